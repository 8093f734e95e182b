"""The fallback by colour: what it never takes, what it prefers, and what it says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.color import BASIC, parse, rgb_to_lab
from scenewright.gaussians.harmonics import SH_C0
from scenewright.gaussians.language.encoders.vocabulary import Vocabulary
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.resolve import resolve
from scenewright.gaussians.language.query.selection import Selection
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.world.box import Box

AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
COLORS = tuple(BASIC)
EYE = Camera.look_at((0, -7, 3), (0, 0, 0.5), (0, 0, 1), 320, 240, 60)
Vec = tuple[float, float, float]


@dataclass(frozen=True)
class Piece:
    """One group: its colour and box. `rest`: a piece of the shell that segmentation left as a thing."""

    color: str
    center: Vec
    size: Vec
    level: Literal["object", "structure"] = "object"
    label: str = ""
    rest: bool = False
    loose: bool = False


def shell(floor: str, wall: str) -> list[Piece]:
    """A floor of 6 x 5 m and two walls."""
    return [
        Piece(floor, (0, 0, 0), (6, 5, 0.02), "structure", "floor"),
        Piece(wall, (0, 2.5, 1.25), (6, 0.02, 2.5), "structure", "wall"),
        Piece(wall, (-3, 0, 1.25), (0.02, 5, 2.5), "structure", "wall"),
    ]


def scene_of(pieces: list[Piece], metres: float | None = 1.0) -> Scene:
    """Gaussians on the faces of every piece, 4 to 12 cm apart; loose pieces have no group."""
    means, colors, group, table = [], [], [], []
    for piece in pieces:
        points = _faces(np.array(piece.center), np.array(piece.size))
        means.append(points)
        rgb = parse(BASIC[piece.color])
        colors.append(np.tile(rgb, (len(points), 1)))
        group.append(np.full(len(points), -1 if piece.loose else len(table)))
        if not piece.loose:
            lightness, a, b = rgb_to_lab(torch.tensor(rgb, dtype=torch.float64)).tolist()
            table.append(
                Group(
                    len(table), piece.level, -1, piece.label, 1.0 if piece.level == "structure" else 0.1,
                    Box(piece.center, AXES, piece.size), (lightness, a, b), len(points), 3, 1.0,
                )
            )  # fmt: skip
    where = torch.from_numpy(np.concatenate(means)).float()
    n = len(where)
    shown = torch.from_numpy(np.concatenate(colors)).float()
    cloud = GaussianCloud.create(
        where, torch.tensor([[1.0, 0, 0, 0]]).repeat(n, 1), torch.full((n, 3), 0.03), torch.full((n,), 0.9),
        ((shown - 0.5) / SH_C0)[:, None, :].contiguous(), torch.from_numpy(np.concatenate(group)).int(),
    )  # fmt: skip
    field = LanguageField(tuple(table), np.zeros((len(table), 2), np.float32), "test:1")
    return Scene(cloud, Frame((0, 0, 1), 0.0, metres, "given", "given"), language=field)


def _faces(center: np.ndarray, size: np.ndarray) -> np.ndarray:
    made = []
    for axis in range(3):
        a, b = (i for i in range(3) if i != axis)
        counts = [max(2, min(50, int(size[i] / 0.06))) for i in (a, b)]
        u, v = np.meshgrid(*(np.linspace(-0.5, 0.5, c) for c in counts), indexing="ij")
        for side in (-0.5, 0.5):
            points = np.zeros((u.size, 3))
            points[:, a], points[:, b], points[:, axis] = u.ravel() * size[a], v.ravel() * size[b], side * size[axis]
            made.append(points + center)
    return np.concatenate(made)


def ask(scene: Scene, text: str, *colors: str, pick: Literal["one", "all", "any"] = "one") -> Selection:
    # Nobody is sure of any label, and there is no encoder: every name goes by its colour.
    return resolve(scene, Query(text=text, colors=colors, pick=pick), EYE, Knows())


class Knows:
    """An encoder that knows no word."""

    fingerprint, dim = "test:1", 2

    vocabulary = Vocabulary({"lamp": ()}, {}, ())

    class calibration:
        threshold = 0.5

    def unknown_words(self, text: str) -> tuple[str, ...]:
        return tuple(text.split())

    def knows(self, text: str) -> bool:
        return False


def rows_of(pieces: list[Piece], scene: Scene, wanted: set[int]) -> set[int]:
    """Ids of the Gaussians of some pieces, by position in the list."""
    sizes = [len(_faces(np.array(p.center), np.array(p.size))) for p in pieces]
    starts = np.concatenate([[0], np.cumsum(sizes)])
    return {int(scene.cloud.ids[r]) for i in wanted for r in range(starts[i], starts[i + 1])}


color = st.sampled_from(COLORS)
spot = st.tuples(st.floats(-2.2, 2.2), st.floats(-1.8, 1.8))


@st.composite
def rooms(draw: st.DrawFn) -> list[Piece]:
    """A room with things, and pieces of its floor and walls that the segmentation left, with or without a group."""
    floor, wall = draw(color), draw(color)
    made = shell(floor, wall)
    for x, y in draw(st.lists(spot, max_size=3)):
        side = draw(st.floats(0.3, 0.9))
        made.append(Piece(draw(color), (x, y, side / 2 + 0.02), (side, side, side)))
    left = [
        Piece(floor, (draw(st.floats(-1, 1)), -1.2, 0.015), (2.5, draw(st.floats(1.5, 2.4)), 0.03), rest=True),
        Piece(wall, (draw(st.floats(-1, 1)), 2.47, 1.2), (2.2, 0.04, draw(st.floats(1.2, 2.2))), rest=True),
    ]
    for piece in left:
        if draw(st.booleans()):
            loose = draw(st.booleans())
            made.append(Piece(piece.color, piece.center, piece.size, rest=True, loose=loose))
    return made


NOUNS = st.sampled_from(["gizmo", "box", "wooden stand", "table"])


@settings(max_examples=15, deadline=None)
@given(
    rooms(), color, st.sampled_from(["gizmo", "box", "wooden stand", "table"]), st.sampled_from(["one", "all", "any"])
)
def test_no_floor_wall_or_piece_of_them_is_ever_chosen(
    pieces: list[Piece], word: str, noun: str, pick: Literal["one", "all", "any"]
) -> None:
    scene = scene_of(pieces)
    found = ask(scene, noun, word, pick=pick)
    assert found.verdict != "found"
    barred = {i for i, p in enumerate(pieces) if p.level == "structure" or p.rest}
    assert not set(found.ids.tolist()) & rows_of(pieces, scene, barred)
    told = {g for g in found.groups} | {c.group for c in found.candidates if found.verdict != "absent"}
    table = [i for i, p in enumerate(pieces) if not p.loose]
    assert all(table[g] not in barred for g in told if g >= 0)


def test_the_floor_is_chosen_if_it_is_asked_for() -> None:
    scene = scene_of(shell("brown", "white"))
    assert ask(scene, "floor", "brown").verdict == "found" and ask(scene, "floor", "brown").groups == (0,)
    assert ask(scene, "box", "brown").verdict == "absent"


def test_a_whole_group_takes_precedence_over_a_larger_loose_patch() -> None:
    pieces = [*shell("gray", "white"), Piece("red", (1, 0, 0.3), (0.5, 0.5, 0.5)),
              Piece("red", (-1.5, 0, 0.6), (1.0, 1.0, 1.0), loose=True)]  # fmt: skip
    scene = scene_of(pieces)
    found = ask(scene, "gizmo", "red")
    assert found.verdict == "unconfirmed" and found.groups == (3,)
    assert set(found.ids.tolist()) == rows_of(pieces, scene, {3})


def test_without_a_group_a_compact_patch_is_chosen_and_a_thin_cross_is_not() -> None:
    room = shell("gray", "white")
    block = Piece("red", (1, 0, 0.5), (0.6, 0.6, 0.6), loose=True)
    scene = scene_of([*room, block])
    found = ask(scene, "gizmo", "red")
    assert found.verdict == "unconfirmed" and found.groups == () and "patch" in found.reason
    assert set(found.ids.tolist()) == rows_of([*room, block], scene, {3})
    bars = [Piece("red", (0, 0, 1), tuple(2.0 if i == k else 0.03 for i in range(3)), loose=True) for k in range(3)]  # type: ignore[arg-type]
    assert ask(scene_of([*room, *bars]), "gizmo", "red").verdict == "absent"


@pytest.mark.parametrize(("noun", "verdict"), [("gizmo", "unconfirmed"), ("mug", "absent"), ("box", "unconfirmed")])
def test_a_noun_of_known_size_bars_what_cannot_be_it(noun: str, verdict: str) -> None:
    pieces = [*shell("gray", "white"), Piece("red", (1, 0, 0.3), (0.6, 0.6, 0.5))]
    assert ask(scene_of(pieces), noun, "red").verdict == verdict
    assert ask(scene_of(pieces, metres=None), noun, "red").verdict == "unconfirmed"  # no scale: any size may be right


def test_a_rug_may_be_flat_on_the_floor_if_its_colour_is_another() -> None:
    rug = Piece("red", (0.5, 0, 0.02), (2.0, 1.4, 0.02))
    assert ask(scene_of([*shell("gray", "white"), rug]), "rug", "red").groups == (3,)
    assert ask(scene_of([*shell("gray", "white"), rug]), "box", "red").verdict == "absent"
    same = Piece("gray", (0.5, 0, 0.02), (2.0, 1.4, 0.02))
    assert ask(scene_of([*shell("gray", "white"), same]), "rug", "gray").verdict == "absent"


def test_equal_things_of_a_colour_are_ambiguous_and_all_are_unconfirmed() -> None:
    two = [Piece("red", (x, 0, 0.3), (0.5, 0.5, 0.5)) for x in (-1.0, 1.0)]
    scene = scene_of([*shell("gray", "white"), *two])
    assert ask(scene, "gizmo", "red").verdict == "ambiguous"
    every = ask(scene, "gizmo", "red", pick="all")
    assert every.verdict == "unconfirmed" and every.groups == (3, 4) and "2 red things" in every.reason
