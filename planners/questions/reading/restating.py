"""Restates a question that no template reads: by a cue ("far", "tall", "how many") and the things that it names.

    "planning to hang a print , the bookcase , how high does that one go up"  ──►  "how tall is the bookcase"

A question is restated only if hardly a word of it is left over, so that nothing is dropped that may change its meaning.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from functools import lru_cache

from ....gaussians import late_re as re
from ....gaussians.world import kinds
from ....gaussians.world.words import is_plural, normalise, plural, singular
from ...grammar.tagging.words import bag
from . import noun_phrase
from .phrase_templates import Words

_MOST_LEFT = 1  # words that may be left over
_LONGEST_NAME = 5  # words
_BLOCKS = bag(
    "not no except without excluding besides only never neither nor unless other others another else own owns owner "
    "bought cost costs price worth brand made material old age heavy weigh weighs comfortable comfy why who whose when "
    "clean dirty dusty open closed shut locked working broken than if further more less same different both each every "
    "second third fourth hard harder difficult tricky awkward impossible unable dangerous unsafe risky avoid detour "
    "shine shines shining illuminate reflect reflects reflected"
)
_SITUATED = bag(
    "sat sit sitting seated stood standing stand lying lie lay facing face faces back after before once until"
)
_PRONOUNS = ("it", "them", "those", "these", "that", "this", "they")
_DETERMINERS = bag("the a an my our your his her their this that these those any some all both two three four five")
_ADJECTIVES = bag(
    "big small large little tall short wide narrow long high low tiny huge old new nice round square wooden main left "
    "right far near leftmost rightmost biggest smallest tallest shortest largest back front rear hand"
)
# Words that say nothing about what is asked.
_CHATTER = bag(
    "lot laid boast boasts sport sports offer offers stood who whom mind hogs measured middle middles centre centres "
    "center centers edge edges ignoring crow flies tape bedroom kitchen office lounge living dining bathroom studio "
    "point precisely total everything all those these wait hm kind type sorts "
    "give 's enumerate itemise itemize resting kept separates sticks says whole entire going kind sort piece mean "
    "compare compared work works hang hanging choose chosen picked pick big little bit side sides house owner's or "
    "i we you he she they me us my our your it its the a an this that these those there here is are was were am "
    "be been being do does did have has had got get gets getting can could would will should might may shall must "
    "of in on at to for from with and or so as by up off out into about just only really please ok okay well now "
    "then also too very quite pretty some any one ones thing things stuff room rooms place house home flat "
    "apartment scene picture currently actually need needs want wants like think know knows tell say see look "
    "looks looking find check exactly roughly about around approximately what which where how when whether s re "
    "whereabouts many much what's going go goes come comes let lets put puts putting use using measure measuring "
    "measured measurement figure figuring guess wondering curious thinking planning trying buy buying order "
    "ordering move moving before after because since today tomorrow later mate love dear darling mum dad grandma "
    "kids kid child friend guys folks people person someone somebody anyone anybody everyone exact rough overall "
    "maximum max minimum min reckon suppose imagine stand stands standing sit sits sitting sat placed located "
    "situated sitting lying lies lay right now quick quickly hello hi hey thanks thank cheers ta sorry excuse ask "
    "asking question wonder curiosity random stupid silly idea clue sure counting counted altogether inside "
    "visible present exist exists happen happens seem seems appear appears contain contains include includes "
    "feature features fitted spot spotted notice anywhere somewhere"
)
_ON = ("on top of", "on", "upon", "atop")
_RELATIONS = {
    **dict.fromkeys(_ON, "on"),
    **dict.fromkeys(("underneath", "under", "beneath", "below"), "under"),
    **dict.fromkeys(("above", "over"), "above"),
    **dict.fromkeys(
        ("next to", "round", "around", "beside", "alongside", "right by", "close to", "near", "by"), "next to"
    ),
    **dict.fromkeys(("in front of", "before"), "in front of"),
    **dict.fromkeys(("behind", "in back of"), "behind"),
    **dict.fromkeys(("to the left of", "left of", "on the left of", "to the left hand side of"), "left of"),
    **dict.fromkeys(("to the right of", "right of", "on the right of", "to the right hand side of"), "right of"),
    **dict.fromkeys(("inside", "within"), "in"),
}
_LINKS = ("at", "in", "with", "that is on", "that is by", "standing on", "sitting on", "hanging on", "lying on")
_AUXILIARIES = bag("is are was were does do did has have can could will would should am whether")
_SIZES = {
    **dict.fromkeys(("tall", "height", "high", "tallness"), "how tall {be} {a}"),
    **dict.fromkeys(("wide", "width", "broad", "across"), "how wide {be} {a}"),
    **dict.fromkeys(("deep", "depth"), "how deep {be} {a}"),
    **dict.fromkeys(("long", "length"), "how long {be} {a}"),
    **dict.fromkeys(
        ("dimensions", "measurements", "size", "big", "large", "footprint"), "what are the dimensions of {a}"
    ),
}
_COMPARED = re.compile(
    r"(taller|higher|bigger|larger|wider|broader|longer|deeper|smaller|shorter|narrower|lower|thinner|thicker)$"
)
_MOST = re.compile(
    r"(tallest|highest|biggest|largest|widest|longest|deepest|smallest|shortest|narrowest|lowest|tiniest|thinnest|"
    r"loftiest|teeniest|hugest)$"
)
_PLAIN_MOST = {"loftiest": "tallest", "teeniest": "smallest", "tiniest": "smallest", "hugest": "biggest"}
_ROOM_SIZES = {"high": "high", "height": "high", "tall": "high", "wide": "wide", "width": "wide", "long": "long",
               "length": "long"}  # fmt: skip
_MEASURED_ROOM = bag("room ceiling space place bedroom kitchen lounge office bathroom studio")


@dataclass(frozen=True)
class Named:
    """A noun phrase in a question: its words from `start` to `end`."""

    start: int
    end: int
    said: str
    plural: bool

    @property
    def definite(self) -> str:
        """With a determiner: "the sofa"."""
        return self.said if self.said.split()[0] in _DETERMINERS else f"the {self.said}"

    @property
    def bare(self) -> str:
        """Without a determiner: "sofa"."""
        first, _, rest = self.said.partition(" ")
        return rest if first in _DETERMINERS and rest else self.said


@dataclass(frozen=True)
class _Clause:
    """A clause with the things that it names."""

    words: Words
    named: tuple[Named, ...]
    asks_yes_no: bool

    def has(self, *cues: str) -> bool:
        return any(cue in self.words for cue in cues)

    @property
    def said(self) -> str:
        return " ".join(self.words)

    def between(self, a: Named, b: Named) -> str:
        """The words between two things."""
        return " ".join(self.words[a.end : b.start])


_ELSEWHERE = re.compile(
    r"\b(?:next door|neighbou?rs?|upstairs|downstairs|outside|yesterday|last (?:week|year|time)|"
    r"(?:have|need|must|forced) (?:to )?(?:walk|go|step|climb|squeeze|move|get) (?:around|round|over|past|between))\b"
)
# What says no more than the question does: a way is clear if one can walk it, and sides are the viewer's.
_TAIL = re.compile(
    r",? if you (?:would|will|could) be so kind|,? if you please|"
    r" without (?:anything|something|moving|bumping|having|hitting|tripping|squeezing|climbing)\b.*$"
    r"|(?:(?:,? )|^)(?:as|when) i (?:look|come|walk|am looking)(?: in| at it)?(?= ,|$)"
    r"|(?:(?:,? )|^)(?:seen |viewed |looking )?from (?:my (?:viewpoint|point of view|side|position)|"
    r"(?:the spot )?where (?:i|the viewer|the visitor) (?:look|looks|stand|stands)(?: in)?)(?: outside)?(?: ,|(?= )|$)"
)


def restated(words: Words, labels: Collection[str]) -> Iterator[str]:
    """Plainer questions that the words may mean, the likeliest first.

    Args:
        words: of the question, in plain form, with commas between its clauses.
        labels: of the things in the scene, whose names count as known beside those of all kinds.
    """
    known = frozenset(name for label in labels for name in _names_of(label))
    if _ELSEWHERE.search(" ".join(words)):
        return
    words = tuple(_TAIL.sub("", " ".join(words)).split())
    plain = tuple(w for w in words if w != ",")
    made = dict.fromkeys((*_fitting(words), *_seated(plain, tuple(_named(plain, known)))))
    for clause in _clauses(words, known):
        named = tuple(_named(clause, known))
        asks_yes_no = any(part[0] in _AUXILIARIES for part in _parts(words) if set(part) <= set(clause))
        for things in (named, *_joined(clause, named)):
            held = _Clause(clause, things, asks_yes_no)
            for rule in _RULES:
                for question in rule(held):
                    if _leaves_little(held, question, 3 if rule in (_areas, _ways) else _MOST_LEFT):
                        made[question] = None
    yield from (q for q in made if tuple(q.split()) != words)


def _clauses(words: Words, known: frozenset[str]) -> Iterator[Words]:
    """The whole question, then its clauses from the last to the first, with a pronoun replaced by what it stands for.

    A clause alone is the question only if no other one restricts it or says where somebody is.
    """
    said = _parts(words)
    yield tuple(w for w in words if w != ",")
    for i in reversed(range(len(said))):
        others = [w for k, clause in enumerate(said) if k != i for w in clause]
        if len(said) < 2 or any(w in _BLOCKS or w in _SITUATED for w in others):
            continue
        before = [n for clause in said[:i] for n in _named(clause, known)]
        pronoun = next((said[i].index(p) for p in _PRONOUNS if p in said[i]), None)
        if pronoun is not None and before and not [*_named(said[i], known)]:
            end = pronoun + 1 + (said[i][pronoun + 1 : pronoun + 2] in (("one",), ("thing",)))
            yield (*said[i][:pronoun], *before[-1].definite.split(), *said[i][end:])
        else:
            yield said[i]


def _parts(words: Words) -> list[Words]:
    """The words between commas."""
    return [tuple(part.split()) for part in re.split(r"\s*,\s*", " ".join(words)) if part.strip()]


@lru_cache(maxsize=4096)
def _names_of(label: str) -> tuple[str, ...]:
    base = " ".join(label.lower().split())
    return (base, plural(base), base.split()[-1] if base else "")


def _is_name(said: str, known: frozenset[str]) -> bool:
    """Whether words name a kind of thing, or something in the scene."""
    return said in known or singular(said) in known or kinds.find(said) is not None


def _named(words: Words, known: frozenset[str]) -> Iterator[Named]:
    """The noun phrases of known things, from left to right, each as long as it can be."""
    at = 0
    while at < len(words):
        for end in range(min(len(words), at + _LONGEST_NAME), at, -1):
            name = " ".join(words[at:end])
            if words[at] not in _DETERMINERS and name not in _CHATTER and _is_name(name, known):
                start = at
                while start > 0 and (words[start - 1] in _ADJECTIVES or noun_phrase.is_color_word(words[start - 1])):
                    start -= 1
                if start > 0 and words[start - 1] in _DETERMINERS:
                    start -= 1
                said = " ".join(words[start:end])
                if noun_phrase.thing(tuple(said.split())) is not None:
                    yield Named(start, end, said, is_plural(words[end - 1]))
                    at = end
                    break
        else:
            at += 1


def _joined(words: Words, named: tuple[Named, ...]) -> Iterator[tuple[Named, ...]]:
    """The things with two neighbours taken for one phrase: "the chair at the desk", from the last pair to the first."""
    for i in reversed(range(len(named) - 1)):
        a, b = named[i], named[i + 1]
        link = " ".join(words[a.end : b.start])
        if link in _RELATIONS or link in _LINKS:
            both = " ".join(words[a.start : b.end])
            if noun_phrase.thing(words[a.start : b.end]) is not None:
                yield (*named[:i], Named(a.start, b.end, both, a.plural), *named[i + 2 :])


def _leaves_little(clause: _Clause, question: str, most: int) -> bool:
    """Whether at most so many words of a clause are missing in the restated question, and none that changes it."""
    kept = set(normalise(question)) | set(question.split())
    inside = {i for n in clause.named for i in range(n.start, n.end)}
    left = [
        w for i, w in enumerate(clause.words)
        if i not in inside and w not in kept and w not in _CHATTER and w not in _CUES and singular(w) not in kept
    ]  # fmt: skip
    unused = [n for n in clause.named if n.bare.split()[-1] not in question]
    blocked = any(w in _BLOCKS and w not in question.split() for w in clause.words)
    return len(left) <= most and not blocked and not unused


# -- one rule a kind of question ---------------------------------------------------------------------------------------


def _counts(c: _Clause) -> Iterator[str]:
    asked = "how many" in c.said or c.has("number", "count", "amount", "quantity")
    if asked and c.named and (c.named[0].plural or len(c.named) == 1):
        first = c.named[0].bare if c.named[0].plural else plural(c.named[0].bare)
        if len(c.named) == 1:
            yield f"how many {first} are there"
        elif (relation := _relation(c.between(c.named[0], c.named[1]))) is not None:
            yield f"how many {first} are {relation} {c.named[1].definite}"


def _colored(c: _Clause) -> Iterator[str]:
    """Lists of things of a colour, and which of some colours a thing has."""
    hues = [w for w in c.words if noun_phrase.is_color_word(w)]
    if len(hues) > 1 and len(c.named) == 1 and "or" in c.words and not c.asks_yes_no:
        yield f"what colour {_be(c.named[0])} {c.named[0].definite}"
    if (
        len(hues) == 1
        and not c.named
        and c.has("list", "name", "anything", "items", "things", "everything", "objects", "what", "stuff")
    ):
        yield f"is there anything {hues[0]}" if c.asks_yes_no else f"list all {hues[0]} things"


def _sides(c: _Clause) -> Iterator[str]:
    """On which of two sides: "does the armchair stand in front of the desk or behind it?"."""
    for one, other in (("in front of", "behind"), ("behind", "in front"), ("left", "right"), ("right", "left")):
        if re.search(rf"\b{one}\b.*\bor\b.*\b{other}\b", c.said) and len(c.named) == 2:
            a, b = c.named[0].definite, c.named[1].definite
            across = "in front of or behind" if "front" in one + other else "to the left or to the right of"
            yield f"is {a} {across} {b}"


def _colors(c: _Clause) -> Iterator[str]:
    if c.has("colour", "color", "shade", "hue", "colours", "colors", "coloured", "colored", "painted") and c.named:
        if len(c.named) == 1:
            yield f"what colour {_be(c.named[0])} {c.named[0].definite}"
        elif (relation := _relation(c.between(c.named[0], c.named[1]))) is not None:
            yield f"what colour is {c.named[0].definite} {relation} {c.named[1].definite}"


_LENGTHS = ("metres", "meters", "feet", "centimetres", "inches", "cm", "m", "ft", "slot", "opening", "space", "room")


def _distances(c: _Clause) -> Iterator[str]:
    if (
        len(c.named) == 1
        and c.named[0].plural
        and c.has("two", "both", "pair")
        and c.has("far", "apart", "distance", "separates")
    ):
        yield f"how far apart are {c.named[0].definite}"
    if len(c.named) != 2 or c.asks_yes_no:
        return
    a, b = c.named[0].definite, c.named[1].definite
    if c.has("gap", "clearance") or ("between" in c.words and "distance" not in c.words and c.has(*_LENGTHS)):
        yield f"how much space is there between {a} and {b}"
    elif c.has("far", "distance", "apart", "away", "separates", "separate", "separation", *_LENGTHS[:8]):
        yield f"how far is {a} from {b}"


def _sizes(c: _Clause) -> Iterator[str]:
    if "floor to ceiling" in c.said and not any(n.bare not in ("floor", "ceiling") for n in c.named):
        yield "how high is the room"
    if re.search(r"\b(?:front to back|back to front)\b", c.said) and not c.named:
        yield "how deep is the room"
    if re.search(r"\b(?:side to side|left wall (?:\w+ )?to the right|one side to the other)\b", c.said):
        yield "how wide is the room"
    cues = [w for w in c.words if w in _SIZES]
    if c.asks_yes_no or not cues or c.has("fit", "fits", "far", "distance", "apart"):
        return
    if len(c.named) == 1:
        thing = c.named[0]
        if thing.bare in _MEASURED_ROOM:
            return
        yield _SIZES[cues[0]].format(be=_be(thing), a=thing.definite)
    elif not c.named and c.has("ceiling", "ceilings"):
        yield "how high is the ceiling"
    elif not c.named and c.has(*_MEASURED_ROOM):
        yield f"how {_ROOM_SIZES.get(cues[0], 'big')} is the room"


_FREE = ("free", "empty", "unused", "available", "uncovered", "bare", "spare", "unoccupied", "remaining", "leftover")


def _areas(c: _Clause) -> Iterator[str]:
    floor = c.has("floor", "floorspace", "area", "sqm", "m2", "sqft") or "square" in c.words
    if not floor or any(n.bare.split()[-1] not in ("floor", "furniture", "room") for n in c.named):
        return
    left = re.search(r"\b(?:what is|how much is|much) left\b", c.said)
    if left or c.has(*_FREE) or "clear of" in c.said:
        yield "how much free floor is there"
    elif c.has("area", "square", "sqm", "m2", "sqft", "floorspace") and not c.asks_yes_no:
        yield "what is the floor area"


def _comparisons(c: _Clause) -> Iterator[str]:
    cues = [w for w in c.words if _COMPARED.match(w)]
    if len(cues) != 1 or len(c.named) != 2 or re.search(r"\b(?:higher up|lower down|further up)\b", c.said):
        return
    a, b = c.named[0].definite, c.named[1].definite
    if "or" in c.between(c.named[0], c.named[1]).split() or c.has("which", "what") or not c.asks_yes_no:
        yield f"which is {cues[0]} , {a} or {b}"
    elif c.asks_yes_no and "than" in c.words:
        yield f"is {a} {cues[0]} than {b}"


def _superlatives(c: _Clause) -> Iterator[str]:
    cues = [_PLAIN_MOST.get(w, w) for w in c.words if _MOST.match(w)]
    if len(cues) != 1 or c.asks_yes_no:
        return
    if not c.named:
        yield f"what is the {cues[0]} thing"
    elif len(c.named) == 1 and cues[0] not in c.named[0].said.split():
        yield f"which {singular(c.named[0].bare)} is the {cues[0]}"
    elif len(c.named) == 1:
        yield f"what is {c.named[0].definite}"


def _nearest(c: _Clause) -> Iterator[str]:
    cue = next((w for w in c.words if w in ("nearest", "closest", "farthest", "furthest")), "")
    if not cue or c.asks_yes_no:
        return
    to = "from" if cue in ("farthest", "furthest") else "to"
    if len(c.named) == 1:
        yield f"what is {cue} {to} {c.named[0].definite}"
    elif len(c.named) == 2 and c.has("which", "what"):
        yield f"which {singular(c.named[0].bare)} is {cue} {to} {c.named[1].definite}"


_MOVES = ("go", "goes", "fit", "fits", "put", "place", "squeeze", "would", "could", "can", "will", "should", "move")


def _related(c: _Clause) -> Iterator[str]:
    """What is on it, and whether this is on that."""
    if len(c.named) == 2:
        a, b = c.named
        relation = _relation(c.between(a, b))
        cleft = re.match(rf"(?:is|was) it (.+) {re.escape(a.said)} (?:that|where) {re.escape(b.said)}\b", c.said)
        if cleft and (moved := _relation(cleft[1])) is not None:
            yield f"is {b.definite} {moved} {a.definite}"
        elif relation is not None and c.asks_yes_no and not c.has(*_MOVES):
            yield f"is {a.definite} {relation} {b.definite}"
        return
    if len(c.named) != 1:
        return
    thing = c.named[0]
    before, behind = " ".join(c.words[: thing.start]), " ".join(c.words[thing.end :])
    relation = _relation(before)
    asks = c.has(
        "what", "which", "list", "name", "things", "stuff", "items", "objects", "everything", "lot", "enumerate"
    )
    if c.has("wall", "corner", "go", "goes", "fit", "put", "side", "hand", "end"):
        return
    if relation is not None and asks and not c.asks_yes_no:
        yield f"what is {relation} {thing.definite}"
    elif relation is not None and c.asks_yes_no and c.has("anything", "something", "stuff", "things"):
        yield f"is there anything {relation} {thing.definite}"
    elif asks and re.fullmatch(
        r"(?:have|has|got|hold|holds|carry|carries|holding|carrying)(?: got)?(?: on(?: it| top)?)?", behind
    ):
        yield f"what is on {thing.definite}"


def _places(c: _Clause) -> Iterator[str]:
    asked = c.has("where", "whereabouts", "location", "locate", "find", "hiding", "hidden") or "which wall" in c.said
    if len(c.named) == 1 and asked:
        yield f"where {_be(c.named[0])} {c.named[0].definite}"


_OFFERS = ("come", "comes", "boast", "sport", "offer", "feature")


def _existence(c: _Clause) -> Iterator[str]:
    cue = c.has(
        "there", "any", "got", "see", "spot", "exist", "include", "contain", "has", "have", "anywhere", "find", *_OFFERS
    )
    also = len(c.named) == 2 and re.search(r"as well as|or only|or just|and also|besides", c.between(*c.named))
    here = c.asks_yes_no and re.search(r"\bin (?:this|the|that) room\b|\bin here\b|\banywhere\b", c.said)
    if c.named and c.named[0].said.startswith("the ") and c.words[0] in ("has", "have", "had", "did", "does", "do"):
        return
    if (also and c.asks_yes_no) or (here and len(c.named) == 1):
        yield f"is there a {c.named[0].bare}"
    if len(c.named) == 1 and cue and (c.asks_yes_no or "any" in c.words or c.words[0] in ("got", "no")):
        thing = c.named[0]
        yield f"are there any {thing.bare}" if thing.plural else f"is there a {thing.bare}"


_UNIT = r"(?:cm|mm|m|in|inches|ft|feet|metres?|meters?)"
_FIT = re.compile(r"\b(?:fit|fits|squeeze|squeezed|slots?|slide|go|goes|stand|standing|sit|tuck|tucked|ok|put|park)\b")
_BETWEEN = re.compile(
    r"\bbetween (?:\w+ ){1,6}and (?:the |a |my )?(?:\w+ ?){1,3}?(?= along| without| thank| please| at the|$)"
)
_PLACE = re.compile(
    r"\b(?:next to|beside|under|underneath|beneath|against|along|in front of|behind) (?:\w+ ?){1,5}?"
    r"(?= without| thank| please|$)"
)
_SIZED = re.compile(
    rf"\b\d+(?:\.\d+)? ?{_UNIT}?(?: (?:wide|long|deep|across))?"
    rf"(?: (?:by|x|and) \d+(?:\.\d+)? ?{_UNIT}?(?: (?:wide|long|deep|tall|high))?)?"
)


def _fitting(words: Words) -> Iterator[str]:
    """Whether something of a stated size fits somewhere, with the size in one clause and the place in another."""
    said = " ".join(w for w in words if w != ",")
    sized = _SIZED.search(said)
    if sized is None or _FIT.search(said) is None or {"no", "not"} & set(words):
        return
    place = _BETWEEN.search(said, sized.end()) or _PLACE.search(said, sized.end())
    if place is not None:
        yield f"would a {sized[0].replace(' and ', ' by ').strip()} thing fit {place[0]}"


_GAZE = re.compile(
    r"(?:facing|watching|(?:looking|gazing|looks?|looked|staring) (?:at|to|toward|towards|out of|into)|"
    r"turned (?:to|towards?))$"
)
_AT = re.compile(r"(?:\bon|\bin|\bat|\bthrough|\bby|\bonto|\binto)$")
_POSE = re.compile(
    r"\b(?:sat|sit|sits|sitting|seated|stood|stand|standing|lying|lie|lay|slumped|perched|tucked|works?|working|eating|"
    r"sleeping|comes?|were|seat)\b"
)
_EITHER = re.compile(r"\bleft\b.*\bor\b.*\bright\b|\bright\b.*\bor\b.*\bleft\b|\b(?:which|what) (?:side|hand)\b")
_OWN_SIDE = re.compile(
    r"\b(?:my|your|their|her|his|the|its) (left|right)\b|\b(left|right) hand\b|"
    r"\b(behind|in front of) (?:me|you|them|her|him)\b"
)


def _seated(words: Words, named: tuple[Named, ...]) -> Iterator[str]:
    """On which side somebody who sits or stands somewhere has a thing."""
    said = " ".join(words)
    before = {n: " ".join(words[: n.start]) for n in named}
    gaze = next((n for n in named if _GAZE.search(before[n])), None)
    place = next((n for n in named if n is not gaze and _AT.search(before[n])), None)
    rest = [n for n in named if n is not gaze and n is not place]
    open_ended = re.search(r"\b(?:what|which)\b(?! (?:side|hand)\b)", said)
    if place is None or len(rest) != 1 or _POSE.search(said) is None or open_ended:
        return
    where = f"if i sat on {place.definite}" + (f" facing {gaze.definite}" if gaze else "")
    if _EITHER.search(said):
        yield f"{where} , is {rest[0].definite} on my left or my right"
        return
    sides = {next(filter(None, found)) for found in _OWN_SIDE.findall(said)}
    if len(sides) == 1:
        side = next(iter(sides))
        yield f"{where} , is {rest[0].definite} {f'on my {side}' if side in ('left', 'right') else f'{side} me'}"


_CATCH = re.compile(r"\bcatch (?:\w+ )?(?:toe|toes|foot|feet|slipper|heel|shoe)\b|\bcatch someone 's foot\b")


def _ways(c: _Clause) -> Iterator[str]:
    if c.has("trip", "tripping", "stumble", "stub", "hazard", "hazards") or _CATCH.search(c.said):
        yield "what could i trip over"
    reached = re.match(r"(?:can|could) (.+) be reached from (.+?)(?: on foot)?$", c.said)
    if reached and len(c.named) == 2:
        yield f"can one walk from {c.named[1].definite} to {c.named[0].definite}"
    walks = c.has("walk", "route", "path", "way", "get", "go", "reach", "wheel", "wheelchair", "carry", "through")
    found = re.search(r"\bfrom\b.*\bto\b", c.said)
    if len(c.named) == 2 and walks and found and not c.has("far", "distance"):
        a, b = c.named[0].definite, c.named[1].definite
        yield f"can one walk from {a} to {b}" if c.asks_yes_no else f"how do i get from {a} to {b}"
    if c.has("blocked", "blocking", "obstructed", "obstructing", "blocks", "obstruct") and len(c.named) == 1:
        yield f"is {c.named[0].definite} blocked" if c.asks_yes_no else f"what is blocking {c.named[0].definite}"


_RULES: tuple[Callable[[_Clause], Iterator[str]], ...] = (
    _counts, _colored, _colors, _sides, _comparisons, _nearest, _superlatives, _distances, _sizes, _areas, _ways,
    _related, _places, _existence,
)  # fmt: skip
_CUES = bag(
    "colour color shade hue colours colors painted number count amount quantity far distance apart away gap space "
    "clearance between nearest closest farthest furthest where whereabouts location trip tripping stumble walk "
    "route path way reach blocked blocking area floor square metres meters free empty tall height high wide width "
    "deep depth long length dimensions measurements size big large across footprint top hold holds got list name "
    "items objects everything anything something feet inches cm centimetres m ft foot metre meter up under above "
    "next near"
) | frozenset(w for phrase in _RELATIONS for w in phrase.split())


def _relation(said: str) -> str | None:
    """The relation that words between two things state, None if none, or several."""
    found = [phrase for phrase in _RELATIONS if re.search(rf"\b{phrase}\b", said)]
    names = {_RELATIONS[p] for p in found if not any(p != q and p in q for q in found)}
    return next(iter(names)) if len(names) == 1 else None


def _be(thing: Named) -> str:
    return "are" if thing.plural else "is"
