"""Post-conditions that several operations share, each measured on the scenes before and after.

Knows scenes, what was asked of each body, and tolerances with their reasons. Refuses to know which operation asked.
"""

from __future__ import annotations

import numpy as np
import torch

from ..gaussians.camera import Camera
from ..gaussians.language.field.measure import reach, solid_points
from ..gaussians.language.query.selection import mask_of
from ..gaussians.scene import Scene
from ..gaussians.world.box import overlap
from .operation import Affine, Outcome
from .placement.bodies import Array, centimetre, contact_box, neighbours
from .placement.occupancy import hits, obstacle_points
from .receipt import Check, at_most, report

# A body may pass through this share of its points' number of foreign points: floaters and touching surfaces.
_TOUCHING = 0.01
_BLOCK = 1 << 16  # rows compared at a time, so that float64 copies stay small


def counted(before: Scene, after: Scene, outcome: Outcome) -> Check:
    """No Gaussian appeared or vanished beyond those the operation names."""
    off = len(after.cloud) - (len(before.cloud) + len(outcome.added) - len(outcome.removed))
    return at_most("count", abs(off), 0, "Gaussians", f"{abs(off)} Gaussians more or fewer than the edit accounts for")


def gone(after: Scene, outcome: Outcome) -> Check:
    """None of the removed ids is left."""
    left = int(mask_of(after.cloud, outcome.removed).sum())
    return at_most("none left", left, 0, "Gaussians", f"{left} of {len(outcome.removed):,} removed Gaussians are left")


def carried_as_asked(before: Scene, after: Scene, moved: tuple[Affine, ...]) -> Check:
    """Every centre is where the asked map takes it."""
    worst, extent = 0.0, 0.0
    for body in moved:
        for source, rows in zip(torch.split(body.source, _BLOCK), torch.split(body.rows, _BLOCK), strict=True):
            was = before.cloud.means[source].to(torch.float64).cpu().numpy()
            now = after.cloud.means[rows].to(torch.float64).cpu().numpy()
            if len(now):
                worst = max(worst, float(np.abs(was @ body.matrix.T + body.offset - now).max()))
                extent = max(extent, float(np.abs(now).max()))
    # float32 keeps 24 bits of a coordinate; a few roundings later a millionth of the largest one is still safe.
    bound = 2e-6 * max(extent, 1.0)
    return at_most(
        "moved as asked", worst, bound, "units", f"every centre is within {worst:.2g} units of where it was sent"
    )


def supported(after: Scene, moved: tuple[Affine, ...]) -> Check | None:
    """Gap between the undersides of what was put down and the surface it was put on; None if nothing was."""
    up, gaps, bound = after.frame.up_vector, [], 0.0
    for body in moved:
        if body.support is None:
            continue
        points = solid_points(after.cloud, body.rows)
        low, high = reach(points @ up)
        gaps.append(low - body.support)
        # Two centimetres, or 3 % of its height: splats reach about that far beyond their centres.
        bound = max(bound, 2 * centimetre(after.frame, high - low), 0.03 * (high - low))
    if not gaps:
        return None
    worst = max(gaps, key=abs)
    return at_most("supported", abs(worst), bound, "units", f"it stands {worst:+.3g} units above its support")


def collision_free(after: Scene, moved: tuple[Affine, ...]) -> Check | None:
    """Solid points of other things within what was put down; None if nothing was."""
    placed = [body for body in moved if body.support is not None]
    if not placed:
        return None
    worst, bound = 0, 0.0
    for body in placed:
        points = solid_points(after.cloud, body.rows)
        box = contact_box(points, after.frame)
        own = torch.zeros(len(after.cloud), dtype=torch.bool, device=after.cloud.device)
        own[body.rows] = True
        others = obstacle_points(after.cloud, own)
        clear = max(0.15 * box.size[2], 1e-9)
        worst = max(worst, hits(points, others, box, min(clear, 4 * centimetre(after.frame, max(box.size)))))
        bound = max(bound, _TOUCHING * len(points), 3.0)
    return at_most("no collision", worst, bound, "Gaussians", f"{worst} points of other things are inside it")


def bumps(after: Scene, groups: set[int]) -> tuple[str, ...]:
    """Notes about objects whose boxes a freely moved thing now stands in; moving by a distance does not forbid it."""
    notes = []
    for group in sorted(g for g in groups if g >= 0):
        assert after.language is not None
        box = after.language.groups[group].box
        for label, other in neighbours(after, groups):
            if overlap(box, other) > 0.1 * min(*box.size, *other.size):
                notes.append(f"it now overlaps the {label or 'thing beside it'}")
    return tuple(dict.fromkeys(notes))[:5]


def unseen(after: Scene, moved: tuple[Affine, ...], viewer: Camera) -> tuple[str, ...]:
    """A note if something new stands where the viewer does not look."""
    centers = np.stack([after.cloud.means[body.rows].mean(dim=0, dtype=torch.float64).cpu().numpy() for body in moved])
    hidden = int((~viewer.contains(*viewer.project(centers))).sum())
    return (f"{hidden} of {len(moved)} stand outside the current view",) if hidden else ()


def spread_of(points: Array) -> float:
    """Root mean square distance of points from their mean."""
    return float(np.sqrt(((points - points.mean(axis=0)) ** 2).sum(axis=1).mean())) if len(points) else 0.0


def size_changed(before: Scene, after: Scene, body: Affine) -> Check:
    """The ratio of a stretched body's volume to before is that of the map; measured on its covariance of centres."""
    was = before.cloud.means[body.source].to(torch.float64).cpu().numpy()
    now = after.cloud.means[body.rows].to(torch.float64).cpu().numpy()
    if len(was) < 4:
        return report("size", float("nan"), "1", "too few Gaussians to measure a size")
    ratio = spread_of(now) / max(spread_of(was @ body.matrix.T), 1e-30)
    return at_most("size", abs(ratio - 1), 1e-4, "1", f"its extent is {ratio:.5f} times what was asked")
