"""Complete an edit: fill the surfaces that it reveals, take contact shadows off, and cast them where things are put.

This comes after the checks of the operation. It only adds Gaussians, and makes those lighter or darker that lie in a
contact shadow; all others stay the same bit for bit. Where there is a model that inpaints pictures, what it makes of
views is lifted into new Gaussians; where photographs see what was added, it is optimised against them.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence

import torch
from torch import Tensor

from ..gaussians.errors import ScenewrightError
from ..gaussians.language.field.language_field import LanguageField
from ..gaussians.language.query.selection import mask_of
from ..gaussians.rows import mask_of_ids, rows_of_ids
from ..gaussians.scene import Scene
from ..gaussians.timing import timed
from .cloud_diff import Draft, joined, without
from .execute import Done
from .field_update import after_recolor, after_removal, recount
from .operation import Context, EditOp
from .receipt import Filled, Lifted, Vec3

log = logging.getLogger(__name__)

Box = tuple[Vec3, Vec3]  # lowest and highest corner, world

_FEWEST, _MOST = 20, 24  # Gaussians of a thing that casts a shadow, and things that do after one operation


def completed(before: Scene, op: EditOp, context: Context, done: Done) -> Done:
    """The result of an operation with what it revealed filled, unless the operation or the context says not to; what
    was filled is optimised against the photographs of the context; and what was put somewhere casts its shadow there.

    Args:
        before: the scene before the operation.
        done: its result.

    Raises:
        FileError: a photograph cannot be read.
    """
    return with_shadows(before, op, context, done.scene, revealed(before, op, context, done))


def revealed(before: Scene, op: EditOp, context: Context, done: Done) -> Done:
    """The result of `completed` before anything casts its shadow where it was put; arguments and errors are the
    same."""
    if op.op == "restyle" and context.restyler is not None:
        return _unless_it_fails(done, before.cloud.ids[:0], lambda now, _: _restyled(before, op, context, now))[0]
    done, new = _filled(before, op, context, done)
    if context.inpainter is not None and _may_fill(before, op, context, done):
        done, new = _unless_it_fails(done, new, lambda now, ids: _inpainted(before, op, context, now, ids))
    if context.photographs is not None and len(new):
        done, _ = _unless_it_fails(done, new, lambda now, ids: _photographed(context, now, ids))
    return done


def unshadowed(before: Scene, op: EditOp, context: Context, done: Done, hidden: Tensor) -> Done:
    """The result of an operation that hides things with their contact shadows taken off, as where they are deleted;
    nothing is filled behind them.

    Args:
        before: the scene before the operation.
        done: its result, in which they still are.
        hidden: ids, ascending.
    """
    query = op.query()
    if not context.infill or query is None or query.spatial or not len(hidden):
        return done
    cloud = without(done.scene.cloud, mask_of(done.scene.cloud, hidden))
    if not len(cloud):
        return done
    gone = done.scene.replace(cloud=cloud, language=after_removal(done.scene, cloud, hidden))
    try:
        lit = filled(before, gone)[0].cloud
    except Exception:  # the edit itself is done and checked: it stays
        log.warning("contact shadows could not be taken off", exc_info=True)
        return done
    rows = rows_of_ids(lit.ids, cloud.ids)
    lighter = (lit.sh[rows] != cloud.sh).flatten(1).any(dim=1)
    if not bool(lighter.any()):
        return done
    draft = Draft(done.scene.cloud)
    draft.write("sh", rows_of_ids(done.scene.cloud.ids, cloud.ids[lighter]), lit.sh[rows[lighter]])
    after = done.scene.replace(cloud=draft.done())
    after = after.replace(language=after_recolor(after, cloud.ids[lighter]))
    count = int(lighter.sum())
    note = f"took its contact shadow off: {count} Gaussians are lighter"
    receipt = done.receipt.model_copy(
        update={"changed": done.receipt.changed + count, "notes": (*done.receipt.notes, note)}
    )
    return done._replace(scene=after, receipt=receipt)


def _unless_it_fails(
    done: Done, new: Tensor, step: Callable[[Done, Tensor], tuple[Done, Tensor]]
) -> tuple[Done, Tensor]:
    """What a step with pictures makes of a result; the result as it is, with a note, if a model of others fails in a
    way that nobody foresaw.

    Raises:
        ScenewrightError: as the step.
    """
    try:
        return step(done, new)
    except ScenewrightError:
        raise
    except Exception as error:  # the edit itself is done and checked: it stays
        log.warning("pictures could not be used", exc_info=True)
        failed = f"pictures were not used: that failed ({type(error).__name__}: {error})"
        return done._replace(receipt=done.receipt.model_copy(update={"notes": (*done.receipt.notes, failed)})), new


def _photographed(context: Context, done: Done, new: Tensor) -> tuple[Done, Tensor]:
    """The result with the new Gaussians optimised against the photographs, and their ids."""
    from .lifting.photographs import with_photographs
    from .lifting.told import note

    seconds: dict[str, float] = {}
    assert context.photographs is not None
    with timed(seconds, "lift"):
        scene, lifted = with_photographs(done.scene, context.photographs, new, context.seed)
    return _lifted(done, scene, lifted, seconds, note(lifted)), new


def _restyled(before: Scene, op: EditOp, context: Context, done: Done) -> tuple[Done, Tensor]:
    """The result of a restyle with the look that the model of the context paints, and the ids of what it painted;
    Gaussians that restyle left stay."""
    from .lifting.behind import differing
    from .lifting.restyled import restyled
    from .lifting.told import restyle_note

    assert context.restyler is not None
    changed = done.scene.cloud.ids[differing(before.cloud, done.scene.cloud)[1]]
    color = getattr(op, "color", None)
    material = " ".join(filter(None, (color, getattr(op, "called", ""))))
    seconds: dict[str, float] = {}
    with timed(seconds, "paint"):
        scene, lifted = restyled(
            done.scene, changed, f"a photograph of {op.subject()}, {material}", context.restyler, context.seed
        )
    return _lifted(done, scene, lifted, seconds, restyle_note(lifted)), changed


def _inpainted(before: Scene, op: EditOp, context: Context, done: Done, new: Tensor) -> tuple[Done, Tensor]:
    """The result with the hole filled by the model of the context, and the ids of all new Gaussians."""
    from .filling.revealed import left_their_place
    from .lifting.inpainted import with_inpainted
    from .lifting.told import note

    assert context.inpainter is not None
    if not left_their_place(before, done.scene, _moved(before, done.scene) if op.op == "move" else ()):
        return done, new
    seconds: dict[str, float] = {}
    with timed(seconds, "inpaint"):
        scene, new, lifted = with_inpainted(before, done.scene, new, context.inpainter, context.seed)
    return _lifted(done, scene, lifted, seconds, note(lifted)), new


def _lifted(done: Done, scene: Scene, lifted: Lifted, seconds: dict[str, float], said: str) -> Done:
    """The result with a scene whose Gaussians were optimised, and with what was measured in its receipt."""
    receipt = done.receipt.model_copy(
        update={
            "added": done.receipt.added + lifted.made - lifted.replaced,
            "total": len(scene.cloud),
            "notes": (*done.receipt.notes, said),
            "lifted": (*done.receipt.lifted, lifted),
            "seconds": {**done.receipt.seconds, **seconds},
        }
    )
    return done._replace(scene=scene, receipt=receipt)


def _may_fill(before: Scene, op: EditOp, context: Context, done: Done) -> bool:
    """Whether what an operation revealed is to be filled at all."""
    query = op.query()
    wanted = op.reveals and context.infill and getattr(op, "infill", True) and done.scene is not before
    return bool(wanted) and query is not None and not query.spatial


def with_shadows(before: Scene, op: EditOp, context: Context, placed: Scene, done: Done) -> Done:
    """The result with the contact shadows of what an operation put somewhere.

    Args:
        placed: the scene right after the operation, before anything was filled.
    """
    query = op.query()
    if not (op.puts and context.harmony and getattr(op, "harmony", True)) or placed is before:
        return done
    if (query is not None and query.spatial) or (op.reveals and not (context.infill and getattr(op, "infill", True))):
        return done  # a shadow stays where it was
    put = _put(before, placed, op)
    if not put:
        return done
    seconds: dict[str, float] = {}
    with timed(seconds, "shadows"):
        scene, cast, said, (made, replaced, changed) = _shaded(before, done.scene, put, op.op != "move")
    receipt = done.receipt.model_copy(
        update={
            "changed": done.receipt.changed + changed,
            "added": done.receipt.added + made,
            "removed": done.receipt.removed + replaced,
            "total": len(scene.cloud),
            "notes": (*done.receipt.notes, *said),
            "filled": (*done.receipt.filled, *cast),
            "seconds": {**done.receipt.seconds, **seconds},
        }
    )
    return done._replace(scene=scene, receipt=receipt)


def _filled(before: Scene, op: EditOp, context: Context, done: Done) -> tuple[Done, Tensor]:
    """The result with what it revealed filled, and the ids of the new Gaussians; `infill` itself made its own."""
    nothing = before.cloud.ids[:0]
    if op.op == "infill":
        return done, done.scene.cloud.ids[~mask_of_ids(done.scene.cloud.ids, before.cloud.ids)]
    if not _may_fill(before, op, context, done):
        return done, nothing
    seconds: dict[str, float] = {}
    try:
        with timed(seconds, "fill"):
            scene, told, ids = filled(before, done.scene, _moved(before, done.scene) if op.op == "move" else ())
    except Exception as error:  # the edit itself is done and checked: it stays
        log.warning("what the edit revealed could not be filled", exc_info=True)
        failed = f"what it hid is not filled: filling failed ({type(error).__name__}: {error})"
        return done._replace(receipt=done.receipt.model_copy(update={"notes": (*done.receipt.notes, failed)})), nothing
    if not told:
        return done, nothing
    from .filling.told import notes

    receipt = done.receipt.model_copy(
        update={
            "added": done.receipt.added + len(ids),
            "changed": done.receipt.changed + sum(f.lighter + f.darker for f in told),
            "total": len(scene.cloud),
            "notes": (*done.receipt.notes, *notes(told)),
            "filled": told,
            "seconds": {**done.receipt.seconds, **seconds},
        }
    )
    return done._replace(scene=scene, receipt=receipt), ids


def filled(before: Scene, after: Scene, moved: Sequence[Tensor] = ()) -> tuple[Scene, tuple[Filled, ...], Tensor]:
    """The scene after an edit with filled surfaces, what was done to each, and the ids of the new Gaussians.

    Args:
        moved: rows of the cloud before that were moved.
    """
    from .filling.fill import merged, patches_behind, unshaded
    from .filling.revealed import left_their_place
    from .filling.told import filled as tell
    from .lifting.past import without_those_before

    scene, told, ids = after, list[Filled](), [after.cloud.ids[:0]]
    top = int(before.cloud.ids.max()) if len(before.cloud) else -1  # ids of what is gone are not used again
    elsewhere = [before.cloud.ids[rows] for rows in moved]
    for rows in left_their_place(before, after, moved):
        apart = mask_of(scene.cloud, torch.cat(elsewhere)) if elsewhere else None
        patches = without_those_before(before, scene, patches_behind(scene, before.cloud[rows], apart))
        lit, new = unshaded(scene, patches), merged(scene, patches, top)
        told += tell(scene, patches)
        if lit is not scene.cloud:
            shaded = torch.cat([p.shaded for p in patches])
            scene = scene.replace(cloud=lit)
            scene = scene.replace(language=after_recolor(scene, lit.ids[shaded]))
        if len(new):
            cloud = joined(scene.cloud, None, [new])
            scene = scene.replace(cloud=cloud, language=recount(scene.language, cloud))
            ids.append(new.ids)
    return scene, _together(told), torch.cat(ids)


def _shaded(
    before: Scene, scene: Scene, put: Sequence[Tensor], new: bool
) -> tuple[Scene, tuple[Filled, ...], tuple[str, ...], tuple[int, int, int]]:  # fmt: skip
    """The scene with the contact shadows of what was put somewhere, by the ids of each thing; what was done, in words
    too; how many Gaussians were made of coarse ones, of how many, and how many others are darker.

    Coarse Gaussians are split for new things alone: a thing that moves leaves all rows there.
    """
    from .harmony.shadows import shadows_under
    from .harmony.strength import strength_of
    from .harmony.told import notes

    things = [mask_of(scene.cloud, ids).nonzero().squeeze(1) for ids in put]
    scene, told = shadows_under(scene, things, strength_of(before), lit=before, split=new, layers=True)
    cast = Filled(surface="what it stands on", gaussians=0, area=0.0, sure=0.0, darker=told.darker)
    return scene, (cast,) if told.darker else (), notes(told), (told.made, told.replaced, told.changed)


def _put(before: Scene, after: Scene, op: EditOp) -> tuple[Tensor, ...]:
    """Ids of the Gaussians of each thing that an operation put somewhere: what is new, or what moved."""
    if op.op == "move":
        rows = torch.cat(_moved(before, after) or (torch.zeros(0, dtype=torch.int64),))
    else:
        rows = (~mask_of(after.cloud, before.cloud.ids)).nonzero().squeeze(1)
    owner = after.cloud.group[rows]
    if after.language is not None:
        owner = _objects(after.language, owner)
    things = [after.cloud.ids[rows[owner == g]] for g in torch.unique(owner)]
    return tuple(sorted((t for t in things if len(t) >= _FEWEST), key=len, reverse=True)[:_MOST])


def _together(told: Sequence[Filled]) -> tuple[Filled, ...]:
    """What was done, one entry for each surface and reason."""
    found: dict[tuple[str, str], Filled] = {}
    for one in told:
        key = one.surface, one.reason
        if (other := found.get(key)) is None:
            found[key] = one
            continue
        area = one.area + other.area
        sure = (one.sure * one.area + other.sure * other.area) / area if area > 0 else 0.0
        found[key] = Filled(
            surface=one.surface, gaussians=one.gaussians + other.gaussians, area=area, sure=sure,
            lighter=one.lighter + other.lighter, darker=one.darker + other.darker, reason=one.reason,
            place=_around(one.place, other.place),
        )  # fmt: skip
    return tuple(found.values())


def _objects(field: LanguageField, groups: Tensor) -> Tensor:
    """The object that each group is of; -1 stays."""
    from .filling.revealed import objects

    return objects(field, groups)


def _around(one: Box | None, other: Box | None) -> Box | None:
    """The box around two boxes."""
    if one is None or other is None:
        return one or other
    (a, b), (c, d) = one, other
    return (min(a[0], c[0]), min(a[1], c[1]), min(a[2], c[2])), (max(b[0], d[0]), max(b[1], d[1]), max(b[2], d[2]))


def _moved(before: Scene, after: Scene) -> tuple[Tensor, ...]:
    """Rows of the cloud before whose centres are elsewhere; rows keep their order when things move."""
    a, b = before.cloud.means, after.cloud.means
    return ((a != b[: len(a)]).any(dim=1).nonzero().squeeze(1),) if a is not b else ()
