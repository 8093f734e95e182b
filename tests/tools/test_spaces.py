"""Edits of the whole scene and of parts of its space: no Gaussian is forgotten, and no haze stays behind."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
import torch

from scenewright.gaussians.cloud import NO_GROUP, concat
from scenewright.gaussians.errors import InstructionError
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
