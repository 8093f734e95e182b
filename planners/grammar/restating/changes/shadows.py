"""What an instruction says of shadows: "no shadow under the sofa", "give the vase a shadow", "without a shadow".

Such clauses are taken out before the rest is read. What names the thing that casts the shadow is read as a thing that
is selected.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from .....gaussians import late_re as re
from ..speech.frames import is_reported, unframed

Change = Literal["remove", "cast", "darker", "lighter"]

_POLITE = r"(?:(?:please|now|then|also|and|but|ok|okay|just|can you|could you|would you|will you|i want you to) )*"
_ART = r"(?:the|that|this|its|their|any|all|every|a|an|some|those|these|that ugly|the ugly)"
_KIND = r"(?:(?:contact|cast|drop|dark|leftover|left ?over|remaining|old|ugly|black|grey|gray|soft|little|remaining) )*"
_SHADE = rf"{_KIND}(?:shadows?|shadowing|shading)"
_PATCH = (
    r"(?:dark|darker|black|shady|shadowy|gr[ea]y) (?:patch(?:es)?|spots?|areas?|smudges?|blobs?|stains?|marks?|bits?)"
)
_UNDER = r"(?:under|beneath|below|underneath|around|behind|at the (?:foot|feet|base|bottom) of|next to|beside|by)"
_OF = rf"(?:of|from|cast by|thrown by|made by|left by|belonging to|{_UNDER})"
_AWAY = (
    r"(?:remove|delete|erase|clear(?: up| away| out)?|take (?:away|off|out)|get rid of|lose|kill|drop|ditch|scrap|"
    r"wipe(?: away| out| off)?|clean(?: up| away| off)?|hide|cut|eliminate|lift|strip|edit out|rub out)"
)
_CAST = r"(?:add|put|create|make|draw|paint|cast|drop|bring(?: back)?|place|lay|restore)"
_DEEPER = r"(?:darken|deepen|strengthen|intensify)"
_PALER = r"(?:lighten|soften|weaken|fade|brighten|reduce|tone down|lessen|soften up|dim)"
_DARKER = r"(?:darker|stronger|deeper|heavier|more visible|more pronounced|blacker)"
_LIGHTER = r"(?:lighter|softer|fainter|weaker|paler|less dark|less strong|less visible|brighter|subtler|more subtle)"
_BIT = r"(?:a (?:bit|little) |much |slightly )?"
_S = r"(?:'s|s'|’s)"
_MAKE = r"(?:make|turn|have)"
_THING = r"(?P<what>.+?)"
_END = (
    r"(?: (?:please|pls|too|as well|again|completely|entirely|there|on the (?:floor|ground|wall|carpet|table)))*[.!?]*$"
)
_LEAVES = r"(?:casts?|leaves?|throws?|makes?|left|has)"
_GONE = r"(?:removed|deleted|gone|cleared|erased)"
_ALSO = r"(?: (?:is|are)(?: still| always)? .+?| (?:looks?|seems?) .+?| bothers me.*?| (?:should|must|has to) go)?"
_STILL = r"(?: (?:still|always))?"
_CLEAR_IT = (
    rf"(?:,|;|\.| and)?(?: (?:please|can you|could you|so|just|then))* {_AWAY}(?: (?:it|that|them|this))"
    r"(?: away| up| off)?"
)


def _clause(pattern: str) -> re.Pattern[str]:
    return re.compile(rf"^{_POLITE}{pattern}{_END}", re.IGNORECASE)


_FORMS: tuple[tuple[Change, re.Pattern[str]], ...] = (
    ("remove", _clause(rf"{_AWAY} (?:{_ART} )?{_SHADE} (?:that )?{_OF} {_THING}")),
    ("remove", _clause(rf"{_AWAY} (?:{_ART} )?{_PATCH} (?:that is |that's )?(?:left )?(?:{_UNDER}|by|from) {_THING}")),
    ("remove", _clause(rf"{_AWAY} (?:{_ART} )?{_SHADE} (?:that |which )?{_THING} {_LEAVES}")),
    ("remove", _clause(rf"{_AWAY} (?P<own>its|their|his|her) {_SHADE}")),
    ("remove", _clause(rf"{_AWAY} {_THING}{_S} {_SHADE}")),
    ("remove", _clause(rf"(?:there (?:should|must) be )?(?:no|without(?: a| any| the)?) {_SHADE} {_OF} {_THING}")),
    ("remove", _clause(rf"(?:i )?(?:do not|don't|dont) want (?:{_ART} )?{_SHADE} {_OF} {_THING}")),
    ("remove", _clause(rf"(?:do not|don't|dont) let {_THING} (?:cast|throw|have) (?:a|any) {_SHADE}")),
    ("remove", _clause(rf"{_THING} (?:should|must) (?:not|n't|never) (?:cast|throw|have|leave) (?:a|any) {_SHADE}")),
    ("remove", _clause(rf"{_THING} (?:should|must)n'?t (?:cast|throw|have|leave) (?:a|any) {_SHADE}")),
    ("remove", _clause(rf"{_THING} without (?:its|a|any|the) {_SHADE}")),
    (
        "remove",
        _clause(rf"(?:there(?:'s| is|s){_STILL} )?(?:{_ART} )?(?:{_SHADE}|{_PATCH}) {_OF} {_THING}{_ALSO}{_CLEAR_IT}"),
    ),
    ("remove", _clause(rf"{_THING} (?:still )?(?:has|casts|leaves) (?:a|its|the) {_SHADE}{_CLEAR_IT}")),
    ("remove", _clause(rf"(?:{_ART} )?{_SHADE} {_OF} {_THING} (?:should|must|has to|needs to|can) go(?: away)?")),
    ("remove", _clause(rf"(?:{_ART} )?(?:{_SHADE}|{_PATCH}) {_OF} {_THING} should be {_GONE}")),
    ("darker", _clause(rf"{_MAKE} (?:{_ART} )?{_SHADE} {_OF} {_THING} {_BIT}{_DARKER}")),
    ("darker", _clause(rf"{_MAKE} (?P<own>its|their) {_SHADE} {_BIT}{_DARKER}")),
    ("darker", _clause(rf"{_MAKE} {_THING}{_S} {_SHADE} {_BIT}{_DARKER}")),
    ("darker", _clause(rf"{_DEEPER} (?:{_ART} )?{_SHADE} {_OF} {_THING}")),
    ("darker", _clause(rf"{_DEEPER} (?P<own>its|their) {_SHADE}")),
    ("darker", _clause(rf"{_DEEPER} {_THING}{_S} {_SHADE}")),
    ("lighter", _clause(rf"{_MAKE} (?:{_ART} )?{_SHADE} {_OF} {_THING} {_BIT}{_LIGHTER}")),
    ("lighter", _clause(rf"{_MAKE} (?P<own>its|their) {_SHADE} {_BIT}{_LIGHTER}")),
    ("lighter", _clause(rf"{_MAKE} {_THING}{_S} {_SHADE} {_BIT}{_LIGHTER}")),
    ("lighter", _clause(rf"{_PALER} (?:{_ART} )?{_SHADE} {_OF} {_THING}")),
    ("lighter", _clause(rf"{_PALER} (?P<own>its|their) {_SHADE}")),
    ("lighter", _clause(rf"{_PALER} {_THING}{_S} {_SHADE}")),
    ("cast", _clause(rf"{_CAST} (?:a|an|some|the|its) {_SHADE} (?:back )?(?:{_UNDER}|for|to|of) {_THING}")),
    ("cast", _clause(rf"{_CAST} (?P<own>its|their) {_SHADE}(?: back)?")),
    ("cast", _clause(rf"give {_THING} (?:a|an|some|its|back its) {_SHADE}(?: back)?")),
    ("cast", _clause(rf"(?:let|make|have) {_THING} (?:cast|throw|have|drop) (?:a|some|its) {_SHADE}")),
    ("cast", _clause(rf"{_THING} (?:should|must|needs to|ought to) (?:cast|throw|have) (?:a|some|its) {_SHADE}")),
    ("cast", _clause(rf"{_THING} needs (?:a|some|its) {_SHADE}")),
    ("cast", _clause(rf"there should be (?:a|some) {_SHADE} {_OF} {_THING}")),
)  # fmt: skip
_SHADED = re.compile(rf"{_SHADE}|{_PATCH}", re.IGNORECASE)
_AFTER = re.compile(
    r",? (?:(?:even )?(?:after|now that|since|although|though|but|because) (?:i|we|you|it|that|they|the) .+?"
    r"|(?:where|when) (?:it|that|they|the \w+) (?:was|were|stood|used to .+?))(?=,|;|\.| can you| could you| please|$)",
    re.IGNORECASE,
)
_ON = re.compile(
    r" (?:on|from|off) (?:the )?(?:floor|ground|wall|carpet|rug|floorboards|table ?top|tiles?)\b", re.IGNORECASE
)
_JOIN = re.compile(r"\s*(?:,\s*(?:and |then )*|;\s*|\.\s+|\band then\b |\bthen\b |\band\b )\s*", re.IGNORECASE)
_ALONG = re.compile(
    rf"(?:,? (?:and|with|together with|along with|including|plus|and take|and bring) (?:also )?(?:its|their|the|"
    rf"his|her) {_SHADE})"
    r"(?: (?:too|as well|with it|along|along with it))?(?=\s*(?:[,.;!]|$))",
    re.IGNORECASE,
)
_GOES = re.compile(rf"^{_POLITE}(?:{_AWAY}|move|shift|push|pull|drag|slide|put|bring|throw out|bin)\b", re.IGNORECASE)
_AS_IS = re.compile(
    r"(?:,|;|\band\b|\bbut\b)?\s*(?:(?:exactly |just )?as (?:it|they) (?:is|are|comes?|come)|as[ -]is|"
    r"in (?:its|their) own (?:light|colou?rs?)|"
    r"(?:without|with no) (?:(?:matching|adjusting|changing|fitting|adapting|harmoni[sz]ing|relighting|toning)"
    r"(?: (?:it|them|its|their|the))*(?: (?:colou?rs?|light|lighting|brightness|exposure|shading|look))*"
    r"(?: to (?:the|this) (?:room|scene|light))?|(?:any )?harmony|(?:a |any |its |their )?(?:contact )?shadows?)|"
    r"no (?:harmony|harmoni[sz]ing|harmoni[sz]ation|shadows?)|"
    r"(?:do not|don't|dont) (?:match|adjust|change|fit|adapt|harmoni[sz]e|relight) (?:it|them|its|their)"
    r"(?: (?:colou?rs?|light|lighting|brightness))?(?: to (?:the|this) (?:room|scene|light))?)(?=\s*(?:[,.;!]|$))",
    re.IGNORECASE,
)
_PUTS = re.compile(
    rf"^{_POLITE}(?:insert|add|put|place|replace|swap|drop|set|bring|stand|hang|i want|give|exchange)\b", re.IGNORECASE
)


class ShadowRequest(NamedTuple):
    """A shadow to change: the words of what casts it ("it" where none are said), and how."""

    what: str
    change: Change


class ShadowsHeard(NamedTuple):
    """An instruction split into what it says of shadows and the rest.

    Attributes:
        parts: in their order, requests and the words of other clauses.
        as_is: whether what is put into the scene keeps its own colours and casts no shadow.
    """

    parts: tuple[ShadowRequest | str, ...]
    as_is: bool = False


def shadows_heard(text: str) -> ShadowsHeard | None:
    """The instruction split; None if it says nothing of shadows or of fitting things to the light."""
    text = text.strip()
    shadow_first = re.match(rf"{_POLITE}\w+ (?:(?:{_ART}) )?{_SHADE}", text, re.IGNORECASE)
    if (
        not shadow_first
        and _PUTS.match(text)
        and (rest := _AS_IS.sub("", text).strip(" ,;")) != text.strip(" ,;")
        and rest
    ):
        return ShadowsHeard((rest,), True)
    if (whole := _request(text)) is not None:
        return ShadowsHeard((whole,))
    if _GOES.match(text) and (rest := _ALONG.sub("", text).strip(" ,;")) != text.strip(" ,;") and rest:
        return ShadowsHeard((rest,))
    if "shadow" not in text.lower() and not re.search(_PATCH, text, re.IGNORECASE):
        return None
    if (loose := _loosely(text)) is not None:
        return ShadowsHeard((loose,))
    for join in _JOIN.finditer(text):
        first, second = text[: join.start()], text[join.end() :]
        if (one := _request(first)) is not None and second:
            later = shadows_heard(second)
            return ShadowsHeard((one, *(later.parts if later is not None else (second,))))
        if first and (two := _request(second)) is not None:
            return ShadowsHeard((first, two))
    return None


_ASKING = re.compile(r"^(?:why|what|who|how|where|which|when|is|are|was|were|does|do|did|has|have|am)\b", re.I)
_DENIED = re.compile(
    r"\b(?:never mind|do not (?:touch|remove|change|delete|move)|don't (?:touch|remove|change|delete|move)|"
    r"leave|keep|ignore|if)\b",
    re.I,
)
_NAMED = r"(?:(?:the|that|this|my|our|both|all|every|each) )?(?:[a-z-]+ ){0,3}?[a-z-]+"


def _word(form: str) -> re.Pattern[str]:
    return re.compile(rf"\b(?:{form})\b", re.IGNORECASE)


_OWNERS = tuple(
    re.compile(form, re.IGNORECASE)
    for form in (
        rf"\b(?P<what>(?:the|that|this|my|our|its|their) (?:[a-z-]+ ){{0,2}}[a-z-]+)(?:'s|s') (?:[a-z]+ )?{_SHADE}",
        rf"\b{_SHADE} (?:that is |that's )?(?:right |directly )?{_OF} (?P<what>{_NAMED})"
        r"(?= (?:is|are|was|looks?|seems?|should|must|needs?|stayed|stays|remained|has|have|please|now|too|a bit|a "
        r"little|much|lighter|darker|softer|stronger|weaker|gone)\b|[,.;!?]|$)",
        rf"\b{_SHADE} (?:that |which )?(?P<what>(?:the|that|this|my) (?:[a-z-]+ ){{0,2}}?[a-z-]+) {_LEAVES}\b",
        rf"^{_POLITE}(?:i (?:would like|want|need) )?(?P<what>{_NAMED}) (?:still |also )?(?:needs?|wants?|lacks?|"
        rf"misses|is missing|without|"
        rf"with|could use|could do with|should (?:have|get|cast)|has no|casts no|casts?|has|gets?) (?:a |an |its |"
        rf"some |any |two |double |"
        rf"more |the |no )*(?:[a-z]+er )?(?:of a )?{_SHADE}",
        rf"^{_POLITE}(?:give|lend) (?P<what>{_NAMED}) (?:a|an|its|some|more)(?: of a)? (?:[a-z]+ )?{_SHADE}",
    )
)
_CHANGES: tuple[tuple[Change, re.Pattern[str]], ...] = (
    (
        "lighter",
        _word("(?:too|so|very|rather|quite) (?:dark|strong|heavy|harsh|hard|black|deep|intense|pronounced|big)"),
    ),
    ("darker", _word("(?:too|so|very|rather|quite) (?:faint|weak|light|soft|pale|subtle|thin)")),
    ("lighter", _word(f"{_LIGHTER}|{_PALER}")),
    ("darker", _word(f"{_DARKER}|{_DEEPER}|more of a|more")),
    (
        "cast",
        _word(
            "forgot|forgotten|needs?|lacks?|misses|missing|wants?|give|lend|add|should (?:have|get|cast)|could use|"
            "could do with|has no|casts no|gets?|(?:make|let) .* (?:cast|throw)"
        ),
    ),
    (
        "remove",
        _word(
            f"{_AWAY}|take (?:it|that|them) (?:away|out|off)|bothers?|annoys?|without|no|gone|disappear|vanish|"
            "stayed(?: behind)?|stays|left ?over|left behind|remains|remained|still (?:there|here|visible)|"
            "should not be|get rid"
        ),
    ),
)
_SUBJECT = re.compile(
    r"^(?:(?:hey|well|so|now|but|hmm) )*(?P<what>(?:the|that|this|my|our) (?:[a-z-]+ ){0,2}?[a-z-]+) "
    r"(?:is|are|looks?|seems?|appears?|feels?|floats?|hovers?|has|have|lacks?)\b",
    re.I,
)
_FLOATING = re.compile(
    r"\b(?:float|hover|levitat|flying|flies|in the air|mid ?air|not (?:touch|ground)|unground)", re.I
)
_OTHERS = re.compile(
    r"\b(?:move|paint|put|place|turn|rotate|scale|make it|make the (?!shadow)|replace|duplicate|copy|insert|brighter|"
    r"and then|the light|lights|lighting)\b",
    re.I,
)


def _loosely(text: str) -> ShadowRequest | None:
    """A shadow that is named with its owner and one change: "the shadow under the bed is too dark", "lamp without
    shadow", "the plant is hovering, add a shadow"; None if either is missing, or more is asked for."""
    plain = unframed(" ".join(text.lower().replace(",", " ,").split()))
    text = plain.replace(" ,", ",").rstrip(".!? ")
    if _ASKING.match(text) or _DENIED.search(text) or "shadow" not in text or is_reported(text):
        return None
    first, comma, rest = text.partition(",")
    subject = _SUBJECT.match(first) if comma else None
    floating = subject is not None and _FLOATING.search(first) is not None and "shadow" in rest
    owner = next((m["what"] for p in _OWNERS if (m := p.search(text)) is not None), None)
    if (owner is None or owner in ("it", "them")) and floating and subject is not None:
        owner = subject["what"]
    change = next((c for c, p in _CHANGES if p.search(rest if floating else text)), None)
    if owner is None or change is None or _OTHERS.search(text.replace("make the shadow", "")):
        return None
    owner = re.sub(r"^(?:no|any|a|an|some|its|their) ", "", owner)
    return ShadowRequest(owner, change) if owner not in ("there", "i", "we", "you", "nothing", "light") else None


def _request(clause: str) -> ShadowRequest | None:
    clause = _ON.sub("", _AFTER.sub("", clause)).strip(" ,;")
    if _SHADED.search(clause) is None:  # each form names a shadow
        return None
    for change, pattern in _FORMS:
        if (found := pattern.match(clause)) is not None:
            words = found.groupdict().get("what")
            if words is None:
                return ShadowRequest("them" if found["own"].lower() == "their" else "it", change)
            if "," not in words and not re.search(
                r"\b(?:and|then|but)\b .*\b(?:make|put|move|delete|remove|paint|add)\b", words
            ):
                return ShadowRequest(words, change)
    return None
