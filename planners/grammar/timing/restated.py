"""Turns of phrase about time and motion, and the same in words that the readers know.

A rule covers a way of saying something, not a sentence: what it drops is said already by what it keeps.
"""

from __future__ import annotations

from collections.abc import Callable

from ....gaussians import late_re as re
from .asides import HUES
from .manner import MOTION
from .moments import DURATION, OWN, seconds_of
from .verbs import SENSES, any_of, forms

_PLAIN = any_of(MOTION, "plain")
_S = any_of(MOTION, "s")
_ING = any_of((*MOTION, "stop"), "ing")
_IT = "(?:it|he|she|they)"
_EVENT = "(?:motion|movement|animation|walk|roll|fall|drop|swing|ride|flight|turn|slide|run|move)"
_BEGIN = (
    "(?:sets? (?:off|out)|starts?|begins?|moves?(?: off)?|goes|gets? (?:going|moving)|got (?:going|moving)|"
    "began|started|set off|moved)"
)
_COLOR = f"(?:(?:light |dark |bright |deep )?(?:{HUES}|turquoise))"
_SHARE = "(?:a )?(?:half|quarter|third|double|triple|twice)(?: (?:of )?(?:the|its))?"
_POINT = rf"(?:(?:t|second) =? ?\d+(?:\.\d+)?(?: s(?:econds?)?)?|{DURATION}|\d+(?:\.\d+)?|one|two|three|four|five)"
_LENGTHS = "for over within in lasting by until till from between last first next the and"
_NO_LENGTH = "".join(f"(?<!{w})" for w in _LENGTHS.split())  # behind one of these words it is no time after something
_CAUSING = {"letting": "let", "having": "have"}  # which no sense of a verb holds
_PASTS = {past: verb for verbs in SENSES.values() for verb in verbs.split(", ") for past, form in forms(verb)
          if form == "past" and " " not in verb}  # fmt: skip


def _with_unit(time: str) -> str:
    """A number of seconds with its unit."""
    time = re.sub(r"^(?:t|second) =? ?", "", time)
    return time if re.search(r"\bs(?:ec|$)", time) else f"{time} seconds"


def _from_to(found: re.Match[str]) -> str:
    """ "leaving at one and getting there at three"."""
    return f" from {_with_unit(found['a'])} to {_with_unit(found['b'])}"


def _wished(found: re.Match[str]) -> str:
    """ "(I would be pleased if) the robot turned": a wish, in the form of what was."""
    verb = _PASTS.get(found["verb"])
    return found[0] if verb is None else f"let {found['np']} {verb}{found['rest']}"


def _between(found: re.Match[str]) -> str:
    """ "beginning at two seconds and being fully open only at four"."""
    before = found["before"]
    if found["how"]:  # it moves already, at another pace
        before = re.sub(rf" (?={_PLAIN}$)", " start to ", before)
    return f"{before}{_from_to(found)}"


def _plain_of(verb: str) -> str:
    """A verb in its plain form."""
    return next((v for vs in SENSES.values() for v in vs.split(", ") for form, _ in forms(v) if form == verb), verb)


def _unwished(said: str) -> str:
    """A name without the wish before it, and without "should" behind it."""
    said = re.sub(r"^(?:i|we) (?:would like|want|would love|would prefer|need) |^(?:let|make|have) ", "", said)
    return re.sub(r" (?:should|must|shall|ought|needs|has)(?: to)?$", "", said)


def _gone(found: re.Match[str]) -> str:
    """ "have the lamp vanish at three seconds and come back at four"."""
    return f"hide {_unwished(found['x'])}{_from_to(found)}"


def _colored(found: re.Match[str]) -> str:
    """ "the vase goes red at 1 s, back to blue at 3 s"."""
    return f"make {found['x']} {found['c']}{_from_to(found)}"


def _counted(found: re.Match[str]) -> str:
    """The article before a unit as a number, so that it begins no name: "a second lamp"."""
    return found[1] or "one "


_SETS_OFF = "(?:leaving|setting off|departing|start(?:s|ing)?|begin(?:s|ning)?|leaves)"
_IS_THERE = (
    "(?:(?:getting|being|gets|is) there|arriv(?:es|ing)(?: there)?|reaching it|done|end(?:s|ing)?|stop(?:s|ping)?|"
    "finish(?:ed|es|ing)?|over|there)"
)


def _slowed_to(found: re.Match[str]) -> str:
    """ "slowed to one turn every two seconds"."""
    seconds = seconds_of(found["d"])
    whom = (found["x"] or found["w"] or "it").strip()
    return found[0] if not seconds else f"spin {whom} at {1 / seconds:g} turns per second"


def _rate(found: re.Match[str]) -> str:
    """ "one round in four seconds", where how long it goes on is said besides."""
    seconds = seconds_of(found["d"])
    return found[0] if not seconds else f"{1 / seconds:g} turns per second"


_RULES: tuple[tuple[str, str | Callable[[re.Match[str]], str]], ...] = (
    # how it is written
    (r"\bthats\b", "that is"), (r"\bdont\b", "do not"), (r"\bdoesnt\b", "does not"), (r"\bb4\b", "before"),
    (r"\b(?P<w>whatever|what|anything) (?:it is|is it) (?:that|which) (?=is |are |\w+s\b)", r"\g<w> "),
    (r"\bso long as\b", "as long as"), (r"\bdouble (?:so|as) (?=fast|quick|slow)", "twice as "),
    # who asks, and how
    (rf"^(?P<v>{any_of(tuple(SENSES), 'ing')}|{'|'.join(_CAUSING)}) (?=(?:the|all|my|our|"
     rf"it|both|"
     r"that|this|every) )",  # "would you mind letting the ball go"
     lambda m: f"{_CAUSING.get(m['v']) or _plain_of(m['v'])} "),
    (rf"\b(?:(?:i|we) (?:would (?:like|love|prefer)|want|need|wish)(?: to (?:see|have|show|get|watch))?|show|"
     rf"display|render|"
     rf"have|see|dress|tint)(?: us| me)? (?P<np>it|him|her|them|the [a-z ]+?|my [a-z]+) (?:in )?(?P<c>{_COLOR})"
     r"(?= (?:,|\.|and|from|while|when|once|until|till|for|as|at|between|after|before|during|throughout|all|only|"
     r"instead)\b|"
     r"$| [,.])", r"make \g<np> \g<c>"),
    (r"^(?:someone|somebody|you|one) (?:really )?(?:ought to|should|must|has to|have to|needs to|need to|could|"
     r"can) ", ""),
    (r"^it would (?:look|be|seem|feel|get) (?:(?:much|far|a bit|a lot|so|more|even) )*[a-z]+ if ",
     "it would be nice if "),
    (r"\b(?:i|we) (?:do not|would not|no longer) (?:want|wish|like|need) (?:(?:anyone|anybody|people|them|you|us) "
     r")?to (?:be able "
     r"to )?see (?P<np>it|him|her|them|(?:the|my) [a-z ]+?)(?: (?:any ?more|any longer|again|at all))*"
     r"(?= ?(?:[,.]|while|when|until|from|once|after|before|at)|$)", r"hide \g<np>"),
    (r"(?:^|(?<=[.!?;] ))(?:could|can|would|will|should) (?:not )?(?P<it>it|he|she|they) (?:not )?(?:just |simply "
     r"|please |perhaps )*"
     rf"(?=(?:{any_of(tuple(SENSES), 'plain')}|be(?! (?:possible|ok|okay|nice|great|all))) )", r"let \g<it> "),
    (r"\bdo (?:everything|it all|all of it|its thing|all that)\b", "move"),
    (r"\b(?P<v>waits?|holds? (?:on|back)) and (?:then |only then )?(?=(?:only )?(?:sets?|starts?|begins?|goes?|go|"
     r"leaves?|"
     r"moves?) )", ""),
    (r"(?: ,)? so (?:please |just )*(?=(?:make|let|have|turn|put|stop|start|move|play|slow|speed|delay|hide|paint|"
     r"open|close|"
     r"keep|freeze) (?:it|him|her|them|the|that|all)\b)", " . "),
    (r"\bin the direction of (?=the |my |its )", "toward "),
    (r"^(?:what (?:i|we) (?:would )?(?:really )?(?:like|love|want|need)(?: to (?:see|have))? is|(?:all|the thing) "
     r"(?:i|we) (?:want|need|ask)(?: for)? is)(?: that| for| to see)? (?=\S)", "i want "),
    (r"^(?:(?:i|we) (?:am|was|were|are) (?:just )?wondering (?:what|how) it would (?:look|be)(?: like)?|what would it "
     r"(?:look|be) like|what|imagine(?: that)?|(?:i|we) would (?:much )?rather(?: have it)?(?: that)?|how "
     r"would it look)"
     r" (?:if (?:, )?)?(?=(?:(?:starting|beginning) |the |my |our |all |both |every )[^?]*$)", "it would be nice if "),
    (rf"^it would be nice if (?:starting|beginning) (?:at|from|with) (?P<d>{_POINT})(?: ,)? (?P<x>(?:the|my|"
     rf"our|all|both|"
     r"every) .+)$", r"it would be nice if \g<x> from \g<d>"),
    (rf"^(?:starting|beginning) (?:at|from|with) (?P<d>{_POINT}) , (?P<x>.+)$", r"\g<x> from \g<d>"),
    (rf"^do (?={any_of(tuple(SENSES), 'plain')} )", ""),  # "do hide it"
    (r"^(?P<i>i|we) should (?:(?:rather|quite|very much|really|so) )*(?=like\b)", r"\g<i> would "),
    (
        r"^(?:i|we) (?:would|should|am|are) be (?:(?:very|so|most|rather|quite|really) )*(?:pleased|glad|happy|"
        r"grateful|delighted|thankful|obliged) if (?:(?:you|we) (?:could|would|can|will) )?",
        "it would be nice if ",
    ),
    (rf"^it would be nice if you (?P<verb>{'|'.join(sorted(_PASTS))})(?= )", lambda m: _PASTS[m["verb"]]),
    (rf"^it would be nice if (?P<np>(?:the|my|our|every|all|both) [a-z ]+?) (?P<verb>{'|'.join(sorted(_PASTS))})"
     r"(?P<rest>(?: .*)?)$", _wished),
    (
        r"^(?:i|we) (?:should|want to|would like to|must|wish to|need to) see (?P<np>the [a-z ]+?) "
        rf"{_PLAIN} back\b[^;]*? (?:;|:|\.|,) (?:so )?(?:please )?(?:run|play) its (?P<event>{_EVENT}) "
        r"(?:backwards?|in reverse)$",
        r"play \g<np> 's \g<event> backwards",
    ),
    (r"^be so (?:kind|good|nice) as to ", ""),
    (rf"^(?:let|have|make) (?P<np>the [a-z ]+?) (?:run|play|do|make) its (?:{_EVENT}|path|way) "
     r"(?:backwards?|in reverse)$", r"play \g<np> 's motion backwards"),
    (r"^(?:i|we) (?:wish|hope|ask|request|demand|suggest|propose)(?: that)? (?=the |my |it )", "i want "),
    (r"^(?:(?:could|can|would|will) you (?:perhaps |please |maybe )?)?(?:arrange|see to it|set it up|(?:would |will "
     r")?it be possible|"
     r"is it possible|(?:is|would) there (?:be )?(?:a|any) way|make it possible|we need|i need) for (?P<x>.+?) to "
     r"(?=[a-z])", r"let \g<x> "),
    (r"^(?:how|what) about (?:we )?(?:have|let|make|get) ", "let "),
    (r"^(?:let|have|make) only (?P<x>(?:the |my )?[a-z ]+?) (?P<v>[a-z]+)$", r"only \g<x> \g<v>"),
    (r"^(?:there is )?no need for (?P<x>(?:the |my )?[a-z ]+?) to (?=[a-z])", r"do not let \g<x> "),
    (rf"^(?:skip|leave out|omit|cancel|drop|cut out|lose) (?:the (?:part|bit|moment) (?:where|when|in which) "
     rf")(?P<x>the [a-z ]+?) "
     rf"(?P<v>{_S})(?: again)?$", lambda m: f"do not let {m['x']} {_plain_of(m['v'])}"),
    (r"^(?:skip|leave out|omit|cancel|drop|cut out) the (?P<v>opening|closing|falling|rolling|walking|moving|"
     r"spinning) of (?P<x>the "
     r"[a-z ]+)$", lambda m: f"do not let {m['x']} {_plain_of(m['v'])}"),
    (r"^(?:drop|start|launch) (?P<x>(?:the |all )[a-z ]+?) (?:at (?:exactly )?the same (?:time|moment|instant) as|"
     r"together with|along "
     r"with) (?P<y>(?:the |all )[a-z ]+)$", r"let \g<x> start at the same time as \g<y>"),
    (r"\b(?:heads?|heading|sets? (?:off|out)|departs?|leaves?|makes? its way) (?:for|towards?) (?=the |my )", "go to "),
    (rf"\b(?P<w>when|once|while|until|as soon as) "
     rf"(?P<v>{any_of(('stop', 'start', 'reach', 'leave', 'open', 'close'), 's')})(?= the |$)",
     r"\g<w> it \g<v>"),
    (rf"^(?P<x>(?:the )?[a-z ]+?) (?:is |are )?(?P<v>starts?|begins?|starting|{_S})(?: [a-z]+){{0,2}} (?:too "
     rf")?(?:early|late|soon)(?: for my "
     rf"taste)? , (?:please )?(?:(?:make|have|do) it (?:at )?|at |better (?:at |make it )?)?(?P<d>{DURATION})(?: "
     rf"(?:would|is|would be|"
     rf"might) (?:be )?(?:better|nicer|good|nice|fine))?$", r"start the \g<x> at \g<d>"),
    (r"^start the the ", "start the "),
    (rf"\b(?:start|begin) (?P<v>{any_of(('close', 'open', 'hide', 'rise', 'sink'), 'ing')}) (?=(?:the|it|my|that|"
     rf"all|them)\b)",
     lambda m: f"{_plain_of(m['v'])} "),  # what begins is not what moves already
    (rf"\b(?:tips?|topples?)(?: over)? (?=(?:about |exactly )?{DURATION} (?:later|earlier|sooner))", "start "),
    (r"\b(?P<w>begin|start)(?P<s>s)? (?:to tip|tipping|to topple|toppling)(?: over)?\b", r"\g<w>\g<s>"),
    (r"\blet (?P<x>it|him|her|them|the [a-z ]+?) (?:keep|stay|remain|be|hold|stand) still\b", r"keep \g<x> still"),
    (rf"\b(?P<x>it|he|she) takes? (?P<d>{DURATION}) to (?P<v>{_PLAIN})\b", r"\g<x> \g<v> in \g<d>"),
    # how fast
    (rf"\b(?P<a>(?:as|so) [a-z]+|[a-z]+er|more [a-z]+) (?:as|than) {_IT} (?:(?:does|do|is|are|did) )?"
     r"(?:at present|at the moment|right now|currently|so far)\b", r"\g<a>"),
    (rf"^(?P<f>{_SHARE}) (?:speed|pace|tempo) (?:on|for) (?P<x>.+)$", r"play \g<x> at \g<f> speed"),
    (rf"\bin slow ?motion ,? ?(?:at )?(?P<f>{_SHARE}) (?:speed|pace|tempo)\b", r"at \g<f> speed"),
    (rf"\b(?:one|1|a|a single|a full|one full) (?:round|turn|revolution|rotation) (?:in|every|per|each) "
     rf"(?P<d>{DURATION})(?=(?: ,)? (?:from|between|all|always|the whole|throughout|for|until))", _rate),
    (r"(?<= )(?:its|his|the) (?:whole|entire|full|complete) (?:way|path|route)(?= \S)(?! (?:to|from|back)\b)", ""),
    (r"\b(?:with|at|to|in) (?:the |its )?(?P<f>double|half|triple|twice)(?: of)?(?: the| its)? (?:speed|velocity|"
     r"pace|tempo)\b",
     r"at \g<f> speed"),
    (r"^(?:put|set|run|get) (?P<x>the [a-z ]+?) (?=at (?:double|half|triple|twice) speed)", r"play \g<x> "),
    (rf"(?:\b(?:(?:could|can|should|must|let|have) )*(?P<w>the [a-z ]+?|it) (?:(?:should|must|to|can|could) )?be "
     rf")?\b(?:slow(?:ed)?|"
     rf"sped|speed|brought|reduced|bring|set)(?: down| up)? (?P<x>(?:the [a-z ]+? |it ))?(?:down |up )?(?:to|at) "
     rf"(?:just |only )?(?:one|1|a|a single|one full) (?:round|turn|revolution|rotation) (?:in|every|"
     rf"per|each) (?P<d>{DURATION})", _slowed_to),
    (r"(?: ,)? (?:as )?(?:seen|viewed|looking|looked at|when (?:one|you|we) (?:looks?|sees? it)|if (?:one|you|we) "
     r"looks?) "
     r"(?:at it )?(?:down )?from (?:above|the top|on top|the ceiling)\b|^(?:as )?(?:seen|viewed|looking) from "
     r"(?:above|the "
     r"top) ,", ""),
    (r"(?: ,)?(?: so)? (?:counter|anti)? ?-?clockwise(?: ,)? (?:rather than|instead of|and not|not) "
     r"(?:counter|anti)? ?-?clockwise\b", " the other way"),
    (r"\b(?P<w>(?:other|opposite) (?:way(?: round| around)?|direction))(?: ,)? (?:so|i e|that is|meaning|namely|hence) "
     r"(?:counter|anti)? ?-?clockwise\b", r"\g<w>"),
    (r"(?: ,)? (?:and |but )?still (?:running|turning|going|moving|spinning) (?=from |until |between )", " "),
    (r"^(?P<r>(?:rewind|reverse) .+?|play .+? (?:in reverse|backwards?)|.+? (?:in reverse|backwards?))(?: ,)? so "
     r"(?:that )?(?:it|they|"
     r"he|she|we|the [a-z]+)(?: all| both)? [a-z ]+$", r"\g<r>"),
    (r"\b(?P<w>go|come|went|came)(?:es|s)? down together\b", "fell"),
    # what it is not
    (rf"(?<=second|econds)(?: ,)? (?:instead of|rather than|and not|not)(?: (?:at|after|until|by|in))?(?: already|"
     rf" only)? "
     rf"{_POINT}(?: and a half)?(?= ?(?:[,.]|$))", ""),
    (rf"^(?P<x>.+?) (?:should|must|shall|may|does|will) not (?P<y>.+?) (?:at|after|from|by) {_POINT}(?: already)?"
     rf"(?: ,)? but (?:(?:first|only|rather|instead|already|just) )*(?P<w>at|after|from) (?P<d>{_POINT})$",
     r"\g<x> should \g<y> \g<w> \g<d>"),
    (rf" not (?:at|after|from) {_POINT}(?: ,)? but (?:(?:first|only|rather|instead|already) )*(?=(?:at|after|from) )",
     " "),
    (
        rf"(?: ,)? (?:instead of|rather than) (?:it )?{_ING} (?:(?:at|after|by|until|from) (?:already )?{_POINT}"
        r"|there|then|halfway|early|on)$",
        "",
    ),
    # what it comes to
    (rf"(?: ,)? so (?:that )?{_IT} (?:starts?|begins?|ends?|stops?|happens?|moves?|comes?) (?:later|earlier|sooner)"
     r"(?: than (?:now|before|it does))?$", ""),
    (
        rf"(?P<b>\b(?:backwards?|in reverse|the other way(?: round| around)?)) ,? ?so (?:that )?{_IT} (?:starts?|"
        rf"begins?|sets?)(?: out| off)? (?:at|from|by|on|in) [a-z ]+? and (?:finishes|ends|stops|arrives)(?: up)? "
        r"(?:at |in )?where [a-z ]+$",
        "backwards",
    ),
    (r" (?:,|-|–|—|;|and|then|so)(?: and| then)* (?:it |he |she )?(?:just |simply |then )*(?:stands?|stays?|remains?|"
     r"rests?|waits?|lies?|sits?)(?: just| simply)*(?: (?:there|still|so|put))* from (?:then|there|that (?:point|"
     r"moment|time)) on(?:wards?)?$", ""),
    (r"^(?P<x>(?:everything|all|all that|whatever|anything)(?: that| which)? (?P<np>the [a-z ]+?) (?:does|is doing))\b",
     r"the movement of \g<np>"),
    # how, in passing
    (r"(?: ,(?: just| a bit| kind of| sort of)? like| (?:, )?as if| (?:, )?as though) (?:a|an|some|it|there|someone|"
     r"somebody|they|you|he|she|in a|"
     r"on a|in the|for)\b(?! (?:is|was) now)[^.]*$", ""),
    (r"\b(?:to (?:the|its|his) )?(?P<a>left|right)(?:wards?)? ,? ?(?:instead of|rather than|and not|not)(?: "
     r"turning)? (?:to (?:the|"
     r"its|his) )?(?!(?P=a))(?:left|right)\b", "to the opposite side"),
    (rf"^(?:move|shift|push|put|set|reschedule) (?P<x>the {_EVENT} of the [a-z ]+?|the [a-z ]+? 's {_EVENT}) to "
     rf"(?P<d>{_POINT})$",
     lambda m: f"start {m['x']} at {_with_unit(m['d'])}"),
    (rf"^(?:let |make |have )?(?P<x>(?:the |my )?[a-z ]+?) (?:(?:should|must|may|shall|can|to) )?(?:(?:only|just) "
     rf"(?:{_PLAIN}|{_S}) "
     rf"(?:for|during|in)|(?:{_PLAIN}|{_S}) (?:only|just) (?:for|during|in)) the first "
     rf"(?P<d>{DURATION})$", r"stop \g<x> at \g<d>"),
    (r"\b(?:changes?|switch(?:es)?|reverses?) (?:its |the |his )?direction(?: of (?:rotation|travel|spin))?(?= |"
     r"$)(?! of)",
     "turn the other way"),
    (r"\bafter (?=(?:only |just )?(?:[\d.]+|one|two|three|a|half a) ?(?:m|cm|metres?|meters?|centimet(?:re|"
     r"er)s?)\b)", "at "),
    # where to, and where not to
    (r"^(?P<x>.+ (?:to|toward|towards|into|at|against|beside|by|till|until) .+?)(?: ,)? "
     r"(?:instead of|rather than|and not|not) (?:to |at |into |against |on |in |toward |towards |by |beside |"
     r"next to )?(?P<np>(?:the|its|that|a) (?!right$|left$|other way)(?![a-z ]*(?:second|time|speed|way|start|end|"
     r"beginning)s?\b)"
     r"[a-z]+(?: [a-z]+){0,2})(?: like now| as now| as before| like before)?$", rf"\g<x> {OWN}"),
    # when
    (rf"\b(?P<w>until|till|at|from|after) (?P<d>{DURATION}) in(?:to it)?(?= ?(?:[,.]|and\b|then\b|$))", r"\g<w> \g<d>"),
    (r"\b(?P<v>(?:freez|stop|paus|halt)(?:es?|s|ing)?)(?: dead)? in (?:mid ?-? ?(?:air|flight|swing|step|fall|"
     r"turn)|its tracks|place)\b",
     r"\g<v>"),
    (rf"(?: ,| and)+(?: it| he| she)? (?:holds?|hangs?|waits?|rests?|stands?)(?: (?:there|still|motionless|"
     rf"frozen|like that|in "
     rf"place|in mid-air))+ for (?:exactly |just )?(?P<d>{DURATION})", r" for \g<d>"),
    (rf"(?: ,)?(?: and| but)?(?: only)?(?: then| after (?:that|this)| afterwards)*(?: it| he| she)? (?:continues?|"
     rf"carr(?:y|ies) on|"
     rf"goes on|resumes?|proceeds?|keeps? on)(?: (?:to )?(?:{_PLAIN}|{_ING}))?(?: on)?(?: (?:with )?(?:its|the) "
     rf"(?:way|journey|path|"
     rf"{_EVENT}))?(?: ,)? (?:until|till|to|up to|as far as) (?:the|its) [a-z]+$", " and then it carries on"),
    (r"\b(?P<v>leave|keep|hold) (?P<x>the [a-z ]+?) (?:(?:up|down|over) )?there(?: (?:up |over )?(?:on|in|"
     r"at) the [a-z]+"
     r"(?: [a-z]+)?)?(?= ?(?:[,.]|$))", r"do not let \g<x> move"),
    (r"\b(?P<w>stays?|remains?) where (?P<it>it|he|she) is(?: (?:up|down|over))? (?:on|in|at) the [a-z]+(?: [a-z]+)??"
     r"(?= (?:while|and|but|until|when|,|[.])|$)", r"\g<w> where \g<it> is"),
    (r"\b(?P<w>until|till|from|at|after|before) (?:exactly |just )?the (?:very |exact )?(?:moment|point|instant|time)"
     r"(?: (?:when|that|where|in which|at which))? (?=(?:the|my|it|he|she|they|all|both) )",
     lambda m: {"at": "when", "from": "once", "after": "after"}.get(m["w"], m["w"]) + " "),
    (rf"(?P<d>{DURATION}) (?:sharp|exactly|precisely|on the dot)(?= ?(?:[,.]|$))", r"\g<d>"),
    (rf"^(?P<x>.+?) (?:vanish|disappear|hide|go away|be gone|be hidden|be invisible)(?:s|es)?(?: at| from)? (?:at "
     rf"|from )?"
     rf"(?P<a>{_POINT}) (?:, |and |then )+(?:it |he |she )?(?:to )?(?:comes?|is|be|reappears?|appears?|returns?|shows?)"
     rf"(?: (?:back|again|there|up|visible))* (?:at|from) (?P<b>{_POINT})$", _gone),
    (rf"^(?P<x>(?:the |my )?[a-z ]+?) (?:goes|turns|becomes|is|should (?:be|turn|go|become)) (?P<c>{_COLOR}) at "
     rf"(?P<a>{_POINT})"
     rf" (?:, |and |then )+(?:it |turns |goes |is )*(?:back(?: to (?:{_COLOR}|normal|its own colou?r))?|{_COLOR} "
     rf"again|normal"
     rf"(?: again)?) at (?P<b>{_POINT})$", _colored),
    (rf"(?: ,)? and (?:this|that|the|its|the whole) (?:whole )?{_EVENT} (?:(?:should|must|has to|is to|shall|to) )?"
     rf"(?:take|last|takes|lasts) (?P<d>{DURATION})", r" in \g<d>"),
    (rf"(?:^|(?<=[.!?;] ))(?:start|begin) (?P<v>{_ING}) (?P<x>it|the [a-z ]+?) (?:at|"
     rf"from) (?P<a>{_POINT}) (?:, |and |"
     r"please |then )+(?:have it |be |finish |end |it should be |it must be |let it be )(?:(?:fully|completely|"
     r"all the way|quite) "
     rf")?(?:shut|closed|open|done|there|finished)? ?(?:by|at) (?P<b>{_POINT})$",
     lambda m: f"{_plain_of(m['v'])} {m['x']}{_from_to(m)}"),
    (rf"(?: ,)? {_SETS_OFF} (?:at|from) (?P<a>{_POINT})(?: ,)?(?: and)? {_IS_THERE} (?:at|by) (?P<b>{_POINT})$",
     _from_to),
    (r"\bfor (?:a|one) (?:sec|second|moment|bit)(?: ,)? (?=(?:from|between) )", ""),
    (r"(?<=\d) already$", ""),
    (r"\b(?:right|just|shortly|immediately|directly|straight) (?=(?:before|after|when|once) (?:the|it|he|she|"
     r"they|all) )", ""),
    (r"\b(?:during|in|for) (?:all )?the (?:whole )?time (?:in which|during which|when|that|while)\b", "while"),
    (rf"^(?P<x>(?:the )?[a-z ]+?) (?:is |are )?(?:starts?|begins?|starting|{_S})(?: [a-z]+){{0,2}} (?:too )?(?:early|"
     rf"late|soon) ,(?: please)? (?:let it |have it |make it |it should )?(?:start|begin|{_PLAIN})(?: it)? at "
     rf"(?P<d>{_POINT})$", lambda m: f"start the {re.sub('^the ', '', m['x'])} at {m['d']}"),
    (rf"^(?:(?:move|push|shift|set|put|change|bring|pull)(?: forward| back)? )?the (?:start|beginning|onset) (?:of|"
     rf"for) "
     rf"(?P<x>(?:the |my )?[a-z ]+?)(?: 's)? (?:(?:should|must|shall) be )?(?:(?:to|at|is) )?(?P<d>{DURATION})(?: "
     rf"mark)?$",
     r"start the \g<x> at \g<d>"),
    (rf"^start of (?P<x>[a-z ]+?)(?: :)?(?: to| at)? (?P<d>{DURATION})$", r"start the \g<x> at \g<d>"),
    (r"^start the the ", "start the "),
    (rf"\blasts? (?:only |just |for )*(?P<d>{DURATION})$", r"take \g<d>"),
    (rf"^(?P<x>.+?) (?:be|being|to be) the (?P<r>last|first)(?: one| thing| of them)? to (?P<v>{_PLAIN})\b(?P<y>.*)$",
     lambda m: f"let {_unwished(m['x'])} {m['v']} {m['r']}{m['y']}"),
    (rf"^(?P<before>.+?)(?: (?P<how>more (?:gently|slowly)|slower|faster))?(?: ,)? (?:beginning|starting|setting off) "
     rf"(?:only )?(?:at|from) (?P<a>{_POINT}) and (?:only )?(?:being|ending|finishing|stopping|coming to rest|done)"
     rf"(?: (?:fully|completely|all the way|wide|open|closed|shut|done|there|finished|only|just))* (?:at|by) "
     rf"(?P<b>{_POINT})$", _between),
    (r"(?: ,)? but (?:no|not any) longer(?: than that)?$| , and only then(?= ,)", ""),
    (rf"^(?:let|have|make) (?P<np>(?:the|my|our) [a-z ]+?) wait (?:for )?(?P<d>{DURATION}) before {_IT} {_BEGIN}$",
     r"keep \g<np> still for the first \g<d>"),
    (rf"(?P<b>^|(?<!until)(?<!till)(?<!from)(?<!between)(?<!by) )(?:at )?(?P<d>{DURATION}) before the (?:very )?end\b",
     r"\g<b>for the last \g<d>"),
    (rf"(?P<b>^|{_NO_LENGTH} )(?:at )?(?P<d>{DURATION}) after (?=(?:the|my|our|all|both|it|he|she|they) )",
     lambda m: f"{m['b']}after {re.sub(r'(half )?an? (?=second)', _counted, m['d'])} after "),
    (rf"^only after (?P<d>{DURATION}) (?:should|must|may|shall|can) (?P<x>.+)$", r"\g<x> at \g<d>"),
    (r"^only (?P<w>(?:when|once|after) (?:the|it|my|both|all) .+?) (?:should|must|may|shall|can) (?P<x>.+)$",
     r"let \g<x> \g<w>"),
    (r"\b(?P<w>first|last|final) second and a half\b", r"\g<w> one and a half seconds"),
    (r"\bfor (?:just|only) the (?=first|last|final)", "for the "),
    (r"^might (?=(?:the|my|our|this|that|all|every|it) )", ""),
    (rf"^not (?:before|until) (?P<d>{_POINT}) (?:should|must|may|shall|can) (?P<x>.+)$", r"\g<x> at \g<d>"),
    (rf"(?: ,)? (?:but |and |though )?not (?:before|earlier than|sooner than|until) (?P<d>{DURATION})$", r" at \g<d>"),
    (rf"\b(?P<e>{_EVENT})(?P<aux>(?: (?:to|should|must|shall))?) lasts? (?P<d>{DURATION})$",
     r"\g<e>\g<aux> be over \g<d>"),
    (rf"\b(?P<d>{DURATION}) of (?:stillness|standing still|rest|resting|waiting|doing nothing|quiet|silence)\b",
     r"\g<d>"),
    (rf"\b(?P<w>until|till|after|once|when) (?P<d>{DURATION}) (?:has|have|is|are) (?:gone(?: by)?|passed(?: by)?|"
     rf"elapsed|over|up)\b", lambda m: f"{'after' if m['w'] in ('once', 'when') else m['w']} {m['d']}"),
    (rf"\bfor the first (?P<d>{DURATION}|second) (?:before|and (?:only )?then|until) {_IT} {_BEGIN}"
     rf"(?: (?:to )?(?:{_PLAIN}|{_ING}))?$",
     r"for the first \g<d>"),
    (r"\b(?:right |straight |on )?through (?:to|until|till) the (?:very )?end\b", "until the end"),
    (r"\bat (?:exactly |just )?(?:the same|one and the same) (?:moment|instant)\b(?! (?:as|when)\b)",
     "at the same time"),
    # where
    (r"\b(?P<w>up|upwards) (?:off|from|above) (?:the|its|his) [a-z]+(?: [a-z]+)?(?= (?:from|between|at|in|for|"
     r"over|until)|$)",
     r"\g<w>"),
    (r"\bback (?:up |down |over |in )?to (?:its|his|her) (?!start|place|spot|old|first|original|former|"
     r"colou?r)(?P<x>[a-z]+)",
     r"to the \g<x>"),
    (r"\b(?P<w>stays?|remains?|staying) (?:up|down|over|right|back) there\b", r"\g<w> where it is"),
    (rf"(?P<v>\b(?:{_PLAIN}|{_S}|{_ING}))(?: (?:across|through|along|over) the (?:room|floor|scene|ground|"
     rf"air))? and (?:to )?"
     r"(?:ends?|ended|ending|finish(?:es)?|wind|winds) up (?=(?:at|beside|next|by|in|on|near) )", r"\g<v> "),
    (r"(?P<v>\b(?:float|go|move|rise|lift|come|fly)s? (?:up )?(?:by )?)(?P<d>(?:\d+(?:\.\d+)?|[a-z]+) (?:cm|"
     r"centimet(?:re|er)s?|m|"
     r"met(?:re|er)s?)) (?:from|off|above|over) the [a-z]+(?: [a-z]+)?(?= ?(?:[,.]|$))", r"\g<v>\g<d>"),
    (r"(?P<d>\b(?:\d+(?:\.\d+)?|[a-z]+) (?:cm|centimet(?:re|er)s?|m|met(?:re|er)s?)) (?:off|above) the [a-z]+(?: "
     r"[a-z]+)?"
     r"(?= ?(?:[,.]|$))", r"\g<d>"),
    (r"\b(?P<v>(?:drive|roll|move|walk|go|come|slide|run|fly|hop)s?)(?: up| over)? and (?:then )?(?:stop|park|"
     r"halt|wait|stand|"
     r"stay)s? (?=(?:beside|next to|by|near|in front of|behind|at|on) )", r"\g<v> "),
    # which
    (rf"\bthe (?:whole|entire|complete|full) (?P<e>{_EVENT}|action) (?=of the )", r"the \g<e> "),
    (r"\bthe (?:whole |entire )?(?P<x>[a-z]+(?: [a-z]+)?) action\b", r"the \g<x> motion"),
    (rf"\bthe (?:whole|entire|complete) (?P<x>[a-z]+(?: 's)?) (?P<e>{_EVENT})\b", r"the \g<x> \g<e>"),
    (rf"\b(?:cut|break) (?P<x>.+? (?:'s )?{_EVENT}) (?:off|short) (?=at|after|when|once)", r"stop \g<x> "),
    (rf"\b(?P<det>the [a-z ]*?)(?P<noun>[a-z]+) (?P<rest>(?:(?:to|should|must|shall) )?{_PLAIN} (?:before|after|while) "
     r"the [a-z]+) one (?P<do>does|do|did)$", r"\g<det>\g<noun> \g<rest> \g<noun> \g<do>"),
    (rf"\b(?P<verb>{_PLAIN}) (?P<w>before|after|while) (?P<x>(?:the|my|our|both|all) [a-z ]+?) (?:does|do|did)$",
     r"\g<verb> \g<w> \g<x> \g<verb>"),
)  # fmt: skip
_COMPILED = tuple((re.compile(pattern), plain) for pattern, plain in _RULES)


def restated(said: str) -> str:
    """An instruction in words that the readers know.

    >>> restated("half speed on the fan")
    'play the fan at half speed'
    """
    for pattern, plain in _COMPILED:
        said = pattern.sub(plain, said)
    return said.strip(" ,.;")
