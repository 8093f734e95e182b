"""The table of groups: a label is its most probable name, and another encoder names the same groups."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch
from two_hues import BOX, GREEN, HUES, RED, things

from scenewright.gaussians.errors import UserError
from scenewright.gaussians.language.encoders.backends.vectors import wrap
from scenewright.gaussians.language.field.group_table import NAMELESS, renamed
from scenewright.gaussians.language.field.language_field import Group


def test_the_label_is_the_first_name() -> None:
    whole = Group(0, "object", -1, "mug", 0.7, BOX, (0, 0, 0), 1, 1, 1.0, names=(("mug", 0.7), ("vase", 0.2)))
    assert whole.names[1] == ("vase", 0.2)
    assert replace(whole, count=5).names == whole.names
    assert replace(whole, label="bowl", label_score=1.0).names == (("bowl", 1.0),)  # the old names are of the old label
    assert replace(whole, label="", label_score=0.0).names == ()


def test_another_encoder_names_the_same_groups() -> None:
    before = things(RED, GREEN)
    after = renamed(before, HUES)
    assert before.language is not None and after.language is not None
    assert torch.equal(after.cloud.group, before.cloud.group)
    assert [g.label for g in after.language.groups] == ["tomato", "cucumber"]
    assert after.language.encoder == HUES.fingerprint and after.language.embeddings.shape == (2, 2)
    assert after.language.making is not None and before.language.making is not None
    made = replace(before.language.making, encoder="Hues", trust=after.language.making.trust)
    assert after.language.making == made and made.masks  # the masks are not forgotten
    assert after.language.notes == before.language.notes
    assert [(g.box, g.lab, g.count) for g in after.language.groups] == [
        (g.box, g.lab, g.count) for g in before.language.groups
    ]


def test_names_that_were_given_survive_another_encoder() -> None:
    scene = things(RED, GREEN)
    assert scene.language is not None
    rows = list(scene.language.groups)
    rows[0] = replace(rows[0], label="poppy", label_score=1.0, named_by="sight")
    after = renamed(scene.replace(language=replace(scene.language, groups=tuple(rows))), HUES)
    assert after.language is not None and [g.label for g in after.language.groups] == ["poppy", "cucumber"]


def test_what_was_inserted_keeps_its_name_under_another_encoder() -> None:
    scene = things(RED, RED)
    assert scene.language is not None
    rows = list(scene.language.groups)
    rows[1] = replace(rows[1], label="cucumber", label_score=1.0, views=0)  # as `insert` files a thing
    after = renamed(scene.replace(language=replace(scene.language, groups=tuple(rows))), HUES)
    assert after.language is not None and [g.label for g in after.language.groups] == ["tomato", "cucumber"]
    assert np.array_equal(after.language.embeddings[1], HUES.encode_text(["cucumber"])[0])


def test_an_encoder_that_can_name_nothing_here_says_so() -> None:
    texts = wrap([["poppy"], ["mug"]], np.eye(2, dtype=np.float32))
    nameless = renamed(things(RED, GREEN), texts)
    assert nameless.language is not None and NAMELESS in nameless.language.notes
    again = renamed(nameless, HUES)
    assert again.language is not None and again.language.notes == ("a note",)


def test_an_encoder_without_pictures_names_groups_by_what_detectors_called_them() -> None:
    texts = wrap([["poppy"], ["mug"], ["grass"]], np.eye(3, dtype=np.float32))
    scene = renamed(things(RED, votes=(("mug", 4.0), ("poppy", 1.0), ("", 2.0))), texts)
    assert scene.language is not None and scene.language.groups[0].label == "mug"
    assert scene.language.groups[0].votes == (("mug", 4.0), ("poppy", 1.0), ("", 2.0))


def test_a_scene_without_groups_cannot_be_named() -> None:
    with pytest.raises(UserError, match="embed"):
        renamed(things(RED).replace(language=None), HUES)
