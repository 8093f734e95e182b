"""Whether a question says more than its kind and its marks: a negation, a number, a comparison, a rank, a thing."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from ......gaussians import late_re as re
from ......gaussians.world.words import singular
from .....grammar.tagging.words import bag
from .....grammar.vocabulary.quantities import NUMBERS
from ...noun_phrase import is_color_word
from ..loosely import HARD
from .phrases import ALL_OF, DENIED, deed_of, is_kind
from .said import ASKS_WHEN, Said

SURE = 0.8  # probability from which words without a mark are taken for those of the question

_HARD = (HARD - {"one"}) | bag("after before further until while backwards backward reverse ever straight")


def says_more(kind: str, chance: float, said: Said, names: Collection[str], strictly: bool = False) -> bool:
    """Whether words without a mark say more than the kind of question does.

    Args:
        chance: the probability of the kind.
        strictly: whether a word that may say more counts, however likely the kind is.
    """
    held = _HELD_UNTIL if kind in _ENDS_A_REST else _SINCE if kind in ("when_open", "when_shut") else None
    told = said.rest if held is None else held.sub(" when ", said.rest)
    plain = _EACH_SECOND.sub(" ", _IN_A_ROOM.sub(" ", _WHAT_SECOND.sub(" when ", told)))
    if kind.startswith("long_"):
        plain = _FINALLY.sub(" ", _LASTS.sub(r"\g<1>", plain))
    if kind.startswith("where_"):
        plain = _WHICH_PLACE.sub(" where ", plain)
    if _is_another(kind, said, plain):
        return True
    if kind.startswith("when_"):
        plain = _THE_SECOND.sub(" when ", plain)
    rest = plain.split()
    return _wants_another(kind, said, rest) or _tells_more(kind, chance, rest, names, strictly)


def _is_another(kind: str, said: Said, plain: str) -> bool:
    """Whether words are those of a question that no kind asks: of a share, of some of several, of all but one."""
    if (kind == "when_turns" and _A_FULL_ONE.search(plain)) or (
        kind in ("far_turns", "far_opens") and _A_SHARE.search(plain)
    ):
        return True
    if kind == "when_reaches" and _CROSSED.search(plain):
        return True
    if said.y and _GOES_ROUND.search(said.rest):
        return True  # "does the car drive around the table" asks for no touch
    several = any(word in NUMBERS and word != "one" for word in said.x.split())
    until = kind != "when_stops" and _UNTIL_WHEN.search(plain) is not None  # "until what second does it turn"
    if kind.startswith("when_") and (until or (several and ALL_OF.match(said.x) is None)):
        return True  # "when have two books fallen"
    if kind in ("what_moves", "what_still"):
        if kind == "what_still" and not said.x and said.y and _APART.search(said.rest):
            return False  # of all but what moves
        whose = said.x in _ANYTHING or is_kind(said.x) or " and " in said.x or _APART.search(said.rest) is not None
        if not whose or said.y:
            return True  # "who moves the ball", "what never moves near the desk"
    elif _BESIDES.search(said.rest) is not None:
        return True  # "does anything besides the door move"
    whole_way = kind == "far" and _FROM_TO.search(said.barred) is not None
    if len(said.places) > 1 and kind != "visits" and not whole_way:
        return True
    deeds = _TWO_DEEDS.search(said.barred)
    if deeds is not None and deeds["deed"] not in _OWN_DEEDS.get(kind, ()):
        return True
    return any(found.search(told) for found, told in ((_NTH, said.time), (_FROM_WHEN, plain), (_A_CLAUSE, plain)))


def _wants_another(kind: str, said: Said, rest: list[str]) -> bool:
    """Whether yes or no is wanted of what is no such question: "is the ball at its top speed then?"."""
    sides = kind == "turn_way" and not {"or", "left", "right"}.isdisjoint(rest)  # to one of them, or to which
    asks = not _ASKS.isdisjoint(rest) or sides or ASKS_WHEN.match(said.off) is not None
    states = kind.startswith("when_") and not _STATED.isdisjoint(rest) and _TIME_NOUNS.isdisjoint(rest)
    wants = said.first in _AUXILIARIES or states  # "the fan is starting immediately?"
    return not kind.startswith("if_") and not said.unit and wants and not asks


def _tells_more(kind: str, chance: float, rest: list[str], names: Collection[str], strictly: bool) -> bool:
    """Whether one of the words denies, ranks, counts or names."""
    told = [word for word in rest if word not in _ALLOWED.get(kind, frozenset())]
    if kind in _NEGATED or (chance < SURE and rest and rest[0] in _AUXILIARIES):  # "did it not move?"
        told = [word for word in told if word not in DENIED]
    if not DENIED.isdisjoint(told[1:]) or (kind not in _RANKED and (not _RANKS.isdisjoint(told) or "than" in told)):
        return True
    if kind in ("when_starts", "when_stops"):
        told = [word for word in told if word not in ("zero", "0")]  # of a speed
    if any((w in NUMBERS and w != "one" and kind not in _COUNTED) or w[0].isdigit() or is_color_word(w) for w in told):
        return True
    if chance < SURE or strictly:
        if (kind.startswith("if_") and _ASKS.intersection(rest)) or ("and" in rest and kind != "gap") or "or" in rest:
            return True  # "which way does it turn" wants no yes or no; two deeds, or things to choose from
        if any(word in _HARD for word in told):
            return True
    said = f" {' '.join(rest)} "
    does = kind != "how_many" or deed_of(said, "") != ""  # else what stands somewhere is counted
    if chance >= CERTAIN and kind in _PLACED:
        told = (_BY_A_PLACE if does else _AROUND).sub(" ", said).split()
    falls = does and kind in _TO_THE_FLOOR
    return any(singular(w) in names for w in told if w not in _VERBS and not (falls and w in _LEVELS))


CERTAIN = 0.95  # probability of a kind from which the place of what happens needs no mark
_PLACED = bag(
    "when_closes when_shut when_falls when_opens when_turns when_stops first last order if_returns if_stops if_closes "
    "if_turns where_ends far_opens how_many turn_way what_fell what_up does long_closes long_opens on_way long_reach "
    "if_before if_after"
)
_BY_A_PLACE = re.compile(  # "comes to rest at which wall", "quits the shelf board"
    r" (?:(?:(?:in|into|to|from|at|off|on|onto|of|out of|back to|around|round|by|beside|with|face|quits?|leaves?|"
    r"against|towards?) )+|[a-z]+ to )"
    r"(?:the |its |his |her |which |what |that )?(?:[a-z]+ )?[a-z]+(?= )"
)
_AROUND = re.compile(r" (?:around|round) (?:the |this |that )?(?:[a-z]+ )?[a-z]+(?= )")
_LASTS = re.compile(  # "how long does it last"
    r"(\b(?:does|do|did|will|would|should|must|to) (?:.* )?)lasts?\b"
    r"(?= *(?:[?,.]|$|in total|exactly|altogether|overall))"
)
_FINALLY = re.compile(r"\b(?:final|total) (?=(?:stop|standstill|rest|halt|time|duration|transit|running)\b)")
_ENDS_A_REST = bag("when_starts when_stops when_opens when_falls when_leaves when_closes")
_WHEN = r"(?:when(?= (?:do|does|did|is|was|can|has)\b| \?)|(?:what|which) (?:second|moment|point|time)\b)"
_HELD_UNTIL = re.compile(rf"\b(?:until|till|til|up to|since|from) {_WHEN}")  # "until when does it rest?"
_SINCE = re.compile(rf"\b(?:since|from) {_WHEN}")
_WHAT_SECOND = re.compile(
    r"\b(?:at|in|on|by|after)? ?(?:what|which) (?:second|stroke of the clock)\b|\b(?:exact|precise|very) second\b|"
    r"\bthe (?:exact |precise |very )?second (?:(?:at|in|on) which|where|when|that)\b"
)
_THE_SECOND = re.compile(r" the (?:exact |precise |very )?second ")  # that something happens
_FROM_TO = re.compile(r"\b(?:full|whole|entire|total)\b.*\bfrom \| to \|")
_A_FULL_ONE = re.compile(r"\b(?:one|full|whole|complete)\b")
_A_SHARE = re.compile(r"\b(?:fraction|share|part|percent\w*|portion)\b")
_EACH_SECOND = re.compile(r" (?:per|a|each|every) (?:second|minute)(?= )")
_FROM_WHEN = re.compile(r"\b(?:from|since|until|till|to) (?:when|the moment)\b")  # a time without a mark
_A_CLAUSE = re.compile(r"\b(?:while|whilst|once (?:it|the|has|have|had|is|are|was))\b")  # the same, of what happens
_CROSSED = re.compile(r"\b(?:cross\w*|passed|past|through|over|across)\b")
_GOES_ROUND = re.compile(r"\b(?:driv|go|walk|roll|run|mov|circl|orbit|travel|march)\w* (?:a?round)\b")
_UNTIL_WHEN = re.compile(r"\b(?:until|till|up to) (?:what|which|when)\b")
_WHICH_PLACE = re.compile(
    r"\b(?:(?:up)?on|in|at|against|by|to|onto|over|next to|beside|near|close to) (?:the )?(?:what|which) "
    r"(?:(?:piece|bit|item|kind|sort) of )?"
    r"(?:furniture|wall|surface|thing|object|place|spot)\b|"
    r"\b(?:what|which) (?:(?:piece|bit|item) of )?(?:furniture|wall|surface)\b|"
    r"\b(?:against|at|by|on|in|over) which (?:of the (?:walls|corners)|floor covering)\b"
)
_IN_A_ROOM = re.compile(r"\b(?:in|of|inside) (?:the|this|that|our) (?:[a-z]+ )?room\b")
_BESIDES = re.compile(r"\b(?:besides|apart from|except|excepting|other than|aside from)\b")
_APART = re.compile(rf"{_BESIDES.pattern}|\bbut\b")
_RANKED = bag("order visits long_moves long_opens long_closes far apart long_falls")
_COUNTED = bag("order does visits how_many what_still what_shut what_up what_open what_on what_fell what_moves")
_OWN_DEEDS: Mapping[str, tuple[str, ...]] = {
    "when_shut": ("clos", "shut"), "if_shut": ("clos", "shut"), "what_shut": ("clos", "shut"),
    "when_stops": ("stop",), "when_lands": ("land",), "when_falls": ("fall",), "when_starts": ("start", "go", "mov"),
    "when_opens": ("open",), "when_open": ("open",), "what_fell": ("land", "fall"),
}  # fmt: skip
_TWO_DEEDS = re.compile(
    r" and (?:\w+ )?(?P<deed>stop|fall|open|clos|shut|turn|roll|walk|land|start|go|com|mov|reach)\w* "
)
_NTH = re.compile(r"\b(?:second|third|fourth|last) (?:time|trip|turn|movement|run|fall|way|lap|round)\b")
_ANYTHING = ("", "things", "the things", "anything", "everything", "something", "the furniture", "it")

_RANKS = bag("second third first last other another twice again anew afresh resume resumes")
_LEVELS = bag("floor ground board shelf")
_TO_THE_FLOOR = bag("when_lands when_falls if_falls long_falls how_many what_fell what_up far_falls first last order")
_ASKS = bag("which what how when where who whose")
_STATED = bag("is are was were")
_TIME_NOUNS = bag("time moment second instant point timestamp timecode stamp frame mark")
_AUXILIARIES = bag("is are was were does do did has have had would should might")
_NEGATED = bag("if_still what_still long_still long_open what_up what_shut if_shut how_many")
_VERBS = bag("fall falls light turn turns open close drop step steps start stop move swing spin fan walk roll slide")
_ORDERS = bag("first last second third than before after earlier later sooner next other")
_ALLOWED: Mapping[str, frozenset[str]] = {
    "first": _ORDERS, "last": _ORDERS | {"final"}, "order": _ORDERS, "if_before": _ORDERS, "if_after": _ORDERS,
    "if_together": bag("same both each other"), "if_returns": bag("back again"), 
    "when_shut": bag("back again"), "if_closes": bag("back again"), "if_shut": bag("again back"),
    "long_closes": bag("back again"), "where_ends": bag("last final"),
    "fastest": bag("most than faster every each other"),
    "when_opens": bag("first"), "when_closes": bag("back again first"), "when_leaves": bag("first"),
    "when_closest": bag("most least"), "when_starts": bag("first"), "when_stops": bag("last final again"),
    "when_reaches": bag("first"), "when_falls": bag("first"), "where_starts": bag("first initial"),
    "turns": bag("every each"), "often": bag("every each again back"), "fast_most": bag("most"),
    "gap": _ORDERS | {"between"},
    "long_still": bag("before first only"), "long_reach": bag("before until"),
    "if_to_end": bag("until last second final"), "turn_way": bag("other"),
    "what_still": bag("only else other"), "what_moves": bag("only else other"),
    "does": _ORDERS | bag("one another"), "how_many": bag("every each other"),
}  # fmt: skip
