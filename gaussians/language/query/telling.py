"""What things are called in notes: by their names where these are sure, else by what is measured."""

from __future__ import annotations

from ...color import name_of
from ..field.language_field import Group, LanguageField
from .color.fallback import is_reliable

SURE = 0.5  # probability from which a name is told in a scene whose names are reliable


def told(field: LanguageField, group: Group) -> str:
    """What a group is called, without an article: its name, or "dark gray thing" where its name is a guess.

    A field of a capture names things by guesses; a name that a person or a new thing gave is sure anywhere.
    """
    if group.label and (group.named_by or group.inserted):
        return group.label
    return group.label or "something" if is_reliable(field) else f"{name_of(group.lab)} thing"
