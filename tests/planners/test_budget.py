"""Budgets: what words mean, and that nothing is asked when it is used up."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians.errors import BackendError, UserError
from scenewright.planners.budget import SECONDS, Budget, Ledger, Metered, OverBudgetError
from scenewright.planners.plan import EditPlan, NoPlanError, Usage


def usage(dollars: float | None = 0.01, seconds: float = 1.0) -> Usage:
    return Usage(model="fake:1", requests=1, input_tokens=100, output_tokens=10, dollars=dollars, seconds=seconds)


class Fake:
    """A planner that costs a cent and abstains, or fails."""

    name = "fake:1"

    def __init__(self, error: Exception | None = None) -> None:
        self.error, self.calls = error, 0

    def plan(self, text: str, **_: object) -> EditPlan:
        self.calls += 1
        if self.error is not None:
            raise self.error
        return EditPlan(instruction=text, planner=self.name, verdict="not_understood", usage=usage())


@pytest.mark.parametrize(
    ("text", "seconds", "dollars"),
    [
        ("20s", 20, None), ("20", None, None), ("0.05usd", SECONDS, 0.05), ("20s,0.05usd", 20, 0.05),
        ("$0.05, 20 seconds", 20, 0.05), (".5 USD", SECONDS, 0.5), ("1 dollar", SECONDS, 1), ("0s", None, None),
        ("-3s", None, None), ("20s,30s", None, None), ("", None, None), ("$5usd", None, None), ("1e3s", None, None),
        ("nans", None, None), ("infusd", None, None), ("99999999s", None, None), ("20s,", None, None),
    ],
)  # fmt: skip
def test_a_budget_in_words(text: str, seconds: float | None, dollars: float | None) -> None:
    if seconds is None:
        with pytest.raises(UserError, match="for an instruction"):
            Budget.parse(text)
    else:
        assert Budget.parse(text) == Budget(seconds, dollars)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("8views", Budget(views=8)), ("1 view", Budget(views=1)), ("20000tokens", Budget(tokens=20_000)),
        ("20s,0.05usd,8views,20000tokens", Budget(20, 0.05, 8, 20_000)), ("3 Tokens , $1", Budget(dollars=1, tokens=3)),
        ("0views", None), ("1.5views", None), ("2views,3views", None), ("$8views", None), ("9999views", None),
        ("2.5tokens", None), ("-1tokens", None), ("views", None), ("8v", None),
    ],
)  # fmt: skip
def test_views_and_tokens_are_counts_of_a_question(text: str, wanted: Budget | None) -> None:
    if wanted is None:
        with pytest.raises(UserError, match="tokens for a question"):
            Budget.parse(text)
    else:
        assert Budget.parse(text) == wanted


@given(st.text(max_size=30))
def test_any_text_is_a_budget_or_a_user_error(text: str) -> None:
    try:
        budget = Budget.parse(text)
    except UserError:
        return
    assert budget.seconds > 0 and (budget.dollars is None or budget.dollars > 0)


@given(st.lists(st.none() | st.floats(0, 1), max_size=20), st.floats(0.001, 5))
def test_nothing_is_asked_once_the_dollars_are_spent(prices: list[float | None], limit: float) -> None:
    ledger, spent = Ledger(Budget(dollars=limit)), 0.0
    for price in prices:
        if spent >= limit:
            with pytest.raises(OverBudgetError):
                ledger.require()
        else:
            ledger.require()
        ledger.add(usage(price))
        spent += price or 0.0
    assert (ledger.spent.dollars or 0.0 if ledger.spent else 0.0) == pytest.approx(spent)
    assert (ledger.spent.requests if ledger.spent else 0) == len(prices)


def test_a_metered_planner_is_loaded_when_asked_and_stops_at_its_budget() -> None:
    fake, loads, told = Fake(), list[int](), list[tuple[str, float]]()

    def make(_: object) -> Fake:
        loads.append(1)
        return fake

    ledger = Ledger(Budget(dollars=0.02))
    planner = Metered("fake:1", make, ledger, lambda stage, share: told.append((stage, share)))
    assert loads == []
    planner.plan("a")
    planner.plan("b")
    with pytest.raises(OverBudgetError, match=r"\$0.02 is used up"):
        planner.plan("c")
    assert (len(loads), fake.calls) == (1, 2) and ledger.spent == usage(0.02, 2.0).model_copy(
        update={"requests": 2, "input_tokens": 200, "output_tokens": 20}
    )
    assert told == [("asking fake:1", 0.0), ("asking fake:1", 1.0)] * 2


def test_a_scene_is_looked_at_before_the_clock_runs() -> None:
    order = list[str]()

    class Slow:
        def graph(self) -> object:
            order.append("embedded")
            raise BackendError("it cannot be embedded")  # which is for the planner to judge

        def picture(self) -> None:
            return None

    planner = Metered("fake:1", lambda _: Fake(), Ledger(), lambda stage, share: order.append(stage))
    planner.plan("a", observation=Slow())  # type: ignore[arg-type]
    assert order == ["embedded", "asking fake:1", "asking fake:1"]


def test_attempts_that_came_to_nothing_are_paid_for() -> None:
    ledger = Ledger(Budget(dollars=0.01))
    planner = Metered("fake:1", lambda _: Fake(NoPlanError("no valid plan", usage())), ledger)
    with pytest.raises(NoPlanError):
        planner.plan("a")
    with pytest.raises(OverBudgetError):
        planner.plan("a")


def test_progress_is_the_share_of_the_patience_and_ends() -> None:
    told = list[tuple[str, float]]()

    class Streams(Fake):
        def plan(self, text: str, **more: object) -> EditPlan:
            goes_on[0]("planning with fake:1", 0.0)
            raise BackendError("down")

    goes_on: list[object] = []

    def make(progress: object) -> Streams:
        goes_on.append(progress)
        return Streams()

    planner = Metered("fake:1", make, Ledger(), lambda stage, share: told.append((stage, share)))
    with pytest.raises(BackendError):
        planner.plan("a")
    assert [s for s, _ in told] == ["asking fake:1", "planning with fake:1 (0 s)", "asking fake:1"]
    assert told[0][1] == 0.0 and 0 <= told[1][1] < 0.99 and told[2][1] == 1.0
