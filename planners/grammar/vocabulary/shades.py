"""Colour names of two or more words whose first words are things: "fire engine red", "bottle green", "duck egg blue".

Each is read as the plain name that it is a shade of; names that `gaussians.color` knows keep their own value there.
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
