"""Selections of captures that are too scattered or too large for one thing: they are confirmed before they are edited.

A segmentation of a capture may give a thing pieces from all over the room, or most of the scene. What is found for a
name is then hardly what is meant, whatever the name's score.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..gaussians.language.field.language_field import LanguageField
from ..gaussians.language.field.scale import estimate_scale
from ..gaussians.language.query.selection import Selection
from ..gaussians.scene import Scene
from ..gaussians.world import kinds
from ..gaussians.world.core import core_of
from .cloud_diff import rows_of

_UNITY = 0.75  # least share of one thing that is in its heaviest connected piece; of real things it is above 0.9
_APART, _WHOLE = 0.9, 0.98  # such shares below which a thing may be two, and from which it is surely one
_LARGER, _FAR_LARGER = 1.15, 2.0  # times the largest of its kind as sold: of what may be two things, of the others
_SURE = 0.8  # probability from which a name is believed, where nothing tells the size
_SMALL = 1.2  # metres: usual longest side of a kind up to which it fills no scene
_MOST = 0.6  # of the scene's extent without its outermost tenth: longest side of such a thing
_SAMPLE = 50_000


def with_doubt(scene: Scene, selection: Selection) -> Selection:
    """The selection; "unconfirmed", with the reason, if it is too scattered or too large for the one thing it names."""
    query = selection.query
    fixed = query.last or query.groups or query.confirmed or query.also or query.exclude or query.spatial
    named = bool(query.text) and not fixed
    if selection.verdict != "found" or not named or query.pick in ("all", "rest") or not len(selection):
        return selection
    field = scene.language
    if field is None or len(selection.groups) > 1 or any(r.name == "part_of" for r in query.relations):
        return selection
    if any(field.groups[g].level == "structure" for g in selection.groups):
        return selection
    why = ""
    if scene.frame.metres_per_unit is None and (unity := _unity(scene, selection)) < _UNITY:
        why = f"only {unity:.0%} of it is in one piece"
    why = why or _too_large(scene, field, selection)
    if not why:
        return selection
    reason = f"what was found for {query.describe()} may be more than one thing: {why}"
    return replace(selection, verdict="unconfirmed").noting(reason)


def _unity(scene: Scene, selection: Selection) -> float:
    """The share of a selection that is in its heaviest connected piece, in [0, 1]."""
    return core_of(scene.cloud, rows_of(scene.cloud, selection.ids)).unity


def _too_large(scene: Scene, field: LanguageField, selection: Selection) -> str:
    """Why a selection is too large for its kind; "" if it is not, or nothing is known of the kind.

    It is measured in metres, if the scale is known or other things tell it, else by the extent of the scene.
    """
    kind = kinds.find(selection.query.text)
    if kind is None or not selection.groups:
        return ""
    group = field.groups[selection.groups[0]]
    scale = scene.frame.metres_per_unit
    if scale is None and (told := estimate_scale([g for g in field.objects() if g.id != group.id])) is not None:
        scale = told.metres
    if scale is not None:
        (width, depth, tallest), (*level, height) = (high for _, high in kind.size), group.box.size
        times = max(max(level) / max(width, depth), height / tallest) * scale
        if times <= _LARGER:  # it is told for no unity
            return ""
        unity = _unity(scene, selection)
        limit = _LARGER if unity < _APART else _FAR_LARGER
        return (
            f"it is {times:.1f} times as large as the largest {kind.name}" if times > limit and unity < _WHOLE else ""
        )
    if max(high for _, high in kind.size) > _SMALL or group.label_score >= _SURE:
        return ""
    points = scene.cloud.means[:: max(1, len(scene.cloud) // _SAMPLE)].double().cpu().numpy() @ scene.frame.basis().T
    extent = float((np.quantile(points, 0.9, axis=0) - np.quantile(points, 0.1, axis=0)).max())
    share = max(group.box.size) / max(extent, 1e-30)
    return f"it is {share:.1f} times as wide as the middle of the scene" if share > _MOST else ""
