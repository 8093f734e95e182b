"""The receipt of an edit: checks with measured values, counts, pixels, seconds and back ends, as JSON data."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field

Vec3 = tuple[float, float, float]


class Check(BaseModel):
    """One post-condition and its measured value.

    Attributes:
        name: short and stable, e.g. "outside unchanged".
        passed: whether the measured value keeps the bound; a check without a bound only reports.
        value: what was measured.
        bound: the largest (or, with `at_least`, the smallest) value that passes; None if it only reports.
        at_least: whether the bound is a lower one.
        unit: of value and bound: "Gaussians", "ΔE", "m", "units", "px", "1".
        sentence: the check in words, for a person.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    name: str
    passed: bool
    value: float
    bound: float | None = None
    at_least: bool = False
    unit: str = "1"
    sentence: str = ""


def at_most(name: str, value: float, bound: float, unit: str, sentence: str) -> Check:
    """A check that passes while `value <= bound` (NaN fails)."""
    return Check(name=name, passed=value <= bound, value=value, bound=bound, unit=unit, sentence=sentence)


def at_least(name: str, value: float, bound: float, unit: str, sentence: str) -> Check:
    """A check that passes while `value >= bound` (NaN fails)."""
    return Check(
        name=name, passed=value >= bound, value=value, bound=bound, at_least=True, unit=unit, sentence=sentence
    )


def report(name: str, value: float, unit: str, sentence: str) -> Check:
    """A check that only reports a measured value; it always passes."""
    return Check(name=name, passed=True, value=value, unit=unit, sentence=sentence)


class SelectionSummary(BaseModel):
    """The selection that an operation worked on, without its Gaussians' ids."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    asked: str
    verdict: str
    gaussians: int
    groups: tuple[int, ...] = ()
    things: tuple[str, ...] = ()
    reason: str = ""


class Pixels(BaseModel):
    """Changed pixels in the viewer's picture.

    Attributes:
        width, height: of the compared pictures, pixels.
        changed: pixels whose colour moved by more than `threshold` in some channel.
        changed_outside: those of them outside the target's dilated silhouettes before and after.
        silhouette: pixels inside these silhouettes.
        threshold: in display space, 0..1.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    width: int
    height: int
    changed: int
    changed_outside: int
    silhouette: int
    threshold: float


class Repair(BaseModel):
    """What was tried after a judge refused an edit.

    Attributes:
        failed: the checks that refused it.
        tried: what was done instead, in words: "selected 312 more Gaussians that were left behind".
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    failed: tuple[Check, ...]
    tried: str


class Judgement(BaseModel):
    """What a judge measured after an edit, from the scenes alone.

    Attributes:
        judge: "built-in", or with the vision-language model that was asked too.
        checks: each with its value.
        repairs: what was tried before these checks passed, in order; empty if the first edit passed.
        seconds: that judging and repairing took.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    judge: str
    checks: tuple[Check, ...]
    repairs: tuple[Repair, ...] = ()
    seconds: float = 0.0

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return all(check.passed for check in self.checks)


class Filled(BaseModel):
    """What was done to a surface that an edit revealed.

    Attributes:
        surface: in words: "the floor", "the wall".
        gaussians: how many were made.
        area: of the hole, square scene units.
        sure: how sure the fill is, in [0, 1].
        lighter: Gaussians of the surface that lay in the thing's contact shadow and are lighter now.
        darker: Gaussians of the surface that lie in its shadow where it stands now.
        reason: why nothing was made; "" if something was.
        place: lowest and highest corner of the box around a hole that was left, world; None without one.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    surface: str
    gaussians: int
    area: float
    sure: float
    lighter: int = 0
    darker: int = 0
    reason: str = ""
    place: tuple[Vec3, Vec3] | None = None


class Lifted(BaseModel):
    """How the Gaussians of a fill were optimised against pictures.

    Attributes:
        source: of the pictures: "photographs", or the model that inpainted them.
        looked: pictures that show the place.
        made: Gaussians that were made from inpainted views.
        replaced: Gaussians of the fill from the scene itself that these replace.
        views: those that were used: photographs that see behind what is gone, views that were inpainted.
        held_out: of these, how many measured the result and were not optimised against; 0: all did both.
        pixels: of all these pictures, that count.
        psnr_before, psnr_after: dB in these pixels, with the plain fill and now; None if nothing was measured.
        steps: of the optimisation; fewer than the work is worth where a clock ended it.
        seconds: wall time.
        reason: why the fill stays as it was; "" if it was optimised.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    source: str
    looked: int = 0
    made: int = 0
    replaced: int = 0
    views: int = 0
    held_out: int = 0
    pixels: int = 0
    psnr_before: float | None = None
    psnr_after: float | None = None
    steps: int = 0
    seconds: float = 0.0
    reason: str = ""


class Receipt(BaseModel):
    """What one operation did; `Receipt.model_validate_json(receipt.to_json()) == receipt`.

    Attributes:
        op: the operation as JSON.
        selection: what it was applied to; for insert, what was inserted.
        changed, added, removed: counts of Gaussians.
        total: Gaussians in the scene afterwards.
        columns: the columns of the cloud whose values changed for Gaussians that stayed.
        outside_changed: Gaussians outside the target that differ from before in any bit (0, or the edit was refused).
        pixels: what changed in the viewer's picture, if it was compared.
        checks: every post-condition.
        notes: what the user should know: assumptions taken, defaults used, neighbours touched.
        seconds: wall time of each stage: "resolve", "apply", "check", "see", "pixels".
        backends: what was used, by role: "resolver", "encoder", "renderer".
        dry_run: True if nothing was kept.
        judged: what the judge measured, if there was one.
        filled: what was done to the surfaces that the edit revealed.
        lifted: how the fill was optimised against pictures, one entry for each source of them.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    op: dict[str, Any]
    selection: SelectionSummary
    changed: int
    added: int
    removed: int
    total: int
    columns: tuple[str, ...]
    outside_changed: int
    pixels: Pixels | None = None
    checks: tuple[Check, ...]
    notes: tuple[str, ...] = ()
    seconds: dict[str, float] = Field(default_factory=dict)
    backends: dict[str, str] = Field(default_factory=dict)
    dry_run: bool = False
    judged: Judgement | None = None
    filled: tuple[Filled, ...] = ()
    lifted: tuple[Lifted, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return all(check.passed for check in self.checks)

    def to_json(self) -> str:
        """One line of JSON."""
        return self.model_dump_json()

    def sentence(self) -> str:
        """The receipt in one line for a person: "recolor the red chair: 1,204 Gaussians changed, 5 checks passed"."""
        counts = [f"{n:,} {word}" for n, word in self._counts() if n] or [self._found()]
        failed = [c.name for c in self.checks if not c.passed]
        verdict = f"failed: {', '.join(failed)}" if failed else f"{len(self.checks)} checks passed"
        judged = f", {len(self.judged.checks)} more by the judge" if self.judged is not None else ""
        return f"{self.op.get('op', '?')} {self.selection.asked}: {', '.join(counts)}; {verdict}{judged}"

    def _found(self) -> str:
        """What to say of an operation that changed nothing: what it selected, or "nothing changed"."""
        groups = len(self.selection.groups)
        things = f" in {groups:,} thing{'s' if groups > 1 else ''}" if groups else ""
        said = f"{self.selection.gaussians:,} Gaussian{'s' if self.selection.gaussians != 1 else ''}"
        return f"{said}{things} selected" if self.op.get("op") == "select" else "nothing changed"

    def _counts(self) -> list[tuple[int, str]]:
        return [(self.changed, "changed"), (self.added, "added"), (self.removed, "removed")]
