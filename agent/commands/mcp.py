"""`scenewright mcp SCENE`: serve a scene to MCP clients, over stdin and stdout or over HTTP on this machine."""

from __future__ import annotations

from typing import Annotated

import typer

from ..options import (
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
    RestyleBy,
    Scale,
    SceneFile,
    Seed,
    Size,
    Up,
    View,
    Vlm,
    Window,
)


def command(
    scene: SceneFile,
    http: Annotated[
        int | None,
        typer.Option("--http", metavar="PORT", min=0, max=65535, help="Serve HTTP on 127.0.0.1 (0: any free port)."),
    ] = None,
    planner: Planner = "auto",
    vlm: Vlm = "auto",
    budget: Budget = None,
    window: Window = None,
    picture: Picture = False,
    judge: Judge = None,
    infill: Infill = "scene",
    no_infill: NoInfill = False,
    capture: Capture = None,
    restyle: RestyleBy = None,
    harmony: Harmony = True,
    encoder: Encoder = "auto",
    up: Up = None,
    metres_per_unit: Scale = None,
    view: View = "auto",
    size: Size = None,
    log: Log = None,
    seed: Seed = 0,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Serve a scene to MCP clients: they edit, look, ask, undo, and save to the folder of the scene.

    By default over stdin and stdout, as most clients start a server. --json: with --http, print the address as JSON.
    """
    from ...gaussians.errors import BackendError
    from ...planners.grammar.planner import make_tables
    from ..output_files import folder_of
    from ..session.opening import SessionOptions, open_session
    from ..toolbox.progress import Progress
    from ..toolbox.toolbox import Toolbox

    try:
        from ..mcp.server import SceneServer
        from ..mcp.serving import serve_http, serve_stdio
    except ModuleNotFoundError as error:
        if error.name is None or error.name.split(".")[0] not in ("mcp", "mcp_types", "uvicorn", "anyio"):
            raise
        raise BackendError("`scenewright mcp` needs the package mcp; run: pip install 'scenewright[mcp]'") from error

    progress = Progress()
    session, embedded = open_session(
        SessionOptions(
            scene, planner, encoder, view, size, log, seed, up=up, metres_per_unit=metres_per_unit, budget=budget,
            picture=picture, judge=judge, vlm=vlm, infill="none" if no_infill else infill, capture=capture,
            restyle=restyle, harmony=harmony,
        ),
        progress,
    )  # fmt: skip
    folder = folder_of(scene)
    make_tables()
    server = SceneServer(Toolbox(session, folder, keep_field=embedded, progress=progress))
    try:
        serve_stdio(server) if http is None else serve_http(server, http)
    finally:
        session.close()
