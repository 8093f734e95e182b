"""What painted Gaussians looked like before: from the record alone, and from the column that was kept."""

from __future__ import annotations

from dataclasses import replace

import torch

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.painted import Painted, painted_again, unpainted


def _cloud(count: int = 40) -> GaussianCloud:
    rng = torch.Generator().manual_seed(5)
    quats = torch.nn.functional.normalize(torch.randn(count, 4, generator=rng), dim=1)
    sh = torch.randn(count, 4, 3, generator=rng)
    return GaussianCloud(
        means=torch.randn(count, 3, generator=rng),
        quats=quats,
        scales=torch.full((count, 3), 0.1),
        opacities=torch.full((count,), 0.9),
        sh=sh,
        group=torch.zeros(count, dtype=torch.int32),
        ids=torch.arange(count),
    )


def _painted(
    cloud: GaussianCloud, record: Painted | None, rows: list[int], value: float
) -> tuple[GaussianCloud, Painted]:
    where = torch.tensor(rows)
    bare = unpainted(cloud, record)
    now = cloud.replace(sh=bare.sh.where(~torch.isin(torch.arange(len(cloud)), where)[:, None, None], value))
    if record is not None:  # what is not painted now keeps its earlier paint
        others = ~torch.isin(torch.arange(len(cloud)), where)
        now = now.replace(sh=torch.where(others[:, None, None], cloud.sh, now.sh))
    return now, painted_again(record, bare, now, where)


def _from_the_record(cloud: GaussianCloud, record: Painted) -> torch.Tensor:
    """As `unpainted`, of objects that it has never seen."""
    return unpainted(cloud.replace(sh=cloud.sh.clone()), replace(record)).sh


def test_two_coats_come_off_at_once() -> None:
    first = _cloud()
    once, record = _painted(first, None, [1, 2, 3], 0.5)
    twice, again = _painted(once, record, [3, 4], 0.7)
    for cloud, known in ((once, record), (twice, again)):
        assert torch.equal(unpainted(cloud, known).sh, first.sh)
        assert torch.equal(_from_the_record(cloud, known), first.sh)


def test_what_something_else_changed_counts_as_never_painted() -> None:
    first = _cloud()
    once, record = _painted(first, None, [1, 2], 0.5)
    turned = once.replace(sh=once.sh.index_fill(0, torch.tensor([2, 9]), 0.1))
    bare = unpainted(turned, record).sh
    assert torch.equal(bare[1], first.sh[1])
    assert bool((bare[[2, 9]] == 0.1).all())
    twice, again = _painted(turned, record, [2, 5], 0.7)
    assert torch.equal(unpainted(twice, again).sh, bare)
    assert torch.equal(_from_the_record(twice, again), bare)


def test_nothing_is_written_in_place() -> None:
    first = _cloud()
    kept = first.sh.clone()
    once, record = _painted(first, None, [0], 0.5)
    unpainted(once, record)
    assert torch.equal(first.sh, kept)
    assert bool((once.sh[0] == 0.5).all())
