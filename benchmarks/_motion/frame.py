"""What a frame at a time costs beside a frame of the same scene standing still, 200,000 Gaussians at 512 x 512."""

from __future__ import annotations

import time
from collections.abc import Callable
from statistics import median

import numpy as np

from ...gaussians.camera import Camera
from ...gaussians.motion.at import cloud_at
from ...gaussians.motion.motion import Motion, Track
from ...gaussians.render import render
from ...gaussians.scene import Scene
from ...gaussians.viewpoints.coverage import choose_views
from ..files import glossy
from ..harness import Metric
from .rooms import moving_room

GAUSSIANS = 200_000
SIDE = 512  # pixels
GOAL = 1.3
ROUNDS, QUICK_ROUNDS = 15, 3
SHARES = {"a tenth of it": 0.1, "half of it": 0.5}  # of the glossy cloud that turn


def measured(quick: bool) -> list[Metric]:
    """Ratio of a frame at a new time to a static one: a room with a fan, and a cloud of degree 3 of which a part turns.

    Both are drawn in turns, so that what else the machine does meets them alike; a ratio is that of the medians.
    """
    count = GAUSSIANS // 10 if quick else GAUSSIANS
    room = moving_room("fan")
    scenes = {
        "fan": moving_room("fan", count / len(room.cloud)),
        **{name: _turning(count, share) for name, share in SHARES.items()},
    }
    metrics: list[Metric] = []
    for name, scene in scenes.items():
        metrics += _case(name, scene, QUICK_ROUNDS if quick else ROUNDS)
    return metrics


def _turning(count: int, share: float) -> Scene:
    """A cloud with view-dependent colours of which the first rows turn about their middle."""
    cloud = glossy(count)
    ids = np.arange(int(share * count))
    middle = cloud.means[: len(ids)].double().mean(dim=0).numpy()
    turning = Track.hinge(ids, [0, 5], [0, 2.0], (0, 0, 1), middle)
    return Scene(cloud, motion=Motion((turning,), stop=5.0))


def _case(name: str, scene: Scene, rounds: int) -> list[Metric]:
    assert scene.motion is not None
    still = scene.replace(motion=None)
    camera: Camera = choose_views(still, 1).cameras[0].resized(SIDE, SIDE)
    times = np.linspace(scene.motion.start, scene.motion.stop, rounds + 2)[1:-1]
    render(still.cloud, camera)
    render(cloud_at(scene, float(times[0])), camera)
    spent: dict[str, list[float]] = {"static": [], "moving": [], "at": []}
    for moment in times:
        spent["static"].append(_seconds(lambda: render(still.cloud, camera)))
        spent["moving"].append(_seconds(lambda t=moment: render(cloud_at(scene, float(t)), camera)))  # type: ignore[misc]
        spent["at"].append(_seconds(lambda t=moment: cloud_at(scene, float(t))))  # type: ignore[misc]
    static, moving, alone = (median(spent[key]) for key in ("static", "moving", "at"))
    key = f"frame.{name}"
    return [
        Metric(f"{key}.ratio to static", moving / static, "x", "lower", 0.1, goal=GOAL),
        Metric(f"{key}.static", static * 1000, "ms", "lower", 0.3),
        Metric(f"{key}.at a time", moving * 1000, "ms", "lower", 0.3),
        Metric(f"{key}.scene at a time", alone * 1000, "ms", "lower", 0.3),
        Metric(f"{key}.gaussians", len(scene.cloud), "count"),
    ]


def _seconds(work: Callable[[], object]) -> float:
    started = time.perf_counter()
    work()
    return time.perf_counter() - started
