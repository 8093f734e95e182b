"""Takes what an instruction says of light out of it, clause by clause, and leaves the rest to the grammar."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice, pairwise
from typing import Any

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ..restating.speech.frames import is_reported, unframed, without_asides
from ..tagging.words import Word, bag, split
from .lamps import switched
from .places import somewhere
from .reading import read
from .tokens import tokens_of
from .vocabulary import meanings
from .wording import is_comparison, is_kept, is_mended, misspelled, plainly

EVERYTHING = Query(text="everything", pick="all")
_MARKS = (",", ".", ";", "!", "?", ":", "\n")
_JOINING = ("and", "then", "but", "or")
_IT_IS = (
    ("it", "is"),
    ("it", "looks"),
    ("it", "feels"),
    ("it", "seems"),
    ("this", "is"),
    ("that", "is"),
    ("this", "looks"),
)
_HAVING = (("have", "it"), ("want", "it"), ("like", "it"), ("need", "it"), ("can", "it"), ("could", "it"))
_DENIED = bag("not never no without nothing")
_BEFORE_SO = bag("not is are ever")  # "not so bright"
_FRONTED = re.compile(
    r"^(?:for|since|because|when|while|as|now that|after|before|during) (?!(?:the|a) (?:light|lamp))[^,.;]{3,60}, "
    r"(?=\w)",
    re.IGNORECASE,
)  # "for the evening, dim the lights"
_CHANGES = bag(
    "brighter darker dimmer warmer cooler colder softer harsher cosy cozy romantic spooky dim dimmed brighten "
    "darken down "
    "up lower raise red blue green purple pink violet teal magenta turquoise"
)
_LOOKING = bag("look looks looking feel feels be is something more seem would not")
_PAINTED = bag("darker lighter")
_CUTS = 3  # asides that are left out
_MOST = 12  # pieces of an instruction that are looked at


@dataclass(frozen=True)
class Part:
    """A part of an instruction.

    Attributes:
        text: its words as they stand.
        fields: of the operation, without its target; None where the grammar reads it.
        target: what of the scene it means.
    """

    text: str
    fields: dict[str, Any] | None = None
    target: Query = EVERYTHING


def parts_of(cleaned: str, lit: bool, alone: bool, thing: Callable[[str], Query | None]) -> list[Part] | None:
    """The parts of an instruction, read in plain words if more of it is understood; see `_parts`."""
    plain = plainly(cleaned)
    bare = _FRONTED.sub("", plain)
    asked = _parts(bare, lit, alone, thing) if bare != plain else None
    if asked is not None and all(part.fields is not None for part in asked):
        return asked
    if plain == cleaned:
        return _parts(cleaned, lit, alone, thing)
    found = _parts(plain, lit, alone, thing)
    if found is not None and all(part.fields is not None for part in found):
        return found
    said = _parts(cleaned, lit, alone, thing)
    return found if said is not None and found is not None and _read(found) > _read(said) else said


def _read(parts: Sequence[Part]) -> int:
    return sum(part.fields is not None for part in parts)


def _parts(cleaned: str, lit: bool, alone: bool, thing: Callable[[str], Query | None]) -> list[Part] | None:
    """The parts of an instruction, None if nothing of it is about light.

    Args:
        cleaned: see `tagging.words.clean`.
        lit: whether the instruction before was about light.
        alone: whether there was no instruction before.
        thing: reads a phrase for things.
    """
    pieces = _pieces(split(cleaned))
    if not pieces or len(pieces) > _MOST:
        return None
    found: list[tuple[int, int, _Said | None]] = []
    at, said = 0, lit
    while at < len(pieces):
        if found and found[-1][2] is not None and _is_aside(pieces[at]):
            at += 1
            continue
        apart = _is_remark(pieces[at]) or _is_likened(pieces[at : at + 2])
        longest = at + 1 if apart else len(pieces)
        for end in range(longest, at, -1):
            words = [w.text for piece in pieces[at:end] for w in piece if w.text not in _MARKS]
            if end - at > 1 and _switched_apart(pieces[at:end], thing):
                continue
            understood = _clause(words, said or (alone and at == 0 and _bare(words)), thing, end - at == 1)
            if understood is not None:
                before = found[-1][2] if found else None
                understood = _there(understood, before, words)
                if (
                    before is not None
                    and before.target == understood.target != EVERYTHING
                    and set(understood.fields) == {"kelvin"}
                ):
                    understood = replace(understood, fields={**before.fields, **understood.fields})
                    at = found.pop()[0]
                found.append((at, end, understood))
                at, said = end, True
                break
        else:
            before = found[-1][2] if found else None
            if before is None or not _says_no_more(pieces[at], before.remark):
                found.append((at, at + 1, None))
            at += 1
    if all(one is None for _, _, one in found):
        return None
    return _joined(cleaned, pieces, found)


@dataclass(frozen=True)
class _Said:
    fields: dict[str, Any]
    target: Query
    remark: bool = False


_HINTS = re.compile(
    r"light|lit\b|bright|dark|dim|lamp|warm|cool|cold|glow|sun|moon|night|evening|dusk|dawn|morning|day|candle|mood|"
    r"atmos|ambi|kelvin|\bk\b|\d{4,5} ?k|exposure|illum|gloom|ding|murk|overcast|cloud|noon|twilight|golden|contrast|"
    r"shadow|lantern|chandelier|cosy|cozy|sconce|bulb|fire|rainy|white balance|vibe|romantic|shade|blinding|glar|"
    r"\bstops?\b|\bev\b|cosi|cozi|\beyes\b|pitch|dinner|movie|romantic|date night|see (?:a|much)|rain|snow|storm|fog|"
    r"winter|novem|decem|cast\b|tint|tinge|bedtime|dinner|cinema|pendant|\d ?[ap]\.?m\b|"
    r"(?:less|more|too) (?:blue|yellow|orange|red|white)|exposed|"
    r"hour\b|sunny|thunder|spooky|eerie|halloween|neon|\bleds?\b|visible|to see\b|mediterranean|\bzen\b|cabin|"
    r"festive|\bsoft|harsh|winter|nocturnal|tungsten|cinematic|bleach|washed|hygge|temperature",
    re.IGNORECASE,
)


_GREETING = re.compile(
    r"(?:(?:hi|hello|hey),? )?(?:a )?(?:very )?good (?:morning|evening|night|day)\b[\w ]*[.!]*", re.IGNORECASE
)


def may_be_light(cleaned: str) -> bool:
    """Whether any word could be about light; most instructions have none, and take no more time."""
    named = _HINTS.search(cleaned) is not None or misspelled(cleaned)
    return named and _GREETING.fullmatch(cleaned.strip()) is None


def _pieces(words: Sequence[Word]) -> list[list[Word]]:
    """The words between marks and conjunctions, without them."""
    found: list[list[Word]] = [[]]
    for word in words:
        aim = word.text in ("so", "because", "since") and bool(found[-1]) and found[-1][-1].text not in _BEFORE_SO
        if word.text in _MARKS or word.text in _JOINING:
            found.append([])
        elif aim:
            found.append([word])
        else:
            found[-1].append(word)
    return [piece for piece in found if piece]


def _is_remark(piece: Sequence[Word]) -> bool:
    """Whether a clause only tells what is wrong with the light: "the whole place looks dingy"."""
    words = [w.text for w in piece]
    heard = read(words, True) if not _asked(words) else None
    return heard is not None and heard.remark


def _is_aside(piece: Sequence[Word]) -> bool:
    """Whether a clause behind one about light only compares it: "like the middle of July", not "like 4000 K"."""
    words = [w.text for w in piece]
    return is_comparison(words) and not any(w[0].isdigit() for w in words)


def _is_likened(pieces: Sequence[Sequence[Word]]) -> bool:
    """Whether the first of two clauses is about light, and the second says what that is like: "cosy, like a pub"."""
    if len(pieces) < 2 or not is_comparison([w.text for w in pieces[1]]):
        return False
    return read([w.text for w in pieces[0]], True) is not None


def _says_no_more(piece: Sequence[Word], remarked: bool) -> bool:
    """Whether a clause behind one about light asks for nothing more: "like the middle of July", "the rest is fine",
    "so that buyers can see it", and "fix that" behind a remark."""
    words = [w.text for w in piece]
    if is_comparison(words) or is_kept(words):
        return True
    return remarked and (is_mended(words) or tokens_of(words) is not None)  # "it is cold and sterile"


def _switched_apart(pieces: Sequence[Sequence[Word]], thing: Callable[[str], Query | None]) -> bool:
    """Whether the first and the last of several pieces switch lamps each: "table lamp on, floor lamp off"."""
    said = [[w.text for w in piece] for piece in (pieces[0], pieces[-1])]
    return all({"on", "off", "out"} & set(words) and switched(" ".join(words), thing) is not None for words in said)


def _is_filler(pieces: Sequence[Sequence[Word]]) -> bool:
    """Whether pieces only hold words that say nothing: "please"."""
    return all(any(m.slot == "filler" for m in meanings().get((w.text,), ())) for piece in pieces for w in piece)


def _bare(words: Sequence[str]) -> bool:
    """Whether words name nothing that they are about: "a bit brighter please", "it is too dark"."""
    if tuple(words[:2]) in _IT_IS or any(pair in _HAVING for pair in pairwise(words)):
        return True
    if "it" in words and _PAINTED & set(words):
        return False  # "make it darker" is said of a thing that was spoken of
    return len(words) > 1 and not {"that", "them", "these", "those"} & set(words)


def _clause(
    words: Sequence[str], loose: bool, thing: Callable[[str], Query | None], alone: bool = True
) -> _Said | None:
    """What one clause says of light; asides are left out where it stands `alone` between marks."""
    said = " ".join(words)
    if (lamps := switched(said, thing)) is not None:
        return _Said(lamps.fields, lamps.target or EVERYTHING)
    for shorter in (*_before_likeness(words), list(words), *_reduced(words, alone)):
        heard = read(shorter, loose)
        if heard is not None and (
            len(shorter) == len(words) or heard.anchored or heard.remark or _CHANGES & set(shorter)
        ):
            return _Said(heard.fields, EVERYTHING, heard.remark and not _asked(shorter))
        if (there := somewhere(shorter, loose, thing)) is not None:
            return _Said(there.heard.fields, there.target, there.heard.remark and not _asked(shorter))
    return None


def _before_likeness(words: Sequence[str]) -> Iterator[list[str]]:
    """The words before what they are compared to or meant for: "cooler light like in a hospital"."""
    at = next((i for i, w in enumerate(words) if i > 1 and w in ("like", "for")), None)
    changing = at is not None and bool(_CHANGES & set(words[:at])) and words[at - 1] not in _LOOKING
    if at is not None and changing and not _DENIED & set(words):
        yield list(words[:at])


def _reduced(words: Sequence[str], alone: bool) -> Iterator[list[str]]:
    """The words without the frame of the wish, and without asides behind it; none where they ask for nothing."""
    said = " ".join(words)
    if is_reported(said) or _DENIED & set(words):
        return
    plain = unframed(said).split()
    if plain and plain != list(words):
        yield plain
    if alone:
        yield from islice(without_asides(plain), _CUTS)


def _there(said: _Said, before: _Said | None, words: Sequence[str]) -> _Said:
    """A clause that says "it" of a place or lamp of the remark before: "the light there is too yellow, cool it"."""
    named = before is not None and before.remark and before.target != EVERYTHING
    toned = set(said.fields) == {"kelvin"} and words[0] in ("like", "at", "about", "around", "say")
    if toned and before is not None and said.target == EVERYTHING:
        return replace(said, target=before.target)  # "more light on the desk, like 4000 K"
    if named and before is not None and said.target == EVERYTHING and {"it", "that"} & set(words):
        return replace(said, target=before.target)
    return said


def _asked(words: Sequence[str]) -> bool:
    return bool({"make", "can", "could", "please", "want", "would"} & set(words))


def _joined(cleaned: str, pieces: list[list[Word]], found: list[tuple[int, int, _Said | None]]) -> list[Part]:
    """Parts in their order; what is not about light in runs, with the words between them. A remark ("too dark") behind
    or before which something is asked of the light says nothing more."""
    asked = any(one is not None and not one.remark for _, _, one in found)
    parts: list[Part] = []
    start: int | None = None
    for i, (first, last, one) in enumerate(found):
        if one is None and _is_filler(pieces[first:last]):
            continue
        if one is None:
            start = pieces[first][0].start if start is None else start
            following = found[i + 1][2] if i + 1 < len(found) else one
            if i + 1 == len(found) or following is not None:
                end = pieces[last - 1][-1].end
                parts.append(Part(cleaned[start:end]))
                start = None
            continue
        if one.remark and asked:
            continue
        text = cleaned[pieces[first][0].start : pieces[last - 1][-1].end]
        parts.append(Part(text, one.fields, one.target))
    return parts
