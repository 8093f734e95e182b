"""Tools that look at the scene: pictures, answers, descriptions, the scene graph, and the check of it."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

from pydantic import Field

from ...planners.model.prompt.labels import sanitize
from . import views
from .limits import Arguments, Text
from .reply import MAX_SIDE, Reply
from .tool import READS, Desk, Tool, tool

Side = Annotated[int, Field(ge=32, le=MAX_SIDE, strict=True)]

_VIEWER = ("", "viewer")
_MOST_VIOLATIONS = 100


class RenderArguments(Arguments):
    """Arguments of `render`."""

    camera: Annotated[str, Field(max_length=200)] = "viewer"
    """"viewer" (whose left and right are meant), "auto", a camera of the scene by name or number, or eye and target in
    world coordinates as "x,y,z:x,y,z", with ":angle" for the vertical field of view in degrees."""
    width: Side = 768
    """Pixels."""
    height: Side | None = None
    """Pixels; by default as the camera's own aspect wants."""


class GraphArguments(Arguments):
    """Arguments of `graph` and `describe`."""

    most: Annotated[int, Field(ge=1, le=2000, strict=True)] = 200
    """At most so many things, the largest first."""


class FindViewArguments(Arguments):
    """Arguments of `find_view`."""

    view: Text
    """The view in words: "the guitar from behind", "what one sees sitting on the sofa", "the room from above"."""
    width: Side = 768
    """Pixels."""
    height: Side = 512
    """Pixels."""
    marks: Annotated[bool, Field(strict=True)] = False
    """Outline the things and write their names on them."""


class AskArguments(Arguments):
    """Arguments of `ask`."""

    question: Text
    """A question in words: "how far is the sofa from the window?", "what is on the desk?"."""
    picture: Annotated[bool, Field(strict=True)] = False
    """Also return a picture of what the answer rests on: things outlined and named, distances and routes as lines."""


class NoArguments(Arguments):
    """For tools that take no arguments."""


def _render(desk: Desk, said: RenderArguments) -> Reply:
    """Return a picture of the scene from a camera, as an image."""
    from ..pictures.named_cameras import choose_view

    session = desk.session
    chosen = session.viewer if said.camera.lower() in _VIEWER else choose_view(session.scene, said.camera)
    drawn, camera = views.of_camera(session, chosen, said.width, said.height)
    eye, forward = ([round(float(v), 4) for v in vector] for vector in (camera.position, camera.forward))
    known = [c.name or str(number) for number, c in enumerate(session.scene.cameras[:100])]
    data = {
        "verdict": "ok", "width": camera.width, "height": camera.height, "eye": eye, "forward": forward,
        "up": list(session.scene.frame.up), "cameras": known,
    }  # fmt: skip
    name = camera.name or said.camera or "viewer"
    return Reply(f"the scene from {name}, {camera.width}x{camera.height} pixels", data, (drawn,))


def _find_view(desk: Desk, said: FindViewArguments) -> Reply:
    """Find the camera that shows what the words say, and return its picture; `view` in the result can be given to
    `render`. A thing's front, left and right are its own where its shape shows them, else the viewer's."""
    from ..pictures.evidence import name_marks
    from ..pictures.image_files import encoded_png
    from ..pictures.marked_views import draw_view
    from ..pictures.marks import draw_marks
    from ..pictures.named_cameras import view_text
    from ..session.find_view import find_view

    session = desk.session
    found = find_view(session, said.view, (said.width, said.height))
    camera = found.view.camera
    drawing = draw_view(session.scene, camera, found.groups, found.view.cut)
    image = drawing.image
    if said.marks:
        image = draw_marks(image, drawing.labels, name_marks(session.scene, found.groups))[0]
    shares = dict(zip(found.groups, (round(share, 4) for share in found.shares), strict=True))
    data = {
        "verdict": "ok", "view": view_text(camera), "width": camera.width, "height": camera.height,
        "things": [{"group": group, "share": share} for group, share in shares.items()],
        "left_out": sorted(found.view.cut.groups), "notes": list(found.notes),
    }  # fmt: skip
    return Reply("\n".join([f"{said.view}: camera {data['view']}", *found.notes]), data, (encoded_png(image),))


def _ask(desk: Desk, said: AskArguments) -> Reply:
    """Answer a question about the scene: what is there, how many, how large, how far, where, what fits, which way. The
    scene is not changed; "it" then means what the answer is about. An answer of null says that nothing here tells."""
    from ..pictures.evidence import evidence_png, has_picture

    session = desk.session
    answer = session.ask(said.question)
    pictures: tuple[bytes, ...] = ()
    if said.picture and has_picture(answer):
        pictures = (evidence_png(session.scene, answer, session.viewer),)
    return Reply(answer.text, {"verdict": "ok", **answer.to_json()}, pictures)


def _describe(desk: Desk, said: GraphArguments) -> Reply:
    """Describe the scene from measured facts: a paragraph, and for each thing a line with its id, size and place."""
    told = desk.session.describe()
    ranked = sorted(told.things, key=lambda t: (-t.size[0] * t.size[1] * t.size[2], str(t.id)))
    kept = {t.id for t in ranked[: said.most]}
    data = told.to_json()
    data["things"] = [t for t in data["things"] if t["id"] in kept]
    data["left_out"] = len(told.things) - len(data["things"])
    lines = [f"  {t['id']}: {t['text']}" for t in data["things"]]
    return Reply("\n".join([told.text, *lines]), {"verdict": "ok", **data})


def _graph(desk: Desk, said: GraphArguments) -> Reply:
    """Return the scene graph: every thing with its id, name, colour, size, position and what it stands on. Metres, z
    up, origin at the centre of the floor; ids are the `groups` of a query."""
    graph = sanitize(desk.session.graph())
    ranked = sorted(graph.nodes, key=lambda n: (-n.size[0] * n.size[1] * n.size[2], str(n.id)))
    kept = {n.id for n in ranked[: said.most]}
    data = graph.model_dump(mode="json", exclude_none=True)
    data["nodes"] = [n for n in data["nodes"] if n["id"] in kept]
    data["relations"] = [r for r in data["relations"] if r[0] in kept and r[2] in kept]
    left_out = len(graph.nodes) - len(data["nodes"])
    more = f"; {left_out} smaller ones were left out" if left_out else ""
    text = f"{len(data['nodes'])} things in a room of {' x '.join(f'{s:.2f}' for s in graph.room.size)} m{more}"
    return Reply(text, {"verdict": "ok", "graph": data, "left_out": left_out})


def _check(desk: Desk, said: NoArguments) -> Reply:
    """Check the scene: collisions, things outside the room or without support, and what cannot be reached on foot."""
    from ...planners.rooms.check import check, sentences

    report = check(sanitize(desk.session.graph()))
    shown = report.violations[:_MOST_VIOLATIONS]
    lines = sentences(shown) or ["nothing is wrong"]
    data = {**asdict(report), "verdict": "ok", "ok": report.ok, "violations": [asdict(v) for v in shown]}
    return Reply("\n".join(lines), {**data, "count": len(report.violations)})


def looking_tools() -> list[Tool]:
    """The tools of this module."""
    return [
        tool("render", RenderArguments, READS, _render, needs_field=False),
        tool("find_view", FindViewArguments, READS, _find_view),
        tool("ask", AskArguments, READS, _ask),
        tool("describe", GraphArguments, READS, _describe),
        tool("graph", GraphArguments, READS, _graph),
        tool("check", NoArguments, READS, _check),
    ]
