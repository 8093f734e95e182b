"""The language field that a session needs: made if there is none, its groups named anew if another encoder made it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from ...gaussians.scene import Scene

if TYPE_CHECKING:
    from ...gaussians.language.encoders import Encoder
    from ...gaussians.language.field.language_field import Group, LanguageField

_ANEW = "the groups are of the encoder "


def embedded_by(
    encoder: Encoder,
    scene: Scene,
    progress: Callable[[str, float], None] = lambda stage, share: None,
    made: Mapping[str, Any] = MappingProxyType({}),
) -> Scene:
    """The scene with a language field of an encoder.

    A field of another encoder keeps its groups, which are embedded and named anew; a note says so. Its column of groups
    stays as it is, so that ids of groups mean the same. `made`: more arguments of `embed`.

    Raises:
        UserError: the scene has no Gaussians.
    """
    from ...gaussians.language.field.embed import embed
    from ...gaussians.language.field.group_table import renamed

    if scene.language is None:
        return embed(scene, encoder, progress=progress, **made)
    if scene.language.encoder == encoder.fingerprint:
        return scene
    progress("names", 0.0)
    named = renamed(scene, encoder)
    assert named.language is not None
    notes = (*(note for note in named.language.notes if not note.startswith(_ANEW)), told_anew(scene.language))
    return named.replace(language=replace(named.language, notes=notes))


def told_anew(field: LanguageField) -> str:
    """A sentence about groups that are named anew, with the encoder that named them before."""
    made_by = field.encoder if field.making is None else field.making.encoder
    return f"{_ANEW}{made_by} and are named anew"


def only_thing(scene: Scene) -> Group | None:
    """The one thing of an embedded scene that holds one and nothing else; None of any other scene."""
    groups = [] if scene.language is None else [g for g in scene.language.groups if g.count and g.level != "part"]
    return groups[0] if len(groups) == 1 and groups[0].level == "object" else None
