"""Removes what carries no meaning in spoken instructions: hesitation, tags, reasons, openers and well-wishing.

Every function takes and gives the words of an instruction, marks included. Nothing that an operation could depend on is
removed: what is dropped is a closed class ("er", "if you don't mind") or begins with a word that opens a reason.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from ....gaussians.world.words import singular
from ..tagging.lookahead import color_at
from ..tagging.words import Word, bag
from .participles import gerunds

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
                      r"mate|thanks a lot|please now|if you do not mind|if you "
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
    r"yes|yeah|"
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
    r"i (?:would|'d) (?:be grateful|appreciate it) if you (?:could|would)|i (?:would )?wish you (?:would|could)|"
    r"you (?:had better|better|might want to|may want to|could maybe|should probably|need to|have to|have got to|"
    r"ought to|can go ahead and|can now)|we (?:had better|better|might want to|ought to|should probably|have to|"
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
# Behind a command, these open a reason up to the next mark; "so that it faces" and "so it is" say what to do.
_OWN_STATE = (
    r"(?! (?:it|they|that|this) (?:is|are|faces?|looks?|points?|stands?|becomes?|matches|match|sits?|measures?))"
)
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
    r"evening|meeting|presentation|concert|show)|to match the (?:rest|mood)|to brighten (?:things|the place|it) up|"
    r"until (?:i|we|you))"
)
_TRAILING_REASON = re.compile(rf"(?<=\S)(?: ,)* {_REASON}(?= |$)[^.;!?]*(?= [.;!?]|$)")
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


_SIZED = r"(?P<size>big|large|tall|high|wide|long|deep|broad)"
# Phrases with a plain equal of their own, wherever they stand.
_REWORDED = tuple(
    (re.compile(rf"(?<!\S){pattern}" + ("" if pattern.endswith(" ") or "(?=" in pattern else r"(?!\S)")), plain)
    for pattern, plain in (
        (rf"half as {_SIZED} again(?: as (?:it is|now|before))?", r"1.5 times as \g<size>"),
        (rf"half again as {_SIZED}(?: as (?:it is|now|before))?", r"1.5 times as \g<size>"),
        (rf"(?:as {_SIZED} again)", r"2 times as \g<size>"),
        (r"(?:piece|bit|item|lump)s? of furniture", "furniture"),
        (
            r"(?:turn|spin|swing) (?P<x>\S.*?) (?:round |around |so (?:that )?it (?:is )?)?(?:to |and )?(?:face|"
            r"faces|facing|look|looks|"
            r"point|points) the (?:other|opposite) (?:way|direction)(?: round| around)?",
            r"turn \g<x> around",
        ),
        (r"(?:to |so (?:that )?it (?:is )?)?(?:face|faces|facing) the (?:other|opposite) (?:way|direction)", "around"),
        (r"(?:cut|chop|reduce|scale|bring|take|slash) (?P<x>\S.*?) (?:in|by|to|down to|down by) half", r"halve \g<x>"),
        (r"whatever (?:is|are) (?:sitting|standing|lying|placed|resting|currently|now|there) ", "whatever is "),
        (r"(?:only|just) the (?=\S.* (?:should|can|may|must) (?:stay|remain|be left))", "only the "),
        (r"'s (?:got to|have to|gotta)", "has to"),
        (r"got to", "have to"),
        (r"out of (?:the|its|that|their) corner (?=into|onto|to |over|next)", ""),
        (
            r"(?:and |then |oh |, )*(?:while|whilst) (?:you|we|i) (?:are|am) (?:at it|there|here|about it|on)(?: ,)*",
            ",",
        ),
        (r"(?:like|same as) (?:all )?(?:the rest|the others|the other ones|the other one)(?= [,.;!?]|$)", ""),
        (r"its (?=(?:\w+ing|a|too|so|not|just|really|in the way|looking|very)(?: |$))", "it is "),
        (r"would you mind (?:awfully|terribly|very much|ever so|kindly|possibly)", "would you mind"),
        (r"(?<!would )(?<!do )(?:you all|d'you|you|do ya) mind (?=\w+in)", "would you mind "),
        (r"(?P<v>swop|swopped|swap)", "swap"),
        (
            r"(?:crank|turn|bump|ramp|punch|pump|dial) up the colou?rs? (?:on|of|in) (?P<x>[^,.;!?]+?)",
            r"make \g<x> more vivid",
        ),
        (
            r"(?:tone|turn|dial|tame) down the colou?rs? (?:on|of|in) (?P<x>[^,.;!?]*[^ ,.;!?])",
            r"make \g<x> less vivid",
        ),
        (
            r"(?:shave|take|knock|chop|cut|lop|trim) (?P<n>(?:an? |\d|half|one|two|five|ten|fifteen|twenty)\S*(?: "
            r"\S+){0,2}?) off "
            r"(?P<x>(?:the|that|this|my|its)[^,.;!?]*? (?:'s )?(?:height|width|size|length|depth)(?: of "
            r"[^,.;!?]+?)?)(?= [,.;!?]|$)",
            r"reduce \g<x> by \g<n>",
        ),
        (r", (?:but )?not (?P<x>the [^,.;!?]+?)(?: though)?(?= [.;!?]|$)", r"except \g<x>"),
        (
            r"(?:empty|clear) (?:out |off )?(?P<x>the [^,.;!?]+?)(?: ,)? (?P<but>except for|except|apart from|but "
            r"for|but not|bar|save for|"
            r"but leave|but keep) ",
            r"delete everything on \g<x> except ",
        ),
        (r"(?:tin|can|pot|bucket|tub) of paint", "paint can"),
        (r"(?:tins|cans|pots|buckets|tubs) of paint", "paint cans"),
        (r"(?P<v>down|up|along|over|off) (?=from (?:the|that|this|my))", ""),
        (r"(?:that is |which is |that are |just )?(?:leaning|leant|propped)(?: up)? against", "next to"),
        (r"whatever (?:is|has) been (?:left |put |placed |dumped |sitting |lying )?(?=\S)", "whatever is "),
        (
            r"(?P<v>budge|shuffle|move|shift|slide|nudge|scoot|push|scooch) (?P<x>[^,.;!?]+?) along (?=to the|left|"
            r"right|a bit|a little)",
            r"\g<v> \g<x> ",
        ),
        (r"rather than (?:on|in|under|by|next to|behind|beside|against|at|where) [^,.;!?]+", ""),
        (r"be double (?P<s>(?:the |its )?(?:size|height|width|length))", r"be twice \g<s>"),
        (r"show me nothing but", "show only"),
        (r"leave me (?:with )?(?:only|just)", "keep only"),
        (
            r", (?:so |could you |can you |please |just )*(?:put|move|stick|place|pop) (?:it|them) (?:there|over "
            r"there)(?= [.;!?]|$)",
            "",
        ),
        (r", (?:exact|identical|the same) (?:copies|duplicates|clones|ones)(?= [.;!?]|$)", ""),
        (
            r"go (?P<d>(?:a bit |a little |a touch |much |even |way )?(?:darker|lighter|brighter|bigger|smaller|"
            r"paler))",
            r"make it \g<d>",
        ),
        (
            r"(?:chuck|sling|whack|throw|bung|lob|toss|drop) (?P<x>an? [^,.;!?]+?) (?:down |over |in |up "
            r")?(?P<p>by|on|onto|next to|in|"
            r"into|under|behind|beside|near|between|against)",
            r"put \g<x> \g<p>",
        ),
        (
            r"(?:only|just|nothing but) (?P<x>(?:the|my|our|both|that|those) \S.*?) (?:should|must|can|may|is to|"
            r"are to) "
            r"(?:stay|remain|be left|be visible|be shown|be there|survive|be kept)(?: visible| behind)?",
            r"keep only \g<x>",
        ),
        (r"(?:let me have a look|let me look|i want to look|have a look) at (?:only|just) ", "keep only "),
        (r"(?P<v>swap|switch|change) (?P<x>\S.*?) over(?= [,.;!?]|$)", r"swap \g<x>"),
        (r"get rid(?= [,.;!?]|$)", "get rid of it"),
        (r"less (?:wide|broad)", "narrower"),
        (r"less (?:tall|high)", "shorter"),
        (r"less (?:big|large|huge)", "smaller"),
        (r"less bright", "darker"),
        (r"less dark", "lighter"),
        (r"(?:chuck|throw|toss|kick|fling) (?P<x>\S.*?) out (?:of )?the (?:window|door)", r"delete \g<x>"),
        (
            r"(?P<off>(?:off|out of|from|away from) (?:\S+ ){1,5}?)and (?P<to>into|onto|to|over to|on to|under|"
            r"behind|against)",
            r"\g<off>\g<to>",
        ),
        (
            r"(?:so (?:that )?|until |till )(?:it|they) (?:is|are) (?:right |up )?(?P<p>on|in|under|next|beside|"
            r"between|behind|against|above|"
            r"near|by|at|below|over|inside|opposite|onto|across|facing)",
            r"\g<p>",
        ),
        (
            r"(?:back |over |along |up |right )*(?:so (?:that )?(?:it|they)|until (?:it|they)|till (?:it|they)) "
            r"(?:touch|hit|reach|meet|"
            r"abut|press|rest|lean)(?:es|s)?(?: against| on)?",
            "against",
        ),
        (
            r"(?P<f>flip|spin|swing|turn|rotate) (?P<x>\S.*?) (?:round|around) (?:by |a full )?(?P<n>\d+)(?: "
            r"degrees| deg)?",
            r"rotate \g<x> \g<n> degrees",
        ),
        (
            r"(?:put|place|stick|pop) (?P<a>\S.*?) where (?P<b>\S.*?) (?:is|are|was)(?: now)?(?: ,)* and (?P=b) "
            r"where (?P=a) "
            r"(?:is|are|was)(?: now)?",
            r"swap \g<a> and \g<b>",
        ),
        (r"(?P<v>colou?r|paint|make|do|turn) me (?P<d>the|my|that|this|both|all|every)", r"\g<v> \g<d>"),
        (r"(?:with|by) (?:the |a )?(?:(?:width|breadth) of a|a) hand(?: 's (?:width|breadth))?", "by 10 cm"),
        (
            r"(?:by )?(?:the |a )?(?:(?:width|breadth) of a hand|hand 's (?:width|breadth)|handbreadth|palm 's width)",
            "10 cm",
        ),
        (r"(?:by )?(?:an? )?arm 's length", "70 cm"),
        (r"(?:by )?(?:a )?(?:finger|thumb) 's (?:width|breadth)", "2 cm"),
        (
            r"(?:by )?(?:a|one) (?:step|pace|stride)(?= (?:to|left|right|back|forward|further|closer|away|towards?|"
            r"up|down))",
            "75 cm",
        ),
        (
            r"(?:by )?(?:two|a couple of) (?:steps|paces|strides)(?= (?:to|left|right|back|forward|further|closer|"
            r"away|towards?))",
            "1.5 m",
        ),
        (
            r"(?P<v>paint|recolou?r|colou?r|dye|make|tint|turn) (?P<x>\S.*?) (?:(?:so (?:that )?(?:it|they) |to "
            r")match(?:es)?|like)(?= (?:the|my|our|that|its|"
            r"those|these) )",
            r"\g<v> \g<x> the same colour as",
        ),
        (
            r"(?P<verb>put|place|tidy|store|stow|pack|stick|pop) (?P<x>\S.*?) away (?P<p>in|into|on|onto|under|"
            r"inside|behind)",
            r"put \g<x> \g<p>",
        ),
    )
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
    said = " ".join(t for t in texts if t not in _SOUNDS)
    said = re.sub(r"(?: (?:—|–|―))+", " ,", said)
    said = re.sub(r"\. \.(?: \.)*", ",", said)
    said = _settle_commas(said)
    said = _JUDGING.sub(r"\g<the> ", _plain_hues(said))
    for pattern, plain in _REWORDED:
        said = pattern.sub(plain, said)
    said = re.sub(r" (too|as well) (?:, and|,|and) ", r" \1 . ", said)
    said = _named_ones(_dropped_g(said))
    before = None
    while before != said:
        before = said
        said = _settle_commas(_TAG_END.sub("", said))
    found = said.split()
    return found if found else list(texts)


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
    if found and (hue := color_at(found.group("hue").split(), 0)) and hue[1] == len(found.group("hue").split()):
        return _SAME.sub("the same colour as", " ".join(kept))
    return " ".join(kept)


_JUDGING = re.compile(
    r"(?<!\S)(?P<the>the|that|this|those|these|my|our) (?:(?:lone|poor|ugly|hideous|horrible|awful|stupid|silly|"
    r"bloody|damn|"
    r"damned|flipping|blasted|wretched|boring|lovely|favourite|favorite|beloved|tatty|shabby|tired|sad|annoying|nasty|"
    r"ghastly|dreadful|manky|grotty|crappy|rubbishy|god awful|so called|aforementioned|said|entire|actual|same old|"
    r"blooming|freaking|darn|pesky|trusty|humble|solitary|single|sole|only) )+(?=\S)"
)


_APPOSED = re.compile(r"(?P<a>an?) (?P<noun>\S+)(?P<rest> [^.;!?]*?) , an? (?P<kind>[^,.;!?]+?) one(?= [.;!?]|$)")
_OF_THESE = re.compile(
    r"(?<!\S)of (?:the|these|those) (?:two |three |four |five )?(?P<nouns>[^,.;!?]+?) , (?P<rest>the "
    r"[^,.;!?]*?)one(?!\S)"
)


def _named_ones(said: str) -> str:
    """The words with the noun for "one" where it stands near: "a beanbag by the sofa, a red one"."""
    said = _APPOSED.sub(r"a \g<kind> \g<noun>\g<rest>", said)
    if found := _OF_THESE.search(said):
        noun = " ".join([*found.group("nouns").split()[:-1], singular(found.group("nouns").split()[-1])])
        said = said[: found.start()] + found.group("rest") + noun + said[found.end() :]
    return said


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


def without_reason(said: str) -> str:
    """A sentence without the reason behind or in front of its command."""
    if not _FACING.search(said):
        said = _TRAILING_REASON.sub("", said)
    if found := _LEADING_AIM.match(said):
        return found.group("rest").removeprefix(", ")
    if found := _LEADING_REASON.match(said):
        return found.group("rest")
    return said
