"""The shape of the house: who may import whom, what a wheel holds, and what start-up costs."""

from __future__ import annotations

import ast
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

import scenewright
from scenewright.benchmarks import structure

ROOT = Path(__file__).resolve().parents[1]
SHIPPED = ("gaussians", "tools", "planners", "agent", "prompts")
PACKAGES = (*SHIPPED, "benchmarks", "training")
# Lower packages never import higher ones. `benchmarks` may import everything; only `scenewright bench` imports it.
MAY_IMPORT = {
    "gaussians": {"gaussians"},
    "tools": {"gaussians", "tools"},
    "planners": {"gaussians", "tools", "prompts", "planners"},
    "agent": {"gaussians", "tools", "planners", "prompts", "agent", "benchmarks"},
    "prompts": {"prompts"},
    "benchmarks": {"gaussians", "tools", "planners", "agent", "prompts", "training", "benchmarks"},
    "training": {"gaussians", "planners", "training"},  # composed rooms are photographed and fitted too
}


def _modules(package: str) -> list[Path]:
    return sorted((ROOT / package).rglob("*.py"))


def _packages_imported(path: Path) -> Iterator[tuple[str, int]]:
    """Packages that a module imports, absolutely or relatively, anywhere in it, with the line."""
    package = ("scenewright", *path.relative_to(ROOT).parent.parts)
    for statement in structure.source(path).imports:
        base = package[: len(package) - statement.level + 1] if statement.level else ()
        base += tuple(statement.module.split(".")) if statement.module else ()
        for name in ((*base, *imported.split(".")) for imported in statement.names):
            if name[0] == "scenewright" and len(name) > 1:
                yield name[1], statement.line


@pytest.mark.parametrize("package", PACKAGES)
def test_packages_import_only_lower_ones(package: str) -> None:
    wrong = [
        f"{path.relative_to(ROOT)}:{line} imports {other}"
        for path in _modules(package)
        for other, line in _packages_imported(path)
        if other in PACKAGES and other not in MAY_IMPORT[package]
    ]
    assert not wrong


def test_no_module_imports_itself_through_others() -> None:
    """Imports within functions and for type checkers count too."""
    modules = structure.product()
    edges = [(a, b) for a, path in modules.items() for b in structure.imported(a, path, modules)]
    assert len(edges) > 1000
    assert not structure.cycles(modules, edges)


@pytest.mark.parametrize("package", PACKAGES)
def test_every_file_says_what_it_knows(package: str) -> None:
    silent = [p for p in _modules(package) if p.stat().st_size and not structure.source(p).docstring]
    assert not silent


@pytest.mark.parametrize("package", PACKAGES)
def test_every_folder_of_modules_is_a_package(package: str) -> None:
    bare = {p.parent for p in _modules(package) if not (p.parent / "__init__.py").exists()}
    assert not bare


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Names in a wheel built from a copy without the editors' links, as a build on Windows would see it."""
    if importlib.util.find_spec("setuptools") is None:
        pytest.skip("setuptools is not installed in this environment; the wheel cannot be built")
    copy = tmp_path_factory.mktemp("build")
    for package in PACKAGES:  # all of them, so that what does not ship has a chance to slip in
        shutil.copytree(ROOT / package, copy / package, ignore=shutil.ignore_patterns("__pycache__"))
    (copy / "src" / "scenewright").mkdir(parents=True)
    for file in (ROOT / "src" / "scenewright").iterdir():
        if not file.is_symlink() and file.is_file():
            shutil.copy(file, copy / "src" / "scenewright")
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy)
    code = "from setuptools.build_meta import build_wheel; print(build_wheel('out'))"
    done = subprocess.run([sys.executable, "-c", code], cwd=copy, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    (built,) = (copy / "out").glob("*.whl")
    return zipfile.ZipFile(built).namelist()


def test_the_wheel_holds_every_package_with_its_data(wheel: list[str]) -> None:
    wanted = {
        f"scenewright/{path.relative_to(ROOT).as_posix()}"
        for package in SHIPPED
        for path in (ROOT / package).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    wanted |= {"scenewright/__init__.py", "scenewright/__main__.py", "scenewright/py.typed"}
    assert not wanted - set(wheel)


def test_the_wheel_holds_nothing_else(wheel: list[str]) -> None:
    assert not [n for n in wheel if not n.startswith(("scenewright/", "scenewright-"))]
    assert not [n for n in wheel if "__pycache__" in n]
    assert not [
        n
        for n in wheel
        if n.startswith(tuple(f"scenewright/{folder}" for folder in ("tests", "benchmarks", "training")))
    ]


def test_no_package_is_importable_by_its_bare_name(tmp_path: Path) -> None:
    code = (
        "import importlib.util, json, sys; names = sys.argv[1:];"
        "print(json.dumps({n: str(s.origin or list(s.submodule_search_locations or [])) for n in names"
        " if (s := importlib.util.find_spec(n))}))"
    )
    env = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    done = subprocess.run(
        [sys.executable, "-c", code, *PACKAGES, "tests"],
        cwd=tmp_path,
        env=env,
        capture_output=True,
        text=True,
        check=True,
    )
    # Another distribution may install a module called "tools" or "tests"; ours must not.
    ours = {name: origin for name, origin in json.loads(done.stdout).items() if str(ROOT) in origin}
    assert not ours


def test_exported_members() -> None:
    assert sorted(scenewright.__all__) == scenewright.__all__
    assert set(scenewright.__all__) == set(scenewright._HOME)
    for name in scenewright.__all__:
        assert getattr(scenewright, name) is not None
        assert name in dir(scenewright)
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = scenewright.nonsense


def test_exported_members_are_declared_for_type_checkers() -> None:
    tree = ast.parse((ROOT / "src/scenewright/__init__.py").read_text("utf-8"))
    block = next(n for n in tree.body if isinstance(n, ast.If))
    declared = {
        alias.name: f".{node.module}" for node in block.body if isinstance(node, ast.ImportFrom) for alias in node.names
    }
    assert declared == scenewright._HOME


def _loaded_by(code: str, whole: bool = False) -> set[str]:
    """Modules in a fresh interpreter after `code`: the top-level ones, or all by their whole names."""
    name = "m" if whole else "m.split('.')[0]"
    report = f"; import sys, json; print(json.dumps(sorted({{{name} for m in sys.modules}})), file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code + report], capture_output=True, text=True, check=True)
    return set(json.loads(done.stderr.strip().splitlines()[-1]))


HEAVY = {"torch", "numpy", "numba", "scipy", "trimesh", "onnxruntime", "PIL", "matplotlib", "lark", "prompt_toolkit"}


def test_import_costs_nothing() -> None:
    assert not _loaded_by("import scenewright") & (HEAVY | {"pydantic", "rich", "typer"})


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys; from scenewright.agent.cli import main; sys.argv = ['scenewright', '--help']\n"
        "try: main()\nexcept SystemExit: pass\nTrue"
    )
    assert not _loaded_by(code) & (HEAVY | {"pydantic"})


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A room with a saved language field, and the name of a thing in it."""
    path = tmp_path_factory.mktemp("start") / "room.ply"
    made = f"""
from pathlib import Path
import scenewright as sw
from scenewright.gaussians.language.field.store import save_field
path = Path({str(path)!r})
sw.save(sw.furnish(3, objects=3, detail=0.25).scene, path)
from scenewright.gaussians.language import encoders
scene = sw.embed(sw.load(path), encoders.load())
save_field(scene, path)
print(max(scene.language.objects(), key=lambda g: g.label_score).label)
"""
    done = subprocess.run([sys.executable, "-c", made], check=True, capture_output=True, text=True)
    return path, done.stdout.strip()


def _loaded_by_command(*arguments: str) -> set[str]:
    return _loaded_by(
        "from scenewright.agent.cli import main\n"
        f"try: main({list(arguments)!r})\nexcept SystemExit as end: assert not end.code, end.code\nTrue",
        whole=True,
    )


# Of no use to a command that selects or recolours a thing by its name: 0.05 s or more each, most of it scipy.
UNUSED = {
    "trimesh", "matplotlib", "prompt_toolkit", "rich", "scipy.sparse", "scipy.optimize", "scipy.stats",
    "scenewright.gaussians.assets", "scenewright.gaussians.fit", "scenewright.planners.questions",
    "scenewright.planners.compose", "scenewright.planners.layout", "scenewright.planners.model.prompt",
    "scenewright.tools.harmony.form",
}  # fmt: skip


@pytest.mark.slow
def test_select_on_a_saved_field_loads_only_what_it_uses(room: tuple[Path, str]) -> None:
    loaded = _loaded_by_command("select", str(room[0]), f"every {room[1]}")
    assert {"torch", "scenewright.gaussians.language.query.resolve"} <= loaded  # the command has run
    assert not loaded & (UNUSED | {"numba", "llvmlite", "scipy.ndimage", "scipy.spatial", "scipy.special"})
    assert not {m for m in loaded if m.startswith("scenewright.agent.commands.")} - {
        "scenewright.agent.commands.select"
    }


@pytest.mark.slow
def test_edit_on_a_saved_field_loads_only_what_it_uses(room: tuple[Path, str], tmp_path: Path) -> None:
    words = f"recolor every {room[1]} teal"
    loaded = _loaded_by_command("edit", str(room[0]), words, "-o", str(tmp_path / "out.ply"))
    assert (tmp_path / "out.ply").is_file() and "scenewright.tools.coloring.repaint" in loaded
    assert not loaded & UNUSED


@pytest.mark.slow
def test_ask_and_info_on_a_saved_field_load_only_what_they_use(room: tuple[Path, str]) -> None:
    loaded = _loaded_by_command("ask", str(room[0]), f"how many {room[1]}s are there?")
    assert "scenewright.planners.questions.kinds.counting" in loaded
    assert not loaded & {"numba", "trimesh", "rich", "scipy.ndimage", "scipy.sparse", "scipy.optimize"}
    loaded = _loaded_by_command("info", str(room[0]))
    assert "scenewright.agent.terminal.thing_names" in loaded
    assert not loaded & {"numba", "trimesh", "rich", "lark", "scipy", "scenewright.gaussians.fit"}
