"""Things that the library does not draw, made from their names by a model or a program: `--assets dream:SPEC`."""

from __future__ import annotations

from dataclasses import dataclass

import torch

from ...gaussians.assets.modeling import imported
from ...gaussians.assets.modeling.make import Asset
from ...gaussians.camera import Vec3
from ...gaussians.color import Rgb, name_of, rgb_to_lab
from ...gaussians.dream.generating import Generator
from ...gaussians.errors import BackendError
from ...gaussians.world import kinds
from .asset_folder import FolderAsset

TALLER = 2.0  # times the height of its place, which a thing may have that is dreamt


@dataclass(frozen=True)
class DreamtAssets:
    """What the library has is left to it: a thing that is made takes minutes, and is kept for the next time."""

    generator: Generator

    def natural(self, name: str, color: str | None) -> tuple[Asset | None, tuple[str, ...]]:
        """The asset called `name` in its own proportions, metres, None if the library draws it; and notes.

        Raises:
            BackendError: it cannot be made.
        """
        if _drawn(name):
            return None, ()
        path = self.generator.path(_prompt(name, color))
        size = imported.natural_size(path)
        return imported.read(path, size, name), (f"{name}: made by {self.generator.spec}",)

    def take(self, label: str, size: Vec3, tint: Rgb | None, exact: bool) -> FolderAsset:
        """The asset with the name `label` in its own proportions, as large as its place in plan, `size`, lets it be;
        None if the library draws it or it cannot be made."""
        if exact or _drawn(label):
            return FolderAsset(None)
        color = None if tint is None else name_of(rgb_to_lab(torch.tensor(tint)))
        try:
            path = self.generator.path(_prompt(label, color))
        except BackendError as error:
            return FolderAsset(None, (f"{label}: {error}",))
        own = imported.natural_size(path)
        factor = min(size[0] / own[0], size[1] / own[1], TALLER * size[2] / own[2])
        fitted = own[0] * factor, own[1] * factor, own[2] * factor
        return FolderAsset(imported.read(path, fitted, label), (f"{label}: made by {self.generator.spec}",))


def _drawn(name: str) -> bool:
    kind = kinds.of(name)
    return kind is not None and bool(kind.asset)


def _prompt(name: str, color: str | None) -> str:
    return f"a {color} {name}" if color else f"a {name}"
