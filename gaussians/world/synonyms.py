"""Everyday words for the same thing, and words for whole families of things.

Knows words only. The embedded encoder's vocabulary holds synonyms of the kinds that it can see; this table adds what
people write in graphs and say in instructions. Refuses to know a scene.
"""

from __future__ import annotations

from functools import cache

from .words import normalise

Phrase = tuple[str, ...]

# Each line: names of one kind of thing.
_SAME = """
sofa, couch, settee, loveseat, divan, futon
television, tv, telly, tv set, television set, flat screen, flatscreen
refrigerator, fridge, freezer, icebox, fridge freezer
rug, carpet, mat, throw rug, area rug
curtain, drape, drapery
stove, cooker, oven, range, hob, stovetop
trash can, bin, waste bin, waste basket, wastebasket, garbage can, garbage bin, \
trash bin, rubbish bin, dustbin, trashcan, recycling bin, wastepaper basket, garbage, trash
armchair, easy chair, arm chair, lounge chair, recliner
cushion, pillow, throw pillow
nightstand, night stand, bedside table, night table, bedside cabinet, end table
painting, picture, artwork, art, canvas, framed picture, print, photo, photograph, poster
bicycle, bike, cycle, pushbike
barbecue, grill, bbq, barbeque
parasol, umbrella, sunshade, patio umbrella
mug, cup, coffee cup, teacup, coffee mug
sink, basin, washbasin, wash basin
toilet, loo, commode, lavatory
wardrobe, closet, armoire
dresser, chest of drawers, drawers, bureau
lamp, light
planter, plant pot, flower pot, flowerpot, flower box
shrub, bush
filing cabinet, file cabinet
bookcase, bookshelf, book shelf, bookshelves, book case, shelving unit
faucet, tap
bathtub, tub, bath
phone, telephone, cell phone, mobile phone, smartphone, mobile
vacuum cleaner, hoover, vacuum
backpack, rucksack, knapsack, school bag
whiteboard, white board, dry erase board, marker board
monitor, screen, display, computer screen, computer monitor
computer, pc, desktop computer, computer tower
teddy bear, teddy, stuffed bear, stuffed animal, plush toy, plushie, soft toy, cuddly toy, stuffed toy
cabinet, cupboard
ottoman, footstool, pouf, pouffe, foot stool, footrest, foot rest
counter, countertop, counter top, worktop, bar
cash register, till
laundry basket, hamper, laundry hamper
coffee machine, coffee maker, espresso machine, coffeemaker
coffee table, cocktail table
radiator, heater
bench, pew
potted plant, houseplant, house plant, pot plant, plant
vase, flower vase
garden hose, hose, hosepipe
grand piano, piano
bed, cot
suitcase, luggage
bucket, pail
garden gnome, gnome, garden dwarf
tv stand, television stand, media console, tv cabinet, media unit, tv unit
jug, pitcher
book, novel
box, carton, cardboard box
chandelier, pendant lamp, pendant light, ceiling light, ceiling lamp, hanging lamp, hanging light
door, doorway
shoe, sneaker, trainer
bottle, flask
paper towel dispenser, paper towel holder, towel dispenser
window sill, windowsill, window ledge
stair, staircase, stairs, steps, stairway
mini fridge, minifridge
microwave, microwave oven
dishwasher, dish washer
washing machine, washer, clothes washer
clothes dryer, dryer, tumble dryer
toilet paper, toilet roll, toilet paper roll
blinds, window blind, blind, shade, shades
office chair, desk chair, computer chair, swivel chair
blackboard, chalkboard
sofa chair, armchair
copier, photocopier, copy machine, copy printer
desk, workstation
laptop, notebook computer
kitchen island, island
stool, bar stool, barstool
purse, handbag, hand bag
cart, trolley
toy, plaything
"""

# Each line: a word for a family, and its members.
_WIDER = """
appliance: refrigerator, stove, microwave, toaster, kettle, dishwasher, washing machine, coffee machine, blender, oven
electronics: television, computer, laptop, monitor, printer, phone, speaker, keyboard, radio
device: television, computer, laptop, monitor, printer, phone, speaker, keyboard, radio
furnishing: sofa, armchair, chair, table, desk, bed, wardrobe, dresser, cabinet, bookcase, \
nightstand, stool, bench, ottoman, tv stand
seat: chair, armchair, sofa, stool, bench, ottoman
seating: chair, armchair, sofa, stool, bench, ottoman
plant: potted plant, shrub, tree, flower, rose bush, rose, cactus, fern
greenery: potted plant, shrub, tree, flower, rose bush, fern
crockery: mug, bowl, plate, saucer, jug, teapot
dish: mug, bowl, plate, saucer
container: box, basket, bin, bucket, crate
decoration: vase, painting, candle, clock, statue, garden gnome
board: whiteboard, blackboard, bulletin board, menu board
lighting: lamp, floor lamp, table lamp, desk lamp, chandelier, lantern
statue: garden gnome, bust, sculpture
animal: cat, dog, bird
vehicle: bicycle, car, scooter
toy: teddy bear, ball, toy car, doll
clothing: shoe, coat, hat
flower: rose bush, rose, tulip, flowers
"""


@cache
def _lines() -> tuple[tuple[Phrase, ...], ...]:
    return tuple(tuple(normalise(p) for p in line.split(",")) for line in _SAME.strip().splitlines())


@cache
def same(phrase: Phrase) -> frozenset[Phrase]:
    """All phrases for the thing that a phrase names, the phrase itself among them (singular words, lower case)."""
    return frozenset({phrase}).union(*(line for line in _lines() if phrase in line))


@cache
def narrower(phrase: Phrase) -> frozenset[Phrase]:
    """What a word for a family covers, with every synonym; empty for other words."""
    found: set[Phrase] = set()
    for line in _WIDER.strip().splitlines():
        word, _, members = line.partition(":")
        if normalise(word) == phrase:
            found |= {other for m in members.split(",") for other in same(normalise(m))}
    return frozenset(found)


@cache
def phrases() -> frozenset[str]:
    """Every name of the tables as it is written."""
    return frozenset(p.strip() for line in _SAME.strip().splitlines() for p in line.split(","))


@cache
def every_word() -> frozenset[str]:
    """Every single word of the tables."""
    text = f"{_SAME} {_WIDER}".replace(",", " ").replace(":", " ")
    return frozenset(text.lower().split())
