"""Leaves out remarks on how things are beside an order: "it is in the way, move it", "move it, it needs light"."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .....gaussians import late_re as re
from ...tagging.lookahead import Lookahead, color_at
from ...tagging.words import bag
from ...vocabulary import doings, nouns
from ..chunks import is_thing
from ..order.elision import JOINTS, substitute
from ..wishes.judgements import is_judged
from ..wishes.states import states

_SUBJECTS = bag(
    "never i we you it they he she nobody everybody everyone someone somebody people guests visitors there this "
    "that these those my our the grandma mum mom dad granny grandpa clients customers kids children"
)
_NOBODY = bag(
    "i we you it they he she there nobody everybody everyone people someone somebody guests visitors "
    "clients customers kids"
)
_REMARKING = bag(
    "use uses wobbles wobble squeaks squeak leaks leak creaks rattles flickers buzzes sags stinks smell smells "
    "clash gathers "
    "is are was were am looks look seems seem feels feel keeps keep gets get takes take blocks block "
    "bothers hates hate likes like loves love wants want needs need thinks think says said has have had "
    "does do did goes comes come coming bumping bump can could will would might may never always sits sit "
    "stands stand sticks fits fit clashes matches annoys hurts drives makes broke cost bought 's collects "
    "wastes smells works spoils ruins hides hide suits belongs sees see find finds cannot started reminds "
    "used lets got prefers"
)
_OPENING_NOUNS = bag("the a an my our your his her its that this those these all both every each some any and or of")
_ASKING = re.compile(
    r"\b(?:should|must|ought|(?:has|have|needs?|wants?|got) to|to be|could you|can you|would you|will you|please|"
    r"instead|"
    r"would (?:like|rather|prefer|love)|had better|i mean|i meant|delete|remove|paint|recolou?r|move|rotate|"
    r"replace|duplicate|not|if|unless|could do "
    r"with|(?:needs?|wants?) \w+ing)\b"
)
_NEGATED = re.compile(r"\b(?:can|do|does|did|will|would|could|is|are|was|were|has|have|had|am) not\b")
_COAT = re.compile(r"\b(?:coat|lick|layer|splash|touch)s? of paint\b")


def is_remark(said: Sequence[str]) -> bool:
    """Whether words only say how things are: they begin with a subject, hold a finite verb, and ask for nothing."""
    text = " ".join(said)
    if _NEEDING.match(text) or _LOOKING.match(text) or _judged(said) is not None:
        return True
    return (
        len(said) > 1
        and said[0] not in ("whatever", "whichever", "what", "which", "who")
        and Lookahead(said).verb(0) is None
        and (said[0] in _SUBJECTS or said[1] in _REMARKING or _has_subject(said))
        and any(finite_at(said, i) for i in range(1, len(said)))
        and not _ASKING.search(_NEGATED.sub("cannot", _COAT.sub("", text)))
    )


def _has_subject(said: Sequence[str]) -> bool:
    """Whether words begin with a thing and what is said of it: "two parasols is one too many"."""
    hue = color_at(said, 0)
    if hue is not None and hue[1] < len(said) and finite_at(said, hue[1]):
        return True  # "white shows every fingerprint"
    return any(finite_at(said, i) and is_thing(tuple(said[:i])) for i in range(1, min(len(said), 5)))


def _judged(said: Sequence[str]) -> list[str] | None:
    """The thing that a judgement names behind it, empty if none; None for other words: "too bright, that rug"."""
    judgement, _, thing = " ".join(said).partition(" , ")
    if is_judged(said):
        return []
    return thing.split() if is_judged(judgement.split()) and is_thing(tuple(thing.split())) else None


def finite_at(said: Sequence[str], i: int) -> bool:
    """Whether the word at `i`, which is not the first, says what is, was or is done by what stands before it."""
    word, before = said[i], said[i - 1]
    if word in _REMARKING:
        return True
    if i == 1 and before in ("it", "that", "this", "he", "she") and word.endswith("s") and len(word) > 3:
        return word not in ("belongs", "this")
    if before in _OPENING_NOUNS or (word not in doings.said_of_one() and not (word in doings.plain() and _many(said))):
        return False
    return said[0] in _NOBODY or not nouns.is_known(word)


def _many(said: Sequence[str]) -> bool:
    """Whether the subject is people or things in the plural, so that its verb has no ending: "guests trip"."""
    return said[0] in _NOBODY and said[0] not in ("it", "he", "she")


def remarks(said: Sequence[str]) -> Iterator[list[str]]:
    """Readings without a remark before or behind the order: "it is in the way, move it", "move it, it needs light"."""
    for i, word in enumerate(said):
        if word not in JOINTS or not 0 < i < len(said) - 1:
            continue
        first, second = _trimmed(said[:i]), _trimmed(said[i + 1 :])
        if first and second and is_remark(first):
            thing = subject_of(first)
            if (
                thing
                and (hue := _HUE_WISH.match(" ".join(second)))
                and color_at(second, len(second) - hue["hue"].count(" ") - 1)
            ):
                yield ["paint", *_of_whom(thing), *hue["hue"].split()]
            if thing and (state := _BETTER_SO.match(" ".join(second))):
                yield from (s.split() for s in states(" ".join(thing), state["state"].split()))
            if far := _FAR_FROM.search(" ".join(first)):
                second = _toward(second, far["goal"])
            filled = substitute(thing or ("it",), second)
            if filled is None or thing:
                yield filled or [*first, ".", *second]
                yield filled or second
        if first and second and is_remark(second) and word != "and":
            yield first


_OF_IT = ("it", "they", "he", "she", "we", "i", "nobody", "everyone", "that", "someone", "somebody", "people", "there")


def without_remark(said: Sequence[str]) -> str | None:
    """A command without the remark behind it that begins with a pronoun; None if there is none."""
    for i in range(len(said) - 2, 1, -1):
        behind = said[i + 1 :]
        if said[i] == "," and behind[0] in _OF_IT and "," not in behind and is_remark(behind):
            kept = list(said[:i])
            return " ".join(kept) if Lookahead(kept).verb(0) is not None or len(kept) > 1 else None
    return None


# "The red is too loud, go for beige"; "the table is too far from the sofa, move it closer".
_HUE_WISH = re.compile(
    r"^(?:please |just |let us |rather |maybe |i would |we could |so )*(?:go|try|use|make that|how about|what about|"
    r"i would say|let us say|say) (?:with |for |it |in |a |to )*(?P<hue>\S+(?: \S+)?)(?: instead| please| then)*$"
)
_BETTER_SO = re.compile(
    r"^(?P<state>(?:a |an |\d|half|two|ten|twenty|thirty|slightly |much |somewhat )\S*.*?) (?:would|might|will) "
    r"(?:be|look|work|suit) "
    r"(?:it |them )?(?:a bit |a lot |much |far )?(?:better|nicer|good|great|best|fine|perfect)$"
)
_FAR_FROM = re.compile(r"\btoo (?:far|close)(?: away)? (?:from|to) (?P<goal>(?:the|that|this|my|our) \S.*)$")


def says_how_far(said: Sequence[str]) -> bool:
    """Whether words say that a thing is too far from another, so that "closer" behind them means to that one."""
    return _FAR_FROM.search(" ".join(said).partition(" , ")[0]) is not None


def _of_whom(thing: Sequence[str]) -> Sequence[str]:
    """The thing whose colour a phrase names: "the red of the rug" is about the rug."""
    of = "of" in thing and color_at(thing, 1) is not None
    return thing[list(thing).index("of") + 1 :] if of else thing


def _toward(second: Sequence[str], goal: str) -> list[str]:
    """A command with what it is to be closer to, or away from, named."""
    if second[-1] in ("closer", "nearer"):
        return [*second, "to", *goal.split()]
    return list(second)


def _trimmed(said: Sequence[str]) -> list[str]:
    words = list(said)
    while words and words[0] in JOINTS:
        words = words[1:]
    while words and words[-1] in JOINTS:
        words = words[:-1]
    return words


_THERE_IS = re.compile(r"^there (?:is|are) (?:a|an|some|one|two|three|four|this|that|these|those) (?P<thing>\S.*)$")
# What the speaker wants to do, not to have done: "I want to have a closer look".
_LOOKING = re.compile(
    r"^(?:so )?(?:i|we|she|he|they) (?:just |only )?(?:wants?|needs?|would like|wish|am going|are going|have|has|am "
    r"trying|are trying|plan|intend) "
    r"to (?:have a|take a|get a|look|see (?:it|them|what|how|whether|if|\S.* by (?:itself|themselves))|check|"
    r"inspect|compare|study|admire|read|"
    r"count|photograph|think|focus|"
    r"concentrate|work|sleep|sit|cook|play|eat|dance|practise|film|get (?:past|through|by|in|out|to)|walk|reach)\b"
)
_COLOR_OF = re.compile(
    r"^(?:the|that|this) (?:colou?r|shade|tone|\w+) of (?P<thing>(?:the|that|this|my|our) (?:\w+ ){1,3}?)(?:is|"
    r"looks|does|clashes|"
    r"feels|seems|hurts|jars|goes|bothers|annoys) "
)
_NEEDING = re.compile(
    r"^(?:(?:i|we|you|it|this room|the room) )?(?:need|needs|want|wants|could use) (?:(?:more|some|the|that|a bit "
    r"more|a "
    r"bit of|a little more) "
    r"(?:light|space|room|storage|seating|colou?r|air|warmth|privacy|order|variety)|(?:somewhere|something|someone|"
    r"a place|space|room|"
    r"some|more) .*|.* (?:clear|free|empty|tidy))$"
)
_LINKING = bag(
    "is are was were looks look seems seem feels feel 's clashes blocks takes needs need gets has have "
    "does do can sits stands sticks spoils ruins"
)
_BEHIND_THING = re.compile(
    r"(?: (?:any ?more|any longer|again|now|at all|there|here|really|so much|either|all the time))+$"
)


def subject_of(said: Sequence[str]) -> list[str] | None:
    """The thing that a remark is about: its subject if it says how that is, else the last thing that it names."""
    if judged := _judged(said):
        return judged
    if found := _THERE_IS.match(" ".join(said)):
        return ["the", *found.group("thing").split()]
    if found := _COLOR_OF.match(" ".join(said)):
        return found["thing"].split()
    words = _BEHIND_THING.sub("", " ".join(said)).split()
    subject: list[str] | None = None
    for i in range(1, min(len(words), 10)):
        if finite_at(words, i):
            thing = tuple(words[:i])
            if words[0] in ("one", "a", "an") and i > 1 and words[1] != "of" and is_thing(tuple(words[1:i])):
                return ["the", *words[1:i]]
            named = words[0] in ("the", "that", "this", "these", "those", "my", "our") or i == 1
            if words[0] not in _NOBODY and named and is_thing(thing):
                subject = list(thing)
            if subject and words[i] in _LINKING:
                return subject
            break
    for i in range(len(words) - 1, 0, -1):
        if words[i + 1 : i + 2] and words[i + 1] in nouns.EVERYWHERE:
            continue  # of "the bike off the floor" the floor is not what it is about
        if words[i] in ("the", "that", "this", "those", "these", "my", "our") and is_thing(tuple(words[i:])):
            return list(words[i:])
        if words[i] in ("two", "three", "four", "five", "both") and is_thing(tuple(words[i:])):
            return ["the", *words[i:]]
    return subject
