"""Reads the folder of a user's own assets, which operations insert by their names."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...tools.operation import AssetSource


def own_assets(folder: str | Path | None) -> AssetSource | None:
    """The assets in a folder; None without one.

    Raises:
        UserError: there is no such folder, or no asset in it.
        FileError: its index is not valid.
    """
    if folder is None:
        return None
    from ...planners.rooms.asset_folder import AssetFolder

    return AssetFolder.read(Path(folder))
