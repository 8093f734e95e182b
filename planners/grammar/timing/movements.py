"""What clauses about new movements mean, and about several things: tipping over, hopping, going round or after another
thing, orders, parts and repetitions of a movement, and what comes and goes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from operator import itemgetter

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ....gaussians.world.words import singular
from ..tagging.words import bag
from .clauses import MOVING, Clause
from .command import Command, Fields, pace, plain
from .manner import MOTION, Manner, Thing
from .moments import DURATION, Moment, seconds_of
from .verbs import any_of

_SWAYS = {
    "hop": "hop", "jump": "hop", "leap": "hop", "bounce": "hop", "bob": "bob", "hover": "bob", "shake": "shake",
    "tremble": "shake", "vibrate": "shake", "jiggle": "shake", "rattle": "shake", "quiver": "shake", "shiver": "shake",
    "swing": "swing", "sway": "swing", "wobble": "wobble", "rock": "wobble", "totter": "wobble", "teeter": "wobble",
}  # fmt: skip
_IN_PLACE = re.compile(r"\b(?:there|in place|in (?:the |mid )?air)\b")
_HUNG = bag("door gate window drawer lid hatch flap cupboard cabinet fridge")  # which swing on a hinge
_LONGER = bag("further farther more another extra longer again wider")
_TURNING = bag("fan propeller wheel globe rotor windmill carousel blade top")
_BLINK = 0.5  # seconds from one blink to the next


def swayed(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    """ "let the vase hop twice", "give the table a shake"."""
    if clause.verb is None or clause.negated or clause.aspect or clause.kept or clause.form == "past":
        return
    how = _SWAYS.get(clause.verb.first, "bob" if clause.verb.said.endswith("up and down") else None)
    if how is None or not manner.only("times", "turns", "length", "degrees", "way", "forth", "endless"):
        return
    if clause.sense in ("open", "close") or (
        how == "swing" and any(singular(w) in _HUNG for w in clause.target.text.split())
    ):
        return
    if clause.verb.first == "hover" and _IN_PLACE.search(" ".join(clause.tail)) is not None:
        return  # "lift it, and let it hover there"
    if manner.way not in ("", "up") or (manner.way and how not in ("hop", "bob")) or (manner.way and not manner.length):
        return
    if (manner.length is not None and how in ("swing", "wobble")) or (
        manner.degrees and how not in ("swing", "wobble")
    ):
        return
    count = manner.times or manner.turns
    if count is not None and count != int(count):
        return
    op: Fields = {"op": "sway", "target": clause.target, "how": how}
    op |= {"times": int(count)} if count else {}
    op |= {"distance": manner.length} if manner.length is not None else {}
    op |= {"degrees": manner.degrees} if manner.degrees is not None else {}
    yield Command((op,), always_lasts=count is None and (manner.endless or moment.always))


def tipped(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    """ "the chair tips over to the left"."""
    sideways = clause.sense == "fall" and manner.way in ("to the left", "to the right", "forward")
    if not (clause.sense == "tip" or sideways) or clause.negated or clause.aspect or not manner.only("way", "degrees"):
        return
    ways = {"to the left": "left", "to the right": "right", "forward": "forward", "": "right"}
    if manner.way not in ways:
        return
    op: Fields = {"op": "tip", "target": clause.target, "direction": ways[manner.way]}
    yield Command(({**op, "degrees": manner.degrees} if manner.degrees else op,))


def orbited(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    """ "let the car drive around the bed twice"."""
    around = manner.at in ("around", "round") and clause.sense in ("go", "move", "spin", "do")
    if (
        not (clause.sense == "orbit" or around)
        or clause.negated
        or clause.aspect
        or manner.whom is None
        or manner.whom.last
    ):
        return
    if not manner.only("goal", "at", "whom", "times", "turns", "endless", "clockwise"):
        return
    turns = manner.turns if manner.turns is not None else manner.times
    op: Fields = {"op": "orbit", "target": clause.target, "around": manner.whom}
    sign = -1.0 if manner.clockwise == "clockwise" else 1.0
    if turns is not None or manner.clockwise:
        op["turns"] = sign * (turns if turns is not None else 1.0)
    yield Command((op,))


def followed(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    """ "the car follows the robot", "move the car along with the robot"."""
    leader, with_it = manner.whom, manner.at in ("with", "along with", "together with")
    behind = clause.sense == "follow" or (manner.at in ("after",) and clause.sense in ("go", "move"))
    if (
        leader is None
        or clause.negated
        or clause.aspect
        or not (behind or (with_it and clause.sense in ("go", "move")))
    ):
        return
    if not manner.only("goal", "at", "whom", "later") or (manner.later or 0) < 0:
        return
    op: Fields = {"op": "follow", "target": clause.target, "leader": leader, "how": "along" if with_it else "behind"}
    yield Command(({**op, "seconds": manner.later} if manner.later else op,))


def parted(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    """ "the ball should roll only two metres", "stop the robot halfway"."""
    if clause.negated or clause.aspect not in ("", "event") or not moment.empty or _LONGER & set(clause.tail):
        return
    moves = clause.sense in ("go", "move", "fall", "stop") and not clause.kept
    named = any(singular(w) in _HUNG for w in clause.target.text.split()) or clause.target.last
    if not moves or named or manner.by or not (manner.only("share", "far", "percent") or manner.only("length", "far")):
        return
    if clause.ordered and clause.sense == "move":
        return  # "move it 2 m"
    share = manner.share if manner.share is not None else manner.percent
    if share is None and manner.far and manner.length is None:
        return
    if share is not None and 0 < share < 1 and (manner.far or clause.sense == "stop" or manner.halfway):
        yield pace(clause.target, "part", share=share)
    elif manner.length is not None and not clause.ordered:
        yield pace(clause.target, "part", distance=manner.length)


def repeated(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    """ "repeat the drawer's movement twice", "let the ball roll back and forth"."""
    if clause.negated or not moment.empty or clause.kept:
        return
    count = manner.times if manner.times is not None else manner.turns
    if count is not None and (count != int(count) or count < 1):
        return
    more: Fields = {"times": int(count)} if count else {}
    forth = manner.forth and clause.sense in (*MOTION, "be", "play", "do", "repeat")
    if forth and manner.only("forth", "times", "turns", "endless", "looping"):
        yield pace(clause.target, "back_and_forth", **more)
        return
    loops = clause.sense == "repeat" or (manner.looping and clause.sense in (*MOTION, "be", "play", "do"))
    if loops and manner.only("looping", "times", "turns", "endless", "doing"):
        again = clause.sense == "repeat" and "times" in more and clause.verb and clause.verb.first == "repeat"
        more = {"times": more["times"] + 1} if again else more  # "repeat it once" is twice in all
        yield pace(clause.target, "repeat", **more)


def once_more(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    """ "let the red book fall again at 3 s": the same movement a second time."""
    again = re.search(r"\b(?:again|once more|one more time|a second time|another time)\b", " ".join(clause.tail))
    moves = clause.sense in ("fall", "go", "bob", "rise", "sink") or (clause.sense == "do" and clause.aspect == "event")
    if again and moves and moment.start is not None and not clause.negated and manner.only("turns", "times"):
        yield pace(clause.target, "repeat", times=1)


def mirrored(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    """ "the robot turns right instead of left"."""
    if clause.sense == "spin" and manner.instead and not clause.negated and manner.only("instead"):
        turns = any(singular(w) in _TURNING for w in clause.target.text.split())
        if not turns:
            yield pace(clause.target, "mirror")


def blinked(clause: Clause, manner: Manner, moment: Moment) -> Iterator[Command]:
    """ "the lamp blinks three times"."""
    if clause.verb is None or clause.negated or clause.sense != "blink" or not manner.only("times", "rate", "turns"):
        return
    yield plain(clause, "look", "hide {}", **blinking(manner, moment))


def blinking(manner: Manner, moment: Moment) -> Fields:
    """How often something comes and goes, as fields of `Command`."""
    count = manner.times if manner.times is not None else manner.turns
    period = 1 / manner.rate if manner.rate else _BLINK
    lasting = moment.lasting
    if lasting is None and isinstance(moment.stop, float) and moment.stop > 0:
        lasting = moment.stop - (moment.start if isinstance(moment.start, float) else 0.0)
    if count and lasting:
        period = lasting / count
    return {"every": period, "blinks": int(count) if count and not lasting else 0}


# -- several things ----------------------------------------------------------------------------------------------------

_VERBS = any_of((*MOTION, "start"), "plain", "s", "ing")
_MODAL = r"(?:(?:all|should|must|shall|may|can|will|are to|have to|need to|ought to|both) )*"
_LED = r"(?:(?:let|make|have|get) )?"
_STARTING = rf"(?:{_VERBS}(?: (?:to|off|out|down|over|moving|falling))*)"
_TIMING = (
    r"(?:(?:start(?:ing)?|begin(?:ning)?) times?|timings?|times?|turns|order|starts?|moments?|falls?|drops?|movements?|"
    r"motions?|sequence)"
)
_REVERSED = re.compile(
    rf"^{_LED}(?P<np>.+?) {_MODAL}{_STARTING} (?:,? ?but )?(?:in (?:the |an )?(?:reversed?|opposite|inverse|"
    rf"inverted|other|"
    r"contrary) (?:order|sequence)|the other way (?:round|around) in order|in order from (?:last to first|back to "
    r"front)"
    r"|last one first|last to first)$|"
    rf"^(?:reverse|invert|flip|turn around|switch|change|swap) the (?:order|sequence) (?:of|in which) (?:the "
    rf"fall(?:s|ing)? of )?"
    rf"(?P<of>.+?)(?: {_STARTING})?(?: around| round)?$"
)
_SWAPPED = re.compile(
    rf"^(?:swap|exchange|switch|interchange|trade)(?: around| round)? (?:the )?(?:{_TIMING} (?:of|for|at which|when) )?"
    rf"(?P<a>.+?)(?: 's)? (?:and|with|for) (?P<b>.+?)(?: 's)? ?(?P<t>(?:{_TIMING} )?{_TIMING}|{_STARTING})?(?: "
    rf"(?:in time|around|round))?$|"
    rf"^{_LED}(?P<c>.+?) and (?P<d>.+?) {_MODAL}(?:swap|exchange|switch|trade)(?: (?:their|the))? "
    rf"(?P<u>{_TIMING})(?: {_TIMING})?$"
)
_APART = re.compile(
    rf"^{_LED}(?P<np>.+?) {_MODAL}{_STARTING} (?:one (?:after|by) (?:another|one|the other) ?,? ?)?"
    rf"(?:(?:with )?(?:exactly |always )?(?P<d>{DURATION}) (?:apart|between (?:them|each|one and the next|the \w+)|"
    rf"after (?:each other|one "
    rf"another|the other)|in between|from each other)|(?:at|in) (?:intervals of )?(?P<e>{DURATION}) intervals?|at "
    rf"intervals of "
    rf"(?P<f>{DURATION})|every (?P<g>{DURATION})|with (?:a (?:gap|pause|delay|break) of )?(?P<h>{DURATION}) (?:of )?"
    rf"(?:between (?:them|each)|gaps?|in between|breaks?|pauses?))(?: ,? ?one (?:after|by) (?:another|one))?$"
)
_TOGETHER = re.compile(
    rf"^{_LED}(?P<np>.+?) {_MODAL}{_STARTING} (?:all )?(?:at (?:exactly )?(?:the )?(?:same|one) (?:time|moment|"
    rf"instant)|at once|"
    r"together|simultaneously|all together|in one go|in unison|as one|in sync)$|"
    r"^(?:drop|start|launch|release) (?P<of>(?:all|both|the|every) .+?) (?:all )?(?:at (?:exactly )?the same (?:time|"
    r"moment|instant)|at once|together|simultaneously|in one go)$"
)
_LIKE = re.compile(
    rf"^{_LED}(?P<a>.+?) {_MODAL}{_STARTING} (?:together|at (?:exactly )?the same (?:time|moment)|simultaneously|in "
    rf"sync) "
    rf"(?:with|as) (?P<b>.+?)(?: (?:does|{_STARTING}))?$"
)
_BEFORE = re.compile(
    rf"^{_LED}(?P<a>.+?) {_MODAL}{_STARTING} (?P<w>before|ahead of) (?P<b>.+?)(?: (?:does|do|{_STARTING}))?$"
)
_FIRST = re.compile(rf"^{_LED}(?P<a>.+?) {_MODAL}(?:be the first (?:one )?to {_VERBS}|{_STARTING} (?:first|as the "
 rf"first(?: one)?|before (?:all )?the "
                    r"others?(?: (?:ones?|books?|things?))?))$")  # fmt: skip
_LISTED = (
    re.compile(rf"^{_LED}(?P<np>.+?) {_MODAL}{_STARTING} in (?:the |this |that |another |a different )?(?:following "
     rf")?order ?[:,]? ?(?P<list>.+)$"),
    re.compile(rf"^(?:first )?{_LED}(?P<list>.+? , ?(?:and )?then .+?|.+? , .+? (?:,|and|then) .+?)(?: "
     rf"{_MODAL}{_STARTING})?$"),
    re.compile(r"^(?:make |let )?the order (?:of (?:the )?[a-z]+ )?(?:should be |is |be |: )?(?P<list>.+)$"),
)  # fmt: skip
_NEXT = re.compile(
    r"(?: ,)?(?: (?:and|then|next|after that|afterwards|finally|last(?:ly)?|followed by))+ | , | - > | > "
)


def ordered(said: str, thing: Thing, moment: Moment) -> Iterator[Command]:
    """Which of several things moves when: "let the books fall in the opposite order"."""
    if (found := _REVERSED.match(said)) is not None:
        yield from _order(thing(_plural_of(found["np"] or found["of"])), "reversed")
    if (found := _SWAPPED.match(said)) is not None and (
        found["t"] or found["u"] or " times" in said or "timing" in said
    ):
        pair = [thing(_one(n)) or thing(f"{_one(n)} one") for n in (found["a"] or found["c"], found["b"] or found["d"])]
        if pair[0] is not None and pair[1] is not None:
            yield from _order(_both(_named_like(pair[0], pair[1]), pair[1]), "reversed")
    if (found := _APART.match(said)) is not None:
        text = next(found[k] for k in "defgh" if found[k] is not None)
        if (gap := seconds_of(text)) is not None:
            yield from _order(thing(_plural_of(found["np"])), "kept", gap=gap)
    if moment.empty and (found := _TOGETHER.match(said)) is not None:
        yield from _order(thing(_plural_of(found["np"] or found["of"])), "together")
    if moment.empty and (found := _LIKE.match(said)) is not None:
        one, other = thing(found["a"]), thing(found["b"]) or thing(f"{_one(found['b'])} one")
        if one is not None and other is not None and one.pick != "all":
            during = {"state": "moving", "of": _named_like(other, one), "part": "from"}
            yield replace(pace(one, "begin"), during=during)
    if moment.empty and (found := _BEFORE.match(said)) is not None:
        one, other = thing(found["a"]), thing(found["b"]) or thing(f"{_one(found['b'])} one")
        if one is not None and other is not None and not one.last and not other.last:
            other = _named_like(other, one)
            yield from _order(_both(one, other), "listed", first=(one, other))
    if moment.empty and (found := _FIRST.match(said)) is not None:
        one = thing(found["a"])
        if one is not None and not one.last and one.pick != "all":
            yield from _order(MOVING, "listed", first=(one,))
    yield from _listed(said, thing)
    yield from _ranked(said, thing)


_RANK = re.compile(
    rf"^(?:and |then |with |but )*(?P<np>.+?) ?,? ?(?:(?:is|are|be|being|goes?|comes?) )?(?:to )?{_MODAL}(?:{_VERBS} )?"
    r"(?:the |as |as the |coming |going )*"
    r"(?P<rank>first|second|third|fourth|next|last|in the middle|in between|at the end|finally)$"
)
_RANKS = {"first": 1, "second": 2, "next": 2, "in the middle": 2, "in between": 2, "third": 3, "fourth": 4, "last": 9,
          "at the end": 9, "finally": 9}  # fmt: skip
_OF_ORDER = re.compile(
    r"^(?:flip|reverse|change|swap|switch|turn around|mix up|set|make) the order"
    r"(?: of (?:the )?[a-z]+| in which [a-z ]+?)? (?=(?:the )?[a-z]+(?: [a-z]+)? first\b)"
)


def _ranked(said: str, thing: Thing) -> Iterator[Command]:
    """ "the blue book is to fall first and the red one last, with the green in the middle"."""
    said = re.sub(rf"^{_LED}", "", _OF_ORDER.sub("", said))
    said = re.sub(r"^(?:the )?(?:other|opposite) way (?:about|round|around)(?: please)? [:,]? ?", "", said)
    parts = [p.strip(" ,") for p in re.split(r" , | and (?=(?:the )?[a-z]+(?: one)? )|(?: then| with)(?= )", said)]
    found = [(_RANK.match(p), p) for p in parts if p]
    if sum(rank is not None for rank, _ in found) < 2:
        return
    places = [_RANKS[rank["rank"]] if rank is not None else i + 1 for i, (rank, _) in enumerate(found)]
    placed = sorted(zip(places, found, strict=True), key=itemgetter(0))
    ranked = [rank["np"] if rank is not None else p for _, (rank, p) in placed]
    ranked = [re.sub(r"^(?:(?:and|then|next|after that|finally|lastly) )+", "", name) for name in ranked]
    names = [_one(re.sub(r" (?:should|to|must|is|are|will|can)$", "", name)) for name in ranked]
    read = [thing(n) or thing(f"{n} one") for n in names]
    queries = [q for q in read if q is not None and not q.last and q.pick != "all"]
    if len(queries) != len(ranked):
        return
    text = next((q.text for q in queries if q.text and q.text != "one"), "")
    named = tuple(q if q.text and q.text != "one" else q.model_copy(update={"text": text}) for q in queries)
    yield from _order(MOVING, "listed", first=named)


def _listed(said: str, thing: Thing) -> Iterator[Command]:
    """ "first blue, then green, then red"."""
    for pattern in _LISTED:
        if (found := pattern.match(said)) is None:
            continue
        names = [n.strip(" ,:") for n in _NEXT.split(re.sub(r"^first ", "", found["list"].strip(" ,:")))]
        names = [
            re.sub(rf"^(?:the )?(?:first|last(?:ly)?) (?=the )|(?: (?:first|{_MODAL}{_VERBS}|last|at last))+$", "", n)
            for n in names
            if n
        ]
        read = [thing(n if n.startswith("the ") else f"the {n}") or thing(f"the {n} one") for n in names]
        if len(read) < 2 or any(q is None or q.last or q.pick == "all" for q in read):
            continue
        queries = [q for q in read if q is not None]
        text = next((q.text for q in queries if q.text), "")
        named = tuple(q if q.text else q.model_copy(update={"text": text}) for q in queries)
        whole = thing(_plural_of(found["np"])) if "np" in found.re.groupindex else None
        yield from _order(whole if whole is not None and not whole.last else MOVING, "listed", first=named)


def _order(target: Query | None, order: str, **more: object) -> Iterator[Command]:
    if target is not None and not target.last:
        yield Command(({"op": "order", "target": target, "order": order, **more},))


def _plural_of(said: str) -> str:
    said = re.sub(r" (?:all|both)$", "", said.strip(" ,"))
    return "everything that moves" if said in ("them", "they", "it", "these", "those", "everything", "things") else said


def _one(said: str) -> str:
    return re.sub(r"^(?:the )?", "the ", said.strip())


def _named_like(one: Query, other: Query) -> Query:
    """A thing of which only the colour is said, with the name of the other: "the red and the blue book"."""
    return one if one.text not in ("", "one") or not other.text else one.model_copy(update={"text": other.text})


def _both(one: Query, other: Query) -> Query:
    return one.model_copy(update={"also": (*one.also, other)})
