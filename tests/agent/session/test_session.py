"""Laws of a session: an instruction is whole or nothing, undo is exact, the log tells the truth, replay repeats it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from scenewright.agent.session.log import read_log, viewer_of
from scenewright.agent.session.session import Session
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import (
    AbsentError,
    AmbiguousError,
    CheckFailedError,
    FileError,
    ScenewrightError,
    UserError,
)
from scenewright.gaussians.language.field.loading import load
from scenewright.gaussians.scene import Scene


@pytest.fixture
def session(boxes: Scene, encoder: Any) -> Session:
    return Session(boxes, encoder=encoder, viewer=boxes.cameras[0])


def test_an_instruction_changes_what_it_names_and_leaves_the_given_scene_alone(session: Session, boxes: Scene) -> None:
    digest = boxes.cloud.digest()
    result = session.do("make the green thing blue")
    changed = (result.scene.cloud.sh != boxes.cloud.sh).any(dim=(1, 2))
    assert bool((result.scene.cloud.group[changed] == 1).all()) and bool(changed.any())
    assert boxes.cloud.digest() == digest and result.before is boxes and session.scene is result.scene
    assert [r.op["op"] for r in result.receipts] == ["recolor"]
    assert result.render().rgb.shape == (64, 96, 3)


def test_undo_and_redo_return_the_very_values(session: Session, boxes: Scene) -> None:
    first = session.do("make the green thing blue").scene
    second = session.do("delete the blue thing").scene
    assert session.undo().scene is first
    assert session.undo().scene is boxes
    assert session.redo().scene is first
    assert session.redo().scene is second
    assert session.do("undo that").scene is first
    assert session.do("Redo.").scene is second


def test_a_new_instruction_forgets_what_was_undone(session: Session) -> None:
    session.do("make the green thing blue")
    session.undo()
    session.do("delete the green thing")
    with pytest.raises(UserError, match="nothing to redo"):
        session.redo()


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("delete the purple thing", AbsentError),
        ("delete the red thing", AmbiguousError),
        ("make the green thing blue and delete the yellow thing", AbsentError),
        ("delete the green thing, then make the red thing blue", AmbiguousError),
        ("flurble the green thing", UserError),
    ],
)
def test_what_cannot_be_done_changes_nothing(
    session: Session, boxes: Scene, text: str, error: type[ScenewrightError]
) -> None:
    with pytest.raises(error):
        session.do(text)
    assert session.scene is boxes
    with pytest.raises(UserError, match="nothing to undo"):
        session.undo()


def test_a_compound_instruction_says_which_step_failed(session: Session) -> None:
    with pytest.raises(AbsentError, match=r"step 2 of 2 \(delete\) failed, nothing was changed"):
        session.do("make the green thing blue and delete the yellow thing")


def test_a_failed_check_rolls_everything_back(session: Session, boxes: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    from scenewright.tools import execute

    real = execute.carry_out

    def failing(scene: Scene, op: Any, context: Any, selection: Any) -> Any:
        if op.op == "delete":
            raise CheckFailedError("nothing was deleted")
        return real(scene, op, context, selection)

    monkeypatch.setattr(execute, "carry_out", failing)
    with pytest.raises(CheckFailedError):
        session.do("make the green thing blue and delete it")
    assert session.scene is boxes


def test_it_means_what_was_last_spoken_of_and_undo_takes_that_back_too(session: Session) -> None:
    session.do("select the green thing")
    session.do("make it blue")
    assert session.last is not None and session.last.groups == (1,)
    session.undo()
    session.undo()
    assert session.last is None
    with pytest.raises(AbsentError):
        session.do("delete it")


def test_a_preview_changes_nothing(session: Session, boxes: Scene) -> None:
    result = session.preview("delete the green thing")
    assert result.dry_run and len(result.scene.cloud) < len(boxes.cloud)
    assert session.scene is boxes and session.done == ()


@pytest.mark.parametrize(
    ("answer", "group"),
    [("2", None), ("the left one", 0), ("the right one", 2), ("the smallest", 0), ("the big one", 2)],
)
def test_an_ambiguity_is_settled_by_an_answer(session: Session, boxes: Scene, answer: str, group: int | None) -> None:
    with pytest.raises(AmbiguousError):
        session.do("delete the red thing")
    assert session.question is not None
    assert {c.group for c in session.question.candidates} == {0, 2}
    expected = session.question.candidates[1].group if group is None else group
    session.answer(answer)
    assert set(session.scene.cloud.group.unique().tolist()) == {0, 1, 2, 3} - {expected}
    assert session.question is None
    session.undo()
    assert session.scene is boxes


def test_all_is_an_answer_and_nonsense_is_none(session: Session) -> None:
    with pytest.raises(AmbiguousError):
        session.do("make the green thing blue and delete the red thing")
    with pytest.raises(UserError, match="answer with a number from 1 to 2"):
        session.answer("7")
    assert session.question is not None
    session.answer("all")
    assert set(session.scene.cloud.group.unique().tolist()) == {1, 3}
    with pytest.raises(UserError, match="no open question"):
        session.answer("1")


def test_an_answer_that_fits_something_else_is_none(session: Session, boxes: Scene) -> None:
    with pytest.raises(AmbiguousError):
        session.do("delete the red thing")
    for words in ("the green one", "the green thing", "the purple one"):
        with pytest.raises(UserError, match="none of the 2"):
            session.answer(words)
    assert session.scene is boxes and session.question is not None


def test_bytes_that_are_no_text_are_a_user_error(session: Session) -> None:
    with pytest.raises(UserError, match="UTF-8"):
        session.do("\udcff delete")


def test_select_looks_and_does_not_touch(session: Session, boxes: Scene) -> None:
    found = session.select("the green thing")
    assert found.verdict == "found" and found.groups == (1,)
    assert torch.equal(found.ids, (boxes.cloud.group == 1).nonzero().squeeze(1))
    assert session.select("the red thing").verdict == "ambiguous"
    assert session.select("the purple thing").verdict == "absent"
    assert session.scene.cloud is boxes.cloud
    with pytest.raises(UserError):
        session.select("the thing that flurbles")


def test_recall_sets_what_it_means_without_doing_anything(session: Session, boxes: Scene) -> None:
    session.recall("delete the green thing")
    assert session.select("it").groups == (1,)
    session.recall(None)
    assert session.select("it").verdict == "absent"
    assert session.scene.cloud is boxes.cloud


def test_the_log_is_a_chain_of_digests(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    session = Session(boxes, encoder=encoder, log=tmp_path / "log.jsonl")
    session.do("make the green thing blue")
    with pytest.raises(AbsentError):
        session.do("delete the yellow thing")
    session.do("delete the blue thing")
    session.undo()
    session.redo()
    session.close()
    records = read_log(tmp_path / "log.jsonl").records
    assert [r["kind"] for r in records] == ["open", "do", "failed", "do", "undo", "redo"]
    at = records[0]["digest"]
    assert at == boxes.cloud.digest()
    for record in records[1:]:
        assert record["before"] == at
        at = record.get("after", at)
    assert at == session.scene.cloud.digest()
    assert records[1]["receipts"][0]["checks"]


def test_nothing_happens_that_cannot_be_logged(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    session = Session(boxes, encoder=encoder, log=tmp_path / "log.jsonl")
    session.close()
    with pytest.raises(FileError, match="session log"):
        session.do("delete the green thing")
    assert session.scene is boxes


def test_replay_leads_to_the_same_scene(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    session = Session(boxes, encoder=encoder, log=tmp_path / "log.jsonl")
    session.do("make the green thing blue")
    session.do("delete the blue thing")
    session.undo()
    with pytest.raises(AmbiguousError):
        session.do("delete the red thing")
    session.answer("2")
    session.do("make the red thing yellow")
    session.close()
    again = Session(boxes, encoder=encoder)
    replayed = again.replay(tmp_path / "log.jsonl")
    assert [r.text for r in replayed] == [
        "make the green thing blue",
        "delete the red thing",
        "make the red thing yellow",
    ]
    assert again.scene.cloud.digest() == session.scene.cloud.digest()


def test_replay_elsewhere_resolves_the_words_again(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    session = Session(boxes, encoder=encoder, log=tmp_path / "log.jsonl")
    session.do("make the green thing blue")
    with pytest.raises(AmbiguousError):
        session.do("delete the red thing")
    session.answer("1")  # an id of this scene: it must not be followed in another
    session.close()
    cloud = boxes.cloud
    other = boxes.replace(cloud=cloud.replace(opacities=cloud.opacities * 0.9))
    elsewhere = Session(other, encoder=encoder)
    with pytest.raises(AmbiguousError, match="all of it was undone"):
        elsewhere.replay(tmp_path / "log.jsonl")
    assert elsewhere.scene is other
    outcome = elsewhere.replay(tmp_path / "log.jsonl", skip_failed=True)
    assert [r.error is None for r in outcome] == [True, False]


def test_replay_of_nothing_is_a_user_error(session: Session, tmp_path: Path) -> None:
    (tmp_path / "log.jsonl").write_text("")
    with pytest.raises(UserError, match="holds no session"):
        session.replay(tmp_path / "log.jsonl")


def test_save_refuses_to_overwrite(session: Session, tmp_path: Path) -> None:
    session.save(tmp_path / "a.ply")
    with pytest.raises(UserError, match="--force"):
        session.save(tmp_path / "a.ply")
    session.save(tmp_path / "a.ply", force=True)


def test_save_keeps_the_names_unless_told_otherwise(session: Session, boxes: Scene, tmp_path: Path) -> None:
    assert session.save(tmp_path / "a.ply") == tmp_path / "a.ply.field.safetensors"
    saved = load(tmp_path / "a.ply").language
    assert saved is not None and boxes.language is not None and saved.groups == boxes.language.groups
    assert session.save(tmp_path / "b.ply", names=False) is None and load(tmp_path / "b.ply").language is None


def test_an_unknown_planner_is_refused_by_name(boxes: Scene) -> None:
    with pytest.raises(ScenewrightError, match="grammar"):
        Session(boxes, planner="oracle")


def test_whether_a_text_is_a_question_is_told_without_asking_a_model(boxes: Scene, encoder: Any) -> None:
    class Costly:
        name = "costly"

        def plan(self, text: str, **rest: Any) -> Any:
            raise AssertionError("the model was asked")

    session = Session(boxes, planner=Costly(), encoder=encoder)
    assert session.is_question("how far is the red box from the green one?")
    assert not session.is_question("delete the red box")
    assert not session.is_question("can you delete the red box?")


def test_a_replay_knows_what_it_meant_after_a_selection(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    with_log = Session(boxes, planner="grammar", encoder=encoder, log=tmp_path / "s.jsonl")
    assert with_log.select("the green thing").groups == (1,)
    with_log.do("delete it")
    with_log.close()
    again = Session(boxes, planner="grammar", encoder=encoder)
    again.replay(tmp_path / "s.jsonl")
    assert again.scene.cloud.digest() == with_log.scene.cloud.digest()


def test_a_replay_sees_the_scene_as_it_was_seen(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    """ "Left" is that of the viewer who said it: a session that looks from the other side comes to the same bytes, and
    then has its own viewer again. On another scene its own viewer counts."""
    log = tmp_path / "log.jsonl"
    front = boxes.cameras[0]
    back = Camera.look_at((0.0, 9.0, 4.0), (0.0, 0.0, 0.5), (0.0, 0.0, 1.0), 96, 64)
    first = Session(boxes, encoder=encoder, viewer=front, log=log)
    first.do("move the green thing 30 cm to the left")
    first.viewer = back
    first.do("move the green thing 10 cm to the left")
    first.close()
    viewers = [viewer_of(r) for r in read_log(log).records if r["kind"] == "do"]
    for seen, meant in zip(viewers, (front, back), strict=True):
        assert seen is not None and np.array_equal(seen.world_to_camera, meant.world_to_camera)
        assert (seen.fx, seen.cx, seen.width) == (meant.fx, meant.cx, meant.width)
    second = Session(boxes, encoder=encoder, viewer=back)
    assert [r.note for r in second.replay(log)] == ["", ""]
    assert second.digest == first.digest and second.viewer is back
    step = first.scene.cloud.means - boxes.cloud.means  # 30 cm to one side and 10 cm back
    assert float(step[:, 0].min()) == pytest.approx(-0.2, abs=1e-5)
    other = boxes.replace(cloud=boxes.cloud.replace(opacities=boxes.cloud.opacities * 0.99))
    third = Session(other, encoder=encoder, viewer=back)
    third.replay(log)
    moved = third.scene.cloud.means - boxes.cloud.means
    assert float(moved[:, 0].max()) == pytest.approx(0.4, abs=1e-5)


@pytest.mark.parametrize("viewer", [None, 3, {}, {"world_to_camera": [[1]]}, {"world_to_camera": "x", "fx": 1}])
def test_a_record_without_a_camera_has_no_viewer(viewer: Any) -> None:
    """Logs of earlier versions, and edited ones."""
    assert viewer_of({"kind": "do", "viewer": viewer}) is None and viewer_of({"kind": "do"}) is None
