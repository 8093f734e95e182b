"""Contact shadows through time: what goes takes its shadow along when it sets out, and casts one when it arrives."""

from __future__ import annotations

import numpy as np
import pytest

from scenewright.agent.session.session import Session
from scenewright.gaussians.motion.at import at
from scenewright.gaussians.motion.motion import moving_ids
from scenewright.gaussians.scene import Scene
from scenewright.planners.rooms.build import construct
from scenewright.planners.rooms.graph import SceneGraph


@pytest.fixture
def session() -> Session:
    """A box in a room, on the floor, with its shadow."""
    box = {"id": 1, "label": "box", "size": (0.4, 0.4, 0.4), "position": (-0.8, 0.0, 0.2), "support": "floor"}
    sofa = {"id": 2, "label": "sofa", "size": (1.8, 0.9, 0.8), "position": (0.9, -1.0, 0.4), "support": "floor"}
    graph = SceneGraph.model_validate({"room": {"size": (4.0, 3.6, 2.6)}, "nodes": [box, sofa]})
    return Session(construct(graph, seed=0, detail=0.4).scene, accept_unconfirmed=True)


def brighter(before: Scene, after: Scene, time: float) -> tuple[np.ndarray, np.ndarray]:
    """`[m, 3]` where Gaussians of what stands still are lighter at a time than before, and where they are darker."""
    now = at(after, time).cloud
    was = before.cloud
    own = np.isin(was.ids.numpy(), now.ids.numpy()) & ~np.isin(was.ids.numpy(), moving_ids(after.motion))
    rows = np.searchsorted(now.ids.numpy(), was.ids.numpy()[own])
    step = (now.sh[rows, 0].mean(dim=1) - was.sh[own][:, 0].mean(dim=1)).numpy()
    means = was.means[own].numpy()
    return means[step > 1e-4], means[step < -1e-4]


def test_a_shadow_is_there_when_its_thing_arrives(session: Session) -> None:
    before = session.scene
    session.do("move the box 80 cm to the right from 1 to 3 s")
    for time, left, cast in ((0.9, False, False), (1.1, True, False), (2.9, True, False), (3.0, True, True)):
        lighter, darker = brighter(before, session.scene, time)
        assert (len(lighter) > 20, len(darker) > 20) == (left, cast), time
    lighter, darker = brighter(before, session.scene, 3.0)
    assert np.linalg.norm(lighter.mean(axis=0) - darker.mean(axis=0)) > 0.5


def test_what_is_hidden_takes_its_shadow_along(session: Session) -> None:
    before = session.scene
    done = session.do("hide the box from 1 to 2 s")
    assert "took its contact shadow off" in "; ".join(done.sentences())
    for time, left in ((0.9, False), (1.5, True), (2.1, False)):
        assert (len(brighter(before, session.scene, time)[0]) > 20) == left, time
