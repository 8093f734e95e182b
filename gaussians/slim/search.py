"""The search for the smallest file that keeps a promised PSNR: settings are tried, written, read back and measured."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from ..errors import CheckFailedError
from ..files.formats.morton import morton_sorted
from ..scene import Scene
from .counting import Tried, next_count
from .encoding import Files
from .importance import Progress
from .loss import Loss
from .optimise import Course
from .preparing import Prepared, Settings
from .reductions import Reducer, Strength

CLOSE = 0.04  # dB above the target at which a number of Gaussians counts as found
TRIES = 9  # numbers of Gaussians tried for one setting
EXPECTED = 25  # tries in all, for the progress
ROUND = 0.95  # share of the Gaussians kept from one round of the optimisation to the next
GAP = 1.2  # times what the held-out views lose more than the chosen ones, which optimised files must keep as well
CHANCES = 2  # legs that a number of Gaussians is optimised for before it is given up
GAIN = 0.99  # share of the bytes that a stronger setting must reach to be taken
ROUNDINGS = (0.07, 0.15, 0.3, 0.5)  # shares of the allowed error that rounding may take
DULL = (0.3, 0.6, 0.8)  # shares of the Gaussians without higher bands
SETS = (16, 4, 64, 256)  # Gaussians for each set of higher coefficients: at first, if that loses too much, and then
RAISES = 8  # times that the target of the choice is raised because the held-out views lose more
MARGIN = 0.03  # dB by which it is raised beyond what they lack


@dataclass(frozen=True, eq=False)
class Found:
    """A setting with its file and its loss from the chosen views."""

    strength: Strength
    scene: Scene
    data: bytes
    loss: Loss


class Search:
    """The search for the strongest setting that keeps the promise.

    Attributes:
        raised: how often the held-out views lost more than promised and a weaker setting was taken.
        steps: of the optimisation.
        tried: settings tried, as (strength, bytes, dB from the chosen views).
    """

    def __init__(
        self, scene: Scene, suffix: str, settings: Settings, ready: Prepared, files: Files, say: Progress
    ) -> None:
        self.scene, self.suffix, self.settings, self.files, self.say = scene, suffix, settings, files, say
        self.views, self.truth, self.held_out = ready.views, ready.truth, ready.held_out
        self.reducer = Reducer(scene, ready.order, ready.importance, suffix)
        self.tried: list[tuple[Strength, int, float]] = []
        self.raised = self.steps = 0

    def run(self) -> tuple[Found, Loss]:
        """The smallest file that keeps the promise, and the loss of the format alone from the held-out views.

        Raises:
            CheckFailedError: the format alone loses more than promised; the message says what it keeps.
        """
        alone = self._alone()
        best = self._kept_promise()
        if self.settings.steps or self.settings.seconds:
            best = self._optimised(best)
        return best, alone

    def _kept_promise(self) -> Found:
        """The smallest file that keeps the promise from the held-out views too: the target of the choice is raised by
        what they lack."""
        target = self.settings.psnr
        best = self._best(target)
        while best is not None and self.raised < RAISES:
            lacking = self._lacking(best)
            if lacking <= 0:
                return best
            self.raised += 1
            target += lacking + MARGIN
            best = self._fewest(best.strength, target) or self._best(target)
        return self._whole()  # not even all Gaussians keep the raised target

    def _lacking(self, found: Found) -> float:
        """What a file lacks of the promise from the held-out views, dB; at most zero if it keeps it."""
        return self.settings.psnr - self.held_out.loss(self.files.decode(found.data).cloud).psnr

    def _optimised(self, start: Found) -> Found:
        """The smallest file with fewer Gaussians that were optimised for it, or `start`.

        Fewer Gaussians are kept and optimised, again and again, until the chosen views lose too much or the time is
        over. The smallest of these files that keeps the promise from the held-out views is taken.
        """
        settings, passed = self.settings, list[Found]()
        wanted = settings.psnr + GAP * max(0.0, start.loss.psnr + self._lacking(start) - settings.psnr)
        course = Course(self.views.training, self.scene.cloud, settings.steps, settings.seconds, self.say)
        cloud, chances = self.reducer.plain(start.strength), CHANCES
        while not course.over and chances:
            fewer = max(self.reducer.least, round(ROUND * len(cloud)))
            if chances == CHANCES and fewer < len(cloud):
                cloud = self.reducer.fewest(cloud, fewer, self.views.choice)
            cloud = course.optimised(cloud)
            found = self._measured(self.reducer.finished(cloud, start.strength), start.strength)
            if found.loss.psnr < wanted:
                chances -= 1  # the same number is optimised further
                continue
            chances = CHANCES
            passed.append(found)
        self.steps = course.steps
        for found in sorted((f for f in passed if len(f.data) < len(start.data)), key=lambda f: len(f.data)):
            if self._lacking(found) <= 0:
                return found
            self.raised += 1
        return start

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

    def _best(self, target: float) -> Found | None:
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
        if packed:
            yield "rounding", [share * 10 ** (-target / 10) for share in ROUNDINGS]
        if degree and self.suffix == ".sog":
            yield "sets", [max(1, count // n) for n in SETS[2:]]
        if degree and packed:
            yield "dull", list(DULL)
        if degree:
            yield "degree", list(range(degree - 1, -1, -1))

    def _fewest(self, strength: Strength, target: float, beat: Found | None = None) -> Found | None:
        """The fewest Gaussians that keep `target` dB from the chosen views; None if all of them do not, or if the file
        would not get smaller than that of `beat`.

        The PSNR is about linear in the logarithm of the number. Each try interpolates between the nearest numbers that
        keep the target and that do not.
        """
        above: Found | None = None
        below: Found | None = None
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

    def _next(self, above: Found | None, below: Found | None, target: float) -> int | None:
        """The next number of Gaussians to try; None if there is none between those that were tried."""
        return next_count(_tried(above), _tried(below), target, len(self.scene.cloud), self.reducer.least)

    def _try(self, strength: Strength) -> Found:
        return self._measured(self.reducer.at(strength), strength)

    def _measured(self, smaller: Scene, strength: Strength) -> Found:
        data = self.files.encode(smaller)
        loss = self.truth.loss(self.files.decode(data).cloud)
        done = replace(strength, count=len(smaller.cloud))
        self.tried.append((done, len(data), loss.psnr))
        return Found(done, smaller, data, loss)

    def _whole(self) -> Found:
        """Everything kept: what the format alone loses, which was measured to keep the promise."""
        return self._try(Strength(len(self.scene.cloud), self.scene.cloud.degree))


def _tried(found: Found | None) -> Tried | None:
    return None if found is None else Tried(found.strength.count, found.loss.psnr)
