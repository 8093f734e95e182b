"""Learn to tell the kinds of questions about time and motion, and which words name what, from written questions.

    python -m scenewright.training.timed_questions

Reads `timed_questions.tsv` (writers 1 to 9 and 12 knew the kinds and asked about any films, the others about six
rooms), tells how often the questions of a writer are told right by what the others wrote, and writes the weights of
`planners/questions/reading/time/supposed/`.
"""

from __future__ import annotations

from pathlib import Path

from ..planners.questions.reading.time.supposed.kinds import FOLDER
from .wording import learn

SENTENCES = Path(__file__).with_name("timed_questions.tsv")

RIDGE = 1e-6  # of 63 kinds; .77 of those of unseen writers are told, .76 with 1e-5

if __name__ == "__main__":
    learn(SENTENCES, FOLDER, RIDGE)
