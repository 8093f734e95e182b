"""The shipped contour network: its interface, that depth may be absent, borders of things against edges of texture."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from scenewright.gaussians import assets
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import concat
from scenewright.gaussians.language import masks
from scenewright.gaussians.render import render

FILE = Path(masks.__file__).parent / "weights" / "contours.onnx"
F32 = NDArray[np.float32]


@pytest.fixture(scope="module")
def session() -> Any:
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = 1
    return onnxruntime.InferenceSession(str(FILE), options, providers=["CPUExecutionProvider"])


def contours(session: Any, rgb: F32) -> F32:
    """Contours `[H, W]` of a picture `[H, W, 3]` without depth."""
    channels = np.concatenate([rgb.transpose(2, 0, 1), np.zeros((5, *rgb.shape[:2]), np.float32)])
    result: F32 = session.run(None, {"picture": channels[None].astype(np.float32)})[0][0, 0]
    return result


def test_the_interface(session: Any) -> None:
    (given,), (back,) = session.get_inputs(), session.get_outputs()
    assert (given.name, given.type, given.shape[:2]) == ("picture", "tensor(float)", [1, 8])
    assert (back.name, back.type, back.shape[:2]) == ("contour", "tensor(float)", [1, 1])
    assert FILE.stat().st_size <= 8_000_000


@pytest.mark.parametrize("size", [(16, 16), (48, 80), (304, 400)])
def test_any_size_gives_probabilities_of_that_size_and_the_same_ones_again(session: Any, size: tuple[int, int]) -> None:
    picture = np.random.default_rng(0).random((1, 8, *size)).astype(np.float32)
    one, two = (session.run(None, {"picture": picture})[0] for _ in range(2))
    assert one.shape == (1, 1, *size)
    assert np.isfinite(one).all() and one.min() >= 0 and one.max() <= 1
    assert (one == two).all()


def pair() -> tuple[F32, NDArray[np.int32]]:
    """A picture `[H, W, 3]` of a chair and a bin side by side, and the number of the thing in each pixel."""
    chair, bin_ = assets.make("chair", 3).cloud, assets.make("bin", 5).cloud
    bin_ = bin_.replace(means=bin_.means + torch.tensor([0.42, -0.1, 0.0]))
    bin_ = bin_.replace(ids=bin_.ids + len(chair))
    both = concat([c.replace(group=torch.full((len(c),), n, dtype=torch.int32)) for n, c in enumerate((chair, bin_))])
    camera = Camera.look_at((0.4, -2.0, 1.1), (0.2, 0.0, 0.35), (0, 0, 1), 320, 240, 40.0)
    seen = render(both, camera, background=(0.62, 0.6, 0.57))
    things = np.where(seen.alpha.numpy() > 0.5, seen.group.numpy(), -1)
    return seen.rgb.clamp(0, 1).numpy(), things.astype(np.int32)


def test_borders_of_things_stand_out_from_what_is_inside_and_outside(session: Any) -> None:
    rgb, things = pair()
    strength = contours(session, rgb)
    border = np.zeros(things.shape, bool)
    border[:, :-1] |= things[:, 1:] != things[:, :-1]
    border[:-1] |= things[1:] != things[:-1]
    from scipy.ndimage import distance_transform_edt, maximum_filter

    away = distance_transform_edt(~border)
    assert np.median(maximum_filter(strength, 3)[border]) > 0.5
    assert strength[away > 5].mean() < 0.08
    assert (strength[away > 5] > 0.5).mean() < 0.06


@pytest.mark.parametrize("pattern", ["plain", "stripes", "checks", "noise"])
def test_a_textured_wall_gets_little(session: Any, pattern: str) -> None:
    y, x = np.mgrid[:240, :320]
    value = {
        "plain": np.zeros((240, 320)),
        "stripes": np.where(x // 12 % 2, 0.12, 0.0),
        "checks": np.where((x // 16 + y // 16) % 2, 0.12, 0.0),
        "noise": 0.06 * np.random.default_rng(0).normal(size=(240, 320)),
    }[pattern]
    wall = np.clip(np.array([0.7, 0.66, 0.6]) * (0.85 + value + 0.1 * x / 320)[..., None], 0, 1).astype(np.float32)
    strength = contours(session, wall)[8:-8, 8:-8]
    assert strength.mean() < 0.05
    assert (strength > 0.5).mean() < 0.02


def test_the_card_tells_what_it_was_trained_on() -> None:
    card = json.loads(FILE.with_suffix(".json").read_text("utf-8"))
    assert card["bytes"] == FILE.stat().st_size
    assert card["steps"] > 0 and card["pictures"] > 0
    assert all(pack["licence"].startswith("CC0") for pack in card["objects"]["packs"].values())
    for name in ("held_out", "held_out_with_depth"):
        assert card["figures"][name]["network"]["f_best"] > card["figures"][name]["color_gradient"]["f_best"]
