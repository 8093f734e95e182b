"""`scenewright chat SCENE`: edit one scene interactively."""

from __future__ import annotations

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
    Memory,
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
from ..terminal.output import terminal

OUTLINE = 50_000  # Gaussians of a scene in tiles by which the camera is moved


def command(
    scene: SceneFile,
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
    memory: Memory = None,
    seed: Seed = 0,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Edit and question a scene interactively, in words; /help lists commands. --json: one JSON object per line.

    A scene in tiles (see `tile`) is edited where it lies: each edit is in its folder at once, and undo reaches those of
    earlier days. What does not fit into the memory is answered from the table of its things, or refused.
    """
    from ...planners.grammar.planner import make_tables
    from ..session.opening import SessionOptions, open_session
    from ..session.tiled import TiledSession
    from ..terminal.chat import Chat
    from ..terminal.tiled_chat import TiledChat

    session, _ = open_session(
        SessionOptions(
            scene, planner, encoder, view, log=log, seed=seed, up=up, metres_per_unit=metres_per_unit, budget=budget,
            picture=picture, judge=judge, vlm=vlm, assets=assets, infill="none" if no_infill else infill,
            capture=capture, restyle=restyle, references=reference or (), reference_width=reference_width,
            harmony=harmony, tiled=True, outline=OUTLINE,
        )
    )  # fmt: skip
    make_tables()
    try:
        chat = TiledChat(session, terminal) if isinstance(session, TiledSession) else Chat(session, terminal)
        chat.run()
    finally:
        session.close()
