"""Command-line options that several verbs share: their names, types and help texts."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from . import startup
from .terminal.output import terminal


def _json(value: bool) -> bool:
    terminal.as_json = value
    return value


def _debug(value: bool) -> bool:
    terminal.debug = value
    if value:
        startup.watch_imports()
    return value


def _window(value: str | None) -> str | None:
    """The window for all models of this run; their back ends read the variable, as they read keys."""
    if value is not None:
        from ..planners.model import WINDOW_VARIABLE, window

        window(value)
        os.environ[WINDOW_VARIABLE] = value
    return value


def _memory(value: str | None) -> str | None:
    """The memory for this run; what reads tiles looks the variable up."""
    if value is not None:
        from ..gaussians.tiles.budget import VARIABLE, parse_memory

        parse_memory(value)
        os.environ[VARIABLE] = value
    return value


SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="A scene file or folder (see `convert --help`).")]
Output = Annotated[
    Path | None,
    typer.Option("--output", "-o", metavar="FILE", help="File for the scene; its suffix selects the format."),
]
Json = Annotated[bool, typer.Option("--json", callback=_json, is_eager=True, help="Print the result as JSON.")]
Debug = Annotated[
    bool,
    typer.Option(
        "--debug", callback=_debug, is_eager=True, help="Show errors with their traceback, and what starting took."
    ),
]
Memory = Annotated[
    str | None,
    typer.Option(
        "--memory", metavar="SIZE", callback=_memory,
        help="Memory for a scene in tiles, as in 4GB (the default) or 500MB; also SCENEWRIGHT_MEMORY.",
    ),
]  # fmt: skip
Force = Annotated[bool, typer.Option("--force", help="Overwrite files that exist.")]
Yes = Annotated[
    bool, typer.Option("--yes", "-y", help="Go on with what was chosen although its name is not confirmed; do not ask.")
]
Encoder = Annotated[
    str,
    typer.Option(
        "--encoder", metavar="NAME",
        help="Text and image encoder: 'auto' (our own), 'open_clip:MODEL/PRETRAINED', 'onnx:FOLDER' or 'vectors:PATH'.",
    ),
]  # fmt: skip
Masks = Annotated[
    str | None,
    typer.Option(
        "--masks", metavar="SOURCE",
        help="Masks of views: 'folder:PATH' (made by another program), 'sam:PATH-or-NAME', 'pictures' (our own, of "
        "photographs or renders), 'embedded', or 'none'. With --capture, 'pictures' is added unless this is 'none'.",
    ),
]  # fmt: skip
Capture = Annotated[
    Path | None,
    typer.Option(
        "--capture", metavar="FILE",
        help="Photographs with camera poses: a transforms.json, or the folder of one or of a COLMAP model.",
    ),
]  # fmt: skip
Planner = Annotated[
    str,
    typer.Option(
        "--planner", metavar="NAME",
        help="Planner: 'auto' (the grammar, then the model that SCENEWRIGHT_MODEL names), 'grammar', "
        "'openai:MODEL[@URL]', 'anthropic:MODEL', 'google:MODEL', 'transformers:FOLDER', or 'auto:' before a model.",
    ),
]  # fmt: skip
Budget = Annotated[
    str | None,
    typer.Option(
        "--budget", metavar="LIMITS",
        help="Limits for models: seconds per instruction, dollars per session, views, tokens: '20s,0.05usd,8views'.",
    ),
]  # fmt: skip
Window = Annotated[
    str | None,
    typer.Option(
        "--window", metavar="TOKENS", callback=_window,
        help="Context window of the language model, as in 32768 or 32k, for servers that do not tell theirs; also "
        "SCENEWRIGHT_WINDOW.",
    ),
]  # fmt: skip
Vlm = Annotated[
    str,
    typer.Option(
        "--vlm", metavar="NAME",
        help="Vision model for what geometry cannot answer or find: 'openai:MODEL[@URL]', 'anthropic:MODEL', "
        "'google:MODEL', 'transformers:FOLDER', or 'auto' (the one that SCENEWRIGHT_VLM names).",
    ),
]  # fmt: skip
Assets = Annotated[
    str | None,
    typer.Option(
        "--assets", metavar="FOLDER|dream:SPEC",
        help="Your own assets: the .glb and .ply files of a folder, by their names; or 'dream:diffusers:FOLDER' or "
        "'dream:command:PROGRAM {prompt} {output}', which make what the library does not draw.",
    ),
]  # fmt: skip
_INFILL = typer.Option(
    "--infill", metavar="NAME",
    help="What fills the surfaces that deleted, moved and replaced things hid: 'scene' (what is around them; the "
    "default), 'none', or also a model that inpaints pictures: 'onnx:FILE' (LaMa), 'diffusers:FOLDER', or "
    "'folder:FOLDER' (made elsewhere).",
)  # fmt: skip
Infill = Annotated[str, _INFILL]
InfillOrDial = Annotated[str | None, _INFILL]  # None: what --effort means, else "scene"
RestyleBy = Annotated[
    str | None,
    typer.Option(
        "--restyle", metavar="NAME",
        help="A model that paints views of what gets another material, which its colours then follow: "
        "'diffusers:FOLDER'.",
    ),
]  # fmt: skip
NoInfill = Annotated[bool, typer.Option("--no-infill", help="Leave holes: the same as --infill none.")]
References = Annotated[
    list[Path] | None,
    typer.Option(
        "--reference", metavar="PHOTO",
        help="A photograph of a material, which instructions may name: 'the sofa like in the photo'. Repeatable.",
    ),
]  # fmt: skip
ReferenceWidth = Annotated[
    float | None,
    typer.Option("--reference-width", metavar="M", help="How many metres the photographs show from left to right."),
]
Harmony = Annotated[
    bool,
    typer.Option("--harmony/--no-harmony", help="Fit what is put into a scene to its light, and let it cast shadows."),
]
Picture = Annotated[
    bool, typer.Option("--picture", help="Send the viewer's picture to a language model that takes pictures.")
]
Batch = Annotated[
    Path | None,
    typer.Option(
        "--batch", metavar="FILE", help='JSON Lines of {"id", "text", "context"?}; one answer per line. - is stdin.'
    ),
]
Log = Annotated[Path | None, typer.Option("--log", metavar="FILE", help="Session log to append to (JSON Lines).")]
View = Annotated[
    str,
    typer.Option(
        "--view", metavar="VIEW",
        help="Viewer: a camera of the scene by number or name, 'x,y,z:x,y,z' as eye and target (and ':55' for a field "
        "of view of 55 degrees), or 'auto'.",
    ),
]  # fmt: skip
Size = Annotated[str | None, typer.Option("--size", metavar="WxH", help="Size of pictures in pixels, e.g. 1280x720.")]
Up = Annotated[str | None, typer.Option("--up", metavar="X,Y,Z", help="Up direction, if the estimated one is wrong.")]
Scale = Annotated[
    float | None,
    typer.Option("--metres-per-unit", metavar="M", help="Scale of the scene, whatever its file says."),
]
JUDGE = "built-in"  # what --judge alone means
Judge = Annotated[
    str | None,
    typer.Option(
        "--judge", metavar="[NAME]",
        help="Judge each edit from the scenes before and after it, repair it if possible, else take it back; "
        "'vlm' also asks the vision model.",
    ),
]  # fmt: skip
Effort = Annotated[
    str | None,
    typer.Option(
        "--effort", metavar="LEVEL",
        help="fast, balanced, accurate, or seconds: settings are chosen from measured points (docs/effort.md); other "
        "options win.",
    ),
]  # fmt: skip
LOD_PIXELS = 1.0  # what --lod alone means: `gaussians.levels.choosing.PIXELS`
Lod = Annotated[
    float | None,
    typer.Option(
        "--lod", metavar="[PIXELS]", min=0.0,
        help="Draw a .lod with levels of detail: parts as coarse as moves nothing by more than so many pixels (1).",
    ),
]  # fmt: skip
Seed = Annotated[int, typer.Option("--seed", min=0, help="Random seed; the same seed gives the same bytes.")]


def with_values(arguments: Sequence[str]) -> list[str]:
    """The arguments with the values of a `--judge`, an `--infill` and a `--lod` that stand alone; what follows them is
    then no value of theirs."""
    from .session.judge import JUDGES

    given = list(arguments)
    for k, word in enumerate(given):
        if word == "--":
            break
        if word == "--infill" and (k + 1 == len(given) or given[k + 1].startswith("-")):
            given[k] = "--infill=scene"
        if word == "--lod" and not _is_number(given[k + 1 : k + 2]):
            given[k] = f"--lod={LOD_PIXELS}"
        if word == "--judge" and given[k + 1 : k + 2] not in ([[j] for j in (*JUDGES, "off")]):
            given[k] = f"--judge={JUDGE}"
    return given


def _is_number(words: Sequence[str]) -> bool:
    """Whether the only one of these words is a number, which may be below zero: then it is refused as one."""
    try:
        return len([float(word) for word in words]) == 1
    except ValueError:
        return False
