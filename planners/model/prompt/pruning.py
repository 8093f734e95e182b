"""Describe a scene graph in lines of text for the prompt, pruned to a token budget by relevance to an instruction.

Pruning does not decide what an instruction refers to, and the number of omitted nodes is always stated. A node is
*named* if a phrase of the instruction agrees with its label, or states its colour.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ....gaussians.color import plain_color
from ....gaussians.world.support import SHELL
from ...rooms.graph import SceneGraph
from ...rooms.label_encoder import THRESHOLD, agreement, words
from ...rooms.node import Node

MAX_TOKENS = 8000  # of a scene, whatever the model's window: about 200 things; more costs much and helps little
_COLORED = 0.3  # score of a node of which only the colour is stated
_AGREEMENTS = 60_000  # comparisons of phrases with labels for one instruction, about half a second
_REACH = 1.5  # metres from a named thing within which others are its neighbours
_ANCHORS = 256  # named things whose neighbours are searched
_LEFT_OUT_NAMES = 8  # labels of omitted nodes that are listed

_PIECE = re.compile(r"(?P<word>[A-Za-z]+)|(?P<marks>[^\w\s]+)|(?P<other>[\w\n])")
_LETTERS = {"word": 7, "marks": 2}
_WORD = re.compile(r"[^\W_]+(?:['-][^\W_]+)*")
_IDLE_WORDS = """
a an the of to in on at by for with and or but it them this that these those its is are be all every both each one ones
other some any please can could you would i me my we our make put move let so as from into onto up down out off over
under left right front behind next near between more less bit very too same there here not no than then
"""
_IDLE = frozenset(_IDLE_WORDS.split())


def tokens(text: str) -> int:
    """Estimate the number of tokens of a text.

    Each digit, each non-Latin letter and each line break counts as one token, as do each seven letters of a word and
    each two punctuation marks in a row. On our prompts and scenes this is within 7 % of CLIP's byte-pair encoding,
    mostly above it; bytes divided by three are a third too few for texts with many numbers.
    """
    return sum(-(-len(found.group()) // _LETTERS.get(found.lastgroup or "", 1)) for found in _PIECE.finditer(text))


def line(node: Node) -> str:
    """One node: "12: green armchair, 0.8 x 0.8 x 0.9 m, at (-2.2, 0.6, 0.45), turned 90, on floor"."""
    size = " x ".join(_short(s) for s in node.size)
    at = ", ".join(_short(p) for p in node.position)
    turned = f", turned {_short(node.yaw)}" if round(node.yaw) else ""
    support = node.support if node.support in SHELL or isinstance(node.support, int) else "another thing"
    name = f"{node.color} {node.label or 'thing'}".strip()
    return f"{node.id if isinstance(node.id, int) else '-'}: {name}, {size} m, at ({at}){turned}, on {support}"


def _short(value: float) -> str:
    return f"{round(value, 2) + 0.0:g}"


@dataclass(frozen=True)
class Shown:
    """A scene as text.

    Attributes:
        whole: number of things that are described.
        named: number of further things of which the name is given alone.
    """

    text: str
    whole: int = 0
    named: int = 0


def described(graph: SceneGraph, said: Sequence[str], budget: int) -> Shown:
    """The room, its things one per line, and a summary of omitted ones, in at most `budget` tokens.

    Things that do not fit are listed by their names alone, in at most a third of the budget, then only counted.

    Args:
        graph: with sanitised names (see `labels.sanitize`).
        said: the instruction, and others that it may refer to.
        budget: tokens as counted by `tokens`; if not even one line fits, only the counts are given.
    """
    width, depth, height = (_short(s) for s in graph.room.size)
    head = f"Room: {width} x {depth} x {height} m, the origin in the middle of the floor.{_viewer(graph)}"
    left = budget - tokens(head) - 60  # for the line about what was left out
    relations = _relations(graph)
    order = list(Relevance(graph, said).order())
    full = [line(graph.nodes[i]) + "".join(f", {told}" for told in relations.get(i, ())) for i in order]
    whole = _fitting(full, left)
    if whole < len(order):
        brief = [_name(graph.nodes[i]) for i in order]
        reserved = sum(tokens(text) + 1 for text in brief[: _fitting(brief, max(left, 0) // 3)])
        whole = _fitting(full, left - reserved)
        left -= sum(tokens(text) + 1 for text in full[:whole])
        named = _fitting(brief[whole:], left)
    else:
        brief, named = [], 0
    kept = dict(zip(order, [*full[:whole], *brief[whole : whole + named]], strict=False))
    missing = Counter(n.label or "thing" for i, n in enumerate(graph.nodes) if i not in kept)
    text = "\n".join([head, *(kept[i] for i in sorted(kept)), *_left_out(missing)])
    return Shown(text, whole, named)


def _fitting(lines: Sequence[str], budget: int) -> int:
    """How many of the lines, from the first on, fit a budget."""
    for count, text in enumerate(lines):
        budget -= tokens(text) + 1
        if budget < 0:
            return count
    return len(lines)


def _name(node: Node) -> str:
    """One node of which the name is told alone: "12: green armchair"."""
    return line(node).partition(", ")[0]


def _viewer(graph: SceneGraph) -> str:
    if graph.viewer is None:
        return ""
    eye, target = (", ".join(_short(c) for c in p) for p in (graph.viewer.position, graph.viewer.target))
    return f" The viewer is at ({eye}) and looks at ({target})."


def _left_out(missing: Counter[str]) -> list[str]:
    if not missing:
        return []
    names = ", ".join(f"{count} {name}" for name, count in missing.most_common(_LEFT_OUT_NAMES))
    more = ", …" if len(missing) > _LEFT_OUT_NAMES else ""
    return [f"Not shown: {missing.total()} more things ({names}{more})."]


def _relations(graph: SceneGraph) -> dict[int, list[str]]:
    """Stated relations of nodes to others by the index of the node, at most two a node; "on" is covered by the support
    of a node."""
    index = {n.id: i for i, n in enumerate(graph.nodes)}
    relations: dict[int, list[str]] = {}
    for a, name, b in graph.relations:
        told = relations.setdefault(index[a], [])
        if isinstance(b, int) and len(told) < 2 and (name != "on" or graph.nodes[index[a]].support != b):
            told.append(f"{name.replace('_', ' ')} {b}")
    return relations


class Relevance:
    """Relevance of each node of a graph to an instruction.

    Args:
        graph: with sanitised names.
        said: the instruction, and others that it may refer to.
    """

    def __init__(self, graph: SceneGraph, said: Sequence[str]) -> None:
        self.graph = graph
        self._said = tuple(tuple(_WORD.findall(text.lower())) for text in said if text)

    @cached_property
    def scores(self) -> NDArray[np.float64]:
        """`[N]` in [0, 1]: agreement of a node's label, or at least its colour, with the instruction."""
        labels = tuple(dict.fromkeys(n.label for n in self.graph.nodes if n.label))
        best = dict.fromkeys(labels, 0.0)
        for phrase in self._phrases(_AGREEMENTS // max(len(labels), 1)):
            for name, how in zip(labels, agreement(phrase, labels), strict=True):
                best[name] = max(best[name], how)
        spoken = {w for text in self._said for w in text}
        stems = {s for w in spoken for s in words(w)}
        for name in labels:  # if phrases were cut off by the limit, a shared word still counts
            if best[name] < THRESHOLD and stems & set(words(name)) - _IDLE:
                best[name] = THRESHOLD
        colored = np.array([_COLORED * bool(set(plain_color(n.color).split()) & spoken) for n in self.graph.nodes])
        named = np.array([best.get(n.label, 0.0) for n in self.graph.nodes])
        found: NDArray[np.float64] = np.where(named >= THRESHOLD, named + 0.02 * (colored > 0), colored)
        return found

    def named(self, index: int) -> bool:
        """Whether the instruction names a node."""
        return bool(self.scores[index] >= THRESHOLD)

    def order(self) -> Iterator[int]:
        """Indices of all nodes by decreasing relevance.

        Named nodes, each followed by its supports; nodes on them or related to them; their neighbours; then the rest by
        decreasing volume. Of equally named nodes, those near another named node come first.
        """
        seen: dict[int, None] = {}
        named = self._named()
        index = {n.id: i for i, n in enumerate(self.graph.nodes)}
        for i in named:
            at: int | None = i
            while at is not None and at not in seen:
                seen[at] = None
                at = index.get(self.graph.nodes[at].support)
        for i in self._partners(set(named), index):
            seen.setdefault(i)
        for i in self._neighbours(named):
            seen.setdefault(i)
        for i in sorted(range(len(self.graph.nodes)), key=lambda i: (-math.prod(self.graph.nodes[i].size), i)):
            seen.setdefault(i)
        return iter(seen)

    def _phrases(self, limit: int) -> list[str]:
        """N-grams of one to three words that begin and end with a content word, about `limit` at most."""
        found: dict[str, None] = {}
        for text in self._said:
            for length in (1, 2, 3):
                for start in range(len(text) - length + 1):
                    run = text[start : start + length]
                    if run[0] not in _IDLE and run[-1] not in _IDLE:
                        found.setdefault(" ".join(run))
        return list(found)[: max(limit, 8)]

    def _named(self) -> list[int]:
        """Named nodes, sorted by score, then rarity of the label, then distance to another named node."""
        chosen = [i for i in range(len(self.graph.nodes)) if self.named(i)]
        label = {i: self.graph.nodes[i].label for i in chosen}
        count = Counter(label.values())
        rare = sorted(chosen, key=lambda i: (count[label[i]], i))[:_ANCHORS]
        near = self._gaps(rare, apart=True)
        return sorted(chosen, key=lambda i: (-self.scores[i], count[label[i]], near[i], i))

    def _partners(self, named: set[int], index: dict[int | str, int]) -> Iterator[int]:
        """Nodes on a named node, and nodes related to one."""
        for i, node in enumerate(self.graph.nodes):
            if index.get(node.support) in named:
                yield i
        for a, _, b in self.graph.relations:
            if index[a] in named or index[b] in named:
                yield from (index[a], index[b])

    def _neighbours(self, named: Sequence[int]) -> list[int]:
        gaps = self._gaps(named[:_ANCHORS])
        order: NDArray[np.int64] = np.argsort(gaps, kind="stable")
        return [int(i) for i in order if gaps[i] <= _REACH]

    def _gaps(self, anchors: Sequence[int], apart: bool = False) -> NDArray[np.float64]:
        """`[N]` metres between each node's centre and the nearest anchor's; `apart`: of another label only."""
        nodes = self.graph.nodes
        best = np.full(len(nodes), np.inf)
        places = np.array([n.position for n in nodes], dtype=np.float64).reshape(-1, 3)
        kinds = {name: k for k, name in enumerate(dict.fromkeys(n.label for n in nodes))}
        kind = np.array([kinds[n.label] for n in nodes])
        for a in anchors:
            gap = np.linalg.norm(places - places[a], axis=1)
            best = np.minimum(best, np.where(kind == kind[a], np.inf, gap) if apart else gap)
        return best
