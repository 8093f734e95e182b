"""The small scene of boxes with a language field of the embedded encoder, as another process reads it."""

from __future__ import annotations

import pytest

from scenewright.gaussians.language import encoders
from scenewright.gaussians.language.field.language_field import LanguageField
from scenewright.gaussians.scene import Scene


@pytest.fixture
def named_boxes(boxes: Scene) -> Scene:
    assert boxes.language is not None
    encoder = encoders.load("auto")
    vectors = encoder.encode_text([g.label for g in boxes.language.groups])
    return boxes.replace(language=LanguageField(boxes.language.groups, vectors, encoder.fingerprint))
