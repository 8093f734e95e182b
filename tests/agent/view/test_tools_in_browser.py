"""What a person does with the tools of the page, in a real browser: box and brush, parts, hiding, ways to move, before
and after, files, keys alone, long work."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from served_page import DESK, PHONE, Page, Server

from scenewright.gaussians.files import load

pytestmark = [pytest.mark.browser, pytest.mark.slow]

COUNT = "store.state.selection.ranges.reduce((sum, [, count]) => sum + count, 0)"
EYE = 1.6  # metres above the floor, of a person who walks


@pytest.fixture
def page(browser: Any, server: Server) -> Any:
    made = Page(browser, server.address, DESK)
    yield made
    assert not made.faults, made.faults
    made.close()


def selected(page: Page, *spots: tuple[float, float], keys: tuple[str, ...] = ()) -> int:
    """How many Gaussians are selected one by one after a drag, or of one spot a click, is answered."""
    answers = page.tab.evaluate("window.answers")
    page.drag(*spots, keys=keys)
    page.until(f"window.answers > {answers}")
    page.settle()
    return int(page.state(COUNT))


def text(page: Page) -> str:
    found: str = page.state("store.state.selection.text")
    return found


def test_a_box_and_a_brush_add_and_take_away(page: Page) -> None:
    x, y = page.at(page.thing("sofa"))
    origin = page.tab.locator("#canvas").bounding_box()
    x, y = x - origin["x"], y - origin["y"]
    page.press("b")
    boxed = selected(page, (x - 30, y - 15), (x + 30, y + 15))
    wider = selected(page, (x - 60, y - 15), (x - 20, y + 15), keys=("Shift",))
    assert wider > boxed > 0
    rest = selected(page, (x - 30, y - 15), (x + 30, y + 15), keys=("Alt",))
    assert 0 < rest < wider and rest + boxed >= wider  # what the first box took is gone
    page.tab.get_by_role("button", name="Add", exact=True).click()
    again = selected(page, (x - 30, y - 15), (x + 30, y + 15))
    assert again >= rest + 0.9 * boxed
    page.tab.get_by_role("button", name="Take away", exact=True).click()
    assert selected(page, (x - 150, y - 120), (x + 150, y + 120)) == 0  # also what a coarser look does not see
    page.tab.get_by_role("button", name="New", exact=True).click()

    page.press("n")
    page.tab.get_by_label("Size of the brush").fill("8")
    thin = selected(page, (x - 20, y), (x + 20, y))
    page.tab.get_by_label("Size of the brush").fill("30")
    thick = selected(page, (x - 20, y), (x + 20, y))
    assert thick > 1.5 * thin > 0
    page.picture("brush")
    page.press("v")
    rows = sum(thing["rows"] for thing in page.state("store.state.things"))
    assert page.say("delete it")["ok"], page.turns()
    page.until(f"store.state.things.reduce((sum, thing) => sum + thing.rows, 0) <= {rows - thick}")


def test_shift_adds_and_takes_away_and_a_click_on_nothing_clears(page: Page) -> None:
    sofa, armchair = page.thing("sofa"), page.thing("armchair")
    page.click(sofa)
    page.until(f"store.state.selection.groups.join() === '{sofa['group']}'")
    page.click(armchair, keys=("Shift",))
    page.until("store.state.selection.groups.length === 2")
    assert page.tab.locator("#selected p").inner_text() == "sofa, armchair"
    page.picture("two")
    page.click(sofa, keys=("Shift",))
    page.until(f"store.state.selection.groups.join() === '{armchair['group']}'")
    place = page.tab.locator("#canvas").bounding_box()
    page.tab.mouse.click(place["x"] + place["width"] - 40, place["y"] + 30)  # on nothing
    page.until("store.state.selection.groups.length === 0 && store.state.selection.ranges.length === 0")


def test_hidden_is_not_deleted(page: Page) -> None:
    sofa = page.thing("sofa")
    page.settle()
    digest, first = page.digest(), page.pixels()
    middle = page.at(sofa)
    page.tab.hover(f"[data-stop=name-{sofa['group']}]")
    page.tab.click(f"[data-stop=eye-{sofa['group']}]")
    page.tab.mouse.move(640, 300)
    page.settle()
    gone = page.pixels()
    assert np.abs(gone - first).max() > 60
    page.tab.mouse.click(*middle)  # what is hidden is not clicked either
    page.tab.wait_for_timeout(300)
    assert sofa["group"] not in page.state("store.state.selection.groups")
    asked = page.say("how many sofas are there?")
    assert asked["text"] == "There is a sofa."
    assert page.digest() == digest and page.state("store.state.history.length") == 0
    page.press("Escape", "Shift+H")
    page.until("store.state.selection.groups.length === 0 && store.state.hidden.size === 0")
    page.tab.mouse.move(640, 790)
    page.settle()
    assert np.abs(page.pixels() - first).mean() < 0.5
    page.click(sofa)
    page.until(f"store.state.selection.groups.includes({sofa['group']})")
    page.press("h")
    page.settle()
    page.until("store.state.hidden.size === 1")
    page.press("h")
    page.until("store.state.hidden.size === 0")


def test_flying_goes_where_one_looks_and_walking_stays_on_the_floor(page: Page) -> None:
    def camera() -> dict[str, np.ndarray[Any, Any]]:
        found = page.state("viewer.camera")
        return {name: np.array(found[name]) for name in ("position", "forward")}

    def hold(key: str) -> None:
        page.tab.locator("#canvas").focus()
        x, y, z = camera()["position"]
        page.tab.keyboard.down(key)
        page.until(f"Math.hypot(...viewer.camera.position.map((c, i) => c - [{x}, {y}, {z}][i])) > 0.1")
        page.tab.keyboard.up(key)
        page.settle()

    start = camera()
    page.press("2")
    page.drag((300, 300), (420, 300))
    turned = camera()
    assert np.allclose(turned["position"], start["position"]) and turned["forward"] @ start["forward"] < 0.99
    hold("w")
    flown = camera()
    way = flown["position"] - turned["position"]
    assert np.linalg.norm(way) > 0.05 and way @ turned["forward"] > 0.99 * np.linalg.norm(way)
    hold("e")
    assert camera()["position"][2] > flown["position"][2] + 0.03

    page.press("3")
    page.settle()
    scene = page.state("store.state.scene")
    height = scene["floor"] + EYE / (scene["metres_per_unit"] or 1)
    assert abs(camera()["position"][2] - height) < 1e-3 and abs(camera()["forward"][2]) < 1e-3
    page.drag((300, 300), (300, 380))
    before = camera()
    assert abs(before["forward"][2]) > 0.1  # looks up or down, and stays level when it walks
    hold("w")
    walked = camera()
    assert abs(walked["position"][2] - height) < 1e-3
    assert np.linalg.norm(walked["position"] - before["position"]) > 0.05
    page.picture("walk")
    page.press("1")
    page.drag((300, 300), (380, 300))
    assert np.linalg.norm(camera()["position"] - walked["position"]) > 0.05  # orbits


def test_the_slider_shows_what_was_and_goes_when_nothing_is_left_to_compare(page: Page) -> None:
    assert page.tab.locator("[data-command=compare]").get_attribute("aria-disabled") == "true"
    assert page.say("make the sofa red")["ok"]
    page.press("c")
    page.until("viewer.comparing")
    thumb = page.tab.locator("#compare-share")
    page.settle()
    half = page.pixels()
    box = page.tab.locator("#canvas").bounding_box()
    page.tab.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.tab.mouse.down()
    page.tab.mouse.move(box["x"] + 0.9 * box["width"], box["y"] + box["height"] / 2, steps=4)
    page.tab.mouse.up()
    assert float(thumb.input_value()) > 0.8
    page.settle()
    assert np.abs(page.pixels() - half).max() > 60
    thumb.press("ArrowLeft")
    assert float(thumb.input_value()) < 0.9
    undone = page.say("undo")
    assert undone["ok"], undone
    page.until("store.state.compare === null")
    assert page.tab.locator("#compare").is_hidden()


def test_the_scene_is_saved_exported_and_photographed(page: Page, server: Server) -> None:
    assert page.say("make the sofa red")["ok"]
    page.press("Control+s")
    name = page.tab.locator("#save-name")
    assert name.input_value() == "room-edited.ply"
    page.picture("save")
    name.fill("../outside.ply")
    page.tab.keyboard.press("Enter")
    assert page.tab.locator("#save").is_visible()  # no such name
    name.fill("mine.ply")
    page.tab.keyboard.press("Enter")
    saved = page.answered()
    assert saved["ok"] and "mine.ply" in saved["text"], saved
    assert len(load(server.folder / "mine.ply").cloud) == page.state("store.state.scene.slots")
    page.press("Control+s")
    name.fill("mine.ply")
    page.tab.get_by_role("button", name="Save", exact=True).last.click()
    again = page.answered()
    assert not again["ok"] and "exists" in again["text"]
    page.press("Control+s")
    name.fill("mine.ply")
    page.tab.get_by_label("Replace a file of this name").check()
    page.tab.get_by_role("button", name="Save", exact=True).last.click()
    assert page.answered()["ok"], page.turns()
    assert not list(server.folder.parent.glob("outside*"))

    with page.tab.expect_download() as taken:
        page.press("p")
    assert taken.value.suggested_filename == "room.png"
    shot = np.asarray(Image.open(io.BytesIO(Path(taken.value.path()).read_bytes())).convert("RGB"), np.int16)
    assert shot.shape == page.pixels().shape and np.abs(shot - page.pixels()).mean() < 1
    page.press("x")
    assert page.answered()["ok"]
    with page.tab.expect_download() as taken:
        page.tab.locator("#turns a.download").click()
    assert taken.value.suggested_filename == "room.html"
    assert Path(taken.value.path()).read_bytes().startswith(b"<!doctype html>")


def test_a_conversation_by_keys_alone(page: Page) -> None:
    chairs = "store.state.things.filter((thing) => thing.name === 'chair').length"

    def typed(words: str) -> dict[str, Any]:
        page.tab.keyboard.type(words)
        page.tab.keyboard.press("Enter")
        return page.answered()

    page.tab.keyboard.press("/")
    asked = typed("how many chairs are there?")
    assert asked["ok"] and len(asked["pictures"]) == 1
    page.tab.locator("#turns .evidence img").wait_for()
    page.until("document.querySelector('#turns .evidence img').naturalWidth === 768")
    page.tab.keyboard.press("Shift+Tab")
    page.tab.keyboard.press("Enter")  # the picture, larger
    assert page.tab.locator("#picture img").is_visible()
    page.picture("evidence")
    page.tab.keyboard.press("Escape")
    page.tab.keyboard.press("/")
    assert not typed("remove the chair")["ok"]
    page.until("store.state.question !== null")
    page.tab.keyboard.press("Escape")  # from the words to the picture
    page.tab.keyboard.press("2")
    assert page.answered()["ok"], page.turns()
    page.until(f"{chairs} === 1")
    page.tab.keyboard.press("Control+z")
    assert page.answered()["ok"]
    page.until(f"{chairs} === 2")
    page.tab.keyboard.press("/")
    assert not typed("remove the chair")["ok"]
    page.until("store.state.question !== null")
    assert typed("1")["ok"]  # the number as words
    page.until(f"{chairs} === 1")
    page.tab.keyboard.press("ArrowUp")
    assert page.tab.locator("#words").input_value() == "1"
    page.tab.keyboard.press("ArrowUp")
    assert page.tab.locator("#words").input_value() == "remove the chair"
    page.tab.locator("#words").fill("")
    assert typed("/why the sofa")["ok"]
    assert not typed("no such thing as this")["ok"]
    page.tab.keyboard.press("Control+z")  # the field is empty, so it is the scene's
    assert page.answered()["ok"]
    page.until(f"{chairs} === 2")


def test_long_work_tells_its_stage_and_a_second_click_takes_a_part(
    browser: Any, room_file: Path, tmp_path: Path
) -> None:
    bare = tmp_path / "bare"
    bare.mkdir()
    (bare / "room.ply").write_bytes(room_file.read_bytes())  # without its field: words begin with finding the things
    (tmp_path / "work").mkdir()
    server = Server(bare / "room.ply", tmp_path / "work")
    try:
        page = Page(browser, server.address, DESK)
        assert not page.state("store.state.embedded") and page.tab.locator("#things-note").inner_text()
        page.tab.fill("#words", "make the sofa red")
        page.tab.press("#words", "Enter")
        page.tab.locator("#turns progress").wait_for(state="visible")
        page.tab.locator("#working").wait_for(state="visible")
        page.picture("working")
        assert page.tab.locator("#turns .wait").inner_text().endswith("…")
        answer = page.answered()
        assert answer["ok"], page.turns()
        stages = page.tab.evaluate("window.stages")
        assert len(stages) > 3 and all(0 <= share <= 1 for _, share in stages), stages
        assert len({stage for stage, _ in stages}) > 1
        assert page.tab.locator("#working").is_hidden() and page.tab.locator("#turns progress").count() == 0
        assert page.state("store.state.embedded")

        armchair = page.thing("armchair")
        page.click(armchair)
        page.until(f"store.state.selection.groups.join() === '{armchair['group']}'")
        x, y = page.at(armchair)
        place = page.tab.locator("#canvas").bounding_box()
        part = selected(page, (x - place["x"], y - place["y"]))
        assert 0 < part < armchair["rows"] and "of the armchair" in text(page), text(page)
        page.settle()
        page.picture("part")
        page.click(armchair)
        page.until(f"store.state.selection.groups.join() === '{armchair['group']}'")  # the thing again
        page.close()
    finally:
        server.close()


def test_a_tab_that_is_loaded_again_keeps_its_conversation(page: Page) -> None:
    assert page.say("how many chairs are there?")["ok"]
    assert page.say("make the sofa red")["ok"]
    page.say("remove the chair")
    page.drag((300, 300), (380, 320))
    sofa = page.thing("sofa")["group"]
    page.tab.hover(f"[data-stop=name-{sofa}]")
    page.tab.click(f"[data-stop=eye-{sofa}]")
    before, camera = page.turns(), page.state("viewer.camera")
    page.tab.reload()
    page.until("store.state.connection === 'ready' && store.state.question !== null")
    assert page.turns() == before
    assert page.state("viewer.camera") == camera and page.state("[...store.state.hidden]") == [sofa]
    page.until("document.querySelector('#turns .evidence img').naturalWidth === 768")
    page.tab.locator("#numbers .number").first.click()
    assert page.answered()["ok"]
    assert len(page.turns()) == len(before) + 1
    other = page.context.new_page()  # a new tab is told the steps
    other.goto(page.tab.url)
    other.wait_for_selector("#turns .earlier")
    other.wait_for_timeout(300)
    assert other.locator("#turns .earlier").count() == 2


def test_a_phone_asks_with_the_picture_in_sight(browser: Any, server: Server) -> None:
    page = Page(browser, server.address, PHONE, has_touch=True, is_mobile=True)
    page.tab.locator("#chat-handle").tap()
    page.until("document.body.classList.contains('sheet-up')")
    page.say("remove the chair")
    page.until("store.state.question !== null && !document.body.classList.contains('sheet-up')")
    page.tab.wait_for_timeout(300)
    page.settle()
    for number in page.tab.locator("#numbers .number").all():
        place = number.bounding_box()
        assert place is not None and place["width"] >= 30
        middle = [place["x"] + place["width"] / 2, place["y"] + place["height"] / 2]
        top = page.tab.evaluate("(at) => document.elementFromPoint(...at).className", middle)
        assert top == "number"  # nothing lies over it
    page.picture("phone-question")
    page.tab.locator("#numbers .number").first.tap()
    assert page.answered()["ok"], page.turns()
    page.until("store.state.question === null")
    assert not page.faults
    page.close()
