"""Restyle: another material on the same shape, in the same light, and nothing else changed."""

from __future__ import annotations

from typing import Any

import pytest
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.color import rgb_to_lab
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.render import render
from scenewright.gaussians.scene import Scene
from scenewright.tools.coloring.seen import lit_face, seen_colors
from scenewright.tools.execute import Done, carry_out
from scenewright.tools.finishing.subdivide import counts_for, subdivided
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse

TABLE, CHAIR = 0, 1  # groups of the corner


def restyled(scene: Scene, context: Context, target: str, material: str, **more: Any) -> Done:
    return carry_out(scene, parse({"op": "restyle", "target": {"text": target}, "material": material, **more}), context)


def rows(scene: Scene, group: int) -> torch.Tensor:
    return (scene.cloud.group == group).nonzero().squeeze(1)


@pytest.mark.slow
def test_a_marble_table_is_pale_and_found_as_before(corner: Scene, context: Context) -> None:
    done = restyled(corner, context, "table", "marble")
    shown = lit_face(seen_colors(done.scene, rows(done.scene, TABLE)))
    before = lit_face(seen_colors(corner, rows(corner, TABLE)))
    assert float(shown[0]) > float(before[0]) + 10  # as pale as white can be in the light of this dim corner
    assert float(shown[1:].norm()) < 8
    assert done.receipt.passed
    again = context.resolve(done.scene, Query(text="table"))
    assert again.verdict == "found"
    assert again.ids.tolist() == done.scene.cloud.ids[rows(done.scene, TABLE)].sort().values.tolist()
    assert done.selection.ids.tolist() == again.ids.tolist()


def test_nothing_else_changes_in_any_bit(corner: Scene, context: Context) -> None:
    done = restyled(corner, context, "chair", "leather")
    for name, column in corner.cloud.columns():
        kept = corner.cloud.group != CHAIR
        after = done.scene.cloud.group != CHAIR
        assert torch.equal(column[kept], getattr(done.scene.cloud, name)[after]), name


@pytest.mark.slow
def test_the_same_words_give_the_same_bytes(corner: Scene, context: Context) -> None:
    one, two = (restyled(corner, context, "chair", "brick").scene.cloud for _ in range(2))
    assert all(torch.equal(a, b) for (_, a), (_, b) in zip(one.columns(), two.columns(), strict=True))


def test_its_colours_can_be_said(corner: Scene, context: Context) -> None:
    green = restyled(corner, context, "table", "marble", color="green")
    shown = lit_face(seen_colors(green.scene, rows(green.scene, TABLE)))
    assert float(shown[1]) < -15  # a of CIELAB: green


def test_a_finer_unit_needs_more_gaussians(corner: Scene, context: Context) -> None:
    coarse, fine = (restyled(corner, context, "table", "checks", unit={"value": v, "unit": "cm"}) for v in (60.0, 12.0))
    assert fine.receipt.added > coarse.receipt.added


def test_porcelain_needs_no_new_gaussians(corner: Scene, context: Context) -> None:
    assert restyled(corner, context, "table", "porcelain").receipt.added == 0


@pytest.mark.parametrize(
    "wrong",
    [
        {"material": "cheese"},
        {"material": "brick", "unit": {"value": -1}},
        {"material": "brick", "color": ""},
        {},
    ],
)
def test_what_is_no_material_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(UserError):
        parse({"op": "restyle", "target": {"text": "table"}, **wrong})


def test_an_unknown_colour_is_refused_and_the_scene_stays(corner: Scene, context: Context) -> None:
    before = corner.cloud.sh.clone()
    with pytest.raises(UserError, match="unknown colour"):
        restyled(corner, context, "table", "marble", color="blorange")
    assert torch.equal(before, corner.cloud.sh)


# -- splitting --------------------------------------------------------------------------------------------------------


def sheet(opacity: float) -> GaussianCloud:
    """Flat Gaussians on a grid that overlap, as on a wall."""
    places = torch.cartesian_prod(torch.arange(9.0), torch.arange(9.0)) * 0.1 - 0.4
    n = len(places)
    means = torch.stack([places[:, 0], torch.zeros(n), places[:, 1]], dim=1)
    quats = torch.zeros(n, 4)
    quats[:, 0] = 1
    scales = torch.tensor([0.1, 0.005, 0.08]).expand(n, 3).contiguous()
    sh = torch.stack([places[:, 0], places[:, 1], -places[:, 0]], dim=1)[:, None] * 2
    return GaussianCloud.create(means, quats, scales, torch.full((n,), opacity), sh)


# Renderers drop what is fainter than 1/255, so the many faint children of a faint Gaussian lose their rims.
@pytest.mark.parametrize(("opacity", "decibels"), [(0.2, 28), (0.6, 35), (0.95, 35)])
def test_children_look_like_their_parents(opacity: float, decibels: float) -> None:
    cloud = sheet(opacity)
    sides = cloud.scales.sort(dim=1, descending=True).values
    counts = torch.stack([counts_for(sides[:, k], cloud.opacities, 0.03) for k in (0, 1)], dim=1)
    children, parents = subdivided(cloud, counts)
    assert 0.7 * int(counts.prod(dim=1).sum()) <= len(children) <= int(counts.prod(dim=1).sum())
    assert float(children.opacities.min()) >= 1 / 255
    assert torch.equal(children.ids, cloud.ids[parents])
    camera = Camera.look_at((0.0, -2.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 96, 96, 40.0)
    was, now = render(cloud, camera), render(children, camera)
    assert float((was.alpha - now.alpha).abs().max()) < 0.15
    inside = was.alpha > 0.9 * was.alpha.max()  # the rim of a sheet that ends there may fade a little earlier
    assert float(((was.rgb - now.rgb)[inside] ** 2).mean()) < 10 ** (-decibels / 10)


def test_what_is_fine_enough_is_not_split() -> None:
    cloud = sheet(0.5)
    assert counts_for(cloud.scales[:, 0], cloud.opacities, 0.2).max() == 1
    children, _ = subdivided(cloud, torch.ones(len(cloud), 2, dtype=torch.int64))
    assert all(torch.equal(a, b) for (_, a), (_, b) in zip(children.columns(), cloud.columns(), strict=True))


def test_light_stays_on_a_thing(corner: Scene, context: Context) -> None:
    """What was darker is darker still: correlation of luma by cells, before and after, on a plain material."""
    done = restyled(corner, context, "table", "porcelain")
    was, now = (rgb_to_lab(0.2821 * s.cloud.sh[rows(s, TABLE), 0].double() + 0.5)[:, 0] for s in (corner, done.scene))
    assert float(torch.corrcoef(torch.stack([was, now]))[0, 1]) > 0.6
