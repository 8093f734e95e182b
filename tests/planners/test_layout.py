"""The layout solver: whatever it returns is sound by the checker's word, and whatever it refuses it explains."""

from __future__ import annotations

from collections import Counter

import pytest
from amounts import some
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenewright.gaussians.world.support import SHELL
from scenewright.planners.layout import Conflict, Item, Keepout, Layout, Problem, Stand, Wish, solve
from scenewright.planners.layout.verify import STATED
from scenewright.planners.rooms.check import check

UNSOUND = {"collision", "bounds", "support"}
NAMES = ("left_of", "right_of", "in_front_of", "behind", "next_to", "facing", "around", "aligned_with", "far_from")
ALONE = ("against_wall", "in_corner", "in_center", "at_window")


def item(id: str, size: tuple[float, float, float] = (0.5, 0.5, 0.5), **more: object) -> Item:
    return Item.model_validate({"id": id, "label": id, "size": size, **more})


def wish(subject: str, name: str, *objects: str, hard: bool = True) -> Wish:
    return Wish.model_validate({"subject": subject, "name": name, "objects": objects, "hard": hard})


def room(
    *items: Item, wishes: tuple[Wish, ...] = (), size: tuple[float, float, float] = (4.0, 4.0, 2.5), **more: object
) -> Problem:
    return Problem.model_validate({"size": size, "items": items, "wishes": wishes, **more})


def unsound(layout: Layout) -> list[str]:
    return [v.sentence for v in check(layout.graph).violations if v.kind in UNSOUND]


def without_time(layout: Layout) -> str:
    return layout.model_copy(update={"seconds": 0.0}).model_dump_json()


DOOR = item("door", (0.9, 0.08, 2.0), support="wall", stand=Stand(position=(1.0, -1.96, 1.0), yaw=180.0))

lengths = st.floats(0.0, 2.2).map(lambda v: round(v, 2))


@st.composite
def problems(draw: st.DrawFn) -> Problem:
    """Rooms from closets to halls, with things of all sizes, also none, on anything, and any wishes."""
    size = tuple(draw(st.floats(0.5, 6.0).map(lambda v: round(v, 2))) for _ in range(2))
    count = draw(st.integers(0, 8))
    names = [f"thing {k}" for k in range(count)]
    items = []
    for k, name in enumerate(names):
        support = draw(st.sampled_from(["floor", "floor", "floor", "wall", "ceiling", *names[:k], *names[k + 1 :]]))
        clear = draw(st.sampled_from([(0.0, 0.0, 0.0, 0.0), (0.5, 0.0, 0.0, 0.0), (0.2, 0.2, 0.2, 0.2)]))
        box = (draw(lengths), draw(lengths), draw(lengths))
        items.append(
            item(name, box, support=support, clear=clear, backed=draw(st.booleans()), optional=draw(st.booleans()))
        )
    wishes = []
    for _ in range(draw(st.integers(0, 6)) if count > 1 else 0):
        one, other = draw(st.permutations(names))[:2]
        if draw(st.booleans()):
            wishes.append(wish(one, draw(st.sampled_from(NAMES)), other, hard=draw(st.booleans())))
        else:
            wishes.append(wish(one, draw(st.sampled_from(ALONE)), hard=draw(st.booleans())))
    free = [Keepout(name="rug", radius=draw(st.floats(0.2, 1.0)))] if draw(st.booleans()) else []
    return Problem.model_validate({"size": (*size, 2.5), "items": items, "wishes": wishes, "free": free})


@settings(max_examples=some(60), deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(problems(), st.integers(0, 3))
@pytest.mark.slow
def test_what_is_returned_is_sound_and_all_is_accounted_for(problem: Problem, seed: int) -> None:
    layout = solve(problem, seed, effort=0.3)
    assert not unsound(layout)
    assert not [v for v in check(layout.graph).violations if v.kind == "relation"]
    placed = {n.id for n in layout.graph.nodes}
    assert placed.isdisjoint(layout.left_out) and placed | set(layout.left_out) == {i.id for i in problem.items}
    assert Counter(layout.kept) + Counter(layout.broken) == Counter(problem.wishes)
    statable = {(w.subject, w.name, w.objects[0]) for w in layout.kept if w.name in STATED}
    assert set(layout.graph.relations) == statable
    mandatory = {i.id for i in problem.items if not i.optional}
    hard = [w for w in layout.broken if w.hard and {w.subject, *w.objects} <= placed]
    failed = bool(hard or mandatory & set(layout.left_out))
    assert layout.conflicts if failed else layout.ok or problem.free, "a disc without a place is a failure too"


@settings(max_examples=some(15), deadline=None)
@given(problems())
@pytest.mark.slow
def test_the_same_problem_and_seed_give_the_same_layout(problem: Problem) -> None:
    assert without_time(solve(problem, 5, effort=0.3)) == without_time(solve(problem, 5, effort=0.3))


def test_an_empty_room_is_laid_out() -> None:
    layout = solve(room())
    assert layout.ok and layout.graph.nodes == ()


def test_one_thing_is_placed() -> None:
    layout = solve(room(item("sofa", (2.0, 0.9, 0.8), backed=True)))
    (sofa,) = layout.graph.nodes
    assert layout.ok and check(layout.graph).ok
    assert max(abs(sofa.position[0]), abs(sofa.position[1])) == pytest.approx(2.0 - 0.45), "its back is at a wall"


def test_a_thing_that_fits_only_exactly_is_placed() -> None:
    layout = solve(room(item("shelf", (2.0, 4.0, 1.0)), item("box", (2.0, 4.0, 1.0)), walkway=0.0))
    assert layout.ok and not unsound(layout)


def test_a_piano_in_a_closet_is_refused_with_both_sizes() -> None:
    layout = solve(room(item("grand piano", (1.5, 1.4, 1.0)), size=(1.0, 1.0, 2.5)))
    (conflict,) = layout.conflicts
    assert layout.left_out == ("grand piano",) and conflict.subjects == ("grand piano",)
    assert conflict.statements == (
        "the grand piano (grand piano) is 1.5 m wide, 1.4 m deep and 1 m high",
        "the room is 1 m wide, 1 m deep and 2.5 m high",
    )


def test_contradicting_wishes_are_exactly_the_conflict() -> None:
    asked = (wish("a", "left_of", "b"), wish("c", "left_of", "a"), wish("b", "left_of", "a"))
    layout = solve(room(item("a"), item("b"), item("c"), wishes=asked))
    (conflict,) = layout.conflicts
    assert set(conflict.statements) == {"the a (a) is left of the b (b)", "the b (b) is left of the a (a)"}
    assert asked[1] in layout.kept and not unsound(layout)


BED = (1.8, 2.0, 0.5)
IMPOSSIBLE = {
    "ring": room(
        item("a"),
        item("b"),
        item("c"),
        wishes=(wish("a", "left_of", "b"), wish("b", "left_of", "c"), wish("c", "left_of", "a")),
    ),
    "beds": room(item("a", BED), item("b", BED), item("c", (0.3, 0.3, 0.3)), size=(3.0, 3.0, 2.5)),
    "places": room(item("a"), item("b"), wishes=(wish("a", "in_corner"), wish("a", "in_center"))),
    "apart": room(item("a"), item("b"), wishes=(wish("a", "next_to", "b"), wish("a", "far_from", "b"))),
}


@pytest.mark.parametrize("name", IMPOSSIBLE)
def test_a_conflict_is_minimal(name: str) -> None:
    """Without any one of the wishes and sizes in it, the problem is solved."""
    problem = IMPOSSIBLE[name]
    (conflict,) = solve(problem).conflicts
    assert len(conflict.statements) >= 2
    for said in conflict.statements:
        eased = _eased(problem, conflict, said)
        assert solve(eased).ok, said


def _eased(problem: Problem, conflict: Conflict, said: str) -> Problem:
    """The problem without one statement, as the sentence tells it."""
    if said.startswith("the room"):
        return problem.model_copy(update={"size": tuple(3 * s for s in problem.size)})
    if " wide" in said:
        small = tuple(
            i.model_copy(update={"size": (0.1, 0.1, 0.1)}) if f"({i.id}) is" in said else i for i in problem.items
        )
        return problem.model_copy(update={"items": small})
    meant = {w.name.split("_")[-1]: w for w in problem.wishes}
    words = {
        "left_of": "left of the {}",
        "in_corner": "corner",
        "in_center": "middle",
        "next_to": "next",
        "far_from": "far",
    }
    gone = [w for w in problem.wishes if f"({w.subject}) is" in said and words[w.name].format(*w.objects) in said]
    assert len(gone) == 1 and meant
    return problem.model_copy(update={"wishes": tuple(w for w in problem.wishes if w not in gone)})


def test_things_that_stay_are_not_moved_even_out_of_each_other() -> None:
    stands = {"a": Stand(position=(0.0, 0.0, 0.5), yaw=30.0), "b": Stand(position=(0.2, 0.0, 0.5))}
    fixed = [item(n, (1.0, 1.0, 1.0), stand=s) for n, s in stands.items()]
    layout = solve(room(*fixed, item("c", (1.0, 1.0, 1.0)), wishes=(wish("a", "right_of", "b"),)))
    at = {n.id: (n.position, n.yaw) for n in layout.graph.nodes}
    assert all(at[n] == (s.position, s.yaw) for n, s in stands.items())
    assert [v.ids for v in check(layout.graph).violations if v.kind == "collision"] == [("a", "b")]
    assert {"the a (a) stays where it is", "the b (b) stays where it is"} <= set(layout.conflicts[0].statements)


def test_what_stands_on_a_thing_that_is_left_out_is_left_out_with_it() -> None:
    layout = solve(
        room(
            item("piano", (3, 3, 1), optional=True),
            item("vase", (0.1, 0.1, 0.1), support="piano", optional=True),
            size=(1, 1, 2),
        )
    )
    assert set(layout.left_out) == {"piano", "vase"} and layout.ok
    needed = solve(
        room(item("piano", (3, 3, 1), optional=True), item("vase", (0.1, 0.1, 0.1), support="piano"), size=(1, 1, 2))
    )
    assert not needed.ok, "what must be there needs what it stands on"


def test_things_that_stand_on_each_other_are_told() -> None:
    layout = solve(room(item("a", support="b"), item("b", support="a"), item("c", support="a"), item("d")))
    assert set(layout.left_out) == {"a", "b", "c"}
    assert set(layout.conflicts[0].statements) == {"the a (a) stands on the b (b)", "the b (b) stands on the a (a)"}


def test_optional_things_go_first() -> None:
    layout = solve(room(item("a", (1.6, 1.6, 1), optional=True), item("b", (1.6, 1.6, 1)), size=(2, 2, 2.5)))
    assert layout.left_out == ("a",) and layout.ok


def test_a_tall_thing_does_not_fit_under_a_low_ceiling() -> None:
    layout = solve(room(item("wardrobe", (1, 0.6, 2.6)), size=(4, 4, 2.4)))
    assert layout.left_out == ("wardrobe",) and len(layout.conflicts[0].statements) == 2


def test_a_disc_is_kept_free() -> None:
    layout = solve(
        room(
            *(item(f"t{k}", (0.8, 0.8, 0.7)) for k in range(5)),
            free=(Keepout(name="dance floor", radius=1.0, center=(0.0, 0.0)),),
        )
    )
    assert layout.ok
    for node in layout.graph.nodes:
        nearest = [max(abs(c) - 0.4, 0.0) for c in node.position[:2]]
        assert nearest[0] ** 2 + nearest[1] ** 2 >= 1.0 - 1e-3  # positions are written to a tenth of a millimetre


def test_everything_can_be_walked_up_to() -> None:
    things = [item(f"t{k}", (0.9, 0.6, 1.2), clear=(0.4, 0, 0, 0)) for k in range(9)]
    layout = solve(room(DOOR, *things))
    assert layout.ok and check(layout.graph).ok


def test_chairs_stand_around_their_table_and_face_it() -> None:
    chairs = [item(f"chair {k}", (0.45, 0.5, 0.9)) for k in range(6)]
    asked = tuple(wish(str(c.id), "around", "table") for c in chairs)
    layout = solve(room(DOOR, item("table", (1.8, 0.9, 0.75)), *chairs, wishes=asked, size=(5, 4, 2.5)))
    assert layout.ok and len(layout.kept) == 6 and check(layout.graph).ok
    yaws = Counter(n.yaw % 360 for n in layout.graph.nodes if n.label.startswith("chair"))
    assert sorted(yaws.values()) == [1, 1, 2, 2], "two on each long side, one at each end"


def test_what_is_said_to_be_on_a_thing_stands_on_it() -> None:
    layout = solve(
        room(item("table", (1, 1, 0.7)), item("vase", (0.2, 0.2, 0.3)), wishes=(wish("vase", "on", "table"),))
    )
    assert layout.ok and layout.graph.node("vase").support == "table"
    assert layout.graph.relations == (("vase", "on", "table"),)


def test_a_picture_hangs_flush_above_the_sofa() -> None:
    asked = (wish("picture", "above", "sofa"),)
    layout = solve(
        room(item("sofa", (2, 0.9, 0.8), backed=True), item("picture", (0.8, 0.04, 0.6), support="wall"), wishes=asked)
    )
    assert layout.ok and layout.kept == asked and check(layout.graph).ok


def test_things_without_size_do_no_harm() -> None:
    layout = solve(
        room(item("a", (0, 0, 0)), item("b", (0, 1, 0)), item("c", (1, 1, 0)), wishes=(wish("a", "left_of", "b"),))
    )
    assert layout.ok and not unsound(layout)


@pytest.mark.slow
def test_as_many_things_as_a_problem_holds_end_in_bounded_work() -> None:
    things = [item(f"t{k}", (0.5, 0.5, 0.5)) for k in range(512)]
    layout = solve(room(*things, size=(20, 20, 3)))
    assert not unsound(layout) and len(layout.graph.nodes) > 400
    crammed = solve(room(*things, size=(5, 5, 3)))
    assert not unsound(crammed) and crammed.left_out and crammed.conflicts


def test_supports_of_the_graph_exist() -> None:
    hung = item("vase", (0.2, 0.2, 0.2), support="table", stand=Stand(position=(0.0, 0.0, 1.0)))
    layout = solve(room(item("table", (9, 9, 0.9)), hung))
    assert layout.left_out == ("table",)
    assert layout.graph.node("vase").support in SHELL


def test_a_habit_that_would_box_others_in_is_left_out() -> None:
    door = item("door", (0.9, 0.06, 2.0), support="wall", stand=Stand(position=(0.0, -2.97, 1.0), yaw=180.0))
    wide = item("counter", (2.9, 0.6, 1.0), optional=True, stand=None)
    chair = item("chair", (0.5, 0.5, 0.9))
    layout = solve(room(door, wide, chair, size=(3.0, 6.0, 2.5), wishes=(wish("chair", "far_from", "door"),)))
    assert not any(v.kind == "reach" for v in check(layout.graph).violations)


def test_a_place_is_sought_from_which_everything_can_be_reached() -> None:
    """A long counter fits across a corridor at hundreds of places, and along it at a few."""
    door = item("door", (0.9, 0.06, 2.0), support="wall", stand=Stand(position=(0.0, -2.97, 1.0), yaw=180.0))
    box = item("box", (0.5, 0.5, 0.5), stand=Stand(position=(0.0, 2.7, 0.25)))
    counter = item("counter", (2.2, 0.6, 1.0))
    layout = solve(room(door, box, counter, size=(2.3, 6.0, 2.5)))
    assert check(layout.graph).violations == ()
    assert len(layout.graph.nodes) == 3


def test_what_works_behind_a_counter_has_its_aisle() -> None:
    counter = item("counter", (2.0, 0.6, 1.0), backed=True, aisle=0.8, clear=(0.7, 0.75, 0.0, 0.0))
    for seed in range(4):
        node = solve(room(counter, size=(5.0, 6.0, 2.5)), seed).graph.node("counter")
        x, y = node.position[:2]
        fx, fy = {0: (0, -1), 180: (0, 1), 90: (1, 0), -90: (-1, 0)}[round(node.yaw)]
        to_wall = (2.5 + fx * x if fx else 3.0 + fy * y) - 0.3
        assert to_wall == pytest.approx(0.8, abs=0.021)


def test_nothing_hangs_on_the_wall_that_one_looks_in_through_unless_wished() -> None:
    pictures = [item(f"picture {k}", (0.8, 0.03, 0.6), support="wall") for k in range(4)]
    shelf = item("shelf", (1.0, 0.35, 1.8), backed=True)
    seen = solve(room(*pictures, shelf, open=("south",))).graph
    assert min(n.position[1] for n in seen.nodes) > -1.8
    said = Wish(subject="picture 0", name="against_wall", wall="south")
    there = solve(room(*pictures, shelf, open=("south",), wishes=(said,)))
    assert there.kept == (said,)
    assert there.graph.node("picture 0").position[1] < -1.9


def test_a_named_wall_is_kept_and_told() -> None:
    north = Wish(subject="a", name="against_wall", wall="north")
    assert solve(room(item("a"), wishes=(north,))).graph.node("a").position[1] == pytest.approx(1.75, abs=0.1)
    east = Wish(subject="a", name="against_wall", wall="east")
    west = Wish(subject="a", name="against_wall", wall="west")
    (conflict,) = solve(room(item("a"), wishes=(east, west))).conflicts
    assert {"the a (a) is against the east wall", "the a (a) is against the west wall"} <= set(conflict.statements)


def test_at_a_window_of_a_named_wall() -> None:
    left = item("left window", (1.2, 0.08, 1.2), support="wall", stand=Stand(position=(-1.96, 0.0, 1.5), yaw=90.0))
    back = item("back window", (1.2, 0.08, 1.2), support="wall", stand=Stand(position=(0.0, 1.96, 1.5)))
    west = Wish(subject="a", name="at_window", wall="west")
    node = solve(room(left, back, item("a"), wishes=(west,))).graph.node("a")
    assert node.position[0] < -1.0 and abs(node.position[1]) < 1.5
