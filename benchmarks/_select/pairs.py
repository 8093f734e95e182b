"""Queries by attribute: pairs of a kind that differ only in colour or size, and two kinds with their colours swapped.

To an encoder that is nearly a bag of words, "a red chair and a green table" equals "a green chair and a red table".
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...gaussians import assets
from ...gaussians.assets import Asset
from ...gaussians.assets.furnishing.layout import Layout
from ...gaussians.color import BASIC
from ...gaussians.language.encoders import Encoder
from ...gaussians.language.query.query import Query
from ..harness import Metric
from . import staged
from .cases import Case, Part, ask

# Kinds of which designs can be mostly of one colour: a drum has skins, a basket a dark inside.
KINDS = (
    "chair", "armchair", "stool", "table", "box", "suitcase", "ottoman", "bin", "bench", "nightstand", "vase",
    "flower pot", "ball", "backpack", "cabinet", "side table",
)  # fmt: skip
PLAIN = 0.7  # share of the surface that must be of the colour: a red chair is mostly red
SMALL, LARGE = 0.8, 1.3  # factors on a design's size
COLOR_PAIRS, SIZE_PAIRS, SWAPS = 4, 2, 3  # a room


@dataclass(frozen=True)
class Meant:
    """A query and the id of the object that it means; None where there is no such thing."""

    query: Query
    object: int | None


Set = tuple[Case, list[Meant]]


def design(kind: str, colors: Sequence[str], seed: int) -> int:
    """The first design from `seed` on that is mostly of its main colour in each of these colours."""
    for number in range(seed, seed + 50):
        made = [assets.make(kind, number, color=color) for color in colors]
        if all(a.color == c and staged.share_of(a, c) >= PLAIN for a, c in zip(made, colors, strict=True)):
            return number
    raise ValueError(f"no {kind} of the first 50 designs from {seed} on is mostly {' or '.join(colors)}")


def attribute_room(seed: int) -> Set:
    """Pairs of a kind in two colours and pairs in two sizes; each is asked by what tells it from the other."""
    layout = staged.bare("attributes", seed)
    rng = layout.rng
    kinds = [str(k) for k in rng.permutation(KINDS)[: COLOR_PAIRS + SIZE_PAIRS]]
    things, asked = [], []
    for kind in kinds[:COLOR_PAIRS]:
        for color in rng.choice(sorted(BASIC), 2, replace=False):
            number = design(kind, [str(color)], int(rng.integers(1 << 20)))
            things.append(assets.make(kind, number, color=str(color)))
            asked.append(Query(text=kind, colors=(str(color),)))
    for kind in kinds[COLOR_PAIRS:]:
        one = assets.make(kind, int(rng.integers(1 << 20)))
        for word, factor in (("small", SMALL), ("large", LARGE)):
            w, d, h = (side * factor for side in one.size)
            things.append(assets.make(kind, one.seed, size=(w, d, h)))
            asked.append(Query.model_validate({"text": kind, "size": word}))
    return _placed(layout, things, asked, seed)


def swap_rooms(seed: int) -> tuple[Set, Set]:
    """Two rooms of the same things at the same places with colours swapped; both are asked all four combinations."""
    rng = np.random.default_rng([zlib.crc32(b"swap"), seed])
    kinds = [str(k) for k in rng.permutation(KINDS)[: 2 * SWAPS]]
    colors = [[str(c) for c in rng.choice(sorted(BASIC), 2, replace=False)] for _ in range(SWAPS)]
    drawn = rng.integers(1 << 20, size=2 * SWAPS).tolist()
    designs = [design(kind, colors[i // 2], drawn[i]) for i, kind in enumerate(kinds)]

    def room(swapped: bool) -> Set:
        layout, things, asked = staged.bare("swap", seed), [], []
        for i, kind in enumerate(kinds):
            own = colors[i // 2][(i + swapped) % 2]
            things.append(assets.make(kind, designs[i], color=own))
            asked.append(Query(text=kind, colors=(own,)))
        case, meant = _placed(layout, things, asked, seed)
        for i, kind in enumerate(kinds):
            other = colors[i // 2][(i + 1 + swapped) % 2]
            meant.append(Meant(Query(text=kind, colors=(other,)), None))
        return case, meant

    return room(False), room(True)


def _placed(layout: Layout, things: Sequence[Asset], asked: Sequence[Query], seed: int) -> Set:
    """The room with the things that could be placed, and their queries; without kinds of which a thing is missing."""
    spots = staged.stand(layout, things)
    lost = {things[i].kind for i, spot in enumerate(spots) if spot is None}
    meant = [Meant(q, s) for q, s, t in zip(asked, spots, things, strict=True) if t.kind not in lost]
    return staged.built(layout, seed), meant


def right(embedded: Case, meant: Meant, encoder: Encoder) -> bool:
    """Whether the answer is the meant object, or a refusal where nothing is meant."""
    answer = ask(embedded, meant.query, encoder)
    if meant.object is None:
        return answer.verdict == "absent"
    return answer.means(embedded.truth(embedded.objects[meant.object]))


def measure(attributes: Sequence[int], swaps: Sequence[int], encoder: Encoder, grouped: Callable[[Case], Case]) -> Part:
    """All sets from their seeds; `grouped` gives a case its field."""
    rooms = [attribute_room(seed) for seed in attributes]
    swapped = [room for seed in swaps for room in swap_rooms(seed)]
    kinds: dict[str, list[bool]] = {"color": [], "size": [], "swap": [], "swap.absent": []}
    wrong: list[str] = []
    for name, sets in (("color", rooms), ("swap", swapped)):
        for case, meant in sets:
            known = grouped(case)
            for one in meant:
                key = "size" if one.query.size else "swap.absent" if one.object is None else name
                kinds[key].append(right(known, one, encoder))
                if not kinds[key][-1]:
                    said = "said to be there" if one.object is None else "missed"
                    wrong.append(f"{one.query.describe()} {said} in {case.seed}")
    every = [v for values in kinds.values() for v in values]
    metrics = [Metric("attribute.right", sum(every) / len(every), "share", "higher", 0.03, 0.95)]
    for key, values in kinds.items():
        metrics.append(Metric(f"attribute.{key}.right", sum(values) / len(values), "share", "higher", 0.03))
        metrics.append(Metric(f"attribute.{key}.asked", len(values), "count"))
    note = "attributes: two objects of a kind in two basic colours or two sizes, and two kinds with swapped colours"
    return Part(tuple(metrics), notes=(note, *([f"attributes wrong: {'; '.join(wrong)}"] if wrong else [])))
