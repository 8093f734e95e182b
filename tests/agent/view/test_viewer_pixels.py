"""The renderer of the page in a real browser against the CPU renderer: the same camera, the same Gaussians."""

from __future__ import annotations

import base64
import http.server
import io
import os
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from PIL import Image
from real_browser import browser_or_skip
from scipy import ndimage

from scenewright import agent
from scenewright.agent.view.changes import Shown, changes
from scenewright.agent.view.state import camera_json
from scenewright.agent.view.wire import change, load
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.render import render
from scenewright.gaussians.render.convention import near_plane
from scenewright.gaussians.scene import Scene

pytestmark = [pytest.mark.browser, pytest.mark.slow]  # seconds of a browser's start and of software drawing

PICTURES = os.environ.get("SCENEWRIGHT_PAGE_PICTURES")  # a folder for pictures, to be looked at: page left, CPU right
VIEWER = Path(agent.__file__).parent / "view" / "page" / "viewer"
WIDTH, HEIGHT = 200, 150
CAMERA = Camera.look_at([0.3, -4.2, 1.4], [0, 0, 0.1], [0, 0, 1], WIDTH, HEIGHT, 50)
GROUPS = 6
PAGE = f"""<!doctype html><meta charset=utf-8><canvas id=c style="width:{WIDTH}px;height:{HEIGHT}px"></canvas>
<script type=module>
import {{ SplatViewer }} from '/viewer.js';
window.viewer = new SplatViewer(document.getElementById('c'));
window.decode = (text) => viewer.decode(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
window.picture = async () => {{
  const bytes = new Uint8Array(await (await viewer.png()).arrayBuffer());
  return btoa(Array.from(bytes, (b) => String.fromCharCode(b)).join(''));
}};
</script>"""


class _Files(http.server.BaseHTTPRequestHandler):
    def do_GET(self) -> None:
        name = self.path.strip("/")
        known = {path.name: path for path in VIEWER.glob("*.js")}
        body = known[name].read_bytes() if name in known else PAGE.encode()
        self.send_response(200)
        self.send_header("Content-Type", "text/javascript" if name in known else "text/html")
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: Any) -> None:
        pass


@pytest.fixture(scope="module")
def page() -> Iterator[Any]:
    with browser_or_skip() as browser:
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), _Files)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        opened = browser.new_page(viewport={"width": 320, "height": 240})
        faults: list[str] = []
        opened.on("pageerror", lambda error: faults.append(str(error)))
        opened.goto(f"http://127.0.0.1:{server.server_port}/")
        opened.wait_for_function("window.viewer")
        yield opened
        server.shutdown()
    assert not faults


def clusters(degree: int, count: int = 3000, seed: int = 1) -> Scene:
    """Clusters of coloured Gaussians of all shapes, a group each, before a wall that hides what is behind it."""
    made = torch.Generator().manual_seed(seed)
    group = torch.arange(count) % GROUPS
    middle = torch.stack([(group % 3 - 1) * 1.2, (group // 3) * 1.0 - 0.5, (group % 2) * 0.8 - 0.2], dim=1)
    means = middle + 0.25 * torch.randn(count, 3, generator=made)
    wall = group == 0
    flat = 3 * torch.rand(count, 3, generator=made) - 1.5
    means[wall] = torch.stack([1.4 * flat[:, 0], torch.full((count,), 1.6), flat[:, 2]], dim=1)[wall]
    sh = torch.zeros(count, (degree + 1) ** 2, 3)
    sh[:, 0] = torch.randn(count, 3, generator=made)
    sh[:, 1:] = 0.25 * torch.randn(count, (degree + 1) ** 2 - 1, 3, generator=made)
    scales = torch.exp(-3.2 + 0.7 * torch.randn(count, 3, generator=made))
    scales[wall] *= 3
    return Scene(
        GaussianCloud.create(
            means, torch.nn.functional.normalize(torch.randn(count, 4, generator=made), dim=1), scales,
            torch.rand(count, generator=made) * 0.95 + 0.05, sh, group=group.to(torch.int32),
        )
    )  # fmt: skip


def shown(page: Any, scene: Scene, camera: Camera = CAMERA) -> Shown:
    """Send the whole scene to the viewer."""
    state = Shown.first(scene)
    page.evaluate("near => { viewer.near = near }", near_plane(scene.cloud.means))
    for message in load(state):
        page.evaluate("decode", base64.b64encode(message).decode())
    page.evaluate("camera => { viewer.camera = camera }", camera_json(camera))
    return state


def picture(page: Any) -> NDArray[np.uint8]:
    data = base64.b64decode(page.evaluate("picture()"))
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"))


def psnr(a: NDArray[np.uint8], b: NDArray[np.uint8]) -> float:
    return float(10 * np.log10(255**2 / max(1e-9, np.mean((a.astype(float) - b) ** 2))))


def keep(name: str, *pictures: NDArray[np.uint8]) -> None:
    if PICTURES:
        Image.fromarray(np.hstack(pictures)).save(Path(PICTURES) / f"{name}.png")


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_the_page_draws_what_the_cpu_draws(page: Any, degree: int) -> None:
    scene = clusters(degree)
    shown(page, scene)
    drawn, wanted = picture(page), render(scene.cloud, CAMERA).to_uint8()
    keep(f"degree{degree}", drawn, wanted)
    assert wanted.std() > 20  # the scene has something to see
    assert psnr(drawn, wanted) > 30
    if degree:  # and the test can see the highest band
        assert psnr(drawn, render(scene.cloud.with_degree(degree - 1), CAMERA).to_uint8()) < 30


@pytest.mark.parametrize(
    ("eye", "at", "fov"), [([0, 0, 0.3], [1, 0.4, 0], 90), ([0, 0, 6], [0, 0, 0], 40)], ids=["within", "straight down"]
)
def test_other_cameras(page: Any, eye: list[float], at: list[float], fov: float) -> None:
    camera = Camera.look_at(eye, at, [0, 0, 1], WIDTH, HEIGHT, fov)
    scene = clusters(1)
    shown(page, scene, camera)
    drawn, wanted = picture(page), render(scene.cloud, camera).to_uint8()
    keep(f"fov{fov}", drawn, wanted)
    assert psnr(drawn, wanted) > 30


def test_a_click_finds_the_group_that_the_cpu_sees(page: Any) -> None:
    scene = clusters(0)
    shown(page, scene)
    page.evaluate("viewer.idle()")
    group = render(scene.cloud, CAMERA).group.numpy()
    ys, xs = np.nonzero(group >= 0)
    some = np.random.default_rng(0).choice(len(ys), 300, replace=False)
    points = [[x + 0.5, y + 0.5] for x, y in zip(xs[some].tolist(), ys[some].tolist(), strict=True)]
    found = page.evaluate("points => points.map(([x, y]) => viewer.pick(x, y)?.group ?? -1)", points)
    assert len(set(found)) == GROUPS
    assert np.mean(np.array(found) == group[ys[some], xs[some]]) >= 0.95
    assert page.evaluate("viewer.pick(1, 1)") is None or group[1, 1] >= 0


def test_a_box_takes_only_what_is_seen_in_it(page: Any) -> None:
    scene = clusters(0)
    state = shown(page, scene)
    page.evaluate("viewer.idle()")
    ranges = page.evaluate("viewer.pickBox(60, 50, 120, 100)")
    rows = np.concatenate([state.slots.rows[first : first + count] for first, count in ranges])
    pixels, depth = CAMERA.project(scene.cloud.means[torch.from_numpy(rows)].numpy())
    assert 20 < len(rows) < 1500 and (depth > 0).all()
    near = (pixels > [35, 25]).all(axis=1) & (pixels < [145, 125]).all(axis=1)
    assert near.mean() > 0.95


def test_a_change_of_rows_shows(page: Any) -> None:
    scene = clusters(2)
    state = shown(page, scene)
    was = picture(page)
    sh = scene.cloud.sh.clone()
    chosen = scene.cloud.group == 2
    sh[chosen, 0] = torch.tensor([1.5, -1.5, -1.5])
    kept = scene.cloud.replace(sh=sh)[~(scene.cloud.group == 1)]
    after = state.then(Scene(kept))
    page.evaluate("decode", base64.b64encode(change(after, 0, changes(state, after) or {})).decode())
    drawn, wanted = picture(page), render(kept, CAMERA).to_uint8()
    keep("changed", was, drawn, wanted)
    assert psnr(drawn, wanted) > 30
    assert psnr(drawn, was) < 30


def test_hidden_groups_are_not_drawn(page: Any) -> None:
    scene = clusters(0)
    shown(page, scene)
    plain = picture(page)
    page.evaluate("() => { viewer.hidden = new Set([1, 3]) }")
    drawn = picture(page)
    page.evaluate("() => { viewer.hidden = new Set() }")
    seen = (scene.cloud.group != 1) & (scene.cloud.group != 3)
    wanted = render(scene.cloud[seen], CAMERA).to_uint8()
    keep("hidden", plain, drawn, wanted)
    assert psnr(drawn, wanted) > 30 > psnr(plain, wanted)
    assert psnr(picture(page), plain) > 60


def test_a_line_runs_around_what_is_selected_and_its_colours_stay(page: Any) -> None:
    scene = clusters(0)
    shown(page, scene)
    plain = picture(page)
    page.evaluate("() => { viewer.highlight = { groups: new Set([2]), color: [1, 0, 1] } }")
    outlined = picture(page)
    page.evaluate("() => { viewer.highlight = {} }")
    keep("outlined", plain, outlined)
    line = (outlined == [255, 0, 255]).all(axis=-1)
    white = torch.where((scene.cloud.group == 2)[:, None, None], 0.5, -0.5) / 0.28209479177
    chosen = render(scene.cloud.replace(sh=white.expand_as(scene.cloud.sh)), CAMERA).rgb[..., 0].numpy() > 0.5
    near = ndimage.binary_dilation(chosen, ndimage.generate_binary_structure(2, 2), iterations=4)
    assert chosen.sum() > 200
    assert (line & near & ~ndimage.binary_erosion(chosen)).sum() > 0.98 * line.sum()
    border = ndimage.binary_dilation(chosen) & ~chosen
    assert (line & border).sum() > 0.9 * border.sum()
    assert np.abs(outlined.astype(int) - plain)[~line].max() <= 1
    assert psnr(picture(page), plain) > 60


def test_the_slider_shows_the_scene_before_on_its_left(page: Any) -> None:
    scene = clusters(1)
    cloud = scene.cloud
    means = cloud.means + torch.tensor([0.3, 0.0, 0.4]) * (cloud.group == 2)[:, None]
    now = Scene(cloud.replace(means=means)[cloud.group != 1])
    past = shown(page, now).then(scene)  # it has Gaussians that the scene of now lacks
    message = change(past, 0, changes(Shown.first(now), past) or {}, "before")
    send = "text => viewer.setBefore(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer)"
    page.evaluate(send, base64.b64encode(message).decode())
    before, after = (render(s.cloud, CAMERA).to_uint8() for s in (scene, now))
    assert psnr(picture(page), after) > 30 > psnr(before, after)
    page.evaluate("() => { viewer.compare = 0.5 }")
    drawn, half = picture(page), WIDTH // 2
    keep("slider", before, drawn, after)
    assert psnr(drawn[:, :half], before[:, :half]) > 30 > psnr(drawn[:, :half], after[:, :half])
    assert psnr(drawn[:, half:], after[:, half:]) > 30 > psnr(drawn[:, half:], before[:, half:])
    page.evaluate("() => { viewer.setBefore(null); viewer.compare = null }")
    assert psnr(picture(page), after) > 30


def lit(means: torch.Tensor, scales: torch.Tensor, opacities: torch.Tensor, colors: torch.Tensor) -> Scene:
    """Upright Gaussians of plain colours, in [0, 1]."""
    turn = torch.tensor([1.0, 0, 0, 0]).expand(len(means), 4)
    return Scene(GaussianCloud.create(means, turn, scales, opacities, ((colors - 0.5) / 0.28209479177)[:, None]))


def test_every_footprint_of_a_full_draw_call_is_whole(page: Any) -> None:
    """16-bit indices begin a new strip at 65,535, the last corner of the 16,384th footprint: the large one here."""
    made = torch.Generator().manual_seed(2)
    near = 0.5 * torch.rand(16_383, 3, generator=made) - torch.tensor([0.25, 3.0, 0.0])
    means = torch.cat([near, torch.tensor([[0.0, 0.0, 0.1]])])
    scales = torch.full((16_384, 3), 1e-3)
    scales[-1] = 0.6
    opacities = torch.full((16_384,), 0.02)
    opacities[-1] = 0.95
    scene = lit(means, scales, opacities, torch.tensor([0.9, 0.6, 0.2]).expand(16_384, 3))
    shown(page, scene)
    drawn, wanted = picture(page), render(scene.cloud, CAMERA).to_uint8()
    keep("full call", drawn, wanted)
    assert psnr(drawn, wanted) > 45


def test_what_is_behind_an_opaque_wall_is_left_out_and_nothing_else(page: Any) -> None:
    """A wall covers the left of the picture; later batches leave out what is wholly behind it."""
    made = torch.Generator().manual_seed(3)
    count = 6000
    flat = torch.rand(count, 3, generator=made)
    wall = torch.stack([2.4 * flat[:, 0] - 2.4, -1 + 0.01 * flat[:, 1], 3 * flat[:, 2] - 1.4], dim=1)
    behind = torch.stack([5 * flat[:, 2] - 2.5, 1 + 0.5 * flat[:, 1], 4 * flat[:, 0] - 2], dim=1)
    means = torch.cat([wall, behind])
    scales = torch.full((2 * count, 3), 0.06)
    scales[count:] = 0.01 + 0.12 * torch.rand(count, 1, generator=made) ** 3
    colors = torch.rand(2 * count, 3, generator=made)
    colors[:count] = torch.tensor([0.7, 0.4, 0.3])  # of one colour: its order is finer than the sort's 16 bits
    scene = lit(means, scales, torch.full((2 * count,), 0.9), colors)
    shown(page, scene)
    drawn, wanted = picture(page), render(scene.cloud, CAMERA).to_uint8()
    keep("wall", drawn, wanted)
    assert psnr(drawn, wanted) > 45


def test_a_lost_context_comes_back_with_all_that_changed_meanwhile(page: Any) -> None:
    scene = clusters(2)
    state = shown(page, scene)
    was = picture(page)
    page.evaluate("() => { window.loser = viewer.gl.getExtension('WEBGL_lose_context'); loser.loseContext() }")
    page.evaluate("() => { viewer.highlight = { groups: new Set([3]), color: [1, 0, 1] } }")
    sh = scene.cloud.sh.clone()
    sh[scene.cloud.group == 2, 0] = torch.tensor([1.5, -1.5, -1.5])
    kept = scene.cloud.replace(sh=sh)
    after = state.then(Scene(kept))
    page.evaluate("decode", base64.b64encode(change(after, 0, changes(state, after) or {})).decode())
    assert page.evaluate("viewer.gl.isContextLost()")
    page.evaluate("async () => { await new Promise((done) => setTimeout(done, 200)); loser.restoreContext() }")
    outlined = picture(page)
    page.evaluate("() => { viewer.highlight = {} }")
    drawn, wanted = picture(page), render(kept, CAMERA).to_uint8()
    keep("restored", was, outlined, drawn, wanted)
    assert (outlined == [255, 0, 255]).all(axis=-1).sum() > 50
    assert psnr(drawn, wanted) > 40
    assert psnr(drawn, was) < 30
