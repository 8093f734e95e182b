"""A worker process: tasks come in as JSON on stdin, outcomes go out as JSON on stdout, a line each.

It ends when stdin ends, as it does when the process that started it is gone.
"""

from __future__ import annotations

import json
import os
import sys

from .working import Task, work


def serve() -> None:
    """Work until stdin ends."""
    replies = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what libraries print behind Python's back is no reply
    for line in sys.stdin:
        replies.write(json.dumps(work(Task(*json.loads(line))), default=str) + "\n")
        replies.flush()


if __name__ == "__main__":
    serve()
