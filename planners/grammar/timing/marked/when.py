"""When the marks of an instruction say that something is to be: the time that all marks of time tell together."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from .....gaussians import late_re as re
from .....gaussians.language.query.query import Query
from .....tools.when import During
from ...learned.events import event_of
from ...learned.marks import Span
from ...tagging.words import bag
from ...vocabulary.nouns import is_known
from ...vocabulary.quantities import NUMBERS
from ..happenings import IT, Happening
from ..manner import Thing
from ..moments import DURATION, End, Moment, seconds_of
from .amounts import amount
from .events import is_told_by_event, told_by_event, told_by_leg
from .names import named as names_in
from .numbered import numbered
from .times import LASTS, LEADING, TIMES, UNTIL, delayed, joined, told_by

LOOKS = ("recolor", "hide", "remove")  # kinds that other things only tell the place of
NEAR = 0.06  # seconds by which a number may differ from what it says of how it is now
KEEPING = re.compile(
    r"^(?:while|whilst|all the while) (?:still )?(?:preserving|keeping|maintaining|retaining|leaving|holding|"
    r"conserving)\b|^(?:from|at|with|in) (?:the |its |his |her )?(?:same|usual|present|current|normal|old|original) "
    r"(?!(?:time|moment|instant|second|frame) (?:as|that|when)\b)"
)
_PLAINER = tuple(
    (re.compile(pattern), plain)
    for pattern, plain in (  # times in plainer words
        (
            r"^(?:for |during |in )?(?:just |exactly |precisely |only )*(?=(?:as|so) long as\b(?! (?:the |this )?"
            r"(?:film|clip|video|movie|scene|shot|picture)\b))",
            "",
        ),
        (r"\b(?:a|one) second (?=has|is|have)", "1 seconds "),
        (
            r"\b(?:has|have|is|are|'s) (?:\w+ly )?(?:swung|slid|come|gone|been pulled|opened|pulled|rolled)"
            r"(?: (?:fully|wide|right|all the way|completely|wholly))? (?=(?:open|out)\b)",
            "is fully ",
        ),
        (r"^at the (?:stroke|count|mark) of ", "at "),
        (
            r"^(?:when|once|as soon as) (?:the )?(?P<at>\d+(?:\.\d+)?)(?: (?:s|secs?|seconds?))? "
            r"(?:hits?|strikes?|comes?(?: (?:up|round|around))?|arrives?|is reached|rolls? (?:up|round|around))$",
            r"at \g<at>",
        ),
        (
            r"^(?:until|till) (?:we|i|they|you) (?:sign off|wrap(?: up)?|are done|finish|stop|go home|cut|close)$",
            "until the end",
        ),
        (r"^first (?=(?:at|from|in|after|when|once)\b)|(?<=\d) first$", ""),
        (
            rf"^(?:only )?after (?P<d>{DURATION}) of (?:quiet|silence|stillness|rest|peace|calm|nothing|waiting)$",
            r"at \g<d>",
        ),
        (
            r"^(?:when|once|as soon as) (?:the |my |our )?(?:clock|timer|watch|counter|second) ?"
            r"(?:(?:has |is )?(?:touch(?:es)?|says?|strikes?|reads?|shows?|hits?|reaches|gets to|at) )?"
            rf"(?P<at>\d+(?:\.\d+)?|{'|'.join(word for word in NUMBERS if word.isalpha())})(?: strikes?| comes?)?$",
            r"at \g<at>",
        ),
        (r"^(?:one|a) (?:beat|heartbeat|breath|moment|blink) , (?:say|call it|that is|about) ", ""),
        (r"(?:(?<= s)|(?<=seconds)) , (?=after )", " "),
        (r"(?:(?<=second)|(?<=seconds)|(?<=s)) and not (?:one|a second|any) (?:less|more)$", ""),
        (r"^no later than ", "by "),
        (
            r"^up to (?:the )?(?:moment|point|instant|second|time) (?:when |that |(?:at|in) which )?"
            r"(?=(?:the|it|he|she)\b)",
            "until ",
        ),
        (
            r"\bhas (?:settled|come to rest|stopped|parked|halted|come to a stop)(?: (?:by|at|against|beside|near|on) "
            r"the [a-z]+)$",
            "has stopped",
        ),
        (r"\bfirst (?=(?:moves|stirs|budges|opens|starts|goes)\b)", ""),
        (r"\b(?:budge|stir)(?=s?$|s? )", "move"),
        (
            r"^(?:in )?between (?:the (?P<x>[a-z]+) 's|its) two (?:moves|movements|strokes|trips)$",
            lambda found: f"while {'the ' + found['x'] if found['x'] else 'it'} is fully open",
        ),
        (r"^as far as (?=the )", "until "),
        (r"^(?:coming )?out of (?=(?:the|its|his|her) (?:turn|corner|bend)\b)", "after "),
        (r"\bis standing$", "has stopped"),
        (r"\b(?:comes? to a (?:halt|stop|standstill)|stops|halts|rests) (?:outside|out)$", "is fully open"),
        (r"^once (?=(?:opened|closed|landed|fallen|out|open|shut|stopped|turned)$)", "once it is "),
        (
            r"^(?:through|until|till|to) (?:the )?(?:very )?(?:end of )?(?:the )?(?:end|shift|day|show|reel|take|match|"
            r"song|number|last)$",
            "until the end",
        ),
        (r"\bits first (?=(?:landing|fall|run|roll|turn)$)", "its "),
        (r"^to (?=(?:\d|one\b|two\b|half\b|a )[^,]* (?:after|once|when|behind) )", ""),
        (
            r"^(?:and )?with (?P<who>(?:the|my|our) [a-z ]+?) (?P<how>(?:fully |wide |all the way |completely )?"
            r"(?:open|out|shut|closed))(?: again)?$",
            r"when \g<who> is \g<how>",
        ),
        (
            r"^in (?:sync|step|time|tandem) with (?P<who>(?:the|my|our) [a-z ]+?) (?P<what>opening|closing|moving)$",
            r"while \g<who> is \g<what>",
        ),
        (r"\bthe rest of (?:the|this) \w+$", "the rest of the film"),
        (
            r"\b(?:has |is |had )?(?:finished|finishes|done|completes|completed) (?:coming out|sliding out|opening|"
            r"going out|moving out)$",
            "is fully open",
        ),
        (r"^all over(?: and| ,)? ?", ""),
        (r"\bthe second number (?=\w)", "second "),
        (
            r"\bhas (?:taken|made|done|spent|finished) (?:its|his|her) (?:very )?last (?:step|turn|round|spin)$",
            "has stopped",
        ),
        (rf"^(?:until|till|not (?:until|till|before)) (?={DURATION} (?:after|once|past|from) )", ""),
        (r"\b(?:couple(?: of)?) (?=seconds?\b)", "two "),
        (r"^(?P<lead>(?:for|in|of|over|within|taking|lasting) )?second and a half\b", r"\g<lead>1.5 seconds"),
        (
            r"^(?P<lead>(?:by|until|till|before|at) the )(?P<rank>first|second|third|fourth|fifth)$",
            r"\g<lead>\g<rank> second",
        ),
        (
            r"^(?P<lead>(?:for|in|of|over|within|taking|lasting) )?(?:an?|the|just|only|like|about) (?=(?:\d|one|"
            r"two|three|four|five|half a|third of|quarter of)\b)",
            r"\g<lead>",
        ),
    )
)
_UNTIL_THEN = re.compile(r"^(?:until|till) ")
_DEICTIC = re.compile(
    r"^(?:from|at|in|on) (?:this|that) (?:very |same )?(?:moment|point|instant|time)(?: on(?:wards?)?)?$"
)
_THERE_BY = re.compile(r"^(?:and )?(?:be |is |are )?there (?:for|by|at|on) (?=\d|one\b|two\b|three\b|four\b|five\b)")
_MUST_BE_THERE = re.compile(
    r"^(?:, )?(?:it|he|she|they) (?:(?:must|should|has to|have to|is to|needs to|shall|will|ought to) )?"
    r"(?:be|stand|sit|have arrived|is|has arrived)\b(?: (?:there|in place|home|over there)| \||$)"
)
_THAT = re.compile(r"(?<=[a-z] )(?:that|this|those|these)(?= (?P<noun>[a-z]+)(?: |$))")  # "hits that wall"
_HALFWAY = re.compile(r"\b(?:half ?way|mid|midway|middle|half)\b")
_ARRIVES = re.compile(
    r"\b(?:there|arriv\w+|position|place|last|ends?|ending|done|finish\w*|reach\w*|gets?|stops?|lands?|home|parks?|"
    r"complet\w+|back|again|return\w*|re ?\w+s)\b"
)
_FOR_THE_TIME = re.compile(
    r"^(?:just |only )*(?:for|during) (?:the|that) (?:time|moments?|seconds?|bit) (?:when|that|in which)\b"
)
_IS_THERE = re.compile(
    r"\b(?:be|is|are|been|stands?|sits?) (?:there|in place|home|in position)(?: just| right| exactly)?$|"
    r"\b(?:arriv(?:e|es|ing)|gets? there|reach(?:es|ing)? it)(?: there)?(?: just| right| exactly)?$"
)
_ONCE = re.compile(r"^(?:and )?(?:when|once|as soon as)\b")
_ENDED = ("hide", "recolor", "pause", "halt")  # kinds that two times begin and end: "gone at 1 s, and back at 3 s"
_A_NUMBER = re.compile(r"^(?:at|from|in) (?:t ?= ?|second )?\d")
_REASON = re.compile(  # "since it's leaking, take it out"
    r"^since (?:it|he|she|they|that|the \w+) (?:is|are|'s|looks?|seems?)\b"
    r"(?! (?:\w+ )?(?:open|shut|closed|out|up|down|gone|there|still|moving|rolling|turning|falling|at|on|in)\b)"
)
BY_SO_MUCH = re.compile(rf"^by (?:another )?{DURATION}$")  # "shift it by one second" tells no time
_ONLY = re.compile(r"^(?:right|only|just|exactly|precisely|immediately|directly|shortly|already|not) ")
_JUST_BEFORE = re.compile(r"^(?:right |just |directly |immediately )*before ")
_LIKEWISE = re.compile(
    r"^(?:when|once|as soon as|after|until|till) (?P<who>(?:the|a|my) [a-z ]+?) (?:does|do|did|has|is)(?: too| so)?$"
)
_STAYS_OPEN = re.compile(r"^(?:until|till) (?:\d|one\b|two\b|three\b|four\b|five\b|half\b)")
_AT_A_NUMBER = re.compile(r"^(?:at|from|on) (?:t ?= ?|second )?\d")
_COMES_BACK = re.compile(
    r"\b(?:back|again|returns?|reappears?|normal|usual|reverts?|visible|shows?|seen|ends?|stops?|over|done|until|till|"
    r"(?:pops?|comes?|steps?|walks?|fades?) (?:in|up|out)|enters?)\b"
)
_UP_TO_THEN = re.compile(r"\b(?:until|till|before)(?: ,)?$")
_AT_A_SECOND = re.compile(r"^(?:just |right )?(?:in|at|on) (?:second|sec|t ?=) ?\d")
_OF_SEVERAL = ("open", "order", "together", "move")
_SECOND_TIME = re.compile(
    r"\b(?:for )?(?:the |a )?(?:second|first|next|last|other) (?:time|go|run|pass|one|take|round)\b ?"
)
_AGAIN_AT_ONCE = re.compile(
    r"^(?:and )?(?:the |a )?(?:second (?:time|go|run|one) )?(?:right|straight|immediately|directly|at once|on the spot|"
    r"no |without|with no|each following|each one|one after|instantly|back to back|in a row|just)\b"
    r"(?!.*\b(?:it|the \w+) (?:is|has|lands?|stops?|opens?|shuts?|closes?))"
)
_EACH_TIME = re.compile(
    r"(?:^| )(?:each (?:time |run |one |pass |way )?|every time |apiece|per (?:run|pass|time))"
    r"(?:lasting |taking |in |for )?| each(?: time)?$"
)
_TOGETHER = re.compile(
    r"^one (?:after|behind) (?:the )?(?:other|another)$|^one by one$|^in turn$|^out and (?:back )?in(?: again)?$|"
    r"^(?:(?:both|all|in|and|out|shuts?|opens?|close[sd]?|times|again|back) )*together\b(?! with\b)[a-z ]*$"
)
_AT_NO_TIME = re.compile(
    r"^(?:not once|never|(?:from )?(?:the )?(?:very )?(?:beginning|first [a-z]+|first|slate|start|kick ?off) "
    r"(?:to|till) (?:the )?(?:very )?(?:last(?: [a-z]+)?|end|out|finish|whistle)|"
    r"every (?:single )?(?:second|frame|moment)\b.*)$"
)
_RUN_OVER = re.compile(
    r"^(?:the (?:instant|moment)|as soon as|once|when) (?:the|its) (?:first |one )?(?:run|time|go|pass|roll|trip) "
    r"(?:is|has) (?:over|done|finished|ended)$"
)
_BEHIND_IT = re.compile(rf"^(?P<d>{DURATION}) (?:later|(?:after|behind) (?:it|him|her|that))$")
_WITH_IT = re.compile(r"^(?:[a-z]+ ){0,4}together with (?:it|him|her|that(?: one)?)$")
PLACES_IN_TURN = bag("first then next last lastly finally and the one ones top middle bottom upper lower drawer , ;")
_REVERTED = re.compile(  # ", and come back when it is closed again"
    r"\b(?:back|returns?|reappears?|again|visible|normal|usual|reverts?)\b.*?"
    r"\b(?P<then>(?:when|once|as soon as|at|after|upon) .+)$"
)
_RESTS = re.compile(rf"^for (?P<lasting>{DURATION}) (?P<then>(?:after|once|when|from|right after|as soon as) .+)$")
_OF_NO_TIME = ("amount", "speed", "spin")  # kinds whose amounts are no times
_AT_A_TIME = re.compile(
    r"^(?:(?:forward|back|up|out|on) )?(?:to|at|from) (?:t ?= ?)?\d+(?:\.\d+)?(?: (?:s|secs?|seconds))?$"
)  # for what begins
_CLAUSE = re.compile(r"\bsame\b|\b(?:as|with|when|while|once|until|till|after|before|during) \w+ \w+")
_COMPLETED = re.compile(r"\b(?:completed?|finished|done|over with|arriv\w+|there)(?: already)?$")


def time_of(
    words: Sequence[str], spans: Sequence[Span], text: Callable[[Span], str], thing: Thing, kind: str
) -> tuple[Moment, Happening | None] | None:
    """The time that marks tell; None if one of them is not understood, or if they contradict each other."""
    moment, happening = Moment(), None
    times = sum(tag in TIMES for tag, _, _ in spans)
    for span, tag, phrase in _divided(spans, text):
        if tag == "by" and is_a_time(phrase, kind):
            tag = "from"
        lasts = happening is not None and happening.during.part == "while"
        if tag == "not" and kind in _ENDED and not lasts and (reverted := _REVERTED.search(phrase)) is not None:
            tag, phrase = "to", reverted["then"]
        if tag == "from" and (rests := _RESTS.match(phrase)) is not None:
            lasting = told_by("for", rests["lasting"], thing)
            if lasting is None or lasting[0] is None or (both := joined(moment, lasting[0])) is None:
                return None
            moment, phrase = both, rests["then"]
        if tag not in TIMES or not phrase or KEEPING.match(phrase) or _HOW_MANY.match(phrase):
            continue
        if (
            kind == "repeat"
            and _AGAIN_AT_ONCE.match(phrase)
            and not any(map(tells_number, _SECOND_TIME.sub("", phrase).split()))
        ):
            continue  # "right after the first", "without a break"
        if kind in LOOKS and _EVERY_TIME.match(phrase):
            return None
        if kind == "repeat":
            phrase = _SECOND_TIME.sub("", _EACH_TIME.sub("", phrase))
        if kind == "still" and tag == "in" and _AT_NO_TIME.match(phrase):
            continue
        if kind == "repeat" and _RUN_OVER.match(phrase):
            continue  # "the instant the first run is over"
        if (behind := _BEHIND_IT.match(phrase)) is not None and (others := [text(o) for o in spans if o[0] == "y"]):
            said = phrase = f"{behind['d']} behind {others[0]}"  # "trails the van, one second after it"
        if kind == "open" and _WITH_IT.search(phrase):
            continue  # "out and back in together with it"
        if kind in _OF_SEVERAL and (_TOGETHER.match(phrase) or set(phrase.split()) <= PLACES_IN_TURN):
            continue  # "first bottom, then middle"; "together and shuts together"
        said = phrase = _THAT.sub(lambda found: "the" if is_known(found["noun"]) else found[0].split()[0], phrase)
        for pattern, plain in _PLAINER:
            phrase = pattern.sub(plain, phrase)
        said = text(span) if said == phrase == text(span) else phrase
        if _THERE_BY.match(phrase) or (kind == "move" and _MUST_BE_THERE.match(" ".join(words[span[2] : span[2] + 6]))):
            tag, phrase = "to", _THERE_BY.sub("at ", phrase)
        tag = _plainer_tag(tag, phrase, " ".join(words[max(0, span[1] - 4) : span[1]]), kind, moment, happening)
        if tag == "from" and kind == "close":
            phrase = _UNTIL_THEN.sub("at ", phrase)  # "leave it open till four, then close it"
        if _DEICTIC.match(phrase):
            if moment.start is not None or happening is not None:
                continue  # "at 2.5 s: from that instant ..."
            said = phrase = _spoken_of(words, spans, span)
        gone = kind == "hide" and moment.start is not None  # and is back then
        number = tag == "to" and kind in LOOKS and not gone and _AT_A_NUMBER.match(phrase) is not None
        if number and not _COMES_BACK.search(" ".join(words)):
            return None  # "gold once the cat has sat down at 3 s" does not end then
        phrase, delay = delayed(LEADING.sub("", phrase))
        if tag == "from" and kind == "pause" and (before := _JUST_BEFORE.match(phrase)) is not None:
            phrase = f"when {phrase[before.end() :]}"  # a rest before its turn begins where that did
        idles = tag in ("from", "for") and kind in _RESTED_BEFORE and happening is not None and _begins(happening)
        if idles and delay is None and moment.start is None and (rest := _REST.match(phrase)) is not None:
            moment = replace(moment, start=seconds_of(_SMALL.sub("", rest["delay"])))
            continue  # "once it is open, let it hold its breath for one second"
        told = _told(tag, phrase, said if delay is None else phrase, thing, happening)
        if told is None and times > 1 and _says_nothing(phrase, thing):
            continue
        if told is None:
            return None
        found, event = told
        if delay is not None:
            found = replace(found or Moment(), start=delay)
        elif (
            found is not None
            and isinstance(found.start, float)
            and happening is not None
            and _begins(happening)
            and _AT_SOME_TIME.match(phrase)  # else that is how long after it: "a full second of silence"
        ):
            happening = None  # "once the fan has stopped, at 4.5 s": the number tells it
        if found is not None:
            if kind == "pause" and tag == "to" and moment.start is not None and _is_later(found.stop, moment.stop):
                continue  # "from 1 to 2 s, afterwards it goes on until 4 s"
            if (both := joined(moment, found)) is None:
                return None
            moment = both
        if tag == "from" and event is not None and kind in _BEGUN and event.during.part == "while":
            event = replace(event, during=event.during.model_copy(update={"part": "from"}))
        if event is not None and happening is not None:
            resting = kind == "pause" and moment.lasting is not None and _begins(happening)
            if resting and event.during.part == "until":
                continue  # "for a second after its walk, before it turns"
            event = _both(happening, event)
            if event is None:
                return None
        happening = event or happening
    numbers = isinstance(moment.start, float) and isinstance(moment.stop, float) and moment.start >= 0
    if numbers and happening is not None and happening.during.part == "while" and happening.until is None:
        happening = None  # "together with the top one, 1 to 2 s": the numbers tell it
    until = happening is not None and happening.during.part == "until"
    if kind in LOOKS and moment.start == 0.0 and (moment.stop is not None or until):
        moment = replace(moment, start=None)
    return moment, happening


_AT_SOME_TIME = re.compile(r"^(?:at|from|on|in|by|with|when|t|second) ")
_BEGUN = ("close", "move", "begin", "return", "repeat", "reverse")  # kinds of what begins "when the door is open"
_RESTED_BEFORE = ("close", "return")  # kinds before which a thing may rest where it is
_EVERY_TIME = re.compile(r"^(?:for )?(?:each|every) (?:single )?time\b")
_HOW_MANY = re.compile(r"^(?:all|both)(?: of them)?(?: (?:two|three|four|five|2|3|4|5))?$")  # "all four", of things
_SMALL = re.compile(r"\b(?:little|short|brief|tiny|quick|single|bare|scant|full|whole|good) ")
_REST = re.compile(  # how long
    r"^(?:(?:let |have )?(?:it |he |she )?"
    r"(?:waits?|holds?|rests?|pauses?|lingers?|stays?|stands?|remains?|sits?|hangs?)"
    r"(?:ing)?\b(?: (?!for\b)[a-z]+){0,3}? (?:for )?)?"
    rf"(?P<delay>(?:a |one |an? )?(?:{_SMALL.pattern})?{DURATION}|(?:a|one) {_SMALL.pattern}(?:second|sec))$"
)
_SAID_BEFORE = re.compile(r" [.;:?!] ")
_RIGHT = re.compile(r" , (?:yes|right|see|ok|okay)$")


def _divided(spans: Sequence[Span], text: Callable[[Span], str]) -> Iterator[tuple[Span, str, str]]:
    """Each mark with its tag and its words; one that tells a beginning and an end as two."""
    for span in spans:
        both = _BOTH_ENDS.match(text(span)) if span[0] in TIMES else None
        if both is None:
            whole = _AS_ONE.match(text(span)) if span[0] in TIMES else None
            yield span, "in" if whole else span[0], f"while {text(span)[whole.end() :]}" if whole else text(span)
        else:
            yield span, "from", both["a"]
            yield span, "to", both["b"]


def _both(one: Happening, other: Happening) -> Happening | None:
    """The time that two tell: from one until the other, or from when something has happened, while something is so;
    None if they do not go together."""
    if one.during == other.during and None in (one.until, other.until):
        return other if one.until is None else one  # "after its turn, while it walks on to the bed"
    found = one.ended(other) or other.ended(one)
    for begins, lasts in ((one, other), (other, one)) if found is None else ():
        if begins.during.part in ("from", "after") and lasts.during.part == "while" and lasts.until is None:
            return begins.ended(replace(lasts, during=lasts.during.model_copy(update={"part": "until_end"})))
    return found


_BOTH_ENDS = re.compile(
    r"^(?:beginning|starting) (?:with|at|from|on) (?P<a>.+?) and (?:ending|finishing|stopping) (?:with|at|on|when) "
    r"(?P<b>.+)$"
)
_AS_ONE = re.compile(
    r"^(?:start|begin)\w* and (?:finish|end|stop)\w* (?:exactly |together )?(?:when|as|while) (?=the\b|it\b)"
)


def _spoken_of(words: Sequence[str], spans: Sequence[Span], span: Span) -> str:
    """What an instruction says before a mark that points to it, as a time: "the ball touches the wall, yes? From this
    moment ..."."""
    before = _RIGHT.sub("", " ".join(words[: span[1]]).strip(" ,.;:?!"))
    told = _SAID_BEFORE.split(before)[-1].strip(" ,.")
    return f"when {told}" if any(tag in ("x", "y", "not", "off") for tag, _, _ in spans) else ""


def with_both_ends(
    moment: Moment, happening: Happening | None
) -> tuple[tuple[Moment, Happening | None], tuple[str, ...]]:
    """A time that tells its end and how long it lasts with its beginning and its end instead, and the words that tell
    nothing beside them."""
    lasting, stop, start = moment.lasting, moment.stop, moment.start
    if lasting is None or not isinstance(stop, float) or happening is not None:
        return (moment, happening), ()
    if start is None and stop >= lasting:
        return (replace(moment, start=round(stop - lasting, 4), lasting=None, taken=False), None), moment.said
    if isinstance(start, float) and abs(start + lasting - stop) < NEAR:
        return (replace(moment, lasting=None, taken=False), None), moment.said
    return (moment, None), ()


def is_a_time(phrase: str, kind: str) -> bool:
    """Whether words for how much are the time of a kind of wish: "cue its slide back on [three]"."""
    if kind in _OF_NO_TIME:
        return False
    bare = kind == "close" and (alone := amount(phrase)) is not None and alone.unit == ""
    return bare or _AT_A_TIME.match(phrase) is not None


def tells_number(word: str) -> bool:
    return word[0].isdigit() or word in NUMBERS


def _is_later(one: End | None, other: End | None) -> bool:
    """Whether both are seconds, and one is later than the other."""
    return isinstance(one, float) and isinstance(other, float) and one > other


def _as_well(happening: Happening, other: Query, tag: str, phrase: str) -> Happening:
    """The time at which another thing does the same: "when the red book lands, ... when the blue one does"."""
    ends = {"from": "until", "while": "until", "after": "until_end"}
    part = ends.get(happening.during.part, "until") if tag == "to" else happening.during.part
    return Happening(happening.during.model_copy(update={"of": other, "part": part}), phrase)


def _says_nothing(phrase: str, thing: Thing) -> bool:
    """Whether words with a mark of time tell of nothing beside another time: "a good while first"."""
    words = phrase.split()
    told = any(map(tells_number, words)) or _CLAUSE.search(phrase) is not None or names_in(phrase, thing)
    return not told and event_of(phrase) is None


def _begins(happening: Happening) -> bool:
    """Whether what happens is that from which something is to be."""
    return happening.until is None and happening.during.part in ("from", "after")


def _plainer_tag(tag: str, phrase: str, before: str, kind: str, moment: Moment, happening: Happening | None) -> str:
    """The tag of words that tell a time, where they or those before them say what they are: "it lasts", "back at"."""
    begun = isinstance(moment.start, float) or (
        happening is not None and happening.during.part not in ("until", "until_end")
    )
    numbers = isinstance(moment.start, float) or _A_NUMBER.search(phrase) is None
    if tag == "from" and begun and kind != "repeat" and ((kind in _ENDED and numbers) or _ARRIVES.search(before)):
        tag = "to"
    if tag == "from" and kind in LOOKS and _FOR_THE_TIME.match(phrase):
        return "in"  # "just for the moment when it turns"
    if tag == "from" and kind == "move" and _IS_THERE.search(before) and not begun:
        return "to"  # "it has to be there just when the door starts to open"
    if kind == "close" and tag == "to" and _STAYS_OPEN.match(phrase) and re.search(r"\b(?:open|out)\b", before):
        return "from"  # "leave it open till four, then close it"
    if tag == "from" and kind not in LOOKS and _COMPLETED.search(before) and _A_NUMBER.search(phrase):
        tag = "to"
    if tag == "in" and begun and kind in _ENDED and _ONCE.match(phrase):
        return "to"  # "when it gets on the rug it goes yellow, and when it leaves the rug, red"
    if tag == "from" and (UNTIL.match(phrase) or _UP_TO_THEN.search(before)):
        tag = "to"
    if tag == "in" and _AT_A_SECOND.match(phrase) and kind not in LOOKS:
        tag = "from"
    if tag == "for" and begun and before.endswith(" there"):
        return "to"  # "off at 2.5 and there for 4.5"
    return "for" if tag in ("from", "to") and LASTS.match(phrase) else tag


def _told(
    tag: str, phrase: str, said: str, thing: Thing, happening: Happening | None
) -> tuple[Moment | None, Happening | None] | None:
    """The time that words with a tag tell, by rules or else by the kind of what happens; None if they tell none.

    Args:
        phrase: the words without those that only lead to them.
        said: all of the words.
        happening: what happens at the time that is told so far.
    """
    if tag == "from" and (BY_SO_MUCH.match(phrase) or _REASON.match(said)):
        return None
    if (likewise := _LIKEWISE.match(phrase)) is not None and (other := thing(likewise["who"])) is not None:
        if happening is not None:
            return None, _as_well(happening, other, tag, phrase)
        if phrase.split()[-1] in ("does", "do"):
            return None, Happening(During(state="moving", of=other, part="until" if tag == "to" else "from"), phrase)
    if (leg := told_by_leg(tag, phrase, thing)) is not None:
        return None if _HALFWAY.search(phrase) else (None, leg)
    for plainer in dict.fromkeys((phrase, _ONLY.sub("", phrase))):
        told = told_by(tag, plainer, thing)
        if told is not None:
            by_event = told[0] is None and is_told_by_event(phrase)
            return (told_by_event(tag, said, thing) if by_event else None) or told
    if tag in ("from", "to") and (far := amount(phrase)) is not None and far.unit in ("m", "deg"):
        whose = names_in(phrase, thing)[:1]
        how_far = {"degrees": far.value} if far.unit == "deg" else {"distance": {"value": far.value}}
        of = thing(whose[0]) if whose else IT
        fields = {"state": "halfway", "of": of or IT, "part": "until" if tag == "to" else "from", **how_far}
        return None, Happening(During.model_validate(fields), phrase)
    if (moment := numbered(tag, phrase)) is not None:
        return moment, None
    return told_by_event(tag, said, thing)
