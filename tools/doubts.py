"""Selections of captures that are too scattered or too large for one thing: they are confirmed before they are edited.

A segmentation of a capture may give a thing pieces from all over the room, or most of the scene. What is found for a
name is then hardly what is meant, whatever the name's score.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..gaussians.language.query.selection import Selection
from ..gaussians.scene import Scene
from ..gaussians.world import kinds
from ..gaussians.world.core import core_of
from .cloud_diff import rows_of

_UNITY = 0.6  # least share of one thing that is in its heaviest connected piece; of real things it is above 0.9
_SURE = 0.8  # probability from which a name is believed, whatever the size
_SMALL = 1.2  # metres: usual longest side of a kind up to which it fills no scene
_MOST = 0.6  # of the scene's extent without its outermost tenth: longest side of such a thing
_SAMPLE = 50_000


def with_doubt(scene: Scene, selection: Selection) -> Selection:
    """The selection; "unconfirmed", with the reason, if it is too scattered or too large for the one thing it names.

    Where the scale is known, sizes are part of the selection itself, and scenes are of our own making.
    """
    query = selection.query
    named = bool(query.text) and not (query.last or query.groups or query.confirmed or query.also or query.exclude)
    if selection.verdict != "found" or not named or query.pick in ("all", "rest") or not len(selection):
        return selection
    field = scene.language
    if field is None or scene.frame.metres_per_unit is not None or len(selection.groups) > 1:
        return selection
    if any(field.groups[g].level == "structure" or field.groups[g].label_score >= _SURE for g in selection.groups):
        return selection
    rows = rows_of(scene.cloud, selection.ids)
    unity = core_of(scene.cloud, rows).unity
    why = f"only {unity:.0%} of it is in one piece" if unity < _UNITY else _too_large(scene, selection)
    if not why:
        return selection
    reason = f"what was found for {query.describe()} may be more than one thing: {why}"
    return replace(selection, verdict="unconfirmed").noting(reason)


def _too_large(scene: Scene, selection: Selection) -> str:
    """Why a selection is too large for its kind; "" if it is not, or nothing is known of the kind."""
    kind = kinds.find(selection.query.text)
    if kind is None or not selection.groups or max(high for _, high in kind.size) > _SMALL:
        return ""
    assert scene.language is not None
    points = scene.cloud.means[:: max(1, len(scene.cloud) // _SAMPLE)].double().cpu().numpy() @ scene.frame.basis().T
    extent = float((np.quantile(points, 0.9, axis=0) - np.quantile(points, 0.1, axis=0)).max())
    share = max(scene.language.groups[selection.groups[0]].box.size) / max(extent, 1e-30)
    return f"it is {share:.1f} times as wide as the middle of the scene" if share > _MOST else ""
