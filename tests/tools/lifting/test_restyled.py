"""A model paints views of a restyled thing; its colours follow, and nothing else changes."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch
from PIL import Image

from scenewright.gaussians.errors import BackendError
from scenewright.gaussians.harmonics import dc_to_color
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.selection import Selection
from scenewright.tools.completing import completed
from scenewright.tools.execute import carry_out
from scenewright.tools.lifting.inpainters import F32, Shot
from scenewright.tools.lifting.restyled import STRENGTHS, restyled
from scenewright.tools.lifting.restylers import Restyler, load
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse

from .conftest import BOX, Room

GREEN = np.float32([0.1, 0.7, 0.2])


@dataclass
class Painter:
    """Mixes a colour into the whole picture, as far as it may."""

    name: str = "painter"
    asked: list[tuple[str, float]] = field(default_factory=list)

    def restyle(self, shot: Shot, prompt: str, strength: float, seed: int = 0) -> F32:
        self.asked.append((prompt, strength))
        return np.asarray(shot.rgb + np.float32(strength) * (GREEN - shot.rgb), np.float32)


class Failing(Painter):
    def restyle(self, shot: Shot, prompt: str, strength: float, seed: int = 0) -> F32:
        if self.asked:
            raise BackendError("out of memory")
        return super().restyle(shot, prompt, strength, seed)


def _box(room: Room) -> torch.Tensor:
    return room.fitted.cloud.ids[room.fitted.cloud.group == BOX]


@pytest.mark.slow
def test_colours_follow_the_model_and_nothing_else_changes(room: Room) -> None:
    painter = Painter()
    assert isinstance(painter, Restyler)
    scene, told = restyled(room.fitted, _box(room), "a green box", painter)
    was, now, own = room.fitted.cloud, scene.cloud, room.fitted.cloud.group == BOX
    for name, column in was.columns():
        other = getattr(now, name)
        assert torch.equal(column[~own], other[~own])
        assert name == "sh" or torch.equal(column, other)
    views = told.views
    assert views >= 3 and len(painter.asked) == views * len(STRENGTHS)
    assert {p for p, _ in painter.asked} == {"a green box"} and [s for _, s in painter.asked[::views]] == list(
        STRENGTHS
    )
    seen = (was.sh != now.sh).flatten(1).any(dim=1) & own
    left = np.prod([1 - s for s in STRENGTHS])  # of the way to green, had the colours followed wholly
    before, after = (np.abs(dc_to_color(c.sh[seen, 0]).numpy() - GREEN).mean() for c in (was, now))
    assert seen.sum() > 0.3 * own.sum() and left * before * 0.5 < after < 0.45 * before
    again, _ = restyled(room.fitted, _box(room), "a green box", Painter())
    assert torch.equal(again.cloud.sh, now.sh)


def test_a_model_that_fails_leaves_the_material(room: Room) -> None:
    scene, told = restyled(room.fitted, _box(room), "a green box", Failing())
    assert scene is room.fitted and told.reason == "out of memory"


@pytest.mark.slow
def test_restyle_is_completed_by_the_model(room: Room) -> None:
    """The whole way: the box becomes leather, and the model paints it."""
    scene, painter = room.fitted, Painter()
    target = Selection(Query(), "found", _box(room), (BOX,))
    op = parse({"op": "restyle", "target": {"groups": [BOX], "text": "box"}, "material": "leather", "color": "green"})
    context = Context(viewer=scene.cameras[0], restyler=painter)
    done = completed(scene, op, context, carry_out(scene, op, context, target, seen=False))
    assert painter.asked[0][0] == "a photograph of the box, green leather"
    assert done.receipt.lifted[0].views > 0 and "painter painted" in done.receipt.notes[-1]
    old = int((scene.cloud.group != BOX).sum())
    assert torch.equal(done.scene.cloud.sh[:old], scene.cloud.sh[:old])


def test_nothing_to_paint(room: Room) -> None:
    scene, told = restyled(room.fitted, torch.zeros(0, dtype=torch.int64), "nothing", Painter())
    assert scene is room.fitted and told.reason == "no view shows it"


def test_a_pipeline_of_diffusers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[dict[str, Any]] = []

    class Pipeline:
        from_pretrained = classmethod(lambda cls, folder, local_files_only, use_safetensors: cls())
        to = staticmethod(lambda device: Pipeline())
        set_progress_bar_config = staticmethod(lambda disable: None)

        def __call__(self, **asked: Any) -> Any:
            calls.append(asked)
            return SimpleNamespace(images=[Image.new("RGB", asked["image"].size, (10, 200, 30))])

    monkeypatch.setitem(sys.modules, "diffusers", SimpleNamespace(AutoPipelineForImage2Image=Pipeline))
    with pytest.raises(BackendError, match="use diffusers:FOLDER"):
        load("onnx:x")
    with pytest.raises(BackendError, match=r"no model_index\.json"):
        load(f"diffusers:{tmp_path}")
    (tmp_path / "model_index.json").write_text("{}")
    shot = Shot("view_00", np.full((40, 60, 3), 0.5, np.float32), np.ones((40, 60), bool))
    found = load(f"diffusers:{tmp_path}").restyle(shot, "marble", 0.4, 3)
    assert calls[0]["prompt"] == "marble" and calls[0]["strength"] == 0.4
    assert np.abs(found - np.float32([10, 200, 30]) / 255).max() < 0.01 and found.shape == (40, 60, 3)
