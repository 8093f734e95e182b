"""Groups of whole rooms get the label of what they show, and others none."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from scenewright.gaussians.assets import furnish
from scenewright.gaussians.assets.furnishing.furnish import Room
from scenewright.gaussians.language import encoders
from scenewright.gaussians.language.field.language_field import LanguageField
from scenewright.training import room_groups


@pytest.mark.slow
def test_groups_of_a_room_are_named_after_its_things() -> None:
    room = furnish(3, objects=6, detail=0.5)
    kinds = tuple(o.kind for o in room.truth.objects)
    found = room_groups.collect(encoders.load("auto"), [(room.scene, room.truth.ids.numpy(), kinds)])
    named = [name for name in found.labels if name in kinds]
    assert found.vectors.shape == (len(found.labels), 256) and np.isfinite(found.vectors).all()
    assert len(named) >= 0.7 * len(kinds) and all(named.count(kind) <= kinds.count(kind) for kind in named)


@pytest.fixture(scope="module")
def room() -> Room:
    return furnish(3)


@pytest.mark.parametrize(
    ("first", "second", "label"),
    [  # percent of a chair and of a table that one group holds
        (95, 5, "chair"),
        (20, 0, "part of something"),
        (50, 50, "several things together"),
        (70, 30, None),
    ],
)
def test_a_group_is_one_thing_a_piece_or_several(room: Room, first: int, second: int, label: str | None) -> None:
    objects = np.repeat(np.array([0, 1], np.int32), 1000)
    group = np.full(2000, -1)
    group[: 10 * first], group[1000 : 1000 + 10 * second] = 0, 0
    few = torch.arange(2000)  # which ones does not matter
    scene = room.scene.replace(cloud=room.scene.cloud[few].replace(group=torch.from_numpy(group.astype(np.int32))))
    table = _table(10 * (first + second))
    found = dict(room_groups._labelled(scene, table, objects, ("chair", "table")))
    assert found == ({} if label is None else {0: label})


def _table(count: int) -> LanguageField:
    from scenewright.gaussians.language.field.language_field import Group
    from scenewright.gaussians.world.box import Box

    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    one = Group(0, "object", -1, "", 0.0, Box((0, 0, 0), axes, (1, 1, 1)), (50, 0, 0), count, 3, 1.0)
    return LanguageField((one,), np.zeros((1, 4), np.float32), "none")


def test_things_in_other_colours_keep_their_places_and_the_walls_their_colours() -> None:
    room = furnish(3)
    objects = room.truth.ids.numpy()
    changed = room_groups._colored(room.scene, objects, 7)
    rows = torch.from_numpy(objects < 0)
    assert torch.equal(changed.cloud.sh[rows], room.scene.cloud.sh[rows])
    assert torch.equal(changed.cloud.means, room.scene.cloud.means)
    assert not torch.equal(changed.cloud.sh[~rows], room.scene.cloud.sh[~rows])
