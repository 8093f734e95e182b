"""Composed rooms embedded blind: what names, absent things and relations come to without the graph they were built of.

Each room is composed from the name of a kind of room and built; its table of true groups is taken away and the scene
is embedded anew. The true groups remain as ground truth.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from statistics import fmean

import numpy as np
import torch

from ...gaussians import assets
from ...gaussians.assets import TruthObject
from ...gaussians.cloud import NO_GROUP
from ...gaussians.language.encoders import Encoder
from ...gaussians.world import kinds
from ...planners.compose.api import compose
from ...planners.compose.knowledge import rooms as room_kinds
from ...planners.rooms.build import construct
from .._iou import iou
from ..harness import Metric
from . import relations
from .cases import RIGHT, Case, Part, ask

ABSENT = 6  # names of kinds asked in each room that it does not hold
RELATIONS = 24  # queries by relation asked in each room at most
SEED = 7200  # of the first room; the rooms after it take the seeds that follow
FEW_GAUSSIANS = 20  # things of fewer Gaussians are not asked for


@dataclass(frozen=True)
class Confusion:
    """What became of one true object of a room.

    Attributes:
        room: kind of room.
        meant: true name.
        named: label of the group that agrees best with it.
        iou: of that group.
        union: IoU of the best union of groups.
        found: IoU of what its name selects; None where the room holds several and the name was not asked.
        verdict: of that query, "" if not asked.
    """

    room: str
    meant: str
    named: str
    iou: float
    union: float
    found: float | None
    verdict: str


@dataclass(frozen=True)
class Asked:
    """The answers of one room: confusions of its objects, absent names refused, and relations right on both fields."""

    objects: tuple[Confusion, ...]
    absent: tuple[str, ...]
    accepted: tuple[str, ...]
    blind: tuple[bool, ...]
    true_groups: tuple[bool, ...]


def room_names() -> list[str]:
    """All kinds of rooms that can be composed; "room" names no kind."""
    return [name for name in room_kinds() if name != "room"]


def composed_room(name: str, seed: int) -> tuple[Case, Case]:
    """A composed room: with its true groups as field, and without a field. Names are those of kinds where known."""
    graph = compose(name, seed=seed, planner="grammar", best=True)
    built = construct(graph, seed=seed)
    scene = built.scene
    assert scene.language is not None
    row_of = {n.id: built.ids[n.id] for n in graph.nodes if n.id in built.ids}
    number = {key: i for i, key in enumerate(row_of)}
    group, ids = scene.cloud.group.numpy(), np.full(len(scene.cloud), -1, np.int32)
    objects = []
    for key, row in row_of.items():
        ids[group == row] = number[key]
        node, box = graph.node(key), scene.language.groups[row].box
        kind = kinds.find(node.label)
        support = number.get(node.support, node.support)
        name_of = kind.name if kind else node.label
        objects.append(TruthObject(number[key], name_of, node.color or "", box.size, box.center, node.yaw, support, ()))
    cloud = scene.cloud.replace(group=torch.full_like(scene.cloud.group, NO_GROUP))
    return (
        Case(seed, scene, ids, tuple(objects)),
        Case(seed, replace(scene, cloud=cloud, language=None), ids, tuple(objects)),
    )


def ask_room(name: str, true: Case, blind: Case, encoder: Encoder) -> Asked:
    """All questions about one room; `blind` is embedded."""
    field = blind.scene.language
    assert field is not None
    masks, groups = blind.groups(), field.objects()
    objects = []
    for thing in blind.objects:
        truth = blind.truth(thing)
        if truth.sum() < FEW_GAUSSIANS:
            continue
        each = [iou(mask, truth) for mask in masks]
        best = int(np.argmax(each))
        answer = ask(blind, thing.kind, encoder) if blind.present[thing.kind] == 1 else None
        found = None if answer is None else iou(answer.mask, truth)
        verdict = "" if answer is None else answer.verdict
        label, union = groups[best].label, blind.best_union(truth)
        objects.append(Confusion(name, thing.kind, label, each[best], union, found, verdict))
    absent = _absent(blind)
    accepted = tuple(kind for kind in absent if ask(blind, kind, encoder).verdict == "found")
    known = relations.generate(blind, (0,))
    chosen = np.random.default_rng(blind.seed).permutation(len(known))[:RELATIONS]
    asked = [known[i] for i in sorted(chosen.tolist())]
    right = [tuple(relations.right(case, one, encoder) for one in asked) for case in (blind, true)]
    return Asked(tuple(objects), absent, accepted, right[0], right[1])


def _absent(case: Case) -> tuple[str, ...]:
    missing = [k for k in assets.kinds(shown=True) if not any(there.endswith(k) for there in case.present)]
    return tuple(str(k) for k in np.random.default_rng(case.seed).choice(missing, ABSENT, replace=False))


def confusions(asked: Sequence[Asked]) -> list[str]:
    """Lines for the reader: each kind that was named or found wrongly, with what it was taken for, most often first."""
    table: dict[str, list[Confusion]] = {}
    for room in asked:
        for one in room.objects:
            table.setdefault(one.meant, []).append(one)
    wrong: list[tuple[int, str]] = []
    for meant, every in sorted(table.items()):
        split = [c for c in every if c.iou < RIGHT]
        called = Counter(c.named or "(nothing)" for c in every if c.iou >= RIGHT and c.named != meant)
        missed = [c for c in every if c.found is not None and c.found < RIGHT]
        if not (split or called or missed):
            continue
        verdicts = Counter(c.verdict if c.verdict != "found" else "wrong thing" for c in missed)
        told = [f"group apart {len(every) - len(split)} of {len(every)}"]
        told += ["called " + ", ".join(f"{k} {n}" for k, n in called.most_common())] if called else []
        told += ["asked: " + ", ".join(f"{k} {n}" for k, n in verdicts.most_common())] if missed else []
        wrong.append((len(split) + called.total() + len(missed), f"{meant}: {'; '.join(told)}"))
    return [line for _, line in sorted(wrong, key=lambda pair: -pair[0])]


def measure(grouped: Callable[[Case], Case], encoder: Encoder, names: Sequence[str]) -> Part:
    """The figures over rooms of these kinds, one room each."""
    asked = []
    for i, name in enumerate(names):
        true, bare = composed_room(name, SEED + i)
        asked.append(ask_room(name, true, grouped(bare), encoder))
    single = [c for room in asked for c in room.objects if c.found is not None]
    every = [c for room in asked for c in room.objects]
    absent = [k for room in asked for k in room.absent]
    accepted = [k for room in asked for k in room.accepted]
    blind, true_groups = ([v for room in asked for v in getattr(room, key)] for key in ("blind", "true_groups"))
    metrics = [
        Metric("composed.names.right", fmean((c.found or 0.0) >= RIGHT for c in single), "share", "higher", 0.03, 0.92),
        Metric("composed.names.asked", len(single), "count"),
        Metric("composed.labels.right", fmean(c.named == c.meant and c.iou >= RIGHT for c in every), "share", "higher",
               0.03),
        Metric("composed.groups.right", fmean(c.iou >= RIGHT for c in every), "share", "higher", 0.03),
        Metric("composed.oracle.miou", fmean(c.iou for c in every), "IoU", "higher", 0.03),
        Metric("composed.best_union", fmean(c.union for c in every), "IoU", "higher", 0.03, 0.95),
        Metric("composed.absent.refused", 1 - len(accepted) / len(absent), "share", "higher", 0.03, 0.95),
        *([Metric("composed.relations.right", fmean(blind), "share", "higher", 0.05),
           Metric("composed.relations.true_groups", fmean(true_groups), "share", "higher", 0.05)] if blind else []),
    ]  # fmt: skip
    note = (
        f"composed: {len(names)} kinds of rooms, each composed from its name, built, and embedded without its table. "
        "A kind that the room holds once is asked by name; labels: of the group that agrees best with each thing"
    )
    worst = confusions(asked)
    more = ("composed, wrong most often: " + " | ".join(worst[:12]),) if worst else ()
    return Part(tuple(metrics), notes=(note, *more))
