"""Place things in a generated room without collisions: on the floor, against walls, on walls, on other things.

`recipes` defines which furniture belongs in which kind of room.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...world.box import YawBox, meet
from ..modeling.make import Asset

Array = NDArray[np.float64]
GAP = 0.035  # metres between neighbours, and between a back and a wall (skirting boards)
TOUCHING = 1e-4  # metres by which two boxes may penetrate each other
HANG = 0.015  # metres between a picture's back and the wall


@dataclass(frozen=True, eq=False)
class Placed:
    """An asset in the room. `support` is the index of what carries it, or "floor", "wall", "ceiling"."""

    asset: Asset
    box: YawBox
    support: int | str


@dataclass
class Layout:
    """A room being furnished: origin at the centre of the floor, z up. Walls by name; north is +y.

    Attributes:
        w, d, h: inner size, metres.
        walls: which of "north", "west", "east", "south" exist.
        rng: the only source of randomness.
        things: placed so far.
        kept_free: boxes that nothing may enter (the floor before doors).
    """

    w: float
    d: float
    h: float
    walls: tuple[str, ...]
    rng: np.random.Generator
    things: list[Placed] = field(default_factory=list)
    kept_free: list[YawBox] = field(default_factory=list)

    def free(self, box: YawBox, on_wall: bool = False, ignore: tuple[int, ...] = ()) -> bool:
        """Whether a box lies inside the room and meets no other thing; unless `on_wall`, also no box of `kept_free`."""
        c = box.corners()
        if np.abs(c[:, 0]).max() > self.w / 2 + 1e-6 or np.abs(c[:, 1]).max() > self.d / 2 + 1e-6 or box.high > self.h:
            return False
        if any(meet(box, t.box, TOUCHING) for i, t in enumerate(self.things) if i not in ignore):
            return False
        return on_wall or not any(meet(box, k, TOUCHING) for k in self.kept_free)

    def put(self, asset: Asset, box: YawBox, support: int | str) -> int:
        """Add a thing without a test of its place; returns its index."""
        self.things.append(Placed(asset, box, support))
        return len(self.things) - 1

    def try_put(self, asset: Asset, x: float, y: float, yaw: float, margin: float = 0.0) -> int | None:
        """Put it on the floor, or on a rug that lies wholly under it, if that place is free; its index, else None."""
        w, d, h = asset.size
        box = YawBox(x, y, 0.0, w, d, h, yaw)
        support: int | str = "floor"
        for i, t in enumerate(self.things):
            if t.asset.kind != "rug" or not meet(box._replace(h=0.01), t.box, 0.0):
                continue
            local = (box.corners() - np.array([t.box.x, t.box.y])) @ t.box.axes.T
            reach = np.array([t.box.w, t.box.d]) / 2
            inside = (np.abs(local) <= reach).all() and ((local / reach) ** 2).sum(axis=1).max() <= 1.9
            if not inside:
                return None
            box, support = box._replace(low=t.box.h), i
        ignore = (support,) if isinstance(support, int) else ()
        return self.put(asset, box, support) if self.free(box.grown(margin), ignore=ignore) else None

    def against(
        self, asset: Asset, walls: tuple[str, ...] | None = None, at: float | None = None, front: float = 0.45
    ) -> int | None:
        """Put its back to a wall, at the fraction `at` of the wall's length or anywhere, `front` metres free before."""
        w, d, _ = asset.size
        names = [n for n in (walls or self.walls) if n in self.walls]
        for k in range(16):
            if not names:
                return None
            wall = names[int(self.rng.integers(len(names)))]
            along = self.w if wall in ("north", "south") else self.d
            room = (along - w) / 2 - GAP
            if room < 0:
                continue
            t = (at - 0.5) * along if at is not None and k < 3 else self.rng.uniform(-room, room)
            if at is None and self.rng.random() < 0.35:
                t = room * (1 if self.rng.random() < 0.5 else -1)
            t = float(np.clip(t, -room, room))
            x, y, yaw = self.spot(wall, t, d / 2 + GAP)
            keep = YawBox(*self.spot(wall, t, d + GAP + front / 2)[:2], 0.02, w * 0.9, front, 0.3, yaw)
            if front > 0 and not self.free(keep, on_wall=True, ignore=tuple(self.rugs())):
                continue
            if (index := self.try_put(asset, x, y, yaw)) is not None:
                return index
        return None

    def rugs(self) -> list[int]:
        """Indices of rugs."""
        return [i for i, t in enumerate(self.things) if t.asset.kind == "rug"]

    def spot(self, wall: str, along: float, out: float) -> tuple[float, float, float]:
        """Position `along` a wall from its middle (rightwards as one looks at it), `out` of it; the yaw facing in."""
        if wall == "north":
            return along, self.d / 2 - out, 0.0
        if wall == "south":
            return -along, -self.d / 2 + out, 180.0
        if wall == "west":
            return -self.w / 2 + out, along, 90.0
        return self.w / 2 - out, -along, -90.0

    def hang(self, asset: Asset, wall: str, along: float, low: float, flush: bool = False) -> int | None:
        """Hang it on a wall with its lower edge at height `low`; `flush` for things that are set into the wall."""
        w, d, h = asset.size
        reach = (self.w if wall in ("north", "south") else self.d) / 2 - w / 2 - 0.03
        if reach < 0 or abs(along) > reach or low + h > self.h - 0.03:
            return None
        x, y, yaw = self.spot(wall, along, d / 2 + (0.002 if flush else HANG))
        box = YawBox(x, y, low, w, d, h, yaw)
        return self.put(asset, box, "wall") if self.free(box, on_wall=True) else None

    def near(
        self, asset: Asset, anchor: int, right: float, back: float, turn: float = 0.0, margin: float = 0.0
    ) -> int | None:
        """Put it at an offset along the anchor's own axes, turned by `turn` degrees relative to the anchor."""
        box = self.things[anchor].box
        x, y = box.world(right, back)
        return self.try_put(asset, x, y, box.yaw + turn, margin)

    def anywhere(self, asset: Asset, margin: float = 0.3, edge: bool = True) -> int | None:
        """Put it on a random free spot of the floor, near the walls if `edge`, with `margin` metres around."""
        w, d, _ = asset.size
        reach = math.hypot(w, d) / 2 + 0.03
        for _ in range(30):
            x, y = self.rng.uniform(-1, 1, 2) * (self.w / 2 - reach, self.d / 2 - reach)
            if edge and max(abs(x) / (self.w / 2), abs(y) / (self.d / 2)) < 0.6:
                continue
            yaw = float(self.rng.uniform(-180, 180))
            if (index := self.try_put(asset, float(x), float(y), yaw, margin)) is not None:
                return index
        return None

    def corner(self, asset: Asset) -> int | None:
        """Put it in a corner of the room."""
        w, d, _ = asset.size
        for k in self.rng.permutation(4):
            sx, sy = (-1, 1)[k % 2], (-1, 1)[k // 2]
            yaw = 0.0 if sy > 0 else 180.0
            x, y = sx * (self.w / 2 - w / 2 - GAP), sy * (self.d / 2 - d / 2 - GAP)
            if (index := self.try_put(asset, x, y, yaw)) is not None:
                return index
        return None

    def on_top(
        self, asset: Asset, anchor: int, right: float | None = None, back: float | None = None, turn: float = 0.0
    ) -> int | None:
        """Put it on the anchor's upper face, at an offset along its axes or anywhere; all of it must be supported."""
        base = self.things[anchor].box
        w, d, h = asset.size
        turned = math.radians(turn)
        rw = abs(w * math.cos(turned)) + abs(d * math.sin(turned))
        rd = abs(d * math.cos(turned)) + abs(w * math.sin(turned))
        room = np.array([base.w - rw, base.d - rd]) / 2 - 0.01
        if (room < 0).any():
            return None
        for _ in range(1 if right is not None else 14):
            r = right if right is not None else float(self.rng.uniform(-room[0], room[0]))
            b = back if back is not None else float(self.rng.uniform(-room[1], room[1]))
            if abs(r) > room[0] or abs(b) > room[1]:
                continue
            level = rest_height(self.things[anchor].asset, r, b, rw, rd)
            if level is None:
                continue
            x, y = base.world(r, b)
            box = YawBox(x, y, base.low + level, w, d, h, base.yaw + turn)
            if self.free(box.grown(0.008), on_wall=True, ignore=(anchor,)):
                return self.put(asset, box, anchor)
        return None


def rest_height(asset: Asset, x: float, y: float, w: float, d: float) -> float | None:
    """Height of the asset's surface under a w x d footprint at (x, y) in its frame, None if that is not flat.

    The nine points of a 3 x 3 grid over the footprint must each have a Gaussian of the upper face nearby.
    """
    means = asset.cloud.means.numpy()
    pad = 0.02
    above = (np.abs(means[:, 0] - x) < w / 2 + pad) & (np.abs(means[:, 1] - y) < d / 2 + pad)
    if not above.any():
        return None
    top = float(means[above, 2].max())
    face = means[above & (means[:, 2] > top - 0.006)][:, :2]
    grid = np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1]), axis=-1).reshape(-1, 2) * np.array([w, d]) * 0.46 + np.array(
        [x, y]
    )
    gap = np.linalg.norm(grid[:, None] - face[None], axis=2).min(axis=1)
    reach = 0.75 * float(asset.cloud.scales[:, :2].max()) / 0.6
    return top if gap.max() < max(reach, 0.03) else None
