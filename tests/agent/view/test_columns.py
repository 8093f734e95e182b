"""Columns, slots and changes against slow references: what a page puts together is what the cloud holds."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.agent.session.packed_ids import pack, unpack
from scenewright.agent.view import wire
from scenewright.agent.view.changes import Shown, changes
from scenewright.agent.view.columns import columns_of, decode, encode, owners, width
from scenewright.agent.view.slots import EMPTY, Slots, ranges_of, slots_of
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.scene import Scene


def _cloud(count: int, degree: int, seed: int = 0) -> GaussianCloud:
    g = torch.Generator().manual_seed(seed)
    quats = torch.nn.functional.normalize(torch.randn(count, 4, generator=g), dim=1)
    return GaussianCloud.create(
        torch.randn(count, 3, generator=g) * 5, quats, torch.rand(count, 3, generator=g) + 1e-3,
        torch.rand(count, generator=g) * 0.98 + 0.01, torch.randn(count, (degree + 1) ** 2, 3, generator=g),
        torch.randint(-1, 4, (count,), generator=g, dtype=torch.int32),
    )  # fmt: skip


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_columns_hold_what_the_cloud_holds(degree: int) -> None:
    cloud = _cloud(50, degree)
    rows = np.array([3, EMPTY, 49, 0])
    there = cloud[torch.tensor([3, 49, 0])]
    full = rows != EMPTY
    made = {c: encode(cloud, owners(Scene(cloud)), c, rows) for c in columns_of(degree)}
    assert {c: len(data) for c, data in made.items()} == {c: 4 * width(c, degree) for c in made}
    assert (decode(made["position"], "position")["means"][full] == there.means.numpy()).all()
    shape, color = decode(made["shape"], "shape"), decode(made["color"], "color")
    turned = np.abs((shape["quats"][full] * there.quats.numpy()).sum(axis=1))  # q and -q turn alike
    assert (shape["quats"][:, 0] >= 0).all() and (turned > 1 - 1e-4).all()
    assert np.allclose(shape["scales"][full], there.scales.numpy(), rtol=4e-3)  # half of 11 bits of up to 7
    assert np.allclose(color["dc"][full], there.sh[:, 0].numpy(), rtol=1e-3, atol=1e-4)  # 11 bits
    assert np.allclose(color["opacities"][full], there.opacities.numpy(), atol=1e-5)
    assert color["opacities"][~full] == 0 and (color["opacities"][full] > 0).all()
    assert decode(made["group"], "group")["owner"].tolist() == [int(cloud.group[3]), -1, *cloud.group[[49, 0]].tolist()]
    if degree:
        rest = decode(made["harmonics"], "harmonics")["rest"].reshape(4, -1)
        assert np.allclose(rest[full], there.sh[:, 1:].reshape(3, -1).numpy(), rtol=1e-3, atol=1e-4)


@given(st.sets(st.integers(0, 400), max_size=80), st.integers(0, 3))
def test_ranges_hold_their_slots_and_bridge_short_gaps(chosen: set[int], bridged: int) -> None:
    slots = np.array(sorted(chosen), np.int64)
    ranges = ranges_of(slots, bridged)
    held = slots_of(ranges).tolist()
    assert chosen <= set(held) and len(held) == len(set(held))
    assert (ranges[1:, 0] - ranges[:-1].sum(axis=1) > bridged).all()
    assert bridged or held == slots.tolist()


@given(st.sets(st.integers(0, 10**12), max_size=60))
def test_packed_ids_come_back(ids: set[int]) -> None:
    given = torch.tensor(sorted(ids), dtype=torch.int64)
    assert torch.equal(unpack(pack(given)), given)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.integers(0, 2))
def test_changes_put_onto_a_page_give_what_is_shown(seed: int, degree: int) -> None:
    rng = np.random.default_rng(seed)
    shown = Shown.first(Scene(_cloud(30, degree, seed)))
    held = _page(shown)
    for step in range(4):
        shown, before = shown.then(Scene(_edited(shown.scene.cloud, rng, step))), shown
        changed = changes(before, shown)
        assert changed is not None
        for name, rows in held.items():
            more = np.zeros((shown.slots.count - len(rows), rows.shape[1]), np.uint8)
            held[name] = np.concatenate([rows, more])
        for part in wire.read(wire.change(shown, before.revision, changed))[1].values():
            width_ = held[part.column].shape[1]
            held[part.column][slots_of(part.ranges)] = np.frombuffer(part.data, np.uint8).reshape(-1, width_)
        wanted, full = _page(shown), shown.slots.rows != EMPTY
        for name, rows in wanted.items():
            assert (held[name][full] == rows[full]).all(), name
        assert not held["color"][~full, 6:].any()  # the opacity of an empty slot


def _page(shown: Shown) -> dict[str, np.ndarray]:
    """The bytes of all slots."""
    cloud, rows = shown.scene.cloud, shown.slots.rows
    return {
        c: np.frombuffer(encode(cloud, shown.owner, c, rows), np.uint8).reshape(len(rows), -1).copy()
        for c in columns_of(shown.degree)
    }


def _edited(cloud: GaussianCloud, rng: np.random.Generator, step: int) -> GaussianCloud:
    """The cloud with a few rows gone, added, moved in order, or changed in one column."""
    kind = rng.integers(5)
    if kind == 0 and len(cloud) > 3:
        return cloud[torch.from_numpy(np.sort(rng.choice(len(cloud), len(cloud) - 2, replace=False)))]
    if kind == 1:
        new = _cloud(3, cloud.degree, step)
        first = 1000 * (step + 1)
        columns = {n: torch.cat([c, getattr(new, n)]) for n, c in cloud.columns() if n != "ids"}
        return cloud.replace(**columns, ids=torch.cat([cloud.ids, torch.arange(first, first + 3)]))
    if kind == 2:
        return cloud[torch.from_numpy(rng.permutation(len(cloud)))]
    name = ("means", "sh", "opacities", "group", "scales")[rng.integers(5)]
    column = getattr(cloud, name).clone()
    column[rng.integers(len(cloud))] = 1 if name == "group" else 0.5
    return cloud.replace(**{name: column})


def test_only_slots_and_columns_that_changed_are_told() -> None:
    cloud = _cloud(100, 3)
    first = Shown.first(Scene(cloud))
    sh = cloud.sh.clone()
    sh[[5, 70], 0] = 0.25
    changed = changes(first, first.then(Scene(cloud.replace(sh=sh))))
    assert changed is not None and list(changed) == ["color"]
    assert changed["color"].tolist() == sorted(first.slots.slot[[5, 70]].tolist())
    fewer = first.then(Scene(cloud[torch.arange(100) != 9]))
    gone = changes(first, fewer)
    assert gone == {"color": [first.slots.slot[9]], "group": [first.slots.slot[9]]}
    assert changes(first, first.then(Scene(cloud.with_degree(1)))) is None


def test_a_scene_of_nothing_is_told() -> None:
    shown = Shown.first(Scene(GaussianCloud.empty(2)))
    (message,) = wire.load(shown)
    header, parts = wire.read(message)
    assert header["slots"] == 0 and all(not part.data for part in parts.values())
    then = shown.then(Scene(_cloud(4, 2)))
    assert {len(s) for s in (changes(shown, then) or {}).values()} == {4}
    assert Slots.of(then.scene.cloud).count == 4
