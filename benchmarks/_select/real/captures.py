"""Selection in four captures by the words people say: what groups can reach, what phrases select, and what is refused.

Each scene is embedded once for each setting: bare, with its photographs, and with masks. `said.json` holds the phrases
with the outlines they mean; a person wrote them who looked at the photographs only. Half of them are held out.
"""

from __future__ import annotations

import gc
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from statistics import fmean

import numpy as np

from ....agent.session.session import Session
from ....gaussians.camera import Camera
from ....gaussians.errors import ScenewrightError
from ....gaussians.language.encoders import Encoder
from ....gaussians.language.query.query import Query
from ....gaussians.language.query.resolve import resolve
from ....gaussians.scene import Scene
from ...harness import Metric
from ..cases import Part
from .drawings import BACKGROUND, IGNORE, UNLABELED, Bools, Weights, mean_agreement, silhouettes
from .settings import SETTINGS, Setting, Truth, embedded, encoder_of, truth_of

WRONG = 0.3  # IoU below which something that was found is the wrong thing
# Six queries that were measured from the beginning, as data, and the annotated labels that they mean.
QUERIES: dict[str, tuple[Query, tuple[int, ...]]] = {
    "bicycle": (Query(text="bicycle"), (5,)),
    "chair": (Query(text="chair", pick="all"), (7, 8)),
    "potted plant": (Query(text="potted plant"), (1,)),
    "purple cloth": (Query(text="cloth", colors=("purple",)), (4,)),
    "pink tree": (Query(text="tree", colors=("pink",)), (1,)),
    "red bicycle": (Query(text="bicycle", colors=("red",)), (5,)),
}
FOUR = ("the laptop", "the book", "the cup", "the flower pot")  # of `diorama_table`, the names of which three are asked
# Goals of figures, by scene, setting and figure.
GOALS: dict[str, float] = {
    "bonsai_room.photos.best_union": 0.80,
    "diorama_table.photos.best_union": 0.85,
    "bonsai_room.masks_coco.said": 0.70,
    "bonsai_room.masks_coco.six_queries": 0.82,
    "bonsai_room.masks_coco.wrong_found": 0,
    "bonsai_room.photos.said": 0.40,
    "bonsai_room.photos.wrong_found": 0,
    "bonsai_room.bare.wrong_found": 0,
    "diorama_table.true_masks.best_group": 0.93,
    "diorama_table.photos.named_of_four": 3,
    "diorama_table.photos.wrong_found": 0,
    "desk_laptop.photos.wrong_found": 0,
    "bench_box.photos.wrong_found": 0,
}


@dataclass(frozen=True, eq=False)
class Heard:
    """What one phrase selected.

    Attributes:
        phrase: as a person says it, "the red bike".
        kind: "said", "held_out", "undrawn", "absent" or "ambiguous".
        thing: the thing that is meant, "" if it is none of the drawn ones.
        verdict: of the selection; "not understood" if the words could not be read.
        chosen: `[N]` the selected Gaussians.
        public, other: IoU over the public and the other photographs, None where they do not show the thing.
        wrong: whether something was found that is not meant.
    """

    phrase: str
    kind: str
    thing: str
    verdict: str
    chosen: Bools = field(repr=False)
    public: float | None = None
    other: float | None = None
    wrong: bool = False

    @property
    def score(self) -> float:
        """IoU over the public photographs, over the others where those do not show it; 0 unless it was found."""
        known = self.public if self.public is not None else self.other
        return known or 0.0


@dataclass(frozen=True, eq=False)
class Measured:
    """A scene embedded in one setting, with every phrase asked of it.

    Attributes:
        unions, groups, limits: for each drawn thing, IoU of the best union of leaf groups, of the best single object,
            and of the best choice of single Gaussians.
    """

    truth: Truth
    setting: Setting
    scene: Scene
    seconds: float
    heard: tuple[Heard, ...]
    unions: dict[str, float]
    groups: dict[str, float]
    limits: dict[str, float]
    six: dict[str, float]


def measured(captures: Path, name: str, setting: Setting, limits: bool = True) -> Measured:
    """One scene in one setting, with every phrase asked; `limits`: also what single Gaussians could reach."""
    truth, encoder = truth_of(captures, name), encoder_of(captures, setting)
    scene, seconds = embedded(captures, name, setting, encoder)
    viewer = truth.drawn[0].camera
    ask = partial(_heard, Session(scene, "grammar", encoder, viewer=viewer, vlm=None))
    heard = [
        *(ask(phrase, kind, thing) for thing, entry in truth.said["things"].items() for kind in ("said", "held_out")
          for phrase in entry[kind]),
        *(ask(phrase, kind, "") for kind in ("undrawn", "absent", "ambiguous") for phrase in truth.said[kind]),
    ]  # fmt: skip
    scored = _scored(truth, scene, heard)
    unions, groups, singles = reached(truth, scene, limits)
    six = _six(truth, scene, encoder, viewer) if name == "bonsai_room" else {}
    return Measured(truth, setting, scene, seconds, tuple(scored), unions, groups, singles, six)


def _heard(session: Session, phrase: str, kind: str, thing: str) -> Heard:
    cloud = session.scene.cloud
    try:
        found = session.select(phrase)
    except ScenewrightError:
        return Heard(phrase, kind, thing, "not understood", np.zeros(len(cloud), bool))
    return Heard(phrase, kind, thing, found.verdict, found.mask(cloud).numpy())


def _scored(truth: Truth, scene: Scene, heard: Sequence[Heard]) -> list[Heard]:
    """The phrases with their agreement; equal selections are rendered once."""
    keys = [h.chosen.tobytes() if h.verdict in ("found", "unconfirmed") else b"" for h in heard]
    unique = {key: h.chosen for key, h in zip(keys, heard, strict=True) if key}
    order = {key: i for i, key in enumerate(unique)}
    chosen = np.stack(list(unique.values())) if unique else np.zeros((0, len(scene.cloud)), bool)
    shown = [silhouettes(scene, chosen, d.camera) for d in truth.drawn]
    scored = []
    for key, one in zip(keys, heard, strict=True):
        if not key:
            zero = 0.0 if one.kind in ("said", "held_out") else None
            scored.append(replace(one, public=zero, other=zero))
            continue
        compared = _compared(truth, one, [s[order[key]] for s in shown])
        scored.append(replace(compared, wrong=compared.wrong and one.verdict == "found"))
    return scored


def _compared(truth: Truth, one: Heard, shown: Sequence[Bools]) -> Heard:
    """What was found, with its agreement with the best reading of the phrase, or whether it shows what is not meant."""
    if one.thing:
        split = len(truth.public)
        readings = [truth.labels(names) for names in truth.said["things"][one.thing]["means"]]

        def best(part: slice) -> float | None:
            each = [mean_agreement(shown[part], truth.drawn[part], labels) for labels in readings]
            return max((v for v in each if v is not None), default=None)

        public, other = best(slice(0, split)), best(slice(split, None))
        return replace(one, public=public, other=other, wrong=(public if public is not None else other or 0.0) < WRONG)
    if one.kind == "absent":
        return replace(one, wrong=True)
    meant = truth.labels(truth.said["ambiguous"].get(one.phrase, ())) if one.kind == "ambiguous" else ()
    nothing = (0, UNLABELED, *meant)
    strange = sum(int((s & ~np.isin(d.labels, nothing)).sum()) for s, d in zip(shown, truth.drawn, strict=True))
    return replace(one, wrong=strange > 0.5 * max(sum(int(s.sum()) for s in shown), 1))


def reached(truth: Truth, scene: Scene, limits: bool) -> tuple[dict[str, float], dict[str, float], dict[str, float]]:
    """For each drawn thing the IoU of the best union of leaf groups, the best object, and the best choice of Gaussians.

    Judged over the public photographs where there are any.
    """
    drawn = truth.public or truth.other
    assert scene.language is not None
    leaf = scene.cloud.group.numpy()
    parent = np.array([g.parent if g.parent >= 0 else g.id for g in scene.language.groups] or [0])
    whole = np.where(leaf >= 0, parent[np.maximum(leaf, 0)], -1)
    each = np.arange(len(leaf))
    weights = Weights.of(scene, drawn)
    things = {n: (v,) for n, v in truth.numbers.items() if n not in (IGNORE, BACKGROUND)}
    things = {n: v for n, v in things.items() if any(d.shows(v) for d in drawn)}
    choices = [weights.best_union(leaf, drawn, v) for v in things.values()]
    choices += [weights.best_group(whole, drawn, v) for v in things.values()]
    choices += [weights.best_union(each, drawn, v) for v in things.values()] if limits else []
    shown = [silhouettes(scene, np.stack(choices), d.camera) for d in drawn]
    scores = [
        mean_agreement([s[i] for s in shown], drawn, list(things.values())[i % len(things)]) or 0.0
        for i in range(len(choices))
    ]
    parts = [
        dict(zip(things, scores[k : k + len(things)], strict=False)) for k in range(0, 3 * len(things), len(things))
    ]
    return parts[0], parts[1], parts[2]


def _six(truth: Truth, scene: Scene, encoder: Encoder, viewer: Camera) -> dict[str, float]:
    """Agreement of the six queries."""
    chosen = [resolve(scene, query, viewer, encoder).mask(scene.cloud).numpy() for query, _ in QUERIES.values()]
    shown = [silhouettes(scene, np.stack(chosen), d.camera) for d in truth.public]
    return {
        name: mean_agreement([s[i] for s in shown], truth.public, labels) or 0.0
        for i, (name, (_, labels)) in enumerate(QUERIES.items())
    }


def by_thing(heard: Sequence[Heard], kinds: Sequence[str], which: str = "score") -> dict[str, float]:
    """Mean over the phrases of each drawn thing."""
    table: dict[str, list[float]] = {}
    for one in heard:
        value = getattr(one, which)
        if one.thing and one.kind in kinds and value is not None:
            table.setdefault(one.thing, []).append(value)
    return {thing: fmean(values) for thing, values in table.items()}


def figures(one: Measured, name: str) -> dict[str, float]:
    """All figures of one scene in one setting, without its key."""
    every = one.heard
    singles = [h for h in every if h.thing in one.unions or not h.thing]
    found: dict[str, float] = {
        "best_union": fmean(one.unions.values()),
        "best_group": fmean(one.groups.values()),
        **({"gaussian_limit": fmean(one.limits.values())} if one.limits else {}),
    }
    for key, kinds in (("said", ("said",)), ("held_out", ("held_out",))):
        found[key] = fmean(by_thing(singles, kinds).values())
    if one.truth.public and one.truth.other:
        found["said_other_photos"] = fmean(by_thing(singles, ("said", "held_out"), "other").values())
    if one.six:
        found["six_queries"] = fmean(one.six.values())
    asked = [h for h in every if h.kind in ("said", "held_out")]
    for verdict in ("found", "ambiguous", "absent", "unconfirmed", "not understood"):
        found[f"verdict.{verdict.replace(' ', '_')}"] = sum(h.verdict == verdict for h in asked) / len(asked)
    found["wrong_found"] = sum(h.wrong for h in every)
    for kind, right in (("absent", ("absent",)), ("ambiguous", ("ambiguous",))):
        of_kind = [h for h in every if h.kind == kind]
        found[f"{kind}.right"] = sum(h.verdict in right for h in of_kind) / len(of_kind)
    if name == "diorama_table":
        found["named_of_four"] = sum(h.phrase in FOUR and h.score >= 0.5 for h in every)
    found["embed.seconds"] = one.seconds
    return found


def measure(captures: Path, names: Sequence[str] = tuple(SETTINGS)) -> Part:
    """All captures that are there, in all settings."""
    metrics: list[Metric] = []
    notes = [
        f"captures: phrases that a person said who saw only the photographs, in every setting. A thing counts as "
        f"wrongly found below an IoU of {WRONG}, as does anything that is found and is not there. best_union: of leaf "
        "groups, what any choice of groups could reach; best_group: of single objects; gaussian_limit: of single "
        "Gaussians"
    ]
    for name in names:
        if not (captures / name).is_dir():
            notes.append(f"captures: {name} is not here")
            continue
        for setting in SETTINGS[name]:
            one = measured(captures, name, setting, limits=setting is SETTINGS[name][0])
            metrics += [_metric(f"{name}.{setting.name}.{key}", value) for key, value in figures(one, name).items()]
            notes.append(told(one, name))
            del one
            gc.collect()
    return Part(tuple(metrics), notes=tuple(notes))


def _metric(key: str, value: float) -> Metric:
    figure = key.split(".", 2)[2]
    if figure == "embed.seconds":
        return Metric(f"captures.{key}", value, "s", "lower", 0.3)
    if figure == "wrong_found":
        return Metric(f"captures.{key}", value, "count", "lower", 0.1, GOALS.get(key))
    if figure.startswith("verdict."):
        return Metric(f"captures.{key}", value, "share")
    unit = "count" if figure == "named_of_four" else "share" if figure.endswith(".right") else "IoU"
    return Metric(f"captures.{key}", value, unit, "higher", 0.05, GOALS.get(key))


def told(one: Measured, name: str) -> str:
    """A line for the reader: each thing with the best union and what its phrases select, and what was wrongly found."""
    scores = by_thing(one.heard, ("said", "held_out"))
    each = [f"{thing} {scores[thing]:.2f} of {one.unions[thing]:.2f}" for thing in one.unions if thing in scores]
    wrong = [f"{h.phrase!r}" for h in one.heard if h.wrong]
    more = f"; wrongly found: {', '.join(wrong)}" if wrong else ""
    return f"{name}, {one.setting.name}, phrases of the best union: {', '.join(each)}{more}"
