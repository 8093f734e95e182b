"""The plain commands that a sentence may stand for, the likeliest first; the planner takes the first it understands."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

from ....gaussians import late_re as re
from ..tagging.words import bag
from .changes.continuing import continued, following
from .changes.materials import in_materials
from .order.elision import about, gapped, listed, splits, terse, topics
from .order.fronting import fronted
from .speech.phrasings import phrasings
from .speech.remarks import remarks, without_remark
from .speech.smoothing import unopened, without_reason
from .wishes.wishes import wishes

_BEGINNING = re.compile(
    r"^(?:(?:no|nope|nah|wait|hang on|hold on|sorry|oops|actually|rather|and|or rather|not that|not that one|i "
    r"mean|i meant|make that|"
    r"well|hmm) (?:, )*)+"
)
_NOT_THIS = re.compile(r"^not (?P<wrong>(?:the|that|this|my|those|these) [^,]+) , (?:but )?(?P<rest>\S.*)$")
_QUESTIONING = bag("what where who which why how when is are does do did has have was were")


def restatements(texts: Sequence[str], mark: str, follows: bool) -> Iterator[list[str]]:
    """Other ways to say a sentence, as words; a full stop among them parts sentences.

    Args:
        texts: the words of the sentence.
        mark: the mark that ends it.
        follows: whether something was said before that it may continue.
    """
    said = " ".join(texts)
    seen = {said}
    first = continued(texts) if follows else ()
    for reading in chain(first, _readings(said, mark), _continued(said) if follows else ()):
        if reading not in seen:
            seen.add(reading)
            yield reading.split()


def _continued(said: str) -> Iterator[str]:
    plain = _BEGINNING.sub("", unopened(said))
    if not plain:
        return
    yield plain
    yield from following(plain.split())


def _readings(said: str, mark: str) -> Iterator[str]:
    shorter = without_reason(said)
    plain = unopened(said)
    if (bare := without_remark(plain.split())) is not None:
        yield bare
    shortest = unopened(without_reason(plain)) if plain != said else unopened(shorter)
    for text in dict.fromkeys((said, plain, shortest)):
        yield from in_materials(text)
        yield from phrasings(text)
    if (orders := listed(shortest.split())) is not None:
        yield orders
    for text in dict.fromkeys((said, plain)):
        yield from (" ".join(r) for r in topics(text.split()))
    yield from (plain, shorter, shortest, shortest.removesuffix(" more"))
    for text in dict.fromkeys((said, plain, plain.removeprefix("no "))):
        if found := _NOT_THIS.match(text):
            yield " ".join(next(about(found.group("wrong").split(), found.group("rest").split()), []))
            yield found.group("rest")
    asked = mark == "?" and plain.split()[0] in _QUESTIONING
    words = shortest.split()
    for whole in () if asked else dict.fromkeys((tuple(words), tuple(said.split()))):
        yield from (" ".join(r) for r in remarks(whole))
    for base in dict.fromkeys((said, plain, shortest)):
        yield from fronted(base)
    for base in dict.fromkeys((said, shorter, plain, shortest)):
        if mark != "?" or not base.startswith("no "):  # "no black chairs?" asks whether there are any
            yield from wishes(base)
    if asked:
        return
    for reading in (gapped(words), map(str.split, terse(words)), splits(words)):
        yield from (" ".join(r) for r in reading)
