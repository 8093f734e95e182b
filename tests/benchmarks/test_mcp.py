"""The benchmark of the MCP server reaches its goals."""

from __future__ import annotations

import pytest

from scenewright.benchmarks import mcp


@pytest.mark.slow
def test_every_session_is_whole_and_hostile_calls_change_nothing() -> None:
    pytest.importorskip("mcp", reason="needs the extra `mcp`")
    metrics, notes = mcp.figures()
    assert notes and all(m.met is not False for m in metrics), [m for m in metrics if m.met is False]
