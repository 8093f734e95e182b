"""Frames of the page's renderer beside those of PlayCanvas and Spark: the same scenes, cameras, sizes and browser.

The other engines are taken from npm at pinned versions into the user's cache when this runs; none of them is part of
the project. Each engine keeps its defaults. A frame begins with the camera's move and ends when a pixel of its picture
is read back, so that everything asked of WebGL is drawn; the camera goes on by a degree each frame, and every engine
sorts meanwhile in its own worker, by its own policy. Processor time is that of all processes of the browser.
"""

from __future__ import annotations

import base64
import http.server
import io
import json
import math
import os
import shutil
import statistics
import subprocess
import tempfile
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from ...agent.view import wire
from ...agent.view.changes import Shown
from ...agent.view.server import PAGE
from ...gaussians import files
from ...gaussians.assets.furnishing.furnish import furnish
from ...gaussians.cloud import GaussianCloud
from ...gaussians.errors import BackendError
from ...gaussians.render import render
from ...gaussians.render.convention import near_plane
from ...gaussians.scene import Scene
from ...gaussians.user_cache import user_cache
from .._data import folder, missing
from ..render import VIEWS, View
from .browser import DRIVERS, chromium

PACKAGES = ("playcanvas@2.23.3", "@sparkjsdev/spark@2.2.0", "three@0.187.0")
MODULES = {
    "playcanvas": "/modules/playcanvas/build/playcanvas.mjs",
    "three": "/modules/three/build/three.module.js",
    "three/addons/": "/modules/three/examples/jsm/",
    "spark": "/modules/@sparkjsdev/spark/dist/spark.module.min.js",
}
OURS, OTHERS = "ours", ("playcanvas", "spark")
SIZES = ((512, 512), (1280, 720))
STEPS, QUICK_STEPS, DEGREES = 6, 3, 1.0  # frames of a walk, and the angle between them
REST_MS = 1500  # that an engine has to sort the order of the picture that is compared
_FOLDER = Path(__file__).parent / "engine_pages"
_HTML = """<!doctype html><link rel="icon" href="data:,"><style>body {{ margin: 0 }} canvas {{ display: block; width: {width}px; height: {height}px }}</style>
<canvas id="canvas" width="{width}" height="{height}"></canvas>
<script type="importmap">{imports}</script>
<script type="module">import * as walk from '/walk.js'; window.walk = walk;</script>"""  # noqa: E501
_START = """async ([name, told]) => {
  const { start } = await import(`/${name}.js`);
  window.engine = await start(document.getElementById('canvas'), told); }"""


@dataclass(frozen=True)
class Row:
    """One engine at one scene and size.

    Attributes:
        frame: milliseconds of a frame, the median of a walk.
        cpu: milliseconds of processor time of a frame, the mean of a walk.
        psnr: of the engine's picture at rest to the CPU renderer's, dB.
    """

    driver: str
    scene: str
    size: str
    engine: str
    frame: float
    cpu: float
    psnr: float


def measure(quick: bool) -> tuple[list[Row], list[str]]:
    """The rows, and what could not be measured and why.

    Raises:
        BackendError: there is no browser, or Playwright is not installed.
    """
    try:
        modules: Path | None = fetched()
        notes = []
    except BackendError as error:
        modules, notes = None, [f"engines: PlayCanvas and Spark were not measured: {error}"]
    engines = (OURS, *OTHERS) if modules is not None else (OURS,)
    scenes, absent = _scenes(quick)
    sizes, steps, drivers = (SIZES[:1], QUICK_STEPS, DRIVERS[:1]) if quick else (SIZES, STEPS, DRIVERS)
    rows = []
    for name, (cloud, view) in scenes.items():
        with tempfile.TemporaryDirectory() as made:
            path = Path(made) / "scene.ply"
            files.save(Scene(cloud), path)
            table = _table(path, cloud)
            for driver in drivers:
                with chromium(driver) as browser, _served(table, modules) as address:
                    for size in sizes if driver == DRIVERS[0] else sizes[:1]:
                        about = _about(cloud, view, len(table) - 1)
                        for engine in engines:
                            found = _walked(browser, f"{address}/?{size[0]}x{size[1]}", size, engine, about, steps)
                            psnr = _psnr(found.pop("picture"), cloud, view, size)
                            rows.append(Row(driver, name, f"{size[0]}x{size[1]}", engine, psnr=psnr, **found))
    return rows, notes + absent


def fetched() -> Path:
    """The folder of the other engines' packages, taken from npm at their pinned versions if they are not there yet.

    Raises:
        BackendError: there is no npm, or it could not fetch them.
    """
    root = user_cache("engines")
    modules = root / "node_modules"
    if all(_version(modules / name) == version for name, _, version in (p.rpartition("@") for p in PACKAGES)):
        return modules
    npm = shutil.which("npm")
    if npm is None:
        raise BackendError("there is no npm, which fetches them; install node")
    root.mkdir(parents=True, exist_ok=True)
    command = [npm, "install", "--prefix", str(root), "--no-audit", "--no-fund", "--ignore-scripts", *PACKAGES]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    except subprocess.TimeoutExpired as error:
        raise BackendError("npm did not fetch them within five minutes; is there a network?") from error
    if done.returncode:
        raise BackendError(f"npm could not fetch them: {(done.stderr.strip().splitlines() or ['no reason given'])[-1]}")
    return modules


def _version(package: Path) -> str | None:
    """The version of an installed package; None if it is not there."""
    file = package / "package.json"
    return str(json.loads(file.read_text("utf-8"))["version"]) if file.is_file() else None


def _scenes(quick: bool) -> tuple[dict[str, tuple[GaussianCloud, View]], list[str]]:
    """Clouds with their views: a furnished room, and real scenes where they are."""
    made = furnish(3, detail=0.3 if quick else 1.0)
    camera = made.scene.cameras[0]
    eye, ahead = (tuple(float(x) for x in v) for v in (camera.position, camera.position + 2 * camera.forward))
    room = View("", (eye[0], eye[1], eye[2]), (ahead[0], ahead[1], ahead[2]), (0.0, 0.0, 1.0), 55.0)
    scenes = {"furnished": (made.scene.cloud, room)}
    data = folder("scenes")
    if data is None:
        return scenes, [missing("scenes")]
    if not quick:
        scenes |= {name: (files.load(data / view.scene).cloud, view) for name, view in VIEWS.items()}
    return scenes, []


def _about(cloud: GaussianCloud, view: View, columns: int) -> dict[str, Any]:
    """What a page is told of a scene."""
    near = float(near_plane(cloud.means))
    camera = {"eye": view.eye, "target": view.target, "up": view.up, "fov_y": view.fov}
    return {"near": near, "far": 1e5 * near, "columns": columns, "camera": camera}


def _walked(
    browser: Any, address: str, size: tuple[int, int], engine: str, about: Mapping[str, Any], steps: int
) -> dict[str, Any]:
    """Milliseconds of a frame, and of processor time, and the picture at rest as a PNG."""
    page = browser.new_page(viewport={"width": size[0], "height": size[1]})
    page.set_default_timeout(300_000)
    try:
        page.goto(address)
        page.wait_for_function("window.walk")
        page.evaluate(_START, [engine, about])
        picture = page.evaluate("([camera, ms]) => walk.rest(engine, camera, ms)", [about["camera"], REST_MS])
        step = "([camera, steps, degrees]) => walk.walk(engine, camera, steps, degrees)"
        page.evaluate(step, [about["camera"], 2, DEGREES])  # its buffers grow, its workers start
        before = _processor_seconds()
        frames = page.evaluate(step, [about["camera"], steps, DEGREES])
        spent = _processor_seconds() - before
    finally:
        page.close()
    png = base64.b64decode(picture.partition(",")[2])
    return {"frame": statistics.median(frames), "cpu": 1000 * spent / steps, "picture": png}


def _psnr(png: bytes, cloud: GaussianCloud, view: View, size: tuple[int, int]) -> float:
    drawn = np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(float)
    wanted = render(cloud, view.camera(size)).to_uint8()
    error = float(np.mean((drawn - wanted) ** 2))
    return 10 * math.log10(255**2 / max(1e-4, error))


def _processor_seconds() -> float:
    """Seconds of processor time of the running processes that this one started, and of those that they did."""
    children: dict[int, list[int]] = {}
    ticks: dict[int, int] = {}
    for process in Path("/proc").glob("[0-9]*"):
        try:
            fields = (process / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue  # it ended
        children.setdefault(int(fields[1]), []).append(int(process.name))
        ticks[int(process.name)] = int(fields[11]) + int(fields[12])
    found, waiting = 0, list(children.get(os.getpid(), []))
    while waiting:
        process_id = waiting.pop()
        found += ticks[process_id]
        waiting += children.get(process_id, [])
    return found / os.sysconf("SC_CLK_TCK")


# -- what the pages load ---------------------------------------------------------------------------------------------


def _table(path: Path, cloud: GaussianCloud) -> dict[str, bytes]:
    """A scene by address: as a PLY file, and as the messages of the page."""
    messages = wire.load(Shown.first(Scene(cloud)))
    return {"/scene.ply": path.read_bytes(), **{f"/columns/{i}": message for i, message in enumerate(messages)}}


@contextmanager
def _served(table: Mapping[str, bytes], modules: Path | None) -> Iterator[str]:
    """The address of a server on this machine, until the block ends."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), partial(_Files, table, modules))
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        server.server_close()


class _Files(http.server.BaseHTTPRequestHandler):
    """Pages, modules and scenes."""

    def __init__(self, table: Mapping[str, bytes], modules: Path | None, *rest: Any) -> None:
        self._table, self._modules = table, modules
        super().__init__(*rest)

    def do_GET(self) -> None:
        path, _, query = self.path.partition("?")
        kind = "text/javascript" if path.endswith(("js", "mjs")) else "application/octet-stream"
        if path == "/":
            width, height = query.split("x")
            body = _HTML.format(width=width, height=height, imports=json.dumps({"imports": MODULES})).encode()
            kind = "text/html"
        elif path in self._table:
            body = self._table[path]
        else:
            root = PAGE if path.startswith("/viewer/") else _FOLDER
            if path.startswith("/modules/") and self._modules is not None:
                root = self._modules
            file = (root / path.removeprefix("/modules").lstrip("/")).resolve()
            if not file.is_relative_to(root.resolve()) or not file.is_file():
                self.send_error(404)
                return
            body = file.read_bytes()
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing."""
