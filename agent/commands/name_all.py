"""`scenewright name-all SCENE`: let a vision model name the things of a scene, and keep the names beside it."""

from __future__ import annotations

from typing import Annotated

import typer

from ..options import Budget, Debug, Encoder, Json, SceneFile, View, Vlm, Window
from ..terminal.output import terminal


def command(
    scene: SceneFile,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Take the model's name for things with a sure name too.")
    ] = False,
    vlm: Vlm = "auto",
    budget: Budget = None,
    window: Window = None,
    encoder: Encoder = "auto",
    view: View = "auto",
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Name the things of a scene by a vision model, from a few numbered pictures; the language field keeps the names.

    A name that the encoder or the masks are sure of stays, unless --overwrite is given.
    """
    from ...gaussians.language.field.store import save_field
    from ..session.opening import SessionOptions, open_session
    from ..session.plan_report import format_usage

    session, _ = open_session(SessionOptions(scene, "grammar", encoder, view, budget=budget, vlm=vlm))
    named = session.name_all(overwrite=overwrite)
    path = save_field(session.scene, scene)
    terminal.say(f"wrote {path}")
    if named.captions.usage is not None:
        terminal.say(f"{named.captions.pictures} pictures, {format_usage(named.captions.usage)}")
    if named.captions.stopped:
        terminal.say(f"note: {named.captions.stopped}")
    lines = [named.captions.scene] if named.captions.scene else []
    lines += [f"  {group}: {name}. {named.captions.groups[group].text}" for group, name in named.names.items()]
    lines += [f"  {group}: stays {own}; the model calls it {other}" for group, (own, other) in named.kept.items()]
    terminal.result("\n".join(lines) or "nothing was named", named.to_json())
