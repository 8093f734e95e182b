"""What planners may look at: the graph and the picture of a scene, and a written scene graph as an `Observation`."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ...gaussians.errors import ScenewrightError, UserError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...gaussians.camera import Camera
    from ...gaussians.language.query.query import Query
    from ...gaussians.language.query.selection import Selection
    from ...gaussians.scene import Scene
    from ...planners.plan import Movement
    from ...planners.rooms.graph import SceneGraph
    from ...planners.rooms.graph_scene import Stage
    from ...tools.operation import Context
    from ...tools.registry import AnyOp

_FEW = 12  # keys of a way that somebody wrote, and that was not fitted to a film
WIDTH = 768  # pixels, of the picture sent to a model: vision models scale down much larger pictures


def graph_of(scene: Scene, viewer: Camera) -> SceneGraph:
    """The scene graph of an embedded scene with the viewer in it; ids are group ids, as in `Query.groups`.

    Raises:
        UserError: the scene is larger than a graph may be.
    """
    from pydantic import ValidationError

    from ...planners.rooms.graph import SceneGraph

    try:
        return SceneGraph.from_scene(scene, viewer)
    except ValidationError as error:
        raise UserError(
            "planners cannot look at this scene: it is larger than any graph (100 km); give its scale with "
            "--metres-per-unit"
        ) from error


def any_moves(scene: Scene, selection: Selection) -> bool | None:
    """Whether any Gaussian of a selection moves at some time; None if nothing was found."""
    from ...gaussians.motion.motion import moving_ids

    if not selection.chosen:
        return None
    return bool(np.isin(moving_ids(scene.motion), selection.ids.cpu().numpy()).any())


def movement_of(scene: Scene, selection: Selection) -> Movement | None:
    """How the Gaussians of a selection move; None if they stand still, or if nothing was found."""
    from ...planners.plan import Movement
    from ...tools.ops.pace import is_turning
    from ...tools.timing.retiming import divided, extent, spells, whole

    if scene.motion is None or not selection.chosen:
        return None
    tracks, inside = divided(scene.motion, selection.ids.cpu().numpy())
    own = [track for track, belongs in zip(tracks, inside, strict=True) if belongs]
    times = spells(own, scene.motion.start, scene.motion.stop)
    if (span := whole(times)) is None:
        return None
    radians, units = extent(own, span, scene.frame.up_vector)
    metres = units * (scene.frame.metres_per_unit or 1.0)
    turning = all(is_turning(track) for track in own)
    edges = sorted({float(time) for track in own if len(track.times) <= _FEW for time in track.times})
    return Movement(*span, turning, scene.motion.stop, math.degrees(radians), metres, tuple(edges), tuple(times))


def at_rest(scene: Scene) -> Movement:
    """How something moves that stands still in a scene with motion."""
    from ...planners.plan import Movement

    assert scene.motion is not None
    return Movement(0.0, 0.0, False, scene.motion.stop)


def paced(scene: Scene, ops: Sequence[AnyOp], context: Context) -> Scene | None:
    """The scene after operations that change when and how fast things move, without any check; None if one of them does
    something else, or cannot be carried out."""
    from ...tools.ops.pace import Pace
    from ...tools.timing.spans import moving_one

    for op in ops:
        if not isinstance(op, Pace):
            return None
        try:
            chosen = moving_one(scene, op.target, context, moves=True)
            scene = op.apply(scene, chosen, context).scene
        except ScenewrightError:
            return None
        context = replace(context, last=chosen)
    return scene


def picture_of(scene: Scene, camera: Camera) -> bytes:
    """A camera's view as PNG, at most `WIDTH` pixels wide."""
    from ...gaussians.viewpoints.coverage import fit_camera
    from ..pictures.image_files import encoded_png
    from ..pictures.scene_pictures import picture

    if camera.width > WIDTH:
        camera = fit_camera(camera, WIDTH, max(round(camera.height * WIDTH / camera.width), 1))
    return encoded_png(picture(scene, camera))


class GraphObservation:
    """A written scene graph as an `Observation`, with its ids replaced by the rows of its stage.

    A written graph may have an id such as "kettle"; a query names groups by number, and on a stage these are the rows
    (`Stage.ids[row]` is the graph's own id). Planners therefore see row numbers, and `Stage.names` maps the chosen rows
    back to ids.
    """

    def __init__(self, stage: Stage) -> None:
        self._stage = stage

    def graph(self) -> SceneGraph:
        """The graph with the row of each node as its id, in supports and relations too."""
        graph = self._stage.graph
        row = {node.id: i for i, node in enumerate(graph.nodes)}
        nodes = tuple(
            n.model_copy(update={"id": row[n.id], "support": row.get(n.support, n.support)}) for n in graph.nodes
        )
        relations = tuple((row[a], name, row[b]) for a, name, b in graph.relations)
        return graph.model_copy(update={"nodes": nodes, "relations": relations})

    def picture(self) -> None:
        """None: a written graph has no pixels."""
        return None

    def moves(self, query: Query) -> None:
        """None: a written graph does not tell what moves."""
        return None

    def movement(self, query: Query) -> None:
        """None: a written graph does not tell how something moves."""
        return None

    def after(self, ops: Sequence[AnyOp], query: Query) -> None:
        """None: a written graph does not tell how something moves."""
        return None

    def has(self, query: Query) -> bool:
        """No: it is not asked of a written graph, which has no motion."""
        return False

    def lacks(self, query: Query) -> bool:
        """No: it is not asked of a written graph, which has no motion."""
        return False
