"""Compare plans by what they do."""

from __future__ import annotations

from scenewright.planners.plan import EditPlan


def same(plan: EditPlan, other: EditPlan) -> bool:
    """Whether both plans have the same verdict and operations, whatever their time and usage."""
    return (plan.verdict, plan.ops) == (other.verdict, other.ops)
