"""The bar of time in a real browser: it plays, scrubs, survives edits, and goes when nothing moves any more."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from served_page import DESK, PHONE, Page, Server, save_room

from scenewright.gaussians.files import save
from scenewright.gaussians.language.field.loading import load
from scenewright.gaussians.language.field.store import save_field
from scenewright.gaussians.motion.motion import Motion, Track

pytestmark = [pytest.mark.browser, pytest.mark.slow]


@pytest.fixture(scope="module")
def moving_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The room in which the armchair turns and goes off to the left."""
    path = save_room(tmp_path_factory.mktemp("moving"))
    scene = load(path)
    assert scene.language is not None
    armchair = next(g for g in scene.language.groups if g.label == "armchair")
    leaves = np.isin(scene.cloud.group.numpy(), scene.language.leaves(armchair.id))
    ids, middle = scene.cloud.ids[leaves].numpy(), armchair.box.center
    turning = Track.hinge(ids, [0, 3], [0, 3.0], (0, 0, 1), middle)
    going = Track.along(ids, [0, 3], [middle, (middle[0] - 1.2, middle[1] - 1.0, middle[2])])
    moving = scene.replace(motion=Motion((turning, going), stop=3.0))
    save(moving, path, force=True)
    save_field(moving, path)
    return path


@pytest.fixture
def moving_server(moving_file: Path, tmp_path: Path, browser: Any) -> Any:
    running = Server(moving_file, tmp_path)
    yield running
    running.close()


def scrub(page: Page, time: float) -> None:
    page.tab.locator("#time").fill(str(time))
    page.until(f"Math.abs(store.state.time - {time}) < 0.01")
    page.tab.wait_for_timeout(400)
    page.settle()


def test_time_plays_scrubs_and_survives_edits(browser: Any, moving_server: Server) -> None:
    page = Page(browser, moving_server.address, DESK)
    bar = page.tab.locator("#timeline")
    assert bar.is_visible() and "0.0 of 3.0 s" in bar.inner_text()
    first = page.pixels()
    page.press("y")
    page.until("store.state.time > 0.5")
    page.press("y")
    page.until("!store.state.playing")
    page.settle()
    scrub(page, 3.0)
    last = page.pixels()
    page.picture("time")
    page.click(page.thing("armchair"))  # where it is at this time
    page.until("store.state.selection.text === 'armchair'")
    page.press("Escape")
    page.until("store.state.selection.text === ''")
    page.settle()
    assert (np.abs(last - first).max(axis=2) > 60).mean() > 0.005  # the armchair is elsewhere
    scrub(page, 0.0)
    assert np.abs(page.pixels() - first).max() <= 2  # packed positions are those of the load
    scrub(page, 3.0)
    assert page.say("make the armchair blue")["ok"], page.turns()
    page.tab.wait_for_timeout(600)
    page.settle()
    blue = page.pixels()
    away = np.abs(blue - last).max(axis=2) > 60
    assert 0.001 < away.mean() < 0.08  # it is blue where it was at that time
    before = page.state("store.state.motion.version")
    assert page.say("delete the armchair")["ok"], page.turns()
    page.until("store.state.motion === null")
    assert not bar.is_visible()
    page.say("undo")
    page.until(f"store.state.motion?.version === {before}")
    assert bar.is_visible()
    assert not page.faults, page.faults
    page.close()


def test_the_bar_fits_a_phone(browser: Any, moving_server: Server) -> None:
    phone = Page(browser, moving_server.address, PHONE)
    box, views = (phone.tab.locator(name).bounding_box() for name in ("#timeline", "#views"))
    assert box["x"] >= 0 and box["x"] + box["width"] <= PHONE["width"] and box["y"] + box["height"] <= views["y"]
    phone.picture("time-phone")
    phone.close()


def test_a_static_room_has_no_bar(browser: Any, server: Server) -> None:
    still = Page(browser, server.address, DESK)
    assert not still.tab.locator("#timeline").is_visible()
    still.close()
