"""A ball before a bumpy bank that photographs see from one side only: no plane explains what lies behind it."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.harmonics import color_to_dc
from scenewright.gaussians.render import render
from scenewright.gaussians.scene import Frame, Scene
from scenewright.tools.filling.fill import merged, patches_behind

EYES = [Camera.look_at([x, -3.0, z], [0, 0, 0.6], [0, 0, 1], 160, 120) for x in (-0.3, 0.0, 0.3) for z in (0.9, 1.1)]


def _bank() -> GaussianCloud:
    """A surface that rises backward in bumps and waves."""
    rng = np.random.default_rng(0)
    x, t = rng.uniform(-2, 2, 9000), rng.uniform(-1, 2, 9000)
    y = t + 0.1 * np.sin(5 * x)
    z = 0.35 * np.maximum(t, 0) ** 2 + 0.12 * np.sin(7 * x) * np.cos(6 * t) + rng.normal(0, 0.02, len(x))
    rgb = np.stack([0.25 + 0.1 * np.sin(9 * x), 0.5 + 0.1 * np.cos(8 * t), 0 * x + 0.2], axis=1)
    return _cloud(np.stack([x, y, z], axis=1), rgb, 0.03)


def _ball() -> GaussianCloud:
    way = np.random.default_rng(1).normal(size=(1500, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    return _cloud(way * 0.45 + [0.0, -0.4, 0.6], np.tile([0.8, 0.1, 0.1], (1500, 1)), 0.03)


def _cloud(points: np.ndarray, rgb: np.ndarray, size: float) -> GaussianCloud:
    n = len(points)
    quats = torch.tensor([1.0, 0, 0, 0]).expand(n, 4).contiguous()
    means, color = (torch.from_numpy(a.astype(np.float32)) for a in (points, rgb))
    return GaussianCloud.create(
        means, quats, torch.full((n, 3), size), torch.full((n,), 0.9), color_to_dc(color)[:, None]
    )


def _renumbered(*clouds: GaussianCloud) -> GaussianCloud:
    first, out = 0, []
    for cloud in clouds:
        out.append(cloud.replace(ids=torch.arange(first, first + len(cloud))))
        first += len(cloud)
    return concat(out)


def _scene(bank: GaussianCloud, cameras: list[Camera] | None = None) -> Scene:
    frame = Frame((0, 0, 1), 0.0, 1.0, "given", "given")
    return Scene(_renumbered(bank), frame, cameras=tuple(EYES if cameras is None else cameras))


def _unseen(bank: GaussianCloud, ball: GaussianCloud) -> torch.Tensor:
    """What no photograph shows of the bank while the ball is there."""
    from scenewright.gaussians.render import contributions

    both = _renumbered(bank, ball)
    shows = sum(contributions(both, eye) for eye in EYES)
    return shows[: len(bank)] < 0.02


@pytest.fixture(scope="module")
def hole() -> tuple[Scene, GaussianCloud, GaussianCloud]:
    """The scene without the ball and what it hid, the ball, and the whole bank."""
    bank, ball = _bank(), _ball()
    return _scene(bank[~_unseen(bank, ball)]), ball, bank


@pytest.mark.slow
def test_the_bank_behind_the_ball_is_closed_in_its_colours(hole: tuple[Scene, GaussianCloud, GaussianCloud]) -> None:
    scene, ball, bank = hole
    new = merged(scene, patches_behind(scene, ball))
    full = concat([scene.cloud, new])
    for eye in (EYES[0], EYES[3], EYES[5]):
        truth, bare, now = (render(c, eye) for c in (bank, scene.cloud, full))
        gap = (bare.alpha < 0.5) & (truth.alpha > 0.9)
        assert gap.sum() > 150
        assert (now.alpha[gap] > 0.5).float().mean() > 0.97
        error = [float(((s.rgb - truth.rgb)[gap] ** 2).mean().sqrt()) for s in (bare, now)]
        assert error[1] < 0.12 < 0.25 < error[0]


@pytest.mark.slow
def test_what_photographs_see_past_the_ball_stays_as_it_looks(hole: tuple[Scene, GaussianCloud, GaussianCloud]) -> None:
    scene, ball, _ = hole
    full = concat([scene.cloud, merged(scene, patches_behind(scene, ball))])
    for eye in EYES:
        was, now, alone = render(scene.cloud, eye), render(full, eye), render(ball, eye)
        away = torch.nn.functional.max_pool2d(alone.alpha[None, None], 9, 1, 4)[0, 0] < 0.01
        assert float((was.rgb - now.rgb)[away].abs().max()) < 0.1


@pytest.mark.slow
def test_a_second_fill_adds_nothing(hole: tuple[Scene, GaussianCloud, GaussianCloud]) -> None:
    scene, ball, _ = hole
    first = merged(scene, patches_behind(scene, ball))
    after = scene.replace(cloud=concat([scene.cloud, first]))
    again = merged(after, patches_behind(after, ball))
    assert len(first) > 0 == len(again)


@pytest.mark.slow
def test_ten_fills_add_no_more_than_one_leaves(hole: tuple[Scene, GaussianCloud, GaussianCloud]) -> None:
    scene, ball, _ = hole
    counts, pictures = [], []
    for _ in range(10):
        new = merged(scene, patches_behind(scene, ball))
        scene = scene.replace(cloud=concat([scene.cloud, new]))
        counts.append(len(new))
        pictures.append(render(scene.cloud, EYES[1]).rgb)
    assert counts[0] > 0 == sum(counts[1:])
    assert float((pictures[-1] - pictures[0]).abs().mean()) < 2e-3


def test_without_anything_behind_it_nothing_is_made() -> None:
    """A ball in the air that only ground far below it goes with."""
    ball = _ball()
    far = _bank().replace(means=_bank().means - torch.tensor([0.0, 0.0, 30.0]))
    patches = patches_behind(_scene(far), ball)
    assert not any(len(p.cloud) for p in patches)
