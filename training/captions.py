"""Generate captions for training images: kinds, synonyms, broader terms, non-objects, and surrounding words.

The asset kinds have synonyms of their own; those here are additional. Random colours are put before names, independent
of the image, so that the embeddings learn to ignore them: colour is measured on the Gaussians themselves.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from ..gaussians import color
from ..gaussians.language.encoders.vocabulary import Vocabulary
from ..gaussians.world.words import normalise

PART = "part of something"
SEVERAL = "several things together"
WALL = "a piece of wall"
FLOOR = "a piece of floor"
NEGATIVES: dict[str, tuple[str, ...]] = {
    PART: ("fragment of something", "piece of something", "incomplete thing", "part of furniture", "part of a thing"),
    SEVERAL: ("several objects together", "many things together", "two things together", "group of things", "clutter"),
    WALL: ("part of the wall", "wall", "piece of the wall", "bare wall", "ceiling", "piece of ceiling"),
    FLOOR: ("part of the floor", "floor", "piece of the floor", "bare floor", "ground", "piece of ground"),
}  # fmt: skip

# Beside what the asset kinds bring along. Kinds that do not exist are passed over.
SYNONYMS: dict[str, tuple[str, ...]] = {
    "sofa": ("couch", "settee", "loveseat", "love seat", "divan"),
    "armchair": ("easy chair", "lounge chair", "arm chair", "reading chair", "club chair", "recliner"),
    "chair": ("dining chair", "kitchen chair", "wooden chair", "side chair"),
    "office chair": ("desk chair", "swivel chair", "computer chair", "task chair", "rolling chair"),
    "stool": ("bar stool", "footstool", "foot stool", "barstool", "step stool"),
    "bench": ("bench seat", "sitting bench"),
    "ottoman": ("pouf", "hassock", "footrest"),
    "desk": ("writing desk", "office desk", "work desk", "computer desk", "working table", "workstation"),
    "table": ("dining table", "kitchen table", "dinner table", "round table"),
    "dining table": ("dinner table", "kitchen table", "table"),
    "coffee table": ("low table", "cocktail table", "tea table", "living room table"),
    "side table": ("end table", "accent table", "occasional table", "little table"),
    "nightstand": ("night stand", "bedside table", "night table", "bedside cabinet"),
    "bed": ("double bed", "single bed", "twin bed", "king bed", "queen bed"),
    "wardrobe": ("armoire", "closet", "clothes cupboard"),
    "cabinet": ("cupboard", "sideboard", "credenza", "buffet", "storage cabinet"),
    "dresser": ("chest of drawers", "drawers", "bureau", "commode", "drawer"),
    "bookshelf": ("bookcase", "book shelf", "book case", "shelf", "shelving", "shelving unit", "shelves unit"),
    "books": ("stack of books", "pile of books", "book stack", "book pile", "row of books"),
    "book": ("novel", "hardcover", "paperback", "open book"),
    "floor lamp": ("standing lamp", "standard lamp", "lamp stand", "torchiere", "tall lamp", "floor light"),
    "table lamp": ("desk lamp", "bedside lamp", "reading lamp", "small lamp", "table light", "nightstand lamp"),
    "pendant lamp": ("hanging lamp", "ceiling lamp", "pendant light", "ceiling light", "hanging light"),
    "chandelier": ("ceiling chandelier",),
    "potted plant": ("plant", "houseplant", "house plant", "pot plant", "indoor plant", "plant pot", "fern"),
    "cactus": ("potted cactus", "succulent"),
    "vase": ("flower vase", "urn", "amphora"),
    "rug": ("carpet", "floor mat", "area rug", "mat", "runner"),
    "painting": ("picture", "picture frame", "framed picture", "wall art", "artwork", "poster", "canvas", "art print",
                 "framed painting", "photo frame"),
    "mirror": ("looking glass", "wall mirror", "standing mirror"),
    "window": ("window frame", "glass window", "window pane"),
    "door": ("doorway", "room door", "wooden door"),
    "curtain": ("drape", "window curtain", "drapery", "pair of curtains"),
    "television": ("tv", "tv set", "television set", "flat screen", "telly", "tv screen", "flatscreen tv"),
    "tv stand": ("tv unit", "media console", "tv cabinet", "television stand", "media unit", "tv bench"),
    "laptop": ("notebook computer", "laptop computer", "portable computer", "macbook", "notebook"),
    "monitor": ("computer monitor", "computer screen", "screen", "display", "pc monitor"),
    "keyboard": ("computer keyboard", "pc keyboard"),
    "mug": ("cup", "coffee mug", "tea cup", "coffee cup", "teacup", "beaker"),
    "bowl": ("fruit bowl", "salad bowl", "dish bowl", "soup bowl"),
    "bottle": ("wine bottle", "glass bottle", "flask", "water bottle", "beer bottle"),
    "plate": ("dish", "dinner plate", "saucer", "platter"),
    "candle": ("candlestick", "wax candle", "pillar candle", "taper"),
    "clock": ("wall clock", "clock face", "timepiece"),
    "ball": ("football", "soccer ball", "beach ball", "basketball", "toy ball", "sphere"),
    "box": ("carton", "crate", "cardboard box", "package", "parcel", "wooden box", "moving box", "storage box"),
    "basket": ("wicker basket", "laundry basket", "hamper", "storage basket", "woven basket"),
    "bin": ("trash can", "trashcan", "waste bin", "wastebasket", "garbage can", "rubbish bin", "waste basket",
            "wastepaper basket", "trash bin", "garbage bin", "dustbin"),
    "teddy bear": ("teddy", "stuffed bear", "plush bear", "toy bear", "stuffed animal", "bear", "soft toy"),
    "guitar": ("acoustic guitar", "electric guitar", "classical guitar"),
    "bicycle": ("bike", "pushbike", "cycle", "push bike", "road bike", "mountain bike"),
    "pillow": ("cushion", "throw pillow", "sofa cushion", "scatter cushion"),
    "cushion": ("pillow", "throw pillow", "scatter cushion"),
    "blanket": ("throw", "plaid", "bedspread"),
    "piano": ("upright piano", "grand piano", "keyboard piano"),
    "fireplace": ("hearth", "mantelpiece", "chimney"),
    "refrigerator": ("fridge", "freezer", "icebox"),
    "stove": ("oven", "cooker", "kitchen range"),
    "microwave": ("microwave oven",),
    "sink": ("wash basin", "washbasin", "basin"),
    "bathtub": ("bath", "tub", "bath tub"),
    "toilet": ("wc", "lavatory", "water closet"),
    "washing machine": ("washer", "laundry machine"),
    "speaker": ("loudspeaker", "hifi speaker", "stereo speaker"),
    "radio": ("stereo", "portable radio"),
    "phone": ("telephone", "smartphone", "mobile phone", "cell phone"),
    "suitcase": ("luggage", "trunk", "travel case"),
    "backpack": ("rucksack", "bag", "schoolbag"),
    "umbrella": ("parasol", "brolly"),
    "ladder": ("stepladder", "step ladder"),
    "globe": ("world globe", "earth globe"),
    "statue": ("sculpture", "bust", "figurine"),
    "coat rack": ("coat stand", "coat tree", "clothes rack", "hat stand", "coat hanger"),
    "teapot": ("tea pot", "kettle", "tea kettle", "coffee pot"),
    "pan": ("frying pan", "skillet", "saucepan"),
    "pot": ("cooking pot", "saucepan"),
    "fan": ("ventilator", "standing fan", "electric fan"),
    "toaster": ("bread toaster",),
    "shoes": ("pair of shoes", "sneakers", "boots"),
    "tray": ("serving tray",),
    "jug": ("pitcher", "carafe", "ewer"),
    "wine glass": ("goblet", "glass", "stemware"),
}  # fmt: skip

# Terms for several kinds at once. A term that is itself a kind means that kind first.
BROADER: dict[str, tuple[str, ...]] = {
    "lamp": ("floor lamp", "table lamp", "desk lamp", "pendant lamp", "ceiling lamp", "chandelier"),
    "light": ("floor lamp", "table lamp", "desk lamp", "pendant lamp", "ceiling lamp", "chandelier"),
    "table": ("table", "dining table", "coffee table", "side table", "desk", "nightstand"),
    "chair": ("chair", "armchair", "office chair", "rocking chair", "dining chair"),
    "seat": ("chair", "armchair", "sofa", "stool", "bench", "office chair", "ottoman"),
    "shelf": ("bookshelf", "wall shelf"),
    "computer": ("laptop", "monitor", "desktop computer"),
    "screen": ("television", "monitor"),
    "plant": ("potted plant", "cactus"),
    "toy": ("teddy bear", "ball", "toy car", "building blocks"),
    "tableware": ("mug", "bowl", "plate", "bottle", "wine glass", "jug", "teapot"),
    "container": ("box", "basket", "bin"),
    "instrument": ("guitar", "piano"),
    "musical instrument": ("guitar", "piano"),
    "pillow": ("pillow", "cushion"),
    "cupboard": ("cabinet", "wardrobe"),
    "furniture": ("chair", "armchair", "sofa", "stool", "bench", "desk", "table", "dining table", "coffee table",
                  "side table", "bed", "wardrobe", "cabinet", "bookshelf", "dresser", "nightstand", "tv stand"),
}  # fmt: skip

_SIZES = normalise("small large big little tiny huge tall short low high wide narrow long round square thin thick")
_MATERIALS = normalise(
    "wooden wood metal steel iron glass plastic leather fabric velvet wool woollen cotton ceramic clay stone marble "
    "wicker woven bamboo rattan paper cardboard brass copper silver gold golden chrome oak pine walnut linen silk"
)
_LOOKS = normalise(
    "old new modern antique vintage classic rustic simple plain comfy comfortable cozy cosy soft hard shiny bright "
    "dark light pale striped patterned dotted checkered colorful colourful empty open closed pretty nice beautiful "
    "ugly elegant fancy minimalist decorative painted upholstered folding dining living kitchen office bedroom "
    "bathroom garden room wall floor corner standing hanging framed full single double whole complete other one "
    "first second last same left right middle only entire"
)
_SHOWN = ("", "", "", "", "photo of ", "picture of the ", "one ")


def vocabulary(kinds: Mapping[str, tuple[str, ...]]) -> Vocabulary:
    """The names for asset kinds, each with the synonyms it brings, joined with those listed here.

    A synonym that is the name of another kind, or is claimed by two kinds, is dropped: it would teach a contradiction.
    """
    own = {normalise(kind) for kind in kinds}
    claims: dict[tuple[str, ...], set[str]] = {}
    wanted = {k: tuple(dict.fromkeys((*given, *SYNONYMS.get(k, ())))) for k, given in kinds.items()}
    for kind, names in wanted.items():
        for name in names:
            claims.setdefault(normalise(name), set()).add(kind)
    terms = {normalise(term) for term in BROADER}
    kept = {
        kind: tuple(n for n in names if normalise(n) not in own | terms and len(claims[normalise(n)]) == 1)
        for kind, names in wanted.items()
    }
    broader = {
        term: covered
        for term, listed in BROADER.items()
        if (covered := tuple(k for k in listed if k in kinds)) and (normalise(term) not in own or len(covered) > 1)
    }
    return Vocabulary(kept, broader, tuple(NEGATIVES), frozenset(_modifiers()))


def words(vocabulary: Vocabulary) -> list[str]:
    """Every word the text tower learns, sorted: of names, of captions, and the modifiers."""
    phrases = [*vocabulary.names, *vocabulary.broader, *(s for v in vocabulary.kinds.values() for s in v)]
    phrases += [*NEGATIVES, *(s for v in NEGATIVES.values() for s in v)]
    return sorted({w for p in phrases for w in normalise(p)} | set(vocabulary.modifiers))


def phrase(rng: np.random.Generator, name: str, modifiers: list[str]) -> str:
    """One caption around `name`: sometimes alone, often with up to three words before it, in any colour."""
    count = int(rng.choice(4, p=[0.4, 0.3, 0.2, 0.1]))
    before = [modifiers[i] for i in rng.integers(len(modifiers), size=count)]
    return " ".join([_SHOWN[rng.integers(len(_SHOWN))] + " ".join([*before, name])])


def names_of(vocabulary: Vocabulary, label: str) -> tuple[str, ...]:
    """All exact names of a kind or a non-object, the canonical one first."""
    return (label, *(vocabulary.kinds[label] if label in vocabulary.kinds else NEGATIVES[label]))


def _modifiers() -> set[str]:
    """Single words that may stand before a name."""
    shades = {w for name in (*color.EVERYDAY, *color.BASIC) for w in name.split()}
    css = {name for name in color.names() if re.fullmatch("[a-z]+", name)}
    return {
        n for word in shades | css | {"grey"} | set(_SIZES) | set(_MATERIALS) | set(_LOOKS) for n in normalise(word)
    }
