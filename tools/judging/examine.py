"""Judge one operation: what its words promise, measured on the scenes before and after it.

Each operation has a function that lists its checks; an operation without one gets the checks that hold for all.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.errors import ScenewrightError
from ...gaussians.harmonics import dc_to_color
from ...gaussians.language.field.measure import solid_points
from ...gaussians.rows import rows_where
from ...gaussians.world import kinds
from ...gaussians.world.box import Box
from ..coloring.seen import few_of
from ..coloring.surfaces import surfaces
from ..new_objects import scene_scale
from ..operation import Placement
from ..ops.arrange import Arrange
from ..ops.delete import Delete
from ..ops.duplicate import Duplicate
from ..ops.exchange import Exchange
from ..ops.insert import Insert
from ..ops.isolate import Isolate
from ..ops.move import Move
from ..ops.opacity import Opacity
from ..ops.recolor import Recolor
from ..ops.reframe import Reframe
from ..ops.relight import Relight
from ..ops.replace import Replace
from ..ops.restyle import Restyle
from ..ops.rotate import Rotate
from ..ops.scale import Scale
from ..placement.bodies import bodies_of, contact_box, heading, mask_of_bodies
from ..receipt import Check, at_least, at_most, report
from . import appearance, hues, sizes, spots, standing
from .accounting import all_of_it, only_as_asked
from .case import Case, weight_of
from .leftovers import left_behind

_NO_IDS = torch.zeros(0, dtype=torch.int64)
_RIGID = 0.01  # of its size: RMS by which a thing that moved may be out of shape
_WAY = 0.03  # of the way, and at least 2 cm: error of a moved thing's place
_TURN = 2.0  # degrees
_SIZE = 0.03  # error of a size ratio, and at most a third of the change that was asked for
_DARKEST = 1 / 255  # display value of the brightest channel up to which there is no light
_BRIGHTEST = 0.97  # display value of the brightest channel from which a colour may stay as it is
_HUELESS = 1 / 255  # between the channels of a grey
_SWITCHED = 1e-4  # display values by which a lamp that is switched changes itself, or a room with all of its lamps
_PART = 0.05  # score of a colour that only parts of a new thing have
_LEVEL = 0.03  # of its height, and at least 2 cm: by how much a copy of a thing that hangs may hang higher or lower


@dataclass(frozen=True, eq=False)
class Findings:
    """What was measured of an edit.

    Attributes:
        checks: each with its value.
        residue: ids of Gaussians that seem to belong to the target and were left behind.
    """

    checks: tuple[Check, ...]
    residue: Tensor = field(default_factory=lambda: _NO_IDS)

    @property
    def passed(self) -> bool:
        return all(check.passed for check in self.checks)

    @property
    def failed(self) -> tuple[Check, ...]:
        return tuple(check for check in self.checks if not check.passed)


def examine(case: Case) -> Findings:
    """Judge an edit. The scenes are not changed, and nothing that the edit reports of itself is read."""
    if case.op.query() is not None:
        try:
            found = case.asked
        except ScenewrightError as error:
            return Findings((at_least("asked again", 0, 1, "things", f"asking again gave: {error}"),))
        if found is None or found.verdict != "found":
            told = found.reason if found is not None else ""
            return Findings((at_least("asked again", 0, 1, "things", f"asking again: {told}"),))
    return measured(case)


def measured(case: Case) -> Findings:
    """As `examine`, of an edit whose target is known (`Case.chosen`): its words are not asked again."""
    checks = [only_as_asked(case)]
    if case.before.language is None:  # nothing tells one thing from another
        return Findings(tuple(checks))
    judge = _JUDGES.get(type(case.op))
    more, residue = judge(case, case.op) if judge is not None else ([], _NO_IDS)
    return Findings((*checks, *more), residue)


Found = tuple[list[Check], Tensor]


def _named(case: Case, changed: Tensor) -> list[Check]:
    """The encoder, shown what really changed (`[N]` bool over the cloud before), finds it to be what the words name."""
    if not bool(changed.any()) or not _is_seen(case):
        return []
    cloud = case.before.cloud
    # Parts of other hues may keep their colour: the whole thing is looked at, and not the frame of a television.
    whole = case.bodies and not bool((changed & ~case.free).any()) and bool((changed & case.target).any())
    return _seen(case, [cloud[b.rows] for b in case.bodies] if whole else [cloud[changed]])


def _seen(case: Case, clouds: Sequence[GaussianCloud]) -> list[Check]:
    """The encoder finds these things to be what the words of the target name; empty if they name no kind of thing."""
    query = case.op.query()
    if query is None or not _is_seen(case):
        return []
    word = query.text.lower()
    return [appearance.looks_as_named("looks as named", word, appearance.embedded(), clouds, case.before)]


def _is_seen(case: Case) -> bool:
    """Whether the encoder can tell if things are what the words of the target name.

    Nothing is looked at where the scene was embedded by another encoder, looks like nothing that ours was trained on,
    or where somebody gave the target its name.
    """
    query, encoder, field = case.op.query(), appearance.embedded(), case.before.language
    return (
        query is not None
        and appearance.is_looked_for(query, encoder)
        and appearance.is_judge_of(encoder, case.before)
        and not (field is not None and any(field.groups[i].named_by for i in case.meant.groups))
    )


def _delete(case: Case, op: Delete) -> Found:
    left, residue = left_behind(case)
    return [all_of_it(case, case.changes.gone), left, *_named(case, case.changes.gone)], residue


def _isolate(case: Case, op: Isolate) -> Found:
    return [all_of_it(case, case.changes.gone, ~case.target), *_named(case, ~case.changes.gone)], _NO_IDS


def _recolor(case: Case, op: Recolor) -> Found:
    checks = [all_of_it(case, case.changes.colored, _to_paint(case, op))]
    rows = rows_where(case.changes.shaded)
    shown = rows if len(rows) else rows_where(case.target)
    if op.adjust is None and op.color is not None:
        checks.append(appearance.looks_colored("seen in the colour", op.color, _after(case, shown), case.after))
        checks += hues.as_asked(case, op, shown[case.target[shown]])
    elif op.adjust is not None:
        checks.append(_adjusted(case, op, shown))
        if op.adjust in ("darker", "lighter"):
            checks += hues.kept_in_light(case, shown[case.target[shown]])
    return [*checks, *_named(case, case.changes.shaded)], _NO_IDS


def _restyle(case: Case, op: Restyle) -> Found:
    if op.style is not None:  # which leaves what it has no material for
        return [], _NO_IDS
    target = case.target.clone()
    if not op.whole and bool(target.any()):
        target[surfaces(case.before, case.meant).left] = False
    return [all_of_it(case, case.changes.colored | case.changes.gone, target)], _NO_IDS


def _relight(case: Case, op: Relight) -> Found:
    if op.lamps is not None:
        return [_lamps_switched(case, op)], _NO_IDS
    shown = dc_to_color(case.before.cloud.sh[:, 0])
    target = case.free & (shown.amax(dim=1) > _DARKEST)
    if op.exposure is not None and op.exposure > 1:  # white stays white
        target = target & (shown.amax(dim=1) < _BRIGHTEST)
    checks = [all_of_it(case, case.changes.colored, target)]
    if op.mood is None and op.exposure is not None and op.exposure != 1:
        rows = rows_where(case.changes.shaded)
        checks.append(_exposed(case, op, rows if len(rows) else rows_where(case.target)))
    return checks, _NO_IDS


def _lamps_switched(case: Case, op: Relight) -> Check:
    """What is meant became brighter, or darker, on average."""
    rows = rows_where(case.target)
    weight = weight_of(case.before.cloud, rows)
    was, now = (
        dc_to_color(cloud.sh[at, 0]).double().mean(dim=1)
        for cloud, at in ((case.before.cloud, rows), (case.after.cloud, case.now(rows)))
    )
    whole = len(was) == len(now) and len(was) > 0
    step = float((weight * (now - was)).sum() / weight.sum().clamp(min=1e-30)) if whole else -1.0
    step = step if op.lamps == "on" or not whole else -step
    return at_least("switched", step, _SWITCHED, "1", f"its display values moved by {step:.3f} as asked")


def _exposed(case: Case, op: Relight, rows: Tensor) -> Check:
    """The seen colour became brighter or darker, as asked."""
    was = appearance.seen_lab(few_of(case.before.cloud, rows), case.before)
    now = appearance.seen_lab(_after(case, rows), case.after)
    if len(was) < 4 or len(now) < 4:
        return report("seen to change", 0.0, "ΔE", "too few of its pixels are solid to see a colour")
    step = float(now[:, 0].mean() - was[:, 0].mean()) * (1 if op.exposure is not None and op.exposure > 1 else -1)
    return at_least("seen to change", step, 0.0, "ΔE", f"its seen lightness moved by {step:.1f} as asked")


def _to_paint(case: Case, op: Recolor) -> Tensor:
    """`[N]` bool: what of the target has to change its colour.

    A new colour leaves parts of other hues. What is as bright as a display shows cannot become lighter or purer, a grey
    has no hue to lose, and what reflects no light at all has no colour to change.
    """
    shown = dc_to_color(case.before.cloud.sh[:, 0])
    brightest = shown.amax(dim=1)
    target = case.target & (brightest > _DARKEST)
    if op.adjust == "less_saturated":
        return target & (brightest - shown.amin(dim=1) > _HUELESS)
    if op.adjust in ("lighter", "more_saturated"):
        return target & (brightest < _BRIGHTEST)
    if op.color is None or op.paints_parts or not bool(target.any()):
        return target
    target[surfaces(case.before, case.meant).left] = False
    return target


def _after(case: Case, rows: Tensor) -> GaussianCloud:
    """The Gaussians of some rows of the cloud before, as they are after the edit, thinned to what is rendered."""
    return few_of(case.after.cloud, case.now(rows))


def _adjusted(case: Case, op: Recolor, rows: Tensor) -> Check:
    """The seen colour moved in the asked direction, Lab."""
    was = appearance.seen_lab(few_of(case.before.cloud, rows), case.before)
    now = appearance.seen_lab(_after(case, rows), case.after)
    if len(was) < 4 or len(now) < 4:
        return report("seen to change", 0.0, "ΔE", "too few of its pixels are solid to see a colour")
    old, new = was.mean(axis=0), now.mean(axis=0)
    chroma = [float(np.linalg.norm(lab[:, 1:], axis=1).mean()) for lab in (was, now)]  # the mean of many is grey
    step = {
        "darker": old[0] - new[0],
        "lighter": new[0] - old[0],
        "more_saturated": chroma[1] - chroma[0],
        "less_saturated": chroma[0] - chroma[1],
        "warmer": new[2] - old[2],
        "cooler": old[2] - new[2],
        "toward": float(np.linalg.norm(new - old)),
    }[str(op.adjust)]
    return at_least("seen to change", float(step), 0.1, "ΔE", f"its seen colour moved by {step:.1f} as asked")


def _opacity(case: Case, op: Opacity) -> Found:
    rows = rows_where(case.target)
    was, now = case.before.cloud.opacities[rows], case.after.cloud.opacities[case.now(rows)]
    ratio = float(now.double().sum() / was.double().sum()) if len(now) == len(was) and len(was) else -1.0
    said = f"its opacity is {ratio:.2f} times what it was"
    checks = [at_most("as opaque as asked", abs(ratio - op.value), 0.02, "1", said)]
    changed = all_of_it(case, case.changes.faded) if op.value < 1 else None
    return [*checks, *([changed] if changed else []), *_named(case, case.changes.faded)], _NO_IDS


# -- things that move -------------------------------------------------------------------------------------------------


def _displaced(case: Case, rows: Tensor) -> Check:
    """The body kept its shape on the way."""
    motion = standing.rigid_motion(case, rows)
    if motion is None:
        return at_most("kept its shape", 1.0, _RIGID, "1", "nothing of it is there any more")
    size = max(case.box_after(case.now(rows)).size)
    off = motion[2] / max(size, 1e-9)
    return at_most("kept its shape", off, _RIGID, "1", f"it is out of shape by {off:.2%} of its size")


def _near(name: str, off: float, way: float, case: Case, told: str) -> Check:
    """A check that a place is met within `_WAY` of the way, or 2 cm."""
    return at_most(name, off, max(_WAY * way, 2 * case.cm(max(way, 1e-9))), "units", told)


def _move(case: Case, op: Move) -> Found:
    left, residue = left_behind(case)
    checks = [all_of_it(case, case.changes.elsewhere, _of_bodies(case)), left]
    for body in case.bodies[: appearance.MOST]:
        checks.append(_displaced(case, body.rows))
        motion = standing.rigid_motion(case, body.rows)
        if motion is None:
            continue
        way = motion[1]
        if op.direction is not None:
            ahead = heading(case.context.viewer, case.before.frame, op.direction)
            length = op.distance.in_units(case.before.frame) if op.distance is not None else float(way @ ahead)
            told = f"it moved {float(way @ ahead):.3g} units {op.direction}"
            if length > 0:
                checks.append(_near("moved as said", float(np.linalg.norm(way - length * ahead)), length, case, told))
            else:
                checks.append(at_least("moved as said", length, 0.0, "units", told))
        elif op.toward is not None:
            checks += _approached(case, op, body.rows, body.center, way)
        elif op.place is not None:
            checks += _placed(case, op.place, case.now(body.rows), body.label)
    return [*checks, *_named(case, case.changes.elsewhere & case.target)], residue


def _of_bodies(case: Case) -> Tensor:
    """`[N]` bool: the target without its strays, which stay where they are."""
    return case.target & mask_of_bodies(case.before, case.bodies)


def _approached(case: Case, op: Move, rows: Tensor, was: Any, way: Any) -> list[Check]:
    """It came nearer to the thing it was sent to, or got away from it, by the asked distance."""
    assert op.toward is not None
    found = case.context.resolve(case.before, op.toward)
    if found.verdict != "found":
        return [report("moved as said", 0.0, "units", f"what it goes to was not found: {found.reason}")]
    goals = [b.center for b in bodies_of(case.before, found)]
    closer = [float(np.linalg.norm(g - was) - np.linalg.norm(g - was - way)) for g in goals]
    far = -min(closer) if op.away else max(closer)
    told = f"it came {far:.3g} units {'farther away' if op.away else 'nearer'}"
    checks = [at_least("moved as said", far, 1e-3 * case.cm(1.0), "units", told)]
    if op.distance is not None:
        length, far = op.distance.in_units(case.before.frame), float(np.linalg.norm(way))
        checks.append(_near("distance seen", abs(far - length), length, case, f"it moved {far:.3g} of {length:.3g}"))
    return checks


def _placed(case: Case, place: Placement | None, rows: Tensor, label: str) -> list[Check]:
    """A thing that was put down, rows of the cloud after: carried, free of others, where it was asked."""
    if not len(rows):
        return [at_least("carried", 0, 1, "Gaussians", "nothing of it is there")]
    checks = [standing.stands(case, rows, label), standing.free_of_others(case, rows)]
    asked = standing.in_relation(case, place, rows) if place is not None else None
    return [*checks, *([asked] if asked is not None else [])]


def _rotate(case: Case, op: Rotate) -> Found:
    checks: list[Check] = []
    axis = heading(case.context.viewer, case.before.frame, op.axis)
    if op.degrees is not None and op.toward is None and abs(op.degrees % 360) > 1e-6:
        checks.append(all_of_it(case, case.changes.placed, _of_bodies(case)))
    for body in case.bodies[: appearance.MOST]:
        checks.append(_displaced(case, body.rows))
        motion = standing.rigid_motion(case, body.rows)
        if motion is not None and op.degrees is not None and op.toward is None:
            off = abs((standing.turned_by(motion[0], axis) - op.degrees + 180) % 360 - 180)
            checks.append(at_most("turned as said", off, _TURN, "degrees", f"its turn is off by {off:.2g} degrees"))
        if motion is not None:
            checks += spots.pivot_kept(case, body, motion[0])
    return [*checks, *_named(case, case.changes.placed & case.target)], _NO_IDS


def _scale(case: Case, op: Scale) -> Found:
    checks: list[Check] = []
    if op.factor != 1:
        checks.append(all_of_it(case, case.changes.placed, _of_bodies(case)))
    for body in case.bodies[: appearance.MOST]:
        rows = case.now(body.rows)
        if len(rows) < 4:
            checks.append(at_most("size as asked", 1.0, _SIZE, "1", "nothing of it is there any more"))
            continue
        was = contact_box(solid_points(case.before.cloud, body.rows), case.before.frame, body.box.axes)
        checks += [_resized(case, op, was, rows), spots.foot_kept(case, body), spots.underside_kept(case, body)]
    return [*checks, *_named(case, case.changes.placed & case.target)], _NO_IDS


def _resized(case: Case, op: Scale, was: Box, rows: Tensor) -> Check:
    """The measured box has the asked size, along the asked axis or in all directions."""
    now = contact_box(solid_points(case.after.cloud, rows), case.after.frame, was.axes)
    ratios = [n / max(w, 1e-9) for n, w in zip(now.size, was.size, strict=True)]
    bound = _SIZE
    if op.length is None:
        factor = op.factor or 1.0
        bound = min(_SIZE, max(abs(factor - 1) / 3, 1e-4))
        across = [abs(r / factor - 1) for r in ratios]
        off = max(across) if op.axis == "all" else across[2] if op.axis == "height" else min(across[:2])
    else:
        side, length = op.length
        asked = length.in_units(case.before.frame)
        across = [abs(s / asked - 1) for s in now.size]
        off = across[2] if side == "height" else min(across[:2])
    return at_most("size as asked", off, bound, "1", f"its size is off by {off:.1%}")


def _arrange(case: Case, op: Arrange) -> Found:
    left, residue = left_behind(case)
    checks = [all_of_it(case, case.changes.placed, _of_bodies(case)), left]
    way = np.array([op.x, op.y, op.z]) / (case.before.frame.metres_per_unit or 1.0) @ case.before.frame.basis()
    for body in case.bodies[: appearance.MOST]:
        checks.append(_displaced(case, body.rows))
        motion = standing.rigid_motion(case, body.rows)
        if motion is None:
            continue
        rows = case.now(body.rows)
        turned = standing.turned_by(motion[0], case.before.frame.up_vector)
        off = abs((turned - op.turn + 180) % 360 - 180)
        checks.append(at_most("turned as said", off, _TURN, "degrees", f"its turn is off by {off:.2g} degrees"))
        moved = case.before.cloud.means[body.rows].double().mean(dim=0).numpy() - body.center
        expected = body.center + way + motion[0] @ moved
        there = case.after.cloud.means[rows].double().mean(dim=0).numpy()
        far = float(np.linalg.norm(there - expected))
        checks.append(_near("moved as said", far, float(np.linalg.norm(way)), case, f"its place is off by {far:.3g}"))
    return [*checks, *_named(case, case.changes.placed & case.target)], residue


def _exchange(case: Case, op: Exchange) -> Found:
    checks = [all_of_it(case, case.changes.placed, _of_bodies(case))]
    if len(case.bodies) != 2:
        return checks, _NO_IDS
    for one, other in (case.bodies, case.bodies[::-1]):
        checks.append(_displaced(case, one.rows))
        rows = case.now(one.rows)
        if len(rows):
            aside = np.array(case.box_after(rows).center) - other.center
            up = case.before.frame.up_vector
            off = float(np.linalg.norm(aside - up * (aside @ up)))
            reach = max(*one.box.size, *other.box.size)
            told = f"it stands {off:.3g} units from where the other stood"
            checks.append(at_most("changed places", off, 0.75 * reach, "units", told))
    return checks, _NO_IDS


# -- things that are added --------------------------------------------------------------------------------------------


def _new(case: Case, kind: str, color: str | None, count: int) -> list[Check]:
    """As many new things as asked, each seen to be of the kind and colour."""
    encoder = appearance.embedded()
    clouds = [case.after.cloud[rows] for rows in case.added]
    told = f"{len(clouds)} new things are there, {count} were asked for"
    checks = [at_most("as many as asked", abs(len(clouds) - count), 0, "things", told)]
    looking = case.chosen is None or appearance.is_judge_of(encoder, case.before)
    if looking and encoder.knows(kind.lower()) and clouds and case.context.assets is None:
        checks.append(appearance.looks_as_named("looks as named", kind.lower(), encoder, clouds, case.after))
    if color is not None:
        seen = (appearance.looks_colored("seen in the colour", color, c, case.after, _PART) for c in clouds[:1])
        checks += seen
        checks += [hues.new_in_color("hue as asked", color, c, case.after) for c in clouds[:1]]
    return checks


def _insert(case: Case, op: Insert) -> Found:
    checks = _new(case, op.asset, op.color, op.count)
    for rows in case.added[: appearance.MOST]:
        checks += _placed(case, op.place, rows, op.asset)
        box = case.box_after(rows)
        if op.height is not None:
            off = abs(box.size[2] / op.height.in_units(case.before.frame) - 1)
            checks.append(at_most("as tall as asked", off, _SIZE, "1", f"its height is off by {off:.1%}"))
        else:
            checks.append(sizes.of_its_kind(case, op.asset, box, sizes.scale_around(case)))
    return checks, _NO_IDS


def _replace(case: Case, op: Replace) -> Found:
    left, residue = left_behind(case)
    checks = [all_of_it(case, case.changes.gone), left, *_named(case, case.changes.gone)]
    checks += _new(case, op.asset, op.color, len(case.bodies))
    for rows in case.added[: appearance.MOST]:
        checks += _placed(case, None, rows, op.asset)
        box = case.box_after(rows)
        scale = scene_scale(case.before, [(b, op.target.text) for b in case.bodies])
        sized = sizes.fits_old(case, box) if scale.guessed else sizes.of_its_kind(case, op.asset, box, scale)
        checks += [spots.in_its_place(case, rows, box), sized]
    return checks, residue


def _duplicate(case: Case, op: Duplicate) -> Found:
    count = op.count * len(case.bodies)
    told = f"{len(case.added)} new things are there, {count} were asked for"
    checks = [at_most("as many as asked", abs(len(case.added) - count), 0, "things", told)]
    like = [b.rows for b in case.bodies]
    for rows in case.added[: appearance.MOST]:
        off = min(abs(len(rows) / max(len(one), 1) - 1) for one in like) if like else 1.0
        checks.append(at_most("like the original", off, 0.01, "1", f"its Gaussians are off by {off:.1%}"))
        box = case.box_after(rows)
        near = min(float(np.linalg.norm(np.array(box.center) - b.center)) for b in case.bodies)
        whole = min(case.bodies, key=lambda b: abs(len(b.rows) - len(rows)))
        now = contact_box(solid_points(case.after.cloud, rows), case.after.frame, whole.box.axes)
        was = contact_box(solid_points(case.before.cloud, whole.rows), case.before.frame, whole.box.axes)
        checks += [sizes.like_original(now, was), hues.like_original(case, rows, whole.rows)]
        checks.append(at_least("beside the original", near, 0.2 * min(case.bodies[0].box.size), "units",
                               f"it stands {near:.3g} units from the original"))  # fmt: skip
        if op.direction is None:
            checks += _placed(case, op.place, rows, case.bodies[0].label)
            checks += _as_high(case, rows) if op.place is None else []
    copies = [case.after.cloud[rows] for rows in case.added]
    return [*checks, *(_seen(case, copies) if copies else [])], _NO_IDS


def _as_high(case: Case, rows: Tensor) -> list[Check]:
    """A copy of a thing that hangs on a wall or from the ceiling hangs as high as the original."""
    kind = kinds.find(case.bodies[0].label) if case.bodies[0].label else None
    if kind is None or kind.support not in ("wall", "ceiling"):
        return []
    up, box = case.after.frame.up_vector, case.box_after(rows)
    off = min(abs(float((np.array(box.center) - b.center) @ up)) for b in case.bodies)
    bound = max(_LEVEL * box.size[2], 2 * case.cm(max(box.size)))
    return [at_most("as high as the original", off, bound, "units", f"it hangs {off:.3g} units higher or lower")]


def _reframe(case: Case, op: Reframe) -> Found:
    every = torch.ones_like(case.changes.placed)
    return ([] if op.unit is not None else [all_of_it(case, case.changes.placed, every)]), _NO_IDS


_JUDGES: dict[type, Callable[[Case, Any], Found]] = {
    Delete: _delete,
    Isolate: _isolate,
    Recolor: _recolor,
    Relight: _relight,
    Restyle: _restyle,
    Opacity: _opacity,
    Move: _move,
    Rotate: _rotate,
    Scale: _scale,
    Arrange: _arrange,
    Exchange: _exchange,
    Insert: _insert,
    Replace: _replace,
    Duplicate: _duplicate,
    Reframe: _reframe,
}
