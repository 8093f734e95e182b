"""What the dial decides in a session: how the scene is embedded, whether holes are filled, how many views are sent."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ...gaussians.effort import Dial, Effort
    from ...gaussians.scene import Scene
    from ...planners.plan import EditPlan


@dataclass(frozen=True)
class SessionDial:
    """The dial of a session; without one everything is as usual.

    Attributes:
        dial: of the present job, or None.
    """

    dial: Dial | None = None

    @classmethod
    def of(cls, effort: Effort | Dial | None) -> SessionDial:
        """From the argument of `Session`.

        Raises:
            UserError: it is no effort.
        """
        if effort is None:
            return cls()
        from ...gaussians.effort import Dial

        return cls(effort if isinstance(effort, Dial) else Dial(effort))

    def begin(self) -> None:
        """Begin another job."""
        if self.dial is not None:
            self.dial.begin()

    def embedding(self, scene: Scene, then: str | None = None) -> dict[str, Any]:
        """Keyword arguments of `embed`; `then`: the method that needs time after it."""
        if self.dial is None:
            return {}
        reserve = 0.0 if then is None else self.dial.fastest(then, len(scene.cloud))
        return {"effort": self.dial, "reserve": reserve}

    def fills(self, plan: EditPlan, scene: Scene, usual: bool) -> bool:
        """Whether holes of a plan are filled; `usual`: without a dial, or where the user said it."""
        revealing = sum(op.reveals for op in plan.ops)
        if self.dial is None or not revealing or any(o.endswith("infill") for o in self.dial.overruled):
            return usual
        return bool(self.dial.choose("edit", revealing * len(scene.cloud)).settings["infill"])

    def views(self, usual: int) -> int:
        """Pictures of the first request to a vision model."""
        if self.dial is None:
            return usual
        return int(self.dial.choose("ask", 1.0).settings["views"])
