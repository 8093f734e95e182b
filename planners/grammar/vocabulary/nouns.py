"""Nouns: plural or singular, which of two nouns is furniture, a surface or a container, which compounds stay together.

Knows word forms and a short list of everyday things. Refuses to limit what may be named: any word may be a noun; the
lists here only settle preferences ("put it to the desk" means on it) and which word of a wrong sentence to blame.
"""

from __future__ import annotations

import re

from ..tagging.words import bag, phrases

_IRREGULAR = {
    "knives": "knife", "shelves": "shelf", "bookshelves": "bookshelf", "leaves": "leaf", "loaves": "loaf",
    "scarves": "scarf", "wolves": "wolf", "halves": "half", "wives": "wife", "calves": "calf", "hooves": "hoof",
    "mice": "mouse", "geese": "goose", "feet": "foot", "teeth": "tooth", "men": "man", "women": "woman",
    "children": "child", "people": "person", "dice": "die", "cacti": "cactus", "oxen": "ox",
    "potatoes": "potato", "tomatoes": "tomato", "movies": "movie", "cookies": "cookie", "pies": "pie", "ties": "tie",
    "shoes": "shoe", "toes": "toe", "canoes": "canoe", "horseshoes": "horseshoe", "axes": "axe", "vases": "vase",
    "buses": "bus", "gases": "gas", "quizzes": "quiz", "hoes": "hoe", "brownies": "brownie", "hoodies": "hoodie",
    "selfies": "selfie", "zombies": "zombie", "doggies": "doggie", "heroes": "hero", "mangoes": "mango",
    "hangers": "hanger", "curios": "curio", "bookcases": "bookcase", "suitcases": "suitcase", "cases": "case",
    "houses": "house", "roses": "rose", "noses": "nose", "hoses": "hose", "horses": "horse", "nurses": "nurse",
    "purses": "purse", "blouses": "blouse", "mooses": "moose", "chaises": "chaise", "bases": "base",
    "caches": "cache", "axles": "axle", "irises": "iris", "lenses": "lens", "cruises": "cruise",
}  # fmt: skip
# Words that end in s and are one thing, or have no singular that anyone says.
_NOT_PLURAL = {
    "glass", "grass", "bus", "gas", "dress", "mattress", "canvas", "cactus", "compass", "chess", "brass", "cross",
    "moss", "press", "class", "iris", "lens", "atlas", "bass", "boss", "cutlass", "fortress", "harness", "harps",
    "octopus", "platypus", "crocus", "hibiscus", "virus", "campus", "christmas", "pus", "this", "thus", "yes",
    "bias", "trellis", "tennis", "apparatus", "abacus", "asparagus", "chassis", "debris", "chaos", "mess", "less",
    "status", "menus", "nexus", "plus", "surplus", "eucalyptus", "papyrus", "walrus", "lotus", "focus", "series",
}  # fmt: skip
_ONLY_PLURAL = {"scissors", "trousers", "jeans", "pants", "shorts", "stairs", "headphones", "binoculars", "pliers",
                "tongs", "pyjamas", "pajamas", "sunglasses", "eyeglasses", "goggles", "tights", "tweezers"}  # fmt: skip
_MASS = {"furniture", "cutlery", "clutter", "bedding", "clothing", "luggage", "glassware", "crockery", "silverware",
         "rubbish", "trash", "litter", "garbage", "foliage", "greenery", "seating", "lighting",
         "electronics", "stuff"}  # fmt: skip

SURFACES = bag(
    "floor ground table desk shelf bookshelf bed windowsill sill counter countertop worktop dresser nightstand cabinet "
    "sideboard mantel mantelpiece bench stand stool tray rug carpet mat pedestal plinth sofa couch island bar stove "
    "workbench ledge chest ottoman"
)
CONTAINERS = bag("box basket bin bag drawer bowl bucket crate jar cup mug vase wardrobe closet chest sink")
SEATS = bag("chair armchair sofa couch bed stool bench recliner loveseat")
EVERYWHERE = bag("floor ground wall ceiling room")
# Where things stand, and no things: "clear some space", "empty the corner".
PLACES = bag("space room area spot place zone region part corner path way passage aisle entrance doorway gap half")
NOTHING = bag("space gap place clutter mess")  # no kind of thing is called so, whatever stands there
FURNITURE = bag(
    "sofa couch armchair chair bed table desk wardrobe cabinet bookshelf bookcase dresser sideboard bench stool shelf "
    "ottoman nightstand door window wall fireplace piano fridge oven stove bathtub toilet sink counter "
    "television tv stand rug carpet loveseat recliner crib closet column pillar stairs"
)
_THINGS = bag(
    "lamp light plant pot vase clock painting picture mirror poster frame curtain blind cushion pillow blanket cloth "
    "tablecloth towel laptop monitor screen keyboard computer printer phone telephone book books magazine mug cup "
    "glass bowl bottle plate dish candle ball box basket bin bear toy doll guitar violin drum bicycle bike scooter "
    "robot statue sculpture tower globe tree flower bush grass rock stone road path roof ceiling chandelier fan heater "
    "radiator bag backpack suitcase shoe hat coat jacket knife fork spoon kettle toaster microwave pan tray bucket "
    "broom ladder tool hammer leg arm head wheel seat back handle lid drawer door part speaker radio camera car truck "
    "bus boat house fence gate sign cat dog horse bird fish person man woman child room scene object thing place mat "
    "windowsill counter bonsai ottoman umbrella cart crate barrel hook rack hanger remote console"
)
KNOWN = SURFACES | CONTAINERS | FURNITURE | _THINGS

# Compounds whose first word would otherwise be read as a colour or as a verb.
COMPOUNDS: frozenset[tuple[str, ...]] = phrases(
    "wine glass; wine bottle; wine rack; wine cabinet; snow globe; linen basket; laundry basket; rose bush; "
    "orange tree; orange juice; tomato plant; olive tree; mint plant; lime tree; plum tree; peach tree; "
    "salmon fillet; chocolate bar; wheat field; snow man; light bulb; light switch; light fixture; place mat; "
    "paint brush; paint bucket; paint can; plant pot; plant stand; coat rack; coat stand; coat hanger; bin bag; "
    "trash can; garbage can; tin can; watering can; soda can; spray paint can; rubbish bin; trash bag; "
    "dust bin; mark board; picture frame; show case; roll top; rocking chair; "
    "swivel chair; change table; stand mixer; copy machine; spray bottle; spray can; push pin; tip jar; "
    "lamp shade; front door; back door; high chair; front desk; back rest; wide screen; "
    "kitchen scale; bathroom scale; "
    "gold fish; silver ware; copper pipe; cream jug; cream cake; left overs; back pack; bean bag; top hat; "
    "drop leaf table; lock box; play mat; play pen; fold up chair; coral reef; peach pit; sand box; sand castle",
    ";",
)

_VOWEL_OES = re.compile(r"(.*[^aeiou]o)es$")


def singular(word: str) -> str:
    """The singular of a noun ("shelves": "shelf"); the word itself where it has none or is one already."""
    if word in _IRREGULAR:
        return _IRREGULAR[word]
    if not word.endswith("s") or len(word) < 4 or word in _NOT_PLURAL or word in _ONLY_PLURAL or word.endswith("ss"):
        return word
    if word.endswith("ies"):
        return word[:-3] + "y"
    if found := _VOWEL_OES.match(word):
        return found.group(1)
    if word.endswith(("sses", "shes", "ches", "xes", "zzes", "uses")) and not word.endswith(("auses", "ouses")):
        return word[:-2]
    if word.endswith(("us", "is")):
        return word
    return word[:-1]


def is_plural(word: str) -> bool:
    """Whether the noun says that several are meant ("chairs", "furniture")."""
    return word in _MASS or word in _ONLY_PLURAL or singular(word) != word


def head(phrase: str) -> str:
    """The head noun of a singular phrase: its last word."""
    return phrase.rsplit(" ", 1)[-1]


def is_known(word: str) -> bool:
    """Whether it is one of the everyday nouns that help to decide which word to blame."""
    return word in KNOWN or singular(word) in KNOWN or singular(word) in _MASS
