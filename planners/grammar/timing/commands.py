"""What clauses about motion mean: the sense of a verb and what stands beside it, as operations.

Each rule takes a clause only if it accounts for all that is said beside the verb (`Manner.fields`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ....gaussians.world.words import head, singular
from ..tagging.words import bag
from . import loosely, movements
from . import manner as manners
from .clauses import ALL_OF_IT, MOVING, Clause, clauses
from .command import Command, Fields, pace, plain
from .manner import MOTION, Manner, Thing
from .moments import Moment

Rule = Callable[[Clause, Manner, Moment], Iterator[Command]]

_OPENABLE = bag(
    "door gate window drawer lid hatch flap cupboard cabinet wardrobe fridge refrigerator oven box chest locker trunk "
    "shutter case safe dresser microwave dishwasher toilet"
)
_RUNS = bag("fan motor engine robot toy train wheel machine mixer clock propeller carousel blade windmill rotor car")
_SPEEDS = {"double": 2.0, "triple": 3.0, "halve": 0.5}
_AMOUNTS = ("times", "percent", "share", "compare", "degree")
_PLAIN = bag("move go come slide get shift return head turn")  # verbs that ask for an edit as well as for a movement


def commands(said: str, thing: Thing, moment: Moment, told: bool) -> Iterator[Command]:
    """What a command may mean, the likeliest first.

    Args:
        said: words parted by spaces, without times.
        told: whether it comes with a time, in numbers or by what happens.
    """
    yield from movements.ordered(said, thing, moment)
    for clause in clauses(said, thing):
        for manner in _beside(clause, thing):
            for rule in _RULES:
                for command in rule(clause, manner, moment):
                    if told or not command.needs:
                        yield command
        meets = clause.sense == "reach" and clause.verb is not None and clause.verb.first in _MEETS
        if meets and told and not clause.ordered and not clause.negated:
            whom = thing(" ".join(clause.tail))  # "the ball reaches the wall at 2 s"
            if whom is not None and moment.stop is not None and moment.start is None and moment.lasting is None:
                yield pace(clause.target, "begin")  # "the ball must have reached the wall by 2 s"
            elif whom is not None and (moment.start is not None or moment.lasting is not None):
                yield replace(pace(clause.target, "begin"), ends=True)
    for clause in clauses(said, thing):
        if told or moment.always or clause.sense == "blink":
            yield from _colored(clause)


def loose_commands(said: str, thing: Thing, moment: Moment, told: bool) -> Iterator[tuple[Command, Moment]]:
    """As `commands`, of words in any order; with the time that goes with each."""
    for found, beside in loosely.readings(said, thing):
        for clause, manner, when in loosely.with_time(found, beside, moment):
            timed = told or when.told
            for rule in _RULES if when is moment else (_lasting, _spun, _stopped):
                for command in rule(clause, manner, when):
                    about_time = all(op["op"] in _LOOSE for op in command.ops) and not command.text
                    if timed or (about_time and not command.needs):
                        yield command, when


_LOOSE = ("pace", "spin", "sway", "articulate")  # which words in any order may ask for without a time


def _lasting(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    """ "the door needs 3 s for opening": what it does anyway, in this time."""
    sense = manner.doing if clause.verb is None else clause.sense
    known = (sense in MOTION and sense != "move") or (
        clause.aspect == "event" and sense in ("do", "be", "move", "stay")
    )
    if known and moment.taken and moment.start is None and manner.only("doing") and not clause.negated:
        yield pace(clause.target, "begin", needs=True)


def _beside(clause: Clause, thing: Thing) -> Iterator[Manner]:
    """What stands beside a verb; the object of one that goes round or after another thing."""
    if clause.sense in ("orbit", "follow"):
        for end in range(len(clause.tail), 0, -1):
            whom = thing(" ".join(clause.tail[:end]))
            if whom is not None and not whom.last:
                for manner in manners.read(clause.tail[end:], thing):
                    yield replace(manner, whom=whom, goal=manner.goal or "whom", at=manner.at or "whom")
        return
    yield from manners.read(clause.tail, thing)


_MEETS = bag("reach touch hit strike meet arrive bump crash collide")


def _all(clause: Clause) -> Query:
    """The target; the whole scene where "it" is played."""
    return ALL_OF_IT if clause.played and clause.np in ("it", "this", "that") else clause.target


# -- how fast, when, which way -----------------------------------------------------------------------------------------


def _paced(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    sense = clause.sense
    changed = sense in ("change", "increase", "reduce", "do")
    speedy = sense in ("faster", "slower") or manner.compare != "" or clause.aspect == "speed"
    speedy |= clause.played or clause.target == ALL_OF_IT
    known = sense in (*MOTION, *_SPEEDS, "be", "faster", "slower", "play", "look", "start", "fade") or changed
    if not (speedy and known) or clause.negated or not manner.only(*_AMOUNTS, "doing", "state"):
        return
    if manner.state not in ("", "open", "moving") or (changed and clause.aspect != "speed" and not manner.compare):
        return
    if clause.aspect == "speed" and clause.ordered:  # "drop its speed by a third"
        sense = {"fall": "reduce", "sink": "reduce", "rise": "increase"}.get(sense, sense)
    factor = _factor(sense, manner)
    if factor is not None and not moment.slowly:  # "faster little by little" is no one speed
        yield pace(_all(clause), "speed", factor=factor)


def _factor(sense: str, manner: Manner) -> float | None:
    """How many times as fast."""
    slow = sense in ("slower", "reduce") or manner.compare in ("slow", "slower")
    quick = sense in ("faster", "increase") or manner.compare in ("fast", "faster")
    if sense in _SPEEDS:
        return None if manner.fields - {"compare"} else _SPEEDS[sense]
    if manner.percent is not None:
        if manner.by == "to" or (manner.by != "by" and manner.compare in ("speed", "fast")) or not (slow or quick):
            return manner.percent
        return 1 - manner.percent if slow else 1 + manner.percent
    value = manner.times if manner.times is not None else manner.share
    if value is None:
        if not (slow or quick):
            return None
        return {"little": (0.75, 1.33), "much": (1 / 3, 3.0), "": (0.5, 2.0)}[manner.degree][0 if slow else 1]
    if manner.compare == "slow" or (slow and value > 1):
        return 1 / value
    if manner.by == "by" and manner.share is not None and (slow or quick):
        return 1 - value if slow else 1 + value
    return value


_SHIFTED = ("be", "start", "stop", "do", "delay", "advance", "play", "reach", "arrive", "leave")


def _shifted(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    sign = {"delay": 1.0, "advance": -1.0}.get(clause.sense)
    by = manner.later
    if sign is not None and manner.lasting is not None and not clause.negated:
        by = sign * manner.lasting
    known = clause.sense in (*MOTION, *_SHIFTED)
    if by is None or not known or clause.negated or (sign is None) != (manner.lasting is None):
        return
    if manner.only("later", "lasting", "doing", "goal", "at", "whom") and (_on_floor(manner) or not clause.ordered):
        yield pace(clause.target, "later", seconds=by)


def _on_floor(manner: Manner) -> bool:
    """Whether the goal, if any, only says where what falls comes to."""
    return manner.whom is None or manner.whom.text in ("floor", "ground", "rug", "carpet")


def _reversed(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    if clause.negated:
        return
    if clause.sense == "reverse" and manner.only("backwards", "other_way"):
        if clause.aspect == "way":
            yield Command(({"op": "spin", "target": clause.target, "other_way": True},))
        elif clause.verb and clause.verb.first in ("swap", "switch", "mirror"):
            return  # several things swap something
        elif clause.aspect or (clause.verb and clause.verb.first in ("reverse", "rewind") and not clause.target.last):
            yield pace(clause.target, "reverse")
        return
    if clause.sense == "change" and clause.aspect == "way" and manner.only("other_way"):
        yield Command(({"op": "spin", "target": clause.target, "other_way": True},))
    known = clause.sense in (*MOTION, "be", "play", "do", "look")
    allowed = ("backwards", "other_way", "endless", "goal", "at", "whom", "origin")
    placed = clause.sense in ("open", "close") and manner.other_way  # its hinge is where it is
    placed |= manner.other_way and manner.goal != ""  # "turn it to face the other way"
    if not known or placed or not (manner.backwards or manner.other_way) or not manner.only(*allowed):
        return
    if clause.sense in ("spin", "look") or clause.aspect == "way":
        yield Command(({"op": "spin", "target": clause.target, "other_way": True},))
    else:
        yield pace(_all(clause), "reverse")


def _returned(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    """ "let it roll back", "send it back the way it came"; "put it back" asks for an edit."""
    if not manner.back or not manner.only("back", "way") or clause.negated or clause.sense not in (*MOTION, "be"):
        return
    first = clause.verb.first if clause.verb else ""
    if clause.sense == "be" or (clause.ordered and first in ("put", "move", "bring", "take", "turn", "return")):
        return
    yield pace(clause.target, "return")


# -- turning -----------------------------------------------------------------------------------------------------------


def _spun(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    sense = clause.sense
    if clause.negated or not manner.only(
        "rate",
        "turns",
        "times",
        "degrees",
        "endless",
        "state",
        "doing",
        "degree",
        "compare",
    ):
        return
    if manner.state not in ("", "moving") or manner.doing not in ("", "spin"):
        return
    spin = {"op": "spin", "target": clause.target}
    if "instead" in clause.tail and manner.degrees is not None:
        return  # "turn by 180 degrees instead of 90" is said of a turn that is there
    if manner.compare and manner.rate is None:
        return
    takes = clause.verb is not None and clause.verb.first == "take"  # "it should take half a second"
    if (
        manner.rate is not None
        and not takes
        and sense
        in (
            *MOTION,
            "be",
            "do",
            "faster",
            "slower",
            "change",
            "stay",
            "continue",
            "increase",
            "reduce",
            "start",
        )
    ):
        yield Command(({**spin, "turns_per_second": manner.rate},))
        return
    turns = manner.turns
    if sense in ("spin", "do") and turns is None:
        turns = manner.times if manner.times is not None else _whole_turns(manner.degrees)
    if turns is not None and sense in ("spin", "do", "look"):
        yield Command(({**spin, "turns": turns},), needs=clause.ordered and sense == "spin")
        return
    if sense != "spin" or not manner.only("endless") or clause.kept or clause.form == "past":
        return
    first = clause.verb.first if clause.verb else ""
    edits = first in ("turn", "rotate")
    if clause.ordered and not manner.endless:
        if moment.lasting is not None or moment.stop is not None or moment.always:
            yield Command((spin,), needs=not moment.always)
    elif first != "turn" or manner.endless or clause.form == "plain":
        yield Command((spin,), needs=edits and clause.ordered and not moment.always)


def _whole_turns(degrees: float | None) -> float | None:
    return degrees / 360 if degrees is not None and (degrees % 360 == 0 or degrees == 180) else None


# -- rest and motion ---------------------------------------------------------------------------------------------------


def _stopped(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    target, sense = clause.target, clause.sense
    if clause.negated:
        moves = sense in (*MOTION, "start", "leave") or (sense == "be" and manner.state == "moving")
        if moves and manner.only("doing", "state") and manner.state in ("", "open", "moving"):
            vague = clause.verb is not None and clause.verb.first in _PLAIN - {"move", "slide", "turn"}
            yield pace(MOVING if target == ALL_OF_IT else target, "stop", needs=vague)  # "the bench should not go"
        return
    if sense == "stop" and manner.state in ("", "still") and manner.only("state", "doing", "refrains"):
        yield pace(target, "stop", needs=clause.ordered and _bare_name(clause))
    elif sense == "stop" and manner.at in _BESIDE and manner.only("goal", "at", "whom", "state"):
        during = {"state": "closest", "anchors": (manner.whom,), "part": "from"}
        spans = moment.start is not None and moment.stop is not None  # then it only says where it is
        yield pace(target, "stop") if spans else replace(pace(target, "stop"), during=during)
    meant = clause.kept or sense != "be" or clause.aux != () or not moment.empty  # "the still ball" says nothing
    rests = sense in ("stay", "be", "continue") and manner.state == "still" and manner.only("state") and meant
    refrains = manner.refrains or (manner.doing != "" and clause.verb is not None and clause.verb.first != "keep")
    kept = (clause.kept and sense == "be" and manner.refrains) or (sense == "prevent" and refrains)
    off = (sense == "off" and manner.only()) or (sense == "be" and manner.state == "off" and manner.only("state"))
    stays = clause.verb is not None and clause.verb.first in ("stay", "remain")
    rests |= stays and manner.only() and "there" in clause.tail
    rests |= stays and manner.goal != "" and manner.only("goal", "at", "whom")
    if rests or (kept and manner.only("doing", "refrains")) or (off and _runs(clause)):
        yield pace(target, "stop")


_BESIDE = bag("on over at by near before inside in beside against") | {
    "next to", "in front of", "on top of", "close to", "in the middle of", "in the center of", "in the centre of",
    "on the middle of", "at the middle of", "on the center of",
}  # fmt: skip


def _bare_name(clause: Clause) -> bool:
    """Whether the object has no article: "stop sign"."""
    return not re.match(r"^(?:the|all|every|it|that|this|my|our|both|any|time|whole|them|him|her)\b", clause.np)


def _runs(clause: Clause) -> bool:
    """Whether it has a motor, so that it stops when it is switched off; a lamp goes dark."""
    return singular(head(clause.target.text) or "") in _RUNS


def _continued(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    """It goes on as it moves last."""
    sense, fields = clause.sense, manner.fields
    if clause.negated:
        if sense == "stop" and manner.only("doing"):
            yield pace(clause.target, "go_on")
        return
    on = (sense == "continue" and (not clause.ordered or manner.doing != "")) or (
        sense == "stay" and manner.doing != ""
    )
    on |= clause.kept and ((clause.form == "ing" and sense in MOTION) or (sense == "be" and manner.state == "moving"))
    on |= sense in MOTION and clause.form == "ing" and moment.always and not fields
    on |= sense in MOTION and bool({"keep", "keeps"} & set(clause.aux))
    if on and not manner.refrains and manner.only("doing", "endless", "state") and manner.state in ("", "moving"):
        yield pace(clause.target, "go_on")


def _begun(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    sense, target = clause.sense, clause.target
    if clause.negated:
        return
    if manner.last and sense in (*MOTION, "start") and manner.only("last", "doing") and not target.moving:
        others = MOVING.model_copy(update={"exclude": (target,)})
        yield replace(pace(target, "begin"), during={"state": "moving", "of": others, "part": "after"})
    on = (sense == "on" and manner.only()) or (sense == "be" and manner.state == "on" and manner.only("state"))
    if on and _runs(clause):
        yield pace(target, "begin", needs=True)
    if sense == "arrive" and manner.only() and (moment.start is not None or moment.lasting is not None):
        yield replace(pace(target, "begin", needs=True), ends=True)
    if moment.lasting is not None and not moment.taken and moment.start is None and clause.aspect != "event":
        return  # "it runs for two seconds" does not tell when it stops
    starts = sense == "start" and manner.only("doing")
    moves = (
        sense in MOTION
        and not clause.ordered
        and clause.form != "past"
        and manner.only("goal", "at", "whom", "endless")
    )
    moves = moves and (manner.whom is None or (sense == "fall" and _on_floor(manner)))
    drops = sense == "fall" and clause.ordered and not manner.fields
    lasts = clause.sense in ("be", "do") and clause.aspect == "event" and moment.taken and not manner.fields
    if starts and manner.doing == "close" and _is_openable(target, clause):
        yield Command(({"op": "articulate", "target": target, "change": "close"},), needs=True)
    elif starts or moves or drops or lasts:
        yield pace(target, "begin", needs=True)


# -- doors, drawers and lids -------------------------------------------------------------------------------------------


def _opened(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    sense, target = clause.sense, clause.target
    swung = sense in ("go", "spin", "move") and manner.degrees is not None and _is_openable(target, clause)
    if swung and clause.verb is not None and clause.verb.first in _SWINGS:
        sense = "open"  # "swing the door to 45 degrees"
    change = {"open": "open", "close": "close"}.get(sense) or {"open": "open", "closed": "close"}.get(manner.state)
    stays = sense in ("stay", "be") or (sense == "continue" and clause.verb is not None and clause.verb.first == "keep")
    halfway = sense == "stop" and manner.share is not None and manner.fields == {"share"}
    if sense == "close" and clause.negated and manner.only() and _is_openable(target, clause):
        yield _held_open(target)  # "do not close it"
    if clause.negated or (sense not in ("open", "close", "move", "go") and not (stays and change) and not halfway):
        return
    if sense in ("move", "go") and manner.state not in ("open", "closed"):
        return
    change = "open" if halfway else change
    if change is None or not manner.only("share", "percent", "degrees", "length", "state", "back", "way"):
        return
    if manner.state not in ("", {"open": "open", "close": "closed"}[change]) or not _is_openable(target, clause):
        return
    if manner.way not in ("", "up"):
        return
    amount: Fields = {}
    if manner.degrees is not None:
        amount["degrees"] = manner.degrees
    elif manner.length is not None:
        amount["distance"] = manner.length
    elif manner.share is not None or manner.percent is not None:
        amount["share"] = min(manner.share or manner.percent or 1.0, 1.0)
    if change == "open" and moment.start == "end" and not (clause.kept or sense in ("open", "continue", "stay")):
        return  # "it is to be open at the end" says nothing of when it opens
    gap = change == "close" and target.last  # "close it" may be said of a gap
    kept = clause.kept or sense in ("stay", "continue")
    if kept and change == "open" and moment.start == "end" and moment.stop is None:
        yield replace(_held_open(target), timeless=True)
        return
    if kept and change == "open" and not moment.empty:
        return  # "stay open until the end" says nothing of when it opens
    if kept and moment.stop is not None:
        yield pace(target, "stop")
    elif kept and change == "open" and moment.empty and not moment.always and not amount and not clause.kept:
        yield _held_open(target)
    else:
        yield Command(({"op": "articulate", "target": target, "change": change, **amount},), needs=gap)


_SWINGS = bag("swing turn push move pivot")


def _held_open(target: Query) -> Command:
    """What opens by itself opens and stays so."""
    ops = ({"op": "articulate", "target": target, "change": "open"},)
    return Command(ops, during={"state": "open", "part": "from"})


def _is_openable(target: Query, clause: Clause) -> bool:
    if target.region is not None or clause.aspect == "speed":
        return False
    return (target.last and not target.text) or any(singular(w) in _OPENABLE for w in target.text.split())


# -- going somewhere ---------------------------------------------------------------------------------------------------


def _gone(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    """A way, as a plain command to move: "let the car drive to the sofa" is "move the car toward the sofa"."""
    sense = manner.doing if clause.sense == "start" and manner.goal else clause.sense
    if clause.negated or sense not in ("go", "move", "rise", "sink", "fall", "be", "spin", "look"):
        return
    if sense in ("spin", "look"):
        if (
            sense == "spin"
            and manner.degrees is not None
            and "instead" not in clause.tail
            and manner.only("degrees", "way")
        ):
            side = f" {manner.way}" if manner.way in ("to the left", "to the right") else ""
            yield plain(clause, "path", f"rotate {{}} {manner.degrees:g} degrees{side}", needs=True)
        return
    if not manner.only("goal", "at", "whom", "way", "length", "backwards", "doing") or (
        sense == "be" and not manner.goal
    ):
        return
    way = manner.way or ("backward" if manner.backwards else "")
    if not manner.goal and not way:
        way = {"rise": "up", "sink": "down"}.get(sense, "")
        if sense == "fall" and manner.length is not None:
            way = "down"
    if sense == "fall" and way in ("to the left", "to the right", "forward"):
        return  # it tips over
    if (not manner.goal and not way) or (
        manner.goal and manner.at in ("off", "around", "round", "after", "with", "along with", "together with")
    ):
        return
    far = "" if manner.length is None else f" {manner.length.value:g} {manner.length.unit}"
    to = f" {manner.goal}" if manner.goal else f" {way}"
    if manner.at in _BY and not far and not _SIDE.search(manner.goal):  # over a time it goes up to it, to no free spot
        to = f" toward{manner.goal.removeprefix(manner.at)}"
    first = clause.verb.first if clause.verb else ""
    lively = (
        not clause.ordered and sense != "be" and first not in _PLAIN and not (clause.verb and clause.form == "past")
    )
    yield plain(clause, "path", f"move {{}}{far}{to}" if manner.goal else f"move {{}}{to}{far}", needs=not lively)


_BY = bag("beside by near") | {"next to", "close to"}
_SIDE = re.compile(r" the (?:left|right|other) (?:side )?of | between ")


# -- how it looks ------------------------------------------------------------------------------------------------------


def _hidden(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    sense = clause.sense
    if manner.fields - {"state"}:
        return
    gone = (sense == "hide" and manner.state in ("", "gone")) or (
        sense in ("be", "stay", "move", "go", "look") and manner.state == "gone"
    )
    shown = (sense == "show" and not manner.fields) or (sense in ("be", "stay", "look") and manner.state == "shown")
    if not (gone or shown) and not (sense == "fade" and not manner.fields and not clause.negated):
        return
    if (
        sense == "hide"
        and not clause.ordered
        and clause.verb is not None
        and clause.verb.first in ("remove", "delete", "cut", "lose", "kill")
        and not clause.aux
    ):
        return
    if sense == "fade":
        yield plain(clause, "look", "hide {}", fades=True)
        return
    if clause.negated and clause.verb is not None and clause.verb.first in ("remove", "delete", "erase"):
        return  # "do not remove it when it stops" asks for nothing
    yield plain(clause, "look", "hide {}", needs=True, inverse=shown != clause.negated)


def _colored(clause: Clause) -> Iterator[Command]:
    """ "the vase turns blue", "bed in navy blue": what the plain grammar reads as a change of its look."""
    if (
        clause.sense not in ("look", "paint", "be", "stay", "show", "change", "fade", "blink")
        or clause.negated
        or not clause.tail
        or clause.aspect
    ):
        return
    every = {"every": 0.5} if clause.verb is not None and clause.verb.first in ("blink", "flicker") else {}
    tail = re.sub(
        r"^(?:(?:in|into|to|all|completely|entirely|painted|coloured|colored|a|an|of|look|dyed|tinted|be|the "
        r"colou?r|turned|fully) )+",
        "",
        " ".join(clause.tail),
    )
    tail = re.sub(r" (?:in colou?r|too|as well|all over)$", "", tail)
    for verb in ("make", "paint"):
        yield plain(clause, "look", f"{verb} {{}} {tail}", **every)


_RULES: tuple[Rule, ...] = (
    movements.mirrored, movements.once_more, movements.repeated, movements.swayed, movements.tipped, movements.orbited,
    movements.followed, movements.parted, movements.blinked, _paced, _shifted, _reversed, _returned, _opened, _spun,
    _stopped, _continued, _gone, _begun, _hidden,
)  # fmt: skip
