"""Words of room descriptions that name neither things nor rooms: relations, walls, parts of the room, people, filler.

Maps each spelling to its meaning. `read.py` combines them.
"""

from __future__ import annotations

from ....gaussians.color import FAMILIES
from ....gaussians.world import relations
from ...grammar.tagging.words import bag, phrases
from ..brief import Scale

Phrase = tuple[str, ...]


def _table(said: dict[str, str]) -> dict[Phrase, str]:
    return {tuple(phrase.split()): value for listed, value in said.items() for phrase in listed.split(", ")}


# Relations with an object. `reversed`: "X surrounded by Y" is "Y around X". What "at" and "from" mean depends on the
# things.
_SAID = [kind for kind in relations.KINDS if kind.used("wish") or kind.phrases.descriptions]
RELATIONS: dict[Phrase, str] = {
    **{tuple(p.split()): kind.name for kind in _SAID for p in kind.phrases.in_descriptions()},
    **{tuple(p.split()): f"reversed {kind.name}" for kind in _SAID for p in kind.phrases.in_reverse()},
    **_table({"at": "at", "hanging from, hung from, suspended from, dangling from, from": "from"}),
}

# Relations without an object, or whose object is a part of the room.
SPOTS: dict[Phrase, str] = {
    **{tuple(p.split()): kind.name for kind in relations.KINDS for p in kind.alone.in_descriptions()},
    **_table({
        "on the wall, hung on the wall, mounted on the wall, wall mounted, on the walls, hanging on the wall, hanging "
        "on the walls, on a wall": "wall",
        "on the floor, on the ground": "floor",
        "from the ceiling, on the ceiling, hanging from the ceiling, hung from the ceiling, suspended from the "
        "ceiling, overhead, under the ceiling, ceiling mounted": "ceiling",
    }),
}  # fmt: skip

WALLS = {
    "north": "north", "south": "south", "east": "east", "west": "west", "northern": "north", "southern": "south",
    "eastern": "east", "western": "west", "back": "north", "rear": "north", "far": "north", "front": "south",
    "left": "west", "right": "east",
}  # fmt: skip
CORNERS = {
    "northeast": ("north", "east"), "northwest": ("north", "west"), "southeast": ("south", "east"),
    "southwest": ("south", "west"), "left": ("west",), "right": ("east",), "back": ("north",), "front": ("south",),
    "north": ("north",), "south": ("south",), "east": ("east",), "west": ("west",), "far": ("north",),
}  # fmt: skip

SIZES: dict[str, Scale] = {
    **dict.fromkeys(bag("tiny mini miniature minuscule"), "tiny"),
    **dict.fromkeys(bag("small little narrow short slim snug low smallish petite"), "small"),
    **dict.fromkeys(bag("big large spacious roomy long wide tall generous sizable sizeable oversized ample larger"),
                    "large"),
    **dict.fromkeys(bag("huge enormous giant gigantic massive vast"), "huge"),
    **dict.fromkeys(bag("medium mid normal average"), "normal"),
}  # fmt: skip
# Materials, and the basic colour of a thing of each where none is stated; "": the material has no typical colour.
MATERIALS = dict.fromkeys(
    bag("glass plastic fabric velvet linen wool cotton upholstered acrylic brick brass"), ""
) | {m: FAMILIES[m] for m in bag(
    "wooden wood oak walnut pine teak mahogany timber birch reclaimed leather rattan wicker bamboo cane straw jute "
    "metal metallic steel chrome aluminium aluminum concrete stone stainless iron marble porcelain ceramic"
)}  # fmt: skip
SHAPES = bag("round square rectangular circular oval curved shaped corner open closed tiered folding")
COUNTS: dict[Phrase, int] = {
    ("a", "few"): 3, ("few",): 3, ("several",): 4, ("multiple",): 4, ("many",): 6, ("some",): 3, ("lots", "of"): 6,
    ("plenty", "of"): 6, ("a", "lot", "of"): 6, ("numerous",): 6, ("various",): 4, ("a", "couple", "of"): 2,
    ("a", "couple"): 2, ("a", "pair", "of"): 2, ("pair", "of"): 2, ("both",): 2, ("a", "number", "of"): 4,
    ("a", "set", "of"): 3, ("rows", "of"): 6, ("a", "row", "of"): 4, ("dozens", "of"): 24, ("a", "bunch", "of"): 4,
    ("a", "handful", "of"): 4, ("two", "rows", "of"): 6, ("a", "series", "of"): 4, ("a", "group", "of"): 4,
    ("enough",): 4, ("a", "dozen"): 12, ("half", "a", "dozen"): 6,
}  # fmt: skip
PEOPLE = bag(
    "people person persons guests guest students student kids kid children child adults adult pupils pupil diners "
    "players player visitors customers employees workers colleagues friends members family teenagers teenager "
    "toddler toddlers baby babies twins couple boys girls boy girl teens readers seats seat kindergarteners gamers "
    "clients patients"
)
# Parts of the room; after a colour or a material they state a feature of it.
STRUCTURE = bag("wall walls floor floors ceiling ceilings paint wallpaper flooring floorboards tiles tile parquet")
ABSTRACT = bag(
    "vibe feel feeling atmosphere ambiance ambience touch touches style theme mood lighting daylight sunlight sense "
    "layout specification specifications character charm design decor decoration decorations view air scheme palette "
    "accent accents focus setup arrangement experience setting look looks aesthetic elements element details detail "
    "flow zone zones storage seating furniture furnishings essentials amenities comfort function purpose party event "
    "use everything goods gourmet items stuff things thing pathways walkway walkways access colors colours color "
    "colour light window-light symmetry harmony privacy conversation studying reading working work sleep play "
    "playing relaxation gaming cooking eating dining exercise maximizing overall area areas corner nook spot"
)
NEGATIONS = phrases(
    "no, without, without any, without a, not any, lacking, minus, free of, instead of, rather than, but no, does not "
    "have, do not have, has no, have no, there is no, there are no, do not want, do not add, do not include, "
    "excluding, except, never, with no, and no, not have, do not need, do not put, leave out, skip, not, none of, sans"
)
ONLY = phrases(
    "only, nothing else, just, nothing more, and nothing else, nothing but, empty, unfurnished, otherwise empty, no "
    "other furniture, solely, vacant"
)
PRONOUNS = bag("it them this that these those which one ones another other others each")
FILLER = bag(
    "a an the and or with of to for in at is are be has have having featuring features feature including includes "
    "include containing contains contain there that which also plus then please i we you would like want need needs "
    "wants could can should must make create build design generate compose furnish imagine give me us my our your "
    "their its set up show draw let put place placed located positioned mounted standing sitting arranged laid out "
    "holding nicely very really quite rather some any hmm maybe perhaps ideally preferably it was so as well too about "
    "approximately roughly measuring measures size sized dimensions dimension room-size following here dream lovely "
    "hanging hung leaning filled stocked equipped decorated furnished lined inspired themed styled by from into such "
    "like but while all where into matching comes come along complete together small-scale style type kind sort "
    "side each every on few will good enough plan made ready offering offers boasting fitted attached other another "
    "own both only hello hi hey thanks thank generous dedicated simple looking ones one two-person scene 3d model "
    "render picture photo-realistic go goes around accompanied facing try do does not you'd just extra "
    "centrally surrounded distinct clear creating create between natural main principal"
)
BUILD = bag("make create build design generate compose furnish imagine give show draw let set put place plan want need")
EDITS = frozenset({"DELETE", "MOVE", "ROTATE", "SCALE", "RECOLOR", "REPLACE", "DUPLICATE", "HIDE", "ISOLATE", "SELECT",
                   "FADE", "TURN", "SWAP", "ADD", "INSERT"})  # fmt: skip
FEATURES: dict[Phrase, str] = _table({
    "high ceiling, high ceilings, tall ceiling, tall ceilings, vaulted ceiling, lofty ceiling": "high ceiling",
    "low ceiling, low ceilings": "low ceiling",
    "dance floor": "dance floor",
    "skylight, skylights": "skylight",
    "brick wall, brick walls, exposed brick, exposed brick wall, exposed brick walls, bare brick": "brick wall",
    "exposed pipes, bare pipes, ductwork": "exposed pipes",
    "accent wall, feature wall": "accent wall",
})  # fmt: skip
BIG_WINDOWS = phrases("large window, big window, floor to ceiling window, panoramic window, huge window")
