"""Sources of masks: `ViewMasks`, files of other programs, and models."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import BackendError, FileError, UserError
from scenewright.gaussians.files.captures.capture import read_capture
from scenewright.gaussians.language import masks
from scenewright.gaussians.language.masks import Masker, ViewMasks, pack_layers
from scenewright.gaussians.language.masks.sources import rle
from scenewright.gaussians.scene import Scene

EMPTY = Scene(GaussianCloud.empty())


def camera(width: int = 8, height: int = 6, name: str = "one") -> Camera:
    return Camera.look_at([0, -3, 1], [0, 0, 0], [0, 0, 1], width, height, name=name)


# -- one view


@st.composite
def overlapping(draw: st.DrawFn) -> NDArray[np.bool_]:
    count, height, width = (draw(st.integers(low, 6)) for low in (0, 1, 1))
    return np.random.default_rng(draw(st.integers(0, 2**31))).random((count, height, width)) < draw(st.floats(0, 1))


@given(overlapping())
def test_packing_loses_no_mask_and_cells_are_where_masks_end(given_masks: NDArray[np.bool_]) -> None:
    count, height, width = given_masks.shape
    view = ViewMasks(camera(width, height), pack_layers(given_masks), ("",) * count, np.ones(count, np.float32))
    for i in range(count):
        assert ((view.layers == i).any(axis=0) == given_masks[i]).all()
    cell, inside = view.cells
    for c in np.unique(cell):
        for i in range(count):
            assert (given_masks[i][cell == c] == (i in inside[c])).all()
    assert view.areas().tolist() == given_masks.sum(axis=(1, 2)).tolist()


@pytest.mark.parametrize(
    ("ids", "labels", "scores", "vectors", "said"),
    [
        (np.zeros((5, 8), np.int32), ("a",), [1.0], None, "do not fit"),
        (np.ones((6, 8), np.int32), ("a",), [1.0], None, "between -1 and 0"),
        (np.full((6, 8), -2, np.int32), ("a",), [1.0], None, "between"),
        (np.zeros((6, 8), np.float32), ("a",), [1.0], None, "must be integers"),
        (np.zeros((6, 8), np.int32), ("a",), [1.0, 2.0], None, "finite scores"),
        (np.zeros((6, 8), np.int32), ("a",), [np.nan], None, "finite scores"),
        (np.zeros((6, 8), np.int32), ("a",), [1.0], np.full((1, 4), np.nan), "finite vectors"),
        (np.zeros((6, 8), np.int32), ("a",), [1.0], np.ones((2, 4)), "rows of finite vectors"),
    ],
)
def test_parts_that_do_not_fit_are_refused(ids: Any, labels: Any, scores: Any, vectors: Any, said: str) -> None:
    with pytest.raises(UserError, match=said):
        ViewMasks(camera(), ids, labels, np.array(scores, np.float32), vectors)


# -- run lengths


@given(st.integers(1, 40), st.integers(1, 40), st.integers(0, 2**31), st.floats(0, 1))
def test_run_lengths_come_back(height: int, width: int, seed: int, share: float) -> None:
    mask = np.random.default_rng(seed).random((height, width)) < share
    told = rle.encode(mask)
    assert (rle.decode(told) == mask).all()
    runs = np.diff(np.concatenate([[0], np.flatnonzero(np.diff(mask.T.ravel())) + 1, [mask.size]])).tolist()
    plain = {"size": told["size"], "counts": [0, *runs] if mask.T.ravel()[0] else runs}
    assert (rle.decode(plain) == mask).all()


@pytest.mark.parametrize(
    ("counts", "size", "runs"),
    [  # worked by hand from the layout: five bits a letter, 32 for more, from the fourth run the change over two
        ("213", [2, 3], [2, 1, 3]),
        ("213W1", [2, 23], [2, 1, 3, 40]),
        ("5:3H", [4, 5], [5, 10, 3, 2]),
    ],
)
def test_compressed_runs_mean_what_the_layout_says(counts: str, size: list[int], runs: list[int]) -> None:
    flat = np.repeat(np.arange(len(runs)) % 2 == 1, runs)
    expected = flat.reshape(size[1], size[0]).T
    assert (rle.decode({"size": size, "counts": counts}) == expected).all()
    assert rle.encode(expected)["counts"] == counts


@pytest.mark.parametrize(
    "told",
    [
        None, {}, [[1, 2, 3, 4]], {"size": [2], "counts": []}, {"size": [0, 4], "counts": []},
        {"size": [2, 3], "counts": [2, 1, 4]}, {"size": [2, 3], "counts": [2, -1, 5]},
        {"size": [2, 3], "counts": "214"}, {"size": [2, 3], "counts": "2\x01"}, {"size": [2, 3], "counts": "2W"},
        {"size": [2, 3], "counts": "2~"},
        {"size": [2, 3], "counts": [2.5, 3.5]},
        {"size": [1 << 20, 1 << 20], "counts": [1 << 40]}, {"size": [2, 3], "counts": "oooooooooooooooooooooo"},
    ],
)  # fmt: skip
def test_runs_that_are_no_mask_are_refused(told: Any) -> None:
    with pytest.raises(ValueError, match=r"mask|counts|size|runs|pixels|run"):
        rle.decode(told)


# -- captures


def write_capture(folder: Path, names: tuple[str, ...] = ("one", "two"), **changes: Any) -> Path:
    frames = []
    for i, name in enumerate(names):
        world = np.linalg.inv(camera().world_to_camera)
        world[:3, 3] += [0.1 * i, 0, 0]
        world[:3, 1:3] *= -1  # OpenCV to OpenGL axes
        frames.append({"file_path": f"images/{name}.JPG", "transform_matrix": world.tolist()})
    told = {"fl_x": 10.0, "fl_y": 11.0, "cx": 8.0, "cy": 6.0, "w": 16, "h": 12, "frames": frames} | changes
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "transforms.json").write_text(json.dumps({k: v for k, v in told.items() if v is not None}))
    return folder / "transforms.json"


def test_a_capture_says_where_photographs_were_taken(tmp_path: Path) -> None:
    capture = read_capture(write_capture(tmp_path).parent)
    first = capture.cameras[0]
    assert np.allclose(first.world_to_camera, camera().world_to_camera, atol=1e-9)
    assert (first.fx, first.fy, first.cx, first.cy, first.width, first.height) == (10, 11, 8, 6, 16, 12)
    assert [c.name for c in capture.cameras] == ["one", "two"]
    assert capture.camera("images/TWO.png") is capture.cameras[1] and capture.camera("three") is None
    angle = read_capture(write_capture(tmp_path, fl_x=None, fl_y=None, cx=None, cy=None, camera_angle_x=np.pi / 2))
    assert angle.cameras[0].fx == pytest.approx(8) and angle.cameras[0].cy == 6


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"frames": []}, "no frames"), ({"w": None}, "has no 'w'"), ({"fl_x": "wide"}, "broken"),
        ({"frames": [{"file_path": "a.jpg", "transform_matrix": [[1, 2], [3, 4]]}]}, "4x4"),
        ({"frames": [{"file_path": "a.jpg", "transform_matrix": np.diag([2, 1, 1, 1]).tolist()}]}, "rotation"),
        ({"frames": [{"transform_matrix": np.eye(4).tolist()}]}, "file_path"),
        ({"frames": 2 * [{"file_path": "a.jpg", "transform_matrix": np.eye(4).tolist()}]}, "two frames"),
    ],
)  # fmt: skip
def test_a_broken_capture_says_what_is_wrong(tmp_path: Path, changes: dict[str, Any], said: str) -> None:
    with pytest.raises(FileError, match=said):
        read_capture(write_capture(tmp_path, **changes))


def test_a_missing_capture_is_a_file_error(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="cannot read"):
        read_capture(tmp_path)
    (tmp_path / "transforms.json").write_text("{")
    with pytest.raises(FileError, match="is not valid JSON"):
        read_capture(tmp_path)


# -- folders


def write_pictures(folder: Path, entries: Any = None, ids: Any = None) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    drawn = np.zeros((6, 8), np.uint8) if ids is None else np.array(ids)
    if ids is None:
        drawn[1:3, 2:5], drawn[4, 6] = 3, 7
    told = [{"id": 7, "label": "cup", "score": 0.5}, {"id": 3, "label": "table", "score": 0.9}]
    Image.fromarray(drawn).save(folder / "one.png")
    (folder / "masks.json").write_text(json.dumps({"one.JPG": told if entries is None else entries}))
    return drawn  # type: ignore[no-any-return]


def test_a_folder_of_pictures_and_labels(tmp_path: Path) -> None:
    write_capture(tmp_path)
    drawn = write_pictures(tmp_path / "masks")
    source = masks.load(f"folder:{tmp_path / 'masks'}")  # the capture is found above it
    assert isinstance(source, Masker)
    said: list[float] = []
    (view,) = source.masks(EMPTY, lambda stage, share: said.append(share))
    assert view.labels == ("cup", "table") and np.allclose(view.scores, [0.5, 0.9]) and said == [1.0]
    assert ((view.ids == 0) == (drawn == 7)).all() and ((view.ids == 1) == (drawn == 3)).all()  # type: ignore[comparison-overlap]
    assert (view.camera.width, view.camera.fx, view.camera.name) == (8, 5.0, "one")  # half of the photograph's size


def test_without_a_capture_the_scenes_own_cameras_serve(tmp_path: Path) -> None:
    write_pictures(tmp_path)
    source = masks.load(f"folder:{tmp_path}")
    with pytest.raises(FileError, match="--capture"):
        list(source.masks(EMPTY))
    (view,) = source.masks(replace(EMPTY, cameras=(camera(16, 12, "ONE.png"),)))
    assert view.camera.width == 8
    with pytest.raises(FileError, match="no camera is called one"):
        list(source.masks(replace(EMPTY, cameras=(camera(16, 12, "two"),))))


def archive(path: Path, **columns: Any) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savez(path, **columns)


def test_archives_hold_masks_or_ids_with_vectors(tmp_path: Path) -> None:
    capture = write_capture(tmp_path)
    both = np.zeros((2, 6, 8), bool)
    both[0, :3], both[1, 2:, 4:] = True, True
    archive(tmp_path / "m/two.npz", masks=both, labels=np.array(["a", "b"]), vectors=np.eye(2, 5) * 7)
    archive(tmp_path / "m/one.npz", ids=np.where(both[0], 1, -1))
    one, two = masks.load(f"folder:{tmp_path / 'm'}", capture).masks(EMPTY)
    assert len(one) == 2 and one.vectors is None and (one.ids == np.where(both[0], 1, -1)).all()
    assert two.labels == ("a", "b") and two.vectors is not None and np.allclose(two.vectors, np.eye(2, 5))
    assert all(((two.layers == i).any(axis=0) == both[i]).all() for i in range(2))


@pytest.mark.parametrize("whole", [True, False], ids=["data set", "results"])
def test_coco_files(tmp_path: Path, whole: bool) -> None:
    write_capture(tmp_path)
    mask = np.zeros((6, 8), bool)
    mask[2:4, 1:6] = True
    entry = {"image_id": 5 if whole else "one.jpg", "category_id": 2, "segmentation": rle.encode(mask), "score": 0.25}
    data: Any = [entry, {**entry, "label": "said"}]
    if whole:
        images = [{"id": 5, "file_name": "x/one.jpg"}, {"id": 6, "file_name": "two.jpg"}]
        data = {"images": images, "categories": [{"id": 2, "name": "cup"}], "annotations": data}
    (tmp_path / "found.json").write_text(json.dumps(data))
    for place in (tmp_path, tmp_path / "found.json"):
        view, *others = masks.load(f"folder:{place}").masks(EMPTY)
        assert view.labels == ("cup" if whole else "", "said") and view.layers.shape == (2, 6, 8)
        assert ((view.layers >= 0) == mask).all() and view.scores[0] == 0.25
        assert [len(v) for v in others] == ([0] if whole else [])  # looked at, and nothing found


@pytest.mark.parametrize(
    ("entries", "ids", "said"),
    [
        ([{"id": 3}], None, "pixel of value 7"), ([{"id": 3}, {"id": 3}], None, "without repeating"),
        ([{"id": 0}], np.zeros((6, 8), np.uint8), "from 1"), ([{"label": "x"}], None, "readable id"),
        ([{"id": 3, "score": "high"}, {"id": 7}], None, "readable id"), (["x"], None, "readable id"),
        ([], np.zeros((6, 12), np.uint8), "do not fit"), ([], np.zeros((6, 8, 3), np.uint8), "one channel"),
    ],
)  # fmt: skip
def test_a_broken_folder_says_what_is_wrong(tmp_path: Path, entries: Any, ids: Any, said: str) -> None:
    write_capture(tmp_path)
    write_pictures(tmp_path / "masks", entries, ids)
    with pytest.raises(FileError, match=said):
        list(masks.load(f"folder:{tmp_path / 'masks'}").masks(EMPTY))


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("masks.json", "{"), ("masks.json", "[1]"), ("masks.json", '{"one.jpg": [{"id": 1}]}'), ("a.json", "3"),
        ("a.json", '[{"score": 1}]'), ("a.json", '{"images": 3}'), ("one.npz", "no archive"), ("notes.txt", "nothing"),
        ("a.json", '[{"image_id": "one", "segmentation": {"size": [6, 8], "counts": [90]}}]'),
        ("a.json", '[{"image_id": "nine", "segmentation": {"size": [6, 8], "counts": [48]}}]'),
    ],
)  # fmt: skip
def test_files_that_are_no_masks_are_file_errors(tmp_path: Path, name: str, text: str) -> None:
    capture = write_capture(tmp_path / "capture")
    (tmp_path / "masks").mkdir()
    (tmp_path / "masks" / name).write_text(text)
    with pytest.raises(FileError):
        list(masks.load(f"folder:{tmp_path / 'masks'}", capture).masks(EMPTY))


@pytest.mark.parametrize("columns", [{"ids": np.ones(3)}, {"masks": np.ones((6, 8))}, {"ids": np.full((6, 8), "x")}])
def test_archives_of_something_else_are_file_errors(tmp_path: Path, columns: dict[str, Any]) -> None:
    archive(tmp_path / "m/one.npz", **columns)
    with pytest.raises(FileError):
        list(masks.load(f"folder:{tmp_path / 'm'}", write_capture(tmp_path)).masks(EMPTY))


def test_unknown_sources_say_which_there_are(tmp_path: Path) -> None:
    for spec, kind in (("magic", BackendError), ("folder:", UserError), ("embedded:x", UserError), ("sam:", UserError)):
        with pytest.raises(kind, match=r"folder:PATH|no argument|name the model"):
            masks.load(spec)
    with pytest.raises(FileError, match="no masks at"):
        masks.load(f"folder:{tmp_path / 'nowhere'}")


# -- models and pictures with depth


def test_patches_of_a_rendered_view_follow_what_is_there(world: type[Any]) -> None:
    made = world().box("red", (-0.8, -0.5, 0), (-0.2, 0.1, 0.6), (0.8, 0.1, 0.1), 0.02)
    made.box("blue", (0.2, -0.5, 0), (0.8, 0.1, 0.6), (0.1, 0.1, 0.8), 0.02)
    cloud = made.cloud()
    truth = torch.from_numpy(made.labels(("red", "blue")).astype(np.int32))
    from scenewright.gaussians.language.masks.sources.embedded import of_view
    from scenewright.gaussians.render import render

    eye = Camera.look_at([0.3, -3, 1.2], [0, 0, 0.3], [0, 0, 1], 120, 90, 35)
    seen = render(cloud.replace(group=truth), eye)
    view = of_view(seen, eye)
    assert 4 <= len(view) <= 8  # two boxes of two or three visible faces each
    for i in range(len(view)):
        own = seen.group.numpy()[view.ids == i]
        assert max(np.bincount(own + 1)) > 0.97 * len(own)  # no patch lies in both; its rim is blended
    assert (view.ids[seen.alpha.numpy() > 0.9] >= 0).mean() > 0.95
    nothing = of_view(render(cloud[:0], eye), eye)
    assert len(nothing) == 0 and (nothing.ids == -1).all()


def test_embedded_masks_come_from_the_views_that_see_the_scene(world: type[Any]) -> None:
    cloud = world().box("red", (-0.8, -0.5, 0), (-0.2, 0.1, 0.6), (0.8, 0.1, 0.1), 0.05).cloud()
    source = masks.load("embedded")
    assert isinstance(source, Masker)
    views = list(source.masks(Scene(cloud)))
    assert views and all(len(v) for v in views) and max(v.camera.width for v in views) == 256


def small_sam(folder: Path) -> None:
    """A tiny Segment Anything with random weights, saved as the real ones are."""
    from scenewright.gaussians.torchvision_fix import import_torchvision

    import_torchvision()
    from transformers import SamConfig, SamImageProcessor, SamModel, SamProcessor, SamVisionConfig

    torch.manual_seed(3)
    eye = SamVisionConfig(
        hidden_size=16, num_hidden_layers=2, num_attention_heads=2, image_size=64, patch_size=16, output_channels=32,
        num_pos_feats=16, mlp_dim=32, global_attn_indexes=[1], window_size=2,
    )  # fmt: skip
    config = SamConfig(
        vision_config=eye.to_dict(),
        prompt_encoder_config={"hidden_size": 32, "image_size": 64, "patch_size": 16, "mask_input_channels": 4},
        mask_decoder_config={
            "hidden_size": 32, "num_attention_heads": 2, "mlp_dim": 32, "num_hidden_layers": 2,
            "iou_head_hidden_dim": 32,
        },
    )  # fmt: skip
    model = SamModel(config)
    with torch.no_grad():  # random weights answer next to nothing everywhere; louder ones draw blobs
        for mlp in model.mask_decoder.output_hypernetworks_mlps:
            mlp.proj_out.weight.mul_(2e5)
    model.save_pretrained(folder)
    sides = {"height": 64, "width": 64}
    SamProcessor(
        SamImageProcessor(
            size={"longest_edge": 64}, pad_size=sides, mask_size={"longest_edge": 16},
            mask_pad_size={"height": 16, "width": 16},
        )
    ).save_pretrained(folder)  # fmt: skip


def test_a_segment_anything_model_gives_masks_of_photographs(tmp_path: Path) -> None:
    pytest.importorskip("transformers")
    small_sam(tmp_path / "sam")
    capture = write_capture(tmp_path, w=64, h=48, cx=32.0, cy=24.0)
    (tmp_path / "images").mkdir()
    for i, name in enumerate(("one", "two")):
        noise = np.random.default_rng(i).integers(0, 255, (48, 64, 3), dtype=np.uint8)
        Image.fromarray(noise).save(tmp_path / "images" / f"{name}.JPG")
    source = masks.load(f"sam:{tmp_path / 'sam'}", capture)
    assert isinstance(source, Masker)
    loose = replace(source, points_per_side=3, pred_iou_thresh=-1.0, stability_thresh=0.0)  # type: ignore[type-var]  # random weights are sure of nothing
    views, again = list(loose.masks(EMPTY)), list(loose.masks(EMPTY))
    assert [v.camera.name for v in views] == ["one", "two"] and sum(len(v) for v in views) > 0
    assert [v.ids.tobytes() for v in views] == [v.ids.tobytes() for v in again]
    for view in views:
        assert (np.diff(view.scores) <= 0).all() and set(view.labels) <= {""}
    strict = replace(source, points_per_side=3, pred_iou_thresh=1.1)  # type: ignore[type-var]
    assert all(len(v) == 0 for v in strict.masks(EMPTY))
    (tmp_path / "images/one.JPG").unlink()
    with pytest.raises(FileError, match="cannot read the photograph"):
        list(loose.masks(EMPTY))


def test_a_model_that_is_not_there_is_a_back_end_error(tmp_path: Path) -> None:
    pytest.importorskip("transformers")
    with pytest.raises(BackendError, match=r"cannot load the SAM .*; give sam:PATH"):
        masks.load(f"sam:{tmp_path}")
    with pytest.raises(BackendError, match="there is no model at"):  # and no name to be looked up
        masks.load(f"sam:{tmp_path / 'none'}")
