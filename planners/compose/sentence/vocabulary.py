"""Words of room descriptions that name neither things nor rooms: relations, walls, parts of the room, people, filler.

Maps each spelling to its meaning. `read.py` combines them.
"""

from __future__ import annotations

from ....gaussians.color import FAMILIES
from ....gaussians.world import relations
from ...grammar.tagging.words import bag, phrases
from ..brief import Form, Scale

Phrase = tuple[str, ...]


def _table(said: dict[str, str]) -> dict[Phrase, str]:
    return {tuple(phrase.split()): value for listed, value in said.items() for phrase in listed.split(", ")}


# Relations with an object. `reversed`: "X surrounded by Y" is "Y around X". What "at" and "from" mean depends on the
# things.
_SAID = [kind for kind in relations.KINDS if kind.used("wish") or kind.phrases.descriptions]
RELATIONS: dict[Phrase, str] = {
    **{tuple(p.split()): kind.name for kind in _SAID for p in kind.phrases.in_descriptions()},
    **{tuple(p.split()): f"reversed {kind.name}" for kind in _SAID for p in kind.phrases.in_reverse()},
    **_table(
        {
            "at, per": "at",
            "hanging from, hung from, suspended from, dangling from, from": "from",
            "at the end of, at one end of, at the head of, at the edge of, at the base of, at the corner of, around "
            "the corner from, close beside, tucked beside, butted up against, off": "next_to",
            "round, all round, encircling, circling, grouped around, clustered around, placed around, standing around, "
            "sitting around, arranged round, set round": "around",
            "face, faces, faced toward, faced towards, that face, which face, pointed at, pointing at, aimed at, "
            "turned to face, looks out on, looks onto, looks at, looking onto, look at, looking toward, looking "
            "towards": "facing",
            "goes on, stands on, sits on, sitting on, standing on, resting on, lying on, placed on, displayed on": "on",
            "full of, filled with, packed with, loaded with, covered in, piled with, overflowing with, topped "
            "off with, "
            "crammed with, stacked with": "reversed on",
            "goes under, tucked under, tucked underneath, stored under": "under",
            "goes next to, stands next to, sits next to, right beside, right next to": "next_to",
            "hangs above, hangs over, hanging above, suspended above, suspended over, hung over": "above",
            "along, lined along, running along, all along, down": "against",
            "across": "across",
            "tied to, attached to, fixed to, chained to, connected to, hooked to, clipped to, leading to, leading up "
            "to": "next_to",
            "right above, directly above, just above, hanging right above, hanging directly above, mounted over, "
            "centered above, centred above": "above",
            "directly behind, right behind, just behind": "behind",
            "directly in front of, right in front of, just in front of, out in front of": "in_front_of",
            "directly under, right under, just under, tucked beneath, stored beneath, stored underneath": "under",
            "perched on, piled on, stacked on, balanced on, propped on, spread on, arranged on, laid on, asleep on, "
            "sleeping on, right on top of, high on top of": "on",
            "stuffed with, brimming with, stacked high with": "reversed on",
        }
    ),
}

# Relations without an object, or whose object is a part of the room.
SPOTS: dict[Phrase, str] = {
    **{tuple(p.split()): kind.name for kind in relations.KINDS for p in kind.alone.in_descriptions()},
    **_table({
        "on the wall, hung on the wall, mounted on the wall, wall mounted, on the walls, hanging on the wall, hanging "
        "on the walls, on a wall": "wall",
        "face each other, face one another, faces each other, looking at each other, face to face with each "
        "other": "facing",
        "in front, out in front, right in front": "rel in_front_of",
        "to one side, off to one side, on one side": "one side",
        "to the other side, on the other side, on the opposite side": "other side",
        "side by side, next to each other, beside each other, next to one another, beside one another, shoulder to "
        "shoulder": "beside",
        "to its left, on its left, to the left of it": "rel left_of",
        "to its right, on its right, to the right of it": "rel right_of",
        "on top": "rel on",
        "on the floor, on the ground": "floor",
        "in the corners, in each corner, in every corner, at the corners, in all corners, in all four corners, in the "
        "four corners, in the corners of the room, at the corners of the room, at each corner, in each of the corners, "
        "at every corner, in each of the four corners": "corners",
        "at its head, at its foot, at its side, by its side, at its end, at their head, next to that": "rel next_to",
        "at the back, in the back, at the rear, in the rear, at the far end, along the back, across the back, at the "
        "very back": "part north",
        "at the front, in the front, up front, along the front, out front": "part south",
        "on the left, to the left, on the left side, on the left hand side, off to the left": "part west",
        "on the right, to the right, on the right side, on the right hand side, off to the right": "part east",
        "on opposite walls, against opposite walls, along opposite walls, on facing walls, at opposite walls": "walls",
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
    bag(
        "glass plastic fabric velvet linen wool cotton upholstered acrylic brick brass suede corduroy tweed denim silk "
        "knitted quilted lacquered burlap hessian boucle cashmere satin plush terrazzo granite slate travertine quartz "
        "limestone woollen"
    ), ""
) | {m: FAMILIES.get(m, "") for m in bag(
    "wooden wood oak walnut pine teak mahogany timber birch reclaimed leather rattan wicker bamboo cane straw jute "
    "metal metallic steel chrome aluminium aluminum concrete stone stainless iron marble porcelain ceramic "
    "plywood beech maple cedar ebony rosewood driftwood"
)}  # fmt: skip
SHAPES = bag("round square rectangular circular oval curved shaped open closed tiered l-shaped")
COUNTS: dict[Phrase, int] = {
    ("a", "few"): 3, ("few",): 3, ("several",): 4, ("multiple",): 4, ("many",): 6, ("some",): 3, ("lots", "of"): 6,
    ("plenty", "of"): 6, ("a", "lot", "of"): 6, ("numerous",): 6, ("various",): 4, ("a", "couple", "of"): 2,
    ("a", "couple"): 2, ("a", "pair", "of"): 2, ("pair", "of"): 2, ("both",): 2, ("a", "number", "of"): 4,
    ("a", "set", "of"): 3, ("rows", "of"): 6, ("a", "row", "of"): 4, ("dozens", "of"): 24, ("a", "bunch", "of"): 4,
    ("a", "handful", "of"): 4, ("two", "rows", "of"): 6, ("a", "series", "of"): 4, ("a", "group", "of"): 4,
    ("enough",): 4, ("a", "dozen"): 12, ("half", "a", "dozen"): 6, ("loads", "of"): 6, ("a", "load", "of"): 6,
    ("piles", "of"): 4, ("half", "dozen"): 6, ("a", "cluster", "of"): 4, ("a", "collection", "of"): 4,
    ("an", "array", "of"): 6, ("heaps", "of"): 6, ("pairs", "of"): 4,
}  # fmt: skip
PEOPLE = bag(
    "people person persons guests guest students student kids kid children child adults adult pupils pupil diners "
    "players player visitors customers employees workers colleagues friends members family teenagers teenager "
    "toddler toddlers baby babies twins couple boys girls boy girl teens readers seats seat kindergarteners gamers "
    "clients patients"
)
# Parts of the room; after a colour or a material they state a feature of it.
STRUCTURE = bag("wall walls floor floors ceiling ceilings paint wallpaper flooring floorboards tiles tile parquet")
# Words that say how things stand together, before or behind their names.
FORMS: dict[str, Form] = {
    **dict.fromkeys(bag("row rows line lines column columns rank ranks aisle file"), "row"),
    **dict.fromkeys(bag("circle ring semicircle horseshoe round"), "circle"),
    **dict.fromkeys(bag("grid block"), "grid"),
}  # fmt: skip
# Of "a stack of books" the books are the thing; of "a crate of apples" the crate.
MEASURES = bag(
    "roll sheet block piece slab bolt row stack pile heap bundle pair set string collection tower bunch group cluster "
    "bank rows line range"
)
PAIRS = bag("scales drums drawers keys weights shelves stairs steps cutlery tools doors clubs skis oars headphones")
# Heads of names of places: a text that begins with "a nail bar with" describes one.
PLACES = bag(
    "bar pub club stall stand booth shop store parlour parlor caravan marquee tent cabin house hall lounge den station "
    "centre center workshop ward wagon carriage boat ship bus train van truck hut shed barn stable yard camp arena "
    "pool "
    "lobby suite quarters chamber cell dungeon cave bunker treehouse pavilion gazebo conservatory winery brewery sauna "
    "igloo lighthouse deck depot cellar office marquee ring court pitch rink platform"
)
# Endings of adjectives that boxes cannot show: "a striped awning", "mismatched chairs".
ADJECTIVE_ENDINGS = ("ed", "ing", "able", "ible", "ish", "less", "ful")
# Parts of things and of the room, which are no things by themselves.
PARTS = bag(
    "end ends back front side sides foot head edge edges top bottom middle centre center rear base row rows "
    "line lines circle ring half halves third angle angles direction way distance left right north south east "
    "west aisle floor floors ground wall walls ceiling ceilings room garden terrace balcony space height width length "
    "depth level metre metres meter meters foot feet rest place position spot point background foreground inside "
    "outside entrance exit light dark day night morning evening summer winter spring autumn time afternoon sun shade "
    "alcove alcoves niche recess bay nook pair pairs group groups grid fold riad cell "
    "hotel school office shop store church museum hospital station airport village farm pub club restaurant cafe mall "
    "market university college theatre cinema factory warehouse library bar diner studio apartment flat "
    "sky weather season house home building street town city country manor world style"
)
NOT_THINGS = (
    "ness",
    "ity",
    "tion",
    "sion",
    "ment",
    "ance",
    "ence",
    "ism",
    "ship",
    "hood",
    "ing",
    "ly",
    "ful",
    "less",
    "ous",
    "ive",
    "able",
    "ible",
    "ish",
    "ed",
)  # endings of words that name no thing one can put in a room
ABSTRACT = bag(
    "vibe feel feeling atmosphere ambiance ambience touch touches style theme mood lighting daylight sunlight sense "
    "layout specification specifications character charm design decor decoration decorations view air scheme palette "
    "accent accents focus setup arrangement experience setting look looks aesthetic elements element details detail "
    "flow zone zones storage seating furniture furnishings essentials amenities comfort function purpose party event "
    "use everything goods gourmet items stuff things thing pathways walkway walkways access colors colours color "
    "colour light window-light symmetry harmony privacy conversation studying reading working work sleep play "
    "playing relaxation gaming cooking eating dining exercise maximizing overall area areas corner nook spot owner "
    "owners selling sale sales music air summer winter dinner lunch breakfast tea drinks food sound noise smell colour "
    "mess clutter bit lot kind sort type shape form size idea plan dream memory life love fun charm magic"
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
    "centrally surrounded distinct clear creating create between natural main principal has gets goes stands sits "
    "least most say well old new ones please plain empty own its their his her my stood laid set w facing against "
    "round lots big-ish old-fashioned proper lovely pretty beautiful usual same different single double "
    "first second third fourth fifth last next fold folded pull drop "
    "piled stacked heaped propped scattered strewn perched tucked nestled mounted displayed arranged parked stored "
    "stretched gathered huddled clustered grouped crammed squeezed nailed screwed pinned taped glued theres heres "
    "himself herself each being lined lit selling full fully half tucked running leading down up off out"
)
BUILD = bag("make create build design generate compose furnish imagine give show draw let set put place plan want need")
EDITS = frozenset({"DELETE", "MOVE", "ROTATE", "SCALE", "RECOLOR", "REPLACE", "DUPLICATE", "HIDE", "ISOLATE", "SELECT",
                   "FADE", "TURN", "SWAP", "ADD", "INSERT"})  # fmt: skip
FEATURES: dict[Phrase, str] = _table({
    "high ceiling, high ceilings, tall ceiling, tall ceilings, vaulted ceiling, lofty ceiling": "high ceiling",
    "low ceiling, low ceilings": "low ceiling",
    "dance floor": "dance floor",
    "brick wall, brick walls, exposed brick, exposed brick wall, exposed brick walls, bare brick": "brick wall",
    "exposed pipes, bare pipes, ductwork": "exposed pipes",
    "accent wall, feature wall": "accent wall",
})  # fmt: skip
BIG_WINDOWS = phrases("large window, big window, floor to ceiling window, panoramic window, huge window")
