"""The result of one instruction: its plan, a receipt for each operation, and the scenes before and after."""

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
        text: the instruction as given.
        plan: its plan; None for undo and redo.
        receipts: one for each operation of the plan, in order.
        before, scene: the scene before and after; they share every column that did not change.
        viewer: the camera in whose frame left and right were resolved.
        said_at: the time of a scene with motion at which it was said, seconds; None if none was set.
        selection: what "it" refers to in the next instruction, None if nothing was selected.
        seconds: wall time of each stage: "plan", "embed", "edit", "log".
        dry_run: the session's scene was not changed; `scene` is what the edit would give.
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
    said_at: float | None = None

    def render(self, camera: Camera | None = None, background: Vec3 = (0.0, 0.0, 0.0)) -> Render:
        """The edited scene as `camera` sees it, by default the viewer."""
        from ...gaussians.render import render

        return render(self.scene.cloud, camera or self.viewer, background)

    def _repr_png_(self) -> bytes:
        """The viewer's picture, which notebooks display."""
        from ..pictures.image_files import encoded_png

        return encoded_png(self.render().to_uint8())

    def sentences(self) -> tuple[str, ...]:
        """A sentence for each operation, each followed by its notes; first a note on words that the planner corrected,
        if there are any."""
        corrected = (f"note: {self.plan.reason}",) if self.plan is not None and self.plan.reason else ()
        lines = tuple(line for r in self.receipts for line in (r.sentence(), *(f"note: {n}" for n in r.notes)))
        return corrected + lines

    def to_json(self) -> dict[str, Any]:
        """Plain data for `--json`; the plan holds its planner, prompt hash and model usage."""
        cloud = self.scene.cloud
        return {
            "verdict": "ok",
            "text": self.text,
            "plan": self.plan.model_dump(mode="json") if self.plan is not None else None,
            "receipts": [r.model_dump(mode="json") for r in self.receipts],
            "groups": list(self.selection.groups) if self.selection is not None else [],
            "gaussians": len(cloud) if cloud.rest is None else cloud.rest.count(cloud),
            "seconds": {stage: round(s, 4) for stage, s in self.seconds.items()},
            "dry_run": self.dry_run,
        }
