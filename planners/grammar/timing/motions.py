"""Commands about motion: open and close, spin, stop, start, faster, backwards, and going somewhere in time.

Each pattern reads the whole of a command, without its times; what is named is read as things by the grammar.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

from ....gaussians.language.query.query import Query
from ....gaussians.world.words import head
from ....tools.operation import Length
from ..tagging.words import bag
from ..vocabulary import quantities
from .happenings import Thing
from .moments import DURATION, Moment

Fields = dict[str, Any]
Kind = Literal["motion", "path", "look"]

ALL_OF_IT = Query(text="everything", pick="all")
MOVING = Query(text="", pick="all", moving=True)


@dataclass(frozen=True)
class Command:
    """What a command means.

    Attributes:
        ops: the operations, without their time.
        kind: how its time is read: of motion that is there, of a way, or of a look.
        needs: whether it means this only with a time.
        text: for a way, the plain command that the rest of the grammar reads; then `ops` is empty.
        during: a time that the command itself tells, as the fields of `During`.
    """

    ops: tuple[Fields, ...] = ()
    kind: Kind = "motion"
    needs: bool = False
    text: str = ""
    during: dict[str, Any] | None = None


_LET = r"(?:let|make|have|get|cause|tell|ask|allow|force|i want|set|leave|keep|want)"
_OUGHT = r"(?:should|must|shall|needs? to|has to|have to|ought to|is to|are to|will|can|could|to|may)"
_TO = r"(?: to)?"
_NP = r"(?P<np>(?:(?!,|\band\b then).)+?)"
_AGAIN = r"(?: (?:again|now|please|too|then|back|only|just))*"

_OPENABLE = bag(
    "door gate window drawer lid hatch flap cupboard cabinet wardrobe fridge refrigerator oven box chest "
    "locker trunk shutter case safe dresser microwave dishwasher toilet"
)
_OPEN = (
    r"(?:open(?: up)?|pull open|push open|swing open|slide open|slide out|pull out|fling open|"
    r"throw open|unlatch|crack open)"
)
_CLOSE = r"(?:close(?: up)?|shut|push shut|push in|slide in|slide shut|pull shut|swing shut|slam(?: shut)?)"
_OPENS = (
    r"(?:opens?(?: up)?|swings? open|slides? open|slides? out|comes? out|pulls? out|opening|sliding "
    r"out|swinging open)"
)
_CLOSES = (
    r"(?:closes?(?: up)?|shuts?|swings? shut|slides? shut|slides? in|goes back in|slides? back "
    r"in|closing|shutting|slams?(?: shut)?)"
)
_APART = r"(?:pull|push|swing|slide|fling|throw|put|set|make|have|get|bring|move|keep|leave)"
_HOW = r"(?P<how>(?: .*)?)"
_SHARES = {
    "halfway": 0.5, "half way": 0.5, "half open": 0.5, "half": 0.5, "a crack": 0.1, "a little": 0.25,
    "a bit": 0.25, "slightly": 0.25,
    "a third": 1 / 3, "a quarter": 0.25, "three quarters": 0.75,
    "partway": 0.5, "partly": 0.5, "ajar": 0.15, "two thirds": 2 / 3,
}  # fmt: skip
_IDLE = bag(
    "again back fully wide completely all the way up to by , like at a an of open out shut closed only "
    "more even further just about around so that it is please now and then slowly gently degrees i in "
    "position"
)
_STILL = (
    r"(?:still|where (?:it|he|she|they) (?:is|are|was|were|stands?)|put|motionless|stationary|frozen|"
    r"at rest|in place|there|as (?:it|they) (?:is|are)|unmoved|fixed|"
    r"on the spot|stopped)"
)
_GO = (
    "move|roll|walk|drive|slide|turn|spin|rotate|run|swing|fly|glide|travel|go|bounce|rise|climb|"
    "fall|drop|open|tumble|start|begin|play|work"
)
_GOING = (
    "moving|rolling|walking|driving|sliding|turning|spinning|rotating|running|swinging|flying|"
    "gliding|going|bouncing|rising|"
    "climbing|falling|dropping|opening|tumbling|working|playing|travelling"
)
_GOES = "|".join(f"{w}s" for w in _GO.split("|") if w != "go") + "|goes"
_TIMES = (
    r"(?P<times>in slow motion|(?:at )?(?:double|twice|triple|three times|four times|half|quarter|"
    r"a quarter of|a third of|half of|"
    r"\d+(?:[.,]\d+)? ?(?:x|times|%|percent)|x ?\d+(?:[.,]\d+)?|(?:two|three|four|five|six|ten)(?: ?x| times|fold)?)"
    r"(?: (?:as|the|its|their|of|a|normal|usual|original|present|current))*(?: (?:fast|quick(?:ly)?|"
    r"slow(?:ly)?|speed|pace|tempo|rate|faster|quicker|slower))?|"
    r"(?:a lot |much |way |far |even |a bit |a little |slightly |somewhat |crazy |super |really |very "
    r"|too )*(?:faster|quicker|slower|slow|fast|more slowly|more quickly|slowly|quickly)"
    r"(?: ,? ?(?:like|by|by a factor of|about|at))*(?: ?\d+(?:[.,]\d+)? ?(?:x|times|%|percent)| x "
    r"?\d+(?:[.,]\d+)?| double| twice| half)?(?: (?:faster|slower|as fast|as slow|the speed))?)"
)
_PLAYED = (
    r"(?:it all|all of it|it|this|that|everything|all|the (?:whole )?(?:thing|scene|clip|film|movie|"
    r"video|animation|sequence|shot|room|lot)|"
    r"the entire (?:scene|clip|film|thing|animation|video)|time|the motion|all the motion|all motion|"
    r"the movement|all movements?|the whole lot|whole scene|whole clip)"
)
_BACKWARDS = (
    r"(?:backwards?|in reverse|reversed?|in reverse order|rewound|from (?:the )?end to "
    r"(?:the )?(?:start|beginning)|back to front|the other way round in time)"
)
_OTHER_WAY = (
    r"(?:(?:in |into )?(?:the )?(?:other|opposite|reverse|wrong) (?:way|direction|sense)(?: round| "
    r"around| about)?|backwards?|in reverse|"
    r"the other way round|counter ?clockwise instead|clockwise instead|anti ?clockwise instead|the opposite way)"
)
_PER = r"(?: ?(?:per|a|each|every|/|in a|in one) ?(?:second|sec|s|minute|min))"
_ROUNDS = r"(?:turns?|revs?|rotations?|revolutions?|rounds?|times|spins?|laps?|circles?|twirls?|loops?)"
_COUNT = r"(?:\d+(?:[.,]\d+)?|a|one|two|three|four|five|six|seven|eight|nine|ten|once|twice|half a|thrice)"
_RATE = (
    rf"(?P<rate>(?:at |with |, |by |doing |making |of |around |round |about )*(?:(?P<n>{_COUNT}) "
    rf"?(?:full |complete |whole )?(?:{_ROUNDS})?(?P<per>{_PER})|"
    rf"(?:(?P<m>\d+(?:[.,]\d+)?) ?rpm|rpm ?(?:of )?(?P<k>\d+(?:[.,]\d+)?))|(?P<deg>\d+(?:[.,]\d+)?) "
    rf"(?:degrees?|°|deg)(?P<perdeg>{_PER})))"
)
_WHOLE = (
    rf"(?P<turns>(?:for |by |a |through |of |with |, |do |does |doing |make |makes |around |round "
    rf")*(?P<c>{_COUNT}) ?(?:full |complete |whole )?(?:{_ROUNDS})|(?:a )?(?P<angle>360|720|1080|"
    rf"180)(?: degrees?|°|s)?|(?:a )?full circle|(?:a )?pirouette|(?P<adv>once|twice|thrice))"
)
_ENDLESS = (
    r"(?: (?:like crazy|continuously|constantly|endlessly|around|round|round and round|around "
    r"and around|in circles|on the spot|in place|on its axis|about itself|around itself|about "
    r"its axis|without stopping|non ?stop|and around|on itself|freely|crazily|wildly|,))*"
)
_SPIN = (
    r"(?:spin(?: round| around)?|rotate|turn(?: round| around)?|twirl|whirl|revolve|pirouette|go "
    r"round(?: and round)?|go around|twist|gyrate|swivel|turning|spinning|rotating|keep "
    r"(?:spinning|turning|rotating)|do|make)"
)
_SPINS = (
    r"(?:spins?(?: round| around)?|rotates?|turns?(?: round| around)?|twirls?|whirls?|revolves?|"
    r"goes round|goes around|spinning|turning|rotating|does|makes|do|keeps (?:spinning|turning|"
    r"rotating))"
)
_LIVELY = (
    "drive|walk|roll|fly|run|glide|float|hop|crawl|march|wander|stroll|travel|jump|wheel|hover|"
    "scoot|trundle|dance|creep|rush|race|sail|slither|cruise|zoom|levitate|rise|ascend|descend|"
    "sink|climb|lift off|drift|trot|slowly move|bounce"
)
_PLAIN = "move|go|come|slide|get|shift|return|head|step|proceed|be moved|be pushed|be lifted|lift|push|travel|be"
_LIVELIER = (
    "drives|walks|rolls|flies|runs|glides|floats|hops|crawls|marches|wanders|strolls|travels|jumps|"
    "hovers|moves|goes|comes|slides|rises|ascends|descends|sinks|climbs|"
    "lifts|drifts|shifts|heads|bounces|creeps|races|levitates|lowers|raises"
)
_SOMEWHERE = (
    r"(?P<to>(?:back |over |across |along |up |down |straight |around |all the way |slowly |"
    r"right |then |out |off |away |in )*)(?P<goal>(?:on ?to|to|towards?|into|next to|beside|"
    r"behind|under(?:neath)?|in front of|between|onto|near|against|left|right|forwards?|"
    r"backwards?|up|down|by|away|higher|lower|above|below|in|on|sideways|across|over)\b.*|"
    r"\d.*|half a .*|a (?:metre|meter|foot|bit|little|few) ?.*)"
)


def commands(said: str, thing: Thing, moment: Moment, told: bool) -> Iterator[Command]:
    """What a command may mean, the likeliest first.

    Args:
        said: words parted by spaces, without times.
        told: whether it comes with a time, in numbers or by what happens.
    """
    for read in (_paces, _opening, _spinning, _going):
        for command in read(said, thing, moment):
            closes_it = any(op.get("change") == "close" and op["target"].last for op in command.ops)
            if told or not (command.needs or closes_it):  # "close it" may be said of a gap
                yield command


def _first(patterns: tuple[str, ...], said: str) -> Iterator[re.Match[str]]:
    for pattern in patterns:
        if found := re.match(rf"^{pattern}$", said):
            yield found


# -- doors, drawers and lids -----------------------------------------------------------------------------------------


def _opening(said: str, thing: Thing, moment: Moment) -> Iterator[Command]:
    forms: tuple[tuple[str, str], ...] = (
        (rf"{_OPEN} {_NP}{_HOW}", "open"),
        (rf"{_CLOSE} {_NP}{_HOW}", "close"),
        (
            rf"{_APART} {_NP} (?:wide |fully |all the way |back |half(?: way)? ?)*(?P<side>open|out|"
            rf"ajar)(?: more)?{_HOW}",
            "open",
        ),
        (rf"{_APART} {_NP} (?:back |all the way |fully )*(?P<side>shut|closed|in)(?: again)?{_HOW}", "close"),
        (rf"{_LET} {_NP}{_TO} {_OPENS}{_HOW}", "open"),
        (rf"{_LET} {_NP}{_TO} {_CLOSES}{_HOW}", "close"),
        (
            rf"{_NP} (?:{_OUGHT} )?(?:be )?(?:{_OPENS}|opened|is open|are open|be open|stays open|"
            rf"remains open)(?: up)?{_HOW}",
            "open",
        ),
        (
            rf"{_NP} (?:{_OUGHT} )?(?:be )?(?:{_CLOSES}|closed|is closed|is shut|be closed|be shut|"
            rf"stays closed|stays shut)(?: up)?{_HOW}",
            "close",
        ),
    )
    for pattern, change in forms:
        found = re.match(rf"^{pattern}$", said)
        if found is None:
            continue
        if re.search(r"\b(?:slower|faster|quicker|more slowly|more quickly|earlier|later|sooner)\b", found["how"]):
            continue
        for np, how in _parted(found["np"], found["how"]):
            if np in ("it", "that", "this", "them") and re.match(
                r"^(?:close|shut|fill|seal) \w+ (?:up|off|over|in)\b", said
            ):
                return  # a hole
            target = _openable(np, thing)
            amount = None if target is None else _amount(how)
            if amount is not None:
                yield Command(({"op": "articulate", "target": target, "change": change, **amount},))
                return
    half = re.match(
        rf"^(?:{_LET} )?{_NP}(?: {_OUGHT})? (?:stops?|only (?:opens?|goes)|opens?(?: only)?) (?:at "
        rf")?(?:halfway|half way|half)(?: open)?{_AGAIN}$",
        said,
    )
    if half is not None and (target := _openable(half["np"], thing)) is not None:
        yield Command(({"op": "articulate", "target": target, "change": "open", "share": 0.5},))


def _parted(np: str, how: str) -> Iterator[tuple[str, str]]:
    """The name and what is behind it, the shortest name first."""
    words = f"{np}{how}".split()
    for end in range(len(np.split()), len(words) + 1):
        yield " ".join(words[:end]), " ".join(words[end:])


def _openable(np: str, thing: Thing) -> Query | None:
    np = re.sub(r"(?: (?:again|back|up|wide|fully|slowly|gently))+$", "", np)
    target = thing(np)
    if target is None or target.region is not None:
        return None
    last = target.last and not target.text
    return (
        target if last or head(target.text) in _OPENABLE or any(w in _OPENABLE for w in target.text.split()) else None
    )


def _amount(how: str) -> Fields | None:
    """How far it opens; None if the words say something else."""
    words = how.replace(",", " , ").split()
    made: Fields = {}
    i = 0
    while i < len(words):
        rest = " ".join(words[i:])
        share = next((s for s in sorted(_SHARES, key=len, reverse=True) if re.match(rf"{s}\b", rest)), None)
        found = quantities.read(words[i:])
        if found is not None and found.kind == "ANGLE":
            made, i = {"degrees": abs(found.value)}, i + found.taken
        elif found is not None and found.kind == "LENGTH":
            made, i = {"distance": Length(value=found.value, unit=found.unit)}, i + found.taken  # type: ignore[arg-type]
        elif found is not None and found.kind == "PERCENT" and 0 < found.value <= 1:
            made, i = {"share": found.value}, i + found.taken
        elif share is not None:
            made, i = {"share": _SHARES[share]}, i + len(share.split())
        elif words[i] in _IDLE:
            i += 1
        else:
            return None
    return made


# -- spinning --------------------------------------------------------------------------------------------------------


def _spinning(said: str, thing: Thing, moment: Moment) -> Iterator[Command]:
    forms = (
        rf"{_SPIN} {_NP}{_ENDLESS} ?,? ?(?:{_RATE}|{_WHOLE}){_ENDLESS}",
        rf"(?:{_LET} )?{_NP}(?: {_OUGHT})? (?:{_SPIN}|{_SPINS}){_ENDLESS} ?,? ?(?:{_RATE}|{_WHOLE}){_ENDLESS}",
        rf"(?:{_LET} |set )?{_NP} (?:at|to)? ?{_RATE}",
        rf"(?:speed up|slow down|speed|slow|set|bring|turn) {_NP}(?: up| down)? to {_RATE}",
        rf"{_NP} (?:speed )?{_RATE}",
    )
    for found in _first(forms, said):
        if (fields := _turning(found)) is None or (target := thing(found["np"])) is None:
            continue
        counted = "turns" in found.groupdict() and found["turns"] is not None
        yield Command(
            ({"op": "spin", "target": target, **fields},), needs=counted and re.match(rf"^{_SPIN} ", said) is not None
        )
    endless = (
        rf"(?:spin|twirl|whirl|rotate|turn|revolve|keep spinning|keep turning|keep rotating|keep) "
        rf"{_NP} ?,? ?(?:like crazy|continuously|constantly|endlessly|round and round|around and "
        rf"around|in circles|without stopping|non ?stop|spinning|turning|rotating)",
        rf"(?:{_LET}) {_NP}{_TO} (?:keep (?:on )?)?(?:spin|rotate|turn|twirl|whirl|revolve|spinning|"
        rf"turning|rotating)(?:{_ENDLESS})",
        rf"{_NP} (?:{_OUGHT} )?(?:keeps? (?:on )?)?(?:spins?|rotates?|twirls?|whirls?|revolves?|"
        rf"spinning|rotating){_ENDLESS}",
    )
    for found in _first(endless, said):
        if (target := thing(found["np"])) is not None:
            yield Command(
                ({"op": "spin", "target": target},), needs=said.startswith(("turn ", "rotate ")) and not moment.always
            )
    if (
        (bare := re.match(rf"^(?:spin|twirl|whirl|rotate|turn|revolve) {_NP}{_ENDLESS}$", said))
        and (target := thing(bare["np"])) is not None
        and (moment.lasting is not None or moment.stop is not None or moment.always)
    ):
        yield Command(({"op": "spin", "target": target},), needs=not moment.always)


def _turning(found: re.Match[str]) -> Fields | None:
    got = found.groupdict()
    if got.get("rate"):
        if got.get("deg"):
            rate = _number(got["deg"]) / 360
            return {"turns_per_second": rate / (60 if "min" in got["perdeg"] else 1)}
        if got.get("m") or got.get("k"):
            return {"turns_per_second": _number(got["m"] or got["k"]) / 60}
        rate = _number(got["n"])
        return {"turns_per_second": rate / (60 if "min" in got["per"] else 1)} if rate else None
    if got.get("turns"):
        if got.get("angle"):
            return {"turns": float(got["angle"]) / 360}
        counted = got.get("c") or got.get("adv")
        value = _number(counted) if counted else 1.0
        return {"turns": value} if value else None
    return None


_COUNTS = {"a": 1.0, "one": 1.0, "once": 1.0, "twice": 2.0, "half a": 0.5, "thrice": 3.0}


def _number(said: str) -> float:
    if said in _COUNTS:
        return _COUNTS[said]
    return float(said.replace(",", ".")) if said[0].isdigit() else float(quantities.NUMBERS.get(said, 0))


# -- pace ------------------------------------------------------------------------------------------------------------


def _pace(target: Query, change: str, **more: Any) -> Command:
    return Command(({"op": "pace", "target": target, "change": change, **more},))


def _played(said: str, thing: Thing) -> Query | None:
    """The target of a command about motion: the whole scene, or things."""
    return ALL_OF_IT if re.fullmatch(_PLAYED, said) and said not in ("it", "this", "that") else thing(said)


def _paces(said: str, thing: Thing, moment: Moment) -> Iterator[Command]:
    yield from _backwards(said, thing)
    yield from _middle(said, thing)
    yield from _speeds(said, thing)
    yield from _shifted(said, thing, moment)
    yield from _stops(said, thing)
    yield from _starts(said, thing, moment)


def _backwards(said: str, thing: Thing) -> Iterator[Command]:
    forms = (
        rf"(?:play|run|show|replay|rewind|render) (?P<np>{_PLAYED}) {_BACKWARDS}",
        rf"(?:play|run) {_BACKWARDS}(?P<np>)",
        rf"(?:reverse|rewind|invert|flip) (?P<np>{_PLAYED})",
        rf"(?P<np>{_PLAYED}) (?:{_OUGHT} )?(?:plays?|runs?|goes|go|be played|happens?)? ?{_BACKWARDS}",
        r"(?P<np>rewind|backwards)",
    )
    if next(_first(forms, said), None) is not None:
        yield _pace(ALL_OF_IT, "reverse")
        return
    other = (
        rf"(?:{_LET} )?{_NP}(?: {_OUGHT})? (?:spins?|turns?|rotates?|goes|go|runs?|revolves?|spinning|"
        rf"turning) (?P<way>{_OTHER_WAY})(?: instead)?",
        rf"(?:spin|turn|rotate|run) {_NP} (?P<way>{_OTHER_WAY})(?: instead)?",
        rf"(?:reverse|invert|change|flip|switch) (?:the )?(?:direction|rotation|spin|turning direction|"
        rf"sense(?: of rotation)?|spin direction) of {_NP}(?P<way>)",
        rf"(?:reverse|invert|change|flip|switch) {_NP} s? ?(?:direction|rotation|spin|turning "
        rf"direction|sense(?: of rotation)?)(?P<way>)",
    )
    for found in _first(other, said):
        turns = re.search(
            r"\b(?:spin|spins|turn|turns|rotate|rotates|revolve|revolves|rotation|spinning|turning)\b", said
        )
        if (target := thing(found["np"])) is not None:
            if turns is not None or "round" in found["way"] or "around" in found["way"]:
                yield Command(({"op": "spin", "target": target, "other_way": True},))
            else:
                yield _pace(target, "reverse")
            return
    one = (
        rf"(?:play|run|show|reverse) {_NP}(?: s)?(?: motion| movement| path| way| walk| fall)?(?: {_BACKWARDS})?",
        rf"(?:{_LET} )?{_NP}(?: {_OUGHT})? (?:goes?|walks?|moves?|rolls?|runs?|drives?|falls?|plays?|"
        rf"travels?|makes? (?:its|the) way|do it|does it) (?:{_BACKWARDS})(?: ?,? from .+ to .+)?",
        rf"(?:{_LET} )?(?:the )?(?:motion|movement|path|walk|way|fall) of {_NP} (?:plays? |runs? |goes "
        rf"|go |run )?{_BACKWARDS}",
    )
    for found in _first(one, said):
        if said.startswith(("play", "run", "show")) and re.search(_BACKWARDS, said) is None:
            continue
        if (target := thing(found["np"])) is not None and not (said.startswith("reverse") and target.last):
            yield _pace(target, "reverse")
            return
    back = (
        rf"(?:{_LET} )?{_NP}(?: {_OUGHT})? (?:rolls?|goes?|walks?|drives?|comes?|slides?|swings?|"
        rf"moves?|runs?|flies|fly|travels?|returns?|turns?) back(?: again| home)?"
        r"(?: (?:to|from) where (?:it|he|she|they) (?:was|were|came from|comes from|started|starts|"
        r"stood|began)(?: before| first| at first)?| the (?:same )?way (?:it|he|she|they) came| to "
        r"(?:the |its )?(?:start|beginning|starting (?:point|position|place)|origin|old place|"
        r"original place|first place|initial position))?(?: (?:again|afterwards?|at the end|in the "
        r"end))*",
        rf"(?:send|bring|take|return|roll|drive|walk) {_NP} back(?: again)?(?: (?:to where (?:it|he|"
        rf"she|they) (?:was|were|came from|started|began)|the way it came|to (?:the |its )?(?:start|"
        rf"beginning|starting (?:point|position|place)|origin)))?",
    )
    for found in _first(back, said):
        static = re.match(r"^(?:move|put|bring|take|turn|return|send) ", said) is not None
        if (target := thing(found["np"])) is not None and not static:
            yield _pace(target, "return")
            return


_BESIDE = "at|by|near|next to|beside|in front of"


def _middle(said: str, thing: Thing) -> Iterator[Command]:
    """ "stop the ball in the middle of the rug": a place at which what moves comes to rest."""
    forms = (
        rf"(?:stop|halt|freeze|park) {_NP} (?:right |exactly |directly )?(?:in|at|on|over) (?:the "
        rf")?(?:middle|centre|center) of (?P<goal>.+)",
        rf"(?:{_LET} )?{_NP}(?: {_OUGHT})? (?:stops?|halts?|comes? to (?:a )?(?:rest|stop)|ends? up|"
        rf"stays?|ends?|rests?) (?:right |exactly )?(?:in|at|on|over) (?:the )?(?:middle|centre|"
        rf"center) of (?P<goal>.+)",
        rf"(?:{_LET} )?{_NP}(?: {_OUGHT})? (?:stops?|halts?|comes? to (?:a )?(?:rest|stop)) (?:right |"
        rf"exactly )?(?:on|over) (?P<goal>.+)",
        rf"(?:stop|halt) {_NP} (?:right )?(?:on|over|{_BESIDE}) (?P<goal>(?:the|this|that|a) .+)",
        rf"(?:{_LET} )?{_NP}(?: {_OUGHT})? (?:stops?|halts?) (?:right )?(?:{_BESIDE}|before) (?P<goal>.+)",
    )
    for found in _first(forms, said):
        target, goal = thing(found["np"]), thing(_without_staying(found["goal"]))
        if target is not None and goal is not None:
            yield Command(
                ({"op": "pace", "target": target, "change": "stop"},),
                during={"state": "closest", "anchors": (goal,), "part": "from"},
            )
            return


_STAYING = (
    r"(?: ?,? ?(?:and|then|and then)? ?(?:stays?|remains?|rests?|holds?|keeps?|hold it|keep it|"
    r"leave it|stand|stay|stays|lies)(?: (?:there|still|it there|put|it|in place|like that|"
    r"that way))?)$"
)


def _without_staying(said: str) -> str:
    return re.sub(_STAYING, "", said).strip(" ,")


def _speeds(said: str, thing: Thing) -> Iterator[Command]:
    forms = (
        rf"(?:play|run|show|render|do|replay) (?P<np>.+?) {_TIMES}",
        rf"(?:{_LET} )?(?P<np>.+?)(?: {_OUGHT})? (?:{_GO}|{_GOES}|{_GOING}|swing open|swings open|be|"
        rf"is|opening|s)(?: up| down| open| along| around)? {_TIMES}",
        rf"(?:speed up|accelerate|hurry up|hasten|quicken) (?P<np>.+?)(?: by)?(?: {_TIMES})?(?P<faster>)",
        rf"(?:speed|hurry) (?P<np>.+?) up(?: by)?(?: {_TIMES})?(?P<faster>)",
        rf"(?:slow down|decelerate|slow) (?P<np>.+?)(?: by)?(?: {_TIMES})?(?P<slower>)",
        rf"slow (?P<np>.+?) down(?: by| to)?(?: {_TIMES})?(?P<slower>)",
        r"(?:double|halve|triple) the (?:speed|pace|tempo) of (?P<np>.+?)(?P<named>)",
        rf"(?:make|let|have|get|set|put) (?P<np>.+?) (?:to |run at |go at |at )?{_TIMES}",
        rf"(?P<np>.+?) (?:at )?{_TIMES}",
        rf"(?:open|close|shut|turn|spin|roll|move|drop|walk|drive|swing) (?P<np>.+?) {_TIMES}",
        rf"(?:{_LET} )?(?P<np>.+?)(?: {_OUGHT})? (?:slows? down|decelerates?|gets? slower|brakes?)(?P<slower>)",
        rf"(?:{_LET} )?(?P<np>.+?)(?: {_OUGHT})? (?:speeds? up|accelerates?|gets? faster)(?P<faster>)",
    )
    for found in _first(forms, said):
        got = found.groupdict()
        factor = _factor(got.get("times") or "", "faster" in got, "slower" in got)
        if "named" in got:
            factor = {"double": 2.0, "halve": 0.5, "triple": 3.0}[said.split()[0]]
        np = re.sub(rf" (?:{_OUGHT}|go|run|move|be|turn|spin)$", "", found["np"])
        np = re.sub(r"^(?:let|make|have|get|play|set) ", "", np)
        if factor is None:
            continue
        if re.match(r"^(?:play|run|show|render)\b", said) and np in ("it", "this", "that"):
            target: Query | None = ALL_OF_IT
        else:
            target = _played(np, thing)
        if target is not None:
            yield _pace(target, "speed", factor=factor)
            return


_FACTORS = (
    ("quarter", 0.25), ("third", 1 / 3), ("double", 2.0), ("twice", 2.0), ("triple", 3.0), ("three", 3.0),
    ("four", 4.0), ("two", 2.0), ("five", 5.0), ("six", 6.0), ("ten", 10.0), ("half", 0.5),
)  # fmt: skip


def _factor(said: str, faster: bool, slower: bool) -> float | None:
    """How many times as fast."""
    value: float | None = None
    if found := re.search(r"(\d+(?:[.,]\d+)?) ?(x|times|%|percent)|x ?(\d+(?:[.,]\d+)?)", said):
        value = float((found[1] or found[3]).replace(",", "."))
        if found[2] in ("%", "percent"):
            value /= 100
            if re.search(r"faster|quicker", said) or faster:
                return 1 + value
            return 1 - value if re.search(r"slower", said) or slower else value
    for word, number in _FACTORS:
        if value is None and re.search(rf"\b{word}", said):
            value = number
    if said == "in slow motion":
        return 0.5
    slow = slower or re.search(r"\bslow", said) is not None
    quick = faster or re.search(r"\b(?:fast|quick)", said) is not None
    if value is None:
        if not (slow or quick):
            return None
        if re.search(r"\b(?:bit|little|slightly|somewhat)\b", said):
            return 0.75 if slow else 1.33
        if re.search(r"\b(?:much|way|lot|far|crazy|super|really)\b", said):
            return 1 / 3 if slow else 3.0
        plain = re.fullmatch(r"(?:more )?(?:slowly|quickly)|slow|fast", said) is not None
        return None if plain and not (faster or slower) and "more" not in said else (0.5 if slow else 2.0)
    if value == 0.5 and slow and re.search(r"half as slow", said):
        return 2.0
    if slow and value > 1:
        return 1 / value
    return value if value > 0 else None


def _shifted(said: str, thing: Thing, moment: Moment) -> Iterator[Command]:
    by = r"(?:by )?(?P<by>.+?)"
    forms = (
        (rf"(?:delay|postpone|hold back|put off) (?P<np>.+?) by {by}", 1),
        (rf"(?:advance|bring forward) (?P<np>.+?) by {by}", -1),
        (
            rf"(?:{_LET} )?(?P<np>.+?)(?: {_OUGHT})? (?:(?:{_GO}|{_GOES}|happens?|be|is|comes?)(?: "
            rf"(?:{_GO}|{_GOING}|to \w+))? )?(?P<by>{DURATION}) (?P<way>later|earlier|sooner)",
            0,
        ),
        (
            rf"(?:move|shift|push) (?P<np>.+?) (?:back |forward )?by {by} (?P<way>later|earlier|"
            rf"sooner)(?: in time)?",
            0,
        ),
    )
    from .moments import seconds_of

    for pattern, sign in forms:
        found = re.match(rf"^{pattern}$", said)
        if found is None or (value := seconds_of(found["by"].strip())) is None:
            continue
        target = _played(re.sub(rf" (?:{_OUGHT})$", "", found["np"]), thing)
        if target is not None:
            sign = sign or (1 if found["way"] == "later" else -1)
            yield _pace(target, "later", seconds=sign * value)
            return


def _stops(said: str, thing: Thing) -> Iterator[Command]:
    said = _without_staying(said) or said
    still = (
        rf"(?:do not|never) let (?P<np>.+?) (?:{_GO}|slip|drop off|fall off)(?: .{{0,12}})?",
        rf"(?:{_LET} )?(?P<np>nothing|none of it|no ?thing) (?:{_OUGHT} )?(?:{_GO}|{_GOES}|be moving|"
        rf"is moving)(?: at all| any ?more)?",
        rf"(?:keep|prevent|stop|hinder|block) (?P<np>.+?) from (?:{_GOING}|\w+ing)(?: off| down| at all)?",
        rf"(?:{_LET} )?(?P<np>.+?)(?: {_OUGHT})? (?:not|never|no longer) (?:{_GO}|be moving|"
        rf"{_GOES})(?: at all| any ?more| any longer)?",
        rf"(?P<np>.+?) (?:does not|do not|should not|must not|shall not|never|should never|is not to|"
        rf"may not) (?:{_GO}|{_GOES})(?: at all| any ?more| any longer)?",
        rf"(?:keep|leave|hold) (?P<np>.+?) (?:completely |perfectly |absolutely )?{_STILL}(?: all the time)?",
        r"(?:leave|keep|hold) (?P<np>.+?) (?:up )?on (?:the|its) .+? ,? ?(?:and )?(?:do not|never) "
        r"let (?:it|him|her|them) (?:fall|drop|go|move|slip|roll)(?: off| down)?",
    )
    plain = (
        rf"(?:stop|freeze|pause|halt|hold|arrest|immobili[sz]e|block|interrupt|switch off|turn off) "
        rf"(?P<np>.+?)(?: (?:from moving|moving|in its tracks|dead|right there|there|mid ?way|from "
        rf"(?:{_GOING})|{_GOING}|in place))?",
        rf"(?:{_LET} )?(?P<np>.+?)(?: {_OUGHT})? (?:stops?|freezes?|pauses?|halts?|stands? {_STILL}|"
        rf"stays? {_STILL}|holds? still|be still|be frozen|is frozen|is still|waits?|rests?|come to "
        rf"(?:a )?(?:stop|halt|rest)|comes to (?:a )?(?:stop|halt|rest)|remains? {_STILL}|be paused|be "
        rf"stopped|take a break|takes a break)(?: (?:moving|{_GOING}|there|dead))?",
        rf"(?:keep|leave|hold|make) (?P<np>.+?) {_STILL}",
        rf"(?:{_LET} )?(?P<np>.+?) not move",
    )
    off = re.match(r"^(?:(?:turn|switch|shut) )?(?P<np>.+?) (?:goes |go |turns |switches |is |be )?off$", said)
    if off is not None and _RUNS.search(off["np"]) and (runs := thing(off["np"])) is not None:
        yield _pace(runs, "stop")
        return
    for found in _first(still, said):
        target = MOVING if found["np"] in ("nothing", "none of it", "no thing") else _moved(found["np"], thing)
        if target is not None:
            yield _pace(target, "stop")
            return
    for found in _first(plain, said):
        if said.startswith(("turn off", "switch off")) and _RUNS.search(found["np"]) is None:
            continue
        if (target := _moved(found["np"], thing)) is not None:
            named = re.match(
                r"^(?:stop|hold|block|pause|halt|still) (?!the|all|every|it|that|this|my|our|both|any|"
                r"time|whole)",
                said,
            )
            yield Command(({"op": "pace", "target": target, "change": "stop"},), needs=named is not None)  # "stop sign"
            return


# What has a motor, so that it stops when it is switched off; a lamp goes dark.
_RUNS = re.compile(
    r"\b(?:fans?|motors?|engines?|robots?|toys?|trains?|wheels?|machines?|mixers?|clocks?|propellers?|carousels?|blades?)$"
)


def _moved(np: str, thing: Thing) -> Query | None:
    """What stops or starts: everything is all that moves."""
    if re.fullmatch(_PLAYED, np) and np not in ("it", "this", "that"):
        return ALL_OF_IT
    return thing(np)


def _starts(said: str, thing: Thing, moment: Moment) -> Iterator[Command]:
    said = re.sub(
        r" ?,? ?(?:and )?(?:stands? |be |is |keep it |it is |stay )?(?:still|stopped|not moving|at "
        r"rest) (?:before(?: that)?|until then)$",
        "",
        said,
    )
    on = (
        rf"(?:{_LET} )?(?P<np>.+?)(?: {_OUGHT})? (?:keeps?|continues?|goes on|go on|carr(?:y|ies) on|"
        rf"never stops?|not stop|stays?|keep on|remains?)(?: on)?(?: to)?(?: (?:{_GOING}|{_GO}))?",
        rf"keep (?P<np>.+?) (?:{_GOING})",
        r"(?:do not|never) (?:stop|let) (?P<np>.+?)(?: stop)?",
        rf"(?P<np>.+?) (?:{_OUGHT}) (?:be )?(?:{_GOING})",
        rf"(?P<np>.+?) (?:is|are) (?:{_GOING})",
    )
    for found in _first(on, said):
        lasting = moment.always or re.search(r"keep|continue|on\b|never|not stop", said) is not None
        still = re.search(r" (?:stay|stays|keep|keeps|remain|remains)$", said)
        if lasting and still is None and (target := thing(found["np"])) is not None:
            yield _pace(target, "go_on")
            return
    begin = (
        rf"(?:start|begin|launch|set off|trigger|kick off|activate) (?P<np>.+?)(?: (?:moving|off|up|{_GOING}))?",
        rf"(?:{_LET} )?(?P<np>.+?)(?: {_OUGHT})? (?:only )?(?:starts?|begins?|sets? off|takes? off)(?: "
        rf"(?:to )?(?:{_GO}|{_GOING}|its \w+))?",
        rf"(?:{_LET} )?(?P<np>.+?)(?: {_OUGHT})? (?:only |all )?(?:{_GO}|{_GOES})(?: down| off| over| "
        rf"away| to the floor| onto the floor| at once| together| simultaneously| at the same time| "
        rf"down to the floor)*",
        rf"(?P<np>.+?)(?: s)? (?:{_GOING}|motion|movement|fall|walk|opening) (?:starts?|begins?|"
        rf"happens?|takes? place)",
    )
    for found in _first(begin, said):
        np = re.sub(r" (?:only|all|both)$", "", found["np"])
        if (target := thing(np)) is not None:
            yield Command(({"op": "pace", "target": target, "change": "begin"},), needs=True)
            return
    last = (
        rf"(?:{_LET} )?(?P<np>.+?)(?: {_OUGHT})? (?:{_GO}|{_GOES}) (?:last|after (?:all )?the "
        rf"others?|after everything else|as the last(?: one)?|at the end)"
    )
    if (later := re.match(rf"^{last}$", said)) and (target := thing(later["np"])) is not None and not target.moving:
        others = MOVING.model_copy(update={"exclude": (target,)})
        yield Command(
            ({"op": "pace", "target": target, "change": "begin"},),
            during={"state": "moving", "of": others, "part": "after"},
        )
    takes = rf"(?:{_LET} )?(?P<np>.+?)(?: s)? (?:{_GOING}|motion|movement|fall|walk|opening|it)"
    if moment.taken and (long := re.match(rf"^{takes}$", said)) and (target := thing(long["np"])) is not None:
        yield Command(({"op": "pace", "target": target, "change": "begin"},), needs=True)


# -- going somewhere -------------------------------------------------------------------------------------------------


def _going(said: str, thing: Thing, moment: Moment) -> Iterator[Command]:
    """A way, as a plain command to move: "let the car drive to the sofa" is "move the car toward the sofa"."""
    forms = (
        (rf"(?:{_LET} )?{_NP}(?: {_OUGHT})? (?P<verb>{_LIVELY}) ?{_SOMEWHERE}", False),
        (rf"(?:{_LET} )?{_NP}(?: {_OUGHT})? (?P<verb>{_PLAIN}) ?{_SOMEWHERE}", True),
        (rf"{_NP} (?P<verb>{_LIVELIER}) ?{_SOMEWHERE}", True),
        (
            rf"(?P<verb>drive|walk|roll|fly|float|glide|slide|push|lift|raise|lower|carry|send|bring|"
            rf"take|move|shift|drag) {_NP} {_SOMEWHERE}",
            True,
        ),
        (rf"(?P<verb>lift|raise|lower|sink)(?: up| down)? {_NP}(?P<to>)(?P<goal>(?: by)? ?\d.*| by .*|)", True),
        (
            rf"(?:{_LET} )?{_NP}(?: {_OUGHT})? (?P<verb>rise|rises|float|floats|ascend|ascends|descend|"
            rf"descends|sink|sinks|levitate|levitates|climb|climbs|fall|drop)(?P<to>)(?P<goal>)",
            True,
        ),
    )
    for pattern, needs in forms:
        found = re.match(rf"^{pattern}$", said)
        if found is None or thing(found["np"]) is None:
            continue
        if found["verb"] == "be" and re.match(r"^(?:on|in|at|by)\b", found["goal"]) is None:
            continue
        way = _way(found["verb"], found["to"], found["goal"])
        if way is None:
            continue
        np = _articled(found["np"], thing)
        yield Command(kind="path", needs=needs, text=f"move {np} {way}".strip())
        return


_UP = (
    "rise",
    "rises",
    "ascend",
    "ascends",
    "lift",
    "lifts",
    "raise",
    "raises",
    "levitate",
    "levitates",
    "climb",
    "climbs",
    "lift off",
    "be lifted",
)
_DOWN = ("sink", "sinks", "descend", "descends", "lower", "lowers", "fall", "drop")


def _way(verb: str, to: str, goal: str) -> str | None:
    """Where to, in plain words; None if that is not said."""
    goal = re.sub(r"^by (?=\d|a |half|one|two)", "", goal.strip())
    aimed = re.match(
        r"^(?:on ?to|to|towards?|into|next to|beside|behind|under|in front of|between|near|against|"
        r"above|below|on |in )",
        goal,
    )
    if (
        aimed is None
        and (verb in _UP or "up" in to.split())
        and not re.match(r"^(?:left|right|forward|backward|down)", goal)
    ):
        return f"up {goal.removeprefix('up ').removeprefix('by ')}".strip()
    if aimed is None and (verb in _DOWN or "down" in to.split()):
        return f"down {goal.removeprefix('down ').removeprefix('by ')}".strip()
    if aimed is None and verb in ("float", "floats") and not goal:
        return "up"
    if not goal:
        return None
    if found := re.match(
        r"^(?:to|up to|towards?) (?P<what>(?!the (?:left|right|front|back|side|middle|centre|center|"
        r"other|corner|end)\b).+)$",
        goal,
    ):
        return f"toward {found['what']}"
    if re.match(r"^across (?P<what>.+)", goal):
        return None
    return goal


def _articled(np: str, thing: Thing) -> str:
    """A name with an article, as the rest of the grammar wants it."""
    return (
        np
        if re.match(r"^(?:the|a|an|this|that|these|those|all|every|both|my|our|it|them|each|any)\b", np)
        else f"the {np}"
    )
