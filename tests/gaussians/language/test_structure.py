"""Floors, walls and ceilings of hand-made rooms, and objects that lie in their planes and remain objects."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.language.segmentation.settle import settled
from scenewright.gaussians.language.segmentation.structure import CEILING, FLOOR, NONE, WALL, kind_of, structures
from scenewright.gaussians.language.segmentation.superpoints import links_of, superpoints
from scenewright.gaussians.language.segmentation.surface import surface_of
from scenewright.gaussians.scene import Frame

BROWN, WHITE, PALE, RED, BLUE, GREEN = (
    (0.45, 0.3, 0.16), (0.92, 0.9, 0.86), (0.97, 0.97, 0.97), (0.78, 0.13, 0.12), (0.16, 0.35, 0.78), (0.24, 0.6, 0.25),
)  # fmt: skip
MOST = 0.9  # of a piece's points: superpoints along edges where two pieces meet may go either way
FEW = 0.05


def kinds_of(made: Any, turn: NDArray[np.float64] | None = None) -> dict[str, dict[int, float]]:
    """For each piece the share of its surface points that is called each kind of structure."""
    frame = Frame() if turn is None else Frame(tuple(float(v) for v in turn @ [0, 0, 1]))  # type: ignore[arg-type]
    cloud = made.cloud(turn)
    surface = settled(surface_of(cloud), cloud, frame)
    names = sorted(made.rows)
    piece = made.labels(names)[surface.rows]
    found = kind_of(structures(surface, superpoints(surface, links_of(surface)), frame))
    return {
        name: {kind: float((found[piece == i] == kind).mean()) for kind in (NONE, FLOOR, WALL, CEILING)}
        for i, name in enumerate(names)
    }


def room(world: type[Any], seed: int = 0, ceiling: bool = False) -> Any:
    made = world(seed).sheet("floor", (-2, -1.5, 0), (4, 0, 0), (0, 3, 0), BROWN, 0.05)
    made.sheet("wall", (-2, 1.5, 0), (4, 0, 0), (0, 0, 2.4), WHITE, 0.06)
    made.sheet("side", (-2, -1.5, 0), (0, 3, 0), (0, 0, 2.4), WHITE, 0.06)
    if ceiling:
        made.sheet("ceiling", (-2, -1.5, 2.4), (4, 0, 0), (0, 3, 0), PALE, 0.06)
    made.box("crate", (0.2, -0.4, 0.02), (0.9, 0.3, 0.6), RED)
    made.box("cupboard", (-1.9, 0.2, 0.02), (-1.4, 1.2, 1.6), BLUE)
    return made


def test_a_room_has_a_floor_and_walls_and_its_things_are_neither(world: type[Any]) -> None:
    share = kinds_of(room(world))
    assert share["floor"][FLOOR] > MOST
    assert share["wall"][WALL] > MOST and share["side"][WALL] > MOST
    assert share["crate"][NONE] > MOST and share["cupboard"][NONE] > MOST
    assert all(s[CEILING] == 0 for s in share.values())


def test_a_ceiling_closes_a_room(world: type[Any]) -> None:
    share = kinds_of(room(world, ceiling=True))
    assert share["ceiling"][CEILING] > MOST
    assert share["floor"][FLOOR] > MOST and share["crate"][NONE] > MOST


@pytest.mark.parametrize("up", ["x", "-y", "askew"])
def test_structure_does_not_depend_on_the_axis_that_is_up(world: type[Any], up: str) -> None:
    turn = {
        "x": np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]]),
        "-y": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
        "askew": np.linalg.qr(np.array([[0.9, 0.1, 0.3], [0.2, 0.8, -0.4], [-0.3, 0.5, 0.8]]))[0],
    }[up]
    turn = turn * np.sign(np.linalg.det(turn))
    share = kinds_of(room(world), turn)
    assert share["floor"][FLOOR] > MOST and share["wall"][WALL] > MOST and share["side"][WALL] > MOST
    assert share["crate"][NONE] > MOST and share["cupboard"][NONE] > MOST


def test_a_rug_stays_an_object(world: type[Any]) -> None:
    made = room(world).sheet("rug", (-0.9, -1.3, 0.012), (1.8, 0, 0), (0, 0.8, 0), GREEN, 0.03)
    share = kinds_of(made)
    assert share["rug"][NONE] > MOST and share["floor"][FLOOR] > 0.8  # some floor shows through at the rug's rim


def test_a_rug_of_the_floors_colour_lies_before_it_by_a_finger(world: type[Any]) -> None:
    made = room(world).sheet("rug", (-0.9, -1.3, 0.03), (1.8, 0, 0), (0, 0.8, 0), BROWN, 0.03)
    assert kinds_of(made)["floor"][FLOOR] > 0.8


def test_a_painting_stays_an_object(world: type[Any]) -> None:
    made = room(world).sheet("painting", (0.2, 1.48, 1.1), (0.9, 0, 0), (0, 0, 0.7), GREEN, 0.03)
    share = kinds_of(made)
    assert share["painting"][NONE] > MOST and share["wall"][WALL] > 0.8


def test_tiles_all_over_the_floor_belong_to_it(world: type[Any]) -> None:
    made = world()
    for i in range(8):
        for j in range(6):
            color = BROWN if (i + j) % 2 else PALE
            made.sheet("floor", (-2 + 0.5 * i, -1.5 + 0.5 * j, 0), (0.5, 0, 0), (0, 0.5, 0), color, 0.05)
    made.box("crate", (0.2, -0.4, 0.02), (0.9, 0.3, 0.6), RED)
    share = kinds_of(made)
    assert share["floor"][FLOOR] > MOST and share["crate"][NONE] > MOST


def test_a_bumpy_terrain_is_floor(world: type[Any]) -> None:
    def bumps(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        height: NDArray[np.float64] = 0.12 * np.sin(2.1 * x) * np.cos(1.7 * y) + 0.05 * np.sin(5 * x + 3 * y)
        return height

    made = world().sheet("ground", (-2, -2, 0), (4, 0, 0), (0, 4, 0), GREEN, 0.05, bumps)
    made.box("hut", (0.2, 0.2, -0.05), (1.0, 1.0, 0.9), RED)
    share = kinds_of(made)
    assert share["ground"][FLOOR] > 0.8  # the hut hides some of it and its foot is in it
    assert share["hut"][NONE] > 0.65  # its underside, a seventh of it, is buried, and so is its foot


def test_a_thing_in_empty_space_has_neither_walls_nor_ceiling(world: type[Any]) -> None:
    share = kinds_of(world().box("crate", (-0.5, -0.5, -0.5), (0.5, 0.5, 0.5), RED))
    assert share["crate"][CEILING] + share["crate"][WALL] < FEW


def test_the_same_room_gives_the_same_bytes(world: type[Any]) -> None:
    def once() -> bytes:
        surface = surface_of(room(world, seed=4).cloud())
        return structures(surface, superpoints(surface, links_of(surface)), Frame()).tobytes()

    assert once() == once()


@pytest.mark.parametrize("seed", [1, 2])
def test_the_noise_of_the_sampling_does_not_matter(world: type[Any], seed: int) -> None:
    share = kinds_of(room(world, seed=seed))
    assert share["floor"][FLOOR] > MOST and share["wall"][WALL] > MOST and share["crate"][NONE] > MOST


def test_a_tall_thing_alone_stands_on_nothing() -> None:
    """The lowest slice of a scanned statue is part of the statue, not ground."""
    rng = np.random.default_rng(4)
    points = rng.uniform([-0.4, -0.4, 0], [0.4, 0.4, 4.0], (6000, 3)).astype(np.float32)
    n = len(points)
    cloud = GaussianCloud.create(
        torch.from_numpy(points),
        torch.tensor([[1.0, 0, 0, 0]]).expand(n, 4).contiguous(),
        torch.full((n, 3), 0.03),
        torch.full((n,), 0.9),
        torch.from_numpy(rng.normal(size=(n, 1, 3)).astype(np.float32) * 0.2),
    )
    surface = surface_of(cloud)
    assert not structures(surface, superpoints(surface, links_of(surface)), Frame(up_source="given")).any()


# --- floors that are not a clean level plane -------------------------------------------------------------------------

NOISES = (0.0, 0.01, 0.02, 0.03, 0.05)  # metres
STEP = 0.05  # largest fall of an IoU from one noise to the next


def ious(made: Any, frame: Frame, noise: float) -> dict[str, float]:
    """IoU of the floor, and of what of a rug and a crate is not called floor, among surface points."""
    cloud, rng = made.cloud(), np.random.default_rng(5)
    own = np.sort(made.rows["floor"])
    means = cloud.means.clone()
    means[torch.from_numpy(own), 2] += torch.from_numpy(rng.normal(0, max(noise, 1e-9), len(own))).float()
    cloud = cloud.replace(means=means)
    surface = settled(surface_of(cloud), cloud, frame)
    names = sorted(made.rows)
    piece = made.labels(names)[surface.rows]
    kinds = kind_of(structures(surface, superpoints(surface, links_of(surface)), frame))
    is_floor, floor = kinds == FLOOR, piece == names.index("floor")
    found = {"floor": float((is_floor & floor).sum() / (is_floor | floor).sum())}
    return found | {n: float((kinds[piece == names.index(n)] == NONE).mean()) for n in ("rug", "crate")}


@pytest.mark.slow
def test_no_amount_of_noise_turns_a_floor_into_something_else(world: type[Any]) -> None:
    made = room(world).sheet("rug", (-0.9, -1.3, 0.012), (1.8, 0, 0), (0, 0.8, 0), GREEN, 0.03)
    curve = [ious(made, Frame(), noise) for noise in NOISES]
    for name in ("floor", "rug", "crate"):
        values = [point[name] for point in curve]
        assert min(values) > MOST, (name, values)
        assert max(a - b for a, b in pairwise(values)) < STEP, (name, values)


def test_a_tilted_floor_is_a_floor(world: type[Any]) -> None:
    rise = np.tan(np.radians(5))
    made = world().sheet("floor", (-2, -1.5, 0), (4, 0, 4 * rise), (0, 3, 0), BROWN, 0.05)
    made.sheet("wall", (-2, 1.5, 0), (4, 0, 4 * rise), (0, 0, 2.4), WHITE, 0.06)
    made.box("crate", (0.2, -0.4, 2.3 * rise), (0.9, 0.3, 0.8), RED)
    made.sheet("rug", (-1.6, -1.3, 0.4 * rise + 0.012), (1.4, 0, 1.4 * rise), (0, 0.9, 0), GREEN, 0.03)
    share = kinds_of(made)
    assert share["floor"][FLOOR] > MOST and share["wall"][WALL] > MOST
    assert share["crate"][NONE] > 0.8 and share["rug"][NONE] > MOST  # the crate's foot is in the floor


def test_both_levels_of_a_stepped_floor_are_floor_and_a_bed_is_not(world: type[Any]) -> None:
    made = world().sheet("floor", (-2, -1.5, 0), (2.5, 0, 0), (0, 3, 0), BROWN, 0.05)
    made.sheet("platform", (0.5, -1.5, 0.3), (1.5, 0, 0), (0, 3, 0), BROWN, 0.05)
    made.sheet("riser", (0.5, -1.5, 0), (0, 3, 0), (0, 0, 0.3), BROWN, 0.05)
    made.sheet("wall", (-2, 1.5, 0), (4, 0, 0), (0, 0, 2.4), WHITE, 0.06)
    made.box("bed", (-1.9, -0.5, 0.02), (-0.1, 1.4, 0.4), BLUE)
    made.box("crate", (0.9, -0.4, 0.32), (1.5, 0.3, 0.9), RED)
    share = kinds_of(made)
    assert share["floor"][FLOOR] > 0.8 and share["platform"][FLOOR] > MOST
    assert share["bed"][NONE] > MOST and share["crate"][NONE] > MOST


def test_a_thick_floor_is_one_floor(world: type[Any]) -> None:
    made = room(world).sheet("underside", (-2, -1.5, -0.12), (4, 0, 0), (0, 3, 0), WHITE, 0.05)
    share = kinds_of(made)
    assert share["floor"][FLOOR] > MOST and share["underside"][FLOOR] > 0.8
    assert share["crate"][NONE] > MOST


def test_splats_spread_beneath_a_floor_are_floor(world: type[Any]) -> None:
    """A floor without texture leaves the depth of its splats open: some lie beneath it, none above."""
    rng = np.random.default_rng(3)

    def sunk(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        return -np.abs(rng.normal(0, 0.03, len(x)))

    made = world().sheet("floor", (-2, -1.5, 0), (4, 0, 0), (0, 3, 0), BROWN, 0.05, sunk)
    made.sheet("wall", (-2, 1.5, 0), (4, 0, 0), (0, 0, 2.4), WHITE, 0.06)
    made.sheet("rug", (-0.9, -1.3, 0.012), (1.8, 0, 0), (0, 0.8, 0), GREEN, 0.03)
    share = kinds_of(made)
    assert share["floor"][FLOOR] > MOST and share["rug"][NONE] > MOST


def test_half_a_wall_is_a_wall_and_a_missing_one_is_not_missed(world: type[Any]) -> None:
    made = world().sheet("floor", (-2, -1.5, 0), (4, 0, 0), (0, 3, 0), BROWN, 0.05)
    made.sheet("wall", (-2, 1.5, 0), (1.9, 0, 0), (0, 0, 2.4), WHITE, 0.06)
    made.box("crate", (0.2, -0.4, 0.02), (0.9, 0.3, 0.6), RED)
    share = kinds_of(made)
    assert share["wall"][WALL] > MOST and share["floor"][FLOOR] > MOST
    assert share["crate"][NONE] > MOST


def hastily_fitted(made: Any, noise: dict[str, float]) -> GaussianCloud:
    """The cloud with normal noise (m) on the places of some pieces, whose orientations are random."""
    cloud, rng = made.cloud(), np.random.default_rng(2)
    means, quats = cloud.means.clone(), cloud.quats.clone()
    for name, deviation in noise.items():
        own = torch.from_numpy(made.rows[name])
        means[own] += torch.from_numpy(rng.normal(0, deviation, (len(own), 3))).float()
        turned = torch.from_numpy(rng.normal(size=(len(own), 4))).float()
        quats[own] = torch.nn.functional.normalize(turned, dim=1)
    moved: GaussianCloud = cloud.replace(means=means, quats=quats)
    return moved


@pytest.mark.parametrize(("thickness", "kind"), [(0.02, WALL), (0.05, WALL), (0.3, NONE)])
def test_a_layer_much_thicker_than_the_floor_is_no_wall(world: type[Any], thickness: float, kind: int) -> None:
    """What stands in a row at the edge of a capture fills a sheet as a wall does, but is as deep as things are."""
    made = world().sheet("floor", (-2, -1.5, 0), (4, 0, 0), (0, 3, 0), BROWN, 0.04)
    made.sheet("row", (-2, 1.5, 0.02), (4, 0, 0), (0, 0, 2.4), WHITE, 0.04)
    cloud = hastily_fitted(made, {"floor": 0.02, "row": thickness})
    surface = settled(surface_of(cloud), cloud, Frame())
    found = kind_of(structures(surface, superpoints(surface, links_of(surface)), Frame()))
    own = found[np.isin(surface.rows, made.rows["row"])]
    assert (own == kind).mean() > 0.8


@pytest.mark.slow
def test_walls_and_ceiling_of_a_hasty_fit_are_found_by_positions_alone(world: type[Any]) -> None:
    """Normals are random and every plane is a layer some centimetres thick, as after a training of two minutes."""
    made = world().sheet("floor", (-2, -1.5, 0), (4, 0, 0), (0, 3, 0), BROWN, 0.05)
    made.sheet("ceiling", (-2, -1.5, 2.4), (4, 0, 0), (0, 3, 0), PALE, 0.05)
    for name, corner, along in (
        ("north", (-2, 1.5, 0), (4, 0, 0)), ("south", (-2, -1.5, 0), (4, 0, 0)),
        ("west", (-2, -1.5, 0), (0, 3, 0)), ("east", (2, -1.5, 0), (0, 3, 0)),
    ):  # fmt: skip
        made.sheet(name, corner, along, (0, 0, 2.4), WHITE, 0.05)
    made.box("crate", (0.2, -0.4, 0.02), (0.9, 0.3, 0.6), RED)
    made.box("cupboard", (-1.9, 0.2, 0.02), (-1.4, 1.2, 1.6), BLUE)
    shell = [name for name in made.rows if name not in ("crate", "cupboard")]
    cloud = hastily_fitted(made, dict.fromkeys(shell, 0.03))
    surface = settled(surface_of(cloud), cloud, Frame())
    names = sorted(made.rows)
    piece = made.labels(names)[surface.rows]
    codes = structures(surface, superpoints(surface, links_of(surface)), Frame())
    wanted = {"floor": FLOOR, "ceiling": CEILING, "crate": NONE, "cupboard": NONE}
    for name in names:
        right = kind_of(codes)[piece == names.index(name)] == wanted.get(name, WALL)
        assert right.mean() > 0.8, (name, right.mean())
    sides = [np.bincount(codes[piece == names.index(n)]).argmax() for n in ("north", "south", "west", "east")]
    assert len(set(sides)) == 4  # each wall is one of its own
