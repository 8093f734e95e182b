"""The verb table: maps each phrase that begins a command to its word class, or to why no operation does it.

Phrases behind a verb are in lexicon.py; the rules that turn verbs into operations are in meaning/.
"""

from __future__ import annotations

from typing import Any

Entry = tuple[str, Any]  # word class, value


def same(value: Any, phrases: str) -> dict[str, Any]:
    """A table that maps each of the phrases, separated by commas, to the same value."""
    return {p.strip(): value for p in phrases.split(",")}


def _of_the_frame() -> dict[str, Entry]:
    """What states the up axis, the origin or the scale of the scene."""
    found: dict[str, Entry] = {}
    for axis in ("x", "y", "z"):
        for sign, said in (("", ""), ("-", "minus "), ("-", "negative "), ("-", "-")):
            found |= same(
                ("UPAXIS", sign + axis),
                f"make {said}{axis} up, make {said}{axis} the up axis, set the up axis to {said}{axis}, set up to "
                f"{said}{axis}, convert to {said}{axis} up, use {said}{axis} up, use {said}{axis} as up, make the "
                f"scene {said}{axis} up, turn the scene {said}{axis} up, convert the scene to {said}{axis} up",
            )
    for put in ("put", "set", "move", "place", "shift"):
        found[f"{put} the origin"] = ("ORIGIN", None)
        for to in ("on", "to", "at", "onto"):
            found[f"{put} the origin {to} the floor"] = found[f"{put} the origin {to} the ground"] = ("ORIGIN", "floor")
        for to in ("in", "to", "at", "into"):
            for middle in ("center", "centre", "middle"):
                for of in ("", " of the scene", " of everything", " of the room"):
                    found[f"{put} the origin {to} the {middle}{of}"] = ("ORIGIN", "middle")
    scenes = ("the scene", "the whole scene", "everything")
    found |= same(("UNITIS", None), "one unit is, 1 unit is, a unit is, one scene unit is, 1 scene unit is, one unit "
                  "equals, 1 unit equals, the scale is")  # fmt: skip
    return found | {f"{scale} {of} so that": ("SCALESO", None) for scale in ("scale", "resize") for of in scenes}


VERBS: dict[str, Entry] = {
    **_of_the_frame(),
    **same(
        ("DELETE", None),
        "delete, remove, erase, eliminate, discard, take away, take out, get rid of, throw away, throw out, "
        "chuck out, "
        "chuck, chuck away, take down, lose, clear away, zap, kill, nuke, dump, ditch, trash, scrap, "
        "destroy, banish, "
        "dispose of, do away with, bin, axe, purge, expunge, wipe out, rub out, delete away, get out, toss, toss out, "
        "yank, yank out, rip out, oust, evict, vaporize, obliterate, get shot of, junk, kick out, boot out, strip out, "
        "toss away, chuck in the bin, throw in the trash, be rid of, remove away, rid us of, hoover up, "
        "cut off, cut away, cut out, slice off, crop away, crop out, crop off, trim away, trim off, clip off, "
        "chop off, saw off, yeet, whisk away, cart off, cart away, haul away, cull, vanish, sling out, lob out, "
        "shift out of here, "
        "strip away, whip out, whip away",
    ),
    **same(("CLEAR", None), "clear, clear off, clear out"),
    **same(("MERGE", None), "merge, combine, unite, join, join up, fuse, group, group together, treat, regard"),
    **same(("SPLIT", None), "split, split up, divide, separate, break up, ungroup"),
    **same(("DROP", None), "drop"),
    **same(
        ("TAKE", None),
        "take, throw, get, pick up, grab, nick, pinch, swipe, snatch, nab, whip, fetch, steal, borrow, retrieve, "
        "scoop up, "
        "hoick",
    ),
    **same(
        ("SELECT", None),
        "select, highlight, find, find me, locate, pick, pick out, choose, show me, show, mark, point out, point to, "
        "identify, focus on, outline, click, click on, look for, spot, search for, "
        "you want, you are looking for, you need to select, you want to choose, you want to select, you should select",
    ),
    **same(
        ("ISOLATE", None),
        "isolate, keep only, keep just, only keep, just keep, just keep only, show only, show just, show me only, "
        "only show, "
        "only show me, leave only, leave just, leave nothing but, keep nothing but, show nothing but, "
        "single out, solo",
    ),
    **same(("CROP", None), "crop, crop in, crop down, trim, clip, cut down, cut, crop it, crop tightly"),
    **same(
        ("CROP", "around"),
        "crop around, crop in on, crop in to, crop into, crop tightly around, cut around, crop closely around",
    ),
    **same(("HIDE", None), "hide, conceal, fade out"),
    **same(("FADE", None), "fade"),
    **same(
        ("PAINT", None),
        "paint, colour, color, recolor, recolour, dye, repaint, stain, spray paint, spray, coat, re paint, re colour, "
        "re color, colour in",
    ),
    **same(("TINT", None), "tint"),
    **same(("MAKE", None), "make, render, let"),
    **same(("TURN", None), "turn"),
    **same(("CHANGE", None), "change, convert, transform, set the, adjust"),
    **same(("GIVE", None), "give"),
    **same(("APPLY", None), "slap, apply, splash"),
    **same(
        ("SAME", None),
        "do the same to, do the same for, do the same with, do the same thing to, do the same thing with, same for, "
        "same with, same to, the same for, the same with, the same to, the same goes for, same goes for, same thing "
        "for, same thing with, do that to, do this to, do it to, do that with, do it with, do likewise to, do "
        "likewise with, likewise for, likewise with, likewise, ditto for, ditto, repeat that for, repeat this for, "
        "repeat that with, repeat it for, repeat for, apply the same to, apply that to, do that for, do it for",
    ),
    **same(
        ("WANT", None),
        "want, need, i want, i would like, i need, we want, we need, i would love, i wish for, i would love for, "
        "i would like for, we would like, we would love, have, let us have, i fancy, could do with",
    ),
    **same(("ADJUST", ("darker", None)), "darken"),
    **same(("ADJUST", ("lighter", None)), "lighten, brighten, brighten up, lighten up"),
    **same(("ADJUST", ("less_saturated", None)), "desaturate, tone down, mute"),
    **same(("ADJUST", ("more_saturated", None)), "saturate"),
    **same(("ADJUST", ("warmer", None)), "warm up, warm"),
    **same(("ADJUST", ("cooler", None)), "cool down, cool"),
    **same(
        ("MOVE", None),
        "move, shift, slide, push, pull, bring, shove, drag, scoot, nudge, relocate, transfer, carry, reposition, "
        "move over, shift over, budge, haul, scooch, heave, lug, send, edge, jog, scootch, wheel, roll over, "
        "move along, slide over, shuffle, shunt, ease, inch, budge up, budge along, swing, swivel over, rock over, "
        "walk, bump, bump over, kick, hoof, lob over, roll along, trundle, steer, guide",
    ),
    **same(("CENTERING", None), "center, centre"),
    **same(("KEEP", None), "keep, leave"),
    **same(("RAISE", "up"), "raise, lift, elevate, hoist, lift up"),
    **same(("RAISE", "down"), "lower"),
    **same(
        ("PUT", None),
        "put, place, set, set down, put down, stick, position, pop, lay, stand, hang, hang up, mount, rest, park, "
        "stack, plop, install, arrange, put up, lean, plonk, plunk, plunk down, plonk down, plop down, sit, deposit, "
        "situate, bung, sling, whack, pop down, tuck, prop, prop up, plant down, shove in, wedge, pin, nestle",
    ),
    **same(
        ("ADD", None),
        "add, insert, create, generate, spawn, introduce, bring in, throw in, put in, drop in, add in, give me, "
        "place down, include, plant, get me, fetch me, bring me",
    ),
    **same(("COPY", None), "copy, clone, duplicate, replicate"),
    **same(("REPLACE", None), "replace, swap out, switch out"),
    **same(("SWAP", None), "swap, exchange, switch, trade, trade in, interchange, swap around, switch around"),
    **same(("SUBSTITUTE", None), "substitute"),
    **same(("ROTATE", None), "rotate, spin, revolve, pivot, twist, swivel, spin round, rotate round, rotate around"),
    **same(("TURNROUND", None), "turn around, spin around, turn round"),
    **same(("FACE", None), "face, aim, orient, point"),
    **same(("STRETCH", None), "stretch, elongate"),
    **same(("FLIP", None), "flip, flip over, turn over, topple, invert"),
    **same(("TILT", None), "tilt, tip, roll"),
    **same(("SCALE", None), "scale, resize, rescale"),
    **same(
        ("GROW", ("all", True)),
        "enlarge, grow, expand, blow up, magnify, size up, scale up, upscale, upsize, supersize, embiggen, beef up, "
        "bump up, bulk up, pump up",
    ),
    **same(
        ("GROW", ("all", False)), "shrink, size down, downsize, scale down, downscale, minify, shrink down, bump down"
    ),
    **same(("GROW", ("prop", True)), "increase"),
    **same(("GROW", ("prop", False)), "decrease, reduce"),
    **same(("GROW", ("width", True)), "widen, broaden, lengthen"),
    **same(("GROW", ("width", False)), "narrow"),
    **same(("GROW", ("height", True)), "heighten"),
    **same(("GROW", ("height", False)), "flatten, shorten"),
    **same(("MULTIPLY", 2.0), "double"),
    **same(("MULTIPLY", 3.0), "triple, treble"),
    **same(("MULTIPLY", 4.0), "quadruple"),
    **same(("MULTIPLY", 0.5), "halve"),
}

BLURS = "how sharp a picture is belongs to the camera, not to the scene: make it darker, paler or transparent instead"
TO_ALIGN = "things cannot be lined up with each other in one step"

# Verbs that no operation carries out. They are listed so that the refusal gives the reason, not "not understood".
UNSUPPORTED: dict[str, str] = {
    **same("moving parts and switches cannot be operated", "open, close, shut, turn on, turn off, switch on, "
            "switch off, unlock, lock, fold, unfold, light up, dim"),
    **same("only whole scenes of what is there can be edited, not what happens to it", "break, smash, bend, burn, "
            "fill, empty, start, start up, drive, ring, plug in, unplug, water, feed, charge, knock, knock down, "
            "demolish, "
            "tear down, mow, inflate, clean, wipe, wash, dust, polish, animate, cook, play, eat, wear, throw a party"),
    **same("what was hidden comes back with undo", "unhide, reveal, restore, bring back"),
    **same("say what to select instead", "clear the selection, invert the selection, clear selection, "
            "invert selection, deselect, unselect, select none, select nothing, reset the selection"),
    **same("objects cannot be renamed", "rename, label"),
    **same(TO_ALIGN, "align, line up"),
    **same(BLURS, "blur, blur out, defocus, unblur, deblur, sharpen, sharpen up"),
}  # fmt: skip
