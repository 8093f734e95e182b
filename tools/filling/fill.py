"""Fill what a thing that is gone hid: its surroundings' surfaces are continued as new Gaussians.

    planes near the thing -> a chart of each -> hidden and empty cells -> colours and heights continued -> Gaussians

Nothing that is there changes.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
import scipy
import torch
from torch import Tensor

from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud, concat
from ...gaussians.harmonics import color_to_dc, to_color
from ...gaussians.rotations import to_matrix
from ...gaussians.scene import Scene
from .charts import COVERED, Chart, Seen, chart_of, rows_in_slab, seen
from .hidden import VOXELS as HIDING
from .hidden import hidden, space_of
from .new_rows import Look, gaussians_of, is_fill
from .occlusion import blocked, reach_of
from .planes import F64, VOXELS, Mask, Plane, planes_near
from .shadow import Shadow, most_even, multiplied, rows_and_factors, zone_of
from .smooth import harmonic
from .span import Span
from .texture import Continued, continued

if TYPE_CHECKING:
    from .behind.views import View

_AROUND = 0.6  # of the thing's extent: how far around it its surroundings are looked at
OPAQUE = 0.15  # Gaussians below it are haze
_THICK = 3.0  # times the noise of a surface: how thick it is
_FEWEST = 6  # cells of a hole
_ENDED = 0.5  # share of the border of an extension at which another surface has to end it
_SUPPORT = 0.25  # of a hole's border that must be known
_SURROUNDED = 0.6  # likewise, of a surface that things lie behind: as of a vase at the edge of a table
_LEAST = 3e-4  # of the square of the thing's extent: area of a hole that is worth filling
_SKIRT = 0.02  # of the thing's extent: how near a wall the floor is not looked at
_PART = 0.3  # of a gap in a surface: where the thing hid as much of it, all of it is the hole
_ENCLOSED = 0.8  # of such a gap's border that must be of the surface
_FAR = 1.0  # of the thing's extent: a surface farther from it was seen past it
_BODY = 12_000  # Gaussians of a thing from which its shade is measured
_ROUGH = 0.02  # of the thing's extent: noise of a surface on which no shadow can be told
_CLOSED = 0.5  # of the cells around a thing that its support must cover for its shadow to be told
_NEAR = 6  # cells from a hole within which a group must be that is continued into it
_GROUP = 0.1  # of a surface's cells from which a group is part of it
_LOWEST, _SUNK = 0.01, 0.03  # share of a thing's Gaussians that tells its bottom, and how far, of its extent, that may
# lie under what it stands on
_SAMPLE = 60_000  # points of the surroundings
_WIDE = 8_000  # large Gaussians of which further points are taken
_BESIDE = 0.05  # of the thing's extent: how far from where it touches a surface other than floors and walls it hid it


@dataclass(frozen=True, eq=False)
class Patch:
    """One surface that was continued, or could not be; or what a view shows behind the thing, completed.

    Attributes:
        plane: the surface; None for what is of no plane.
        chart: its cells; None likewise.
        hole: `[H, W]`, the cells, or pixels of a view, that were hidden and empty.
        cloud: the new Gaussians; their group is that of the surface they continue. Empty if none were made.
        support: share of the hole's border that is known.
        shaded, factor: `[M]`, rows of the surface that lie in the thing's contact shadow, and by what their colours are
            multiplied to take it away.
        error: root mean square disagreement with the border, display space.
        spread: standard deviation of the surface's texture, display space.
        darkness: of that shadow close to the thing, in [0, 1); 0 without one.
        reason: why nothing was made, "" if something was.
        extent: `[2, 3]` corners of the box around what a view shows.
        seen_area: of it, square scene units.
    """

    plane: Plane | None
    chart: Chart | None
    hole: Mask
    cloud: GaussianCloud
    support: float
    error: float
    spread: float
    reason: str = ""
    shaded: Tensor = field(default_factory=lambda: torch.zeros(0, dtype=torch.int64))
    factor: Tensor = field(default_factory=lambda: torch.zeros(0))
    darkness: float = 0.0
    extent: F64 = field(default_factory=lambda: np.zeros(0))
    seen_area: float = 0.0

    @property
    def area(self) -> float:
        """Of the hole, square scene units."""
        return self.seen_area if self.chart is None else float(self.hole.sum()) * self.chart.cell**2

    @property
    def corners(self) -> F64:
        """`[2, 3]` the lowest and the highest corner of the box around the hole, world; empty if there is no hole."""
        if self.chart is None or not self.hole.any():
            return self.extent
        points = self.chart.points()[self.hole]
        return np.stack([points.min(axis=0), points.max(axis=0)])


def patches_behind(scene: Scene, thing: GaussianCloud, apart: Tensor | None = None) -> list[Patch]:
    """The surfaces that a thing hid, continued.

    Args:
        scene: without the thing.
        thing: its Gaussians, where they were.
        apart: `[N]` bool, Gaussians that are not continued: the thing itself where it stands now. None: there are none.
    """
    finite = torch.isfinite(thing.means).all(dim=1) & torch.isfinite(thing.scales).all(dim=1)
    thing = thing if bool(finite.all()) else thing[finite]
    size, low, high = _extent(thing)
    if size <= 0:
        return []
    pad = _AROUND * size
    rows = rows_between(scene.cloud, low - pad, high + pad)
    rows = rows if apart is None else rows[~apart[rows]]
    # What was filled before tells nothing of where a surface goes on: the same hole filled again stays as it is.
    made_before = is_fill(scene.cloud, rows)
    earlier, rows = rows[made_before], rows[~made_before]
    solid = rows[scene.cloud.opacities[rows] > OPAQUE]
    around = spread(scene.cloud, solid[:: max(1, len(solid) // _SAMPLE)], size)
    own = points_of(thing, (thing.opacities > OPAQUE).nonzero().squeeze(1))
    own = own[((own >= low) & (own <= high)).all(axis=1)]
    if len(own) < 4:
        return []
    up = scene.frame.up_vector
    middle = (low + high) / 2
    eyes = [c.position for c in scene.cameras if c.contains(*c.project(middle[None]))[0]]
    planes = planes_near(around, own, up, np.array(eyes).reshape(-1, 3))
    patches = list[Patch]()
    for plane in planes:
        clips = [p for p in planes if p is not plane and p.last]
        patch = _patch(scene, (rows, earlier), thing, plane, clips, (low, high, size))
        if patch is not None and (plane.last or len(patch.cloud) or len(patch.shaded)):
            patches.append(patch)  # that a surface among others ends before the thing is nothing to tell
    from .behind.views import witnesses_of

    there = scene.cloud if apart is None else scene.cloud[~apart]
    witnesses = witnesses_of(there, thing, scene.cameras)
    span = Span.of(there, size)
    patches = [_unseen_part(p, witnesses, span) for p in patches]
    return patches + _behind(scene, thing, apart, (low, high), patches, witnesses, span)


def _unseen_part(patch: Patch, witnesses: Sequence[View], span: Span) -> Patch:
    """A patch without the new Gaussians that photographs would have seen before what they show, or that lie beyond the
    scene."""
    from .behind.views import seen_past

    if not len(patch.cloud):
        return patch
    points = patch.cloud.means.to(torch.float64).cpu().numpy()
    past = seen_past(points, witnesses) | span.outside(points)
    if not past.any():
        return patch
    kept, hole = patch.cloud[torch.from_numpy(~past).to(patch.cloud.device)], patch.hole.copy()
    if patch.chart is not None:
        hole[hole] = ~span.outside(patch.chart.points()[hole])
    return replace(patch, cloud=kept, hole=hole)


def _behind(
    scene: Scene, thing: GaussianCloud, apart: Tensor | None, corners: tuple[F64, F64], patches: Sequence[Patch],
    witnesses: Sequence[View], span: Span,
) -> list[Patch]:  # fmt: skip
    """What lies behind a thing and is of no plane that was continued."""
    from .behind.dark import without_dark
    from .behind.glass import glass_of
    from .behind.lifted import holes_filled
    from .behind.views import place_of, without_gloss

    cloud = unshaded(scene, patches)
    cloud = cloud if apart is None else cloud[~apart]
    new = merged(scene, patches)
    cloud = concat([cloud, new]) if len(new) else cloud
    looking = [c for c in scene.cameras if c.contains(*c.project(((corners[0] + corners[1]) / 2)[None]))[0]]
    bands, cloud = cloud.degree, without_gloss(cloud, looking)
    place = place_of(cloud, thing, corners, scene.cameras, scene.frame.up_vector, span, witnesses)
    place = without_dark(place, cloud, thing, scene.cameras)
    return [
        Patch(
            None,
            None,
            h.pixels,
            h.cloud.with_degree(bands),
            h.support,
            h.spread,
            h.spread,
            h.reason,
            extent=h.corners,
            seen_area=h.area,
        )
        for h in holes_filled(cloud, place, glass_of(scene))
    ]


def _extent(thing: GaussianCloud) -> tuple[float, F64, F64]:
    """Largest extent and corners of a thing without its strays."""
    if len(thing) < 4:
        return 0.0, np.zeros(3), np.zeros(3)
    from ...gaussians.world.core import core_of

    rows = torch.arange(len(thing), device=thing.device)
    points = points_of(thing, rows[torch.from_numpy(core_of(thing, rows).solid).to(rows.device)])
    if len(points) < 4:
        return 0.0, np.zeros(3), np.zeros(3)
    low, high = np.quantile(points, [0.002, 0.998], axis=0)
    pad = 0.02 * float((high - low).max())
    return float((high - low).max()), low - pad, high + pad


def points_of(cloud: GaussianCloud, rows: Tensor) -> F64:
    points: F64 = cloud.means[rows].to(torch.float64).cpu().numpy()
    return points


def spread(cloud: GaussianCloud, rows: Tensor, size: float) -> F64:
    """Points that Gaussians cover: their centres, and a grid of points on those that are large."""
    points = points_of(cloud, rows)
    wide = rows[cloud.scales[rows].amax(dim=1) > size / VOXELS]
    wide = wide[:: max(1, len(wide) // _WIDE)]
    if not len(wide):
        return points
    scales, order = cloud.scales[wide].sort(dim=1, descending=True)
    axes = to_matrix(cloud.quats[wide]).gather(2, order[:, None, :].expand(-1, 3, -1))  # columns, the longest first
    found = [points]
    for a, b in itertools.product((-1.0, 0.0, 1.0), repeat=2):
        if a or b:
            reach = axes[:, :, 0] * (a * scales[:, :1]) + axes[:, :, 1] * (b * scales[:, 1:2])
            found.append((cloud.means[wide] + reach).to(torch.float64).cpu().numpy())
    return np.concatenate(found)


def rows_between(cloud: GaussianCloud, low: F64, high: F64) -> Tensor:
    """Rows of the visible Gaussians between two corners."""
    a, b = (torch.tensor(c, dtype=torch.float32, device=cloud.device) for c in (low, high))
    inside = ((cloud.means >= a) & (cloud.means <= b)).all(dim=1) & (cloud.opacities > 0.02)
    rows = inside.nonzero().squeeze(1)
    return rows[torch.isfinite(cloud.scales[rows]).all(dim=1)]


def _patch(
    scene: Scene, known: tuple[Tensor, Tensor], thing: GaussianCloud, plane: Plane, clips: Sequence[Plane],
    extent: tuple[F64, F64, float],
) -> Patch | None:  # fmt: skip
    """One surface continued where the thing hid it; None if it hid nothing of it.

    Args:
        known: rows of what is around, and of what was filled there before.
    """
    (rows, earlier), (_, _, size) = known, extent
    placed = _chart(scene, rows, plane, extent)
    if placed is None:
        return None
    chart, slab = placed
    shown = seen(chart, as_photographed(scene, slab, plane))
    own = _of_surface(shown)
    within = _before(chart.points(), clips, 0.0)
    # Skirting boards and the like are in front of a wall and none of the floor.
    covered = (shown.alpha > COVERED) & own & _before(chart.points(), clips, max(_SKIRT * size, 1.5 * chart.cell))
    empty = (shown.alpha <= COVERED) & within
    there = _covers(scene, earlier, plane, chart, size)
    surface = Surface(chart, shown, covered, slab, there)
    hole, support = np.zeros_like(empty), 0.0
    if empty.sum() >= _FEWEST:
        was, open_ = _hidden_cells(scene, rows, slab, thing, plane, chart, empty, extent)
        # Where nothing was seen, the surface is there if it is there around.
        filled = harmonic(covered.astype(np.float64)[..., None], covered | open_, was)[..., 0]
        hole = (was & (filled > 0.5)) | _gaps(was, empty, covered, within)
        hole &= ~beyond(hole, covered, within)
        hole = _large(hole & ~there, _LEAST * size**2 / chart.cell**2)
        rim = scipy.ndimage.binary_dilation(hole, iterations=2) & ~hole
        told = (covered | open_) & rim if plane.last or plane.carries else rim
        support = float((covered & rim).sum()) / max(int(told.sum()), 0.2 * int(rim.sum()), 1)
    shadow = _shadow(thing, surface, within, size)
    if not hole.any() and shadow is None:
        return None
    return continue_into(scene, surface, hole, support, shadow)


def _covers(scene: Scene, rows: Tensor, plane: Plane, chart: Chart, size: float) -> Mask:
    """`[H, W]` where some rows, which lie on a surface, cover it."""
    thick = max(_THICK * plane.noise, 0.01 * size)
    return seen(chart, scene.cloud[rows_in_slab(scene.cloud, rows, chart, thick, thick)]).alpha > COVERED / 2


@dataclass(frozen=True, eq=False)
class Surface:
    """A surface in its chart: what is seen of it, the cells that it covers `[H, W]`, its rows, and the cells that an
    earlier fill covers, None if there was none."""

    chart: Chart
    shown: Seen
    covered: Mask
    rows: Tensor
    made: Mask | None = None


def _shadow(thing: GaussianCloud, surface: Surface, within: Mask, size: float) -> Shadow | None:
    """The contact shadow of a thing on a surface."""
    plane = surface.chart.plane
    if not (plane.carries or plane.last) or plane.noise > _ROUGH * size:
        return None
    footprint = seen(surface.chart, thing).alpha > COVERED
    if not footprint.any():
        return None
    zone = zone_of(footprint, surface.chart, size) & within
    if surface.covered[zone & ~footprint].sum() < _CLOSED * (zone & ~footprint).sum():
        return None
    points = spread(thing, (thing.opacities > OPAQUE).nonzero().squeeze(1)[:: max(1, len(thing) // _BODY)], size)
    rows, columns = np.nonzero(footprint)
    wide = float(max(np.ptp(rows), np.ptp(columns)) + 1) * surface.chart.cell
    shade = blocked(points, surface.chart, reach_of(wide, float(np.quantile(plane.height(points), 0.98))))
    known = _same(surface.shown, surface.covered, footprint)
    return most_even(surface.shown.rgb, known, footprint, zone, shade)


def _chart(
    scene: Scene, rows: Tensor, plane: Plane, extent: tuple[F64, F64, float]
) -> tuple[Chart, Tensor] | None:  # fmt: skip
    """The chart of a surface around a thing, and the rows of the surface; None if the thing is far from it."""
    low, high, size = extent
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    local = plane.local(corners)
    if local[:, 2].min() > _FAR * size:
        return None
    pad = _AROUND * size
    thick = max(_THICK * plane.noise, 0.01 * size)
    window = local[:, :2].min(axis=0) - pad, local[:, :2].max(axis=0) + pad
    coarse = chart_of(plane, *window, float((window[1] - window[0]).max()) / 100)
    slab = rows_in_slab(scene.cloud, rows, coarse, thick, thick)
    chart = chart_of(plane, *window, spacing_of(coarse, scene.cloud, slab))
    return chart, slab


def continue_into(
    scene: Scene, surface: Surface, hole: Mask, support: float, shadow: Shadow | None, reason: str = ""
) -> Patch:
    """The new Gaussians of a hole, and the factors that take the shadow away.

    Args:
        support: share of the hole's border that is known.
        reason: why it must not be filled; "" if it may.
    """
    chart, shown = surface.chart, surface.shown
    nothing = scene.cloud[torch.zeros(0, dtype=torch.int64)]
    least = _SUPPORT if chart.plane.last or chart.plane.carries else _SURROUNDED
    if not reason and support < least and hole.any():
        reason = "too little of it is seen around the hole"
    rows, factor, darkness = torch.zeros(0, dtype=torch.int64), torch.zeros(0), 0.0
    if shadow is not None:
        darkness = shadow.depth
        shown = replace(shown, rgb=shown.rgb / shadow.ratio[..., None])
        rows, factor = rows_and_factors(scene.cloud, surface.rows, chart, 1 / shadow.ratio)
    if reason or not hole.any():
        return Patch(chart.plane, chart, hole, nothing, support, 0.0, 0.0, reason, rows, factor, darkness)
    return replace(
        _filled(scene, replace(surface, shown=shown), hole, support),
        shaded=rows, factor=factor, darkness=darkness,
    )  # fmt: skip


def _filled(scene: Scene, surface: Surface, hole: Mask, support: float) -> Patch:
    chart, shown, plane = surface.chart, surface.shown, surface.chart.plane
    known = _same(shown, surface.covered & ~hole, hole)
    result: Continued = continued(shown.rgb, known, hole)
    solid = known & (shown.alpha > 0.9) if (known & (shown.alpha > 0.9)).any() else known
    height = harmonic(shown.height[..., None], solid, hole | (known & ~solid))[..., 0]
    edge = scipy.ndimage.binary_dilation(hole) & known & (shown.alpha < 0.9)
    cells = hole | (edge if surface.made is None else edge & ~surface.made)
    points = torch.from_numpy(chart.points(height)[cells].astype(np.float32))
    look = Look(points, result.picture[cells], _groups(shown, known)[cells], gaze(scene.cameras, plane, points))
    cloud = gaussians_of(chart, look, scene.cloud, surface.rows)
    return Patch(plane, chart, hole, cloud, support, result.error, result.spread)


def _groups(shown: Seen, known: Mask) -> np.ndarray:
    """`[H, W]` group of the nearest known cell."""
    at = scipy.ndimage.distance_transform_edt(~known, return_distances=False, return_indices=True)
    return np.asarray(shown.group[tuple(at)])


def _of_surface(shown: Seen) -> Mask:
    """The cells whose group is part of the surface; small groups are things that reach into it."""
    there = shown.alpha > COVERED
    if not there.any():
        return there
    names, count = np.unique(shown.group[there], return_counts=True)
    main = names[(count >= _GROUP * count.sum()) | (names < 0)]
    return np.asarray(np.isin(shown.group, main))


def as_photographed(scene: Scene, rows: Tensor, plane: Plane) -> GaussianCloud:
    """Some Gaussians with the colour that photographs show of them, the same from all sides.

    View-dependent colour holds where it was seen from. Seen along the normal of a surface it may be anything.
    """
    cloud = scene.cloud[rows]
    if not cloud.degree or not len(cloud):
        return cloud
    rgb = to_color(cloud.sh, gaze(scene.cameras, plane, cloud.means)).clamp(0, 1)
    return cloud.replace(sh=color_to_dc(rgb)[:, None])


def gaze(cameras: Sequence[Camera], plane: Plane, points: Tensor) -> Tensor:
    """`[M, 3]` unit directions in which the photographs look at points of a surface, on average; against its normal
    where there are none."""
    eyes = [c.position for c in cameras if (c.position - plane.origin) @ plane.normal > 0]
    ahead = torch.from_numpy(-plane.normal.astype(np.float32)).to(points.device)
    if not eyes:
        return ahead.expand(len(points), 3)
    eye = torch.from_numpy(np.mean(eyes, axis=0).astype(np.float32)).to(points.device)
    return torch.nn.functional.normalize(points - eye, dim=1)


def _same(shown: Seen, known: Mask, place: Mask) -> Mask:
    """The known cells of the groups that are in or near a place: a picture on the wall beside it is left out."""
    near = known & scipy.ndimage.binary_dilation(place, iterations=_NEAR)
    if not near.any():
        return known
    names, count = np.unique(shown.group[near], return_counts=True)
    return np.asarray(known & np.isin(shown.group, names[count >= _GROUP * count.sum()]))


def _before(points: F64, clips: Sequence[Plane], margin: float) -> Mask:
    """Which points lie before every plane behind which nothing lies, by a margin."""
    inside = np.ones(points.shape[:-1], bool)
    for plane in clips:
        inside &= plane.height(points) > margin - max(2 * plane.noise, 1e-9)
    return inside


def _hidden_cells(
    scene: Scene, rows: Tensor, slab: Tensor, thing: GaussianCloud, plane: Plane, chart: Chart, empty: Mask,
    extent: tuple[F64, F64, float],
) -> tuple[Mask, Mask]:  # fmt: skip
    """Which of the empty cells the thing hid, and which were seen to be empty."""
    low, high, size = extent
    points = chart.points()
    flat = points.reshape(-1, 3)
    touched = _touched(thing, chart, size / HIDING)
    if not plane.last:  # a surface among others is known to go on only where the thing lay on it
        # Nobody saw the underside of what stands on it: all that lies below the thing may have been touched.
        lowest = float(np.quantile(plane.height(points_of(thing, torch.arange(len(thing)))), _LOWEST))
        stands = plane.carries and lowest > -_SUNK * size
        lay = seen(chart, thing).alpha > COVERED if stands else touched
        empty = empty & scipy.ndimage.binary_dilation(lay, iterations=max(1, round(_BESIDE * size / chart.cell)))
        if not empty.any():
            return empty, empty
    least, most = np.minimum(flat.min(axis=0), low), np.maximum(flat.max(axis=0), high)
    in_slab = torch.zeros(len(scene.cloud), dtype=torch.bool, device=scene.cloud.device)
    in_slab[slab] = True
    others = rows[~in_slab[rows] & (scene.cloud.opacities[rows] > 2 * OPAQUE)]
    body = points_of(thing, (thing.opacities > OPAQUE).nonzero().squeeze(1))
    space = space_of(body, points_of(scene.cloud, others), least, most)
    stride = max(1, int(np.ceil(np.sqrt(empty.sum() / 1600))))
    asked = np.zeros_like(empty)
    asked[::stride, ::stride] = True
    coarse = asked & scipy.ndimage.binary_dilation(empty, iterations=stride)
    was, free = np.zeros_like(empty), np.zeros_like(empty)
    was[coarse], free[coarse] = hidden(points[coarse], plane.normal, space, scene.cameras, scene.frame.up_vector)
    if stride > 1:
        at = scipy.ndimage.distance_transform_edt(~coarse, return_distances=False, return_indices=True)
        was, free = was[tuple(at)], free[tuple(at)]
    was = (was | touched) & empty
    return was, free & empty & ~was


def _touched(thing: GaussianCloud, chart: Chart, reach: float) -> Mask:
    """The cells that the thing lies on or touches."""
    rows = torch.arange(len(thing), device=thing.device)
    near = rows_in_slab(thing, rows, chart, reach, 2 * reach)
    return seen(chart, thing[near]).alpha > COVERED


def _gaps(was: Mask, empty: Mask, covered: Mask, within: Mask) -> Mask:
    """The gaps in a surface that a thing hid a good part of: holes, though some views see into them.

    Args:
        was: the empty cells that the thing hid.
        within: where the surface may be.
    """
    area, _ = scipy.ndimage.label(empty)
    out = np.zeros_like(empty)
    for k, place in enumerate(scipy.ndimage.find_objects(area), start=1):
        gap = area[place] == k
        if (was[place] & gap).sum() < _PART * gap.sum():
            continue
        wide = tuple(slice(max(0, p.start - 1), p.stop + 1) for p in place)
        gap = area[wide] == k
        rim = scipy.ndimage.binary_dilation(gap) & ~gap & within[wide]
        if (covered[wide] & rim).sum() >= _ENCLOSED * rim.sum() > 0:
            out[wide] |= gap
    return out


def beyond(hole: Mask, covered: Mask, within: Mask) -> Mask:
    """The parts of a hole into which a surface would be extended without anything that ends it: they lie outside of the
    convex hull of what is seen of it, and hardly border on another surface.

    Args:
        within: where the surface may be, before other surfaces.
    """
    outside = hole & ~_hull(covered)
    area, count = scipy.ndimage.label(outside)
    out = np.zeros_like(hole)
    for k in range(1, count + 1):
        part = area == k
        rim = scipy.ndimage.binary_dilation(part, iterations=2) & ~hole
        ends = rim & ~covered
        if (ends & ~within).sum() < _ENDED * ends.sum():
            out |= part
    return out


def _hull(cells: Mask) -> Mask:
    """The convex hull of some cells of `[H, W]`; none where they span no area."""
    from scipy.spatial import Delaunay, QhullError

    at = np.argwhere(cells & ~scipy.ndimage.binary_erosion(cells))  # the border spans the hull
    try:
        hull = Delaunay(at[np.unique(np.linspace(0, len(at) - 1, min(len(at), 4096)).astype(int))])
    except (QhullError, ValueError):
        return np.zeros_like(cells)
    every = np.argwhere(np.ones_like(cells))
    return np.asarray((hull.find_simplex(every) >= 0).reshape(cells.shape))


def _large(hole: Mask, least: float) -> Mask:
    """The hole without specks of fewer than `least` cells."""
    area, count = scipy.ndimage.label(hole)
    if not count:
        return hole
    size = np.bincount(area.ravel())
    keep = size >= max(_FEWEST, least)
    keep[0] = False
    return np.asarray(keep[area])


def spacing_of(chart: Chart, cloud: GaussianCloud, rows: Tensor) -> float:
    """Typical distance of the Gaussians of a surface, scene units."""
    h, w = chart.shape
    if len(rows) < 8:
        return max(h, w) * chart.cell / 40
    local = chart.plane.local(points_of(cloud, rows))[:, :2]
    block = 4 * chart.cell
    cell = np.floor((local - chart.low) / block).astype(np.int64)
    _, count = np.unique(cell[:, 0] * 100_000 + cell[:, 1], return_counts=True)
    return float(block / np.sqrt(np.median(count)))


def unshaded(scene: Scene, patches: Sequence[Patch]) -> GaussianCloud:
    """The cloud of a scene without the contact shadows that patches found; itself if there are none."""
    cloud, sh = scene.cloud, scene.cloud.sh
    for patch in patches:
        if len(patch.shaded):
            sh = sh.clone() if sh is cloud.sh else sh
            sh[patch.shaded] = multiplied(sh[patch.shaded], patch.factor)
    return cloud if sh is cloud.sh else cloud.replace(sh=sh)


def merged(scene: Scene, patches: Sequence[Patch], above: int = -1) -> GaussianCloud:
    """All new Gaussians of some patches, with ids above those of the scene and above the id `above`."""
    clouds = [p.cloud for p in patches if len(p.cloud)]
    if not clouds:
        return scene.cloud[torch.zeros(0, dtype=torch.int64)]
    first = max(above, int(scene.cloud.ids.max())) + 1
    numbered = []
    for cloud in clouds:
        numbered.append(cloud.replace(ids=torch.arange(first, first + len(cloud), device=cloud.device)))
        first += len(cloud)
    return concat(numbered)
