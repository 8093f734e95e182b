"""Embedding with masks: the groups and names of a scene with known objects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch
from masked_yard import SIZE, THINGS, around, seen_by, table_top, with_tops, yard
from numpy.typing import NDArray

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.language.encoders.backends import vectors as vector_encoder
from scenewright.gaussians.language.field.embed import embed
from scenewright.gaussians.language.masks import ViewMasks
from scenewright.gaussians.render import render
from scenewright.gaussians.scene import Frame, Scene


@pytest.fixture
def scene() -> tuple[GaussianCloud, NDArray[np.int64]]:
    made = yard()
    return made.cloud(), made.labels(THINGS)


class Given:
    """Masks that are there already."""

    def __init__(self, views: Sequence[ViewMasks]) -> None:
        self.views = views

    def masks(self, scene: Scene, progress: Any = None) -> Any:
        return iter(self.views)


def coarse(views: Sequence[ViewMasks]) -> list[ViewMasks]:
    """As a detector at a quarter of the size draws them."""
    return [replace(v, ids=np.repeat(np.repeat(v.ids[2::4, 2::4], 4, axis=0), 4, axis=1)) for v in views]


def groups_of(cloud: GaussianCloud, views: Sequence[ViewMasks] | None) -> Scene:
    """The yard, embedded with masks or without."""
    encoder = vector_encoder.wrap([[name] for name in (*THINGS, "sofa", "lamp")], np.eye(6, 8))
    scene = Scene(cloud, Frame(up_source="given", floor=0.0))
    return embed(scene, encoder, masks=None if views is None else Given(views))


def best_ious(made: Scene, truth: NDArray[np.int64]) -> dict[str, float]:
    """IoU of the best object for each true one."""
    assert made.language is not None
    column, field = made.cloud.group.numpy(), made.language
    own = [np.isin(column, field.leaves(g.id)) for g in field.objects()]
    return {
        n: max(float(((truth == i) & o).sum() / ((truth == i) | o).sum()) for o in own) for i, n in enumerate(THINGS)
    }


@pytest.mark.parametrize("spoil", [list, coarse], ids=["true masks", "coarse masks"])
@pytest.mark.slow
def test_masks_of_all_views_give_the_true_objects(scene: Any, spoil: Any) -> None:
    cloud, truth = scene
    found = best_ious(groups_of(cloud, spoil(seen_by(cloud, truth, around(20)))), truth)
    assert min(found.values()) > 0.8  # the underside of the cup is seen by no view


@pytest.mark.slow
def test_a_source_without_masks_changes_no_group(scene: Any) -> None:
    cloud, _ = scene
    nothing = [ViewMasks(c, np.full(SIZE[::-1], -1, np.int32), (), np.zeros(0, np.float32)) for c in around(3)]
    alone, beside = groups_of(cloud, None), groups_of(cloud, nothing)
    assert alone.cloud.group.numpy().tobytes() == beside.cloud.group.numpy().tobytes()


@pytest.mark.slow
def test_the_order_of_views_and_masks_does_not_change_the_groups(scene: Any) -> None:
    cloud, truth = scene
    views = seen_by(cloud, truth, around(9))
    turned = [replace(v, ids=np.where(v.ids >= 0, len(v) - 1 - v.ids, -1), labels=v.labels[::-1]) for v in views[::-1]]
    one, other = (groups_of(cloud, v).cloud.group.numpy() for v in (views, turned))
    assert (one == other).mean() > 0.999  # sums over views in another order


@pytest.mark.slow
def test_a_mask_inside_a_mask_is_a_part(scene: Any) -> None:
    cloud, truth = scene
    top = table_top(cloud, truth)
    made = groups_of(cloud, with_tops(cloud, truth, seen_by(cloud, truth, around(20))))
    assert made.language is not None and min(best_ious(made, truth).values()) > 0.8
    column = made.cloud.group.numpy()
    inside = [g.id for g in made.language.groups if g.count and (top & (column == g.id)).sum() > 0.5 * g.count]
    union = np.isin(column, inside)
    assert (top & union).sum() / (top | union).sum() > 0.75  # the top is one colour with the rest of the table


@pytest.mark.slow
def test_masks_of_half_the_scene_leave_the_rest_to_geometry(scene: Any) -> None:
    cloud, truth = scene
    views = [
        ViewMasks(v.camera, np.where(v.ids == v.labels.index("chair"), 0, -1), ("chair",), np.ones(1, np.float32))
        for v in seen_by(cloud, truth, around(20))
        if "chair" in v.labels
    ]
    bare, made = (best_ious(groups_of(cloud, v), truth) for v in (None, views))
    assert made["chair"] > 0.85 and all(made[name] > bare[name] - 0.02 for name in THINGS)


def test_embedding_with_masks_names_things_by_text_vectors(scene: Any) -> None:
    cloud, truth = scene
    encoder = vector_encoder.wrap([[name] for name in (*THINGS, "sofa", "lamp")], np.eye(6, 8))

    views = seen_by(cloud, truth, around(16))
    made = embed(Scene(cloud, Frame(up_source="given", floor=0.0)), encoder, masks=Given(views))
    field = made.language
    assert field is not None and any("masks of 16 images" in note for note in field.notes)
    for i, name in enumerate(THINGS):
        (group,) = (g for g in field.objects() if g.label == name)
        own = np.isin(made.cloud.group.numpy(), field.leaves(group.id))
        assert ((truth == i) & own).sum() / ((truth == i) | own).sum() > 0.8  # the cup's underside is seen by no view
        assert np.allclose(field.embeddings[group.id], np.eye(6, 8)[i], atol=1e-6)


@pytest.mark.slow
def test_a_field_tells_how_far_each_source_was_believed(scene: Any) -> None:
    cloud, truth = scene
    views, rng = seen_by(cloud, truth, around(12)), np.random.default_rng(3)
    place = np.floor(cloud.means[:, 0].numpy() / 0.4).astype(int)  # slabs, of which each view joins others by chance
    odd = []
    for v in views:
        slab = rng.integers(0, 4, np.ptp(place) + 1).astype(np.int32)
        mixed = cloud.replace(group=torch.from_numpy(slab[place - place.min()]))
        odd.append(ViewMasks(v.camera, render(mixed, v.camera).group.numpy(), ("",) * 4, np.full(4, 0.8, np.float32)))
    nothing = [ViewMasks(v.camera, np.full(SIZE[::-1], -1, np.int32), (), np.zeros(0, np.float32)) for v in views]
    encoder = vector_encoder.wrap([[name] for name in (*THINGS, "sofa", "lamp")], np.eye(6, 8))
    sources = [Given(views), Given(nothing), Given(odd)]
    made = embed(Scene(cloud, Frame(up_source="given", floor=0.0)), encoder, masks=sources).language
    assert made is not None and made.making is not None
    right, silent, chance = made.making.masks
    assert (right.views, silent.views, silent.masks, silent.agreement) == (12, 12, 0, None)
    assert right.agreement is not None and chance.agreement is not None
    assert right.agreement > 0.7 and right.agreement > chance.agreement + 0.3  # views agree that a slab is in one mask
    assert any(f"agree to {right.agreement:.0%}" in line for line in made.making.lines())


@pytest.mark.slow
def test_vectors_of_another_encoder_are_refused(scene: Any) -> None:
    cloud, truth = scene
    encoder = vector_encoder.wrap([["chair"], ["table"]], np.eye(2, 8))
    views = [replace(v, vectors=np.ones((len(v), 5))) for v in seen_by(cloud, truth, around(4))]

    with pytest.raises(UserError, match="5 numbers and the encoder's 8"):
        embed(Scene(cloud), encoder, masks=Given(views))
