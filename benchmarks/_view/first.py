"""From the page's address to its first whole picture, through the server, in a browser that has shown it before."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from typing import Any

from ...agent.session.session import Session
from ...gaussians import files
from ...gaussians.assets.furnishing.furnish import furnish
from ...gaussians.errors import BackendError
from ...gaussians.scene import Scene
from .._data import folder
from ..edit import crowded
from .browser import chromium
from .client import Server, served

SIZE = {"width": 1280, "height": 720}
PATIENCE = 180.0  # seconds
_ROOM = "bonsai_room.ply"
_POLL = 0.02  # seconds between looks at the page
# Counts the pictures that the page draws before the scene is whole; a whole one is finished when its pixel is read.
_LOOK = """async () => {
  const { store, viewer } = window.scenewright ?? {};
  if (!viewer?.splats) return null;
  if (!viewer.counted) {
    viewer.counted = { pictures: 0, first: null };
    viewer.onFrame = ({ drawn }) => {
      if (store.state.connection === 'ready' || !drawn) return;
      viewer.counted.pictures++;
      viewer.counted.first ??= performance.now();
    };
  }
  if (store.state.connection !== 'ready') return null;
  await viewer.idle();
  const { gl } = viewer;
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  return { seconds: performance.now() / 1000, first: viewer.counted.first, pictures: viewer.counted.pictures,
           slots: viewer.splats.slots }; }"""


def measure(quick: bool) -> list[dict[str, Any]]:
    """A row for each scene: `scene`, `gaussians`, `seconds` from the address to the whole picture, and `pictures` that
    were drawn meanwhile.

    Raises:
        BackendError: there is no browser, Playwright is not installed, or the page does not show the scene.
    """
    data = folder("scenes")
    real = data is not None and (data / _ROOM).exists() and not quick
    room = files.load(data / _ROOM) if data is not None and real else furnish(3, detail=0.3 if quick else 1.0).scene
    scenes = {"room": room, **({} if quick else {"million": Scene(crowded(1_000_000).cloud)})}
    return [{"scene": name, "gaussians": len(scene.cloud), **_opened(scene)} for name, scene in scenes.items()]


def _opened(scene: Scene) -> dict[str, Any]:
    """The second visit of a browser."""
    with tempfile.TemporaryDirectory() as made, chromium() as browser:
        session = Session(scene, planner="grammar", log=Path(made) / "log.jsonl")
        with served(session) as server:
            _visit(browser, server, len(scene.cloud))
            return _visit(browser, server, len(scene.cloud))


def _visit(browser: Any, server: Server, count: int) -> dict[str, Any]:
    context = browser.new_context(viewport=SIZE)
    try:
        name, _, value = server.cookie.partition("=")
        address = f"http://127.0.0.1:{server.port}/"
        context.add_cookies([{"name": name, "value": value, "url": address}])
        page = context.new_page()
        page.goto(address)
        end = time.monotonic() + PATIENCE
        while (found := page.evaluate(_LOOK)) is None:
            if time.monotonic() > end:
                raise BackendError(
                    f"the page did not show {count:,} Gaussians within {PATIENCE:.0f} s; measure again while the "
                    "machine is idle, with a browser that draws WebGL2"
                )
            time.sleep(_POLL)
    finally:
        context.close()
    if found["slots"] != count:
        raise ValueError(f"the page shows {found['slots']:,} of {count:,} Gaussians")
    return {"seconds": found["seconds"], "pictures": found["pictures"]}
