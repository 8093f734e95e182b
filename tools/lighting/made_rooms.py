"""Put a room that was built from a description under a named light, as the operation relight does."""

from __future__ import annotations

import torch

from ...gaussians.camera import Camera
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ..operation import Context
from ..ops.relight import Relight
from .moods import MoodName


def in_mood(scene: Scene, mood: MoodName, viewer: Camera) -> Scene:
    """The scene under the light of a mood; only harmonics change.

    The colours in its table stay those of the paint, by which a description names things.

    Args:
        viewer: camera from whose left the light comes where the room has no window.
    """
    everything = Query(text="everything", pick="all")
    chosen = Selection(everything, "found", torch.sort(scene.cloud.ids).values)
    lit = Relight(target=everything, mood=mood).apply(scene, chosen, Context(viewer)).scene
    return scene.replace(cloud=lit.cloud)
