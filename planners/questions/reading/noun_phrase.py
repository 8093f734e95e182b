"""Reads noun phrases of questions as queries, with the grammar of instructions.

What only questions say is put into words of that grammar first: "anything to sit on", "something red", "a piece of
furniture", "the lamp which stands by the bed". Words that name no thing ("tune", "time") are no noun phrase.
"""

from __future__ import annotations

from functools import cache, lru_cache

from ....gaussians import late_re as re
from ....gaussians.errors import UserError
from ....gaussians.language.query.query import Query
from ....gaussians.world import kinds
from ....gaussians.world.words import singular
from ...grammar import GrammarPlanner
from ...grammar.tagging.words import bag
from . import families, room_phrases
from .colors import color

Words = tuple[str, ...]

_ANYTHING = bag("anything something things thing objects object items item stuff everything belongings")
_ID = re.compile(
    r"^(?:the )?(?:object |thing |item )?(?:with (?:the )?)?(?:object|thing|item|number|id|node|group|"
    r"#) (?:# )?(\d+)$|^#(\d+)$"
)
BY_ID = "number"  # text of a query for one thing: "number 7"
_HERE = (
    r"(?:here|in here|there|in the room|around here|in there|in view|visible|you can (?:see|count|find|spot|"
    r"make out|detect)|you see|we have|i have|(?:i|we) can (?:see|count|find)|(?:that|"
    r"which) you can see|"
    r"(?:that|which) is (?:here|there|in the room)|(?:that|which) are (?:here|there|in the room)|anywhere|somewhere|"
    r"around|lying about|lying around|hanging around|at all|present|available|there is|there are|of any kind|"
    r"of some kind)"
)
_SIT = (
    r"(?:(?:that |which )?(?:i|we|you|one|people|someone|somebody) (?:can|could|might|may) sit(?: down)?(?: on| in|"
    r" at)?|"
    r"to sit(?: down)?(?: on| in)?|(?:suitable )?for sitting(?: on| down)?|to have a seat|(?:that|which) can be sat on|"
    r"to be seated|where (?:i|we|you|one) (?:can|could) sit(?: down)?)"
)
_STORE = (
    r"(?:to (?:store|keep|put|put away|stow|hang)(?: away)? (?:my |our |your |the |some )?(?:things|stuff|clothes|"
    r"items|books|shoes|"
    r"belongings|dishes|plates|toys|documents|files|papers|cups)(?: in| on| away)?|for storage|"
    r"for (?:storing|keeping) (?:\w+ )?(?:things|stuff|clothes|books|shoes|items)|"
    r"(?:i|we|you) can (?:store|keep|put) (?:things|stuff|clothes|books|my things|items) (?:in|on|away))"
)
_LIGHT = (
    r"(?:(?:that|which) (?:gives?|emits?|makes?|produces?) light|giving light|to light the room|for light|"
    r"that lights? up|for lighting)"
)
_SOME = (
    r"(?:anything|something|things|stuff|anywhere|somewhere|everything|thing|objects?|items?|(?:a )?places?|spots?|"
    r"pieces? of furniture|furniture)"
)
_REWRITES: tuple[tuple[re.Pattern[str], str], ...] = tuple(
    (re.compile(pattern), said)
    for pattern, said in (
        (rf" {_HERE}$", ""),
        (rf" {_HERE} (?=except )", " "),
        (r"\b(?:that|which) (?:is|are) (?:the )?(closest|nearest|farthest)\b", r"\1"),
        (
            r"^(?:there (?:is|are)|such a thing as|things like|something like|anything like|any sign of|any kind of|"
            r"any sort of|"
            r"some kind of|some sort of|any type of|a kind of|a type of|one of the|a single|even a|even one|"
            r"at least one|"
            r"one or more|any one of the|any of (?:the|these|those)|some of the|(?:a )?few|several|a lot of|lots of|"
            r"many|much)"
            r" (?=\w)",
            "",
        ),
        (r"\bthe viewer 's (left|right)\b", r"the \1"),
        (rf"^(?:{_SOME}|seats?) {_SIT}", "qseats"),
        (rf"^{_SOME} {_STORE}", "qstores"),
        (rf"^{_SOME} {_LIGHT}", "qlights"),
        (r"\b(?:sitting|seating) (?:places?|spots?|options?|opportunit(?:y|ies))\b", "qseats"),
        (r"\blight(?:ing)? (?:sources?|fixtures?|fittings?)\b|\bsources? of light(?:ing)?\b", "qlights"),
        (r"\bstorage (?:places?|spaces?|furniture|units?|options?|pieces?)\b", "qstores"),
        (r"\bpieces? of storage\b", "qstores"),
        (r"\b(pieces|items|bits|articles) of furniture\b", "qpieces"),
        (r"\b(?:piece|item|bit|article) of furniture\b", "qpiece"),
        (r"\bfurniture (?:pieces|items|objects)\b", "qpieces"),
        (r"\bfurniture (?:piece|item|object)\b", "qpiece"),
        (r"\b(?:electronic|electrical|household|home|kitchen|domestic) (appliances?|devices?)\b", r"\1"),
        (r"\b(?:pairs?|sets?) of (curtains|drapes|speakers|shoes|drawers)\b", r"\1"),
        (r"\bpieces? of (art(?:work)?|art)\b", "pictures"),
        (r"\b(?:some|any)(things?) (?:that|which) (?:is|are) \b", r"any\1 "),
        (r"^(?:something|anything|stuff|things?) (?:coloured|colored|in|of (?:the )?color) (\w+)$", r"any \1 thing"),
        (r"\b(chairs?|sofas?|tables?|lamps?|things?|objects?|items?|\w+s?) (?:that|which|who) (?:is |"
         r"are )?(?:currently )?"
         r"(?:stands?|sits?|lies?|rests?|standing|sitting|lying|resting|located|placed|positioned|situated|found|"
         r"kept|to be found)"
         r" (on|in|by|next|near|at|under|behind|beside|between|against|above|below|beneath|underneath|inside|"
         r"to)\b", r"\1 \2"),
        (r"\b(?:that|which) (?:hangs?|is hung|are hung|is hanging|are hanging|is mounted|are mounted) ", "hanging "),
        (r"\b(?:hanging |suspended |dangling )?(?:down )?(?:from|off) the (wall|ceiling)\b", r"on the \1"),
        (r"\bhanging up\b", "hanging"),
        (r"\b(?:hung|mounted|fixed|attached|fastened|leaning|propped)(?: up)? (on|over|above|against|by)\b",
         r"\1"),
        (r"\b(?:fixed|attached|fastened) to\b", "on"),
        (r"\b(?:standing|sitting|lying|resting|located|placed|positioned|situated|found|kept|stood|sat|put|left|set|"
         r"parked|stored|"
         r"laid|arranged|displayed|piled|stacked|fitted|installed)(?: up| down| right)? (?=(?:on|in|by|next|near|at|"
         r"under|behind|"
         r"beside|between|against|above|below|beneath|underneath|inside|to the|atop|in front|close|opposite|"
         r"around)\b)", ""),
        (r" ,? ?(?:not|but not|not including|not counting|excluding|except for|except|other than|apart from|besides|"
         r"ignoring|aside "
         r"from|leaving out|without counting) (?=the |a |any |\w+$)", " except "),
        (r"\b(wall|ceiling) (?:mounted|hung|fixed) (\w+)(?= |$)", r"\2 on the \1"),
        (r"^(?:any|some)(?:thing)? else(?: but| than| besides| except)? (?:the )?(?=\w)", "anything except the "),
        (r"^the (?:color|colour|shade|height|width|depth|length|size|dimensions|number|amount|distance|gap|position|"
         r"location) .*$", ""),
        (r"\b(?:that|which) (?:has|have|holds|carries|have got|has got) ((?:the|a|an|some|any|two|three) .+?)"
         r"(?: (?:on|in) (?:it|them|top))?$",
         r"with \1 on it"),
        (r"(?<=\w) (?:that|which) (?:is|are) (?=(?:on|in|by|next|near|at|under|behind|beside|between|against|above|"
         r"below|beneath|underneath|inside|closest|nearest|farthest|left|right|to the) )", " "),
    )
)  # fmt: skip
_OWN_SIDE = re.compile(r"(?:my|your|our|his|her|their) (?:\w+ )?(?:left|right|front|back|rear)\b")
_COLORED = re.compile(r"^(?:something|anything|everything|stuff|all|things|objects|items|what|one|ones) (\w+)(?= |$)")
_PLACE, _HARD_NAME = "qroom", "qname"
# Words of names of kinds that the grammar takes for something else: "but", a measure, an action, a colour.
_HARD = bag(
    "bar size top adjustable height till mounted telly area art copy scale food water walk brolly length cooler"
)
_TOKENS = {
    "qseat": families.SEAT, "qlight": families.LIGHT, "qstore": families.STORAGE, "qpiece": families.FURNITURE,
}  # fmt: skip
# Heads of noun phrases that name no thing that could be found in a scene.
_NO_THINGS = bag(
    "list inventory overview enumeration tune time use order way front back side middle center top bottom end edge "
    "reach view sight shape condition mood style place room space weather date day night morning evening weekend "
    "weekends year age price cost value brand make model owner company name reason purpose question idea problem "
    "thought color size height width depth length weight area volume story storey function dimension dimensions "
    "meter centimeter millimeter inch yard cm mm ft "
    "distance gap direction position location orientation number amount total sum average lot bit kind sort type "
    "difference left right everyone everybody anyone anybody someone somebody nobody me you us them him her i we it "
    "they myself yourself person people man woman owner designer shade material texture pattern smell sound noise "
    "temperature heat cold warm hot comfortable comfy cosy cozy nice beautiful pretty ugly clean dirty tidy messy "
    "open closed shut locked empty full broken new old cheap expensive heavy big small large tall wide deep long "
    "short high low bigger smaller taller wider deeper longer shorter higher lower larger closer nearer farther "
    "longest widest deepest narrowest highest lowest thinnest thickest closest nearest farthest same different "
    "similar equal aligned level straight common sure able possible likely red danger safe safety space walkway path "
    "route walk foot work living being what which who where when why how many much not no yes is are was were be been "
    "do does did have has had can could would will should there here this that these those than as so if whether and "
    "or but of to from for with"
)
_VERBS = re.compile(
    r"\b(?:is|are|was|were|be|been|does|do|did|has|have|had|can|could|would|will|should|whether|how|what|which|who|"
    r"where|"
    r"when|why|than|there|if|get|walk|fit|sit|see|look|looks|stand|stands|hang|hangs|lie|lies|belong|belongs|cost|"
    r"costs|"
    r"goes|go|i|we|he|she|they|might|may|must)\b"
)
_RELATIVE = re.compile(r"\b(?:that|which|who) (?:is|are|has|have|does not have|is not|are not)\b")
_NO_STARTS = bag(
    "than and or of to from in on at by with is are was were does do did has have had be been being can could would "
    "will should which who whom whose where when why how whether if , not as so but for under over above below behind "
    "between near next inside into onto i we he she they"
)
_NO_ENDS = bag(
    "the a an and or of to from in at by with is are was were than my your our its his her their which who between "
    "behind near next , as if under above below beside beneath inside into onto very most more"
)
_LAST = frozenset({"it", "them", "this", "that", "these", "those", "this one", "that one", "this thing", "that thing"})


@lru_cache(maxsize=16384)
def thing(words: Words) -> Query | None:
    """The query of a noun phrase, None if the words are none."""
    said = _enumerated(words)
    if not said or len(words) > 20 or words[0] in _NO_STARTS or words[-1] in _NO_ENDS:
        return None
    if found := _ID.match(said):
        return Query(text=f"{BY_ID} {found[1] or found[2]}")
    if _OWN_SIDE.match(said):
        return None
    if said in _LAST:
        return Query(last=True)
    said = _plainly(said)
    if not said or _VERBS.search(_RELATIVE.sub("", _with_verbs().sub("it", said))):
        return None
    try:
        plan = _grammar().plan(f"select {said}")
    except UserError:
        return None
    if len(plan.ops) != 1 or plan.ops[0].op != "select":
        return None
    query = plan.ops[0].query()
    return _checked(query) if query is not None and not _ends_in_verb(query.text) else None


def _ends_in_verb(text: str) -> bool:
    """Whether a noun phrase ends in a participle, as "kettle boiled": then it is a clause."""
    last = text.rpartition(" ")[2]
    return last.endswith(("ed", "ing")) and " " in text and kinds.of(text) is None


def _enumerated(words: Words) -> str:
    """The words without commas; those of an enumeration become "and": "the bed, the sofa or the rug"."""
    last = max((i for i, w in enumerate(words) if w in ("and", "or")), default=0)
    if not last and words.count(",") > 1:
        last = len(words) + 1
    said = [("and" if w == "," and 0 < i < last - 1 else "" if w == "," else w) for i, w in enumerate(words)]
    return " ".join(w for w in said if w)


def _plainly(said: str) -> str:
    """A noun phrase in the words of the grammar."""
    before = ""
    while before != said:
        before = said
        for pattern, plain in _REWRITES:
            said = pattern.sub(plain, said).strip()
    said = room_phrases.WITHIN.sub(_placed, said)
    said = _of_names().sub(lambda m: _of_kinds()[m[0]], said)
    said = _hard_names().sub(lambda m: f"{_hard_tokens()[m[1]]}{m[2]}", said)
    if (colored := _COLORED.match(said)) and is_color_word(colored[1]):
        rest = said[colored.end() :].strip()
        every = "all" if said.startswith(("everything", "all")) else "any"
        said = f"{every} {colored[1]} thing{'s' if every == 'all' else ''} {rest}".strip()
    if said.startswith(("any ", "some ")) and said.split()[1] not in ("of", "other"):
        said = said.partition(" ")[2]
    if said.startswith("something"):
        said = "anything" + said.removeprefix("something")
    return re.sub(r" or (?:else )?(?:(?:a|an|any|some) )?", " and ", said)


def _placed(found: re.Match[str]) -> str:
    """A place of the room as one word that the grammar takes for a noun."""
    return f" in the {_PLACE}{room_phrases.kind_of(found[1])}{''.join(room_phrases.named_in(found[1]))}"


@cache
def _hard_tokens() -> dict[str, str]:
    """Names of kinds with words that mean something else in the grammar ("bar cart"), each with a word in its place."""
    names = (n for kind in kinds.table().kinds.values() for n in kind.names)
    hard = sorted(n for n in names if " of " not in n and not _HARD.isdisjoint(n.split()))
    return {n: f"{_HARD_NAME}{chr(97 + i // 26)}{chr(97 + i % 26)}x" for i, n in enumerate(dict.fromkeys(hard))}


@cache
def _hard_names() -> re.Pattern[str]:
    longest = sorted(_hard_tokens(), key=len, reverse=True)
    return re.compile(rf"\b({'|'.join(map(re.escape, longest))})(s?)\b")


@cache
def _of_hard_tokens() -> dict[str, str]:
    return {token: name for name, token in _hard_tokens().items()}


@cache
def _of_kinds() -> dict[str, str]:
    """Names of kinds with "of" in them ("chest of drawers"), which the grammar would read as parts, and plain names."""
    return {n: k.name for k in kinds.table().kinds.values() for n in k.names if " of " in n} | {
        "set of drawers": "dresser"
    }


@cache
def _of_names() -> re.Pattern[str]:
    return re.compile(rf"\b(?:{'|'.join(map(re.escape, _of_kinds()))})\b")


@cache
def _with_verbs() -> re.Pattern[str]:
    """Names of kinds that hold a word which is a verb elsewhere: "trash can", "coat stand"."""
    named = [n for n in kinds.phrases() if _VERBS.search(n)]
    forms = sorted({*named, *(f"{n}s" for n in named)}, key=len, reverse=True)
    return re.compile(rf"\b(?:{'|'.join(map(re.escape, forms))})\b")


def without_verb_names(said: str) -> str:
    """A phrase with "it" in place of names of kinds that hold a verb, as "coat stand"."""
    return _with_verbs().sub("it", said)


@cache
def is_color_word(word: str) -> bool:
    """Whether a word names a colour."""
    return color((word,)) is not None


def _checked(query: Query) -> Query | None:
    """The query with words for families in place of their tokens; None if it names something that is no thing."""
    text = query.text
    words = text.split()
    if words and (hard := _of_hard_tokens().get(words[-1])) is not None:
        text = " ".join([*words[:-1], hard])
        words = text.split()
    token = _TOKENS.get(words[-1]) if words else None
    if token is not None:
        if len(words) > 1:
            return None  # "wooden piece of furniture": nothing here tells
        text = token
    elif text in families.SAID:
        text = families.SAID[text]
    elif (
        words
        and kinds.find(text) is None
        and (words[-1] in _NO_THINGS or words[0] in _NO_THINGS or singular(words[-1]) in _NO_THINGS)
    ):
        return None
    changed: dict[str, object] = {"text": text}
    for name in ("also", "exclude"):
        parts = tuple(map(_checked, getattr(query, name)))
        if None in parts:
            return None
        changed[name] = parts
    relations = []
    for relation in query.relations:
        anchors = tuple(map(_checked_anchor, relation.anchors))
        if None in anchors:
            return None
        relations.append(relation.model_copy(update={"anchors": anchors}))
    return query.model_copy(update={**changed, "relations": tuple(relations)})


@cache
def _is_plural_noun(word: str) -> bool:
    return singular(word) != word and singular(word) in kinds.heads()


def _checked_anchor(query: Query) -> Query | None:
    """An anchor; corners and the like are places, which the resolver tells apart."""
    if query.text.startswith(_PLACE):
        return Query(text=room_phrases.told(query.text.removeprefix(_PLACE)))
    return query if query.text in ("corner", "room", "middle", "center") else _checked(query)


def is_anything(query: Query) -> bool:
    """Whether a query names neither a kind of thing nor a colour: "anything", and not "anything green" or "it"."""
    return is_unnamed(query) and not query.colors and not query.not_colors and not query.last


def is_unnamed(query: Query) -> bool:
    """Whether a query names no kind of thing; it may tell a colour or a place."""
    return not query.text or query.text in _ANYTHING


@lru_cache(maxsize=1)
def _grammar() -> GrammarPlanner:
    return GrammarPlanner()
