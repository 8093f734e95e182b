"""Training in torch, as on a GPU, against training in numba: step by step, through refinement and checkpoints; and on a
device if there is one."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import BackendError
from scenewright.gaussians.files.captures.colmap import Points
from scenewright.gaussians.fit import Photos, Settings, Status, fit, fitting, train
from scenewright.gaussians.fit.densify import DefaultStrategy, MCMCStrategy, Strategy
from scenewright.gaussians.fit.engine import CpuEngine, EngineFactory, engine_for, resolve_device
from scenewright.gaussians.fit.engine_torch import TorchEngine
from scenewright.gaussians.fit.parameters import Parameters, learning_rates
from scenewright.gaussians.fit.quality import measure
from scenewright.gaussians.fit.train import MEANS_LR, Schedule, Shot, Trainer
from scenewright.gaussians.render import cuda, differentiable, render

IN_TORCH: EngineFactory = partial(TorchEngine, device="cpu", draw=differentiable.draw)


def blobs(seed: int, count: int = 250) -> GaussianCloud:
    """Coloured blobs in a ball."""
    g = torch.Generator().manual_seed(seed)
    means = torch.nn.functional.normalize(torch.randn(count, 3, generator=g), dim=1) * torch.rand(count, 1, generator=g)
    return GaussianCloud.create(
        means, torch.nn.functional.normalize(torch.randn(count, 4, generator=g), dim=1),
        torch.rand(count, 3, generator=g) * 0.1 + 0.03, torch.rand(count, generator=g) * 0.5 + 0.4,
        torch.randn(count, 1, 3, generator=g),
    )  # fmt: skip


def shots(count: int = 9, side: int = 48) -> list[Shot]:
    """Photographs of the blobs from a circle around them."""
    angles = np.linspace(0, 2 * math.pi, count, endpoint=False)
    eyes = [(3 * math.cos(a), 3 * math.sin(a), 0.8 * math.sin(3 * a)) for a in angles]
    cameras = [Camera.look_at(eye, (0, 0, 0), (0, 0, 1), side, side - 8, name=f"p{i}") for i, eye in enumerate(eyes)]
    return [Shot(c, render(blobs(1), c).to_uint8()) for c in cameras]


def growth_of(name: str, rng: np.random.Generator) -> Strategy:
    """With few copies at a time, and much noise: copies that lie where the one they came from does change their order
    by a rounding."""
    return (
        MCMCStrategy(300, rng, grow_share=0.05, noise_lr=5e5) if name == "budgeted" else DefaultStrategy(3.3, rng, 300)
    )


def trainer(engine: EngineFactory, growth: str, steps: int, degree: int = 1, count: int = 200) -> Trainer:
    """A start that is off, some of it faint, so that there is something to learn, to wander and to move."""
    rng = np.random.default_rng(0)
    start = Parameters.of(blobs(2, count))
    start.logit_opacities[::5] = -4.0
    return Trainer(
        shots()[1:], start, growth_of(growth, rng), 3.3, Schedule(steps=steps, coarse=0.1, degree=degree), rng, engine
    )


def assert_close(ours: Trainer, theirs: Trainer, steps: int) -> None:
    """All but one parameter in 50 within a hundredth of the way that `steps` steps can have taken them.

    Adam makes as large a step against a gradient of rounding noise as against any other, so parameters without
    influence on the photographs drift apart, by rates and not by roundings; and two Gaussians at the same depth may
    change places in a pixel.
    """
    a, b = ours.parameters, theirs.parameters
    assert len(a) == len(b) and a.degree == b.degree
    for name, rate in learning_rates(MEANS_LR * 3.3).items():
        apart = np.abs(getattr(a, name) - getattr(b, name))
        assert np.count_nonzero(apart > 0.01 * steps * rate) <= 0.02 * apart.size, name
        assert a.optimisers[name].steps == b.optimisers[name].steps


@pytest.mark.parametrize("growth", ["budgeted", "classic"])
def test_steps_in_torch_equal_those_in_numba(growth: str) -> None:
    ours, theirs = (trainer(engine, growth, 1000) for engine in (CpuEngine, IN_TORCH))
    for _ in range(20):
        assert ours.step() == pytest.approx(theirs.step(), rel=1e-3)  # a pixel whose Gaussians change places
    assert_close(ours, theirs, 20)


@pytest.mark.parametrize("growth", ["budgeted", "classic"])
@pytest.mark.slow
def test_refinement_and_added_bands_agree_in_torch_and_numba(growth: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Refinement uses thresholds and random draws over all Gaussians, so rounding may change which ones are copied. The
    numbers of Gaussians and the quality must agree."""
    monkeypatch.setattr(train, "REFINE_START_ITER", 100)
    ours, theirs = (trainer(engine, growth, 180) for engine in (CpuEngine, IN_TORCH))
    held = shots()[:1]
    before = measure(ours.parameters.cloud(), held).psnr
    for one in (ours, theirs):
        while one.progress < 1:
            one.step()
        assert one.parameters.degree == 1
    a, b = (measure(one.parameters.cloud(), held).psnr for one in (ours, theirs))
    assert a > before + 2 and abs(a - b) < 0.5
    assert len(ours.parameters) != 200 and abs(len(ours.parameters) - len(theirs.parameters)) <= 3


@pytest.mark.parametrize(("first", "second"), [(CpuEngine, IN_TORCH), (IN_TORCH, CpuEngine), (IN_TORCH, IN_TORCH)])
@pytest.mark.slow
def test_a_state_of_one_engine_resumes_in_the_other(
    first: EngineFactory, second: EngineFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(train, "REFINE_START_ITER", 100)
    begun = trainer(first, "budgeted", 1000)
    for _ in range(100):
        begun.step()
    arrays, values = begun.state()
    kept = {name: np.array(value) for name, value in arrays.items()}
    resumed = trainer(second, "budgeted", 1000)
    resumed.restore(kept, {**values, "order": list(values["order"])})
    for _ in range(15):
        assert begun.step() == pytest.approx(resumed.step(), rel=1e-3)
    assert_close(begun, resumed, 15)
    assert {n: (a.shape, np.asarray(a).dtype) for n, a in kept.items() if n.endswith("first")} == {
        n: (a.shape, a.dtype) for n, a in resumed.state()[0].items() if n.endswith("first")
    }


def test_changes_on_the_host_between_steps_take_effect() -> None:
    one = trainer(IN_TORCH, "budgeted", 1000)
    one.step()
    one.parameters.take(np.arange(50))
    one.parameters.raise_degree(2)
    one.step()
    assert len(one.parameters) == 50 and one.parameters.degree == 2


def test_a_gaussian_under_training_is_drawn_by_gsplat_as_on_the_cpu(gsplat: ModuleType) -> None:
    through = partial(TorchEngine, device="cpu", draw=cuda.draw)
    ours, theirs = (trainer(engine, "classic", 1000, count=60) for engine in (CpuEngine, through))
    for _ in range(5):
        assert ours.step() == pytest.approx(theirs.step(), rel=1e-3)
    assert_close(ours, theirs, 5)


@pytest.mark.parametrize("draw", [differentiable.draw, cuda.draw])
def test_strategies_get_the_same_centre_gradients(
    gsplat: ModuleType, draw: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In 1/px, of every Gaussian's footprint, from each renderer."""
    pulls: list[NDArray[np.float32]] = []
    monkeypatch.setattr(
        DefaultStrategy, "after_step", lambda self, parameters, centers, size, rate: pulls.append(centers)
    )
    monkeypatch.setattr(
        DefaultStrategy, "after_step_torch", lambda self, values, centers, *_: pulls.append(centers.numpy())
    )
    for engine in (CpuEngine, partial(TorchEngine, device="cpu", draw=draw)):
        trainer(engine, "classic", 1000, count=60).step()
    ours, theirs = pulls
    assert np.linalg.norm(ours - theirs) <= 1e-3 * np.linalg.norm(ours)  # float32, sums that cancel
    assert ours.shape == (60, 2) and np.linalg.norm(ours) > 1e-5


def test_devices_are_chosen_or_refused(gsplat: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    assert resolve_device("auto") == "cuda" and resolve_device("cpu") == "cpu" and resolve_device("cuda") == "cuda"
    made = engine_for("cuda")(Parameters.of(blobs(1, 3)), MCMCStrategy(3, np.random.default_rng(0)), 0.2)
    assert isinstance(made, TorchEngine) and made.degree == 0
    assert engine_for("cpu") is CpuEngine
    monkeypatch.setattr(cuda.splatting, "DEVICE", "cuda")
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    assert resolve_device("auto") == "cpu"
    with pytest.raises(BackendError, match=r"finds no CUDA device.*--device cpu"):
        resolve_device("cuda")


def test_on_a_device_a_scene_is_learnt_as_on_the_cpu() -> None:
    if cuda.missing():
        pytest.skip(cuda.missing())
    held, found = shots()[:1], []
    for device in ("cpu", "cuda"):
        one = trainer(engine_for(device), "budgeted", 200)  # type: ignore[arg-type]
        while one.progress < 1:
            one.step()
        found.append(measure(one.parameters.cloud(), held).psnr)
    assert abs(found[0] - found[1]) < 0.5


def test_a_fit_resumes_from_its_checkpoint_on_the_other_device(
    gsplat: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fitting, "CHECKPOINT_EVERY", 0.0)
    monkeypatch.setattr(fitting, "REPORT_EVERY", 0.0)
    monkeypatch.setattr(train, "REFINE_START_ITER", 100)
    cloud, kept = blobs(1), tmp_path / "checkpoint"
    photos = Photos(
        tuple(shots()[1:]), tuple(shots()[:1]), Points(cloud.means.double().numpy(), np.ones((250, 3))), 3.3
    )

    class Killed(Exception): ...

    def killed(status: Status) -> None:
        if status.steps > 105:
            raise Killed

    settings = Settings(steps=110, max_gaussians=260, degree=0, gain=None)
    with pytest.raises(Killed):
        fit(photos, settings, checkpoint_path=kept, on_status=killed)
    begun: list[int] = []
    fitted = fit(
        photos,
        replace(settings, device="cuda"),
        checkpoint_path=kept,
        on_status=lambda status: begun.append(status.steps),
    )
    assert begun[0] == 101 and math.isfinite(fitted.quality.psnr)
