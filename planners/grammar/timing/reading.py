"""Reads an instruction that says something of time, of motion, or of what moves; all others are left alone.

What it says of time is cut out; the rest is a command about motion (`motions`), or a plain command of the grammar,
whose operations get the time.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace

from pydantic import BaseModel, ValidationError

from ....gaussians.errors import UserError
from ....gaussians.language.query.nested import queries, with_queries
from ....gaussians.language.query.query import Query
from ....tools.registry import OPS
from ....tools.registry import parse as parse_op
from ....tools.when import During, When
from ..parsing import Refusal
from ..restating.speech.frames import unframed
from ..tagging.words import split
from . import happenings, moments
from .happenings import IT, Happening
from .moments import BRIEF, LITTLE_BY_LITTLE, SLOW, End, Moment
from .motions import Command, Fields, commands

Understand = Callable[[str], Sequence[Fields]]  # the operations of a plain command

_HINTS = re.compile(
    r"\b(?:\d+ ?s|secs?|seconds?|t ?= ?\d|while|whilst|until|till?|untill|when|whenever|once|after|"
    r"before|as soon as|as long as|the moment|"
    r"mov(?:e|es|ing)|still|motion|still|open|opens|close|closes|shut|spin|spins|spinning|rpm|revs?|"
    r"faster|slower|fast|slow|speed|pause|"
    r"freeze|stop|stops|start|starts|begin|begins|halt|backwards?|reverse|rewind|later|earlier|sooner|"
    r"drives?|walks?|rolls?|fl(?:y|ies)|falls?|drops?|"
    r"fade|fades|slowly|gradually|vanish(?:es)?|disappears?|appears?|halfway|half speed|delay|turning|"
    r"rotat(?:e|es|ing)|whole (?:time|clip)|"
    r"always|permanently|throughout|forever|keeps?|swings?|slides?|pull|push|other way|crazy|rise|"
    r"rises|float|let|last|beginning|despawn|spawn|"
    r"play|clip|turns?|do|does|doing|hold|from \d\S* (?:to|until|till)|between \d)\b",
    re.IGNORECASE,
)
_TAIL = re.compile(
    r" ?,? ?(?:(?:and|then|and then|after(?: that|wards)?|but|finally) ?,? ?)+(?:"
    r"(?:it |then |the rest |everything )?(?:carr(?:y|ies) on|continues?|goes? on|resumes?|keeps? "
    r"going|moves? on|on it goes)(?: as (?:before|usual|normal))?|"
    r"(?:it |he |she |they |turn(?:s)? it |make it |goes |go |change(?:s)? |turn(?:s)? |switch(?:es)? "
    r"|return(?:s)? |bring it |let it |put it |have it )*(?:back |return |again )+(?:to )?(?:normal|"
    r"how it was|as (?:it was|before|usual)|(?:its |the )?(?:original|old|usual|own|first|previous) "
    r"(?:colou?r|look|state|one)|what it was|before)(?: again| afterwards| after that)?|"
    r"back(?: again)?|(?:bring|put) it back|(?:it )?(?:comes?|reappears?|appears?|returns?|shows?)(?: "
    r"back| again| up)*|normal(?: again)?|"
    r"(?:it |to |let it )?(?:stays?|remains?|holds?|keeps?|hold it|keep it|leave it)(?: (?:there|"
    r"still|it|so|open|shut|closed|like that|that way|in place|put|there for good))*)$"
)
_BACK_WHEN = re.compile(
    r" ?,? ?(?:(?:and|then|and then|but) )*(?:(?:it |turns? |goes? |turn it |change it )*(?:back|"
    r"again)(?: to [a-z ]+?)?|normal(?: again)?|off(?: again)?)"
    r" (?:when|once|as soon as|after) (?:it|the \w+|that|this) (?:leaves?|stops?|is off|has left|is "
    r"gone|ends?|does not|is past|has passed|moves? on|rolls? off)(?: it)?$"
)
_NOISE = re.compile(
    r"(?:^| )(?:lol|haha|pls|plz|please|thanks|thank you|dear|mate|ok|okay|right|you know|cheers|"
    r"kindly|if you can|if possible|would you|could you)(?= |$)"
)
_ITS = re.compile(
    r"\bits (?=(?:on|in|under|at|near|next|behind|moving|falling|rolling|open|closed|still|turning|"
    r"spinning|touching|walking|standing|opening|closing|driving|sliding|not|going|inside|over|off|"
    r"running|done)\b)"
)
_WHO = re.compile(
    r"\bwhile (?=(?:moving|falling|rolling|turning|spinning|walking|opening|closing|driving|sliding|"
    r"running|standing still|rotating|on|in|under|touching)\b)"
)
_MOVING = (
    (re.compile(r"\b(?:whatever|anything|everything|all|any ?thing|all things|every ?thing|the "
                r"things?|things|stuff|all the things|all of the things|every object|all objects|the "
                r"objects?|objects) (?:that |which )?(?:is |are |s )?(?:moves?|moving|in motion|on "
                r"the move|not standing still|animated|not static|not still)\b(?: around| about)?"), True),
    (re.compile(r"\b(?:whatever|anything|everything|all|all things|the things?|things|stuff|all the "
                r"things|every object|all objects|the objects?|objects) (?:that |which )?(?:(?:is |"
                r"are |s )?(?:standing still|stands? still|static|stationary|not moving|immobile|"
                r"still|motionless|unmoving|at rest)|does not move|do not move|never moves?|stays? "
                r"(?:still|put)|keeps? still)\b"), False),
)  # fmt: skip
_MOVING_ONE = re.compile(
    r"\b(?P<det>the|every|all|all the|any|that|this|both|each) (?P<how>moving|still|static|stationary|"
    r"unmoving|motionless) (?=(?P<noun>[a-z]+))"
)
_ASKS = re.compile(
    r"^(?:what|where|who|why|how|which|when (?:does|do|did|is|will)|does|did|do (?:the|any|all)|is|"
    r"are|was|were|has|have (?:the|any)|tell me)\b"
)
_SAME_TIME = re.compile(r" (?:at the same time|at once|simultaneously|together|all together)(?= |$)")
_CONTRARY = re.compile(
    r"\b(?:spin|move|turn|roll|walk|rotate|run)s? and (?:stand|stay|be|keep)s? still\b|\bopen and "
    r"closed?\b.*\bsame time\b"
)
_COLORED = (
    r"(?:turns?|goes?|becomes?|gets?|flashes|flash|shines?|glows?|is|are|be|looks?|stays?|in|painted|to|has|have)"
)
# What ends a name only if that was read too far.
_VERB = re.compile(
    r"(?: (?:turns?|flash(?:es)?|goes|go|gets?|becomes?|shines?|glows?|spins?|rotates?|walks?|rolls?|"
    r"drives?|falls?|drops?|opens?|closes?|shuts?|"
    r"stops?|starts?|begins?|moves?|runs?|slides?|swings?|fades?|vanish(?:es)?|disappears?|appears?|"
    r"keeps?|stays?|comes?|stands?|flies|fly|rises?|"
    r"sinks?|hides?|shows?|plays?|waits?|pauses?|freezes?|halts?|continues?|remains?|hit|hits|touch|"
    r"touches|reach|reaches|red|blue|green|yellow|"
    r"white|black|purple|pink|orange|golden|later|earlier|last|first|there|still|speed|too|late|early|"
    r"open|closed|halfway|want|wants|need|needs)|^(?:stop|start|make|let|have|get|turn|open|close|"
    r"play|freeze|pause|keep|hold|hide|slow|speed|spin))$"
)
_HIDING = (
    r"(?:disappears?|vanish(?:es)?|be gone|is gone|are gone|despawns?|hides?|go away|goes away|"
    r"be hidden|is hidden|be invisible|is invisible|not be (?:there|visible|seen|shown)|leaves "
    r"the (?:scene|room)|out of sight|turn invisible|turns invisible|poofs?|is not there|gone)"
)
_SHOWING = (
    r"(?:(?:only |first |just )*(?:appears?|shows? up|pops? up|is visible|be visible|be there|"
    r"is there|spawns?|comes? into (?:view|existence)|shows?|becomes? visible|be seen|is "
    r"seen))"
)


_FADES = re.compile(r"^(?:fade|dissolve) (?:out|away)\b|\b(?:fades?|dissolves?) (?:out|away)$|^fade .+ (?:out|away)$")
_RIDDING = re.compile(r"^(?:delete|remove|take|get rid of|throw|put|move|erase|bin|save|catch)\b")
_REMARK = re.compile(
    r"^(?P<np>.+?) (?:is|are|looks?|seems?|opens?|starts?|moves?|goes|comes?|turns?|feels?)(?: "
    r"\w+){0,2} (?:too|much too|way too|so|very|not|really|a bit) .+$"
)


_T = r"(?:an?|one|two|three|four|half an?|[\d.,]+)(?: and a half)? (?:seconds?|secs?|s)"
_NAMED = r"(?P<x>(?:the )?[\w ]+?)"
_SAME = tuple(  # what people say, and the same as a plain command
    (re.compile(pattern), plain)
    for pattern, plain in (
        (rf"^(?:start|begin|launch|kick off) {_NAMED} (?P<t>{_T}) (?P<w>later|earlier|sooner)$",
         r"\g<x> starts \g<t> \g<w>"),
        (rf"^{_NAMED} (?:sets? (?:off|out)|gets? going|kicks? off|takes? off) (?P<t>{_T}) (?P<w>later|earlier|sooner)$",
         r"\g<x> starts \g<t> \g<w>"),
        (rf"^(?:delay|postpone) {_NAMED} (?:by )?(?P<t>{_T})$", r"\g<x> starts \g<t> later"),
        (rf"^double (?:the )?(?:speed of )?{_NAMED}(?: 's)?(?: speed)?$", r"make \g<x> twice as fast"),
        (rf"^halve (?:the )?(?:speed of )?{_NAMED}(?: 's)?(?: speed)?$", r"make \g<x> half as fast"),
        (rf"^{_NAMED}(?: 's)? speed (?:x|times|by) ?(?P<n>[\d.]+)$", r"make \g<x> \g<n> times as fast"),
        (rf"^slow ?motion (?:on|for) {_NAMED}(?: ,? (?P<f>half|quarter|third) speed)?$", r"play \g<x> at \g<f> speed"),
        (r"^(?P<a>(?:stop|start|freeze|pause|open|close) .+?) (?:earlier|sooner|later) ,? ?(?P<b>at .+)$",
         r"\g<a> \g<b>"),
        (r"\bsince (?P<a>[\d.]+)(?: (?:seconds?|secs?|s))? until\b", r"from \g<a> until"),
        (r"\bbetween seconds? (?P<a>[\d.]+) and (?P<b>[\d.]+)\b", r"from \g<a> to \g<b> seconds"),
        (r"\b(?:one|1) time in (?P<t>[\d.]+ seconds?)\b", r"once in \g<t>"),
        (r"\bin (?:the )?direction of\b", "toward the"),
        (r"^relocate\b", "move"),
        (r"^reverse (?P<x>.+?) (?:anim|animation|motion|movement)$", r"reverse \g<x>"),
    )
)  # fmt: skip


def may_be_timed(cleaned: str) -> bool:
    """Whether any word could be about time or motion."""
    return _HINTS.search(cleaned) is not None


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
        said = " ".join(w.text for w in split(cleaned))
        if _ASKS.match(said) and cleaned.rstrip().endswith("?"):
            return None
        said = _tidy(said)
        for pattern, plain in _SAME:
            said = pattern.sub(plain, said)
        if not said:
            return None
        if _CONTRARY.search(said):
            raise Refusal("it cannot be both at the same time", said, verdict="impossible")
        found = self._whole(said)
        if found is not None:
            return found
        parts = _parts(said)
        if len(parts) > 1 and (joined := self._joined(parts)) is not None:
            return joined
        numbers = moments.TIMED.search(said)
        if numbers is not None:
            raise Refusal(f"what is to happen “{numbers[0]}” is not understood", numbers[0])
        clause = next(iter(happenings.cut(said, self.thing)), None)
        if clause is not None and clause[1].said.split()[0] not in ("when", "as", "after", "before"):
            raise Refusal(f"what is to happen “{clause[1].said}” is not understood", clause[1].said)
        return None

    # -- things ------------------------------------------------------------------------------------------------------

    def thing(self, phrase: str) -> Query | None:
        """What a phrase for things means; None if it means none."""
        phrase = phrase.strip(" ,.")
        if phrase not in self._things:
            self._things[phrase] = self._thing_of(phrase)
        return self._things[phrase]

    def _thing_of(self, phrase: str) -> Query | None:
        if not phrase or len(phrase.split()) > 9:
            return None
        if phrase in ("it", "he", "she", "him", "her", "this", "that", "they", "them", "itself"):
            return IT
        if re.search(
            r"\b(?:be|is|are|should|must|will|would|can|do|does|let|make|have|to be|when|while|until|"
            r"then|i|you|we|instead|not|at|by|than)\b",
            phrase,
        ):
            return None
        if re.search(
            r"^(?:to|in|at|on|of|for|with|and|or|up|down|out|off|from|into|by|as|so|faster|slower|"
            r"fast|slow|back|half|open|start|stop|begin|moving)\b|\b(?:to|in|at|on|of|for|with|and|or|"
            r"the|a|from|into|by|as|up|down|out|off|over|back|again|way|more|much|too)$",
            phrase,
        ):
            return None
        if _VERB.search(phrase):
            return None
        for pattern, moving in _MOVING:
            if pattern.fullmatch(phrase):
                return Query(text="", pick="all", moving=moving)
        bare = _MOVING_ONE.match(phrase)
        moves = None
        if bare is not None:
            moves, phrase = bare["how"] == "moving", f"{bare['det']} {phrase[bare.end() :]}"
        phrase = re.sub(r"^(?:that|this) (?=\w+ )", "the ", phrase)
        phrase = re.sub(r"^(?:a|an) (?=\w)", "the ", phrase)
        if not re.match(
            r"^(?:the|all|every|both|my|our|these|those|each|any|everything|one|two|three|four|five|"
            r"his|her|their|its)\b",
            phrase,
        ):
            phrase = f"the {phrase}"
        found = self._thing(phrase.replace(" 's ", "'s "))
        if found is None or (not found.text and not found.last and not found.colors):
            return None
        if found.invert or found.grow:
            return None
        return found if moves is None else _which_moves(found, moves)

    # -- one command -------------------------------------------------------------------------------------------------

    def _joined(self, parts: Sequence[str]) -> tuple[Fields, ...] | None:
        """Several commands, of which one at least is about time; None if one is not understood."""
        ops: list[Fields] = []
        timed = False
        topic: Query | None = None
        refusal: Refusal | None = None
        for part in parts:
            about = _REMARK.match(part)
            if topic is None and not ops and about is not None and part is not parts[-1]:
                topic = self.thing(about["np"])  # "the door opens too late, make it start at 0 s"
                if topic is not None:
                    continue
            found = self._whole(part)
            if found and topic is not None and found[0].get("target") == IT:
                found = ({**found[0], "target": topic}, *found[1:])
            if found is not None:
                timed = True
            else:
                try:
                    found = tuple(self._understand(part))
                except Refusal as error:
                    refusal = refusal or error
            ops += found or ()
        if not timed:
            return None
        if refusal is not None:
            raise refusal  # nothing is half done
        return tuple(ops)

    def _whole(self, said: str) -> tuple[Fields, ...] | None:
        for rest, moment, happening in self._readings(said):
            told = not moment.empty or moment.slowly or happening is not None
            for form in dict.fromkeys(
                (_bare(rest), _bare(_TAIL.sub("", _bare(rest))), _bare(_TAIL.sub("", _TAIL.sub("", _bare(rest)))))
            ):
                found = self._command(form, moment, happening, told)
                if found:
                    return found
        return self._about_moving(said)

    def _readings(self, said: str) -> Iterator[tuple[str, Moment, Happening | None]]:
        """The words without what they say of time, and what that is; the most cut first."""
        shorter = _BACK_WHEN.sub("", said)
        flashes = shorter != said
        seen = set[str]()
        for text in dict.fromkeys((shorter, said)):
            rest, moment = moments.cut(text)
            for left, happening in happenings.cut(rest, self.thing):
                if flashes and happening.during.part == "from":
                    during = happening.during.model_copy(update={"part": "while"})
                    happening = replace(happening, during=during)
                if left not in seen:
                    seen.add(left)
                    yield left, moment, happening
            if rest not in seen:
                seen.add(rest)
                yield rest, moment, None

    def _command(self, said: str, moment: Moment, happening: Happening | None, told: bool) -> tuple[Fields, ...] | None:
        if not said:
            return None
        if happening is not None and not moment.empty and moment.lasting is None and moment.stop is not None:
            return None
        for command in commands(said, self.thing, moment, told):
            with suppress(Refusal, UserError, ValidationError):
                found = self._made(command, moment, happening)
                if found:
                    return found
        if not told and _FADES.search(said):
            moment, told = replace(moment, slowly=True), True
        if not told and not moment.always:
            return None
        return self._look(said, moment, happening)

    def _made(self, command: Command, moment: Moment, happening: Happening | None) -> tuple[Fields, ...] | None:
        ops = list(command.ops)
        if command.text:
            ops = list(self._understand(command.text))
            if is_misread(ops) or any(op["op"] not in ("move", "rotate") for op in ops):
                return None
        if command.during is not None:
            if happening is not None:
                return None
            happening = Happening(During(**command.during), "")
        if moment.taken and moment.lasting is not None and all(op.get("change") == "speed" for op in ops):
            ops = [
                {k: v for k, v in op.items() if k != "factor"} | {"change": "begin"} for op in ops
            ]  # "faster, in 1 s"
        return self._with_time(ops, moment, happening, command.kind)

    def _look(self, said: str, moment: Moment, happening: Happening | None) -> tuple[Fields, ...] | None:
        """A plain command that gets a time."""
        if happening is not None and happening.said.startswith("before ") and _RIDDING.match(said):
            return None  # "delete the vase before it falls" gives a reason
        for text, inverse in _plain_commands(said, self.thing):
            ops: Sequence[Fields] = ()
            with suppress(Refusal, UserError):
                ops = self._understand(text)
            if not ops or any(not _takes_time(op) for op in ops) or is_misread(ops):
                continue
            if re.search(r"\b(?:off|out|on)$", said) and any(op["op"] == "delete" for op in ops):
                continue  # "the light should go out"
            own, seen = moment, happening
            if inverse:
                flipped = _inverse(moment, happening)
                if flipped is None:
                    continue
                own, seen = flipped
            kind = "path" if all(op["op"] in ("move", "rotate") for op in ops) else "look"
            with suppress(ValidationError, UserError):
                return self._with_time(list(ops), own, seen, kind)
        return None

    def _with_time(
        self, ops: Sequence[Fields], moment: Moment, happening: Happening | None, kind: str
    ) -> tuple[Fields, ...] | None:
        made: list[Fields] = []
        for op in ops:
            target = op.get("target")
            during = None
            if happening is not None:
                target, during = _settled(target, happening.during)
                op = {**op, **({"target": target} if target is not None else {})}
            when = _when(moment, during, kind, op)
            made.append({**op, **({"when": when} if when is not None else {})})
            parse_op(made[-1])  # an operation that cannot be is no reading
        return tuple(made)

    # -- what moves --------------------------------------------------------------------------------------------------

    def _about_moving(self, said: str) -> tuple[Fields, ...] | None:
        """A command about what moves, or stands still, without a time: "remove whatever moves"."""
        for pattern, moving in _MOVING:
            if (found := pattern.search(said)) is not None:
                text = f"{said[: found.start()]}everything{said[found.end() :]}"
                return self._with_moving(text, lambda q: q.text in ("everything", "all") and not q.exclude, moving)
        found = _MOVING_ONE.search(said)
        if found is not None:
            text = f"{said[: found.start()]}{found['det']} {said[found.end() :]}"
            noun = found["noun"].removesuffix("s")
            return self._with_moving(text, lambda q: noun in q.text or noun == "thing", found["how"] == "moving")
        return None

    def _with_moving(self, text: str, meant: Callable[[Query], bool], moving: bool) -> tuple[Fields, ...] | None:
        with suppress(Refusal, UserError):
            ops = self._understand(_bare(text))
            hit = False

            def change(query: Query) -> Query:
                nonlocal hit
                if not meant(query):
                    return query
                hit = True
                return _which_moves(query, moving)

            made = tuple(
                {k: with_queries(v, change) if isinstance(v, Query) else v for k, v in op.items()} for op in ops
            )
            return made if hit else None
        return None


def _which_moves(query: Query, moving: bool) -> Query:
    text = "" if query.text in ("everything", "all", "thing", "object") else query.text
    return query.model_copy(update={"text": text, "moving": moving})


def _tidy(said: str) -> str:
    said = re.sub(r"(?<=\d) ?= ?", " ", said)
    said = _ITS.sub("it is ", said)
    said = re.sub(r"(?: [.!?])+$", "", said.strip(" .!?\n"))
    said = re.sub(r" ?[!?] ?", " . ", said)
    for _ in range(3):
        said = _NOISE.sub("", said).strip(" ,")
    said = _WHO.sub("while it is ", said)
    said = re.sub(
        r"^(?:can|could|would|will|may|should|must|shall) (?=(?:the|my|our|this|that|all|every|it) )", "", said
    )
    return " ".join(said.split())


def _bare(said: str) -> str:
    """A command without politeness, and without marks at its ends."""
    said = re.sub(r"(?: ,)* (?:like|only|just|about|exactly)$", "", said.strip(" ,.;"))
    said = unframed(said).strip(" ,.;")
    return re.sub(r"^(?:to |then |and |but |now |from now on |please )+", "", said)


def _parts(said: str) -> list[str]:
    """The commands of an instruction, as far as marks and joints tell."""
    parts = [p.strip(" ,") for p in re.split(r" \. | ; |(?: ,)? (?:and then|then|and also) | \n ", f" {said} ")]
    parts = [p for p in parts if p]
    if len(parts) > 1:
        return parts
    return [
        p.strip(" ,")
        for p in re.split(
            r"(?: ,)? and (?=(?:open|close|make|let|paint|hide|remove|delete|stop|turn|move|spin|have|"
            r"put|play|slow|speed|start|freeze)\b)| , (?=(?:open|close|make|let|paint|hide|remove|"
            r"delete|stop|move|spin|have|put|play|slow|speed|start|freeze)\b)",
            said,
        )
        if p.strip(" ,")
    ]


def _takes_time(op: Fields) -> bool:
    made = OPS.get(op["op"])
    return made is not None and "when" in made.model_fields and "held" not in op and op["op"] != "select"


def is_misread(ops: Sequence[Fields]) -> bool:
    """Whether a name in operations ends with a word that is no name: "the robot stop", "slow motion", "the end"."""
    names = [q.text for op in ops for v in op.values() if isinstance(v, BaseModel) for _, q in queries((v,))]
    names += [q.get("text", "") for op in ops for q in _plain_queries(op)]
    names += [str(op.get("asset", "")) for op in ops]
    return any(_NO_THING.search(name) for name in names if name)


_NO_THING = re.compile(
    r"(?:^| )(?:end|start|beginning|motion|slow|appears?|once|twice|while|finish|stops?|opens?|closed|disappears?|"
    r"vanish|begins?|walks?|rolls|goes|becomes|flash|falls|spins|moves)$"
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


def _settled(target: Query | None, during: During) -> tuple[Query | None, During]:
    """The target and the time, with "it" in each read as what the other names."""
    of = during.of
    if target is not None and of is not None:
        if target == IT and of != IT and not of.moving:
            target, of = of, None
        elif (of == IT and target != IT) or of in (target, IT):
            of = None
    anchors = tuple(target if q == IT and target is not None else q for q in during.anchors)
    return target, during.model_copy(update={"of": of, "anchors": anchors})


def _when(moment: Moment, during: During | None, kind: str, op: Fields) -> When | None:
    lasting, gradual = moment.lasting, False
    start: End | None = moment.start
    if kind == "look":
        if moment.taken or moment.slowly or op.get("gradual"):
            gradual = True
            if moment.stop is None or moment.start is None:
                lasting = lasting or LITTLE_BY_LITTLE
        if op["op"] in ("insert", "delete", "replace", "isolate", "duplicate") and moment.taken:
            gradual = False
    elif lasting is None and moment.stop is None:
        lasting = SLOW if moment.slowly else BRIEF if moment.quickly and kind == "path" else None
    stop: End | None = None if lasting is not None else moment.stop
    if kind == "path" and start is None and stop is None and lasting is None and during is None:
        start = 0.0
    if start is None and stop is None and lasting is None and during is None:
        return None
    return When(start=start, stop=stop, lasting=lasting, during=during, gradual=gradual)


def _inverse(moment: Moment, happening: Happening | None) -> tuple[Moment, Happening | None] | None:
    """The time in which something is not to be seen that is to be seen in another; None if that is several."""
    if happening is not None:
        flipped = {
            "from": "until",
            "after": "until_end",
            "until": "from",
            "until_end": "after",
            "while": "unless",
            "unless": "while",
        }
        part = flipped[happening.during.part]
        return (
            (moment, replace(happening, during=happening.during.model_copy(update={"part": part})))
            if moment.empty
            else None
        )
    if moment.start is not None and moment.stop is None and moment.lasting is None:
        return replace(moment, start=None, stop=moment.start), None
    if moment.stop is not None and moment.start is None:
        return replace(moment, start=moment.stop, stop=None), None
    return None


def _plain_commands(said: str, thing: Callable[[str], Query | None]) -> Iterator[tuple[str, bool]]:
    """Plain commands that words may stand for, and whether they say when it is *not* so."""
    ought = r"(?:should|must|shall|needs to|has to|have to|ought to|is to|are to|will|can|could|to|may)"
    let = r"(?:let|make|have|get|cause|i want)"
    hide = re.match(rf"^(?:{let} )?(?P<np>.+?)(?: {ought})? {_HIDING}(?: again)?$", said)
    if hide is not None and thing(hide["np"]) is not None:
        yield f"hide {_named(hide['np'])}", False
    hide = re.match(
        r"^(?:despawn|lose|take out|take away|remove|hide|kill|drop|blank|switch off|conceal|get rid "
        r"of|delete|erase|cut) (?P<np>.+?)$",
        said,
    )
    if hide is not None and thing(hide["np"]) is not None:
        yield f"hide {_named(hide['np'])}", False
    hide = re.match(
        r"^(?:take|get|bring|move|cut|leave|keep) (?P<np>.+?) (?:out of (?:the )?(?:room|scene|"
        r"picture|view|sight|shot|frame|way)|away|out|off)$",
        said,
    )
    if hide is not None and thing(hide["np"]) is not None:
        yield f"hide {_named(hide['np'])}", False
    show = re.match(
        rf"^(?:only |{let} |show )?(?P<np>.+?)(?: {ought})? {_SHOWING}(?: again)?$|^(?:only )?(?:show|"
        rf"reveal|spawn|unhide|display) (?P<np2>.+?)$",
        said,
    )
    if show is not None and thing(show["np"] or show["np2"]) is not None:
        yield f"hide {_named(show['np'] or show['np2'])}", True
    new = re.match(
        r"^(?P<np>(?:an?|one|two|three|another) .+?) (?:appears?|shows? up|pops? up|spawns?|is there|materiali[sz]es?) "
        r"(?P<where>(?:on|in|next to|beside|behind|under|near|at|in front of|to the) .+)$",
        said,
    )
    if new is not None:
        yield f"add {new['np']} {new['where']}", False
    fade = re.match(
        r"^(?:fade|dissolve)(?: out| away)? (?P<np>.+?)(?: out| away| to nothing| to (?:zero|0))?$", said
    ) or re.match(
        rf"^(?:{let} )?(?P<np>.+?)(?: {ought})? (?:fades?|dissolves?|melts?)(?: out| away| to nothing)?$", said
    )
    if fade is not None and re.search(r"\d|percent|%|half", fade["np"]) is None and thing(fade["np"]) is not None:
        yield f"hide {_named(fade['np'])}", False
    told = re.match(
        r"^(?P<np>.+?) (?:turns|goes|becomes|gets|flashes|shines|glows|is|are|turn|go|become|shine|"
        r"glow|flash) (?:in |into |to )?(?P<hue>[a-z ]+)$",
        said,
    )
    if told is not None and thing(told["np"]) is not None:
        yield f"make {_named(told['np'])} {told['hue']}", False
    yield said, False
    color = re.match(
        rf"^(?:{let} |turn |paint |that )?(?P<np>.+?)(?: {ought})?(?: be)? (?:back )?{_COLORED} (?P<hue>.+)$", said
    )
    if color is not None and thing(color["np"]) is not None:
        hue = re.sub(r"^(?:in|all|into|to|a|an|be|the colou?r|painted|look|turn|completely) ", "", color["hue"])
        yield f"make {_named(color['np'])} {hue}", False
        yield f"paint {_named(color['np'])} {hue}", False
    color = re.match(
        r"^(?:paint|turn|make|colou?r|tint|dye|give) (?P<np>.+?) (?:in |into |to |a )?(?P<hue>\w+(?: \w+)?)$", said
    )
    if color is not None and thing(color["np"]) is not None:
        yield f"make {_named(color['np'])} {color['hue']}", False
    if (pair := re.match(r"^(?P<np>.+?) (?P<hue>\w+)$", said)) is not None and thing(pair["np"]) is not None:
        yield f"make {_named(pair['np'])} {pair['hue']}", False


def _named(np: str) -> str:
    if re.match(r"^(?:the|all|every|both|my|our|these|those|each|any|it|them|everything|one|two|three|this)\b", np):
        return "it" if np in ("him", "her", "he", "she") else np
    if np in ("him", "her", "he", "she"):
        return "it"
    return f"the {np}"
