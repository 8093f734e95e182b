"""Questions about sides: of the viewer, of a thing, of somebody who sits on it or faces another thing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ....gaussians.world import kinds
from .. import sentences as say
from ..naming import Made, Room, asked, named, yes_no
from ..truth import Thing, bearing, outside, plan_gap

ASIDE = 0.5  # metres to a side, at least
TILT = 1.5  # and as a multiple of the offset along the other axis
_SEATS = ("sofa", "armchair", "chair", "office chair", "loveseat", "rocking chair", "rattan chair", "gaming chair")


def _sides(right: float, ahead: float) -> tuple[str, str]:
    """ "left" or "right", and "front" or "behind", of an offset; "" where it is not clear."""
    across = "right" if right > 0 else "left"
    along = "front" if ahead > 0 else "behind"
    return (
        across if abs(right) >= ASIDE and abs(right) >= TILT * abs(ahead) else "",
        along if abs(ahead) >= ASIDE and abs(ahead) >= TILT * abs(right) else "",
    )


def viewer_side(room: Room) -> Made:
    """Left, right, in front and behind of the viewer: clear in the levelled axes and as a line of sight."""
    eye, forward = np.array(room.table.eye), np.array(room.table.forward)
    for a, b in room.pairs():
        offset = a.xy - b.xy
        across, along = _sides(float(offset @ room.table.right), float(offset @ forward))
        sight = [bearing(t.xy, eye, forward) for t in (a, b)]
        if min(s[1] for s in sight) < 0.3:
            continue  # behind the viewer's back
        if across:
            angles = [np.degrees(np.arctan2(*s)) for s in sight]
            if (angles[0] > angles[1] + 3) != (across == "right") or abs(angles[0] - angles[1]) < 3:
                continue
            yield from _side_forms(room, "viewer_side", (say.SIDE, say.SIDE_IS), across, (a, b), ("left", "right"))
        if along:
            # Toward the viewer is in front.
            side = "behind" if along == "front" else "front"
            words = ("in front of", "behind")
            yield from _side_forms(room, "viewer_side", (say.DEPTH, say.DEPTH_IS), side, (a, b), words)


def _side_forms(
    room: Room, kind: str, wordings: tuple[Sequence[str], Sequence[str]], side: str, things: tuple[Thing, ...],
    words: tuple[str, str],
) -> Made:  # fmt: skip
    """One question of a side: which, or yes or no."""
    values = dict(zip("abc", things, strict=False))
    viewer = kind == "viewer_side"
    if room.rng.random() < 0.5:
        yield asked(room, kind, "label", room.word(wordings[0], **values), side, side=viewer, **named(*things))
        return
    said = words[int(room.rng.integers(2))]
    holds = said.split()[-1] == side or (said == "in front of" and side == "front")
    yield asked(
        room, kind, "yesno", room.word(wordings[1], **values, side=said), yes_no(holds), side=viewer, **named(*things)
    )


def object_side(room: Room) -> Made:
    """Left and right, before and behind, in the frame of a thing with a front."""
    for b in room.named:
        kind = kinds.of(b.label)
        if kind is None or not kind.front or not room.table.on_floor(b):
            continue
        for a in room.named:
            if a.id == b.id:
                continue
            across, along = _sides(*bearing(a.xy, b.xy, b.front))
            if across and plan_gap(a, b) > 0.05:
                text = room.word(say.OWN_SIDE, a=a, b=b)
                yield asked(room, "object_side", "label", text, across, **named(b, a))
            if along and plan_gap(a, b) > 0.05:
                text = room.word(say.OWN_FRONT, a=a, b=b)
                yield asked(room, "object_side", "label", text, along, **named(b, a))


def seated(room: Room) -> Made:
    """Left and right of someone who sits on a seat and looks where it faces."""
    for b in room.named:
        if b.label not in _SEATS or not room.table.on_floor(b):
            continue
        for a in room.named:
            across, _ = _sides(*bearing(a.xy, b.xy, b.front))
            if a.id != b.id and across and plan_gap(a, b) > 0.05:
                yield from _side_forms(room, "seated", (say.SEATED, say.SEATED_IS), across, (a, b), ("left", "right"))


def facing(room: Room) -> Made:
    """Left, right and behind of someone who stands at one thing and faces another."""
    standing = room.standing
    for a, b, c in room.triples(standing):
        way = c.xy - b.xy
        far = float(np.linalg.norm(way))
        if far < 1.0:
            continue
        spots = (b.xy, outside(b, c))  # people stand at a thing on its near side, or where it is
        seen = {_sides(*bearing(a.xy, spot, way / far)) for spot in spots}
        if len(seen) > 1:
            continue
        across, along = next(iter(seen))
        if across:
            yield asked(room, "facing", "label", room.word(say.FACING, a=a, b=b, c=c), across, **named(b, c, a))
        elif along:
            text = room.word(say.FACING_BEHIND, a=a, b=b, c=c)
            yield asked(room, "facing", "yesno", text, yes_no(along == "behind"), **named(b, c, a))
