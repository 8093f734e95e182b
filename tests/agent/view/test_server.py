"""The server of the page: what is shown follows the session, on every tab, through cuts and restarts."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from scenewright.agent.session.session import Session
from scenewright.agent.view.gallery import KEPT, Gallery
from scenewright.benchmarks._view.client import Page, Server, asked, same, served
from scenewright.gaussians.scene import Scene


@pytest.fixture
def server(boxes: Scene, encoder: Any) -> Iterator[Server]:
    with served(Session(boxes, encoder=encoder)) as made:
        yield made


@pytest.fixture
def page(server: Server) -> Iterator[Page]:
    with Page(server.port, server.cookie) as made:
        yield made


def test_a_tab_gets_everything_and_the_state(server: Server, page: Page) -> None:
    assert page.welcome["slots"] == len(server.hub.shown.scene.cloud)
    assert same(page, server.hub)
    assert [t["name"] for t in page.state["things"]] == ["box", "box", "box", "floor"]
    assert page.state["things"][0]["color"].startswith("#d")
    assert page.state["selection"]["groups"] == [] and not page.state["can_undo"]


def test_a_thing_whose_name_is_not_sure_is_told_by_its_colour(unsure: Scene, encoder: Any) -> None:
    with served(Session(unsure, encoder=encoder)) as made, Page(made.port, made.cookie) as page:
        assert [t["name"] for t in page.state["things"]] == ["red thing", "green thing", "red thing", "floor"]


def test_words_change_what_every_tab_shows_and_undo_restores_it(server: Server, page: Page) -> None:
    with Page(server.port, server.cookie) as other:
        digest = page.state["digest"]
        said = page.ask("say", text="make the green thing blue")
        assert said["ok"] and any(row["passed"] for row in said["receipt"])
        assert page.state["digest"] != digest and same(page, server.hub)
        assert page.received < 343 * 8 * 1.2 + 700  # only the colours of the box, and a header
        assert page.state["history"][0]["text"] == "make the green thing blue"
        while other.state["digest"] == digest:
            other.take()
        assert same(other, server.hub)
        page.ask("undo")
        assert page.state["digest"] == digest and page.state["can_redo"] and same(page, server.hub)


@pytest.mark.slow
def test_rows_that_go_and_come_back_keep_the_page_right(server: Server, page: Page) -> None:
    for text in ("delete the green thing", "undo", "duplicate the green thing", "delete the green things", "undo"):
        said = page.ask("say", text=text)
        assert said["ok"], said
        assert same(page, server.hub), text


def test_it_is_what_was_clicked(server: Server, page: Page) -> None:
    page.ask("select", mode="set", group=2)
    assert page.state["selection"]["groups"] == [2]
    page.ask("select", mode="add", group=1)
    assert page.state["selection"]["groups"] == [1, 2]
    page.ask("select", mode="remove", group=2)
    before = server.hub.session.scene.cloud
    assert page.ask("say", text="make it blue")["ok"]
    now = server.hub.session.scene.cloud
    assert set(now.group[(now.sh != before.sh).any(dim=2)[:, 0]].tolist()) == {1}


def test_a_slot_selects_its_thing_and_slots_a_part_of_it(server: Server, page: Page) -> None:
    shown = server.hub.shown
    row = int((shown.scene.cloud.group == 0).nonzero()[0])
    page.ask("select", mode="set", slot=int(shown.slots.slot[row]))
    assert page.state["selection"]["groups"] == [0]
    page.ask("select", mode="clear")
    assert server.hub.session.last is None
    page.ask("select_slots", mode="set", ranges=[[int(shown.slots.slot[row]), 1]])
    assert page.state["selection"]["ranges"] == [[int(shown.slots.slot[row]), 1]]
    assert page.state["selection"]["box"] is not None


@pytest.mark.slow
def test_operations_go_to_the_selection_as_one_step(server: Server, page: Page) -> None:
    move = {"op": "move", "direction": "up", "distance": {"value": 0.5, "unit": "m"}}
    assert page.ask("operate", ops=[move])["type"] == "error"  # nothing is selected
    page.ask("select", mode="set", group=1)
    assert page.ask("operate", ops=[move, {"op": "scale", "factor": 1.2}])["ok"]
    (step,) = page.state["history"]
    assert step["text"] == "move it: direction up, distance 0.5 m and scale it: factor 1.2"
    assert same(page, server.hub)
    assert page.ask("operate", ops=[{"op": "nonsense"}])["type"] == "error"


@pytest.mark.slow
def test_a_question_is_answered_by_a_click(server: Server, page: Page) -> None:
    asked = page.ask("say", text="delete the red thing")
    question = page.state["question"]
    assert not asked["ok"] and [c["number"] for c in question["candidates"]] == [1, 2]
    assert [c["name"] for c in question["candidates"]] == ["red box", "red box"]
    assert len(asked["lines"]) == 1 and asked["lines"][0].startswith("Which one? A number")
    assert "red box (1), red box (2)" in asked["text"] and "red box (1), red box (2)" in question["text"]
    assert page.ask("answer", choice=2)["ok"]
    assert page.state["question"] is None and same(page, server.hub)


def test_before_turns_the_page_into_what_it_was(server: Server, page: Page) -> None:
    assert page.ask("before")["type"] == "error"
    page.ask("say", text="make the green thing blue")
    page.send({"type": "before", "id": 99})
    header = page.take()
    assert header["type"] == "before" and header["base"] == page.revision
    assert [p["column"] for p in header["parts"]] == ["color"]


def test_a_tab_that_comes_back_gets_what_it_missed_only(server: Server, page: Page) -> None:
    with Page(server.port, server.cookie) as other:
        page.cut()
        for text in ("make the green thing blue", "make the green thing yellow", "delete the green thing"):
            other.ask("say", text=text)
        page.received = 0
        page.connect()
        assert page.headers[-1]["base"] is not None
        assert same(page, server.hub) and page.state["digest"] == other.state["digest"]


@pytest.mark.slow
def test_the_log_makes_the_work_again_after_a_crash(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    from scenewright.agent.session.restoring import restore, unfinished

    log = tmp_path / "log.jsonl"
    with served(Session(boxes, encoder=encoder, log=log)) as first, Page(first.port, first.cookie) as page:
        slots = first.hub.shown.slots.slot[(boxes.cloud.group == 1).numpy()][:40]
        page.ask("select_slots", mode="set", ranges=[[int(s), 1] for s in sorted(slots)])
        assert page.ask("operate", ops=[{"op": "recolor", "color": "blue"}])["ok"]
        page.ask("say", text="delete the green thing")
        page.ask("undo")
        page.ask("select", mode="set", group=2)
        digest = page.state["digest"]
    again = Session(boxes, encoder=encoder, log=log)
    earlier = unfinished(log)
    assert earlier is not None
    notes: list[str] = []
    restore(again, earlier, notes.append)
    assert again.digest == digest and again.last is not None and again.last.groups == (2,), notes
    assert len(again.done) == 1 and again.redoable
    again.redo()  # what was undone can be redone after the crash, too
    assert again.done[-1] == "delete the green thing" and not again.redoable
    again.undo()
    assert again.digest == digest
    again.close()


@pytest.mark.slow
def test_what_was_all_undone_can_be_redone_after_a_crash(boxes: Scene, encoder: Any, tmp_path: Path) -> None:
    from scenewright.agent.session.restoring import restore, unfinished

    log = tmp_path / "log.jsonl"
    first = Session(boxes, encoder=encoder, log=log)
    first.do("make the green thing blue")
    first.do("delete the blue thing")
    first.undo()
    first.undo()
    first.close()
    for _ in range(2):  # and after the next one
        again = Session(boxes, encoder=encoder, log=log)
        earlier = unfinished(log)
        assert earlier is not None and not earlier.edits
        restore(again, earlier, lambda note: None)
        assert not again.done and again.redoable
        again.close()
    again = Session(boxes, encoder=encoder, log=log)
    earlier = unfinished(log)
    assert earlier is not None
    restore(again, earlier, lambda note: None)
    again.redo()
    again.redo()
    assert again.done == ("make the green thing blue", "delete the blue thing") and not again.redoable
    assert len(again.scene.cloud) == len(boxes.cloud) - 343
    again.close()


def test_the_scene_is_exported_as_a_page_to_download(server: Server, page: Page) -> None:
    cookie = {"Cookie": server.cookie}
    assert asked(server.port, "/made.html", cookie)[0] == 404
    link = page.ask("export")["link"]
    status, headers, body = asked(server.port, link, cookie)
    assert status == 200 and body.startswith(b"<!doctype html>")
    assert headers["content-disposition"] == "attachment; filename*=UTF-8''test.html"
    assert asked(server.port, link)[0] == 403


@pytest.mark.slow
def test_an_answer_shows_what_it_rests_on(server: Server, page: Page) -> None:
    said = page.ask("say", text="is there a green thing?")
    assert said["ok"] and len(said["pictures"]) == 1
    path, cookie = said["pictures"][0], {"Cookie": server.cookie}
    status, headers, body = asked(server.port, path, cookie)
    assert status == 200 and headers["content-type"] == "image/png"
    shown = np.asarray(Image.open(io.BytesIO(body)))
    assert shown.shape == (512, 768, 3) and len(np.unique(shown.reshape(-1, 3), axis=0)) > 100
    assert asked(server.port, path)[0] == 403  # only with the cookie
    assert asked(server.port, "/pictures/2.png", cookie)[0] == 404
    assert page.ask("say", text="make the green thing blue")["pictures"] == []


def test_pictures_are_drawn_when_nothing_waits_and_the_oldest_go() -> None:
    gallery = Gallery()
    first = gallery.add(lambda: b"1")
    waiting = gallery.at(first)
    assert waiting is not None and not waiting.done()
    failing = gallery.add(lambda: bytes(-1))
    while gallery.draw_next():
        pass
    assert waiting.result() == b"1"
    broken = gallery.at(failing)
    assert broken is not None and isinstance(broken.exception(), ValueError)
    paths = [gallery.add(lambda: b"") for _ in range(KEPT)]
    assert gallery.at(first) is None and all(gallery.at(path) is not None for path in paths)
