"""What a model inpaints into views of a hole is lifted into Gaussians; all others stay as they were."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import BackendError
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.selection import Selection
from scenewright.gaussians.render import render
from scenewright.gaussians.rows import mask_of_ids
from scenewright.gaussians.scene import Scene
from scenewright.tools.completing import completed
from scenewright.tools.execute import carry_out
from scenewright.tools.lifting.depth import continued_depth, seeds
from scenewright.tools.lifting.inpainted import with_inpainted
from scenewright.tools.lifting.inpainters import F32, Shot, load
from scenewright.tools.lifting.views import Revealed, views_of
from scenewright.tools.operation import Context
from scenewright.tools.receipt import Lifted
from scenewright.tools.registry import parse

from .conftest import BOX, FLOOR, STEP, Room, ring

Result = tuple[Scene, torch.Tensor, Lifted]
NONE = torch.zeros(0, dtype=torch.int64)


@dataclass
class Oracle:
    """Knows what is behind: renders it."""

    truth: GaussianCloud
    cameras: Sequence[Camera]
    name: str = "oracle"
    grow: int = 2
    seen: list[Shot] = field(default_factory=list)

    def prepare(self, shots: Sequence[Shot]) -> None:
        assert [s.name for s in shots] == [f"view_{k:02d}" for k in range(len(self.cameras))]

    def fill(self, shot: Shot, seed: int = 0) -> F32:
        self.seen.append(shot)
        return render(self.truth, self.cameras[int(shot.name[-2:])]).rgb.clamp(0, 1).numpy()


@dataclass
class Broken:
    """Returns what it is told to."""

    answer: object
    name: str = "broken"
    grow: int = 2

    def prepare(self, shots: Sequence[Shot]) -> None:
        pass

    def fill(self, shot: Shot, seed: int = 0) -> F32:
        if isinstance(self.answer, Exception):
            raise self.answer
        return self.answer  # type: ignore[return-value]


def _emptied(room: Room) -> Scene:
    cloud = room.fitted.cloud
    return room.fitted.replace(cloud=cloud[cloud.group == FLOOR])


def _oracle(room: Room, after: Scene, new: torch.Tensor) -> Oracle:
    views = views_of(Revealed.of(room.fitted, after, new), after.cameras, after.frame.up_vector)
    return Oracle(room.truth, [v.camera for v in views])


@pytest.fixture(scope="module")
def lifted(room: Room) -> Result:
    after = _emptied(room)
    return with_inpainted(room.fitted, after, NONE, _oracle(room, after, NONE))


def _same(a: GaussianCloud, b: GaussianCloud) -> bool:
    return all(torch.equal(x, y) for (_, x), (_, y) in zip(a.columns(), b.columns(), strict=True))


@pytest.mark.slow
def test_old_gaussians_stay_and_new_ids_are_fresh(room: Room, lifted: Result) -> None:
    scene, ids, told = lifted
    before = _emptied(room).cloud
    assert _same(scene.cloud[: len(before)], before)
    assert torch.equal(scene.cloud.ids[len(before) :], ids) and len(ids) == told.made > 0
    assert int(ids.min()) > int(room.fitted.cloud.ids.max()) and len(ids.unique()) == len(ids)
    assert set(scene.cloud.group[len(before) :].tolist()) == {FLOOR}


@pytest.mark.slow
def test_the_same_input_gives_the_same_bytes(room: Room, lifted: Result) -> None:
    after = _emptied(room)
    again, _, _ = with_inpainted(room.fitted, after, NONE, _oracle(room, after, NONE))
    assert _same(again.cloud, lifted[0].cloud)


def test_what_a_good_model_says_is_seen_from_other_sides(room: Room, lifted: Result) -> None:
    """The stripe and the tiles are where they were, which takes a right depth as well as right colours."""
    empty, thing = _emptied(room).cloud, room.fitted.cloud[room.fitted.cloud.group == BOX]
    for camera in ring(24)[1::6]:
        want, was, now = (render(c, camera) for c in (room.truth, empty, lifted[0].cloud))
        hole = (was.alpha < 0.5).numpy() & (render(thing, camera).alpha > 0.5).numpy()
        assert hole.sum() > 100
        # Slivers at the outline are hidden from here alone, and from none of the views that were inpainted.
        assert (now.alpha.numpy()[hole] < 0.5).mean() < 0.05
        error = [np.square(x.rgb.numpy() - want.rgb.numpy())[hole].mean() for x in (was, now)]
        assert error[1] < error[0] / 15 and -10 * np.log10(error[1]) > 18


@pytest.mark.slow
def test_only_what_is_missing_is_asked_again(room: Room) -> None:
    after = _emptied(room)
    oracle = _oracle(room, after, NONE)
    with_inpainted(room.fitted, after, NONE, oracle)
    first, later = oracle.seen[0], oracle.seen[1:]
    assert all(s.mask.sum() < 0.5 * first.mask.sum() for s in later)


@pytest.mark.slow
def test_a_fill_tells_the_depth_and_is_replaced(room: Room, lifted: Result) -> None:
    """What views show of the fill from the scene goes; what none shows, under the box, stays."""
    oracle = _oracle(room, room.filled, room.new)
    scene, ids, told = with_inpainted(room.fitted, room.filled, room.new, oracle)
    own = mask_of_ids(room.filled.cloud.ids, room.new)
    old = int((~own).sum())
    assert _same(scene.cloud[:old], room.filled.cloud[~own])
    assert told.replaced == int((~mask_of_ids(room.new, scene.cloud.ids)).sum()) > 0.5 * len(room.new)
    assert len(scene.cloud) == len(room.filled.cloud) + told.made - told.replaced
    assert torch.equal(ids, scene.cloud.ids[old:])
    made = scene.cloud.means[len(scene.cloud) - told.made :]
    # On the floor, as the fill was; a render's depth is that of the centres drawn first, up to half a one away.
    assert float(made[:, 2].abs().median()) < 0.5 * 0.6 * STEP


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (np.zeros((3, 3, 3), np.float32), r"returned \[3, 3, 3\]"),
        (BackendError("out of memory; take a smaller model"), "out of memory"),
    ],
)
def test_a_model_that_fails_leaves_the_fill(room: Room, answer: object, said: str) -> None:
    scene, ids, told = with_inpainted(room.fitted, room.filled, room.new, Broken(answer))
    assert scene is room.filled and ids is room.new
    assert told.views == 0 and __import__("re").search(said, told.reason)


@pytest.mark.slow
def test_a_model_that_crashes_leaves_the_edit(room: Room) -> None:
    """An `Inpainter` of the user's own may raise anything."""
    scene = room.fitted
    target = Selection(Query(), "found", scene.cloud.ids[scene.cloud.group == BOX])
    op = parse({"op": "delete", "target": {"groups": [BOX]}})
    plain = Context(viewer=scene.cameras[0])
    done = [
        completed(scene, op, how, carry_out(scene, op, how, target, seen=False))
        for how in (plain, replace(plain, inpainter=Broken(ValueError("shape"))))
    ]
    assert _same(done[0].scene.cloud, done[1].scene.cloud)
    assert done[1].receipt.notes[-1] == "pictures were not used: that failed (ValueError: shape)"


def test_nothing_hidden_is_nothing_to_fill(room: Room) -> None:
    whole = room.fitted.replace(cloud=room.truth)
    after, _, told = with_inpainted(whole, whole, NONE, Broken(None))
    assert after is whole and told.reason == "no view shows a hole that it left"


def test_a_scene_without_cameras_is_seen_from_around(room: Room) -> None:
    after = _emptied(room)
    found = views_of(Revealed.of(room.fitted, after, NONE), (), np.array([0.0, 0, 1]))
    assert len(found) >= 4 and all(v.hole.sum() > 100 for v in found)
    positions = np.stack([v.camera.position for v in found])
    assert (positions[:, 2] > 0.2).all()
    assert np.ptp(np.degrees(np.arctan2(positions[:, 1], positions[:, 0]))) > 120  # from different sides


def test_depth_goes_on_and_breaks_at_edges() -> None:
    """A near strip and a far one with a hole across both: depth follows the colours."""
    rgb = np.zeros((20, 40, 3), np.float32)
    rgb[:, 20:] = 0.8
    depth = np.where(np.arange(40) < 20, 1.0, 4.0)[None].repeat(20, axis=0)
    hole = np.zeros((20, 40), bool)
    hole[6:14, 5:35] = True
    found = continued_depth(np.where(hole, 0, depth), ~hole, hole, rgb, np.zeros((20, 40)))
    assert np.abs(found / depth - 1)[hole].max() < 0.25 and np.abs(found / depth - 1)[hole].mean() < 0.08
    assert np.array_equal(found[~hole], depth[~hole])
    nearest = np.full((20, 40), 2.0)
    assert continued_depth(np.where(hole, 0, depth), ~hole, hole, rgb, nearest)[hole].min() >= 2.0


def test_seeds_project_to_their_pixels() -> None:
    camera = Camera.look_at([0.3, -2, 1], [0, 0, 0], [0, 0, 1], 60, 40)
    pixels = np.zeros((40, 60), bool)
    pixels[5:9, 10:20] = True
    depth = np.linspace(1, 3, 60)[None].repeat(40, axis=0)
    rgb = np.random.default_rng(0).random((40, 60, 3)).astype(np.float32)
    like = Scene(GaussianCloud.create(*_one())).cloud
    found = seeds(camera, rgb, depth, pixels, like)
    at, z = camera.project(found.means.numpy().astype(np.float64))
    y, x = np.nonzero(pixels)
    assert np.abs(at - np.stack([x, y], 1) - 0.5).max() < 1e-2
    assert np.abs(z - depth[y, x]).max() < 1e-4
    seen = render(found, camera)
    assert float(seen.alpha.numpy()[6:8, 11:19].min()) > 0.9
    assert found.sh.shape[1] == like.sh.shape[1] and set(found.group.tolist()) == {7}


def _one() -> tuple[torch.Tensor, ...]:
    return (
        torch.zeros(1, 3), torch.tensor([[1.0, 0, 0, 0]]), torch.full((1, 3), 0.1), torch.tensor([0.5]),
        torch.zeros(1, 4, 3), torch.tensor([7], dtype=torch.int32),
    )  # fmt: skip


@pytest.mark.slow
def test_delete_with_a_folder_of_pictures(room: Room, tmp_path: Path) -> None:
    """The whole way, twice: the views are written, somebody paints them, and they are lifted."""
    scene = room.fitted
    target = Selection(Query(), "found", scene.cloud.ids[scene.cloud.group == BOX])
    op = parse({"op": "delete", "target": {"groups": [BOX]}})
    context = Context(viewer=scene.cameras[0], inpainter=load(f"folder:{tmp_path}"))

    def delete(how: Context) -> tuple[Scene, object]:
        done = completed(scene, op, how, carry_out(scene, op, how, target, seen=False))
        return done.scene, done.receipt

    plain, _ = delete(replace(context, inpainter=None))
    first, receipt = delete(context)
    assert _same(first.cloud, plain.cloud)
    assert "wait to be inpainted" in receipt.notes[-1]  # type: ignore[attr-defined]
    edit = next(tmp_path.iterdir())
    for path in (edit / "pictures").iterdir():
        rgb, mask = np.asarray(Image.open(path)).copy(), np.asarray(Image.open(edit / "masks" / path.name))
        rgb[mask > 0] = [200, 40, 30]
        Image.fromarray(rgb).save(edit / "filled" / path.name)
    second, receipt = delete(context)
    made = receipt.lifted[0].made  # type: ignore[attr-defined]
    old = int((scene.cloud.group == FLOOR).sum())
    assert receipt.added == len(second.cloud) - old and made > 50  # type: ignore[attr-defined]
    assert _same(second.cloud[:old], plain.cloud[:old])
    shot = render(second.cloud, scene.cameras[2])
    hole = (render(_emptied(room).cloud, scene.cameras[2]).alpha < 0.3).numpy()
    hole &= (render(room.fitted.cloud[room.fitted.cloud.group == BOX], scene.cameras[2]).alpha > 0.9).numpy()
    assert np.abs(shot.rgb.numpy()[hole] - np.float32([200, 40, 30]) / 255).mean() < 0.1
