"""Post-conditions that several operations share, each measured on the scenes before and after."""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor

from ..gaussians.camera import Camera
from ..gaussians.language.field.measure import reach, solid_points
from ..gaussians.language.query.selection import mask_of
from ..gaussians.scene import Scene
from ..gaussians.world.box import overlap
from ..gaussians.world.core import coverage
from .operation import Affine, Outcome
from .placement.bodies import Array, centimetre, contact_box, neighbours
from .placement.occupancy import obstacle_points, points_inside
from .receipt import Check, at_most, report

# Foreign points allowed inside a body, as a share of the number of its own: floaters and touching surfaces.
_TOUCHING = 0.01
_DRIFT = 0.35  # of its size in plan: how far the middle of a thing that is turned or scaled may move
_SAMPLE = 20_000  # Gaussians from which that is measured
_ROWS = 1 << 16  # rows compared at a time, so that float64 copies stay small


def count_matches(before: Scene, after: Scene, outcome: Outcome) -> Check:
    """The number of Gaussians changed by exactly those that the operation says it added and removed."""
    off = len(after.cloud) - (len(before.cloud) + len(outcome.added) - len(outcome.removed))
    return at_most("count", abs(off), 0, "Gaussians", f"{abs(off)} Gaussians more or fewer than the edit accounts for")


def none_left(after: Scene, outcome: Outcome) -> Check:
    """None of the removed ids is left in the scene."""
    left = int(mask_of(after.cloud, outcome.removed).sum())
    return at_most("none left", left, 0, "Gaussians", f"{left} of {len(outcome.removed):,} removed Gaussians are left")


def moved_as_asked(before: Scene, after: Scene, moved: tuple[Affine, ...]) -> Check:
    """Every centre is where the requested affine map takes it."""
    worst, extent = 0.0, 0.0
    for body in moved:
        for source, rows in zip(torch.split(body.source, _ROWS), torch.split(body.rows, _ROWS), strict=True):
            was = before.cloud.means[source].to(torch.float64).cpu().numpy()
            now = after.cloud.means[rows].to(torch.float64).cpu().numpy()
            if len(now):
                worst = max(worst, float(np.abs(was @ body.matrix.T + body.offset - now).max()))
                extent = max(extent, float(np.abs(now).max()))
    # float32 keeps 24 bits of a coordinate: after a few roundings two millionths of the largest one are a safe bound.
    bound = 2e-6 * max(extent, 1.0)
    return at_most(
        "moved as asked", worst, bound, "units", f"every centre is within {worst:.2g} units of where it was sent"
    )


def placed(outcome: Outcome) -> tuple[Check, ...]:
    """The checks `supported` and `collision_free` of the bodies that were placed; empty if there are none."""
    checks = supported(outcome.scene, outcome.moved), collision_free(outcome.scene, outcome.moved)
    return tuple(c for c in checks if c is not None)


def supported(after: Scene, moved: tuple[Affine, ...]) -> Check | None:
    """Gap between the underside of each placed body and its supporting surface; None if nothing was placed."""
    up, gaps, bound = after.frame.up_vector, [], 0.0
    for body in moved:
        if body.support is None:
            continue
        points = solid_points(after.cloud, body.rows)
        low, high = reach(points @ up)
        gaps.append(low - body.support)
        # Two centimetres, or 3 % of its height: Gaussians reach about that far beyond their centres.
        bound = max(bound, 2 * centimetre(after.frame, high - low), 0.03 * (high - low))
    if not gaps:
        return None
    worst = max(gaps, key=abs)
    return at_most("supported", abs(worst), bound, "units", f"it stands {worst:+.3g} units above its support")


def collision_free(after: Scene, moved: tuple[Affine, ...]) -> Check | None:
    """Number of solid points of other things inside a placed body; None if nothing was placed."""
    placed = [body for body in moved if body.support is not None and not body.touches]
    if not placed:
        return None
    worst, bound = 0, 0.0
    for body in placed:
        points = solid_points(after.cloud, body.rows)
        box = contact_box(points, after.frame)
        own = torch.zeros(len(after.cloud), dtype=torch.bool, device=after.cloud.device)
        own[body.rows] = True
        others = obstacle_points(after.cloud, own, box.bounds())
        clear = max(0.15 * box.size[2], 1e-9)
        if after.frame.metres_per_unit is not None:  # floors of captures are noisy
            clear = min(clear, 4 * centimetre(after.frame, max(box.size)))
        worst = max(worst, points_inside(points, others, box, clear))
        bound = max(bound, _TOUCHING * len(points), 3.0)
    return at_most("no collision", worst, bound, "Gaussians", f"{worst} points of other things are inside it")


def overlap_notes(after: Scene, groups: set[int]) -> tuple[str, ...]:
    """Notes that name the objects whose boxes a moved object now overlaps.

    A move by a distance may end in an overlap, so this is a note and not a check.
    """
    notes = []
    for group in sorted(g for g in groups if g >= 0):
        assert after.language is not None
        box = after.language.groups[group].box
        for label, other in neighbours(after, groups):
            if overlap(box, other) > 0.1 * min(*box.size, *other.size):
                notes.append(f"it now overlaps the {label or 'thing beside it'}")
    return tuple(dict.fromkeys(notes))[:5]


def out_of_view_note(after: Scene, moved: tuple[Affine, ...], viewer: Camera) -> tuple[str, ...]:
    """A note with the number of new objects outside the viewer's picture; empty if all are inside."""
    centers = np.stack([after.cloud.means[body.rows].mean(dim=0, dtype=torch.float64).cpu().numpy() for body in moved])
    hidden = int((~viewer.contains(*viewer.project(centers))).sum())
    return (f"{hidden} of {len(moved)} stand outside the current view",) if hidden else ()


def _rms_radius(points: Array) -> float:
    """Root mean square distance of points from their mean."""
    return float(np.sqrt(((points - points.mean(axis=0)) ** 2).sum(axis=1).mean())) if len(points) else 0.0


def stays_put(before: Scene, after: Scene, moved: tuple[Affine, ...]) -> Check:
    """The middle of a turned or scaled thing stayed over the same spot, measured as the middle of its 5 % and 95 %
    quantiles, seen from above.

    A thing that turns about the middle of its box moves that middle by up to twice as far as thin ends reach out of it
    on one side, which is allowed besides `_DRIFT`. A pivot that lies elsewhere moves it by more.
    """
    plan, worst, bound = np.array(before.frame.basis()[:2]), 0.0, _DRIFT
    for body in moved:
        step = max(1, len(body.rows) // _SAMPLE)
        was, now = (_bulk(s, rows[::step], plan) for s, rows in ((before, body.source), (after, body.rows)))
        size = max(float(np.linalg.norm(high - low)) for low, high in (was, now))
        drift = float(np.linalg.norm(now.mean(axis=0) - was.mean(axis=0))) / max(size, 1e-30)
        if drift > bound:
            ends = solid_points(before.cloud, body.source) @ plan.T
            uneven = (ends.min(axis=0) + ends.max(axis=0)) / 2 - was.mean(axis=0)
            bound = max(bound, _DRIFT + 2 * float(np.linalg.norm(uneven)) / max(size, 1e-30))
        worst = max(worst, drift)
    return at_most("on the spot", worst, bound, "1", f"its middle moved by {worst:.2g} of its size")


def _bulk(scene: Scene, rows: Tensor, plan: Array) -> Array:
    """`[2, 2]` the 5 % and the 95 % quantile of what Gaussians cover, along two level axes."""
    points = scene.cloud.means[rows].to(torch.float64).cpu().numpy() @ plan.T
    weight = coverage(scene.cloud.scales[rows], scene.cloud.opacities[rows]).astype(np.float64)
    found = []
    for values in points.T:
        order = np.argsort(values)
        total = np.cumsum(weight[order])
        found.append(values[order[np.searchsorted(total, np.array([0.05, 0.95]) * total[-1])]])
    return np.stack(found, axis=1)


def size_changed(before: Scene, after: Scene, body: Affine) -> Check:
    """The extent of a scaled body changed by the requested map; measured as the RMS radius of its centres."""
    was = before.cloud.means[body.source].to(torch.float64).cpu().numpy()
    now = after.cloud.means[body.rows].to(torch.float64).cpu().numpy()
    if len(was) < 4:
        return report("size", float("nan"), "1", "too few Gaussians to measure a size")
    ratio = _rms_radius(now) / max(_rms_radius(was @ body.matrix.T), 1e-30)
    return at_most("size", abs(ratio - 1), 1e-4, "1", f"its extent is {ratio:.5f} times what was asked")
