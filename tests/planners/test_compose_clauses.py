"""Descriptions to briefs: places before their thing, lists that share a place, what each has, words for no things."""

from __future__ import annotations

import pytest

from scenewright.planners.compose import Brief, compose, read


def told(brief: Brief) -> set[str]:
    """The relations of a brief as "subject name object"."""
    names = {t.id: t.name for t in brief.things}
    return {" ".join([names[r.subject], r.name, *(names[o] for o in r.objects)]) for r in brief.relations}


def counts(brief: Brief) -> dict[str, int]:
    """How many things there are of each name."""
    found: dict[str, int] = {}
    for thing in brief.things:
        found[thing.name] = found.get(thing.name, 0) + thing.count
    return found


@pytest.mark.parametrize(
    ("text", "relations"),
    [
        ("a bedroom with a bunk bed and under the bed theres a box", {"box under bunk bed"}),
        ("a shop: a counter, on it a till and a vase", {"cash register on counter", "vase on counter"}),
        ("a room. Behind the counter, three shelves.", {"shelf behind counter"}),
        ("a sofa, on the left of the sofa a floor lamp, on its right a tall plant",
         {"floor lamp left_of sofa", "potted plant right_of sofa"}),
        ("a room with a lamp and a clock on the desk", {"table lamp on desk", "clock on desk"}),
        ("a spade and a rake leaning on the wall of a shed", {"spade against_wall", "rake against_wall"}),
        ("a stage with an upright piano, a drum kit and a double bass on it",
         {"piano on stage", "drum kit on stage", "double bass on stage"}),
        ("a white cot with a mobile hanging over it, a rocking chair next to it", {"rocking chair next_to crib"}),
        ("two sofas facing each other across a coffee table", {"coffee table between sofa"}),
        ("a studio. A bookcase separates the bed from the sofa.", {"bookshelf between bed sofa"}),
        ("a desk with a lamp next to the wardrobe", {"desk next_to wardrobe"}),
        ("a washer and a dryer side by side", {"dryer next_to washing machine"}),
        ("a room with eight chairs round a long table", {"chair around large table"}),
    ],
)  # fmt: skip
def test_a_relation_is_found_wherever_its_words_stand(text: str, relations: set[str]) -> None:
    assert relations <= told(read(text))


@pytest.mark.parametrize(
    ("text", "there", "elsewhere"),
    [
        ("a living room with a sofa, an armchair and a coffee table on a rug",
         {"sofa", "armchair", "coffee table"}, set()),
        ("a kids room with a bed, a desk, a bookshelf, a toy car and a ball on a rug",
         {"toy car", "ball"}, {"bed", "desk", "bookshelf"}),
        ("a bedroom with a bed, a wardrobe and a cat on a rug", {"cat"}, {"bed", "wardrobe"}),
        ("a dining table and four chairs on a rug", {"dining table", "chair"}, set()),
    ],
)  # fmt: skip
def test_what_is_much_larger_does_not_share_the_rug_of_what_is_listed_behind_it(
    text: str, there: set[str], elsewhere: set[str]
) -> None:
    relations = told(read(text))
    assert {f"{name} on rug" for name in there} <= relations
    assert not {f"{name} on rug" for name in elsewhere} & relations


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("a bathroom with two basins, a mirror above each", {"wash basin": 2, "mirror": 2}),
        ("a tea house: four low tables, around each of them four cushions", {"coffee table": 4, "cushion": 16}),
        ("a ward with four beds, each with a bedside cabinet, a drip stand and a curtain round it",
         {"bed": 4, "nightstand": 4, "drip stand": 4, "curtain": 4}),
        ("two desks, a monitor and a keyboard on each", {"desk": 2, "monitor": 2, "keyboard": 2}),
        ("a bedroom with two beds, a nightstand beside each bed with a lamp on it", {"nightstand": 2, "table lamp": 2}),
        ("an armory with a crate in each corner", {"box": 4}),
        ("a terrace with olive trees in two of the corners", {"olive tree": 2}),
        ("a dining table with a chair at each end and three along each side", {"dining table": 1, "chair": 8}),
        ("a table, two chairs on one side and one on the other", {"table": 1, "chair": 3}),
        ("a courtyard with a fountain, four benches around it, one on each side", {"fountain": 1, "bench": 4}),
        ("office for 4 people. each desk w/ chair, lamp & laptop",
         {"desk": 4, "chair": 4, "table lamp": 4, "laptop": 4}),
        ("a round table with two chairs, one green and one orange", {"round table": 1, "chair": 2}),
        ("a desk with magazines on it", {"books": 2}),
    ],
)  # fmt: skip
def test_things_are_there_in_the_number_that_the_words_distribute(text: str, number: dict[str, int]) -> None:
    found = counts(read(text))
    assert {name: found.get(name) for name in number} == number


@pytest.mark.parametrize(
    ("text", "absent"),
    [
        ("a loft studio for a painter: three easels", "painter"),
        ("a bench for people waiting against the wall", "person"),
        ("an altar stands at the far end, the bird cage stands by the window", "stand"),
        ("yurt with a wood stove and a low bed", "yurt"),
        ("bus shelter, one bench, a litter bin to the left of it", "bus shelter"),
        ("a crate used as a table beside the deck chair", "table"),
        ("a bench made of bamboo", "bamboo"),
        ("a campsite by the lake with two tents", "lake"),
        ("bus station cafe; counter with a till", "bus"),
        ("a stack of crates behind the counter", "stack"),
        ("a dungeon: stone floor, iron cage", "stone"),
        ("lavender in big pots on a terrace", "cooking pot"),
    ],
)
def test_whom_and_what_a_thing_is_for_is_no_thing(text: str, absent: str) -> None:
    assert absent not in counts(read(text))


def test_a_size_behind_a_thing_is_that_of_the_thing() -> None:
    brief = read("a workshop. In the middle stands a cutting table, 1.2 m wide, with scissors on it.")
    assert brief.size is None
    assert [t.width for t in brief.things if t.name == "cutting table"] == [1.2]


@pytest.mark.parametrize("text", ["a dryer along the qwertz", "a lamp next to the zorblax and a bed"])
def test_a_place_that_is_not_understood_is_told(text: str) -> None:
    brief = read(text)
    assert brief.unknown or any("was not understood" in r for r in brief.remarks)


def test_what_is_above_a_table_in_the_middle_hangs_from_the_ceiling() -> None:
    composition = compose("a vet's room. Steel table in the centre with a lamp above it.")
    assert composition.ok
    lamp = next(n for n in composition.layout.graph.nodes if "lamp" in n.label)
    assert lamp.support == "ceiling"


def test_a_counter_at_a_wall_leaves_an_aisle_for_what_is_behind_it_and_says_so() -> None:
    composition = compose("a cheese shop. The counter runs along the back wall. Behind the counter, three shelves.")
    assert composition.ok
    assert any("from the wall" in r for r in composition.remarks)


@pytest.mark.parametrize(
    "text",
    [
        "a shed: workbench under the window, vice on the workbench",
        "a kitchen with a sink under the window",
        "a balcony with window boxes on the railing",
        "a bathroom with a freestanding tub in the center and a towel rail next to the tub",
        "a roof terrace with a round table and six chairs around it, a parasol, and olive trees in two of the corners",
        "a table with brushes in a jar",
        "a waiting room. Eight chairs in two rows of four facing each other, with a low table between them",
        "five chairs in a semicircle facing a television",
    ],
)
def test_what_is_possible_is_neither_refused_nor_broken(text: str) -> None:
    composition = compose(text)
    assert composition.ok
    assert not composition.unmet
