"""Splits a sentence into clauses and tags its phrases with word classes, the terminals of grammar.lark.

The class depends on context: a verb begins a clause, "red" is an attribute before a noun and elsewhere the colour
something becomes, "left" is a direction or a side. context_rules.py holds the rules for single words; the rules here,
in order of preference:
1. The longest phrase wins; of equal ones quantities, then compounds, colours, the closed vocabulary, plain nouns.
2. A word that can be a verb is one only where a clause begins; after "and" it also needs an object behind it
   ("delete the chair and plant" has one clause, "delete the chair and plant a tree" would have two).
3. A colour, size or side is an attribute if a noun follows; "the light blue" at the end is a light and its new colour.
4. "this", "that" and the like are pronouns unless a noun follows.
"""

from __future__ import annotations

from collections.abc import Sequence

from ....gaussians.world.shades import shade_at
from ..vocabulary import lexicon, nouns, quantities
from ..vocabulary.verbs import Entry
from .context_rules import CARRYING, NOUNISH, facing_at, tag_by_context
from .lookahead import NOUN_COLORS, color_at, compounds, match, may_be_noun, verb_classes
from .tags import Clause, Tag, TaggerState
from .words import Word

# Before "of" a comparative acts as a superlative: "the smaller of the two".
_COMPARATIVES = {"bigger": "largest", "larger": "largest", "smaller": "smallest", "taller": "tallest",
                 "shorter": "shortest"}  # fmt: skip
_REPEATABLE = ("DELETE", "SELECT", "HIDE", "ISOLATE")
MAX_NOUN_WORDS = 4
_CHOOSING = ("DELETE", "SELECT", "HIDE", "ISOLATE", "MOVE", "KEEP", "ADJUST", "SCALE", "GROW", "ROTATE")
_BEFORE_NAMES = ("DET", "SIZE", "NUMBER", "COLOR", "SUP", "ORDINAL", "ADJ")
_CHANGING = ("MAKE", "PAINT", "TURN", "CHANGE", "WANT")


# ---- clauses -------------------------------------------------------------------------------------------------


def clauses(words: Sequence[Word]) -> list[Clause]:
    """The clauses of a sentence."""
    state = TaggerState(words)
    i = _begin_clause(state, 0)
    while i < len(state.texts):
        i = i + 1 if i in state.particles else _begin_next_clause(state, i) or _tag_next(state, i)
    _end_clause(state)
    return state.done


def _end_clause(state: TaggerState) -> None:
    """Finish the present clause without joints at its end."""
    while state.clause.tags and state.clause.tags[-1].type in ("COMMA", "AND"):
        state.clause.tags.pop()
    if state.clause.tags or state.clause.unsupported or state.clause.negated:
        state.done.append(state.clause)
    state.clause = Clause()


def _begin_clause(state: TaggerState, i: int) -> int:
    """Begin a clause at `i`: skip polite phrases and tag its verb; returns the position behind."""
    j, negated = state.ahead.skip_polite(i)
    if negated:
        state.clause.negated = True
        state.clause.tags.append(Tag("NEGATION", None, state.words[i : j + 1]))
    found = state.ahead.verb(j)
    unsupported = match(lexicon.UNSUPPORTED_PHRASES, state.texts, j)
    if unsupported and (not found or unsupported[1] > found[1]):
        state.clause.unsupported = unsupported[0]
        state.clause.tags.append(Tag("UNSUPPORTED", unsupported[0], state.words[j : j + unsupported[1]]))
        return j + unsupported[1]
    if not found or (j + found[1] < len(state.texts) and state.ahead.verb_is_noun(j, found[1])):
        return j
    (kind, value), taken, particle = found
    if particle is not None:
        state.particles.add(particle)
    state.clause.verb = kind
    state.clause.tags.append(Tag(kind, value, state.words[j : j + taken]))
    return j + taken


def _begin_next_clause(state: TaggerState, i: int) -> int | None:
    """Begin a new clause if one starts at `i`; returns the position behind its verb, None if none starts."""
    texts = state.texts
    j = i
    if texts[j] in (",", "and", "&", "then", "but", "plus"):
        if texts[j] == "but" and state.ahead.phrase(j) != (("BUT", None), 1):
            return None
        while j < len(texts) and texts[j] in (",", "and", "&", "then", "but", "also", "plus"):
            j += 1
    if j == i:
        return None
    forced = "then" in texts[i:j]
    if j >= len(texts):
        return j if forced else None
    if not forced and not state.ahead.verb_begins(j):
        return None
    _end_clause(state)
    behind = _begin_clause(state, j)
    before = state.done[-1] if state.done else None
    if forced and not state.clause.tags and before and before.verb in _REPEATABLE:
        # "delete the chair, then the table": the verb of the first clause is repeated.
        state.clause = Clause([before.tags[0]], before.verb)
    return behind


# ---- tokens --------------------------------------------------------------------------------------------------


def _tag_next(state: TaggerState, i: int) -> int:
    """Tag the phrase at `i`; returns the position behind it."""
    texts = state.texts
    if texts[i] == ",":
        return _tag_comma(state, i)
    if texts[i] == ":" and state.last_type in verb_classes():
        return i + 1
    phrase = state.ahead.phrase(i)
    length = phrase[1] if phrase else 0
    for reader in (tag_by_context, _tag_quantity, _tag_compound, _tag_color, _tag_attribute):
        if (found := reader(state, i, length)) is not None:
            return found
    filler = match(lexicon.FILLER, texts, i)
    if filler and filler[1] > length:
        return i + filler[1]
    if texts[i] in lexicon.PARTICIPLES and state.ahead.preposition_at(i + 1):
        return i + 1
    if phrase:
        return _tag_phrase(state, i, *phrase)
    return _tag_noun(state, i)


def _tag_comma(state: TaggerState, i: int) -> int:
    after = state.texts[i + 1 : i + 2]
    if not after or after[0] in ("and", "&", ",") or not state.clause.tags or state.last_type in ("AND", "COMMA"):
        return i + 1
    rest = state.ahead.phrase(i + 1)
    if rest and rest[0][0] in ("BUT", "NOT", "REL", "WITH", "BY", "CLOCK", "DIR", "PREP", "BETWEEN"):
        return i + 1
    return state.emit("COMMA", None, i, 1)


def _tag_quantity(state: TaggerState, i: int, length: int) -> int | None:
    found = quantities.read(state.texts[i:])
    if not found or found.taken < length:
        return None
    behind = i + found.taken
    headed = state.last_type in ("COLOR", "SIZE", "SUP", "ORDINAL", "ADJ", "OTHER")
    if (
        found.taken == 1
        and state.texts[i] == "one"
        and found.kind == "NUMBER"
        and (headed or not state.ahead.noun_at(behind))
    ):
        return None
    if found.kind == "LENGTH":
        if state.texts[behind : behind + 1] in (("tall",), ("high",)):
            before_noun = state.ahead.noun_at(behind + 1)
            if before_noun or state.clause.verb in ("ADD", "PUT", "WANT"):
                if state.last_type == "COMMA":
                    state.clause.tags.pop()
                kind = "TALL" if before_noun else "TALLER"
                return state.emit(kind, (found.value, found.unit), i, found.taken + 1)
        return state.emit("LENGTH", (found.value, found.unit), i, found.taken)
    return state.emit(found.kind, found.value, i, found.taken)


def _tag_compound(state: TaggerState, i: int, length: int) -> int | None:
    found = match(compounds(), state.texts, i)
    return _tag_noun(state, i, found[1]) if found and found[1] >= length else None


def _tag_color(state: TaggerState, i: int, length: int) -> int | None:
    found = color_at(state.texts, i)
    if not found or found[1] < length:
        return None
    name, taken = found
    joined, length_of_all = state.ahead.colors(i)
    if joined and state.last_type in ("DET", "NUMBER", "SIZE", "COMMA", "AND", *verb_classes()):
        return state.emit("COLORS", joined, i, length_of_all)
    if state.ahead.noun_at(i + taken) or (state.last_type == "DET" and _shares_noun(state, i + taken)):
        return state.emit("COLOR", name, i, taken)
    follows_det = state.last_type in ("DET", "SIZE", "SUP", "ORDINAL", "COLOR") or (
        state.last_type in ("", *verb_classes()) and state.clause.verb != ""
    )
    shade = shade_at(state.texts, i) if state.last_type == "DET" and state.clause.verb in _CHANGING else None
    if shade and shade[1] == taken and state.clause.tags[-1].text not in ("a", "an"):
        return _thing_then_hue(state, i, taken)
    if follows_det and taken == 2 and (state.texts[i] == "light" or state.texts[i] in NOUN_COLORS):
        return state.emit("NOUN", state.texts[i], i, 1)
    if follows_det and taken == 1 and name in NOUN_COLORS and not _indefinite_hue(state, i):
        return state.emit("NOUN", name, i, 1)
    changed = state.clause.verb in _CHANGING and state.ahead.hue_follows(_behind_joint(state.texts, i + taken))
    changed = changed or (state.clause.verb in _CHANGING and _changes_at(state, i + taken))
    if state.last_type == "EVERYTHING" and (changed or state.clause.verb in _CHOOSING):
        state.emit("REL", None, i, 0)  # "everything red" is everything that is red
    return state.emit("HUE", name, i, taken)


def _changes_at(state: TaggerState, i: int) -> bool:
    """Whether a change other than to a colour is at `i`: "make everything brown a shade lighter"."""
    phrase = state.ahead.phrase(i) if i < len(state.texts) else None
    amount = quantities.read(state.texts[i:])
    said = phrase is not None and phrase[0][0] in ("DEGREE", "LIGHT", "GROWN", "CLEARLY", "MORE", "LESS", "OPAQUE")
    return said or (amount is not None and amount.kind != "NUMBER")


def _thing_then_hue(state: TaggerState, i: int, taken: int) -> int:
    """Tag the words of a shade as a thing and its new colour: "paint the brick red"."""
    last = i + taken - 1
    state.emit("NOUN", " ".join(state.texts[i:last]), i, taken - 1)
    return state.emit("HUE", state.texts[last], last, 1)


def _behind_joint(texts: Sequence[str], i: int) -> int:
    """The position behind "to", "into" or "in"."""
    return i + (i < len(texts) and texts[i] in ("to", "into", "in"))


def _shares_noun(state: TaggerState, i: int) -> bool:
    """Whether the noun of a colour comes behind a second colour ("the red and the blue chair")."""
    second = state.texts[i : i + 2] in (("and", "the"), ("and", "my")) and color_at(state.texts, i + 2)
    return bool(second) and state.ahead.noun_at(i + 2)


def _indefinite_hue(state: TaggerState, i: int) -> bool:
    """Whether a colour word follows, so that the article belongs to it ("give it an orange colour")."""
    found = state.ahead.phrase(i + 1)
    return bool(found) and found[0][0] == "COLORWORD"  # type: ignore[index]


def _tag_attribute(state: TaggerState, i: int, length: int) -> int | None:
    found = match(lexicon.ATTRIBUTE_PHRASES, state.texts, i)
    if not found or found[1] < length:
        return None
    (kind, value), taken = found
    behind = state.texts[i + taken : i + taken + 1]
    after_det = state.last_type in ("DET", "POSS", "NUMBER", "ORDINAL")
    if state.ahead.noun_at(i + taken) and (after_det or state.last_type not in NOUNISH):
        return state.emit(kind, value, i, taken)
    if after_det and state.texts[i] in ("back", "top", "front", "bottom", "left", "right") and behind == ("of",):
        return state.emit("NOUN", state.texts[i], i, 1)
    if kind == "SIZE" and state.last_type == "DET" and behind == ("of",) and state.texts[i] in _COMPARATIVES:
        return state.emit("SUP", _COMPARATIVES[state.texts[i]], i, taken)
    if kind == "SUP" and after_det and (state.last_type == "DET" or state.last_type == "ORDINAL"):
        return state.emit(kind, value, i, taken)
    if kind == "SIZE" and not length:
        return state.emit("SIZEWORD", value, i, taken)
    return None


def _tag_phrase(state: TaggerState, i: int, entry: Entry, taken: int) -> int:
    """Tag a phrase of the closed vocabulary, adjusting its class to the words around it."""
    kind, value = entry
    text, behind = state.texts[i], i + taken
    if kind == "EVERYTHING" and text == "whatever" and taken == 2 and state.ahead.preposition_at(behind):
        return state.emit("EVERYTHING", value, i, taken)
    if kind == "DEGREE" and state.texts[i:behind] == ("a", "little") and state.ahead.noun_at(behind):
        state.emit("DET", "indef", i, 1)  # "a little side table"
        return state.emit("SIZE", "small", i + 1, 1)
    if kind == "DET" and taken == 1:
        return _tag_determiner(state, i, value)
    if (
        kind == "ONE"
        and not value
        and state.ahead.noun_at(behind)
        and state.last_type not in ("COLOR", "SIZE", "SUP", "DET")
    ):
        return state.emit("NUMBER", 1.0, i, 1)
    if kind == "BUT" and text == "bar" and not _excludes(state, i):
        return _tag_noun(state, i)
    if kind == "DET" and text == "one" and state.last_type in ("SUP", "ORDINAL", "COLOR", "SIZE"):
        return state.emit("ONE", False, i, 1)  # "the middle one of the three chairs"
    if kind == "NOT" and state.last_type in ("EVERYTHING", "NOUN", "THING") and state.ahead.hue_follows(behind):
        state.emit("REL", None, i, 0)
        return state.emit("NOT", None, i, taken)
    sided = kind in ("DIR", "SIDE", "SPOT", "NOWHERE") and state.texts[i + 1 : i + 2] == ("the",)
    if sided and state.ahead.noun_at(behind):
        # "to the left wall": the side belongs to the noun.
        return _tag_phrase(state, i, lexicon.CLOSED_PHRASES[text,], 1)
    if kind == "NOT" and state.last_type != "REL":
        return state.emit("NOT" if state.ahead.preposition_at(behind) else "BUT", None, i, taken)
    if kind == "REL" and state.ahead.preposition_at(behind):
        return behind
    if kind == "AND":
        if state.ahead.preposition_at(behind):
            return state.emit("ANDREL", None, i, taken)
        if text == "and" and state.last_type in ("AND", "COMMA"):
            return behind
    if kind == "PREP" and taken == 1 and text in ("in", "on", "at") and behind >= len(state.texts):
        return state.emit("UNKNOWN", None, i, taken)
    if kind == "DIR" and text in ("forward", "forwards") and _comes(state):
        return state.emit("DIR", "backward", i, taken)
    if kind in ("COLORWORD", "PROP") and state.last_type in _BEFORE_NAMES and _names_thing(state, behind):
        return _tag_noun(state, i, 2)  # "the paint pots"
    if kind == "COLORWORD" and text == "tint" and state.last_type in NOUNISH:
        return state.emit("UNKNOWN", None, i, taken)
    return state.emit(kind, value, i, taken)


def _names_thing(state: TaggerState, i: int) -> bool:
    """Whether the word at `i` is a noun of its own that one before it belongs to."""
    return i < len(state.texts) and nouns.is_known(state.texts[i]) and not color_at(state.texts, i)


def _comes(state: TaggerState) -> bool:
    """Whether the verb moves things to the speaker, so that "forward" is towards the speaker: "bring it forward"."""
    return bool(state.clause.tags) and state.clause.tags[0].text in ("bring", "come", "pull", "draw")


def _excludes(state: TaggerState, i: int) -> bool:
    """Whether "bar" excludes what follows ("everything bar the sofa"), rather than being part of "bar stool"."""
    named = state.last_type in (*NOUNISH, "EVERYTHING")
    found = state.ahead.phrase(i + 1)
    return named and found is not None and found[0][0] in ("DET", "PRON", "NUMBER")


def _tag_determiner(state: TaggerState, i: int, value: str) -> int:
    """Tag "this", "all" and the like: as a determiner before a noun, as a pronoun otherwise."""
    text = state.texts[i]
    noun_follows = state.ahead.noun_at(i + 1) or state.ahead.opens_noun(i + 1)
    if text in ("this", "that", "these", "those") and not noun_follows:
        return state.emit("PRON", "it", i, 1)
    if text == "all" and not noun_follows:
        return state.emit("EVERYTHING", "scene", i, 1)
    if text == "both" and not noun_follows:
        return state.emit("PRON", "it", i, 1)
    return state.emit("DET", value, i, 1)


def _tag_noun(state: TaggerState, i: int, at_least: int = 0) -> int:
    """Tag a run of plain words: as a noun, or as an adjective if a colour follows before the noun."""
    if not at_least and state.texts[i] == "non" and (found := color_at(state.texts, i + 1)):
        return state.emit("NONCOLOR", found[0], i, 1 + found[1])
    if not at_least and not may_be_noun(state.texts[i]):
        return state.emit("UNKNOWN", None, i, 1)
    j = i + max(at_least, 1)
    while j < len(state.texts) and _continues_noun(state, j):
        j += 1
    kind = "NOUN" if j - i <= MAX_NOUN_WORDS else "UNKNOWN"
    if j - i > 1 and not at_least and _is_done(state.texts[j - 1]):
        kind = "UNKNOWN"  # "the sofa painted": what was done to it is no part of its name
    if kind == "NOUN" and state.last_type in ("DET", "COLOR", "SIZE", "ADJ") and state.ahead.colored_noun(j):
        kind = "ADJ"
    return state.emit(kind, " ".join(state.texts[i:j]), i, j - i)


def _is_done(word: str) -> bool:
    """Whether a word says what was done to a thing: no name of a thing ends with it ("the sofa painted")."""
    return word in lexicon.DONE or (word.endswith("ed") and len(word) > 4 and not nouns.is_known(word))


def _is_container(state: TaggerState, j: int) -> bool:
    """Whether "can" behind a noun is a container ("the fuel can") and no verb."""
    behind = state.texts[j + 1 : j + 2]
    joint = not behind or behind[0] in (",", "and", "or", "but", "then", "to", "from", "by", "please", "'s", "too")
    return joint or state.ahead.preposition_at(j + 1) or state.ahead.hue_follows(j + 1)


def _continues_noun(state: TaggerState, j: int) -> bool:
    texts = state.texts
    if state.clause.verb == "SWAP" and texts[j] in ("places", "positions", "spots", "locations", "place", "position"):
        return False
    if texts[j] == "can":
        return _is_container(state, j)
    if not may_be_noun(texts[j]) or texts[j] == ",":
        return False
    tables = (lexicon.CLOSED_PHRASES, lexicon.FILLER)
    if (
        facing_at(state, j)
        or match(CARRYING, texts, j)
        or any(match(t, texts, j) for t in tables)
        or texts[j] in lexicon.PARTICIPLES
    ):
        return False
    return not color_at(texts, j) and not quantities.read(texts[j:])
