"""Questions about how things look for a while: colours and what is hidden, in a room whose truth we made."""

from dataclasses import replace

import pytest
import torch

from scenewright.agent.session.session import Session
from scenewright.benchmarks._motion.rooms import moving_room
from scenewright.gaussians.color import parse
from scenewright.gaussians.harmonics import color_to_dc
from scenewright.gaussians.language.field.group_index import index_groups
from scenewright.gaussians.motion.motion import Look


@pytest.fixture(scope="module")
def session() -> Session:
    """The toy robot's room, 0 to 5 s: the bed is red from 1 to 2.5 s, the shelf is hidden from 1 to 1.5 s and from 3 to
    3.25 s."""
    scene = moving_room("toy", 0.1)
    assert scene.motion is not None and scene.language is not None
    index = index_groups(scene.cloud)
    ids = {g.label: index.ids_of([g.id]).sort().values for g in scene.language.groups}
    red = color_to_dc(torch.tensor(parse("red")))[None, None].repeat(len(ids["bed"]), 1, 1).float()
    looks = (
        Look(ids["bed"].numpy(), 1.0, 2.5, sh=red),
        *(
            Look(ids["shelf"].numpy(), a, b, opacities=torch.zeros(len(ids["shelf"])))
            for a, b in ((1.0, 1.5), (3.0, 3.25))
        ),
    )
    return Session(scene.replace(motion=replace(scene.motion, looks=looks)))


@pytest.mark.parametrize(
    ("question", "wanted"),
    [
        ("When does the bed turn red?", 1.0),
        ("When is the bed red?", 1.0),
        ("Until when is the bed red?", 2.5),
        ("When does the bed stop being red?", 2.5),
        ("How long is the bed red?", 1.5),
        ("For how long does the bed stay red?", 1.5),
        ("When is the shelf hidden?", 1.0),
        ("How long is the shelf out of sight?", 0.75),
        ("How often does the shelf blink?", 2.0),
        ("How many times does the shelf disappear?", 2.0),
        ("How many times does the bed change its colour?", 2.0),
        ("Does the shelf blink?", "yes"),
        ("Does the bed ever blink?", "no"),
        ("Does the bed ever turn red?", "yes"),
        ("Does the shelf turn red?", "no"),
        ("Is the bed always red?", "no"),
        ("Is the shelf ever invisible?", "yes"),
        ("Does the toy car change its colour?", "no"),
        ("What changes its colour?", "bed"),
        ("When does the shelf disappear?", 1.0),
        ("When does the shelf disappear for the second time?", 3.0),
        ("When is the shelf back?", 1.5),
        ("How long is the shelf gone each time it blinks?", 0.375),
        ("What colour does the bed turn?", "red"),
        ("Does the bed turn red at some point?", "yes"),
        ("Is the shelf missing at 1.2 s?", "yes"),
        ("Is the shelf missing at 2 s?", "no"),
        ("Which object is the last one to change colour?", "bed"),
        ("How many things change their colour?", 1.0),
        ("Which thing turns red?", "bed"),
        ("What disappears?", "shelf"),
        ("What blinks?", "shelf"),
    ],
)
def test_how_things_look_for_a_while_is_told(session: Session, question: str, wanted: float | str) -> None:
    answer = session.ask(question)
    assert answer.answer == pytest.approx(wanted) if isinstance(wanted, float) else answer.answer == wanted, answer.text


@pytest.mark.parametrize(
    ("question", "said"),
    [
        ("When does the toy car turn red?", "never red"),
        ("When is the bed hidden?", "never hidden"),
        ("What turns blue?", "Nothing turns blue"),
        ("When does the unicorn turn red?", "no unicorn"),
    ],
)
def test_what_never_looks_so_has_no_time(session: Session, question: str, said: str) -> None:
    answer = session.ask(question)
    assert said in answer.text and answer.answer is None


def test_a_colour_before_a_change_is_that_of_the_start(session: Session) -> None:
    start = session.ask("what colour is the bed at 0.5 s?").answer
    assert session.ask("what colour is the bed before it turns red?").answer == start != "red"
