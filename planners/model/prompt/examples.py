"""Parse the few-shot examples of the prompt: a scene, and instructions with correct answers. Tests check the answers.

The format of the file:

    ## Scene                       ## make it darker
    ```json                        after: paint the sofa red
    {…a scene graph…}              touches: 1
    ```                            ```json
                                   {…a reply…}
                                   ```

`touches` lists the nodes that each operation changes, with semicolons between operations and "-" for none. It is for
the tests and not part of the prompt.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass

from ...rooms.graph import SceneGraph

_SECTION = re.compile(r"^## (?P<title>[^\n]+)\n(?P<notes>.*?)```json\n(?P<data>.*?)\n```", re.MULTILINE | re.DOTALL)
_NOTE = re.compile(r"^(after|touches): (.+)$", re.MULTILINE)
_SCENE = "Scene"


@dataclass(frozen=True)
class Example:
    """One instruction and its correct answer.

    Attributes:
        instruction: its text.
        previous: the previous instruction, if any.
        touches: for each operation the ids of the nodes it changes.
        answer: the reply as JSON on one line.
    """

    instruction: str
    previous: str | None
    touches: tuple[tuple[int, ...], ...]
    answer: str

    def told(self) -> str:
        """The example as text of the prompt."""
        before = f"Instruction before: {quoted(self.previous)}\n" if self.previous else ""
        return f"{before}Instruction: {quoted(self.instruction)}\nAnswer: {self.answer}"


def parse(text: str) -> tuple[SceneGraph, tuple[Example, ...]]:
    """Parse the scene and the examples of a prompt file.

    Raises:
        ValueError: the file does not have that format, or a block is not JSON. A bug in the file, not a user's error.
    """
    sections = list(_SECTION.finditer(text))
    if len(sections) != len(re.findall(r"^## ", text, re.MULTILINE)) or not sections or sections[0]["title"] != _SCENE:
        raise ValueError("examples begin with a section Scene, and every section has a block of JSON")
    return SceneGraph.model_validate_json(sections[0]["data"]), tuple(map(_example, sections[1:]))


def _example(section: re.Match[str]) -> Example:
    notes = dict(_NOTE.findall(section["notes"]))
    touches = tuple(
        tuple(int(i) for i in step.replace("-", "").replace(",", " ").split())
        for step in (notes["touches"].split(";") if "touches" in notes else ())
    )
    answer = json.dumps(json.loads(section["data"]), ensure_ascii=False)
    return Example(section["title"].strip(), notes.get("after"), touches, answer)


def quoted(text: str) -> str:
    """The text as a JSON string on one line, so that its end is unambiguous."""
    return json.dumps(text, ensure_ascii=False)
