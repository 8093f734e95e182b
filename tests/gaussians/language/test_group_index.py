"""The index of groups and set operations on sorted ids, against linear search and Python's sets."""

from __future__ import annotations

import torch
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians.cloud import NO_GROUP, GaussianCloud
from scenewright.gaussians.language.field.group_index import difference, index_groups, union


def cloud_of(groups: list[int], ids: list[int]) -> GaussianCloud:
    n = len(groups)
    return GaussianCloud.create(
        torch.zeros(n, 3), torch.tensor([[1.0, 0, 0, 0]]).repeat(n, 1), torch.ones(n, 3), torch.full((n,), 0.5),
        torch.zeros(n, 1, 3), torch.tensor(groups, dtype=torch.int32), torch.tensor(ids, dtype=torch.int64),
    )  # fmt: skip


def ascending(ids: set[int]) -> torch.Tensor:
    return torch.tensor(sorted(ids), dtype=torch.int64)


rows = st.lists(st.tuples(st.integers(-1, 6), st.integers(0, 10_000)), max_size=60, unique_by=lambda r: r[1])
asked = st.sets(st.integers(-1, 9), max_size=6)
# close together, far apart, and both: flags serve the first, sorting the second
sets = st.sets(st.integers(0, 60) | st.integers(10**9, 10**9 + 60) | st.integers(0, 10**12), max_size=40)


@given(rows, asked, st.booleans(), st.sets(st.integers(0, 10_000), max_size=40))
def test_rows_and_ids_of_groups_are_those_a_search_finds(
    made: list[tuple[int, int]], groups: set[int], in_order: bool, strays: set[int]
) -> None:
    some = strays | {i for _, i in made[::2]}
    made = sorted(made, key=lambda r: r[1]) if in_order else made
    found = index_groups(cloud_of([g for g, _ in made], [i for _, i in made]))
    assert found.rows(groups).tolist() == [k for k, (g, _) in enumerate(made) if g in groups]
    assert found.ids_of(groups).tolist() == sorted(i for g, i in made if g in groups)
    assert found.ids_but(groups).tolist() == sorted(i for g, i in made if g not in groups)
    assert found.every_id.tolist() == sorted(i for _, i in made)
    assert found.present(torch.tensor(sorted(some), dtype=torch.int64)).tolist() == sorted(some & {i for _, i in made})


@given(st.integers(2000, 4000), st.integers(0, 2**31 - 1))
def test_few_and_many_rows_come_out_alike(count: int, seed: int) -> None:
    column = torch.randint(-1, 200, (count,), generator=torch.Generator().manual_seed(seed))
    found = index_groups(cloud_of(column.tolist(), list(range(5, count + 5))))
    for groups in ([7], [3, 9], list(range(150)), [NO_GROUP, 4]):
        wanted = torch.isin(column, torch.tensor(groups)).nonzero().squeeze(1)
        assert found.rows(groups).tolist() == wanted.tolist()
        assert found.ids_of(groups).tolist() == (wanted + 5).tolist()


def test_a_cloud_is_sorted_once_and_again_only_when_its_groups_change() -> None:
    cloud = cloud_of([0, 1, 1, -1], [0, 1, 2, 3])
    first = index_groups(cloud)
    assert index_groups(cloud.replace(opacities=cloud.opacities * 0.5)) is first
    moved = cloud.replace(group=torch.tensor([1, 1, 0, -1], dtype=torch.int32))
    assert index_groups(moved).ids_of([0]).tolist() == [2] and first.ids_of([0]).tolist() == [0]


@given(sets, sets)
def test_unions_and_differences_are_those_of_sets(a: set[int], b: set[int]) -> None:
    one, other = ascending(a), ascending(b)
    assert union(one, other).tolist() == sorted(a | b)
    assert difference(one, other).tolist() == sorted(a - b)
