"""Carries out one written instruction as a user would, and takes pictures of what it did.

A question is answered only where somebody has looked at what it offers: `answers.json` holds answers by the hash of the
question. Any other question ends the instruction as "asked". The nearest things that are listed in place of an absent
one can be chosen by their number too; unless one is chosen, the instruction is "refused".
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ....agent.pictures.scene_pictures import numbered, picture, spotlight
from ....agent.session.clarify import Question
from ....agent.session.refusal import verdict_of
from ....agent.session.result import Result
from ....agent.session.session import Session
from ....gaussians.camera import Camera
from ....gaussians.errors import ScenewrightError, UserError
from ....gaussians.scene import Scene
from .scenes import Place

Picture = NDArray[np.uint8]  # [H, W, 3]
Outcome = Literal["done", "asked", "refused"]
Answers = Mapping[str, Mapping[str, str]]  # answers by the key of the instruction, then by the hash of the question
ROUNDS = 4  # questions that are answered at most
CHANGED = 12  # of 255: a pixel that differs by more has changed
_ASKED = 2  # how much larger the pictures of a question are, so that numbers leave things visible
_CLOSEST = 0.25  # share of a view that a close-up shows at least

HERE = Path(__file__).parent


@dataclass(frozen=True)
class Instruction:
    """One written instruction; `expect` says what a careful person would see afterwards, `absent` that it names a thing
    that is not there."""

    id: str
    scene: str
    text: str
    expect: str
    absent: bool


@dataclass(frozen=True)
class Carried:
    """What became of one instruction in one setting.

    Attributes:
        key: id and setting.
        outcome: "done", "asked" (a question is open) or "refused".
        questions: how many questions were answered before.
        said: what the program said at last.
        told: what it said before each answer, and the answer.
        look: the hash by which grades and answers know it: of the pictures of what was done, else of what was said.
    """

    key: str
    outcome: Outcome
    questions: int
    said: str
    told: tuple[str, ...]
    look: str

    def to_json(self) -> dict[str, Any]:
        return asdict(self)

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Carried:
        return cls(**{**data, "told": tuple(data["told"])})


@dataclass(frozen=True, eq=False)
class Shown:
    """Rows of pictures of one instruction: before, after and what changed; or the candidates of a question."""

    rows: tuple[tuple[Picture, ...], ...]


def read_answers() -> Answers:
    """The committed answers."""
    path = HERE / "answers.json"
    return dict(json.loads(path.read_text(encoding="utf-8"))) if path.is_file() else {}


def key_of(instruction: Instruction, place: Place) -> str:
    return f"{instruction.id} {place.setting.name}"


def carry_out(instruction: Instruction, place: Place, answers: Answers) -> tuple[Carried, Shown]:
    """Carry out an instruction on a fresh session, answer what `answers` answers, and take pictures."""
    session = Session(place.scene, viewer=place.views[0])
    key, told = key_of(instruction, place), list[str]()
    result: Result | None = None
    said = ""
    outcome: Outcome = "refused"
    try:
        result = session.do(instruction.text)
    except ScenewrightError as error:
        failed: ScenewrightError = error
        while True:
            said, outcome = f"{verdict_of(failed)}: {failed}", _outcome(session, failed)
            answer = answers.get(key, {}).get(_asks(said, session.question))
            if answer is None or len(told) >= 2 * ROUNDS:
                break
            told += [said, answer]
            try:
                result = session.answer(answer)
                break
            except ScenewrightError as again:
                failed = again
    questions = len(told) // 2
    if result is None:
        question = session.question
        shown = Shown(()) if question is None or not question.candidates else _asked(question, place, session.scene)
        look = _asks(said, question)
        return Carried(key, outcome, questions, said, tuple(told), look), shown
    look, shown = _done(result, place)
    return Carried(key, "done", questions, "\n".join(result.sentences()), tuple(told), look), shown


def _asks(said: str, question: Question | None) -> str:
    """The hash of what is asked for and of the things that are offered, or of what was said where nothing is."""
    if question is None or not question.candidates:
        return _hash(said)
    asked = (question.selection.verdict, question.selection.query.describe())
    return _hash(*asked, *(f"{c.group} {c.color} {c.center} {c.size}" for c in question.candidates))


def _outcome(session: Session, error: ScenewrightError) -> Outcome:
    """Whether an error is a question: one with something to choose or to confirm."""
    question = session.question
    if question is None or isinstance(error, UserError) or not question.candidates:
        return "refused"
    return "refused" if question.selection.verdict == "absent" else "asked"


def _hash(*parts: str | bytes) -> str:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part.encode() if isinstance(part, str) else part)
    return digest.hexdigest()[:16]


def _done(result: Result, place: Place) -> tuple[str, Shown]:
    """The pictures of an edit: from the viewer, and closer from the view that it changed most."""
    views = place.views
    before, after = ([picture(s, v) for v in views] for s in (result.before, result.scene))
    if result.scene is result.before and result.selection is not None:
        after = [spotlight(result.scene, v, result.selection) for v in views]
    changed = [_changed(a, b) for a, b in zip(before, after, strict=True)]
    most = max(range(len(views)), key=lambda i: (int(changed[i].sum()), -i))
    look = _hash(*(np.ascontiguousarray(after[i]).tobytes() for i in dict.fromkeys((0, most))))
    closer = _close_up(views[most], changed[most])
    rows = [(before[0], after[0], _marked(after[0], changed[0]))]
    if closer is not views[0]:
        near = [picture(s, closer) for s in (result.before, result.scene)]
        if result.scene is result.before and result.selection is not None:
            near[1] = spotlight(result.scene, closer, result.selection)
        rows.append((near[0], near[1], _marked(near[1], _changed(near[0], near[1]))))
    return look, Shown(tuple(rows))


def _asked(question: Question, place: Place, scene: Scene) -> Shown:
    """What a question offers: what was chosen, lit, or the candidates with numbers, from every view."""
    pictures = []
    for view in place.views:
        larger = view.resized(_ASKED * view.width, _ASKED * view.height)
        if question.selection.verdict == "unconfirmed":
            pictures.append(spotlight(scene, larger, question.selection))
        else:
            pictures.append(numbered(scene, larger, question.candidates))
    return Shown(tuple(tuple(pictures[i : i + 2]) for i in range(0, len(pictures), 2)))


def _changed(before: Picture, after: Picture) -> NDArray[np.bool_]:
    return np.abs(before.astype(np.int16) - after.astype(np.int16)).max(axis=2) > CHANGED


def _marked(after: Picture, changed: NDArray[np.bool_]) -> Picture:
    """Changed pixels in colour, all others dark grey."""
    grey = (after.mean(axis=2, keepdims=True) / 4 + 20).repeat(3, axis=2)
    marked: Picture = np.where(changed[..., None], after // 2 + np.array([127, 60, 0]), grey).astype(np.uint8)
    return marked


def _close_up(view: Camera, changed: NDArray[np.bool_]) -> Camera:
    """The view cut to what changed, with a margin, at the size of the view; stray pixels do not count."""
    ys, xs = np.nonzero(changed)
    if not len(xs):
        return view
    (x0, x1), (y0, y1) = (np.quantile(v, (0.02, 0.98)) for v in (xs, ys))
    share = max((x1 - x0) / view.width, (y1 - y0) / view.height) * 1.3
    share = float(np.clip(share, _CLOSEST, 1.0))
    if share > 0.8:
        return view
    width, height = view.width * share, view.height * share
    left = float(np.clip((x0 + x1 - width) / 2, 0, view.width - width))
    top = float(np.clip((y0 + y1 - height) / 2, 0, view.height - height))
    return Camera(
        view.world_to_camera, view.fx / share, view.fy / share, (view.cx - left) / share, (view.cy - top) / share,
        view.width, view.height,
    )  # fmt: skip
