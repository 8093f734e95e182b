"""Words by which an instruction is no wish of a kind, or asks for more than what its marks hold."""

from __future__ import annotations

from itertools import pairwise

from .....gaussians import late_re as re
from ...learned.seen import hues
from ...vocabulary.nouns import EVERYWHERE, is_opened
from ..clauses import AUXILIARIES
from ..happenings import IT
from ..whens import HELD_BACK
from .kinds import STATIC, SURE, is_any_word
from .names import MOVING
from .slots import Slots

_GREETING = re.compile(r"^(?:(?:hi|hello|hey|hiya|yo|ok|okay|so|and|well|right|sorry|oh|ah|hm+)(?: there)?(?: ,)? )+")
_JOINED = re.compile(r"^(?:[,.;:!] |and |then |but )+")
_THERE_AND_BACK = re.compile(
    r"\b(?:to|against|(?<!begin )(?<!start )(?<!begins )(?<!starts )at|into) (?:\||(?:the|a) \w+) and "
    r"(?!(?:be |is |arrive|get|reach|stop|stay|done|there|end|finish))"
)
_THERE_IS = re.compile(
    r"\bthere (?:sits|stands|lies|hangs|lives) an? (?:[a-z]+ )?(?P<noun>[a-z]+)\b.*\b(?:her|him|it)\b"
)
_ORDERED = re.compile(r"(?:delete|remove|erase|hide|paint|make|move|turn|put|recolou?r)\b")  # how they are ordered
_DETERMINED = re.compile(r"(?:the|a|an|that|this|these|those|my|our|all|both|every|everything|it|him|her|them)$")
_PROHIBITED = re.compile(
    r"\b(?:do not|never|must not|should not) (?:delete|remove|move|paint|touch|hide|recolou?r|change)\b"
)
_UNWANTED = re.compile(
    r"\b(?:nobody|no one|none of us) (?:wants?|needs?|asked|asks|likes?)\b(?! (?:push|pull|touch|close|open)\b)"
)
_OTHER_EDITS = re.compile(
    r"\b(?:add|insert|duplicate|copy|replace|swap|exchange|trade|forget|never mind|cancel|undo)\b"
)
_ADDED = re.compile(r"\b(?:add|insert)\b")  # "insert a pause", "add a half turn at the end"
_FOR_ANOTHER = re.compile(r"\b(?:swap|exchange|trade|replace)\b")  # one colour for another
_PAIR = re.compile(r"\b(?:them both|both of (?:them|these|those)|the two of them|the pair of them)\b")
_COPIES = re.compile(r"\b(?:copy|copies)\b")
_ADDABLE = ("pause", "spin", "repeat", "halt", "longer", "begin", "duration", "amount", "open", "close", "return")
_EXCHANGED = ("order", "reverse")  # kinds that words for another edit say: "swap start and finish"
_PLACES_IT = re.compile(
    r"\b(?:place|put|lay|hang|install|set)s? (?!(?:\||it|him|her|them|the \w+(?: \w+)?) ?back\b)"
    r"(?!\| ?(?:away|aside|out)\b)(?!.*\b(?:away|aside|out)\b)"
)
_KEEPS_IT = re.compile(
    r"^(?:please |just |only )*(?:keep|leave) (?!.*\b(?:hidden|out|invisible|away|off|unseen|gone)\b)|"
    r"\bnothing (?:else|but)\b"
)
_LIT = re.compile(r"\b(?:off|out|on)$")
_A_LIGHT = re.compile(r"\b(?:lamps?|lights?|lanterns?|candles?|bulbs?)$")
_EXCEPT = re.compile(r"(?<!\bat )\b(?:everything|all|every|both|things?)\b.*\b(?:but|except|apart from)\b")
_IN_PIECES = re.compile(r"\b(?:apart(?! from)|to pieces|in two(?! \w))\b")
_REMOVALS = re.compile(r"\b(?:delete|remove|erase|get rid)\b")
_A_STRETCH = re.compile(r"\b(?:first|second|last|latter|other|final) (?:half|third|quarter|part|stretch|leg|bit)\b")


def is_ruled_out(kind: str, chance: float, slots: Slots) -> bool:
    """Whether an instruction names nothing, or has words by which it is no wish of a kind, or more than one.

    Args:
        chance: the probability of the kind.
    """
    things, asked, idle = slots.things, slots.asked, slots.idle
    if not things or (slots.queries and slots.queries[0].text.split(" ")[-1] in EVERYWHERE):
        return True
    aside = (" ".join(slots.words[start:stop]) for tag, start, stop in slots.spans if tag in ("off", "not", "keep"))
    for said in (asked, *aside):
        first, then = (*_GREETING.sub("", _JOINED.sub("", said)).split(" "), "")[:2]
        if first.isalpha() and not is_any_word(first) and _DETERMINED.match(then):
            return True  # a verb that is no word may ask for anything
    timeless = not slots.told and not slots.moment.always
    left = slots.rest.split()
    if (
        timeless
        and kind in ("hide", "remove", "move")
        and any(
            verb.isalpha() and not is_any_word(verb) and (then == "|" or _DETERMINED.match(then))
            for verb, then in pairwise(left)
        )
    ):
        return True
    single = len(slots.queries) == 1 and slots.queries[0].pick == "one" and not slots.queries[0].also
    if kind in ("recolor", "hide", "remove") and single and _PAIR.search(slots.whole):
        return True  # "vase I do not like and table also not, take them both away"
    if kind in ("hide", "remove") and hues() & {
        word for tag, a, b in slots.spans if tag == "keep" for word in slots.words[a:b]
    }:
        return True  # "both get the same black material"
    if kind in ("hide", "remove") and (_PLACES_IT.search(asked) or _KEEPS_IT.search(f"{asked} {idle}")):
        return True  # "place three bottles on the table", "keep the crib, nothing else"
    if (there := _THERE_IS.search(slots.whole)) is not None and there["noun"] not in " ".join(things).split():
        return True  # "on the sofa there sits a cat, could you make her black": the cat is meant
    if kind in STATIC and timeless and (chance < SURE or _ORDERED.match(asked)):
        return True
    if _LIT.search(asked) and _A_LIGHT.search(things[0]):
        return True  # "turn the lamp off" stops no motion
    if _EXCEPT.search(f"{asked} {idle}") or _IN_PIECES.search(f"{asked} {idle}"):
        return True  # "everything but the fan", "take it apart"
    cancels = kind in ("stay", "still", "halt")  # "cancel its way back"
    if (_PROHIBITED if kind in STATIC else _REMOVALS).search(asked) and not cancels:
        return True
    if kind in STATIC and _UNWANTED.search(f"{idle} {asked}"):
        return True
    shades = sum(tag == "as" for tag, _, _ in slots.spans)
    if kind == "recolor" and shades > 1:
        asked = _FOR_ANOTHER.sub("make", asked)
    edits = _ADDED.sub("make", asked) if kind in _ADDABLE else asked
    if _OTHER_EDITS.search(_COPIES.sub(" ", edits) if kind in ("open", "together") else edits) and not (
        cancels or kind in _EXCHANGED
    ):
        return True
    if kind in ("reverse", "return") and _THERE_AND_BACK.search(slots.rest):
        return True  # "roll to the wall and come back"
    if kind in ("speed", "duration", "begin") and _A_STRETCH.search(asked):
        return True  # "faster in the second half"
    return kind in STATIC and MOVING in things  # all, or what of it moves


_TELLING = {  # words that say something by themselves, and the kinds of wishes that say it
    r"slow|slower|fast|faster|quick|quicker|twice|double|half|speed": "speed duration spin repeat amount",
    r"slowly|quickly": "speed duration spin repeat amount move",
    r"wide|wider": "amount open stay duration begin reverse",
    r"far(?! (?:too|better|nicer|more|less|from|prettier|cooler|slower|faster|quicker|longer|shorter|earlier|later))|"
    r"farther|further": "amount",
    r"earlier|sooner|later": "begin open close order longer duration halt",
    r"backwards?|reverse|reversed": "reverse return order",
    r"back": "return reverse close stay still hide order repeat pause",
    r"again": "repeat return close open stay still halt hide recolor reverse pause",
    r"invisible|hides?|hidden|disappears?|vanish|vanishes|gone": "hide remove",
    r"(?<!the )shows?|shown": "hide recolor repeat reverse duration speed return",
    r"reveals?|visible": "hide recolor repeat",
    r"shut|shuts|close|closes": "close stay still open begin order together speed reverse",
    r"(?:turn|turned|switch|switched) (?:\| )?off": "halt longer still",
    r"(?:keeps?(?: on)?|goes on) (?:going|moving|rolling|walking)|straight (?:on|ahead)": "longer repeat move amount",
    r"(?:to|into|onto|against|at) (?:the|a) (?:wall|floor|ground|ceiling)": "move reverse order duration",
}
_SAID_BY = tuple((re.compile(rf"\b(?:{words})\b"), kinds.split()) for words, kinds in _TELLING.items())
_ONLY_SO_FAR = re.compile(  # "no turning, it just walks its first stretch"
    r"\b(?:just|only) (?:walk|roll|go|drive|move|slide|fall)\w*|\bfirst (?:stretch|bit|part|leg)\b"
)
_OPENS = re.compile(r"\b(?:opens|starts? (?:to )?open(?:ing)?|let (?:it|\||the \w+) open)\b")  # before it closes
_WHY_NOT = re.compile(r"\bwhy (?:not|do not we|do not you)\b")
ASKED_AS_NOT = re.compile(  # "couldn't we see it fall again?"
    r"^(?:\W*\w+ ){0,2}?\W*(?:why not\b|(?:can|could|will|would|should|might) not "
    r"(?=\||(?:we|you|i|it|he|she|they|there)\b))"
)
_THEN = re.compile(r"\bthen (?:\w+ ){0,3}(?P<rest>(?:shut|close|open)s?)\b")
_BACK_TO = re.compile(r"\bback(?= (?:to|by|on|in|at|near|against|next to|beside)\b)")
_SAME_SPEED = re.compile(  # "at unchanged speed"
    r"\b(?:at|with) (?:an? |the |its )?(?:same|unchanged|unaltered|usual|normal|present|current|original) "
    r"(?:speed|pace|rate|velocity|tempo)\b|\b(?:same|unchanged|unaltered) (?:speed|pace|rate|velocity|tempo)\b"
)
_SLOWLY = re.compile(r"\b(?:nice|good|real|really) (?:and )?(?:slow|easy|quick|fast)\b")
_IN_STEP = re.compile(r"\b(?:sync\w*|together|unison|tandem|in step|mirror\w*|cop(?:y|ies)|doubles?|same|as)\b")
_AT_ONCE = re.compile(
    r"\bwithout (?:any |a |further )?(?:delay|pause|break|stop|stopping|hesitation|ado|wait|waiting)\b"
)
_MADE_QUICK = re.compile(r"\b(?:make (?:it|that) )?(?:quick|quickly|slow|slowly|fast)\b")
_ROLLS_ON = re.compile(r"\bthen (?:\w+ ){0,2}(?:on|further|farther|onwards?)\b")
_BY_HOW_MUCH = re.compile(r"\b(?:earlier|sooner|later)\b")
_BACK_IN = re.compile(r"\bback(?: in)?\b")
_BEFORE_IT = re.compile(  # "it waits until 2 s before it sets off"
    r"\bbefore (?:it |he |she |they |\| )?(?:to )?(?:sets?|starts?|begins?|commences?|goes|going|go|rolls?|rolling|"
    r"gets? (?:going|moving|started|rolling|under way)|moves?|moving|leaves?|leaving|walks?|walking|falls?|falling|"
    r"drops?|dropping|opens?|opening|setting|starting|sliding|slides?)"
    r"(?: off| moving| rolling| going| walking| falling| to \w+| out)*"
)
_NEGATED = ("hide", "remove", "still", "stay", "halt", "pause", "longer", "amount")  # kinds that say what is not to be
_NOT = re.compile(r"\b(?:not|no|never|without|invisible|nobody|nothing)\b")
NO_MORE = re.compile(
    r"\b(?:no|not|nothing|never)\b(?: (?!then\b|and\b|but\b)\w+){0,3} (?:more|further|farther|wider|again)"
    r"(?: than (?:that|this))?\b"
)
_HALF_OF_IT = re.compile(r"\b(?:first|second|last|latter|other) half of (?=\||the|its|his|her)")
_DISLIKES = re.compile(r"\b(?:do|does) not (?:really |much |quite )?(?:like|love|care for|fancy|enjoy)\b")
_TOO_FAST = re.compile(r"\b(?:not so|not as|not that) (?:fast|quick|quickly|hasty|wild|rushed|speedy|speed|slow)\b")
_LATER = re.compile(r"\b(?:plus|later|delay|delayed|late|postpone|hold back|waits?|longer|behind)\b")
_AS_IT_DOES = re.compile(
    r"\b(?:\w+ )?as (?:it|he|she|they|now|\|)(?: \w+)? ?(?:does|do|is|was|goes|opens|moves)?(?: now)?\b"
)
_WISHED = re.compile(r" , (?:and |but )?(?:i|we) (?:want|would like|need) (?:it|him|her|them) to\b")
_TWO_ORDERS = re.compile(  # "open it, and once it is open paint it red"
    r"^(?:open|close|shut|push|pull|move|slide|roll|lift|spin|turn|stop|start|freeze|hide|remove|delete) \|.*"
    r"(?:,|\band\b|\bthen\b) ?(?:paint|make|turn|colou?r|hide|show|spin|move|stop|open|close) (?:it|him|her|them|\|)"
)
_SOUNDS = re.compile(r"(?:creak|squeak|groan|rattl|whine)")  # more than that it opens
_MANNER = re.compile(r"\| (?P<verb>[a-z]+) (?:open|shut|closed|apart)\b")


def says_more(kind: str, slots: Slots) -> bool:
    """Whether a word without a mark tells of another wish: "one second earlier, and slower"."""
    idle, left = slots.idle, ASKED_AS_NOT.sub(" ", _WHY_NOT.sub(" ", slots.rest))
    if kind == "move":
        left = _SLOWLY.sub(" ", left)
    if kind in ("open", "together") and is_opened(slots.things[0]) and _IN_STEP.search(left):
        left = _BACK_IN.sub(" ", left)
    if kind == "open" and slots.happening is not None and slots.happening.during.of not in (None, IT, *slots.queries):
        left = _BACK_IN.sub(" ", left)  # as another one does
    if kind not in ("recolor", "hide") and "then" in idle and hues() & set(idle.split()):
        return True  # "stop at 2 s, then roll it red again"
    if (then := _THEN.search(idle)) is not None:
        left = f"{left} {then['rest']}"  # "let it stand for a second, then shut it"
    if kind == "move" and len(slots.things) > 1:
        left = _BACK_TO.sub(" ", left)
    if kind == "move" and any(own.unit == "m" for own in slots.amounts):
        left = _BACK_IN.sub(" ", left)  # "push it back by 20 cm"
    if kind in ("open", "close") and isinstance(slots.moment.start, float):
        left = _BY_HOW_MUCH.sub(" ", left)  # "a bit sooner, at 2 s"
    left = _AT_ONCE.sub(" ", _SAME_SPEED.sub(" ", left))
    if kind in ("duration", "speed") and is_opened(slots.things[0]):
        left = _BACK_IN.sub(" ", left)  # its way back in
    if kind in ("open", "close") and slots.moment.lasting is not None:
        left = _MADE_QUICK.sub(" ", left)
    if kind == "pause":
        left = _ROLLS_ON.sub(" ", left)
    if kind == "begin" and any(own.unit in ("s", "") for own in slots.amounts):
        left = _BACK_IN.sub(" ", left)  # "its departure back by a second"
    if kind == "begin":
        left = _BEFORE_IT.sub(" ", HELD_BACK.sub(" ", left))
        if is_opened(slots.things[0]):
            left = _BACK_IN.sub(" ", left)  # the beginning of its closing
    if kind in ("halt", "stay", "still", "amount"):
        left = _HALF_OF_IT.sub(" ", left)
        left = _AS_IT_DOES.sub(" ", NO_MORE.sub(" ", left))
    if any(kind not in kinds and words.search(left) for words, kinds in _SAID_BY):
        return True
    if kind in ("still", "halt") and not slots.told and _ONLY_SO_FAR.search(left):
        return True
    if kind == "close" and _OPENS.search(f"{left} {idle}"):
        return True
    if _WISHED.search(f"{slots.asked} {idle}") or _TWO_ORDERS.search(left):
        return True
    if kind not in _NEGATED and _NOT.search(_DISLIKES.sub(" ", _TOO_FAST.sub(" ", NO_MORE.sub(" ", left)))):
        waits = _LATER.search(left) is not None or isinstance(slots.moment.stop, float) or _waits(slots)
        return kind != "begin" or not waits  # "not at once, it waits", "do not open it till 3 s"
    manner = _MANNER.search(left)
    verb = None if manner is None or kind not in ("open", "close", "duration", "speed") else manner["verb"]
    return verb is not None and verb not in AUXILIARIES and (_SOUNDS.match(verb) is not None or not is_any_word(verb))


def _waits(slots: Slots) -> bool:
    """Whether a time is told as that before which something is not to begin: "it must not go before 3 s"."""
    return any(tag in ("from", "to") and _UNTIL_THEN.match(" ".join(slots.words[a:b])) for tag, a, b in slots.spans)


_UNTIL_THEN = re.compile(r"^(?:and |only |just |right )*(?:not )?(?:until|till|til|before|prior to)\b")
