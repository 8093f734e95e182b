"""Our files against an independent program, PlayCanvas' splat-transform: each reads what the other writes.

`npm install @playcanvas/splat-transform` and its `node_modules/.bin` on the PATH; skipped where it is not found.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
import torch
from scipy.spatial import cKDTree

from scenewright.gaussians import files
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.files.formats import spz
from scenewright.gaussians.files.formats.morton import morton_sorted
from scenewright.gaussians.scene import Scene

PROGRAM = shutil.which("splat-transform")
pytestmark = pytest.mark.skipif(
    PROGRAM is None,
    reason="splat-transform is not on the PATH (npm install @playcanvas/splat-transform; add node_modules/.bin)",
)
COUNT = 900  # up to 1,024 sets of coefficients both programs' palettes can be exact
EXACT = 2e-6  # relative, float32: both programs read the same bytes; float32 logarithms and logits lie between
WRITTEN = (".ply", ".compressed.ply", ".spz", ".3.spz", ".sog")


def transform(source: Path, target: Path, *options: str) -> Path:
    assert PROGRAM is not None
    done = subprocess.run(
        [PROGRAM, "-q", "-w", "-g", "cpu", *options, str(source), str(target)],
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    return target


def scene(degree: int) -> Scene:
    """Gaussians on a jittered lattice, so far apart that each can be found again whatever the order."""
    rng = np.random.default_rng(degree)
    lattice = np.stack(np.unravel_index(np.arange(COUNT), (10, 10, 9)), axis=1) * 0.5
    quats = rng.normal(size=(COUNT, 4))
    columns = (
        lattice + rng.uniform(-0.1, 0.1, (COUNT, 3)) - (1.0, 3.0, 2.0),
        quats / np.linalg.norm(quats, axis=1, keepdims=True),
        np.exp(rng.uniform(-7, -1, (COUNT, 3))),
        rng.uniform(0.02, 0.98, COUNT),
        rng.normal(0, 0.25, (COUNT, (degree + 1) ** 2, 3)).clip(-0.95, 0.95),
    )
    return Scene(GaussianCloud.create(*(torch.from_numpy(c.astype(np.float32)) for c in columns)))


def alike(path: Path, other: Path) -> None:
    """Two files hold the same Gaussians, in whatever order."""
    a, b = files.load(path).cloud, files.load(other).cloud
    assert len(a) == len(b) and a.degree == b.degree
    found = cKDTree(b.means.numpy()).query(a.means.numpy())[1]
    assert len(set(found.tolist())) == len(a)
    b = b[torch.from_numpy(found)]
    assert np.allclose(a.means, b.means, rtol=EXACT, atol=EXACT)
    # In .splat we take byte 128 for zero, as antimatter15 does; they take the middle of 127 and 128. Half a byte in
    # each of four components is at most 1/128 of the length of a quaternion.
    assert (1 - (a.quats * b.quats).sum(dim=1).abs()).max() < (1.05 / 128**2 / 2 if ".splat" in path.name else EXACT)
    assert np.allclose(a.scales, b.scales, rtol=10 * EXACT)  # a float32 logarithm near ten is off by 5e-7
    assert np.allclose(a.opacities, b.opacities, atol=EXACT)
    assert np.allclose(a.sh, b.sh, rtol=EXACT, atol=EXACT)


@pytest.mark.parametrize("degree", [0, 2, 3])
@pytest.mark.parametrize("suffix", [".compressed.ply", ".splat", ".spz", ".3.spz", ".2.spz", ".sog"])
def test_what_we_write_is_read_alike(tmp_path: Path, suffix: str, degree: int) -> None:
    ours = tmp_path / f"ours{suffix}"
    if suffix[1].isdigit():
        with ours.open("wb") as file:
            spz.write(morton_sorted(scene(degree)), file, int(suffix[1]))
    else:
        files.save(scene(degree), ours)
    alike(ours, transform(ours, tmp_path / "theirs.ply"))


@pytest.mark.parametrize("degree", [0, 1, 3])
@pytest.mark.parametrize("suffix", WRITTEN)
def test_what_they_write_is_read_alike(tmp_path: Path, suffix: str, degree: int) -> None:
    files.save(scene(degree), tmp_path / "a.ply")
    options = ("--spz-version", "3") if suffix == ".3.spz" else ()
    theirs = transform(tmp_path / "a.ply", tmp_path / f"b{suffix}", *options)
    alike(theirs, transform(theirs, tmp_path / "c.ply"))


@pytest.mark.parametrize("suffix", WRITTEN)
def test_both_write_the_same_scene(tmp_path: Path, suffix: str) -> None:
    """Each quantises in its own way, so within the coarser step of the two; axes, signs and orders would be far off."""
    files.save(scene(3), tmp_path / "a.ply")
    theirs = transform(tmp_path / "a.ply", tmp_path / f"b{suffix}")
    got, want = files.load(theirs).cloud, scene(3).cloud
    got = got[torch.from_numpy(cKDTree(got.means.numpy()).query(want.means.numpy())[1])]
    assert np.allclose(got.means, want.means, atol=0.005)
    assert (1 - (got.quats * want.quats).sum(dim=1).abs()).max() < 2e-4  # eight bits, cut off instead of rounded
    assert np.allclose(got.scales.log(), want.scales.log(), atol=1 / 16)
    assert np.allclose(got.opacities, want.opacities, atol=1.01 / 255)
    assert np.allclose(got.sh[:, 0], want.sh[:, 0], atol=0.03)
    if suffix != ".sog":  # whose palette is a matter of taste
        assert np.allclose(got.sh, want.sh, atol=1 / 8)
