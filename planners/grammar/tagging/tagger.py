"""From words to clauses of tagged tokens: which word class each phrase has where it stands.

Knows context: a verb begins a clause, "red" before a noun is an attribute and elsewhere what something becomes, "left"
is a direction or a side. Refuses to know the words that are read one by one (context_rules.py), how tokens combine
(grammar.lark) and what they do (commands.py).

The rules of preference, in order:
1. The longest phrase wins; of equal ones quantities, then compounds, colours, the closed vocabulary, plain nouns.
2. A word that can be a verb is one only where a clause begins; after "and" it also needs an object behind it
   ("delete the chair and plant" has one clause, "delete the chair and plant a tree" would have two).
3. A colour, size or side is an attribute if a noun follows; "the light blue" at the end is a light and its new colour.
4. "this", "that" and the like are pronouns unless a noun follows.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..vocabulary import lexicon, quantities
from ..vocabulary.verbs import Entry
from .context_rules import CARRYING, NOUNISH, facing_at, special
from .lookahead import NOUN_COLORS, color_at, compounds, is_plain, match, verb_classes
from .tags import Clause, Tag, Tagging
from .words import Word

# "the smaller of the two" picks as a superlative does.
_COMPARATIVES = {"bigger": "largest", "larger": "largest", "smaller": "smallest", "taller": "tallest",
                 "shorter": "shortest"}  # fmt: skip
_REPEATABLE = ("DELETE", "SELECT", "HIDE", "ISOLATE")
MAX_NOUN_WORDS = 4


# ---- clauses -------------------------------------------------------------------------------------------------


def clauses(words: Sequence[Word]) -> list[Clause]:
    """The clauses of a sentence."""
    now = Tagging(words)
    i = _open(now, 0)
    while i < len(now.texts):
        i = i + 1 if i in now.particles else _boundary(now, i) or _step(now, i)
    _close(now)
    return now.done


def _close(now: Tagging) -> None:
    while now.clause.tags and now.clause.tags[-1].type in ("COMMA", "AND"):
        now.clause.tags.pop()
    if now.clause.tags or now.clause.unsupported or now.clause.negated:
        now.done.append(now.clause)
    now.clause = Clause()


def _open(now: Tagging, i: int) -> int:
    """Begin a clause at `i`: drop politeness, read its verb; the position behind."""
    j, negated = now.read.skip_polite(i)
    if negated:
        now.clause.negated = True
        now.clause.tags.append(Tag("NEGATION", None, now.words[i : j + 1]))
    found = now.read.verb(j)
    unsupported = match(lexicon.UNSUPPORTED_PHRASES, now.texts, j)
    if unsupported and (not found or unsupported[1] > found[1]):
        now.clause.unsupported = unsupported[0]
        now.clause.tags.append(Tag("UNSUPPORTED", unsupported[0], now.words[j : j + unsupported[1]]))
        return j + unsupported[1]
    if not found or (j + found[1] < len(now.texts) and now.read.verb_is_noun(j, found[1])):
        return j
    (kind, value), taken, particle = found
    if particle is not None:
        now.particles.add(particle)
    now.clause.verb = kind
    now.clause.tags.append(Tag(kind, value, now.words[j : j + taken]))
    return j + taken


def _boundary(now: Tagging, i: int) -> int | None:
    """The position behind the verb of a new clause, if one begins at `i`."""
    texts = now.texts
    j = i
    if texts[j] in (",", "and", "&", "then", "but", "plus"):
        if texts[j] == "but" and now.read.phrase(j) != (("BUT", None), 1):
            return None
        while j < len(texts) and texts[j] in (",", "and", "&", "then", "but", "also", "plus"):
            j += 1
    if j == i:
        return None
    forced = "then" in texts[i:j]
    if j >= len(texts):
        return j if forced else None
    if not forced and not now.read.verb_begins(j):
        return None
    _close(now)
    behind = _open(now, j)
    before = now.done[-1] if now.done else None
    if forced and not now.clause.tags and before and before.verb in _REPEATABLE:
        # "delete the chair, then the table": the verb is said once.
        now.clause = Clause([before.tags[0]], before.verb)
    return behind


# ---- tokens --------------------------------------------------------------------------------------------------


def _step(now: Tagging, i: int) -> int:
    """Tag what stands at `i`; the position behind it."""
    texts = now.texts
    if texts[i] == ",":
        return _comma(now, i)
    if texts[i] == ":" and now.before in verb_classes():
        return i + 1
    phrase = now.read.phrase(i)
    length = phrase[1] if phrase else 0
    for reader in (special, _quantity, _compound, _color, _attribute):
        if (found := reader(now, i, length)) is not None:
            return found
    filler = match(lexicon.FILLER, texts, i)
    if filler and filler[1] > length:
        return i + filler[1]
    if texts[i] in lexicon.PARTICIPLES and now.read.preposition_at(i + 1):
        return i + 1
    if phrase:
        return _phrase(now, i, *phrase)
    return _noun(now, i)


def _comma(now: Tagging, i: int) -> int:
    after = now.texts[i + 1 : i + 2]
    if not after or after[0] in ("and", "&", ",") or not now.clause.tags or now.before in ("AND", "COMMA"):
        return i + 1
    rest = now.read.phrase(i + 1)
    if rest and rest[0][0] in ("BUT", "NOT", "REL", "WITH", "BY", "CLOCK", "DIR", "PREP", "BETWEEN"):
        return i + 1
    return now.put("COMMA", None, i, 1)


def _quantity(now: Tagging, i: int, length: int) -> int | None:
    found = quantities.read(now.texts[i:])
    if not found or found.taken < length:
        return None
    behind = i + found.taken
    headed = now.before in ("COLOR", "SIZE", "SUP", "ORDINAL", "ADJ", "OTHER")
    if now.texts[i] == "one" and found.kind == "NUMBER" and (headed or not now.read.nouny(behind)):
        return None
    if found.kind == "LENGTH":
        if now.texts[behind : behind + 1] in (("tall",), ("high",)):
            before_noun = now.read.nouny(behind + 1)
            if before_noun or now.clause.verb in ("ADD", "PUT", "WANT"):
                if now.before == "COMMA":
                    now.clause.tags.pop()
                kind = "TALL" if before_noun else "TALLER"
                return now.put(kind, (found.value, found.unit), i, found.taken + 1)
        return now.put("LENGTH", (found.value, found.unit), i, found.taken)
    return now.put(found.kind, found.value, i, found.taken)


def _compound(now: Tagging, i: int, length: int) -> int | None:
    found = match(compounds(), now.texts, i)
    return _noun(now, i, found[1]) if found and found[1] >= length else None


def _color(now: Tagging, i: int, length: int) -> int | None:
    found = color_at(now.texts, i)
    if not found or found[1] < length:
        return None
    name, taken = found
    joined, length_of_all = now.read.colors(i)
    if joined and now.before in ("DET", "NUMBER", "SIZE", "COMMA", "AND", *verb_classes()):
        return now.put("COLORS", joined, i, length_of_all)
    if now.read.nouny(i + taken) or (now.before == "DET" and _shares_noun(now, i + taken)):
        return now.put("COLOR", name, i, taken)
    follows_det = now.before in ("DET", "SIZE", "SUP", "ORDINAL", "COLOR") or (
        now.before in ("", *verb_classes()) and now.clause.verb != ""
    )
    if follows_det and taken == 2 and (now.texts[i] == "light" or now.texts[i] in NOUN_COLORS):
        return now.put("NOUN", now.texts[i], i, 1)
    if follows_det and taken == 1 and name in NOUN_COLORS and not _indefinite_hue(now, i):
        return now.put("NOUN", name, i, 1)
    if now.before == "EVERYTHING" and now.clause.verb in ("DELETE", "SELECT", "HIDE", "ISOLATE", "MOVE", "KEEP"):
        now.put("REL", None, i, 0)  # "everything red" is everything that is red
    return now.put("HUE", name, i, taken)


def _shares_noun(now: Tagging, i: int) -> bool:
    """ "the red and the blue chair": whether the noun comes with a second colour."""
    second = now.texts[i : i + 2] in (("and", "the"), ("and", "my")) and color_at(now.texts, i + 2)
    return bool(second) and now.read.nouny(i + 2)


def _indefinite_hue(now: Tagging, i: int) -> bool:
    """ "give it an orange colour": the article belongs to the colour word behind."""
    found = now.read.phrase(i + 1)
    return bool(found) and found[0][0] == "COLORWORD"  # type: ignore[index]


def _attribute(now: Tagging, i: int, length: int) -> int | None:
    found = match(lexicon.ATTRIBUTE_PHRASES, now.texts, i)
    if not found or found[1] < length:
        return None
    (kind, value), taken = found
    behind = now.texts[i + taken : i + taken + 1]
    after_det = now.before in ("DET", "POSS", "NUMBER", "ORDINAL")
    if now.read.nouny(i + taken) and (after_det or now.before not in NOUNISH):
        return now.put(kind, value, i, taken)
    if after_det and now.texts[i] in ("back", "top", "front", "bottom", "left", "right") and behind == ("of",):
        return now.put("NOUN", now.texts[i], i, 1)
    if kind == "SIZE" and now.before == "DET" and behind == ("of",) and now.texts[i] in _COMPARATIVES:
        return now.put("SUP", _COMPARATIVES[now.texts[i]], i, taken)
    if kind == "SUP" and after_det and (now.before == "DET" or now.before == "ORDINAL"):
        return now.put(kind, value, i, taken)
    if kind == "SIZE" and not length:
        return now.put("SIZEWORD", value, i, taken)
    return None


def _phrase(now: Tagging, i: int, entry: Entry, taken: int) -> int:
    """A phrase of the closed vocabulary, adjusted to its surroundings."""
    kind, value = entry
    text, behind = now.texts[i], i + taken
    if kind == "DET" and taken == 1:
        return _determiner(now, i, value)
    if kind == "ONE" and not value and now.read.nouny(behind) and now.before not in ("COLOR", "SIZE", "SUP", "DET"):
        return now.put("NUMBER", 1.0, i, 1)
    if kind == "NOT" and now.before in ("EVERYTHING", "NOUN", "THING") and now.read.hue_follows(behind):
        now.put("REL", None, i, 0)
        return now.put("NOT", None, i, taken)
    sided = kind in ("DIR", "SIDE", "SPOT", "NOWHERE") and now.texts[i + 1 : i + 2] == ("the",)
    if sided and now.read.nouny(behind):
        # "to the left wall": the side belongs to the noun.
        return _phrase(now, i, lexicon.INSIDE_PHRASES[text,], 1)
    if kind == "NOT" and now.before != "REL":
        return now.put("NOT" if now.read.preposition_at(behind) else "BUT", None, i, taken)
    if kind == "REL" and now.read.preposition_at(behind):
        return behind
    if kind == "AND":
        if now.read.preposition_at(behind):
            return now.put("ANDREL", None, i, taken)
        if text == "and" and now.before in ("AND", "COMMA"):
            return behind
    if kind == "PREP" and taken == 1 and text in ("in", "on", "at") and behind >= len(now.texts):
        return now.put("UNKNOWN", None, i, taken)
    if kind == "COLORWORD" and text == "tint" and now.before in NOUNISH:
        return now.put("UNKNOWN", None, i, taken)
    return now.put(kind, value, i, taken)


def _determiner(now: Tagging, i: int, value: str) -> int:
    """ "this" or "all": a determiner before a noun, a pronoun otherwise."""
    text = now.texts[i]
    noun_follows = now.read.nouny(i + 1) or now.read.opens_noun(i + 1)
    if text in ("this", "that", "these", "those") and not noun_follows:
        return now.put("PRON", "it", i, 1)
    if text == "all" and not noun_follows:
        return now.put("EVERYTHING", None, i, 1)
    if text == "both" and not noun_follows:
        return now.put("PRON", "it", i, 1)
    return now.put("DET", value, i, 1)


def _noun(now: Tagging, i: int, at_least: int = 0) -> int:
    """A run of plain words: a noun, or adjectives if a colour or size follows before the noun."""
    if not at_least and now.texts[i] == "non" and (found := color_at(now.texts, i + 1)):
        return now.put("NONCOLOR", found[0], i, 1 + found[1])
    if not at_least and not is_plain(now.texts[i]):
        return now.put("UNKNOWN", None, i, 1)
    j = i + max(at_least, 1)
    while j < len(now.texts) and _continues_noun(now, j):
        j += 1
    kind = "NOUN" if j - i <= MAX_NOUN_WORDS else "UNKNOWN"
    if kind == "NOUN" and now.before in ("DET", "COLOR", "SIZE", "ADJ") and now.read.colored_noun(j):
        kind = "ADJ"
    return now.put(kind, " ".join(now.texts[i:j]), i, j - i)


def _continues_noun(now: Tagging, j: int) -> bool:
    texts = now.texts
    if not is_plain(texts[j]) or texts[j] == ",":
        return False
    tables = (lexicon.INSIDE_PHRASES, lexicon.FILLER)
    if (
        facing_at(now, j)
        or match(CARRYING, texts, j)
        or any(match(t, texts, j) for t in tables)
        or texts[j] in lexicon.PARTICIPLES
    ):
        return False
    return not color_at(texts, j) and not quantities.read(texts[j:])
