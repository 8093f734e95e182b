"""Everyday nouns: every word has a class with a size, a shape that is drawn, and no kind of its own."""

from __future__ import annotations

import numpy as np
import pytest

from scenewright.gaussians.assets import make
from scenewright.gaussians.assets.modeling.shapes import bounds
from scenewright.gaussians.assets.modeling.solids import SHAPES, solid
from scenewright.gaussians.assets.registry import KINDS
from scenewright.gaussians.world import everyday, kinds

CLASSES = everyday._classes()


@pytest.mark.parametrize("entry", CLASSES, ids=lambda e: e["class"])
def test_every_class_can_be_drawn_and_stands_on_something(entry: dict[str, object]) -> None:
    assert make is not None  # registers the kinds
    assert entry["shape"] in {*SHAPES, *KINDS, "box", "ball"}
    assert set(entry.get("on", ())) <= set(kinds.table().kinds)  # type: ignore[call-overload]


def test_no_word_is_in_two_classes_and_none_names_a_kind() -> None:
    words = [w for entry in CLASSES for w in entry["words"].split(", ")]
    assert sorted(w for w in set(words) if words.count(w) > 1) == []
    labels = {n for k in kinds.table().kinds.values() for n in k.labels}
    assert [w for w in words if w not in labels and kinds.find(w) is not None and everyday.find(w)] == []


@pytest.mark.parametrize(
    ("said", "low", "high"), [("boulders", 0.4, 1.0), ("apple tree", 2.0, 3.0), ("trowel", 0.0, 0.1)]
)
def test_a_thing_has_the_height_of_its_class(said: str, low: float, high: float) -> None:
    found = everyday.find(said)
    assert found is not None and low < found.size[2][0] <= found.size[2][1] < high


def test_a_label_means_the_thing_that_it_ends_with() -> None:
    old = everyday.of("gnarled old apple tree")
    assert old is not None and old.size == everyday.of("apple tree").size  # type: ignore[union-attr]
    assert everyday.of("zorblax") is None and everyday.shape("zorblax") == ""


@pytest.mark.parametrize("shape", SHAPES)
def test_a_solid_fills_its_box_within_a_few_percent(shape: str) -> None:
    """The box is exact after `make.fit_to_size`; the design must not have to be stretched visibly for that."""
    size = (1.2, 0.9, 1.1)
    pieces = solid(shape, size, None)
    assert pieces
    low, high = bounds(pieces)
    assert np.all(np.abs((high - low) / np.array(size) - 1) < 0.25), (high - low, size)
    assert any(p.material is not None and p.material.main for p in pieces)


def test_things_stand_beneath_what_has_legs_or_a_crown_and_not_beneath_a_box() -> None:
    assert everyday.free_beneath("dining table", 0.75) > 0.5 and everyday.free_beneath("apple tree", 2.6) > 1.2
    assert everyday.free_beneath("wardrobe", 2.0) == 0.0 == everyday.free_beneath("zorblax", 2.0)
