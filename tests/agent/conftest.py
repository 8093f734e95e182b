"""A small scene with a hand-made language field: a red box left, a green one in the middle, a red one right."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from scenewright.agent import doctor
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.color import rgb_to_lab
from scenewright.gaussians.files import save
from scenewright.gaussians.language import encoders
from scenewright.gaussians.language.encoders.vocabulary import Vocabulary
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.field.store import save_field
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.world.box import Box

_AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
_BOXES = (  # colour in display space, centre, side, label
    ((0.85, 0.05, 0.05), (-2.0, 0.0, 0.4), 0.8, "box"),
    ((0.05, 0.6, 0.1), (0.0, 0.3, 0.3), 0.6, "box"),
    ((0.85, 0.05, 0.05), (2.0, 0.0, 0.5), 1.0, "box"),
)
_FLOOR = ((0.5, 0.5, 0.5), (0.0, 0.0, 0.0), 8.0, "floor")


class NamesOnly:
    """The part of an encoder that a scene asked by colour needs: a fingerprint, and a vector for a name."""

    fingerprint = "test:1"

    def knows(self, text: str) -> bool:
        return bool(text)

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        return np.tile(np.float32([1, 0]), (len(texts), 1))


class KnowsNoGizmo(NamesOnly):
    """An encoder that does not know the word "gizmo", so that a gizmo can only be chosen by its colour."""

    dim = 2
    vocabulary = Vocabulary({"lamp": ()}, {}, ())
    calibration = SimpleNamespace(threshold=0.5)

    def unknown_words(self, text: str) -> tuple[str, ...]:
        return tuple(word for word in text.split() if word == "gizmo")


def _points(center: tuple[float, float, float], side: float, level: bool) -> torch.Tensor:
    steps = torch.linspace(-side / 2, side / 2, 12 if level else 7)
    grid = torch.cartesian_prod(steps, steps, torch.zeros(1) if level else steps)
    return grid + torch.tensor(center)


@pytest.fixture
def boxes() -> Scene:
    clouds, groups = [], []
    for i, (rgb, center, side, label) in enumerate((*_BOXES, _FLOOR)):
        means = _points(center, side, level=label == "floor")
        n = len(means)
        dc = (torch.tensor(rgb) - 0.5) / 0.28209479
        clouds.append((means, dc.expand(n, 1, 3), torch.full((n,), i, dtype=torch.int32), side))
        lab = tuple(float(c) for c in rgb_to_lab(torch.tensor(rgb)))
        size = (side, side, 0.01 if label == "floor" else side)
        level = "structure" if label == "floor" else "object"
        groups.append(Group(i, level, -1, label, 0.9, Box(center, _AXES, size), lab, n, 4, 1.0))  # type: ignore[arg-type]
    means = torch.cat([c[0] for c in clouds])
    cloud = GaussianCloud.create(
        means,
        torch.tensor([1.0, 0, 0, 0]).expand(len(means), 4).contiguous(),
        torch.cat([torch.full((len(c[0]), 3), 0.12 if c[3] < 4 else 0.4) for c in clouds]),
        torch.full((len(means),), 0.95),
        torch.cat([c[1] for c in clouds]).contiguous(),
        torch.cat([c[2] for c in clouds]),
    )
    field = LanguageField(tuple(groups), np.zeros((len(groups), 2), np.float32), NamesOnly.fingerprint)
    camera = Camera.look_at([0, -8, 2.5], [0, 0, 0.4], [0, 0, 1], 96, 64, 50, "door")
    frame = Frame((0, 0, 1), 0.0, 1.0, "given", "given")
    return Scene(cloud, frame, (camera,), field)


@pytest.fixture(scope="session")
def findings() -> tuple[doctor.Finding, ...]:
    """What the doctor finds on this machine. It imports torchvision in another process, which takes seconds."""
    return tuple(doctor.examine())


@pytest.fixture
def torchvision_examined(findings: tuple[doctor.Finding, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    """Lets further examinations take what was found of torchvision from the first one."""
    found = next(finding for finding in findings if finding.name == "torchvision")
    monkeypatch.setattr(doctor, "_torchvision", lambda: found)


@pytest.fixture
def encoder() -> NamesOnly:
    return NamesOnly()


@pytest.fixture
def unsure(boxes: Scene) -> Scene:
    """The boxes with names of which nobody is sure, so that one of them may be a gizmo."""
    assert boxes.language is not None
    groups = tuple(replace(g, label_score=0.3 if g.level == "object" else 1.0) for g in boxes.language.groups)
    return boxes.replace(language=replace(boxes.language, groups=groups))


@pytest.fixture
def gizmo_encoder() -> KnowsNoGizmo:
    return KnowsNoGizmo()


@pytest.fixture
def gizmo_room(unsure: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The unsure boxes in a file with a saved field, and an encoder that fits it."""
    monkeypatch.setattr(encoders, "load", lambda spec="auto": KnowsNoGizmo())
    save(unsure, tmp_path / "gizmos.ply")
    save_field(unsure, tmp_path / "gizmos.ply")
    return tmp_path / "gizmos.ply"


@pytest.fixture
def room(boxes: Scene, encoder: NamesOnly, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The boxes in a file with a saved field, and an encoder that fits it."""
    monkeypatch.setattr(encoders, "load", lambda spec="auto": encoder)
    save(boxes, tmp_path / "boxes.ply")
    save_field(boxes, tmp_path / "boxes.ply")
    return tmp_path / "boxes.ply"
