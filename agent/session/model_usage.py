"""What asking a language model took, in words for a person.

Knows the usage that a plan carries. Refuses to know prices and who was asked why.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...planners.plan import EditPlan, Usage


def asked(plan: EditPlan | None) -> tuple[str, ...]:
    """The line that tells of it: "planned by openai:gpt-5 in 1.2 s, 1,830 tokens, $0.0040"; none if no model was."""
    if plan is None or plan.usage is None:
        return ()
    how = "planned by" if plan.planner == plan.usage.model else "asked"
    return (f"{how} {plan.usage.model} {took(plan.usage)}",)


def took(usage: Usage) -> str:
    """ "in 1.2 s, 1,830 tokens, $0.0040"; dollars where a price is known."""
    said = [f"in {usage.seconds:.1f} s"]
    if usage.requests > 1:
        said.append(f"{usage.requests} requests")
    if tokens := usage.input_tokens + usage.output_tokens:
        said.append(f"{tokens:,} tokens")
    if usage.dollars is not None:
        said.append(f"${usage.dollars:.4f}")
    return ", ".join(said)
