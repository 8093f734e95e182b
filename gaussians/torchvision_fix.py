"""Makes `import torchvision` work beside a CPU build of torch.

The torchvision wheel on PyPI is built against CUDA torch. Beside CPU torch its native library does not load, and its
import fails with `operator torchvision::nms does not exist`. open_clip and most of transformers import it. Only the
two operators that it registers shapes for are missing. They are declared (but not implemented: nothing here detects
boxes) and the import is tried again. A torchvision that works is left alone.
"""

from __future__ import annotations

import importlib
import sys
from types import ModuleType
from typing import Any

from .errors import BackendError

_MISSING = ("nms", "qnms")
_SCHEMA = "(Tensor dets, Tensor scores, float iou_threshold) -> Tensor"
_kept: list[Any] = []  # torch drops the declarations of a Library that is garbage-collected


def import_torchvision() -> ModuleType:
    """The torchvision module, repaired if necessary. Call this before importing open_clip or transformers.

    Raises:
        BackendError: torchvision is not installed, or fails for another reason than the missing operators.
    """
    try:
        return importlib.import_module("torchvision")
    except ModuleNotFoundError as error:
        raise BackendError("torchvision is not installed; run: pip install 'scenewright[models]'") from error
    except RuntimeError as error:
        if "torchvision::" not in str(error):
            raise BackendError(f"torchvision cannot be imported: {error}") from error
    _forget("torchvision")
    declare_operators()
    try:
        return importlib.import_module("torchvision")
    except (RuntimeError, ImportError) as error:
        raise BackendError(
            f"torchvision does not fit the installed torch: {error}; "
            "install both in one command: pip install 'torch>=2.13,<2.14' 'torchvision>=0.28,<0.29'"
        ) from error


def declare_operators() -> tuple[str, ...]:
    """Declare the missing operators; returns the names of those that were missing."""
    import torch

    declared = []
    for name in _MISSING:
        if not hasattr(torch.ops.torchvision, name):
            library: Any = torch.library.Library("torchvision", "FRAGMENT")  # type: ignore[no-untyped-call]
            library.define(f"{name}{_SCHEMA}")
            _kept.append(library)
            declared.append(name)
    return tuple(declared)


def _forget(package: str) -> None:
    """Remove a partly imported package and its modules from `sys.modules`."""
    for name in [m for m in sys.modules if m == package or m.startswith(f"{package}.")]:
        del sys.modules[name]
