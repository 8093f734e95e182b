"""What planners may look at: the session's scene, or a written graph, each part made only when somebody looks.

Knows how a scene becomes a graph and a picture. Refuses to know who looks, and what for.
"""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

from ...gaussians.errors import UserError

if TYPE_CHECKING:
    from ...planners.rooms.graph import SceneGraph
    from ...planners.rooms.graph_scene import Stage
    from .session import Session

WIDTH = 768  # pixels of the picture that a model sees: vision models scale down what is much larger


class SessionSight:
    """The scene of a session as it stands. Looking at the graph embeds the scene, as a query would."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def graph(self) -> SceneGraph:
        """What stands where, and where the viewer stands; ids are groups, as `Query.groups` names them.

        Raises:
            ScenewrightError: the scene could not be embedded.
            UserError: it is larger than a graph may be.
        """
        from pydantic import ValidationError

        from ...planners.rooms.graph import SceneGraph

        scene = self._session.embed()
        try:
            return SceneGraph.from_scene(scene, self._session.viewer)
        except ValidationError as error:
            raise UserError(
                "planners cannot look at this scene: it is larger than any graph (100 km); give its scale with "
                "--metres-per-unit"
            ) from error

    def picture(self) -> bytes:
        """The viewer's view as PNG, at most `WIDTH` pixels wide."""
        import numpy as np
        from PIL import Image

        from ...gaussians.viewpoints.coverage import fit_camera
        from ..pictures.scene_pictures import picture

        camera = self._session.viewer
        if camera.width > WIDTH:
            camera = fit_camera(camera, WIDTH, max(round(camera.height * WIDTH / camera.width), 1))
        drawn = io.BytesIO()
        Image.fromarray(np.ascontiguousarray(picture(self._session.scene, camera))).save(drawn, format="PNG")
        return drawn.getvalue()


class StageSight:
    """A written graph, with its ids turned into the rows of its stage.

    A graph that somebody wrote may call its nodes "kettle"; a query names groups by number, and on a stage these are
    the rows (`Stage.ids[row]` is the graph's own id). Planners therefore see row numbers, and `Stage.names` turns what
    they chose back.
    """

    def __init__(self, stage: Stage) -> None:
        self._stage = stage

    def graph(self) -> SceneGraph:
        """The graph with node `i` called `i`: in supports and relations too."""
        graph = self._stage.graph
        row = {node.id: i for i, node in enumerate(graph.nodes)}
        nodes = tuple(
            n.model_copy(update={"id": row[n.id], "support": row.get(n.support, n.support)}) for n in graph.nodes
        )
        relations = tuple((row[a], name, row[b]) for a, name, b in graph.relations)
        return graph.model_copy(update={"nodes": nodes, "relations": relations})

    def picture(self) -> None:
        """There are no pixels of a written graph."""
        return None
