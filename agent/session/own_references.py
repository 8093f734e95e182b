"""Reads photographs of materials that the user gives as references for restyle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...tools.finishing.photograph import Photograph


def own_references(
    paths: str | Path | Sequence[str | Path] | Mapping[str, Photograph], width: float | None = None
) -> Mapping[str, Photograph]:
    """The photographs by the names of their files, two of one name by their paths; those that were read stay.

    Args:
        width: metres that each shows from left to right, if that is known.

    Raises:
        FileError: a file is no photograph that can be read.
        UserError: the width is no length of things.
    """
    if isinstance(paths, Mapping):
        return paths
    if isinstance(paths, str | Path):
        paths = [paths]
    if not paths:
        return {}
    from ...tools.finishing.photograph import read_photograph

    found: dict[str, Photograph] = {}
    for path in map(Path, paths):
        photograph = read_photograph(path, width)
        found[str(path) if photograph.name in found else photograph.name] = photograph
    return found
