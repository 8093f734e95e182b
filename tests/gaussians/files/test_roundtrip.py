"""Written clouds are read back within the quantisation step of the format; equal scenes give equal bytes."""

from __future__ import annotations

import itertools
import json
import math
import zipfile
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from scenewright.gaussians import files
from scenewright.gaussians.camera import Camera, Vec3
from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.files.formats import spz
from scenewright.gaussians.files.formats.morton import morton_sorted
from scenewright.gaussians.reduce import psnr
from scenewright.gaussians.scene import Scene

C0 = 0.28209479177387814
ROUNDING = 1e-5  # relative: float32 arithmetic of a few steps, float32 logarithms
LOSSY = (".compressed.ply", ".splat", ".spz", ".sog")
every = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)


def random_cloud(count: int, degree: int, seed: int, spread: float = 3.0, extreme: bool = False) -> GaussianCloud:
    """Gaussians all over the ranges that files hold; with `extreme`, some far beyond."""
    rng = np.random.default_rng(seed)
    quats = rng.normal(size=(count, 4)) * (rng.random((count, 4)) > 0.2) + np.array([1e-9, 0, 0, 0])
    quats /= np.linalg.norm(quats, axis=1, keepdims=True)
    logs = rng.uniform(-9, 4, (count, 3))
    opacities, sh = rng.uniform(0.001, 0.999, count), rng.normal(size=(count, (degree + 1) ** 2, 3)) * 0.3
    means = rng.normal(size=(count, 3)) * spread
    if extreme:
        logs[rng.random((count, 3)) < 0.2] = rng.choice([-80.0, 60.0])
        opacities[rng.random(count) < 0.3] = rng.choice([1e-7, 1 - 1e-7])
        sh[rng.random(count) < 0.2] *= 1e4
        means[rng.random(count) < 0.2] *= 1e3  # SPZ ends at 8.4e6
    columns = (means, quats, np.exp(logs), opacities, sh)
    return GaussianCloud.create(*(torch.from_numpy(column.astype(np.float32)) for column in columns))


clouds = st.builds(
    random_cloud, st.sampled_from([1, 2, 3, 255, 256, 257, 700]), st.integers(0, 3), st.integers(0, 10**6),
    st.sampled_from([0.0, 1e-3, 3.0, 500.0]), st.booleans(),
)  # fmt: skip


def put(cloud: GaussianCloud, path: Path) -> tuple[GaussianCloud, GaussianCloud]:
    """What was written, in the order of the file, and what came back."""
    files.save(Scene(cloud), path, force=True)
    back, report = files.load_with_report(path)
    assert report.rows == report.loaded == len(cloud) and report.notes == ()
    plain = path.suffix == ".splat"
    return (cloud if plain else morton_sorted(Scene(cloud)).cloud), back.cloud


def angles(a: GaussianCloud, b: GaussianCloud) -> NDArray[np.float64]:
    """Radians between rotations, `[N]`; by the chord, which is exact for small angles."""
    p, q = a.quats.double().numpy(), b.quats.double().numpy()
    p, q = (x / np.linalg.norm(x, axis=1, keepdims=True) for x in (p, q))
    chord = np.minimum(np.linalg.norm(p - q, axis=1), np.linalg.norm(p + q, axis=1))
    return 4 * np.arcsin(np.clip(chord / 2, 0, 1))


def thirds_angle(half: float) -> float:
    """Largest angle when three components err by `half`: the fourth, at least 1/2 and with the others at most √3/2
    long, errs by up to √3 times as much; an angle is twice the way on the sphere; second order and float32 above."""
    return 2 * math.sqrt(3) * half * math.hypot(1, math.sqrt(3)) * 1.02 + 1e-3


def close(got: torch.Tensor, want: NDArray[np.floating] | torch.Tensor, step: NDArray[np.floating] | float) -> None:
    """Within half a step and float32's rounding."""
    wanted = np.asarray(want, dtype=np.float64)
    assert (np.abs(got.numpy() - wanted) <= np.asarray(step) / 2 + ROUNDING * (1 + np.abs(wanted))).all()


def chunk_steps(column: NDArray[np.floating], steps: tuple[int, ...]) -> NDArray[np.floating]:
    """Extent of each row's chunk of 256 over its number of steps."""
    parts = [column[start : start + 256] for start in range(0, len(column), 256)]
    return np.concatenate([np.repeat((p.max(0) - p.min(0))[None] / steps, len(p), axis=0) for p in parts])


@every
@given(clouds)
def test_compressed_ply(tmp_path: Path, cloud: GaussianCloud) -> None:
    want, got = put(cloud, tmp_path / "a.compressed.ply")
    close(got.means, want.means, chunk_steps(want.means.numpy(), (2047, 1023, 2047)))
    assert angles(want, got).max() <= thirds_angle(math.sqrt(2) / 1023 / 2)
    logs = np.clip(np.log(want.scales.double().numpy()), -20, 20)
    close(got.scales.double().log(), logs, chunk_steps(logs, (2047, 1023, 2047)))
    close(got.opacities, want.opacities, 1 / 255)
    close(got.sh[:, 0], want.sh[:, 0], chunk_steps(want.sh[:, 0].numpy(), (255, 255, 255)))
    close(got.sh[:, 1:], want.sh[:, 1:].clip(-4, 4), 2 / 32)  # bytes at the ends stand for the ends of their step


@every
@given(clouds)
def test_splat(tmp_path: Path, cloud: GaussianCloud) -> None:
    want, got = put(cloud, tmp_path / "a.splat")
    assert torch.equal(got.means, want.means)
    assert torch.equal(got.scales, want.scales.clamp_min(float(np.finfo(np.float32).tiny)))
    assert angles(want, got).max() <= 2 * (2 / 256) * 1.02  # four components half a step off, none derived
    close(got.opacities, want.opacities, 1 / 255)
    close(got.sh[:, 0], ((want.sh[:, 0] * C0 + 0.5).clip(0, 1) - 0.5) / C0, 1 / 255 / C0)
    assert got.degree == 0


@every
@given(clouds, st.sampled_from(spz.WRITABLE))
def test_spz(tmp_path: Path, cloud: GaussianCloud, version: int) -> None:
    path = tmp_path / "a.spz"
    with path.open("wb") as file:
        spz.write(Scene(cloud), file, version)
    got = files.load(path).cloud
    bits = spz.codes.fraction_bits(cloud.means.numpy())
    close(got.means, cloud.means, 2.0**-bits)
    if version == 2:  # w is what x, y and z leave; near zero a small error of theirs is a large one of its own
        error = math.sqrt(3) / 255
        assert angles(cloud, got).max() <= 2 * (error + math.sqrt(2 * error + error**2)) * 1.02
    else:
        assert angles(cloud, got).max() <= thirds_angle(1 / math.sqrt(2) / 511 / 2)
    close(got.scales.double().log(), cloud.scales.double().log().clip(-10, 255 / 16 - 10), 1 / 16)
    close(got.opacities, cloud.opacities, 1 / 255)
    close(got.sh[:, 0], cloud.sh[:, 0].clip(-0.5 / 0.15, 0.5 / 0.15), 1 / 255 / 0.15)
    top = 127 / 128
    close(got.sh[:, 1:4], cloud.sh[:, 1:4].clip(-1, top), 2**-4)
    close(got.sh[:, 4:], cloud.sh[:, 4:].clip(-1, top), 2**-3)


@every
@given(clouds)
@pytest.mark.slow
def test_sog(tmp_path: Path, cloud: GaussianCloud) -> None:
    want, got = put(cloud, tmp_path / "a.sog")
    meta = json.loads(zipfile.ZipFile(tmp_path / "a.sog").read("meta.json"))

    def logs(means: torch.Tensor) -> NDArray[np.float64]:
        return np.sign(means.double().numpy()) * np.log1p(np.abs(means.double().numpy()))

    close(torch.from_numpy(logs(got.means)), logs(want.means), np.ptp(logs(want.means), axis=0) / 65535)
    assert angles(want, got).max() <= thirds_angle(math.sqrt(2) / 255 / 2)
    close(got.opacities, want.opacities, 1 / 255)
    for name, here, there in (
        ("scales", got.scales.double().log(), want.scales.double().log().clip(-20, 20)),
        ("sh0", got.sh[:, 0], want.sh[:, 0]),
        ("shN", got.sh[:, 1:], want.sh[:, 1:]),
    ):
        if here.numel():  # up to 1,024 sets of coefficients the palette is exact, so all that is left is its codebook
            book = np.array(meta[name]["codebook"])
            best = np.abs(there.double().numpy()[..., None] - book).min(axis=-1)
            close((here.double() - there.double()).abs(), best, 0.0)
            assert len(book) == 256


@pytest.mark.parametrize("suffix", [".ply", *LOSSY])
def test_equal_scenes_give_equal_bytes(tmp_path: Path, suffix: str) -> None:
    cloud = random_cloud(3000, 2, 7)
    for name in "ab":
        files.save(Scene(cloud), tmp_path / (name + suffix))
    assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


@pytest.mark.parametrize("suffix", LOSSY)
def test_what_is_not_finite_is_refused_and_leaves_nothing(tmp_path: Path, suffix: str) -> None:
    cloud = random_cloud(300, 1, 1)
    cloud.sh[7, 2, 1], cloud.means[9, 0] = math.nan, math.inf
    with pytest.raises(UserError, match="2 Gaussians hold NaN"):
        files.save(Scene(cloud), tmp_path / f"a{suffix}")
    with pytest.raises(UserError, match="zero Gaussians"):
        files.save(Scene(GaussianCloud.empty()), tmp_path / f"a{suffix}")
    assert not list(tmp_path.iterdir())


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("suffix", LOSSY)
def test_a_thousand_equal_gaussians(tmp_path: Path, suffix: str) -> None:
    one = random_cloud(1, 3, 3)
    want, got = put(one[torch.zeros(1000, dtype=torch.long)], tmp_path / f"a{suffix}")
    assert len({tuple(row) for row in got.means.tolist()}) == 1
    assert np.allclose(got.means[0], want.means[0], rtol=1e-5, atol=2.0**-13)


def test_spz_says_what_it_cannot_hold(tmp_path: Path) -> None:
    cloud = random_cloud(3, 0, 3)
    cloud.means[0, 0] = 1e7
    with pytest.raises(UserError, match="crop"):
        files.save(Scene(cloud), tmp_path / "a.spz")
    with (tmp_path / "b.spz").open("wb") as file, pytest.raises(UserError, match="2, 3, 4, not 1"):
        spz.write(Scene(cloud), file, 1)


def test_a_bound_language_field_keeps_the_order_of_rows(tmp_path: Path) -> None:
    cloud = random_cloud(600, 0, 5)
    scene = Scene(cloud)
    files.writer(tmp_path / "a.sog")  # exists
    with (tmp_path / "a.compressed.ply").open("wb") as file:
        files.writer(tmp_path / "a.compressed.ply")(scene.replace(language=object()), file)
    got = files.load(tmp_path / "a.compressed.ply").cloud
    assert np.allclose(got.means, cloud.means, atol=np.ptp(cloud.means.numpy()) / 1023)


# Handedness. A scene that no reflection or half turn leaves alike: three lobes of different length and colour along
# x, y and z, turned anisotropic splats, and harmonics of which every coefficient differs.
def asymmetric(degree: int = 3) -> Scene:
    parts = []
    for axis, (length, color) in enumerate(((1.0, (0.9, 0.1, 0.1)), (0.7, (0.1, 0.8, 0.1)), (0.4, (0.1, 0.2, 0.9)))):
        part = random_cloud(120, 0, axis, 0.05)
        means = part.means.clone()
        means[:, axis] += torch.linspace(0.05, length, 120)
        rng = np.random.default_rng(axis)
        sh = torch.from_numpy(rng.normal(0, 0.12, (1, (degree + 1) ** 2, 3)).astype(np.float32)).repeat(120, 1, 1)
        sh[:, 0] = (torch.tensor(color) - 0.5) / C0
        scales = torch.tensor([[0.06, 0.02, 0.008]]).repeat(120, 1)
        parts.append(part.replace(means=means, sh=sh, scales=scales, opacities=torch.full((120,), 0.8),
                                  ids=part.ids + 120 * axis))  # fmt: skip
    return Scene(concat(parts))


EYES: tuple[Vec3, ...] = ((1.6, -1.2, 1.4), (-1.5, 1.0, 1.3), (0.4, 1.8, -1.6))
CAMERAS = [Camera.look_at(eye, (0.2, 0.2, 0.1), (0.0, -1.0, 0.0), 128, 128) for eye in EYES]
ALIKE = 32.0  # dB; formats with eight bits a rotation reach 36 here, any flip falls below 20 (next test)


@pytest.mark.parametrize(("first", "second"), list(itertools.product((".ply", *LOSSY), repeat=2)))
def test_scenes_keep_their_handedness_through_every_pair(tmp_path: Path, first: str, second: str) -> None:
    scene = asymmetric(0 if ".splat" in (first, second) else 3)
    there = scene
    for name, suffix in (("a", first), ("b", second), ("c", first)):
        files.save(there, tmp_path / (name + suffix))
        there = files.load(tmp_path / (name + suffix))
    assert min(psnr(scene.cloud, there.cloud, CAMERAS)) > ALIKE


@pytest.mark.parametrize("signs", [(1, -1, -1), (-1, 1, -1), (-1, -1, 1), (-1, 1, 1), (1, -1, 1), (1, 1, -1)])
def test_the_asymmetric_scene_shows_flips(signs: tuple[int, int, int]) -> None:
    cloud = asymmetric().cloud
    turned = cloud.replace(means=cloud.means * torch.tensor(signs, dtype=torch.float32))
    assert min(psnr(cloud, turned, CAMERAS)) < 20
