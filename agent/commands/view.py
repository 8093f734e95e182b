"""`scenewright view SCENE`: see and edit a scene in the browser, in words and with clicks."""

from __future__ import annotations

from typing import Annotated

import typer

from ..options import (
    Assets,
    Budget,
    Capture,
    Debug,
    Encoder,
    Harmony,
    Infill,
    Json,
    Judge,
    Log,
    NoInfill,
    Picture,
    Planner,
    References,
    ReferenceWidth,
    RestyleBy,
    Scale,
    SceneFile,
    Seed,
    Up,
    View,
    Vlm,
    Window,
)


def command(
    scene: SceneFile,
    port: Annotated[
        int, typer.Option("--port", metavar="PORT", min=0, max=65535, help="Port on 127.0.0.1 (0: any free one).")
    ] = 0,
    open_page: Annotated[bool, typer.Option("--open/--no-open", help="Open the page in the browser.")] = True,
    anew: Annotated[
        bool, typer.Option("--anew", help="Begin with the file as it is, without unsaved edits of the last time.")
    ] = False,
    planner: Planner = "auto",
    vlm: Vlm = "auto",
    budget: Budget = None,
    window: Window = None,
    assets: Assets = None,
    picture: Picture = False,
    judge: Judge = None,
    infill: Infill = "scene",
    no_infill: NoInfill = False,
    capture: Capture = None,
    restyle: RestyleBy = None,
    reference: References = None,
    reference_width: ReferenceWidth = None,
    harmony: Harmony = True,
    encoder: Encoder = "auto",
    up: Up = None,
    metres_per_unit: Scale = None,
    view: View = "auto",
    log: Log = None,
    seed: Seed = 0,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """See a scene in the browser, click things, and edit in words; all on this machine.

    Prints the address with a token that counts once. Every step is in a log (--log; by default one for each scene in
    the user's folder for state), so that what was not saved is made again the next time.
    """
    from ...gaussians.errors import BackendError
    from ...planners.grammar.planner import make_tables
    from ..session.opening import SessionOptions

    try:
        from ..view.running import run
    except ModuleNotFoundError as error:
        if error.name is None or error.name.split(".")[0] not in ("starlette", "uvicorn", "websockets"):
            raise
        raise BackendError("`scenewright view` needs more packages; run: pip install 'scenewright[view]'") from error

    options = SessionOptions(
        scene, planner, encoder, view, log=log, seed=seed, up=up, metres_per_unit=metres_per_unit, budget=budget,
        picture=picture, judge=judge, vlm=vlm, assets=assets, infill="none" if no_infill else infill, capture=capture,
        restyle=restyle, references=reference or (), reference_width=reference_width, harmony=harmony,
    )  # fmt: skip
    make_tables()
    run(options, port=port, open_page=open_page, anew=anew)
