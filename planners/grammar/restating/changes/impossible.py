"""Recognises what no operation does where a sentence is not understood otherwise: walls that move, things that run."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from .....gaussians import late_re as re
from ...tagging.lookahead import Lookahead
from ...tagging.words import bag
from ...vocabulary import doings
from ...vocabulary.verbs import BLURS
from ..speech.smoothing import unopened

_SHELL = re.compile(
    r"\b(?:push|move|pull|shift|raise|lower|lift|extend|knock|widen|enlarge|take|shrink|stretch|rotate|turn|tear|break|"
    r"slide|bring|drop|cut|open|smash|build|drill)(?: (?:up|out|down|through))? (?:(?:the|that|this|my|our|a) )?"
    r"(?:(?:left|right|back|front|rear|far|side|whole|outer|inner|hand|entire|dividing|party) )*"
    r"(?P<part>walls?|ceilings?|floors?|room|roof|doorway|building|house)(?= (?!paper|light|lamp|clock|mirror|unit|"
    r"cabinet|shelf))"
)
_SHELL_SIZE = re.compile(
    r"\bmake (?:the|this|that|my|our) (?P<part>walls?|ceilings?|floors?|room|roof|doorway|building|house) (?:\S+ )*?"
    r"(?:bigger|larger|smaller|wider|narrower|higher|lower|taller|longer|shorter|deeper|thicker|thinner)\b"
)
_SWITCHED = re.compile(
    r"\b(?:plug|switch|turn|power|fire|start|boot) (?:the|that|this|my|our|all|both) [^,.;!?]+? (?:in|on|off|up)\b|"
    r"\b(?:put|set|run|start) the (?:washing machine|washer|dryer|tumble dryer|dishwasher|oven|microwave|kettle|"
    r"heater|radio|tv|"
    r"television|telly|stereo|music) (?:on|to|off)\b"
)
_RUNNING = re.compile(
    r"^(?:\S+ )*?(?:get|make|have|let|start|set|keep) (?:the|that|this|my|our|all|every) (?P<thing>\S.*?) (?:(?:to "
    r")?(?:play|ring|sing|"
    r"dance|talk|speak|bark|fly|drive|run|work|glow|blink|bounce|walk|beep|tick|boil|cook)|(?:play|ring|sing|danc|"
    r"talk|speak|"
    r"bark|fly|driv|runn|work|glow|blink|bounc|walk|beep|tick|boil|cook|spinn|rock|swing|mov|turn)ing)\b"
)
_BLURRED = re.compile(r"\b(?:blurr?(?:y|ier|ed)?|bokeh|out of focus|in focus|sharper|depth of field)\b")
# What is made to be eaten and drunk, and what is done for people.
_SERVED = re.compile(
    r"^(?:make|fix|pour|bring|get|cook|brew|give|order|fetch|buy) (?:me|us|them|him|her|everyone) (?:a |an |some |"
    r"the )?"
    r"(?:\w+ )?(?:coffee|tea|cuppa|sandwich|drink|beer|dinner|lunch|breakfast|snack|pizza|meal|discount|refund)\b"
)


def _made_to(command: Sequence[str]) -> bool:
    """Whether a thing shall be made to do what things do: "make the basket smell of rolls", "make it stop raining"."""
    if len(command) < 3 or command[0] not in ("make", "get", "have", "let", "keep", "stop"):
        return False
    does = [w for before, w in pairwise(command[1:7]) if before not in _ARTICLES and w not in _SEEMING]
    return command[1] in _OBJECT and any(w in doings.plain() or w in doings.ongoing() for w in does)


_CAN = "through time things can move, turn, open, fall over, hop, follow others, look different and be hidden"
_REQUEST = re.compile(r"^(?:please )?(?:can|could|will|would) (?:you|we|i|someone|somebody) (?:please |just |kindly )*")
_ARTICLES = bag("the a an my our your that this")
_SEEMING = bag("like mean feel look seem appear match fit suit stand sit hang lie show stick visit open close")
_OBJECT = bag("the a an my our your his her its that this those these some something it them me us all both up")


def cannot_be(texts: Sequence[str]) -> str:
    """Why a sentence that is not understood asks for what no operation does; "" if that cannot be told."""
    said = " ".join(texts) + " "
    texts = _REQUEST.sub("", " ".join(texts)).split()
    start, _ = Lookahead(texts).skip_polite(0)
    command = [w for w in unopened(" ".join(texts[start:])).split() if w not in ("please", "just")]
    if len(command) > 1 and command[0] in doings.ACTIONS and command[1] in _OBJECT:
        return f"no operation does this ({command[0]}); {_CAN}"
    if _made_to(command):
        return f"no operation makes this happen; {_CAN}"
    if _SERVED.match(" ".join(command)):
        return "in a scene nothing is cooked, fetched or served"
    if found := _SHELL.search(said) or _SHELL_SIZE.search(said):
        return f"the {found.group('part')} stays: it has no operation that moves or opens it"
    if _SWITCHED.search(said):
        return "moving parts and switches cannot be operated"
    if _BLURRED.search(said):
        return BLURS
    if found := _RUNNING.search(said):
        return f"no operation makes the {found.group('thing')} run by itself or sound; {_CAN}"
    return ""
