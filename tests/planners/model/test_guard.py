"""Plans that are valid and wrong: each fault is found, told with what would be right, and ends as it should."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from amounts import spread

from scenewright.planners.grammar import GrammarPlanner
from scenewright.planners.model.verify.guard import Fault, Guard
from scenewright.planners.model.verify.removal_words import mentions
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.tools import registry
from scenewright.tools.operation import EditOp

ROOMS = Path(__file__).parents[1] / "written"
LIVING_ROOM = SceneGraph.read(ROOMS / "living_room.json")
OFFICE = LIVING_ROOM.model_copy(update={"nodes": LIVING_ROOM.nodes[:3]})


def op(name: str, text: str = "", **fields: Any) -> EditOp:
    """An operation; fields of the query begin with q_."""
    query = {"text": text, **{k[2:]: v for k, v in fields.items() if k.startswith("q_")}}
    rest = {k: v for k, v in fields.items() if not k.startswith("q_")}
    return registry.parse({"op": name, **({"target": query} if name != "insert" else {}), **rest})


def guard(text: str, previous: str | None = None, graph: SceneGraph | None = LIVING_ROOM) -> Guard:
    return Guard(text, previous, graph, GrammarPlanner())


def faults(text: str, *ops: EditOp, previous: str | None = None, graph: SceneGraph | None = LIVING_ROOM) -> list[Fault]:
    return guard(text, previous, graph).faults(ops)


def kinds(text: str, *ops: EditOp, **known: Any) -> list[str]:
    return [f.kind for f in faults(text, *ops, **known)]


# -- ids -------------------------------------------------------------------------------------------------------------


def test_ids_of_nothing_come_back_with_those_that_are_meant() -> None:
    (fault,) = faults("delete the vase", op("delete", "vase", q_groups=[99]))
    assert fault.kind == "ids" and fault.verdict is None
    assert "no thing has the id 99" in fault.told and "18: blue vase" in fault.told


def test_ids_of_nothing_without_a_name_come_back_with_their_neighbours() -> None:
    (fault,) = faults("delete that", op("delete", q_groups=[22]))
    assert "21: brown teddy bear" in fault.told


def test_ids_within_queries_are_looked_at_too() -> None:
    near = [{"name": "next_to", "anchors": [{"text": "sofa", "groups": [77]}]}]
    assert kinds("delete the plant next to the sofa", op("delete", "plant", q_relations=near)) == ["ids"]


def test_an_id_that_is_something_else_is_no_slip_to_be_trusted() -> None:
    (fault,) = faults("delete the vase", op("delete", "vase", q_groups=[17]))
    assert fault.kind == "ids" and "17 is a mug" in fault.told


def test_ids_without_a_scene_mean_nothing() -> None:
    assert kinds("delete the vase", op("delete", "vase", q_groups=[18]), graph=None) == ["ids"]


def test_right_ids_pass() -> None:
    assert not faults("delete the vase", op("delete", "vase", q_groups=[18]))
    assert not faults("recolor where I watch tv from", op("recolor", "seat", q_groups=[1, 2, 3], color="red"))


# -- ids that choose -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "planned"),
    [
        ("delete the armchair", op("delete", "armchair", q_groups=[2])),
        ("please delete the armchair", op("delete", q_groups=[2])),
        ("paint the armchair red", op("recolor", "armchair", q_groups=[3], q_pick="all", color="red")),
        ("move the cushion 40 cm to the left",
         op("move", "cushion", q_groups=[15], direction="left", distance={"value": 40, "unit": "cm"})),
        ("put the mug on the armchair",
         op("move", "mug", place={"relation": "on", "anchors": [{"text": "armchair", "groups": [2]}]})),
    ],
)  # fmt: skip
def test_ids_do_not_choose_what_the_words_leave_open(text: str, planned: EditOp) -> None:
    (settled,) = guard(text).drop_unstated([planned])
    assert "groups" not in json.dumps(settled.model_dump(exclude_defaults=True, mode="json"))
    assert kinds(text, settled) == ["ambiguous"]  # and so the user is asked


@pytest.mark.parametrize(
    ("text", "groups"),
    [
        ("delete the green armchair", [2]),
        ("delete the armchair where the teddy sits", [3]),
        ("delete any armchair", [3]),
        ("delete the armchairs", [2, 3]),
        ("lösche den grünen Sessel", [2]),
    ],
)
def test_ids_that_the_words_have_a_ground_for_stay(text: str, groups: list[int]) -> None:
    planned = op("delete", "armchair", q_groups=groups, q_pick="all")
    assert guard(text).drop_unstated([planned]) == (planned,)
    assert not faults(text, planned)


def test_ids_that_tell_twins_apart_stay() -> None:
    swapped = (
        op("recolor", "armchair", q_groups=[2], color="yellow"),
        op("recolor", "armchair", q_groups=[3], color="green"),
    )
    for text in ("make the green armchair yellow and the yellow one green", "swap the colors of the armchairs"):
        assert guard(text).drop_unstated(swapped) == swapped
    alone = op("recolor", "armchair", q_groups=[2], color="yellow")
    assert guard("paint the green armchair yellow").drop_unstated([alone]) == (alone,)


# -- colours, shell, it ----------------------------------------------------------------------------------------------


def test_words_that_are_no_colours_come_back_with_some_that_are() -> None:
    (fault,) = faults("paint the sofa teel", op("recolor", "sofa", color="teel"))
    assert fault.kind == "color" and fault.verdict == "not_understood" and "teal" in fault.told
    assert kinds("delete the blu vase", op("delete", "vase", q_colors=["blurple"]))[0] == "color"


def test_colours_that_the_scene_writes_are_colours() -> None:
    assert not faults("delete the walnut stand", op("delete", "tv stand", q_colors=["walnut"]))


@pytest.mark.parametrize("graph", [LIVING_ROOM, None], ids=["scene", "blind"])
@pytest.mark.parametrize("name", ["delete", "duplicate"])
def test_the_shell_of_the_room_stays(graph: SceneGraph | None, name: str) -> None:
    (fault,) = faults(f"{name} the floor", op(name, "floor"), graph=graph)
    assert fault.verdict == "impossible" and "the floor stays" in fault.reason


def test_the_shell_may_be_painted() -> None:
    assert not faults("paint the wall blue", op("recolor", "wall", color="blue"))


def test_it_needs_something_before() -> None:
    (fault,) = faults("paint it red", op("recolor", q_last=True, color="red"))
    assert fault.kind == "last" and fault.verdict == "not_understood"
    assert not faults("paint it red", op("recolor", q_last=True, color="red"), previous="select the sofa")


def test_it_may_be_what_the_step_before_was_about() -> None:
    assert not faults("take the vase, paint it red", op("select", "vase"), op("recolor", q_last=True, color="red"))


def test_an_it_that_cannot_be_told_is_left_to_the_session() -> None:
    planned = op("recolor", q_last=True, color="red")
    assert not faults("paint it red", planned, previous="frobnicate the glorp")


# -- what is taken away ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "planned"),
    [
        ("paint the sofa red", op("delete", "sofa")),
        ("move the lamp left", op("replace", "floor lamp", asset="cactus")),
        ("rotate the vase", op("isolate", "vase")),
        ("make the sofa darker", op("opacity", "sofa", value=0.0)),
        ("what a nice silver thing near the sink", op("delete", "vase")),
        ("die Lampe soll rot sein", op("delete", "floor lamp")),
    ],
)
@pytest.mark.parametrize("graph", [LIVING_ROOM, None], ids=["scene", "blind"])
def test_nothing_is_taken_away_that_nobody_asked_to(text: str, planned: EditOp, graph: SceneGraph | None) -> None:
    fault = faults(text, planned, graph=graph)[0]
    assert (fault.kind, fault.verdict) == ("groundless", "not_understood")
    assert planned.op in fault.reason and "If you mean it, say so" in fault.reason


@pytest.mark.parametrize(
    ("text", "planned"),
    [
        ("get rid of the sofa", op("delete", "sofa")),
        ("the sofa has to go", op("delete", "sofa")),
        ("I don't want the rug any more", op("delete", "rug")),
        ("lösche den Teppich", op("delete", "rug")),
        ("supprime le tapis", op("delete", "rug")),
        ("удали ковёр", op("delete", "rug")),
        ("把地毯删掉", op("delete", "rug")),
        ("ラグを削除して", op("delete", "rug")),
        ("make the vase a cactus", op("replace", "vase", asset="cactus")),
        ("swap the vase for something green", op("replace", "vase", asset="cactus")),
        ("keep only the sofa", op("isolate", "sofa")),
        ("hide the sofa", op("opacity", "sofa", value=0.0)),
        ("let me see through the sofa a bit", op("opacity", "sofa", value=0.5)),
    ],
)
def test_what_is_asked_for_passes(text: str, planned: EditOp) -> None:
    assert not faults(text, planned)


def test_the_instruction_before_is_a_ground_too() -> None:
    assert not faults("the vase too", op("delete", "vase"), previous="delete the mug")


@pytest.mark.parametrize(
    "everything",
    [
        op("delete", "everything", q_pick="all"),
        op("delete", q_pick="all"),
        op("delete", "vase", q_invert=True),
        op("delete", "vase", q_pick="rest"),
        op("opacity", "thing", q_pick="all", value=0.0),
    ],
)
@pytest.mark.parametrize("graph", [LIVING_ROOM, None], ids=["scene", "blind"])
def test_everything_goes_only_where_all_was_said(everything: EditOp, graph: SceneGraph | None) -> None:
    assert "sweeping" in kinds("delete the vase, hide the mug", everything, graph=graph)
    assert "sweeping" not in kinds("delete everything, hide all", everything, graph=graph)


def test_much_that_nobody_named_does_not_go_one_by_one() -> None:
    each = [op("delete", n.label, q_groups=[n.id]) for n in LIVING_ROOM.nodes if n.label != "vase"]
    assert kinds("delete the vase", *each)[0] == "sweeping"
    assert "sweeping" not in kinds("clear the room", *each)


def test_much_that_was_named_goes() -> None:
    seats = OFFICE.model_copy(update={"nodes": LIVING_ROOM.nodes[1:3]})
    assert not faults("delete the armchairs", op("delete", "armchair", q_pick="all"), graph=seats)


@pytest.mark.parametrize("room", spread(sorted(ROOMS.glob("*.json")), 3), ids=lambda p: p.stem)
def test_what_people_wrote_is_never_refused_for_want_of_grounds(room: Path) -> None:
    # What the grammar makes of the written instructions, right or wrong, is at least asked for.
    graph, planner = SceneGraph.read(room), GrammarPlanner()
    for case in map(json.loads, (ROOMS / "instructions.jsonl").read_text("utf-8").splitlines()):
        if case["room"] == room.stem and case["verdict"] == "ok":
            plan = planner.plan(case["text"], previous=case.get("context"))
            found = kinds(case["text"], *plan.ops, previous=case.get("context"), graph=graph)
            assert not {"groundless", "sweeping"} & set(found), case["id"]


def test_words_that_only_begin_like_grounds_are_none() -> None:
    harmless = "move the thing with silver stripes near the sink at noon; make her garden chair quite wide"
    assert [g for g in ("removing", "exchanging", "keeping", "hiding", "all") if mentions(g, harmless)] == []  # type: ignore[arg-type]


# -- what the scene says ---------------------------------------------------------------------------------------------


def test_absent_and_ambiguous_are_told_with_what_there_is_and_may_stand() -> None:
    (absent,) = faults("delete the piano", op("delete", "piano"))
    (ambiguous,) = faults("delete the plant", op("delete", "plant"))
    assert (absent.kind, absent.verdict) == ("absent", "ok")
    assert (ambiguous.kind, ambiguous.verdict) == ("ambiguous", "ok")
    assert "12: green potted plant" in ambiguous.told and "13: green potted plant" in ambiguous.told


def test_what_cannot_be_ends_as_impossible() -> None:
    inside = {"relation": "inside", "anchors": [{"text": "vase"}]}
    (fault,) = faults("put the sofa into the vase", op("move", "sofa", place=inside))
    assert fault.verdict == "impossible" and "too large" in fault.reason


def test_refusals_are_told_before_what_may_stand() -> None:
    planned = [op("recolor", "plant", color="red"), op("delete", "sofa")]
    assert kinds("paint the plant red", *planned) == ["groundless", "unasked", "ambiguous"]


def test_no_operations_have_no_faults() -> None:
    assert faults("hello") == []


# -- one, and not all ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "name", "pick", "settled"),
    [
        ("delete the armchair", "armchair", "all", "one"),
        ("delete the armchair", "armchair", "any", "one"),
        ("now make my old armchair red", "armchair", "all", "one"),
        ("delete the armchairs", "armchair", "all", "all"),
        ("delete every armchair", "armchair", "all", "all"),
        ("delete an armchair", "armchair", "any", "any"),
        ("delete any of the armchair things", "armchair", "any", "any"),
        ("delete the armchair on the left and the one by the sofa", "armchair", "all", "all"),
        ("delete the armchair and that armchair", "armchair", "all", "all"),
        ("delete the furniture", "furniture", "all", "all"),
        ("lösche den Sessel", "armchair", "all", "all"),
        ("delete the armchair", "armchair", "largest", "largest"),
    ],
)
def test_where_one_was_said_it_is_never_all(text: str, name: str, pick: str, settled: str) -> None:
    (made,) = guard(text).drop_unstated([op("delete", name, q_pick=pick)])
    query = made.query()
    assert query is not None and query.pick == settled


@pytest.mark.parametrize(
    ("text", "grounded"),
    [
        ("make the sofa teal", False),
        ("now, please paint the sofa teal", False),
        ("and the sofa", True),
        ("the sofa as well", True),
        ("do the same to the sofa", True),
        ("get the sofa too", True),
        ("und das Sofa", True),
    ],
)
def test_a_command_of_its_own_takes_no_ground_from_the_one_before(text: str, grounded: bool) -> None:
    found = kinds(text, op("delete", "sofa"), previous="delete the floor lamp")
    assert ("groundless" not in found) == grounded


def test_everything_that_went_before_is_no_ground_for_everything_now() -> None:
    planned = op("opacity", "everything", q_pick="all", value=0.0)
    assert "sweeping" in kinds("hide the sofa", planned, previous="show everything")


@pytest.mark.parametrize(
    ("text", "previous", "kept"),
    [
        ("delete the armchair", None, ()),
        ("please move the armchair to the left", None, ()),
        ("delete the green armchair", None, ("green",)),
        ("delete the armchair", "make the green lamp red", ("green",)),
        ("delete the emerald armchair", None, ("green",)),
        ("delete her armchair", None, ("green",)),
        ("lösche den grünen Sessel", None, ("green",)),
    ],
)
def test_colours_that_nobody_said_choose_nothing(text: str, previous: str | None, kept: tuple[str, ...]) -> None:
    planned = op("move", "armchair", q_colors=["green"], direction="left")
    (made,) = guard(text, previous).drop_unstated([planned])
    query = made.query()
    assert query is not None and query.colors == kept and query.text == "armchair"


def test_a_colour_to_paint_with_is_none_to_look_for() -> None:
    (made,) = guard("paint the armchair green").drop_unstated(
        [op("recolor", "armchair", q_colors=["gray"], color="green")]
    )
    assert made.query().colors == () and made.color == "green"  # type: ignore[attr-defined,union-attr]
