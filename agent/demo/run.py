"""Runs the demo: furnishes a room, embeds it, edits it with ten instructions, and writes all files.

The instructions are derived from the room (see script.py). The builder's own list of things serves to choose the words
and to check the results afterwards; the selection never sees it.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...gaussians.errors import AmbiguousError, InstructionError, UserError
from ...gaussians.scene import Scene
from ...gaussians.timing import timed
from ..output_files import make_folder
from ..pictures.image_files import Tile, contact_sheet, save_png
from ..pictures.scene_pictures import Picture, after, numbered, picture
from ..session.result import Result
from ..session.session import Session
from ..terminal.thing_names import describe_things
from .demo_targets import Ids, agreement, find_targets, try_turn
from .script import SCRIPT, ScriptPart, Targets, Turn

if TYPE_CHECKING:
    from ...gaussians.assets import Room

MAX_TRIES = 40  # instructions tried for one part of the script before it is left out
MIN_IOU = 0.5  # intersection over union from which a selection counts as the thing that was meant
FILES = ("room.ply", "edited.ply", "session.jsonl", "contact_sheet.png")

Say = Callable[[str], None]


@dataclass(frozen=True)
class Step:
    """One instruction and its outcome.

    Attributes:
        number: from 1.
        text: the instruction, followed by the answer if there was a question.
        outcome: in a sentence.
        good: whether the instruction was carried out.
        seconds: from the words to the new scene, without pictures.
        overlap: intersection over union of the selection with the things that were meant; None if there is nothing to
            compare.
        files: its pictures.
    """

    number: int
    text: str
    outcome: str
    good: bool
    seconds: float
    overlap: float | None
    files: tuple[str, ...]


@dataclass
class Demo:
    """A run of the demo.

    Args:
        folder: for all files.
        seed: of the room.
        size: width and height of the pictures, pixels.
        force: overwrite the files of an earlier run.
        encoder: text and image encoder.
        say: called with each line of the report.
        progress: called with the stage and the share done during long work.
    """

    folder: Path
    seed: int = 0
    size: tuple[int, int] = (640, 480)
    force: bool = False
    encoder: str = "auto"
    say: Say = print
    progress: Callable[[str, float], None] = lambda stage, fraction: None
    steps: list[Step] = field(default_factory=list)
    passed_over: list[str] = field(default_factory=list)
    seconds: dict[str, float] = field(default_factory=dict)
    _tiles: list[Tile] = field(default_factory=list)

    def run(self) -> dict[str, Any]:
        """Run the demo and return its report as data.

        Raises:
            UserError: there are files of an earlier run and `force` is not set.
        """
        from ...gaussians.assets import furnish
        from ...gaussians.files import save
        from ...gaussians.viewpoints.coverage import default_viewer

        started = time.perf_counter()
        self._prepare()
        with timed(self.seconds, "furnish"):
            room = furnish(self.seed)
        scene: Scene = room.scene
        self.say(
            f"furnished a room from seed {self.seed}: {len(scene.cloud):,} Gaussians, {len(room.truth.objects)} things"
        )
        with timed(self.seconds, "save"):
            save(scene, self.folder / "room.ply", force=self.force)
        log = self.folder / "session.jsonl"
        log.unlink(missing_ok=True)  # only with force: see _prepare
        session = Session(scene, "grammar", self.encoder, log=log, progress=self.progress, seed=self.seed)
        session.viewer = default_viewer(scene, *self.size)
        with timed(self.seconds, "embed"):
            session.embed()
        language = session.scene.language
        assert language is not None
        self.say(f"embedded in {self.seconds['embed']:.1f} s; it sees {describe_things(language.objects())}")
        self._converse(session, room)
        with timed(self.seconds, "save"):
            session.save(self.folder / "edited.ply", force=self.force)
        session.close()
        if self.passed_over:
            self.say(f"skipped, since they would select other things: {'; '.join(self.passed_over)}")
        heading = f"Scenewright demo, seed {self.seed}: {len(self.steps)} instructions"
        with timed(self.seconds, "pictures"):
            save_png(contact_sheet(heading, self._tiles), self.folder / "contact_sheet.png", self.force)
        self.seconds["total"] = time.perf_counter() - started
        return self._report()

    # -- before and after the conversation --------------------------------------------------------------------------

    def _prepare(self) -> None:
        make_folder(self.folder)
        there = [name for name in FILES if (self.folder / name).exists()]
        if there and not self.force:
            raise UserError(f"{self.folder} holds {there[0]} of an earlier run; choose another folder, or --force")
        for old in self.folder.glob("[0-9][0-9]-*.png") if self.force else ():
            old.unlink()

    def _report(self) -> dict[str, Any]:
        return {
            "folder": str(self.folder),
            "seed": self.seed,
            "passed_over": self.passed_over,
            "steps": [step.__dict__ for step in self.steps],
            "seconds": {stage: round(value, 3) for stage, value in self.seconds.items()},
            "files": sorted(p.name for p in self.folder.iterdir()),
        }

    # -- the conversation -------------------------------------------------------------------------------------------

    def _converse(self, session: Session, room: Room) -> None:
        truth = np.asarray(room.truth.ids)
        targets = find_targets(room, session.viewer)
        for name, part in SCRIPT:
            with timed(self.seconds, "choose what to say"):
                turn = self._first_that_fits(session, part, targets, truth)
            if turn is None:
                self.say(f"-- left out: {name} (nothing in this room suits it)")
                continue
            self._play(session, turn, truth)
            targets.used.update(t.id for t in turn.about)
            targets.last = turn.about[-1] if turn.about else targets.last
            if turn.text.startswith("remove") and turn.outcome == "edit":
                targets.things = [t for t in targets.things if t not in turn.about]

    def _first_that_fits(self, session: Session, part: ScriptPart, targets: Targets, truth: Ids) -> Turn | None:
        """The first instruction of a part of the script that has its expected outcome in a dry run. An instruction that
        would select the wrong thing is skipped and added to `passed_over`."""
        mistaken: set[int] = set()
        for turn in itertools.islice(part(targets), MAX_TRIES):
            if mistaken & {t.id for t in turn.about}:
                continue
            fits, result = try_turn(session, turn)
            overlap = agreement(result, turn, truth) if result is not None else None
            if fits and (overlap is None or overlap >= MIN_IOU):
                return turn
            if fits:
                mistaken |= {t.id for t in turn.about}
                self.passed_over.append(f"{turn.text} (IoU {overlap:.2f})")
        return None

    def _play(self, session: Session, turn: Turn, truth: Ids) -> None:
        """Carry out a turn, answer its question if there is one, and save pictures before and after."""
        number = len(self.steps) + 1
        with timed(self.seconds, "pictures"):
            before = picture(session.scene, session.viewer)
        shots, text, answered = [before], turn.text, False
        spent: dict[str, float] = {}
        result: Result | None = None
        try:
            session.pixel_checks = True
            with timed(spent, "converse"):
                result = session.do(turn.text)
            outcome = _sentence(result)
        except AmbiguousError as error:
            outcome = str(error)
            if turn.answer and session.question is not None:
                candidates = session.question.candidates
                with timed(self.seconds, "pictures"):
                    shots = [numbered(session.scene, session.viewer, candidates)]
                with timed(spent, "converse"):
                    result, answered = session.answer(turn.answer), True
                outcome = f"asked back: {len(candidates)} things match; answered '{turn.answer}': {_sentence(result)}"
                text = f"{turn.text} … {turn.answer}"
        except InstructionError as error:
            outcome = f"refused, nothing was changed: {error}"
        session.pixel_checks = False  # not needed for trying sentences
        seconds = spent["converse"]
        self.seconds["converse"] = self.seconds.get("converse", 0.0) + seconds
        if result is not None:
            with timed(self.seconds, "pictures"):
                shots.append(after(result, session.viewer))
        overlap = agreement(result, turn, truth) if result is not None and not answered else None
        files = self._keep(number, shots)
        step = Step(number, text, outcome, result is not None, seconds, overlap, files)
        self.steps.append(step)
        self._tiles.append(Tile(text, outcome, tuple(shots), step.good))
        check = f" (agrees with the builder: IoU {overlap:.2f})" if overlap is not None else ""
        self.say(f"{number:>2}. {text}\n    {outcome}{check} [{seconds:.2f} s]")

    def _keep(self, number: int, shots: list[Picture]) -> tuple[str, ...]:
        names = ("before", "after")[: len(shots)]
        files = tuple(f"{number:02d}-{name}.png" for name in names)
        for file, shot in zip(files, shots, strict=True):
            with timed(self.seconds, "pictures"):
                save_png(shot, self.folder / file, self.force)
        return files


def _sentence(result: Result) -> str:
    return "; ".join(r.sentence() for r in result.receipts) or "the scene is again exactly as it was"
