"""Carry out one operation: resolve its target, apply it, check the result and write the receipt.

Scenes are values: the old scene is never changed, and a scene that fails a check is not returned, so nothing has to be
undone.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import torch

from ..gaussians.errors import AbsentError, CheckFailedError
from ..gaussians.language.query.query import Query
from ..gaussians.language.query.selection import Selection, mask_of
from ..gaussians.scene import Scene
from ..gaussians.timing import timed
from . import pixel_diff
from .carried_objects import unsupported_note
from .cloud_diff import Difference, difference
from .cohesion import remarks
from .enclosed import with_enclosed
from .judging.case import Case
from .judging.examine import measured
from .keeping_motion import with_motion_kept
from .operation import Affine, Context, EditOp, Outcome
from .ops.reframe import of_everything
from .receipt import Check, Pixels, Receipt, SelectionSummary, at_most


class Done(NamedTuple):
    """The result of an operation.

    Attributes:
        scene: the new scene (the old one itself if nothing changed).
        receipt: what was done and measured.
        selection: what "it" means in the next instruction.
        moved: the map of each body, with rows of the new scene.
    """

    scene: Scene
    receipt: Receipt
    selection: Selection
    moved: tuple[Affine, ...] = ()


def carry_out(
    scene: Scene, op: EditOp, context: Context, selection: Selection | None = None, *, seen: bool = True
) -> Done:
    """Resolve the target, apply the operation and check it.

    Args:
        scene: never changed.
        selection: what to apply it to, instead of resolving the operation's own query.
        seen: also check what a person sees (see `judging`); a judge, who measures the same and repairs it, does not ask
            for it.

    Raises:
        AbsentError, AmbiguousError, UnconfirmedError: the target (or an anchor) is not in the scene, not unique, or not
            confirmed.
        InstructionError: the operation cannot be done as said.
        CheckFailedError: the result fails a post-condition; the message names it and what was measured.
        UserError: a name in the operation (colour, asset) is unknown.
    """
    seconds: dict[str, float] = {}
    inner: tuple[str, ...] = ()
    op = of_everything(op)
    with timed(seconds, "resolve"):
        chosen = target_of(scene, op, context, selection)
        if chosen.enclosed is not None:
            inner = (f"{len(chosen.enclosed):,} Gaussians inside it went along",)
        op = op.settled(scene, context)
    with timed(seconds, "apply"):
        outcome = with_motion_kept(scene, op.apply(scene, chosen, context))
        unsupported = (*remarks(scene, op, chosen), *unsupported_note(scene, outcome.scene, chosen.groups))
        query = op.query()
        where = (chosen.reason,) if query is not None and query.spatial and chosen.reason else ()
        outcome = replace(outcome, notes=(*where, *inner, *outcome.notes, *unsupported))
    receipt = checked(scene, op, chosen, outcome, context, seconds, seen)
    return Done(outcome.scene, receipt, chosen if outcome.focus is None else outcome.focus, outcome.moved)


def checked(
    scene: Scene,
    op: EditOp,
    chosen: Selection,
    outcome: Outcome,
    context: Context,
    seconds: dict[str, float],
    seen: bool = True,
) -> Receipt:
    """The receipt of what an operation did to a selection.

    Args:
        scene: before.
        seconds: of the stages before; those of the checks are added.
        seen: as in `carry_out`.

    Raises:
        CheckFailedError: the outcome fails a post-condition.
    """
    with timed(seconds, "check"):
        changed = difference(scene.cloud, outcome.scene.cloud, op.may_change(scene, chosen), outcome.removed)
        checks = [*_common_checks(op, changed, chosen), *op.check(scene, outcome, chosen, context)]
    if seen:
        with timed(seconds, "see"):
            crowded = any(body.touches for body in outcome.moved)
            known = changed if _aligned(changed) else None
            checks += measured(Case(scene, outcome.scene, op, context, chosen, crowded, known)).checks
    compared: Pixels | None = None
    if context.pixel_checks:
        with timed(seconds, "pixels"):
            compared = _compare(scene, outcome, context)
            checks.append(pixel_diff.check(compared))
    receipt = _receipt(op, chosen, outcome, changed, tuple(checks), context)
    receipt = receipt.model_copy(update={"pixels": compared, "seconds": seconds})
    if not receipt.passed:
        raise CheckFailedError(_failure_message(receipt))
    return receipt


def preview(scene: Scene, op: EditOp, context: Context, selection: Selection | None = None) -> Receipt:
    """The receipt of `carry_out`, marked `dry_run`; the edited scene is dropped.

    Raises:
        As `carry_out`.
    """
    return carry_out(scene, op, context, selection).receipt.model_copy(update={"dry_run": True})


def target_of(scene: Scene, op: EditOp, context: Context, selection: Selection | None = None) -> Selection:
    """What an operation is applied to: what its own words mean, or `selection`; with what is enclosed in it, if the
    operation takes that along; empty for an operation without a target, such as insert.

    Raises:
        AbsentError, AmbiguousError, UnconfirmedError: as `carry_out`.
    """
    query = op.query()
    if query is None:
        return Selection(Query(), "found", torch.zeros(0, dtype=torch.int64))
    chosen = _remaining(scene, (context.resolve(scene, query) if selection is None else selection).require())
    return with_enclosed(scene, chosen) if op.takes_enclosed else chosen


def _remaining(scene: Scene, selection: Selection) -> Selection:
    """The selection without Gaussians that were deleted since it was made ("it" after a deletion). Raises AbsentError
    if none is left."""
    present = mask_of(scene.cloud, selection.ids)
    left = int(present.sum())
    if left == 0:
        raise AbsentError(f"nothing is left of {selection.query.describe()}: select something that is in the scene")
    return selection if left == len(selection) else replace(selection, ids=scene.cloud.ids[present].sort().values)


def _common_checks(op: EditOp, changed: Difference, selection: Selection) -> list[Check]:
    """The checks that every operation has."""
    checks = []
    if op.query() is not None:
        had = len(selection)
        checks.append(
            Check(
                name="target present", passed=had > 0, value=had, bound=1, at_least=True, unit="Gaussians",
                sentence=f"the target has {had:,} Gaussians",
            )
        )  # fmt: skip
    said = f"{changed.outside} Gaussians outside the target changed in any bit"
    checks.append(at_most("outside unchanged", changed.outside, 0, "Gaussians", said))
    checks.append(at_most("new ids", changed.bad_ids, 0, "Gaussians", "added Gaussians have ids of their own"))
    return checks


def _aligned(changed: Difference) -> bool:
    """Whether the rows that were compared are the same Gaussians, as they are but for a faulty operation."""
    return "ids" not in changed.columns and not changed.bad_ids


def _compare(scene: Scene, outcome: Outcome, context: Context) -> Pixels:
    touched = torch.cat([outcome.touched, outcome.removed])
    before = pixel_diff.TargetedCloud(scene.cloud, mask_of(scene.cloud, touched))
    cloud = outcome.scene.cloud
    after = pixel_diff.TargetedCloud(cloud, mask_of(cloud, torch.cat([outcome.touched, outcome.added])))
    return pixel_diff.compare(before, after, context.viewer, context.pixel_width, context.renderer)


def _receipt(
    op: EditOp, chosen: Selection, outcome: Outcome, changed: Difference, checks: tuple[Check, ...], context: Context
) -> Receipt:
    shown = chosen if op.query() is not None else (chosen if outcome.focus is None else outcome.focus)
    backends = {"resolver": getattr(context.resolver, "__name__", "language")}
    if context.encoder is not None:
        backends["encoder"] = context.encoder.fingerprint
    if context.pixel_checks:
        backends["renderer"] = context.renderer
    return Receipt(
        op=op.model_dump(mode="json", exclude_defaults=True) | {"op": op.op},
        selection=SelectionSummary(
            asked=op.subject(),
            verdict=shown.verdict,
            gaussians=len(shown),
            groups=shown.groups,
            things=tuple(c.describe() for c in shown.candidates[:20]),
            reason=shown.reason,
        ),
        changed=len(outcome.touched),
        added=len(outcome.added),
        removed=len(outcome.removed),
        total=len(outcome.scene.cloud),
        columns=changed.columns,
        outside_changed=changed.outside,
        checks=checks,
        notes=outcome.notes,
        backends=backends,
    )


def _failure_message(receipt: Receipt) -> str:
    failed = [c for c in receipt.checks if not c.passed]
    told = "; ".join(
        f"{c.name}: measured {c.value:.4g} {c.unit}, {'at least' if c.at_least else 'at most'} {c.bound:.4g} allowed"
        f" ({c.sentence})"
        for c in failed
        if c.bound is not None
    )
    return f"{receipt.op['op']} {receipt.selection.asked} failed its own check and was taken back: {told}"
