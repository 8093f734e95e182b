"""Removes what carries no meaning in spoken instructions: hesitation, tags, reasons, openers and well-wishing.

Every function takes and gives the words of an instruction, marks included. Nothing that an operation could depend on is
removed: what is dropped is a closed class ("er", "if you don't mind") or begins with a word that opens a reason.
"""

from __future__ import annotations

from collections.abc import Sequence

from .....gaussians import late_re as re
from .....gaussians.world.words import singular
from ...tagging.lookahead import Lookahead, color_at, is_hue
from ...tagging.words import Word, bag
from ...vocabulary import doings, lexicon, nouns, quantities
from ..changes.rewordings import REWORDED
from .participles import at, gerunds

_SOUNDS = bag("er erm um umm uh uhm uhh hm hmm eh ah aha oh ooh oi yo huh ugh argh ahem")
# Closing words, after a comma or before the end of a sentence.
_TAGS = (
    "please and thanks|please and thank you|pretty please|thanks a lot|thanks a bunch|thanks so much|thanks very much|"
    "thank you kindly|much appreciated|ta|ta very much|cheers|cheers mate|thx|tyvm|"
    "would you|will you|could you|can you|won't you|will not you|would not you|can not you|could not you|"
    "would you mind|if you do not mind|if you would not mind|if that is (?:ok|okay|alright|all right|possible|fine)|"
    "if it is (?:ok|okay|alright|all right|possible|not too much trouble|no trouble|not too much bother)|"
    "if you (?:please|can|could|will|would|like|get a (?:sec|second|chance|minute)|have a (?:sec|second|minute))|"
    "if (?:i|we) (?:may|can|could)|"
    "if possible|when you (?:can|get a (?:chance|sec|second|minute|moment)|have a (?:sec|second|minute|moment))|"
    "yeah|yes|yep|right|ok|okay|alright|all right|innit|is not it|do not you think|you know|you see|i think|i guess|"
    "i suppose|i reckon|i would say|is that (?:ok|okay|alright|all right|possible)|that is (?:it|all)|there is a "
    "(?:love|dear|good lad|good chap|star)|there you go|will ya|would ya|got it|see|hey|mate|love|dear|darling|"
    "sweetie|honey|buddy|pal|dude|man|guys|folks|bro|my friend|sir|hun|my dear|my love|old chap|"
    "for a change|for once|once and for all|for good|for heaven 's sake|for goodness sake|for god 's sake|"
    "for crying out loud|then|now|so|thanks|please|thank you|too please|instead please|no\\s?\\?|eh|"
    "as soon as (?:you can|possible)|before (?:i|we) (?:go|forget)|and that is (?:it|all|that)|and be done with it|"
    "and be quick about it|or something|or whatever|or something like that|or so i think|somehow|"
    "for a (?:moment|bit|while|sec|second|minute|little while)|temporarily|just in case|just because|because why "
    "not|why not|to start with|to be honest|to be fair|tbh|honestly|imo|imho|"
    "in my opinion|for me|for us|for now|at last|like i said|as i said|as discussed|as agreed|as usual"
)  # fmt: skip
_TAG_END = re.compile(rf"(?:(?: ,)+ (?:{_TAGS})|(?<=\S) (?:please and thanks|please and thank you|pretty please|innit|"
                      r"yeah|would you mate|will you mate|would ya|will ya|would you|will you|could you|can you|"
                      r"mate|ta|lol|please love|please mate|thanks a lot|please now|if you do not mind|if you "
                      r"please|"
                      r"if that is (?:ok|okay|alright|all right|possible)|for me|for us|when you (?:can|get a "
                      r"(?:chance|sec|second|minute|moment)|have a (?:sec|second|minute|moment))|for goodness sake|"
                      r"for god 's sake|as soon as (?:you can|possible)|and be done with it|and that is that|"
                      r"would you kindly|if it is not too much (?:trouble|bother|to ask)|"
                      r"if (?:i|we) (?:may|could)|once and for all|for heaven 's sake|to be honest|tbh|"
                      r"for a (?:moment|bit|while|sec|second|minute)|temporarily|or something|or whatever))(?= "
                      r"[.;!?]| *$)")  # fmt: skip
# Words that open a sentence and say nothing of what to do; a comma need not follow.
_OPENERS = re.compile(
    r"^(?:(?:so|and|but|well|right|ok|okay|now|alright|all right|anyway|anyways|hey|hi|hello|listen|look|please|"
    r"yes|yeah|yo|mummy|daddy|mum|dad|computer|assistant|robot|"
    r"yep|sure|fine|great|good|nice|perfect|lovely|thanks|thank you|cool|actually|honestly|basically|also|then|next|"
    r"next up|go on|come on|here goes|let us see|let me see|let me think|you know what|guess what|first|firstly|"
    r"first of all|first off|to start|to start with|to begin with|finally|lastly|last of all|last thing|one last thing|"
    r"one more thing|another thing|and another thing|secondly|thirdly|mate|darling|dear|love|sorry|excuse me|pardon me|"
    r"if you (?:would|could|can|please|do not mind|would not mind|like|would be so kind|get a chance)|"
    r"if it is (?:possible|ok|okay|alright|not too much trouble|not too much bother|not a problem)|if possible|"
    r"if that is (?:ok|okay|alright|possible)|if (?:i|we) may|if (?:i|we) could|"
    r"when you (?:can|get a (?:chance|sec|second|minute|moment)|have a (?:sec|second|minute|moment))|"
    r"quick one|small thing|quick favour|quick favor|do me a favou?r and|do me a favou?r|be a (?:love|dear|star|sport|"
    r"darling) and|be so kind and|be so kind as to|be an angel and|go ahead and|why do not you|why do not we|"
    r"why not|i was (?:thinking|wondering)(?: if| whether)? (?:you|we|i) (?:could|can|might|should)|"
    r"i (?:think|guess|suppose|reckon|feel|believe|say|would say|am thinking)(?: that)? (?:you should|we should|"
    r"we could|you could|we can|i will|i would like to|i want to)|"
    r"(?:could|can|would|will) (?:you|we|i)(?: please| possibly| perhaps| maybe| kindly| also)* be (?:a|an) "
    r"(?:love|dear|star|sport|darling|angel) and|"
    r"(?:could|can|would|will) you (?:please )?do me a favou?r and|"
    r"how would you feel about|what do you say we|what say we|it is time (?:we|to)|time to|it is about time (?:we|"
    r"you|to)|"
    r"i (?:will )?need you to|i am going to need you to|i am asking you to|i command you to|your job is to|"
    r"the next step is to|the next thing is to|all i want is to|all i want is for you to|what i want is to|"
    r"what i (?:would like|want) (?:you )?to (?:do )?(?:is|now is)(?: to)?|"
    r"what (?:i|we) (?:want|need) to do is(?: to)?|"
    r"would it be (?:ok|okay|possible|alright|all right|too much trouble) (?:to|if you could|if you)|"
    r"is it (?:ok|okay|possible|alright) (?:to|if you could|if you|if i)|"
    r"any chance (?:you could|you can|we could|of you)|is there any (?:chance|way) (?:you could|you can|to|we could)|"
    r"(?:it would|it'd) be (?:great|good|nice|lovely|cool|better|best|helpful|awesome|fantastic|wonderful|super)"
    r"(?: if you (?:could|would)| if we (?:could|would)| to)|"
    r"i (?:would|'d) (?:be grateful|appreciate it) if you (?:could|would)|on second thoughts?|on reflection|come to "
    r"think of it|i (?:would )?wish you (?:would|could)|"
    r"you (?:had better|would better|better|might want to|may want to|could maybe|should probably|need to|have to|"
    r"have got to|"
    r"ought to|can go ahead and|can now)|we (?:had better|would better|better|might want to|ought to|should "
    r"probably|have to|"
    r"have got to|need to|can|could|should|might as well)|i (?:might as well|had better)|"
    r"(?:how|what) about (?:we|you|if we|if you)|what if (?:we|you)|suppose we|maybe we (?:could|should)|perhaps "
    r"we (?:could|"
    r"should)|maybe you (?:could|should)|perhaps you (?:could|should)|"
    r"(?:could|can|would|will) (?:someone|somebody|anyone|anybody)(?: please| kindly)?|(?:someone|somebody)(?: "
    r"please)?|"
    r"let us (?:just )?go ahead and|let us (?:also |just |now |try to |please )*)"
    r"(?: ,)* )(?=\S)"
)
_OPENING_MARKS = re.compile(r"^(?:[,:] )+")
_REASON = (
    r"(?:because|cos|coz|cuz|'cause|cause|as it is|as they are|since it|since they|since we|since i|since the|"
    r"since there|"
    r"seeing as|seeing that|given that|in case|as (?:we|i|you|nobody|no one|there)|considering|now that|"
    r"so that (?:i|we|you|he|she|people|there|nobody|no one|everyone|everybody|the|my|our|guests|visitors|kids)|"
    r"so (?:that )?the \S+(?: \S+)? (?:can|could|is|are|does|do|will|would|faces?|has|have|gets?)|"
    r"so (?:i|we|you|he|she|people|there|nobody|no one|everyone|everybody|guests|visitors|kids|the kids|the dog|the "
    r"cat|my|our)|so as to|so as not to|so that it (?:does|can|will|would)|so it (?:does|can|will|would|matches|"
    r"has|gets|"
    r"fits)|so they (?:do|can|will|would|match|have|get)|so that they (?:do|can|will|would)|"
    r"in order to|to (?:make|free up|create|give|get|have|save|leave) (?:\w+ )*?(?:room|space|way|light|air|peace)|"
    r"before (?:i|we|you|he|she|someone|somebody|anyone|people)|"
    r"before (?:it|they|(?:the|my|our) \S+(?: \S+)?) (?:is|are|gets?|comes?|goes?|falls?|breaks?|tips?|arrives?|"
    r"starts?|ends?|has|have|does|do|can|will|would|leaves?|see|sees|visits?|moves?)(?= |$)|"
    r"otherwise|or else|while (?:i|we|you|it)|"
    r"for (?:the|my|our|a) (?:party|guests|wedding|visit|photo|photos|shoot|summer|winter|christmas|kids|children|baby|"
    r"evening|meeting|presentation|concert|show)|for (?:(?:the|my|our|your) )?(?:people|customers|clients|visitors|"
    r"punters|"
    r"guests|kids|children|staff|everyone|everybody)(?: (?:who|that|to) [^,.;!?]*)?|"
    r"(?<=, )where (?:\S+ )+?\S+|(?<=, )not (?:out |over |there |up )*where (?:\S+ )+?\S+|to match the (?:rest|"
    r"mood)|to brighten (?:things|the place|it) up|"
    r"until (?:i|we|you))"
)
_TRAILING_REASON = re.compile(rf"(?<=\S)(?: ,)* {_REASON}(?= |$)[^.;!?]*(?= [.;!?]|$)")
_MATCHING = re.compile(
    r"^(?P<edit>.+?)(?: ,)? (?:to|so (?:that )?(?:it|they)|which|that) (?:match|matches|go|goes|fit|fits|suit|suits|"
    r"blend in|"
    r"complement|complements|tie in)(?: well| better| nicely)?(?: in| with)* [^,.;!?]*$"
)
_FACING = re.compile(r"\b(?:so (?:that )?(?:it|they|he|she) (?:is |are )?(?:fac|look|point)|until|till)")
_LEADING_REASON = re.compile(
    r"^(?:because|cos|since|as|so that|so|in order to|in order that|to|given that|seeing as|seeing that|now that|"
    r"before|"
    r"after|while|when|whenever|if|in case|for|with|due to|thanks to|considering|although|though|even though) "
    r"(?P<why>[^,.;!?]+?) , (?P<rest>.+)$"
)
_LEADING_AIM = re.compile(
    r"^(?:to|in order to|so as to) (?:make|free up|create|get|have|save|give)(?: \w+){0,3}? "
    r"(?:room|space|way|light)(?: here| in here| for (?:the )?\w+)? (?P<rest>\S.+)$"
)


def smoothed(words: Sequence[Word]) -> tuple[Word, ...]:
    """The words of an instruction without hesitation, tags and reasons; each keeps its place in the text."""
    texts = [w.text for w in words]
    found, at = [], 0
    for text in smooth(texts):
        here = next((i for i in range(at, len(texts)) if texts[i] == text), None)
        near = words[min(at if here is None else here, len(words) - 1)]
        found.append(near if here is not None else Word(text, near.start, near.end))
        at = at if here is None else here + 1
    return tuple(found)


def smooth(texts: Sequence[str]) -> list[str]:
    """The words of an instruction without hesitation, tags and reasons; never fewer than none of them are left."""
    said = " ".join(_without_hedges([t for t in texts if t not in _SOUNDS]))
    said = _linked(_asked_to(said))
    said = re.sub(r"(?: (?:—|–|―))+", " ,", said)
    said = re.sub(r"\. \.(?: \.)*", ",", said)
    said = _settle_commas(said)
    said = _JUDGING.sub(r"\g<the> ", _plain_hues(said))
    for pattern, plain in REWORDED:
        said = pattern.sub(plain, said)
    said = _joined_amounts(_TIMES.sub("", said))
    said = re.sub(r" (too|as well) (?:, and|,|and) ", r" \1 . ", said)
    said = _named_ones(_dropped_g(said))
    before = None
    while before != said:
        before = said
        said = _settle_commas(_TAG_END.sub("", said))
    found = said.split()
    return found if found else list(texts)


# When it shall be done, which nobody can choose here.
_TIMES = re.compile(
    r"(?<=\S)(?: ,)? (?:(?:by|before|until|for|from|on|in time for|this|next|every|first thing) (?:(?:the|this|"
    r"next) )?(?:monday|tuesday|"
    r"wednesday|thursday|friday|saturday|sunday|tomorrow|tonight|today|noon|midnight|christmas|easter|weekend|"
    r"summer|winter|"
    r"morning|evening|afternoon)s?(?: morning| evening| night)?|tomorrow|tonight|today|asap)(?= [,.;!?]|$)"
)


def _joined_amounts(said: str) -> str:
    """The words without a comma before the amount that ends a command: "push it back, 50 cm"."""
    words = said.split(" ")
    kept: list[str] = []
    for i, word in enumerate(words):
        if (
            word == ","
            and kept
            and "," not in kept
            and Lookahead(kept).verb(Lookahead(kept).skip_polite(0)[0]) is not None
        ):
            rest = words[i + 1 :]
            amount = quantities.read(rest)
            if amount is not None and amount.kind in ("LENGTH", "ANGLE", "PERCENT"):
                behind = rest[amount.taken :]
                if not behind or behind[0] in (".", ";", "!", "?", ","):
                    continue
        kept.append(word)
    return " ".join(kept)


_HEDGES = bag(
    "really definitely certainly probably possibly perhaps maybe surely properly neatly carefully gently quickly "
    "quietly completely totally entirely fully absolutely literally frankly seriously personally obviously ideally "
    "preferably basically essentially honestly truly urgently desperately badly finally"
)
_SHADED = bag("transparent invisible see opaque different hidden visible clear solid")


def _without_hedges(texts: Sequence[str]) -> list[str]:
    """The words without adverbs that only stress or weaken what is said; "fully transparent" stays."""
    kept = [t for i, t in enumerate(texts) if t not in _HEDGES or _SHADED & set(texts[i + 1 : i + 2])]
    return kept if any(t[0].isalpha() for t in kept) else list(texts)


_MIND = re.compile(r"^(?:(?:would|do) you )?mind (?P<rest>\S.*)$")


def _asked_to(said: str) -> str:
    """ "Mind taking out the sink?" as "take out the sink ?"."""
    found = _MIND.match(said)
    form = at(gerunds(), found["rest"].split(), 0) if found else None
    return said if found is None or form is None else " ".join([*form[0], *found["rest"].split()[form[1] :]])


_OWNED = re.compile(
    r"(?:^|(?<=[.;!?,] ))(?P<thing>(?:(?:the|that|this|my|our|your) )?(?:[a-z]+ ){1,4}?)'s (?P<how>(?:(?:too|so|very|"
    r"just|a bit|a little|rather|quite|pretty|well|way|all|getting|looking|been|gone|become|made|always|still|bit|"
    r"dead|proper|right|far|really|such|no|not|only|never) )*)(?P<last>[a-z]+)(?P<rest>(?: [a-z]+){0,6})(?= [,.;!?]|$)"
)


def _linked(said: str) -> str:
    """The words with "is" for the "'s" of a clause that says how a thing is: "that lamp 's naff , swap it"."""

    def full(found: re.Match[str]) -> str:
        thing, how, last = found["thing"].split(), found["how"], found["last"]
        owned = (last,) in lexicon.CLOSED_PHRASES or nouns.is_known(last) or color_at((last,), 0)
        verb = Lookahead([*thing, "it"]).verb(0)
        command = verb is not None and thing[0] not in ("that", "this", "the")
        if command or (not how and (owned or found["rest"])):
            return found.group()
        return f"{found['thing']}is {how}{last}{found['rest']}"

    return _OWNED.sub(full, said)


_PRAISING = bag(
    "nice lovely good beautiful pretty proper gorgeous cheerful fresh warm rich cool really very bold solid"
)
_SAME = re.compile(r"(?<!\S)the (?:exact |very )?same (?P<hue>\S+(?: \S+)?) (?:as|like)(?!\S)")


def _plain_hues(said: str) -> str:
    """The words without praise between an article and a colour, "the same green as" being a colour of another thing."""
    words = said.split()
    kept: list[str] = []
    for i, word in enumerate(words):
        j = i
        while j < len(words) and words[j] in _PRAISING:
            j += 1
        praised = kept[-1:] in (["a"], ["an"], ["some"]) or (kept and kept[-1] in _PRAISING)
        if j > i and (praised or words[i - 1] in _PRAISING) and color_at(words, i) is None and color_at(words, j):
            continue
        kept.append(word)
    found = _SAME.search(" ".join(kept))
    if found and is_hue(found["hue"].split()):
        return _SAME.sub("the same colour as", " ".join(kept))
    return " ".join(kept)


_JUDGING = re.compile(
    r"(?<!\S)(?P<the>the|that|this|those|these|my|our) (?:(?:lone|poor|ugly|hideous|horrible|awful|stupid|silly|"
    r"bloody|damn|"
    r"damned|flipping|blasted|wretched|boring|lovely|favourite|favorite|beloved|tatty|shabby|tired|sad|annoying|nasty|"
    r"ghastly|dreadful|manky|grotty|crappy|rubbishy|god awful|so called|aforementioned|said|entire|actual|same old|"
    r"blooming|freaking|darn|pesky|trusty|humble|solitary|single|sole|only) )+(?=\S)"
)


_NARROWED = re.compile(
    r"(?<!not )(?P<the>the|that|this|my) (?P<noun>[a-z]+(?: [a-z]+)?) , (?:i mean |that is |namely |specifically )?"
    r"(?P<one>the [^,.;!?]+?) one(?: ,)?(?: (?:and |so )?not (?:the|that) [^,.;!?]+)?(?= [,.;!?]|$)"
)
_APPOSED = re.compile(r"(?P<a>an?) (?P<noun>\S+)(?P<rest> [^.;!?]*?) , an? (?P<kind>[^,.;!?]+?) one(?= [.;!?]|$)")
_OF_THESE = re.compile(
    r"(?<!\S)of (?:the|these|those) (?:two |three |four |five )?(?P<nouns>[^,.;!?]+?) , (?P<rest>the "
    r"[^,.;!?]*?)one(?!\S)"
)


def _named_ones(said: str) -> str:
    """The words with the noun for "one" where it stands near: "a beanbag by the sofa, a red one"."""
    said = _APPOSED.sub(r"a \g<kind> \g<noun>\g<rest>", said)
    if (found := _NARROWED.search(said)) and _is_bare(found["noun"].split()):
        said = f"{said[: found.start()]}{found['one']} {found['noun']}{said[found.end() :]}"
    if found := _OF_THESE.search(said):
        noun = " ".join([*found.group("nouns").split()[:-1], singular(found.group("nouns").split()[-1])])
        said = said[: found.start()] + found.group("rest") + noun + said[found.end() :]
    return said


def _is_bare(noun: Sequence[str]) -> bool:
    """Whether a noun stands without attributes of its own."""
    return (noun[0],) not in lexicon.ATTRIBUTE_PHRASES and color_at(noun, 0) is None


def _dropped_g(said: str) -> str:
    """The words with "makin" as "making", for verbs of commands."""
    words = (w + "g" if w.endswith("in") and len(w) > 4 and (w + "g",) in gerunds() else w for w in said.split(" "))
    return " ".join(words)


def _settle_commas(said: str) -> str:
    """One comma where several stand, none beside a mark that ends a sentence."""
    said = re.sub(r"(?:, )+(?=[,.;!?])", "", said)
    said = re.sub(r"(?<=[.;!?:]) ,(?= |$)", "", said)
    return re.sub(r"^(?:[,;] )+| ,$", "", said.strip())


def unopened(said: str) -> str:
    """A sentence without the words that only open it; the sentence itself if nothing else is left."""
    while (found := _OPENERS.match(said)) and found.end() < len(said):
        said = said[found.end() :]
    return _OPENING_MARKS.sub("", said)


_OWNING = ("the", "my", "our", "your", "any", "people")


def _without_event(said: str) -> str:
    """A sentence without what happens before or when somebody does something: "before the neighbours complain"."""
    words = said.split()
    for i in range(2, len(words) - 2):
        if words[i] in ("before", "when", "whenever", "while") and words[i + 1] in _OWNING:
            end = next((j for j in range(i, len(words)) if words[j] in (",", ".", ";")), len(words))
            if any(w in doings.plain() or w in doings.said_of_one() for w in words[i + 3 : end]):
                return " ".join([*words[:i], *words[end:]]).replace(" , ,", " ,")
    return said


def _ends_in_hue(said: str) -> bool:
    """Whether words end in a colour, so that what it shall match is a reason: "paint it navy, to match the logo"."""
    words = said.split()
    return any(found[1] == taken for taken in (1, 2, 3) if (found := color_at(words, len(words) - taken)) is not None)


def without_reason(said: str) -> str:
    """A sentence without the reason behind or in front of its command."""
    if not _FACING.search(said):
        said = _TRAILING_REASON.sub("", said)
    said = _without_event(said)
    if (found := _MATCHING.match(said)) and _ends_in_hue(found["edit"]):
        said = found["edit"]
    if found := _LEADING_AIM.match(said):
        return found.group("rest").removeprefix(", ")
    if found := _LEADING_REASON.match(said):
        return found.group("rest")
    return said
