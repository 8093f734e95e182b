"""Times told by what happens: "while it is on the rug", "once the fan stops", "until the ball reaches the wall".

A clause is cut out of the words of a sentence if the whole of it says that something is so, begins or ends.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ....gaussians.world.words import plural, singular
from ....tools.when import ALONE, During, Part
from . import manner as manners
from .clauses import Clause, owner, told
from .manner import MOTION, Manner, Thing

IT = Query(last=True)
_ITSELF = re.compile(r"\b(?:it|him|her)self\b")


@dataclass(frozen=True)
class Happening:
    """What is told of, and the words of the clause.

    Attributes:
        during: with `of` as it was said; `IT` for a pronoun.
        said: the clause.
        until: what ends the time that begins then; None if nothing is said to.
        from_start: whether a time that it ends begins at a moment told in numbers.
    """

    during: During
    said: str
    until: During | None = None
    from_start: bool = False

    def ended(self, other: Happening) -> Happening | None:
        """This with what ends the time that it begins; None if one of both does not begin or end a time."""
        if self.during.part not in ("from", "after", "while") or other.during.part not in ("until", "until_end"):
            return None
        during, until = self.during, other.during
        if during.anchors and IT in until.anchors:  # "once it hits the floor, until it rolls off it"
            until = until.model_copy(update={"anchors": during.anchors})
        if during.state in ("open", "opening", "fully_open") and until.state == "moving" and " back" in other.said:
            until = until.model_copy(update={"state": "closing"})
        itself = _ITSELF.search(other.said) is not None  # the thing that is changed
        if until.of == IT and during.of not in (None, IT) and not itself:
            until = until.model_copy(update={"of": during.of})
        elif during.of == IT and until.of not in (None, IT):
            during = during.model_copy(update={"of": until.of})  # "after the turn and until the robot stops"
        return replace(self, during=during, until=until)


@dataclass(frozen=True)
class _Course:
    """Which part of the time a state stands for, by the conjunction before it."""

    once: Part  # "when", "once"
    through: Part  # "while"
    before: Part  # "until" and "before"
    after: Part = "after"


_EVENT = _Course("from", "while", "until", "after")  # "it moves"
_LASTS = _Course("while", "while", "until", "after")  # "it is moving"
_BEGINS = _Course("from", "from", "until", "from")
_ENDED = _Course("after", "after", "until_end", "after")  # "it has moved"
_SHUTS = _Course("after", "while", "until", "after")  # "it shuts"
_HAS_SHUT = _Course("after", "after", "until_end", "after")  # "it has shut"
_HOLDS = _Course("while", "while", "until", "from")  # "it is open"
_LACKS = _Course("unless", "unless", "until_end", "after")  # "it is closed"
_COMES = _Course("from", "while", "until", "from")  # "it hits the wall"

_ONCE = (
    r"(?:(?:right |just )as|(?:on|at|from|with) the (?:very |exact |same )?(?:frame|point|instant|moment|time) "
    r"(?:where|when|that|(?:at|in|on) which)|(?:on|from) the (?:very |exact |same )?frame"
    r"(?= (?:the|my|our|it|he|she|they) )|"
    r"the (?:very |exact )?(?:moment|point|instant|second) (?:when|where|that)|"
    r"once(?! (?:on|in|at|around|round|to|from|over|about|every|per|each) )|when|as soon as|the moment|"
    r"the instant|the second|the sec(?= (?:the|my|our|it|he|she|they) )|at the moment when|at the moment|"
    r"immediately when|right when|from when|from the moment|"
    r"exactly when|directly when|immediately(?= the )|directly(?= the )|the minute|each time|every time|"
    r"from the time)"
)
_WHILE = (
    r"(?:while|whilst|as long as|so long as|whenever|during the time|for as long as|the whole time|all the time|as|"
    r"during|"
    r"for the duration of|throughout|in the course of|for the time)"
)
_AFTER = r"(?:(?:right |just |only |directly |immediately |shortly )?(?:after|following))"
_UNTIL = (
    r"(?:until|till|til|untill|up until|up to when|before|by the time|right before|just before|right until|"
    r"only until|"
    r"prior to)"
)
CONJUNCTION = re.compile(
    rf"(?:^|(?<= ))(?:only |but only |just )?(?P<word>{_ONCE}|{_WHILE}|{_AFTER}|{_UNTIL})(?: that)?(?= )"
)
_PRONOUNS = ("it", "he", "she", "they", "that", "this")
_PEOPLE = re.compile(r"^(?:i|we|you|people|guests?|everyone|someone|somebody|my .*|anyone|nobody|there)\b")
_RELATIONS = {
    "on": "on top of|on|upon|over|across|along|above|onto|on to", "inside": "inside of|inside|within|in|into",
    "under": "underneath|beneath|under|below", "next_to": "next to|beside|close to|near to|near|by|alongside|around",
    "behind": "behind|in back of", "in_front_of": "in front of|before",
}  # fmt: skip
_RELATED = {said: relation for relation, phrases in _RELATIONS.items() for said in phrases.split("|")}
_TO = ("to", "up to", "over to", "against", "as far as", "across to", "back to", "at")
_DONE = re.compile(
    r"(?:\b(?:is|has|are|have|gets)|'s) (?:all )?(?:done|finished|through) (?:with )?(?:its |his |the )?[a-z]+ing$"
)
_UNDER_WAY = re.compile(
    r"(?: (?:is|are)|'s) (?:still |up )*(?:in (?:the air|mid ?air|flight|motion|transit)|airborne|under way|"
    r"(?:on (?:its|his|her|their|the) way|heading)(?: down| up| back)?(?: (?:to|towards?|for) (?:the|its|"
    r"my) [a-z ]+)?)"
    r"$"
)
_USUALLY = re.compile(r" (?:would |will |does )?(?:normally|usually|ordinarily) (?=[a-z])")
_THEY_ALL = re.compile(
    r"(?:all|both)(?: of (?:them|these|those)| (?:the )?(?:two|three|four|five))|they (?:have )?all|all of it|both"
)
_HALF = re.compile(
    r"^(?P<who>.+?) (?:is|has come|has gone|comes|gets|goes|has) half(?: ?way)? "
    r"(?:open|out|closed|shut|in|up|down|done|through|there)$"
)
_DRAWN = re.compile(
    r"^(?P<who>(?:.+ )?drawer|it) (?:is|'s) (?:going|coming|sliding|moving|pulling|gliding) (?:back )?(?P<way>out|"
    r"in)$"
)
_EVENT_OVER = re.compile(
    r"^(?:the|its|his|her) (?P<event>motion|movement|walk|roll|fall|drop|swing|ride|flight|turn|slide|run|spin)"
    r"(?: of (?P<who>.+?))? (?:is|has) (?:over|done|ended|finished|completed?)$"
)
_TURN_DONE = re.compile(
    r"(?: (?:is|has|are|have|gets)|'s) (?:all )?(?:done|finished|through|over|completed) (?:with )?(?:its|his|her|"
    r"the) "
    r"(?:left |right )?turn(?:ing)?$"
)
_IS_SHUT = re.compile(  # which is no closing
    r"^(?P<who>.+?) (?:is|are|'s|stays?|remains?|stands?|sits?|lies?) (?:(?:still|fully|completely|all) )*"
    r"(?:closed|shut)$"
)
_AT_TURN = re.compile(
    r"^(?P<who>.+?) (?:begins|starts|gets to|reaches|comes to|arrives at|makes|takes|does|is at|"
    r"has (?:taken|made|done)|turns|rounds|goes (?:a)?round|has "
    r"turned|has rounded|has reached) (?:(?:its|his|her|the|that) (?:left |right |sharp )?"
    r"(?:turn|turning point|corner|bend|curve)|(?:to )?where (?:it|he|she) (?:turns|makes (?:its|his|her|the) turn))$"
)
_AT_REST = re.compile(
    r" (?:has |is )?(?:come|comes|coming) to (?:a |its )?(?:rest|stop|halt|standstill)"
    r"(?: (?:against|at|by|near|on|in|beside) (?:the|its|his|her) [a-z ]+)?$"
)
_HAS_HIT = re.compile(r" is (?P<done>hit|left|reached|touched|crossed|entered)(?= (?:the|its|his|her|my|that) )")
_IS_BACK = re.compile(
    r" (?:is|gets|has got|comes|has come) back(?: in)?"
    r"(?: (?:in|at|on|to) (?:its|his|her|the) (?:old )?(?:place|spot|home))?$"
)
_IS_THERE = re.compile(r" (?:gets|has got|is|arrives|has arrived|comes|has come) there$")
_WHOLLY = re.compile(r"\b(?:totally|completely|entirely|wholly|all(?= (?:open|out|shut|closed)\b))\b")
_LEG = r"(?:first|second|last|other|next) (?:part|half|leg|bit|stretch|section|stage)"  # of a way
_A_LEG = re.compile(rf".*\b{_LEG}$|(?:the|its|his|her) {_LEG}\b")
_FULLY = re.compile(r"\b(?:full|fully|completely|all the way|wide|entirely|totally)\b")
_IN_THE_FLOOR = re.compile(r"\bin(?= the (?:floor|ground|rug|carpet|mat)\b)")
_NEXT = ("touching", "in contact with", "resting against")


def clause_of(word: str, said: str, thing: Thing) -> During | None:
    """What a clause behind a conjunction tells of; None if the whole of it is not understood."""
    if _PEOPLE.match(said) or _A_LEG.match(said) or " , then " in said:
        return None
    said = _WHOLLY.sub("fully", _IN_THE_FLOOR.sub("on", said))
    said = _TURN_DONE.sub(" has turned", said)
    said = _USUALLY.sub(" ", _UNDER_WAY.sub(" is moving", _DONE.sub("has stopped", said)))
    said = _AT_REST.sub(" has stopped", said)
    said = _HAS_HIT.sub(r" has \g<done>", _IS_BACK.sub(" has stopped", _IS_THERE.sub(" has stopped", said)))
    if (over := _EVENT_OVER.match(said)) is not None:
        said = f"{over['who'] or 'it'} has {'turned' if over['event'] == 'turn' else 'stopped'}"
    if (half := _HALF.match(said)) is not None and (whose := _who(half["who"], thing)) is not None:
        return During(state="halfway", of=whose, part="until" if re.fullmatch(_UNTIL, word) else "from")
    if (way := _DRAWN.match(said)) is not None and (whose := _who(way["who"], thing)) is not None:
        return During(state="opening" if way["way"] == "out" else "closing", of=whose, part=_part(word, _LASTS))
    if (turn := _AT_TURN.match(said)) is not None and (whose := _who(turn["who"], thing)) is not None:
        return During(state="turning", of=whose, part=_part(word, _EVENT))

    shut = _IS_SHUT.match(said) if re.fullmatch(_WHILE, word) else None
    if shut is not None and (whose := _who(shut["who"], thing)) is not None:
        return During(state="open", of=whose, part="unless")

    def who(phrase: str) -> Query | None:
        return _who(phrase, thing)

    if word in ("each time", "every time") and (once := clause_of("once", said, thing)) is not None:
        return None if once.part == "after" else clause_of("when", said, thing)  # of several ends only one is known

    for clause in told(said.split(" "), who):
        for manner in manners.read(clause.tail, who):
            found = _state(clause, manner)
            if found is None:
                continue
            state, course = found
            if state == "touches" and re.fullmatch(_WHILE, word) and clause.sense in MOTION:
                state, course = "moving", _LASTS  # "while it walks over to the bed"
            if state == "closing" and course in (_SHUTS, _EVENT) and _FROM_THEN.match(word):
                course = _BEGINS  # "from the moment when it goes back in"
            anchors = (manner.whom,) if manner.whom is not None and state not in ALONE else ()
            part = _part(word, course)
            if state == "open" and not clause.negated and re.fullmatch(_AFTER, word):
                state = "fully_open"
            if (
                (state, part) == ("open", "unless")
                and re.fullmatch(_ONCE, word)
                and (word != "when" or _AGAIN.search(said))
            ):
                state, part = "closing", "after"  # "as soon as the top drawer is in again"
            if clause.negated:
                part = _NEGATED.get(part, part)
            return During(state=state, anchors=anchors, of=clause.target, part=part)
    return _touching(word, said, who) or _noun_event(word, said, who)


def _state(clause: Clause, manner: Manner) -> tuple[str, _Course] | None:
    """The state that a clause tells of."""
    sense, fields = clause.sense, manner.fields
    if sense == "close" and clause.form in ("s", "plain") and not clause.negated and manner.only("state", "back"):
        return "closing", _HAS_SHUT if {"has", "have", "is", "'s"} & set(clause.aux) else _SHUTS
    at_rest = sense in ("be", "stay") and manner.state == "still" and manner.whom is not None
    if at_rest and manner.only("state", "at", "whom", "goal"):
        return "moving", _ENDED  # "it is lying still at the wall"
    told = set(clause.aux)
    ended = clause.form == "past" and bool({"has", "have", "'s", "is", "are", "was", "were", "had"} & told)
    ended |= clause.form == "plain" and bool({"has", "have", "had"} & told)  # "it has come out"
    place = _RELATED.get(manner.at) if manner.whom is not None else None
    only_place = manner.only("goal", "at", "whom")
    if sense == "start" and manner.doing in ("open", "close") and manner.only("doing"):
        return ("opening" if manner.doing == "open" else "closing"), _BEGINS
    if ended and sense in MOTION and sense not in ("open", "close") and manner.only("state", "back"):
        if manner.state == "open":
            return "fully_open", _COMES  # "it has come all the way out"
        if manner.state == "closed":
            return "closing", _HAS_SHUT
    slides = manner.doing == "move" and manner.state in ("open", "closed") and manner.only("doing", "state", "back")
    if sense == "start" and slides:  # "it starts sliding back in"
        return ("opening" if manner.state == "open" else "closing"), _BEGINS
    if sense == "start" and manner.only("doing"):
        if {"turn", "turning"} & set(clause.tail):
            return "turning", _BEGINS
        return ("falling" if manner.doing == "fall" else "moving"), _BEGINS
    if sense in ("stop", "arrive", "close") and manner.only("doing", "state") and (sense != "close" or ended):
        return ("closing" if sense == "close" else "moving"), _ENDED
    if sense in ("be", "stay", "look", "stop") and fields == {"state"}:
        if manner.state == "open":
            stands = sense == "stay" or (clause.verb is not None and clause.verb.first == "stand")
            fully = stands or _FULLY.search(" ".join(clause.tail)) is not None or "out" in clause.tail
            return ("fully_open" if fully else "open"), _HOLDS
        states: dict[str, tuple[str, _Course]] = {
            "closed": ("open", _LACKS),
            "still": ("still", _HOLDS),
            "moving": ("moving", _LASTS),
            "off": ("moving", _ENDED),
        }
        return states.get(manner.state)
    if sense == "be" and manner.only("doing") and manner.doing:
        return ("falling" if manner.doing == "fall" else "moving"), _LASTS
    if sense == "be" and manner.way == "down" and fields == {"way"}:
        return "moving", _ENDED
    if sense == "leave" and only_place and place is None and not fields:
        return "moving", _BEGINS
    if manner.whom is not None and only_place and sense in (*MOTION, "be") and not clause.negated:
        if manner.at in _TO:
            return "touches", _COMES
        if manner.at in ("off", "out of", "away from"):
            return "on", _ENDED
    if place is not None and only_place and sense in ("be", "stay", *MOTION, "stop"):
        if sense == "stop":
            return "moving", _ENDED  # "when it stops next to the bed"
        if ended:
            return place, _COMES
        if manner.at in ("onto", "on to", "into"):
            return place, _COMES
        return place, _HOLDS
    if (
        sense in MOTION
        and manner.only("way", "back", "goal", "at", "whom", "origin", "endless", "state", "degrees")
        and not place
    ):
        if manner.state == "still":
            return "moving", _ENDED  # "it goes still"
        own = "falling" if sense == "fall" and not ended else _GOINGS.get(sense, "moving")
        if clause.verb is not None and clause.verb.first == "turn":
            own = "turning"
        full = _FULLY.search(" ".join(clause.tail)) is not None and sense == "open"
        return own, _ENDED if ended or full else _LASTS if clause.form == "ing" else _EVENT
    return None


_GOINGS = {"open": "opening", "close": "closing"}
_WITH_OBJECT: dict[str, tuple[str, _Course]] = {
    "leave": ("on", _ENDED), "enter": ("on", _COMES), "cross": ("on", _LASTS), "reach": ("touches", _COMES),
}  # fmt: skip


def _touching(word: str, said: str, who: Thing) -> During | None:
    """What one thing does to another: "it hits the wall", "it has left the rug", "it is touching the box"."""
    said = re.sub(r"\bin contact with\b", "touching", said)
    said = re.sub(r"\bno longer (?:on|in|touching|touches)\b", "leaves", said)
    for clause in told(said.split(" "), who):
        known = _WITH_OBJECT.get(clause.sense)
        whom = who(" ".join(clause.tail)) if known is not None and clause.tail else None
        if known is None or whom is None:
            continue
        state, course = known
        if clause.form == "ing" and clause.sense == "reach":
            course = _LASTS
        part = _part(word, course)
        if clause.negated:
            part = _NEGATED.get(part, part)
        return During(state=state, anchors=(whom,), of=clause.target, part=part)
    return None


_EVENTS = {
    "turn": "turning", "curve": "turning", "bend": "turning", "fall": "falling", "drop": "falling",
}  # fmt: skip


def _noun_event(word: str, said: str, who: Thing) -> During | None:
    """ "after the turn", "during the fall of the book", "for the duration of the door swing"."""
    noun = re.match(r"^(?:the|its|his|that|this|their) (?P<event>[a-z]+)$", said)
    found = owner(said, who)
    if found is None or found[1] not in ("event", "way"):
        return None
    event = noun["event"] if noun is not None else next((w for w in said.split() if w in _EVENTS), "")
    of = IT if noun is not None else found[0]
    part: Part = "after" if re.fullmatch(_AFTER, word) else "until" if re.fullmatch(_UNTIL, word) else "while"
    return During(state=_EVENTS.get(event, "moving"), of=of, part=part)


def _part(word: str, course: _Course) -> Part:
    if re.fullmatch(_UNTIL, word):
        return course.before
    if re.fullmatch(_AFTER, word):
        return course.after
    if word == "when":
        return course.once
    if re.fullmatch(_ONCE, word):
        return "from" if course.once == "while" else course.once
    return course.through


_AGAIN = re.compile(r"\b(?:again|back)\b")
_NEGATED: dict[Part, Part] = {"while": "unless", "from": "after", "until": "after"}  # "once it is not turning"
_FROM_THEN = re.compile(r"from |the (?:very |exact )?(?:moment|instant|second)")
_ONE_OF = re.compile(
    r"^(?:the )?(?P<rank>first|last)(?: one)? of (?:the|those|these|all|all the)(?: two| three| four)? "
    r"(?P<noun>[a-z]+)$"
)


def _who(said: str, thing: Thing) -> Query | None:
    said = re.sub(
        r" (?:itself|finally|then|just|both|all|also|actually|again|already|there|completely)$", "", said.strip()
    )
    said = re.sub(r"^(?:only|just|exactly|right) ", "", said)
    if said in _PRONOUNS:
        return IT
    if _THEY_ALL.fullmatch(said):
        return thing("everything that moves")
    if not said or len(said.split()) > 7 or _PEOPLE.match(said):
        return None
    said = _ONE_OF.sub(lambda m: f"the {m['rank']} {singular(m['noun'])}", said)
    if (first := re.match(r"^(?:the )?(?:first|last|other) (?=\w)", said)) is not None:
        noun = said[first.end() :]
        place = "last" if "last" in first[0] else "first" if "first" in first[0] else ""
        if noun != "one" and place and (one := thing(f"the {noun} that moves {place}")) is not None:
            return one
        return IT if noun == "one" else thing(f"all {noun if noun.endswith('s') else plural(noun)}")
    return thing(said)


def cut(said: str, thing: Thing) -> Iterator[tuple[str, Happening]]:
    """The words of a sentence without a clause that tells a time, and what it tells; the likeliest first."""
    for found in reversed(list(CONJUNCTION.finditer(said))):
        word, start = found["word"], found.start()
        words = said[found.end() :].strip().split(" ")
        for end in _ends(words, bool(said[:start].strip(" ,"))):
            clause = " ".join(words[:end]).strip(" ,.")
            during = clause_of(word, clause, thing) if clause else None
            if during is None:
                continue
            left, right = said[:start].strip(" ,"), " ".join(words[end:]).strip(" ,.")
            if _A_LEG.match(right):
                continue  # "when it has finished the first part"
            right = re.sub(r"^(?:then|,) ", "", right) if not left else right
            rest = f"{left} {right}".strip() if not left or not right else f"{left} , {right}"
            if rest:
                yield rest, Happening(during, f"{word} {clause}")


def _ends(words: list[str], trailing: bool) -> list[int]:
    """Where a clause may end: at the end, at a comma or a joint; without one before any word where it leads."""
    marks = [i for i, w in enumerate(words) if w in (",", "then", ".", "and", "but")]
    if trailing:
        return [len(words), *marks[::-1]]
    first = [i for i in marks if i > 1]
    return [*first, *[i for i in range(len(words) - 1, 1, -1) if i not in marks]]
