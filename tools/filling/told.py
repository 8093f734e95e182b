"""What was filled, in words: which surfaces, how many Gaussians, how sure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...gaussians.scene import Scene
from ..receipt import Filled, Vec3
from .fill import Patch
from .planes import F64

_SURE, _FAIR = 0.7, 0.45  # from which a fill is told to be sure, and fairly sure
_ROUGH = 0.1  # disagreement with the border, display space, at which a fill is worth 1 / e
_NAMED = 0.5  # probability from which a group's name is told


def filled(scene: Scene, patches: Sequence[Patch]) -> tuple[Filled, ...]:
    """What was done to each surface, patches of the same surface together."""
    by_name: dict[tuple[str, str], list[Patch]] = {}
    for patch in patches:
        by_name.setdefault((surface_name(scene, patch), patch.reason), []).append(patch)
    return tuple(_one(name, reason, same) for (name, reason), same in by_name.items())


def _one(name: str, reason: str, patches: list[Patch]) -> Filled:
    area = sum(p.area for p in patches)
    sure = sum(_sure(p) * p.area for p in patches) / area if area > 0 else 0.0
    return Filled(
        surface=name,
        gaussians=sum(len(p.cloud) for p in patches),
        area=area,
        sure=0.0 if reason else sure,
        lighter=sum(len(p.shaded) for p in patches),
        reason=reason,
        place=_place([p.corners for p in patches if len(p.corners)]) if reason else None,
    )


def _place(corners: Sequence[F64]) -> tuple[Vec3, Vec3] | None:
    """The box around some boxes."""
    if not corners:
        return None
    low, high = np.min([c[0] for c in corners], axis=0), np.max([c[1] for c in corners], axis=0)
    return _rounded(low), _rounded(high)


def _rounded(point: F64) -> Vec3:
    x, y, z = (round(float(v), 5) for v in point)
    return x, y, z


def _sure(patch: Patch) -> float:
    """How sure a fill is, in [0, 1]: by how much of its border is known and how well its texture meets the border."""
    return float(min(1.0, patch.support) * np.exp(-patch.error / _ROUGH))


def surface_name(scene: Scene, patch: Patch) -> str:
    """ "the floor", "the wall", "the table": by its group, else by how it lies."""
    groups = patch.cloud.group.tolist()
    if patch.plane is not None and scene.language is not None and groups:
        names, count = np.unique(groups, return_counts=True)
        group = int(names[count.argmax()])
        if group >= 0:
            known = scene.language.groups[group]
            known = scene.language.groups[known.parent] if known.parent >= 0 else known
            if known.label and known.label_score >= _NAMED:
                return f"the {known.label}"
    if patch.plane is None:
        return "what lies behind it"
    level = float(patch.plane.normal @ scene.frame.up_vector)
    if level > 0.9:
        return "the floor" if patch.plane.last else "the surface under it"
    if level < -0.9:
        return "the ceiling"
    return "the wall" if patch.plane.last and abs(level) < 0.3 else "the surface beside it"


def notes(told: Sequence[Filled]) -> tuple[str, ...]:
    """The same as notes of a receipt."""
    lines = []
    made = [f for f in told if f.gaussians]
    if made:
        parts = [f"{f.surface} by {f.gaussians:,} Gaussians ({_word(f.sure)})" for f in made]
        lines.append(f"filled what it hid: continued {', '.join(parts)}")
    for f in told:
        if f.lighter:
            lines.append(f"took its contact shadow off {f.surface}: {f.lighter:,} Gaussians are lighter")
        if f.reason:
            lines.append(f"left a hole in {f.surface}: {f.reason}")
    return tuple(lines)


def _word(sure: float) -> str:
    return "sure" if sure >= _SURE else "fairly sure" if sure >= _FAIR else "a guess"
