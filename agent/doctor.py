"""Finds which back ends are usable on this machine, and what to install for the rest.

It reads the metadata of installed distributions, and imports a package only where nothing else shows whether it works
(torchvision beside a CPU build of torch, in a separate process). It changes nothing and downloads nothing.
"""

from __future__ import annotations

import importlib.metadata
import os
import platform
import re
import shutil
import subprocess
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from .session.log import scrub


@dataclass(frozen=True)
class Finding:
    """One back end.

    Attributes:
        name: its name on the command line or in `pip install`.
        serves: its purpose.
        usable: whether it would work now.
        needed: whether the program does not run without it.
        version: of the installed distribution, "" if there is none.
        detail: what was found, one sentence.
        fix: what to do if it is not usable, "" if it is.
    """

    name: str
    serves: str
    usable: bool
    needed: bool
    version: str
    detail: str
    fix: str

    def to_json(self) -> dict[str, Any]:
        return asdict(self)


NEEDED = {
    "torch": "tensors and the reference renderer",
    "numba": "fast rendering on the CPU",
    "scipy": "nearest neighbours",
    "onnxruntime": "the embedded text and image encoder",
    "trimesh": "procedural assets",
    "lark": "the grammar planner",
    "pydantic": "plans and receipts",
    "pillow": "pictures",
    "typer": "the command line",
    "rich": "tables",
    "prompt_toolkit": "the chat",
    "safetensors": "saved language fields",
    "zstandard": "reading and writing .spz of version 4",
}


def examine() -> list[Finding]:
    """The findings of all back ends, the needed ones first."""
    nothing_more = (True, False, "", "needs nothing more", "")
    return [
        *(_distribution(name, serves, needed=True, fix=_REINSTALL) for name, serves in NEEDED.items()),
        *(check() for check in (_cuda, _gsplat, _encoder, _torchvision)),
        _distribution("open_clip_torch", "real CLIP towers (open_clip:MODEL/PRETRAINED)"),
        # The towers run on onnxruntime, which is installed in any case; texts also need the `tokenizers` package.
        _distribution(
            "onnx:FOLDER", "real CLIP towers without torch models (embed --encoder onnx:FOLDER)", "tokenizers"
        ),
        Finding("vectors:PATH", "names with vectors made elsewhere (embed --encoder vectors:PATH)", *nothing_more),
        Finding("masks folder:PATH", "masks that another program made (embed --masks folder:PATH)", *nothing_more),
        _distribution("masks sam:PATH", "masks by a Segment Anything model (embed --masks sam:PATH)", "transformers"),
        _distribution("transformers", "local language and vision models"),
        _distribution("pycolmap", "poses of photographs that come without (fit)", fix='pip install "scenewright[sfm]"'),
        _distribution("xatlas", "textures of meshes (mesh)", fix='pip install "scenewright[mesh]"'),
        _distribution("mcp", "serving a scene to MCP clients (mcp)", fix='pip install "scenewright[mcp]"'),
        _webp(),
        _distribution("matplotlib", "charts of `scenewright bench`", fix='pip install "scenewright[bench]"'),
        _ffmpeg(),
        *(_planner(kind) for kind in PLANNERS),
        _planner_here(),
        _planner_of_auto(),
    ]


def machine() -> dict[str, Any]:
    """Python version, system, usable cores and path of the interpreter."""
    return {
        "python": platform.python_version(),
        "system": f"{platform.system()} {platform.machine()}",
        "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
        "executable": sys.executable,
    }


# Hosted language models: provider, client library, environment variables that may hold the key. The planners' own table
# is not used: importing it imports torch, and the doctor must also run where torch cannot be imported.
PLANNERS = {
    "openai": ("OpenAI", "openai", ("OPENAI_API_KEY",)),
    "anthropic": ("Anthropic", "anthropic", ("ANTHROPIC_API_KEY",)),
    "google": ("Google", "google-genai", ("GOOGLE_API_KEY", "GEMINI_API_KEY")),
}
ANY_KEY = "SCENEWRIGHT_API_KEY"

_LLM = 'pip install "scenewright[llm]"'
_REINSTALL = "install Scenewright again: pip install -e . (in its folder)"
_MODELS = 'pip install "scenewright[models]" in one command with torch'


def _version(name: str) -> str:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return ""


def _distribution(name: str, serves: str, package: str = "", *, needed: bool = False, fix: str = _MODELS) -> Finding:
    """The finding on a Python package; `package` if the back end `name` is called otherwise."""
    version = _version(package or name)
    detail = f"{package} is " * bool(package) + ("installed" if version else "not installed")
    return Finding(name, serves, bool(version), needed, version, detail, "" if version else fix)


def _cuda() -> Finding:
    """CUDA needs a CUDA build of torch and a driver; torch is imported only if both seem to be there."""
    version = _version("torch")
    if not version or version.endswith("+cpu"):
        detail, usable = ("this torch is a CPU build" if version else "torch is not installed"), False
    elif not shutil.which("nvidia-smi"):
        detail, usable = "no NVIDIA driver found (nvidia-smi is not on the path)", False
    else:
        import torch

        usable = bool(torch.cuda.is_available())
        detail = torch.cuda.get_device_name(0) if usable else "torch finds no CUDA device"
    fix = "" if usable else "not needed; with an NVIDIA GPU: install a CUDA build of torch 2.13 from pytorch.org"
    return Finding("cuda", "tensors and the reference renderer on a GPU", usable, False, version, detail, fix)


def _gsplat() -> Finding:
    """gsplat's wheels on PyPI hold sources that nvcc compiles on first use; compiled wheels name their torch version
    after a "+" in their own."""
    version, serves = _version("gsplat"), "rendering and fitting on a GPU (render --backend cuda, fit --device cuda)"
    if not version:
        fix = 'not needed; with an NVIDIA GPU: pip install "scenewright[cuda]" beside a CUDA build of torch'
        return Finding("gsplat", serves, False, False, "", "not installed", fix)
    if not _cuda().usable:
        return Finding("gsplat", serves, False, False, version, "installed, but there is no CUDA device", "see cuda")
    home = os.environ.get("CUDA_HOME") or os.environ.get("CUDA_PATH") or "/usr/local/cuda"
    nvcc = shutil.which("nvcc") or shutil.which("nvcc", path=os.path.join(home, "bin"))
    if "+" in version or nvcc:
        return Finding("gsplat", serves, True, False, version, nvcc or "compiled", "")
    fix = "install the CUDA toolkit of torch's CUDA version and set CUDA_HOME to it"
    return Finding("gsplat", serves, False, False, version, "no nvcc to compile its kernels with", fix)


def _encoder() -> Finding:
    """The embedded encoder ships as .onnx files in the package, which a broken installation may lack."""
    home = Path(__file__).resolve().parent.parent / "gaussians" / "language"
    weights = sorted(home.rglob("*.onnx"))
    usable = bool(weights) and bool(_version("onnxruntime"))
    detail = (
        f"{len(weights)} files, {sum(w.stat().st_size for w in weights) / 1e6:.1f} MB"
        if weights
        else "its .onnx files are missing"
    )
    serves = "text and image embedding without a download"
    return Finding("embedded encoder", serves, usable, True, "", detail, "" if usable else _REINSTALL)


def _torchvision() -> Finding:
    """torchvision on PyPI is a CUDA build; beside a CPU build of torch its import fails, and with it other imports."""
    serves, version, torch = "transforms of open_clip and transformers", _version("torchvision"), _version("torch")
    if not version:
        return Finding("torchvision", serves, False, False, "", "not installed", _MODELS)
    if torch.endswith("+cpu") == version.endswith("+cpu"):
        return Finding("torchvision", serves, True, False, version, f"matches torch {torch}", "")
    said, problem = _interpreter(_IMPORT_TORCHVISION)
    if not problem:
        repaired, imports = (
            f"a CUDA build beside torch {torch}: Scenewright repairs its import",
            f"imports beside torch {torch}",
        )
        return Finding("torchvision", serves, True, False, version, repaired if said == "repaired" else imports, "")
    fix = f"pip install torchvision=={version.split('+')[0]}+cpu --index-url https://download.pytorch.org/whl/cpu"
    return Finding("torchvision", serves, False, False, version, problem, fix)


_IMPORT_TORCHVISION = """
try:
    import torchvision
except Exception:
    from scenewright.gaussians.torchvision_fix import import_torchvision
    import_torchvision()
    print("repaired")
"""


def _interpreter(code: str) -> tuple[str, str]:
    """Runs `code` in a fresh interpreter: what it prints, and the last line of its error ("" if it succeeds)."""
    try:
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    except subprocess.TimeoutExpired:
        return "", "its import takes longer than two minutes"
    error = "" if done.returncode == 0 else (done.stderr.strip().splitlines() or ["import failed"])[-1]
    return done.stdout.strip(), error


def _webp() -> Finding:
    serves, usable, detail = "reading and writing .sog", False, "pillow is not installed"
    if _version("pillow"):
        from PIL import features

        usable = bool(features.check("webp"))
        detail = f"libwebp {features.version('webp')}" if usable else "this pillow is built without it"
    return Finding("webp", serves, usable, False, "", detail, "" if usable else "pip install -U pillow")


def _ffmpeg() -> Finding:
    path = shutil.which("ffmpeg")
    fix = "" if path else "apt-get install ffmpeg"
    return Finding("ffmpeg", "turning pictures into video", bool(path), False, "", path or "not on the path", fix)


def _planner(kind: str) -> Finding:
    """A provider's models need its client library and a key; the report names the variable, never the key."""
    label, package, keys = PLANNERS[kind]
    version, missing = _version(package), [p for p in ("pydantic-ai-slim", package) if not _version(p)]
    held = next((name for name in (ANY_KEY, *keys) if os.environ.get(name, "").strip()), "")
    serves = f"plans by models of {label}" + (" or any server in its format" if kind == "openai" else "")
    name, key = f"{kind}:MODEL", f"key in {held}" if held else f"no key ({' or '.join(keys)})"
    if missing:
        return Finding(name, serves, False, False, version, f"{' and '.join(missing)} not installed; {key}", _LLM)
    if held or kind == "openai":
        alone = "" if held else ": only servers of your own, openai:MODEL@URL"
        return Finding(name, serves, True, False, version, f"{key}{alone}", "")
    return Finding(name, serves, False, False, version, key, f"set {keys[0]} to a key of {label}")


def _planner_here() -> Finding:
    """Local language models need transformers, and llguidance to hold them to the schema."""
    missing = [p for p in ("transformers", "llguidance") if not _version(p)]
    detail = f"{' and '.join(missing)} not installed" if missing else "transformers and llguidance are installed"
    serves = "plans by a language model on this machine"
    fix = _MODELS if missing else ""
    return Finding("transformers:FOLDER", serves, not missing, False, _version("llguidance"), detail, fix)


def _planner_of_auto() -> Finding:
    """The model that `auto` asks where the grammar abstains."""
    variable, serves = "SCENEWRIGHT_MODEL", "the model that planner auto asks"
    named = scrub(re.sub(r"//[^/@\s]*@", "//", os.environ.get(variable, "").strip()))
    if named:
        return Finding(variable, serves, True, False, "", named[:200], "")
    fix = f"not needed; to let auto ask a model where the grammar abstains: export {variable}=openai:MODEL@URL"
    return Finding(variable, serves, False, False, "", "not set: auto is the grammar alone", fix)
