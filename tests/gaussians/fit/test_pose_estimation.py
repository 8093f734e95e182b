"""Photographs without poses: found, surveyed once, kept, told of, and refused with a reason. What finds poses is stood
in for, except where pycolmap itself is asked; those tests are skipped where it is not installed."""

from __future__ import annotations

import importlib.util
import json
import math
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from PIL import Image

from scenewright.gaussians import rotations
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import BackendError, FileError, UserError
from scenewright.gaussians.files.captures.capture import read_capture, to_transforms, unposed_photos
from scenewright.gaussians.fit import load_photos
from scenewright.gaussians.fit.photographs import pose_estimation
from scenewright.gaussians.lens import Lens
from scenewright.gaussians.render import render

needs_pycolmap = pytest.mark.skipif(
    importlib.util.find_spec("pycolmap") is None, reason='pycolmap is not installed: pip install "scenewright[sfm]"'
)
Lots = list[dict[str, Any]]


def around(count: int, width: int = 48, height: int = 40, turn: float = 2 * math.pi) -> list[Camera]:
    return [
        Camera.look_at((3 * math.cos(a), 3 * math.sin(a), 1 + 0.3 * math.sin(3 * a)), (0, 0, 0), (0, 0, 1), width,
                       height, name=f"p{i:03d}")
        for i, a in enumerate(np.linspace(0, turn, count, endpoint=False))
    ]  # fmt: skip


def photographs(folder: Path, count: int = 8, suffix: str = ".png") -> Path:
    """Pictures of noise, no two alike."""
    folder.mkdir(parents=True)
    rng = np.random.default_rng(count)
    for camera in around(count):
        noise = rng.integers(0, 256, (40, 48, 3), dtype=np.uint8)
        Image.fromarray(noise).save(folder / (camera.name + suffix))
    return folder


class StandIn:
    """Places all cameras but the last `without`, by the points of a ball, as COLMAP's text."""

    def __init__(self, without: int = 0, points: int = 300) -> None:
        self.without, self.points, self.runs = without, points, 0

    def __call__(self, lots: Lots, work: Path, progress: Callable[[str, float], None]) -> None:
        self.runs += 1
        names = sorted(name for lot in lots for name in lot["photos"].values())
        pictures = [name for lot in lots for name in lot["photos"]]
        assert all((work / "pictures" / name).is_file() for name in pictures)
        sparse = work / "sparse/0"
        sparse.mkdir(parents=True)
        one, lines = around(1)[0], []
        for i, camera in enumerate(around(len(names))[: len(names) - self.without]):
            turn = torch.from_numpy(camera.world_to_camera[:3, :3].copy())
            quat = rotations.from_matrix(turn[None])[0].tolist()
            pose = " ".join(map(str, [*quat, *camera.world_to_camera[:3, 3]]))
            lines.append(f"{i} {pose} 1 {names[i]}\n\n")
        (sparse / "images.txt").write_text("".join(lines))
        (sparse / "cameras.txt").write_text(f"1 SIMPLE_RADIAL 48 40 {one.fx} 24 20 0.01\n")
        ball = np.random.default_rng(0).normal(0, 0.3, (self.points, 3))
        rows = (f"{i} {x} {y} {z} 100 100 100 0.5\n" for i, (x, y, z) in enumerate(ball))
        (sparse / "points3D.txt").write_text("".join(rows))
        progress("placing cameras", 1.0)


@pytest.fixture
def placing(monkeypatch: pytest.MonkeyPatch) -> StandIn:
    return stand_in(monkeypatch, StandIn())


def stand_in(monkeypatch: pytest.MonkeyPatch, made: StandIn) -> StandIn:
    monkeypatch.setattr(pose_estimation, "run", made)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: name)
    return made


# -- which folders ---------------------------------------------------------------------------------------------------


def test_photographs_are_found_in_the_folder_or_in_images_whatever_their_case(tmp_path: Path) -> None:
    plain = photographs(tmp_path / "a", suffix=".JPG")
    inside = photographs(tmp_path / "b/images", suffix=".jpeg").parent
    for folder in (plain, inside):
        (folder / "notes.txt").write_text("none")
        (folder / ".hidden.jpg").write_bytes(b"what macOS leaves on disks of others")
    assert [p.name for p in unposed_photos(plain)] == [f"p00{i}.JPG" for i in range(8)]
    assert [p.parent.name for p in unposed_photos(inside)] == ["images"] * 8
    (inside / "transforms.json").write_text("{}")
    assert unposed_photos(inside) == [] == unposed_photos(tmp_path) == unposed_photos(tmp_path / "no")


def test_who_needs_poses_is_told_where_they_come_from(tmp_path: Path) -> None:
    with pytest.raises(FileError, match=r"has 8 photographs but no poses; `scenewright fit .*` estimates them"):
        read_capture(photographs(tmp_path / "a"))
    with pytest.raises(FileError, match="has 8 photographs but no poses"):
        load_photos(tmp_path / "a")


def test_what_is_described_is_read_again(tmp_path: Path) -> None:
    cameras, lens = around(5), Lens(0.1, -0.02, 0.003, 0.0004, -0.0005)
    told = to_transforms(cameras, [lens] * 5, [f"../{c.name}.png" for c in cameras])
    (tmp_path / "transforms.json").write_text(json.dumps(told))
    again = read_capture(tmp_path)
    assert again.lenses == (lens,) * 5 and [p.name for p in again.photos] == [f"{c.name}.png" for c in cameras]
    for a, b in zip(cameras, again.cameras, strict=True):
        assert np.allclose(a.world_to_camera, b.world_to_camera, atol=1e-12)  # two inverses in float64
        assert (a.fx, a.fy, a.cx, a.cy, a.width, a.height) == (b.fx, b.fy, b.cx, b.cy, b.width, b.height)


# -- what is kept ----------------------------------------------------------------------------------------------------


def test_photographs_alone_become_a_capture_beside_them(tmp_path: Path, placing: StandIn) -> None:
    folder, kept = photographs(tmp_path / "in"), tmp_path / "out/room.ply.poses"
    kept.parent.mkdir()
    before = sorted(p.name for p in folder.iterdir())
    told: list[str] = []
    taken = load_photos(folder, progress=lambda stage, share: told.append(stage), poses=kept)
    assert taken.poses_folder == kept and taken.unplaced == () and len(taken.points.means) == 300
    shots = sorted((*taken.shots, *taken.held_out), key=lambda s: s.camera.name)
    for shot, camera in zip(shots, around(8), strict=True):
        assert np.allclose(shot.camera.world_to_camera, camera.world_to_camera, atol=1e-5)  # from_matrix is float32
    assert sorted(p.name for p in folder.iterdir()) == before
    assert [p.name for p in kept.parent.iterdir()] == [kept.name]  # nothing half-written
    assert [c.name for c in read_capture(kept).cameras] == [c.name for c in around(8)]
    assert {"preparing photographs", "placing cameras", "reading photographs"} <= set(told)


def test_the_same_photographs_are_surveyed_once_even_if_things_move(tmp_path: Path, placing: StandIn) -> None:
    folder, kept = photographs(tmp_path / "in"), tmp_path / "kept"
    load_photos(folder, poses=kept)
    load_photos(folder, poses=kept)
    assert placing.runs == 1
    away = tmp_path / "far/away/kept"
    away.parent.mkdir(parents=True)
    kept.rename(away)
    folder = folder.rename(tmp_path / "elsewhere")
    assert len(load_photos(folder, poses=away).shots) == 7 and placing.runs == 1
    assert read_capture(away).photos[0].resolve() == (folder / "p000.png").resolve()
    (folder / "p003.png").write_bytes((folder / "p004.png").read_bytes())
    load_photos(folder, poses=away)
    assert placing.runs == 2 and [p.name for p in away.parent.iterdir()] == ["kept"]


def test_photographs_that_find_no_place_are_left_out_by_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = stand_in(monkeypatch, StandIn(without=2))
    folder = photographs(tmp_path / "in")
    for _ in range(2):  # just surveyed, and found again
        taken = load_photos(folder, poses=tmp_path / "kept")
        assert taken.unplaced == ("p006.png", "p007.png") and len(taken.shots) + len(taken.held_out) == 6
    assert made.runs == 1


# -- what is refused -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (
            StandIn(without=5),
            r"only 3 of 8 photographs .* could be placed, with 300 common points; take more photographs",
        ),
        (StandIn(points=99), "only 8 of 8 photographs .* could be placed, with 99 common points"),
    ],
)
def test_a_survey_that_holds_little_is_refused_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, made: StandIn, said: str
) -> None:
    stand_in(monkeypatch, made)
    folder = photographs(tmp_path / "in")
    with pytest.raises(FileError, match=said):
        load_photos(folder, poses=tmp_path / "kept")
    assert [p.name for p in tmp_path.iterdir()] == ["in"]


def test_an_interrupt_leaves_what_was_kept_before(
    tmp_path: Path, placing: StandIn, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, kept = photographs(tmp_path / "in"), tmp_path / "kept"
    load_photos(folder, poses=kept)
    before = (kept / "transforms.json").read_bytes()
    (folder / "p000.png").unlink()

    def stop(lots: Lots, work: Path, progress: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(pose_estimation, "run", stop)
    with pytest.raises(KeyboardInterrupt):
        load_photos(folder, poses=kept)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["in", "kept"]
    assert (kept / "transforms.json").read_bytes() == before


def test_nothing_of_others_is_replaced(tmp_path: Path, placing: StandIn) -> None:
    folder, kept = photographs(tmp_path / "in"), tmp_path / "kept"
    kept.mkdir()
    (kept / "diary.txt").write_text("mine")
    with pytest.raises(UserError, match="holds something else"):
        load_photos(folder, poses=kept)
    assert (kept / "diary.txt").read_text() == "mine" and placing.runs == 0


def _broken(folder: Path) -> None:
    (folder / "p005.png").write_bytes(b"no picture")


def _cut(folder: Path) -> None:
    whole = (folder / "p005.png").read_bytes()
    (folder / "p005.png").write_bytes(whole[: len(whole) // 2])


def _twice(folder: Path) -> None:
    shutil.copy(folder / "p005.png", folder / "P005.PNG")


def _few(folder: Path) -> None:
    for i in range(5):
        (folder / f"p00{i}.png").unlink()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (_broken, r"cannot read the photograph .*p005\.png"),
        (_cut, r"cannot read the photograph .*p005\.png"),
        (_twice, "two photographs are called p005"),
        (_few, "has 3 photographs; at least 4 are needed"),
    ],
)
def test_what_is_wrong_with_photographs_is_said_before_the_work(
    tmp_path: Path, placing: StandIn, change: Callable[[Path], None], said: str
) -> None:
    change(photographs(tmp_path / "in"))
    with pytest.raises(FileError, match=said):
        load_photos(tmp_path / "in", poses=tmp_path / "kept")
    assert placing.runs == 0 and [p.name for p in tmp_path.iterdir()] == ["in"]


def test_no_folder_for_poses_is_a_file_error(tmp_path: Path, placing: StandIn) -> None:
    with pytest.raises(FileError, match="cannot write"):
        load_photos(photographs(tmp_path / "in"), poses=tmp_path / "no/such/kept")


def test_without_pycolmap_the_command_to_install_it_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(BackendError, match=r'pip install "scenewright\[sfm\]"'):
        load_photos(photographs(tmp_path / "in"), poses=tmp_path / "kept")
    assert [p.name for p in tmp_path.iterdir()] == ["in"]


# -- cameras ---------------------------------------------------------------------------------------------------------


def test_photographs_of_one_size_and_focal_length_share_a_camera(tmp_path: Path) -> None:
    exif = Image.Exif()
    exif.get_ifd(0x8769)[0xA405] = 28
    picture = Image.new("RGB", (2000, 1500))
    for name, told in (("a", exif), ("b", exif), ("c", Image.Exif())):
        picture.save(tmp_path / f"{name}.jpg", exif=told)
    picture.resize((300, 400)).save(tmp_path / "d.jpg", exif=b"Exif\0\0broken")
    lots = pose_estimation._lots(sorted(tmp_path.glob("*.jpg")), tmp_path / "pictures", lambda stage, share: None)
    assert [sorted(lot["photos"].values()) for lot in lots] == [["a.jpg", "b.jpg"], ["c.jpg"], ["d.jpg"]]
    assert [(lot["width"], lot["height"], lot["full"]) for lot in lots[1:]] == [
        (1600, 1200, [2000, 1500]), (300, 400, [300, 400]),
    ]  # fmt: skip
    # a diagonal of 2000 px stands for that of 36 x 24 mm
    assert lots[0]["focal"] == pytest.approx(28 / math.hypot(36, 24) * 2000)
    assert lots[1]["focal"] is None and lots[2]["focal"] is None
    for name in lots[0]["photos"]:
        with Image.open(tmp_path / "pictures" / name) as shrunk:
            assert shrunk.size == (1600, 1200)


# -- pycolmap itself -------------------------------------------------------------------------------------------------


@needs_pycolmap
def test_pairs_are_all_of_few_and_the_most_alike_of_many() -> None:
    from scenewright.gaussians.fit.photographs.reconstruct import PARTNERS, SEQUENTIAL, count_matches, likely_pairs

    rng = np.random.default_rng(0)

    def seen(count: int) -> np.ndarray[Any, np.dtype[np.float32]]:
        found = np.abs(rng.normal(size=(count, 32))).astype(np.float32)
        return found / np.linalg.norm(found, axis=1, keepdims=True)

    places = [seen(20) for _ in range(3)]
    views = [np.concatenate([places[i % 3], seen(10)]) for i in range(75)]  # three places, looked at in turn
    assert count_matches(views[0], views[3]) >= 20 > 10 > count_matches(views[0], views[1])
    assert count_matches(views[0], views[0][:1]) == 0 == count_matches(views[0][:0], views[1])
    assert likely_pairs(views[:10]) == {(a, b) for b in range(10) for a in range(b)}
    pairs = likely_pairs(views)
    assert all(a < b for a, b in pairs) and len(pairs) <= 75 * (PARTNERS + SEQUENTIAL)
    ahead = {(a, b) for a in range(75) for b in range(a + 1, min(75, a + 1 + SEQUENTIAL))}
    assert ahead <= pairs and all(a % 3 == b % 3 for a, b in pairs - ahead)
    assert all(sum(i in pair for pair in pairs) >= PARTNERS for i in range(75))


@needs_pycolmap
@pytest.mark.slow
def test_a_failure_of_the_other_process_is_a_backend_error(tmp_path: Path) -> None:
    with pytest.raises(BackendError, match=r"pycolmap failed to estimate poses: KeyError: 'focal'"):
        pose_estimation.run([{"photos": {}}], tmp_path, lambda stage, share: None)


def textured(count: int = 5000) -> GaussianCloud:
    """Small blobs of all colours on a floor and on the faces of a box that stands on it."""
    g = torch.Generator().manual_seed(5)
    flat = torch.rand(count, 3, generator=g) * 2 - 1
    side = torch.arange(count) % 4
    floor = torch.stack([1.8 * flat[:, 0], 1.8 * flat[:, 1], torch.full((count,), -0.6)], dim=1)
    sign = torch.where(flat[:, 2] < 0, -0.6, 0.6)
    box = torch.where((side == 2)[:, None], torch.stack([sign, 0.6 * flat[:, 0], 0.6 * flat[:, 1]], dim=1),
                      torch.stack([0.6 * flat[:, 0], sign, 0.6 * flat[:, 1]], dim=1))  # fmt: skip
    means = torch.where((side < 2)[:, None], floor, box)
    quats = torch.nn.functional.normalize(torch.randn(count, 4, generator=g), dim=1)
    scales = torch.rand(count, 3, generator=g) * 0.02 + 0.01
    return GaussianCloud.create(
        means, quats, scales, torch.full((count,), 0.95), torch.randn(count, 1, 3, generator=g) * 1.5
    )


@needs_pycolmap
@pytest.mark.slow
def test_poses_of_a_rendered_scene_are_found_again(tmp_path: Path) -> None:
    """Up to a similarity, which nothing in photographs can tell: angles and shares of distances are compared."""
    cameras, cloud = around(20, 400, 300, turn=0.6 * 2 * math.pi), textured()
    cameras[::3] = [camera.resized(480, 360) for camera in cameras[::3]]  # by another camera
    (tmp_path / "in").mkdir()
    for camera in cameras:
        Image.fromarray(render(cloud, camera).to_uint8()).save(tmp_path / "in" / f"{camera.name}.png")
    Image.new("RGB", (400, 300), (90, 90, 90)).save(tmp_path / "in" / "blank.png")
    taken = load_photos(tmp_path / "in", poses=tmp_path / "kept")
    assert taken.unplaced == ("blank.png",)
    shots = sorted((*taken.shots, *taken.held_out), key=lambda s: s.camera.name)
    found, true = ([c.world_to_camera for c in cs] for cs in ([s.camera for s in shots], cameras))
    eyes, told = (np.stack([-w[:3, :3].T @ w[:3, 3] for w in ws]) for ws in (found, true))
    apart, wanted = (np.linalg.norm(e[:, None] - e[None], axis=2) for e in (eyes, told))
    # A pixel is a 300th of the depth and 0.2 degrees; where blobs pass before each other, what is found wanders by a
    # few of them. Solutions that are wrong are off by tens of degrees, and bent.
    assert np.abs(apart / apart.max() - wanted / wanted.max()).max() < 0.02
    for i in range(1, 20):
        turn = found[i][:3, :3] @ found[0][:3, :3].T @ (true[i][:3, :3] @ true[0][:3, :3].T).T
        assert math.degrees(math.acos(min(1.0, (np.trace(turn) - 1) / 2))) < 1
    for shot, camera in zip(shots, cameras, strict=True):
        assert (shot.camera.width, shot.camera.height) == (camera.width, camera.height)
        assert shot.camera.fx == pytest.approx(camera.fx, rel=0.03)
    assert len({shot.camera.fx for shot in shots}) == 2
    load_photos(tmp_path / "in", poses=tmp_path / "again")
    for name in ("transforms.json", "sparse/0/points3D.bin"):
        assert (tmp_path / "kept" / name).read_bytes() == (tmp_path / "again" / name).read_bytes()


@needs_pycolmap
@pytest.mark.slow
def test_photographs_that_share_nothing_cannot_be_placed(tmp_path: Path) -> None:
    folder = photographs(tmp_path / "in")
    with pytest.raises(FileError, match="only 0 of 8 photographs"):
        load_photos(folder, poses=tmp_path / "kept")
    assert [p.name for p in tmp_path.iterdir()] == ["in"]
