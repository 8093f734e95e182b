"""Models that inpaint pictures, built on the spot: what they are given, what is made of what they return."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

from scenewright.agent.session.picture_models import infill_of
from scenewright.gaussians.errors import BackendError
from scenewright.tools.lifting.inpainters import Inpainter, Shot, checked, load, names
from scenewright.tools.lifting.inpainters.sizes import Fitted

Build = Callable[..., Path]
RGB = np.float32([0.2, 0.6, 0.4])


def shot(height: int = 40, width: int = 56) -> Shot:
    y, x = np.mgrid[0:height, 0:width].astype(np.float32)
    rgb = np.stack([x / width, y / height, 0.5 + 0 * x], axis=2).astype(np.float32)
    mask = np.zeros((height, width), bool)
    mask[10:25, 20:40] = True
    return Shot("view_00", rgb, mask)


@pytest.fixture
def network(tmp_path: Path) -> Build:
    """A network that paints the hole in one colour: picture * (1 - mask) + colour * mask, times a factor."""
    onnx = pytest.importorskip("onnx")
    helper, kinds = onnx.helper, onnx.TensorProto

    def build(
        size: Any = ("h", "w"), factor: float = 1.0, color: Any = RGB, stacked: bool = False, last: bool = False
    ) -> Path:
        def constant(name: str, value: Any) -> Any:
            return onnx.numpy_helper.from_array(np.float32(value), name)

        inputs = [helper.make_tensor_value_info("a_picture", kinds.FLOAT, [1, 3, *size]),
                  helper.make_tensor_value_info("the_mask", kinds.FLOAT, [1, 1, *size])]  # fmt: skip
        nodes = []
        if stacked:
            inputs = [helper.make_tensor_value_info("both", kinds.FLOAT, [1, 4, *size])]
            nodes.append(helper.make_node("Split", ["both", "parts"], ["a_picture", "the_mask"], axis=1))
        nodes += [
            helper.make_node("Sub", ["one", "the_mask"], ["outside"]),
            helper.make_node("Mul", ["a_picture", "outside"], ["kept"]),
            helper.make_node("Mul", ["the_mask", "color"], ["painted"]),
            helper.make_node("Add", ["kept", "painted"], ["sum"]),
            helper.make_node("Mul", ["sum", "factor"], ["scaled"]),
            helper.make_node("Transpose", ["scaled"], ["out"], perm=[0, 2, 3, 1] if last else [0, 1, 2, 3]),
        ]
        values = [constant("one", 1), constant("factor", factor), constant("color", np.reshape(color, (1, 3, 1, 1)))]
        values.append(onnx.numpy_helper.from_array(np.int64([3, 1]), "parts"))
        out = helper.make_tensor_value_info("out", kinds.FLOAT, None)
        graph = helper.make_graph(nodes, "painter", inputs, [out], values if stacked else values[:3])
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)])
        model.ir_version = 9
        path = tmp_path / f"painter{len(list(tmp_path.iterdir()))}.onnx"
        onnx.save(model, path)
        return path

    return build


@pytest.mark.parametrize("size", [("h", "w"), (64, 64), (32, 96)])
@pytest.mark.parametrize("factor", [1.0, 255.0])
def test_a_network_is_given_what_it_wants(network: Build, size: Any, factor: float) -> None:
    """Of any size or of one; values up to 1 or 255."""
    model, given = load(f"onnx:{network(size, factor)}"), shot()
    assert isinstance(model, Inpainter)
    found = model.fill(given)
    assert found.shape == given.rgb.shape and found.dtype == np.float32
    assert np.array_equal(found[~given.mask], given.rgb[~given.mask])
    inside = np.zeros_like(given.mask)
    inside[13:22, 23:37] = True  # resampled masks have soft borders
    assert np.abs(found[inside] - RGB).max() < 0.02
    assert np.array_equal(found, model.fill(given))


def test_a_network_may_take_one_input_or_return_channels_last(network: Build) -> None:
    given = shot()
    expected = np.where(given.mask[..., None], RGB, given.rgb)
    for path in (network(stacked=True), network(last=True)):
        assert np.abs(load(f"onnx:{path}").fill(given) - expected).max() < 1e-5


def test_a_network_never_sees_what_was_in_the_hole(network: Build) -> None:
    given = shot()
    model = load(f"onnx:{network(color=[0, 0, 0])}")
    assert float(model.fill(given)[given.mask].max()) == 0


@pytest.mark.parametrize(
    ("factor", "color", "said"),
    [
        (np.nan, RGB, "not numbers"),
        (-1.0, RGB, "values from"),
        (400.0, [3.0, 3.0, 3.0], "values from"),
        (1.0, [1.8, 0.1, 0.1], "values from"),
        (0.0, RGB, "another picture"),
    ],
)
def test_hostile_networks_are_named(network: Build, factor: float, color: Any, said: str) -> None:
    with pytest.raises(BackendError, match=said):
        load(f"onnx:{network(factor=factor, color=color)}").fill(shot())


def test_what_is_no_network_is_refused(tmp_path: Path) -> None:
    onnx = pytest.importorskip("onnx")
    helper = onnx.helper
    with pytest.raises(BackendError, match="there is no file"):
        load(f"onnx:{tmp_path / 'none.onnx'}")
    (tmp_path / "text.onnx").write_text("hello")
    with pytest.raises(BackendError, match="not a usable ONNX model"):
        load(f"onnx:{tmp_path / 'text.onnx'}")
    a = helper.make_tensor_value_info("tokens", onnx.TensorProto.INT64, [1, 77])
    b = helper.make_tensor_value_info("out", onnx.TensorProto.INT64, [1, 77])
    graph = helper.make_graph([helper.make_node("Identity", ["tokens"], ["out"])], "g", [a], [b])
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)])
    model.ir_version = 9
    onnx.save(model, tmp_path / "tokens.onnx")
    with pytest.raises(BackendError, match=r"no inpainting network: it takes tokens \[1, 77\]"):
        load(f"onnx:{tmp_path / 'tokens.onnx'}")


def test_pictures_are_checked() -> None:
    given = shot()
    with pytest.raises(BackendError, match=r"returned \[40, 55, 3\]"):
        checked(given.rgb[:, :-1], given, "it")
    with pytest.raises(BackendError, match="no inpainting model"):
        checked(np.full(given.rgb.shape, "x"), given, "it")
    found = checked((given.rgb * 255).astype(np.uint8), given, "it")
    assert np.abs(found - given.rgb).max() < 1 / 255 and found.dtype == np.float32


@pytest.mark.parametrize("wanted", [(None, None), (64, 64), (128, 32)])
def test_sizes_there_and_back(wanted: Any) -> None:
    given = shot(37, 53)
    fitted = Fitted.to((37, 53), wanted)
    there = fitted.picture(given.rgb)
    assert there.shape[:2] == fitted.taken == fitted.mask(given.mask).shape
    assert fitted.taken == (wanted if wanted[0] else (40, 56))
    assert np.abs(fitted.back(there) - given.rgb)[2:-2, 2:-2].mean() < (1e-6 if wanted[0] is None else 0.03)
    height, width = fitted.padded
    assert abs(height / width - fitted.taken[0] / fitted.taken[1]) < 0.05  # nothing is stretched


def _fake_diffusers(monkeypatch: pytest.MonkeyPatch, paint: Callable[[dict[str, Any]], Any]) -> list[dict[str, Any]]:
    calls: list[dict[str, Any]] = []

    class Pipeline:
        @classmethod
        def from_pretrained(cls, folder: str, local_files_only: bool, use_safetensors: bool) -> Pipeline:
            assert local_files_only and use_safetensors and Path(folder).is_dir()
            return cls()

        def to(self, device: str) -> Pipeline:
            return self

        def set_progress_bar_config(self, disable: bool) -> None:
            assert disable

        def __call__(self, **asked: Any) -> Any:
            calls.append(asked)
            return SimpleNamespace(images=[paint(asked)])

    monkeypatch.setitem(sys.modules, "diffusers", SimpleNamespace(AutoPipelineForInpainting=Pipeline))
    return calls


def _paint(asked: dict[str, Any]) -> Any:
    """A pipeline that draws one random colour into the hole."""
    rgb = np.asarray(asked["image"]).copy()
    rgb[np.asarray(asked["mask_image"]) > 0] = asked["generator"].initial_seed() % 255
    return Image.fromarray(rgb)


def _pipeline_folder(tmp_path: Path) -> Path:
    (tmp_path / "model_index.json").write_text("{}")
    return tmp_path


def test_a_pipeline_of_diffusers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = _fake_diffusers(monkeypatch, _paint)
    model, given = load(f"diffusers:{_pipeline_folder(tmp_path)}"), shot()
    found = model.fill(given, seed=51)
    asked = calls[0]
    assert asked["height"] % 64 == asked["width"] % 64 == 0 and asked["image"].size == (asked["width"], asked["height"])
    assert found.shape == given.rgb.shape
    assert np.abs(found[13:22, 23:37] - 51 / 255).max() < 0.02
    assert np.array_equal(found[~given.mask], given.rgb[~given.mask])
    assert not np.array_equal(found, model.fill(given, seed=90))


@pytest.mark.parametrize(
    ("paint", "said"),
    [
        (lambda asked: Image.new("RGB", (8, 8)), "no inpainting model"),
        (lambda asked: np.full((asked["height"], asked["width"], 3), np.nan), "not numbers"),
        (lambda asked: 1 / 0, "failed: division by zero"),
    ],
)
def test_hostile_pipelines_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, paint: Any, said: str) -> None:
    _fake_diffusers(monkeypatch, paint)
    with pytest.raises(BackendError, match=said):
        load(f"diffusers:{_pipeline_folder(tmp_path)}").fill(shot())


def test_diffusers_is_optional(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(BackendError, match=r"it has no model_index\.json"):
        load(f"diffusers:{tmp_path}")
    monkeypatch.setitem(sys.modules, "diffusers", None)
    with pytest.raises(BackendError, match=r"scenewright\[diffusion\]"):
        load(f"diffusers:{_pipeline_folder(tmp_path)}")


@pytest.mark.parametrize("index", ['{"_class_name": ["code", "Pipeline"]}', "{}", "no JSON"])
def test_a_folder_with_a_program_in_it_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, index: str) -> None:
    """diffusers imports the modules that an index names."""
    _fake_diffusers(monkeypatch, _paint)
    (tmp_path / "unet").mkdir()
    if index == "{}":
        (tmp_path / "unet" / "code.py").write_text("1 / 0")
    (tmp_path / "model_index.json").write_text(index)
    with pytest.raises(BackendError, match=r"not run|cannot read"):
        load(f"diffusers:{tmp_path}")


def test_a_folder_is_written_first_and_read_then(tmp_path: Path) -> None:
    given = shot()
    with pytest.raises(BackendError, match="1 of 1 views wait to be inpainted"):
        load(f"folder:{tmp_path / 'views'}").prepare([given])
    edit = next((tmp_path / "views").iterdir())
    picture, mask = (np.asarray(Image.open(edit / sub / "view_00.png")) for sub in ("pictures", "masks"))
    assert np.abs(picture / 255 - given.rgb).max() < 1 / 255
    assert np.array_equal(mask, np.where(given.mask, 255, 0))
    painted = picture.copy()
    painted[mask > 0] = 77
    Image.fromarray(painted).save(edit / "filled" / "view_00.png")
    again = load(f"folder:{tmp_path / 'views'}")
    again.prepare([given])
    assert np.abs(again.fill(given)[given.mask] - 77 / 255).max() < 1e-6
    other = Shot(given.name, given.rgb * np.float32(0.5), given.mask)  # of another edit: its views are written too
    with pytest.raises(BackendError, match="wait to be inpainted"):
        again.prepare([other])
    assert len(list((tmp_path / "views").iterdir())) == 2


def test_hostile_folders_are_named(tmp_path: Path) -> None:
    given, model = shot(), load(f"folder:{tmp_path}")
    with pytest.raises(BackendError):
        model.prepare([given])
    path = next(tmp_path.iterdir()) / "filled" / "view_00.png"
    Image.new("RGB", (20, 20)).save(path)
    model.prepare([given])
    with pytest.raises(BackendError, match="must be 56x40 pixels"):
        model.fill(given)
    path.write_text("no picture")
    with pytest.raises(BackendError, match=r"view_00\.png"):
        model.fill(given)
    Image.new("RGB", (56, 40), "white").save(path)
    with pytest.raises(BackendError, match="another picture"):
        model.fill(given)
    (tmp_path / "file").write_text("")
    with pytest.raises(BackendError, match="is a file"):
        load(f"folder:{tmp_path / 'file'}")


def test_how_infill_is_said(tmp_path: Path) -> None:
    assert infill_of(True) == infill_of("scene") == (True, None)
    assert infill_of(False) == infill_of("none") == (False, None)
    fills, model = infill_of(f"folder:{tmp_path}")
    assert fills and isinstance(model, Inpainter) and infill_of(model) == (True, model)
    for wrong in ("lama", "onnx", "onnx:", "torch:x"):
        with pytest.raises(BackendError, match="use scene, none, onnx:FILE, diffusers:FOLDER or folder:FOLDER"):
            infill_of(wrong)
    assert set(names()) == {"onnx", "diffusers", "folder"}
