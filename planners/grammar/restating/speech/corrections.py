"""Applies what a speaker takes back: "paint it red, no wait, blue" is "paint it blue".

The words behind the taking back replace the last part of the same kind before it: a colour a colour, a place a place, a
thing a thing, an amount an amount. A command of its own replaces the command before.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .....gaussians import late_re as re
from ...tagging.lookahead import Lookahead, match
from ...vocabulary import lexicon
from ..chunks import Chunk, chunks, last_of

_WAIT = r"(?:wait|hang on|hold on|hang about|one sec|stop|oops|whoops|scratch that|strike that|forget that|cancel "\
        r"that|"\
        r"forget it|never mind|nevermind|not that|on second thoughts?|on reflection|changed my mind|i changed my mind|"\
        r"i have changed my mind|thinking about it|my bad|my mistake|correction|i take that back|come to think of it|"\
        r"sorry|apologies|pardon|actually|rather|make that|make it|i mean|i meant|i meant to say|i mean to say|"\
        r"that is|let us say|say|better|or rather|or better|or no|or actually|actually make (?:that|it)|silly me|"\
        r"not that one|not this one|not it|well)"  # fmt: skip
_STRONG = (
    r"(?:(?:no|nope|nah|oh no|oh)(?: ,)* (?:{w}(?: ,)* )*|(?:actually|wait|sorry|hang on|hold on|oops|scratch that|"
    r"strike that|forget that|cancel that|never mind|nevermind|i mean|i meant|i meant to say|make that|correction|"
    r"on second thoughts?|or rather|or better|or better still|or actually|changed my mind|i have changed my mind|"
    r"my mistake|my bad|"
    r"rather|not that)(?: ,)* (?:(?:no|nope|nah)(?: ,)* )?(?:{w}(?: ,)* )*)"
).replace("{w}", _WAIT)
_TAKEN_BACK = re.compile(rf"(?P<before>.+?)(?: [,.;!?])+ (?P<mark>{_STRONG})(?P<after>\S.*)$")
_BARE_MARK = re.compile(
    r"(?P<before>.+?)(?: [,.;!?])* (?P<mark>(?:no(?: ,)* wait|wait(?: ,)* no|no(?: ,)* sorry|sorry(?: ,)* no|or rather|"
    r"i mean|i meant|sorry i meant|scratch that|make that|actually no|no actually)(?: ,)*) (?P<after>\S.*)$"
)
_RATHER_BEHIND = re.compile(r"(?P<before>.+) , (?P<after>[^,.;!?]+?) (?:rather|instead|i mean|i meant|sorry)$")
_NOT_BUT = re.compile(r"(?P<before>.+) , (?:not|rather than) (?P<wrong>[^,.;!?]+)$")
_PRONOUNS = ("it", "them", "that", "this", "those", "these", "him", "her", "they")
_WHOLLY = re.compile(r"scratch that|strike that|forget that|forget it|cancel that|never ?mind")


_OPENING = re.compile(rf"^(?:{_STRONG})\S")


# Behind a sign these say only that the words before it are taken back.
_NOTHING = re.compile(r"(?:(?:not|no|that|this|it|one|the|do|leave|keep|alone|as|is|was|really|at all|,|\.|so|"
                      r"please|let|be|just|nothing|wait|"
                      r"stop|sorry|thanks|thank|you|all|ok|okay|never|mind) ?)+|(?:i|we) .*|do not .*|not .*|leave "
                      r".*|keep .*")  # fmt: skip
_WHOLLY_BACK = re.compile(
    r" [,.;!?](?: [,.;!?])* (?:no|nope|nah|no wait|wait no|actually no|no actually|scratch that|strike that|forget "
    r"(?:it|that)|"
    r"never ?mind|cancel that|on second thoughts?(?: ,)* no|no(?: ,)* sorry|wait|stop|oops)(?: ,| \.)*$"
)


def takes_back(texts: Sequence[str]) -> bool:
    """Whether a sentence begins by taking back the one before it."""
    return _OPENING.match(" ".join(texts) + " .") is not None


def corrected(said: str) -> Iterator[str]:
    """The sentence with what was taken back replaced; several readings, the likeliest first; none without a sign.

    A reading without words says that nothing was put in place of what was taken back.
    """
    found = _TAKEN_BACK.match(said) or _BARE_MARK.match(said)
    if found is None and (behind := _RATHER_BEHIND.match(said)) is not None:
        found = behind
    if found is None:
        if _WHOLLY_BACK.search(said):
            yield ""
        elif (contrast := _NOT_BUT.match(said)) is not None and _is_contrast(contrast["before"], contrast["wrong"]):
            yield contrast["before"]
        return
    if _NOTHING.fullmatch(found.group("after")):
        yield ""
        return
    before, after = found.group("before").split(), found.group("after").split()
    for after_now in _readings(after):
        yield from _merged(before, after_now)
    if "mark" in found.groupdict() and _WHOLLY.search(found.group("mark")):
        yield " ".join(after)


def _is_contrast(before: str, wrong: str) -> bool:
    """Whether words behind "not" name what something has now, of the kind that it gets: "make it green, not blue"."""
    one, other = ([c.kind for c in chunks(tuple(said.split()))] for said in (wrong, before))
    return one == ["hue"] and "hue" in other


def _readings(after: Sequence[str]) -> Iterator[list[str]]:
    """The words behind a sign, corrected themselves where they hold another sign."""
    inner = list(corrected(" ".join(after)))
    yield from (r.split() for r in inner[:2])
    if not inner:
        yield list(after)


def _merged(before: Sequence[str], after: Sequence[str]) -> Iterator[str]:
    """Readings of `before` with the part that `after` corrects replaced by it."""
    clause = Lookahead(after).verb(Lookahead(after).skip_polite(0)[0])
    if clause is not None:
        yield from _new_command(before, after)
        return
    ends = [i for i, t in enumerate(after) if t in (",", ".")]
    for end in (*ends[:1], len(after)):
        fragment, rest = list(after[:end]), list(after[end + 1 :])
        if text := _replaced(before, fragment):
            yield " ".join([*text, *rest])


def _new_command(before: Sequence[str], after: Sequence[str]) -> Iterator[str]:
    """The command behind a sign instead of the one before it; its pronoun means what that one was about."""
    start = _last_command(before)
    kept, old = list(before[:start]), tuple(before[start:])
    pronoun = next((i for i, t in enumerate(after) if t in _PRONOUNS), None)
    if pronoun is not None:
        thing = next((c for c in chunks(old) if c.kind == "thing" and c.start > 0), None)
        if thing is None:
            return
        after = [*after[:pronoun], *old[thing.start : thing.end], *after[pronoun + 1 :]]
    yield " ".join([*kept, *after])


def _last_command(before: Sequence[str]) -> int:
    """Where the last command of some words begins, the joint before it excluded."""
    ahead = Lookahead(before)
    for i in range(len(before) - 1, 0, -1):
        if before[i - 1] in ("and", "then", ",", ".", ";") and ahead.verb_begins(i):
            return i
    return 0


def _replaced(before: Sequence[str], fragment: Sequence[str]) -> list[str] | None:
    """`before` with its last part of the fragment's kind replaced by the fragment; None if there is no such part."""
    while fragment and fragment[0] in ("the", "just") and len(fragment) > 1 and fragment[1] == "just":
        fragment = fragment[1:]
    new = chunks(tuple(fragment))
    old = chunks(tuple(before))
    if not new or not old:
        return None
    first = new[0]
    part = _same_head(before, old, fragment, first) or last_of(old, first.kind)
    if part is None and first.kind == "amount":
        part = last_of([c for c in old if c.kind == "thing" and before[c.end - 1][0].isdigit()], "thing")
    if part is None and first.kind in ("hue", "grown"):
        part = last_of(old, "grown") or last_of(old, "hue")
    if part is None and first.kind in ("way", "place"):
        part = last_of(old, "place") or last_of(old, "way")
    if part is None and first.kind == "thing":
        part = last_of(old, "place")
        if part is not None:
            start = _behind_preposition(before, part)
            part = Chunk("thing", start, part.end, part.head)
    if part is None:
        return None
    part = _with_postmodifiers(old, part, before, len(new) > 1)
    said = _named(list(fragment), new, before, part)
    behind = list(before[part.end :])
    covered = {c.kind for c in new[1:]}
    rest = [c for c in old if c.start >= part.end]
    if rest and all(c.kind in covered for c in rest):
        behind = []
    return [*before[: part.start], *said, *behind]


def _same_head(before: Sequence[str], old: Sequence[Chunk], fragment: Sequence[str], first: Chunk) -> Chunk | None:
    """The last thing with the noun of a corrected one, also behind a preposition; None if there is none.

    Where no noun is the same, the goal of a move is corrected rather than what moves.
    """
    if first.kind != "thing" or first.head < 0:
        return None
    places = [
        Chunk("thing", _behind_preposition(before, c), c.end, c.head) for c in old if c.kind == "place" and c.head >= 0
    ]
    things = sorted([*(c for c in old if c.kind == "thing" and c.head >= 0), *places], key=lambda c: c.end)
    same = [c for c in things if before[c.head] == fragment[first.head]]
    if same:
        return same[-1]
    moves = before[0] in (
        "put",
        "move",
        "place",
        "set",
        "stick",
        "shift",
        "slide",
        "push",
        "bring",
        "hang",
        "stand",
        "pop",
        "add",
    )
    return things[-1] if moves and things and things[-1] in places else None


def _with_postmodifiers(old: Sequence[Chunk], part: Chunk, before: Sequence[str], more: bool) -> Chunk:
    """A thing with the places behind it that describe it, where its correction has places too or ends the words."""
    if part.kind != "thing" or not more:
        return part
    end = part.end
    for chunk in old:
        if chunk.start == end and chunk.kind == "place":
            end = chunk.end
    return Chunk(part.kind, part.start, end, part.head)


def _behind_preposition(before: Sequence[str], place: Chunk) -> int:
    found = match(lexicon.CLOSED_PHRASES, before, place.start)
    return place.start + (found[1] if found else 1)


def _named(fragment: list[str], new: Sequence[Chunk], before: Sequence[str], part: Chunk) -> list[str]:
    """A fragment whose "one" is named after the thing that it replaces: "no, the blue one"."""
    head = new[0].head
    if new[0].kind != "thing" or head < 0 or fragment[head] not in ("one", "ones") or part.head < 0:
        return fragment
    noun = before[part.head]
    if fragment[:head] == ["the", "other"]:
        return [fragment[0], noun, "but", "not", *before[part.start : part.end]]
    return [*fragment[:head], noun, *fragment[head + 1 :]]
