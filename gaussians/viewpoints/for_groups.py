"""Chooses a few views that together show given groups: large enough, whole, unhidden, and from different sides.

A view is worth, for each group, how readable the group is in it (`Visibility`). Views are chosen greedily by what they
add to the best view of each group so far, and a little for a further side. A candidate is rendered only while the
bound from projected boxes says that it may be the best; `choose_all_rendered` renders every candidate and is the
readable reference for the same choice.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..errors import UserError
from ..scene import Scene
from .free_space import FreeSpace
from .view_candidates import Kind, View, candidate_views, is_photographed
from .visibility import GroupPixels, silhouettes

F64 = NDArray[np.float64]

WIDTH, HEIGHT = 768, 576  # pixels, of the chosen views
LEGIBLE = 0.015  # share of an image from which a thing is read without effort: 80 pixels squared at 768x576
WHOLE = 0.5  # share of its box's silhouette that a whole, unhidden thing covers
CONTEXT = 0.5  # weight of all other objects together: what surrounds the asked ones
SPREAD = 0.15  # worth of seeing a group again from the opposite side, against seeing it for the first time
ENOUGH = 0.005  # a further view must add this share of what the first gave
MOST_RENDERED = 56  # views of one choice; candidates beyond them are those that can show least
# A capture is sharp where its photographs were taken; seen from outside, its walls are ragged.
TRUST: Mapping[Kind, float] = {"camera": 1.0, "walk-in": 0.95, "close-up": 0.95, "overview": 0.9, "plan": 0.9}
TRUST_IN_CAPTURES: Mapping[Kind, float] = {**TRUST, "overview": 0.5, "plan": 0.5}
TRUST_BESIDE_PHOTOGRAPHS: Mapping[Kind, float] = {
    "camera": 1.0, "walk-in": 0.5, "close-up": 0.5, "overview": 0.3, "plan": 0.3
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class ChosenView:
    """A view and which of the asked groups it shows.

    Attributes:
        view: camera and cut.
        shares: group id to the share of the image's pixels that the group covers after occlusion, in [0, 1], for every
            asked group; 0 where it is hidden or outside.
        readable: group id to how readable it is in this view, in [0, 1]: 1 is large and whole.
    """

    view: View
    shares: Mapping[int, float]
    readable: Mapping[int, float]

    @property
    def shows(self) -> tuple[int, ...]:
        """The asked groups that are visible, most readable first."""
        seen = [g for g, share in self.shares.items() if share > 0]
        return tuple(sorted(seen, key=lambda g: -self.readable[g]))


@dataclass(frozen=True, eq=False)
class Sights:
    """A scene prepared for choosing views; kept over the questions about one scene.

    Attributes:
        scene: with its language field and a known frame.
        space: where a camera can stand.
    """

    scene: Scene
    space: FreeSpace = field(repr=False)

    @classmethod
    def of(cls, scene: Scene) -> Sights:
        """Prepares a scene.

        Raises:
            UserError: it has no language field.
        """
        if scene.language is None:
            raise UserError("the scene has no language field yet; run `scenewright embed` on it first")
        return cls(scene, FreeSpace.of(scene.cloud, scene.frame))

    def asked(self, groups: Sequence[int]) -> tuple[int, ...]:
        """The groups without repetitions; all present objects if there are none.

        Raises:
            UserError: the scene has no such group, or it is empty.
        """
        assert self.scene.language is not None
        table = self.scene.language.groups
        for g in groups:
            if not 0 <= g < len(table):
                raise UserError(f"the scene has no group {g}; its groups are 0 to {len(table) - 1}")
            if not table[g].count:
                raise UserError(f"group {g} was deleted; nothing of it can be shown")
        return tuple(dict.fromkeys(groups)) or tuple(g.id for g in self.scene.language.objects() if g.count)


Choose = Callable[..., tuple[ChosenView, ...]]  # (sights, groups, count, size=..., seed=...)


def choose(
    sights: Sights, groups: Sequence[int], count: int, size: tuple[int, int] = (WIDTH, HEIGHT), seed: int = 0
) -> tuple[ChosenView, ...]:
    """At most `count` views that together show `groups`, the most useful first; fewer if more would add nothing.

    Args:
        groups: ids in the scene's field; empty asks for the whole scene.
        size: width and height of the views, pixels.
        seed: not used; `choose_random` has the same signature.

    Raises:
        UserError: the scene has no such group.
    """
    return _greedy(_Candidates(sights, groups, size, MOST_RENDERED), count)


def choose_all_rendered(
    sights: Sights, groups: Sequence[int], count: int, size: tuple[int, int] = (WIDTH, HEIGHT), seed: int = 0
) -> tuple[ChosenView, ...]:
    """The reference of `choose`: every candidate is rendered, and each step takes the one that adds most."""
    pool = _Candidates(sights, groups, size, None)
    for i in range(len(pool)):
        pool.render(i)
    best, chosen = np.zeros(len(pool.groups)), list[int]()
    while len(chosen) < count:
        gains = [pool.gain(i, best, chosen) if i not in chosen else -1.0 for i in range(len(pool))]
        if not gains or not _enough(max(gains), pool, chosen):
            break
        chosen.append(int(np.argmax(gains)))
        best = np.maximum(best, pool.worth[chosen[-1]])
    return tuple(pool.chosen(i) for i in chosen)


def choose_uniform(
    sights: Sights, groups: Sequence[int], count: int, size: tuple[int, int] = (WIDTH, HEIGHT), seed: int = 0
) -> tuple[ChosenView, ...]:
    """Views spread evenly over the candidates that do not depend on the question: own cameras, else walk-ins and
    overviews in turn. For comparison."""
    pool = _Candidates(sights, groups, size, None, whole=True)
    own = [i for i, view in enumerate(pool.views) if view.kind == "camera"]
    places = own if len(own) >= count else list(range(len(pool)))
    taken = [places[int(i)] for i in np.linspace(0, len(places) - 1, min(count, len(places))).round()] if places else []
    return _rendered(pool, dict.fromkeys(taken))


def choose_random(
    sights: Sights, groups: Sequence[int], count: int, size: tuple[int, int] = (WIDTH, HEIGHT), seed: int = 0
) -> tuple[ChosenView, ...]:
    """Views drawn from the same candidates as `choose_uniform`, by a seed. For comparison."""
    pool = _Candidates(sights, groups, size, None, whole=True)
    taken = np.random.default_rng(seed).permutation(len(pool))[:count]
    return _rendered(pool, dict.fromkeys(int(i) for i in taken))


def measured(sights: Sights, view: View, groups: Sequence[int]) -> ChosenView:
    """Which of `groups` a given view shows, and how much."""
    pool = _Candidates(sights, groups, (view.camera.width, view.camera.height), None, views=[view])
    pool.render(0)
    return pool.chosen(0)


class _Candidates:
    """The candidates of one choice, what each can show at most, and what it shows once it is rendered.

    The groups are the asked ones, then all other objects, which give a view its context.
    """

    def __init__(
        self, sights: Sights, groups: Sequence[int], size: tuple[int, int], most: int | None, *,
        whole: bool = False, views: list[View] | None = None,
    ) -> None:  # fmt: skip
        field = sights.scene.language
        assert field is not None
        asked = sights.asked(groups)
        others = [g.id for g in field.objects() if g.count and g.id not in set(asked)]
        parts = {p for g in asked for p in field.leaves(g)} | {field.groups[g].parent for g in asked}
        others = [g for g in others if g not in parts]
        self.asked, self.groups = len(asked), [*asked, *others]
        weights = [np.full(len(asked), 1 / len(asked)) if asked else np.zeros(0)]
        weights.append(np.full(len(others), CONTEXT / len(others)) if others else np.zeros(0))
        self.weights = np.concatenate(weights)
        boxes = [field.groups[g].box for g in self.groups]
        self.centers = np.array([b.center for b in boxes]).reshape(-1, 3)
        for_these = () if whole or not groups else asked
        self.views = views if views is not None else candidate_views(sights.scene, for_these, size, sights.space)
        bounds = [silhouettes(view.camera, boxes) for view in self.views]
        shape = (len(self.views), len(self.groups))
        self._whole = np.array([b[0] for b in bounds]).reshape(shape)
        self._within = np.array([b[1] for b in bounds]).reshape(shape)
        trust = _trust(sights.scene)
        self._trust = np.array([trust[view.kind] for view in self.views])
        # [V, G]: an upper bound until the view is rendered, then what it shows
        self.worth = readability(self._within, self._whole) * self._trust[:, None]
        self.shares = np.zeros(shape)
        self.is_rendered = np.zeros(len(self.views), bool)
        self._left = most if most is not None else len(self.views)
        self._pixels = GroupPixels(sights.scene, self.groups)

    def __len__(self) -> int:
        return len(self.views)

    def render(self, i: int) -> bool:
        """Count what view `i` shows; False if the budget of renders is spent, and the view then counts as empty."""
        if self.is_rendered[i]:
            return True
        self.is_rendered[i] = True
        if self._left <= 0:
            self.worth[i] = 0.0
            return False
        self._left -= 1
        self.shares[i] = self._pixels.shares(self.views[i].camera, self.views[i].cut)
        counted = np.minimum(self.shares[i], self._within[i])
        self.worth[i] = readability(counted, self._whole[i]) * self._trust[i]
        return True

    def gain(self, i: int, best: F64, chosen: Sequence[int]) -> float:
        """What view `i` adds to the chosen ones; grows with its worth for every group."""
        more = np.maximum(0.0, self.worth[i] - best)
        if chosen:
            more = more + SPREAD * self.worth[i] * self._novelty(i, chosen)
        return float(more @ self.weights)

    def _novelty(self, i: int, chosen: Sequence[int]) -> F64:
        """`[G]` in [0, 1]: how far view `i` sees each group from another side than every chosen view."""
        ways = self.centers - self.views[i].camera.position
        ways = ways / np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 1e-9)
        least = np.ones(len(ways))
        for j in chosen:
            other = self.centers - self.views[j].camera.position
            other = other / np.maximum(np.linalg.norm(other, axis=1, keepdims=True), 1e-9)
            least = np.minimum(least, (1 - (ways * other).sum(axis=1)) / 2)
        return least

    def chosen(self, i: int) -> ChosenView:
        """View `i` as a result, for the asked groups."""
        asked = self.groups[: self.asked]
        shares, readable = self.shares[i].tolist(), (self.worth[i] / self._trust[i]).tolist()
        return ChosenView(
            self.views[i], dict(zip(asked, shares, strict=False)), dict(zip(asked, readable, strict=False))
        )


def readability(shares: F64, whole: F64) -> F64:
    """How readable things are, in [0, 1], from the share of the image that they cover and that of their silhouette.

    It grows with the root of the covered share until `LEGIBLE`; what is half hidden or cut off loses up to half.
    """
    size = np.sqrt(np.minimum(1.0, shares / LEGIBLE))
    complete = np.minimum(1.0, shares / np.maximum(WHOLE * whole, 1e-12))
    return np.asarray(size * (0.5 + 0.5 * complete))


def _trust(scene: Scene) -> Mapping[Kind, float]:
    """How far views of each kind are trusted to look like the scene, in [0, 1]."""
    if is_photographed(scene):
        return TRUST_BESIDE_PHOTOGRAPHS
    return TRUST_IN_CAPTURES if scene.frame.up_source == "estimated" else TRUST


def _greedy(pool: _Candidates, count: int) -> tuple[ChosenView, ...]:
    """The choice of `choose_all_rendered` with fewer renders: a view is rendered when its bound is the largest."""
    best, chosen = np.zeros(len(pool.groups)), list[int]()
    while len(chosen) < count and len(pool):
        gains = np.array([pool.gain(i, best, chosen) if i not in chosen else -1.0 for i in range(len(pool))])
        while not pool.is_rendered[top := int(np.argmax(gains))]:
            pool.render(top)
            gains[top] = pool.gain(top, best, chosen)
        if not _enough(gains[top], pool, chosen):
            break
        chosen.append(top)
        best = np.maximum(best, pool.worth[top])
    return tuple(pool.chosen(i) for i in chosen)


def _enough(gain: float, pool: _Candidates, chosen: Sequence[int]) -> bool:
    """Whether a view is worth adding: the first if it shows anything, further ones by what they add."""
    if not chosen:
        return gain > 0
    first = float(pool.worth[chosen[0]] @ pool.weights)
    return gain >= ENOUGH * first


def _rendered(pool: _Candidates, places: Mapping[int, None]) -> tuple[ChosenView, ...]:
    for i in places:
        pool.render(i)
    return tuple(pool.chosen(i) for i in places)
