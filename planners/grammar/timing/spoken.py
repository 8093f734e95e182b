"""What is written as it is spoken: "start movin it soon as the drawer's shuttin"."""

from __future__ import annotations

from ....gaussians import late_re as re
from ..tagging.spelling import is_word
from ..vocabulary.nouns import is_known
from .verbs import SENSES, has_form

_DROPPED = re.compile(r"\b(?P<stem>[A-Za-z]{2,}in)(?:'(?![A-Za-z]))?(?![\w'])")
_SOON_AS = re.compile(r"(?<!\bas )\bsoon as\b", re.IGNORECASE)
_DO_NOT_BE = re.compile(r"\b(?P<not>do not|don't|dont) be (?P<doing>[a-z]+ing)\b", re.IGNORECASE)


_VOCATIVE = re.compile(  # "pick it up, love, and lay it on the desk"
    r", (?:my )?(?:love|dear|darling|mate|honey|sweetheart|sweetie|pal|buddy|boss|sir|madam|friends?|folks|listeners|"
    r"baby|babe|kiddo|lads)(?=[,.!?:]|$)",
    re.IGNORECASE,
)
_OFF_AT = re.compile(r"^(?:the )?(?P<thing>[a-z]+(?: fan)?) off (?=(?:at|after|once|when|until|till) )", re.IGNORECASE)
_TOO_CLUTTERED = re.compile(  # a reason: "remove the chair, too cluttered"
    r"^(?P<order>(?:please |just )?(?:remove|delete|hide|lose|ditch|scrap|bin|take|paint|get rid) [^,.]+), "
    r"(?:it's |it is )?(?:way |far |a bit |just )?too [a-z]+[.!]?$",
    re.IGNORECASE,
)
_IT_IS = re.compile(  # "its so slow"
    r"\b(?P<it>its) (?=(?:so|too|really|way too|not|just|still|all the way|a bit|going to|supposed to) )|"
    r"(?<=time )its (?=(?:on|in|at|off|up|out|[a-z]+ing)\b)",
    re.IGNORECASE,
)


_PLAINER = tuple(  # turns of phrase and their plain words, one after the other
    (re.compile(pattern, re.IGNORECASE), plain)
    for pattern, plain in (
        (r"\bwould sooner\b|(?<=\bi)'d sooner\b|(?<=\bwe)'d sooner\b", " would rather"),
        (r"\ba single (?=second|turn|minute)", "one "),
        (  # which goes without saying
            r",? (?:and|n|&|then) (?:then )?(?:keep|leave) (?:it|him|her|them) "
            r"(?:that way|like that|so|thus)(?=[.!]*$)",
            "",
        ),
        (r"\b(?:triggered|prompted|cued) by (?=(?:the|a|my|our) [a-z ]+?ing\b)", "upon "),
        (  # that something is so
            r"\b(?:for |during )?(?:the (?:whole|entire) time|all the time) (?:that |when )?"
            r"(?=(?:it|he|she|the [a-z]+) (?:is|rolls|moves|turns|spins|walks|opens|falls|stands)\b)",
            "while ",
        ),
        (  # slang
            r"(?:(?:,? (?:no cap|lol|lmao|haha+|innit|tbh|imo))|, (?:bro|bruh|fam|dude|lads))+[.!]*$",
            "",
        ),
    )
)
_TITLE = re.compile(  # "TC-01: ...", "Requirement 4.1: ..."
    r"^(?:(?:test ?case|tc|req|requirement|test|case|step|task|shot|cue|note|item|ticket|bug|spec)\b[ #]?[\w.-]*|"
    r"[a-z]{1,4}-?\d[\w.-]*) ?: +(?=\w)",
    re.IGNORECASE,
)
_NOTATION = tuple(  # of times and rates
    (re.compile(pattern, re.IGNORECASE), plain)
    for pattern, plain in (
        (r"(?<![\w,.])(?P<a>\d{1,2}),(?P<b>\d{1,2})(?![\w,.]*\d)", r"\g<a>.\g<b>"),
        (r"(?<![\w.])(?P<n>\d+(?:\.\d+)?) ?(?:ms|milliseconds?)\b", lambda m: f"{float(m['n']) / 1000:g} s"),
        (r"(?<![\w.])(?P<n>\d+(?:\.\d+)?) ?rpm\b", lambda m: f"{round(float(m['n']) / 60, 4):g} turns per second"),
        (
            r"\b(?P<what>turns?|rotations?|rev(?:olution)?s?|spins?|rounds?) ?/ ?s(?:ec(?:onds?)?)?\b",
            r"\g<what> per second",
        ),
        (r"(?<=[a-z]) lets go(?= ?(?:$|[,.;!?]|and\b|of (?:the|its)\b))", " falls"),
        (r"(?<=\bby )point (?=(?:one|two|three|four|five|six|seven|eight|nine)\b)", "zero point "),
        (r"(?<![\w.])(?P<n>0?\.\d+) of a sec(?:ond)?\b", r"\g<n> seconds"),
        (r"(?<=[a-z]) along with (?:it|him|them)(?= ?(?:$|[.!]))", " too"),
        (r"(?<=\bby )\+ ?(?=\d)", "plus "),
        (r"(?<=\bby )[-−–] ?(?=\d)", "minus "),
        (
            r"(?P<what>\b(?:turns?|rotations?|revolutions?|spins?|rounds?|times)) (?P<each>an?|per|each|every) sec\b",
            r"\g<what> \g<each> second",
        ),
        (r"\b(?:in the )?(?:time )?(?:interval|window|range) (?=\[)", ""),
        (
            r"\[ ?(?P<a>\d+(?:\.\d+)?)(?: ?s)? ?(?:,|;|-|–|\.\.+) ?(?P<b>\d+(?:\.\d+)?)(?: ?s)? ?\]",
            r"from \g<a> s to \g<b> s",
        ),
        (r"\bt_?(?:start|begin|0) ?= ?", "from "),
        (r"\bt_?(?:end|stop|1) ?= ?", "to "),
        (
            r"(?<![\w.:-])(?:from )?(?P<a>\d+\.\d+)(?: ?s)? ?[-–] ?(?P<b>\d+(?:\.\d+)?)(?: ?s)?"
            r"(?= ?(?:$|[,;!?)]|\.(?!\d)))",
            r"from \g<a> s to \g<b> s",
        ),
    )
)


_FROM_ROOM = re.compile(  # which all of it is in
    r"^(?P<order>(?:please |can you |could you |just )*(?:remove|delete|take|get rid|clear|strike|erase) .+?),? "
    r"(?:from|out of|in) (?:the|this|my|our) (?:entrance )?(?:hall|hallway|corridor|(?:living |dining |bed ?)?room|"
    r"kitchen|bedroom|bathroom|office|scene|picture|image|film|video|clip|shot)"
    r"(?P<end> altogether| for good| please)?[.!?]*$",
    re.IGNORECASE,
)


_DIGITS = {word: str(digit) for digit, word in enumerate(
    ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine")
)}  # fmt: skip
_A_DIGIT = "|".join(_DIGITS)
_POINT = re.compile(rf"\b(?P<whole>{_A_DIGIT}|\d+) point (?P<part>(?:{_A_DIGIT})(?: (?:{_A_DIGIT}))?)\b", re.IGNORECASE)
_B4 = re.compile(r"\bb4\b", re.IGNORECASE)


def in_figures(text: str) -> str:
    """A text with decimals in figures, and with what is written as a figure in words: "one point five s", "b4"."""

    def figure(found: re.Match[str]) -> str:
        part = "".join(_DIGITS[word] for word in found["part"].lower().split())
        return f"{_DIGITS.get(found['whole'].lower(), found['whole'])}.{part}"

    return _POINT.sub(figure, _B4.sub("before", text))


def written(spoken: str) -> str:
    """A text with the words in full that people shorten when they speak or write notes."""
    text = _TITLE.sub("", _VOCATIVE.sub("", spoken))
    for pattern, plain in _NOTATION:
        text = pattern.sub(plain, text)
    text = in_figures(text)
    text = _FROM_ROOM.sub(r"\g<order>\g<end>", _TOO_CLUTTERED.sub(r"\g<order>", text))
    text = _OFF_AT.sub(_switched, _IT_IS.sub("it is ", text))
    for pattern, plain in _PLAINER:
        text = pattern.sub(plain, text)
    text = _SOON_AS.sub("as soon as", with_endings(text))
    return _DO_NOT_BE.sub(_prohibited, text)


def with_endings(text: str) -> str:
    """A text with the last letter of verbs: "leavin' the rug" is leaving it."""
    return _DROPPED.sub(_in_full, text)


def _switched(found: re.Match[str]) -> str:
    """A thing that is to be off: "fan off at 2 s", and not "set off at 2 s"."""
    thing = found["thing"].lower().split(" ")[-1]
    is_thing = is_known(thing) and not has_form(thing, tuple(SENSES), "plain")
    return f"switch the {found['thing']} off " if is_thing else found[0]


def _prohibited(found: re.Match[str]) -> str:
    """A prohibition to be doing something, as one to start it: "do not be opening it", and not "do not be boring"."""
    doing = found["doing"].lower()
    moves = has_form(doing, tuple(SENSES), "ing") and not is_known(doing)
    return f"{found['not']} start {found['doing']}" if moves else found[0]


def _in_full(found: re.Match[str]) -> str:
    """A verb with its last letter: "openin" is opening, a cabin is none."""
    stem = found["stem"].lower()
    verb = has_form(f"{stem}g", tuple(SENSES), "ing") and not is_known(stem) and not is_word(stem)
    return f"{found['stem']}g" if verb else found[0]
