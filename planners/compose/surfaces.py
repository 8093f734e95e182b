"""Surfaces and light of a composed room: what the brief says of the room and its things, else what its style means."""

from __future__ import annotations

from collections.abc import Mapping

from ...gaussians.world.finishes import described, said
from ...gaussians.world.styles import Role, material_for, materials_of
from ..rooms.graph import SceneGraph
from ..rooms.node import Node
from . import knowledge
from .brief import Brief
from .sentence.lights import feature_mood
from .sentence.surfaces import PARTS

_METALS = frozenset({"gold", "copper", "brass", "bronze", "chrome"})  # colours that are metals on furniture
_PAINTED = ("walls", "ceiling")  # of which a colour alone is said


def with_surfaces(graph: SceneGraph, brief: Brief, names: Mapping[int, str]) -> SceneGraph:
    """The graph with the materials of its room and of its things, and with its light.

    Args:
        names: for each node that the brief asked for, its id to the id of the brief's thing.
    """
    room = _room(brief)
    style = _style(brief)
    if "furniture" in room:
        style["furniture"] = room["furniture"]
    parts: tuple[Role, ...] = ("floor", "walls", "ceiling")
    shape = graph.room.model_copy(update={part: room.get(part) or style.get(part, "") for part in parts})
    shape = shape.model_copy(update={"light": _light(brief)})
    if graph.room.outdoor:
        shape = shape.model_copy(update={"walls": "", "ceiling": ""})
    things = {thing.id: thing for thing in brief.things}
    nodes = []
    for node in graph.nodes:
        thing = things.get(names.get(node.id, "")) if isinstance(node.id, int) else None
        own = _material(thing.material, thing.color) if thing is not None else ""
        stated = thing is not None and bool(thing.color or thing.material)
        nodes.append(_with(node, own or ("" if stated else material_for(node.label, style))))
    return graph.model_copy(update={"room": shape, "nodes": tuple(nodes)})


def _with(node: Node, material: str) -> Node:
    return node.model_copy(update={"material": material[:60]}) if material else node


def _room(brief: Brief) -> dict[str, str]:
    """Phrases for floor, walls and ceiling among the features of a brief."""
    found: dict[str, str] = {}
    for feature in brief.features:
        phrase, _, last = feature.rpartition(" ")
        part = PARTS.get(last, "")
        told = described(phrase) if part and phrase else None
        if told is not None:
            found[part] = phrase[:60]
    return found


def _light(brief: Brief) -> str:
    """The named light that the features of a brief mean, else its styles, "" for none."""
    meant = [*brief.features, *(unshown for s in brief.styles if (unshown := _unshown(s)))]
    return next((mood for text in meant if (mood := feature_mood(text))), "")


def _unshown(style: str) -> str:
    found = knowledge.styles().get(style)
    return found.unshown if found is not None else ""


def _style(brief: Brief) -> dict[Role, str]:
    """What the first style with materials means, by the role of what has them."""
    return next((dict(materials_of()[name]) for name in brief.styles if name in materials_of()), {})


def _material(material: str, color: str) -> str:
    """The surface of a thing that is said to be of a material, or of a colour that is a metal."""
    known = said(material)
    if known is None:
        return color if color in _METALS else ""
    return f"{color} {material}" if color and color not in _METALS else material
