"""An instruction without the pieces that ask for nothing: "to make room, push the desk to the wall, it bothers me".

A piece stands between marks, or behind a word that begins a reason. It is left out only by trial, where the whole is
not understood (`TimeReader`), and only if no number, colour, time or movement would be lost with it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from ....gaussians import late_re as re
from ..restating.speech.remarks import is_remark
from ..vocabulary.nouns import is_known
from ..vocabulary.quantities import NUMBERS
from .asides import HUES, told_of
from .manner import MOTION, Thing, starts
from .moments import DURATION, cut
from .verbs import has_form

_SUBJECT = r"(?:i|we|you|he|she|it|they|people|everyone|everybody|nobody|someone|the|my|our|this|that|there)"
_MARK = re.compile(
    rf" (?:,|\.|;|:|–|-|!)(?: (?:and|but|so|because|since|as|for|then))* | (?:because|since|so that|as if|as though) |"
    rf" so (?={_SUBJECT} )| (?<!looks )(?<!look )(?<!be )(?<!would )like (?=(?:a|an|in|on|{_SUBJECT}) )"
)
_LEADS = re.compile(r"\b(?:because|since|so|as if|as though|like)\b")  # behind which a reason or a likeness stands
_AIM = re.compile(r"^(?:in order )?(?:to|for) (?:a |an |the )?[a-z]+ ?(?:[a-z]+ ?)*$")  # "to open up the floor space"
_PERSON = re.compile(
    r"^(?:(?:and|but|so|then|because|since|as|when|if|whenever|otherwise) )*(?:i|we|you|people|everyone|everybody|"
    r"nobody|someone|my [a-z]+|our [a-z]+|the (?:kids|children|class|client|boss|director|audience|viewers?|guests?|"
    r"customers?|buyers?|visitors?|patients?|pupils?|students?)|buyers|viewers|customers|guests|clients|patients|"
    r"pupils|students|visitors)\b"
)
_OF_IT = re.compile(
    r"^(?:(?:and|but|so|then|because|since|as) )*(?:it|that|this|he|she|they|there) (?:(?:is|are|was|were|has|have|"
    r"will|would|can|could|may|might|does|do|did|always|just|really|only|all|not|'s) )*(?P<verb>[a-z]+)"
)
_ASKS = re.compile(
    r"\b(?:not only|except|without|other|others|rest|until|till|while|once|after|before|during|as soon|should|must|"
    r"shall|ought|instead|also|too|again|back|both|all|each|every|same|first|last|next|more|less|to be|"
    r"(?<!'s )(?<!is )(?<!are )only)\b"
)
_WISH = re.compile(
    r"\b(?:want|need|like|prefer|wish|love)s? (?:it|him|her|them|that|the|all|both|my|our)\b(?! (?:so|like))"
)
_BUT_SEEING = re.compile(
    r"\b(?:want|need|like|prefer|wish|love)s? (?:that|it|this)$|\bto (?:see|look|watch|show|have a)\b"
)
_APPEARS = re.compile(r"^(?:that |it )?(?:looks?|seems?|feels?|sounds?) (?!like)[a-z]+(?: (?!until|from|at)[a-z]+)*$")
_AMOUNT = re.compile(rf"\d|\b(?:{HUES})\b|{DURATION}|\bby (?:{'|'.join(NUMBERS)})\b")
_SHORT = 5  # words of a piece without a verb

Reads = Callable[[str], bool]


def without_remarks(said: str, thing: Thing, reads: Reads) -> Iterator[str]:
    """An instruction without the pieces that ask for nothing, if there are any; without fewer of them next.

    Args:
        thing: reads a phrase for things.
        reads: whether a piece is a command by itself, which is then no remark.
    """
    pieces = _divided(said)
    if not 1 < len(pieces) < 9:
        return
    before = ["", *(piece for _, piece in pieces)]
    idle = [_is_idle(piece, mark, before[i], thing, reads) for i, (mark, piece) in enumerate(pieces)]
    if not any(idle) or all(idle):
        return
    seen = set[str]()
    for dropped in (idle, *([i == k for i in range(len(idle))] for k in range(len(idle)) if idle[k])):
        kept = [(m, p) for (m, p), out in zip(pieces, dropped, strict=True) if not out or told_of(p) is not None]
        left = "".join(f"{m if i else ''}{p}" for i, (m, p) in enumerate(kept)).strip(" ,")
        if left and left not in seen and left != said:
            seen.add(left)
            yield left


def _divided(said: str) -> list[tuple[str, str]]:
    """The pieces, each with the mark before it."""
    found, at, mark = list[tuple[str, str]](), 0, ""
    for joint in _MARK.finditer(said):
        found.append((mark, said[at : joint.start()]))
        mark, at = joint[0], joint.end()
    found.append((mark, said[at:]))
    return [(m, p.strip(" ,")) for m, p in found if p.strip(" ,")]


def _is_hue_again(piece: str, before: str) -> bool:
    """Whether a piece names a colour that was named already: "red, a good strong red"."""
    hue = re.match(rf"^(?:a|an|the|some) (?:[a-z]+ ){{0,3}}(?P<hue>{HUES})(?: colou?r)?$", piece)
    return hue is not None and re.search(rf"\b{hue['hue']}\b", before) is not None


def _is_idle(piece: str, mark: str, before: str, thing: Thing, reads: Reads) -> bool:
    """Whether a piece asks for nothing, behind the one `before`, if there is any."""
    words = piece.split()
    if _APPEARS.match(piece) or (before and _is_hue_again(piece, before)):
        return True
    if re.match(r"(?:when|whenever) (?!i |we |you |people |one )", piece):
        return False
    if _AMOUNT.search(piece) or cut(piece)[0] != piece:
        return False
    if _LEADS.search(mark):
        return not reads(piece)  # "it is stuffy, so open the door" gives an order
    if not before and _AIM.match(piece) and len(words) > 2:
        return True
    if _PERSON.match(piece):
        wished = _WISH.search(piece) is not None and _BUT_SEEING.search(piece) is None
        return not wished and not reads(piece)
    if (of := _OF_IT.match(piece)) is not None:
        return not _ASKS.search(piece) and not _moves(of["verb"]) and not reads(piece)
    if is_remark(words):
        return not reads(piece)
    return len(words) <= _SHORT and not _says(words, thing) and not reads(piece)


def _moves(word: str) -> bool:
    return has_form(word, (*MOTION, "stop", "start", "stay", "hide", "show", "continue"), "plain", "s", "ing", "past")


def _says(words: list[str], thing: Thing) -> bool:
    """Whether any word of a short piece is about a thing, a movement, or how something is done."""
    if _ASKS.search(" ".join(words)) or {"not", "no", "never", "but"} & set(words) or any(map(_moves, words)):
        return True
    for i in range(len(words)):
        if any(fields for fields, _ in starts(" ".join(words[i:]), thing)):
            return True
        if is_known(words[i]) and thing(words[i]) is not None:
            return True
    return False
