"""A toolbox on the small scene of boxes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from scenewright.agent.session.session import Session
from scenewright.agent.toolbox.progress import Progress
from scenewright.agent.toolbox.toolbox import Toolbox
from scenewright.gaussians.scene import Scene


@pytest.fixture
def toolbox(boxes: Scene, encoder: Any, tmp_path: Path) -> Toolbox:
    progress = Progress()
    session = Session(boxes, encoder=encoder, viewer=boxes.cameras[0], progress=progress)
    (tmp_path / "scenes").mkdir(exist_ok=True)
    return Toolbox(session, tmp_path / "scenes", progress=progress)
