"""Questions and instructions about the six moving rooms by somebody who knew the rooms from a description and no code.

`questions.jsonl` and `instructions.jsonl` are what the readers were developed with; `held_questions.jsonl` and
`held_instructions.jsonl`, by another writer, are asked for afterwards only. `later_instructions.jsonl` is by a writer
who was read after a first score; it is no part of the benchmark. A line holds room, text, expect and a note
on who speaks.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent


def cases(name: str) -> list[dict[str, Any]]:
    """The lines of a file, none if it is not there.

    Args:
        name: "questions", "instructions", "held_questions", "held_instructions" or "later_instructions".
    """
    path = FOLDER / f"{name}.jsonl"
    return [json.loads(line) for line in path.read_text().splitlines() if line] if path.exists() else []
