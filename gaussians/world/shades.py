"""Colours named after things: of two or more words ("fire engine red", "bottle green"), and of one ("mahogany").

The first are read as the plain name that they are a shade of; names that `gaussians.color` knows keep their own value
there. The second have a value each. Most are nouns, so only a text that is known to be a colour is looked up in them.
"""

from __future__ import annotations

from collections.abc import Sequence

_OF: dict[str, str] = {
    "red": "fire engine, fire truck, brick, pillar box, post box, letter box, phone box, cherry, blood, ruby, ketchup, "
    "apple, rose, poppy, lipstick, ferrari, strawberry, berry, signal, london bus, candy apple, chili, chilli, "
    "cardinal, "
    "raspberry, beetroot, traffic light, stop sign, santa",
    "dark red": "ox blood, oxblood, brick dust, mahogany, garnet",
    "blue": "cobalt, electric, ocean, sea, petrol, ink, denim, cornflower, peacock, royal, lapis, delft, prussian, "
    "air force, cerulean, china, cyan, marine, ultramarine, french, oxford, klein, police, jeans, bluebell",
    "light blue": "baby, duck egg, ice, icy, pastel, robin egg, robin 's egg, sky, powder, arctic",
    "green": "grass, apple, pea, emerald, jade, moss, leaf, frog, kermit, shamrock, kelly, fern, avocado, parrot, "
             "lizard, "
    "pistachio, pear, cactus, pool table, billiard, salad, spinach, park bench, jungle, army, khaki, irish, clover",
    "dark green": "bottle, racing, british racing, hunter, pine, ivy, spruce, fir, holly, christmas tree, forest",
    "light green": "pastel, mint, sea foam, seafoam",
    "yellow": "lemon, canary, sunshine, sunflower, banana, mustard, corn, butter, buttercup, daffodil, egg yolk, "
    "school bus, taxi, cab, sun, bumblebee, custard, post it, primrose, honey, saffron, sunny",
    "orange": "burnt, pumpkin, tangerine, carrot, traffic cone, flame, sunset, safety, clementine, mandarin, amber",
    "pink": "bubblegum, bubble gum, barbie, candy, candy floss, flamingo, fuchsia, salmon, blush, dusty, rose, "
    "piglet, rosy, shocking, cotton candy, peony, shell",
    "purple": "royal, grape, aubergine, eggplant, plum, lavender, violet, cadbury, imperial, blackberry, amethyst",
    "brown": "chocolate, coffee, chestnut, nut, walnut, mocha, cocoa, caramel, cinnamon, tobacco, hazelnut, "
             "saddle, conker",
    "gray": "battleship, gunmetal, gun metal, steel, mouse, elephant, concrete, charcoal, stone, dove, slate, silver, "
    "iron, pebble, storm, graphite, cement",
    "black": "jet, pitch, coal, raven, midnight, ebony, ink, inky, piano, soot, matt, matte, gothic, onyx, stealth",
    "white": "snow, pure, brilliant, chalk, milk, milky, lily, pearl, paper, bone, arctic, ivory, brilliant pure, "
             "polar, "
    "crisp, clean, bright, cloud, porcelain, hospital, eggshell, matt, matte",
    "beige": "sand, sandy, oatmeal, biscuit",
}  # fmt: skip
_SPELT = {"gray": ("gray", "grey")}


def _table() -> dict[tuple[str, ...], str]:
    found: dict[tuple[str, ...], str] = {}
    for plain, modifiers in _OF.items():
        base = plain.split()[-1]
        for name in _SPELT.get(base, (base,)):
            for modifier in modifiers.split(","):
                found[(*modifier.split(), name)] = plain
    return found


SHADES = _table()
_LONGEST = max(map(len, SHADES))


def shade_at(texts: Sequence[str], i: int) -> tuple[str, int] | None:
    """The plain colour of the shade at `i` and its number of words, None if there is none."""
    for taken in range(min(_LONGEST, len(texts) - i), 1, -1):
        if (plain := SHADES.get(tuple(texts[i : i + taken]))) is not None:
            return plain, taken
    return None


# Names of `PAINTS` that name nothing else in a room, so that they need no other word beside them.
DYES = frozenset((
    "saffron", "umber", "sepia", "auburn", "anthracite", "graphite", "gunmetal", "vermilion", "cinnabar", "carmine",
    "claret", "oxblood", "mulberry", "pistachio", "cerulean", "cobalt", "ultramarine", "periwinkle", "amethyst",
    "wisteria", "mocha", "platinum",
))  # fmt: skip

# Typical values of what the names say: woods, stones, foods, plants, metals and dyes.
PAINTS: dict[str, str] = {
    "lemon": "#f5e64c", "canary": "#ffe94d", "honey": "#e0a43a", "saffron": "#f4c430", "banana": "#ffe135",
    "butter": "#f6e7a0", "vanilla": "#f3e5ab", "champagne": "#f2dfb8", "magnolia": "#f4ecdc", "eggshell": "#f0ead6",
    "pearl": "#eae6db", "oatmeal": "#d9cbb0", "straw": "#e0c878", "camel": "#c19a6b", "caramel": "#b7703a",
    "cinnamon": "#b5652b", "ginger": "#b5651d", "hazel": "#a97142", "hazelnut": "#a5784e", "auburn": "#8c3b24",
    "umber": "#6b4a34", "sepia": "#6f4b2f", "coffee": "#6f4e37", "mocha": "#7a5a45", "espresso": "#4b3228",
    "cocoa": "#6b4432", "chestnut": "#7b4a30", "mahogany": "#6e2f22", "cherry": "#a52a38", "teak": "#9c6b3f",
    "pine": "#d2a76a", "ash": "#b8b4ab", "ebony": "#2b2522", "jet": "#1a1a1c", "onyx": "#25262a", "coal": "#2b2b2d",
    "graphite": "#45474a", "anthracite": "#383e42", "gunmetal": "#4a5258", "slate": "#65737e", "stone": "#a8a295",
    "concrete": "#95938f", "smoke": "#a7a9ac", "steel": "#9aa3aa", "chrome": "#c8ccd0", "platinum": "#dcdad5",
    "brick": "#a8503c", "vermilion": "#e34234", "cinnabar": "#e44d2e", "carmine": "#a0132b", "cardinal": "#b5192f",
    "claret": "#7f1734", "oxblood": "#5a1a1c", "mulberry": "#8b3b5e", "raspberry": "#c1264f", "strawberry": "#e6435c",
    "tangerine": "#f28500", "pumpkin": "#e8751a", "avocado": "#6d7f2e", "pistachio": "#b4cf8e", "moss": "#6f7f3a",
    "fern": "#5b8a4b", "forest": "#22652f", "hunter": "#355e3b", "bottle": "#0f4d3a", "petrol": "#17606b",
    "cerulean": "#2a82b8", "cobalt": "#1f4fa8", "ultramarine": "#2330a0", "sky": "#87ceeb", "ice": "#d4ecf2",
    "midnight": "#191f45", "periwinkle": "#a3a8e6", "wisteria": "#b79fd6", "heather": "#a58bb5", "grape": "#6a2f80",
    "aubergine": "#46233f", "eggplant": "#4a2545", "amethyst": "#8f63b8", "blush": "#eec2bf", "bubblegum": "#f79ac0",
    "flamingo": "#f58aa5", "khaki": "#b8aa72", "mud": "#70543e", "snow": "#f8fafa", "milk": "#f7f5ee",
    "chalk": "#f2f1ea",
}  # fmt: skip
# Words before a colour that name its surface or its mood, and the qualifier of `gaussians.color` that they come to.
FINISHES: dict[str, str] = {
    **dict.fromkeys(("matt", "matte", "glossy", "gloss", "shiny", "metallic", "satin", "plain", "pure", "solid"), ""),
    **dict.fromkeys(("medium", "mid", "warm", "cool", "cold", "classic", "natural", "true", "real"), ""),
    **dict.fromkeys(("pastel", "soft", "muted", "dusty", "faded", "washed out", "powdery", "chalky", "baby"), "pale"),
    **dict.fromkeys(("neon", "fluorescent", "electric", "hot", "intense", "strong", "saturated", "rich"), "vivid"),
    "darker": "dark", "lighter": "light", "paler": "pale", "brighter": "bright", "deeper": "deep", "darkish": "dark",
}  # fmt: skip
