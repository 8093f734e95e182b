"""Puts what stands in front of a command behind it: a place, an exclusion, a group, or the change itself.

"On the fridge put the kettle" is "put the kettle on the fridge", "apart from the blue one, delete all suitcases" leaves
one out, "of the two palms, delete the shorter" picks among them, and "20 cm to the left, the rug" moves the rug.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .....gaussians import late_re as re
from ...tagging.lookahead import Lookahead, color_at, is_hue, match
from ...vocabulary import lexicon, quantities
from ..chunks import is_thing
from ..speech.participles import at, participles
from ..speech.remarks import is_remark
from ..wishes.states import states
from .elision import JOINTS

_MOST = 4  # ends of a front that are tried
_ONLY = r"(?:only|just|solely|nothing but|no more than|none but)"
_STAYS = (
    r"(?:(?:should|must|can|may|shall|will|is to|are to|has to|have to|needs? to|gets? to|is allowed to) )?"
    r"(?:stays?|remains?|be left|be kept|survives?|is left|are left|is kept|are kept|is staying|be spared|is spared|"
    r"be there|be here)(?: where (?:it is|they are)| put| there| here| behind| as it is| as they are)*"
)
_AMONG = re.compile(
    rf"^(?:out )?of (?:all )?(?P<group>(?:the|those|these|my|our) (?:two |three |four |five |six |\d "
    rf")?(?P<nouns>[^,]+?))"
    rf"(?: ,)? (?P<rest>(?:{_ONLY} )?(?:the |that |this )\S.*|(?:keep|leave|spare|save) \S.*|(?:[a-z]+ ){{1,2}}the "
    rf"\S.*)$"
)
_KEPT_ONE = (
    re.compile(rf"^{_ONLY} (?P<one>the \S.*?) {_STAYS}$"),
    re.compile(rf"^(?P<one>the \S.*?) {_STAYS} {_ONLY}$"),
    re.compile(rf"^(?:keep|leave|spare|save) (?:(?:me|us) )?(?:{_ONLY} )(?P<one>the \S.*)$"),
    re.compile(rf"^(?:keep|leave|spare|save) (?:(?:me|us) )?(?P<one>the \S.*?)(?: {_ONLY}| alone)$"),
)
# Behind a command: what it leaves out.
_SPARED = tuple(
    re.compile(pattern)
    for pattern in (
        rf"^(?P<edit>\S.*?)(?: ,)*(?: (?:and|but|so|though|although|however))* {_ONLY} (?P<one>\S.*?) {_STAYS}$",
        rf"^(?P<edit>\S.*?)(?: ,)*(?: (?:and|but|so|though|although|however))* (?P<one>(?:the|my|our|that|this) \S.*?) "
        rf"{_STAYS}$",
        r"^(?P<edit>\S.*?)(?: ,)*(?: (?:and|but|so|though|although|however))* (?:only |just |please |do )*(?:spare|"
        r"keep|"
        r"leave|save|leave out|skip|ignore|mind you leave)(?: (?:me|us))?(?: only| just| with)* (?P<one>(?:the|my|"
        r"our|that|this) [^,]+?)"
        r"(?: alone| be| in place| there| here| where (?:it is|they are)| as (?:it is|they are)| out| though| "
        r"please)*$",
        r"^(?P<edit>\S.*?)(?: ,)*(?: (?:and|but|so|though|although|however|just|only|mind|please))* (?:not|never) "
        r"(?P<one>(?:the|my|our|that|this) [^,]+?)(?: though| please| of course| obviously)*$",
        r"^(?P<edit>\S.*?)(?: ,)*(?: (?:and|but|so|though|although|however|just|only|please))* do not (?:touch|delete|"
        r"remove|move|change|paint|hide|include|take|recolou?r|turn|rotate) (?P<one>(?:the|my|our|that|this) [^,]+?)"
        r"(?: though| please| of course| obviously)*$",
    )
)
_EXCLUDED = re.compile(
    r"^(?:all |everything )?(?:apart from|except for|except|besides|other than|but for|bar|barring|excluding|aside "
    r"from|save for|leaving aside|with the exception of) (?P<one>[^,]+?)(?: ,)+ (?P<rest>\S.*)$"
)
_FOR = re.compile(
    r"^(?P<state>\S.*?)(?: ,)* (?:(?:please|thanks|then)(?: ,)* )?(?:for|with|on) (?P<thing>(?:the|my|our|that|this|"
    r"those|these|"
    r"both|all|every) \S.*?)(?: please)?$"
)
_WHICH = re.compile(
    r"^(?:whichever|which|whatever)(?: one)? (?:of )?(?:the )?(?P<nouns>\S.*?) (?:is|are|looks|stands|sits|happens "
    r"to be)"
    r"(?: the)? (?P<which>\S+)(?: ,| \?)* (?P<rest>\S.*)$"
)


def fronted(said: str) -> Iterator[str]:
    """Readings with what stands in front moved to where a command has it."""
    yield from _among(said)
    yield from _spared(said)
    if found := _EXCLUDED.match(said):
        yield f"{found['rest']} except {found['one']}"
    if (found := _WHICH.match(said)) and found["which"] in _RANKS:
        yield from _filled(found["rest"], f"the {found['which']} {found['nouns']}")
    words = said.split()
    yield from _with_participle(said)
    yield from _unjoined(words)
    yield from _placed_first(words)
    yield from _changed_first(said)


_RANKS = {word for (word, *more), entry in lexicon.ATTRIBUTE_PHRASES.items() if not more and entry[0] == "SUP"}


def _filled(rest: str, thing: str) -> Iterator[str]:
    words = rest.split()
    for i, word in enumerate(words):
        if word in ("it", "that", "this", "them"):
            behind = words[i + 2 :] if words[i + 1 : i + 2] == ["one"] else words[i + 1 :]
            yield " ".join([*words[:i], thing, *behind])
            return


def _among(said: str) -> Iterator[str]:
    """ "of the two palms, delete the shorter", "of the suitcases only the blue one should stay"."""
    if not (found := _AMONG.match(said)):
        return
    group, rest = found["group"], found["rest"]
    for pattern in _KEPT_ONE:
        if kept := pattern.match(rest):
            yield f"delete all {found['nouns']} except {kept['one']}"
            return
    words = rest.split()
    for i in range(len(words), 0, -1):
        if words[i - 1] in ("one", "ones") or (words[i - 1],) in lexicon.ATTRIBUTE_PHRASES:
            head = words[: i - 1] if words[i - 1] in ("one", "ones") else words[:i]
            if head and head[-1] not in ("the", "that"):
                yield " ".join([*head, "of", group, *words[i:]])
                yield " ".join([*head, *found["nouns"].split(), *words[i:]])
                return


def _spared(said: str) -> Iterator[str]:
    """ "delete the suitcases but spare the blue one", "lose the suitcases, only the blue one stays"."""
    for pattern in _SPARED:
        if (found := pattern.match(said)) and Lookahead(found["edit"].split()).verb(0) is not None:
            yield f"{found['edit']} except {found['one']}"


_WITH = re.compile(
    r"^(?P<edit>\S.*?)(?: ,)? (?:and )?with (?P<thing>(?:the|that|this|my|our|both|all) [^,]+?) "
    r"(?P<state>\w+(?:ed|ne|en|ung|ut)(?: .*)?)$"
)


def _with_participle(said: str) -> Iterator[str]:
    """ "paint the table white, with the hamper moved next to it"."""
    if (found := _WITH.match(said)) and at(participles(), found["state"].split(), 0) is not None:
        for command in states(found["thing"], found["state"].split()):
            yield f"{found['edit'].removesuffix(' ,')} . {command}"
            return


def _unjoined(words: Sequence[str]) -> Iterator[str]:
    """ "the bear is so dull make it blue": a remark and a command with nothing between them."""
    for i in range(3, len(words) - 1):
        if words[i + 1] in ("it", "them") and words[i - 1] not in JOINTS and is_remark(words[:i]):
            verb = Lookahead(words[i:]).verb(0)
            if verb is not None and verb[1] == 1:
                yield " ".join([*words[:i], ",", *words[i:]])
                return


def _placed_first(words: Sequence[str]) -> Iterator[str]:
    """ "on the fridge put the kettle", "next to the bed I want a lamp"."""
    ahead = Lookahead(words)
    place = match(lexicon.CLOSED_PHRASES, words, 0)
    if place is None or not ahead.preposition_at(0):
        return
    tried = 0
    for i in range(place[1], len(words) - 1):
        rest = list(words[i:])
        comma = rest[0] == ","
        rest = rest[comma:]
        begins = Lookahead(rest).verb(0) is not None or rest[0] in ("i", "we", "there", "a", "an", "another", "some")
        if not begins or (i > place[1] and not (comma or is_thing(tuple(words[place[1] : i])))):
            continue
        if i == place[1] and place[0][0] not in ("SPOT", "SIDE", "CENTER"):
            continue
        added = ["add"] if rest[0] in ("a", "an", "another", "some") else []
        yield " ".join([*added, *rest, *words[:i]])
        tried += 1
        if tried == _MOST:
            return


def _changed_first(said: str) -> Iterator[str]:
    """ "20 cm to the left, the rug", "bit bigger, that rug", "black for the chandelier"."""
    pairs = [(a, b) for a, comma, b in (said.rpartition(" , "),) if comma]
    if found := _FOR.match(said):
        pairs.append((found["state"].removesuffix(" ,"), found["thing"]))
    for state, thing in pairs:
        words = state.split()
        if words and words[0] in ("bit", "touch", "tad", "little", "smidge"):
            words = ["a", *words]
        if "," in words or Lookahead(words).verb(0) is not None or not _is_change(words):
            continue
        if is_thing(tuple(thing.split())):
            yield from states(thing, words)


def _is_change(words: Sequence[str]) -> bool:
    """Whether words begin with what becomes of a thing, and name none."""
    if color_at(words, 0) is not None:
        return is_hue(words)
    degree = match(lexicon.CLOSED_PHRASES, words, 0)
    if degree is not None and degree[0][0] in ("DEGREE", "GROWN", "LIGHT", "DIR", "TIMES", "UPSIDE", "MORE", "LESS"):
        return True
    amount = quantities.read(words)
    return words[0] == "double" or (amount is not None and amount.kind not in ("NUMBER", "ORDINAL"))
