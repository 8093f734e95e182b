"""Fit the correction of the affinity rule for hazy scenes, on rooms fitted from photographs with known objects.

    python -m scenewright.training.hazy_affinity --fits FOLDER

Writes `affinity_haze.json` beside `affinity.py`; to be run again after `training.affinity`. The rooms are those of
`fitted_rooms.py`, whose fits are kept in FOLDER: a quarter of an hour on one processor the first time. Borders are
collected in rounds, as for the rule itself. Every room has the same total weight, and the weights of the features are
held near zero: a network that was fitted on these few rooms and on generated ones joined different objects in fitted
rooms that it had not seen, and lost in generated ones.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from ..gaussians.language.segmentation import affinity
from ..gaussians.language.segmentation.haze import Correction, HazyRule, correction_inputs, correction_of
from ..gaussians.language.segmentation.learned_rule import Rule, load_rule
from .affinity import LabelledGraph, collect_borders, labelled_graph
from .fitted_rooms import HELD_OUT, ROOMS, fitted_room
from .rules import Examples, joined, judge

F64 = NDArray[np.float64]
ROUNDS = 1
ROOM_WEIGHT = 1000.0  # total weight of the borders of one room, in each fit
RIDGE = 10.0  # penalty on squared weights of features; constant and slope are nearly free
FREE = 0.01


def fit_correction(rule: Rule, rooms: Sequence[LabelledGraph], seed: int) -> dict[str, Any]:
    """The table of the correction after all rounds."""
    rng = np.random.default_rng(seed)
    count = len(affinity.FEATURES)
    weights, collected = np.zeros(2 + count), []
    for _ in range(ROUNDS + 1):
        now = Correction(weights[0], weights[1], weights[2:])
        for known in rooms:
            haze = known.graph.haze
            found = collect_borders(known, HazyRule(rule, now, haze), rng)
            collected.append((haze, found))
        weights = _logistic(*_stacked(rule, collected))
    return {
        "features": list(affinity.FEATURES),
        "constant": round(float(weights[0]), 5),
        "slope": round(float(weights[1]), 5),
        "weights": np.round(weights[2:], 5).tolist(),
        "borders": sum(len(found.same) for _, found in collected),
    }


def _stacked(rule: Rule, collected: Sequence[tuple[float, Examples]]) -> tuple[F64, F64, F64, F64]:
    """Log-odds of the rule `[B]`, inputs of the correction `[B, 2 + F]`, answers `[B]` and weights `[B]`."""
    parts = []
    for haze, found in collected:
        odds, inputs = correction_inputs(rule, found.features, haze)
        parts.append((odds, inputs, found.same.astype(np.float64), found.cost * (ROOM_WEIGHT / found.cost.sum())))
    odds, inputs, same, cost = (np.concatenate(column) for column in zip(*parts, strict=True))
    return odds, inputs, same, cost / (ROUNDS + 1)


def _logistic(odds: F64, inputs: F64, same: F64, cost: F64) -> F64:
    """Weights `[2 + F]` of the inputs, added to the log-odds, by penalised maximum likelihood."""
    penalty = np.full(inputs.shape[1], RIDGE)
    penalty[:2] = FREE

    def loss(weights: F64) -> tuple[float, F64]:
        now = odds + inputs @ weights
        likely = 1 / (1 + np.exp(-np.clip(now, -40, 40)))
        value = (cost * (np.logaddexp(0, now) - same * now)).sum() + (penalty * weights**2).sum() / 2
        return float(value), inputs.T @ (cost * (likely - same)) + penalty * weights

    result: F64 = minimize(loss, np.zeros(inputs.shape[1]), jac=True, method="L-BFGS-B", options={"maxiter": 500}).x
    return result


def accuracy(rule: Rule, correction: Correction, rooms: Sequence[LabelledGraph], seed: int) -> dict[str, float]:
    """Accuracy of the corrected rule on the borders that it meets in rooms, see `rules.judge`."""
    found, right = [], {}
    for known in rooms:
        hazy = HazyRule(rule, correction, known.graph.haze)
        found.append(judge(hazy, joined([collect_borders(known, hazy, np.random.default_rng(seed))])))
    for name in found[0] if found else ():
        right[name] = round(float(np.mean([f[name] for f in found])), 4)
    return right


def main() -> None:
    """Fit the correction, from the command line."""
    parser = argparse.ArgumentParser(prog="python -m scenewright.training.hazy_affinity")
    parser.add_argument("--fits", type=Path, required=True, help="folder where fitted rooms are kept; made if missing")
    parser.add_argument("--seed", type=int, default=9000)
    parser.add_argument("--out", type=Path, default=Path(affinity.__file__).with_name("affinity_haze.json"))
    args = parser.parse_args()
    rule = load_rule("affinity", affinity.FEATURES)
    known, held = (
        [labelled_graph(*fitted_room(recipe, args.fits)) for recipe in recipes] for recipes in (ROOMS, HELD_OUT)
    )
    table = fit_correction(rule, known, args.seed)
    correction = correction_of(table, affinity.FEATURES)
    table["held_out"] = accuracy(rule, correction, held, args.seed)
    args.out.write_text(json.dumps(table) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
