"""On which side a door hangs: its handle tells, though its frame stands out at both sides."""

from __future__ import annotations

import numpy as np
import pytest

from scenewright.agent.session.session import Session
from scenewright.planners.rooms.build import construct
from scenewright.planners.rooms.graph import SceneGraph


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_door_in_its_frame_hangs_away_from_its_handle(seed: int) -> None:
    door = {"id": 1, "label": "door", "size": (0.85, 0.06, 2.0), "position": (0.3, 1.77, 1.0), "support": "wall"}
    sofa = {"id": 2, "label": "sofa", "size": (1.8, 0.9, 0.8), "position": (-0.9, -1.0, 0.4), "support": "floor"}
    graph = SceneGraph.model_validate({"room": {"size": (4.0, 3.6, 2.6)}, "nodes": [door, sofa]})
    session = Session(construct(graph, seed=seed, detail=0.5).scene, accept_unconfirmed=True)
    ids = session.select("the door").ids
    before = session.scene.cloud.means.numpy()
    done = session.do("open the door")
    assert "its handle is at the other side" in "; ".join(done.sentences())
    moved = np.linalg.norm(session.scene.cloud.means.numpy() - before, axis=1)
    own = np.isin(session.scene.cloud.ids.numpy(), ids.numpy())
    means, far = before[own], moved[own]
    out = means[:, 1] - np.median(means[:, 1])
    within = (np.abs(means[:, 0] - 0.3) < 0.34) & (np.abs(means[:, 2] - 1.0) < 0.4)
    knob = within & (out < np.quantile(out[within], 0.25) - 0.015)
    assert far[knob].mean() > 1.3 * far[within].mean()  # the hinge is at the other side
