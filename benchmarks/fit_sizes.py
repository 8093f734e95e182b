"""bench fit_sizes: bytes of a trained scene against its likeness to held-out photographs.

The same capture as `bench fit`, trained for the same time at each degree of the harmonics; then each of these scenes
with positions in 16 bits (as integers or half floats), with harmonics in 8 bits, and with both (`_ablation`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..gaussians import files
from ..gaussians.cloud import GaussianCloud
from ..gaussians.fit import Settings
from ..gaussians.fit.quality import measure
from ..gaussians.fit.train import Shot
from . import _fits
from ._ablation import bytes_saved, eight_bit_harmonics, half_float_positions, sixteen_bit_positions
from ._data import missing
from ._fits import Made, Run
from .harness import Metric, Point, Result

SECONDS, MAX_GAUSSIANS = 60.0, 180_000
QUICK_STEPS = 200
NOISE = 0.01  # of a PSNR: a quarter of a decibel, as other seeds give
TITLE = "bytes of trained scenes against likeness to photographs that were held out"
ACCURACY = "PSNR on all held-out photographs, dB"
NOTES = (
    f"each degree trained for {SECONDS:.0f} s with at most {MAX_GAUSSIANS:,} Gaussians. More SH bands take more time a "
    "step, so that there are fewer steps. No band is dropped",
    "8 bits: each SH band in 256 uniform steps over its range. 16 bits: each axis in 65,536 steps over the box of all "
    "Gaussians. The rest stays as in the .ply, with three unused normals",
)


@dataclass(frozen=True)
class Storage:
    """A way to store a scene: its title, the change of the cloud, and the columns that it makes smaller."""

    title: str
    change: Callable[[GaussianCloud], GaussianCloud]
    harmonics: bool = False
    positions: bool = False


STORAGES = {
    "float32": Storage("all in 32 bits (.ply)", lambda c: c),
    "means16": Storage("positions in 16 bits", sixteen_bit_positions, positions=True),
    "means_half": Storage("positions in half floats", half_float_positions, positions=True),
    "sh8": Storage("harmonics in 8 bits", eight_bit_harmonics, harmonics=True),
    "both": Storage("8 and 16 bits", lambda c: sixteen_bit_positions(eight_bit_harmonics(c)), True, True),
}
DRAWN = ("float32", "means16", "sh8", "both")  # half floats take as much as 16 bits


@dataclass(frozen=True)
class Stored:
    """A trained scene in one of the ways: its bytes, and PSNR on the held-out photographs."""

    name: str
    way: str
    bytes: int
    psnr: float
    made: Made

    def metrics(self) -> Iterator[Metric]:
        """Its figures."""
        key = f"{self.name}.{self.way}"
        yield Metric(f"{key}.psnr", self.psnr, "dB", "higher", NOISE)
        yield Metric(f"{key}.bytes", self.bytes, "B", "lower", 0.02)
        yield Metric(f"{key}.bytes_each", self.bytes / self.made.gaussians, "B a Gaussian", "lower", 0.02)

    def point(self) -> Point:
        """Where it stands on the chart."""
        return Point(STORAGES[self.way].title, f"SH {self.made.degree}", self.made.seconds, self.psnr, self.bytes)


def run(quick: bool) -> Result:
    """Degrees 0 to 3, each stored in every way."""
    make = _fits.maker(quick)
    if make is None:
        return Result(TITLE, ACCURACY, (), (), (missing(_fits.CAPTURE),), cost="bytes")
    runs = [Run(f"sh{k}", f"SH {k}", _settings(quick, k)) for k in range(4)]
    with _fits.kept() as place:
        found = _fits.all_made(runs, place, make)
        held = _fits.photos(quick).held_out
        stored = [one for name, made in found.items() for one in _stored(name, made, place, held)]
    metrics = [m for name, made in found.items() for m in _trained(name, made)]
    metrics += [m for one in stored for m in one.metrics()]
    points = [one.point() for way in DRAWN for one in stored if one.way == way]
    notes = (*NOTES, *_fits.notes(runs, found, quick))
    return Result(TITLE, ACCURACY, tuple(metrics), tuple(points), notes, (0,), cost="bytes")


def _settings(quick: bool, degree: int) -> Settings:
    if quick:
        return Settings(steps=QUICK_STEPS, max_gaussians=2 * _fits.SMALL, degree=degree, gain=None)
    return Settings(seconds=SECONDS, max_gaussians=MAX_GAUSSIANS, degree=degree, gain=None)


def _trained(name: str, made: Made) -> Iterator[Metric]:
    yield Metric(f"{name}.gaussians", made.gaussians, "count")
    yield Metric(f"{name}.steps", made.steps, "count")
    yield Metric(f"{name}.ssim", made.ssim, "1", "higher", NOISE)
    yield Metric(f"{name}.memory", made.peak, "B", "lower", 0.1)


def _stored(name: str, made: Made, place: Path, held: Sequence[Shot]) -> Iterator[Stored]:
    """A trained scene in every way."""
    cloud = files.load(_fits.scene_of(name, place)).cloud
    for key, way in STORAGES.items():
        size = made.bytes - bytes_saved(cloud, way.harmonics, way.positions)
        yield Stored(name, key, size, measure(way.change(cloud), held).psnr, made)
