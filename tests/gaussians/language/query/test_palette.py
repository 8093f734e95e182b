"""The colours of some Gaussians, with folds counted to their material; and groups that are set apart from others."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.harmonics import color_to_dc
from scenewright.gaussians.language.field.apart import set_apart
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.field.measure import box_of, lab_of_cloud
from scenewright.gaussians.language.query.palette import palette
from scenewright.gaussians.scene import Scene

RED, WHITE, PURPLE = (0.75, 0.1, 0.08), (0.85, 0.85, 0.85), (0.22, 0.12, 0.30)


def sheet(colors: list[tuple[float, float, float]], folds: bool = False, n: int = 40) -> Scene:
    """A level sheet of `n` times `n` Gaussians in strips of colours along x; `folds` darken every other row."""
    x, y = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    means = np.stack([x, y, np.zeros_like(x)], axis=2).reshape(-1, 3) * 0.01
    rgb = np.array(colors)[(x * len(colors) // n).reshape(-1)]
    rgb = rgb * np.where(folds & (y.reshape(-1) % 4 < 2), 0.35, 1.0)[:, None]
    count = len(means)
    cloud = GaussianCloud(
        means=torch.from_numpy(means).float(),
        quats=torch.tensor([[1.0, 0, 0, 0]]).repeat(count, 1),
        scales=torch.tensor([[0.006, 0.006, 0.001]]).repeat(count, 1),
        opacities=torch.full((count,), 0.9),
        sh=color_to_dc(torch.from_numpy(rgb).float())[:, None],
        group=torch.zeros(count, dtype=torch.int32),
        ids=torch.arange(count),
    )
    return Scene(cloud)


def strip(n: int, number: int, of: int) -> np.ndarray:
    return np.flatnonzero((np.arange(n * n) // n) * of // n == number)


def agreement(found: np.ndarray, asked: np.ndarray) -> float:
    return len(np.intersect1d(found, asked)) / len(np.union1d(found, asked))


def test_every_row_has_one_colour_and_shares_sum_to_one() -> None:
    scene = sheet([RED, WHITE])
    found = palette(scene, np.arange(len(scene.cloud)))
    assert len(found.part) == len(found.rows) == len(scene.cloud)
    assert found.shares.sum() == pytest.approx(1.0)
    assert set(found.part.tolist()) == set(range(len(found.labs)))


@pytest.mark.parametrize("word, number", [("red", 0), ("white", 1)])
def test_a_word_takes_the_rows_of_its_colour(word: str, number: int) -> None:
    # averaging over 12 neighbours moves a border by about one row of 40
    scene = sheet([RED, WHITE])
    found = palette(scene, np.arange(len(scene.cloud)))
    assert agreement(found.of([word]), strip(40, number, 2)) > 0.9


def test_folds_belong_to_their_material() -> None:
    scene = sheet([PURPLE, (0.35, 0.22, 0.10)], folds=True)
    found = palette(scene, np.arange(len(scene.cloud)))
    assert agreement(found.of(["purple"]), strip(40, 0, 2)) > 0.9


def test_a_colour_that_is_not_there_gives_nothing() -> None:
    scene = sheet([RED, WHITE])
    assert not len(palette(scene, np.arange(len(scene.cloud))).of(["green"]))
    with pytest.raises(UserError):
        palette(scene, np.zeros(0, np.int64))


def two_things() -> Scene:
    """A sheet whose halves along x are two objects."""
    scene = sheet([RED, WHITE])
    column = (torch.arange(len(scene.cloud)) >= len(scene.cloud) // 2).int()
    halves = [scene.cloud[column == k] for k in range(2)]
    groups = tuple(
        Group(k, "object", -1, "mat", 1.0, box_of(c, scene.frame), lab_of_cloud(c), len(c), 1, 1.0)
        for k, c in enumerate(halves)
    )
    cloud = scene.cloud.replace(group=column)
    return scene.replace(cloud=cloud, language=LanguageField(groups, np.eye(2, dtype=np.float32), "none"))


@pytest.mark.parametrize("part", [False, True])
def test_what_is_set_apart_is_one_group_and_the_rest_is_measured_again(part: bool) -> None:
    scene = two_things()
    assert scene.language is not None
    owner, rows = scene.language.groups[0], np.flatnonzero(scene.cloud.group.numpy() == 0)
    upper = rows[: len(rows) // 3]
    after, new = set_apart(scene, upper, "hat", "user", part=part)
    table = after.language
    assert table is not None
    assert (after.cloud.group == new).nonzero().squeeze(1).tolist() == upper.tolist()
    for name, column in after.cloud.columns():
        assert name == "group" or column is getattr(scene.cloud, name)
    made = table.groups[new]
    assert (made.level, made.parent) == (("part", owner.id) if part else ("object", -1))
    assert (made.label, made.count) == ("hat", len(upper))
    assert table.groups[owner.id].count == (len(rows) if part else len(rows) - len(upper))


def test_all_of_an_object_stays_that_object() -> None:
    scene = two_things()
    assert scene.language is not None
    owner, rows = scene.language.groups[0], np.flatnonzero(scene.cloud.group.numpy() == 0)
    after, same = set_apart(scene, rows, "hat", "user")
    assert same == owner.id and after.cloud is scene.cloud and after.language is not None
    assert after.language.groups[same].label == "hat"
