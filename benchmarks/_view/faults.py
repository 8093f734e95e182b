"""The server of the page under faults and strangers: what is lost, what is refused, and how much memory it takes.

`measure` gives rows for `bench view`. The scene is small: what is measured does not depend on its size.
"""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any

from websockets.exceptions import WebSocketException

from ...agent.session.history import looks_alike
from ...agent.session.log import read_log
from ...agent.session.log_sessions import problems
from ...agent.session.session import Session
from ...agent.view.server import HOST
from ...gaussians.assets.furnishing.furnish import furnish
from ...gaussians.files import save
from .client import Page, Server, asked, connected, entered, same, served

CUTS, QUICK_CUTS = 50, 8
MESSAGES, QUICK_MESSAGES = 10_000, 500
HUGE, QUICK_HUGE = 1 << 30, 1 << 26
KILLS, QUICK_KILLS = 5, 1
_NOTHING: dict[str, Any] = {"type": "select_slots", "mode": "add", "ranges": []}  # leaves the selection as it is
_COLORS = ("blue", "red", "green", "yellow", "teal")


def measure(quick: bool) -> list[dict[str, Any]]:
    """Rows with `what`, `times`, and what was found: all of `same`, `log_whole`, `refused` must be true, and `changed`
    false; `grown` is how many bytes the server's resident memory grew."""
    seed = 17
    with tempfile.TemporaryDirectory() as folder:
        scene = furnish(seed, detail=0.05).scene
        log = Path(folder) / "cuts.jsonl"
        with served(Session(scene, planner="grammar", log=log)) as server:
            rows = [cuts(server, log, QUICK_CUTS if quick else CUTS, seed)]
        rows.append(kills(Path(folder), QUICK_KILLS if quick else KILLS, seed))
        with served(Session(scene, planner="grammar")) as server:
            count, before = (QUICK_MESSAGES if quick else MESSAGES), resident()
            wrong = random_messages(server, count, seed)
            grown = resident() - before
            row = {"what": "random messages", "times": count, "refused": not wrong, "changed": bool(wrong)}
            rows += [{**row, "grown": grown}, *strangers(server, QUICK_HUGE if quick else HUGE)]
    return rows


def cuts(server: Server, log: Path, times: int, seed: int) -> dict[str, Any]:
    """Cut the connection of one tab at random moments, before and after its messages are answered, while another edits;
    after each cut the tab shows what the server has."""
    rng = random.Random(seed)
    right = 0
    with Page(server.port, server.cookie) as page, Page(server.port, server.cookie) as other:
        other.ask("select", mode="set", group=_a_thing(other))
        for _ in range(times):
            if rng.random() < 0.5:
                page.send({"type": "operate", "id": 1, "ops": [_recolor(rng)]})
                for _ in range(rng.randrange(3)):
                    if page.take()["type"] == "error":  # nothing follows a refusal
                        break
            page.cut()
            for _ in range(rng.randrange(3)):
                other.ask("operate", ops=[_recolor(rng)]) if rng.random() < 0.7 else other.ask("undo")
            page.connect()
            other.ask(**_NOTHING)  # what the first tab asked for is done by then
            while page.state["digest"] != other.state["digest"] or page.revision != other.revision:
                page.take()
            right += same(page, server.hub) and page.state["digest"] == server.hub.session.digest
    whole = not problems(read_log(log))
    return {"what": "connection cut", "times": times, "same": right == times, "right": right, "log_whole": whole}


def kills(folder: Path, times: int, seed: int) -> dict[str, Any]:
    """Kill a server with SIGKILL, right after an answer, and start it again: it has what was done."""
    rng = random.Random(seed)
    path, log = folder / "room.ply", folder / "kills.jsonl"
    save(furnish(seed, detail=0.05).scene, path)
    right, digest, selected = 0, None, None
    for time in range(times + 1):
        process, port, cookie = _started(path, log)
        try:
            with Page(port, cookie) as page:
                if digest is not None:
                    page.ask(**_NOTHING)  # its answer comes after the edits were made again
                    right += page.state["digest"] == digest and page.state["selection"] == selected
                if time < times:
                    page.ask("select", mode="set", slot=rng.randrange(page.welcome["slots"]))
                    page.ask("select", mode="set", group=_a_thing(page, rng))
                    page.ask("operate", ops=[_recolor(rng)])
                    if rng.random() < 0.3:
                        page.ask("undo")
                    digest, selected = page.state["digest"], page.state["selection"]
        finally:
            os.kill(process.pid, signal.SIGKILL)
            process.wait()
    whole = not [p for p in problems(read_log(log)) if "records are missing" in p or "not a whole record" in p]
    return {"what": "server killed", "times": times, "same": right == times, "right": right, "log_whole": whole}


def strangers(server: Server, huge: int) -> list[dict[str, Any]]:
    """Ask without a token, with a wrong Host or Origin, for odd paths, and send a message of `huge` bytes."""
    scene, cookie = server.hub.session.scene, {"Cookie": server.cookie}
    paths = ("/../hub.py", "/%2e%2e/hub.py", "/..%2fhub.py", "//etc/passwd", "/index.html%00", "/viewer/../../hub.py")
    tried = {
        "no token": all(asked(server.port, p)[0] == 403 for p in ("/", "/?token=x", "/index.html")),
        "wrong Host": asked(server.port, "/", {**cookie, "Host": "evil.example"})[0] == 421,
        "wrong Origin": _refused(server, server.cookie, "http://evil.example"),
        "no cookie": _refused(server, "none=1", None),
        "path tricks": all(asked(server.port, p, cookie)[0] == 404 for p in paths),
    }
    rows: list[dict[str, Any]] = [
        {"what": what, "times": 1, "refused": refused, "changed": server.hub.session.scene is not scene}
        for what, refused in tried.items()
    ]
    before = resident()
    refused = _sent_in_pieces(server, huge)
    changed = server.hub.session.scene is not scene
    rows.append({"what": f"message of {huge:,} bytes", "times": 1, "refused": refused, "changed": changed,
                 "grown": resident() - before})  # fmt: skip
    return rows


def random_messages(server: Server, count: int, seed: int) -> list[str]:
    """Send random messages, most of them wrong in one place; returns those after which the scene was another one, or
    the server did not answer. Right ones among them only select."""
    rng, wrong = random.Random(seed), []
    scene = server.hub.session.scene.cloud
    sent = 0
    while sent < count:
        with suppress(WebSocketException, OSError), connected(server.port, server.cookie) as socket:
            socket.send(json.dumps({"type": "resume", "revision": server.hub.shown.revision}))
            for _ in range(20):
                message = _random_message(rng)
                sent += 1
                socket.send(message)
                socket.ping(ack_on_close=True).wait(10)
        if not looks_alike(server.hub.session.scene.cloud, scene):  # a click on a scene may find its things, no more
            wrong.append(f"after {sent} messages the scene was another one")
            break
    with Page(server.port, server.cookie) as page:
        if page.ask("select", mode="clear")["type"] != "said":
            wrong.append("the server does not answer")
    return wrong


def resident() -> int:
    """Bytes of resident memory of this process."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def _random_message(rng: random.Random) -> str | bytes:
    """A message of a page with a field that is missing, odd or too many; or random bytes."""
    if rng.random() < 0.15:
        data = rng.randbytes(rng.randrange(1, 2000))
        return data if rng.random() < 0.5 else data.decode("latin-1")
    right: dict[str, Any] = rng.choice(
        [
            {"type": "select", "id": 1, "mode": "set", "group": 1},
            {"type": "select_slots", "id": 1, "mode": "set", "ranges": [[0, 5]]},
            {"type": "operate", "id": 1, "ops": [{"op": "delete"}]},
            {"type": "resume", "revision": None},
            {"type": "answer", "id": 1, "choice": 1},
            {"type": "save", "id": 1, "name": "../x.ply"},
        ]
    )
    text = "x" * rng.randrange(1, 5000)
    odd: Any = rng.choice([None, -1, 1e308, 2**70, text, [], [[0, -1]], {"a": {"b": []}}, True, "\x00", [[3, 2**40]]])
    made = dict(right)
    if right["type"] in ("select", "select_slots") and rng.random() < 0.2:
        return json.dumps(made)
    made[rng.choice([*made, "more"])] = odd
    if made["type"] == "operate" and isinstance(made.get("ops"), list) and made["ops"]:
        made["id"] = odd if not isinstance(odd, int) else "x"  # never one that could be done
    return json.dumps(made)


def _refused(server: Server, cookie: str, origin: str | None) -> bool:
    try:
        with connected(server.port, cookie, origin):
            return False
    except WebSocketException:
        return True


def _sent_in_pieces(server: Server, size: int) -> bool:
    """Whether the server ends a message of many fragments before all of it is there."""
    piece = b" " * (1 << 20)
    try:
        with connected(server.port, server.cookie) as socket:
            socket.send(piece.decode() for _ in range(size // len(piece)))
            socket.recv(timeout=10)
        return False
    except (WebSocketException, OSError):
        return True


def _a_thing(page: Page, rng: random.Random | None = None) -> int:
    if not page.state["embedded"]:
        page.ask("select", mode="set", slot=0)
    things = [t["group"] for t in page.state["things"]]
    return things[0] if rng is None else rng.choice(things)


def _recolor(rng: random.Random) -> dict[str, Any]:
    return {"op": "recolor", "color": rng.choice(_COLORS)}


def _started(scene: Path, log: Path) -> tuple[subprocess.Popen[str], int, str]:
    """A server of its own process, its port, and the cookie of a page."""
    command = [sys.executable, "-m", "scenewright", "view", str(scene), "--no-open", "--json", "--log", str(log)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    assert process.stdout is not None
    address = json.loads(process.stdout.readline())["url"]
    return process, int(address.removeprefix(f"http://{HOST}:").partition("/")[0]), entered(address)
