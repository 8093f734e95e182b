"""Instructions of several sentences as one: a sentence that only tells a time belongs to the one before it, what goes
without saying and what people say of themselves is left out.

"Push the chair to the bed. Start at 1 s and take two seconds for it" is "push the chair to the bed from 1 s in two
seconds".
"""

from __future__ import annotations

from ....gaussians import late_re as re
from ..tagging.words import bag
from .asides import changes_nothing, told_of
from .manner import MOTION
from .moments import DURATION
from .phrases import GOES_BACK_WHEN
from .verbs import has_form

_SPLIT = re.compile(r" (?:\.|;|\n|!)(?: (?:and|so|then|but|also|ok|okay|now|just|please))* ")
_POINT = (
    rf"(?:t ?= ?\d+(?:\.\d+)?|(?:the )?{DURATION}(?: mark)?|(?:the )?second \d+(?:\.\d+)?|\d+(?:\.\d+)?|the "
    r"(?:very )?(?:start|beginning|end))"
)
_EVENT = (
    "(?:whole |entire |complete )?(?:thing|movement|motion|move|opening|closing|fall|drop|walk|roll|turn|trip|"
    "ride|way|drive|slide|swing|spin|change|fade)"
)
_LEAD = (
    rf"(?:(?:it|he|she|this|that|they|the {_EVENT}|its {_EVENT}|i|we|you|want|would like|need|let|have|make|should|"
    r"must|shall|may|can|could|has|needs|ought|is|to|will|would|also|still|just|only|then|please|and|but|with|do|so|"
    r"it all) )*?"
)
_DETAILS = tuple(
    (re.compile(rf"^{_LEAD}{pattern}$"), plain)
    for pattern, plain in (
        (rf"(?:stays?|remains?|holds?|hangs?|waits?|stands?|rests?|is|be|keeps?)(?: (?:frozen|stopped|there|still|"
         rf"motionless|like "
         rf"that|in place|put|so|that way|in mid-air))* for (?P<d>{DURATION})", r"for \g<d>"),
        (
            rf"(?:take|takes|taking|last|lasts|lasting|use|using|need|needs|spend|spending) (?:it )?(?P<d>{DURATION})"
            r"(?: (?:for|on) (?:it|that|this|the \w+|\w+ing(?: \w+){0,2})| to \w+(?: \w+){0,2}| in total| long| doing "
            r"(?:it|so|that)| over it)?",
            r"in \g<d>",
        ),
        (rf"(?:start|starts|starting|begin|begins|beginning) (?:it )?(?:at|from|with) (?P<a>{_POINT}) (?:and|,) "
         rf"(?:to )?(?:end|ends|ending|stop|stopping|finish|finishing|be done|be over|done) (?:it )?(?:at|by|with) "
         rf"(?P<b>{_POINT})", r"from \g<a> to \g<b>"),
        (rf"(?:start|starts|starting|begin|begins|beginning) (?:it )?(?:at|from|with) (?P<a>{_POINT})", r"from \g<a>"),
        (rf"(?:end|ends|ending|finish|finishing|be done|be finished|be over|over|done|finished|complete|completed) "
         rf"(?:it )?(?:at|by|with) (?P<b>{_POINT})", r"until \g<b>"),
        (rf"(?:go|goes|going|happen|happens|happening|be|do it|do this|do that|do so|be done|run|running)? ?"
         rf"(?P<when>(?:at|from|between|after|for|during|over|in|within) (?:the (?:first|last) )?{_POINT}"
         rf"(?: (?:to|and|until|till) {_POINT})?)", r"\g<when>"),
    )
)  # fmt: skip
_STAYS = re.compile(
    r"^(?:(?:it|he|she|they|that|this|and|then|but|so|please|just|simply|should|must|shall|can|may|has|to|let|leave|"
    r"keep|have|want|i|it all|the rest) )*(?:stay|stays|remain|remains|leave|keep|hold|stand|stands|rest|rests|wait|"
    r"waits|lie|lies|be|is)(?: (?:it|him|her|them|just|there|here|up|down|still|off|on|out|open|shut|closed|like|"
    r"this|that|so|as|is|way|in|place|where|put|exactly|until|till|to|the|very|end|of|clip|scene|then|from|for|rest|"
    r"good|standing|lying|hanging|quiet|at|same|speed|unchanged|untouched|then|alone|be|it is|was))+$"
)
_ON = re.compile(
    r"^(?:(?:it|he|she|they|should|must|just|please|let|have) )*(?:keep|keeps|go|goes|carry|continue|run|turn|spin)s? "
    r"(?:(?:it|on|going|moving|running|turning|spinning|rolling|walking|rotating|at|with|the|its|same|usual|normal|"
    r"full|speed|pace|rate|until|till|to|very|end|of|clip|scene|film|all|time|whole|forever) ?)+$"
)
_AS_IT_IS = bag(
    "same otherwise unchanged usual usually normal normally before nothing again still does did now already carry "
    "carries carrying continue continues resume resumes whole all onwards"
)
_SAYS_NO_MORE = _AS_IT_IS | bag(
    "it he she they them him her that this one each everything else rest thing things way speed pace rate "
    "tempo time as so too quick quickly fast slow slowly do is are was has have had like happened happens when how "
    "what just simply then later after afterwards keep keeps keeping on in out of off up down back and can could "
    "should must may shall will would see seen be to at with the its his their a go goes let than exactly start "
    "starts starting begin begins beginning end ends ending stop stops old own colour color look one for run runs "
    "motion movement animation"
)
_ENDLESS = re.compile(r"\b(?:not|never) (?:ever )?(?:stop|halt|pause|end|rest)|\b(?:keep|go on|continue)\b")
_STATED = re.compile(
    r"^(?:(?:it|this|that|there|i|we|you|people|guests|everyone|everybody|nobody|someone|my \w+|our \w+|his|her)"
    r"(?: (?:really|just|all|only|also|always))* (?:is|are|am|was|were|'s|would|will|do|does|can|cannot|could|may|"
    r"might|love|loves|like|likes|hate|"
    r"hates|need|needs|find|finds|think|thinks|feel|feels|look|looks|seem|seems|get|gets|have|has|keep|keeps|make|"
    r"makes|want|wants|say|says)\b|(?:too|so|very|much too|way too) \w+(?: like (?:that|this))?$|"
    r"(?:thanks|thank you|cheers|great|nice|good|perfect|sorry|hmm|hm|well)\b(?: .{0,30})?$)"
)
_ASKS = re.compile(
    r"\b(?:make|let|have it|should|must|shall|stop|start|move|open|close|hide|paint|turn|play|slow|speed|put|delete|"
    r"remove|instead|freeze|spin|delay|fade|show|please|to be|to stop|to start|to move|to go|to open|to close|to fall|"
    r"to turn|\d)\b"
)
_NOT_WANTED = re.compile(
    r"^(?:(?:the|this|that|it) (?:\w+ ){0,3}(?:is|are|looks?) (?:\w+ ){1,3}(?:, )?but )?"
    r"(?:(?:i|we) (?:do not|would not|never) (?:want|like|wish)(?: (?:that|for))?|do not let) "
    r"(?:it|he|she|the \w+(?: \w+)?) (?:to )?(?:hit|hits|reach|reaches|touch|bump|crash|"
    r"end up|(?:run|roll|go|walk|drive|move|get|come|travel)s? (?:all the way|right up|as far as|up|quite as far))\b.*$"
)
_HOW_IT_IS = re.compile(r"^(?:it|he|she|they|the [a-z]+(?: [a-z]+)?) (?:is|are|stands?|stays?) ")
_LAST_JOINTS = (" , and then ", " , but ", " , and ", " , then ", " and then ", " but ", " while ", " , ")
_LED = re.compile(
    r"^(?:when|whenever|once|as soon as|after|while|until|till|before|by the time|the moment)\b"
)  # a time
_OPENS = bag("when how what at with to in let keep")  # which begin a time or an order, and no remark
_ITS_TIME = re.compile(rf"\bits (?:full|whole|usual|normal|entire) {DURATION}")
_JOINT = re.compile(r" ,(?: (?:and|but))? | (?:and|but) ")


def folded(said: str) -> str:
    """An instruction of several sentences with as few as say the same.

    >>> folded("push the chair to the bed . start at 1 second and take two seconds for it")
    'push the chair to the bed from 1 second in two seconds'
    """
    parts = [_without_end(p) for p in (p.strip(" ,.;") for p in _SPLIT.split(f"{said} . ")) if p]
    if len(parts) < 2:
        return parts[0] if parts else said
    made: list[str] = []
    asks = False  # whether the last one made asks for something, to which the next may belong
    for i, part in enumerate(parts):
        tells = told_of(part) is not None
        if not tells and _is_said_beside(part, first=i == 0):
            continue
        if asks and (detail := _detail(part)) is not None:
            made[-1] = f"{made[-1]} {detail}"
            asks = told_of(made[-1]) is None
        elif not (asks and _goes_without_saying(made[-1], part)):
            made.append(part)
            asks = not tells
    return " . ".join(made) if made else said


def _without_end(part: str) -> str:
    """A sentence without what goes without saying behind its last comma: "..., leave it up there"."""
    for joint in _LAST_JOINTS:
        head, mark, tail = part.rpartition(joint)
        if (
            mark
            and len(head.split()) > 2
            and not (_LED.match(head) and " , " not in head)
            and not (joint == " while " and _HOW_IT_IS.match(tail))
            and not GOES_BACK_WHEN.search(tail)
            and (_goes_without_saying(head, tail) or _says_no_more(tail) or changes_nothing(tail))
        ):
            return _without_end(head.rstrip(" ,"))
    return part


def _says_no_more(said: str) -> bool:
    """Whether words tell only that all else is as it is: "same roll otherwise", "each falling as quick as it does"."""
    words = _ITS_TIME.sub("its whole time", said).split()
    if not 1 < len(words) <= 12 or not _AS_IT_IS & set(words) or words[0] in _OPENS:
        return False
    return all(w in _SAYS_NO_MORE or has_form(w, MOTION, "plain", "s", "ing") for w in words)


def _goes_without_saying(before: str, said: str) -> bool:
    """Whether a sentence tells that something stays as the one before has it."""
    return _STAYS.match(said) is not None or (_ON.match(said) is not None and _ENDLESS.search(before) is not None)


def _is_said_beside(part: str, first: bool) -> bool:
    """Whether a sentence asks for nothing: "it is drafty", "my daughter would love that"."""
    if first and _NOT_WANTED.match(part):
        return True  # the sentence behind it says what is wanted
    return changes_nothing(part) or (_STATED.match(part) is not None and not _ASKS.search(part))


def _detail(part: str) -> str | None:
    """The time that a sentence adds to the one before, None if it says anything else."""
    for pattern, plain in _DETAILS:
        if (found := pattern.match(part)) is not None:
            return found.expand(plain)
    pieces = [p.strip(" ,") for p in _JOINT.split(part) if p.strip(" ,") and not changes_nothing(p.strip(" ,"))]
    if not pieces or pieces == [part]:
        return None
    details = [_detail(piece) for piece in pieces]
    return None if None in details else " ".join(d for d in details if d is not None)
