"""The plans that answers to a session's open question make, and what the question offers.

`Session.question` is the open question; what is found here replaces it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

from ...gaussians.errors import AbsentError, ScenewrightError, UnconfirmedError, UserError
from . import portions
from .answers import chosen_numbers, keeps_and_more, rejects, says_enough
from .clarify import (
    Question,
    as_a_whole,
    asked_about,
    is_further,
    plan_with_answer,
    plan_with_query,
    with_plural,
    without_further,
)
from .offers import PARTS_PAGE, offered, offers_of
from .offers import chosen as offered_choice
from .planner_client import is_dismissal
from .refusal import with_message

if TYPE_CHECKING:
    from ...gaussians.camera import Camera
    from ...gaussians.language.encoders import Encoder
    from ...gaussians.language.query.query import Query
    from ...gaussians.scene import Scene
    from ...planners.plan import EditPlan


class Asking(Protocol):
    """What has an open question: the session."""

    question: Question | None

    @property
    def scene(self) -> Scene: ...

    @property
    def viewer(self) -> Camera: ...

    @property
    def encoder(self) -> Encoder: ...

    def noun_phrase(self, text: str) -> Query | None:
        """What an answer means as a noun phrase, None if it is none."""

    def regroup(self, scene: Scene) -> None:
        """Take over a scene whose field or groups differ, not its Gaussians."""


def answered(session: Asking, text: str) -> EditPlan:
    """The plan of the open question with an answer in it; raises as `Session.answer`."""
    asked = session.question
    if asked is None or not asked.candidates:
        raise UserError("there is no open question; give an instruction")
    if rejects(text) and (error := offer_others(session)) is not None:
        raise error
    if is_further(asked) and says_enough(text):
        return without_further(asked)
    if asked.offered and (held := keeps_and_more(text, len(asked.candidates))) is not None:
        raise _offer_more(session, asked, held)
    single = asked.selection.verdict == "unconfirmed"
    if (portion := portions.read(text, len(asked.candidates), single=single)) is not None:
        return _portion(session, asked, portion)
    by_number = asked.offered or any(c.ids is not None for c in asked.candidates)
    if by_number and (places := chosen_numbers(text, len(asked.candidates))) is not None:
        absent = asked.selection
        every = (*absent.candidates, *asked.kept)
        places = (*places, *range(len(absent.candidates), len(every)))
        scene, meant = offered_choice(session.scene, absent.query, every, places)
        session.regroup(scene)
        return with_plural(plan_with_query(asked, meant), asked)
    if single and is_dismissal(text):
        session.question = None
        raise UnconfirmedError(
            f"nothing was changed; say in other words what is meant by {asked.selection.query.describe()}"
        )
    return plan_with_answer(asked, text, session.noun_phrase)


def offer_others(session: Asking) -> ScenewrightError | None:
    """Let the open question offer other things than those it lists, and the error that says so; None if there are none
    left."""
    asked = session.question
    return None if asked is None else offer(session, asked, page=asked.page + 1 if asked.offered else 0)


def offer(
    session: Asking, question: Question, error: ScenewrightError | None = None, *, page: int = 0
) -> ScenewrightError | None:
    """Let the open question offer what may be meant by what was not found, and the error that says so; None if there is
    nothing to offer. What an earlier step of the same plan makes is not offered."""
    encoder = session.encoder if session.scene.language is not None else None
    found = offered(session.scene, question.selection, session.viewer, encoder, question.resolve, page=page)
    if found is None:
        return None
    told = found.reason.removeprefix(question.selection.reason).removeprefix("; ")
    selection = replace(found, verdict="absent", ids=found.ids[:0], groups=())
    session.question = replace(question, selection=selection, offered=True, page=page)
    if about := asked_about(question):
        told = f"this asks for {about}: {told}; or 'that is all' if it is in what was chosen"
    said = str(error) if error is not None else f"nothing was changed; {question.selection.query.describe()}"
    return with_message(error or AbsentError(said), f"{said}; {told}")


def _offer_more(session: Asking, asked: Question, held: tuple[int, ...]) -> ScenewrightError:
    """Let the open question keep some candidates and offer others, and the error that says so."""
    error = offer_others(session)
    if error is None or session.question is None:
        raise UserError("there are no others; say the numbers alone, or a portion: 'the red part of 2'")
    kept = (*asked.kept, *(asked.candidates[i] for i in held))
    session.question = replace(session.question, kept=kept)
    return with_message(error, f"{error}; {len(kept)} of those before are kept")


def _portion(session: Asking, asked: Question, portion: portions.Portion) -> EditPlan:
    """The plan of a question for a portion of its candidates, which becomes a group of its own; or their pieces as new
    candidates.

    Raises:
        AbsentError: the pieces are offered.
        UserError: there is no such portion.
    """
    absent = asked.selection
    if portion.kind == "pieces":
        raise _offer_pieces(session, asked, portion)
    whole = portion.kind == "whole" and not portion.more and not asked.kept
    if whole:
        scene, meant = offered_choice(session.scene, absent.query, absent.candidates, portion.places)
    else:
        every = (*absent.candidates, *asked.kept)
        held = portions.Portion("numbers", tuple(range(len(absent.candidates), len(every))))
        portion = replace(portion, more=(*portion.more, held)) if asked.kept else portion
        scene, meant = portions.taken(session.scene, portion, absent.query, every, session.viewer)
    session.regroup(scene)
    plan = plan_with_query(asked, meant)
    return as_a_whole(plan, asked.step) if whole else plan


def _offer_pieces(session: Asking, asked: Question, portion: portions.Portion) -> ScenewrightError:
    """Let the open question offer the pieces of some candidates, and the error that says so."""
    if not portion.places:
        found = offer(session, asked, page=PARTS_PAGE)
        return found or AbsentError("nothing smaller is known; say of which number: 'pieces of 3'")
    groups = [asked.candidates[i].group for i in portion.places]
    if any(g < 0 for g in groups):
        raise UserError("that one cannot be divided; say where it is ('the left one'), or 'all'")
    scene, found_pieces = portions.pieces(session.scene, groups)
    if len(found_pieces) <= len(groups):
        raise UserError("it cannot be divided further; say a colour or a side of it: 'the red part of 3'")
    session.regroup(scene)
    error, session.question = offers_of(asked, scene, found_pieces, session.viewer)
    return error
