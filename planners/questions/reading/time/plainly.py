"""What people say, and the same as it is asked plainly: "is there a moment when it moves" is "it moves at some time".

Each line is a pattern and what takes its place, tried in their order on the words of a question.
"""

from __future__ import annotations

from functools import cache

from .....gaussians import late_re as re

_LINES = r"""
^whether =>
(?: ,)? or not$ =>
^(?:will|would|should|could|shall) (.+?) be\b => is \1
\b(anything|something|else|anybody|nothing) in (?:the|this) (?:whole |entire )?(?:room|scene|clip|film)\b => \1
\b(?:a|one) (?:second|sec) and a half\b => one and a half seconds
\b(two|three|four) (?:seconds|secs) and a half\b => \1 and a half seconds
(?: once and)? for good$ => for the last time
^from (?:what|which|how great a) height (?:does|do|did) (.+?) (?:fall|drop|tumble|plunge)$ => how far does \1 fall
^would i be (?:right|correct)(?: (?:in|to) (?:saying|thinking|say|think))?(?: that)? =>
(?: ,)? (?:when |as |if )?(?:seen|viewed|looking|looked at) (?:from above|from the top)$ =>
\b(?:do|can|will|does) (?:we|you|i|one) (?:first )?(?:see|notice|observe|spot)\b =>
^how (?:many times|often) (a|per|each|every) (second|minute) (.+)$ => how many times \3 per \2
^(?:list|name|give|order) (?:me )?(.+?) in (?:the )?order (?:(?:in which|that) )?(?:they )?(\w.*)$ => in what order \
do \1 \2
^(?:is |was )?(the .+?) (?:is |was )?the only (?:one|thing|object)(?: that| which| to) (.+)$ => nothing besides \1 \2
^(?:what|which) is the (?:only )?(\w+ing) (?:thing|object|one) => what is \1
^(?:is|are) there (anything|something|any \w+) (?:else )?(?:that|which) (.+)$ => does \1 \2
^how does (.+?) end up(?: ,)? (\w+ or \w+)$ => is \1 \2 at the end
^how long is (?:the|its) (?:path|way|route|distance|track|trip)(?: (?:of|that) (.+?))?(?: \
(?:moves|takes|walks|covers))?$ => how far does \1 move
\b(?:is|was) it that (?=\w+s\b) =>
\b(?:would you say|do you think) =>
 , (?=in (?:order|sequence)$) =>
 (?:at|from|in) the moment (?:(?:when|that|at which|where) )?(?=the |it ) => when
\b(opening|closing|sliding|rolling|turning|falling|walking) (?:movement|motion|action|phase)\b => \1
(?: ,)? (?:out and back|there and back)$ =>
 (?:at rest|still|stationary|motionless) between (?:the|its) (?:two )?(?:movements|motions|moves|trips)$ => pausing
^((?:which|what|who) (?!.*\b(?:first|earlier|sooner|later|last|faster|slower|quicker)\b)\w+ .+?) , the \w+(?: \w+)? \
or the \w+(?: \w+)?$ => \1
^(?:does|do|did|is|are|is it) only (the .+?) (?:that )?(move|moves|moving|fall|falls|falling|turn|turns|turning)$ \
=> nothing besides \1 \2
\bon the (last|final|first) frame\b => in the \1 frame
\bon (?:the|its) (?:last|final|second) (?:stretch|leg|part|straight)\b => after the turn
\bon (?:the|its) (?:first|initial) (?:stretch|leg|part|straight)\b => before the turn
^(?:is|are|was) there (?:a|any|some) (?:moment|time|point|instant)s? (?:when|at which|where|that) (.+)$ => \1 at \
some time
^(?:is|are) there (?:still )?(?:any |some )?(?:movements?|motion)(?: in the room)?(?= |$) => does anything move
^(?:is )?(?:there )?anything (else )?(moving|turning|spinning|falling)\b => is anything \1\2
^(does|is|did) anything (?:else )?(.*?)\
(?: (?:besides|except|apart from|other than|but)) (.+)$ => \1 anything besides \3 \2
\b(anything|something) else (?:than|but|besides|except) => \1 besides
^(the [\w ]+?) (does|did|is|was|will|has) (?:it|he|she|they) (.+)$ => \2 \1 \3
^(the \w+(?: \w+)?) , ((?:when|how|where|what|which|does|is|at|until)\b.*)\b(?:it|they)\b(.*)$ => \2\1\3
^(?:in )?(?:what|which) state (?:is|are) (.+?)(?: in)?((?: at .+)?)$ => is \1 open or closed\2
^how (?:far|wide) (?:open|out) (is|was) (.+?)((?: at| when| after| before| by) .*)?$ => how far \1 \2 open\3
^(how far) ((?:out of|away from|from|off) (?:the|its) (?:\w+ ){1,3}?)((?:does|do|did|is|has) .+)$ => \1 \3 \2
^(?:to )?where (?:is|does) (.+?) (?:heading|head|headed|bound)(?: to| for)?(?= |$) => which way does \1 move
^(?:the )?(?:total |whole )?time (the [\w ]+?) is in motion$ => how long does \1 move
^((?:for )?how long .+) lasts?$ => \1
^(?:the )?time (?:for|to make) (.+)$ => how long does \1 take
^(?:the )?time per (?:one |a )?(.+)$ => how long does one \1 take
 (?:for|to make|to complete|to do|to finish|makes?|made|complete|do) \
(?:one|a|each|every|two|three|four|five|ten|\d+) (?:full |single |whole |complete \
)?(?:turn|rotation|revolution|spin|round)s?\b => turn
"""


@cache
def _rows() -> tuple[tuple[re.Pattern[str], str], ...]:
    lines = [line.partition("=>") for line in _LINES.replace("\\\n", "").strip("\n").split("\n")]
    return tuple((re.compile(said[:-1]), f" {plain.strip()} " if plain.strip() else " ") for said, _, plain in lines)


def plainly(said: str) -> str:
    """The words of a question in the order in which they are asked plainly."""
    said = said.replace("metre", "meter")
    for row, plain in _rows():
        said = re.sub(r" +", " ", row.sub(plain, said)).strip(" ,")
    return said
