"""Nouns: which of two nouns is furniture, a surface or a container, and which compounds stay together.

Knows a short list of everyday things. Refuses to limit what may be named: any word may be a noun; the
lists here only settle preferences ("put it to the desk" means on it) and which word of a wrong sentence to blame.
"""

from __future__ import annotations

from ....gaussians.world.words import MASS, singular
from ..tagging.words import bag, phrases

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


def is_known(word: str) -> bool:
    """Whether it is one of the everyday nouns that help to decide which word to blame."""
    return word in KNOWN or singular(word) in KNOWN or word in MASS
