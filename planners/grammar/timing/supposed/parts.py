"""An instruction divided by marks: what it is about, where that goes, when, and what asks for nothing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from pydantic import BaseModel

from .....gaussians import late_re as re
from .....gaussians.language.query.query import Query
from .....gaussians.world.words import singular
from .....tools.when import During, Part
from ...learned.marks import Span
from ...learned.seen import hues
from ...tagging.spelling import is_word
from ...tagging.words import bag
from ...vocabulary.nouns import is_known
from ...vocabulary.quantities import NUMBERS, ORDINALS
from ..command import Fields
from ..happenings import CONJUNCTION, IT, Happening, clause_of
from ..happenings import cut as happenings_in
from ..manner import Thing
from ..moments import DURATION, TIMED, End, Moment, cut, seconds_of
from ..restated.restating import restated
from ..verbs import SENSES, has_form
from .choosing import says_plainly
from .kinds import is_any_word, marked
from .names import named as names_in
from .names import with_moving
from .orders import listed
from .said import BEFORE_IT, Said

TIMES = {"from": "when", "to": "until", "in": "while", "for": "for"}  # tags of times, and how such a time is begun
_IDLE = ("not", "off")  # tags of words that ask for nothing
_LEADING = re.compile(
    r"^(?:(?:,|and|then|but|just|only|right|exactly|about|around|starting|beginning|start|begin|finish(?:ed|ing)?|done|"
    r"ending|end|arriving|being|be|there|taking|takes?|lasting|lasts?) (?=\w))*"
)
_BARE = re.compile(
    r"^(?:(?:by|at|on|from|in|to|till|until|after|before|up|for|over|within|during|the|only|just|about|around|exactly|"
    r"say|like|mark|starting|beginning|finished|done|,) )*(?P<value>.+?)(?: (?:mark|on|onwards?|already|sharp|flat|in|"
    r"long|exactly|precisely|or so))*$"
)
_AS = re.compile(
    r"^(?:all the while|the whole time(?: that)?|(?:for|in|during) (?:the|that) (?:time|bit|part|stretch|moments?|"
    r"seconds|period|phase)(?: (?:that|where|when|in which|during which))?) (?=\w)"
)
_FROM_EVENT = re.compile(
    r"^(?:from|starting (?:from|with)|with|at) (?:the|its|his|her) (?P<event>turn|fall|drop)(?: on(?:wards?)?)?$"
)
_GERUND = re.compile(r"^(?P<word>after|once|when|while|before|until) (?P<doing>[a-z]+ing)(?= |$)")
_WHERE = re.compile(r"^(?:right |just |exactly )?(?:at )?(?:the (?:point|place|spot|corner) )?(?:where|upon) (?=\w)")
_WHERE_IN = re.compile(
    r"(?<!\bto )(?<!\bnear )\bwhere\b(?= (?:it|he|she|they|the) )(?! \w+ (?:is|are|was|were|stands?|sits?|lies?)\b)"
)
_ALL = re.compile(
    r"\b(?:whole|entire|throughout|all (?:the way )?through|over the length of|all the time|always|"
    r"(?:beginning|start) to (?:the )?(?:end|finish))\b"
)
_NAMED: tuple[tuple[re.Pattern[str], End], ...] = (
    (re.compile(r"\b(?:middle|half ?way|half time|midway|half the)\b"), "middle"),
    (
        re.compile(
            r"^(?:un)?till? the (?:very )?last (?:second|moment)$|\b(?:end|ends|finish|close|last frame|over|finale)\b"
        ),
        "end",
    ),
    (
        re.compile(
            r"\b(?:beginning|start|outset|first (?:frame|moment|second)|at once|immediately|straight away)\b|"
            r"\btop (?:of the (?:film|show|clip|video|scene|shot))?$"
        ),
        0.0,
    ),
)
_HALF = re.compile(r"\b(first|second|last|latter|other) half\b")
_UNTIL = re.compile(r"^(?:arriv|finish|ending|done|there |be there|complet|reach|all |over )")  # what it is until then
_LASTS = re.compile(r"^(?:and )?(?:tak(?:es?|ing)|last(?:s|ing)?)\b")  # how long it is said to take
_HALFWAY = re.compile(
    r"^(?:when |once |at |as soon as )?(?:(?P<who>.+?) (?:is|has (?:gone|got)|gets) )?"
    r"(?:half ?way|midway|half the way|in the middle of|(?:in )?mid (?:fall|air|flight|swing|walk|roll|turn))"
    r"(?P<way>(?: (?:down|up|through|there|across|along|over|to|into|out|open|of))* ?(?P<what>.*))$"
)
_ALONE = re.compile(r"^(?:at |from )?(?:half ?way|midway|half time)(?: through| in| point)*$")
_FILM = re.compile(r"\b(?:film|clip|video|movie|scene|shot|time|animation|footage|sequence)\b")
_BEFORE = re.compile(r"\b(?:not|never) (?:before|until|till|unless|if|when|while) \w+ \w+")  # that waits for something
_BESIDE = re.compile(  # "set off with the robot", "at the same time as the top one"
    r"^(?:at )?(?:just |right )?(?:the )?(?:same (?:time|moment) as|together with|along with|alongside|with) "
    r"(?P<who>(?:the|my|our|that) [a-z ]+?)(?: (?:does|moves|starts|sets off|opens|goes))?$"
)
_UNLESS = re.compile(r"\b(?:except|unless|apart from|only if)\b|\bif (?:it|he|she|they|the)\b")
_REVERTED = re.compile(  # ", and revert when it slides back"
    r"(?:(?: ,)?(?: (?:and|but|then))+| ,) (?:(?:it|let it|have it|should|to|make it) )*"
    r"(?:reverts?|[a-z]+ again|(?:goes|go|turns?|turning|changes?|turn it|put it|set it|change it|going) back|"
    r"returns?|back|normal)"
    r"(?: (?:again|to|as|its|the|his|her|normal|usual|old|original|own|before|it was|colou?r|look))* "
    r"(?P<then>(?:when|once|as soon as|after|at|by) .+)$"
)
_OFF_IT = re.compile(r"\b(?:it|he|she) (?:is|'s|has|gets|rolls|comes|moves|goes)(?: \w+)? off(?: it| again)?$")
_PRONOUN = re.compile(r"\b(?:it|him|her|them)\b")
_HOW_MANY = re.compile(  # ", all four of them"
    r"(?:all|both|each|every one)(?: (?:the )?(?:two|three|four|five|six))?(?: of (?:them|those|these))?"
)
_SO_THAT = re.compile(r"^(?:, )?(?:and )?so (?:that )?(?:it|he|she|they|we|i|you|people|everyone)\b")  # a reason
_AMOUNT = re.compile(r"\b(?:quarter|half|third|twice|double|triple|thrice|percent|faster|slower|backwards?|reverse)\b")
_CONTRAST = re.compile(r"\b(?:not|no|instead|rather|than|never|without|then|back|again|too)\b")
_ANOTHER = re.compile(r"^(?:, )?(?:and |but )?then\b|\botherwise\b")
_AS_IT_WAS = re.compile(r"\b(?:again|back|before|usual|normal|was|returns?|own|original|used to)\b")
_DELAY = re.compile(rf"^(?P<delay>{DURATION}|a (?:moment|bit)) (?=(?:after|once|when) )")


def divided(words: Sequence[str], spans: Sequence[Span], thing: Thing) -> tuple[Said, Happening | None] | None:
    """What an instruction says, and what happens at its time; None if a time in it is not understood.

    Args:
        words: those of the instruction.
        spans: the marks in them.
        thing: reads a name.
    """
    moment, spans = Moment(), [_with_half(words, _as_name(words, span, thing)) for span in spans]
    happening: Happening | None = None
    delayed, skipped = False, list[tuple[int, int]]()
    for tag, start, stop in spans:
        if tag not in TIMES:
            continue
        phrase = " ".join(words[start:stop]).strip(" ,.;:")
        begun = moment.start is not None or (happening is not None and happening.during.part != "until")
        if tag == "from" and begun and (gone := _gone_back(words, spans, start)) is not None:
            tag, skipped = "to", [*skipped, (gone, start)]
        if tag == "from" and _UNTIL.match(phrase):
            tag = "to"
        if tag in ("from", "to") and _LASTS.match(phrase):
            tag = "for"
        phrase = _LEADING.sub("", phrase)
        if (delay := _DELAY.match(phrase)) is not None and (seconds := seconds_of(delay["delay"])) is not None:
            phrase, moment, delayed = phrase[delay.end() :], replace(moment, start=seconds), True
        if (lain := _HAS_BEEN.match(phrase)) is not None and (seconds := seconds_of(lain["delay"])) is not None:
            phrase, moment, delayed = _so_far(lain), replace(moment, start=seconds), True
        if (given := _GIVEN.match(phrase)) is not None and (seconds := seconds_of(given["delay"])) is not None:
            phrase, moment, delayed = given["clause"], replace(moment, start=seconds), True
        if (told := _told(tag, phrase, thing)) is None:
            return None
        found, event = told
        if found is not None:
            if (both := _joined(moment, found)) is None:
                return None
            moment = both
        if event is not None:
            happening = event if happening is None else happening.ended(event) or event.ended(happening)
            if happening is None:
                return None
    if any(tag in _IDLE and _loses(tag, words[start:stop]) for tag, start, stop in spans):
        return None
    if any(tag == "off" and start and _is_odd(words[start:stop]) for tag, start, stop in spans):
        return None
    left = {at for tag, start, stop in spans if tag in TIMES or tag in _IDLE for at in range(start, stop)}
    left |= {at for start, stop in skipped for at in range(start, stop)}
    spans = [s for s in spans if s[0] in TIMES or not any(start <= s[1] < stop for start, stop in skipped)]
    again = [span for span in spans if span[0] == "x" and _HOW_MANY.fullmatch(" ".join(words[span[1] : span[2]]))]
    left |= {at for _, start, stop in again for at in range(start, stop)} if len(spans) > len(again) else set()
    spans = [span for span in spans if span not in again] if len(spans) > len(again) else spans
    text = " ".join(word for at, word in enumerate(words) if at not in left).strip(" ,.;:!")
    text = with_moving(re.sub(r"(?: [,.;:!])+(?= [,.;:!])", "", text))
    if isinstance(moment.stop, float):
        text = BEFORE_IT.sub(" ", text)
    amounts = {" ".join(words[start:stop]).strip(" ,.") for tag, start, stop in spans if tag == "by"}
    if happening is None:
        text, moment, happening = _with_unmarked(text, moment, thing, amounts)
    elif _begins(happening) and isinstance(moment.start, float) and not delayed:
        happening = None  # "after it has been opened, from 3.5 s on"
    looks = any(tag == "as" for tag, _, _ in spans) or says_plainly("hide", text)
    if looks and happening is not None and _begins(happening) and moment.stop is None:
        unwanted = [" ".join(words[start:stop]) for tag, start, stop in spans if tag == "not"]
        ended = _reverted(text, unwanted, moment, happening, thing)
        if ended is None:
            return None
        text, moment, happening = ended
    if happening is not None:
        text, words = _with_goal(text, words, spans, happening, thing)
    named = [(tag, _name(words, start, stop, thing)) for tag, start, stop in sorted(spans, key=lambda s: s[1])]
    goals = _things(named, "y", thing)
    things = _things(named, "x", thing) or tuple(name for name in names_in(text, thing) if name not in goals)[:1]
    if not things and happening is not None:  # "once the door has opened, shut it"
        idle_names = (names_in(" ".join(words[start:stop]), thing) for tag, start, stop in spans if tag in _IDLE)
        if any(idle_names) and _PRONOUN.search(text) is None:
            return None  # "that lamp would look so pretty ... in pink as long as the fan turns"
        things = names_in(happening.said, thing)[:1]
    goals = tuple(name for name in goals if name not in things)
    idle = " ".join(" ".join(words[start:stop]) for tag, start, stop in spans if tag in _IDLE)
    marks = {at for _, start, stop in spans for at in range(start, stop)}
    return Said(
        text, (*things, *goals), moment, happening is not None, thing, goals, idle,
        listed(words, spans, thing), " ".join(word for at, word in enumerate(words) if at not in marks),
    ), happening  # fmt: skip


def _so_far(found: re.Match[str]) -> str:
    """What was so for some time, as what begins it: "once it has been lying there" is once it has stopped."""
    state = found["state"].strip()
    if re.fullmatch(r"(?:lying|resting|sitting|standing|still|there|on|at|down)\b.*", state):
        return f"{found['who']} has stopped"
    return f"{found['who']} is {state}"


_GIVEN = re.compile(  # "once it is open give it a second"
    r"^(?P<clause>(?:once|when|after|as soon as) .+?) (?:give|allow|leave|wait)(?: it| him| her)? "
    rf"(?P<delay>{DURATION})$"
)
_HAS_BEEN = re.compile(
    r"^(?P<who>(?:once|after|when|as soon as|only after|from when) .+?) (?:has|have|is|'s|was|had) been "
    rf"(?P<state>[a-z ]+?)(?: for)? (?P<delay>{DURATION})$"
)


def _told(tag: str, phrase: str, thing: Thing) -> tuple[Moment | None, Happening | None] | None:
    """The time in numbers and what happens, either of which words with a tag may tell; None if they tell neither."""
    if tag == "in" and phrase.startswith("from ") and (ends := _from_until(phrase, thing)) is not None:
        return ends
    if (found := _moment(tag, phrase)) is not None:
        return found, None
    if (event := _event(tag, phrase, thing)) is not None:
        return None, event
    if (found := _named_moment(tag, phrase, thing)) is not None:
        return found, None
    return _from_until(phrase, thing) if tag in ("in", "from") else None


def _from_until(phrase: str, thing: Thing) -> tuple[Moment | None, Happening | None] | None:
    """As `_told`, of words with two ends: "from halfway through till the end", "from when it turns until it stops"."""
    begun = re.sub(r"^(?:from|between|in between) ", "", phrase)
    for joint in _JOINTS.finditer(begun):
        start = _told("from", begun[: joint.start()].strip(" ,"), thing)
        stop = _told("to", begun[joint.end() :].strip(" ,"), thing)
        if start is None or stop is None:
            continue
        (begins, happens), (ends, over) = start, stop
        if begins is None and ends is None and happens is not None and over is not None:
            both = happens.ended(over)
            return None if both is None else (None, both)
        if begins is not None and over is not None:
            return begins, replace(over, from_start=True)
        if happens is None and begins is not None and ends is not None:
            both_ends = _joined(begins, ends)
            return None if both_ends is None else (both_ends, None)
    return None


_JOINTS = re.compile(r"(?: ,)? (?:until|till|til|to|and|up to|through|-)(?= )")


def _with_goal(
    text: str, words: Sequence[str], spans: Sequence[Span], happening: Happening, thing: Thing
) -> tuple[str, Sequence[str]]:
    """A text and its words with what a pronoun for a goal means: "when the robot is there, roll the car over to it"."""
    goals = [
        start
        for tag, start, stop in spans
        if tag == "y" and stop == start + 1 and (words[start] == "there" or thing(words[start]) == IT)
    ]
    meant = names_in(happening.said, thing)
    meant = meant[-1:] if [words[at] for at in goals] == ["there"] else meant[:1]
    if len(goals) != 1 or not meant or not re.search(rf"\b{words[goals[0]]}(?: too| as well)?$", text):
        return text, words
    goal = meant[0] if words[goals[0]] != "there" else f"to {meant[0]}"
    text = re.sub(rf"\b{words[goals[0]]}(?: too| as well)?$", goal, text)
    return text, [meant[0] if at == goals[0] else word for at, word in enumerate(words)]


def _is_odd(words: Sequence[str]) -> bool:
    """Whether words that belong to the sentence hold one that is none: "around nothing blorp"."""
    if words[0] in ("so", "because", "as", "since", "for", "like", "if"):
        return False
    return words[0].isalpha() and any(word.isalpha() and not is_any_word(word) for word in words)


def _gone_back(words: Sequence[str], spans: Sequence[Span], start: int) -> int | None:
    """From where words before a time tell that things are as before from then on: "and go back to its green [once it
    lands]"; None if they do not."""
    before = max((stop for tag, _, stop in spans if tag in TIMES and stop <= start), default=0)
    if any(tag in ("x", "y") and before <= begin < start for tag, begin, _ in spans):
        return None  # "go back to the table when it stops"
    return before if _AS_IT_WAS.search(" ".join(words[before:start])) is not None else None


def _as_name(words: Sequence[str], span: Span, thing: Thing) -> Span:
    """A mark of a time that only names what comes before, as that of a name: "after [the blue one]"."""
    tag, start, stop = span
    after = (
        tag == "from" and words[start] in ("after", "before") and thing(" ".join(words[start + 1 : stop])) is not None
    )
    return ("y", start + 1, stop) if after else span


def _with_half(words: Sequence[str], span: Span) -> Span:
    """A mark of a time with the half behind it: "[at one second] and a half"."""
    tag, start, stop = span
    half = tag in TIMES and list(words[stop : stop + 3]) == ["and", "a", "half"]
    return (tag, start, stop + 3) if half else span


def _loses(tag: str, words: Sequence[str]) -> bool:
    """Whether words that seem to ask for nothing tell a time."""
    said = " ".join(words).strip(" ,.;")
    if len(hues() & set(said.split())) > 1:
        return True  # "first blue, then green, and red for the finale"
    if _ANOTHER.search(said) and hues() & set(said.split()) and not _AS_IT_WAS.search(said):
        return True  # "then yellow", "blue otherwise"
    if _BEFORE.search(said) or _UNLESS.search(said):
        return True
    if tag == "off" and re.search(r"\bnot [a-z]+ing$", said):
        return True  # "how about not making"
    if tag == "not" and _CONTRAST.search(said):
        return False
    if (_AMOUNT.search(said) and not _SO_THAT.search(said)) or any(
        word[0].isdigit() or (word in NUMBERS and word != "one") for word in said.split()
    ):
        return True
    return TIMED.search(said) is not None or any(found["word"] != "as" for found in CONJUNCTION.finditer(said))


def _reverted(
    text: str, unwanted: Sequence[str], moment: Moment, happening: Happening, thing: Thing
) -> tuple[str, Moment, Happening] | None:
    """A text and its time with the end that words for going back tell: ", and revert when it slides back"; None if that
    is not understood.

    Args:
        unwanted: words with the mark of what is not wanted.
    """
    for said in (text, *unwanted):
        if (found := _REVERTED.search(f" {said}")) is None:
            continue
        rest = said[: max(0, found.start() - 1)] if said is text else text
        if happening.during.state == "on" and _OFF_IT.search(found["then"]):
            over = happening.during.model_copy(update={"part": "until_end", "of": IT})
            both = happening.ended(Happening(over, found["then"]))
            return None if both is None else (rest, moment, both)
        told = _told("to", found["then"].strip(" ,."), thing)
        if told is None:
            return None
        ends, event = told
        if ends is not None:
            if ends.stop is None:
                return None
            return rest, replace(moment, stop=ends.stop, said=(*moment.said, *ends.said)), happening
        both = None if event is None else happening.ended(event)
        return None if both is None else (rest, moment, both)
    return text, moment, happening


def _begins(happening: Happening) -> bool:
    return happening.during.part in ("from", "after") and happening.until is None


def _with_unmarked(text: str, moment: Moment, thing: Thing, amounts: set[str]) -> tuple[str, Moment, Happening | None]:
    """A text without times that no mark tells, and these beside those that marks tell.

    Args:
        amounts: words that tell how much, and no time: "delay it by one second".
    """
    rest, found = cut(text)
    if amounts & set(found.said):
        return text, moment, None
    if found != Moment() and (both := _joined(moment, found)) is not None:
        text, moment = rest, both
    rest, happening = next(happenings_in(_WHERE_IN.sub("when", text), thing), (text, None))
    return rest, moment, happening


def _name(words: Sequence[str], start: int, stop: int, thing: Thing) -> str:
    """A name with a mark, and the noun behind it if that is a part of it: "[the coat] rack"."""
    said = " ".join(words[start:stop]).strip(" ,.")
    longer = f"{said} {words[stop]}" if stop < len(words) and is_known(words[stop]) else ""
    if longer and CONJUNCTION.match(f"{words[stop]} it"):
        longer = ""  # "hold [the door] till 3 s"
    if longer and thing(longer) is not None and not has_form(words[stop], tuple(SENSES), "plain", "s"):
        return longer
    return said if thing(said) is not None else next(iter(names_in(said, thing)), said)


def _things(named: Sequence[tuple[str, str]], tag: str, thing: Thing) -> tuple[str, ...]:
    """The names with a tag, each once, without pronouns."""
    found = list[tuple[str, Query]]()
    for own, name in named:
        query = thing(name) if own == tag else None
        if query is not None and not query.last and not any(query == other for _, other in found):
            found.append((name, query))
    return tuple(name for name, _ in found)


def _joined(one: Moment, other: Moment) -> Moment | None:
    """Both times as one; None if both tell the same part of it, each another. A number tells more than a name: "at the
    end, from 4 s on"."""
    if all(isinstance(moment.start, float) for moment in (one, other)):
        one, other = sorted((one, other), key=lambda moment: float(moment.start or 0.0) >= 0)
        if one.start is not None and float(one.start) < 0 <= float(other.start or 0.0):
            one = replace(one, start=None)  # "in the last two seconds, from 3 s on"
    for key in ("start", "stop", "lasting"):
        told = [getattr(moment, key) for moment in (one, other)]
        if None in told or told[0] == told[1]:
            continue
        if sum(isinstance(value, str) for value in told) != 1:
            return None
        ends: dict[str, Any] = {key: None}
        one, other = (replace(one, **ends), other) if isinstance(told[0], str) else (one, replace(other, **ends))
    return Moment(
        start=other.start if one.start is None else one.start,
        stop=other.stop if one.stop is None else one.stop,
        lasting=other.lasting if one.lasting is None else one.lasting,
        taken=one.taken or other.taken, always=one.always or other.always, said=(*one.said, *other.said),
    )  # fmt: skip


def _moment(tag: str, phrase: str) -> Moment | None:
    """The time in numbers that words with a tag tell, None if they tell none."""
    if _half_its_way(phrase) is not None:
        return None
    if tag == "to" and re.match(r"by (?:the )?(?:very )?end\b", phrase):
        return Moment(stop="end", said=(phrase,))
    phrase = _PASSED.sub("", _WHOLE_SECONDS.sub("", phrase))
    rest, moment = cut(phrase)
    if moment != Moment() and not any(is_word(word) or is_known(word) for word in rest.strip(" ,.").split()):
        if tag == "to" and isinstance(moment.start, float) and moment.stop is None and moment.lasting is None:
            moment = replace(moment, start=None, stop=moment.start)  # "only gets there at five seconds"
        return moment
    if (half := _HALF.search(phrase)) is not None:
        first = half[1] == "first"
        return Moment(start=None if first else "middle", stop="middle" if first else "end", said=(phrase,))
    if _ALL.search(phrase):
        return Moment(always=True, said=(phrase,))
    bare = _BARE.match(phrase)
    value = None if bare is None else _seconds(bare["value"])
    return None if value is None else _at(tag, phrase, value)


def _named_moment(tag: str, phrase: str, thing: Thing) -> Moment | None:
    """The start, the middle or the end of the film where words with a tag name it, None if they name none."""
    if any(is_known(name.split(" ")[-1]) for name in names_in(phrase, thing)):
        return None  # "until the fall of the book is over"
    leads = phrase.split(" ")[0] not in _EVEN_SO and _FILM.search(phrase) is None
    if tag == "for" or (leads and CONJUNCTION.match(phrase)):
        return None
    if tag == "to" and _WITH_THE_FILM.search(phrase):
        return _at(tag, phrase, "end")
    begins = re.sub(r" (?:to|until|till) the (?:very )?end$", "", phrase) if tag != "to" else phrase
    value = next((end for pattern, end in _NAMED if pattern.search(begins)), None)
    return None if value is None else _at(tag, phrase, value)


def _at(tag: str, phrase: str, value: End) -> Moment | None:
    """A time as its tag has it: from then, until then, or for so long."""
    if tag == "for":
        return Moment(lasting=value, taken=True, said=(phrase,)) if isinstance(value, float) else None
    if tag == "from":
        return Moment(start=value, said=(phrase,))
    if tag == "to":
        return Moment(stop=None if value == "end" else value, always=value == "end", said=(phrase,))
    return None


_PASSED = re.compile(r" (?:on the dot|(?:has|have) (?:passed|elapsed|gone(?: by)?)|(?:is|are) (?:over|up))$")
_WHOLE_SECONDS = re.compile(r"\b(?:whole|full|entire|good|solid|complete) (?=(?:seconds?|secs?)\b)")
_UNTIL_THEN: dict[Part, Part] = {"from": "until", "while": "until", "after": "until_end"}
_WITH_THE_FILM = re.compile(r"\b(?:with|as) the (?:film|clip|video|movie|scene|shot)$")
_EVEN_SO = ("until", "till", "after", "by", "before")


def _seconds(said: str) -> float | None:
    """Seconds that a number names, with or without its unit."""
    said = re.sub(r"^another (?=second)", "one ", said)
    said = re.sub(r"^(?:second|sec|t|time)\b ?=? ?(?=\w)", "", re.sub(r"\b(?:more|another|extra|further) ", "", said))
    found = seconds_of(said)
    if found is None:
        found = seconds_of(f"{said} seconds")
    if found is None and (rank := re.fullmatch(r"(\w+) second", said)) is not None and rank[1] in ORDINALS:
        found = float(ORDINALS[rank[1]])
    return found


def _half_its_way(phrase: str) -> re.Match[str] | None:
    """The words for half the way of something; None for others, and for half the film."""
    return None if _FILM.search(phrase) or _ALONE.match(phrase) else _HALFWAY.match(phrase)


def _event(tag: str, phrase: str, thing: Thing) -> Happening | None:
    """The time told by what happens of words with a tag, None if they tell none."""
    if (half := _half_its_way(phrase)) is not None:
        of = names_in(half["who"] or half["what"], thing)[:1]
        whose = thing(of[0]) if of and (half["who"] or half["way"].startswith((" through", " of"))) else None
        return Happening(During(state="halfway", of=whose or IT, part="until" if tag == "to" else "from"), phrase)
    phrase = re.sub(r" onwards?$", "", phrase)
    phrase = re.sub(r"^(while|as) its (?=[a-z]+ing\b)", r"\1 it is ", phrase)
    if (noun := _FROM_EVENT.match(phrase)) is not None and tag == "from":
        phrase = f"from when it {noun['event']}s"
    phrase = _GERUND.sub(r"\g<word> it is \g<doing>", _WHERE.sub("when ", _AS.sub("while ", phrase)))
    if (beside := _BESIDE.match(phrase)) is not None and (query := thing(beside["who"])) is not None:
        return Happening(During(state="moving", of=query, part="until" if tag == "to" else "from"), phrase)
    for said in dict.fromkeys((phrase, f"{TIMES[tag]} {phrase}", restated(phrase), restated(f"{TIMES[tag]} {phrase}"))):
        for found in CONJUNCTION.finditer(said):
            if found.start() == 0 and (during := clause_of(found["word"], said[found.end() :].strip(" ,."), thing)):
                if tag == "to" and during.part in _UNTIL_THEN:  # "... and normal again [to when it slides back]"
                    during = during.model_copy(update={"part": _UNTIL_THEN[during.part]})
                return Happening(during, said)
    return None


def leaves_out(words: Sequence[str], ops: Sequence[Fields]) -> bool:
    """Whether a number beside a time, or a colour, that an instruction tells stands in no operation.

    What is not wanted, and what comes back, may be left out.
    """
    if _loses_colors(words, ops):
        return True
    said = " ".join(words)
    return (TIMED.search(said) or _A_SECOND.search(said)) is not None and _loses_numbers(words, ops)


def _loses_colors(words: Sequence[str], ops: Sequence[Fields]) -> bool:
    """Whether a look is for a time, and another colour that is told stands nowhere: "red while it rolls, else blue"."""
    if not any(op["op"] == "recolor" and op.get("when") is not None for op in ops):
        return False
    held = set(re.findall(r"[a-z]+", str(ops)))
    for at, word in enumerate(words):
        around = {*words[max(0, at - 4) : at], *words[at + 1 : at + 3]}
        beside = held & hues() & {*words[max(0, at - 1) : at], *words[at + 1 : at + 2]}  # "mint green" is one colour
        if word in hues() and word not in held and not beside and not around & _NOT_WANTED:
            return True
    return False


_NOT_WANTED = bag(
    "again back return returns revert reverts not no never instead than rather too from usual normal longer was rest "
    "without ugly"
)


def _loses_numbers(words: Sequence[str], ops: Sequence[Fields]) -> bool:
    """Whether a number stands in no operation, and not among what is not wanted."""
    missing = set(_missing(words, ops))
    if missing and "not" in words and "but" in words[words.index("not") :]:  # "not at 1 s but at 3 s"
        missing -= set(range(words.index("not"), words.index("but", words.index("not"))))
    if missing:
        unwanted = [(start, stop) for tag, start, stop in marked(words) if tag == "not"]
        missing -= {
            at for start, stop in unwanted if _CONTRAST.search(" ".join(words[start:stop])) for at in range(start, stop)
        }
    return bool(missing)


def _missing(words: Sequence[str], ops: Sequence[Fields]) -> Iterator[int]:
    """Where the numbers stand that are in no operation."""
    exact = {abs(value) for op in ops for value in _numbers(op)}
    shares = [{v and 1 / v, 100 * v, 1 - v, 100 * (1 - v), 100 * (v - 1)} for v in exact]
    held = exact.union({0.0}, {360 * v for v in exact}, *shares)  # degrees of turns
    for at, (word, then) in enumerate(zip(words, (*words[1:], ""), strict=True)):
        if is_known(singular(then)) or then in _NO_NUMBER:
            continue
        told = float(word) if re.fullmatch(r"\d+(?:\.\d+)?", word) else float(NUMBERS.get(word, 1))
        seconds = re.fullmatch("full|whole|s|sec|secs|seconds?", then) is not None
        seconds |= word == "one" and at > 0 and words[at - 1] in _AT and not then.isalpha()  # "starting at one"
        seconds &= word != "a" or (at > 0 and words[at - 1] in ("for", "over", "within", "in"))
        if told != 1 or (seconds and word in ("1", "one", "a")):
            rate = words[max(0, at - 1)] in ("every", "each", "per")
            among = exact if seconds and not rate else held
            if not any(abs(told - value) < 0.01 or abs(told + 0.5 - value) < 0.01 for value in among):
                yield at


_A_SECOND = re.compile(r"\b(?:every|each|per|a) (?:second|sec)\b")
_AT = ("at", "by", "until", "till", "from", "before", "after")
_NO_NUMBER = ("of", "ones", "quarters", "thirds", "quarter", "third")  # behind a part of something


def _numbers(value: object) -> Iterator[float]:
    """All numbers in the fields of an operation."""
    if isinstance(value, BaseModel):
        value = value.model_dump(exclude_defaults=True)
    if isinstance(value, bool):
        return
    if isinstance(value, int | float):
        yield float(value)
    elif isinstance(value, dict):
        for inner in value.values():
            yield from _numbers(inner)
    elif isinstance(value, list | tuple):
        for inner in value:
            yield from _numbers(inner)
