"""Readers of the holes of templates, by type: noun phrases, numbers, lengths, units, colours, dimensions, free words.

{x}            Query: a noun phrase          {x:noun}    its words, if they are a noun phrase
{n:number}     float                         {l:length}  float, metres
{u:unit}       Unit                          {c:color}   a basic or other colour word, no material
{p:place}      words from a preposition on, such as "on the desk"
{d:dimension}  Dimension: "wide", "height"   {m:more}    More: "taller", "less wide"
{s:superlative} Superlative: "tallest", "second largest"
{a:amount}     Amount: "more than one", "at least two", "four"
{a:spot}       Spot: a thing, its middle or edge, or a person
{r:relation}   name of a relation: "on top of"
{d:side}       Side: "on my left", "at two o'clock"
{o:way}        name of a relation of one side word: "left"
{z:zone}       a place of the room, as said: "the far left corner"; {w:shell} walls, floor or ceiling
{w:words}      any words
{f:frames}     the ways in which all the words are a question about a scene with time
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache, lru_cache

from ....gaussians.language.query.query import Query
from ....gaussians.world import relations
from ....gaussians.world.lengths import IN_METRES, METRES, UNITS, in_metres
from ....gaussians.world.words import singular
from ...grammar.vocabulary import quantities
from . import (
    activity,
    ends,
    item,
    noun_phrase,
    relation_phrases,
    room_names,
    room_phrases,
    side_phrases,
    spans,
    spots,
    where_to,
)
from .colors import color
from .measures import Unit, amount, dimension, more, superlative
from .phrase_templates import HoleReader, Words
from .time.frames import Frame, frames


def number(words: Words) -> float | None:
    """A number in digits or words; "no" is none."""
    found = quantities.read(words)
    return found.value if found and found.kind == "NUMBER" and found.taken == len(words) else None


def length(words: Words) -> float | None:
    """A length with its unit, in metres."""
    said = words[1:] if words[:1] in (("about",), ("around",)) else words
    found = quantities.read(said) if said else None
    fits = found is not None and found.kind == "LENGTH" and found.taken == len(said)
    return in_metres(found.value, found.unit) if found is not None and fits else None


def unit(words: Words) -> Unit | None:
    """A unit of length: "metres", "ft", "inches"."""
    said = " ".join(words)
    if said in ("in", "'", '"', "units", "unit"):
        return None
    short = UNITS.get(said)
    if short in METRES:
        return Unit(str(short), METRES[str(short)])
    return Unit(said[:2], IN_METRES[said]) if said in IN_METRES else None


def free(words: Words) -> str | None:
    """Any words."""
    return " ".join(words) or None


def noun(words: Words) -> Words | None:
    """The words of a noun phrase."""
    return words if noun_phrase.thing(words) is not None else None


_SOME = frozenset({"any", "anything", "some", "something", "anywhere", "somewhere"})


@cache
def _prepositions() -> frozenset[str]:
    """First words of the relations of queries."""
    phrases = (p for kind in relations.KINDS for p in (*kind.phrases.in_commands(), *kind.alone.in_commands()))
    return frozenset(p.split()[0] for p in phrases) | {
        "closest", "nearest", "farthest", "hanging", "standing", "lying", "from", "off",
    }  # fmt: skip


def some(words: Words) -> Query | None:
    """A noun phrase that begins with "any", "anything" or the like."""
    return noun_phrase.thing(words) if words and words[0] in _SOME else None


@lru_cache(maxsize=4096)
def place(words: Words) -> Words | None:
    """Words that say where a thing is: "on the desk", "to the left of the bed"."""
    if len(words) < 2 or words[0] not in _prepositions():
        return None
    return words if noun_phrase.thing(("thing", *words)) is not None else None


def time_frames(words: Words) -> tuple[Frame, ...] | None:
    """The ways of reading a question about a scene with time, the likeliest first."""
    return frames(words) or None


_COLUMNS: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("size", "dimension", "measurement", "measure", "extent"), ("width", "depth", "height")),
    **dict.fromkeys(("position", "location", "place", "coordinate", "whereabouts"), ("x", "y", "z")),
    **dict.fromkeys(("width", "length", "breadth"), ("width",)),
    "depth": ("depth",), "height": ("height",), "color": ("color",), "support": ("on",),
    "id": (), "number": (), "name": (), "label": (),
}  # fmt: skip


def columns(words: Words) -> tuple[str, ...] | None:
    """Columns of a table: "sizes and colours" to width, depth, height and colour."""
    said = [singular(w) for w in words if w not in (",", "and", "the", "their", "its", "plus")]
    if not said or any(w not in _COLUMNS for w in said):
        return None
    return tuple(dict.fromkeys(c for w in said for c in _COLUMNS[w])) or None


READERS: Mapping[str, HoleReader] = {
    "thing": noun_phrase.thing,
    "noun": noun,
    "some": some,
    "number": number,
    "length": length,
    "unit": unit,
    "color": color,
    "place": place,
    "dimension": dimension,
    "more": more,
    "superlative": superlative,
    "amount": amount,
    "columns": columns,
    "words": free,
    "spot": spots.spot,
    "relation": relation_phrases.relation,
    "side": side_phrases.side,
    "mutual": relation_phrases.mutual,
    "either": side_phrases.either,
    "way": side_phrases.way,
    "zone": room_phrases.zone,
    "shell": room_phrases.shell,
    "length_unit": spans.unit,
    "area_unit": spans.area_unit,
    "volume_unit": spans.volume_unit,
    "area": spans.area,
    "span": spans.length,
    "extent": spans.dimension,
    "lesser_extent": spans.lesser,
    "room": spans.room,
    "room_name": room_names.room_name,
    "end": ends.end,
    "walker": ends.walker,
    "item": item.read_item,
    "activity": activity.activity,
    "where_to": where_to.where_to,
    "frames": time_frames,
}
