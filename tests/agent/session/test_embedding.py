"""A session with another encoder than the field's: the same groups under new names, whatever is asked of them."""

from __future__ import annotations

from pathlib import Path

import torch
from two_hues import GREEN, HUES, RED, things

from scenewright.agent.session.embedding import embedded_by
from scenewright.agent.session.log import read_log
from scenewright.agent.session.session import Session
from scenewright.gaussians.camera import Camera

VIEWER = Camera.look_at([1.5, -9, 2], [1.5, 0, 0], [0, 0, 1], 96, 64, 50)


def test_words_find_the_groups_of_a_field_of_another_encoder(tmp_path: Path) -> None:
    scene = things(RED, GREEN)
    assert scene.language is not None and scene.language.encoder != HUES.fingerprint
    session = Session(scene, "grammar", HUES, tmp_path / "log.jsonl", VIEWER, vlm=None)
    found = session.select("the tomato")
    assert found.verdict == "found" and found.groups == (0,)
    assert torch.equal(session.scene.cloud.group, scene.cloud.group)
    assert session.explain("the cucumber").verdict == "found"
    assert session.ask("how many cucumbers are there?").answer == 1
    after = session.do("delete the cucumber").scene
    assert len(after.cloud) == 200 and bool((after.cloud.group == 0).all())
    assert session.undo().scene.cloud is session.scene.cloud and len(session.scene.cloud) == 400
    embeddings = [record for record in read_log(tmp_path / "log.jsonl").records if record["kind"] == "embed"]
    assert [record["encoder"] for record in embeddings] == [HUES.fingerprint]  # once for all that was asked


def test_the_field_tells_that_its_groups_were_named_anew_and_by_whom_before() -> None:
    made = embedded_by(HUES, things(RED, GREEN)).language
    assert made is not None and made.notes == ("a note", "the groups are of the encoder none and are named anew")
    assert made.making is not None and made.making.encoder == "Hues" and made.making.masks


def test_a_field_of_the_same_encoder_is_left_alone() -> None:
    scene = embedded_by(HUES, things(RED, GREEN))
    assert embedded_by(HUES, scene) is scene
    session = Session(scene, "grammar", HUES, viewer=VIEWER, vlm=None)
    assert session.embed() is scene
