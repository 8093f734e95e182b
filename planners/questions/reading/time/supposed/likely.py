"""The likeliest kind of a question, by what the networks tell of it and by its words."""

from __future__ import annotations

from collections.abc import Mapping

from ......gaussians import late_re as re
from .....grammar.tagging.words import bag, clean, split
from .kinds import kinds_of
from .phrases import SUMMED


def likeliest(words: tuple[str, ...]) -> tuple[str, float]:
    """The likeliest kind with its probability; kinds that the networks take for each other are told apart by words."""
    found, said = dict(kinds_of(words)), " ".join(words)
    if not _FILM.search(said):
        found.pop("film_long")
    if _IS_SHUT.search(said):
        _give(found, "if_shut", "if_closes")
    if _YES_OR_NO.search(said):
        found = {kind: chance for kind, chance in found.items() if kind.startswith("if_")}
    if SUMMED.search(said):
        _give(found, "far", "far_opens")
    if "how many times" in said:
        _give(found, "often", "how_many")
    if _RANKS_ALL.match(said):
        _give(found, "order", "first", "last")
    if _CUTS_OUT.search(said) or _OFF_AT.search(said):
        _give(found, "when_stops", "when_starts")
    if _TIMECODE.search(said):
        _give(found, "when_stops", "where_ends")
        _give(found, "when_starts", "where_starts")
    if _CROSSES.search(said):
        _give(found, "long_on", "long_reach")
    if _ON_WHICH_SIDE.search(said) and _best(found) != "if_turns":
        _give(found, "turn_way", "when_turns")
    if _WILL_NOT_REST.search(said):
        _give(found, "what_moves", "what_still")
    if _LAST_PLACE.search(said):
        _give(found, "where_ends", "where_starts", "where_at")
    kind = _best(found)
    if kind in _POSES and _POSED.search(said):
        return "long_open", _sum(found, *_POSES)
    if kind == "when_turns" and _LASTS.search(said):
        return "long_moves", _sum(found, kind, "long_moves")
    if kind == "none" and _COUNTS.search(said) and sorted(found, key=found.__getitem__)[-2] == "how_many":
        return "how_many", _sum(found, "none", "how_many")  # of what stands still, too
    if kind in _WHERES and _WHERE_IS.match(said):
        return "where_at", _sum(found, *_WHERES)
    if kind in ("fast", "fast_most"):
        return ("fast_most" if _GREATEST.search(said) else "fast"), _sum(found, "fast", "fast_most")
    return kind, found[kind]


def _best(found: Mapping[str, float]) -> str:
    """The likeliest kind."""
    return max(found, key=found.__getitem__)


def _sum(found: Mapping[str, float], *kinds: str) -> float:
    """The probability of one of some kinds; those that another has taken have none."""
    return sum(found.get(kind, 0.0) for kind in kinds)


def _give(found: dict[str, float], kind: str, *others: str) -> None:
    """Give the probability of other kinds to one."""
    found[kind] = _sum(found, kind, *others)
    for other in others:
        found.pop(other, None)


_ON_WHICH_SIDE = re.compile(r"^when .*\b(?:is|was) (?:it|that|this) to (?:the|its|his|her) (?:left|right)\b")
_WILL_NOT_REST = re.compile(r"\b(?:refuses?|declines?|fails?) to (?:be|stay|stand|remain|keep|sit)\b")
_LAST_PLACE = re.compile(r"\b(?:terminus|destination|final (?:place|spot|position|resting place))\b")
_POSES = ("long_open", "long_still")
_POSED = re.compile(  # "how long does it just sit there pulled all the way out"
    r"\b(?:all the way|fully|completely|pulled|slid|wide|hang\w*|stick\w*|sits?|stands?|stays?) (?:out|open)\b|"
    r"\b(?:extended|outermost|outstretched)\b"
)
_LASTS = re.compile(r"\b(?:duration|how long|how much time|time (?:\w+ )*?(?:needs?|takes?|spends?|spent))\b")
_CROSSES = re.compile(r"\bcross\w*")
_COUNTS = re.compile(r"\bhow (?:many|much)\b|\bcount\b|\b(?:number|quantity) of\b")
_RANKS_ALL = re.compile(r"^(?:please )?(?:rank|sort|order|arrange|line up)\b")
_CUTS_OUT = re.compile(r"\b(?:cuts?|conks?|gives?|gave|switch(?:es)?|shuts?|powers?) (?:out|off|down)\b")
_OFF_AT = re.compile(r"^(?:(?:the|that|this|our) )?(?:ceiling )?[a-z]+(?<!s) off (?:at|by) (?:what|which)\b")
_TIMECODE = re.compile(r"\b(?:time ?code|time ?stamp|(?:at )?(?:what|which) (?:time|second|moment|instant))\b")
_LEG = re.compile(
    r"(?:(?:(?:during|for|on|in|over|of|along|while on) )?(?:^|(?:the|that|this|its|his|her|'s) )|"
    r"\b(?:during|for|on|in|over|along) )"
    r"(?P<rank>first|opening|initial|second|last|final) (?:straight |walking )?"
    r"(?:leg|stretch|part|bit|section|stage|walk|straight)"
    r"(?: of (?:the|its|his|her) (?:walk|way|trip|path|journey|route))?"
)
_LEGS = {"second": "after it has turned", "last": "after it has turned", "final": "after it has turned"}
OF_A_LEG = bag("fast fast_most far long_moves way")


def goes_first(text: str) -> bool:
    """Whether a question is about one stretch of a way, or about the moment of a first movement, of which other readers
    tell the whole."""
    said = " ".join(word.text for word in split(clean(text)))
    return _LEG.search(said) is not None or _FIRST_MOVE.match(said) is not None


_FIRST_MOVE = re.compile(r"^(?:the )?(?:time ?stamp|time|frame|moment|instant) of (?:the )?(?:first|initial) ")


def without_options(words: tuple[str, ...]) -> tuple[str, ...]:
    """The words without ranks to choose from, where it is asked which one: "top, middle or bottom, which drawer"."""
    said = " ".join(words)
    found = _OPTIONS.search(said)
    if found is None or " or " not in found[0] or not _WHICH.search(said):
        return words
    return tuple(f"{said[: found.start()]} {said[found.end() :]}".split())


_RANK = r"(?:the |an? )?(?:top|upper|middle|bottom|lower|uppermost|lowest|highest)(?: (?:one|drawer|book|shelf))?"
_OPTIONS = re.compile(rf"(?:^|[,:;] ?|\b(?:is it|either) ){_RANK}(?:(?: ?, or| or| ?,) {_RANK})+(?: ?[,:])?(?![\w])")
_WHICH = re.compile(r"\b(?:which|what)\b")


def without_leg(words: tuple[str, ...]) -> tuple[tuple[str, ...], str]:
    """The words without those for one stretch of a way, and the time of that; "" if there are none."""
    said = " ".join(words)
    if (leg := _LEG.search(said)) is None:
        return words, ""
    rest = " ".join(f"{said[: leg.start()]} {said[leg.end() :]}".split())
    return tuple(rest.split(" ")), _LEGS.get(leg["rank"], "before it turns")


_FILM = re.compile(
    r"\b(?:film|clip|video|scene|movie|footage|recording|shot|sequence|animation|thing|it all|"
    r"whole)\b"
)


_WHERES = ("where_at", "where_ends", "where_starts")
_WHERE_IS = re.compile(r"^where (?:is|are|was|were) ")
_IS_SHUT = re.compile(r"\bis (?:the|that|my|our|every)\w*\b.*\b(?:shut|closed)\b")


def asks_why(kind: str, said: str, asked: str) -> bool:
    """Whether words ask for a cause, or for what somebody does or feels, or only for one stretch of a way.

    Args:
        asked: those that ask for something.
    """
    if _CAUSES.search(said) or _A_STRETCH.search(said) or _FEELS.search(asked):
        return True
    return kind not in _OF_SOMEBODY and _REASONS.search(said) is not None


_CAUSES = re.compile(
    r"\bwhat (?:is it that )?(?:made|makes|shook|shakes|pushed|pushes|drives|caused|causes|knocked|knocks|"
    r"shoved|tipped|bumped|kicked|toppled|blew|threw) (?!over$)|\bwhy\b|"
    r"\bbecause (?:he|she|it|they) (?:'s|is|are|was|were|feels?|felt|wants?|wanted)\b|"
    r"\bthat (?:drove|made|pushed|caused)\b|\bwhat (?:induce[sd]|prompt(?:s|ed)|trigger(?:s|ed)|led|got|sets|set) "
    r"(?:the|it|him|her)\b|"
    r"\b(?:motives?|intentions?|intended|meant to|on whose)\b|"
    r"(?<!\bby )\bcolou?rs?\b"
)
_FEELS = re.compile(
    r"\bfeel(?:s|ing)?\b|\b(?:is|was|were|are|be|been|felt|get|gets|got) (?:the |it |he |she |they )?(?:[a-z]+ ){0,3}?"
    r"(?:frightened|afraid|scared|happy|unhappy|sad|angry|tired|exhausted|bored|hurt|lonely|nervous|shy|proud|ashamed|"
    r"jealous|hungry|thirsty|cold|sleepy|dizzy|worried|excited|upset|in pain)\b"
)
_A_STRETCH = re.compile(r"\b(?:first|second|last|final) (?:leg|stretch|part|half|bit|section|stage)\b")
_YES_OR_NO = re.compile(
    r"\b(?:yes or no|true or (?:false|not|nah)|right or wrong|is (?:that|this) (?:so|right|true|correct)|confirm|"
    r"am i right|that right|is it true)\b|, (?:right|correct|yes|true) \?$"
)
_REASONS = re.compile(
    r"\b(?:reason|explain|because of|caus(?:e|es|ed|ing)|blame|on purpose|who(?:m|se)?|somebody|someone)\b"
)
_OF_SOMEBODY = bag("first last order fastest what_moves what_still happens does how_many where_at where_ends near")
_GREATEST = re.compile(
    r"\b(?:top(?= (?:speed|pace|rate|velocity)\b)|max|maximum|maximal|peak|highest|greatest|fastest|most|record)\b"
)
