"""Edits of selections as captures give them: with strays far away, as regions of colour, with things on them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from scenewright.gaussians.cloud import concat
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.selection import Candidate, Selection
from scenewright.gaussians.scene import Scene
from scenewright.tools.execute import Done, carry_out
from scenewright.tools.operation import Context
from scenewright.tools.placement.bodies import bodies_of
from scenewright.tools.registry import parse

from .conftest import by_name

TABLE, CHAIR, ARMCHAIR, VASE = range(4)


@pytest.fixture(scope="module")
def spoiled(corner: Scene) -> tuple[Scene, torch.Tensor]:
    """The corner with strays of the armchair all over it, one in a hundred of its Gaussians; and their rows."""
    own = corner.cloud[(corner.cloud.group == ARMCHAIR).nonzero().squeeze(1)]
    count = len(own) // 100
    g = torch.Generator().manual_seed(3)
    means = 12 * torch.randn(count, 3, generator=g) + torch.tensor([9.0, -7.0, 4.0])
    first = int(corner.cloud.ids.max()) + 1
    strays = own[torch.arange(count)].replace(means=means, ids=torch.arange(first, first + count))
    cloud = concat([corner.cloud, strays])
    return corner.replace(cloud=cloud), torch.arange(len(corner.cloud), len(cloud))


def do(scene: Scene, context: Context, op: str, **fields: Any) -> Done:
    return carry_out(scene, parse({"op": op, **fields}), context)


ARM = {"text": "armchair"}


def rows_of_armchair(scene: Scene, strays: torch.Tensor) -> torch.Tensor:
    rows = (scene.cloud.group == ARMCHAIR).nonzero().squeeze(1)
    return rows[~torch.isin(rows, strays)]


@pytest.mark.parametrize(
    ("there", "back"),
    [
        ({"op": "rotate", "degrees": 70}, {"op": "rotate", "degrees": -70}),
        ({"op": "rotate", "degrees": 35, "axis": "right"}, {"op": "rotate", "degrees": -35, "axis": "right"}),
        ({"op": "scale", "factor": 2.5}, {"op": "scale", "factor": 0.4}),
    ],
    ids=str,
)
def test_there_and_back_is_the_identity_on_the_core(
    spoiled: tuple[Scene, torch.Tensor], context: Context, there: dict[str, Any], back: dict[str, Any]
) -> None:
    scene, strays = spoiled
    done = do(scene, context, **there, target=ARM)
    last = do(done.scene, context, **back, target=ARM).scene
    rows = rows_of_armchair(scene, strays)
    size = max(bodies_of(scene, by_name(scene, Query(text="armchair"), context.viewer))[0].box.size)
    # The core is measured again in between: voxels at its border may come or go, hundredths of its size.
    assert float((last.cloud.means[rows] - scene.cloud.means[rows]).abs().max()) < 0.02 * size
    assert torch.equal(done.scene.cloud.means[strays], scene.cloud.means[strays])
    assert any("stray Gaussians" in note for note in done.receipt.notes)


def test_strays_change_nothing_about_where_a_thing_turns(
    corner: Scene, spoiled: tuple[Scene, torch.Tensor], context: Context
) -> None:
    scene, strays = spoiled
    rows = rows_of_armchair(scene, strays)
    clean = do(corner, context, "rotate", target=ARM, degrees=90).scene
    dirty = do(scene, context, "rotate", target=ARM, degrees=90).scene
    assert float((clean.cloud.means[rows] - dirty.cloud.means[rows]).abs().max()) < 0.01


def test_a_pivot_far_from_the_thing_is_caught(corner: Scene, context: Context, monkeypatch: pytest.MonkeyPatch) -> None:
    """The check sees the geometry: it is not told where the operation thinks that the pivot is."""
    from scenewright.gaussians.errors import CheckFailedError
    from scenewright.tools.ops.rotate import Rotate

    honest = Rotate._offset
    for off in (0.4, 3.0):
        aside = np.array([off, 0.0, 0.0])
        monkeypatch.setattr(
            Rotate, "_offset", lambda self, s, b, m, aside=aside: honest(self, s, b, m) + aside - m @ aside
        )
        with pytest.raises(CheckFailedError, match="on the spot"):
            do(corner, context, "rotate", target=ARM, degrees=180)


def region(scene: Scene, groups: tuple[int, ...], upper: float = 0.5) -> Selection:
    """A region of colour as a query finds it: the upper parts of some things, as one place that has no group."""
    chosen = torch.zeros(len(scene.cloud), dtype=torch.bool)
    for group in groups:
        rows = (scene.cloud.group == group).nonzero().squeeze(1)
        height = scene.cloud.means[rows, 2]
        chosen[rows[height >= torch.quantile(height, 1 - upper)]] = True
    points = scene.cloud.means[chosen]
    center, size = points.median(dim=0).values.tolist(), (points.amax(dim=0) - points.amin(dim=0)).tolist()
    told = (Candidate(-1, "", "brown", tuple(center), tuple(size), 1.0),)
    return Selection(Query(text="cloth"), "found", scene.cloud.ids[chosen].sort().values, (), told, "")


@pytest.mark.parametrize(
    "data",
    [
        {"op": "move", "direction": "left", "distance": {"value": 0.4, "unit": "m"}},
        {"op": "rotate", "degrees": 30},
        {"op": "scale", "factor": 1.2},
        {"op": "duplicate", "direction": "up"},
    ],
    ids=str,
)
def test_a_region_of_a_thing_is_edited_with_what_stands_on_it(
    corner: Scene, context: Context, data: dict[str, Any]
) -> None:
    selection = region(corner, (TABLE,), 0.7)
    done = carry_out(corner, parse({**data, "target": {"last": True}}), context, selection)
    assert done.receipt.passed and done.receipt.outside_changed == 0
    if data["op"] in ("move", "rotate"):
        assert "what stood on it went along: vase" in done.receipt.notes
        vase = corner.cloud.group == VASE
        assert not torch.equal(done.scene.cloud.means[vase], corner.cloud.means[vase])


def test_a_region_over_several_things_is_one_body(corner: Scene, context: Context) -> None:
    """Each of its pieces would turn about its own middle otherwise."""
    selection = region(corner, (TABLE, VASE), 0.3)
    bodies = bodies_of(corner, selection)
    assert len(bodies) == 1 and bodies[0].group == -1 and bodies[0].label == "cloth"
    op = parse({"op": "rotate", "target": {"last": True}, "degrees": 90})
    done = carry_out(corner, op, context, selection)
    moved = selection.mask(corner.cloud).nonzero().squeeze(1)
    was, now = (torch.pdist(s.cloud.means[moved[::40]].double()) for s in (corner, done.scene))
    assert torch.allclose(was, now, atol=1e-4)  # it turned as a rigid whole


def test_two_regions_turn_each_on_its_spot(corner: Scene) -> None:
    one, two = region(corner, (CHAIR,), 0.3), region(corner, (TABLE,), 0.3)
    both = replace(one, ids=torch.cat([one.ids, two.ids]).sort().values, candidates=(*one.candidates, *two.candidates))
    bodies = bodies_of(corner, both)
    assert [len(b.rows) for b in bodies] == [len(one), len(two)]


def test_undo_is_the_same_scene(spoiled: tuple[Scene, torch.Tensor], context: Context) -> None:
    scene, _ = spoiled
    digest = scene.cloud.digest()
    done = do(scene, context, "rotate", target=ARM, degrees=45)
    assert scene.cloud.digest() == digest != done.scene.cloud.digest()
