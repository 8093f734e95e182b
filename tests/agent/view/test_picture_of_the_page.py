"""The picture of the page that the README shows: a composed room, a question with its evidence, an edit of what was
clicked, and candidates that are numbered in the picture. `make page-picture` writes it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from served_page import Page, Server

import scenewright as sw
from scenewright.gaussians.files import save
from scenewright.gaussians.language.field.store import save_field

pytestmark = [pytest.mark.browser, pytest.mark.slow]

ROOM = (
    "a bright living room with a grey sofa, an orange armchair, two white chairs, a coffee table, a floor lamp, "
    "a bookshelf and a potted plant"
)
SIZE = {"width": 1360, "height": 850}


def test_the_readme_shows_the_page(browser: Any, tmp_path: Path) -> None:
    scene, work = sw.compose(ROOM, seed=4).build(seed=4), tmp_path / "work"
    work.mkdir()
    save(scene, tmp_path / "room.ply")
    save_field(scene, tmp_path / "room.ply")
    server = Server(tmp_path / "room.ply", work)
    try:
        page = Page(browser, server.address, SIZE)
        armchair = page.thing("armchair")
        page.click(armchair)
        page.until(f"store.state.selection.groups.includes({armchair['group']})")
        assert page.say("make it teal")["ok"], page.turns()
        asked = page.say("how far is the sofa from the bookshelf?")
        assert len(asked["pictures"]) == 1
        page.until("document.querySelector('#turns .evidence img')?.naturalWidth === 768")
        page.click(armchair)
        assert not page.say("remove the chair")["ok"]
        page.until("store.state.question?.candidates.length === 2")
        page.tab.mouse.move(700, 840)
        page.settle()
        page.require_a_picture()
        assert page.tab.locator("#numbers .number:visible").count() == 2
        page.picture("view")
        assert not page.faults
        page.close()
    finally:
        server.close()
