"""English nouns: singular, plural and head; and normalised noun phrases for encoders with a finite vocabulary.

Every function but `normalise` takes lower-case text.

A plural of two nouns is read as the commoner one: "axes" are tools and "bases" are feet of lamps, so that
`singular(plural(noun)) == noun` holds for "axe" and "base" but not for "axis" and "basis".
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache

PROMPT = "a photo of a {}"  # prompt for encoders that were trained on captions of photographs

_WORD = re.compile(r"[a-z0-9]+")
_FRAMED = re.compile(
    r"^(?:an? |the )?(?:(?:close ?up|cropped|blurry|good|bad) )?(?:photo|photograph|picture|image|rendering|view)"
    r" of (?=\w)"
)
_DETERMINERS = frozenset("a an the some any my your our his her their its this that these those".split())  # noqa: SIM905


def _bag(text: str) -> frozenset[str]:
    return frozenset(text.split())


# Nouns without a plural form that stand for several things.
MASS = _bag(
    "furniture cutlery clutter bedding clothing luggage glassware crockery silverware rubbish trash litter garbage "
    "foliage greenery seating lighting electronics stuff"
)
# Nouns that are used in the plural only.
PLURAL_ONLY = _bag(
    "scissors trousers jeans pants shorts stairs headphones binoculars pliers tongs pyjamas pajamas sunglasses "
    "eyeglasses goggles tights tweezers clothes spectacles dungarees overalls leggings knickers panties underpants "
    "sweatpants slacks shears nunchucks bagpipes handcuffs groceries leftovers belongings furnishings surroundings "
    "undies upstairs downstairs thanks cattle"
)
# Singular and plural are one form.
_INVARIANT = _bag(
    "sheep deer moose bison swine grouse fish salmon trout cod tuna shrimp aircraft spacecraft hovercraft offspring "
    "series species chassis corps headquarters crossroads barracks gallows bellows means chamois rendezvous debris "
    "news molasses billiards gymnastics aerobics mathematics physics biceps triceps forceps always perhaps towards "
    "hummus asparagus couscous chaos tennis chess"
)

# Singular nouns in -s beside those in -ss and -us; of those in -is the ones with a plural in -ises.
_SINGULAR_S = _bag(
    "gas biogas lens canvas atlas bias alias christmas pancreas madras rhinoceros thermos cosmos asbestos calvados "
    "kudos ethos pathos yes mercedes texas kansas vegas iris trellis pelvis ibis clematis portcullis metropolis mantis"
)
_SIS = _bag("oasis crisis thesis hypothesis analysis diagnosis parenthesis synopsis neurosis ellipsis")  # plural: -ses

# Nouns in -u and -i; other words in -us and -is are singulars.
_FINAL_VOWEL = _bag(
    "menu emu gnu guru tutu kudu zebu sudoku tiramisu bayou caribou marabou "
    "ski jetski taxi kiwi bikini zucchini khaki salami tsunami yeti rabbi alibi panini martini jacuzzi safari sari "
    "corgi ravioli chili deli tipi mini semi okapi broccoli bonsai samurai spaghetti origami teriyaki hifi wifi"
)
# Nouns in -o with a plural in -oes.
_O_ES = _bag(
    "potato tomato hero superhero echo mango tornado volcano mosquito buffalo domino cargo motto veto torpedo embargo"
)
# Nouns in -oe, -ie, -che, -xe, -sse and -use. Their plurals end as those of nouns in -o, -y, -ch, -x, -ss and -us do.
_FINAL_E = _bag(
    "shoe horseshoe snowshoe overshoe toe tiptoe mistletoe canoe hoe backhoe foe doe roe sloe aloe floe oboe woe "
    "movie cookie brownie hoodie selfie zombie genie doggie birdie smoothie rookie calorie collie pixie prairie "
    "menagerie foodie hippie magpie necktie bowtie potpie cutie sweetie veggie wheelie bookie auntie beanie onesie "
    "budgie barbie talkie goalie oldie goodie pinkie rotisserie patisserie brasserie jalousie townie newbie freebie "
    "hankie reverie sortie aerie eyrie sharpie cootie bogie plushie "
    "ache headache toothache stomachache backache earache heartache cache niche quiche creche avalanche moustache "
    "mustache brioche pastiche cliche psyche gouache cartouche cloche tranche porsche "
    "axe pickaxe battleaxe poleaxe mousse crevasse posse finesse impasse "
    "fuse muse use ruse excuse recluse abuse"
)
_DOUBLED_Z = {"quiz": "quizzes", "fez": "fezzes", "whiz": "whizzes"}
_HARD_CH = _bag("stomach monarch patriarch epoch loch tech eunuch")  # plural in -s, as the sound is k

# Nouns in -f and -fe with plurals in -ves, alone and as the end of a compound ("bookshelf").
_F = ("shelf", "knife", "wolf", "leaf", "loaf", "wife", "thief", "calf", "half", "scarf")
_F_ALONE = ("self", "elf", "hoof", "wharf", "dwarf", "sheaf", "life", "afterlife", "yourself", "kerchief")
_VES = {noun.removesuffix("e")[:-1] + "ves": noun for noun in (*_F, *_F_ALONE)}

# Plurals that follow no rule, also at the end of a compound ("grandchildren", "snowmen").
_COMPOUNDING = {"children": "child", "people": "person", "men": "man", "feet": "foot", "teeth": "tooth"} | {
    many: one for many, one in _VES.items() if one in _F
}
_PLURAL_ENDINGS = tuple(_COMPOUNDING)
_NOT_MEN = _bag(
    "specimen abdomen omen amen ramen stamen cyclamen acumen regimen bitumen lumen semen dolmen albumen examen"
)
_NOT_MAN = _bag("human german roman norman ottoman talisman shaman caiman doberman superhuman ataman")
_LATIN = {
    **{f"{stem}i": f"{stem}us" for stem in _bag(
        "cact fung alumn nucle radi stimul foc syllab loc bacill termin octop hippopotam hibisc croc narciss gladiol")},
    **{f"{stem}a": f"{stem}um" for stem in _bag(
        "bacteri aquari terrari planetari strat stadi curricul memorand errat ov millenni auditori sanatori")},
    **{f"{stem}a": f"{stem}on" for stem in _bag("criteri phenomen automat")},
    **{f"{stem}ae": f"{stem}a" for stem in _bag("larv alg antenn vertebr formul nebul pup amoeb")},
    **{f"{stem}x": stem for stem in _bag("bureau chateau gateau plateau tableau trousseau")},
    "indices": "index", "matrices": "matrix", "vertices": "vertex", "appendices": "appendix", "codices": "codex",
}  # fmt: skip
# Irregular plurals that are rarer than the regular plural; they are only read, never formed.
_RARE_PLURALS = _bag(
    "octopi hippopotami hibisci croci gladioli foci aquaria terraria planetaria stadia auditoria sanatoria memoranda "
    "indices bureaux chateaux gateaux plateaux tableaux trousseaux formulae antennae automata"
)
_IRREGULAR = {
    **_VES, **_LATIN, **{f"{noun[:-2]}es": noun for noun in _SIS}, **{many: one for one, many in _DOUBLED_Z.items()},
    "mice": "mouse", "dormice": "dormouse", "lice": "louse", "geese": "goose", "dice": "die", "oxen": "ox",
    "topazes": "topaz", "tvs": "tv", "pcs": "pc", "cds": "cd",
}  # fmt: skip
_PLURAL = {one: many for many, one in _IRREGULAR.items() if many not in _RARE_PLURALS}

_UNCHANGED = MASS | PLURAL_ONLY | _INVARIANT
# Words that end the head of a phrase: "a table with drawers" is a table. "of" is not among
# them: "a stack of books" is a stack and books, so callers decide.
AFTER_HEAD = _bag("with in on from for near at by without made having")


def singular(noun: str) -> str:
    """The singular of a noun or of a phrase's head: "couches" to "couch", "cups of tea" to "cup of tea".

    A noun that is singular, or that has no singular, comes back as it is; applying it twice changes nothing more.
    """
    return _at_head(noun, _singular)


def plural(noun: str) -> str:
    """The plural of a singular noun or of a phrase's head: "shelf" to "shelves"; of mass nouns the noun itself."""
    return _at_head(noun, _plural)


def is_plural(noun: str) -> bool:
    """Whether the noun stands for several things ("chairs"); true also for mass nouns ("furniture") and "stairs"."""
    word = head(noun)
    return word in MASS or word in PLURAL_ONLY or _singular(word) != word


def head(phrase: str) -> str:
    """The head noun of a phrase: the last word, or the one before "of", "with" or the like ("chest of drawers")."""
    words = phrase.split(" ")
    return words[_head(words)]


@lru_cache(maxsize=1 << 14)  # tables of names ask for the same phrases two and three times
def normalise(text: str) -> tuple[str, ...]:
    """The words that carry meaning, lower-case and singular: "A photo of the red Couches" to `("red", "couch")`."""
    plain = " ".join(_WORD.findall(text.lower().replace("'s", " ")))
    plain = _FRAMED.sub("", plain)
    return tuple(_singular(w) for w in plain.split() if w not in _DETERMINERS)


def _head(words: list[str]) -> int:
    return next((i for i, w in enumerate(words) if i and (w == "of" or w in AFTER_HEAD)), len(words)) - 1


def _at_head(phrase: str, changed: Callable[[str], str]) -> str:
    words = phrase.split(" ")
    at = _head(words)
    return " ".join([*words[:at], changed(words[at]), *words[at + 1 :]])


@lru_cache(maxsize=1 << 14)
def _singular(word: str) -> str:
    if word in _UNCHANGED or word in _SINGULAR_S:
        return word
    if found := _irregular(word):
        return found
    plain = _without_ending(word)
    return _irregular(plain) or plain  # "peoples"


def _irregular(word: str) -> str:
    """The singular of a plural that follows no rule, "" for other words."""
    if word in _IRREGULAR:
        return _IRREGULAR[word]
    if word in _NOT_MEN:
        return ""
    if not word.endswith(_PLURAL_ENDINGS):
        return ""
    for many, one in _COMPOUNDING.items():
        if word.endswith(many) and (word == many or len(word) > len(many) + 1):
            return word.removesuffix(many) + one
    return ""


def _without_ending(word: str) -> str:
    """A word without the ending of a plural; itself if it has none."""
    if len(word) < 4 or not word.endswith("s") or _ends_singular(word):
        return word
    stem = word[:-1]  # without -s
    if not stem.endswith("e") or stem in _FINAL_E:
        return stem
    short = stem[:-1]  # without -es
    if short.endswith("i"):
        return short[:-1] + "y" if len(short) > 2 else stem
    if short.endswith(("o", "ch", "sh", "x", "zz", "tz")):
        return short
    in_s = short in _SINGULAR_S or (short.endswith(("ss", "us")) and not stem.endswith(("ause", "ouse", "euse")))
    return short if in_s else stem


def _ends_singular(word: str) -> bool:
    """Whether a word in -s that no list holds is a singular by its ending."""
    return word.endswith("ss") or (
        word.endswith(("us", "is")) and word[:-1] not in _FINAL_VOWEL and not word.endswith("eaus")
    )


def _plural(word: str) -> str:
    if word in _UNCHANGED or word.endswith("fish"):
        return word
    if word in _PLURAL:
        return _PLURAL[word]
    for many, one in _COMPOUNDING.items():
        if word.endswith(one) and (word == one or len(word) > len(one) + 1) and word not in _NOT_MAN:
            return word.removesuffix(one) + many
    if word.endswith("y") and word[-2:-1] not in ("a", "e", "i", "o", *(() if word.endswith("quy") else "u")):
        return word[:-1] + "ies"
    sibilant = word.endswith(("s", "x", "z", "ch", "sh")) and word not in _HARD_CH
    return word + ("es" if sibilant or word in _O_ES else "s")
