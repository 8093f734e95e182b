"""What one instruction did: its plan, a receipt for each operation, and the scenes before and after.

Knows values. Refuses to know how they came about.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ...gaussians.camera import Camera, Render, Vec3
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene

if TYPE_CHECKING:
    from ...planners.plan import EditPlan
    from ...tools.receipt import Receipt


@dataclass(frozen=True, eq=False)
class Result:
    """The outcome of `Session.do`.

    Attributes:
        text: the instruction as said.
        plan: what it was taken to mean; None for undo and redo.
        receipts: one for each operation of the plan, in order.
        before, scene: the scene before and after; they share every column that did not change.
        viewer: the camera whose left and right were meant.
        selection: what "it" means next, None if nothing was selected.
        seconds: wall time a stage: "plan", "embed", "edit", "log".
        dry_run: nothing was kept; `scene` shows what would be.
    """

    text: str
    plan: EditPlan | None
    receipts: tuple[Receipt, ...]
    before: Scene
    scene: Scene
    viewer: Camera
    selection: Selection | None = None
    seconds: Mapping[str, float] = field(default_factory=dict)
    dry_run: bool = False

    def render(self, camera: Camera | None = None, background: Vec3 = (0.0, 0.0, 0.0)) -> Render:
        """The edited scene as `camera` sees it, by default the viewer."""
        from ...gaussians.render import render

        return render(self.scene.cloud, camera or self.viewer, background)

    def sentences(self) -> tuple[str, ...]:
        """What was done, a sentence for each operation, with the notes a person should read: first what was read
        otherwise than it was written, if anything was."""
        read = (f"note: {self.plan.reason}",) if self.plan is not None and self.plan.reason else ()
        return read + tuple(line for r in self.receipts for line in (r.sentence(), *(f"note: {n}" for n in r.notes)))

    def to_json(self) -> dict[str, Any]:
        """Plain data for `--json`; the plan tells who planned it, by which prompt, and what asking a model took."""
        return {
            "verdict": "ok",
            "text": self.text,
            "plan": self.plan.model_dump(mode="json") if self.plan is not None else None,
            "receipts": [r.model_dump(mode="json") for r in self.receipts],
            "groups": list(self.selection.groups) if self.selection is not None else [],
            "gaussians": len(self.scene.cloud),
            "seconds": {stage: round(s, 4) for stage, s in self.seconds.items()},
            "dry_run": self.dry_run,
        }
