"""The network tells kinds and marks as the learner does, and its weights are read as they were written."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import torch

from scenewright.planners.grammar.learned.files import LEVELS, store, stored
from scenewright.planners.grammar.learned.network import ROWS, Network, Networks, networks, pieces
from scenewright.planners.grammar.learned.seen import classed
from scenewright.training.wording import Learner, Sentence

TASKS = {
    "wishes": [Sentence("1", "hide", "hide [x the fan] [t at 2 s]"), Sentence("1", "stop", "stop [x the fan]")],
    "questions": [Sentence("1", "when", "when does [x the fan] stop"), Sentence("2", "where", "where is [y it]")],
}


@pytest.fixture
def learner() -> Learner:
    torch.manual_seed(4)
    made = Learner(TASKS).eval()
    for moves in made.moves.values():
        torch.nn.init.normal_(moves)
    return made


@pytest.mark.parametrize("task", TASKS)
def test_it_tells_what_the_learner_tells(learner: Learner, task: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The learner is the reference: its layers are those of torch."""
    monkeypatch.setattr("scenewright.training.wording.HIDDEN_WORDS", 0.0)
    words = ["when", "does", "the", "unheard-of", "fan", "stop", "2", "?"]
    with torch.no_grad():
        kinds, marks, _ = learner._scores(task, [words], random.Random(0))
    model = learner.learned()
    chances = dict(zip(learner.lists[f"kinds.{task}"], kinds[0].softmax(0).tolist(), strict=True))
    told = Networks((model,)).told(task, words)
    assert dict(told.kinds) == pytest.approx(chances, abs=1e-5)
    assert [kind for kind, _ in told.kinds] == sorted(chances, key=chances.__getitem__, reverse=True)
    held = model._held(words)
    assert model._linear(f"labels.{task}", held) == pytest.approx(marks[0].numpy(), abs=1e-5)


def test_it_is_read_as_it_was_written(learner: Learner, tmp_path: Path) -> None:
    model = learner.learned()
    Networks((model, model)).write(tmp_path / "a.npz")
    read = Networks.of(tmp_path / "a.npz").members
    assert [own.lists for own in read] == [model.lists] * 2
    for own in read:
        for name, values in model.weights.items():
            assert np.abs(own.weights[name] - values).max() <= np.abs(values).max() / LEVELS / 2 + 1e-6, name


def test_several_tell_their_mean(learner: Learner) -> None:
    one = learner.learned()
    other = Network(one.lists, {name: -values for name, values in one.weights.items()})
    words = ["hide", "the", "fan"]
    chances = [own.scores("wishes", words)[0] for own in (one, other)]
    told = dict(Networks((one, other)).told("wishes", words).kinds)
    assert [told[kind] for kind in one.lists["kinds.wishes"]] == pytest.approx(np.mean(chances, axis=0), abs=1e-6)
    assert Networks((one, one)).told("wishes", words) == Networks((one,)).told("wishes", words)


def test_weights_are_stored_to_half_a_step(tmp_path: Path) -> None:
    weights = np.random.default_rng(1).normal(size=(5, 3)).astype(np.float32)
    store(tmp_path / "a.npz", {"names": ["a b", "ü"], "labels": ["c"]}, {"weights": weights})
    lists, read = stored(tmp_path / "a.npz")
    assert lists == {"names": ["a b", "ü"], "labels": ["c"]}
    assert np.abs(read["weights"] - weights).max() <= np.abs(weights).max() / LEVELS / 2 + 1e-6


def test_no_words_tell_nothing() -> None:
    told = networks().told("wishes", ())
    assert told.kinds == told.spans == ()


def test_words_of_one_class_look_alike() -> None:
    assert [classed(w) for w in ("3", "three", "secs", "red", "sofa")] == ["#", "#", "#s", "#color", "#thing"]


@pytest.mark.parametrize(
    ("word", "count"), [("2.5", lambda n: 2), ("stop", lambda n: 2 + 4 + 3 + 2), ("a", lambda n: 3)]
)
def test_words_are_built_of_runs_of_letters(word: str, count: Callable[[int], int]) -> None:
    assert len(pieces(word)) == count(len(word)) and all(0 <= row < ROWS for row in pieces(word))
