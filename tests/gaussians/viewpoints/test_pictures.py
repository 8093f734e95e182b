"""Pictures of a scene: photographs are read without distortion, chosen for what they show, and missed aloud."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from scipy import ndimage

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import FileError, UserError
from scenewright.gaussians.files.captures.capture import Capture, read_capture, to_transforms
from scenewright.gaussians.language import encoders, masks
from scenewright.gaussians.language.field.embed import embed
from scenewright.gaussians.language.masks.sources.pictures import Pictures
from scenewright.gaussians.lens import Lens
from scenewright.gaussians.render import contributions, render
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.viewpoints.pictures import choose_photographs, present, read_photographs, render_views

SIDE = 64


@pytest.fixture
def scene(world: Any) -> Scene:
    made = world().box("red", (-0.8, -0.5, 0), (-0.2, 0.1, 0.6), (0.8, 0.1, 0.1), 0.05)
    return Scene(made.box("blue", (0.3, -0.3, 0), (0.8, 0.2, 0.4), (0.1, 0.1, 0.8), 0.05).cloud())


def write(folder: Path, scene: Scene, count: int = 6, lens: Lens | None = None, aim: float = 0.0) -> Capture:
    """A capture around the scene with its photographs, which are renders."""
    (folder / "images").mkdir(parents=True)
    cameras = []
    for i, angle in enumerate(np.linspace(0, 2 * np.pi, count, endpoint=False)):
        eye = [3 * np.cos(angle), 3 * np.sin(angle), 1.5]
        cameras.append(Camera.look_at(eye, [aim, 0, 0.3], [0, 0, 1], 96, 72, 45, f"view{i}"))
        Image.fromarray(render(scene.cloud, cameras[-1]).to_uint8()).save(folder / f"images/view{i}.jpg", quality=95)
    told = to_transforms(cameras, [lens or Lens()] * count, [f"images/view{i}.jpg" for i in range(count)])
    (folder / "transforms.json").write_text(json.dumps(told))
    return read_capture(folder)


def test_photographs_are_read_small_and_fit_their_cameras(tmp_path: Path, scene: Scene) -> None:
    capture = write(tmp_path, scene)
    pictures = list(read_photographs(capture, (1, 4), SIDE))
    assert [p.camera.name for p in pictures] == ["view1", "view4"]
    for picture in pictures:
        assert picture.seen is None and picture.rgb.shape == (48, SIDE, 3) and picture.rgb.dtype == np.uint8
        assert (picture.camera.width, picture.camera.height) == (SIDE, 48)
        drawn = render(scene.cloud, picture.camera).to_uint8().astype(int)
        assert np.abs(drawn - picture.rgb).mean() < 6  # of 255: JPEG and another resampling
    (large,) = read_photographs(capture, (0,), 1000)
    assert large.rgb.shape == (72, 96, 3)  # never enlarged


def test_distortion_is_removed(tmp_path: Path, scene: Scene) -> None:
    lens = Lens(k1=-0.3)
    capture = write(tmp_path, scene, lens=lens)
    camera = capture.cameras[0]
    v, u = np.mgrid[: camera.height, : camera.width] + 0.5
    straight = np.stack([127 + 120 * np.sin(u / 4 + c) * np.cos(v / 5) for c in range(3)], axis=-1)
    at_x, at_y = (u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy
    x, y = at_x, at_y
    for _ in range(30):  # the ray that appears at each pixel, by fixed-point iteration
        seen = lens.distort(x, y)
        x, y = x + at_x - seen[0], y + at_y - seen[1]
    rows, columns = y * camera.fy + camera.cy - 0.5, x * camera.fx + camera.cx - 0.5
    photo = np.stack(
        [ndimage.map_coordinates(straight[..., c], [rows, columns], order=1, mode="nearest") for c in range(3)], axis=-1
    )
    Image.fromarray(photo.astype(np.uint8)).save(capture.photos[0], quality=98)
    (picture,) = read_photographs(capture, (0,), 96)
    inner = np.s_[4:-4, 4:-4]  # what the lens bent out of the picture is lost
    assert np.abs(picture.rgb[inner] - straight[inner]).mean() < 8 < 20 < np.abs(photo[inner] - straight[inner]).mean()


def test_photographs_that_show_more_are_chosen(tmp_path: Path, scene: Scene) -> None:
    capture = write(tmp_path, scene, count=8)
    assert choose_photographs(scene, capture, 8) == tuple(range(8))
    some = choose_photographs(scene, capture, 3)
    assert len(some) == 3 and list(some) == sorted(some) and some == choose_photographs(scene, capture, 3)

    def shown(chosen: tuple[int, ...]) -> float:
        return float(np.mean(np.any([contributions(scene.cloud, capture.cameras[i]) > 0.01 for i in chosen], axis=0)))

    assert shown(some) >= max(shown((0, 1, 2)), shown((4, 5, 6)))


def test_photographs_of_another_place_are_refused(tmp_path: Path, scene: Scene) -> None:
    capture = write(tmp_path, scene)
    moved = scene.replace(cloud=scene.cloud.replace(means=scene.cloud.means + 50))
    with pytest.raises(UserError, match="do not show the scene"):
        choose_photographs(moved, capture, 4)


def test_a_truncated_photograph_says_what_to_do(tmp_path: Path, scene: Scene) -> None:
    capture = write(tmp_path, scene)
    photo = tmp_path / "images/view2.jpg"
    photo.write_bytes(photo.read_bytes()[:600])
    with pytest.raises(FileError, match=r"view2\.jpg.*restore the file, or remove its frame from .*transforms\.json"):
        list(read_photographs(capture, (2,), SIDE))
    source = masks.load("pictures", tmp_path)
    with pytest.raises(FileError, match="restore the file"):
        list(source.masks(scene))


def test_renders_cover_the_scene_at_the_size_asked_for(scene: Scene) -> None:
    pictures = list(render_views(scene, SIDE, 4))
    assert 1 <= len(pictures) <= 4 and all(max(p.rgb.shape) == SIDE and p.seen is not None for p in pictures)


# -- the source of masks


def test_masks_of_photographs_follow_the_things_in_them(tmp_path: Path, scene: Scene) -> None:
    write(tmp_path, scene)
    views = list(masks.load("pictures", tmp_path).masks(scene))
    assert [v.camera.name for v in views] == [f"view{i}" for i in range(6)]
    seen = render(scene.cloud, views[0].camera)
    for thing in (0, 2):  # the red box and the blue one
        truth = ((seen.rgb[..., thing] > 2 * seen.rgb[..., 2 - thing]) & (seen.alpha > 0.5)).numpy()
        best = max(
            ((layer == i) & truth).sum() / ((layer == i) | truth).sum()
            for layer in views[0].layers
            for i in np.unique(layer)
        )
        assert best > 0.3  # one face of a box at least
    assert all(v.cells[0].tobytes() == again.cells[0].tobytes() for v, again in zip(
        views, masks.load("pictures", tmp_path).masks(scene), strict=True
    ))  # fmt: skip


def test_missing_photographs_are_said_and_renders_take_their_place(tmp_path: Path, scene: Scene) -> None:
    capture = write(tmp_path, scene)
    (tmp_path / "images/view0.jpg").unlink()
    source = masks.load("pictures", tmp_path)
    assert isinstance(source, Pictures) and "1 of the 6 photographs" in source.notes[0] and "view0" in source.notes[0]
    assert present(capture) == (1, 2, 3, 4, 5) and source.has_photographs
    for path in capture.photos[1:]:
        path.unlink()
    assert not source.has_photographs and "renders are used instead" in source.notes[0]
    assert len(list(source.masks(scene))) >= 1


def test_the_sources_that_a_user_means(tmp_path: Path, scene: Scene) -> None:
    capture = write(tmp_path / "c", scene)
    (tmp_path / "m").mkdir()
    np.savez(tmp_path / "m/view0.npz", ids=np.zeros((72, 96), np.int32))
    folder = f"folder:{tmp_path / 'm'}"
    assert masks.load_all(None) == ((), ()) and masks.load_all("none", capture.path) == ((), ())
    (only,), notes = masks.load_all(None, capture.path)
    assert isinstance(only, Pictures) and not notes
    both, _ = masks.load_all(folder, capture.path)
    assert len(both) == 2 and isinstance(both[1], Pictures)
    assert len(masks.load_all("pictures", capture.path)[0]) == 1
    for path in capture.photos:
        path.unlink()
    (named,), (note,) = masks.load_all(folder, capture.path)
    assert not isinstance(named, Pictures) and "only the masks of folder" in note
    (only,), (note,) = masks.load_all(None, capture.path)
    assert isinstance(only, Pictures) and "renders are used" in note


def test_sources_count_even_if_only_one_gives_vectors(tmp_path: Path, scene: Scene) -> None:
    write(tmp_path, scene)
    encoder = encoders.load("embedded")
    ids = np.zeros((72, 96), np.int32)
    np.savez(tmp_path / "view0.npz", ids=ids, labels=np.array(["box"]), vectors=np.eye(1, encoder.dim))
    sources, _ = masks.load_all(f"folder:{tmp_path}", tmp_path)
    field = embed(scene, encoder, masks=sources).language
    assert field is not None and field.making is not None
    assert [(s.views, s.masks > 0) for s in field.making.masks] == [(1, True), (6, True)]
