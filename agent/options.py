"""Options that several verbs share, declared once. Knows names and help texts; nothing else."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .terminal.output import terminal


def _json(value: bool) -> bool:
    terminal.as_json = value
    return value


def _debug(value: bool) -> bool:
    terminal.debug = value
    return value


SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="A scene file or folder (see `convert --help`).")]
Output = Annotated[
    Path | None,
    typer.Option("--output", "-o", metavar="FILE", help="Where to write the scene; its suffix says the format."),
]
Json = Annotated[bool, typer.Option("--json", callback=_json, is_eager=True, help="Print the result as JSON.")]
Debug = Annotated[
    bool, typer.Option("--debug", callback=_debug, is_eager=True, help="Let errors through with their traceback.")
]
Force = Annotated[bool, typer.Option("--force", help="Overwrite files that exist.")]
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
        help="Masks of some views: 'folder:PATH' of another program's, 'sam:PATH-or-NAME', or 'embedded'.",
    ),
]  # fmt: skip
Capture = Annotated[
    Path | None,
    typer.Option("--capture", metavar="FILE", help="Where photographs were taken: a transforms.json or its folder."),
]
Planner = Annotated[
    str,
    typer.Option(
        "--planner", metavar="NAME",
        help="Who reads instructions: 'auto' (the grammar, then the model that SCENEWRIGHT_MODEL names), 'grammar', "
        "'openai:MODEL[@URL]', 'anthropic:MODEL', 'google:MODEL', 'transformers:FOLDER', or 'auto:' before a model.",
    ),
]  # fmt: skip
Budget = Annotated[
    str | None,
    typer.Option(
        "--budget", metavar="LIMITS",
        help="What language models may cost: seconds an instruction and dollars a session, '20s', '0.05usd' or both.",
    ),
]  # fmt: skip
Picture = Annotated[
    bool, typer.Option("--picture", help="Let a language model that sees look at the viewer's picture.")
]
Batch = Annotated[
    Path | None,
    typer.Option(
        "--batch", metavar="FILE", help='JSON Lines of {"id", "text", "context"?}; one answer a line. - is stdin.'
    ),
]
Log = Annotated[Path | None, typer.Option("--log", metavar="FILE", help="Session log to append to (JSON Lines).")]
View = Annotated[
    str,
    typer.Option(
        "--view", metavar="VIEW",
        help="The viewer: a camera of the scene by number or name, or 'EYE:TARGET' as 'x,y,z:x,y,z'; 'auto' chooses.",
    ),
]  # fmt: skip
Size = Annotated[str | None, typer.Option("--size", metavar="WxH", help="Size of pictures in pixels, e.g. 1280x720.")]
Up = Annotated[str | None, typer.Option("--up", metavar="X,Y,Z", help="Which way is up, if it is guessed wrongly.")]
Scale = Annotated[
    float | None, typer.Option("--metres-per-unit", metavar="M", help="The scene's scale, where its file says nothing.")
]
Seed = Annotated[
    int, typer.Option("--seed", min=0, help="What varies between two runs; the same seed gives the same bytes.")
]
