"""`scenewright edit SCENE "TEXT" -o out.ply`: carry out an instruction on a file."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ...gaussians.timing import timed
from ..options import (
    Assets,
    Budget,
    Capture,
    Debug,
    Effort,
    Encoder,
    Force,
    Harmony,
    InfillOrDial,
    Json,
    Judge,
    Log,
    Memory,
    NoInfill,
    Output,
    Picture,
    Planner,
    References,
    ReferenceWidth,
    RestyleBy,
    Scale,
    SceneFile,
    Seed,
    Size,
    Up,
    View,
    Vlm,
    Window,
    Yes,
)
from ..terminal.effort import dialled, reported, tell
from ..terminal.output import error_json, terminal

if TYPE_CHECKING:
    from ...gaussians.errors import UnconfirmedError
    from ..session.replay import Replay
    from ..session.result import Result
    from ..session.session import Session


@dataclass(frozen=True)
class _Targets:
    """The files that an edit writes."""

    output: Path | None
    preview: Path | None
    pictures: Path | None
    force: bool
    keep_field: bool


def command(
    scene: SceneFile,
    text: Annotated[str | None, typer.Argument(metavar="TEXT", help="What to do, e.g. 'make the sofa teal'.")] = None,
    output: Output = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Show the plan and what it would change; write no scene.")
    ] = False,
    preview: Annotated[
        Path | None,
        typer.Option(
            "--preview",
            metavar="FILE.png",
            help="A dry run: write a picture of before, after and what would change, and say how much; write no scene.",
        ),
    ] = None,
    pictures: Annotated[
        Path | None, typer.Option("--pictures", metavar="FOLDER", help="Write before.png and after.png there.")
    ] = None,
    log: Log = None,
    replay: Annotated[
        Path | None, typer.Option("--replay", metavar="LOG", help="Repeat the edits of a session in a log.")
    ] = None,
    session_of_log: Annotated[
        str | None,
        typer.Option("--session", metavar="ID", help="With --replay: the session, by id or number; default the last."),
    ] = None,
    undo: Annotated[
        bool, typer.Option("--undo", help="Of a scene in tiles: undo its last edit, instead of an instruction.")
    ] = False,
    redo: Annotated[
        bool, typer.Option("--redo", help="Of a scene in tiles: redo the edit that was undone last.")
    ] = False,
    memory: Memory = None,
    up: Up = None,
    metres_per_unit: Scale = None,
    view: View = "auto",
    size: Size = None,
    planner: Planner = "auto",
    vlm: Vlm = "auto",
    budget: Budget = None,
    window: Window = None,
    assets: Assets = None,
    picture: Picture = False,
    judge: Judge = None,
    effort: Effort = None,
    infill: InfillOrDial = None,
    no_infill: NoInfill = False,
    capture: Capture = None,
    restyle: RestyleBy = None,
    reference: References = None,
    reference_width: ReferenceWidth = None,
    harmony: Harmony = True,
    encoder: Encoder = "auto",
    seed: Seed = 0,
    yes: Yes = False,
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Edit a scene in words. An instruction is carried out completely or not at all, and checked.

    What is chosen by its colour, as its name could not be confirmed, is edited only if you say so, or with --yes.

    A language field saved beside SCENE (see `embed`) is used, and then saved beside the edited scene too.

    A scene in tiles (see `tile`) is edited where it lies, without -o; --undo and --redo reach the edits that were made.
    """
    started = time.perf_counter()
    from ...gaussians.errors import UserError
    from ...gaussians.tiles.store import is_tiles
    from ..session.opening import SessionOptions, open_session

    tiled = is_tiles(scene)
    if undo or redo:
        _step_back(scene, tiled, undo, any(value is not None for value in (text, replay, output)) or undo == redo)
        return
    if (text is None) == (replay is None):
        raise UserError('give either TEXT or --replay LOG: scenewright edit SCENE "make the sofa teal" -o out.ply')
    if preview is not None and replay is not None:
        raise UserError("--preview shows what one instruction would change: give TEXT, or --replay LOG without it")
    dry_run = dry_run or preview is not None
    if tiled and (output is not None or replay is not None or pictures is not None):
        raise UserError(
            f"{scene} is edited where it lies, one instruction at a time: leave out -o, --replay and --pictures; "
            "`scenewright convert` writes it to another file"
        )
    if output is None and not dry_run and not tiled:
        raise UserError("say where to write the edited scene: -o out.ply (or try it first with --preview change.png)")
    if session_of_log is not None and replay is None:
        raise UserError("--session names a session of a log; give the log with --replay")
    chosen = _logged(replay, session_of_log) if replay is not None else None
    _check_targets(None if dry_run else output, preview, pictures, force)
    dial = dialled(effort, started)
    if dial is not None and (no_infill or infill is not None):
        dial.overrule("--no-infill" if no_infill else "--infill")
    seconds: dict[str, float] = {}
    options = SessionOptions(
        scene, planner, encoder, view, size, None if dry_run else log, seed, True, up, metres_per_unit, budget, picture,
        judge,
        vlm,
        yes,
        assets,
        "none" if no_infill else infill or "scene",
        capture,
        restyle,
        reference or (),
        reference_width,
        harmony,
        dial,
        tiled=True,
    )  # fmt: skip
    with timed(seconds, "open"):
        session, had_field = open_session(options)
    targets = _Targets(None if dry_run else output, preview, pictures, force, had_field)
    with closing(session):
        results = [_instruct(session, str(text), dry_run)] if chosen is None else _replay(session, chosen)
        lines, data = _report(results, chosen, dry_run)
        if tiled and results[0].receipts:  # the result's scene is a window
            data["gaussians"] = results[0].receipts[-1].total
        with timed(seconds, "write"):
            _write(session, results, targets, data)
    spent = {**data.pop("seconds", {}), **seconds, "total": time.perf_counter() - started}
    data["seconds"] = {stage: round(value, 3) for stage, value in spent.items()}
    lines += [data["change"]] if "change" in data else []
    lines += ["dry run: no scene was written"] if dry_run else [f"wrote {data.get('output', scene)}"]
    lines += [f"wrote {path}" for path in data.get("pictures", ())]
    terminal.result("\n".join(lines), data | reported(dial))
    tell(dial)
    if not as_json:
        from ..session.plan_report import usage_lines

        for line in usage_lines(session.planned):
            terminal.say(line)
        terminal.say("seconds: " + ", ".join(f"{stage} {value:.2f}" for stage, value in data["seconds"].items()))


def _step_back(scene: Path, tiled: bool, undo: bool, more: bool) -> None:
    """Undo or redo an edit of a scene in tiles."""
    from ...gaussians.errors import UserError
    from ...gaussians.tiles import changing

    if not tiled or more:
        raise UserError("--undo and --redo stand alone and are for scenes in tiles: scenewright edit NAME.tiles --undo")
    tiles, text = (changing.undo if undo else changing.redo)(scene)
    done = "undone" if undo else "done again"
    data = {"verdict": "ok", "text": text, "step": "undo" if undo else "redo", "gaussians": len(tiles)}
    terminal.result(f"{done}: {text}", data)


def _check_targets(output: Path | None, preview: Path | None, pictures: Path | None, force: bool) -> None:
    """Check before the work that the files can be written: no overwriting, existing folders, known formats."""
    from ...gaussians.files import writer
    from ..output_files import make_folder, refuse_existing, require_folder, require_png

    if output is not None:
        writer(output)
        require_folder(output)
    if preview is not None:
        require_png(preview)
        require_folder(preview)
    wanted = [path for path in (output, preview) if path]
    wanted += [pictures / name for name in ("before.png", "after.png")] if pictures else []
    refuse_existing(wanted, force)
    if pictures is not None:
        make_folder(pictures)


def _instruct(session: Session, text: str, dry_run: bool) -> Result:
    """Carry out the instruction; if it is refused, report the reason, the candidates and the model usage, and exit."""
    from ...gaussians.errors import ScenewrightError, UnconfirmedError
    from ..session.plan_report import candidate_json, refusal_json, usage_lines

    try:
        try:
            return session.preview(text) if dry_run else session.do(text)
        except UnconfirmedError as error:
            return _confirmed(session, error, dry_run)
    except ScenewrightError as error:
        for line in usage_lines(session.planned):
            terminal.say(line)
        if terminal.debug:
            raise
        candidates = session.question.candidates if session.question else ()
        data = {"candidates": [candidate_json(c) for c in candidates], **refusal_json(error, session.planned)}
        terminal.refuse(error, {**error_json(error), **data}, [c.describe() for c in candidates])


def _confirmed(session: Session, error: UnconfirmedError, dry_run: bool) -> Result:
    """The result of the instruction after the user confirmed what was chosen, each query of it in turn.

    Raises:
        UnconfirmedError: nobody can be asked, or the answer is no.
        ScenewrightError: as `Session.do`.
    """
    from ...gaussians.errors import UnconfirmedError

    while session.question is not None and (said := terminal.confirms(f"{error}. Go on with it?")) is not None:
        if not said:
            raise UnconfirmedError("nothing was changed; say in other words what is meant")
        plan = session.answered("yes")
        try:
            return session.preview(plan) if dry_run else session.apply(plan)
        except UnconfirmedError as another:
            error = another
    raise UnconfirmedError(f"{error}; nothing was changed. --yes goes on with it")


def _logged(log: Path, which: str | None) -> Replay:
    """The session of a log that is replayed; says what is wrong with the log, which session it is, and of how many."""
    from ..session.log import read_log
    from ..session.log_sessions import logged_session, problems, sessions_of
    from ..session.replay import Replay

    content = read_log(log)
    for problem in problems(content):
        terminal.say(f"note: in the log {log}: {problem}")
    chosen = logged_session(log, -1 if which is None else which)
    terminal.say(f"replaying {chosen.describe()} of the {len(sessions_of(content))} in {log}")
    return Replay(log, chosen)


def _replay(session: Session, replay: Replay) -> list[Result]:
    """The edits of a session in a log, carried out on this session; in a dry run nothing is written."""
    from ...gaussians.errors import UnconfirmedError, UserError

    try:
        replayed = session.replay(replay.log, session=replay.session.number - 1)
    except UnconfirmedError as error:
        raise UnconfirmedError(f"{error}. --yes goes on with it") from error
    for note in filter(None, (r.note for r in replayed)):
        terminal.say(f"note: {note}")
    results = [r.result for r in replayed if r.result is not None]
    if not results:
        raise UserError(f"{replay.session.describe()} in {replay.log} did nothing that could be replayed")
    return results


def _report(results: Sequence[Result], replay: Replay | None, dry_run: bool) -> tuple[list[str], dict[str, Any]]:
    """The results as lines and as data."""
    if replay is None:
        return _lines(results[0], dry_run), results[0].to_json()
    lines = [line for result in results for line in (f"> {result.text}", *_lines(result, dry_run))]
    rows = [r.to_json() for r in results]
    data = {"verdict": "ok", "session": replay.session.to_json(), "replayed": rows, "dry_run": dry_run}
    return lines, {**data, "gaussians": rows[-1]["gaussians"]}


def _lines(result: Result, dry_run: bool) -> list[str]:
    """The sentences of a result; in a dry run its plan, and what it would do."""
    from ..session.plan_report import plan_lines

    if not dry_run or result.plan is None:
        return list(result.sentences())
    would = [s if s.startswith("note:") else f"would {s}" for s in result.sentences()]
    return [*(f"plan: {line}" for line in plan_lines(result.plan)), *would]


def _write(session: Session, results: Sequence[Result], targets: _Targets, data: dict[str, Any]) -> None:
    """Write the requested files, and add their paths to `data`."""
    if targets.output is not None:
        field = session.save(targets.output, force=targets.force, names=targets.keep_field)
        data["output"] = str(targets.output)
        if field is not None:
            data["field"] = str(field)
    if targets.pictures is not None:
        data["pictures"] = _draw(session, results, targets.pictures, targets.force)
    if targets.preview is not None:
        data |= _previewed(session, results[0], targets.preview, targets.force)


def _previewed(session: Session, result: Result, path: Path, force: bool) -> dict[str, Any]:
    """Write the picture of what a dry run would change; its path and numbers as data."""
    from ..pictures.change_pictures import change_of
    from ..pictures.image_files import save_png

    change = change_of(result, session.viewer)
    save_png(change.picture, path, force)
    return {"pictures": [str(path)], "change": f"it would change {change.sentence()}", "preview": change.to_json()}


def _draw(session: Session, results: Sequence[Result], folder: Path, force: bool) -> list[str]:
    """Write before.png and after.png from the viewer's camera; returns their paths."""
    from ..pictures.image_files import save_png
    from ..pictures.scene_pictures import after, picture

    shots = {"before": picture(results[0].before, session.viewer), "after": after(results[-1], session.viewer)}
    for name, shot in shots.items():
        save_png(shot, folder / f"{name}.png", force)
    return [str(folder / f"{name}.png") for name in shots]
