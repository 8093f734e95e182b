"""Three balls of one colour each with a language field, and a ring of cameras around them."""

from __future__ import annotations

import math

import numpy as np
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.world.box import Box

SIZE = 48
BALLS = 3
RING = [
    Camera.look_at((4 * math.cos(a), 4 * math.sin(a), 0.6 + 1.5 * (i % 3)), (0, 0.3, 0.5), (0, 0, 1), SIZE, SIZE)
    for i, a in enumerate(np.arange(12) * math.pi / 6)
]


def balls(count: int = 1500, degree: int = 0, seed: int = 0) -> Scene:
    """Three balls of one colour each, with hidden Gaussians inside, in three groups, and some without a group."""
    g = torch.Generator().manual_seed(seed)
    ball = torch.randint(0, BALLS, (count,), generator=g)
    way = torch.nn.functional.normalize(torch.randn(count, 3, generator=g), dim=1)
    radius = torch.where(torch.rand(count, generator=g) < 0.6, 0.5, 0.3 * torch.rand(count, generator=g))
    centers = torch.tensor([[-1.2, 0.0, 0.5], [0.0, 0.9, 0.5], [1.2, 0.0, 0.5]])
    sh = torch.zeros(count, (degree + 1) ** 2, 3)
    sh[:, 0] = torch.tensor([[1.5, -1, -1], [-1, 1.5, -1], [-1, -1, 1.5]])[ball]
    sh[:, 0] += 0.1 * torch.randn(count, 3, generator=g)
    sh[:, 1:] = 0.05 * torch.randn(count, sh.shape[1] - 1, 3, generator=g)
    cloud = GaussianCloud.create(
        centers[ball] + radius[:, None] * way, torch.nn.functional.normalize(torch.randn(count, 4, generator=g)),
        0.03 + 0.04 * torch.rand(count, 3, generator=g), 0.3 + 0.65 * torch.rand(count, generator=g), sh,
        torch.where(torch.rand(count, generator=g) < 0.05, -1, ball).to(torch.int32),
    )  # fmt: skip
    boxes = [Box(tuple(c), ((1, 0, 0), (0, 1, 0), (0, 0, 1)), (1, 1, 1)) for c in centers.tolist()]
    groups = tuple(
        Group(i, "object", -1, f"ball {i}", 0.9, box, (50, 0, 0), int((cloud.group == i).sum()), 4, 1.0)
        for i, box in enumerate(boxes)
    )
    field = LanguageField(groups, np.eye(BALLS, 4, dtype=np.float32), "test:1")
    return Scene(cloud, Frame((0.0, 0.0, 1.0), 0.0, 1.0, "given", "given"), language=field)
