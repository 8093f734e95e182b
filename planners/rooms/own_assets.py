"""A user's own assets, by a specification: a folder of files, or things that are made when they are asked for."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from ...gaussians.assets.modeling.make import Asset
    from ...gaussians.camera import Vec3
    from ...gaussians.color import Rgb
    from .asset_folder import FolderAsset

DREAM = "dream:"


class OwnAssets(Protocol):
    """Assets besides the library's."""

    def natural(self, name: str, color: str | None) -> tuple[Asset | None, tuple[str, ...]]:
        """As `tools.operation.AssetSource.natural`."""
        ...

    def take(self, label: str, size: Vec3, tint: Rgb | None, exact: bool) -> FolderAsset:
        """The asset with the name `label`, fitted to `size`.

        Args:
            tint: its new colour; None leaves its own.
            exact: accept only this name or a synonym, because the asset library can make the thing too.
        """
        ...


def own_assets(spec: str | Path | None) -> OwnAssets | None:
    """The assets of a specification; None without one.

    Args:
        spec: a folder of .glb and .ply files; or "dream:diffusers:FOLDER" or "dream:command:PROGRAM ...", which make
            what the library does not draw.

    Raises:
        UserError: there is no such folder, or no asset in it.
        FileError: its index is not valid.
        BackendError: what is to be dreamt with is unknown.
    """
    if spec is None:
        return None
    if isinstance(spec, str) and spec.startswith(DREAM):
        from ...gaussians.dream.generating import Generator
        from .dreamt_assets import DreamtAssets

        return DreamtAssets(Generator(spec.removeprefix(DREAM)))
    from .asset_folder import AssetFolder

    return AssetFolder.read(Path(spec))
