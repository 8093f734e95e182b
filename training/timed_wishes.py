"""Learn to tell the kinds of wishes about time and motion, and which words name what, from written sentences.

    python -m scenewright.training.timed_wishes

Reads `timed_wishes.tsv` (writers 1 to 10, 29, 30, 32 and 70 to 73 knew the kinds and wrote about any films, too, the
others about six rooms), tells how often the sentences of a writer are told right by what the others wrote, and writes
the weights of `planners/grammar/timing/supposed/`.
"""

from __future__ import annotations

from pathlib import Path

from ..planners.grammar.timing.supposed.kinds import FOLDER
from .wording import learn

SENTENCES = Path(__file__).with_name("timed_wishes.tsv")

if __name__ == "__main__":
    learn(SENTENCES, FOLDER)
