"""The page of `scenewright view` in a real browser, against the real server: a conversation with words and clicks, both
themes, a phone's width, keys alone, and what axe finds."""

from __future__ import annotations

import re
import shutil
import subprocess
from typing import Any

import numpy as np
import pytest
from served_page import DESK, PHONE, Page, Server

pytestmark = [pytest.mark.browser, pytest.mark.slow]

AXE = "axe-core@4"


def test_a_conversation_with_words_and_clicks(browser: Any, server: Server) -> None:
    page = Page(browser, server.address, DESK)
    page.require_a_picture()
    first = page.pixels()
    page.picture("start")

    # A question, then a click, and "it" means what was clicked.
    asked = page.say("how many chairs are there?")
    assert asked["ok"] and ("2" in asked["text"] or "two" in asked["text"]), asked
    armchair = page.thing("armchair")
    page.click(armchair)
    page.until(f"store.state.selection.groups.includes({armchair['group']})")
    made = page.say("make it teal")
    assert made["ok"] and made["receipt"] and all(row["passed"] for row in made["receipt"]), made
    red, green, blue = bytes.fromhex(page.thing("armchair")["color"][1:])
    assert red < min(green, blue), (red, green, blue)
    assert np.abs(page.pixels() - first).max() > 60
    page.require_a_picture()
    page.picture("teal")

    # What is ambiguous is asked back; a click on a number in the picture answers.
    chairs = page.state("store.state.things.filter((thing) => thing.name === 'chair').length")
    unclear = page.say("remove the chair")
    assert not unclear["ok"]
    page.until("store.state.question !== null && store.state.question.candidates.length === 2")
    page.picture("question")
    page.tab.locator("#numbers .number").nth(1).click()
    assert page.answered()["ok"], page.turns()
    page.until("store.state.question === null")
    page.until(f"store.state.things.filter((thing) => thing.name === 'chair').length === {chairs - 1}")
    page.require_a_picture()

    # Ctrl-Z brings it back.
    page.tab.keyboard.press("Control+z")
    assert page.answered()["ok"]
    page.until(f"store.state.things.filter((thing) => thing.name === 'chair').length === {chairs}")

    # The handle writes a move, as words would.
    table = page.thing("coffee table")
    page.click(table)
    page.until(f"store.state.selection.groups.includes({table['group']})")
    page.tab.locator("#canvas").focus()
    page.tab.keyboard.press("m")
    handle = page.tab.locator("#drawn .handle.right .tip").bounding_box()
    x, y = handle["x"] + handle["width"] / 2, handle["y"] + handle["height"] / 2
    page.tab.mouse.move(x, y)
    page.tab.mouse.down()
    page.tab.mouse.move(x - 20, y, steps=3)
    page.tab.mouse.move(x - 45, y, steps=3)
    page.picture("gizmo")
    page.tab.mouse.up()
    moved = page.answered()
    assert moved["ok"], page.turns()
    before, after = (np.array(one["box"]["centre"]) for one in (table, page.thing("coffee table")))
    far = float(np.linalg.norm(after - before))
    said = re.search(r"left ([\d.]+) m", page.turns()[-1][0])
    assert said and abs(far - float(said[1])) < 0.02, (page.turns()[-1], far)
    page.require_a_picture()
    page.picture("moved")

    # Nothing of it was an error, and the log holds the steps that were not undone.
    assert page.state("store.state.history[0].text") == "make it teal"
    assert page.state("store.state.history.length") == 2
    assert not page.faults
    page.close()


def test_before_and_after_hiding_and_a_second_tab(browser: Any, server: Server) -> None:
    page = Page(browser, server.address, DESK)
    sofa = page.thing("sofa")
    page.tab.click(f"[data-stop=name-{sofa['group']}]")
    page.until(f"store.state.selection.groups.includes({sofa['group']})")
    assert page.say("make it red")["ok"]
    page.tab.locator("#canvas").focus()
    page.tab.keyboard.press("Escape")
    page.until("store.state.selection.groups.length === 0")
    page.settle()
    now = page.pixels()
    page.tab.keyboard.press("c")
    page.until("viewer.comparing")
    page.tab.locator("#compare-share").fill("1")
    page.settle()
    was = page.pixels()
    assert np.abs(now - was).max() > 60  # the picture before is another
    page.tab.locator("#compare-share").fill("0")
    page.settle()
    assert np.abs(page.pixels() - now).mean() < 1
    page.tab.locator("#compare-share").fill("0.5")
    page.settle()
    page.picture("compare")
    page.tab.locator("#canvas").focus()
    page.tab.keyboard.press("c")
    page.settle()

    page.tab.hover(f"[data-stop=name-{sofa['group']}]")
    page.tab.click(f"[data-stop=eye-{sofa['group']}]")
    page.tab.mouse.move(640, 300)
    page.settle()
    assert np.abs(page.pixels() - now).max() > 60
    assert page.thing("sofa") is not None  # hidden, not deleted

    other = page.context.new_page()
    other.goto(server.address.split("?")[0])
    other.wait_for_timeout(3000)
    assert other.evaluate("window.scenewright.store.state.history.length") == 1
    page.close()


def test_a_connection_that_breaks_loses_nothing(browser: Any, server: Server) -> None:
    page = Page(browser, server.address, DESK)
    before = page.pixels()
    page.context.set_offline(True)
    page.tab.evaluate("window.sockets.at(-1).close()")
    page.until("store.state.connection === 'lost'")
    page.tab.fill("#words", "make the sofa red")
    page.tab.press("#words", "Enter")
    page.picture("lost")
    page.context.set_offline(False)
    page.until("store.state.connection === 'ready'")
    assert page.answered()["ok"], page.turns()
    assert np.abs(page.pixels() - before).max() > 60
    page.close()


def test_keys_alone_do_it(browser: Any, server: Server) -> None:
    page = Page(browser, server.address, DESK, reduced_motion="reduce")
    page.tab.keyboard.press("Tab")
    assert page.tab.evaluate("document.activeElement.className") == "skip"
    page.tab.locator("#canvas").focus()
    page.tab.keyboard.press("?")
    assert page.tab.locator("#help").is_visible()
    page.tab.keyboard.press("Escape")
    page.tab.keyboard.press("b")
    assert page.state("store.state.tool") == "box"
    page.tab.keyboard.press("v")
    first = page.tab.locator("#things-list button[tabindex='0']")
    assert first.count() == 1  # one tab stop for the whole list
    first.focus()
    page.tab.keyboard.press("ArrowDown")
    page.tab.keyboard.press("ArrowDown")
    page.tab.keyboard.press("Enter")
    page.until("store.state.selection.groups.length === 1")
    page.tab.locator("#canvas").focus()
    page.tab.keyboard.press("t")
    page.tab.locator("#drawn .handle.up").focus()
    for _ in range(3):
        page.tab.keyboard.press("ArrowRight")
    assert "15°" in page.tab.locator("#drawn .handle.up").get_attribute("aria-valuetext")
    page.tab.keyboard.press("Enter")
    assert page.answered()["ok"], page.turns()
    page.tab.keyboard.press("/")
    assert page.tab.evaluate("document.activeElement.id") == "words"
    page.close()


def test_a_box_selects_and_text_is_no_html(browser: Any, server: Server) -> None:
    page = Page(browser, server.address, DESK)
    page.tab.keyboard.press("b")
    box = page.tab.locator("#canvas").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.tab.mouse.move(x - 40, y - 40)
    page.tab.mouse.down()
    page.tab.mouse.move(x + 40, y + 40, steps=4)
    page.tab.mouse.up()
    page.until("store.state.selection.ranges.length > 0 || store.state.selection.groups.length > 0")
    page.settle()
    page.picture("box")
    said = page.say("<img src=x onerror='window.broken = true'> <b>bold</b>")
    assert not said["ok"]
    assert page.tab.locator("#turns b:not(.number), #turns img").count() == 0
    assert page.tab.evaluate("window.broken") is None
    page.close()


@pytest.fixture(scope="module")
def axe(tmp_path_factory: pytest.TempPathFactory) -> str:
    """axe-core's source (MPL-2.0), fetched for this run and kept nowhere."""
    if shutil.which("npm") is None:
        pytest.skip("npm is not installed, so axe-core cannot be fetched")
    folder = tmp_path_factory.mktemp("axe")
    fetch = ["npm", "install", "--prefix", str(folder), "--no-audit", "--no-fund", "--ignore-scripts", AXE]
    try:
        done = subprocess.run(fetch, capture_output=True, text=True, timeout=120)
    except subprocess.TimeoutExpired:
        pytest.skip("npm did not fetch axe-core within two minutes")
    if done.returncode:
        pytest.skip(f"npm cannot fetch axe-core: {done.stderr.strip()[-200:]}")
    return (folder / "node_modules" / "axe-core" / "axe.min.js").read_text()


RULES = """axe.run(document, {resultTypes: ["violations"]}).then(({violations}) => violations.map(
  ({id, impact, nodes}) => `${impact}: ${id}: ${nodes.map((node) => node.html.slice(0, 120)).join(" | ")}`))"""


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("size", [DESK, PHONE], ids=["desk", "phone"])
def test_axe_finds_nothing_serious(browser: Any, server: Server, axe: str, size: dict[str, int], theme: str) -> None:
    touch = {"has_touch": True, "is_mobile": True, "device_scale_factor": 2} if size is PHONE else {}
    page = Page(browser, server.address, size, theme=theme, bypass_csp=True, **touch)
    page.tab.add_script_tag(content=axe)
    name = f"{'phone' if size is PHONE else 'desk'}-{theme}"

    def require_no_violations() -> None:
        found = page.tab.evaluate(RULES)
        assert not [one for one in found if one.startswith(("serious", "critical"))], found

    require_no_violations()
    page.picture(f"{name}-start")
    page.click(page.thing("armchair"))
    page.until("store.state.selection.groups.length === 1")
    page.say("make it teal")
    page.say("remove the chair")
    page.until("store.state.question !== null")
    page.tab.locator("#canvas").focus()
    page.tab.keyboard.press("t")
    page.settle()
    require_no_violations()
    page.picture(f"{name}-question")
    page.tab.keyboard.press("c")
    page.tab.wait_for_timeout(800)
    page.tab.keyboard.press("?")
    require_no_violations()
    page.tab.keyboard.press("Escape")
    if size is PHONE:
        page.tab.keyboard.press("l")
        page.tab.tap(".more")
        require_no_violations()
        page.tab.wait_for_timeout(400)
        page.picture(f"{name}-panels")
        assert page.tab.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    page.close()
