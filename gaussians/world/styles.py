"""Styles of rooms: their names, and the materials that they give floor, walls and things, read from `styles.json`.

`planners.compose.knowledge` reads the same file for what a style means for the things of a composed room.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Literal, get_args

from . import kinds
from .finishes import described

Role = Literal["floor", "walls", "ceiling", "counters", "seating", "textiles", "metal", "furniture"]
StyleName = Literal[
    "minimalist", "cozy", "modern", "industrial", "rustic", "scandinavian", "japanese", "bohemian", "vintage",
    "luxurious", "beach inspired", "playful", "dark", "romantic", "botanical",
]  # fmt: skip
STYLES = Path(__file__).with_name("styles.json")
# Kinds that a style dresses alike; a kind of two roles takes the first that the style names.
ROLES: Mapping[Role, tuple[str, ...]] = MappingProxyType({
    "counters": ("kitchen counter", "kitchen island", "counter", "bar counter", "reception desk"),
    "seating": ("sofa", "loveseat", "armchair", "ottoman", "beanbag", "office chair"),
    "textiles": ("curtain", "cushion", "floor cushion", "bedspread", "blanket", "folded towel"),
    "metal": ("floor lamp", "pendant lamp", "chandelier", "arc lamp", "table lamp", "desk lamp"),
    "furniture": (
        "table", "dining table", "round table", "coffee table", "side table", "console table", "cafe table", "desk",
        "nightstand", "bookshelf", "shelf", "wall shelf", "cabinet", "wardrobe", "wall cabinet", "dresser", "sideboard",
        "tv stand", "bench", "chair", "stool", "bar stool", "rocking chair", "bed", "chest", "kitchen counter",
        "kitchen island", "kitchen cabinet", "workbench",
    ),
})  # fmt: skip


@cache
def materials_of() -> Mapping[str, Mapping[Role, str]]:
    """The materials of each style that names any, by what has them."""
    found = {s["name"]: s["materials"] for s in json.loads(STYLES.read_text("utf-8")) if s.get("materials")}
    strange = [phrase for table in found.values() for phrase in table.values() if described(phrase) is None]
    assert not strange, f"styles name materials that are not known: {strange}"
    assert set(found) == set(get_args(StyleName)), "the names of styles are those in the file"
    return MappingProxyType({name: MappingProxyType(table) for name, table in found.items()})


@cache
def names() -> Mapping[str, str]:
    """Every name of a style that names materials, in lower case without hyphens, and the style."""
    found = {
        also: s["name"]
        for s in json.loads(STYLES.read_text("utf-8"))
        if s["name"] in materials_of()
        for also in (s["name"], *s.get("also", ()))
    }
    return MappingProxyType(found)


def named(text: str) -> str:
    """The style that a word or phrase names, "" if it names none."""
    return names().get(" ".join(text.lower().replace("-", " ").split()), "")


def roles_of(label: str) -> tuple[Role, ...]:
    """The roles in which a style may dress a thing, the closest first: "seating", "furniture", ..."""
    kind = kinds.find(label)
    name = kind.name if kind is not None else label
    return tuple(role for role, held in ROLES.items() if name in held)


def material_for(label: str, style: Mapping[Role, str]) -> str:
    """What a style gives a thing, a floor, a wall or a ceiling of a name; "" where it leaves it as it is."""
    if label in ("floor", "wall", "ceiling", "ground"):
        parts: dict[str, Role] = {"floor": "floor", "ground": "floor", "wall": "walls", "ceiling": "ceiling"}
        return style.get(parts[label], "")
    return next((style[role] for role in roles_of(label) if role in style), "")
