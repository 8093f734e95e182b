"""The closed vocabulary: maps every phrase that is not a noun to its word class and value.

For example "get rid of" is DELETE and "to the left of" is PREP left_of. grammar.lark combines the classes; tagger.py
chooses the class in context. The tables are keyed by phrase; `table` turns them into tables keyed by tuples of words
(VERB_PHRASES, CLOSED_PHRASES, ATTRIBUTE_PHRASES).
"""

from __future__ import annotations

from ....gaussians.world import relations
from ....gaussians.world.finishes import FINISHES
from ..tagging.words import bag, phrases
from .verbs import UNSUPPORTED, VERBS, Entry, same

# Commands that the session answers, not a planner; then words of chat and questions, which ask for no edit.
COMMANDS = frozenset(
    {
        "undo",
        "redo",
        "save",
        "help",
        "quit",
        "exit",
        "load",
        "history",
        "render",
        "screenshot",
        "cancel",
        "stop",
        "revert",
    }
)
CHAT = bag(
    "hello hi hey hiya greetings thanks thank bye goodbye cheers yes no yep nope ok okay cool great nice wow sorry "
    "morning evening good lol awesome perfect amazing excellent brilliant lovely fantastic sweet neat work job well "
    "done super appreciate it that looks million bunch heaps tons loads one"
)
QUESTION = bag(
    "what where who whom whose which why how when is are am was were does do did has have had can could will would "
    "shall should may might"
)
# A sentence that begins with one of these takes back the previous one.
RETRACTIONS = phrases(
    "no, nope, nah, wait, no wait, actually no, actually not, scratch that, never mind, nevermind, forget it, forget "
    "that, cancel that, cancel, sorry, i mean, i meant, oops, on second thought, rather not, hold on, stop, "
    "just kidding"
)
STATEMENT = bag("i we you he she they there my our your")

# Words that are nouns as well; they are verbs only if an object follows.
NOUN_VERBS = bag(
    "plant light paint set stand copy clone duplicate mark place park drop bin mount rest tip roll change show pick "
    "color colour tint stain dye coat spray swap switch trade slide push dump scrap trash lock play fold lift double "
    "clear dust label group face hang cool warm spin twist flip turn scale grow narrow lower split light position "
    "center centre keep leave have sit edge wheel junk boot toss slap splash need want"
)

# ---- words inside a clause -----------------------------------------------------------------------------------------

_RELATED = [kind for kind in relations.KINDS if kind.anchors == 1 and not kind.orders and kind.name != "center"]
RELATIONS: dict[str, str] = {p: kind.name for kind in _RELATED for p in kind.phrases.in_commands()}


def _said(kind: str, name: str, alone: bool = False) -> dict[str, Entry]:
    """The phrases of a relation that has a token class of its own: those before an anchor, or those without one."""
    known = relations.named(name)
    return dict.fromkeys((known.alone if alone else known.phrases).in_commands(), (kind, name))


_COUNTS = ((2, "two"), (3, "three"), (4, "four"), (5, "five"), (6, "six"), (7, "seven"), (8, "eight"))
_KINDS_OF_THING = ("things", "objects", "items", "pieces", "parts", "different things", "separate things",
                   "different objects", "separate objects", "individual things")  # fmt: skip


def _one_thing() -> dict[str, Entry]:
    """What says that things are one ("as one thing", "are one object", "belong together", "is part of")."""
    ones = [f"{one}{thing}" for one in ("one", "a single", "one single") for thing in (" thing", " object", " item")]
    ones += ["one", "the same thing", "the same object"]
    together = {f"{into} {one}": ("ASONE", None) for into in ("as", "into", "to be") for one in ones}
    being = {f"{are} {one}": ("BEONE", None) for are in ("are", "is", "form", "make up", "should be") for one in ones}
    being |= same(("BEONE", None), "belong together, go together, belong to each other")
    being |= same(("PARTOF", None), "belongs to, belong to, is part of, is a part of, are part of, are a part of, "
                  "belongs with, goes with")  # fmt: skip
    return {**together, "together": ("ASONE", None), **being}


def _several_things() -> dict[str, Entry]:
    """What says that one thing is several ("is two things", "into three parts", "in two")."""
    found: dict[str, Entry] = {}
    for number, word in _COUNTS:
        for said in (word, str(number)):
            found |= {f"{into} {said}": ("INTOMANY", number) for into in ("in", "into")}
            for thing in _KINDS_OF_THING:
                found |= {f"{into} {said} {thing}": ("INTOMANY", number) for into in ("in", "into")}
                found |= {
                    f"{be}{really} {said} {thing}": ("BEMANY", number)
                    for be in ("is", "are", "should be", "that is", "that are")
                    for really in ("", " actually", " really", " in fact")
                }
    return found


def _axes() -> dict[str, Entry]:
    """What a turn is about ("around the x axis", "about the vertical axis")."""
    found: dict[str, Entry] = {}
    for about in ("around", "about", "along", "on", "round"):
        for axis in ("x", "y", "z"):
            found |= {f"{about} {the}{axis}{word}": ("AXIS", axis) for the in ("", "the ") for word in ("", " axis")}
        for the in ("the", "its", "a"):
            found |= same(("AXIS", "up"), f"{about} {the} vertical axis, {about} {the} up axis, {about} {the} vertical")
    return found


def _same_color() -> dict[str, Entry]:
    """What gives a thing the colour of another ("the same colour as")."""
    leads, sames = ("", "the ", "in the ", "to the ", "of the "), ("same", "exact same", "very same", "identical")
    colors, likes = ("colour", "color", "shade", "hue", "paint"), ("as", "like", "as that of", "as the one of")
    found: dict[str, Entry] = {
        f"{lead}{alike} {color} {like}": ("COLORLIKE", None)
        for lead in leads
        for alike in sames
        for color in colors
        for like in likes
    }
    matching = ("to match the ", "matching the ", "in the ")
    surfaces = {f"like~{name}": ("COLORLIKE", name) for name in ("material", *FINISHES)}  # see `restating.likenesses`
    return (
        found
        | surfaces
        | {f"{lead}{color} of": ("COLORLIKE", None) for lead in matching for color in ("colour", "color")}
    )


def _standing() -> dict[str, Entry]:
    """What begins a description by a place ("that stands", "which are hanging")."""
    verbs = ("stands", "stand", "sits", "sit", "hangs", "hang", "lies", "lie", "rests", "lives")
    forms = (*verbs, *(f"{be} {v}ing" for be in ("is", "are") for v in ("stand", "sitt", "hang", "ly")))
    return {f"{that} {form}": ("REL", None) for that in ("that", "which") for form in forms}


def _corner_names() -> dict[str, tuple[str, ...]]:
    """What people call each corner of the room."""
    depths = {"front": ("front", "near", "nearest", "closest"), "back": ("back", "rear", "far", "furthest", "farthest")}
    found: dict[str, tuple[str, ...]] = {}
    for depth, words in depths.items():
        for side in ("left", "right"):
            pairs = [f"{w} {side}{hand}" for w in words for hand in ("", " hand", "most")]
            found[f"{depth} {side}"] = (*pairs, *(f"{side}{hand} {w}" for w in words[:2] for hand in ("", " hand")))
    return found


def _corner_attributes() -> dict[str, Entry]:
    """The corners of the room before a noun ("the back left chair"); "far left" is the leftmost."""
    names = ((name, corner) for corner, found in _corner_names().items() for name in found)
    return {name: ("SUP", corner) for name, corner in names if not name.startswith(("far", "furthest"))}


def _corners() -> dict[str, Entry]:
    """The four corners of the room, as places and behind a thing that is there ("in the back left corner")."""
    found: dict[str, Entry] = {}
    for corner, names in _corner_names().items():
        for name in names:
            for of in ("", " of the room"):
                leads = ("in the", "to the", "into the", "at the", "over in the", "over to the")
                found |= {f"{lead} {name} corner{of}": ("SPOT", corner) for lead in leads}
            if not name.startswith(("far", "furthest")):
                found |= {f"{lead}{name}": ("SIDE", corner) for lead in ("", "at the ", "on the ")}
        depth, side = corner.split()
        found |= {f"at the {depth} on the {side}": ("SIDE", corner), f"on the {side} at the {depth}": ("SIDE", corner)}
    return found


def _counted() -> dict[str, Entry]:
    """From where things are counted ("from the left")."""
    found: dict[str, Entry] = {}
    for side, other in (("right", "left"), ("left", "right")):
        leads = ("", "counting ", "along ", "in ", "starting ", "as seen ")
        found |= {f"{lead}from the {side}": ("COUNTED", side) for lead in leads}
        found |= {f"from {side} to {other}": ("COUNTED", side), f"from {side}": ("COUNTED", side)}
    return found


CLOSED: dict[str, Entry] = {
    **_one_thing(),
    **_several_things(),
    **{phrase: ("PREP", name) for phrase, name in RELATIONS.items()},
    **{f"over {p}": ("PREP", n) for p, n in RELATIONS.items()},
    **{f"directly {p}": ("PREP", n) for p, n in RELATIONS.items() if n not in ("inside",)},
    **{f"right {p}": ("PREP", n) for p, n in RELATIONS.items() if n not in ("inside", "right_of", "left_of")},
    **{f"just {p}": ("PREP", n) for p, n in RELATIONS.items() if n not in ("inside",)},
    **_said("BETWEEN", "between"),
    **_said("NEAR", "nearest_to"),
    **_said("NEAR", "farthest_from"),
    **same(("FROM", None), "from, off, off of, out of"),
    **same(("OF", None), "of"),
    **same(("TO", None), "to, over to, up to"),
    **same(("TOWARD", None), "toward, towards, closer to, nearer to, nearer, in the direction of"),
    **same(("AWAYFROM", None), "away from, farther away from, further away from, farther from, further from"),
    **same(("WITH", None), "with"),
    **same(("FOR", None), "for"),
    **same(("AS", None), "as"),
    **same(("NOT", None), "not"),
    **same(("INSTEAD", None), "instead of, in place of, rather than, in lieu of"),
    **_same_color(),
    **same(("LIKE", None), "like, similar to, same as, identical to, matching"),
    **same(("GOES", None), "has to go, have to go, needs to go, need to go, must go, should go, can go, "
            "has got to go, have got to go, gotta go, may go, ought to go, can be removed, can be deleted"),
    **same(("AWAY", None), "away, out"),
    **same(("AROUND", None), "around, round, the other way around, the other way"),
    **same(("UPSIDE", None), "upside down, on its head"),
    **same(("APART", None), "apart"),
    **same(
        ("BUT", None),
        "but, but not, except, except for, excepting, excluding, other than, apart from, aside from, besides, "
        "but leave, but keep, but do not touch, save for, bar, barring, though not, although not, minus, and not, "
        "without touching, without removing, "
        "without moving, without deleting, without changing, without affecting, without including, leaving, leaving "
        "out, keeping, not counting, not including, other then, but never",
    ),
    **same(("AND", None), "and, &, and also, as well as, plus, along with, together with, and then"),
    **_said("SPOT", "corner", alone=True),
    **_corners(),
    **_said("SPOT", "center", alone=True),
    **{
        f"in the {middle} of the {group}": ("SPOT", "center")
        for middle in ("middle", "centre", "center")
        for group in ("row", "line", "group", "bunch", "lot", "trio", "three", "five", "set")
    },
    **_said("CENTER", "center"),
    **same(("SIDE", "leftmost"), "on the left, on the left side, on the left hand side, at the left, on my left, "
            "on the far left, to the far left, on the very left, farthest to the left, furthest to the left, "
            "furthest left, "
            "farthest left, far left, to the very left, on the extreme left, at the far left, at the left end, on "
            "the left end, "
            "at the left hand end, on the left hand end, to my left, at the left side, over on the left"),
    **same(("SIDE", "rightmost"), "on the right, on the right side, on the right hand side, at the right, "
            "on my right, on the far right, to the far right, on the very right, farthest to the right, "
            "furthest to the right, furthest right, farthest right, far right, to the very right, on the extreme "
            "right, at the "
            "far right, at the right end, on the right end, at the right hand end, on the right hand end, to my right, "
            "at the right side, over on the right"),
    **same(("SIDE", "nearest"), "in front, at the front, in the front, closest to me, nearest to me, nearest me, "
            "closest to the camera, nearest to the camera, in the foreground, nearest to the viewer, nearest the "
            "viewer, closest to the viewer, nearest the camera, closest to us, nearest to us, at the very front"),
    **same(("SIDE", "farthest"), "at the back, in the back, farthest from me, furthest from me, farthest away, "
            "furthest away, in the background, farthest from the viewer, furthest from the viewer, farthest from the "
            "camera, furthest from the camera, farthest from us, furthest from us, at the very back"),
    **same(("SIDE", "highest"), "at the top, on the top"),
    **same(("SIDE", "lowest"), "at the bottom, on the bottom"),
    **same(("SIDE", "leftmost"), "on the left of the room, on the left side of the room"),
    **same(("SIDE", "rightmost"), "on the right of the room, on the right side of the room"),
    **same(("SIDE", "nearest"), "at the front of the room, in the front of the room"),
    **same(("SIDE", "farthest"), "at the back of the room, in the back of the room"),
    **same(("NOWHERE", None), "to the back of the room, to the front of the room, to the left of the room, "
            "to the right of the room, to the left side of the room, to the right side of the room, "
            "to the opposite side of the room, "
            "to the other side of the room, to the side, on its side, on its back, on their side, on their sides, "
            "side by side, on either side of, on each side of, on both sides of, every other, every second, "
            "in a line, in a circle, in a row, in rows"),
    **_counted(),
    **same(("DIR", "left"), "to the left, left, leftward, leftwards, to my left, over to the left, further left, "
            "to the left side, more to the left, further to the left, farther left, over left"),
    **same(("DIR", "right"), "to the right, right, rightward, rightwards, to my right, over to the right, further "
            "right, to the right side, more to the right, further to the right, farther right, over right"),
    **same(("DIR", "forward"), "forward, forwards, away from me, away from the viewer, away from the camera, "
            "further "
            "away, farther away, to the back, back, further back, farther back, toward the back, towards the back"),
    **same(("DIR", "backward"), "backward, backwards, toward me, towards me, closer to me, nearer to me, toward the "
            "viewer, toward the camera, towards the camera, towards the viewer, to the front, closer, nearer, to me, "
            "closer to the camera, closer to the viewer, toward the front, towards the front"),
    **same(("DIR", "up"), "up, upward, upwards, higher up, further up"),
    **same(("DIR", "down"), "down, downward, downwards, lower down, further down"),
    **_axes(),
    **same(("CLOCK", -1), "clockwise"),
    **same(("CLOCK", 1), "counterclockwise, counter clockwise, anticlockwise, anti clockwise"),
    **same(("DEGREE", "little"), "a bit, a little, a little bit, slightly, somewhat, a touch, a tad, a smidge, "
            "a tiny bit, a hair, ever so slightly, a wee bit, a smidgen, a fraction, a whisker, a notch, a shade, "
            "a tad bit, "
            "a teeny bit, a teensy bit, just a bit, just a little, a wee touch, a bit of a way"),
    **same(("DEGREE", "much"), "much, a lot, way, far, considerably, significantly, a great deal, a good deal, "
            "substantially, lots, so much, very much, a good bit, a fair bit, quite a bit, quite a lot, a whole "
            "lot, loads, heaps, tons, "
            "miles, a fair amount, a hell of a lot"),
    **same(("MORE", None), "more, even more"),
    **same(("LESS", None), "less, even less"),
    **same(("LIGHT", "darker"), "darker"),
    **same(("LIGHT", "lighter"), "lighter, brighter, paler"),
    **same(("LIGHT", "warmer"), "warmer"),
    **same(("LIGHT", "cooler"), "cooler, colder"),
    **same(("LIGHT", "more_saturated"), "more vivid, more saturated, more colorful, more colourful, more vibrant, "
            "more intense, richer"),
    **same(("LIGHT", "less_saturated"), "less vivid, less saturated, less colorful, less colourful, less vibrant, "
            "less intense, more muted, duller, more washed out"),
    **same(("TOWARDHUE", "blue"), "bluer"), **same(("TOWARDHUE", "red"), "redder"),
    **same(("TOWARDHUE", "green"), "greener"), **same(("TOWARDHUE", "yellow"), "yellower"),
    **same(("TOWARDHUE", "pink"), "pinker"), **same(("TOWARDHUE", "brown"), "browner"),
    **same(("TOWARDHUE", "white"), "whiter"), **same(("TOWARDHUE", "black"), "blacker"),
    **same(("TOWARDHUE", "gray"), "greyer, grayer"),
    **same(("GROWN", ("all", True)), "bigger, larger, huger"),
    **same(("GROWN", ("all", False)), "smaller, tinier, littler"),
    **same(("GROWN", ("height", True)), "taller"),
    **same(("GROWN", ("height", False)), "shorter, flatter"),
    **same(("GROWN", ("width", True)), "wider, broader, longer"),
    **same(("GROWN", ("width", False)), "narrower, slimmer, thinner"),
    **same(("GROWN", ("depth", True)), "deeper"),
    **same(("PROP", "all"), "size, scale, in size, dimensions"),
    **same(("PROP", "height"), "height, in height"),
    **same(("PROP", "width"), "width, length, in width, in length"),
    **same(("PROP", "depth"), "depth, in depth"),
    **same(("COLORWORD", None), "colour, color, colours, colors, paint, hue, shade, colored, coloured, tint"),
    **same(("ASHADE", None), "a shade of, a nice shade of, a coat of, a lick of, a dash of, a nice coat of, a fresh "
            "coat of, a new coat of, some, a fresh lick of, a layer of, a splash of, a touch of"),
    **same(("OPACITYWORD", True), "opacity, alpha"),
    **same(("OPACITYWORD", False), "transparency"),
    **same(("CLEARLY", 0.3), "transparent, see through, translucent"),
    **same(("CLEARLY", 0.5), "semi transparent, half see through"),
    **same(("CLEARLY", 0.0), "invisible, completely transparent, fully transparent, totally transparent, hidden"),
    **same(("OPAQUE", None), "opaque, visible"),
    **same(("GONE", None), "gone, disappear, vanish, go away, removed, deleted, thrown out, thrown away, taken away, "
            "taken out, erased"),
    **same(("TOBE", None), "to be, be, become, look, to look"),
    **same(("SHOULD", None), "should be, needs to be, need to be, must be, has to be, have to be, ought to be, "
            "should become, should look, should all be, must all be, should both be, need to all be, have to all be, "
            "ought to all be, want to be, could be, would be better, would look better, would look nicer"),
    **same(("COPIES", None), "copy of, copies of, duplicate of, duplicates of, clone of, clones of, more copies of, "
            "another copy of, copies from, more of"),
    **same(("REL", None), "that is, that are, which is, which are, who is, that was, which was, that were"),
    **_standing(),
    **same(("DET", "def"), "the, my, our, your, this, that, these, those, the very, the whole, the entire"),
    **same(("DET", "indef"), "a, an, another, some, one more, a new, some new"),
    **same(("DET", "all"), "every last, every last one of the, every one of those, each one of the"),
    **same(("DET", "all"), "all, every, each, all the, all of the, every single, every one of the, each of the, "
            "all these, all those, all of these, all of those, all my, all of my, any and all"),
    **same(("DET", "both"), "both, both the, both of the"),
    **same(("DET", "any"), "any, one of the, any of the, any one of the, either, either of the"),
    **same(("OTHER", None), "other, remaining"),
    **same(("PRON", "it"), "it, them, them all, them both, it all, this one, that one, these ones, those ones, "
    "the same, the same one, "
            "the same thing, the same object, the same ones, this thing, that thing, all of them, all of it, "
            "both of them, each of them, the selection, the selected, the selected object, the selected objects, "
            "the current selection, my selection, the copy, the copies, the duplicate, the clone, the new one, "
            "the new ones, the selected one, the whole thing, him"),
    **same(("LIKEIT", None), "like it, like this, like that, like this one, like that one, like these, like those, "
            "like them, just like it"),
    **same(("PRON", "any"), "one of them, any of them, either of them"),
    **same(("EVERYTHING", None), "whatever is, all things, all objects, every object, all the objects"),
    **same(("EVERYTHING", "scene"), "what is, everything, anything, the scene, "
            "the whole scene, the entire scene, the complete "
            "scene, the full scene, all of the scene, the whole room, the entire room, everything in the scene, "
            "the whole picture, the whole image, the whole capture, the whole model, the whole splat, "
            "the entire model, my scene, this scene, the scene as a whole, all of this scene, whole scene, "
            "entire scene, everything there is, everything here, this whole scene, my whole scene, my entire scene"),
    **same(("EVERYTHING", "else"), "everything else, the rest, all the rest, all else, anything else, "
            "the rest of the scene, the rest of the room, the rest of it"),
    **same(("ONE", False), "one"),
    **same(("ONE", True), "ones"),
    **same(("OTHERS", None), "the others, all the others, all others, the other ones, all the other ones, both of "
                             "the others, both the "
            "others, both others, all of the others, each of the others, both of the other ones, both other ones"),
    **same(("THING", False), "thing, object, item, part, piece, area, region, element, bit"),
    **same(("THING", True), "things, objects, items, parts, pieces, areas, regions, elements, bits, stuff"),
}  # fmt: skip

# Phrases about "the room" are accepted for other places as well.
_PLACES = ("garden", "patio", "yard", "terrace", "kitchen", "office", "bedroom", "living room", "cafe", "shop", "space")
CLOSED |= {
    phrase.replace("the room", f"the {place}"): entry
    for phrase, entry in list(CLOSED.items())
    if phrase.endswith("of the room")
    for place in _PLACES
}

# Attributes: used before a noun ("the left chair"), or after a determiner without a noun ("the largest").
ATTRIBUTES: dict[str, Entry] = {
    **same(("SUP", "largest"), "largest, biggest, greatest"),
    **same(("SUP", "smallest"), "smallest, tiniest, littlest"),
    **same(("SUP", "tallest"), "tallest"),
    **same(("SUP", "shortest"), "shortest"),
    **same(("SUP", "nearest"), "nearest, closest, front, foremost, frontmost, front most"),
    **same(("SUP", "farthest"), "farthest, furthest, far, back, rear, rearmost, most distant, backmost, hindmost"),
    **_corner_attributes(),
    **same(("SUP", "leftmost"), "leftmost, far left, furthest left, left most, left, left hand, left side"),
    **same(("SUP", "rightmost"), "rightmost, far right, furthest right, right most, right, right hand, right side"),
    **same(("SUP", "highest"), "highest, topmost, top, uppermost, upper"),
    **same(("SUP", "lowest"), "lowest, bottom, bottommost, lower"),
    **same(("SUP", "middle"), "middle, centre, center, central, middlemost"),
    **same(("SIZE", "small"), "small, little, tiny, smaller"),
    **same(("SIZE", "large"), "big, large, huge, giant, enormous, massive, bigger, larger"),
    **same(("SIZE", "tall"), "tall, high, taller"),
    **same(("SIZE", "short"), "short, low, shorter"),
    **same(("SIZE", "wide"), "wide, long, broad, wider, longer"),
    **same(("SIZE", "narrow"), "narrow, thin, slim, skinny, narrower"),
}  # fmt: skip

# Filler: dropped at any position.
FILLER = phrases(
    "please, kindly, just, now, actually, for me, if you can, if possible, if you could, would you, will you, "
    "thanks, thank you, thank you very much, ok, okay, well, so, hey, hi, hello, also, as well, right now, "
    "straight away, go ahead and, from the scene, in the scene, from the room, in the room, from this scene, "
    "in this scene, in here, from here, out of here, out of the room, out of the scene, in the picture, "
    "in the image, in the view, where it is, where they are, right where it is, right where they are, in peace, "
    "from the picture, from the image, really, simply, instead, over there, "
    "you see, you know, as it is now, as it is, as before, as now, than it is now, than before, than it is, "
    "than now, than it was, as it was, as they are, as they are now, than they are, currently, too, if you "
    "would, if you will, could you, can you, would you please, for now, from the view, this time, alone, "
    "somewhere, mate, buddy, my friend, finally, lastly, afterwards, after that, entirely, altogether, "
    "even, still, "
    "current, shall we, shall you, anymore, any more, any longer, if you do not mind, if that is okay, if that is ok, "
    "not that one, not this one, not that, or so, or thereabouts, hey scenewright, scenewright, "
    "will ya, asap, quickly please, darling, dear, thank you so much, many thanks, cheers, this instant, "
    "at once, immediately, already, for good"
)

# Dropped before a preposition ("the lamp standing on the desk").
PARTICIPLES = bag(
    "standing sitting located placed lying hanging situated positioned mounted leaning resting "
    "hung propped found seated attached "
    "tucked kept parked"
)
# What is said of a thing behind its name, never part of the name: "the sofa painted blue".
DONE = bag(
    "painted moved removed deleted turned rotated recolored recoloured coloured colored placed put shifted raised "
    "lowered "
    "used stood sat hung lay went "
    "enlarged shrunk scaled resized hidden swapped replaced duplicated copied cloned tinted dyed darkened lightened "
    "brightened flipped spun twisted pushed pulled slid brought taken thrown gone doubled halved centred centered "
    "erased"
)

# Dropped at the start of a clause that continues ("no, darker").
INTERJECTIONS = bag("no yes yeah yep hmm oh ok okay and so but well maybe perhaps")

# Before a verb in -ing ("would you mind removing the mug").
GERUND_OPENERS = phrases(
    "would you mind, do you mind, you mind, mind, could you try, how about, what about, what if we try, try, start "
    "by, consider"
)

# Polite phrases: dropped at the start of a clause, before its verb.
POLITE = phrases(
    "could you, can you, would you, will you, could we, can we, shall we, i would like you to, i would like to, "
    "i want you to, i want to, i need you to, i need to, we need to, we want to, let us, let me, you should, "
    "you can, we should, you could, go and, try to, help me to, help me, i would love you to, i would love to, "
    "may i ask you to, i wish you to, i am going to, we are going to, you have to, i have to, you must, "
    "could i ask you to, is it possible to, would it be possible to, is it possible for you to, could you possibly, "
    "would you be able to, are you able to, would you be so kind as to, do you think you could, be so kind and, "
    "could i, can i, could i please, may i, i was wondering if you could, i wonder if you could, be a dear and, be so "
    "good as to, go ahead, third, thirdly, fourth, and third, while you are at it, one more thing, "
    "why do not you, why do not we, you may, you might, how about you, feel free to, make sure to, be sure to, "
    "i would rather you, i would prefer to, i would prefer you to, can i get you to, could i get you to, "
    "could you please, can you please, would you please, will you please, would you kindly, could you kindly, "
    "first, first of all, second, secondly, firstly, to start, "
    "to begin with, next, then, finally, lastly, after that, afterwards, and, so, but, next up, proceed to, "
    "i think you should, maybe, perhaps, oh, uh, um, hmm, alright, all right, right, good, great, "
    "cool, perfect, nice, no, yes, yeah, yep, sure"
)

# Never part of a noun: function words, and words whose loss would change the meaning.
STRUCTURE = bag(
    "if unless until while because since when whenever although though who whom whose which what where why how "
    "that than then so last next previous former latter or nor yet no without "
    "like about through across during via be is are was were am been being do does "
    "did done have has had can could will would shall should may might must i me we us you he she they him her "
    "very quite rather too almost nearly only even ever never always often once again here there facing around "
    "nicer better "
    "opposite beyond past before after during per same such something someone somebody neither "
    "much many few several enough whichever whatever "
    "more less most least not none nothing nobody except but and to of from off with for as by in on at into onto "
    "it its them their itself themselves myself another every each all both any some else maybe perhaps together apart "
    "sorry yeah yep nope okay thanks hello stays remains belongs gets"
)
ADVERB_NOUNS = bag(
    "telly brolly trolly lily fly assembly jelly belly butterfly family dolly doily holly curly woolly ply july "
    "bully gully folly supply "
    "wily oily bubbly cuddly friendly"
)
ASKING = bag("tell describe list count explain name ask say answer imagine remember guess")


def table(*tables: dict[str, Entry]) -> dict[tuple[str, ...], Entry]:
    """The tables merged and keyed by tuples of words."""
    return {tuple(phrase.split()): entry for t in tables for phrase, entry in t.items()}


VERB_PHRASES = table(VERBS)
CLOSED_PHRASES = table(CLOSED)
ATTRIBUTE_PHRASES = table(ATTRIBUTES)
UNSUPPORTED_PHRASES = {tuple(p.split()): reason for p, reason in UNSUPPORTED.items()}
LONGEST = max(map(len, (*VERB_PHRASES, *CLOSED_PHRASES, *ATTRIBUTE_PHRASES, *FILLER, *POLITE)))
