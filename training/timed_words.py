"""Learn to tell the kinds of wishes and questions about time and motion, and of what happens at a time.

    python -m scenewright.training.timed_words [--held wishes:74,75 questions:27]

Reads `timed_wishes.tsv`, `timed_questions.tsv` and `timed_events.tsv` and writes the weights of
`planners/grammar/learned/`. With `--held` it leaves out the sentences of some writers instead, and tells how well these
are told.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from ..planners.grammar.learned.network import FILE
from .wording import networks, sentences, told_of, without

FILES = {task: Path(__file__).with_name(f"timed_{task}.tsv") for task in ("wishes", "questions", "events")}


def main() -> None:
    """Learn from all sentences, or tell how well those of some writers are told."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--held", nargs="+", default=[], metavar="TASK:WRITERS")
    writers = {task: said.split(",") for task, said in (held.split(":") for held in parser.parse_args().held)}
    tasks, held = without({task: sentences(path) for task, path in FILES.items()}, writers)
    model = networks(tasks)
    if not writers:
        model.write(FILE)
    for task, known in held.items() if writers else ():
        print(task, len(known), told_of(model, task, known))


if __name__ == "__main__":
    main()
