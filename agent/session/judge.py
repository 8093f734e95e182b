"""The judge loop: an operation is carried out, judged, repaired at most twice, and at last taken back.

The checks are measured from the scenes by `tools.judging`, which reads nothing that the edit reports of itself. A scene
is a value: taking an edit back is keeping the old reference.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ...gaussians.errors import BackendError, CheckFailedError, ScenewrightError, UserError
from .judge_by_sight import SEEN

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from torch import Tensor

    from ...gaussians.language.query.selection import Selection
    from ...gaussians.scene import Scene
    from ...tools.execute import Done
    from ...tools.judging.examine import Findings
    from ...tools.operation import Context, EditOp
    from ...tools.receipt import Check, Judgement, Receipt, Repair
    from .vision_client import VisionClient

JUDGES = ("built-in", "vlm")
REPAIRS = 2  # attempts after the first
_NEXT_SEED = 1009  # added to the seed for another design and another spot
_SPOT = frozenset({"carried", "free of others", "placed as asked", "in its place", "looks as named",
                   "seen in the colour", f"{SEEN}done", f"{SEEN}right thing", f"{SEEN}plausible"})  # fmt: skip
_UNNAMED = frozenset({"looks as named", f"{SEEN}right thing"})
_LEFT = frozenset({"nothing left behind", f"{SEEN}no residue"})


class JudgedError(CheckFailedError):
    """An edit was judged a failure, could not be repaired and was taken back.

    Attributes:
        judgement: what was measured at last, and what was tried.
    """

    def __init__(self, message: str, judgement: Judgement) -> None:
        super().__init__(message)
        self.judgement = judgement


@dataclass(frozen=True, eq=False)
class _Try:
    """One way to carry out an operation again.

    Attributes:
        context: of the operation.
        selection: what its words are taken to mean; None: they are resolved as before.
        told: what is different, in words.
        scene: the scene to carry it out on, where what was left behind is filed under its thing; None: as it was.
    """

    context: Context
    selection: Selection | None
    told: str
    scene: Scene | None = None


def known_judge(name: str | None, vision: bool) -> str | None:
    """The name of a judge, None for "off".

    Args:
        vision: whether there is a vision model.

    Raises:
        UserError: there is no such judge, or it needs a vision model.
    """
    if name is None or name == "off":
        return None
    if name not in JUDGES:
        raise UserError(f"there is no judge {name!r}; choose {', '.join(JUDGES)} or off")
    if name == "vlm" and not vision:
        raise UserError("the judge 'vlm' needs a vision model; name one with --vlm or SCENEWRIGHT_VLM")
    return name


@dataclass(frozen=True)
class Judge:
    """Carries out operations and judges them.

    Attributes:
        vision: a vision model that is asked where the measured checks pass; None: they alone decide.
    """

    vision: VisionClient | None = None

    @property
    def name(self) -> str:
        """As receipts name it."""
        return "built-in" if self.vision is None else f"built-in, {self.vision.backend.name}"

    def carry_out(
        self, scene: Scene, op: EditOp, context: Context, selection: Selection | None = None, instruction: str = ""
    ) -> Done:
        """As `execute.carry_out`, and judged; the receipt holds what was measured and repaired.

        Args:
            selection: what to apply it to, instead of resolving the operation's own query.
            instruction: the user's words, if they ask for this operation alone; without it no vision model is asked.

        Raises:
            JudgedError: the edit failed, also after the repairs. The scene is as before.
            ScenewrightError: as `execute.carry_out`, of the first attempt.
        """
        from ...tools import execute
        from ...tools.receipt import Judgement, Repair

        done = execute.carry_out(scene, op, context, selection, seen=False)
        started = time.perf_counter()
        found = self._findings(scene, done.scene, op, _Try(context, selection, ""), instruction)
        repairs: list[Repair] = []
        while not found.passed and len(repairs) < REPAIRS:
            again = next(_ways(scene, op, context, found, tuple(r.tried for r in repairs), selection), None)
            if again is None:
                break
            repairs.append(Repair(failed=found.failed, tried=again.told))
            try:
                done = execute.carry_out(again.scene or scene, op, again.context, again.selection, seen=False)
            except ScenewrightError as error:
                repairs[-1] = repairs[-1].model_copy(update={"tried": f"{again.told}, which failed: {error}"})
                continue
            found = self._findings(scene, done.scene, op, again, instruction)
        seconds = time.perf_counter() - started
        judgement = Judgement(judge=self.name, checks=found.checks, repairs=tuple(repairs), seconds=seconds)
        if not found.passed:
            raise JudgedError(_message(f"{op.op} {op.subject()}", found.failed, repairs), judgement)
        return done._replace(receipt=_with_judgement(done.receipt, judgement))

    def look_at_all(self, before: Scene, after: Scene, instruction: str, receipts: Sequence[Receipt]) -> list[Receipt]:
        """The receipts of an instruction of several operations; the last one also holds what a vision model says.

        Raises:
            JudgedError: it finds that the instruction was not carried out as asked.
        """
        last = receipts[-1].judged
        if self.vision is None or last is None or after is before:
            return list(receipts)
        started = time.perf_counter()
        seen = self._seen(before, after, instruction)
        seconds = last.seconds + time.perf_counter() - started
        judgement = last.model_copy(update={"checks": (*last.checks, *seen), "seconds": seconds})
        if not judgement.passed:
            failed = tuple(c for c in seen if not c.passed)
            raise JudgedError(_message(f"{instruction!r}", failed, []), judgement)
        return [*receipts[:-1], receipts[-1].model_copy(update={"judged": judgement})]

    def _findings(self, scene: Scene, after: Scene, op: EditOp, how: _Try, instruction: str) -> Findings:
        """What is measured, and if that passes, what the vision model sees."""
        from ...tools.judging.case import Case
        from ...tools.judging.examine import examine

        found = examine(Case(how.scene or scene, after, op, how.context, how.selection))
        if not found.passed or not instruction or self.vision is None or after is scene:
            return found
        return replace(found, checks=(*found.checks, *self._seen(scene, after, instruction)))

    def _seen(self, before: Scene, after: Scene, instruction: str) -> tuple[Check, ...]:
        """What the vision model says; a check that only reports where it is no help."""
        from ...tools.receipt import report
        from .judge_by_sight import checks_by_sight

        assert self.vision is not None
        if before.language is None or after.language is None:
            return (report(f"{SEEN}nothing", 0, "views", "the scene is not embedded, so no views were chosen"),)
        try:
            return checks_by_sight(instruction, before, after, self.vision)
        except BackendError as error:
            return (report(f"{SEEN}nothing", 0, "views", f"the vision model was no help: {error}"),)


def _with_judgement(receipt: Receipt, judgement: Judgement) -> Receipt:
    """The receipt with what was judged; repairs and a model that was no help are told as notes."""
    unseen = [c.sentence for c in judgement.checks if c.name == f"{SEEN}nothing"]
    notes = (*receipt.notes, *(_note(r) for r in judgement.repairs), *unseen)
    seconds = {**receipt.seconds, "judge": judgement.seconds}
    return receipt.model_copy(update={"judged": judgement, "notes": notes, "seconds": seconds})


def _ways(
    scene: Scene,
    op: EditOp,
    context: Context,
    findings: Findings,
    tried: tuple[str, ...],
    bound: Selection | None = None,
) -> Iterator[_Try]:
    """What may repair the failure and was not tried yet, the likeliest first; `bound` is what it is about, if that was
    settled before."""
    failed = {check.name for check in findings.failed}
    if failed & _LEFT and len(findings.residue) and not tried:
        yield _grown(scene, op, context, findings.residue, bound)
    if op.op in ("insert", "replace") and failed & _SPOT:
        told = "another design" + (" and spot" if len(tried) else "")
        seeded = replace(context, seed=context.seed + _NEXT_SEED * (len(tried) + 1))
        if told not in tried:
            yield _Try(seeded, bound, told)
    elif bound is None and failed & _UNNAMED and (other := _other_candidate(scene, op, context)) is not None:
        told = f"the other candidate, {other.candidates[0].describe()}" if other.candidates else "the other candidate"
        if told not in tried:
            yield _Try(context, other, told)
    told = "carried out again"
    if told not in tried and any(name not in _LEFT | _UNNAMED and not name.startswith(SEEN) for name in failed):
        yield _Try(context, bound, told)


def _grown(scene: Scene, op: EditOp, context: Context, residue: Tensor, bound: Selection | None = None) -> _Try:
    """The operation on its target together with what was left behind."""
    import torch

    from ...tools.judging.refile import refiled

    query = op.query()
    assert query is not None
    meant = context.resolve(scene, query).require() if bound is None else bound
    told = f"selected {len(residue):,} more Gaussians that were left behind"
    filed = refiled(scene, meant, residue)
    if filed is not None and bound is None:
        return _Try(context, None, told, filed)
    selection = replace(meant, ids=torch.unique(torch.cat([meant.ids, residue])))
    return _Try(context, selection, told, filed)


def _other_candidate(scene: Scene, op: EditOp, context: Context) -> Selection | None:
    """The only other thing that the words may mean, if the encoder finds it to be what they name."""
    from ...gaussians.language.query.query import Query
    from ...tools.judging import appearance

    query, encoder = op.query(), appearance.embedded()
    if query is None or query.pick != "one" or not appearance.is_looked_for(query, encoder):
        return None
    first = context.resolve(scene, query)
    if first.verdict != "found" or not first.groups:
        return None
    other = context.resolve(scene, query.model_copy(update={"exclude": (Query(groups=first.groups),)}))
    if other.verdict != "found":
        return None
    cloud = scene.cloud[other.mask(scene.cloud)]
    seen = float(appearance.likeness(encoder, query.text.lower(), [cloud], scene)[0])
    return other if seen >= encoder.calibration.threshold else None


def _note(repair: Repair) -> str:
    """A repair as a note of the receipt."""
    return f"the judge refused the first result ({', '.join(c.name for c in repair.failed)}): {repair.tried}"


def _message(what: str, failed: tuple[Check, ...], repairs: list[Repair]) -> str:
    told = "; ".join(f"{c.name}: {c.sentence}" for c in failed)
    tried = f". Tried: {'; '.join(r.tried for r in repairs)}" if repairs else ""
    return f"{what} was judged a failure and taken back: {told}{tried}"
