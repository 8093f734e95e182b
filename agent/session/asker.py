"""Answers questions about a session's scene: from geometry, and from a vision-language model where one is named."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...gaussians.camera import Camera
    from ...gaussians.language.encoders import Encoder
    from ...gaussians.language.query.selection import Selection
    from ...gaussians.scene import Scene
    from ...planners.questions.answer import Answer
    from ...planners.questions.survey import Survey
    from ...planners.questions.timeline.bodies import Timeline
    from .vision_client import VisionClient

FIRST_VIEWS = 3  # pictures of the first request to a vision model


@dataclass
class Asker:
    """Keeps the survey of the present scene, so that only the first question after an edit measures it."""

    _survey: Survey | None = field(default=None, init=False)
    _of: tuple[object, ...] = field(default=(), init=False)
    _timeline: Timeline | None = field(default=None, init=False)

    def survey(self, scene: Scene, viewer: Camera, encoder: Encoder | None, last: Selection | None) -> Survey:
        """The survey of an embedded scene; "it" refers to `last`.

        Raises:
            UserError: the scene is larger than a scene graph may be.
        """
        from ...planners.questions.survey import Survey

        of = (scene.cloud, scene.language, viewer)
        if self._survey is None or not all(a is b for a, b in zip(self._of, of, strict=True)):
            self._survey, self._of = Survey.of_scene(scene, viewer, encoder), of
        return self._survey.in_scene(scene, viewer, encoder, last)

    def timeline(
        self, scene: Scene, viewer: Camera, encoder: Encoder | None, last: Selection | None, now: float | None = None
    ) -> Timeline | None:
        """What moves in an embedded scene, None in a static one; "it" refers to `last`.

        Args:
            now: the time that questions without one are asked of, seconds; None: the start.
        """
        from ...planners.questions.timeline.bodies import Timeline

        if not scene.motion:
            return None
        known = self._timeline
        if known is None or not (known.scene is scene and known.viewer is viewer):
            known = self._timeline = Timeline(scene, viewer, encoder)
        return replace(known, last=last, now=scene.motion.start if now is None else now)


def see_answer(
    text: str, measured: Answer, survey: Survey, scene: Scene, viewer: Camera, vision: VisionClient,
    first: int = FIRST_VIEWS,
) -> Answer:  # fmt: skip
    """What a vision model answers from pictures where geometry has no answer.

    A model that cannot be asked leaves geometry's answer, with the reason in its text. `first`: pictures of the first
    request.
    """
    from ...gaussians.errors import BackendError
    from ...planners.vision.answering import Terms, ask_about
    from ...planners.vision.facts import Facts
    from .looker import SceneLooker

    groups = tuple(id for id in measured.evidence.ids if isinstance(id, int))
    wanted = measured.answer_type if measured.answer_type != "text" else None
    try:
        terms = Terms(wanted, groups, first, ledger=vision.ledger, progress=vision.progress)
        return ask_about(text, Facts(survey.graph), SceneLooker(scene, viewer), vision.backend, terms)
    except BackendError as error:
        told = f"{measured.text} The vision model was no help: {error}"
        return measured.model_copy(update={"text": told[:4000], "usage": getattr(error, "usage", None)})
