"""How fast, which way, and how in passing."""

from __future__ import annotations

from ..moments import DURATION
from .wording import (
    EVENT,
    IN_ORDER,
    ING,
    IT,
    NAMED,
    PLAIN,
    POINT,
    SHARE,
    Rules,
    S,
    in_order,
    rate,
    slowed_to,
    with_unit,
)

_LIGHT = r"(?:the |my |that |this )?(?:[a-z]+ )?(?:lamp|light|lantern|candle|bulb|chandelier)s?"


def _turned(side: str, other: str) -> tuple[str, str]:
    """The rule of what turns to the other side: "wrong way, the robot should turn right at the corner"."""
    to, instead = "(?:to the )?", "(?:and not|not|instead of|rather than)"
    told = rf"(?=.*\b(?:wrong way|mirror|{instead} {to}(?:left|right))\b)"
    who = rf"(?:.*?(?:,|:|\.) )?(?:at the corner (?:, )?)?(?P<np>{NAMED}|he|she|it)"
    wish = r"(?:(?:should|must|has to|is to|ought to) )?turns? (?:90 degrees |by a quarter turn )?"
    corner = r"(?: at (?:the|its|that) (?:corner|turn|bend))?(?: by a quarter turn)?"
    said = rf"^{told}{who} {wish}{to}{side}{corner}(?:(?: ,)? {instead} {to}{other})?$"
    return said, rf"\g<np> turns {side} instead of {other}"


RULES: Rules = (
    # what is switched off
    (r"^(?:kill|cut) (?P<np>(?:the |that |this |my )?(?:[a-z]+ )?(?:fan|wheel|windmill|propeller|rotor|carousel|motor|"
     r"engine|machine))\b(?! (?:in|into|out|off)\b)", r"stop \g<np>"),
    (rf"^(?P<v>turn|switch|shut) (?P<np>{_LIGHT}) (?P<how>off|on)\b(?! (?:the|a|an|its|my|our|that|this|top)\b)",
     r"\g<v> \g<how> \g<np>"),
    (rf"^(?P<np>{_LIGHT}) (?:(?:should|must|shall|is to|has to) )?(?:goes|go|turns?|switch(?:es)?) "
     r"(?:dark|out|off|black)\b", r"turn off \g<np>"),
    (rf"^(?P<np>{_LIGHT}) (?:(?:should|must|shall|is to|has to) )?(?:comes|come|goes|go|turns?|switch(?:es)?|lights?) "
     r"(?:on|up)\b", r"turn on \g<np>"),
    (r"^(?:remove|delete|drop|cancel|get rid of) (?:the|all|all the|any|every|its) (?:motion|movement|animation)s?$",
     "everything should stand still"),
    (r"^(?P<x>(?:let|have|make|send|roll|drive|walk|the) .* to (?:the|my) [a-z ]+?)(?: ,)?(?: and)?(?: then)? "
     r"(?:(?:come|go|roll|walk|drive|return)s? )?back(?: again)?$", r"\g<x> , then let it go back the way it came"),
    _turned("right", "left"),
    _turned("left", "right"),
    # how fast
    (r"(?P<x>\b(?:stop|halt|freeze|end|pause)s? .+?)(?: ,)? and (?:go|walk|move|travel|roll|get|come) no (?:further|"
     r"farther|more)$", r"\g<x>"),
    (r"(?P<x>\b(?:\d+(?:\.\d+)?|[a-z]+) (?:degrees?|deg|°|cm|m|met(?:re|er)s?|centimet(?:re|er)s?))(?: ,)? (?:and |but "
     r")?"
     r"(?:no|not|nothing) (?:more|further|farther|wider)(?: than (?:that|this))?$", r"\g<x>"),
    (r"(?: ,| \.) (?:and )?(?:no|without) (?:waiting|hanging|messing|dawdling|faffing|loitering|delay|dithering|"
     r"mucking|pausing)(?: (?:around|about))?$", ""),
    (r"(?P<x>\btoo [a-z]+) for (?:my|our|the|his|her|their) [a-z]+ to (?:follow|see|watch|enjoy|understand|take in|"
     r"catch|keep up|notice|believe)(?: it| with it)?\b", r"\g<x>"),
    (r"(?<=slow it) (?:down )?(?:to|at) (?P<f>half|a third|a quarter) (?:of )?(?:what it is|what it was|that)(?: now| a"
     r"t "
     r"present| at the moment)?$", r" to \g<f> the speed"),
    (r"\b(?:complete|finish|do|make|perform)s? (?:its|his|her|the) [a-z]+ in half the (?:usual |present |current )?time"
     r"(?: it (?:takes|needs))?(?: (?:now|at present|currently|at the moment))?$", "move twice as fast"),
    (rf" , (?:it |he |she )?should (?:take|last|need) (?:about |only |just )*(?P<d>{DURATION})$", r" in \g<d>"),
    (r"(?: ,)? (?:and )?(?:(?:keep(?:ing)?|with|at) )?(?:the|its|his)? ?same (?:duration|length|speed|pace|timing|"
     r"tempo)(?: as (?:now|before))?$", ""),
    (rf"^(?:move|shift|push|put|set|delay) (?P<np>{NAMED}) 's (?:start|beginning|begin) to (?P<d>{POINT})$",
     lambda m: f"start {m['np']} at {with_unit(m['d'])}"),
    (r"(?P<a>\bstops? (?:at|after|when|once) .+?)(?: ,)? and (?:not|never) (?:go|walk|roll|move|continue|reach|carry|"
     r"come|get|drive)\b[^,.]*$", r"\g<a>"),
    (r"(?: ,)? without (?:ever |any )?(?:stopping|pausing|a break|a pause|resting|breaks|pauses|interruptions?)\b", ""),
    (rf"^(?P<np>{NAMED}) (?:(?:is|are|seems?|looks?|{S}) )(?:[a-z]+ )??too (?:fast|quick|quickly)(?: for (?:me|us|my "
     r"(?:taste|liking|eyes)))?$", r"let \g<np> move slower"),
    (rf"^(?P<np>{NAMED}) (?:(?:is|are|seems?|looks?|{S}) )(?:[a-z]+ )??too (?:slow|slowly|sluggish)(?: for (?:me|us|my "
     r"(?:taste|liking|eyes)))?$", r"let \g<np> move faster"),
    (rf"^(?:spin|rotate|whirl) (?P<np>{NAMED}) (?:in )?the (?:other|opposite|reverse) (?:way|direction)"
     r"(?: round| around| about)?(?= ?(?:[,.]|$))", r"let \g<np> turn the other way round"),
    (r"(?: ,)? like (?=(?:in|over|for|about|at|around|half|twice|double) |\d)", " "),
    (r"\bgive (?P<np>(?:the |my )?[a-z ]+?) (?P<n>a|an|one|two|three|four|\d+) (?:full |single |complete |slow |"
     r"quick )?(?:twirl|pirouette|rotation|revolution|whirl|round)s?\b(?! (?:per|a|every|each|in a) )",
     r"spin \g<np> \g<n> turns"),
    (r"\b(?:no more than|not more than|at most|a maximum of|at maximum|as much as) (?=(?:\d|[a-z]+ (?:degrees?|cm|"
     r"centimet(?:re|er)s?|m|met(?:re|er)s?|seconds?)\b))", ""),
    (rf"(?:,|\.|and)? ?(?P<d>{DURATION}) (?:is|will be|would be|should be) (?:enough|plenty|sufficient|fine|ok|okay)"
     r"(?: for (?:it|that|this|him|her))?$", r" in \g<d>"),
    (r"^(?:let |have |make )?(?P<np>(?:the |my )?[a-z ]+?) (?:(?:should|must|shall|to|can|could|may) )?(?:do|does|"
     rf"play|run|walk|perform|make)s? (?:its|his|her|the) (?:{EVENT}|way|path|route|thing) (?P<b>backwards?|in "
     r"reverse)\b", r"play \g<np> 's motion \g<b>"),
    (r"\b(?P<n>one|a|1|two|2|three|3) (?:full )?(?P<t>twirl|spin|turn|pirouette|rotation|revolution)s?(?: ,)? all "
     r"the way (?:round|around)\b", r"\g<n> \g<t>"),
    (r"(?: ,)? (?:but )?(?:for )?(?:just |exactly )?as long as (?:now|before|it does(?: now)?|usual)$", ""),
    (r"\b(?:its|his|her|the) (?:way|path|route) (?=in reverse|backwards?)", ""),
    (r"\ba (?:little|bit|little bit)(?: (?:as well|too|also|more))? (?:, )?(?=(?:\d+|[a-z]+) (?:cm|m|degrees?|"
     r"centimet(?:re|er)s?|met(?:re|er)s?)\b)", ""),
    (rf"(?: ,)? (?:instead of|rather than) (?:it )?{ING} (?:all the way|on|further|right|over|the whole way|up)(?: "
     r"(?:to|into|against|up to|until) (?:the|its) [a-z]+(?: [a-z]+)?)?(?= ?(?:[,.]|$))", ""),
    (r"\bto (?P<f>half|a third|a quarter|double|twice|triple) (?:of )?(?:its|the|his|her) (?:pace|speed|tempo|rate|"
     r"velocity)\b", r"to \g<f> the speed"),
    (r"^(?:take|bring|dial|drop|turn|set|cut|put|knock) (?P<x>it|(?:the |my )?[a-z]+(?: [a-z]+)??) (?:down |back |up "
     r")?(?:to|at) (?P<f>half|a third|a quarter|double|twice|triple) (?:of )?(?:its|the|his|her) speed\b",
     r"play \g<x> at \g<f> speed"),
    (r"\b(?P<n>two|three|four|five|\d+) times (?:as )?slow(?:er|ly)?\b", r"\g<n> times slower"),
    (IN_ORDER, in_order),
    (r"(?: ,| and)?(?: let us)? say (?=(?:right |exactly )?(?:from|between|over|in|at|by|for|about|around|half|twice|"
     r"double|a |an |\d|one|two|three|four|five|ten) ?)", " "),
    (rf"\b(?P<a>(?:as|so) [a-z]+|[a-z]+er|more [a-z]+) (?:as|than) {IT} (?:(?:does|do|is|are|did) )?(?:at present|at "
     r"the moment|right now|currently|so far)\b", r"\g<a>"),
    (rf"^(?P<f>{SHARE}) (?:speed|pace|tempo) (?:on|for) (?P<x>.+)$", r"play \g<x> at \g<f> speed"),
    (rf"\bin slow ?motion ,? ?(?:at )?(?P<f>{SHARE}) (?:speed|pace|tempo)\b", r"at \g<f> speed"),
    (r"\b(?:one|1|a|a single|a full|one full) (?:round|turn|revolution|rotation) (?:in|every|per|each) "
     rf"(?P<d>{DURATION})(?=(?: ,)? (?:from|between|all|always|the whole|throughout|for|until))", rate),
    (r"(?<= )(?:its|his|the) (?:whole|entire|full|complete) (?:way|path|route)(?= \S)(?! (?:to|from|back|through)\b)",
     ""),
    (r"\b(?:with|at|to|in) (?:the |its )?(?P<f>double|half|triple|twice)(?: of)?(?: the| its)? (?:speed|velocity|"
     r"pace|tempo)\b", r"at \g<f> speed"),
    (r"^(?:put|set|run|get) (?P<x>the [a-z ]+?) (?=at (?:double|half|triple|twice) speed)", r"play \g<x> "),
    (r"(?:\b(?:(?:could|can|should|must|let|have) )*(?P<w>the [a-z ]+?|it) (?:(?:should|must|to|can|could) )?be "
     r")?\b(?:slow(?:ed)?|sped|speed|brought|reduced|bring|set)(?: down| up)? (?P<x>(?:the [a-z ]+? |it ))?(?:down |"
     r"up )?(?:to|at) (?:just |only )?(?:one|1|a|a single|one full) (?:round|turn|revolution|rotation) (?:in|every|"
     rf"per|each) (?P<d>{DURATION})", slowed_to),
    (r"(?: ,)? (?:as )?(?:seen|viewed|looking|looked at|when (?:one|you|we) (?:looks?|sees? it)|if (?:one|you|we) "
     r"looks?) (?:at it )?(?:down )?from (?:above|the top|on top|the ceiling)\b|^(?:as )?(?:seen|viewed|looking) "
     r"from (?:above|the top) ,", ""),
    (r"(?: ,)?(?: so)? (?:counter|anti)? ?-?clockwise(?: ,)? (?:rather than|instead of|and not|not) (?:counter|"
     r"anti)? ?-?clockwise\b", " the other way"),
    (r"\b(?P<w>(?:other|opposite) (?:way(?: round| around)?|direction))(?: ,)? (?:so|i e|that is|meaning|namely|"
     r"hence) (?:counter|anti)? ?-?clockwise\b", r"\g<w>"),
    (r"(?: ,)? (?:and |but )?still (?:running|turning|going|moving|spinning) (?=from |until |between )", " "),
    (r"^(?P<r>(?:rewind|reverse) .+?|play .+? (?:in reverse|backwards?)|.+? (?:in reverse|backwards?))(?: ,)? so "
     r"(?:that )?(?:it|they|he|she|we|the [a-z]+)(?: all| both)? [a-z ]+$", r"\g<r>"),
    (r"\b(?P<w>go|come|went|came)(?:es|s)? down together\b", "fell"),
    # what it is not
    (r"(?P<a>\d(?:\.\d+)? ?(?:cm|m|degrees?|deg|°|centimet(?:re|er)s?|met(?:re|er)s?|%|percent))(?: ,)? (?:and "
     r")?(?:not|(?<=m )(?:instead of|rather than))(?: the)?(?: (?:usual|present|current|full|whole|all))* "
     r"\d+(?:\.\d+)?(?: ?(?:cm|m|degrees?|deg|°|centimet(?:re|er)s?|met(?:re|er)s?|%|percent))?(?= ?(?:[,.]|$))",
     r"\g<a>"),
    (r"(?P<b>\b(?:backwards?|in reverse|the other way(?: round| around)?))(?: ,)?(?: so)? from (?:the|its) [a-z]+(?: "
     r"[a-z]+)? (?:back |home )?to (?:the|its) [a-z]+(?: [a-z]+)?$", r"\g<b>"),
    (r"(?<=second|econds)(?: ,)? (?:instead of|rather than|and not|not)(?: (?:at|after|until|by|in))?(?: already| "
     rf"only)? {POINT}(?: and a half)?(?= ?(?:[,.]|$))", ""),
    (rf"^(?P<x>.+?) (?:should|must|shall|may|does|will) not (?P<y>.+?) (?:at|after|from|by) {POINT}(?: already)?(?: "
     rf",)? but (?:(?:first|only|rather|instead|already|just) )*(?P<w>at|after|from) (?P<d>{POINT})$",
     r"\g<x> should \g<y> \g<w> \g<d>"),
    (rf" not (?:at|after|from) {POINT}(?: ,)? but (?:(?:first|only|rather|instead|already) )*(?=(?:at|after|from) )",
     " "),
    (rf"(?: ,)? (?:instead of|rather than) (?:it )?{ING} (?:(?:at|after|by|until|from) (?:already )?{POINT}|there|"
     r"then|halfway|early|on)$", ""),
    # what it comes to
    (rf"(?: ,)? so (?:that )?{IT} (?:starts?|begins?|ends?|stops?|happens?|moves?|comes?) (?:later|earlier|sooner)"
     r"(?: than (?:now|before|it does))?$", ""),
    (rf"(?P<b>\b(?:backwards?|in reverse|the other way(?: round| around)?)) ,? ?so (?:that )?{IT} (?:starts?|begins?|"
     r"sets?)(?: out| off)? (?:at|from|by|on|in) [a-z ]+? and (?:finishes|ends|stops|arrives)(?: up)? (?:at |in "
     r")?where [a-z ]+$", "backwards"),
    (r" (?:,|-|–|—|;|and|then|so)(?: and| then)* (?:it |he |she )?(?:just |simply |then )*(?:stands?|stays?|remains?|"
     r"rests?|waits?|lies?|sits?)(?: just| simply)*(?: (?:there|still|so|put))* from (?:then|there|that (?:point|"
     r"moment|time)) on(?:wards?)?$", ""),
    (r"^(?P<x>(?:everything|all|all that|whatever|anything)(?: that| which)? (?P<np>the [a-z ]+?) (?:does|is doing))"
     r"\b", r"the movement of \g<np>"),
    # how, in passing
    (r"(?: ,)? (?:as (?:though|if)|like) (?:he |she |it )?(?:is |was |were )?(?!(?:no|any|some|every)thing)"
     r"[a-z]+ing(?: [a-z]+)?(?= ?(?:[,.]|and\b|$))", ""),
    (r"(?: ,)? as (?:if|though) (?:the|its|his|this|that|my) [a-z ]+? (?:was|were|is|had|has|would)\b[^.]*$", ""),
    (r"^(?:crank|speed|rev|gear|wind)(?: up)? (?P<np>(?:the|that|this|my) [a-z]+(?: [a-z]+)?)(?: up)?(?: ,| to)+ (?P<r>"
     r"(?:one|two|three|four|half a|\d+(?:\.\d+)?) (?:turns?|rounds?|revolutions?) (?:a|per|each|every) (?:second|"
     r"minute))$", r"spin \g<np> at \g<r>"),
    (r"(?: ,)? (?:nicely|neatly|dramatically|elegantly|gracefully|majestically|mysteriously|magically|happily|sadly|"
     r"proudly|obediently|politely|dutifully|cheerfully|spookily|silently|quietly|on its own|all by itself|by itself|"
     r"for (?:me|us|you)|spinny|in style|like magic)(?= |$)", ""),
    (r"\b(?:a (?:bit|little|touch|tad)|slightly|somewhat|much|way|far) (?P<w>sooner|earlier|later) (?=(?:, "
     r")?(?:please )?(?:, )?(?:already )?(?:at|from) )", r"\g<w> "),
    (r"(?: ,(?: just| a bit| kind of| sort of)? like| (?:, )?as if| (?:, )?as though) (?:a|an|some|it|there|someone|"
     r"somebody|they|you|he|she|in a|on a|in the|for)\b(?! (?:is|was) now)[^.]*$", ""),
    (r"\b(?:to (?:the|its|his) )?(?P<a>left|right)(?:wards?)? ,? ?(?:instead of|rather than|and not|not)(?: "
     r"turning)? (?:to (?:the|its|his) )?(?!(?P=a))(?:left|right)\b", "to the opposite side"),
    (rf"^(?:move|shift|push|put|set|reschedule) (?P<x>the {EVENT} of the [a-z ]+?|the [a-z ]+? 's {EVENT}) to "
     rf"(?P<d>{POINT})$", lambda m: f"start {m['x']} at {with_unit(m['d'])}"),
    (r"^(?:let |make |have )?(?P<x>(?:the |my )?[a-z ]+?) (?:(?:should|must|may|shall|can|to) )?(?:(?:only|just) "
     rf"(?:{PLAIN}|{S}) (?:for|during|in)|(?:{PLAIN}|{S}) (?:only|just) (?:for|during|in)) the first "
     rf"(?P<d>{DURATION})$", r"stop \g<x> at \g<d>"),
    (r"\b(?:changes?|switch(?:es)?|reverses?) (?:its |the |his )?direction(?: of (?:rotation|travel|spin))?(?= |$)"
     r"(?! of)", "turn the other way"),
    (r"\bafter (?=(?:only |just )?(?:[\d.]+|one|two|three|a|half a) ?(?:m|cm|metres?|meters?|centimet(?:re|er)s?)\b)",
     "at "),
)  # fmt: skip
