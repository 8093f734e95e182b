"""Checks of sizes: a new thing is as large as its kind is beside what stands there, a copy as large as its original."""

from __future__ import annotations

import math

import numpy as np

from ...gaussians.world import kinds
from ...gaussians.world.box import Box
from ..new_objects import SceneScale, scene_scale
from ..receipt import Check, at_most, report
from .case import Case

_OUT = 1.5  # factor beyond the sizes as sold by which a new thing may be larger or smaller
_LIKE = 0.05  # relative error of the size of a copy
_WIDER = 1.6  # of what it replaces: how wide or tall a new thing may be where nothing tells the scale


def of_its_kind(case: Case, kind: str, box: Box, scale: SceneScale) -> Check:
    """A new thing has a size at which its kind is sold, in metres by a scale."""
    known = kinds.find(kind)
    if known is None or case.context.assets is not None:
        return report("size of its kind", 1.0, "1", f"the usual size of a {kind} is not known")
    width, depth, height = known.size
    level = (max(width[0], depth[0]), max(width[1], depth[1]))
    sides = (max(box.size[:2]) / scale.units_per_metre, level), (box.size[2] / scale.units_per_metre, height)
    out = [max(has / high, low / max(has, 1e-9), 1.0) if has > 0 else math.inf for has, (low, high) in sides]
    signs = [1 if has > high else -1 for has, (_, high) in sides]
    off = math.exp(abs(sum(s * math.log(o) for s, o in zip(signs, out, strict=True))) / 2)
    told = " x ".join(f"{has:.2g}" for has, _ in sides)
    return at_most(
        "size of its kind", off, _OUT, "1", f"it is {told} m wide and tall, {off:.2g} times out of the usual"
    )


def scale_around(case: Case) -> SceneScale:
    """The scale of the scene before, as the things tell it that the words of the place name."""
    place = getattr(case.op, "place", None)
    anchors = []
    if place is not None and case.before.frame.metres_per_unit is None and len(place.anchors) == 1:
        from ..placement.bodies import bodies_of

        found = case.context.resolve(case.before, place.anchors[0])
        anchors = [(b, place.anchors[0].text) for b in bodies_of(case.before, found)] if found.chosen else []
    return scene_scale(case.before, anchors)


def fits_old(case: Case, box: Box) -> Check:
    """Where nothing tells the scale, a new thing is at most a little wider or taller than what it replaces."""
    most = max(
        min(max(box.size[:2]) / max(max(b.box.size[:2]), 1e-30), box.size[2] / max(b.box.size[2], 1e-30))
        for b in case.bodies
    )
    return at_most("as large as the old", most, _WIDER, "1", f"it is {most:.2g} times as large as what it replaces")


def like_original(box: Box, original: Box) -> Check:
    """A copy has the size of its original."""
    off = float(np.abs(np.array(box.size) / np.maximum(original.size, 1e-30) - 1).max())
    return at_most("as large as the original", off, _LIKE, "1", f"its size is off by {off:.1%}")
