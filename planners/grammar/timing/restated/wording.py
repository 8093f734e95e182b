"""What rules share that restate an instruction: groups of words, and how parts of a sentence are put together again."""

from __future__ import annotations

from collections.abc import Callable

from .....gaussians import late_re as re
from ...vocabulary.nouns import is_known
from ..asides import HUES
from ..manner import MOTION
from ..moments import DURATION, seconds_of
from ..verbs import SENSES, any_of, forms

Rules = tuple[tuple[str, str | Callable[["re.Match[str]"], str]], ...]  # a pattern, and what stands in its place

PLAIN = any_of(MOTION, "plain")
S = any_of(MOTION, "s")
ING = any_of((*MOTION, "stop"), "ing")
NUMBER = r"(?:\d+(?:\.\d+)?|zero|one|two|three|four|five)"
IT = "(?:it|he|she|they)"
NAMED = r"(?:(?:the|that|this|my|our|all the) )?[a-z]+(?: [a-z]+){0,2}?"
EVENT = "(?:motion|movement|animation|walk|roll|fall|drop|swing|ride|flight|turn|slide|run|move)"
BEGIN = (
    "(?:sets? (?:off|out)|starts?|begins?|moves?(?: off)?|goes|gets? (?:going|moving)|got (?:going|moving)|"
    "began|started|set off|moved)"
)
COLOR = f"(?:(?:light |dark |bright |deep )?(?:{HUES}|turquoise))"
SHARE = "(?:a )?(?:half|quarter|third|double|triple|twice)(?: (?:of )?(?:the|its))?"
POINT = rf"(?:(?:t|second) =? ?\d+(?:\.\d+)?(?: s(?:econds?)?)?|{DURATION}|\d+(?:\.\d+)?|one|two|three|four|five)"
LENGTHS = "for over within in lasting by until till from between last first next the and"
NO_LENGTH = "".join(f"(?<!{w})" for w in LENGTHS.split())  # behind one of these words it is no time after something
CAUSING = {"letting": "let", "having": "have"}  # which no sense of a verb holds
PASTS = {past: verb for verbs in SENSES.values() for verb in verbs.split(", ") for past, form in forms(verb)
          if form == "past" and " " not in verb}  # fmt: skip


def with_article(found: re.Match[str]) -> str:
    """ "green book falls at 3 s"."""
    return f"the {found[0]}" if is_known(found["np"].split()[-1]) else found[0]


def with_unit(time: str) -> str:
    """A number of seconds with its unit."""
    time = re.sub(r"^(?:t|second) =? ?", "", time)
    return time if re.search(r"\bs(?:ec|$)", time) else f"{time} seconds"


def from_to(found: re.Match[str]) -> str:
    """ "leaving at one and getting there at three"."""
    return f" from {with_unit(found['a'])} to {with_unit(found['b'])}"


def wished(found: re.Match[str]) -> str:
    """ "(I would be pleased if) the robot turned": a wish, in the form of what was."""
    verb = PASTS.get(found["verb"])
    return found[0] if verb is None else f"let {found['np']} {verb}{found['rest']}"


def between(found: re.Match[str]) -> str:
    """ "beginning at two seconds and being fully open only at four"."""
    before = found["before"]
    if found["how"]:  # it moves already, at another pace
        before = re.sub(rf" (?={PLAIN}$)", " start to ", before)
    return f"{before}{from_to(found)}"


def plain_of(verb: str) -> str:
    """A verb in its plain form."""
    return next((v for vs in SENSES.values() for v in vs.split(", ") for form, _ in forms(v) if form == verb), verb)


def unwished(said: str) -> str:
    """A name without the wish before it, and without "should" behind it."""
    said = re.sub(r"^(?:i|we) (?:would like|want|would love|would prefer|need) |^(?:let|make|have) ", "", said)
    return re.sub(r" (?:should|must|shall|ought|needs|has)(?: to)?$", "", said)


def gone(found: re.Match[str]) -> str:
    """ "have the lamp vanish at three seconds and come back at four"."""
    return f"hide {unwished(found['x'])}{from_to(found)}"


def colored(found: re.Match[str]) -> str:
    """ "the vase goes red at 1 s, back to blue at 3 s"."""
    return f"make {found['x']} {found['c']}{from_to(found)}"


_HUE_FIRST = rf"(?:the )?(?:{HUES})(?: (?!and |then )[a-z]+)?(?:(?: to fall| falls| drops| goes| should fall)? first)?"
_HUE_NEXT = (
    rf"(?: ,| then| and| next| finally)+ (?:the )?(?:{HUES})"
    r"(?: (?:one|book|ball|box|last|second|third|first|goes|falls|drops))*"
)
_NO_NOUN = r"(?:one|first|last|then|and|falls?|drops?|goes|comes|is|should|must|lands?|for|to|at|in)\b"
IN_ORDER = (
    r"^(?P<head>.*\b(?:order|sequence|falls?|drops?|come down|way (?:about|round|around)|round)\b.*?)[ ,:.]+"
    rf"(?:(?:that is|i e|so|first|namely|with) )*(?P<list>{_HUE_FIRST}(?:{_HUE_NEXT}){{1,3}}(?: (?:for|at) the "
    r"(?:finale|end))?)$"
)


def in_order(found: re.Match[str]) -> str:
    """ "the books should come down the other way about : blue , green , then red"."""
    hues = re.findall(rf"\b(?:{HUES})\b", found["list"])
    noun = re.search(rf"\b(?:{HUES}) (?!{_NO_NOUN})([a-z]+)", found[0])
    noun = noun or re.search(
        r"\b(?:the|all|my|two|three|four) ([a-z]+)s\b(?= (?:[a-z:,]+ )*?(?:fall|drop|come|tumble|in))", found[0]
    )
    if noun is None or len(set(hues)) != len(hues) or re.search(rf"\b(?:{HUES})\b", found["head"]):
        return found[0]
    name = noun[1].removesuffix("s")
    return "let " + " , then ".join(f"the {hue} {name}{' fall first' if not i else ''}" for i, hue in enumerate(hues))


def counted(found: re.Match[str]) -> str:
    """The article before a unit as a number, so that it begins no name: "a second lamp"."""
    return found[1] or "one "


SETS_OFF = "(?:leaving|setting off|departing|start(?:s|ing)?|begin(?:s|ning)?|leaves)"
IS_THERE = (
    "(?:(?:getting|being|gets|is) there|arriv(?:es|ing)(?: there)?|reaching it|done|end(?:s|ing)?|stop(?:s|ping)?|"
    "finish(?:ed|es|ing)?|over|there)"
)


def slowed_to(found: re.Match[str]) -> str:
    """ "slowed to one turn every two seconds"."""
    seconds = seconds_of(found["d"])
    whom = (found["x"] or found["w"] or "it").strip()
    return found[0] if not seconds else f"spin {whom} at {1 / seconds:g} turns per second"


def rate(found: re.Match[str]) -> str:
    """ "one round in four seconds", where how long it goes on is said besides."""
    seconds = seconds_of(found["d"])
    return found[0] if not seconds else f"{1 / seconds:g} turns per second"
