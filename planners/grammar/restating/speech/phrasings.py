"""Edits that a plainer sentence says as well: "a copy of the mug", "black and white", "and leave the rest"."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from .....gaussians import late_re as re

_PLACE = (
    r"(?P<place>(?:on|onto|next to|beside|near|by|behind|under|below|between|against|in front of|opposite|"
    r"(?:to the )?(?:left|right) of|at the (?:left|right) of|on the (?:left|right) of) .+)"
)
_ANOTHER = r"(?:a|one) (?:second|2nd|further|identical|matching)"
_WISH = r"(?:i (?:would|'d) like|i want|i need|give me|add|put|place|get me|make|have|let us have|we need|we want)"
_KEPT = (
    r"(?:keep|leave|do not (?:touch|change)) "
    r"(?:the rest|everything else|all else|anything else|the others|all the rest)"
)

_Rule = tuple[re.Pattern[str], Callable[[re.Match[str]], str]]
_RULES: tuple[_Rule, ...] = (
    (
        re.compile(rf"^(?:put|place|set|add|stand|drop) (?:a|one|another) (?:copy|duplicate|clone|twin) of "
                   rf"(?P<thing>.+?) {_PLACE}$"),
        lambda m: f"copy {m['thing']} and put it {m['place']}",
    ),
    (
        re.compile(rf"^{_WISH} {_ANOTHER} (?P<thing>[^,]+?) {_PLACE}$"),
        lambda m: f"copy the {m['thing']} and put it {m['place']}",
    ),
    (re.compile(rf"^{_WISH} {_ANOTHER} (?P<thing>\w+(?: \w+)?)$"), lambda m: f"copy the {m['thing']}"),
    (re.compile(r"^(?:take|pull|peel|strip) off (?P<thing>.+)$"), lambda m: f"remove {m['thing']}"),
    (
        re.compile(r"^(?:make|turn|render|show|set) (?P<thing>.+?) (?:in|into|to|all)? ?"
                   r"(?:black and white|black - and - white|greyscale|grayscale|grey scale|gray scale|monochrome)$"),
        lambda m: f"make {m['thing']} 100 % less saturated",
    ),
    (re.compile(rf"^(?P<edit>.+?)(?: ,)?(?: and| but)? {_KEPT}(?: .+)?$"), lambda m: m["edit"]),
    (re.compile(r"^(?P<edit>.+?) (?:right |over |in )?here$"), lambda m: m["edit"]),
    (re.compile(r"^(?P<edit>.+?) (?:like|as) (?:in|at|on|during) [^,]+$"), lambda m: m["edit"]),
)  # fmt: skip


def phrasings(said: str) -> Iterator[str]:
    """Plainer sentences for one, by one rule or by two after one another."""
    for first in _once(said):
        yield first
        yield from _once(first)


def _once(said: str) -> Iterator[str]:
    for pattern, plainly in _RULES:
        if match := pattern.match(said):
            yield plainly(match)
