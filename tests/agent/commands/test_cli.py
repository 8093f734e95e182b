"""The command line: streams, exit codes, files, and that nothing is overwritten unasked."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from scenewright.agent import cli
from scenewright.agent.session.log import read_log
from scenewright.agent.terminal.output import terminal
from scenewright.gaussians.files import load
from scenewright.gaussians.language.field.store import field_path
from scenewright.gaussians.scene import Scene


def test_help_lists_every_verb(call: Any) -> None:
    answer = call("--help")
    assert answer.code == 0, answer.err
    assert all(f"\n  {verb} " in answer.out for verb in cli.VERBS)


@pytest.mark.parametrize("verb", cli.VERBS)
def test_every_verb_has_help_json_and_debug(call: Any, verb: str) -> None:
    answer = call(verb, "--help")
    assert answer.code == 0 and "--json" in answer.out and "--debug" in answer.out


@pytest.mark.parametrize("arguments", [["nonsense"], ["info"], ["edit"], ["info", "a.ply", "--nonsense"]])
def test_a_wrong_command_exits_with_2(call: Any, arguments: list[str]) -> None:
    answer = call(*arguments)
    assert answer.code == 2 and not answer.out and answer.err


def test_a_missing_file_exits_with_4_and_one_line(call: Any) -> None:
    answer = call("info", "none.ply")
    assert answer.code == 4 and answer.out == ""
    assert answer.err == "scenewright: no such file or folder: none.ply\n"


def test_with_json_an_error_is_an_object_on_stdout(call: Any) -> None:
    answer = call("info", "none.ply", "--json")
    assert answer.data == {"verdict": "file", "reason": "no such file or folder: none.ply", "exit_code": 4}


def test_a_bug_is_one_line_and_a_traceback_only_with_debug(call: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    from scenewright.gaussians import files

    def broken(path: object) -> None:
        raise RuntimeError("boom")

    monkeypatch.setattr(files, "load_with_report", broken)
    answer = call("info", "a.ply")
    assert answer.code == 4 and answer.err.count("\n") == 1 and "RuntimeError: boom" in answer.err
    with pytest.raises(RuntimeError):
        cli.main(["info", "a.ply", "--debug"])
    terminal.debug = False


@pytest.mark.parametrize("arguments", [["edti", "a.ply"], ["render", "a.ply"], ["info", "a.ply", "--nonsense"]])
def test_a_misused_command_is_one_line_that_says_where_help_is(call: Any, arguments: list[str]) -> None:
    answer = call(*arguments)
    assert answer.err.count("\n") == 1 and answer.err.startswith("scenewright: ") and "--help" in answer.err
    answer = call(*arguments, "--json")
    assert answer.code == answer.data["exit_code"] == 2


def test_without_a_verb_the_help_is_shown(call: Any) -> None:
    answer = call()
    assert answer.code == 2 and answer.out == "" and "Commands:" in answer.err


def test_an_interrupt_exits_with_130(call: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    from scenewright.gaussians import files

    def interrupted(path: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(files, "load_with_report", interrupted)
    answer = call("info", "a.ply")
    assert answer.code == 130 and answer.err == "interrupted\n"


def test_what_cannot_be_written_is_said_before_the_work(call: Any, room: Path, tmp_path: Path) -> None:
    words = ("edit", room, "make the green thing blue", "-o", tmp_path / "out.ply")
    answer = call(*words, "--pictures", room)
    assert answer.code == 2 and "cannot be made as a folder" in answer.err
    assert not (tmp_path / "out.ply").exists()
    answer = call("render", room, "-o", tmp_path / "a.jpg")
    assert answer.code == 2 and "written as .png" in answer.err
    batch = tmp_path / "batch.jsonl"
    batch.write_text('{"id": "a", "text": "the red thing"}\n{"id": "a", "text": "the green thing"}\n')
    answer = call("select", room, "--batch", batch, "--ids", tmp_path / "ids")
    assert answer.code == 2 and answer.out == "" and "its own id" in answer.err
    assert not (tmp_path / "ids").exists()


def test_a_dry_run_shows_the_plan_and_what_it_would_do(call: Any, room: Path) -> None:
    answer = call("edit", room, "make the green thing blue", "--dry-run")
    assert 'plan: {"op": "recolor"' in answer.out and "would recolor" in answer.out
    assert "seconds" not in answer.out and "seconds" in answer.err


def test_a_preview_writes_a_picture_and_says_how_much_would_change(call: Any, room: Path, tmp_path: Path) -> None:
    """Nothing but the picture is written; it is not overwritten."""
    there = sorted(tmp_path.rglob("*"))
    answer = call("edit", room, "make the green thing blue", "--preview", tmp_path / "change.png", "--json")
    data = json.loads(answer.out)
    assert answer.code == 0 and data["dry_run"] and 0 < data["preview"]["share_of_picture"] < 1
    assert data["preview"]["gaussians"] == data["receipts"][0]["changed"] and data["preview"]["mean_delta_e"] > 5
    assert sorted(tmp_path.rglob("*")) == sorted([*there, tmp_path / "change.png"])
    again = call("edit", room, "make the green thing blue", "--preview", tmp_path / "change.png")
    assert again.code == 2 and "exists" in again.err
    words = call("edit", room, "make the green thing blue", "--preview", tmp_path / "change.png", "--force")
    assert "it would change" in words.out and "of the picture looks different" in words.out
    assert call("edit", room, "delete it", "--preview", tmp_path / "change.jpg").code == 2


def test_what_is_nearest_is_called_so(call: Any, room: Path) -> None:
    answer = call("edit", room, "delete the yellow thing", "--dry-run")
    assert answer.code == 3 and answer.err.startswith("scenewright: ")
    assert "the nearest things that are there:\n  1. " in answer.err


@pytest.mark.parametrize("option", [("--up", "0,0,0"), ("--up", "nan,0,1"), ("--metres-per-unit", "-1")])
def test_a_frame_that_is_none_is_refused(call: Any, room: Path, option: tuple[str, str]) -> None:
    answer = call("edit", room, "make the green thing blue", "--dry-run", *option)
    assert answer.code == 2 and answer.err.count("\n") == 1 and "Frame." not in answer.err


def test_a_plan_needs_words_beside_the_scene(call: Any, room: Path) -> None:
    answer = call("plan", room)
    assert answer.code == 2 and "say what to do with it" in answer.err


def test_info(call: Any, room: Path) -> None:
    data = call("info", room, "--json").data
    assert data["gaussians"] == 3 * 343 + 144 and data["cameras"][0]["name"] == "door"
    assert data["language"]["encoder"] == "test:1" and len(data["language"]["things"]) == 3
    assert "3 things: box ×3" in call("info", room).out


def test_convert_renders_and_refuses_to_overwrite(call: Any, room: Path, tmp_path: Path) -> None:
    assert call("convert", room, tmp_path / "b.ply").code == 0
    assert load(tmp_path / "b.ply").cloud.digest() == load(room).cloud.digest()
    assert call("convert", room, tmp_path / "b.ply").code == 2
    assert call("convert", room, tmp_path / "b.ply", "--force").code == 0


def test_render(call: Any, room: Path, tmp_path: Path) -> None:
    data = call("render", room, "-o", tmp_path / "a.png", "--view", "door", "--size", "120x80", "--json").data
    assert data["size"] == [120, 80] and Image.open(tmp_path / "a.png").size == (120, 80)
    assert call("render", room, "-o", tmp_path / "a.png").code == 2
    assert call("render", room, "-o", tmp_path / "b.png", "--view", "0,-9,3:0,0,0").code == 0
    for view in ("nowhere", "1,2:3,4", "a,b,c:d,e,f"):
        assert call("render", room, "-o", tmp_path / "c.png", "--view", view).code == 2
    assert call("render", room, "-o", tmp_path / "c.png", "--size", "0x5").code == 2


def test_select_writes_rows_of_the_file(call: Any, room: Path, tmp_path: Path, boxes: Scene) -> None:
    data = call("select", room, "the green thing", "--ids", tmp_path / "ids.npy", "--json").data
    assert data["verdict"] == "found" and data["groups"] == [1]
    rows = np.load(tmp_path / "ids.npy", allow_pickle=False)
    assert np.array_equal(rows, (boxes.cloud.group == 1).nonzero().squeeze(1).numpy())
    absent = call("select", room, "the purple thing", "--json")
    assert absent.code == 3 and absent.data["verdict"] == "absent"
    ambiguous = call("select", room, "the red thing")
    assert ambiguous.code == 3 and "1. red box" in ambiguous.err


def test_select_in_batch(call: Any, room: Path, tmp_path: Path) -> None:
    batch = tmp_path / "b.jsonl"
    rows = [{"id": "a", "text": "the green thing"}, {"id": 2, "text": "the red thing"},
            {"id": "c", "text": "it", "context": "delete the green thing"}, {"id": "d", "text": "it"},
            {"id": "e", "text": "the thing that flurbles"}]  # fmt: skip
    batch.write_text("".join(json.dumps(r) + "\n" for r in rows))
    answer = call("select", room, "--batch", batch, "--ids", tmp_path / "ids")
    assert answer.code == 0, answer.err
    assert [r["id"] for r in answer.rows] == ["a", 2, "c", "d", "e"]
    assert [r["verdict"] for r in answer.rows][:4] == ["found", "ambiguous", "found", "absent"]
    assert {p.name for p in (tmp_path / "ids").iterdir()} == {"a.npy", "2.npy", "c.npy", "d.npy", "e.npy"}
    assert len(np.load(tmp_path / "ids" / "c.npy")) == 343 and len(np.load(tmp_path / "ids" / "2.npy")) == 0


def test_a_batch_id_cannot_leave_its_folder(call: Any, room: Path, tmp_path: Path) -> None:
    batch = tmp_path / "b.jsonl"
    batch.write_text('{"id": "../x", "text": "the green thing"}\n')
    assert call("select", room, "--batch", batch, "--ids", tmp_path / "ids").code == 2
    assert not (tmp_path / "x.npy").exists()


def test_plan_of_words_alone(call: Any) -> None:
    data = call("plan", "delete the green chair", "--json").data
    assert data["verdict"] == "ok" and data["steps"][0]["op"] == "delete" and data["planner"] == "grammar"
    refused = call("plan", "flurble the chair", "--json")
    assert refused.code == 3 and refused.data["verdict"] == "not_understood" and "flurble" in refused.data["reason"]


def test_plan_in_a_scene_names_its_targets(call: Any, room: Path, tmp_path: Path) -> None:
    data = call("plan", room, "delete the green thing", "--json").data
    assert data["verdict"] == "ok" and data["steps"][0]["targets"] == [1]
    batch = tmp_path / "b.jsonl"
    rows = [{"id": 1, "text": "delete the red thing"}, {"id": 2, "text": "delete the purple thing"},
            {"id": 3, "text": "what is this?"},
            {"id": 4, "text": "make it blue", "context": "select the green thing"}]  # fmt: skip
    batch.write_text("".join(json.dumps(r) + "\n" for r in rows))
    answer = call("plan", room, "--batch", batch)
    assert answer.code == 0, answer.err
    assert [r["verdict"] for r in answer.rows] == ["ambiguous", "absent", "not_an_edit", "ok"]
    assert len(answer.rows[0]["candidates"]) == 2 and answer.rows[3]["steps"][0]["targets"] == [1]
    assert call("plan").code == 2


def test_edit_writes_scene_field_pictures_and_log(call: Any, room: Path, tmp_path: Path) -> None:
    before = room.read_bytes()
    answer = call(
        "edit", room, "make the green thing blue, then delete it", "-o", tmp_path / "out.ply", "--json",
        "--pictures", tmp_path / "pics", "--log", tmp_path / "log.jsonl",
    )  # fmt: skip
    assert answer.code == 0, answer.err
    assert [r["op"]["op"] for r in answer.data["receipts"]] == ["recolor", "delete"]
    assert len(load(tmp_path / "out.ply").cloud) == 2 * 343 + 144
    assert field_path(tmp_path / "out.ply").is_file()
    assert {p.name for p in (tmp_path / "pics").iterdir()} == {"before.png", "after.png"}
    assert [r["kind"] for r in read_log(tmp_path / "log.jsonl").records] == ["open", "do", "save"]
    assert room.read_bytes() == before
    assert call("select", tmp_path / "out.ply", "the green thing", "--json").code == 3


def test_a_dry_run_writes_nothing(call: Any, room: Path, tmp_path: Path) -> None:
    there = sorted(tmp_path.rglob("*"))
    answer = call(
        "edit", room, "delete the green thing", "--dry-run", "-o", tmp_path / "o.ply", "--log", tmp_path / "l"
    )
    assert answer.code == 0 and "343 removed" in answer.out and "no scene was written" in answer.out
    assert sorted(tmp_path.rglob("*")) == there


@pytest.mark.parametrize(
    ("text", "code", "verdict"),
    [("delete the red thing", 3, "ambiguous"), ("delete the purple thing", 3, "absent"), ("flurble it", 2, None)],
)
def test_an_edit_that_cannot_be_done_writes_nothing(
    call: Any, room: Path, tmp_path: Path, text: str, code: int, verdict: str | None
) -> None:
    answer = call("edit", room, text, "-o", tmp_path / "o.ply", "--json")
    assert answer.code == code and not (tmp_path / "o.ply").exists()
    assert verdict is None or answer.data["verdict"] == verdict


def test_edit_refuses_before_it_works(call: Any, room: Path, tmp_path: Path) -> None:
    (tmp_path / "o.ply").write_text("mine")
    answer = call("edit", room, "delete the green thing", "-o", tmp_path / "o.ply")
    assert answer.code == 2 and "--force" in answer.err and (tmp_path / "o.ply").read_text() == "mine"
    assert call("edit", room, "delete the green thing", "-o", tmp_path / "o.ply", "--force").code == 0
    assert call("edit", room, "delete the green thing").code == 2
    assert call("edit", room, "-o", tmp_path / "p.ply").code == 2


def test_edit_replays_a_log(call: Any, room: Path, tmp_path: Path) -> None:
    log = tmp_path / "log.jsonl"
    assert call("edit", room, "delete the green thing", "-o", tmp_path / "a.ply", "--log", log).code == 0
    assert call("edit", room, "--replay", log, "-o", tmp_path / "b.ply").code == 0
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()


def test_edit_inserts_assets_of_a_folder(call: Any, room: Path, tmp_path: Path) -> None:
    import trimesh

    (tmp_path / "mine").mkdir()
    trimesh.creation.box((0.3, 0.6, 0.2)).export(tmp_path / "mine" / "gargoyle.glb")
    edit = ("edit", room, "put a gargoyle on the green thing", "-o", tmp_path / "a.ply")
    assert call(*edit).code == 2
    answer = call(*edit, "--assets", tmp_path / "mine")
    assert answer.code == 0 and "gargoyle.glb of your assets" in answer.out, answer.err
    assert call(*edit, "--assets", tmp_path / "none", "--force").code == 2


def test_a_replay_names_its_session_and_tells_what_is_wrong_with_the_log(call: Any, room: Path, tmp_path: Path) -> None:
    log = tmp_path / "log.jsonl"
    assert call("edit", room, "delete the green thing", "-o", tmp_path / "a.ply", "--log", log).code == 0
    assert call("edit", room, "delete the purple thing", "-o", tmp_path / "b.ply", "--log", log).code == 3
    second = call("edit", room, "make the green thing blue", "-o", tmp_path / "b.ply", "--log", log)
    assert second.code == 0 and "begins in a log that holds 2 before it" in second.err
    log.write_text(log.read_text() + '{"v": 1, "se')
    id = read_log(log).sessions()[0][0]["session"]
    answer = call("edit", room, "--replay", log, "--session", id, "-o", tmp_path / "c.ply", "--json")
    assert answer.code == 0 and answer.data["session"] == {"number": 1, "id": id, "edits": 1}
    assert f"replaying session 1 ({id}, 1 edit) of the 3" in answer.err and "not a whole record" in answer.err
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "c.ply").read_bytes()
    answer = call("edit", room, "--replay", log, "--session", "9", "-o", tmp_path / "d.ply")
    assert answer.code == 2 and "no session 9" in answer.err and not (tmp_path / "d.ply").exists()
    assert call("edit", room, "delete the box", "--session", id, "-o", tmp_path / "d.ply").code == 2


def test_the_groups_of_a_field_of_another_encoder_are_named_anew(
    call: Any, room: Path, encoder: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(encoder, "fingerprint", "other:1", raising=False)
    from scenewright.gaussians.language.field import group_table as module

    asked = []

    def renamed(scene: Scene, encoder: Any) -> Scene:
        assert scene.language is not None
        asked.append(scene.language.encoder)
        return scene.replace(language=replace(scene.language, encoder=encoder.fingerprint))

    monkeypatch.setattr(module, "renamed", renamed)
    answer = call("select", room, "the green thing")
    assert answer.code == 0 and asked == ["test:1"] and "named anew" in answer.err
    answer = call("embed", room)
    assert answer.code == 0 and "the same groups, named by another encoder" in answer.out
    assert call("embed", room).code == 0 and asked == ["test:1"] * 2  # it was saved with the new names


def test_a_given_frame_is_used_and_a_field_for_another_is_not(
    call: Any, room: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from scenewright.gaussians.language.field import embed as module

    asked = []

    def embed(scene: Scene, encoder: Any, progress: Any = None, **_: Any) -> Scene:
        asked.append((scene.frame.up, scene.frame.up_source, scene.frame.metres_per_unit))
        raise KeyboardInterrupt

    monkeypatch.setattr(module, "embed", embed)
    same = call("edit", room, "delete the green thing", "--dry-run", "--up", "0,0,1", "--metres-per-unit", "1")
    assert same.code == 0 and not asked
    assert call("edit", room, "delete the green thing", "--dry-run", "--up", "0,2,0").code == 130
    assert call("embed", room, "--metres-per-unit", "0.5").code == 130
    assert [a[0] for a in asked] == [(0, 1, 0), (0, 0, 1)] and asked[0][1] == "given" and asked[1][2] == 0.5
    for wrong in (["--up", "0,0"], ["--up", "0,0,0"], ["--metres-per-unit", "-1"]):
        assert call("embed", room, *wrong).code == 2


@pytest.mark.usefixtures("torchvision_examined")
@pytest.mark.slow
def test_doctor(call: Any) -> None:
    answer = call("doctor", "--json")
    assert answer.code == 0 and answer.data["machine"]["python"]


def test_bench_lists_and_measures(call: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    from scenewright.benchmarks import harness

    assert "render" in call("bench").out
    assert call("bench", "nonsense").code == 2
    values = iter([1.0, 1.0, 2.0])

    def run(name: str, quick: bool, parts: tuple[str, ...] = ()) -> harness.Result:
        metric = harness.Metric("a.seconds", next(values), "s", "lower", 0.1)
        return harness.Result("a test", "PSNR (dB)", (metric,), (harness.Point("cpu", "full", 0.1, 50.0, 10, True),))

    monkeypatch.setattr(harness, "run", run)
    first = call("bench", "render", "--quick", "--json")
    (tmp_path / "first.json").write_text(first.out)
    assert first.data["metrics"][0]["value"] == 1.0
    same = call("bench", "render", "--against", tmp_path / "first.json", "--chart", tmp_path / "chart.png")
    assert same.code == 0 and "| a.seconds |" in same.out and (tmp_path / "chart.png").is_file()
    worse = call("bench", "render", "--against", tmp_path / "first.json")
    assert worse.code == 3 and "worse: a.seconds" in worse.err
    assert call("bench", "render", "--chart", tmp_path / "chart.png").code == 2


def test_a_folder_that_is_read_only_is_said_to_be(
    call: Any, room: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import errno

    from scenewright.gaussians.files import atomic

    def refused(*arguments: object, **options: object) -> Any:
        raise OSError(errno.EROFS, "Read-only file system")

    monkeypatch.setattr(atomic, "open", refused, raising=False)
    monkeypatch.setattr(Path, "unlink", refused)
    answer = call("convert", room, tmp_path / "b.ply")
    assert answer.code == 4 and "Read-only file system" in answer.err and "internal" not in answer.err


# -- scene graphs ----------------------------------------------------------------------------------------------------

WRITTEN = Path(__file__).resolve().parents[2] / "planners" / "written"
LIVING = WRITTEN / "living_room.json"


def test_plan_on_a_graph_needs_no_scene(call: Any) -> None:
    words = "delete the blue cushion and move the vase 2 feet to the left"
    answer = call("plan", words, "--graph", LIVING, "--resolve", "--json")
    assert answer.code == 0, answer.err
    assert answer.data["verdict"] == "ok" and answer.data["planner"] == "grammar"
    assert [(s["op"], s["targets"]) for s in answer.data["steps"]] == [("delete", [14]), ("move", [18])]
    assert answer.data["steps"][1]["metres"] == 0.6096


def test_plan_on_a_graph_tells_what_it_hesitates_between(call: Any) -> None:
    answer = call("plan", "put the mug on the plant", "--graph", LIVING, "--json")
    assert (answer.code, answer.data["verdict"]) == (3, "ambiguous")
    assert [c["id"] for c in answer.data["candidates"]] == [12, 13]
    assert answer.data["candidates"][0] == {"id": 12, "label": "potted plant", "color": "green"}


def test_plan_on_a_graph_in_a_batch(call: Any, tmp_path: Path) -> None:
    rows = [
        {"id": "a", "text": "select the kettle"},
        {"id": "b", "text": "make it blue", "context": "select the kettle"},
        {"id": "c", "text": "what is this?"},
        {"id": "d", "text": "put the fridge in the kettle"},
        {"id": "e", "text": "and " * 500},
    ]
    batch = tmp_path / "batch.jsonl"
    batch.write_text("\n".join(map(json.dumps, rows)))
    answer = call("plan", "--batch", batch, "--graph", WRITTEN / "kitchen.json", "--resolve")
    assert answer.code == 0
    assert [(r["id"], r["verdict"]) for r in answer.rows] == [
        ("a", "ok"), ("b", "ok"), ("c", "not_an_edit"), ("d", "impossible"),
        ("e", "not_understood"),
    ]  # fmt: skip
    assert [s["targets"] for r in answer.rows for s in r["steps"]] == [["kettle"], ["kettle"], []]


def test_a_batch_does_not_list_what_the_context_took_away(call: Any, room: Path, tmp_path: Path) -> None:
    batch = tmp_path / "batch.jsonl"
    rows = [
        {"id": 1, "text": "delete all green things", "context": "delete the green thing"},
        {"id": 2, "text": "select everything", "context": "keep only the green thing"},
        {"id": 3, "text": "delete the green thing"},
    ]
    batch.write_text("\n".join(map(json.dumps, rows)))
    answer = call("plan", room, "--batch", batch)
    assert [r["verdict"] for r in answer.rows] == ["absent", "ok", "ok"]  # and the scene is as it was in the last
    rows = [
        {"id": 1, "text": "delete all the cushions", "context": "delete the blue cushion"},
        {"id": 2, "text": "delete the rug", "context": "delete the rug"},
        {"id": 3, "text": "delete the rug"},
    ]
    batch.write_text("\n".join(map(json.dumps, rows)))
    answer = call("plan", "--batch", batch, "--graph", LIVING, "--resolve")
    assert answer.rows[0]["steps"][0]["targets"] == [15, 16]
    assert [r["verdict"] for r in answer.rows[1:]] == ["absent", "ok"]


def test_resolving_needs_something_to_resolve_on(call: Any, room: Path) -> None:
    assert call("plan", "delete the sofa", "--resolve").code == 2
    assert call("plan", room, "delete the sofa", "--graph", LIVING).code == 2
    assert call("plan", "delete the sofa", "--graph", room.with_suffix(".json")).code == 4


@pytest.mark.parametrize("name", ["plan", "graph", "ops", "query"])
def test_schema(call: Any, name: str) -> None:
    answer = call("schema", name)
    assert answer.code == 0 and answer.data["$schema"].startswith("https://json-schema.org/")
    assert call("schema", "nothing").code == 2


def test_check_says_what_is_wrong_and_fails(call: Any, tmp_path: Path) -> None:
    assert call("check", LIVING).code == 0
    graph = json.loads(LIVING.read_text())
    graph["nodes"][0]["position"] = [0, 0.4, 0.4]
    broken = tmp_path / "broken.json"
    broken.write_text(json.dumps(graph))
    answer = call("check", broken, "--json")
    assert answer.code == 3 and not answer.data["ok"]
    assert {"collision"} <= {v["kind"] for v in answer.data["violations"]}
    assert "sofa (1)" in call("check", broken).out


def test_info_gives_the_graph_of_an_embedded_scene(call: Any, room: Path, tmp_path: Path) -> None:
    answer = call("info", room, "--graph")
    assert answer.code == 0, answer.err
    written = tmp_path / "graph.json"
    written.write_text(answer.out)
    told = call("plan", "select everything", "--graph", written, "--resolve", "--json")
    assert told.data["verdict"] == "ok"
    assert {n["id"] for n in answer.data["nodes"]} <= set(told.data["steps"][0]["targets"])


def test_an_edit_that_could_not_be_written_is_not_begun(
    call: Any, room: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from scenewright.agent.session import opening

    monkeypatch.setattr(opening, "open_session", lambda _: pytest.fail("the work was begun"))
    lost = call("edit", room, "delete the green thing", "-o", tmp_path / "nowhere" / "out.ply")
    assert lost.code == 4 and "nowhere does not exist; create it first" in lost.err
    named = call("edit", room, "delete the green thing", "-o", tmp_path / "out.txt")
    assert named.code == 2 and "cannot write out.txt" in named.err
