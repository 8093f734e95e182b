"""What methods do with a choice: pictures of masks, lengths of trainings."""

from __future__ import annotations

import pytest
import torch

from scenewright.benchmarks._fits import small_photos
from scenewright.gaussians import assets
from scenewright.gaussians.effort import Dial, Method
from scenewright.gaussians.effort import dial as module
from scenewright.gaussians.fit import Settings, fit
from scenewright.gaussians.language.field import embed
from scenewright.gaussians.language.masks.sources.pictures import Pictures
from scenewright.gaussians.scene import Scene


@pytest.fixture(autouse=True)
def _without_calibration(monkeypatch: pytest.MonkeyPatch, tmp_path: object) -> None:
    monkeypatch.setenv("SCENEWRIGHT_EFFORT", f"{tmp_path}/effort.json")


@pytest.mark.parametrize(("opacity", "word", "count"), [(0.3, "fast", 0), (0.3, "accurate", 32), (None, "accurate", 0)])
def test_fitted_scenes_get_masks_where_they_were_measured_to_help(opacity: float | None, word: str, count: int) -> None:
    cloud = assets.make("stool", 0).cloud
    scene = Scene(cloud if opacity is None else cloud.replace(opacities=torch.full((len(cloud),), opacity)))
    found = embed._dialled(scene, Dial(word), None, None, 0.0)
    assert (found.count if isinstance(found, Pictures) else 0) == count


def test_masks_of_the_caller_win() -> None:
    dial, own = Dial("accurate"), Pictures.__new__(Pictures)
    assert embed._dialled(Scene(assets.make("stool", 0).cloud), dial, own, None, 0.0) is own
    assert dial.overruled == ["masks"] and not dial.choices


@pytest.mark.slow
def test_a_training_takes_the_clock_of_its_point(monkeypatch: pytest.MonkeyPatch) -> None:
    every = ["fast", "balanced", "accurate"]
    point = {"setting": "", "settings": {}, "fixed": 0, "per": 0, "clock": 0.2, "accuracy": 20, "names": every}
    told = {"unit": "dB", "sized_by": "pixels", "size": 1, "scene": "a room", "revision": "abc", "points": [point]}
    monkeypatch.setattr(module, "method", lambda name: Method.of(name, told))
    dial = Dial("fast")
    done = fit(small_photos(), Settings(steps=10**6, max_gaussians=300, degree=0, gain=None), effort=dial)
    assert done.steps < 10**6 and [c.clock for c in dial.choices] == [0.2]
