"""Laws of undo and redo: going back and forth leads to the very same values."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.agent.session.history import DEPTH, History, State
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.scene import Scene


def _state(text: str = "") -> State:
    return State(Scene(GaussianCloud.empty()), None, text)


@given(st.lists(st.sampled_from("dur"), max_size=60))
def test_any_walk_agrees_with_a_list_and_an_index(walk: list[str]) -> None:
    first = _state()
    history, model, at = History(first), [first], 0
    for step in walk:
        if step == "d":
            state = _state("x")
            history.advance(state)
            model, at = [*model[: at + 1], state], at + 1
        elif step == "u" and at > 0:
            assert history.undo() is model[at - 1]
            at -= 1
        elif step == "r" and at < len(model) - 1:
            assert history.redo() is model[at + 1]
            at += 1
        assert history.present is model[at]


def test_there_is_nothing_beyond_the_ends() -> None:
    history = History(_state())
    with pytest.raises(UserError, match="nothing to undo"):
        history.undo()
    with pytest.raises(UserError, match="nothing to redo"):
        history.redo()


def test_old_states_are_let_go() -> None:
    history = History(_state())
    for _ in range(DEPTH + 10):
        history.advance(_state())
    assert len(history.past) == DEPTH
