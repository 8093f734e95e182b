"""Rewrites ways to speak of light to the plain forms that are read: "what would it look like at night", "+1 EV".

A rewritten instruction only counts if all of it is understood as light or as another edit; otherwise the grammar reads
the words as they were said.
"""

from __future__ import annotations

from ....gaussians import late_re as re
from ....gaussians.world.spelling import best_slip, nearest
from ..tagging.spelling import is_word
from ..tagging.words import bag, split
from ..vocabulary.nouns import is_known
from .vocabulary import meanings

_SHOWN = (
    r"(?:it|this|that|things|everything|(?:the|this|that|my|our) (?:whole )?(?:room|place|scene|space|kitchen|\w+))"
)
_TINTS = r"yellow|orange|red|blue|golden|amber|warm|cold|cool|yellowish|orangey|bluish|blueish|reddish"
_LOSE = (
    r"(?:undo|remove|get rid of|fix|correct|lose|take out|take away|neutralise|neutralize|cut out|kill|reduce|"
    r"tone down|drop|ditch|no more|without|clear up|eliminate)"
)
_OFF_ALL = r"(?:kill|turn off|switch off|shut off|cut|put out|turn out)"
_REST = (
    r"(?:everything else|all the rest|the rest(?: of (?:them|the lights|the lamps))?|all else|"
    r"(?:all )?the other (?:lamps|lights|ones)|all (?:the )?others|the others|all other (?:lamps|lights)|rest|others)"
)
_LAMP = r"(?:lamp|chandelier|pendant|sconce|spotlight|lantern)"
_LIGHT_PART = r"(?:the )?(?:brightness|exposure|light level|lightness|colou?rs?|tones?|warmth|colou?r temperature|tint)"
_FORMS: tuple[tuple[str, str], ...] = (
    # Speech.
    (r"\b(?:pls|plz|plss)\b", "please"),
    (r"\b(?:you know|i guess|i think|or so|or something|if you can|kinda|sorta|for once)\b[,. ]*", " "),
    (r"\b(\w{3,})-?ish light\b", r"\1 light"),
    (r"\b(?:is|looks|feels|seems) to (?=(?:bright|dark|dim|cold|warm|harsh|yellow|blue|cool|hot)\b)", "is too "),
    (r"\b(?:horribly|awfully|horrendously|dreadfully|unbearably|ridiculously|insanely|hideously)\b", "too"),
    (r"\bits (?=(?:too|so|way|really|very|a bit|quite|rather|as|far|much|pretty) )", "it is "),
    (r"(?<=is )(?:as|so) (dark|dim|gloomy|bright|cold) as (?:a |an |the |in )*[\w' ]+?(?= in here| here|$|"
    r"[.,;!?])", r"too \1"),
    (r"\bi (?:find|think|feel|reckon) (?:it|this|that|(?=the |it'?s |it is |this ))(?: is|'s)?(?= |$)", "it is"),
    (r"\b(dark|dim|gloomy|light|bright|cold) (?:for me |for us )?to (?:read|work|see|write|cook|eat|sew|draw|study|"
     r"sleep|relax|concentrate)(?: (?:anything|much|properly|a thing))?\b", r"\1"),
    (rf"\b(?:take|get|pull|suck|draw|keep) (?:(?:some of|the|that|this|all|a bit of|any) )*({_TINTS})(?:ness)?"
     r"(?: (?:cast|tint|tinge|hue|tone)s?)? (?:out|down|away|off)(?: (?:of|from) (?:it|here|everything|the \w+))?\b",
     r"less \1 light"),
    # What it would look like.
    (r"\bthe sun (?:was|is|were|has|had) (?:setting|going down|just set|about to set|low)\b", "sunset"),
    (r"\bthe sun (?:was|is|were|has|had) (?:rising|coming up|just risen|about to rise)\b", "sunrise"),
    (r"^what if (?=sun)", "show the room in "),
    (
        r"^(?:(?:so|and|hey|ok|hmm|well)[, ]+)?(?:(?:i wonder|i am wondering|i'm wondering|can you show me|"
         r"could you show "
        r"me|show me|let me see|can i see|could i see|i'd like to see|i want to see|tell me|imagine)\W+)?"
        rf"(?:what|how) (?:(?:would|might|could|does|will) {_SHOWN}|{_SHOWN} (?:would|might|could|"
         rf"will)|{_SHOWN}(?= looks)) "
        r"(?:looks?|feels?|seems?|be)\b(?: like)?(?: if| when)?(?: (?:it|this|we|there|things) "
        r"(?:were|was|is|had been|had))?(?: lit)?(?: on| at| in| under| with| by| during| around)?\b",
        "show the room in",
    ),
    (
        rf"^what (?:if|about if) (?:{_SHOWN}|we|there) (?:were|was|is|had|looked like|felt like)\b"
        r"(?: on| at| in| under| by| lit by)?\b",
        "show the room in",
    ),
    # How it is for people.
    (r"^(?:a |an |for a |for )?(romantic dinner|romantic evening|date night|movie night|film night|cinema|dinner party)"
     r"(?: please| mood| vibes?| feel| light| lighting)*(?=$|[.,!;])", r"\1 mood"),
    (r"^(?:can|could|may) (the|my|that) ([\w ]+?) (?:please )?(?:get|have|use|do with) ((?:a bit |a little |"
     r"a lot |some )?(?:more|less)) light\b",
     r"\3 light on \1 \2"),
    (r"^(the|my|that) ([\w ]+?) (?:needs?|wants?|could use|could do with|should (?:have|get)) "
     r"((?:a bit |a little |a lot |some )?(?:more|less)) light\b", r"\3 light on \1 \2"),
    (r"\b(?:my |our |the )?eyes (?:hurt|ache|burn|sting|are (?:hurting|aching|"
     r"burning))(?: in here)?\b[,.! ]*(?:so )?", ""),
    (r"\bi (?:cannot|can't|cant|can not|can hardly|can barely|could hardly) see (?:a thing|anything|much|a damn thing)"
     r"(?: in here| here)?\b", "it is too dark"),
    (rf"^(the [\w ]*?{_LAMP}s?(?: (?:on|by|next to|near|in|at|over|above|beside) the \w+)?) (?:is|are) (?:way |"
     rf"far |much |a bit )*"
     r"too (?:bright|strong|glaring)\b", r"dim \1"),
    (r"(?:[, ]+but|[, ]+and|[, ]+while)[, ]+(?:leave|leaving|keep|"
     r"keeping) (?:the )?([\w ]+?)(?: area| side| part)? (?:dim|dark|darker)\b",
     r", less light on the \1"),
    (r"\b(pendant)(s?)\b(?! (?:lamp|light|s\b))", r"\1 lamp\2"),
    # Times of day.
    (r"\b(?:at |around |about |like |say )*(?:5|6|7|8)(?:[:.]\d\d)? ?a\.?m\b\.?", "early morning light"),
    (r"\b(?:at |around |about |like |say )*(?:9|10|11)(?:[:.]\d\d)? ?a\.?m\b\.?", "daylight"),
    (r"\b(?:at |around |about |like |say )*(?:12|1|2|3)(?:[:.]\d\d)? ?p\.?m\b\.?", "daylight"),
    (r"\b(?:at |around |about |like |say )*(?:4|5|6)(?:[:.]\d\d)? ?p\.?m\b\.?", "late afternoon light"),
    (r"\b(?:at |around |about |like |say )*(?:7|8|9)(?:[:.]\d\d)? ?p\.?m\b\.?", "evening light"),
    (r"\b(?:at |around |about |like |say )*(?:10|11|12)(?:[:.]\d\d)? ?p\.?m\b\.?", "night light mood"),
    (r"\b(?:at |around |about |like |say )*(?:12|1|2|3|4)(?:[:.]\d\d)? ?a\.?m\b\.?", "night light mood"),
    (r"\b(?:it is|it's|its) (?=(?:raining|snowing|storming|pouring)\b)", ""),
    (r"((?:rain|storm|cloud|fog|drizzl|overcast|autumn|winter|november)\w*[^.,;!?]*[.,;!?] )gr[ae]y\b", r"\1overcast"),
    # Amounts.
    (r"(?<![\w.])\+ ?(\d+(?:\.\d+)?|half|one|two) ?(?=stops?\b|ev\b)", r"raise the exposure by \1 "),
    (r"(?<![\w.])[-\u2212\u2013] ?(\d+(?:\.\d+)?) ?(?=stops?\b|ev\b)", r"lower the exposure by \1 "),
    (r"^(?:plus) (?=[\w. ]+ (?:stops?|ev)\b)", "raise the exposure by "),
    (r"^(?:minus) (?=[\w. ]+ (?:stops?|ev)\b)", "lower the exposure by "),
    (r"^quarter (?:of )?(?:the )?(?=brightness|light|exposure)", "a quarter of the "),
    (r"\bquarter (?=brightness|exposure)", "a quarter of the "),
    (r"^(?:the )?(brightness|exposure|light|lights|light level)(?: at| to|:| =| down to| up to)? (?=\d+ ?(?:%|"
     r"percent))",
     r"set the \1 to "),
    (r"^(?:set |go |put it |make it |turn it )?(?:to |at )?(\d+ ?(?:%|"
     r"percent)) (?=(?:of )?(?:the )?(?:brightness|light|exposure)\b)",
     r"set the exposure to \1 "),
    (r"\b(?:nearly|almost|practically|virtually|pretty much) (?:completely |totally )?(?:dark|black|"
     r"no light)\b", "much less light"),
    (r"\balmost no light\b", "much less light"),
    (r"^(?:make (?:it|everything) )?pitch black\b", "pitch dark"),
    (r"^(?:full|maximum|max) (?:brightness|light)\b", "much more light"),
    # Glare, casts, tints.
    (rf"\b{_LOSE} (?:the |this |that |all the |some of the )?glare (?:that is |that's )?(?:coming |shining )?(?:in )?"
     r"(?:from|through|off|of|on) (?=(?:the|that|this|my) )", "less light on "),
    (r"\bglare (?:that is |that's )?(?:coming |shining )?(?:in )?(?:from|through|off|of|on) (?=(?:the|that|this|"
     r"my) )", "light on "),
    (rf"\b{_LOSE} (?:the |this |that |all (?:the |that )?|some of the )?glare\b", "less light"),
    (rf"\b{_LOSE} (?:the |this |that |any |all |some of the )*({_TINTS}) (?:cast|tint|tinge|hue|tone)s?\b",
     r"less \1 light"),
    (r"\b(make (?:everything|it all|the room|the whole room|the place|it)) (?:bluish|blueish) (?=(?:like|as) )",
     r"\1 light bluer "),
    (r"\bhard (?=(?:light|sunlight|sunshine)\b)", "harder "),
    (r"\b(?:put|give|bathe|keep) (the [\w ]+?) (?:in |with )?(?:some )?(?:good|proper|bright|better|decent|strong) "
     r"(?:work(?:ing)? |reading |task )?light\b", r"more light on \1"),
    # What stays.
    (rf"[, ]+(?:(?:but|and|though|only)[, ]+)?(?:please )?(?:do not|don't|dont|without|not) "
     rf"(?:chang(?:e|ing)|touch(?:ing)?|alter(?:ing)?|affect(?:ing)?|los(?:e|ing)|mess(?:ing)? with) "
     rf"(?:{_LIGHT_PART}|how (?:bright|dark|warm|light) it is(?: now)?)(?: please| though| at all)?(?=$|[.,;!?])", ""),
    (rf"[, ]+(?:but|and|while|though)[, ]+(?:please )?(?:keep|keeping|leave|leaving) {_LIGHT_PART}"
     r"(?: (?:as (?:it is|is|they are)|the same|alone|unchanged))?(?=$|[.,;!?])", ""),
    # Lamps, one on and the others off.
    (rf"(?:\band|\bbut|,|;)+ ?(?:then )?{_OFF_ALL} {_REST}\b", " and turn off the other lamps"),
    (rf"(?:\band|\bbut|,|;)+ ?(?:then )?(?:turn|switch|put|with|have|leave|keep)? ?{_REST} (?:off|out)\b",
     " and turn off the other lamps"),
    (r"^(?:please )?(?:only|just) (?:have |leave |keep |turn |switch )?(?:on )?(?:the )?(?P<a>[\w ]*(?:lamps?|"
     r"lights?|pendants?|chandelier|"
     r"candles?|sconces?)(?: (?:on|by|next to|near|in|at|over|above|beside) (?:the )?\w+)?) (?:on|lit|"
      r"burning)\b(?! and turn)",
     r"turn on the \g<a> and turn off the other lamps"),
    (r"^(?:please )?(?:turn on|switch on|leave on|keep on) (?:only|just) (?P<a>the [\w ]*(?:lamps?|lights?|"
     r"pendants?))$",
     r"turn on \g<a> and turn off the other lamps"),
    (r"^(?:please )?(?:turn|switch|put) (?:only|just) (?P<a>[\w ]*(?:lamps?|lights?|pendants?)) on$",
     r"turn on \g<a> and turn off the other lamps"),
    (r"^(?:only|just) (?=the (?:left|right|middle) (?:one|lamp|light)\b.* (?:on|off)\b)", "turn "),
    (r"^(?:just |only )?one (?P<a>[\w ]*(?:lamp|light|pendant|candle|sconce)) on[, ]+(?:and )?(?:the )?(?:one|"
     r"other(?: one)?) off$",
     r"turn on the left \g<a> and turn off the right \g<a>"),
    (r"\b(?:just |only )?one of the (?P<a>[\w ]*(?:lamp|light|pendant|candle|sconce))s (?P<w>on|off|out)"
     r"[, ]+(?:just )?the (?P<s>left|right|middle) (?:one|lamp|light)\b", r"the \g<s> \g<a> \g<w>"),
    (r"\ball (?:of )?(?:the )?(?P<a>lamps|lights) (?P<w>on|off) (?P<e>except|but|apart from|except for|besides) "
     r"(?P<r>(?:the |that )?[\w ]+)$", r"turn \g<w> all lamps except \g<r>"),
    (r"\b(?:turn|switch|put) (?P<w>off|out) (?:everything|all|every light|every lamp|all (?:the )?(?:lamps|lights)) "
     r"(?:except|but|apart from|except for|other than) (?P<r>(?:the |that )?[\w ]+)$",
      r"turn off all lamps except \g<r>"),
    (r"\b(?:turn|switch|put) (?:everything|all|all (?:the )?(?:lamps|lights)) (?:off|out) "
     r"(?:except|but|apart from|except for|other than) (?P<r>(?:the |that )?[\w ]+)$",
      r"turn off all lamps except \g<r>"),
)  # fmt: skip
_READ = tuple((re.compile(form, re.IGNORECASE), plain) for form, plain in _FORMS)
_LIKE = re.compile(
    r"^(?:just |more |a bit |kind of |sort of |pretty much )*(?:like|as if|as though|as in|think|the way|"
    r"so|because|since|as in)\b(?!.* (?:make|put|turn|switch|set|paint|delete|remove|want|need|please)\b)"
)
_KEPT = re.compile(
    r"^(?:(?:please|just|and|but) )*(?:(?:the|all the) (?:rest|others?|remainder|light|lamps?)|everything else|"
    r"nothing else|"
    r"all else|(?:the )?other \w+)(?: of (?:it|the room|the scene))? (?:is|are|stays?|remains?|looks?|can stay|can "
    r"remain|"
    r"should stay)\b[\w ]*$|"
    r"^(?:(?:please|just|and|but) )*(?:leave|keep|do not (?:touch|change)) (?:the rest|everything else|the others|"
    r"all else)\b"
    r"[\w ]*$"
)
_MENDED = re.compile(
    r"^(?:(?:please|can|could|would|will|you|we|just|so|then|i|want|need|to|like|it|maybe) )*"
    r"(?:fix|sort|correct|improve|adjust|solve|mend|repair|change|balance|neutrali[sz]e|even|cure|remedy|counter|"
    r"compensate|help|do something|clean|handle|tweak|make it (?:a bit )?(?:better|nicer|right|neutral|"
    r"normal|friendlier|pleasanter|prettier|more (?:pleasant|natural|friendly|inviting|welcoming|neutral|normal))|"
    r"freshen(?: up)?|refresh|lift|"
    r""
    r"get rid of (?:it|that)|remove (?:it|that)|take (?:it|that) (?:out|away)|(?:it|that) (?:fixed|corrected|gone))"
    r"(?: (?:it|that|this|out|up|please|for|about|me|us|a|bit|with|the|light|lighting|colou?rs?|somehow|now|you|"
    r"can|could))*$"
)
_LONG = 6  # letters of a word whose spelling is mended
_COMMON = bag("brighter brighten darken lighting lights brightness")
_ALIKE, _SLIP = 0.86, 0.75
_CORE = bag("room light dark darker warm warmer cool cooler lamp lamps lights night dusk noon")  # shorter words


def plainly(cleaned: str) -> str:
    """An instruction with its words for light in plain form and spelling; see `tagging.words.clean`."""
    said = _spelled(cleaned)
    for pattern, plain in _READ:
        said = pattern.sub(plain, said)
    return re.sub(r"\s+", " ", said).strip()


def is_comparison(words: list[str]) -> bool:
    """Whether a clause only explains what was said before: "like in the middle of July"."""
    return _LIKE.match(" ".join(words)) is not None


def is_kept(words: list[str]) -> bool:
    """Whether a clause only says that the rest stays as it is."""
    return _KEPT.match(" ".join(words)) is not None


def is_mended(words: list[str]) -> bool:
    """Whether a clause only asks to mend what was said before it: "fix that"."""
    return _MENDED.match(" ".join(words)) is not None


def misspelled(cleaned: str) -> bool:
    """Whether an instruction holds an unknown word that is one slip away from a common word for light."""
    return any(
        len(w) > _LONG and w.isalpha() and not is_word(w) and best_slip(w, _COMMON) for w in cleaned.lower().split()
    )


def _spelled(said: str) -> str:
    known = {w for phrase in meanings() for w in phrase}
    long = sorted(w for w in known if len(w) >= _LONG)
    for word in {w.text for w in split(said)}:
        if len(word) < 4 or not word.isalpha() or word in known or is_known(word) or is_word(word):
            continue
        if len(word) < _LONG:
            close = tuple(
                w for w in nearest(word, _CORE, most=1, likeness=_SLIP) if w[0] == word[0] and len(w) == len(word)
            )
        else:
            close = nearest(word, long, most=1, likeness=_ALIKE)
        if close and close[0]:
            said = re.sub(rf"\b{word}\b", close[0], said, flags=re.IGNORECASE)
    return said
