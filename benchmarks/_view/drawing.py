"""The page's renderer in a real browser: time to open an exported file, PSNR and clicked groups against the CPU
renderer, milliseconds of a click and of a frame. WebGL runs in software (SwiftShader)."""

from __future__ import annotations

import io
import math
import statistics
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from ...agent.view.standalone import page
from ...gaussians.assets.furnishing.furnish import furnish
from ...gaussians.camera import Camera
from ...gaussians.render import render
from ...gaussians.scene import Scene
from ..edit import crowded
from .browser import chromium

SIZES = ((512, 512), (1280, 720))
CLICKS, FRAMES = 500, 5
_SEED = 17
_CLICK = """points => { const found = []; const began = performance.now();
  for (const [x, y] of points) found.push(viewer.pick(x, y)?.group ?? -1);
  return [found, (performance.now() - began) / points.length]; }"""
_RESIZED = """async (width) => {
  while (viewer.canvas.width !== width) await new Promise(requestAnimationFrame);
  await viewer.idle(); }"""
_FRAMES = """count => { const { gl } = viewer; const pixel = new Uint8Array(4); const found = [];
  for (let i = 0; i < count; i++) { const began = performance.now(); viewer.draw();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); found.push(performance.now() - began); }
  return found; }"""


def measure(quick: bool) -> list[dict[str, Any]]:
    """A row for each scene: `scene`, `gaussians`, `degree`, `opened` (s), `psnr` (dB), `right` (share of clicks),
    `click` (ms), and `frame_WxH` (ms).

    Raises:
        BackendError: there is no browser, or Playwright is not installed.
    """
    made = furnish(3, detail=0.3 if quick else 1.0)
    cloud = made.scene.cloud.replace(group=made.truth.ids + 1)  # 0: floor and walls
    crowd = crowded(20_000 if quick else 1_000_000)
    above = Camera.look_at([3.2, -6, 3], [3.2, 3, 0.5], [0, 0, 1], 512, 512)
    scenes = [("room", Scene(cloud), made.scene.cameras[0])]
    scenes += [(f"sh{d}", Scene(crowd.cloud[:20_000].with_degree(d)), above) for d in range(4)]
    scenes += [] if quick else [("million", Scene(crowd.cloud), above)]
    with chromium() as browser:
        return [_row(browser, *each) for each in scenes]


def _row(browser: Any, name: str, scene: Scene, camera: Camera) -> dict[str, Any]:
    """One scene, opened as an exported file."""
    camera = Camera.look_at(camera.position, camera.position + camera.forward, (0, 0, 1), *SIZES[0], fov_y=55)
    row: dict[str, Any] = {"scene": name, "gaussians": len(scene.cloud), "degree": scene.cloud.degree}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.html"
        path.write_bytes(page(scene, camera, name))
        opened = browser.new_page(viewport=dict(zip(("width", "height"), SIZES[0], strict=True)))
        began = time.perf_counter()
        opened.goto(path.as_uri())
        opened.wait_for_selector("#told:has-text('Drag')", timeout=120_000)
        row["opened"] = time.perf_counter() - began
        opened.add_style_tag(content="header, footer { display: none !important }")
        wanted = render(scene.cloud, camera)
        opened.evaluate("viewer.png()")  # draws
        drawn = np.asarray(Image.open(io.BytesIO(opened.screenshot())).convert("RGB")).astype(float)
        error = float(np.mean((drawn - wanted.to_uint8()) ** 2))
        row["psnr"] = 10 * math.log10(255**2 / max(1e-4, error))
        row |= _clicks(opened, np.asarray(wanted.group))
        for width, height in SIZES:
            opened.set_viewport_size({"width": width, "height": height})
            opened.evaluate(_RESIZED, width)
            row[f"frame_{width}x{height}"] = statistics.median(opened.evaluate(_FRAMES, FRAMES))
        opened.close()
    return row


def _clicks(opened: Any, group: np.ndarray) -> dict[str, float]:
    """Clicks at random pixels that show a group."""
    ys, xs = np.nonzero(group >= 0)
    some = np.random.default_rng(_SEED).integers(0, len(ys), CLICKS)
    points = [[x + 0.5, y + 0.5] for x, y in zip(xs[some].tolist(), ys[some].tolist(), strict=True)]
    found, milliseconds = opened.evaluate(_CLICK, points)
    return {"right": float(np.mean(np.array(found) == group[ys[some], xs[some]])), "click": milliseconds}
