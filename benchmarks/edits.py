"""bench edits: instructions in people's words on real scenes, carried out as a user would and graded by eye; what
colour edits do to greys and to the colour that was asked; and which sabotaged edits the checks of every edit catch.

The instructions were written from pictures by somebody who did not know what the program can do. Each run writes a
contact sheet for each of them and `rows.json` into `SCENEWRIGHT_BENCH_EDITS` (by default a folder of the user's cache).
Grades are committed with the hash of the pictures that were looked at; other pictures count as ungraded.

Run `python -m scenewright.benchmarks.edits [SETTING ...] [--keep] [--only A01,A02]` for some of them; `--keep` keeps
embedded scenes between runs, `--table` prints the table of `rows.json` with the present grades.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from . import _data
from ._edits import color, sabotage
from ._edits.graded import carrying, grades, sheets
from ._edits.graded.carrying import Carried, Instruction
from ._edits.graded.scenes import SETTINGS, Place, prepared, results_folder
from .harness import Metric, Result

INSTRUCTIONS = carrying.HERE / "instructions.jsonl"
_QUICK, _QUICK_SETTINGS = 2, ("guitar", "playbot")  # instructions of each scene, and the scenes
_ROWS = "rows.json"


PARTS = ("graded", "colour", "checks")


def run(quick: bool, parts: Sequence[str] = PARTS) -> Result:
    """All instructions in all settings whose data are here, the measures of colour, and of the checks."""
    found, notes = list[Metric](), list[str]()
    if "graded" in parts:
        found += _graded(quick, notes)
    if "colour" in parts and not quick:
        found += color.metrics(*color.measure())
    if "checks" in parts:
        found += sabotage.measure(quick)
    return Result("edits of real scenes in people's words, graded by eye", "grade", tuple(found), (), tuple(notes))


def _graded(quick: bool, notes: list[str]) -> Sequence[Metric]:
    """Figures of the instructions; adds notes."""
    out, rows = results_folder(), list[grades.Row]()
    for setting in (s for s in SETTINGS if not quick or s.name in _QUICK_SETTINGS):
        place = prepared(setting)
        if place is None:
            notes.append(_data.missing(setting.scene))
            continue
        chosen = [i for i in instructions() if i.scene == setting.scene]
        rows += list(measured(place, chosen[:_QUICK] if quick else chosen, out))
    _write(rows, out / _ROWS)
    notes.append(f"contact sheets and rows.json are in {out}")
    return grades.metrics(rows)


def instructions() -> list[Instruction]:
    """The committed instructions."""
    return [Instruction(**data) for data in _data.instructions(INSTRUCTIONS)]


def measured(place: Place, chosen: Sequence[Instruction], out: Path) -> Iterator[grades.Row]:
    """Carry out instructions in a setting, one by one, and write their sheets."""
    answers, known = carrying.read_answers(), grades.read_grades()
    for instruction in chosen:
        carried, shown = carrying.carry_out(instruction, place, answers)
        sheets.save(instruction, carried, shown, out)
        yield grades.graded(instruction, carried, known)


def _write(rows: Sequence[grades.Row], path: Path) -> None:
    """Write rows in the place of older ones with the same key; others stay."""
    kept = {c.key: c for c in _read(path)} if path.is_file() else {}
    kept.update({row.carried.key: row.carried for row in rows})
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps([c.to_json() for c in kept.values()], indent=1, ensure_ascii=False), encoding="utf-8")


def _read(path: Path) -> list[Carried]:
    return [Carried.from_json(data) for data in json.loads(path.read_text(encoding="utf-8"))]


def _print_table(out: Path) -> None:
    """Print the table of the last runs with the present grades, and its figures."""
    by_id, known = {i.id: i for i in instructions()}, grades.read_grades()
    order = [setting.name for setting in SETTINGS]
    carried = sorted(_read(out / _ROWS), key=lambda c: (order.index(c.key.split(" ", 1)[1]), c.key))
    rows = [grades.graded(by_id[c.key.split(" ")[0]], c, known) for c in carried]
    print(grades.table(rows))
    for metric in grades.metrics(rows):
        print(f"{metric.key}: {metric.value:.3g} {metric.unit}")


def main() -> None:
    """Carry out some instructions and print what became of them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("settings", nargs="*", default=[s.name for s in SETTINGS])
    parser.add_argument("--keep", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("--table", action="store_true")
    given = parser.parse_args()
    out = results_folder()
    if given.table:
        _print_table(out)
        return
    only = set(filter(None, given.only.split(",")))
    for setting in (s for s in SETTINGS if s.name in given.settings):
        start = time.perf_counter()
        place = prepared(setting, out / "embedded" if given.keep else None)
        if place is None:
            print(_data.missing(setting.scene))
            continue
        print(f"{setting.name}: ready in {time.perf_counter() - start:.0f} s", flush=True)
        chosen = [i for i in instructions() if i.scene == setting.scene and (not only or i.id in only)]
        for row in measured(place, chosen, out):
            _write([row], out / _ROWS)
            c = row.carried
            print(f"{c.key} [{c.look}] {c.outcome} ({row.counts}): {row.instruction.text}\n    {c.said}", flush=True)


if __name__ == "__main__":
    main()
