"""URLs among the words of a command line."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenewright.agent.urls import local_words, urls
from scenewright.gaussians.errors import UserError


def test_files_are_named_by_url_and_servers_and_sentences_are_not(tmp_path: Path) -> None:
    words = [
        "fit",
        f"file://{tmp_path}/a",
        f"--masks=file://{tmp_path}/b",
        "--judge",
        "http://127.0.0.1:1/v1",
        "x s3://c",
    ]
    assert urls(words) == [f"file://{tmp_path}/a", f"file://{tmp_path}/b"]
    assert local_words(words) == ["fit", f"{tmp_path}/a", f"--masks={tmp_path}/b", *words[3:]]
    assert urls(["info", "http://host/a.ply"]) == ["http://host/a.ply"]
    assert local_words(["batch", "jobs.jsonl", "-o", "s3://b/out"])[-1] == "s3://b/out"
    for wrong in (["edit", "a.ply", "-o", "s3://b/c.ply"], ["edit", "a.ply", "--output=s3://b/c.ply"]):
        with pytest.raises(UserError, match="scenewright batch"):
            local_words(wrong)
    with pytest.raises(UserError, match="writes beside"):
        local_words(["embed", f"file://{tmp_path}/a.ply"])
