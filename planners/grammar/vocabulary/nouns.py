"""Classifies nouns as surface, container, seat or furniture, and lists compound nouns that must not be split.

Any word may be a noun. The classes only decide between readings ("put it to the desk" means on it), and the known nouns
which word of a sentence that does not parse is reported.
"""

from __future__ import annotations

from functools import cache

from ....gaussians.world import kinds
from ....gaussians.world.words import MASS, head, singular
from ..tagging.words import bag, phrases

EVERYWHERE = bag("floor ground wall ceiling room")
# Places, not things: "clear some space", "empty the corner".
PLACES = bag("space room area spot place zone region part corner path way passage aisle entrance doorway gap half")
NOTHING = bag("space gap place clutter mess")  # never the name of a kind of thing
# Everyday words that name no kind of thing: parts of houses and things, places, people, animals and vehicles.
_SHELF_LIKE = bag("floor ground sill mantel stand ledge pedestal rug carpet mat")  # things are put on them
_BUILDING = bag("wall column pillar railing")
_THINGS = bag(
    "frame cloth tablecloth rock stone road path roof ceiling coat jacket knife fork spoon tool hammer leg arm head "
    "wheel back handle lid drawer part radio camera car truck bus boat house fence gate grass tower cat dog horse bird "
    "fish hat person man woman child room scene object thing place crate barrel hook hanger remote book bag doll "
    "violin robot light bear tree broom heater scooter"
)


_OPENED = bag("door drawer gate lid window hatch flap curtain cupboard")


def is_opened(phrase: str) -> bool:
    """Whether a name is of something that opens and closes."""
    return singular(phrase.split(" ")[-1]) in _OPENED


@cache
def everyday() -> frozenset[str]:
    """Everyday nouns: the head nouns of kinds, and words that name no kind."""
    return kinds.heads() | _SHELF_LIKE | _BUILDING | _THINGS | EVERYWHERE


def is_surface(phrase: str) -> bool:
    """Whether small things are put on it: it has a top, stores things, is a bed, rug or seat other than a chair."""
    kind = kinds.of(phrase)
    if kind is None:
        return head(phrase) in _SHELF_LIKE
    return kind.top or kind.is_rug or kind.role == "bed" or kind.stores or (kind.seats > 0 and not is_chair(kind))


def is_chair(kind: kinds.Kind) -> bool:
    """Whether it is a seat for one person with a front side."""
    return kind.seats == 1 and kind.front


def is_container(phrase: str) -> bool:
    """Whether things are put into it."""
    kind = kinds.of(phrase)
    return head(phrase) == "drawer" if kind is None else kind.holds


def is_seat(phrase: str) -> bool:
    """Whether people sit on it."""
    kind = kinds.of(phrase)
    return kind is not None and not kind.holds and (kind.seats > 0 or kind.role == "bed")


def is_furniture(phrase: str) -> bool:
    """Whether it is furniture or part of the building, not a small thing."""
    kind = kinds.of(phrase)
    if kind is None:
        return head(phrase) in _BUILDING
    used = kind.backed or kind.front or kind.seats > 0 or kind.top or kind.stores or kind.is_rug
    return (used and kind.support == "floor") or kind.fixed or kind.name == "television"


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
    "drop leaf table; lock box; play mat; play pen; fold up chair; coral reef; peach pit; sand box; sand castle; "
    "snow blower; snow shovel; snow board; snow shoe; fuel can; petrol can; gas can; jerry can; oil can; beer can; "
    "paint tin; "
    "drop cloth; paint roller; spray gun; clock radio; change machine; play house; copper pot; silver spoon; rose "
    "vase; "
    "turn table; point set; set square; light box; light stand; mount board; stack chair; push chair; push cart; "
    "pull cord; "
    "slide projector; hang tag; drop light; lift chair; mark pen; rest room; roll cage; tip truck; wheel chair; wheel "
    "barrow; coat hook; coat tree; coat peg; bin lid; lime plaster; plum pudding; mint tea; olive oil; cut glass; drag "
    "racer; float glass; cool box; cool bag; warm light; salmon steak; coral lamp; tomato sauce; tomato soup",
    ";",
)


def is_known(word: str) -> bool:
    """Whether a word, or its singular, is an everyday noun."""
    return word in everyday() or singular(word) in everyday() or word in MASS
