"""`compose`: from a sentence to the graph of a room, in one call.

Knows that wishes may conflict, and says so rather than give half of them unasked. Refuses to know how things are chosen
(compose/) and placed (layout/), and Gaussians (`SceneGraph.build` makes them).
"""

from __future__ import annotations

from ..gaussians.errors import InstructionError
from .graph import SceneGraph


def compose(text: str, *, seed: int = 0, planner: str | None = None, best: bool = False) -> SceneGraph:
    """The graph of the room that `text` describes; the same arguments give the same graph.

    Args:
        text: "a minimalist home office", "a cozy coffee shop with a counter and four small tables".
        seed: what varies between two rooms of one description.
        planner: who chooses the things: a language model as `--planner` names it, None for the knowledge that ships
            with the package.
        best: take what can be had where wishes conflict.

    Raises:
        UserError: the words describe no room.
        InstructionError: not everything that is wished is possible together; the message names the smallest conflict.
    """
    from .compose.compose import compose as composed

    layout = composed(text, seed=seed, planner=planner).layout
    if layout.conflicts and not best:
        smallest = min(layout.conflicts, key=lambda conflict: len(conflict.statements))
        raise InstructionError(f"not all of this is possible together: {'; '.join(smallest.statements)}")
    return layout.graph
