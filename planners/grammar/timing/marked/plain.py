"""Marked words of time in the plain words that the readers of times know: "once two seconds have passed" is at 2 s."""

from __future__ import annotations

from .....gaussians import late_re as re
from ...vocabulary.quantities import NUMBERS, ORDINALS
from ..manner import Thing

_NUMBER = rf"(?:\d+(?:\.\d+)?|{'|'.join(NUMBERS)})"
_SECONDS = rf"{_NUMBER}(?: and a half)? (?:seconds?|secs?|s)"
_ORDINAL = rf"(?:{'|'.join(ORDINALS)}|\d+(?:st|nd|rd|th))"
_FILM = r"(?:film|clip|video|movie|scene|shot|animation|footage|sequence|show|take)"
_STATES = r"open|opened|shut|closed|out|up|down|in|on|off|over|done|half|halfway|all|fully|at|past|still|stopped|moving"
_BRIEFLY = (
    r"moment|beat|bit|little|little bit|while|little while|breath|heartbeat|instant|spell|tick|sec|touch|short while"
)
_GONE = r"(?:has|have|had|is|are|'s|was) (?:passed|elapsed|gone(?: by)?|over|up|past|out|in)"
_WAYS = r"movement|motion|slide|climb|run|ride|trip|roll|walk|drop|fall|way|journey|swing|turn|descent|opening|closing"
_LENGTHS = (
    r"(?:travel(?:l?ing)?|run(?:ning)?|transit|trip) ?time|duration|time|length|dur|total|travel|lasting|taking|long"
)
_ALWAYS, _TO_THE_END = "the whole time", "until the end"
_TABLE: tuple[tuple[str, str, str], ...] = (  # tags, none: all; words; what they are put as
    ("", rf"\bits (?=(?:{_STATES}|(?!opening|closing|turning|landing|ending)[a-z]+ing)\b)", "it is "),
    ("", rf"\ba(?:nother)? (?:good|full|whole|solid|entire|complete|proper|mere|further) (?={_SECONDS})", ""),
    (
        "",
        r"(?P<unit>\b(?:seconds?|secs?)) (?:tops|max|at most|at least|(?:in )?total|altogether|each|maybe|or so)$",
        r"\g<unit>",
    ),
    ("", r" (?:, )?(?:at the (?:very )?latest|at the earliest|perhaps|maybe|on the clock|only)$", ""),
    (
        "",
        r"^(?P<word>for|in|during|over)? ?(?:only|just|no (?:fewer|less|more) than|at least|at most) "
        rf"(?=(?:the )?(?:first|last|{_NUMBER})\b)",
        r"\g<word> ",
    ),
    (
        "for",
        rf"^(?:,|with|a|an|its|the|only|total|and)*(?: ?(?:{_LENGTHS})(?: ?(?:of|is|:|=|should be))?) (?=.*{_SECONDS})",
        "",
    ),
    (
        "for",
        rf"(?<=[sd]) (?:for (?:it|that)|of (?:travel|rest|silence|pause|waiting|stillness)|{_LENGTHS}|pause|break|"
        r"rest)(?: .*)?$",
        "",
    ),
    ("for", rf"^of (?={_SECONDS})", ""),
    ("for", r" 's$", ""),
    ("from", rf"^in (?={_SECONDS}$)", "at "),
    (
        "in for to",
        rf"^(?:for |in )?(?:as|so) long as (?:the |this )?(?:{_FILM}|picture) "
        r"(?:lasts|runs|goes on|plays|is on|is running)$",
        "the whole time",
    ),
    ("in", r"^long as\b", "as long as"),
    ("in", r"^in (?=(?:along|together|step|sync|tandem|time|unison) )", ""),
    ("in", r"^(?:just |only )+(?=for|during|while|in|on)", ""),
    (
        "in from",
        r"^(?:just |only )?(?:for|during) (?P<whose>the|its|his|her) "
        r"(?P<event>turn|fall|roll|walk|swing|drop|opening|closing|slide)(?: itself)?$",
        r"during \g<whose> \g<event>",
    ),
    ("", r"\bthe (?:edge|border|rim|side) of (?=the )", ""),
    ("from", r"^having (?:stopped|come to (?:a stop|rest|a halt))(?: at .+)?$", "after it has stopped"),
    ("for", r"^time taken (?:is )?", ""),
    ("for", rf"^(?:frame|t|time) (?={_SECONDS})", "at "),
    ("", rf"\bthe usual (?={_NUMBER}\b)", ""),
    ("", r"\bbusy (?=[a-z]+ing\b)", ""),
    ("", rf"\bthe (?P<n>{_NUMBER}) second (?:mark|point)\b", r"\g<n> seconds"),
    (
        "in",
        r"^(?:during|throughout|in|over|for) (?:the|its|his|her) (?P<doing>[a-z]+ing)"
        r"(?P<way>(?: (?:open|shut|out|back|in|down|away))*) of (?P<who>(?:the|my|our) .+)$",
        r"while \g<who> is \g<doing>\g<way>",
    ),
    (
        "",
        r"\b(?:the )?(?:impact|landing|touchdown) of (?P<who>(?:the|my|our) (?:[a-z]+ )?[a-z]+)",
        r"when \g<who> lands",
    ),
    ("in", r"(?<=lands and )that of (?P<who>(?:the|my|our) (?:[a-z]+ )?[a-z]+)$", r"when \g<who> lands"),
    ("from", r"^(?:immediately|directly|right|straight|just|shortly) (?=(?:after|when|once|as)\b)", ""),
    ("from", r"^after (?:its|his|her|the) (?:\d+ (?:degrees? )?|left |right |first )?turn$", "after it has turned"),
    ("from", r"^having been (?=[a-z])", "once it has been "),
    ("from", r"^having (?:made|done|taken|finished|completed) (?:its|his|her|the) turn$", "after it has turned"),
    (
        "from to",
        r"^(?:when|once|as soon as|after|until|till|before|only when|not until) "
        rf"(?:the first |about |around |we are at |there (?:are|is|have been) )?(?P<time>{_SECONDS})(?: {_GONE})?$",
        r"at \g<time>",
    ),
    ("from to", rf"^(?:when|once|as soon as|after|until|till|before) (?:the )?first second {_GONE}$", "at 1 seconds"),
    ("from", r"^(?:no|not) (?:earlier|sooner) than (?=\w)", "at "),
    ("from", r"^not (?:before|until|till) (?=(?:the|it|he|she) )", "once "),
    ("from", rf"^not (?:before|until|till) (?={_NUMBER})", "at "),
    ("from to", r"^(?:with effect )?from (?=second \w+$)", "at "),
    (
        "from",
        r"^(?:at|from|on|in) (?:the|that) (?:very |exact |same )?(?:moment|instant|time|second|sec) "
        r"(?:that |when |as |at which )?(?=(?:the|it|he|she|they) )",
        "when ",
    ),
    (
        "from to in",
        r"^(?P<word>once|when|while|after|as soon as|until|till|before) "
        r"(?P<state>(?:fully |half |all the way )?(?:open|shut|closed|out|up|down|in|raised|lowered|there))$",
        r"\g<word> it is \g<state>",
    ),
    ("from", r"^at (?P<state>half open|half way open)$", r"when it is \g<state>"),
    ("from", rf"^after (?:its|his|her|the) (?:{_WAYS})$", "after it has stopped"),
    ("in", r"^on (?:its|his|her|the) way(?: [a-z]+)?$", "while it is moving"),
    ("from", r"^on (?:its|his|her|the) way(?: [a-z]+)?$", "when it is halfway"),
    (
        "in to",
        r"^(?:(?:for|in|over|during|through(?:out)?|(?:until|to) the end of) )?(?:all )?the (?:whole )?"
        r"(?:rest|remainder|remaining (?:time|frames|seconds)|last bit|time that is left)"
        rf"(?: of (?:the|this|it) ?(?:{_FILM})?)?$",
        _TO_THE_END,
    ),
    (
        "in for to",
        r"^(?:for good|for ever|forever|ever|at any (?:point|time)|at no time|non ?stop|for keeps|for all time|"
        r"permanently|(?:stays |constant |unchanging |unchanged )?(?:in|over|through) (?:all )?time|"
        r"(?:for|in|at|on|over) (?:all|every|each) (?:t|times?|frames?|seconds?)|at all|all along|"
        r"(?:for|at) (?:any|every|all) (?:t|moment)|"
        r"through to the credits|until we fade out|(?:until|till) the credits(?: roll)?)$",
        _ALWAYS,
    ),
    (
        "in",
        rf"^(?:(?:the )?(?:full|complete|entire|whole) (?:time|{_FILM})|(?:all|the whole|whole) (?:{_FILM} )?long|"
        r"for all the duration|for the (?:full|whole|entire) (?:length|duration)|"
        r"(?:from )?(?:the )?(?:very )?(?:start|first(?: frame)?|beginning) to (?:the )?(?:very )?(?:last|finish|end)"
        r"(?: frame)?|to finish)$",
        _ALWAYS,
    ),
    (
        "in",
        rf"^(?:for |over |during |within )?(?:all|these)(?: of)?(?: the)? {_NUMBER} (?:seconds|secs)"
        rf"(?: of (?:it|the {_FILM}|this))?$",
        _ALWAYS,
    ),
    (
        "in for to",
        rf"^(?:for |over |during |in |on |within )?(?:(?:all|these)(?: of)?(?: the)? {_NUMBER} (?:seconds|secs|s)|"
        rf"(?:all|every|the (?:whole|full)|whole|full|entire) (?:of )?(?:the |its )?"
        rf"(?:frames?|length|timeline|{_FILM})|"
        r"(?:from )?(?:the )?(?:start|top|beginning) to (?:the )?(?:end|tail|bottom|finish))$",
        _ALWAYS,
    ),
    ("for", rf"^(?:for )?(?:just )?(?:briefly|an? (?:short |brief |wee |quick )?(?:{_BRIEFLY}))$", "for 1 seconds"),
    ("from", r"^(?:from|after|at) (?:the )?(?:off|get go|word go|very start)$", "from the start"),
    (
        "to",
        r"^(?:right |up |all the way |together |only )*(?:when|as|with|until|till|by|to|before|past)?(?: the)?"
        rf"(?: very)? (?:(?:{_FILM} )?(?:end(?:s|ing)?|out point)|final frame|closing second|last frame|"
        r"curtain(?: falls?| call)?|"
        rf"credits(?: roll)?|tail(?: of (?:the |this )?{_FILM})?|picture goes (?:black|dark)|clock runs (?:down|out)|"
        rf"screen goes (?:black|dark)|{_FILM} (?:ends|is over|finishes|stops)|fade(?: ?out)?)$",
        _TO_THE_END,
    ),
)
_PLAIN = tuple((tags.split(), re.compile(pattern), said) for tags, pattern, said in _TABLE)
_IN_THE = re.compile(rf"^(?:in|during|for|within) (?:the )?(?P<rank>{_ORDINAL}) second$")
_AT_THE = re.compile(rf"^at (?:the )?(?P<rank>{_ORDINAL}) second$")


def plain(tag: str, phrase: str) -> str:
    """Words with a tag of time in plain words, or as they are."""
    for tags, pattern, said in _PLAIN:
        if not tags or tag in tags:
            phrase = pattern.sub(said, phrase).strip(" ,")
    if (span := _IN_THE.match(phrase)) is not None and tag == "in" and (rank := _rank(span["rank"])) > 1:
        return f"from {rank - 1} seconds to {rank} seconds"
    if (point := _AT_THE.match(phrase)) is not None:
        return f"at {_rank(point['rank'])} seconds"
    return phrase


def _rank(word: str) -> int:
    return ORDINALS.get(word) or int(re.sub(r"\D", "", word))


_CLAUSE = re.compile(
    r"^(?P<word>once|after|when|as soon as|before|until|till|while|as|whilst|during the time) (?P<said>[a-z ]+)$"
)
_NOT_MOVING = re.compile(
    r"\b(?:not|no|never|still|stands?|standing|sits?|sitting|rests?|resting|lies|lying|waits?|waiting|"
    r"parts?|half|bits?|legs?|laps?|steps?|first|second|third)\b"
)
_OVER = re.compile(
    r"^(?: ?(?:is|are|'s|was|has|have|had)(?: been)?)?(?: all)? (?:done|through|up|complete|finished|inside|past|by|"
    r"over|gone|in place|parks?|parked|quits?|dies|settles?|settled|docks?|docked|dead|dies down|gives? up|calms? down|"
    r"(?:[a-z]+ )?to (?:rest|an? (?:\w+ )?(?:standstill|stop|halt))|pulled up|drawn up|"
    r"cuts?(?: out)?|conks out|powers down|(?:switches|shuts|turns) off)(?: .*)?$"
)
_PATH = (
    r"(?:by|past|over|across|through|along|around|round|about|away|off|in|into|out|up|down|to|towards?|at|near|home)"
)
_HAS = re.compile(
    r"^ ?(?:has|have|had|'s) (?!been\b|to\b)(?:\w+ly )?(?:passed|crossed|finished|ended|arrived|docked|parked|"
    rf"settled|landed|reached|[a-z]+(?:ed|en|ne|un|wn|ot|id|it|ept|ode|own) {_PATH})\b"
)
_GOES_ON = re.compile(
    r"^ ?(?:(?:is|are|'s) (?:\w+ly )?(?:passing|crossing)|passes|crosses|"
    rf"(?:(?:is|are|'s) )?[a-z]+(?:ing|s)(?<!wear)(?<!look)(?<!looking)(?<!looks) {_PATH})\b"
)
_BACK_IN = re.compile(r"^(?:is|are|'s|has|have)(?: \w+){0,4} back in(?: again)?$")
_OVER_IT = re.compile(r"\b(?:over|across|along) (?P<what>it|the [a-z]+)\b")


def loosely(phrase: str, thing: Thing) -> str | None:
    """A clause whose verb is not known, as one of a thing that moves or has stopped: "once the dog has trotted past";
    None for others."""
    found = _CLAUSE.match(phrase)
    if found is None:
        return None
    words = found["said"].split(" ")
    for size in range(len(words) - 1, 0, -1):
        who, rest = " ".join(words[:size]), " ".join(words[size:])
        if thing(who) is None or _NOT_MOVING.search(rest):
            continue
        if _BACK_IN.match(rest):
            return f"{found['word']} {who} has closed"
        if _OVER.match(f" {rest}") or _HAS.match(rest):
            return f"{found['word']} {who} has stopped"
        if found["word"] in ("while", "whilst") and _GOES_ON.match(rest):
            over = _OVER_IT.search(rest)
            return f"while {who} is on {over['what']}" if over else f"while {who} is moving"
    return None
