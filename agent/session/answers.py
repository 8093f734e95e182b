"""Reads answers that choose from a numbered list: "2", "1 and 3", "the first two", "all but 2", "all".

Says also which texts are nothing but such an answer, so that they edit nothing where no question is open.
"""

from __future__ import annotations

from ...gaussians import late_re as re
from ...planners.grammar.vocabulary.quantities import NUMBERS, ORDINALS

_CARDINALS = {word: number for word, number in NUMBERS.items() if 1 <= number <= 10}
_ALL = re.compile(
    r"(?:yes,? )?(?:all|both|everything|all of (?:them|these|those|it)|them all|(?:each|every)(?: one)?(?: of them)?"
    r"|everyone|all (?:together|please))(?: of (?:them|these|those))?(?: please)?"
)
_YES = re.compile(
    r"(yes|y|yeah|yep|ok|okay|sure|right|correct|confirm(ed)?|go ahead|do it|that is it|that's it|that one|it is)"
    r"(,? please)?"
)
_NO = re.compile(r"(?:no|nope|none|none of (?:them|these|those)|neither|another one|something else)(?:,? please)?")
_ENOUGH = re.compile(
    r"(?:nothing (?:else|more)|that is (?:all|it)|that's (?:all|it)|no more"
    r"|(?:it is |it's )?(?:already )?(?:included|in it)|already|the same(?: one)?|skip(?: it| that)?|leave it(?: out)?)"
    r"(?:,? please)?"
)
_MORE = re.compile(
    r"(.+?),? (?:and|plus|or) (?:some |there is |there are |show )?(?:more|others|other ones|further ones)"
)
_BUT = re.compile(
    r"(?:all|every one|each|everything)(?: of (?:them|these|those))?,? (?:but|except(?: for)?|without) (.+)"
)
_FIRST = re.compile(rf"(?:the )?(first|last) (\d+|{'|'.join(_CARDINALS)})(?: ones)?")
_RANGE = re.compile(r"(\d+) ?(?:-|–|to|through|until) ?(\d+)")
_NUMBER = re.compile(r"(\d+)(?:st|nd|rd|th)?")
_FILLER = re.compile(r"\b(?:the|numbers?|nos?\.?|both|please|nr\.?)(?= |$)|#|(?<!and)(?<![,;&+])\s+ones?(?= |,|$)")
_LONGEST = 200  # characters of an answer that lists numbers


def plain(text: str) -> str:
    """The text in small letters, with single spaces, without a full stop or exclamation mark at its end."""
    return re.sub(r"\s+", " ", text).strip().rstrip(".!").lower()


def says_yes(text: str) -> bool:
    """Whether a text agrees, and says nothing else."""
    return _YES.fullmatch(plain(text)) is not None


def rejects(text: str) -> bool:
    """Whether a text says that nothing on a list is meant, and says nothing else: "no", "none of them"."""
    return _NO.fullmatch(plain(text)) is not None


def keeps_and_more(text: str, count: int) -> tuple[int, ...] | None:
    """The places that a text chooses while it asks for further ones: "14, 35 and more"; None if it does not."""
    match = _MORE.fullmatch(plain(text))
    return None if match is None else chosen_numbers(match[1], count)


def says_enough(text: str) -> bool:
    """Whether a text says that nothing further is meant, and says nothing else: "that is all", "already included"."""
    return _ENOUGH.fullmatch(plain(text)) is not None


def says_all(text: str) -> bool:
    """Whether a text means everything on a list, and says nothing else: "all", "both", "every one of them"."""
    return _ALL.fullmatch(plain(text)) is not None


def chosen_numbers(text: str, count: int) -> tuple[int, ...] | None:
    """The places in a list of `count` that a text chooses by numbers, from 0 and each once; None if it does not, or if
    one of its numbers is not on the list.

    >>> chosen_numbers("1 and 3", 3), chosen_numbers("all but the second", 3), chosen_numbers("1 and 4", 3)
    ((0, 2), (0, 2), None)
    """
    said = plain(text)
    if len(said) > _LONGEST:
        return None
    if match := _BUT.fullmatch(said):
        out = _listed(match[1], count)
        return None if out is None else tuple(i for i in range(count) if i not in out) or None
    if match := _FIRST.fullmatch(said):
        many = int(match[2]) if match[2].isdigit() else _CARDINALS[match[2]]
        places = tuple(range(count))
        return (places[:many] if match[1] == "first" else places[-many:]) if 0 < many <= count else None
    return _listed(said, count)


def only_an_answer(text: str) -> bool:
    """Whether a text can only be an answer to a question: it has no verb and names no thing."""
    return says_all(text) or says_yes(text) or chosen_numbers(text, 1000) is not None


def _listed(said: str, count: int) -> tuple[int, ...] | None:
    """The places that a list of numbers, ranges and ordinals names."""
    words = " ".join(_FILLER.sub(" ", said).split())
    items = [item.strip() for item in re.split(r",? and |, ?and |[,;&+]| ", _joined(words)) if item.strip()]
    places: list[int] = []
    for item in items:
        numbers = _numbers(item, count, alone=len(items) == 1 and "number" not in said)
        if numbers is None or not all(1 <= n <= count for n in numbers):
            return None
        places.extend(n - 1 for n in numbers)
    return tuple(dict.fromkeys(places)) or None


def _joined(words: str) -> str:
    """The words with each range written without spaces, so that a space always parts two items."""
    return _RANGE.sub(r"\1-\2", words)


def _numbers(item: str, count: int, alone: bool) -> list[int] | None:
    """The numbers that one item of a list means; a number in letters that stands alone may count things instead."""
    if (match := _RANGE.fullmatch(item)) is not None:
        first, last = int(match[1]), int(match[2])
        return list(range(first, last + 1)) if 1 <= first <= last <= count else None
    if (match := _NUMBER.fullmatch(item)) is not None:
        return [int(match[1])]
    if item in ORDINALS:
        return [ORDINALS[item]]
    if item == "last":
        return [count]
    return None if alone or item not in _CARDINALS else [_CARDINALS[item]]
