"""Phrases that have a plain equal of their own wherever they stand: "half as tall again" is 1.5 times as tall."""

from __future__ import annotations

from .....gaussians import late_re as re

_HUE = "red|blue|green|yellow|orange|purple|pink|brown|white|black|gr[ea]y|teal|turquoise"
_SIZED = r"(?P<size>big|large|tall|high|wide|long|deep|broad)"
_TURNED = "turn|rotate|spin|swing|swivel|pivot|twist|move|angle|orient|revolve"
_LOOKING = (
    r"(?:facing|faces|face|(?:looks?|looking|points?|pointing|aims?|aimed|turned|directed|turns?)(?: right| "
    r"straight| directly| "
    r"out)?(?: at| to| towards?| into| onto| of)+)"
)
# Phrases with a plain equal of their own, wherever they stand.
REWORDED = tuple(
    (re.compile(rf"(?<!\S){pattern}" + ("" if pattern.endswith(" ") or "(?=" in pattern else r"(?!\S)")), plain)
    for pattern, plain in (
        (rf"half as {_SIZED} again(?: as (?:it is|now|before))?", r"1.5 times as \g<size>"),
        (rf"half again as {_SIZED}(?: as (?:it is|now|before))?", r"1.5 times as \g<size>"),
        (rf"(?:as {_SIZED} again)", r"2 times as \g<size>"),
        (
            r"(?P<a>(?:put|move|place|pop|stick|belongs?|goes|hang|stand) [^.;!?]*?) , not (?=(?:on|in|under|by|"
            r"next to|behind|"
            r"beside|against|at|over|near) )[^,.;!?]+",
            r"\g<a>",
        ),
        (r"where (?:it|they) belongs?(?: ,)?", ""),
        (r", not (?:out |over |up |there )*where [^.;!?]+", ""),
        (
            r", (?:all (?:of (?:them|those|these)|two|three|four|five|six)|every (?:single |last )?one(?: of (?:them|"
            r"those|these))?)(?= [.;!?]|$)",
            "",
        ),
        (
            r"(?:until|till|so) (?:that )?(?:it|they) (?:is|are) (?P<n>(?:\d|a |half|ten|twenty|thirty)[^,.;!?]*?) "
            r"(?:higher|lower)(?: up| down)?",
            r"by \g<n>",
        ),
        (r"no one", "nobody"),
        (
            rf"(?P<c>{_HUE})(?: ,)? (?:instead of|rather than|and not) (?:the |its |this |that )?(?:old |dull |boring |"
            rf"ugly |usual |current |present )*(?:{_HUE})(?: it is| now)?(?= [.,;!?]|$)",
            r"\g<c>",
        ),
        (
            r"(?:for|through|throughout|during) the (?:whole|entire|full|complete) (?:story|show|piece|thing|sequence)"
            r"(?: of it)?",
            "for good",
        ),
        (
            r"(?:clear|take|get|strike|sweep|pull)s? (?P<np>(?:the|all|my|these|those|both) [a-z ]+?|it|them) (?:off|"
            r"from|out of) the (?:set|stage|scene)(?: (?:altogether|completely|entirely))?(?= [.,;!?]|$)",
            r"remove \g<np>",
        ),
        (
            r"(?:i|we) (?:would like|want|would prefer|need|would love) (?P<np>(?:the|all|my|these|those|both) "
            r"[a-z ]+?) (?:taken|removed|cleared|cut) (?:out of|off|from) the (?:set|stage|scene|picture|frame|"
            r"shot|image|film)(?: (?:altogether|completely|entirely))?(?= [.,;!?]|$)",
            r"remove \g<np>",
        ),
        (
            r", (?:just )?all (?:of (?:them|those|these) )?(?:but|except|except for|apart from|bar|save) (?=(?:the|"
            r"that|this|my|one))",
            "except ",
        ),
        (r"(?P<have>has|have) got to", "has to"),
        (r"(?P<p>size|height|width|length|depth) (?:that )?(?:it|they) (?:is|are)(?: now)?", r"\g<p>"),
        (r"(?:together |along |there )?with the (?:other one|others|rest|other)(?= [,.;!?]|$)", ""),
        (
            r"(?:cut|chop|trim|bring|take|saw|reduce) (?P<x>(?:the|that|this|my|our) [^,.;!?]+?|it|them) (?:back |"
            r"down )?to "
            r"(?=(?:half|a third|a quarter|two thirds|three quarters|\d+ ?%|\d+ percent)(?: of)?(?: (?:its|their|"
            r"the)| |$))",
            r"scale \g<x> to ",
        ),
        (
            r"(?:like|bout|circa|something like|maybe) (?=\d+ ?(?:cm|m|mm|in|inch|inches|ft|feet|foot|deg|degrees|%))",
            "",
        ),
        (
            r"(?P<n>\d\S*(?: (?:cm|m|mm|inches|feet|centimet\w+|met\w+|degrees))?) (?:or so|ish|give or take|or "
            r"thereabouts)",
            r"\g<n>",
        ),
        (
            r"(?P<to>to the (?:left|right)|left|right|back|forward|up|down) (?P<some>a (?:smidge|bit|touch|tad|little|"
            r"notch))(?= [,.;!?]|$)",
            r"\g<some> \g<to>",
        ),
        (
            r"(?:over|along|across) (?=(?:a (?:wee |tiny |little |small )?(?:bit|tad|touch|smidge|little|notch)|\d\S*|"
            r"half|slightly|by) )",
            "",
        ),
        (
            r"(?P<n>\d\S*|two|three|five|ten|twenty|thirty) (?:more|further) (?=degrees|deg|cm|centimet|met|inch|feet|"
            r"foot|mm)",
            r"\g<n> ",
        ),
        (
            r"(?:and |, )*(?:then )?(?:once|when|after|as soon as) (?:that is|that has been|this is|it is|you have|"
            r"you are|all that is|"
            r"that) (?:done|finished|sorted|through)(?: that| with that| it)?(?: ,)?",
            ", then",
        ),
        (r"in an? (?P<l>darker|lighter|paler|brighter|warmer|cooler|richer) (?:tone|shade|colou?r|hue|tint)", r"\g<l>"),
        (r"x (?P<n>\d)(?: (?:the |its )?size| bigger| as big)?", r"\g<n> times the size"),
        (r"(?:like|bout) so", ""),
        (r"back (?=to (?:the|my) (?:left|right)(?! of)(?= |$)|(?:up|down)(?: again| a | by |$))", ""),
        (
            rf"(?:{_TURNED}) (?P<x>(?:the|that|this|my|our|both|all|those|these) [^,.;!?]+?|it|them)(?: right| "
            rf"back)?(?: round| "
            rf"around| over)?(?: ,)? (?:until|till|so that|so|such that|to where|in order that) (?:it|they|its "
            rf"front|their fronts|"
            rf"the front)(?: is| are)?(?: then)? {_LOOKING}",
            r"turn \g<x> to face",
        ),
        (
            r", (?P<n>(?:about |around |roughly )?(?:an?|half|one|two|three|five|ten|twenty|thirty|forty|fifty|"
            r"\d\S*)(?: [a-z]+){0,3}?) "
            r"(?:will|should|would|ought to|is|ought) (?:do|suffice|be (?:enough|plenty|fine|good|ok|about right)|"
            r"enough|plenty|fine)"
            r"(?: it| nicely| the trick)*(?= [,.;!?]|$)",
            r"\g<n>",
        ),
        (
            r", (?:say|about|like|roughly|around|something like|let us say) (?=\d|half|a third|a quarter|two thirds)",
            "about ",
        ),
        (
            r"if (?P<x>[^,.;!?]+?)(?: ,)? (?:that|it|this) (?:would|will|might) be (?:great|good|nice|lovely|ideal|"
            r"perfect|fab|"
            r"fantastic|wonderful|super|amazing|brilliant|cool|better|best)",
            r"\g<x>",
        ),
        (
            r"(?P<v>paint|make|colou?r|dye|recolou?r) (?P<x>(?:the|that|this|my|our|both|all|every) [^,.;!?]+?|it|"
            r"them) (?:in )?the "
            r"(?:exact )?colou?r of (?=(?:the|my|our|that|its|those|these) )",
            r"\g<v> \g<x> the same colour as ",
        ),
        (
            r"as (?P<hue>red|blue|green|yellow|white|black|brown|gr[ea]y|pink|purple|orange) as (?=(?:the|my|our|"
            r"that|those|these) )",
            "the same colour as ",
        ),
        (r"(?P<x>it|they|that|there) (?:is|are) no (?=\w+ (?:to me|anymore))", r"\g<x> is not "),
        (r"another (?=\d|half|bit|a )", ""),
        (r"(?:piece|bit|item|lump)s? of furniture", "furniture"),
        (
            r"(?:turn|spin|swing) (?P<x>\S.*?) (?:round |around |so (?:that )?it (?:is )?)?(?:to |and )?(?:face|"
            r"faces|facing|look|looks|"
            r"point|points) the (?:other|opposite) (?:way|direction)(?: round| around)?",
            r"turn \g<x> around",
        ),
        (r"to face the (?:other|opposite) (?:way|direction)", "to turn around"),
        (r"(?:so (?:that )?it (?:is )?)?(?:face|faces|facing) the (?:other|opposite) (?:way|direction)", "turn around"),
        (r"(?:cut|chop|reduce|bring|take|slash) (?P<x>\S.*?) (?:in|by|to|down to|down by) half", r"halve \g<x>"),
        (
            r"scale (?:down )?(?P<x>(?!up)\S.*?) (?:down |to |down by |down to )half(?! (?:of )?(?:its|their|the))",
            r"halve \g<x>",
        ),
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
            rf"(?:crank|turn|bump|ramp|punch|pump|dial) up the (?:colou?rs?|{_HUE}) (?:on|of|in) (?P<x>[^,.;!?]+?)",
            r"make \g<x> more vivid",
        ),
        (
            rf"(?:tone|turn|dial|tame) down the (?:colou?rs?|{_HUE}) (?:on|of|in) (?P<x>[^,.;!?]*[^ ,.;!?])",
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
            r"(?:empty|clear) (?:out |off )?(?P<x>the [^,.;!?]*?[^ s,.;!?])(?: ,)? (?P<but>except for|except|apart "
            r"from|but "
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
        (r"with the (?:sole |only )?exceptions? of", "except"),
        (r"\+(?= [a-z])", "and"),
        (r"please to(?= [a-z])", "please"),
        (r"like(?= (?:twice|half|really|way|totally|super|a (?:bit|lot|little)) )", ""),
        (r"the (?:object|item|thing)s? (?:known as|called|named) (?=the |my |our )", ""),
        (r"the following (?:objects|items|things)(?: ,)? :", ""),
        (
            r"(?:create|make|produce|generate) (?:(?:an?|one|me|us|another) )*(?:(?:exact|identical|perfect|second) )?"
            r"(?:copy|duplicate|clone|replica|twin) (?:of|from)",
            "duplicate",
        ),
        (
            r"(?P<x>(?:the|this|that|my|our) [^,.;!?]+?) (?:should|must|shall|is to|has to|needs to|ought to) "
            r"(?:also )?be (?:duplicated|copied|cloned)",
            r"duplicate \g<x>",
        ),
        (
            r"apply an? (?:rotation|turn) of (?P<n>[^,.;!?]+?) to (?P<x>(?:the|this|that|my|our) [^,.;!?]+)",
            r"rotate \g<x> by \g<n>",
        ),
    )
)
