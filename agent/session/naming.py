"""Names for all things of a scene by a vision model, from a few pictures with numbered marks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...gaussians.language.field.naming import with_names
from ...gaussians.scene import Scene
from ..terminal.thing_names import NAME_THRESHOLD

if TYPE_CHECKING:
    from ...gaussians.camera import Camera
    from ...planners.vision.captions import Captions
    from .vision_client import VisionClient


@dataclass(frozen=True, eq=False)
class Named:
    """What a vision model calls the things of a scene.

    Attributes:
        scene: the scene whose field keeps the new names.
        captions: what the model said.
        names: the new names, by group.
        kept: of groups with a sure name that the model calls otherwise: that name and the model's.
    """

    scene: Scene
    captions: Captions
    names: dict[int, str]
    kept: dict[int, tuple[str, str]]

    def to_json(self) -> dict[str, Any]:
        """Plain data for `--json`."""
        captions = self.captions
        return {
            "scene": captions.scene,
            "named": [{"group": g, "name": n, "caption": captions.groups[g].text} for g, n in self.names.items()],
            "kept": [{"group": g, "name": own, "model": other} for g, (own, other) in self.kept.items()],
            "pictures": captions.pictures,
            "stopped": captions.stopped,
            "usage": captions.usage.model_dump(mode="json") if captions.usage else None,
        }


def name_all(scene: Scene, viewer: Camera, vision: VisionClient, *, overwrite: bool = False) -> Named:
    """Name the things of an embedded scene; a name that is sure stays unless `overwrite` is set.

    Raises:
        BackendError: the model cannot be asked, or gave no usable reply.
    """
    from ...planners.rooms.graph import SceneGraph
    from ...planners.vision.captions import captions
    from ...planners.vision.facts import Facts
    from .looker import SceneLooker

    assert scene.language is not None
    things = {g.id: g for g in scene.language.objects() if g.count}
    largest = sorted(things, key=lambda i: (-max(things[i].box.size), i))
    said = captions(largest, Facts(SceneGraph.from_scene(scene, viewer)), SceneLooker(scene, viewer), vision.backend,
                    vision.purse(max(12, len(largest) // 2)))  # fmt: skip
    names: dict[int, str] = {}
    kept: dict[int, tuple[str, str]] = {}
    for group, caption in said.groups.items():
        own = things[group]
        sure = own.label and own.label_score >= NAME_THRESHOLD
        if caption.name and (overwrite or not sure):
            names[group] = caption.name
        elif caption.name and caption.name != own.label:
            kept[group] = (own.label, caption.name)
    return Named(with_names(scene, names, "caption"), said, names, kept)
