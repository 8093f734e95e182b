"""Give floor, walls, ceiling and things of a built room the materials that its graph names, in one pass.

The textures are those of restyle. How many Gaussians may be added is shared out by area, so that a room stays small.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud, concat
from ...gaussians.errors import UserError
from ...gaussians.language.field.measure import lab_of_cloud, sample
from ...gaussians.rotations import to_matrix
from ...gaussians.scene import Scene
from ...gaussians.world.box import Box
from ...gaussians.world.finishes import FINISHES, Described, described
from ...tools.color_map import LUMA
from ...tools.coloring.materials import materials
from ...tools.coloring.scene_light import scene_light
from ...tools.coloring.seen import lit_color
from ...tools.field_update import recount
from ...tools.finishing.design import Choice, Lit, of_finish, put_in
from ...tools.finishing.finish import Painted, painted
from ...tools.finishing.surface import chart_of
from .node import Drawn, NodeId

_SHELL = 170_000  # Gaussians that floor, walls and ceiling may have with their materials
_FINEST = 4  # parts along a side into which one of them is divided
_SHARP = 0.6  # of a texture's finest feature: standard deviation that parts have at most, where they may
_THINGS, _EACH = 36_000, 6_000  # Gaussians that things may add, together and each
COMPOSED_COVER = 0.68  # standard deviation of a shell's Gaussians over the length of a cell, see `build`
# Metres of what repeats on floors and walls, where patterns are broader than on cloth.
_BROAD: dict[str, float] = {"checks": 0.7, "dots": 0.2, "stripes": 0.2, "floral": 0.5, "ornament": 0.5, "stars": 0.5}
_SKIRTING = 0.085  # metres above the floor up to which a wall is skirting board


@dataclass(frozen=True, eq=False)
class _Surface:
    """Rows of a cloud that get one material; `flat` where they are of floor, walls or ceiling."""

    rows: Tensor
    box: Box
    said: Described
    flat: bool
    most: int = 0


def with_materials(scene: Scene, graph: Drawn, rows: Mapping[NodeId, int]) -> tuple[Scene, tuple[str, ...]]:
    """The scene with the materials that its graph names, and notes on words that name none.

    Args:
        scene: as built, with its table of groups.
        rows: group of each node.
    """
    notes: list[str] = []
    done: list[Painted] = []
    found = list(_surfaces(scene, graph, rows, notes))
    if not found:
        return scene, tuple(notes)
    white = torch.tensor(scene_light(scene.cloud).white, dtype=torch.float64)
    finer, found = _finer(scene.cloud, found)
    scene = scene.replace(cloud=finer)
    for surface in found:
        chart = chart_of(scene, surface.rows, surface.box, 1.0)
        light = _lit(finer, surface.rows, white)
        finish = FINISHES[surface.said.finish or "plastic"]
        unit = _BROAD.get(finish.name) if surface.flat else None
        design = of_finish(finish, Choice(surface.said.color, surface.said.second, unit), light.own)
        done.append(painted(finer, surface.rows, chart, light.paint(design), surface.most))
    cloud, _, _, _ = put_in(finer, done)
    return _refiled(scene, cloud), tuple(notes)


def _finer(cloud: GaussianCloud, found: list[_Surface]) -> tuple[GaussianCloud, list[_Surface]]:
    """The cloud with the Gaussians of flat surfaces divided as finely as their textures need, and the surfaces with
    their rows in it."""
    parts = {i: _parts(cloud, surface) for i, surface in enumerate(found) if surface.flat}
    while sum(len(found[i].rows) * n * n for i, n in parts.items()) > _SHELL and max(parts.values()) > 1:
        coarsest = max(parts, key=lambda i: (parts[i], len(found[i].rows)))
        parts[coarsest] -= 1
    split = [i for i, n in parts.items() if n > 1]
    if not split:
        return cloud, found
    keep = torch.ones(len(cloud), dtype=torch.bool)
    for i in split:
        keep[found[i].rows] = False
    moved = keep.cumsum(0) - 1
    pieces, start = [cloud[keep]], int(keep.sum())
    made = list(found)
    for i, surface in enumerate(found):
        if i not in split:
            made[i] = replace(surface, rows=moved[surface.rows])
            continue
        pieces.append(_divided(cloud[surface.rows], parts[i]))
        made[i] = replace(surface, rows=torch.arange(start, start + len(pieces[-1])))
        start += len(pieces[-1])
    return concat(_numbered(pieces)), made


def _numbered(pieces: list[GaussianCloud]) -> list[GaussianCloud]:
    """Clouds whose ids are their rows when they are joined."""
    found, start = list[GaussianCloud](), 0
    for piece in pieces:
        found.append(piece.replace(ids=torch.arange(start, start + len(piece))))
        start += len(piece)
    return found


def _parts(cloud: GaussianCloud, surface: _Surface) -> int:
    """Into how many along a side the Gaussians of a surface are divided, for its texture to be seen."""
    if surface.said.finish is None:
        return 1
    size = float(cloud.scales[surface.rows].sort(dim=1).values[:, 1].median())
    return int(min(_FINEST, max(1.0, -(-size // (_SHARP * FINISHES[surface.said.finish].detail)))))


def _divided(cloud: GaussianCloud, parts: int) -> GaussianCloud:
    """Flat Gaussians that cover a surface side by side, each divided into a grid over its own part of the surface.

    The surface's cells are `scale / COMPOSED_COVER` wide, and so much smaller parts overlap as much as the whole ones.
    """
    order = cloud.scales.argsort(dim=1, descending=True)
    axes = to_matrix(cloud.quats)
    plane = [axes.gather(2, order[:, k, None, None].expand(-1, 3, 1)).squeeze(2) for k in (0, 1)]
    sides = cloud.scales.gather(1, order[:, :2])
    places = ((torch.arange(parts) + 0.5) / parts - 0.5) / COMPOSED_COVER
    offsets = torch.cartesian_prod(places, places)
    shift = sum(offsets[:, k, None] * (sides[:, k, None] * plane[k])[:, None, :] for k in (0, 1))
    each = cloud[torch.arange(len(cloud)).repeat_interleave(parts * parts)]
    scales = cloud.scales.scatter(1, order[:, :2], sides / parts).repeat_interleave(parts * parts, dim=0)
    return each.replace(means=(cloud.means[:, None, :] + shift).reshape(-1, 3), scales=scales)


def _lit(cloud: GaussianCloud, rows: Tensor, white: Tensor) -> Lit:
    """The light on some rows, from the colours of their Gaussians: what is built has none inside."""
    lit = lit_color(sample(cloud, rows))
    red, green, blue = (lit / white.clamp(min=0.05)).clamp(0, 1).tolist()
    return Lit(white, float(lit @ torch.tensor(LUMA, dtype=torch.float64)), (red, green, blue))


def _surfaces(scene: Scene, graph: Drawn, rows: Mapping[NodeId, int], notes: list[str]) -> Iterator[_Surface]:
    """What gets a material."""
    assert scene.language is not None
    group = scene.cloud.group
    faces = {"floor": graph.room.floor, "wall": graph.room.walls, "ceiling": graph.room.ceiling}
    own = set(rows.values())
    walls = [g for g in scene.language.groups if g.level == "structure" and g.id not in own]
    faced = [(g, _said(faces.get(g.label, ""), notes, flat=True)) for g in walls]
    shell = [(g, said) for g, said in faced if said is not None]
    things = [
        (scene.language.groups[rows[n.id]], said)
        for n in graph.nodes
        if n.id in rows and (said := _said(n.material, notes)) is not None
    ]
    for g, said in shell:
        where = (group == g.id).nonzero().squeeze(1)
        if g.label == "wall":
            where = where[scene.cloud.means[where, 2] > _SKIRTING]
        if len(where):
            yield _Surface(where, g.box, said, flat=True)
    for g, said in things:
        where = (group == g.id).nonzero().squeeze(1)
        where = where[materials(scene.cloud, where).main] if len(where) else where
        if len(where):
            yield _Surface(where, g.box, said, False, min(_EACH, _THINGS // len(things)))


def _said(text: str, notes: list[str], flat: bool = False) -> Described | None:
    """What a phrase says of a surface; wood on floors, walls and ceilings comes in boards."""
    if not text:
        return None
    found = described(text)
    if found is not None and flat and found.finish == "wood":
        found = replace(found, finish="planks", color=found.color or FINISHES["wood"].color)
    if found is None:
        notes.append(f"“{text}” is no material or colour that is known: it was left out")
        return None
    try:
        of_finish(FINISHES[found.finish or "plastic"], Choice(found.color, found.second), (0.5, 0.5, 0.5))
    except UserError as error:
        notes.append(f"“{text}” was left out: {error}")
        return None
    return found


def _refiled(scene: Scene, cloud: GaussianCloud) -> Scene:
    """The scene with a new cloud, its Gaussians numbered by their rows, and its table counted and measured again."""
    cloud = cloud.replace(ids=torch.arange(len(cloud)))
    field = recount(scene.language, cloud)
    assert field is not None and scene.language is not None
    changed = {g.id for g, was in zip(field.groups, scene.language.groups, strict=True) if g.count != was.count}
    painted_groups = changed | {g.id for g in field.groups if g.level == "structure"}
    groups = tuple(
        replace(g, lab=lab_of_cloud(cloud[(cloud.group == g.id).nonzero().squeeze(1)]))
        if g.id in painted_groups and g.count
        else g
        for g in field.groups
    )
    return scene.replace(cloud=cloud, language=replace(field, groups=groups))
