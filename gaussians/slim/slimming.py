"""`slim`: the smallest file of a scene that loses at most what was promised, measured from views that chose nothing."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..errors import CheckFailedError, UserError
from ..files import known_formats, load
from ..files.formats.morton import morton_sorted
from ..scene import Scene
from .importance import LAST_SHARE, Importance, Progress, rank
from .loss import EXACT, Loss, Truth
from .optimise import Course
from .reductions import Reducer, Strength
from .report import same_thing
from .views import SIZE, Views, choose_views

CLOSE = 0.04  # dB above the target at which a number of Gaussians counts as found
FINE = 1.005  # ratio of two numbers of Gaussians between which no further one is tried
TRIES = 9  # numbers of Gaussians tried for one setting
EXPECTED = 25  # tries in all, for the progress
SLOPE = 18.0  # dB gained by e times as many Gaussians, as far as nothing is known: 13 to 23 on captures
ROUND = 0.88  # share of the Gaussians kept from one round of the optimisation to the next
CHANCES = 2  # legs that a number of Gaussians is optimised for before it is given up
GAIN = 0.99  # share of the bytes that a stronger setting must reach to be taken
ROUNDINGS = (0.0, 0.15, 0.3, 0.5)  # shares of the allowed error that rounding may take
DULL = (0.0, 0.3, 0.6, 0.8)  # shares of the Gaussians without higher bands
SETS = (8, 4, 16, 64)  # Gaussians for each set of higher coefficients: at first, if that loses too much, and then
EXACT_FORMATS = (".ply",)  # which return every bit
RAISES = 8  # times that the target of the choice is raised because the held-out views lose more
MARGIN = 0.03  # dB by which it is raised beyond what they lack


@dataclass(frozen=True)
class Settings:
    """What `slim` may do.

    Attributes:
        psnr: dB that the held-out views must keep; infinite keeps every bit.
        size: pixels of the longer side of the views.
        steps, seconds: length of the optimisation; at most one is given, without both there is none. In steps, equal
            input gives equal bytes.
    """

    psnr: float = 40.0
    size: int = SIZE
    steps: int | None = None
    seconds: float | None = None

    def __post_init__(self) -> None:
        if not self.psnr > 0:
            raise UserError(f"a PSNR is a positive number of decibels, got {self.psnr:g}; 40 is hardly visible")
        if any(length is not None and not length > 0 for length in (self.steps, self.seconds)):
            raise UserError("an optimisation takes a positive number of seconds or steps; leave it out for none")


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
        steps: of the optimisation.
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
    steps: int = 0
    tried: tuple[tuple[Strength, int], ...] = ()


@dataclass(frozen=True, eq=False)
class _Found:
    """A setting with its file and its loss from the chosen views."""

    strength: Strength
    scene: Scene
    data: bytes
    loss: Loss


@dataclass(frozen=True, eq=False)
class Prepared:
    """What is measured of a scene once, for all formats and promises.

    Attributes:
        views: the views.
        truth, held_out: the pictures from the views that choose and from the held-out ones.
        order: rows of the cloud, the ones to keep first.
        importance: of all Gaussians.
    """

    views: Views
    truth: Truth
    held_out: Truth
    order: NDArray[np.int64]
    importance: Importance


def prepare(
    scene: Scene, cameras: Sequence[Camera] = (), size: int = SIZE, progress: Progress | None = None
) -> Prepared:
    """Choose the views of a scene and rank its Gaussians; see `slim`."""
    views = choose_views(scene, cameras, size)
    order, importance = rank(scene.cloud, views.ranking, progress)
    return Prepared(
        views, Truth(scene.cloud, views.choice), Truth(scene.cloud, views.held_out), order, importance
    )  # fmt: skip


def slim(
    scene: Scene,
    suffix: str,
    settings: Settings,
    cameras: Sequence[Camera] = (),
    progress: Progress | None = None,
    prepared: Prepared | None = None,
) -> Slimmed:
    """The smallest file found whose pictures keep `settings.psnr` dB from the held-out views. Same input, same bytes.

    Args:
        suffix: of the file format, with dot: ".sog", ".spz", ".compressed.ply", ".ply".
        cameras: of photographs of the scene; computed views are used without them.
        progress: called with the stage and its share.
        prepared: what `prepare` gave for this scene; its views are used.

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
        ready = prepared or prepare(scene, cameras, settings.size, say)
        return _Search(scene, suffix, settings, ready, files, say).run()


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
        self, scene: Scene, suffix: str, settings: Settings, ready: Prepared, files: Files, say: Progress
    ) -> None:
        self.scene, self.suffix, self.settings, self.files, self.say = scene, suffix, settings, files, say
        self.views, self.truth, self.held_out = ready.views, ready.truth, ready.held_out
        self.reducer = Reducer(scene, ready.order, ready.importance, suffix)
        self.tried: list[tuple[Strength, int]] = []

    def run(self) -> Slimmed:
        alone = self._alone()
        best, raised = self._kept_promise()
        steps = 0
        if self.settings.steps or self.settings.seconds:
            best, steps, more = self._optimised(best)
            raised += more
        back = self.files.decode(best.data)
        held_out = self.held_out.loss(back.cloud)
        back = back.replace(cloud=back.cloud.replace(group=best.scene.cloud.group))
        return Slimmed(
            best.scene, best.data, best.strength, best.loss, held_out, alone, raised, self.views.source,
            same_thing(self.scene, back, self.views.held_out), steps, tuple(self.tried),
        )  # fmt: skip

    def _kept_promise(self) -> tuple[_Found, int]:
        """The smallest file that keeps the promise from the held-out views too, and how often the target of the choice
        was raised for that."""
        target = self.settings.psnr
        best = self._best(target)
        for raised in range(RAISES):
            if best is None:  # not even the whole scene keeps the raised target
                return self._whole(), raised
            lacking = self._lacking(best)
            if lacking <= 0:
                return best, raised
            target += lacking + MARGIN
            best = self._fewest(best.strength, target)
        return self._whole(), RAISES

    def _lacking(self, found: _Found) -> float:
        """What a file lacks of the promise from the held-out views, dB; at most zero if it keeps it."""
        return self.settings.psnr - self.held_out.loss(self.files.decode(found.data).cloud).psnr

    def _optimised(self, start: _Found) -> tuple[_Found, int, int]:
        """The smallest file with fewer Gaussians that were optimised for it, the steps taken, and how many smaller
        files the held-out views refused.

        Fewer Gaussians are kept and optimised, again and again, until the chosen views lose more than promised or the
        time is over. The smallest of these files that keeps the promise from the held-out views is taken.
        """
        settings, passed = self.settings, list[_Found]()
        course = Course(self.views.training, self.scene.cloud, settings.steps, settings.seconds, self.say)
        cloud, chances = self.reducer.plain(start.strength), CHANCES
        while not course.over and chances:
            fewer = max(self.reducer.least, round(ROUND * len(cloud)))
            if chances == CHANCES and fewer < len(cloud):
                cloud = self.reducer.fewest(cloud, fewer, self.views.choice)
            cloud = course.optimised(cloud)
            found = self._measured(self.reducer.finished(cloud, start.strength), start.strength)
            if found.loss.psnr < settings.psnr:
                chances -= 1  # the same number is optimised further
                continue
            chances = CHANCES
            passed.append(found)
        smaller = sorted((f for f in passed if len(f.data) < len(start.data)), key=lambda f: len(f.data))
        for refused, found in enumerate(smaller):
            if self._lacking(found) <= 0:
                return found, course.steps, refused
        return start, course.steps, len(smaller)

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
        start = Strength(max(1, count // 2), degree, sets=sets)
        best = self._fewest(start, target)
        if best is None and sets:
            best = self._fewest(replace(start, sets=count // SETS[1]), target)
        if best is None:
            best = self._fewest(replace(start, sets=0), target)
        for name, ladder in self._ladders(target):
            for value in ladder:
                if best is None:
                    return None
                change: dict[str, Any] = {name: value}
                found = self._fewest(replace(best.strength, **change), target, best)
                if found is None:
                    break
                best = found
        return best

    def _ladders(self, target: float) -> Iterator[tuple[str, list[float] | list[int]]]:
        """The knobs and their values, from weak to strong."""
        count, degree = len(self.scene.cloud), self.scene.cloud.degree
        packed = self.suffix in (".sog", ".spz")
        if degree and self.suffix == ".sog":
            yield "sets", [max(1, count // n) for n in SETS[2:]]
        if degree and packed:
            yield "dull", list(DULL[1:])
        if degree:
            yield "degree", list(range(degree - 1, -1, -1))
        if packed:
            yield "rounding", [share * 10 ** (-target / 10) for share in ROUNDINGS[1:]]

    def _fewest(self, strength: Strength, target: float, beat: _Found | None = None) -> _Found | None:
        """The fewest Gaussians that keep `target` dB from the chosen views; None if all of them do not, or if the file
        would not get smaller than that of `beat`.

        The PSNR is about linear in the logarithm of the number. Each try interpolates between the nearest numbers that
        keep the target and that do not.
        """
        above: _Found | None = None
        below: _Found | None = None
        wanted: int | None = strength.count
        for _ in range(TRIES):
            if wanted is None:
                break
            self.say("search", min(1.0, len(self.tried) / EXPECTED))
            found = self._try(replace(strength, count=wanted))
            if found.loss.psnr < target:
                below = found
                if beat is not None and len(found.data) > GAIN * len(beat.data):
                    return None  # more Gaussians only take more bytes
            else:
                above = found
                if found.loss.psnr < target + CLOSE:
                    break
            wanted = self._next(above, below, target)
        if above is None or (beat is not None and len(above.data) > GAIN * len(beat.data)):
            return None
        return above

    def _next(self, above: _Found | None, below: _Found | None, target: float) -> int | None:
        """The next number of Gaussians to try; None if there is none between those that were tried."""
        count = len(self.scene.cloud)
        least = min(count, max(self.reducer.least, round(LAST_SHARE * count)))
        if above is None:
            assert below is not None
            if below.strength.count >= count:
                return None
            more = math.exp(max((target - below.loss.psnr) / SLOPE, 0.01))
            return min(count, math.ceil(below.strength.count * min(more * 1.02, 2.0)))
        most = above.strength.count
        if below is None:
            fewer = math.exp(-(above.loss.psnr - target) / SLOPE)
            return None if most <= least else max(least, round(most * min(max(fewer, 0.4), 0.98)))
        few = below.strength.count
        if most <= few * FINE + 1:
            return None
        share = (above.loss.psnr - target) / max(above.loss.psnr - below.loss.psnr, 1e-9)
        share = min(max(share * 0.98, 0.05), 0.95)
        wanted = round(math.exp((1 - share) * math.log(most) + share * math.log(few)))
        return wanted if few < wanted < most else None

    def _try(self, strength: Strength) -> _Found:
        return self._measured(self.reducer.at(strength), strength)

    def _measured(self, smaller: Scene, strength: Strength) -> _Found:
        data = self.files.encode(smaller)
        loss = self.truth.loss(self.files.decode(data).cloud)
        done = replace(strength, count=len(smaller.cloud))
        self.tried.append((done, len(data)))
        return _Found(done, smaller, data, loss)

    def _whole(self) -> _Found:
        """Everything kept: what the format alone loses, which was measured to keep the promise."""
        return self._try(Strength(len(self.scene.cloud), self.scene.cloud.degree))
