"""Scenewright: edit, build and question 3D Gaussian Splatting scenes in plain words.

The public API. Names are imported on first use, so that `import scenewright` and the command line start at once.
`__all__` is the whole promise: what is not in it may change without notice.
"""

from __future__ import annotations

import importlib
import os
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .agent.session.result import Result
    from .agent.session.session import Session
    from .agent.toolbox.toolbox import Toolbox
    from .agent.view.show import show
    from .gaussians.assets import Asset, Room, furnish, kinds, make
    from .gaussians.camera import Camera, Render
    from .gaussians.cloud import GaussianCloud
    from .gaussians.errors import (
        AbsentError,
        AmbiguousError,
        BackendError,
        CheckFailedError,
        FileError,
        InstructionError,
        ScenewrightError,
        UnconfirmedError,
        UserError,
    )
    from .gaussians.language.field.embed import embed
    from .gaussians.language.field.language_field import LanguageField
    from .gaussians.language.field.loading import load
    from .gaussians.language.field.saving import save
    from .gaussians.language.query.query import Query, Relation
    from .gaussians.language.query.selection import Selection
    from .gaussians.meshing import Mesh, mesh
    from .gaussians.motion.at import at
    from .gaussians.motion.motion import Look, Motion, Track
    from .gaussians.render import render
    from .gaussians.scene import Frame, Scene
    from .planners.compose.api import compose
    from .planners.plan import EditPlan
    from .planners.rooms.graph import SceneGraph
    from .tools.operation import EditOp
    from .tools.receipt import Receipt

__version__ = "0.1.0"

# Read once by OpenMP when torch is loaded: idle threads sleep instead of spinning. Spinning ones take the cores from
# our own kernels, and on a busy machine slow torch's small operations by a factor of ten.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")

_HOME = {
    "Session": ".agent.session.session",
    "Result": ".agent.session.result",
    "Toolbox": ".agent.toolbox.toolbox",
    "load": ".gaussians.language.field.loading",
    "save": ".gaussians.language.field.saving",
    "show": ".agent.view.show",
    "render": ".gaussians.render",
    "embed": ".gaussians.language.field.embed",
    "mesh": ".gaussians.meshing",
    "Mesh": ".gaussians.meshing",
    "Motion": ".gaussians.motion.motion",
    "Track": ".gaussians.motion.motion",
    "Look": ".gaussians.motion.motion",
    "at": ".gaussians.motion.at",
    "kinds": ".gaussians.assets",
    "make": ".gaussians.assets",
    "furnish": ".gaussians.assets",
    "Asset": ".gaussians.assets",
    "Room": ".gaussians.assets",
    "Scene": ".gaussians.scene",
    "Frame": ".gaussians.scene",
    "GaussianCloud": ".gaussians.cloud",
    "Camera": ".gaussians.camera",
    "Render": ".gaussians.camera",
    "LanguageField": ".gaussians.language.field.language_field",
    "Query": ".gaussians.language.query.query",
    "Relation": ".gaussians.language.query.query",
    "Selection": ".gaussians.language.query.selection",
    "EditOp": ".tools.operation",
    "Receipt": ".tools.receipt",
    "EditPlan": ".planners.plan",
    "SceneGraph": ".planners.rooms.graph",
    "compose": ".planners.compose.api",
    "ScenewrightError": ".gaussians.errors",
    "UserError": ".gaussians.errors",
    "InstructionError": ".gaussians.errors",
    "AbsentError": ".gaussians.errors",
    "AmbiguousError": ".gaussians.errors",
    "UnconfirmedError": ".gaussians.errors",
    "CheckFailedError": ".gaussians.errors",
    "FileError": ".gaussians.errors",
    "BackendError": ".gaussians.errors",
}

__all__ = [
    "AbsentError",
    "AmbiguousError",
    "Asset",
    "BackendError",
    "Camera",
    "CheckFailedError",
    "EditOp",
    "EditPlan",
    "FileError",
    "Frame",
    "GaussianCloud",
    "InstructionError",
    "LanguageField",
    "Look",
    "Mesh",
    "Motion",
    "Query",
    "Receipt",
    "Relation",
    "Render",
    "Result",
    "Room",
    "Scene",
    "SceneGraph",
    "ScenewrightError",
    "Selection",
    "Session",
    "Toolbox",
    "Track",
    "UnconfirmedError",
    "UserError",
    "at",
    "compose",
    "embed",
    "furnish",
    "kinds",
    "load",
    "make",
    "mesh",
    "render",
    "save",
    "show",
]


def _picture(scene: Scene) -> bytes | None:
    """What a notebook shows of a scene that is the value of a cell."""
    from .agent.view.show import picture

    return picture(scene)


def _show_in_notebook() -> None:
    """Where IPython runs, let it show scenes as pictures. (A scene itself knows nothing of how it is drawn.)"""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is not None:
        shell.display_formatter.formatters["image/png"].for_type_by_name(*_SCENE, _picture)


_SCENE = ("scenewright.gaussians.scene", "Scene")
_show_in_notebook()


def __getattr__(name: str) -> Any:
    home = _HOME.get(name)
    if home is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(importlib.import_module(home, __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
