"""Recognises what is said of a change that was made: "too clinical", "wrong way", "still not dark enough"."""

from __future__ import annotations

from collections.abc import Sequence

from .....gaussians import late_re as re

_JUDGED = re.compile(
    r"^(?:(?:hmm|oh|no|nah|nope|oops|whoops|wait|sorry|well|it is|that is|they are|still|now|it looks|looks|bit|a bit|"
    r"a little|much|way|far|just|actually|,) )*"
    r"(?:great|good|nice|perfect|lovely|brilliant|excellent|wonderful|cool|super|fab|not (?:there|here|that|"
    r"this)(?: one)?|(?:too|not so|not as|not very|not that|so) (?P<how>\w+)|not \w+ "
    r"enough|not enough|not quite(?: right| there)?|"
    r"(?:the )?(?:wrong|other) (?:way|direction|side|one)|too (?:far|much) (?:now|that way)|almost(?: there)?|"
    r"nearly(?: there)?|not bad|(?:much |a lot |far )?better)$"
)


def is_judged(said: Sequence[str]) -> bool:
    """Whether words only judge a change before."""
    return _JUDGED.match(" ".join(said)) is not None
