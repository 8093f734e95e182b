"""Singular and plural of nouns, over a list of everyday things, and the laws between them."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians.world.words import MASS, PLURAL_ONLY, head, is_plural, normalise, plural, singular

# Singular and plural; where English has two plurals, the one that people say more.
_PAIRS = """
armchair armchairs, ashtray ashtrays, barrel barrels, basin basins, basket baskets, bathtub bathtubs, bed beds,
bedframe bedframes, bench benches, bin bins, blanket blankets, blind blinds, board boards, bookcase bookcases,
bookend bookends, bookshelf bookshelves, bottle bottles, bowl bowls, box boxes, brick bricks, broom brooms,
brush brushes, bucket buckets, bulb bulbs, bureau bureaus, cabinet cabinets, cage cages, calendar calendars,
candle candles, candlestick candlesticks, canvas canvases, carpet carpets, case cases, ceiling ceilings, chair chairs,
chaise chaises, chandelier chandeliers, chest chests, chimney chimneys, clock clocks, closet closets, coach coaches,
coaster coasters, column columns, computer computers, corner corners, couch couches, cradle cradles, crate crates,
crib cribs, cupboard cupboards, curtain curtains, cushion cushions, desk desks, dish dishes, door doors,
drapery draperies, drawer drawers, dresser dressers, duvet duvets, fan fans, faucet faucets, fireplace fireplaces,
floor floors, flowerpot flowerpots, fuse fuses, frame frames, fridge fridges, futon futons, garage garages, gate gates,
glass glasses, globe globes, hallway hallways, hammock hammocks, hanger hangers, hatch hatches, heater heaters,
hinge hinges, hook hooks, hose hoses, house houses, iron irons, jar jars, jug jugs, key keys, kettle kettles,
knob knobs, ladder ladders, lamp lamps, lampshade lampshades, lantern lanterns, latch latches, ledge ledges,
library libraries, light lights, lobby lobbies, lock locks, mantelpiece mantelpieces, mat mats, match matches,
mattress mattresses, microwave microwaves, mirror mirrors, mop mops, mosaic mosaics, mug mugs, niche niches,
nightstand nightstands, ottoman ottomans, oven ovens, pan pans, pantry pantries, patio patios, photo photos,
piano pianos, picture pictures, pillow pillows, plate plates, porch porches, poster posters, pot pots, pouf poufs,
quilt quilts, rack racks, radiator radiators, radio radios, range ranges, roof roofs, rug rugs, safe safes,
saucer saucers, screen screens, settee settees, shelf shelves, sink sinks, sofa sofas, speaker speakers,
staircase staircases, statue statues, stereo stereos, stool stools, stove stoves, studio studios, suitcase suitcases,
switch switches, table tables, tapestry tapestries, television televisions, tile tiles, toilet toilets, torch torches,
towel towels, toy toys, trash trash, tray trays, trellis trellises, trolley trolleys, trophy trophies, tub tubs,
umbrella umbrellas, urn urns, valve valves, vase vases, video videos, wall walls, wardrobe wardrobes, window windows,
wheel wheels, wreath wreaths,
tv tvs, bus buses, minibus minibuses, box boxes, fax faxes, gas gases, lens lenses, prism prisms, compass compasses,
abacus abacuses, atlas atlases, virus viruses, campus campuses, circus circuses, index indexes, matrix matrices,
axe axes, pickaxe pickaxes, hammer hammers, knife knives, penknife penknives, saw saws, pincer pincers, wrench wrenches,
screwdriver screwdrivers, drill drills, file files, chisel chisels, spade spades, hoe hoes, rake rakes, sickle sickles,
scythe scythes, wedge wedges, vise vises, pulley pulleys, gauge gauges, ruler rulers, level levels, torch torches,
toolbox toolboxes, workbench workbenches, battery batteries, fuse fuses, plug plugs, socket sockets, wire wires,
nail nails, screw screws, bolt bolts, washer washers, tape tapes, rope ropes, chain chains, glue glues, sieve sieves,
ladle ladles, spatula spatulas, whisk whisks, grater graters, sponge sponges, toothbrush toothbrushes, razor razors,
comb combs, paintbrush paintbrushes, quiz quizzes, die dice, staff staffs, stave staves, switch switches,
stopwatch stopwatches, watch watches, crutch crutches, tech techs,
apple apples, apricot apricots, artichoke artichokes, avocado avocados, bagel bagels, banana bananas, bean beans,
berry berries, blueberry blueberries, biscuit biscuits, brioche brioches, brownie brownies, bun buns, cabbage cabbages,
cake cakes, candy candies, carrot carrots, cherry cherries, chili chilis, cookie cookies, crouton croutons,
cucumber cucumbers, curry curries, date dates, donut donuts, egg eggs, fig figs, grape grapes, grapefruit grapefruits,
jelly jellies, kiwi kiwis, leek leeks, lemon lemons, lime limes, loaf loaves, lychee lychees, mango mangoes,
martini martinis, melon melons, mousse mousses, mushroom mushrooms, nacho nachos, noodle noodles, nut nuts,
olive olives, omelette omelettes, onion onions, orange oranges, pancake pancakes, papaya papayas, pastry pastries,
peach peaches, pear pears, pea peas, peanut peanuts, pepper peppers, pie pies, pizza pizzas, plum plums,
potato potatoes, pretzel pretzels, pumpkin pumpkins, quiche quiches, radish radishes, raisin raisins,
raspberry raspberries, recipe recipes, salad salads, sandwich sandwiches, sausage sausages, smoothie smoothies,
soup soups, steak steaks, strawberry strawberries, squash squashes, taco tacos, toast toasts, tomato tomatoes,
tortilla tortillas, turnip turnips, waffle waffles, walnut walnuts, zucchini zucchinis, espresso espressos,
aloe aloes, bonsai bonsais, bouquet bouquets, branch branches, bush bushes, cactus cacti, crocus crocuses,
daisy daisies, fern ferns, ficus ficuses, flower flowers, fungus fungi, hedge hedges, hibiscus hibiscuses, iris irises,
ivy ivies,
leaf leaves, lily lilies, lotus lotuses, moss mosses, orchid orchids, palm palms, pansy pansies, peony peonies,
petunia petunias, plant plants, poppy poppies, reed reeds, rose roses, sapling saplings, tree trees, tulip tulips,
violet violets, yucca yuccas, eucalyptus eucalyptuses, larva larvae, sheaf sheaves, clove cloves, grass grasses,
ant ants, bee bees, beetle beetles, bird birds, buffalo buffaloes, butterfly butterflies, calf calves, canary canaries,
cat cats, cow cows, crow crows, deer deer, dog dogs, donkey donkeys, dove doves, duck ducks, elf elves, emu emus,
fish fish, flamingo flamingos, fly flies, fox foxes, frog frogs, giraffe giraffes, goldfish goldfish, goose geese,
gnu gnus, grouse grouse, hippopotamus hippopotamuses, horse horses, jellyfish jellyfish, kangaroo kangaroos, lion lions,
llama llamas, louse lice, lynx lynxes, magpie magpies, mongoose mongooses, monkey monkeys, moose moose,
mosquito mosquitoes, mouse mice, octopus octopuses, ostrich ostriches, ox oxen, panda pandas, pony ponies,
puppy puppies, rhinoceros rhinoceroses, roach roaches, sheep sheep, spider spiders, thrush thrushes, turkey turkeys,
walrus walruses, wasp wasps, wolf wolves, zebra zebras, antenna antennas, hoof hooves,
apron aprons, beanie beanies, belt belts, beret berets, bikini bikinis, blouse blouses, boot boots, bowtie bowties,
brooch brooches, canoe canoes, cap caps, coat coats, dress dresses, galosh galoshes, glove gloves, hat hats,
headdress headdresses, hoodie hoodies, horseshoe horseshoes, jacket jackets, jersey jerseys, kimono kimonos,
mitten mittens, necklace necklaces, necktie neckties, overcoat overcoats, poncho ponchos, purse purses, robe robes,
sari saris, sash sashes, scarf scarves, shawl shawls, shirt shirts, shoe shoes, skirt skirts, sleeve sleeves,
slipper slippers, sneaker sneakers, sock socks, suit suits, sweater sweaters, tie ties, toe toes, tuxedo tuxedos,
tutu tutus, vest vests, wallet wallets, watch watches,
child children, grandchild grandchildren, person people, salesperson salespeople, man men, woman women, snowman snowmen,
human humans, talisman talismans, foot feet, tooth teeth, thief thieves, wife wives, hero heroes, gnome gnomes,
baby babies, boy boys, lady ladies, nurse nurses, boss bosses, princess princesses, shaman shamans, judge judges,
ache aches, headache headaches, avalanche avalanches, cache caches, moustache moustaches, stomach stomachs,
base bases, bias biases, cause causes, crisis crises, oasis oases, pulse pulses, phase phases, use uses, noise noises,
prize prizes, size sizes, maze mazes, bronze bronzes, waltz waltzes, topaz topazes, buzz buzzes, fez fezzes,
photocopy photocopies, calorie calories, movie movies, selfie selfies, prairie prairies, pixie pixies, lie lies,
menu menus, ski skis, taxi taxis, rabbi rabbis, safari safaris, plateau plateaus, chateau chateaus, igloo igloos,
volcano volcanoes, tornado tornadoes, echo echoes, domino dominoes, half halves, life lives, self selves,
wave waves, cave caves, hive hives, curve curves, alcove alcoves, archive archives, cave caves, belief beliefs,
cliff cliffs, chef chefs, dwarf dwarves, carafe carafes, cafe cafes, eye eyes, day days, way ways, guy guys,
colloquy colloquies, soliloquy soliloquies, criterion criteria, bacterium bacteria, aquarium aquariums, vertex vertices,
nucleus nuclei, radius radii, stimulus stimuli, series series, species species, aircraft aircraft, salmon salmon,
chassis chassis, headquarters headquarters, crossroads crossroads, scissors scissors, trousers trousers, jeans jeans,
pyjamas pyjamas, sunglasses sunglasses, headphones headphones, binoculars binoculars, clothes clothes,
furniture furniture, luggage luggage, cutlery cutlery
"""
PAIRS = sorted({tuple(pair.split()) for pair in _PAIRS.replace("\n", " ").split(",")})
# Singular, and a plural that is read too.
_ALSO = (
    ("cactus", "cactuses"), ("octopus", "octopi"), ("index", "indices"), ("bureau", "bureaux"), ("mango", "mangos"),
    ("scarf", "scarfs"), ("hoof", "hoofs"), ("flamingo", "flamingoes"), ("fish", "fishes"), ("antenna", "antennae"),
    ("aquarium", "aquaria"), ("fungus", "funguses"), ("person", "persons"), ("person", "peoples"), ("bus", "buses"),
)  # fmt: skip
_SINGULAR = (
    "glass grass bus gas dress mattress canvas cactus compass chess brass cross moss press class iris lens atlas bass "
    "boss fortress harness octopus platypus crocus hibiscus virus campus christmas bias trellis tennis asparagus "
    "chassis debris chaos mess status plus surplus papyrus walrus lotus focus series abacus citrus hummus couscous "
    "specimen abdomen spaghetti broccoli media data this is us yes always"
)


def test_the_list_is_long_enough() -> None:
    assert len(PAIRS) > 400


@pytest.mark.parametrize(("one", "many"), PAIRS)
def test_singular_and_plural(one: str, many: str) -> None:
    assert plural(one) == many
    assert singular(many) == one
    assert singular(one) == one
    assert is_plural(many) == (many != one or one in MASS | PLURAL_ONLY)
    assert not is_plural(one) or one in MASS | PLURAL_ONLY


@pytest.mark.parametrize(("one", "many"), _ALSO)
def test_a_second_plural_is_read(one: str, many: str) -> None:
    assert singular(many) == one


@pytest.mark.parametrize("word", _SINGULAR.split())
def test_singular_nouns_that_look_like_plurals(word: str) -> None:
    assert singular(word) == word
    assert not is_plural(word)


@pytest.mark.parametrize(
    ("phrase", "one", "noun"),
    [
        ("cups of tea", "cup of tea", "cup"),
        ("chests of drawers", "chest of drawers", "chest"),
        ("chest of drawers", "chest of drawers", "chest"),
        ("tables with drawers", "table with drawers", "table"),
        ("wine glasses", "wine glass", "glass"),
        ("glasses cases", "glasses case", "case"),
    ],
)
def test_the_head_of_a_phrase_changes(phrase: str, one: str, noun: str) -> None:
    assert singular(phrase) == one
    assert head(one) == noun
    assert singular(plural(one)) == one


def test_no_noun_is_no_error() -> None:
    assert singular("") == head("") == ""
    assert singular("of") == "of"


@given(st.text(alphabet="abcehfilmnosuvxyz ", max_size=12))
def test_the_singular_of_any_word_is_final(word: str) -> None:
    assert singular(singular(word)) == singular(word)


@given(st.sampled_from(PAIRS), st.sampled_from(PAIRS))
def test_normalise_takes_singular_and_plural_alike(first: tuple[str, str], second: tuple[str, str]) -> None:
    assert normalise(f"{first[0]} {second[0]}") == normalise(f"{first[1]} {second[1]}")
