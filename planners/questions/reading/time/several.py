"""Reads questions that are made of others: with names to choose from, of two deeds, or behind another sentence.

"Which of these moves, the bench or the door?" is "which moves" of two things; "does the lamp fall, or at least move?"
is so where either is; "when does it reach the wall and stop?" is when both are.
"""

from __future__ import annotations

from collections.abc import Iterator

from .....gaussians import late_re as re
from .....gaussians.world import kinds
from .....gaussians.world.words import singular
from .deeds import said_in
from .happenings import thing
from .moments import NUMBER, SECONDS, without_time

_RANKED = re.compile(
    r"\b(?:first|earlier|sooner|later|last|next|faster|slower|quicker|longer|shorter|farther|wider|more|less|most|"
    r"fastest|slowest|longest|farthest)\b"
)
_CHOICE = re.compile(
    r"^(?P<q>(?:what|which|who)\b.+?) , (?P<o>(?:(?:the|a|my) )?\w+(?: \w+)*?(?: , (?:(?:the|a|my) "
    r")?\w+(?: \w+)*?)*(?: ,)? "
    r"or (?:(?:the|a|my) )?\w+(?: \w+)*)(?P<u> in \w+)?$"
)
_IS_IT = re.compile(
    r"^(?:is|was) it (?P<a>(?:the|a) \w+(?: \w+)?) or (?P<b>(?:the |a )?\w+(?: \w+)?) (?:that|which) "
    r"(?P<q>.+)$"
)
_OF_THESE = re.compile(
    r"^(what|which|who)(?: one| thing)?s? of (?:these|those|them|the following)(?: things| objects)?\b"
)
_AUX = r"(?:is|are|was|were|does|do|did|has|have|will)"
_OR = re.compile(
    rf"^(?P<aux>{_AUX}) (?P<x>.+?)(?: ,)? or (?:at least |even |perhaps |does it |did it |is it )*(?P<b>.+)$"
)
_AND = re.compile(
    r"^(?P<q>(?:when|at what time|at which (?:time|second|moment)) (?:does|do|did|has|have|is|will)) "
    r"(?P<x>.+?) and "
                  r"(?:then )?(?:also )?(?P<b>\w+(?: \w+){0,4})$")  # fmt: skip
_OPPOSED = re.compile(
    r"\b(?:open|opened|closed|shut|opening|closing|still|moving|stopped|left|right|up|down|in|out|on|off|not|clockwise|"
    r"counterclockwise|before|after|forwards?|backwards?)$"
)
_SHARE = re.compile(
    r"^(?:for |during )?(?:(?:what|which)(?: is the)?|(?:what is )?the) "
    r"(?P<s>share|fraction|percentage|percent|proportion|portion) of "
    r"(?:the |its |these |those )?(?:whole |total |entire |full )?(?:(?:[a-z]+|\d+) (?:s |seconds? ?)(?:of )?)?"
    r"(?:clip|video|film|movie|scene|time|shot|recording|record|footage|running time|(?<=seconds )|(?<=seconds))"
    r" ?(?:for |in |during )?(?:which |that )?(?P<x>.+)$"
)
_IN_MOTION = re.compile(  # "is the fan in motion", "does the drawer spend in motion", "shows the door in motion"
    r"^(?:is|are|does|do|shows?|has|have) (?P<x>.+?) (?:spend |spent |spends )?(?:in motion|moving|on the move)$"
)
_WHICH_ONE = re.compile(
    r"^(?:so |and )?(?:which|what)(?: one| of them)?(?: is it| was it| exactly)?(?: ,? ?(?:dear|please|then))?$"
)
_SOMETHING = re.compile(r"\b(?:a|an|one|some) (?P<x>\w+(?: \w+)?)$")
_TOLD = re.compile(
    rf"\b{NUMBER} {SECONDS}\b|\d|\b(?:after|before|when|while|until|once|if|except|besides|excluding|ignoring|only|"
    r"without counting|counting|apart|other than|(?:first|last) (?:time|one|second))\b",
    re.IGNORECASE,
)
_PERSON = re.compile(
    r"\b(?:hi|hello|hey|quick|basically|i|i'm|i'd|i've|we|my|me|our|us|you|your|mum|mom|dad|gosh|ages|sorry|please|"
    r"says?|said|thinks?|thought|"
    r"wonders?|asked|"
    r"asks?|asking|bets?|swears?|claims?|reckons?|guess|wow|honestly|assuming)\b"
)
_BEGINS = re.compile(
    r"^(?:but |so |and |then |well |ok |okay )*(?P<q>(?:how|what|which|when|where|who|whereabouts|is|are|was|were|"
    r"does|do|did|has|"
    r"have|will|at what|at which|in what|in which|by how|for how|to what)\b.+)$"
)
_ASKING = re.compile(r"\b(?:at (?:what|which)|when|how|where|what|which)\b")
_WHEN_THAT = re.compile(
    r"^(?:so |and )?(?:when|what time|how long|how far|how fast|where|which|what) (?:is|was) "
    r"(?:that|it|this)(?: exactly)?$"
)
_MEANT = re.compile(
    r"^(?P<x>.+?)(?:[,;:–—]|\.\.\.)? (?:i mean|or rather|in other words|or should i say|i ?\.? ?e\.?|"
    r"or nah,? like|like|no,? wait|wait,? no|scratch that|correction)[, ]+"
    r"(?P<q>(?:is|are|was|were|does|do|did|has|have|will|when|how|where|which|what)\b.+)$",
    re.IGNORECASE,
)
_THEN = re.compile(r" (?:then|by then)(?=[?. ]|$)")
_IT = re.compile(r" (?:it|he|she|they) ")
_PRONOUN = re.compile(r"(?<=does|.did|..is|.was|.has) (?:it|he|she|they)(?=[ ?.!,]|$)", re.IGNORECASE)
_SENTENCE = re.compile(r"(?<=[.!?])\s+(?=[A-Z\"'(a-z])")


def choice(said: str) -> tuple[str, tuple[str, ...]] | None:
    """A question without the names that it offers, and these; None if it offers none."""
    if (of := _IS_IT.match(said)) is not None:
        noun = of["b"].split()[-1]
        a = of["a"] if noun in of["a"].split() or thing(of["a"]) is not None else f"{of['a']} {noun}"
        return (
            (f"which {noun} {of['q']}", (a, of["b"])) if thing(a) is not None and thing(of["b"]) is not None else None
        )
    if (found := _CHOICE.match(said)) is None:
        return None
    options = tuple(_full(o, found["q"]) for o in re.split(r"(?: ,)? or | , ", found["o"]))
    if len(options) < 2 or (len(options) < 3 and _RANKED.search(said)) or any(thing(o) is None for o in options):
        return None
    return _OF_THESE.sub(r"\1", found["q"]) + (found["u"] or ""), options


def _full(option: str, question: str) -> str:
    """An option with the noun that the question says: "which drawer moves, the top one or the bottom one"."""
    noun = re.match(r"^(?:what|which) (?:of the )?(?P<n>\w+)", question)
    one = re.match(r"^(?:the )?(?P<x>top|bottom|middle|upper|lower|left|right|first|second|third)(?: one)?$", option)
    return f"the {one['x']} {singular(noun['n'])}" if noun is not None and one is not None else option


def either(said: str) -> tuple[str, str] | None:
    """Two questions of which one must hold: "does it fall, or at least move a little"; None if it is no such "
    "question."""
    found = _OR.match(said)
    if found is None or _OPPOSED.search(found["x"]) or said.count(" or ") != 1:
        return None
    for start, stop, _ in said_in(found["x"]):
        if stop >= len(found["x"]) - 1 or thing(found["x"][stop:]) is not None:
            subject = found["x"][:start].strip()
            subject = re.sub(r" (?:get|gets|got|ever|be)$", "", subject)
            other = re.sub(r" (?:a little|a bit|slightly|otherwise|at all)\b", "", found["b"])
            begins = next(iter(said_in(other)), None)
            if thing(subject) is not None and begins is not None and begins[0] == 0:
                aux = "does" if found["aux"] in ("did", "do") else found["aux"]
                return f"{found['aux']} {found['x']}", f"{aux} {subject} {other}"
    return None


def share(said: str) -> tuple[str, bool] | None:
    """A question for a share of the scene's time as one for a time, and whether percent are asked; None: it is none."""
    if (found := _SHARE.match(said)) is None:
        return None
    rest = _IN_MOTION.sub(r"does \g<x> move", re.sub(r" for$", "", found["x"]))
    return f"how long {rest}", found["s"].startswith("percent")


def both(said: str) -> tuple[str, str] | None:
    """Two questions for one time: "when does it reach the wall and stop"; None if it is no such question."""
    if (found := _AND.match(said)) is None:
        return None
    begins = next((s for s in said_in(found["b"]) if s[0] == 0), None)
    if begins is None:
        return None
    for start, _, _ in sorted(said_in(found["x"]), key=lambda s: s[0]):
        subject = found["x"][:start].strip()
        if subject and thing(subject) is not None:
            return f"{found['q']} {found['x']}", f"{found['q']} {subject} {found['b']}"
    return None


def question_alone(text: str) -> Iterator[str]:
    """The question in a text that says more by itself: "I lost my glasses. Is the door open at 2 s?".

    What is left out tells no time, no number and no exception.
    """
    sentences = [s for s in _SENTENCE.split(text.strip()) if s.strip()]
    asked = [s for s in sentences if s.endswith("?")] or sentences[-1:]
    if len(sentences) > 1 and len(asked) == 1:
        others = [s for s in sentences if s is not asked[0]]
        if not any(_TOLD.search(s) for s in others):
            question, before = asked[0].rstrip("?. ").lower(), others[-1].rstrip("?.! ").lower()
            if _WHICH_ONE.match(question.replace(",", " ,")):
                yield from _which_one(before)
            elif _WHEN_THAT.match(question) and (cue := _ASKING.search(before)) is not None:
                yield f"{before[cue.start() :]}?"
            else:
                yield _named_before(asked[0], before)
            return
    yield from _meant(text)
    yield from _behind_a_comma(text)


def _named_before(question: str, before: str) -> str:
    """A question with the one thing that the sentence before it names in place of its pronoun: "I have a car here. Did
    it move?"."""
    named, it = _one_named(re.findall(r"[\w.]+", before)), _PRONOUN.search(question)
    if not named or it is None or any(kinds.find(singular(w)) for w in question[: it.start()].lower().split()):
        return question
    return _PRONOUN.sub(f" {named}", question, count=1)


def _meant(text: str) -> Iterator[str]:
    """ "Does the lamp come to harm, I mean does it fall?": the second question, of the one thing that is named."""
    if (found := _MEANT.match(text.strip())) is None:
        return
    words = re.findall(r"[\w.]+", found["x"].lower())
    named = _one_named(words)
    question = found["q"]
    if _TOLD.search(found["x"]):
        time, bare = without_time(" ".join(words))
        if time is None or not _THEN.search(question):
            return
        when = " ".join(_without(words, bare.split()))
        question = _THEN.sub(f" {when}", question)
    if named or not _IT.search(question):
        yield _IT.sub(f" {named} ", question, count=1)


def _one_named(words: list[str]) -> str:
    """The thing that a question is about: behind its first word, or the only one that is named; "" if none is."""
    for stop in range(min(len(words), 8), 2, -1):
        said = " ".join(words[1:stop])
        if words[1] in ("the", "that", "this") and kinds.find(singular(words[stop - 1])) and thing(said) is not None:
            return said
    named = {w for w in words if kinds.find(singular(w)) is not None and not any(True for _ in said_in(w))}
    return f"the {next(iter(named))}" if len(named) == 1 else ""


def _without(words: list[str], less: list[str]) -> list[str]:
    """Words without others, each of which is taken out once."""
    kept = list(words)
    for word in less:
        if word in kept:
            kept.remove(word)
    return kept


def _which_one(before: str) -> Iterator[str]:
    """ "A drawer pops out. Which one?" """
    for start, _, _ in sorted(said_in(before), key=lambda s: s[0]):
        if (named := _SOMETHING.search(before[:start].strip())) is not None:
            yield f"which {named['x']} {before[start:]}?"
            return


def _behind_a_comma(text: str) -> Iterator[str]:
    """A question behind what somebody says of himself: "my wife says no way, but does the ball roll?"."""
    parts = re.split(r"\s*[,;:–—]\s+", text.strip())
    for i in range(1, len(parts)):
        begins = _BEGINS.match(parts[i].lower())
        said = [p.lower().split() for p in parts[:i]]
        if begins is not None and all(_says_nothing(p) for p in said):
            yield ", ".join([parts[i][begins.start("q") :], *parts[i + 1 :]])
            return


def _says_nothing(words: list[str]) -> bool:
    """Whether a clause is about who asks: it holds no time, number, exception, and nothing that happens or is there."""
    said = " ".join(words)
    if _TOLD.search(said) or not _PERSON.search(said):
        return False
    return not any(thing(f"the {w}") is not None and kinds.find(singular(w)) is not None for w in words)
