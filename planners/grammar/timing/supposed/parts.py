"""An instruction divided by marks: what it is about, where that goes, when, and what asks for nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from .....gaussians import late_re as re
from .....gaussians.language.query.query import Query
from ...learned.marks import Span
from ...learned.seen import hues
from ...vocabulary.nouns import is_known
from ...vocabulary.quantities import NUMBERS
from ..happenings import CONJUNCTION, IT, Happening
from ..happenings import cut as happenings_in
from ..manner import Thing
from ..moments import DURATION, TIMED, Moment, cut, seconds_of
from ..verbs import SENSES, has_form
from .choosing import says_plainly
from .kinds import is_any_word
from .lost import CONTRAST
from .names import named as names_in
from .names import with_moving
from .orders import listed
from .said import BEFORE_IT, Said
from .times import LASTS, LEADING, TIMES, UNTIL, delayed, joined, told_by

_IDLE = ("not", "off")  # tags of words that ask for nothing
_WHERE_IN = re.compile(
    r"(?<!\bto )(?<!\bnear )\bwhere\b(?= (?:it|he|she|they|the) )(?! \w+ (?:is|are|was|were|stands?|sits?|lies?)\b)"
)
_BEFORE = re.compile(r"\b(?:not|never) (?:before|until|till|unless|if|when|while) \w+ \w+")  # that waits for something
UNLESS = re.compile(r"\b(?:except|unless|apart from|only if)\b|\bif (?:it|he|she|they|the)\b")
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
_REMARKS = re.compile(  # what is said of oneself, or of how it is: ", i am after something dreamlike"
    r"(?:, )?(?:and |but )?(?:i|we|it|that|this|they) (?:am|is|are|was|feels?|looks?|seems?|think)\b"
)
_ASKED_OF = re.compile(r"\b(?:the|a|an) \w+ (?:should|must|shall|has to|have to|needs? to|ought to|is to|are to)\b")
_AFTER_IT = re.compile(  # "after that it pops in", "before it goes on"
    r"\b(?:before|after)(?: (?:and|or) (?:before|after))? (?:that|this|then|which)\b|"
    r"\bbefore (?:it|he|she|they) (?:then |finally )?(?:continues?|goes on|go on|carr(?:y|ies) on|resumes?|moves? on|"
    r"proceeds?)\b"
)
_IS_THERE = re.compile(r"\b(?:be|is|gets?|been|arriv\w+) there$")
_ARRIVES = re.compile(
    r"\b(?:there|arriv\w+|position|place|last|ends?|ending|done|finish\w*|reach\w*|gets?|stops?|lands?)\b"
)
_AMOUNT = re.compile(r"\b(?:quarter|half|third|twice|double|triple|thrice|percent|faster|slower|backwards?|reverse)\b")
_ANOTHER = re.compile(r"^(?:, )?(?:and |but )?then\b|\botherwise\b")
_TO_THEN = re.compile(
    rf"(?:to|until|till|-) (?:{DURATION}|\d+(?:\.\d+)?|{'|'.join(NUMBERS)})"
    r"(?= ?$| (?!times|percent|%|x\b|cm|m\b|met|deg|turns?|rounds?|per\b|of\b))"
)
_AS_IT_WAS = re.compile(r"\b(?:again|back|before|usual|normal|was|returns?|own|original|used to)\b")


def divided(words: Sequence[str], spans: Sequence[Span], thing: Thing) -> tuple[Said, Happening | None] | None:
    """What an instruction says, and what happens at its time; None if a time in it is not understood.

    Args:
        words: those of the instruction.
        spans: the marks in them.
        thing: reads a name.
    """
    moment, spans = Moment(), [_whole(words, _as_name(words, span, thing)) for span in spans]
    happening: Happening | None = None
    clause = ""
    is_delayed, skipped = False, list[tuple[int, int]]()
    for tag, start, stop in spans:
        if tag not in TIMES:
            continue
        phrase = " ".join(words[start:stop]).strip(" ,.;:")
        begun = moment.start is not None or (happening is not None and happening.during.part != "until")
        if tag == "from" and begun and (gone := _gone_back(words, spans, start)) is not None:
            tag, skipped = "to", [*skipped, (gone, start)]
        if tag == "from" and UNTIL.match(phrase):
            tag = "to"
        before = " ".join(words[max(0, start - 4) : start])
        begins = isinstance(moment.start, float)
        if tag == "from" and (_IS_THERE.search(before) or (begins and _ARRIVES.search(before))):
            tag = "to"  # "leaving at 3 s and in position at 4.5 s"
        if tag in ("from", "to") and LASTS.match(phrase):
            tag = "for"
        phrase, delay = delayed(LEADING.sub("", phrase))
        if delay is not None:
            moment, is_delayed = replace(moment, start=delay), True
        if (told := told_by(tag, phrase, thing)) is None:
            return None
        found, event = told
        if found is not None:
            if (both := joined(moment, found)) is None:
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
    if len(spans) > len(again):
        left |= {at for _, start, stop in again for at in range(start, stop)}
        spans = [span for span in spans if span not in again]
    text = " ".join(word for at, word in enumerate(words) if at not in left).strip(" ,.;:!")
    text = with_moving(re.sub(r"(?: [,.;:!])+(?= [,.;:!])", "", text))
    if isinstance(moment.stop, float):
        text = BEFORE_IT.sub(" ", text)
    amounts = {" ".join(words[start:stop]).strip(" ,.") for tag, start, stop in spans if tag == "by"}
    if happening is None:
        text, moment, happening = _with_unmarked(text, moment, thing, amounts)
    elif _begins(happening) and isinstance(moment.start, float) and not is_delayed:
        clause = happening.said  # "after it has been opened, from 3.5 s on"
        happening = None
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
    if not things and _PRONOUN.search(text):
        said = (" ".join(words[start:stop]) for tag, start, stop in spans if tag in _IDLE)
        things = names_in(clause or " . ".join(said), thing)[:1]  # "always shut the door, so have it close at 3 s"
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
    if words[0] in ("so", "because", "as", "since", "for", "like", "if") or _REMARKS.match(" ".join(words)):
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


def _whole(words: Sequence[str], span: Span) -> Span:
    """A mark of a time with what belongs to it behind it: "[at one second] and a half", "[three seconds] to four"."""
    tag, start, stop = span
    if tag in TIMES and list(words[stop : stop + 3]) == ["and", "a", "half"]:
        return tag, start, stop + 3
    begun = " ".join(words[start:stop]).removeprefix("from ").removeprefix("at ")
    then = _TO_THEN.match(" ".join(words[stop:])) if tag in ("from", "for", "in") else None
    if then is None or seconds_of(begun) is None:
        return span
    return "in", start, stop + then[0].count(" ") + 1


def _loses(tag: str, words: Sequence[str]) -> bool:
    """Whether words that seem to ask for nothing tell a time."""
    said = _AFTER_IT.sub(" ", " ".join(words).strip(" ,.;"))
    if len(hues() & set(said.split())) > 1:
        return True  # "first blue, then green, and red for the finale"
    if _ANOTHER.search(said) and hues() & set(said.split()) and not _AS_IT_WAS.search(said):
        return True  # "then yellow", "blue otherwise"
    if _BEFORE.search(said) or UNLESS.search(said):
        return True
    if tag == "off" and _ASKED_OF.search(said):
        return True  # "and the lamp should sing"
    if tag == "off" and re.search(r"\bnot [a-z]+ing$", said):
        return True  # "how about not making"
    if tag == "not" and CONTRAST.search(said):
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
        told = told_by("to", found["then"].strip(" ,."), thing)
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
    if found != Moment() and (both := joined(moment, found)) is not None:
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
