"""The page of `scenewright view` in a real browser, from a server in a process of its own."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from scenewright.gaussians.files import save
from scenewright.gaussians.language.field.store import save_field
from scenewright.planners.rooms.build import build
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.planners.rooms.node import Node, RoomShape

DESK, PHONE = {"width": 1280, "height": 800}, {"width": 390, "height": 844}
PICTURES = os.environ.get("SCENEWRIGHT_PAGE_PICTURES")  # a folder for screenshots, to be looked at
SECONDS = 60.0  # for any one answer: the machine may be busy

THINGS = (  # name, colour, size, centre, yaw
    ("sofa", "gray", (1.9, 0.9, 0.8), (0, 1.5, 0.4), 0),
    ("armchair", "orange", (0.8, 0.8, 0.9), (1.5, 0, 0.45), -90),
    ("chair", "white", (0.45, 0.45, 0.9), (-1.6, 0.5, 0.45), 90),
    ("chair", "white", (0.45, 0.45, 0.9), (-1.6, -0.7, 0.45), 90),
    ("coffee table", "brown", (1.1, 0.6, 0.42), (0, 0.2, 0.21), 0),
    ("floor lamp", "black", (0.4, 0.4, 1.6), (1.7, 1.6, 0.8), 0),
    ("potted plant", "green", (0.4, 0.4, 0.9), (-1.8, 1.6, 0.45), 0),
)
ROOM = SceneGraph(
    room=RoomShape(size=(4.6, 4.2, 2.5)),
    nodes=tuple(
        Node(id=i, label=label, color=color, size=size, position=at, yaw=yaw, support="floor")
        for i, (label, color, size, at, yaw) in enumerate(THINGS, 1)
    ),
)


# -- what runs ---------------------------------------------------------------------------------------------------------


def save_room(folder: Path) -> Path:
    """The room as a file with its language field."""
    scene = build(ROOM, detail=0.5, seed=3)
    path = folder / "room.ply"
    save(scene, path)
    save_field(scene, path)
    return path


class Server:
    """`scenewright view` on a copy of a scene, in a process of its own."""

    def __init__(self, scene: Path, folder: Path) -> None:
        self.folder = folder
        for part in scene.parent.glob(f"{scene.name}*"):
            shutil.copy(part, folder / part.name)
        view = [sys.executable, "-m", "scenewright", "view", str(folder / scene.name)]
        command = [*view, "--no-open", "--port", "0", "--log", str(folder / "log.jsonl")]
        told = folder / "told.txt"
        with told.open("w") as out:
            self.process = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT, cwd=folder)
        end = time.monotonic() + SECONDS
        while (found := re.search(r"http://127\.0\.0\.1:\d+/\?token=\S+", told.read_text())) is None:
            if self.process.poll() is not None or time.monotonic() > end:
                raise AssertionError(f"the server told no address: {told.read_text()}")
            time.sleep(0.1)
        self.address = found[0]

    def close(self) -> None:
        self.process.terminate()
        self.process.wait(20)


KEEP_SOCKETS = """window.WebSocket = class extends WebSocket {
  constructor(...given) {
    super(...given);
    (window.sockets ??= []).push(this);
    window.stages ??= [];
    window.answers ??= 0;
    this.addEventListener("message", ({data}) => {
      const told = typeof data === "string" ? JSON.parse(data) : {};
      if (told.type === "state") window.told = told;
      if (told.type === "said" || told.type === "error") window.answers++;
      if (told.type === "progress") window.stages.push([told.stage, told.share]);
    });
  }
};"""


class Page:
    """A tab with the page, and what a person does there."""

    def __init__(self, browser: Any, address: str, size: dict[str, int], *, theme: str = "light", **more: Any) -> None:
        self.context = browser.new_context(viewport=size, color_scheme=theme, **more)
        self.tab = self.context.new_page()
        self.faults: list[str] = []
        self.tab.on("pageerror", lambda error: self.faults.append(str(error)))
        self.tab.on("console", lambda said: self.faults.append(said.text) if said.type == "error" else None)
        self.tab.add_init_script(KEEP_SOCKETS)
        self.tab.goto(address)
        self.tab.wait_for_url(re.compile(r"/$"))  # the token's page goes on by itself
        self.until("store.state.connection === 'ready'")
        self.settle()

    def state(self, expression: str) -> Any:
        return self.tab.evaluate(f"(() => {{ const {{store, viewer}} = window.scenewright; return {expression}; }})()")

    def until(self, expression: str, seconds: float = SECONDS) -> None:
        """Wait until something holds. (The page's own rules forbid what Playwright's `wait_for_function` does.)"""
        for _ in range(round(seconds * 20)):
            if self.tab.evaluate("Boolean(window.scenewright)") and self.state(expression):
                return
            self.tab.wait_for_timeout(50)
        raise AssertionError(f"never: {expression}; turns: {self.turns()}; faults: {self.faults}")

    def settle(self) -> None:
        """Wait until the picture is that of the present state."""
        self.tab.evaluate("window.scenewright.viewer.idle()")
        self.tab.wait_for_timeout(100)

    def turns(self) -> Any:
        return self.state("store.state.turns.map((turn) => [turn.text, turn.answer?.ok, turn.answer?.text])")

    def answered(self) -> dict[str, Any]:
        """The answer to the last turn, once it is there."""
        self.until("store.state.turns.length > 0 && store.state.turns.at(-1).answer !== null")
        self.settle()
        found: dict[str, Any] = self.state("store.state.turns.at(-1).answer")
        return found

    def say(self, text: str) -> dict[str, Any]:
        self.tab.fill("#words", text)
        self.tab.press("#words", "Enter")
        return self.answered()

    def thing(self, name: str, number: int = 0) -> Any:
        """One of the things in the list of the state."""
        return self.state(f"store.state.things.filter((thing) => thing.name === {name!r})[{number}]")

    def at(self, thing: Any) -> tuple[float, float]:
        """A pixel of the tab where a click meets a thing: the nearest to its middle that does."""
        found = self.state(
            f"""(() => {{
              const spot = viewer.project({thing["box"]["centre"]});
              for (let far = 0; far < 90; far += 6)
                for (let turn = 0; turn < 6.28; turn += 0.5) {{
                  const [x, y] = [spot.x + far * Math.cos(turn), spot.y + far * Math.sin(turn)];
                  if (viewer.pick(x, y)?.group === {thing["group"]}) return [x, y];
                }}
              return null;
            }})()"""
        )
        assert found is not None, f"the {thing['name']} is not to be seen"
        box = self.tab.locator("#canvas").bounding_box()
        return box["x"] + found[0], box["y"] + found[1]

    def click(self, thing: Any, **how: Any) -> None:
        self.tab.mouse.move(*self.at(thing))
        for key in how.get("keys", ()):
            self.tab.keyboard.down(key)
        self.tab.mouse.click(*self.at(thing))
        for key in how.get("keys", ()):
            self.tab.keyboard.up(key)

    def drag(self, *spots: tuple[float, float], keys: tuple[str, ...] = ()) -> None:
        """Press at the first of some pixels of the canvas, go through the others, let go."""
        box = self.tab.locator("#canvas").bounding_box()
        (x, y), *more = [(box["x"] + x, box["y"] + y) for x, y in spots]
        for key in keys:
            self.tab.keyboard.down(key)
        self.tab.mouse.move(x, y)
        self.tab.mouse.down()
        for x, y in more:
            self.tab.mouse.move(x, y, steps=3)
        self.tab.mouse.up()
        for key in keys:
            self.tab.keyboard.up(key)

    def press(self, *keys: str) -> None:
        """Keys while the picture has the focus."""
        self.tab.locator("#canvas").focus()
        for key in keys:
            self.tab.keyboard.press(key)

    def digest(self) -> str:
        """Of the scene as the server has it: of the last `state` message."""
        found: str = self.tab.evaluate("window.told.digest")
        return found

    def pixels(self) -> np.ndarray[Any, np.dtype[np.int16]]:
        """`[H, W, 3]` of the canvas itself, in 0..255: what lies over it is left out."""
        data = self.tab.evaluate(
            """async () => [...new Uint8Array(await (await window.scenewright.viewer.png()).arrayBuffer())]"""
        )
        return np.asarray(Image.open(BytesIO(bytes(data))).convert("RGB"), dtype=np.int16)

    def require_a_picture(self) -> None:
        """Never a blank canvas: many colours over most of it."""
        seen = self.pixels()
        assert (seen.max(axis=2) > 16).mean() > 0.3
        assert len(np.unique(seen.reshape(-1, 3) // 16, axis=0)) > 40

    def picture(self, name: str) -> None:
        if PICTURES:
            self.tab.screenshot(path=Path(PICTURES) / f"{name}.png")

    def close(self) -> None:
        self.context.close()
