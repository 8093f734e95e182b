"""`slim`: the smallest file of a scene that loses at most what was promised, measured from views that chose nothing."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ..camera import Camera
from ..errors import CheckFailedError, UserError
from ..files import known_formats, load
from ..files.formats.morton import morton_sorted
from ..scene import Scene
from .importance import LAST_SHARE, Progress, rank
from .loss import EXACT, Loss, Truth
from .reductions import Reducer, Strength
from .report import same_thing
from .views import SIZE, Views, choose_views

CLOSE = 0.04  # dB above the target at which a number of Gaussians counts as found
FINE = 1.005  # ratio of two numbers of Gaussians between which no further one is tried
TRIES = 9  # numbers of Gaussians tried for one setting
GAIN = 0.99  # share of the bytes that a stronger setting must reach to be taken
ROUNDINGS = (0.0, 0.15, 0.3, 0.5)  # shares of the allowed error that rounding may take
DULL = (0.0, 0.3, 0.6, 0.8)  # shares of the Gaussians without higher bands
SETS = (16, 64, 256)  # Gaussians for each set of higher coefficients; the format itself takes 4, which is slow
EXACT_FORMATS = (".ply",)  # which return every bit
RAISES = 8  # times that the target of the choice is raised because the held-out views lose more
MARGIN = 0.03  # dB by which it is raised beyond what they lack


@dataclass(frozen=True)
class Settings:
    """What `slim` may do.

    Attributes:
        psnr: dB that the held-out views must keep; infinite keeps every bit.
        size: pixels of the longer side of the views.
    """

    psnr: float = 40.0
    size: int = SIZE

    def __post_init__(self) -> None:
        if not self.psnr > 0:
            raise UserError(f"a PSNR is a positive number of decibels, got {self.psnr:g}; 40 is hardly visible")


@dataclass(frozen=True, eq=False)
class Slimmed:
    """A scene made smaller.

    Attributes:
        scene: rows as they are in the file; ids are those of the original.
        data: the file's bytes.
        strength: what was left out; None if nothing was.
        choice, held_out: loss from the views that chose and from those that did not; None if nothing was lost.
        alone: loss of the format alone, from the held-out views; None if nothing was lost.
        raised: how often the held-out views lost more than promised and a weaker setting was taken.
        cameras: where the views come from.
        same_thing: share of the held-out pixels that show the same thing of the language field as before.
        tried: settings tried, as (strength, bytes), in the order tried.
    """

    scene: Scene
    data: bytes
    strength: Strength | None
    choice: Loss | None
    held_out: Loss | None
    alone: Loss | None
    raised: int = 0
    cameras: str = ""
    same_thing: float | None = None
    tried: tuple[tuple[Strength, int], ...] = ()


@dataclass(frozen=True, eq=False)
class _Found:
    """A setting with its file and its loss from the chosen views."""

    strength: Strength
    scene: Scene
    data: bytes
    loss: Loss


def slim(
    scene: Scene, suffix: str, settings: Settings, cameras: Sequence[Camera] = (), progress: Progress | None = None
) -> Slimmed:
    """The smallest file found whose pictures keep `settings.psnr` dB from the held-out views. Same input, same bytes.

    Args:
        suffix: of the file format, with dot: ".sog", ".spz", ".compressed.ply", ".ply".
        cameras: of photographs of the scene; computed views are used without them.

    Raises:
        UserError: the format cannot be written, or no view shows anything.
        CheckFailedError: the format alone loses more than promised; the message says what it keeps.
    """
    if len(scene.cloud) == 0:
        raise UserError("there is nothing to make smaller: the scene holds zero Gaussians")
    say = progress or (lambda stage, share: None)
    with tempfile.TemporaryDirectory() as folder:
        files = Files(Path(folder), suffix)
        if settings.psnr >= EXACT:
            return _unchanged(scene, files, suffix)
        views = choose_views(scene, cameras, settings.size)
        return _Search(scene, suffix, settings, views, files, say).run()


class Files:
    """Encodes scenes in the format of a suffix, in row order, and reads them back; `folder` is for scratch files.

    Raises:
        UserError: no format that can be written has this suffix.
    """

    def __init__(self, folder: Path, suffix: str) -> None:
        write = next((f.write for f in known_formats() if suffix in f.suffixes), None)
        if write is None:
            writable = ", ".join(s for f in known_formats() if f.write for s in f.suffixes)
            raise UserError(f"scenes are written as {writable}, not as {suffix}")
        self._path, self._write = folder / f"a{suffix}", write

    def encode(self, scene: Scene) -> bytes:
        """The bytes of a file whose rows are the scene's."""
        with self._path.open("wb") as file:
            self._write(scene, file)
        return self._path.read_bytes()

    def decode(self, data: bytes) -> Scene:
        """The scene in these bytes."""
        self._path.write_bytes(data)
        return load(self._path)


def _unchanged(scene: Scene, files: Files, suffix: str) -> Slimmed:
    """The same scene, for a promise that nothing is lost."""
    if suffix not in EXACT_FORMATS:
        raise CheckFailedError(f"{suffix} files always lose something; only .ply keeps every bit: write NAME.ply")
    return Slimmed(scene, files.encode(scene), None, None, None, None)


class _Search:
    """The search for the strongest setting that keeps the promise."""

    def __init__(
        self, scene: Scene, suffix: str, settings: Settings, views: Views, files: Files, say: Progress
    ) -> None:
        self.scene, self.suffix, self.settings, self.views, self.files, self.say = (
            scene, suffix, settings, views, files, say,
        )  # fmt: skip
        self.truth, self.held_out = Truth(scene.cloud, views.choice), Truth(scene.cloud, views.held_out)
        self.tried: list[tuple[Strength, int]] = []

    def run(self) -> Slimmed:
        alone = self._alone()
        order, importance = rank(self.scene.cloud, self.views.ranking, self.say)
        self.reducer = Reducer(self.scene, order, importance, self.suffix)
        target, best, raised = self.settings.psnr, None, 0
        while True:
            best = self._best(target) if best is None else self._fewest(best.strength, target)
            if best is None:  # not even the whole scene keeps a raised target
                best = self._whole()
            back = self.files.decode(best.data)
            held_out = self.held_out.loss(back.cloud)
            lacking = self.settings.psnr - held_out.psnr
            if lacking <= 0:
                break
            raised += 1
            if raised > RAISES:
                best = self._whole()
                back = self.files.decode(best.data)
                held_out = self.held_out.loss(back.cloud)
                break
            target += lacking + MARGIN
        back = back.replace(cloud=back.cloud.replace(group=best.scene.cloud.group))
        return Slimmed(
            best.scene, best.data, best.strength, best.loss, held_out, alone, raised, self.views.source,
            same_thing(self.scene, back, self.views.held_out), tuple(self.tried),
        )  # fmt: skip

    def _alone(self) -> Loss:
        """The loss of the format alone.

        Raises:
            CheckFailedError: it is more than promised.
        """
        self.say("format", 0.0)
        back = self.files.decode(self.files.encode(morton_sorted(self.scene))).cloud
        alone = self.held_out.loss(back)
        kept = min(alone.psnr, self.truth.loss(back).psnr)
        if kept < self.settings.psnr:
            raise CheckFailedError(
                f"{self.suffix} alone keeps {kept:.2f} dB of this scene with nothing left out, "
                f"{self.settings.psnr:g} were asked for; ask for less or choose a finer format (.ply keeps every bit)"
            )
        return alone

    def _best(self, target: float) -> _Found | None:
        """The setting with the smallest file: one knob after the other is turned while the file shrinks."""
        count, degree = len(self.scene.cloud), self.scene.cloud.degree
        sets = count // SETS[0] if degree and self.suffix == ".sog" else 0
        start = Strength(count, degree, sets=sets)
        best = self._fewest(start, target)
        if best is None and sets:
            start = replace(start, sets=0)
            best = self._fewest(start, target)
        for name, ladder in self._ladders(target):
            for value in ladder:
                change: dict[str, Any] = {name: value}
                strength = replace(best.strength if best else start, **change)
                found = self._fewest(strength, target)
                if found is None or (best is not None and len(found.data) > GAIN * len(best.data)):
                    break
                best = found
        return best

    def _ladders(self, target: float) -> Iterator[tuple[str, list[float] | list[int]]]:
        """The knobs and their values, from weak to strong."""
        count, degree = len(self.scene.cloud), self.scene.cloud.degree
        packed = self.suffix in (".sog", ".spz")
        if degree and self.suffix == ".sog":
            yield "sets", [max(1, count // n) for n in SETS]
        if degree and packed:
            yield "dull", list(DULL[1:])
        if degree:
            yield "degree", list(range(degree - 1, -1, -1))
        if packed:
            yield "rounding", [share * 10 ** (-target / 10) for share in ROUNDINGS[1:]]

    def _fewest(self, strength: Strength, target: float) -> _Found | None:
        """The fewest Gaussians that keep `target` dB from the chosen views; None if all of them do not.

        The PSNR is about linear in the logarithm of the number. Each try interpolates between the nearest numbers that
        keep the target and that do not.
        """
        self.say("search", min(1.0, len(self.tried) / 40))
        count = len(self.scene.cloud)
        least = min(count, max(self.reducer.least, round(LAST_SHARE * count)))
        above = self._try(replace(strength, count=count))
        if above.loss.psnr < target:
            return None
        below: tuple[float, float] | None = None
        for _ in range(TRIES):
            wanted = self._next(above, below, target, least)
            if wanted is None:
                break
            found = self._try(replace(strength, count=wanted))
            if found.loss.psnr >= target:
                above = found
                if found.loss.psnr < target + CLOSE:
                    break
            else:
                below = (float(wanted), found.loss.psnr)
        return above

    def _next(self, above: _Found, below: tuple[float, float] | None, target: float, least: int) -> int | None:
        """The next number of Gaussians to try; None if the number is found."""
        most = above.strength.count
        if below is None:
            return None if most <= least else max(least, round(0.6 * most))
        if most <= below[0] * FINE + 1:
            return None
        share = (above.loss.psnr - target) / max(above.loss.psnr - below[1], 1e-9)
        share = min(max(share * 0.98, 0.05), 0.95)
        wanted = round(math.exp((1 - share) * math.log(most) + share * math.log(below[0])))
        return wanted if below[0] < wanted < most else None

    def _try(self, strength: Strength) -> _Found:
        smaller = self.reducer.at(strength)
        data = self.files.encode(smaller)
        loss = self.truth.loss(self.files.decode(data).cloud)
        done = replace(strength, count=len(smaller.cloud))
        self.tried.append((done, len(data)))
        return _Found(done, smaller, data, loss)

    def _whole(self) -> _Found:
        """Everything kept: what the format alone loses, which was measured to keep the promise."""
        return self._try(Strength(len(self.scene.cloud), self.scene.cloud.degree))
