"""Edits of the whole scene and of parts of its space: no Gaussian is forgotten, and no haze stays behind."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from scenewright.gaussians.cloud import NO_GROUP, concat
from scenewright.gaussians.errors import AbsentError, InstructionError
from scenewright.gaussians.language.query.floaters import floaters
from scenewright.gaussians.language.query.resolve import resolve
from scenewright.gaussians.scene import Scene
from scenewright.tools.execute import Done, carry_out
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse

ARMCHAIR = 2


@pytest.fixture(scope="module")
def hazy(corner: Scene) -> Scene:
    """The corner with haze of no group in the room, and haze far away that was given to the armchair."""
    own = corner.cloud[(corner.cloud.group == ARMCHAIR).nonzero().squeeze(1)]
    g = torch.Generator().manual_seed(7)
    first = int(corner.cloud.ids.max()) + 1
    haze = []
    for group, middle in ((NO_GROUP, [0.0, 0.0, 1.0]), (ARMCHAIR, [9.0, -7.0, 4.0])):
        made = own[torch.arange(60)].replace(
            means=torch.randn(60, 3, generator=g) + torch.tensor(middle),
            ids=torch.arange(first, first + 60),
            group=torch.full((60,), group, dtype=torch.int32),
            opacities=torch.full((60,), 0.05),
        )
        haze.append(made)
        first += 60
    return corner.replace(cloud=concat([corner.cloud, *haze]))


@pytest.fixture
def real(context: Context) -> Context:
    """The context with the resolver of the product."""
    return replace(context, resolver=resolve, encoder=None)


def do(scene: Scene, context: Context, op: str, **fields: Any) -> Done:
    return carry_out(scene, parse({"op": op, **fields}), context)


EVERYTHING = {"text": "everything", "pick": "all"}


def test_everything_takes_what_belongs_to_no_thing(hazy: Scene, real: Context) -> None:
    done = do(hazy, real, "recolor", target=EVERYTHING, adjust="darker")
    assert done.receipt.changed == len(hazy.cloud)
    faded = do(hazy, real, "opacity", target=EVERYTHING, value=0.5).scene.cloud.opacities
    torch.testing.assert_close(faded, hazy.cloud.opacities * 0.5)


def test_an_attribute_makes_everything_every_thing(hazy: Scene, real: Context) -> None:
    every = real.resolve(hazy, parse({"op": "select", "target": {**EVERYTHING, "relations": ()}}).target)  # type: ignore[attr-defined]
    red = {**EVERYTHING, "not_colors": ("red",)}
    things = real.resolve(hazy, parse({"op": "select", "target": red}).target)  # type: ignore[attr-defined]
    assert len(every) == len(hazy.cloud)
    assert 0 < len(things) < len(hazy.cloud)


@pytest.mark.parametrize("way", ["delete", "isolate"])
def test_what_is_kept_alone_keeps_no_haze(way: str, hazy: Scene, real: Context) -> None:
    kept = {"groups": (ARMCHAIR,)}
    target = {**EVERYTHING, "exclude": (kept,)} if way == "delete" else kept
    after = do(hazy, real, way, target=target).scene.cloud
    n = len(hazy.cloud) - 120  # the haze comes last
    own = hazy.cloud.ids[:n][hazy.cloud.group[:n] == ARMCHAIR]
    assert torch.equal(after.ids, own)
    assert torch.equal(after.means, hazy.cloud.means[:n][hazy.cloud.group[:n] == ARMCHAIR])  # it stays where it was


def test_deleting_everything_is_refused(hazy: Scene, real: Context) -> None:
    with pytest.raises(InstructionError, match="what to keep"):
        do(hazy, real, "delete", target=EVERYTHING)


def region(name: str, **more: Any) -> dict[str, Any]:
    return {**EVERYTHING, "region": {"name": name, **more}}


def test_a_height_cuts_by_centres_and_what_is_outside_is_the_rest(hazy: Scene, real: Context) -> None:
    above = do(hazy, real, "select", target=region("above", distance=60, unit="cm")).selection.ids
    rest = do(hazy, real, "select", target=region("above", distance=60, unit="cm", outside=True)).selection.ids
    heights = hazy.cloud.means[:, 2]
    assert torch.equal(above, hazy.cloud.ids[heights.double() > 0.6])
    assert torch.equal(torch.cat([above, rest]).sort().values, hazy.cloud.ids)


def test_a_length_without_a_known_scale_is_told(hazy: Scene, real: Context) -> None:
    unknown = hazy.replace(frame=replace(hazy.frame, metres_per_unit=None))
    (note, *_) = do(unknown, real, "delete", target=region("above", distance=1)).receipt.notes
    assert "one scene unit as one metre" in note
    assert "cuts through" in note


def test_within_and_beyond_a_distance_are_measured_from_the_box(hazy: Scene, real: Context) -> None:
    near = do(hazy, real, "select", target=region("within", of=({"groups": (ARMCHAIR,)},), distance=0.3)).selection
    wider = do(hazy, real, "select", target=region("within", of=({"groups": (ARMCHAIR,)},), distance=0.6)).selection
    assert set(near.ids.tolist()) < set(wider.ids.tolist())
    assert ARMCHAIR not in near.groups or len(near) > 0
    own = hazy.cloud.ids[: len(hazy.cloud) - 120][hazy.cloud.group[: len(hazy.cloud) - 120] == ARMCHAIR]
    assert torch.isin(own, near.ids).float().mean() > 0.97
    assert not torch.isin(hazy.cloud.ids[-60:], near.ids).any()  # its haze far away does not stretch the box


def test_a_side_takes_things_whole_and_leaves_the_anchor(hazy: Scene, real: Context) -> None:
    left = do(hazy, real, "select", target=region("left_of", of=({"groups": (0,)},))).selection
    right = do(hazy, real, "select", target=region("right_of", of=({"groups": (0,)},))).selection
    assert (1 in left.groups) != (1 in right.groups)
    table = hazy.cloud.ids[hazy.cloud.group == 0]
    for side in (left, right):
        assert not torch.isin(table, side.ids).any()
        for group in (1, ARMCHAIR):
            share = torch.isin(hazy.cloud.ids[hazy.cloud.group == group], side.ids).float().mean()
            assert share in (0.0, 1.0)


def test_a_crop_keeps_a_thing_with_what_stands_on_it_and_no_floor(hazy: Scene, real: Context) -> None:
    after = do(hazy, real, "isolate", target=region("around", of=({"groups": (0,)},))).scene.cloud
    assert set(after.group.tolist()) <= {0, 3, NO_GROUP}
    for group in (0, 3):
        assert int((after.group == group).sum()) > 0.98 * int((hazy.cloud.group == group).sum())


def test_things_are_restricted_to_a_part_of_space(hazy: Scene, real: Context) -> None:
    target = {"pick": "all", "region": {"name": "within", "of": ({"groups": (0,)},), "distance": 0.2}}
    assert set(do(hazy, real, "select", target=target).selection.groups) == {0, 3}


def test_an_empty_part_of_space_is_absent(hazy: Scene, real: Context) -> None:
    with pytest.raises(AbsentError, match="nothing lies"):
        do(hazy, real, "delete", target=region("above", distance=90))


def test_floaters_are_what_lies_apart_and_no_wall(corner: Scene, real: Context) -> None:
    g = torch.Generator().manual_seed(2)
    first = int(corner.cloud.ids.max()) + 1
    like = corner.cloud[torch.arange(300)]
    # A plain wall: few wide flat Gaussians of no group, as captures have it; they overlap, so that it has no holes.
    across, up = 6 * torch.rand(300, generator=g) - 3, 2.5 * torch.rand(300, generator=g)
    places = torch.stack([across, torch.full((300,), 3.0), up])
    wall = like.replace(
        means=places.T.contiguous(),
        scales=torch.tensor([0.2, 0.004, 0.2]).repeat(300, 1),
        quats=torch.tensor([1.0, 0.0, 0.0, 0.0]).repeat(300, 1),
        opacities=torch.full((300,), 0.9),
        group=torch.full((300,), NO_GROUP, dtype=torch.int32),
        ids=torch.arange(first, first + 300),
    )
    air = 8 * torch.rand(20, 3, generator=g) + torch.tensor([-4.0, -12.0, 1.0])
    specks = like[torch.arange(20)].replace(means=air, ids=torch.arange(first + 300, first + 320))
    blob = like[torch.arange(1)].replace(  # before the lens, and filed under a thing
        means=torch.tensor([[0.0, -3.0, 1.6]]),
        scales=torch.full((1, 3), 0.5),
        opacities=torch.tensor([0.4]),
        ids=torch.tensor([first + 320]),
    )
    scene = corner.replace(cloud=concat([corner.cloud, wall, specks, blob]))
    found = do(scene, real, "delete", target={"text": "floater", "pick": "all"})
    gone = set(scene.cloud.ids.tolist()) - set(found.scene.cloud.ids.tolist())
    assert set(range(first + 300, first + 321)) <= gone
    assert not gone & set(range(first, first + 300))
    assert len(gone) - 21 < 0.001 * len(corner.cloud)
    assert found.receipt.changed == 0  # nothing settles where haze was
    assert "apart from every surface" in found.receipt.notes[0]
    fewer, more = (floaters(scene.cloud, strength) for strength in (0.25, 4.0))
    usual = floaters(scene.cloud)
    assert set(np.flatnonzero(usual)) == gone
    assert not (fewer & ~usual).any() and not (usual & ~more).any() and fewer.sum() < usual.sum() < more.sum()
