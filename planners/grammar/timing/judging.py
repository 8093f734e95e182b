"""Judges what rules read of an instruction by what the models tell of it, and tells what it most likely asks for."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from itertools import pairwise, starmap

from pydantic import ValidationError

from ....gaussians import late_re as re
from ....gaussians.errors import UserError
from ....gaussians.language.query.query import Query
from ....tools.operation import EditOp
from ....tools.registry import OPS
from ....tools.registry import parse as parse_op
from ....tools.when import When
from ...plan import Movement
from ..learned.marks import Span
from ..learned.seen import hues
from ..parsing import Refusal
from ..tagging.words import bag
from ..vocabulary.nouns import is_known, is_opened
from . import happenings, moments
from .command import Command, Fields
from .ending import MovementOf, stopping_later
from .happenings import IT
from .marked.commands import commands
from .marked.guards import is_ruled_out, says_more
from .marked.kinds import COURSES, LEAST, STATIC, SURE, is_changed_by, is_clear, is_done_by, likely, marked, marked_ways
from .marked.lost import leaves_out
from .marked.names import MOVING, with_nouns
from .marked.orders import each_in_time
from .marked.proof import is_borne_out, moments_of
from .marked.slots import ALL_MOVING, Slots, asks_more, slots
from .marked.times import TIMES
from .marked.wanted import Wanted
from .marked.wished import CERTAINLY, SURELY, is_wished
from .reading import CLAUSE, TIMELESS, TimeReader
from .whens import of_one_movement
from .wording import LONG_WORDS, in_words, spelt_out, spelt_right

After = Callable[[Sequence[EditOp], Query], Movement | None]  # how something would move after operations
Moves = Callable[[Query], bool | None]  # whether what a query names moves in the scene; None if that cannot be told

_SURELY = 0.7  # probability from which it speaks against another change of a motion
_SAID_SO = 0.5  # probability from which a kind of wish speaks against operations of another one
_WISHED = ("recolor", "delete")
_OF_MOTION = ("pace", "articulate")
_OF_A_KIND = (
    "opacity", "delete", "insert", "merge", "exchange", "recolor", "restyle", "articulate", "rotate", "scale", "move",
    "spin", "pace",
)  # fmt: skip
_PACES = bag("speed pace tempo slower faster")  # words that no change of size is said with
_LOOKS = ("opacity", "recolor", "restyle")
_THROUGHOUT = re.compile(r"\b(?:throughout|all the (?:way|time)|(?:whole|entire) (?:film|time|clip|video))\b")
_PACED = (*COURSES, "amount")
_LOOKS_OR_THINGS = ("insert", "recolor", "rotate", "scale")
_REPEATS = re.compile(r"(?:please )?(?:repeat|replay)\b", re.IGNORECASE)
_SWITCHED_OFF = re.compile(
    r"\b(?:cut|conk|give|gave)\w* out\b|\b(?:turn|switch|shut)(?:ed|s)? (?:\w+ ){0,4}off\b", re.IGNORECASE
)
_PLACED = re.compile(r" (?:beside|on|near|by|in|at|under|behind|next to|above|with|of|from) ")
_RIDS = re.compile(r"\b(?:delete|remove|take|hide|get rid|throw|erase)\b", re.IGNORECASE)
_SPEEDS = re.compile(r"\b(?:slow|slower|slowly|fast|faster|quick|quicker|quickly|speed|pace)\b", re.IGNORECASE)
_EACH = {"order": "begin", "begin": "begin", "together": "begin", "open": "open", "close": "close", "hide": "hide"}
_ON_ITS_WAY = ("duration", "speed", "begin", "pause", "together", "order", "reverse", "repeat")  # of what moves itself
_IN_TURN, _ITS_TIME = {"open", "order"}, {"begin", "duration"}  # kinds that one wish may be of
_SEEN = ("delete", "opacity", "recolor")
_ONCE_FOR_ALL = ("delete", "restyle", "insert", "duplicate", "scale")
MARKED = 0.5  # probability of a kind from which what the marks hold is its command
_LONGEST = 45  # words of an instruction with one wish
_ALL_ELSE = re.compile(
    r"\b(?:everything|all) (?:else(?! (?:being|stays|remains|is to|as))|but)\b|\b(?:remove|delete|hide) the rest\b"
)
_ALWAYS = re.compile(
    r"\b(?:throughout|always|all the time|all (?:film|clip|video|movie)\b|(?:whole|entire|full) "
    r"(?!seconds?\b|secs?\b|turns?\b|rounds?\b)\w+|at all times|at any (?:time|point)|all through|for ever|forever|"
    r"from (?:the )?(?:first|start|beginning) (?:\w+ )?to (?:the )?(?:last|finish|end))\b"
)
_EDGE = re.compile(r"\b(?:start|beginning|end|finish|first frame|last frame)\b")
_AS_WELL = re.compile(
    r"\b(?:and|but|yet) (?:\w+ )?(?:also|meanwhile)\b|\bmeanwhile\b|, yet \w+ (?:must|should|has to)\b"
)
_SHUT, _OUT = (
    r"(?:shut|closed|pushed in)",
    r"(?:open|opened|extended|out|pulled out|ajar|wide)",
)
_AT_ONCE = r"(?:(?:at|in) (?:the )?same time|simultaneously|at once)"
_BOTH_WAYS = re.compile(  # "completely shut and simultaneously extended"
    rf"\b{_SHUT} (?:and|but|yet) (?:also|both|likewise|{_AT_ONCE}) (?:\w+ly )?{_OUT}\b|"
    rf"\b{_OUT} (?:and|but|yet) (?:also|both|likewise|{_AT_ONCE}) (?:\w+ly )?{_SHUT}\b|"
    rf"\bboth (?:\w+ )?(?:{_SHUT} and (?:\w+ )?{_OUT}|{_OUT} and (?:\w+ )?{_SHUT})\b|"
    rf"\b(?:{_SHUT} and (?:\w+ )?{_OUT}|{_OUT} and (?:\w+ )?{_SHUT}),? (?:\w+ ){{0,3}}{_AT_ONCE}\b"
)
_NEVER_LEAVES = re.compile(  # "walks all the way to the bed without ever leaving its spot"
    r"\b(?:walks?|rolls?|drives?|goes|moves?|slides?|travels?|runs?)\b.*\bwithout (?:ever |once |even )?"
    r"(?:leaving (?:its|his|her|the) (?:spot|place|position)|moving|budging|stirring)\b|"
    r"\b(?:never|not once) (?:leaves?|budges?|moves?|quits?|stirs?)\b.{0,40}\b(?:and|but|yet)\b.{0,15}"
    r"\b(?:ends? up|finish(?:es)?|arrives?|gets? to|reach(?:es)?|comes? to rest|lands?)\b|"
    r"\b(?P<how>open|shut|closed)\b.{0,60}\b(?:and|but|yet)\b.{0,40}\bnever (?:\w+ )?(?P=how)\b"
)
_FIRST_AND_LAST = re.compile(
    r"\bbefore (?P<who>(?:the )?\w+) (?:does|do|sets|leaves|starts|moves|goes)\b.*"
    r"\b(?:but|yet|and) (?:not (?:until|before)|only (?:after|once|when)) (?P=who)\b|"
    r"\bbefore (?:the )?(?:\w+ ){1,3}(?:and|but|yet)\b[^.]{0,25}\bafter it\b"
)
_THROUGHOUT_OR_NOT = ("recolor", "hide", "spin", "duration", "speed")  # kinds of which "throughout" is no other time
_LOCKED = re.compile(  # "lock the ball to its spot while it rolls to the wall"
    r"\b(?:lock(?:ed|s)?|pin(?:ned|s)?|nailed|stuck|glued|motionless|stands? still|stays? (?:still|put))\b.{0,60}"
    r"\b(?:while|whilst|as) (?:it|he|she|they) (?:also |still )?"
    r"(?:rolls?|walks?|moves?|goes|drives?|travels?|spins?|opens?)\b"
)
_AT_REST = (
    r"(?:still|shut|closed|motionless|not move|not be moving|stays? put|perfectly still|at rest|frozen|stationary)"
)
_MOVES = r"(?:spin\w*|mov(?:e|es|ing)|roll\w*|walk\w*|turn\w*|open\w*|fall\w*|run\w*|rotat\w*|going)"
_THE_SAME_TIME = (
    r"(?:(?:at|in|during|over|for) (?:the|that|those|this|these) (?:very )?same (?:time|moment|instant|seconds|period)|"
    r"simultaneously|all at once|, together ,)"
)
_BOTH_AT_ONCE = re.compile(
    rf"\b{_MOVES}\b.{{0,40}}\b(?:and|but|yet|while)\b.{{0,30}}\b{_AT_REST}\b.{{0,20}}\b(?:at the same time|"
    rf"simultaneously|all at once)\b|"
    rf"\b{_AT_REST}\b.{{0,30}}\b(?:and|but|yet|while)\b.{{0,30}}\b{_MOVES}\b.{{0,40}}\b(?:at the same time|"
    rf"simultaneously|all at once)\b|"
    rf"\b{_MOVES}\b.{{0,40}}\b(?:and|but|yet)\b.{{0,8}}\b(?:at|in) the (?:same|very same) (?:time|moment|instant)\b"
    rf".{{0,20}}\b{_AT_REST}\b|"
    rf"\b{_MOVES}\b.{{0,40}}{_THE_SAME_TIME}(?: ,)? .{{0,25}}\b{_AT_REST}\b|"
    rf"\b{_AT_REST}\b.{{0,40}}{_THE_SAME_TIME}(?: ,)? .{{0,25}}\b{_MOVES}\b"
)
_NOT_AT_ALL = re.compile(
    r"\b(?:do not|does not|not|never) (?:let (?:it|him|her|them) )?"
    r"(?:move|turn|budge|stir|spin|roll|walk)\b(?: \w+)? at all\b"
)
_MOVES_ON = ("speed", "duration", "longer", "spin", "repeat")  # kinds of what moves all the same
_AT_A_RATE = re.compile(
    r"\b(?:once|twice|thrice|turns?|rounds?|revolutions?) (?:in|every|per|each) (?!a circle)", re.IGNORECASE
)
_ALL = re.compile(r"\b(?:every\w*|all|whatever|anything|both|each|they|them|things?|what)\b", re.IGNORECASE)
_EXCHANGES = re.compile(r"\b(?:swap|exchange|trade|switch)\b.*\bcolou?rs?\b", re.IGNORECASE)


def wording_of(said: str) -> list[str]:
    """The words of an instruction as they are marked: numbers and nouns spelt out, slips corrected."""
    return with_nouns(spelt_right(spelt_out(in_words(said)), LONG_WORDS)).split(" ")


def _apart(start: float, stop: float) -> float:
    return stop - start


def _colors(words: Sequence[str], spans: Sequence[Span]) -> set[str]:
    """The colours that marks tell."""
    return {" ".join(words[start:stop]) for tag, start, stop in spans if tag == "as"}


def _times(spans: Sequence[Span]) -> int:
    """How many marks tell a time."""
    return sum(tag in TIMES for tag, _, _ in spans)


def _turns_of(moves: Movement) -> tuple[float, ...]:
    """How often something that turns does so: in all, in a second, and in a minute."""
    return (moves.degrees / 360, moves.rate, 60 * moves.rate) if moves.turns else ()


class Judge:
    """Judges the operations of one instruction.

    Args:
        reader: reads its times, names and commands.
        moves, movement: tell what moves in the scene, and how; None if there is none.
        has: tells whether the scene surely has what is named.
        after: tells how something would move after operations.
    """

    def __init__(
        self,
        reader: TimeReader,
        moves: Moves | None = None,
        movement: MovementOf | None = None,
        has: Callable[[Query], bool] | None = None,
        after: After | None = None,
    ) -> None:
        self._reader, self._moves, self._movement, self._has, self._after = reader, moves, movement, has, after
        self._likeliest: dict[tuple[str, float], tuple[Fields, ...] | None] = {}

    def likeliest(self, cleaned: str, least: float = 0.0) -> tuple[Fields, ...] | None:
        """The operations that an instruction most likely asks for; None if its kind is not as likely as `least`, or if
        they would leave out anything that it names."""
        if (cleaned, least) not in self._likeliest:
            self._likeliest[cleaned, least] = self._marked(cleaned, max(least, MARKED))
        return self._likeliest[cleaned, least]

    def _marked(self, cleaned: str, least: float) -> tuple[Fields, ...] | None:
        """The operations that the likeliest kind of wish makes of what the marks of an instruction hold; None if it is
        not as likely as `least`, or if one of the marks is not understood."""
        wording = wording_of(cleaned)
        if len(wording) > _LONGEST or _ALL_ELSE.search(" ".join(wording)):
            return None
        first, *others = marked_ways(wording)
        if (found := self._marked_so(cleaned, wording, first, least)) is not None:
            return found
        kind = next(iter(likely(cleaned)), ("", 0.0))[0]
        if kind in STATIC and not any(tag in TIMES for tag, _, _ in first):
            return None  # what is done once and for all needs the likeliest marks
        named, colors = self._named_by(wording, first), _colors(wording, first)
        for spans in others:
            if not named <= self._named_by(wording, spans):
                continue  # a thing that is named stays
            if kind in STATIC and _times(first) and not _times(spans):
                continue  # and a time
            if colors and colors != _colors(wording, spans):
                continue  # and a colour
            found = self._marked_so(cleaned, wording, spans, max(least, SURE))
            if found is not None and not leaves_out(wording, found, spans=first, timed=False):
                return found
        return None

    def _named_by(self, wording: Sequence[str], spans: Sequence[Span]) -> set[Query]:
        """The things that marks name."""
        named = {self._reader.thing(" ".join(wording[start:stop])) for tag, start, stop in spans if tag == "x"}
        return {query for query in named if query is not None and not query.last}

    def _marked_so(
        self, cleaned: str, wording: Sequence[str], spans: Sequence[Span], least: float
    ) -> tuple[Fields, ...] | None:
        """As `_marked`, with these marks."""
        if any(asks_more(wording[start:stop], tag) for tag, start, stop in spans):
            return None
        for still in (False, True):
            if still and any(map(self._does_move, self._named_by(wording, spans))):
                return None  # it then asks for a course of that
            kinds = likely(cleaned, still)
            kind, chance = next(iter(kinds), ("", 0.0))
            if kind in _EACH and (parts := each_in_time(wording, spans, self._reader.thing)):
                if sum(chance for own, chance in kinds if _EACH.get(own) == _EACH[kind]) < least:
                    return None
                own = [self.made_of(_EACH[kind], SURELY, words, marks) for words, marks in parts]
                return None if None in own else tuple(op for ops in own for op in ops or ())
            both = {own for own, _ in kinds[:2]}
            if both == _IN_TURN or (both == _ITS_TIME and {"from", "to"} <= {tag for tag, _, _ in spans}):
                chance = sum(chance for _, chance in kinds[:2])  # things that open in turn; a beginning and an end
            if chance < least:
                return None
            if (found := self.made_of(kind, chance, wording, spans)) is not None:
                return found
        return None

    def made_of(
        self, kind: str, chance: float, wording: Sequence[str], spans: Sequence[Span]
    ) -> tuple[Fields, ...] | None:
        """The first operations that a kind makes of marks, that leave nothing out, and that something moves for."""
        held = slots(wording, spans, self._reader.thing, kind, self._does_move, self._moves_how)
        if held is None:
            return None
        beside = kind == "move" and any(self._does_move(goal.query) for goal in held.goals)
        if not (held.told or beside or MOVING in held.names or self._goes_without_time(kind, chance, wording, spans)):
            return None
        if not is_clear(kind, chance, held.asked) or is_ruled_out(kind, chance, held) or says_more(kind, held):
            return None
        for wanted in commands(kind, held):
            with suppress(Refusal, UserError, ValidationError):
                found = self._ops(wanted)
                if not found or self._loses(found, wording, held) or self.is_still(found):
                    continue
                if done := self.as_told(found, wording, spans, kind):
                    return of_one_movement(held.meant, done, held.aside)
        return None

    def _goes_without_time(self, kind: str, chance: float, wording: Sequence[str], spans: Sequence[Span]) -> bool:
        """Whether a wish of a kind needs no time: for a look or a removal, or where something moves."""
        if kind in STATIC:
            return is_wished(wording, spans, chance, kind)
        return self._does_move(ALL_MOVING) or (self._moves is None and chance >= CERTAINLY)

    def _does_move(self, query: Query) -> bool:
        return self._moves is not None and self._moves(query) is True

    def _moves_how(self, query: Query) -> Movement | None:
        return None if self._movement is None else self._movement(query)

    def _loses(self, ops: Sequence[Fields], wording: Sequence[str], held: Slots) -> bool:
        """Whether operations leave out what an instruction tells, and does not tell twice or of how it is now: only
        where they seem to, the scene is asked how that is."""
        if not leaves_out(wording, ops, spans=held.spans):
            return False
        moves = self._moves_how(ALL_MOVING)
        end = math.inf if moves is None else moves.end
        free = held.said_twice(self._facts(held), end)
        return leaves_out(wording, ops, free, held.spans, shades=set(self._own_colors(held)))

    def _own_colors(self, held: Slots) -> Iterator[int]:
        """Where colours stand that the thing of an instruction has now, in words about what is not wanted, what stays,
        or nothing: "red while it rolls, and blue otherwise"."""
        query = held.queries[0]
        for tag, start, stop in held.spans:
            for at in range(start, stop) if tag in ("not", "keep", "off") else ():
                shade = query.model_copy(update={"colors": (held.words[at],)})
                if held.words[at] in hues() and self._has is not None and self._has(shade):
                    yield at

    def _facts(self, held: Slots) -> tuple[float, ...]:
        """The numbers that tell how the things of an instruction move now, also those that it says stay as they are:
        seconds, degrees, metres and centimetres."""
        found = [self._moves_how(query) for query in (*held.queries, *held.beside)]
        return tuple(
            fact
            for one in found
            if one is not None
            for fact in (
                one.start, one.stop, one.stop - one.start, one.end, *one.edges, *starmap(_apart, pairwise(one.edges)),
                one.degrees, one.metres, 100 * one.metres, *_turns_of(one),
            )
        )  # fmt: skip

    def _ops(self, wanted: Wanted) -> tuple[Fields, ...] | None:
        """The operations of a command, in words or as it is, at its time, and of those that go with it; None if one of
        them is not understood."""
        command, moment, happening = wanted.command, wanted.moment, wanted.happening
        if isinstance(command, Command):
            found = self._reader.made(command, moment, happening)
        else:
            found = self._reader.command(command, "", moment, happening, moment.told or happening is not None)
        for more in wanted.also:
            then = self._ops(more)
            found = None if found is None or then is None else (*found, *then)
        return found

    def contradicts_itself(self, cleaned: str) -> bool:
        """Whether something is to be so all the time, and otherwise at a time or as well: "keep it shut throughout, and
        have it open at 2 s"."""
        said = with_nouns(in_words(cleaned))
        if any(pattern.search(said) is not None for pattern in (_BOTH_WAYS, _NEVER_LEAVES, _LOCKED, _FIRST_AND_LAST)):
            return True
        if _NOT_AT_ALL.search(said) is not None and likely(cleaned)[:1] and likely(cleaned)[0][0] in _MOVES_ON:
            return True  # "at triple speed, but do not let it move at all"
        if _ALWAYS.search(said) is None:
            return _BOTH_AT_ONCE.search(said) is not None
        words = said.split(" ")
        spans = marked(words)
        told = [(tag, " ".join(words[start:stop]).strip(" ,.")) for tag, start, stop in spans if tag in TIMES]
        always = [_ALWAYS.search(said) is not None and tag in ("in", "for") for tag, said in told]
        things = {self._reader.thing(" ".join(words[start:stop])) for tag, start, stop in spans if tag == "x"} - {
            IT,
            None,
        }
        if len(things) > 1:
            return False
        others = any(not own and not _EDGE.search(when) for own, (_, when) in zip(always, told, strict=True))
        if any(always) and (others or sum(always) > 1 or _AS_WELL.search(said)):
            return likely(cleaned)[:1] == [] or likely(cleaned)[0][0] not in _THROUGHOUT_OR_NOT
        return _BOTH_AT_ONCE.search(said) is not None

    def wished(self, cleaned: str) -> tuple[Fields, ...] | None:
        """The operations of a wish that has no words of time: for another look of something, or that it be gone, at
        all times or at a time in bare numbers, or that what moves do so otherwise; None if that is not most likely
        asked for."""
        found = self.likeliest(cleaned, SURE)
        if found is None or all(op.get("when") is not None for op in found):
            return found
        once = all(op["op"] in _WISHED and op.get("when") is None for op in found)
        words = in_words(cleaned).split(" ")
        kind, chance = next(iter(likely(cleaned)), ("", 0.0))
        if all(op["op"] in _OF_MOTION and self._does_move(op["target"]) for op in found):
            return found
        return found if once and is_wished(words, marked(words), chance, kind) else None

    def is_of_another_kind(self, cleaned: str, ops: Sequence[Fields], least: float = _SAID_SO) -> bool:
        """Whether operations of a time, or of a look or a new thing, begin with one that no wish of the likeliest kind
        is done by: "get the robot there by 3 s" hides nothing.

        Args:
            least: probability from which a kind counts.
        """
        if len(ops) > 1 and ops[-1]["op"] == "spin" and ops[-1]["target"] == IT and _is_of_opened(ops[0]):
            return True  # "can the door shut again at 3.5? make it quick, half a second"
        if len(ops) > 1 and ops[0]["op"] in ("rotate", "tip") and ops[-1].get("change") == "reverse":
            return ops[-1]["target"] == IT and self._does_move(ops[0]["target"])  # "flip the fan, let it go backwards"
        alike = len({op["op"] for op in ops}) == 1 and (len(ops) == 1 or ops[0]["op"] in ("recolor", "move"))
        when = (ops[0].get("when") if ops else None) or When()
        if not alike or ops[0]["op"] not in _OF_A_KIND or when.gradual or when.every is not None:
            return False
        if when == When() and _EXCHANGES.search(cleaned):
            return False  # "swap the colours of both"
        if ops[0]["op"] == "delete" and ops[0].get("when") is not None and _SWITCHED_OFF.search(cleaned):
            return _RIDS.search(cleaned) is None
        if ops[0]["op"] == "spin" and is_opened(ops[0]["target"].text):
            return True  # a door turns on its hinge only
        told = moments.TIMED.search(cleaned) or _THROUGHOUT.search(cleaned) or ops[0].get("when")
        op, change = str(ops[0]["op"]), ops[0].get("change")
        kinds = likely(cleaned)
        kind, chance = next(iter(kinds), ("", 0.0))
        coursed = sum(own for course, own in kinds if course in COURSES) >= _SURELY
        if op in _SEEN and coursed and self._does_move(ops[0]["target"]):
            return True  # "the fan is to cut out at 2 s" hides nothing
        if (
            (kind, change) == ("begin", "stop")
            and when.during is not None
            and (when.stop, when.lasting) == (None, None)
        ):
            return chance >= SURE  # "make it wait, and it falls a second after ..."
        if (
            op == "move"
            and kind in ("still", "stay", "halt")
            and self._moves is not None
            and self._moves(ops[0]["target"])
        ):
            return chance >= least  # "it must stay on the shelf" puts nothing there
        if (
            op == "move"
            and kind in _ON_ITS_WAY
            and self._does_move(ops[0]["target"])
            and not {"toward", "place"} & set(ops[0])
        ):
            return chance >= least  # "let it drift down, taking two seconds" moves nothing otherwise
        if (kind, change) == ("close", "begin") and _is_of_opened(ops[0]) and when.during is None:
            return chance >= least  # the closing alone
        if (kind, change) == ("stay", "open"):  # where it opens and closes by itself
            return self._moves is not None and self._moves(ops[0]["target"]) is True and chance >= least
        if told is None and op not in (*_LOOKS_OR_THINGS, "pace", "articulate"):
            return False
        if ops[0]["op"] == "scale" and not _SPEEDS.search(cleaned):
            return False  # "too slow. Double it" makes nothing larger
        if ops[0]["op"] == "rotate" and kind == "spin" and _AT_A_RATE.search(cleaned):
            return chance >= max(least, SURE)  # "turn slowly round, once in four seconds"
        if ops[0]["op"] == "rotate" and not (self._moves is not None and self._moves(ops[0]["target"])):
            return False  # "turn the chair round to face the other way"
        if told is None and (kind not in _PACED or op == "articulate"):
            return False  # "three more blocks, all green" are put in
        if (kind, change) in (("open", "close"), ("close", "open")):
            return chance >= least
        if change in ("begin", "later") and not is_changed_by(kind, str(change)):
            return chance >= (LEAST if _REPEATS.match(cleaned) else max(least, _SURELY))
        return chance >= least and not is_done_by(kind, op)

    def is_about_another(self, cleaned: str, ops: Sequence[Fields]) -> bool:
        """Whether an operation is about none of the things that the marks of an instruction name: "the chair is no good
        there, roll it to the bed once the drawer is out" moves no drawer."""
        if len(ops) != 1 or ops[0].get("target") is None or ops[0]["target"].also:
            return False
        moving = ops[0]["target"].moving is True and ops[0]["target"].pick == "all"
        if not ops[0]["target"].text and not ops[0]["target"].colors and (not moving or _ALL.search(cleaned)):
            return False
        words = with_nouns(in_words(cleaned)).split(" ")
        target, others = ops[0]["target"].text, list[bool]()
        for tag, start, stop in marked(words):
            query = self._reader.thing(" ".join(words[start:stop])) if tag == "x" else IT
            if query is None:  # "that bedside lamp"
                own = _PLACED.split(" ".join(words[start:stop]))[0].split()
                others.append(stop - start > 1 and target.split(" ")[-1] not in own)
            elif query.text and not query.last:
                colors = ops[0]["target"].colors
                others.append(query.text != target if target else bool(query.colors) and query.colors != colors)
        return bool(others) and all(others)

    def misses_a_thing(self, cleaned: str, ops: Sequence[Fields]) -> bool:
        """Whether a look or a removal is of one thing only, and the marks of an instruction name several: "rip out the
        shelf, and the lamp can go with it"."""
        if not ops or any(op["op"] not in _SEEN for op in ops):
            return False
        words = with_nouns(in_words(cleaned)).split(" ")
        named = (self._reader.thing(" ".join(words[start:stop])) for tag, start, stop in marked(words) if tag == "x")
        things = {query.text.split(" ")[-1] for query in named if query is not None and query.text and not query.last}
        held = {word for op in ops for word in re.findall(r"[a-z]+", str(op.get("target")))}
        return len(things) > 1 and bool(things & held) and not things <= held

    def is_named_beside(self, cleaned: str, target: Query) -> bool:
        """Whether the words for a thing only tell where or when something is to be done."""
        words = with_nouns(in_words(cleaned)).split(" ")
        spans = [(tag, " ".join(words[start:stop])) for tag, start, stop in marked(words)]
        besides = [said for tag, said in spans if tag in ("y", *TIMES)]
        besides += [part for tag, said in spans if tag == "x" for part in _PLACED.split(said)[1:]]
        return target.text.split(" ")[-1] in " ".join(besides).split()

    def is_still(self, ops: Sequence[Fields]) -> bool:
        """Whether operations change how something moves that stands still in the scene."""
        for op in ops:
            if op["op"] == "pace" and self._moves is not None and self._moves(op["target"]) is False:
                return True
            if OPS[op["op"]].makes_motion:
                return False
        return False

    def as_told(
        self, ops: Sequence[Fields], wording: Sequence[str], spans: Sequence[Span] | None = None, kind: str = ""
    ) -> tuple[Fields, ...]:
        """Operations that change a motion, and begin and end something at the seconds that marks tell, as far as a
        scene tells that; none if these do not, and none like them does.

        Args:
            spans: the marks; None: the likeliest.
            kind: of the wish; "": the likeliest.
        """
        changes = [op.get("change") for op in ops if op["op"] == "pace"]
        if changes.count("speed") > 1 and all(op.get("when") is None for op in ops):
            return ()  # "too slow for me, make it twice as fast"
        if self._after is None or len(ops) != 1 or not changes or (before := self._moves_how(ops[0]["target"])) is None:
            return tuple(ops)
        spans = marked(wording) if spans is None else spans
        kind = kind or next(iter(likely(" ".join(wording))), ("", 0.0))[0]
        moments = moments_of(wording, spans, self._reader.thing, kind)
        with suppress(UserError):
            after = self._after(tuple(map(parse_op, ops)), ops[0]["target"])
            if is_borne_out(ops[0]["change"], before, after, moments):
                return tuple(ops)
        return stopping_later(ops, self._moves_how)

    def timed(self, cleaned: str, ops: Sequence[Fields]) -> tuple[Fields, ...] | None:
        """What an instruction most likely asks for at a time that its words tell and that operations leave out; None if
        they leave none out, or if that is not told."""
        at_all_times = all(op["op"] in TIMELESS or op.get("change") == "stop" for op in ops)
        if not ops or not at_all_times or any(op.get("when") is not None for op in ops):
            return None
        if any(op["target"].moving is not None for op in ops):
            return None  # "the second book that falls"
        words = in_words(cleaned)
        told = any(tag in TIMES for tag, _, _ in marked(words.split(" ")))
        if not told and next(happenings.cut(words, self._reader.thing), None) is None:
            return None
        found = self.likeliest(cleaned)
        return found if found and all(op.get("when") is not None for op in found) else None

    def fuller(self, cleaned: str, ops: Sequence[Fields]) -> tuple[Fields, ...] | None:
        """What an instruction most likely asks for, if that is the same at a time that more of its words tell: "vanish
        the moment the door moves, and be back at 4 s"; None for others."""
        if len(ops) != 1 or ops[0].get("when") is None:
            return None
        found = self.likeliest(cleaned)
        if found is None or len(found) != 1 or found[0]["op"] != ops[0]["op"] or found[0].get("when") is None:
            return None
        same = found[0].get("target") == ops[0].get("target") and found[0].get("change") == ops[0].get("change")
        more = _ends_told(found[0]["when"]) > _ends_told(ops[0]["when"])
        return found if same and (more or (_lasts(found[0]["when"]) and _begins(ops[0]["when"]))) else None

    def contradicts(self, cleaned: str, ops: Sequence[Fields]) -> bool:
        """Whether operations leave out a number or a later colour of an instruction, or change what is there once and
        for all where its words most likely ask for another course of a motion: "set off at 1 s" deletes nothing."""
        if not ops:
            return False
        words = in_words(cleaned).split(" ")
        if leaves_out(words, ops) or self._leaves_time_out(words, ops):
            return True
        paced = not _PACES.isdisjoint(words)
        if not any(op["op"] in _ONCE_FOR_ALL and (op.get("when") is not None or paced) for op in ops):
            return False
        kinds = likely(cleaned)
        return bool(kinds) and kinds[0][0] in COURSES and kinds[0][1] >= _SAID_SO

    def _leaves_time_out(self, words: Sequence[str], ops: Sequence[Fields]) -> bool:
        """Whether no operation has a time, and a clause tells one by what a thing does: "before the robot comes"."""
        looks = all(op.get("when") is None and op["op"] in _LOOKS for op in ops)
        if not looks or not CLAUSE.search(" ".join(words)):
            return False
        spans = (words[start:stop] for tag, start, stop in marked(words) if tag in TIMES)
        return any(CLAUSE.match(" ".join(said)) and any(map(is_known, said)) for said in spans)


def _is_of_opened(op: Fields) -> bool:
    return isinstance(op.get("target"), Query) and is_opened(op["target"].text)


def _lasts(when: When) -> bool:
    """Whether a time is told by what is so for a while."""
    return when.during is not None and when.during.part == "while"


def _begins(when: When) -> bool:
    """Whether of a time only the beginning is told, by what happens."""
    return when.during is not None and when.during.part == "from" and _ends_told(when) == 1


def _ends_told(when: When) -> int:
    """How much a time tells of when it begins and ends."""
    return sum(end not in (None, 0.0) for end in (when.start, when.stop, when.lasting, when.during, when.until))
