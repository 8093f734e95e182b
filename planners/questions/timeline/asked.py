"""What questions about time have in common: their frames, the bodies and spans that these mean, and words for times."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from ....gaussians.language.query.query import Query
from ....gaussians.motion.holding import Span, common
from ...grammar.tagging.words import bag
from ..answer import Answer, AnswerType, Evidence
from ..kind import Asked, Kind, Undecided
from ..reading.phrase_templates import templates
from ..reading.time.deeds import STATES, Deed
from ..reading.time.frames import Asks, Frame, frames
from ..reading.time.happenings import Happening, happenings
from ..reading.time.moments import When
from ..survey import Found, NotResolved, Survey, Thing, listed
from .bodies import Body, Timeline
from .happening import spans_of

STATIC = "Nothing moves in this scene."
SURE = 0.95
PLACES = {"first": 0, "second": 1, "third": 2, "fourth": 3, "last": -1}  # in an order of time
SAME = 0.05  # of the larger: numbers of several things that differ by less are one number


class Untold(Exception):
    """A question was read, but the scene does not tell its answer; the message says why."""


@dataclass(frozen=True)
class Told:
    """A question with what it is asked of.

    Attributes:
        frame: the question.
        asked: as read.
        survey: the scene at the time of the session.
        timeline: what moves in it.
    """

    frame: Frame
    asked: Asked
    survey: Survey
    timeline: Timeline

    def bodies(self, what: Happening | None = None) -> tuple[Body, ...]:
        """The bodies that do it: those that are named; without a name everything that moves."""
        what = what or self.frame.what
        return self.timeline.meant(what.subject, self.survey)

    def one(self, what: Happening | None = None) -> Body:
        """The one body that does it. Of several those that do it count, if that is one.

        Raises:
            NotResolved: there are none or several.
        """
        what = what or self.frame.what
        found = self.bodies(what)
        if len(found) > 1 and what.deed is not None:
            doing = [b for b in found if self.spans(b, what)]
            if len(doing) == 1:
                return doing[0]
        if len(found) == 1:
            return found[0]
        things = tuple(b.thing for b in found if b.thing is not None)
        raise NotResolved(what.subject or Query(last=True), Found("ambiguous", things, reason="several things move"))

    def nth(self, what: Happening) -> tuple[Body, list[Span]]:
        """The body and the span of the first, second, third or last of all such happenings.

        Raises:
            Untold: there are fewer.
        """
        every = sorted(((s, b) for b in self.bodies(what) for s in self.spans(b, what)), key=lambda e: e[0])
        place = PLACES[what.nth]
        if not every or place >= len(every):
            raise Untold(f"That happens {len(every)} times only.")
        span, body = every[place]
        return body, [span]

    def others(self, what: Happening | None = None) -> tuple[Thing, ...]:
        """The things that it is done to.

        Raises:
            NotResolved: there is no such thing.
        """
        what = what or self.frame.what
        if what.object is None:
            return ()
        found = self.survey.find(what.object)
        if found.verdict == "absent" or not found.things:
            raise NotResolved(what.object, found)
        return found.things

    def spans(self, body: Body, what: Happening | None = None) -> list[Span]:
        """The spans in which a body does it, within the time that is asked of.

        Raises:
            Untold: it cannot be told of this body.
        """
        what = what or self.frame.what
        if what.deed is None:
            return list(body.moving)
        found = spans_of(what.deed, body, self.others(what), self.timeline, self.survey)
        if found is None:
            raise Untold(f"Whether {body.name} does that cannot be told from its motion.")
        return found

    def window(self) -> Span | None:
        """The span of time that is asked of, None if nothing is said of it.

        Raises:
            NotResolved, Untold: it is told by an event that is not there.
        """
        return window(self.frame.when, self)


Answering = Callable[[Told], Answer | Undecided | None]


def kind(name: str, asks: Asks, answer: Answering) -> Kind:
    """A kind of question about time, which is read as a whole by its parts."""

    def given(asked: Asked, survey: Survey) -> Answer | Undecided | None:
        return first_of(tuple(f for f in asked.slots["frames"] if f.asks == asks), asked, survey, answer)

    return Kind(name, templates("{frames:frames}"), given)


_MOTION = (
    "move", "turn", "fall", "rise", "land", "reach", "leave", "cross", "pass", "bob", "approach", "recede", "return"
)  # fmt: skip
NO_VERBS = bag("close on off in out open up down back wide working running active")  # states, of what stands still too


def is_of_motion(words: tuple[str, ...]) -> bool:
    """Whether a question is about motion, whatever the scene."""
    read = frames(words)
    deed = read[0].what.deed if read else None
    return deed is not None and deed.kind in _MOTION and deed.verb not in NO_VERBS


def first_of(read: Sequence[Frame], asked: Asked, survey: Survey, answer: Answering) -> Answer | Undecided | None:
    """The answer to the first reading that has one; else why the first one has none."""
    failed: Exception | None = None
    for frame in read:
        assert asked.timeline is not None
        try:
            found = answer(Told(frame, asked, survey, asked.timeline))
        except (NotResolved, Untold) as error:
            failed = failed or error
            continue
        if found is not None:
            return found
    if isinstance(failed, Untold):
        return nothing(str(failed))
    if failed is not None:
        raise failed
    return None


def agreed(told: Told, answer: Callable[[Body], Answer]) -> Answer:
    """A number that is the same for all bodies that do it, within `SAME`; otherwise none, with that of each.

    Raises:
        NotResolved, Untold: nothing does it, or it cannot be told of the one that does.
    """
    bodies = told.bodies()
    if len(bodies) < 2:
        return answer(told.one())
    doing = [b for b in bodies if told.spans(b)]
    if len(doing) < 2:
        return answer(told.one())
    found = [(b, answer(b)) for b in doing]
    values = [float(a.answer) for _, a in found if isinstance(a.answer, float)]
    text = "; ".join(a.text.removesuffix(".") for _, a in found)
    if len(values) < len(found) or max(values) - min(values) > SAME * max(map(abs, values)):
        return nothing(f"They differ: {text}.", "number", bodies)
    return found[0][1].model_copy(update={"text": f"{text}.", "evidence": evidence(doing, found[0][1].evidence.time)})


def nothing(text: str, answer_type: AnswerType = "text", bodies: Sequence[Body] = ()) -> Answer:
    """No answer, and why."""
    return Answer(
        answer=None, answer_type=answer_type, text=text, confidence=0.9, source="none", evidence=evidence(bodies)
    )


def evidence(bodies: Sequence[Body], time: float | None = None, others: Sequence[Thing] = ()) -> Evidence:
    """The things of an answer, and the time at which they are to be seen."""
    things = [b.thing for b in bodies if b.thing is not None]
    ids = tuple(dict.fromkeys(t.id for t in (*things, *others) if t.node is not None))
    return Evidence(ids=ids, time=time)


def number(
    value: float,
    unit: str,
    text: str,
    bodies: Sequence[Body],
    time: float | None = None,
    sure: float = SURE,
    others: Sequence[Thing] = (),
) -> Answer:
    """A number with its unit."""
    return Answer(
        answer=float(value),
        answer_type="metres" if unit == "m" else "number",
        text=text,
        confidence=sure,
        unit=unit,
        evidence=evidence(bodies, time, others),
    )


def yes_no(
    holds: bool, text: str, bodies: Sequence[Body], time: float | None = None, others: Sequence[Thing] = ()
) -> Answer:
    """A yes or no; `text` is the sentence without it."""
    return Answer(
        answer="yes" if holds else "no",
        answer_type="yesno",
        text=f"{'Yes' if holds else 'No'}, {text}",
        confidence=SURE,
        evidence=evidence(bodies, time, others),
    )


def names(bodies: Sequence[Body], text: str, time: float | None = None, single: bool = False) -> Answer:
    """One thing by its name, or several."""
    if single and len(bodies) == 1:
        return Answer(
            answer=bodies[0].label, answer_type="label", text=text, confidence=SURE, evidence=evidence(bodies, time)
        )
    return Answer(
        answer=tuple(b.label for b in bodies),
        answer_type="list",
        text=text,
        confidence=SURE,
        evidence=evidence(bodies, time),
    )


def window(when: When | None, told: Told) -> Span | None:
    """A time in words as a span of the scene's time; of no length for a moment.

    Raises:
        NotResolved, Untold: it is told by an event that is not there.
    """
    line = told.timeline
    start, stop = line.start, line.stop
    if when is None or when.kind in ("ever", "always"):
        return None
    if when.kind == "clause":
        return _clause(when, told)
    if when.kind == "middle" and when.conj == "by":
        return start, (start + stop) / 2
    if when.kind == "in":  # "how many turns does it make in 2 s", and "is it open in 2 s"
        counts = told.frame.asks in ("how_far", "how_often", "how_fast", "how_long", "how_many")
        return (start, when.start) if counts else (when.start, when.start)
    return {
        "at": (when.start, when.start),
        "span": (when.start, when.stop),
        "after": (when.start, stop),
        "last": (max(stop - when.start, start), stop),
        "start": (start, start),
        "middle": ((start + stop) / 2, (start + stop) / 2),
        "end": (stop, stop),
    }[when.kind]


def _clause(when: When, told: Told) -> Span:
    """The span of a clause: "while the door opens", "before the turn", "when the ball is on the rug"."""
    line, failed = told.timeline, None
    subject = told.frame.what.subject
    for what in happenings(when.clause):
        deed = what.deed
        if deed is None and what.subject is not None and told.frame.what.deed is not None:
            deed = told.frame.what.deed  # "after the red one": when that does the same
            what = replace(what, deed=deed)
        if deed is None:
            continue
        if (
            when.conj in ("once", "after") and deed.kind == "is_open" and not deed.phase
        ):  # "once it is open": as far as it goes
            deed = replace(deed, phase="full")
            what = replace(what, deed=deed)
        if what.subject is None or (what.subject.last and not told.survey.last):
            what = replace(what, subject=subject)
        try:
            found = [s for b in told.bodies(what) for s in told.spans(b, what)]
        except (NotResolved, Untold) as error:
            failed = failed or error
            continue
        if found:
            counts = told.frame.asks in ("yesno", "how_many", "how_far", "how_often", "which")
            conj = "when" if when.conj == "by" and not counts else when.conj
            if conj == "once" and told.frame.asks == "how_long":
                conj = "after"
            return _about(conj, deed, min(found), line)
        failed = failed or Untold(f"That does not happen here: {when.clause}.")
    raise failed or Untold(f"It is not understood when this is: {when.clause}.")


def _about(conj: str, deed: Deed, span: Span, line: Timeline) -> Span:
    a, b = span
    if deed.stops:
        a = b
    if conj in ("before", "by"):
        return line.start, a
    if conj == "until":
        return line.start, a if deed.at_once else b
    if conj == "after" or (conj == "once" and deed.kind in STATES):
        return (a if deed.at_once or deed.kind in STATES else b), line.stop
    if deed.at_once:
        return a, a
    return a, b


def within(found: Sequence[Span], window: Span | None) -> list[Span]:
    """The spans that lie in a window, cut by it; in a moment those that hold then."""
    if window is None:
        return list(found)
    a, b = window
    if a == b:
        return [s for s in found if s[0] - 1e-6 <= a <= s[1] + 1e-6]
    cut = common(list(found), [window])
    return cut + [s for s in found if s[0] == s[1] and a <= s[0] <= b]


def at(time: float) -> str:
    """A time in words: "3.5 s", "3.49 s"."""
    return f"{time:.2f}".rstrip("0").rstrip(".") + " s"


def during(span: Span) -> str:
    """A span in words: "from 1 s to 2.5 s", "at 3 s"."""
    return f"at {at(span[0])}" if span[1] - span[0] < 5e-3 else f"from {at(span[0])} to {at(span[1])}"


def spoken(found: Sequence[Span]) -> str:
    """Several spans in words."""
    return listed([during(s) for s in found])


def cap(said: str) -> str:
    """With a capital letter."""
    return said[:1].upper() + said[1:]


_DOING = {"open": "opening", "close": "closing", "fall": "falling", "turn": "turning", "cross": "crossing it"}


def verb(told: Told, what: Happening | None = None) -> str:
    """A deed in words, as a predicate: "moves", "falls", "reaches the wall"."""
    what = what or told.frame.what
    deed = what.deed
    plain = {
        None: "moves",
        "move": "moves",
        "turn": "turns",
        "open": "opens",
        "close": "closes",
        "fall": "falls",
        "land": "lands",
        "rise": "rises",
        "scene": "ends" if deed is not None and deed.stops else "starts",
        "return": "comes back",
        "is_back": "is back",
        "still": "stands still",
        "bob": "bobs",
        "is_open": "is open",
        "is_closed": "is closed",
        "slows": "slows down",
        "speeds_up": "speeds up",
        "appear": "appears",
        "vanish": "disappears",
        "recolor": "changes its colour",
    }
    other = f" {what.object.describe()}" if what.object is not None else ""
    if deed is None or deed.kind in plain:
        said = plain[deed.kind if deed is not None else None]
        if deed is not None and deed.kind != "scene" and deed.phase in ("start", "stop"):
            said = f"{deed.phase}s" + (f" {_DOING[deed.kind]}" if deed.kind in _DOING else "")
        elif deed is not None and deed.phase:
            said = said.replace("is ", {"half": "is half ", "quarter": "is a quarter "}.get(deed.phase, "is fully "))
        return said
    named = {
        "reach": "reaches",
        "enter": "comes to",
        "leave": "leaves",
        "cross": "crosses",
        "pass": "passes",
        "approach": "comes nearer to",
        "recede": "gets farther from",
        "nearest": "is nearest to",
        "farthest": "is farthest from",
    }
    if deed.kind in named:
        return f"{named[deed.kind]}{other}"
    relation = "touches" if deed.relation == "touches" else f"is {deed.verb}"
    return f"{relation}{other}"
