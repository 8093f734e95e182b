"""The judge loop: an operation is carried out, judged, repaired at most twice, and at last taken back.

The checks are measured from the scenes by `tools.judging`, which reads nothing that the edit reports of itself. A scene
is a value: taking an edit back is keeping the old reference.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ...gaussians.errors import CheckFailedError, ScenewrightError, UserError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from torch import Tensor

    from ...gaussians.language.query.selection import Selection
    from ...gaussians.scene import Scene
    from ...tools.execute import Done
    from ...tools.judging.examine import Findings
    from ...tools.operation import Context, EditOp
    from ...tools.receipt import Check, Judgement, Repair

JUDGES = ("built-in",)
REPAIRS = 2  # attempts after the first
_NEXT_SEED = 1009  # added to the seed for another design and another spot
_SPOT = frozenset({"carried", "free of others", "placed as asked", "in its place", "looks as named",
                   "seen in the colour"})  # fmt: skip


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
    """

    context: Context
    selection: Selection | None
    told: str


def known_judge(name: str | None) -> str | None:
    """The name of a judge, None for "off".

    Raises:
        UserError: there is no such judge.
    """
    if name is None or name == "off":
        return None
    if name not in JUDGES:
        raise UserError(f"there is no judge {name!r}; choose {', '.join(JUDGES)} or off")
    return name


def carry_out_judged(scene: Scene, op: EditOp, context: Context) -> Done:
    """As `execute.carry_out`, and judged; the receipt holds what was measured and repaired.

    Raises:
        JudgedError: the edit failed, also after the repairs. The scene is as before.
        ScenewrightError: as `execute.carry_out`, of the first attempt.
    """
    from ...tools import execute
    from ...tools.judging.case import Case
    from ...tools.judging.examine import examine
    from ...tools.receipt import Judgement, Repair

    done = execute.carry_out(scene, op, context)
    started = time.perf_counter()
    findings = examine(Case(scene, done.scene, op, context))
    repairs: list[Repair] = []
    while not findings.passed and len(repairs) < REPAIRS:
        again = next(_ways(scene, op, context, findings, tuple(r.tried for r in repairs)), None)
        if again is None:
            break
        repairs.append(Repair(failed=findings.failed, tried=again.told))
        try:
            done = execute.carry_out(scene, op, again.context, again.selection)
        except ScenewrightError as error:
            repairs[-1] = repairs[-1].model_copy(update={"tried": f"{again.told}, which failed: {error}"})
            continue
        findings = examine(Case(scene, done.scene, op, again.context, again.selection))
    judging = time.perf_counter() - started
    judgement = Judgement(judge="built-in", checks=findings.checks, repairs=tuple(repairs), seconds=judging)
    if not findings.passed:
        raise JudgedError(_message(op, findings.failed, repairs), judgement)
    notes = (*done.receipt.notes, *(_note(r) for r in repairs))
    seconds = {**done.receipt.seconds, "judge": judging}
    receipt = done.receipt.model_copy(update={"judged": judgement, "notes": notes, "seconds": seconds})
    return done._replace(receipt=receipt)


def _ways(scene: Scene, op: EditOp, context: Context, findings: Findings, tried: tuple[str, ...]) -> Iterator[_Try]:
    """What may repair the failure and was not tried yet, the likeliest first."""
    failed = {check.name for check in findings.failed}
    if "nothing left behind" in failed and len(findings.residue):
        yield _grown(scene, op, context, findings.residue)
    if op.op in ("insert", "replace") and failed & _SPOT:
        told = "another design" + (" and spot" if len(tried) else "")
        seeded = replace(context, seed=context.seed + _NEXT_SEED * (len(tried) + 1))
        if told not in tried:
            yield _Try(seeded, None, told)
    elif "looks as named" in failed and (other := _other_candidate(scene, op, context)) is not None:
        told = f"the other candidate, {other.candidates[0].describe()}" if other.candidates else "the other candidate"
        if told not in tried:
            yield _Try(context, other, told)
    told = "carried out again"
    if told not in tried and not failed <= {"nothing left behind", "looks as named"}:
        yield _Try(context, None, told)


def _grown(scene: Scene, op: EditOp, context: Context, residue: Tensor) -> _Try:
    """The operation on its target together with what was left behind."""
    import torch

    query = op.query()
    assert query is not None
    meant = context.resolve(scene, query).require()
    selection = replace(meant, ids=torch.unique(torch.cat([meant.ids, residue])))
    more = len(selection) - len(meant)
    return _Try(context, selection, f"selected {more:,} more Gaussians that were left behind")


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


def _message(op: EditOp, failed: tuple[Check, ...], repairs: list[Repair]) -> str:
    told = "; ".join(f"{c.name}: {c.sentence}" for c in failed)
    tried = f". Tried: {'; '.join(r.tried for r in repairs)}" if repairs else ""
    return f"{op.op} {op.subject()} was judged a failure and taken back: {told}{tried}"
