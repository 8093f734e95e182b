"""Restates sentences that ask for a change without a command: "I'd like the desk moved to the left", "the rug can go".

A form is a pattern over the words of a sentence. What it yields is tried by the planner and counts only if the whole of
it is understood, so that a pattern may be generous about where a noun phrase ends.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence

from ..tagging.lookahead import color_at
from .chunks import is_thing
from .participles import at, gerunds, participles

_I = r"(?:i|we|you|he|she|they|everyone|everybody|my (?:wife|husband|mum|mom|dad|boss|partner|girlfriend|boyfriend|"\
     r"son|daughter|sister|brother|kids|flatmate|roommate)|the (?:client|boss|wife|kids|customer))"  # fmt: skip
_REALLY = r"(?:(?:really|just|also|still|actually|now|quite|much|so|kind of|sort of|very much|definitely|probably|"\
          r"maybe|perhaps|rather|only|all|both|certainly|please) )*"  # fmt: skip
_BETTER = (
    r"(?:a (?:lot|bit|little|touch|good deal) |much |far |so much |way |even |somewhat )?"
    r"(?:better|nicer|best|great|good|nice|lovely|cooler|prettier|perfect|fab|fantastic|smarter|cosier|happier|"
    r"more at home|more (?:sensible|fun|modern|elegant))"
)
# Before a thing and the state that it is to have.
_WANTING = re.compile(
    rf"^(?:(?:{_I} {_REALLY}(?:would|could|will|can|might|may|should|do|does)? ?{_REALLY}"
    rf"(?:like|love|prefer|want|wants|need|needs|wish|have|see|fancy|be (?:happy|happier|glad) (?:with|if|to have|to see)|"
    rf"appreciate|enjoy|rather|rather have|rather see|rather that)"
    rf"(?: to (?:see|have|get|find)| seeing| having| for| it if| it that| if| that)?|"
    rf"(?:could|can|may|might|shall|should|would) {_I} {_REALLY}(?:please )?(?:have|get|see|try|like|want)|"
    rf"(?:can|could|would|will) (?:you|someone|somebody) {_REALLY}(?:please )?(?:have|get|see (?:to it )?that)|"
    rf"let us {_REALLY}(?:have|try|see|get)|let me {_REALLY}(?:have|see|try)|(?:just )?(?:have|get)|"
    rf"make sure(?: that)?|see to it that|make it so(?: that)?|ensure(?: that)?|i (?:think|feel|reckon|guess|suppose|"
    rf"believe|say|vote)(?: that)?|how about|what about|what if|would it be (?:possible|ok|okay) (?:for|to have)|"
    rf"it would be {_BETTER} (?:if|to have|to see|with)|it is (?:time|about time|high time) (?:for|that)|"
    rf"it 's time for|please let|let|help me (?:get|have)|i am (?:after|hoping for|thinking)|imagine|picture|"
    rf"my (?:idea|plan|wish|preference) (?:is|would be)(?: to have| for)?)"
    rf" )(?P<rest>\S.*)$"
)
_MODAL = re.compile(
    rf"^(?P<thing>\S.*?) (?:(?P<not>(?:can|must|should|may|shall|will|would|could|need|do|does|ought) not|never)|"
    rf"{_REALLY}(?:should|must|shall|could|can|may|might|ought to|has to|have to|had to|has got to|have got to|got to|"
    rf"would {_REALLY}(?:be|look|fit|go|do|feel|work|stand|sit|suit|make more sense) {_BETTER}(?: if it (?:were|was|is))?|"
    rf"needs to|need to|wants to|want to|is to|are to|was to|were to|will|would|had better|is supposed to|"
    rf"are supposed to|is meant to|are meant to|is going to|are going to|is due to|deserves to|cries out to|"
    rf"would like to|was supposed to|is ready to|is dying to|needs|should all|must all|should both|"
    rf"(?:looks|is|fits|works|goes|are|look) {_BETTER}))"
    rf" {_REALLY}(?P<state>\S.*)$"
)
_PLACED = re.compile(
    rf"^(?P<thing>\S.*?) {_REALLY}(?:belongs?|goes|go|lives?|stands?|stood|sits?|sat|hangs?|hung|moves?|moved|turned|were|was)"
    rf" {_REALLY}(?P<state>\S.*)$"
)
_NEEDS = re.compile(
    rf"^(?P<thing>\S.*?) {_REALLY}(?:needs?|wants?|requires?|could {_REALLY}(?:do with|use|stand)|should get|"
    rf"deserves?|is (?:due for|ready for|crying out for)|cries out for|would benefit from|calls for|might need|will need) "
    rf"(?:being |to be |getting )?(?P<state>\S.*)$"
)
_ASKED = re.compile(
    rf"^(?:can|could|may|might|would|will|please can|please could|shall|should) (?P<thing>\S.*?) {_REALLY}"
    rf"(?P<verb>be|go|come|stand|sit|hang|move|turn|face|look|become|have|disappear|vanish|leave|get|shrink|grow|lie) "
    rf"?(?P<state>.*)$"
)
_GONE = r"(?:gone|out|away|off|history|toast|outta here|out of (?:here|there|the (?:room|way|house|picture|scene)|my sight|sight)|"\
        r"removed|deleted|erased|got rid of)"  # fmt: skip
_NO_MORE = r"(?:anymore|any more|any longer|again|ever again|here|in here|around|around here|in this room|in the room|"\
           r"there|at all|any longer here|in the (?:scene|picture)|hanging around|cluttering (?:up )?the (?:place|room))"  # fmt: skip
_UNWANTED = tuple(
    re.compile(pattern)
    for pattern in (
        rf"^(?:there is|there 's|there are|we have|we have got|i have|i have got|there 's just|i see|i have really) "
        rf"(?:really |just |simply )?(?:no|not any|not enough|no more|hardly any|just no) "
        rf"(?:room|space|place|need|use|call|reason|point|purpose)(?: (?:left|here|in here))?"
        rf"(?: (?:for|in having|to have|to keep|in keeping|having|in))? (?P<thing>\S.*?)(?: {_NO_MORE})*$",
        rf"^(?:(?:i|we) (?:have|see) )?no (?:room|space|place|need|use|call|more need) for (?P<thing>\S.*?)(?: {_NO_MORE})*$",
        rf"^(?:i|we|you|nobody|no one) {_REALLY}(?:do not|no longer|never|will not|does not|will never|would not)? ?{_REALLY}"
        rf"(?:ever )?(?:need|needs|want|wants|require|use|uses|miss|care for|wish)(?: to (?:see|have|keep|look at))? "
        rf"(?P<thing>\S.*?)(?: {_NO_MORE})+$",
        rf"^(?:i|we) {_REALLY}(?:do not|no longer|never|will not|will never) {_REALLY}(?:ever )?"
        rf"(?:need|want|require)(?: to (?:see|have|keep|look at))? (?P<thing>\S.*)$",
        rf"^(?:i|we) (?:can|could|would|will) {_REALLY}(?:easily |happily |well |gladly )?(?:do|live|manage|be fine|be happy|"
        rf"be happier|be better off|be better) "
        rf"without (?P<thing>\S.*?)(?: {_NO_MORE})*$",
        rf"^(?P<thing>\S.*?) (?:is|are) (?:no longer|not) {_REALLY}(?:needed|wanted|necessary|required|welcome|useful|in "
        rf"use|used|wanted)(?: {_NO_MORE})*$",
        rf"^(?P<thing>\S.*?) (?:is|are) {_REALLY}(?:superfluous|unnecessary|unwanted|redundant|surplus|surplus to "
        rf"requirements|not needed|not wanted|unneeded|too much|one too many|obsolete|for the (?:bin|tip|skip|dump)|"
        rf"history|toast|past it|past its best)(?: {_NO_MORE})*$",
        rf"^(?:i|we) (?:am|are|have been|was) {_REALLY}(?:sick|tired|done|through|fed up|bored|finished|sick and tired|over)"
        rf"(?: to death)?(?: (?:of|with|by|looking at|seeing|having|of seeing|of looking at))+ (?P<thing>\S.*?)(?: {_NO_MORE})*$",
        rf"^(?:(?:i|we) have (?:really )?(?:had|seen) )?(?:quite )?enough of (?P<thing>\S.*)$",
        rf"^(?P<thing>\S.*?) (?:can|must|should|may|does|do|will|could) not {_REALLY}(?:stay|be|remain|belong|fit|go|live|"
        rf"work|stand)(?: in)?(?: {_NO_MORE})*$",
        r"^(?P<thing>\S.*?) (?:has|have) (?:got )?(?:no (?:place|business)(?: being)?|outlived|overstayed|served|had)"
        r"(?: (?:here|in here|in this room|its usefulness|its welcome|its purpose|its day|its time|their day))+$",
        rf"^(?P<thing>\S.*?) {_REALLY}(?:must|can|should|could|may|might|shall|will|would|has to|have to|needs to|need to|"
        rf"has got to|have got to|got to|ought to|had better|is to|are to) (?:just |also |all |both |definitely |now |then )*"
        rf"(?:go|disappear|vanish|leave|get lost|get out|be off|go away|be {_GONE}|go bye bye|come out|"
        rf"go in the (?:bin|trash|skip)|be history)(?: {_NO_MORE})*$",
        rf"^(?P<thing>\S.*?) {_REALLY}(?:is|are|be|to be|get|gets)? ?{_GONE}$",
        r"^(?:(?:i|we) would )?(?:rather|prefer) (?:not|not to) have (?P<thing>\S.*)$",
        rf"^(?:the (?:room|place|space|scene)|it|this room|this place|that|this|the whole thing|everything) (?:would|will) "
        rf"(?:be|look|feel) {_BETTER} without (?P<thing>\S.*)$",
        rf"^(?:(?:i|we) (?:would|will) (?:be|look|feel) )?{_BETTER} (?:off )?without (?P<thing>\S.*)$",
        r"^(?:away|out|off|down|begone|be gone|be off|goodbye|good bye|bye|bye bye|farewell|say goodbye|say bye|off you go)"
        r"(?: with| to)? (?P<thing>\S.*)$",
        r"^no more (?P<thing>\S.*)$",
        r"^not a fan of (?P<thing>\S.*?) , (?:remove|delete|bin|lose)$",
        r"^(?:i|we) (?:want|would like|need) (?:shot|rid) of (?P<thing>\S.*)$",
        r"^(?:i|we) (?:hate|can not stand|loathe|can not bear) (?:looking at |the sight of |seeing )?(?P<thing>\S.*?) "
        rf"(?:{_NO_MORE})$",
        r"^(?:lose|loose) (?P<thing>\S.*)$",
        r"^(?P<thing>\S.*?) (?:has|have) (?:had (?:its|their) (?:day|time)|got to go|gotta go|gone too far)$",
        r"^(?P<thing>\S.*?) (?:gotta|got to|gots to|go) go$",
    )
)
_A = r"(?:a|an|another|some|one more|one|two|three|four|five|six|a couple of|a pair of|a few|more|new)"
_WANTED = tuple(
    re.compile(pattern)
    for pattern in (
        rf"^there (?:should|must|needs? to|ought to|has to|have to|could|might|may|shall|will|can|want to) (?:also )?be "
        rf"(?P<thing>{_A} \S.*)$",
        rf"^there (?:is|are) (?P<thing>{_A} \S.*?) (?:missing|lacking|needed|wanted)(?P<more> .*)?$",
        rf"^(?:i|we) (?:am|are) (?:still )?(?:missing|lacking|short of|after|in need of|looking for) (?P<thing>{_A} \S.*)$",
        rf"^(?:i|we|it|you|this room|the room|this place|this|she|he|they|someone|somebody) {_REALLY}"
        rf"(?:could|would|can|might|should|will|may) {_REALLY}(?:use|do with|need|like|love|have|fancy|get|want|add|put|"
        rf"welcome|appreciate|stand) (?P<thing>{_A} \S.*)$",
        rf"^(?:how|what) about (?:adding |putting |having |getting |if we (?:add|put|had) )?(?P<thing>{_A} \S.*)$",
        rf"^(?:can|could|may|might|shall|should) (?:i|we|you|there) {_REALLY}(?:please )?(?:have|get|see|add|be|give me|find me|"
        rf"fit(?: in)?|squeeze(?: in)?) (?P<thing>{_A} \S.*)$",
        rf"^(?P<thing>{_A} \S.*?) (?:would|will|could|might|should|may) {_REALLY}(?:be|look|go|fit|do|work|suit) {_REALLY}"
        rf"(?:{_BETTER}|handy|useful|welcome|helpful|appreciated|the thing|just the thing|ideal|well)"
        rf"(?P<more> (?!to ).*)?$",
        rf"^(?P<thing>{_A} \S.*?) (?:is|are) (?:needed|missing|wanted|required|called for|due)(?P<more> .*)?$",
        rf"^(?P<thing>{_A} \S.*?) {_REALLY}(?:should|must|needs to|need to|has to|have to|could|can|belongs?|goes|go|wants? to)"
        rf" ?(?:also )?(?:be|go|stand|sit|hang|live|come|belong|appear|be added|be placed|be put|added|placed)?"
        rf"(?P<more> .*)$",
        rf"^(?:i|we) {_REALLY}(?:need|want|require|fancy|miss|demand|request|crave) (?P<thing>{_A} \S.*)$",
        rf"^(?:what (?:is|was) (?:missing|needed|lacking)(?: here)? is|all (?:we|i|it|this room) (?:need|needs|lacks?) (?:now )?is|"
        rf"the only thing missing is) (?P<thing>{_A} \S.*)$",
        rf"^(?:i|we) (?:have to|must|need to|should|ought to|want to|would like to) have (?P<thing>{_A} \S.*)$",
        rf"^(?:it|this room|the room|this place|this|the place|this corner) {_REALLY}(?:needs|wants|lacks|is missing|is lacking|"
        rf"cries out for|is crying out for|calls for) (?P<thing>{_A} \S.*)$",
        rf"^(?:go for|try|time for|make room for|room for|(?:and )?(?:then )?also|plus|and) (?P<thing>{_A} \S.*)$",
        r"^(?P<thing>(?:one|two|three|four|five|six|a few|a couple of|some) more \S.*)$",
        r"^(?P<thing>another \S.*)$",
    )
)
_INSTEAD = tuple(
    re.compile(pattern)
    for pattern in (
        rf"^instead of (?P<old>\S.*?)(?: ,)? (?:put|use|have|add|give me|{_I} {_REALLY}(?:would|could|should|can|will|might)? ?"
        rf"{_REALLY}(?:want|need|like|prefer|have|use|take|put|rather have)|let us have|there should be|make it|how about|"
        rf"get|get me)? ?(?P<new>{_A} \S.*?)(?: (?:in|there))?$",
        rf"^(?:put|use|have|add|place|get|give me|stick|pop|{_I} {_REALLY}(?:would|could|should|can|will|might)? ?{_REALLY}"
        rf"(?:want|need|like|prefer|have|use|take|put|rather have)|let us have|there should be|how about|what about|"
        rf"(?:can|could) (?:i|we) have)? ?"
        rf"(?P<new>{_A} \S.*?) (?:instead of|in place of|rather than|in lieu of|over|than) (?P<old>\S.*)$",
        rf"^(?:put|place|stick|pop|stand) (?P<new>{_A} \S.*?) (?:where|in the place where|on the spot where) (?P<old>\S.*?) "
        rf"(?:is|are|was|were|stands?|sits?|used to (?:be|stand|sit))(?: now| standing| sitting)?$",
        rf"^(?:i|we) (?:would )?(?:prefer|rather have|favou?r) (?P<new>{_A} \S.*?) (?:to|over|than) (?P<old>\S.*)$",
        rf"^(?P<old>\S.*?) {_REALLY}(?:should|must|could|needs to|has to|ought to|would be {_BETTER}|would work {_BETTER}) "
        rf"(?:be replaced (?:by|with)|be swapped (?:for|out for|with)|be exchanged for|make way for|give way to|"
        rf"be|become|as) (?P<new>{_A} \S.*)$",
        rf"^(?P<new>{_A} \S.*?) (?:should|must|could|can|needs to|has to|shall) (?:replace|take the place of|stand in for) "
        rf"(?P<old>\S.*)$",
        rf"^out with (?P<old>\S.*?)(?: ,)*(?: and)? in with (?P<new>\S.*)$",
        rf"^(?:swap|trade|change|exchange|switch|turn|upgrade)(?: out)? (?P<old>\S.*?) (?:for|into|to) (?P<new>{_A} \S.*)$",
    )
)
_OF_COLOR = re.compile(
    r"^(?:the )?(?:colou?r|paint|shade|tint|finish) of (?P<thing>\S.*?) (?:should|must|has to|needs to|ought to|could|is "
    r"to|would be \w+) (?:be|become|change to|turn|look)? ?(?P<state>\S.*)$"
)


def wishes(said: str) -> Iterator[str]:
    """Commands that a sentence may stand for, the likeliest first."""
    for form in (_given, _replacing, _unwanted, _of_color, _wanted, _needed, _asked, _wanting, _modal, _placed):
        yield from form(said)


def _unwanted(said: str) -> Iterator[str]:
    for pattern in _UNWANTED:
        found = pattern.match(said)
        if found and _is_plain(found.group("thing")):
            yield f"delete {_bare_thing(found.group('thing'))}"


def _wanted(said: str) -> Iterator[str]:
    for pattern in _WANTED:
        if found := pattern.match(said):
            more = found.groupdict().get("more") or ""
            yield f"add {found.group('thing')}{more}"


def _replacing(said: str) -> Iterator[str]:
    for pattern in _INSTEAD:
        if (found := pattern.match(said)) and not color_at(found.group("new").split(), 1 + (found.group("new")[-2:] == "")):
            yield f"replace {found.group('old')} with {found.group('new')}"


def _of_color(said: str) -> Iterator[str]:
    if found := _OF_COLOR.match(said):
        yield f"paint {found.group('thing')} {found.group('state')}"


def _needed(said: str) -> Iterator[str]:
    """ "the rug needs removing", "the wall could do with a coat of blue"."""
    found = _NEEDS.match(said)
    if not found:
        return
    thing, state = found.group("thing"), found.group("state").split()
    if (form := at(gerunds(), state, 0)) is not None:
        yield _command(form[0], thing, state[form[1] :])
    yield from states(thing, state)
    painted = re.match(r"^(?:a |some )?(?:new |fresh )?(?:coat|lick|layer|splash|touch) of (?P<hue>.+?)(?: paint)?$", " ".join(state))
    if painted:
        yield f"paint {thing} {painted.group('hue')}"


def _asked(said: str) -> Iterator[str]:
    """ "can the lamp go on the desk"."""
    found = _ASKED.match(said)
    if found and not re.match(r"(?:you|i|we|it be possible)\b", found.group("thing")):
        yield from states(found.group("thing"), f"{found.group('verb')} {found.group('state')}".split())


def _wanting(said: str) -> Iterator[str]:
    found = _WANTING.match(said)
    if not found:
        return
    rest = found.group("rest")
    yield from _split_states(rest.split())
    yield from wishes(rest)


def _modal(said: str) -> Iterator[str]:
    found = _MODAL.match(said)
    if found and not found.group("not"):
        yield from states(found.group("thing"), found.group("state").split())


def _placed(said: str) -> Iterator[str]:
    found = _PLACED.match(said)
    if found and found.group("thing") not in ("i", "you", "we", "what", "where", "how"):
        state = found.group("state").split()
        yield from states(found.group("thing"), state)
        yield f"put {found.group('thing')} {' '.join(state)}"


def _split_states(rest: Sequence[str]) -> Iterator[str]:
    """The readings of a thing and its state that stand side by side: "the sofa painted blue"."""
    for i in range(1, len(rest)):
        thing = tuple(rest[:i])
        if _may_end(rest[i - 1]) and _begins_state(rest, i) and is_thing(thing):
            yield from states(" ".join(thing), rest[i:])


_STATE_WORDS = frozenset(
    "to in on onto into under next near against beside behind between above below at by over inside facing turned gone out "
    "away off a an as half twice slightly further closer nearer right left up down back forward darker lighter be were "
    "was is should was on-the standing sitting hanging a-bit more less in-front".split()
)


def _begins_state(rest: Sequence[str], i: int) -> bool:
    """Whether a state may begin at `i`."""
    word = rest[i]
    state = word in _STATE_WORDS or word.endswith("er") or word[0].isdigit() or color_at(rest, i) is not None
    return state or at(participles(), rest, i) is not None


def _may_end(word: str) -> bool:
    return word not in ("the", "a", "an", "of", "in", "on", "to", "and", "that", "which", "is", ",", "with", "all")


_MOVES = re.compile(
    r"^(?:(?:be|get|come|go|move|moved|moving) )?(?P<way>(?:(?:about |around |roughly )?(?:a |an |\d|half|two|three|four|"
    r"five|six|ten|twenty|thirty|forty|fifty).*? )?"
    r"(?:(?:a bit|a little|slightly|much|a touch|a tad|a lot|some) )?(?:further |farther |more )?(?:to the |to my |over |"
    r"towards? |closer|nearer|further|farther|left|right|back|forward|up|down|away).*)$"
)
_TO_FACE = re.compile(
    r"^(?:(?:to )?(?:be |get )?(?:turned (?:round |around )?)?(?:so (?:that )?(?:it|they) )?)?(?:to )?"
    r"(?:face|faces|facing|look at|looking at|point at|pointing at|look towards?|point towards?|pointing towards?|looking towards?) "
    r"(?P<goal>\S.*)$"
)
_TALLER = re.compile(r"^(?:be )?(?P<far>.+) (?P<way>higher|lower|higher up|lower down)$")


def states(thing: str, state: Sequence[str]) -> Iterator[str]:
    """Commands that give a thing a state: "moved to the left", "in blue", "on the shelf", "half the size"."""
    words = list(state)
    while words and words[0] in ("to", "be", "also", "just", "now", "all", "both", "really", "being", "been", "were", "was",
                                 "is", "are", "get", "gets", "should", "then") and len(words) > 1:  # fmt: skip
        if words[0] == "to" and words[1] not in ("be", "go", "face", "stand", "move", "turn", "come", "become", "look", "get",
                                                 "sit", "hang", "have", "disappear", "vanish", "leave", "shrink", "grow",
                                                 "lie", "match", "swap"):  # fmt: skip
            break
        words = words[1:]
    said = " ".join(words)
    if re.match(rf"^(?:{_GONE}|go|go away|disappear|vanish|leave)$", said):
        yield f"delete {_bare_thing(thing)}"
        return
    if (form := at(participles(), words, 0)) is not None:
        yield _command(form[0], thing, words[form[1] :])
    if facing := _TO_FACE.match(said):
        yield f"turn {thing} to face {facing.group('goal')}"
    if taller := _TALLER.match(said):
        yield f"{'raise' if taller.group('way').startswith('higher') else 'lower'} {thing} {taller.group('far')}"
    if words[0] == "in" and color_at(words, 1 + (words[1:2] in (["a"], ["an"]))) is not None:
        yield f"make {thing} {' '.join(words[1:])}"
    if words[0] in ("become", "turn", "look", "go", "come", "stay", "painted") and len(words) > 1:
        yield f"make {thing} {' '.join(words[1:])}"
    if words[0] in ("move", "turn", "rotate", "spin", "shrink", "grow", "swap", "slide", "shift", "tilt", "flip", "match"):
        yield f"{words[0]} {thing} {' '.join(words[1:])}"
    if words[0] in ("go", "stand", "sit", "hang", "lie", "live", "come", "standing", "sitting", "hanging", "rest", "belong"):
        yield f"put {thing} {' '.join(words[1:])}"
        yield f"move {thing} {' '.join(words[1:])}"
    if words[0] == "have" and (holding := re.match(r"^have (?P<new>.+?) (?P<where>on|in|next to|beside|under|above|behind|by) (?:it|them|top)$", said)):
        yield f"add {holding.group('new')} {holding.group('where')} {thing}"
    yield f"make {thing} {said}"
    if _MOVES.match(said):
        yield f"move {thing} {said}"
    yield f"put {thing} {said}"
    yield f"move {thing} {said}"


def _command(command: Sequence[str], thing: str, rest: Sequence[str]) -> str:
    return " ".join([*command, _bare_thing(thing), *rest])


def _bare_thing(thing: str) -> str:
    """A thing without the words that only stress it: "the whole rug thing there" stays, "that old rug of yours" too."""
    return thing.removesuffix(" there").removesuffix(" here")


def _is_plain(thing: str) -> bool:
    """Whether words may be the whole of a thing that is unwanted: no state is wished for it."""
    return not re.search(r"\b(?:to be|to go|to have|to look)\b", thing) and is_thing(tuple(_bare_thing(thing).split()))


_GIVEN = re.compile(
    r"^give (?P<thing>\S.*?) (?P<amount>(?:a|an|one|another|two|three|half a)(?: [\w°/.]+)*?) "
    r"(?P<verb>turn|turns|spin|rotation|twist|push|nudge|shove|flip|tilt|pull|shift|lift)(?P<rest>(?: .*)?)$"
)


def _given(said: str) -> Iterator[str]:
    """ "give the chair a quarter turn", "give it a nudge to the left"."""
    if not (found := _GIVEN.match(said)):
        return
    verb = found.group("verb").removesuffix("s")
    amount = "" if found.group("amount") in ("a", "an", "another", "a little", "a gentle", "a good") else found.group("amount")
    if found.group("amount") == "a little":
        amount = "a little"
    if verb in ("turn", "spin", "rotation", "twist"):
        turned = f"{amount} turn" if amount and not amount.endswith(("degree", "degrees", "°", "little")) else amount
        yield " ".join(f"rotate {found.group('thing')} {turned}{found.group('rest')}".split())
        yield " ".join(f"turn {found.group('thing')} around{found.group('rest')}".split())
        return
    yield " ".join(f"{verb} {found.group('thing')} {amount}{found.group('rest')}".split())


Form = Callable[[str], Iterator[str]]
