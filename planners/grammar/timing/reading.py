"""Reads an instruction that says something of time, of motion, or of what moves; all others are left alone.

What it says of time is cut out (`moments`, `happenings`); the rest is a command about motion (`clauses`, `manner`,
`commands`), or a plain command of the grammar, whose operations get the time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial

from pydantic import BaseModel, ValidationError

from ....gaussians import late_re as re
from ....gaussians.errors import UserError
from ....gaussians.language.query.nested import queries, with_queries
from ....gaussians.language.query.query import Query
from ....gaussians.world import kinds
from ....tools.registry import OPS
from ....tools.registry import parse as parse_op
from ....tools.when import During, When
from ..parsing import Refusal
from ..restating.speech.frames import unframed
from ..tagging.words import bag
from ..vocabulary.nouns import is_known
from ..vocabulary.quantities import NUMBERS
from . import happenings, moments, phrases
from .asides import told_of
from .clauses import AUXILIARIES
from .command import Command, Fields
from .commands import commands, loose_commands
from .following import dropped, followed, goes_back, says_again
from .happenings import IT, Happening
from .manner import MOTION
from .marked.lost import leaves_out
from .moments import Moment
from .pieces import without_remarks
from .verbs import SENSES, any_of, has_form
from .whens import closes_later, closes_when_open, inverse, of_one_movement, settled, when_of
from .wording import in_words, spelt_right, tidy, timely_words

Understand = Callable[[str], Sequence[Fields]]  # the operations of a plain command


def may_be_timed(cleaned: str) -> bool:
    """Whether any word could be about time or motion."""
    said = cleaned.lower()
    return phrases.TIME_WORDS.search(said) is not None or any(
        has_form(w, phrases.TIMELY, "plain", "s", "ing", "past") for w in re.findall(r"[a-z]+", said)
    )


class TimeReader:
    """Reads one instruction.

    Args:
        understand: reads plain commands of the grammar; raises `Refusal`.
        thing: reads a phrase for things.
    """

    def __init__(self, understand: Understand, thing: Callable[[str], Query | None]) -> None:
        self._understand = understand
        self._thing = thing
        self._things: dict[str, Query | None] = {}

    def read(self, cleaned: str) -> tuple[Fields, ...] | None:
        """The operations; None if the instruction says nothing of time or motion.

        Raises:
            Refusal: it names a time, and the rest is not understood.
        """
        said = in_words(cleaned)
        if phrases.ASKS.match(said) and cleaned.rstrip().endswith("?"):
            return None
        said = tidy(said)
        if not said:
            return None
        if phrases.CONTRARY.search(said):
            raise Refusal("it cannot be both at the same time", said, verdict="impossible")
        if phrases.STAYS_SEEN.search(said):
            raise Refusal("it says what not to do, and asks for no change", said, verdict="not_an_edit", firm=True)
        said = self._unfronted(said)
        found = self._whole(said)
        if found is not None:
            return of_one_movement(said, self._each(said) or found)
        refusal: Refusal | None = None
        try:
            guess = next(self._guesses(said), None)
        except Refusal as error:
            guess, refusal = None, error
        if guess is not None:
            return None if self._is_timeless(guess, cleaned) else of_one_movement(said, guess)
        if (found := self._without_remarks(said, cleaned)) is not None:
            return found
        if refusal is not None:
            raise refusal
        numbers = moments.TIMED.search(said)
        if numbers is not None:
            raise Refusal(f"what is to happen “{numbers[0]}” is not understood", numbers[0])
        clause = next(iter(happenings.cut(said, self.thing)), None)
        if clause is not None and clause[1].said.split()[0] not in ("as", "after", "before"):
            raise Refusal(f"what is to happen “{clause[1].said}” is not understood", clause[1].said)
        return None

    def _each(self, said: str) -> tuple[Fields, ...] | None:
        """What each part of an instruction asks for, where each or only the last tells a time: "delete the bed, and
        hide the shelf from 1 to 2 s", "roll it to the sofa in 2 s and make it blue when it arrives"; None for others.
        """
        parts = _parts(said)
        times = [self._tells_time(part) for part in parts]
        if len(parts) < 2 or (not all(times) and times != [False] * (len(parts) - 1) + [True]):
            return None
        with suppress(Refusal):
            found = self._joined(parts)
            if found is not None and len({(op["op"], op.get("change")) for op in found}) > 1:
                return found
        return None

    def _tells_time(self, part: str) -> bool:
        """Whether words tell a time, in numbers or by what happens."""
        return moments.cut(part)[1].told or next(happenings.cut(part, self.thing), None) is not None

    def _without_remarks(self, said: str, cleaned: str) -> tuple[Fields, ...] | None:
        """What is asked for beside the pieces that ask for nothing; None if that is not understood either."""
        words = in_words(cleaned).split(" ")
        for shorter in without_remarks(said, self.thing, self._is_command):
            shorter = self._unfronted(tidy(shorter))
            with suppress(Refusal):
                found = self._whole(shorter) or next(self._guesses(shorter), None)
                if found is not None and not self._is_timeless(found, shorter):
                    return None if leaves_out(words, found) else of_one_movement(shorter, found)
                if found is None and self._is_plain(shorter) and not self._is_plain(cleaned):
                    return tuple(self._understand(shorter))
        return None

    # -- things ------------------------------------------------------------------------------------------------------

    def thing(self, phrase: str) -> Query | None:
        """What a phrase for things means; None if it means none."""
        phrase = phrase.strip(" ,.")
        if phrase not in self._things:
            self._things[phrase] = self._thing_of(phrase)
        return self._things[phrase]

    def _thing_of(self, phrase: str) -> Query | None:
        if phrase in ("it", "he", "she", "him", "her", "this", "that", "they", "them", "itself"):
            return IT
        if (nth := phrases.NTH.fullmatch(phrase)) is not None and (place := _place(nth)) is not None:
            named = self.thing(f"the {nth['np']}") if _is_name(nth["np"]) else Query(text="")
            return None if named is None else _in_order(named, place)
        for pattern, moving in phrases.MOVING:
            if (of := pattern.fullmatch(phrase)) is not None:
                named = self.thing(of["np"]) if of["np"] else Query(text="", pick="all")
                return None if named is None else _which_moves(named, moving)
        words = phrase.split()
        if (
            not words
            or len(words) > 9
            or phrases.NEVER & set(words)
            or words[0] in phrases.NEVER_FIRST
            or words[-1] in phrases.NEVER_LAST
            or words[-1] in ("second", "seconds", "secs")
        ):
            return None
        if _PART_OF_TIME.search(phrase) or _SECONDS.search(phrase) or (len(words) > 1 and _is_verb(words[0])):
            return None
        for i, word in enumerate(words):
            if i == len(words) - 1 and i and kinds.find(" ".join(words[1 if _DETERMINED.match(words[0]) else 0 :])):
                continue  # "the tv stand"
            joined = i > 0 and words[i - 1] in ("and", "or")
            if _is_verb(word) and (len(words) == 1 or joined or (i and self.thing(" ".join(words[:i])))):
                return None  # "the robot stop", "the rug and stay there"
        if len(words) > 1 and not is_known(words[-1]) and self.thing(" ".join(words[:-1])):
            return None  # "the door creak"
        bare = phrases.MOVING_ONE.match(phrase)
        moves = None
        if bare is not None:
            moves, phrase = bare["how"] == "moving", f"{bare['det']} {phrase[bare.end() :]}"
        phrase = re.sub(r"^(?:that|this|a|an) (?=\w)", "the ", phrase)
        if not _DETERMINED.match(phrase):
            phrase = f"the {phrase}"
        found = self._thing(phrase.replace(" 's ", "'s "))
        if found is None or (not found.text and not found.last and not found.colors) or found.invert or found.grow:
            return None
        return found if moves is None else _which_moves(found, moves)

    def _unfronted(self, said: str) -> str:
        """An order with its object in it: "whatever walks there, make it pink"."""
        if (found := _FRONTED.match(said)) is None:
            return said
        np = _HERE.sub("", _bare(found["np"]))
        named = self.thing(np)
        if named is None or named.last:
            return said
        if named.moving and not named.text and named.pick != "nth":
            np = "everything that moves"
        return f"{found['order']}{np}{found['rest']}"

    # -- one command -------------------------------------------------------------------------------------------------

    def _joined(self, parts: Sequence[str]) -> tuple[Fields, ...] | None:
        """Several commands, of which one at least is about time; None if one is not understood."""
        ops: list[Fields] = []
        timed = False
        topic: Query | None = None
        refusal: Refusal | None = None
        for part in parts:
            about = _about(part)
            if topic is None and not ops and about is not None and part is not parts[-1]:
                topic = self.thing(about)  # "the door opens too late, make it start at 0 s"
                if topic is not None:
                    continue
            part = dropped(part, ops)
            found = self._whole(part)
            again = ops[-1]["op"] in ("recolor", "restyle") if ops else topic is not None
            if found is None and again:  # "red at 1 s and blue at 3 s", "that fan is too wild, half as quick would do"
                found = self._whole(f"make it {part}") or self._colored(part)
            first = part.split(" ")[0]
            if found is None and ops and has_form(first, tuple(SENSES), "s"):
                found = self._whole(f"it {part}")  # "it opens at 1 s and closes at 2 s"
            if found is None and ops and has_form(first, tuple(SENSES), "plain"):
                found = self._whole(f"{first} it {part[len(first) + 1 :]}")  # "open it at 1 s and close again at 2 s"
            if found and topic is not None and found[0].get("target") == IT:
                found = ({**found[0], "target": topic}, *found[1:])
            if found is not None:
                timed = True
            else:
                try:
                    found = tuple(self._understand(part))
                except Refusal as error:
                    refusal = refusal or error
            if ops and phrases.GOES_BACK_WHEN.search(part):
                return None
            if found and ops and _AGAIN.search(part) and goes_back(ops[-1], found):
                continue  # "then green again"
            if found and says_again(ops, found):
                ops = [{**found[0], "target": ops[-1]["target"]}]  # "close the door. Start closing it at 3 s"
            else:
                ops = followed(ops, found or ())
        if not timed:
            return None
        if refusal is not None:
            raise refusal  # nothing is half done
        return tuple(ops)

    def _colored(self, said: str) -> tuple[Fields, ...] | None:
        """The operation of a colour alone: "then yellow"."""
        with suppress(Refusal, UserError):
            found = tuple(self._understand(f"make it {said}"))
            return found if len(found) == 1 and found[0]["op"] == "recolor" and found[0]["target"] == IT else None
        return None

    def _whole(self, said: str) -> tuple[Fields, ...] | None:
        for rest, moment, happening in self.readings(said):
            told = moment.told or happening is not None
            for form, remark in _forms(rest):
                found = self.command(form, remark, moment, happening, told)
                if found:
                    return found
        return self._about_moving(said)

    def _guesses(self, said: str) -> Iterator[tuple[Fields, ...]]:
        """What an instruction may mean that is not read as a whole: part by part, spelled right, in any order."""
        parts = _parts(said)
        if len(parts) > 1 and (joined := self._joined(parts)) is not None:
            yield joined
        head, mark, rest = said.partition(" , ")
        topical = mark != "" and [head, rest] != parts and told_of(head) is not None
        if topical and (joined := self._joined([head, rest])) is not None:
            yield joined
        right = spelt_right(said, timely_words())
        if right != said and (spelled := self._whole(right)) is not None:
            yield spelled
        if (loose := self._loosely(said)) is not None:
            yield loose

    def _is_timeless(self, read: tuple[Fields, ...], cleaned: str) -> bool:
        """Whether a guess at motion names no time, and the rest of the grammar understands the instruction as said."""
        timed = any(op.get("when") is not None for op in read)
        if timed and (moments.TIMED.search(cleaned) or any(True for _ in happenings.cut(cleaned, self.thing))):
            return False
        return self._is_plain(cleaned)

    def _is_command(self, said: str) -> bool:
        """Whether words are a command, about time or not."""
        return self._whole(said) is not None or self._is_plain(said)

    def _is_plain(self, cleaned: str) -> bool:
        """Whether the rest of the grammar understands an instruction."""
        if _LETS.match(cleaned.lower()):
            return False  # "let the ball roll to the sofa" moves no ball roll
        with suppress(Refusal, UserError):
            return not is_misread(self._understand(cleaned))
        return False

    def _loosely(self, said: str) -> tuple[Fields, ...] | None:
        """One command about motion in any order of its words; None if its readings differ in what is to be done."""
        if _COMPLAINT.search(said):
            return None  # "too slow" asks for the contrary
        for rest, moment, happening in self.readings(said):
            told, found = moment.told or happening is not None, list[tuple[Fields, ...]]()
            if happening is None and moment.told and CLAUSE.match(rest):
                continue  # "when it comes out the chair should vanish, and return at 3 s"
            if happening is not None and happening.said.startswith("before ") and phrases.RIDDING.match(rest):
                continue
            for command, when in loose_commands(_bare(rest), self.thing, moment, told):
                with suppress(Refusal, UserError, ValidationError):
                    if ops := self.made(command, when, happening):
                        found.append(ops)
            if found:
                meant = {tuple((op["op"], op.get("change")) for op in ops) for ops in found}
                return found[0] if len(meant) == 1 else None
        return None

    def readings(self, said: str) -> Iterator[tuple[str, Moment, Happening | None]]:
        """The words without what they say of time, and what that is; the most cut first."""
        shorter = phrases.BACK_WHEN.sub("", said)
        flashes = shorter != said
        seen = set[str]()
        for text in dict.fromkeys((shorter, said)):
            for rest, moment in dict.fromkeys((moments.cut(text), (text, Moment()))):
                cuttable = False
                for left, happening in happenings.cut(rest, self.thing):
                    cuttable = True
                    if (more := next(happenings.cut(left, self.thing), None)) is not None:
                        both = more[1].ended(happening) or happening.ended(more[1])
                        if both is None:
                            continue  # "as it opens, hide it, and bring it back when it is open"
                        left, happening = more[0], both
                    if flashes and happening.during.part == "from":
                        during = happening.during.model_copy(update={"part": "while"})
                        happening = replace(happening, during=during)
                    if left not in seen:
                        seen.add(left)
                        yield left, moment, happening
                if rest not in seen and not (cuttable and moment.told):
                    seen.add(rest)
                    yield rest, moment, None

    def command(
        self, said: str, remark: str, moment: Moment, happening: Happening | None, told: bool
    ) -> tuple[Fields, ...] | None:
        if not said or (happening is None and _TIME_FIRST.match(said)):
            return None
        begins = happening is not None and happening.during.part in ("from", "after")
        if happening is not None and not begins and moment.stop is not None and moment.lasting is None:
            return None
        ends = happening is not None and happening.during.part in ("until", "until_end")
        if ends and moment.start is not None and len(_parts(said)) > 1:
            return None  # "open the door at 1 s, paint it red until it is open" has a time for each
        if happening is not None and happening.said.startswith("before ") and phrases.RIDDING.match(said):
            return None  # "delete the vase before it falls" gives a reason
        for command in commands(said, self.thing, moment, told):
            ends = moment.stop is not None or moment.lasting is not None or happening is not None
            if not _goes_without_saying(remark, command, ends):
                continue  # "roll to the wall and come back" is not half done
            with suppress(Refusal, UserError, ValidationError):
                found = self.made(command, moment, happening)
                if found:
                    return found
        plain = Command(kind="look", text=said)
        if (told or moment.always) and _goes_without_saying(remark, plain, False):
            with suppress(Refusal, UserError, ValidationError):
                return self.made(plain, moment, happening)
        return None

    def made(self, command: Command, moment: Moment, happening: Happening | None) -> tuple[Fields, ...] | None:
        """The operations of a command with its time; None if it cannot be that."""
        ops, kind = list(command.ops), command.kind
        if command.text:
            if _A_TIME_LEFT.search(command.text):
                return None  # "hide the bed at 1 s . hide the shelf at 2 s" has two
            ops = list(self._understand(command.text.replace("rightwards", "to the right")))
            ways = all(op["op"] in ("move", "rotate") for op in ops)
            if len(ops) > 1 and _AFTERWARDS.search(command.text):
                return None  # each has its own time: "blue before it opens and red afterwards"
            if command.target is not None:
                ops = [{**op, "target": command.target} if op.get("target") == IT else op for op in ops]
            if (
                not ops
                or is_misread(ops)
                or _is_strange(ops)
                or not all(map(_takes_time, ops))
                or (kind == "path" and not ways)
            ):
                return None
            if re.search(r"\b(?:off|out|on)$", command.text) and any(op["op"] in ("delete", "relight") for op in ops):
                return None  # "the light should go out"
            kind = "path" if ways else kind
        if command.timeless:
            moment = Moment()
        if happening is not None and happening.during.part in ("until", "until_end"):
            if moment.stop is not None:
                return None
            if moment.start is not None and any(map(_FROM_A_TIME.match, moment.said)):
                happening = replace(happening, from_start=True)
        if happening is not None and happening.during.part == "while" and moment.always and kind == "look":
            happening = replace(happening, during=happening.during.model_copy(update={"part": "from"}))
        if command.every is not None:
            lasting = command.blinks * command.every if command.blinks else moment.lasting
            moment = replace(moment, lasting=lasting, taken=False, slowly=False)
            kind = "motion"  # neither little by little nor a way
        if any("turns_per_second" in op for op in ops):
            moment = replace(moment, slowly=False)  # how slowly is said in numbers
        if command.always_lasts and moment.stop is None and moment.lasting is None:
            moment = replace(moment, stop="end")
        if command.fades:
            moment = replace(moment, slowly=True)
        if command.during is not None:
            if happening is not None:
                return None
            happening = Happening(During(**command.during), "")
            if happening.during.state == "open" and moment.start == "end":
                moment = Moment()  # "it must not close at the end"
        if command.ends and moment.start is not None and moment.stop is None:
            moment = replace(moment, start=None, stop=moment.start)
        if (
            happening is not None
            and happening.said.startswith("when ")
            and happening.during.part == "while"
            and all(op.get("change") in ("stop", "begin") for op in ops)
        ):  # "stop when it is turning" begins then
            happening = replace(happening, during=happening.during.model_copy(update={"part": "from"}))
        if kind == "look" and happening is not None and moment.start is None and _is_half_the_film(happening):
            moment, happening = replace(moment, start="middle"), None
        ends = moment.stop not in (None, "end") or moment.lasting is not None
        ends |= happening is not None and happening.during.part in ("while", "until", "until_end", "unless")
        if ends and ops and all(op["op"] == "delete" for op in ops):  # gone for a time: what stands on it stays there
            ops = [{"op": "opacity", "target": op["target"], "value": 0.0} for op in ops]
        stops = bool(ops) and all(op.get("change") == "stop" for op in ops)
        if happening is None and stops and moment.start == "middle" and any(map(_HALF_ITS_WAY.fullmatch, moment.said)):
            happening = Happening(During(state="halfway", part="from"), "")
            moment = replace(moment, start=None)  # half its own way, and not half the film
        if happening is not None and closes_when_open(ops, happening):  # and not when it begins to be
            opened = happening.during.model_copy(update={"state": "fully_open"})
            happening = replace(happening, during=opened)
        if happening is not None and closes_later(ops, moment, happening):  # "when it was open for one second"
            moment = replace(moment, start=moment.lasting, lasting=None)
            during = happening.during.model_copy(update={"state": "fully_open", "part": "from"})
            happening = replace(happening, during=during)
        if (
            happening is not None and stops and moment.lasting is not None and happening.during.part == "until"
        ):  # "pause for 1 s before it turns"
            happening = replace(happening, during=happening.during.model_copy(update={"part": "from"}))
        if moment.taken and moment.lasting is not None and all(op.get("change") == "speed" for op in ops):
            ops = [
                {k: v for k, v in op.items() if k != "factor"} | {"change": "begin"} for op in ops
            ]  # "faster, in 1 s"
        times = inverse(moment, happening) if command.inverse else [(moment, happening)]
        made = tuple(op for time in times for op in self._with_time(ops, *time, kind))
        if command.every is not None:
            made = tuple(
                {**op, "when": (op.get("when") or When()).model_copy(update={"every": command.every})} for op in made
            )
        return made or None

    def _with_time(
        self, ops: Sequence[Fields], moment: Moment, happening: Happening | None, kind: str
    ) -> tuple[Fields, ...]:
        made: list[Fields] = []
        for op in ops:
            target = op.get("target")
            during: During | None = None
            until: During | None = None
            if happening is not None:
                target, during = settled(target, happening.during)
                if happening.until is not None:
                    target, until = settled(target, happening.until)
                if happening.from_start:
                    during, until = None, during
                ends = len(moment.said) != 1 and all(isinstance(end, float) for end in (moment.start, moment.stop))
                exact = moment.start is not None and (ends or any(map(_AT_A_TIME.match, moment.said)))
                if during is not None and during.part in ("from", "after") and exact:
                    during = None  # "once it has opened, shut it at 3 s" is no 3 s later
                op = {**op, **({"target": target} if target is not None else {})}
            when = when_of(moment, during, kind, op)
            if until is not None:
                when = (when or When()).model_copy(update={"until": until})
            op = op if when in (None, When()) else _on_its_way(op)
            made.append({**op, **({"when": when} if when is not None else {})})
            parse_op(made[-1])  # an operation that cannot be is no reading
        return tuple(made)

    # -- what moves --------------------------------------------------------------------------------------------------

    def _about_moving(self, said: str) -> tuple[Fields, ...] | None:
        """A command about what moves, or stands still, without a time: "remove whatever moves"."""
        if (nth := phrases.NTH.search(said)) is not None and (place := _place(nth)) is not None:
            noun = nth["np"] if _is_name(nth["np"]) else ""
            named = self.thing(f"the {noun}") if noun else None
            text = f"{said[: nth.start()]}{f'the {noun}' if noun else 'everything'}{said[nth.end() :]}"
            names = ("everything", "all") if named is None else (named.text,)
            return self._with_changed(text, names, partial(_in_order, place=place))
        for pattern, moving in phrases.MOVING:
            if (found := pattern.search(said)) is not None:
                text = f"{said[: found.start()]}{found['np'] or 'everything'}{said[found.end() :]}"
                named = self.thing(found["np"]) if found["np"] else None
                meant = ("everything", "all") if named is None else (named.text,)
                return self._with_changed(text, meant, partial(_which_moves, moving=moving))
        found = phrases.MOVING_ONE.search(said)
        if found is not None:
            text = f"{said[: found.start()]}{found['det']} {said[found.end() :]}"
            noun = found["noun"].removesuffix("s")
            names = ("", "everything") if noun in ("thing", "object") else (noun,)
            return self._with_changed(text, names, partial(_which_moves, moving=found["how"] == "moving"))
        return None

    def _with_changed(
        self, text: str, names: Sequence[str], changed: Callable[[Query], Query]
    ) -> tuple[Fields, ...] | None:
        """A plain command with what has one of the names changed: to what of it moves, say."""
        with suppress(Refusal, UserError):
            ops = self._understand(_bare(text))
            hit = False

            def change(query: Query) -> Query:
                nonlocal hit
                if query.exclude or not any(name == query.text or (name and name in query.text) for name in names):
                    return query
                hit = True
                return changed(query)

            made = tuple(
                {k: with_queries(v, change) if isinstance(v, Query) else v for k, v in op.items()} for op in ops
            )
            return made if hit else None
        return None


_TIME_FIRST = re.compile(r"(?:when|whenever|once|while|as soon as) (?:the|my|our|this|that|it|he|she|they) .* , ")
_HALF_ITS_WAY = re.compile(r"(?:at )?(?:half ?way|midway)")
_A_NUMBER = re.compile(rf"\d|\b(?:{'|'.join(NUMBERS)})\b")
CLAUSE = re.compile(r"\b(?:when|whenever|once|while|until|till|before|after|as soon as|as) (?:the|that|this) ")
TIMELESS = ("delete", "move", "opacity", "recolor", "restyle")  # that are of other times, too, where a time is said
_COMPLAINT = re.compile(r"\btoo (?:slow|fast|quick|slowly|quickly|early|late)\b")


def _is_half_the_film(happening: Happening) -> bool:
    """Whether "halfway through" says nothing of what has gone half its way."""
    during, said = happening.during, set(happening.said.split())
    return (during.state, during.part) == ("halfway", "from") and during.of in (None, IT) and not said & _OF_A_WAY


def _on_its_way(op: Fields) -> Fields:
    """What is put next to a thing at a time goes there: it stops where it is beside it, and looks for no free place."""
    place = op.get("place") if op["op"] == "move" else None
    if not isinstance(place, dict) or place.get("relation") != "next_to" or len(place.get("anchors", ())) != 1:
        return op
    return {**{k: v for k, v in op.items() if k != "place"}, "toward": place["anchors"][0]}


_FRONTED = re.compile(
    r"^(?P<np>.+?)(?: ,)? (?:(?:could|can|would|will) you |please |just |then |i want (?:you to )?|let us )*"
    r"(?P<order>(?:make|turn|paint|colou?r|dye|hide|remove|delete|stop|freeze|slow|speed|move|let|have|give|spin|open|"
    r"close|play|keep|start|delay|fade|show|pause|get rid of|reverse|lift|push|pull|slide|do not (?:show|let|"
    r"move|open|close|hide|stop)) )"
    r"(?:it|that|them|him|her)(?P<rest> (?!(?:is|are|has|was|moves?|should|does)\b).*)$"
)
_HERE = re.compile(r"(?: (?:over )?(?:here|there)|,)+$")
_DETERMINED = re.compile(
    r"^(?:the|all|every|both|my|our|these|those|each|any|everything|one|two|three|four|five|his|her|their|its)\b"
)


_SECONDS = re.compile(r"\b(?:\d\S* ?)(?:s|secs?|seconds?)\b")
_THINGS = bag("sink mirror switch block swing slide paint light float lift step lead brake sail")  # names of verbs


_PART_OF_TIME = re.compile(r"\b(?:start|beginning|speed|motion|movement) of\b")
_AT_A_TIME = re.compile(r"at (?!once\b)")
_FROM_A_TIME = re.compile(r"(?:at (?!once\b)|from|starting|beginning|halfway|midway)")
_OF_A_WAY = bag("it he she they its his her their is has gone down up across along there")
_A_TIME_LEFT = re.compile(r"\b(?:at|from|until|till|between|to|before|after) \d+(?:\.\d+)? ?(?:s|secs?|seconds?)\b")
_AGAIN = re.compile(r"\b(?:again|back|as (?:before|usual|normal|ever)|like before)\b")
_NOT_SEEN = re.compile(r"\b(?:not|never) (?:ever )?(?:see|be seen)\b")
_COMES_BACK = re.compile(r"\b(?:back|returns?|comes?|again|normal|reappears?|appears?|shows?)\b")
_GOES_ON = re.compile(
    r"\b(?:opens?|goes?|go|moves?|rolls?|walks?|drives?|falls?|spins?|turns?|runs?|not|continues?|"
    r"on)\b"
)


def _goes_without_saying(remark: str, command: Command, ends: bool) -> bool:
    """Whether a remark behind a command says nothing more: what waits then goes on, and a look goes back.

    Args:
        ends: whether the time of the command has an end.
    """
    if _A_NUMBER.search(remark):
        return False  # "starting at one second, done by three"
    if phrases.GOES_BACK_WHEN.search(remark):
        return False  # "then back to blue once it is off"
    if _NOT_SEEN.search(remark) or _COMES_BACK.search(remark):
        return command.kind == "look" and not command.inverse
    if re.search(rf"\b(?:keep|let|have) (?:it|him|her|them) {any_of(MOTION, 'ing')}", remark):
        return {op.get("change") for op in command.ops} == {"go_on"}
    if re.search(r"\bstops?\b", remark):
        return command.kind == "path"
    changes = {op.get("change") for op in command.ops}
    if changes and changes <= ({"begin", "open", "stop"} if ends else {"begin", "open"}):
        return True
    return (changes == {"stop"} and re.search(r"\b(?:not|never)\b", remark) is not None) or not _GOES_ON.search(remark)


def _about(part: str) -> str | None:
    """The name of what a part tells of that asks for nothing; None if it asks, or tells a time."""
    if re.match(r"(?:when|whenever|once|as soon as|after|while|until|till|before|by the time) ", part):
        return None
    topic = told_of(part)
    if topic is None and (found := phrases.REMARK.match(part)) is not None:
        topic = found["np"] or found["kept"]
    return None if topic is None else re.sub(r"^(?:this|that|these|those) ", "the ", topic)


def _is_verb(word: str) -> bool:
    """Whether a word is a verb of the lexicon, and no name of a thing."""
    return has_form(word, tuple(SENSES), "plain", "s", "past", "ing") and word not in _THINGS


def _which_moves(query: Query, moving: bool) -> Query:
    text = "" if query.text in ("everything", "all", "thing", "object") else query.text
    return query.model_copy(update={"text": text, "moving": moving})


_ANY = (None, "one", "thing", "object", "item")


def _is_name(noun: str | None) -> bool:
    return noun not in _ANY


def _place(found: re.Match[str]) -> int | None:
    """The place in an order that words name: from 1, -1 the last; None if they name none."""
    said = found["a"] or found["b"] or found["c"]
    if said is None:
        return None
    return -1 if said == "last" or said.startswith("after") else phrases.RANKS.get(said, 1)


def _in_order(query: Query, place: int) -> Query:
    """What of it begins to move as the first, the second, the last."""
    return _which_moves(query, True).model_copy(update={"pick": "nth", "ordinal": place})


def _forms(said: str) -> Iterator[tuple[str, str]]:
    """A command as it is said, and without the remarks at its end; with the remarks."""
    form, remarks, seen = _bare(said), "", set[str]()
    while form and form not in seen:
        seen.add(form)
        yield form, remarks
        shorter = phrases.REMARKS.sub("", form)
        form, remarks = _bare(shorter), form[len(shorter) :] + remarks
    first, mark, rest = said.partition(" , ")
    if mark and len(first.split()) < 6 and (turned := _bare(f"{rest} {first}")) not in seen:
        yield turned, ""  # "at half speed, play it all"


def _bare(said: str) -> str:
    """A command without politeness, and without marks at its ends."""
    said = re.sub(r"(?: ,)* (?:like|only|just|about|exactly)$", "", said.strip(" ,.;"))
    said = unframed(said).strip(" ,.;")
    return re.sub(
        r"^(?:to |then |and |but |now |from now on |please |that |mind |only (?!.* (?:should|may|must|"
        r"shall|can|is|are) ))+",
        "",
        said,
    )


_PART = (
    r"(?=(?:open|close|make|let|paint|hide|remove|delete|stop|turn|move|spin|have|put|play|slow|speed|start|freeze|"
    r"do not|never|keep|hold|leave|delay|reverse|pause|show|spread|lift|slide|push|pull)\b)"
)
_JOINTS = tuple(
    re.compile(joint)
    for joint in (
        r" \. | ; |(?: ,)? (?:and then|then|and also) | \n ",
        rf"(?: ,)? and {_PART}| , {_PART}",
        r"(?: ,)? and (?:then )?(?=\w+ (?:at|from|until|till|after|when|while|once|between|for) )|"
        rf"(?: ,)? and (?={any_of(tuple(SENSES), 's')} )",  # "it opens at 1 s and closes at 3 s"
    )
)


def _parts(said: str) -> list[str]:
    """The commands of an instruction, as far as marks and joints tell."""
    for joint in _JOINTS:
        parts = [p for p in (p.strip(" ,") for p in joint.split(f" {said} ")) if p]
        if len(parts) > 1:
            return parts
    return [said]


def _takes_time(op: Fields) -> bool:
    made = OPS.get(op["op"])
    return made is not None and "when" in made.model_fields and "held" not in op and op["op"] != "select"


def is_misread(ops: Sequence[Fields]) -> bool:
    """Whether a name in operations ends with a word that is no name: "the robot stop", "slow motion", "the end"."""
    names = [q.text for op in ops for v in op.values() if isinstance(v, BaseModel) for _, q in queries((v,))]
    names += [q.get("text", "") for op in ops for q in _plain_queries(op)]
    names += [str(op.get("asset", "")) for op in ops]
    if any(_TIME_NOUNS & set(str(op.get("asset", "")).split()) for op in ops):
        return True  # "put a pause of 1 s into it"
    last = [name.split()[-1] for name in names if name.split()]
    return any(word in _NO_NAMES or (_is_verb(word) and not is_known(word)) for word in last)


def _is_strange(ops: Sequence[Fields]) -> bool:
    """Whether a name in operations may hold more than a name: "the car teleport"."""
    names = [q.text for op in ops for v in op.values() if isinstance(v, BaseModel) for _, q in queries((v,))]
    words = [name.split() for name in names]
    return any(len(w) > 1 and (not is_known(w[-1]) or AUXILIARIES & set(w)) for w in words)


_LETS = re.compile(
    r"^(?:please )?(?:let|have) .*\b(?:roll|drive|walk|slide|fall|drop|spin|turn|swing|move|go|run|ride|drift)\b"
)
_TIME_NOUNS = bag("pause break delay stop halt faster slower second seconds")
_NO_NAMES = bag(
    "end start beginning motion slow once twice while finish closed falls walks opens stops moves appear flash blink "
    "blinks flashes knock slower faster speed second seconds"
)


def _plain_queries(value: object) -> Iterator[Fields]:
    """Queries that operations hold as plain data."""
    if isinstance(value, dict):
        if isinstance(value.get("text"), str):
            yield value
        for inner in value.values():
            yield from _plain_queries(inner)
    elif isinstance(value, list | tuple):
        for inner in value:
            yield from _plain_queries(inner)
    elif isinstance(value, Query):
        yield {"text": value.text}


_AFTERWARDS = re.compile(r"\b(?:afterwards?|after that|later|then|otherwise)\b")
