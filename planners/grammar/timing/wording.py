"""The words of an instruction as the readers of time want them: in full, spelt right, and without noise."""

from __future__ import annotations

from functools import cache

from ....gaussians import late_re as re
from ....gaussians.world.spelling import best_slip
from ..tagging.spelling import is_word
from ..tagging.words import bag, split
from ..vocabulary.quantities import NUMBERS
from . import phrases
from .asides import without_comparisons
from .marked.names import with_ranked_noun
from .restated.restating import restated
from .sentences import folded
from .verbs import SENSES, forms, has_form


def spelt_out(said: str) -> str:
    """Words with "is" and "has" in full behind names: "the ball 's stopped" has stopped, "the door 's open" is open."""

    def verb(found: re.Match[str]) -> str:
        return "has" if has_form(found["then"], tuple(SENSES), "past") and found["then"] != "open" else "is"

    return " ".join(_SHORT_VERB.sub(lambda m: f" {verb(m)} {m['then']}", _FILLER.sub(" ", said)).split())


_FILLER = re.compile(r"(?: ,)? (?:uh|um|uhm|er|erm|hmm|(?<! as )well)(?: ,)?(?= )")
_SHORT_VERB = re.compile(
    r"(?<!second)(?<!seconds) 's (?P<then>[a-z]+(?:ing|ed)|"
    r"got|made|taken|to|fully|completely|all|just|already|been|done|open|closed|shut|out|in|gone|hit|"
    r"left|fallen|come|begun|slid|stopped|reached|way|too|so|not)\b"
)


_STAMP = re.compile(
    r"(?<![\d:])(?P<minutes>\d{1,2}):(?P<seconds>[0-5]\d)(?![\d:])(?: ?(?:s|secs?|seconds)\b)?"
)  # "0:02"


_FILM_ENDS = re.compile(
    r"\b(until|till|when|as|once) (?:the )?(?:whole )?(?:film|clip|video|movie|scene|shot) (?:ends|finishes|stops|"
    r"(?:is|has) (?:over|done|finish(?:ed)?|ended|through))",
    re.IGNORECASE,
)
_FILM_BEGINS = re.compile(
    r"\b(?:(?:right |just )?(?:when|as|once)|the moment) (?:the )?(?:film|clip|video|movie|scene|shot) "
    r"(?:begins|starts)",
    re.IGNORECASE,
)
_CLOSE = re.compile(r"(?<=\b(?:to|ll|il|at) )the (?:close|finale)\b", re.IGNORECASE)
_DOTS = re.compile(r"(?<=[a-z])\.\.+ ")
_NUMBER = rf"(?:\d[\d.]*|half|{'|'.join(NUMBERS)})"
_DIGITS = r"\d+(?:\.\d+)?"
_SYNONYMS = tuple(
    (re.compile(rf"\b{said}\b", re.IGNORECASE), plain)
    for said, plain in (
        (r"(?:over|in) the course of the(?= (?:last|first))", "in the"),
        (r"the initial(?= [a-z0-9.]+ sec)", "the first"),
        (r"thereafter", "afterwards"),
        (
            r"no sooner (?P<be>is|has|does|was|had) (?P<who>(?:the|my|our) (?:[a-z]+ )?[a-z]+) (?P<what>[a-z ]+?) than",
            r"as soon as \g<who> \g<be> \g<what> ,",
        ),
        (
            rf"(?:for )?(?P<a>{_DIGITS}) ?s? ?(?:≤|<=|<) ?t ?(?:≤|<=|<) ?(?P<b>{_DIGITS}) ?(?:s\b)?",
            r"from \g<a> s to \g<b> s",
        ),
        (rf"(?:for )?(?:all )?t ?(?:≥|>=|>) ?(?P<a>{_DIGITS}) ?(?:s\b)?", r"from \g<a> s on"),
        (rf"(?:for )?(?:all )?t ?(?:≤|<=|<) ?(?P<a>{_DIGITS}) ?(?:s\b)?", r"until \g<a> s"),
        (rf"(?P<a>{_DIGITS}(?: ?s)?) ?(?:…|→|\.\.\.?) ?(?:t ?= ?)?(?={_DIGITS})", r"\g<a> to "),
        (r"in (?:lieu|place) of", "instead of"),
        (
            r"\b(?:on|at) (?:the )?(?:very |far )?end of (?:the )?(?P<what>rug|carpet|mat)\b",
            r"when it leaves the \g<what>",
        ),
        (r"where (?P<what>the [a-z]+) (?:ends|finishes)(?= ?(?:$|[,.;!?]))", r"when it leaves \g<what>"),
        (
            r"(?:the )?\bdrawer (?:of|in|at|on)(?: the)? (?P<rank>middle|top|bottom)"
            r"(?= ?(?:$|[,.;:!?]| (?:is|has|should|must|may|can|opens?|comes?|slides?|stays?|out|to|at|by|from)\b))",
            r"the \g<rank> drawer",
        ),
        (r"takes? five(?= ?(?:[,;]|at|from|right|until|between)\b)", "pauses"),
        (r"(?P<rank>first|last) of all(?= (?:the|my|our)\b)", r"\g<rank>"),
        (r"(?:all|all along|all through) the (?=film|clip|video|movie)", "for the whole "),
        (rf"(?P<lead>at|by|for|in|to|from|after|up|until|around) like (?={_NUMBER}\b)", r"\g<lead> "),
        (r"(?P<rank>first|last) second and a half", r"\g<rank> 1.5 seconds"),
        (r"(?P<word>until|while|when) ?, (?:and|but) only (?P=word) ?,?", r"\g<word>"),
    )
)
_DIGIT_WORDS = "one|two|three|four|five|six|seven|eight|nine"
_HUNDRED = re.compile(
    r"\b(?P<count>an?|one|two|three)(?: full| whole| good)? hundred"
    rf"(?:(?: and|,)? (?P<more>(?:{'|'.join(NUMBERS)})(?:[ -](?:{_DIGIT_WORDS}))?))?\b",
    re.IGNORECASE,
)


def _hundreds(found: re.Match[str]) -> str:
    """A number from a hundred on in digits."""
    more = re.split(r"[ -]", found["more"]) if found["more"] else []
    count = NUMBERS.get(found["count"].lower(), 1)
    return str(100 * count + sum(NUMBERS[word.lower()] for word in more))


_MILLISECONDS = re.compile(
    r"(?<![\d.])(?P<n>\d{1,5}) ?(?:(?P<unit>(?:ms|msecs?|milliseconds?)\b)|"
    r"(?=(?:and|to|-|–) ?\d{1,5} ?(?:ms\b|millisec)))",
    re.IGNORECASE,
)
_WITHIN = re.compile(r" ?(?:±|\+/-) ?\d+(?:\.\d+)? ?(?:s|secs?|cm|mm|m|deg|degrees?|%|°)?(?![\w])", re.IGNORECASE)
_NO_NEED = re.compile(r"(?: ?,)? (?:and |there is )?no need to (?:wait|hurry|rush)\b[^,.;!]*", re.IGNORECASE)


def in_words(cleaned: str) -> str:
    """The words and marks of an instruction, with spaces between."""
    cleaned = _FILM_ENDS.sub(r"\g<1> the end", _FILM_BEGINS.sub("at the start", _NO_NEED.sub("", cleaned)))
    cleaned = _DOTS.sub(". ", _CLOSE.sub("the end", cleaned))
    cleaned = _WITHIN.sub("", cleaned)
    for pattern, plain in _SYNONYMS:
        cleaned = pattern.sub(plain, cleaned)
    cleaned = _MILLISECONDS.sub(
        lambda m: f"{int(m['n']) / 1000:g} s" if m["unit"] else f"{int(m['n']) / 1000:g}", cleaned
    )
    cleaned = _HUNDRED.sub(_hundreds, cleaned)
    stamped = _STAMP.sub(lambda m: f"{60 * int(m['minutes']) + int(m['seconds'])} s", cleaned)
    ranged = phrases.RANGE.sub(lambda m: f"from {m['a'] or m['c']} to {m['b'] or m['d']} s", stamped)
    return " ".join(w.text for w in split(ranged))


def spelt_right(said: str, known: frozenset[str]) -> str:
    """The words with those that are none as the known word from which they differ by a slip."""
    right = known | _SPELLED_WORDS
    return " ".join(w if w in right or len(w) < 3 or not w.isalpha() or is_word(w) else best_slip(w, known) or w
                    for w in said.split(" "))  # fmt: skip


@cache
def timely_words() -> frozenset[str]:
    verbs = {word for sense in SENSES.values() for verb in sense.split(", ") for word in verb.split()}
    inflected = {form for verb in verbs if verb.isalpha() for form, _ in forms(verb)}
    return frozenset(inflected | _SPELLED_WORDS | set(NUMBERS))


_SPELLED_WORDS = bag(
    "the and should must while until after before between during when once then than second seconds twice times half "
    "speed faster slower later earlier backwards slowly quickly everything whole again only from with into "
    "completely fully entirely late early"
)
LONG_WORDS = frozenset(word for word in _SPELLED_WORDS if len(word) > 4)


_MANY_COMMAS = re.compile(r"(?: ,)+")


def tidy(said: str) -> str:
    """What is written, in words that the readers know."""
    for _ in range(3):
        said = phrases.NOISE.sub("", said).strip(" ,.!?\n")
    said = _MANY_COMMAS.sub(" ,", said)
    said = restated(with_ranked_noun(without_comparisons(said)))
    for pattern, plain in phrases.RESTATED:
        said = pattern.sub(plain, said)
    said = folded(said)
    said = re.sub(
        r"^(?:can|could|would|will|may|should|must|shall) (?=(?:the|my|our|this|that|all|every|it) )",
        "",
        said.strip(" ,."),
    )
    return " ".join(_MANY_COMMAS.sub(" ,", said).split())
