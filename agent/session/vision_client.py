"""The session's vision model: loaded when first needed, asked within the session's budget."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from ...gaussians.errors import BackendError, UserError

if TYPE_CHECKING:
    from ...planners.budget import Ledger, Progress
    from ...planners.model.backend import ModelBackend
    from ...planners.vision.asking import Purse

VISION_VARIABLE = "SCENEWRIGHT_VLM"


class VisionClient:
    """A vision model with the session's ledger.

    Args:
        model: a specification as `planners.model.load` takes it ("openai:MODEL[@URL]"), a back end, "auto" for the
            model that `SCENEWRIGHT_VLM` names, or None for no model.
        ledger: budget and spending of the session.
        progress: called while the model is waited for.

    Raises:
        UserError: the specification names no kind of model.
    """

    def __init__(self, model: str | ModelBackend | None, ledger: Ledger, progress: Progress) -> None:
        from ...planners.model import FORMS, is_model

        if model == "auto":
            model = os.environ.get(VISION_VARIABLE, "").strip() or None
        if isinstance(model, str) and not is_model(model):
            raise UserError(f"{model.partition(':')[0]!r} names no vision model; give one of {', '.join(FORMS)}")
        self.ledger, self.progress = ledger, progress
        self._model = model
        self._loaded: ModelBackend | None = None

    def __bool__(self) -> bool:
        """Whether there is a vision model."""
        return self._model is not None

    @property
    def backend(self) -> ModelBackend:
        """The model, loaded now if it is not yet.

        Raises:
            BackendError: a package, key or folder is missing, or the model reads no pictures.
            UserError: there is no model.
        """
        if self._loaded is None:
            from ...planners import model
            from ...planners.vision.asking import require_sight

            if self._model is None:
                raise UserError(f"this needs a vision model; name one with --vlm or {VISION_VARIABLE}")
            self._loaded = model.load(self._model) if isinstance(self._model, str) else self._model
            try:
                require_sight(self._loaded)
            except BackendError:
                self._loaded = None
                raise
        return self._loaded

    def purse(self, views: int) -> Purse:
        """What the next question may cost; at most so many pictures if the budget sets no number."""
        from ...planners.vision.asking import Purse

        return Purse(self.ledger, self.progress, views)
