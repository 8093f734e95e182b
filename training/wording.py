"""Learn from written sentences to tell their kinds, and which of their words name what.

A file of sentences holds on each line a writer, a kind and a sentence with marks: "[x the ball] is to be [as red]".
"""

from __future__ import annotations

import math
import random
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import torch
from torch import nn

from ..gaussians import late_re as re
from ..planners.grammar.learned.marks import OUTSIDE, Span, labels_of
from ..planners.grammar.learned.network import LAYERS, ROWS, UNKNOWN, WAYS, Network, Networks, pieces
from ..planners.grammar.tagging.words import split

OFTEN = 2  # sentences' words that stand so often have a row of their own
WIDTH = 96  # of an embedding
HIDDEN = 128
DROPPED = 0.4
HIDDEN_WORDS = 0.1  # share of the words that are shown by their classes, or by their pieces, alone
PASSES = 16
MEMBERS = 2  # networks that learn the same sentences
BATCH = 48
RATE, DECAY, CLIP = 3e-3, 1e-2, 2.0
SMOOTHED = 0.02  # of the probability of a kind
CHAIN = 1 / 6  # weight of the marks of a sentence against its kind
MARK = re.compile(r"\[(?P<tag>[a-z]+) (?P<said>[^\[\]]*)\]")


@dataclass(frozen=True)
class Sentence:
    """What one writer wrote of one kind, with marks."""

    writer: str
    kind: str
    marked: str

    @cached_property
    def said(self) -> str:
        """The sentence without marks."""
        return MARK.sub(lambda found: found["said"], self.marked)

    @cached_property
    def words(self) -> tuple[str, ...]:
        """Its words and marks of punctuation."""
        return tuple(word.text for word in split(self.said))

    @cached_property
    def spans(self) -> tuple[Span, ...]:
        """Its marks in its words."""
        found, shorter = list[Span](), 0
        places = [word.start for word in split(self.said)]
        for mark in MARK.finditer(self.marked):
            start = mark.start() - shorter
            shorter += len(mark[0]) - len(mark["said"])
            at = [i for i, place in enumerate(places) if start <= place < start + len(mark["said"])]
            found += [(mark["tag"], at[0], at[-1] + 1)] if at else []
        return tuple(found)


Tasks = Mapping[str, Sequence[Sentence]]


def sentences(path: Path) -> list[Sentence]:
    """The sentences of a file."""
    return [Sentence(*line.split("\t")) for line in path.read_text(encoding="utf-8").splitlines()]


class Learner(nn.Module):
    """The network while it learns; its forward pass is that of `Network`, with dropout.

    Args:
        tasks: the sentences of each task, for its words, kinds and tags.
    """

    def __init__(self, tasks: Tasks) -> None:
        super().__init__()
        counts = Counter(word for known in tasks.values() for sentence in known for word in sentence.words)
        often = sorted(word for word, count in counts.items() if count >= OFTEN and not word[0].isdigit())
        self.lists: dict[str, list[str]] = {"words": ["", *often]}
        self.places = {word: row for row, word in enumerate(self.lists["words"])}
        self.words = nn.Embedding(len(self.places), WIDTH)
        self.pieces = nn.EmbeddingBag(ROWS, WIDTH, mode="mean")
        self.rnn = nn.LSTM(2 * WIDTH, HIDDEN, LAYERS, batch_first=True, dropout=DROPPED, bidirectional=True)
        self.dropped = nn.Dropout(DROPPED)
        self.heads = nn.ModuleDict()
        self.moves = nn.ParameterDict()
        for task, known in tasks.items():
            tags = sorted({tag for sentence in known for tag, _, _ in sentence.spans})
            kinds = sorted({sentence.kind for sentence in known})
            labels = [OUTSIDE, *(f"{part}-{tag}" for tag in tags for part in "BI")]
            self.lists |= {f"kinds.{task}": kinds, f"labels.{task}": labels}
            self.heads[f"kinds {task}"] = nn.Linear(4 * HIDDEN, len(kinds))
            self.heads[f"labels {task}"] = nn.Linear(2 * HIDDEN, len(labels))
            self.moves[task] = nn.Parameter(torch.zeros(len(labels), len(labels)))
        nn.init.normal_(self.words.weight, std=0.3)
        nn.init.normal_(self.pieces.weight, std=0.6)

    def loss(self, task: str, batch: Sequence[Sentence], chance: random.Random) -> torch.Tensor:
        """What the kinds and marks of some sentences, the longest first, lack of being told."""
        kinds, marks, here = self._scores(task, [sentence.words for sentence in batch], chance)
        names, labels = self.lists[f"kinds.{task}"], self.lists[f"labels.{task}"]
        wanted = torch.tensor([names.index(sentence.kind) for sentence in batch])
        rows = torch.zeros(here.shape, dtype=torch.long)
        for row, sentence in zip(rows, batch, strict=True):
            told = [labels.index(label) for label in labels_of(len(sentence.words), sentence.spans)]
            row[: len(told)] = torch.tensor(told)
        of_kinds = nn.functional.cross_entropy(kinds, wanted, label_smoothing=SMOOTHED)
        return of_kinds + CHAIN / len(batch) * _chain_loss(marks, self.moves[task], here, rows)

    def _scores(
        self, task: str, batch: Sequence[Sequence[str]], chance: random.Random
    ) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        """The scores `[sentences, kinds]` and `[sentences, words, labels]`, and where words are."""
        counts = torch.tensor([len(words) for words in batch])
        here = torch.arange(int(counts.max())) < counts[:, None]
        known = torch.full(here.shape, UNKNOWN)
        built, starts = list[int](), list[int]()
        for i, words in enumerate(batch):
            for j in range(here.shape[1]):
                starts.append(len(built))
                if j >= len(words):
                    continue
                hidden = chance.random() < HIDDEN_WORDS
                known[i, j] = UNKNOWN if hidden else self.places.get(words[j], UNKNOWN)
                own = pieces(words[j])
                built += own[:2] if hidden and chance.random() < 0.5 else own
        bags = self.pieces(torch.tensor(built), torch.tensor(starts)).view(*here.shape, WIDTH)
        given = self.dropped(torch.cat([self.words(known), bags], 2))
        packed = nn.utils.rnn.pack_padded_sequence(given, counts, batch_first=True)
        held, _ = nn.utils.rnn.pad_packed_sequence(self.rnn(packed)[0], batch_first=True)
        greatest = held.masked_fill(~here[..., None], -math.inf).max(dim=1).values
        mean = (held * here[..., None]).sum(dim=1) / counts[:, None]
        kinds = self.heads[f"kinds {task}"](self.dropped(torch.cat([greatest, mean], 1)))
        return kinds, self.heads[f"labels {task}"](self.dropped(held)), here

    def learned(self) -> Network:
        """The network as it is by now."""
        found = {"rows.words": self.words.weight, "rows.pieces": self.pieces.weight}
        for layer in range(LAYERS):
            for way, end in zip(WAYS, ("", "_reverse"), strict=True):
                own = {key: getattr(self.rnn, f"{key}_l{layer}{end}") for key in ("weight_ih", "weight_hh")}
                biases = (getattr(self.rnn, f"{key}_l{layer}{end}") for key in ("bias_ih", "bias_hh"))
                name = f"rnn.{layer}.{way}"
                found |= {f"{name}.inputs": own["weight_ih"], f"{name}.hidden": own["weight_hh"]}
                found[f"{name}.biases"] = sum(biases, torch.zeros(1))
        for name, head in self.heads.items():
            assert isinstance(head, nn.Linear)
            ending = name.replace(" ", ".")
            found |= {f"{ending}.inputs": head.weight, f"{ending}.biases": head.bias}
        found |= {f"moves.{task}": moves for task, moves in self.moves.items()}
        return Network(self.lists, {name: values.detach().float().numpy() for name, values in found.items()})


def _chain_loss(scores: torch.Tensor, moves: torch.Tensor, here: torch.Tensor, wanted: torch.Tensor) -> torch.Tensor:
    """The negative log-likelihood of rows of labels in a conditional random field, summed over sentences."""
    gold = (scores.gather(2, wanted[..., None])[..., 0] * here).sum()
    gold = gold + (moves[wanted[:, :-1], wanted[:, 1:]] * here[:, 1:]).sum()
    sums = scores[:, 0]
    for word in range(1, here.shape[1]):
        further = torch.logsumexp(sums[:, :, None] + moves, 1) + scores[:, word]
        sums = torch.where(here[:, word, None], further, sums)
    return torch.logsumexp(sums, 1).sum() - gold


def networks(tasks: Tasks, passes: int = PASSES, count: int = MEMBERS) -> Networks:
    """Networks that have learned the sentences of some tasks; the same ones give the same bytes on one machine."""
    threads = torch.get_num_threads()
    torch.set_num_threads(1)  # several sum in another order each time
    try:
        return Networks(tuple(_learned(tasks, passes, seed) for seed in range(count)))
    finally:
        torch.set_num_threads(threads)


def _learned(tasks: Tasks, passes: int, seed: int) -> Network:
    torch.manual_seed(seed)
    chance = random.Random(seed)
    learner = Learner(tasks)
    batches = _batches(tasks, chance)
    optimizer = torch.optim.AdamW(learner.parameters(), RATE, weight_decay=DECAY)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, RATE, total_steps=passes * len(batches))
    for _ in range(passes):
        for task, batch in batches:
            loss = learner.loss(task, sorted(batch, key=lambda sentence: -len(sentence.words)), chance)
            optimizer.zero_grad()
            loss.backward()  # type: ignore[no-untyped-call]
            nn.utils.clip_grad_norm_(learner.parameters(), CLIP)
            optimizer.step()
            schedule.step()
        batches = _batches(tasks, chance)
    return learner.learned()


def _batches(tasks: Tasks, chance: random.Random) -> list[tuple[str, Sequence[Sentence]]]:
    """The sentences of all tasks in a new order, some at a time."""
    found = list[tuple[str, Sequence[Sentence]]]()
    for task, known in tasks.items():
        mixed = [sentence for sentence in known if sentence.words]
        chance.shuffle(mixed)
        found += [(task, mixed[at : at + BATCH]) for at in range(0, len(mixed), BATCH)]
    chance.shuffle(found)
    return found


@dataclass(frozen=True)
class Told:
    """How well sentences are told.

    Attributes:
        kinds: the share of sentences whose kind is told.
        precision, recall: of marks, with their tag and both ends.
        whole: the share of sentences of which all marks are told, and no others.
    """

    kinds: float
    precision: float
    recall: float
    whole: float


def told_of(model: Networks, task: str, known: Sequence[Sentence]) -> Told:
    """How well networks tell sentences."""
    told = [(sentence, model.told(task, sentence.words)) for sentence in known if sentence.words]
    pairs = [(set(found.spans), set(sentence.spans)) for sentence, found in told]
    hits = sum(len(found & true) for found, true in pairs)
    return Told(
        kinds=sum(found.kinds[0][0] == sentence.kind for sentence, found in told) / len(told),
        precision=hits / max(1, sum(len(found) for found, _ in pairs)),
        recall=hits / max(1, sum(len(true) for _, true in pairs)),
        whole=sum(found == true for found, true in pairs) / len(told),
    )


def without(tasks: Tasks, writers: Mapping[str, Collection[str]]) -> tuple[Tasks, Tasks]:
    """The sentences of all other writers, and those of some of each task."""
    left = {task: [s for s in known if s.writer not in writers.get(task, ())] for task, known in tasks.items()}
    return left, {task: [s for s in known if s.writer in writers.get(task, ())] for task, known in tasks.items()}
