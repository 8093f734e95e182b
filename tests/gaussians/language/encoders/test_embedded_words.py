"""The embedded encoder's fixed list of words is reached by singular and plural."""

from __future__ import annotations

import json

from scenewright.gaussians.language.encoders import weights_folder
from scenewright.gaussians.language.encoders.backends.embedded import load
from scenewright.gaussians.world.words import plural, singular

# Trained words that have no plural.
_ELSE = {"of"}


def test_every_trained_word_is_reached_by_its_singular_and_plural() -> None:
    encoder = load()
    trained = json.loads((weights_folder() / "words.json").read_bytes())["words"]
    forms = {form for w in trained if w not in _ELSE for form in (w, singular(w), plural(w))}
    assert not [form for form in sorted(forms) if not encoder.knows(form)]
