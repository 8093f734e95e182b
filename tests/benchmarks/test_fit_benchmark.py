"""The benchmarks of fitting: the plain recipe takes the steps of the fast one, kept trainings count, bits are bits."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from scenewright.benchmarks import _ablation, _fits, _plain, fit, fit_sizes
from scenewright.benchmarks._fits import Run
from scenewright.benchmarks.files import glossy
from scenewright.gaussians import files
from scenewright.gaussians.errors import FileError, UserError
from scenewright.gaussians.fit import Photos, Settings
from scenewright.gaussians.fit.densify import DefaultStrategy
from scenewright.gaussians.fit.engine import CpuEngine, EngineFactory
from scenewright.gaussians.fit.parameters import F32, Parameters
from scenewright.gaussians.fit.train import Schedule, Trainer
from scenewright.gaussians.scene import Scene


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_fits, "SMALL", 300)
    monkeypatch.setattr(_fits, "SMALL_SIZE", (36, 24))
    monkeypatch.setattr(fit, "QUICK_STEPS", 400)  # bands are tried and Gaussians left out every hundred
    monkeypatch.setattr(fit_sizes, "QUICK_STEPS", 20)
    for name in (_fits.KEEP, _fits.ONLY):
        monkeypatch.delenv(name, raising=False)


class Recording(DefaultStrategy):
    """Records the centre gradients of the last step."""

    centers: F32

    def after_step(self, parameters: Parameters, centers: F32, size: tuple[int, int], rate: float) -> None:
        self.centers = centers

    def after_step_torch(
        self, values: Mapping[str, Tensor], centers: Tensor, size: tuple[int, int], rate: float
    ) -> None:
        self.centers = centers.numpy()


def step(engine: EngineFactory, photos: Photos) -> tuple[float, Parameters, F32]:
    """Loss, what the optimiser remembers, and the pulls at centres, of one step from a start of degree 1, where no
    gradient is zero but for rounding."""
    rng = np.random.default_rng(0)
    parameters, growth = Parameters.of(glossy(300).with_degree(1)), Recording(photos.extent, rng)
    trainer = Trainer(photos.shots, parameters, growth, photos.extent, Schedule(steps=100), rng, engine)
    return trainer.step(), trainer.parameters, growth.centers


def test_a_plain_step_is_a_step_of_the_trainer_in_other_arithmetic() -> None:
    photos = _fits.small_photos()
    loss, fast, centers = step(CpuEngine, photos)
    plain_loss, plain, plain_centers = step(_plain.PlainEngine, photos)
    assert loss == pytest.approx(plain_loss, rel=1e-5)  # sums of a thousand float32 in another order
    # Adam's first memory is a tenth of the gradient. Gaussians that few pixels see are sums that cancel, in float32 on
    # both sides, which the goal of the renderer's gradients against float64 (1e-4) allows for.
    for name, memory in fast.optimisers.items():
        assert apart(memory.first, plain.optimisers[name].first) <= 1e-4, name
        assert memory.steps == plain.optimisers[name].steps == 1
    assert apart(centers, plain_centers) <= 1e-4
    np.testing.assert_array_equal(centers.any(axis=1), plain_centers.any(axis=1))


def apart(found: F32, wanted: F32) -> float:
    assert np.linalg.norm(wanted) > 0
    return float(np.linalg.norm(found - wanted) / np.linalg.norm(wanted))


def test_the_plain_recipe_adds_bands_by_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_plain, "BAND_EVERY", 2)  # for a thousand
    plain = _plain.trainer(_fits.small_photos(), Settings(steps=10))
    degrees = []
    while plain.progress < 1:
        plain.step()
        degrees.append(plain.parameters.degree)
    assert degrees == [0, 0, 1, 1, 2, 2, 3, 3, 3, 3]


def test_the_plain_recipe_moves_higher_bands_at_the_published_rate() -> None:
    plain = _plain.PlainEngine(Parameters.of(glossy(300).with_degree(1)), Recording(3.5, np.random.default_rng(0)), 0.2)
    before = plain.fetch().sh.copy()
    shot = _fits.small_photos().shots[0]
    plain.train_step(shot.camera, shot.colors, 1e-3)
    moved = np.abs(plain.fetch().sh - before)[:, 1:]
    assert float(moved.max()) == pytest.approx(2.5e-3 / 20, rel=1e-3)  # Adam's first step is as long as its rate


@pytest.mark.slow
def test_quick_compares_the_default_with_classic_growth_and_the_plain_recipe() -> None:
    result = fit.run(quick=True)
    found = {metric.key: metric for metric in result.metrics}
    for name in ("default-5", "classic-5", "plain-5"):
        assert found[f"{name}.psnr"].value > 10 and found[f"{name}.seconds"].value > 0
        assert found[f"{name}.memory"].value > 50e6  # bytes: Python and torch alone take more
    assert found["default-5.psnr"].goal == 26.5 and found["default-5.memory"].goal == 3e9
    gain = found["default-5.psnr"].value - found["plain-5.psnr"].value
    assert found["default-5.over.plain-5"].value == pytest.approx(gain)
    curves = {p.method: [q for q in result.points if q.method == p.method] for p in result.points}
    assert set(curves) == {"default", "classic growth", "plain recipe"}
    for name, points in zip(("default-5", "classic-5", "plain-5"), curves.values(), strict=True):
        seconds = [point.seconds for point in points]
        assert 6 <= len(points) <= len(fit.SHOWN) + 1 and seconds == sorted(set(seconds))
        assert [bool(point.setting) for point in points] == [False] * (len(points) - 1) + [True]
        assert seconds[-1] == found[f"{name}.seconds"].value
        assert points[-1].accuracy == pytest.approx(found[f"{name}.psnr"].value)  # two held out, all of them watched
    assert [p.method for p in result.points if p.default] == ["default"]
    assert any(note.startswith("quick") for note in result.notes)
    assert 0 <= found["default-5.left_out"].value < 300


def test_all_settings_of_the_hour_are_told_apart() -> None:
    runs = fit._runs(quick=False)
    assert len({run.name for run in runs}) == len({run.title for run in runs}) == len(runs)
    assert {run.settings.seconds for run in runs} == {fit.SHORT, fit.LONG}
    assert {name for pair in fit.COMPARED for name in pair} | set(fit.GOALS) <= {run.name for run in runs}


@pytest.mark.slow
def test_quick_sizes_tell_what_every_degree_takes() -> None:
    result = fit_sizes.run(quick=True)
    found = {metric.key: metric.value for metric in result.metrics}
    assert result.cost == "bytes" and len(result.points) == 16
    count = found["sh0.gaussians"]
    for degree in range(4):
        numbers = 3 * (degree + 1) ** 2
        exact = found[f"sh{degree}.float32.bytes"]
        assert exact == pytest.approx(count * 4 * (14 + numbers), abs=3000)  # and a header
        assert found[f"sh{degree}.float32.bytes_each"] == exact / count
        assert found[f"sh{degree}.means16.bytes"] == exact - 6 * count + 24
        assert found[f"sh{degree}.means_half.bytes"] == found[f"sh{degree}.means16.bytes"]
        assert found[f"sh{degree}.sh8.bytes"] == exact - 3 * numbers * count + 8 * (degree + 1)
        assert abs(found[f"sh{degree}.both.psnr"] - found[f"sh{degree}.float32.psnr"]) < 3  # dB: eight bits are many


def test_kept_trainings_count_while_their_settings_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    runs = [Run("a", "A", Settings(steps=2)), Run("b", "B", Settings(steps=3))]
    made: list[str] = []
    train = _fits.maker(quick=True)
    assert train is not None

    def make(run: Run, place: Path) -> None:
        made.append(run.name)
        train(run, place)

    monkeypatch.setenv(_fits.KEEP, str(tmp_path / "kept"))
    monkeypatch.setenv(_fits.ONLY, "b")
    with _fits.kept() as place:
        assert list(_fits.all_made(runs, place, make)) == ["b"]
        assert list(_fits.notes(runs, _fits.all_made(runs, place, make), quick=False)) == ["not made: a"]
        monkeypatch.delenv(_fits.ONLY)
        found = _fits.all_made(runs, place, make)
    assert made == ["b", "a"] and [found[name].steps for name in "ab"] == [2, 3]
    with _fits.kept() as place:
        changed = [runs[0], replace(runs[1], settings=Settings(steps=4))]
        again = _fits.all_made(changed, place, make)
        assert made == ["b", "a", "b"] and again["a"] == found["a"] and again["b"].steps == 4
        assert len(files.load(_fits.scene_of("b", place)).cloud) == again["b"].gaussians


def test_what_was_trained_at_other_revisions_is_told(tmp_path: Path) -> None:
    run = Run("a", "A", Settings(steps=1))
    make = _fits.maker(quick=True)
    assert make is not None
    one = _fits.all_made([run], tmp_path, make)["a"]
    found = {"a": replace(one, revision="x"), "b": replace(one, revision="y")}
    assert "revisions: a x, b y" in list(_fits.notes([run], found, quick=False))


def test_names_of_no_training_and_broken_files_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = Run("a", "A", Settings(steps=1))
    (tmp_path / "a.json").write_text(json.dumps({"psnr": 3}))
    with pytest.raises(FileError, match="delete it"):
        _fits.all_made([run], tmp_path, lambda run, place: None)
    monkeypatch.setenv(_fits.ONLY, "a, c")
    with pytest.raises(UserError, match="no training is called c; choose a"):
        _fits.all_made([run], tmp_path, lambda run, place: None)


def test_without_the_capture_nothing_is_measured_and_that_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_fits, "folder", lambda name: None)
    for bench in (fit, fit_sizes):
        result = bench.run(quick=False)
        assert not result.points and "captures/bonsai_room" in result.notes[0]
    with pytest.raises(FileError, match="SCENEWRIGHT_DATA"):
        _fits.photos(quick=False)


@settings(max_examples=50, deadline=None)
@given(st.integers(1, 16), st.lists(st.floats(-1e3, 1e3, width=32), min_size=1, max_size=20))
def test_steps_are_even_few_and_near(bits: int, numbers: list[float]) -> None:
    given_ = torch.tensor(numbers)
    found = _ablation.stepped(given_, bits)
    step = float(given_.max() - given_.min()) / (2**bits - 1)
    rounding = 1e-6 * float(given_.abs().max())  # of the answer to float32
    assert float((found - given_).abs().max()) <= step / 2 + rounding
    assert len(found.unique()) <= 2**bits and float((found.max() - given_.max()).abs()) <= rounding


def test_only_what_is_named_is_rounded(tmp_path: Path) -> None:
    cloud = glossy(500)
    harmonics, positions = _ablation.eight_bit_harmonics(cloud), _ablation.sixteen_bit_positions(cloud)
    assert torch.equal(harmonics.means, cloud.means) and torch.equal(positions.sh, cloud.sh)
    for band in range(4):
        columns = harmonics.sh[:, band * band : (band + 1) ** 2]
        assert 128 < len(columns.unique()) <= 256  # more than seven bits
    box = cloud.means.amax(dim=0) - cloud.means.amin(dim=0)
    assert ((positions.means - cloud.means).abs() <= box / 65535 / 2 * 1.01 + 1e-7).all()
    assert not torch.equal(positions.means, cloud.means)
    halves = _ablation.half_float_positions(cloud).means
    assert torch.equal(halves, cloud.means.half().float())
    files.save(Scene(cloud), tmp_path / "a.ply")
    least = 500 * (4 * 11 + 6 + 48)  # eleven floats, three of two bytes, 48 of one
    left = (tmp_path / "a.ply").stat().st_size - _ablation.bytes_saved(cloud, harmonics=True, positions=True)
    assert least < left < least + 3000  # and a header, ranges and a box
