"""Who asks, and how: a wish in any form as an order or as what is to be."""

from __future__ import annotations

from ..moments import DURATION
from ..verbs import SENSES, any_of
from .wording import CAUSING, COLOR, EVENT, ING, NUMBER, PASTS, PLAIN, POINT, Rules, S, plain_of, wished, with_article

RULES: Rules = (
    # how it is written
    (r"\b(?P<u>seconds?)ll\b", r"\g<u> will"),
    (r"\bhesitate(?P<s>s?)\b", r"pause\g<s>"),
    (rf"\b(?P<d>{DURATION})(?:ll| will| would|'ll) do(?: it| nicely| for (?:it|that))?$", r"\g<d> is enough"),
    (rf" , (?P<d>{DURATION}) and (?:it is|its|it 's|that is it ,? ?it is) (?:done|over|open|shut|closed|there|finished)"
     rf"$", r" in \g<d>"),
    (rf"^(?P<np>(?!the |my |all |both |every |it |he |she )[a-z]+(?: [a-z]+)??) (?:{S}) (?=(?:only |just |not )?(?:at|f"
     rf"rom|"
     r"when|once|after|until|till|for|in|too) )", with_article),
    (r" , (?:as )?(?:a )?permanent(?:ly)?(?: change)?$", ""),
    (rf"^(?P<np>(?:the |my )?[a-z]+(?: [a-z]+)??) in (?:a )?(?P<c>{COLOR}) , (?P<t>(?:the )?(?:whole|entire|full) "
     r"[a-z]+|all the time|always|throughout)$", r"make \g<np> \g<c>"),
    (r"(?<!the )\bfirst ,? ?(?:so |i e |that is )?(?P<w>before|ahead of) (?=(?:the|my) )", r"\g<w> "),
    (r" , (?:lads|folks|guys|darling|sweetheart|sweetie|sir|madam|buddy|dear|pal|chaps|my dear|my "
     r"friend)(?= ,|$)", ""),
    (rf"(?P<c>\b{COLOR})(?: ,)? (?:and )?(?:leave|keep) it (?:{COLOR}|that way|so|like that)$", r"\g<c>"),
    (rf"^(?P<c>{COLOR}) (?P<np>[a-z]+(?: [a-z]+)??)(?: please)?(?: ,)? (?=(?:from|when|once|as soon as|until|till|"
     r"while|during|after|for|between|at|in) )", r"make the \g<np> \g<c> "),
    (rf"\bthe {COLOR} (?:colou?r )?of (?=(?:the|that|this|my) )", ""),
    (r"^(?:leave|keep) (?P<np>(?:the|my) [a-z ]+?) up(?: there)? (?:on|in) (?:the|its) [a-z]+(?: [a-z]+)?(?:(?: ,| ;| "
     r"\.|"
     r" and)+ (?:just |only )*(?:let )?the (?:others?|rest|other (?:two|ones?))(?: (?:should|may|can|must|could|are to)"
     r")? "
     r"(?:fall|drop|come down|move|go|come|tumble)s?(?: down)?)?$", r"keep \g<np> still"),
    (r"(?: ,)* [.!?;] (?:it|he|she|they) (?:does|do) not (?:need|have) to [a-z ]+$", ""),
    (rf"\b(?:only )?(?:when|once|after) (?P<d>{DURATION}) (?:ha(?:s|ve) (?:passed|gone|elapsed)|(?:is|are) (?:over|up|"
     r"gone|past))(?: by)?\b", r"at \g<d>"),
    (r"(?: ,)? please$", ""),
    (rf"\bseconds? (?P<a>{NUMBER}) (?:through|thru|to|till|until|-|–) (?P<b>{NUMBER})\b",
     r"from \g<a> to \g<b> seconds"),
    (r"^(?:bye bye|bye|goodbye|farewell|so long) (?P<np>[a-z]+(?: [a-z]+)?) [.,!] (?P<v>make|let|have|hide|remove) it"
     r"\b",
     r"\g<v> the \g<np>"),
    (r" , (?:peekaboo|boo|voila|tada|ta da|bam|boom|poof|whoosh|surprise|hooray|yay|hurrah|cheers|abracadabra|presto)$",
     ""),
    (r"^(?:up)?on (?P<np>(?:the|my) [a-z]+) (?P<v>[a-z]+ing)\b", lambda m: f"when {m['np']} {plain_of(m['v'])}s"),
    (rf"\b(?:snap|switch|change|flip|set|fade|jump) (?P<np>(?:the|my) [a-z ]+?|it) (?:over )?to (?P<c>{COLOR})\b",
     r"turn \g<np> \g<c>"),
    (rf"^(?P<x>(?=.*\b(?:{COLOR}|gold|silver|make|paint|turn|colou?r)\b.* (?:and|then) )(?=.*\b(?:until|till|"
     rf"to|for|while|between|during|as long as)\b).+?)(?: ,)? (?:and |then )+(?:{COLOR}|normal|"
     r"itself) again(?: (?:after (?:that|this)|afterwards|then|later))?$", r"\g<x>"),
    (r"^(?P<np>(?:the|my|this|that) [a-z]+(?: [a-z]+)?) (?:is|was|are|looks?) [^,.]*? ,? ?(?:and )?so (?:please )?"
     r"(?P<rest>(?:do not |never )?(?:show|hide|paint|make|turn|move|stop|remove|delete|lift|open|close|slow|let) it\b"
     r".*)$",
     lambda m: m["rest"].replace(" it", f" {m['np']}", 1)),
    (r"^(?P<x>(?=.*\b(?:pause|wait|sit|stay|rest|stand|freeze|hold)s?\b).+?)(?: ,)? (?:and )?then (?:it|he|she) (?:"
     r"(?:can|may|should|is to|shall) )?(?:roll|walk|go|move|drive|slide|fall|continue)s? on(?:wards)?(?: to (?:the|"
     r"its) [a-z]+)?$", r"\g<x>"),
    (rf" , (?:in )?(?P<d>{DURATION}) (?:tops|max|maximum|at most|at the most|no more)$", r" in \g<d>"),
    (r"(?: ,)? (?:from )?start to finish$", " from start to finish"),
    (rf"\b(?P<w>for|in|during|over) (?:the |my |its )?(?:closing|final|concluding) (?P<d>{DURATION})",
     r"\g<w> the last \g<d>"),
    (r"^(?:no|oh|sorry)(?: ,)? wait , ", ""),
    (r"\bvid\b", "video"),
    (r"\b(?:hold|keep)s? (?P<np>(?:the|my) [a-z ]+?|it) back (?=(?:until|till) )", r"let \g<np> wait "),
    (r"\b(?P<v>takes?|lasts?|taking|need|needs) (?P<a>only |just |about )?half a second\b", r"\g<v> \g<a>0.5 seconds"),
    (r"(?P<np>\bthe [a-z]+) 's (?=(?:gone|come|been|stopped|opened|closed|shut|fallen|reached|left|finished|arrived|"
     r"landed|turned)\b)", r"\g<np> has "),
    (rf"\b(?P<x>from {DURATION} (?:to|until|till) {NUMBER} and a half)$", r"\g<x> seconds"),
    (r"\b(?:aint|ain 't|ain not)\b", "is not"),
    (r"\bshould be not\b", "should not be"),
    (r"(?: ,)? (?:and )?after (?:that|this) (?:yes|it is (?:fine|ok)|ok|again|as normal|normal(?:ly)?)$", ""),
    (r"(?: ,)? and that is it(?: ,)?(?: (?:it |he |she )?(?:does|do|should|will|must) not (?:move|go|walk|roll|turn|"
     r"spin) (?:again|any ?more|on))?$", ""),
    (rf" , (?:it |he |she )?takes? (?:about |only |just )?(?P<d>{DURATION})$", r" taking \g<d>"),
    (rf"\bwhen we are at (?P<d>{DURATION})", r"at \g<d>"),
    (r"\bget(?:s|ting)? (?:tired|bored|lazy|stuck) and (?=stop|halt|pause|freeze|slow)", ""),
    (r"\b(?:in|at|on) the (?:very |exact )?(?P<m>moment|instant|second) (?=(?:the|my) (?:first |last |second )?[a-z]+ "
     r"[a-z]+s\b)", r"the \g<m> "),
    (rf"\bfor (?:a|the) (?:little |short |brief )?(?:while|bit|moment|time)(?: ,)? (?=(?:between|from|at|until|till) "
     rf"{NUMBER})", ""),
    (r"^(?P<c>(?:when|once|as soon as|after) [^,]+?) at the (?:very )?end ,", r"\g<c> ,"),
    (r"\bcom(?:e|es) (?P<v>roll|walk|slid|driv|fly|hopp|runn|bounc)ing\b",
     lambda m: {"slid": "slide", "driv": "drive", "hopp": "hop", "runn": "run", "bounc": "bounce"}.get(m["v"], m["v"])),
    (r"^(?:leave|keep) (?P<np>(?:the|my) [a-z ]+?)(?: up| over| right| just)?(?: there)? (?:on|in|at) (?:the|its) "
     r"[a-z]+(?: [a-z]+)?(?: ,| \.| and) (?:there is )?(?:no need for (?:it|that one|him|her) to|(?:i |we )?do not "
     r"want (?:it|that|that one|this one)(?: to)?|(?:it|that one|this one|he|she) (?:is|does|should|must|needs?|shall) "
     r"not(?: to)?) (?P<v>fall|falling|drop|dropping|move|moving|roll|rolling|come down|coming down)$",
     lambda m: f"do not let {m['np']} {plain_of(m['v'])}"),
    (rf"\b(?:sooner|faster|quicker)(?: ,)? (?=in {DURATION})", ""),
    (rf"(?P<d>\bin {DURATION}) (?:overall|in total|in all|altogether|all in all)$", r"\g<d>"),
    (rf"(?P<v>\b(?:stop|pause|wait|halt|rest)s?|\bpause) when (?:it|he|she) turns(?: ,)? (?=from {NUMBER})", r"\g<v> "),
    (r"\b(?:make|take|have|do)s? a (?:pause|stop|rest|break)\b(?! of)", "pause"),
    (r"\bthats\b", "that is"),
    (r"\bas (?P<x>(?:the|it|he|she) [^,]*?)(?: ,)? (?:and )?(?:hold|keep|stays?|leave) (?:that|it|so|there|like that)"
     r"(?: that way| so| like that)? (?:till|until|to) the (?:very )?end$", r"when \g<x>"),
    (r"\bin ?-?point\b", "start"),
    (r"(?<=seconds) ha(?:s|ve) (?:gone|passed|elapsed)(?: by)?\b", ""),
    (r"\bt(?: ')?other (?=way)", "the other "),
    (r"\b(?P<u>centimet(?:re|er)s?|met(?:re|er)s?|degrees?|seconds?)ll\b", r"\g<u> will"),
    (r"^(?:no ,? )?not (?:the|my) [a-z ]+? but (?P<b>(?:the|my) [a-z]+ .+)$", r"\g<b>"),
    (r"^(?:up)?on (?=(?:reaching|hitting|touching|arriving|stopping|landing|leaving)\b)", "after "),
    (r"\bdont\b", "do not"),
    (r"\bdoesnt\b", "does not"),
    (r"\bb4\b", "before"),
    (r"\b(?P<w>whatever|what|anything) (?:it is|is it) (?:that|which) (?=is |are |\w+s\b)", r"\g<w> "),
    (r"\bso long as\b", "as long as"),
    (r"\bdouble (?:so|as) (?=fast|quick|slow)", "twice as "),
    (r"\bgimme\b", "give me"),
    (r"\bdiss?app?ear(?P<s>s|ed|ing)?\b", r"disappear\g<s>"),
    (r"\bmore (?:fast|quick)\b", "faster"),
    (r"\bmore slow\b", "slower"),
    (r"\bhalf (?:of )?(?:a |the )?second\b", "half a second"),
    (r"\b(?:do not need|need not|does not need)(?: to)? (?=(?:move|open|close|fall|turn|spin|go|stop|start)\b)",
     "should not "),
    (r"\b(?P<w>everything|all|anything) (?:what|which|as) (?=(?:is|are|moves?|falls?|turns?|stands?|rolls?) )",
     r"\g<w> that "),
    (r"\b(?:is it|it is|it would be) (?:also )?poss?ible (?:that|if) (?P<np>(?:the|my|all) [a-z ]+?) (?:is|are|be) ",
     r"\g<np> should be "),
    (r"^soon as\b", "as soon as"),
    (r"\b(?:is|are) not to (?=(?:fall|move|open|close|go|stop|start|turn|roll|walk|drive)\b)", "should not "),
    (r"\bneeds? to be not\b", "should not"),
    # who asks, and how
    (rf"\b(?:only )?(?:wants|needs) (?P<v>{ING})\b", lambda m: f"should {plain_of(m['v'])}"),
    (r"^(?:the )?(?P<np>[a-z]+(?: [a-z]+)?) 's (?=[a-z]+ing (?:me|us|my|too|so|a bit|way)\b)", r"the \g<np> is "),
    (rf"\btakes? on (?:a |an |the )?(?P<c>{COLOR})(?: colou?r| hue| shade| tone)?\b", r"become \g<c>"),
    (r"(?: ,)? (?:so |and )?(?:please )?(?:correct|adjust|fix|change|amend) (?:that|it|this)?(?: accordingly| "
     r"please)?$|(?: ,)? (?:so |and )?(?:please )?(?:correct|adjust|amend)$", ""),
    (r"^(?:according to (?:the|my|our|a) [a-z]+(?: [a-z]+)?|as far as (?:i|we) (?:know|can tell)|in reality|in fact|"
     r"(?:the |a |one |my |our )?(?:witness|witnesses|report|log|script|director|client|boss|police|neighbou?r)s? "
     r"(?:says?|said|reports?|claims?|states?|tells? (?:me|us)|told (?:me|us)|wants?|shows?)(?: that)?)(?: ,)? "
     r"(?=(?:the|all|my|both) )", "it would be nice if "),
    (r"^(?:nobody|no one|(?:i|we|you|people) (?:do not|should not|must not|cannot|can not)) (?:sees?|should see|can "
     r"see|may see|is to see|must see) (?=(?:the|my) )", "hide "),
    (r"^(?P<np>(?:the|my|this|that) [a-z]+(?: [a-z]+)?) (?:was|is|were|are) [^,.]*? , (?:so|therefore|which is why) "
     r"(?:it|he|she|they) (?=(?:has|have|must|should|needs?|ought|shall) )", r"\g<np> "),
    (r"\b(?:take|takes|get|have|keep|leave|move|put)s? (?P<np>(?:the|all the|my) [a-z ]+?|it|them) out of (?:the "
     r")?(?:view|sight|shot|frame|picture|image|way of the camera)\b(?: (?:altogether|completely|entirely))?",
     r"hide \g<np>"),
    (r"^please (?=(?:the|my|all|every) )", ""),
    (r"\bought to\b", "should"),
    (r"\barriv(?P<s>es?|ing) to (?=the |my |its )", r"arriv\g<s> at "),
    (r"^hide (?P<np>.+?) from (?:us|me|everyone|everybody|sight|view|the (?:camera|audience|viewers?))\b",
     r"hide \g<np>"),
    (r"^take (?P<np>the [a-z ]+?) out (?=(?:from|between|for|until|till) )", r"hide \g<np> "),
    (r"\b(?:do|doing) (?P<np>it|him|her|them) (?=(?:light |dark |bright )?(?:"
     rf"{COLOR})(?: |$))", r"make \g<np> "),
    (rf"(?<!same )\b(?P<c>{COLOR}) as an? (?!(?:second|minute|whole)\b)[a-z]+\b", r"\g<c>"),
    (rf"\b(?P<c>{COLOR})(?: ,)? (?:instead of|rather than|and not|not) (?:the |its |this |that )?(?:old |dull |boring |"
     rf"ugly |usual |current |present )*(?:{COLOR})(?: it is| now| as now)?(?= ?(?:[,.]|at |from |when |for |$))",
     r"\g<c>"),
    (r"(?: ,)? (?:as )?(?:quick|quickly|fast|soon) as (?:you|he|she|they|it) (?:can|could|likes?)$", ""),
    (r"\b(?P<n>a|per|each|every|half a|one) sec\b", r"\g<n> second"),
    (r"\b(?:the )?drawer (?P<w>should |must |to |can |could )?emerge(?P<s>s?)\b", r"the drawer \g<w>come\g<s> out"),
    (r"^(?:i|we) would like if (?P<np>(?:the|my) [a-z ]+?) (?P<v>[a-z]+)s (?=[a-z0-9])", r"i want \g<np> to \g<v> "),
    (rf"\b(?:needs?|take|takes|use|uses) (?:just |only )?(?P<d>{DURATION}) for (?:his|her|its|the) (?:whole |entire |"
     r"full )?(?:walk|way|trip|journey|route|path|roll|ride)\b", r"take \g<d>"),
    (r"\b(?P<w>leave|keep)(?P<np> (?:the |my )?[a-z ]+?) (?:hanging|standing|gaping|sitting) open\b",
     r"\g<w>\g<np> open"),
    (r"^(?:(?:i|we) |you )?do not need (?P<np>the [a-z]+) (?:(?:to be|to open|open) )?(?:that|so|this) (?:wide|far|"
     r"open|high)(?: open)? , (?P<d>(?:\d+|[a-z]+) (?:degrees?|deg|°)) (?:will do|is enough|is plenty|would do|"
     r"suffices?|is fine)$", r"open \g<np> by \g<d>"),
    (r"^offset (?P<np>(?:the|my) [a-z ]+?)(?: layer| clip| track| animation)? (?:by )?(?P<d>.+ (?:later|earlier|"
     r"sooner))$", r"start \g<np> \g<d>"),
    (r"\b(?P<v>reverse|delay|start|stop|freeze|pause|rewind) (?P<np>the (?!whole|entire|full|complete)"
     r"[a-z]+(?: [a-z]+)?) (?:animation|layer|clip|"
     r"track)\b", r"\g<v> \g<np>"),
    (r"\bpause for (?:breath|air|thought|effect)\b", "pause"),
    (r"\b(?:lingers?|loiters?|tarry|hangs? (?:around|about|on)|stays? (?:put|up)|holds? on|sits? tight)(?: up| down|"
     r" over)?(?: there| here)?(?: (?:on|in|at) (?:the|its) [a-z]+)? (?=(?:until|till) )", "wait "),
    (rf"^(?P<x>.*\bthe (?:{COLOR}) [a-z]+?s? .*?\bthen )the (?P<c>{COLOR})$", r"\g<x>the \g<c> one"),
    (r"\b(?:make|do|take|perform|turn)(?P<s>s?) (?:one|a|a single|1) (?:(?:slow|quick|full|complete|single|whole|"
     r"gentle|lazy|big)[ ,]+)+(?:turn|rotation|spin|revolution|twirl|pirouette)\b", r"spin\g<s> once"),
    (r"^(?:only )?(?:send|let|have|make|roll)?s? ?(?P<np>the [a-z ]+?) (?:(?:go|goes|roll|rolls|travel|travels|move|"
     r"moves|get) )?(?:only )?half as far(?: as (?:it does )?now)?$", r"let \g<np> go only half the way"),
    (r"\b(?:in|for|during) this version\b", ""),
    (r"^(?:(?:oh|ah|well|so|right|hello|hi|okay|ok|now|um|uh|perhaps|maybe|actually|hmm|and then|and|but) (?:[,!.] "
     r")*)+(?=\S)", ""),
    (r"^(?:(?:slower|faster|quicker|softer|earlier|later|sooner|careful|easy|not so fast|stop|wait|no|yes)(?: "
     r",)? ?)+ (?:!|\.) (?=\S)", ""),
    (r"^(?P<np>(?:the|my|that|this) (?:poor |little |old )*[a-z]+(?: [a-z]+)??) must be (?:so |very |really "
     r")?(?:tired|exhausted|bored|dizzy|thirsty|lonely|sleepy|worn out|cold|hot) [.!,;] (?P<rest>.*?)\b(?:it|him|her)"
     r"\b", r"\g<rest>\g<np>"),
    (r"^only (?=(?:open|close|swing|turn|move|slide|push|pull|let|roll|rotate|lift|raise|crack|drop|spin|play|make) "
     r"(?:the|it|my|all)\b)", ""),
    (r"^(?P<np>(?:the|my|this|that|those|these|all the) [a-z ]{2,30}?) , (?:can|could|would|should|may|must|will|"
     r"might) (?:it|they|he|she) (?=[a-z])", r"\g<np> should "),
    (r"^(?P<np>(?:the|my|this|that) [a-z]+(?: [a-z]+)?) (?:, )?(?:i|we) (?:would )?(?:rather )?(?:like|prefer|want|"
     rf"need|love|see) (?:it|him|her|them) (?:to be |in |to |as )*(?P<c>{COLOR})\b", r"make \g<np> \g<c>"),
    (r"^(?:let us have|give (?:me|us)|show (?:me|us)|(?:i|we) (?:would like|want|need|would love|fancy)) an? "
     rf"(?P<c>{COLOR}) (?P<np>[a-z]+(?: [a-z]+)??)(?= (?:for|from|while|when|until|during|at|between|after|once|,|"
     r"all|in|throughout|the whole)\b|$| ,)", r"make the \g<np> \g<c>"),
    (r"^(?P<d>(?:for|during|from|between|until|in) (?:the )?[a-z0-9. ]+?) (?:i|we) (?:would like|want|need|would "
     rf"love) an? (?P<c>{COLOR}) (?P<np>[a-z]+)\b", r"make the \g<np> \g<c> \g<d>"),
    (r"\b(?:put|paint|make|have|turn|let) (?P<np>(?:the|my) [a-z ]+?) (?:of|in|with) (?:the |a )?(?:colou?r (?:of "
     rf")?)?(?P<c>{COLOR})(?: colou?r)?\b(?! [a-z]+ (?:to|from)\b)", r"make \g<np> \g<c>"),
    (r"^(?:(?:i|we) (?:think|feel|believe|guess|say|bet|reckon)(?: that)? )?(?P<np>(?:the|my|this|that) [a-z ]+?) "
     r"(?:would|might|could|will) (?:look|be|read) (?:(?:so|really|much|very|quite|even|rather|far|a lot|way) "
     r")*(?:[a-z]+er|lovely|nice|good|great|better|best|well|pretty|beautiful|perfect|cool|sweet|fun|smart|super|"
     rf"gorgeous) (?:in|as) (?:a )?(?P<c>{COLOR}|cream|beige|navy|teal|ivory|lilac|mint|maroon|cyan|magenta)\b",
     r"\g<np> should be \g<c>"),
    (r"^(?:i|we) (?:do not|would not) (?:want|like)(?: to (?:see|have))? (?:any|the|those|these|all the) "
     rf"(?P<np>[a-z]+(?: [a-z]+)?) (?P<v>{ING})(?: (?:on camera|here|at all|around|about|down))*(?= ,|$)",
     lambda m: f"do not let the {m['np']} {plain_of(m['v'])}"),
    (r"^(?:give|show|let) (?:me|us)(?: (?:have|see))? (?P<np>(?:the|my) [a-z ]+?) in (?:slow ?-? ?mo(?:tion)?)\b",
     r"play \g<np> in slow motion"),
    (rf"^(?P<v>{any_of(tuple(SENSES), 'ing')}|{'|'.join(CAUSING)}) (?=(?:the|all|my|our|it|both|that|this|every) )",
     lambda m: f"{CAUSING.get(m['v']) or plain_of(m['v'])} "),  # "would you mind letting the ball go"
    (r"\b(?:(?:i|we) (?:would (?:like|love|prefer)|want|need|wish)(?: to (?:see|have|show|get|watch))?|show|display|"
     r"render|have|see|dress|tint)(?: us| me)? (?P<np>it|him|her|them|the [a-z ]+?|my [a-z]+) (?:(?:to )?(?:go|turn|"
     rf"become|get|be) )?(?:in )?(?P<c>{COLOR})(?= (?:,|\.|and|from|while|when|once|until|till|for|as|at|between|"
     r"after|before|during|throughout|all|only|instead)\b|$| [,.])", r"make \g<np> \g<c>"),
    (r"^(?:someone|somebody|you|one) (?:really )?(?:ought to|should|must|has to|have to|needs to|need to|could|can) ",
     ""),
    (r"^it would (?:look|be|seem|feel|get) (?:(?:much|far|a bit|a lot|so|more|even) )*[a-z]+ if ",
     "it would be nice if "),
    (r"\b(?:i|we) (?:do not|would not|no longer) (?:want|wish|like|need) (?:(?:anyone|anybody|people|them|you|us) "
     r")?to (?:be able to )?see (?P<np>it|him|her|them|(?:the|my) [a-z ]+?)(?: (?:any ?more|any longer|again|at "
     r"all))*(?= ?(?:[,.]|while|when|until|from|once|after|before|at)|$)", r"hide \g<np>"),
    (r"(?:^|(?<=[.!?;] ))(?:could|can|would|will|should) (?:not )?(?P<it>it|he|she|they) (?:not )?(?:just |simply |"
     rf"please |perhaps )*(?=(?:{any_of(tuple(SENSES), 'plain')}|be(?! (?:possible|ok|okay|nice|great|all))) )",
     r"let \g<it> "),
    (r"\bdo (?:everything|it all|all of it|its thing|all that)\b", "move"),
    (r"\b(?P<v>waits?|holds? (?:on|back)) and (?:then |only then )?(?=(?:only )?(?:sets?|starts?|begins?|goes?|go|"
     r"leaves?|moves?) )", ""),
    (r"(?: ,)? so (?:please |just )*(?=(?:make|let|have|turn|put|stop|start|move|play|slow|speed|delay|hide|paint|"
     r"open|close|keep|freeze) (?:it|him|her|them|the|that|all)\b)", " . "),
    (r"\bin the direction of (?=the |my |its )", "toward "),
    (r"^(?:what (?:i|we) (?:would )?(?:really )?(?:like|love|want|need)(?: to (?:see|have))? is|(?:all|the thing) "
     r"(?:i|we) (?:want|need|ask)(?: for)? is)(?: that| for| to see)? (?=\S)", "i want "),
    (r"^(?:(?:i|we) (?:am|was|were|are) (?:just )?wondering (?:what|how) it would (?:look|be)(?: like)?|what would "
     r"it (?:look|be) like|what|imagine(?: that)?|(?:i|we) would (?:much )?rather(?: have it)?(?: that)?|how would "
     r"it look) (?:if (?:, )?)?(?=(?:(?:starting|beginning) |the |my |our |all |both |every )[^?]*$)",
     "it would be nice if "),
    (rf"^it would be nice if (?:starting|beginning) (?:at|from|with) (?P<d>{POINT})(?: ,)? (?P<x>(?:the|my|our|all|"
     r"both|every) .+)$", r"it would be nice if \g<x> from \g<d>"),
    (rf"^(?:starting|beginning) (?:at|from|with) (?P<d>{POINT}) , (?P<x>.+)$", r"\g<x> from \g<d>"),
    (rf"^do (?={any_of(tuple(SENSES), 'plain')} )", ""),  # "do hide it"
    (r"^(?P<i>i|we) should (?:(?:rather|quite|very much|really|so) )*(?=like\b)", r"\g<i> would "),
    (r"^(?:i|we) (?:would|should|am|are) be (?:(?:very|so|most|rather|quite|really) )*(?:pleased|glad|happy|grateful|"
     r"delighted|thankful|obliged) if (?:(?:you|we) (?:could|would|can|will) )?", "it would be nice if "),
    (rf"^it would be nice if you (?P<verb>{'|'.join(sorted(PASTS))})(?= )", lambda m: PASTS[m["verb"]]),
    (rf"^it would be nice if (?P<np>(?:the|my|our|every|all|both) [a-z ]+?) (?P<verb>{'|'.join(sorted(PASTS))})"
     r"(?P<rest>(?: .*)?)$", wished),
    (rf"^(?:i|we) (?:should|want to|would like to|must|wish to|need to) see (?P<np>the [a-z ]+?) {PLAIN} "
     rf"back\b[^;]*? (?:;|:|\.|,) (?:so )?(?:please )?(?:run|play) its (?P<event>{EVENT}) (?:backwards?|in reverse)$",
     r"play \g<np> 's \g<event> backwards"),
    (r"^be so (?:kind|good|nice) as to ", ""),
    (rf"^(?:let|have|make) (?P<np>the [a-z ]+?) (?:run|play|do|make) its (?:{EVENT}|path|way) (?:backwards?|in "
     r"reverse)$", r"play \g<np> 's motion backwards"),
    (r"^(?:i|we) (?:wish|hope|ask|request|demand|suggest|propose)(?: that)? (?=the |my |it )", "i want "),
    (r"^(?:(?:could|can|would|will) you (?:perhaps |please |maybe )?)?(?:arrange|see to it|set it up|(?:would |will "
     r")?it be possible|is it possible|(?:is|would) there (?:be )?(?:a|any) way|make it possible|we need|i need) for "
     r"(?P<x>.+?) to (?=[a-z])", r"let \g<x> "),
    (r"^(?:how|what) about (?:we )?(?:have|let|make|get) ", "let "),
    (r"^(?:let|have|make) only (?P<x>(?:the |my )?[a-z ]+?) (?P<v>[a-z]+)$", r"only \g<x> \g<v>"),
    (r"^(?:there is )?no need for (?P<x>(?:the |my )?[a-z ]+?) to (?=[a-z])", r"do not let \g<x> "),
    (r"^(?:skip|leave out|omit|cancel|drop|cut out|lose) (?:the (?:part|bit|moment) (?:where|when|in which) )"
     rf"(?P<x>the [a-z ]+?) (?P<v>{S})(?: again)?$", lambda m: f"do not let {m['x']} {plain_of(m['v'])}"),
    (r"^(?:skip|leave out|omit|cancel|drop|cut out) the (?P<v>opening|closing|falling|rolling|walking|moving|"
     r"spinning) of (?P<x>the [a-z ]+)$", lambda m: f"do not let {m['x']} {plain_of(m['v'])}"),
    (r"^(?:drop|start|launch) (?P<x>(?:the |all )[a-z ]+?) (?:at (?:exactly )?the same (?:time|moment|instant) as|"
     r"together with|along with) (?P<y>(?:the |all )[a-z ]+)$", r"let \g<x> start at the same time as \g<y>"),
    (r"\b(?:heads?|heading|sets? (?:off|out)|departs?|leaves?|makes? its way) (?:for|towards?) (?=the |my )", "go to "),
    (r"\b(?P<w>when|once|while|until|as soon as) "
     rf"(?P<v>{any_of(('stop', 'start', 'reach', 'leave', 'open', 'close'), 's')})(?= the |$)", r"\g<w> it \g<v>"),
    (rf"^(?P<x>(?:the )?[a-z ]+?) (?:is |are )?(?P<v>starts?|begins?|starting|{S})(?: [a-z]+){{0,2}} (?:too "
     r")?(?:early|late|soon)(?: for my taste)? , (?:please )?(?:(?:make|have|do) it (?:at )?|at |better (?:at |make "
     rf"it )?)?(?P<d>{DURATION})(?: (?:would|is|would be|might) (?:be )?(?:better|nicer|good|nice|fine))?$",
     r"start the \g<x> at \g<d>"),
    (r"^start the the ", "start the "),
    (rf"\b(?:start|begin) (?P<v>{any_of(('close', 'open', 'hide', 'rise', 'sink'), 'ing')}) (?=(?:the|it|my|that|all|"
     r"them)\b)", lambda m: f"{plain_of(m['v'])} "),  # what begins is not what moves already
    (rf"\b(?:tips?|topples?)(?: over)? (?=(?:about |exactly )?{DURATION} (?:later|earlier|sooner))", "start "),
    (r"\b(?P<w>begin|start)(?P<s>s)? (?:to tip|tipping|to topple|toppling)(?: over)?\b", r"\g<w>\g<s>"),
    (r"\blet (?P<x>it|him|her|them|the [a-z ]+?) (?:keep|stay|remain|be|hold|stand) still\b", r"keep \g<x> still"),
    (rf"\b(?P<x>it|he|she) takes? (?P<d>{DURATION}) to (?P<v>{PLAIN})\b", r"\g<x> \g<v> in \g<d>"),
)  # fmt: skip
