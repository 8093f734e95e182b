"""Correct misspelt words: find names of similar spelling, and known words that are one typing error away."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator

SHORTEST = 4  # letters; shorter words have too many neighbours

_LETTERS = "abcdefghijklmnopqrstuvwxyz"
_ROWS = ("qwertyuiop", "asdfghjkl", "zxcvbnm")
_ALIKE = ("aeiouy", "ckqs", "sz", "gj", "fv")  # letters that are confused because they sound alike


def nearest(said: str, names: Iterable[str], most: int = 3, likeness: float = 0.6) -> tuple[str, ...]:
    """Up to `most` names whose ratio of matching letters with `said` is at least `likeness`, the best first."""
    import difflib

    return tuple(difflib.get_close_matches(said, names, n=most, cutoff=likeness))


def did_you_mean(said: str, names: Iterable[str], most: int = 3, likeness: float = 0.6) -> str:
    """The nearest names as a question, "did you mean teal or steel?"; "" if none is near."""
    *others, last = nearest(said, names, most, likeness) or ("",)
    choice = f"{', '.join(others)} or {last}" if others else last
    return f"did you mean {choice}?" if choice else ""


def one_slip(text: str, words: Collection[str]) -> frozenset[str]:
    """The words that differ from `text` by one letter too many, too few or wrong, or by two letters exchanged."""
    if len(text) < SHORTEST or not (text.isascii() and text.isalpha()):
        return frozenset()
    return frozenset(w for w in _neighbours(text) if w in words and len(w) >= SHORTEST)


def likely_slips(text: str, words: Collection[str]) -> frozenset[str]:
    """The words one typing error away that `text` is probably meant to be.

    There is no dictionary, so an unknown word may be spelt right: "gravel" is not "travel", "painter" not "printer".
    Therefore the first letter must agree, as it is seldom mistyped; a wrong letter must be next to the right one on the
    keyboard or sound like it; and in words of four letters only an exchange of two letters counts.
    """
    return frozenset(w for w in one_slip(text, words) if _is_exchange(text, w) or _is_likely(text, w))


def best_slip(text: str, words: Collection[str]) -> str:
    """The one word one typing error away that `text` most probably is: an exchange of letters before a slip of the
    keyboard, and that before any wrong letter but the first. "" if there is none, or several are as probable.

    Only for a text that says nothing as it stands: an unknown word that is spelt right is taken for another one.
    """
    near = [w for w in one_slip(text, words) if w[0] == text[0] or _is_exchange(text, w)]
    ranks = {w: 0 if _is_exchange(text, w) else 1 if _is_likely(text, w) else 2 for w in near}
    best = [w for w in near if ranks[w] == min(ranks.values())]
    return best[0] if len(best) == 1 else ""


def _is_likely(text: str, word: str) -> bool:
    if len(text) <= SHORTEST or text[0] != word[0]:
        return False
    wrong = [(a, b) for a, b in zip(text, word, strict=False) if a != b][:1] if len(text) == len(word) else []
    return all(_are_near(a, b) for a, b in wrong)


def _is_exchange(text: str, word: str) -> bool:
    """Whether two neighbouring letters were exchanged, which is the only single error that keeps all letters."""
    return len(text) == len(word) and sorted(text) == sorted(word)


def _are_near(a: str, b: str) -> bool:
    """Whether two letters sound alike or are neighbours on an English keyboard."""
    if any(a in group and b in group for group in _ALIKE):
        return True
    (y, x), (v, u) = ((i, row.index(c)) for c in (a, b) for i, row in enumerate(_ROWS) if c in row)
    return abs(y - v) <= 1 and abs(x - u) <= 1


def _neighbours(text: str) -> Iterator[str]:
    """Every string that is one typing error away."""
    for i in range(len(text) + 1):
        head, tail = text[:i], text[i:]
        yield from (head + c + tail for c in _LETTERS)
        if tail:
            yield head + tail[1:]
            yield from (head + c + tail[1:] for c in _LETTERS)
        if len(tail) > 1:
            yield head + tail[1] + tail[0] + tail[2:]
