"""Colour patches, against pieces of known colour."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.color import BASIC, parse
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.language.query.color.patches import Patch, fragments_of, patches

PAINT = {name: parse(value) for name, value in BASIC.items()}


def places(cloud: GaussianCloud, *words: str) -> list[Patch]:
    return patches(cloud, words)


def yard(world: type[Any]) -> Any:
    made = world().sheet("floor", (-2, -2, 0), (4, 0, 0), (0, 4, 0), PAINT["gray"], 0.05)
    made.box("big", (-1.5, -1.5, 0.05), (-0.5, -0.5, 1.0), PAINT["red"], 0.03)
    made.box("little", (1.0, 1.0, 0.05), (1.4, 1.4, 0.4), PAINT["red"], 0.03)
    made.box("tub", (1.0, -1.5, 0.05), (1.6, -0.9, 0.6), PAINT["blue"], 0.03)
    return made


def test_each_thing_of_a_colour_is_a_place_and_the_largest_comes_first(world: type[Any]) -> None:
    made = yard(world)
    found = places(made.cloud(), "red")
    assert len(found) == 2
    for place, name in zip(found, ("big", "little"), strict=True):
        rows = set(made.rows[name].tolist())
        shared = len(rows & set(place.rows.tolist()))
        assert shared >= 0.98 * len(rows) and len(place.rows) <= 1.02 * len(rows)  # a stray Gaussian of the rim
        assert np.abs(np.array(place.center) - made.cloud().means[made.rows[name]].mean(0).numpy()).max() < 0.2
    assert found[0].weight > found[1].weight
    assert np.allclose(found[1].size, (0.4, 0.4, 0.35), atol=0.05)
    assert all(0.5 < p.score <= 1 for p in found)


@pytest.mark.parametrize(("word", "name"), [("blue", "tub"), ("gray", "floor")])
def test_other_colours_find_their_own(world: type[Any], word: str, name: str) -> None:
    made = yard(world)
    taken = set(np.concatenate([p.rows for p in places(made.cloud(), word)]).tolist())
    assert len(set(made.rows[name].tolist()) & taken) >= 0.98 * len(made.rows[name])
    assert not taken & set(made.rows["big"].tolist())


def test_a_colour_that_is_nowhere_has_no_place(world: type[Any]) -> None:
    assert places(yard(world).cloud(), "green") == []
    assert places(yard(world).cloud(), "red", "blue") == []  # nothing is both


def test_only_rows_that_may_be_taken_are_taken(world: type[Any]) -> None:
    made = yard(world)
    group = torch.full((len(made),), -1, dtype=torch.int32)
    group[made.rows["big"]] = 3
    cloud = made.cloud().replace(group=group)
    index = fragments_of(cloud)
    (place,) = patches(cloud, ("red",), ~index.in_groups([3]))
    assert set(place.rows.tolist()) <= set(made.rows["little"].tolist())
    assert patches(cloud, ("red",), np.zeros(len(index), bool)) == []


def test_a_place_grows_into_its_own_shade(world: type[Any]) -> None:
    red = PAINT["red"]
    dark = (red[0] * 0.45, red[1] * 0.45, red[2] * 0.45)
    made = world().sheet("cloth", (0, 0, 0), (1, 0, 0), (0, 1, 0), red, 0.03)
    made.sheet("fold", (1, 0, 0), (0.15, 0, 0), (0, 1, 0), dark, 0.03)
    made.sheet("table", (-2, -2, -0.4), (4, 0, 0), (0, 4, 0), PAINT["white"], 0.05)
    (place,) = places(made.cloud(), "red")
    taken = set(place.rows.tolist())
    assert len(taken & set(made.rows["fold"].tolist())) > 0.9 * len(made.rows["fold"])
    assert not taken & set(made.rows["table"].tolist())


def test_speckles_of_another_colour_in_the_same_cell_are_left_out(world: type[Any]) -> None:
    made = world().box("crate", (0, 0, 0), (1, 1, 1), PAINT["red"], 0.03)
    made.box("grid", (0, 0, 0), (1, 1, 1), PAINT["green"], 0.15)
    taken = set(np.concatenate([p.rows for p in places(made.cloud(), "red")]).tolist())
    assert not taken & set(made.rows["grid"].tolist())


def test_places_are_disjoint_ordered_and_the_same_each_time(world: type[Any]) -> None:
    cloud = yard(world).cloud()
    found, again = places(cloud, "red"), places(cloud, "red")
    rows = np.concatenate([p.rows for p in found])
    assert len(set(rows.tolist())) == len(rows)
    assert all((np.diff(p.rows) > 0).all() for p in found)
    assert [p.rows.tobytes() for p in found] == [p.rows.tobytes() for p in again]


def test_haze_has_no_colour(world: type[Any]) -> None:
    cloud = yard(world).cloud()
    assert places(cloud.replace(opacities=torch.full((len(cloud),), 0.02)), "red") == []


def test_an_unknown_colour_is_the_users_error(world: type[Any]) -> None:
    with pytest.raises(UserError, match="unknown colour"):
        places(yard(world).cloud(), "blurple")


@pytest.mark.parametrize("count", [0, 1, 5])
@pytest.mark.parametrize("together", [True, False], ids=["one point", "spread"])
def test_degenerate_clouds_have_places_too(count: int, together: bool) -> None:
    means = (
        torch.full((count, 3), 0.3) if together else torch.rand(count, 3, generator=torch.Generator().manual_seed(1))
    )
    red = (torch.tensor(PAINT["red"]) - 0.5) / 0.28209479
    cloud = GaussianCloud.create(
        means, torch.tensor([[1.0, 0, 0, 0]]).repeat(count, 1), torch.full((count, 3), 0.01), torch.full((count,), 0.9),
        red.expand(count, 1, 3).contiguous(),
    )  # fmt: skip
    assert sum(len(p.rows) for p in places(cloud, "red")) == count
    assert places(cloud, "blue") == []
