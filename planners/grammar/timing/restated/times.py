"""When, from when on, until when."""

from __future__ import annotations

from .....gaussians import late_re as re
from ..moments import DURATION
from .wording import (
    BEGIN,
    COLOR,
    EVENT,
    ING,
    IS_THERE,
    IT,
    NO_LENGTH,
    PLAIN,
    POINT,
    SETS_OFF,
    Rules,
    S,
    between,
    colored,
    counted,
    from_to,
    gone,
    plain_of,
    unwished,
    with_unit,
)

RULES: Rules = (
    # what stays open
    (r"^(?:leave|keep|let) (?P<np>(?:the |my )?[a-z ]+?) (?:stay |remain |be )?(?:open|out)(?: ,| \.| and)+(?: there "
     r"is)? (?:no need for (?:it|him|her) to|(?:it )?(?:should |must |need |does |do )?not(?: let (?:it|him|her))?|"
     r"never)(?: ever)? (?:close|shut|go (?:back )?in|slide (?:back )?(?:in|shut)|come back in|return)(?: again| "
     r"any ?more)?$", r"do not close \g<np>"),
    (r"^(?:when|once|after) (?P<np>(?:the |my )?[a-z ]+?) (?:is|comes|has come|has opened|opens|gets)(?: fully| all "
     r"the way)?(?: out| open)?(?: ,)? (?:it|he|she) (?:should|must|shall|may|does|need) (?:not|never)(?: ever)? "
     r"(?:close|shut|go (?:back )?in|slide (?:back )?(?:in|shut)|come back in|return)(?: again| any ?more)?(?= [.]|$)"
     r"(?: \. (?:leave|keep) it (?:open|out)(?: please)?)?",
     lambda m: f"do not close the {re.sub('^the ', '', m['np'])}"),
    # how a time is named
    (r"\b(?P<v>(?:hit|touch|reach|strik|bump|meet|gets?|arriv)[a-z]*) (?P<at>(?:to |at |into |against )?)the (?:far|opp"
     r"osite|other|"
     r"farther|further) wall\b", r"\g<v> \g<at>the wall"),
    (r"\b(?P<s>seconds?) and half\b", r"\g<s> and a half"),
    (r"\bup to (?:where|when|the (?:point|moment|place) (?:where|when|at which)) ", "until "),
    (r"\b(?:sit|stand|stay)s? and (?=waits?\b)", ""),
    (r"(?: ,)? and stays? (?:that way|so|like that)$", ""),
    (rf"(?: ,)? (?:and |but )?(?:then|after that|afterwards|later)(?: ,)? (?:(?:it |he |she )?(?:should |must |can |may"
     rf" |is to "
     rf")?(?:go|goes|turn|turns|change|changes|be|return|returns) back to|(?:return|turn|change|set|bring|put) (?:it|hi"
     rf"m|her)"
     rf"(?: back)? to|(?:back )?(?:in|to|into) its (?:usual|own|normal|old|original)) (?:{COLOR}|normal|colou?r)(?: aga"
     rf"in)?$", ""),
    (rf"(?: ,)?(?: and| then)+ when (?P<c>(?:it|he|she|the|its) .+?) (?:make|turn|put|set|change|have|paint) (?:it|him|"
     rf"her) "
     rf"(?:back )?(?:to )?(?:normal|{COLOR})(?: again)?$", lambda m: f" until {re.sub('^its ', 'it is ', m['c'])}"),
    (rf"\b(?:when|once) (?:we|you|i) (?:get|come|are) (?:to|at) (?P<d>{POINT})", r"at \g<d>"),
    (r"\bin stead of\b", "instead of"),
    (r"\b(?:all|right) (?:the way )?through(?: (?:the|this) (?:film|clip|video|movie|scene|shot|whole thing))?\b"
     r"(?! the [a-z]+)", "for the whole film"),
    (r"\bover the (?:length|course|duration) of the (?:film|clip|video|movie|shot)\b", "over the whole film"),
    (rf" ,(?: and)? (?:give (?:it|him|her)|allow(?: it)?|take) (?:about |only |just |around )?(?P<d>{POINT})(?: over it"
     rf"| for it"
     rf"| for that)?$", lambda m: f" in {with_unit(m['d'])}"),
    (r"^with (?P<np>(?:all )?(?:the|my) [a-z]+(?: [a-z]+)?) (?P<s>down|open|out|shut|closed|gone|still) ,",
     lambda m: f"once {m['np']} {'have landed' if m['s'] == 'down' else 'is ' + m['s']} ,"),
    (rf"^(?P<v>let|make|have) (?P<np>(?:the |my )?[a-z ]+?) (?:wait|hold on|stay|stand still) (?:for )?(?:another|one m"
     rf"ore|a "
     rf"further) (?P<d>second|{DURATION})(?: before (?:it|he|she) [a-z ]+)?$",
     lambda m: f"start {m['np']} {'one second' if m['d'] == 'second' else m['d']} later"),
    (r"\bin mid ?-?air\b(?=.*\b(?:for|sec|second|seconds)\b)(?: on (?:its|the) way down)?", "halfway"),
    (r"(?P<x>\bhalfway\b.*?)(?: ,)? on (?:its|the|his) way (?:down|up)\b", r"\g<x>"),
    (rf"^for the first (?P<d>second|{DURATION}) (?P<np>(?:the|my) [a-z ]+?|it) (?:should |must |shall |may |has to |is "
     rf"to |can )?"
     r"(?:just |only |simply )*(?:stands?|stays?|sits?|waits?|remains?|be|is)(?: still| there| put| motionless| where ("
     r"?:it|he|"
     r"she) is)*(?: ,)?(?: and)? (?:only )?then (?:it |he |she )?(?:starts?|begins?|goes|moves|sets off|gets going)\b.*"
     r"$",
     lambda m: f"start {m['np']} at {'1 second' if m['d'] == 'second' else m['d']}"),
    (r"\b(?:only )?(?:until|till|up to|as far as) (?:only )?(?=\d+(?:\.\d+)? ?(?:degrees?|deg|°|cm|centimet))", "by "),
    (r"\b(?:straight|right) off the bat\b", "from the start"),
    (r"^(?P<x>.*\bmove .+?)(?: to (?:the|its) (?:left|right))? until (?:it|he|she) (?:sits|stands|rests) (?=(?:next "
     r"to|"
     r"beside|by|near|in front of|behind) (?:the|my) )", r"\g<x> "),
    (rf"(?: ,)?(?: and| then| but)+ (?:(?:turn |make )?it )?(?:back to )?(?:{COLOR}|normal|its (?:own|old|usual|normal)"
     rf" "
     r"colou?r) again (?:when|once|as soon as|from when) (?=(?:it|he|she|the|my) )", " until "),
    (r"\b(?:for|in|during|through) the (?:bit|part|moment|section|stretch|time) (?:where|when|in which) ", "while "),
    (r"(?P<x>\b(?:fall|drop|roll|open|walk|move)s? )(?:two times|twice)(?: ,)? (?:the )?second (?:time|one|go|round) "
     r"(?=from|at|when|after)", r"\g<x>again "),
    (r"(?P<x>\b(?:at|from|until|till|by|in|after) \d+(?:\.\d+)?)(?: ,)? (?:and )?(?:not|instead of|rather than) (?:at |"
     r"from "
     r"|in |after )?\d+(?:\.\d+)?$", r"\g<x> seconds"),
    (rf"(?P<x>\b(?:later|earlier|sooner|delayed by {DURATION}|by {DURATION}))(?: ,| ;) (?:the |its )?(?:closing|opening"
     rf")(?: "
     r"stays)?$", r"\g<x>"),
    (rf"^(?P<np>(?:the |my )?[a-z ]+?) (?:cue|entrance) (?:(?:moves?|shifts?|goes|changes?) )?(?:to|at) (?P<d>{POINT})$"
     rf"",
     lambda m: f"start {m['np']} at {with_unit(m['d'])}"),
    (r"^(?P<x>.+? (?:to|towards?|into|beside|next to|by) (?P<y>(?:the|my|its) [a-z]+(?: [a-z]+)??)) (?P<w>when|once|as "
     r"soon as|after) (?P<who>(?:the|my) [a-z]+(?: [a-z]+)?|it|he|she) (?:gets|is|has got|arrives|has arrived|comes|"
     r"has come) there(?= ?(?:[,.]|$))", r"\g<x> \g<w> \g<who> reaches \g<y>"),
    (rf"(?P<x>\b(?:start|begin|turn|run|move|work)s? (?:only|just) (?:after|at|from) {POINT})(?: ,| ;| \.)+ (?:and )?"
     r"(?:until|till|before) then (?:it|he|she) (?:should |must |shall |may |has to |is to )?(?:be |is |stays? |stands?"
     r" |"
     r"remains? |keeps? |hangs? )*(?:motionless|still|off|switched off|idle|at rest|put)$", r"\g<x>"),
    (r"^(?:hold|keep) (?P<np>(?:the |my )?[a-z ]+?) (?:shut|closed|still|back) for (?:another|one more|a further) "
     rf"(?P<d>second|{DURATION})(?= ?(?:[,.]|$))",
     lambda m: f"start {m['np']} {'one second' if m['d'] == 'second' else m['d']} later"),
    (rf"(?P<w>\b(?:waits?|holds?|pauses?|stays?)\b.*? (?:till|until) .+?)(?: ,)? before {IT} (?:sets? off|{BEGIN}|{S})"
     r"(?: (?:down|off|out|to move|moving))*$", r"\g<w>"),
    (r"\b(?P<w>when|once|until|till|as soon as|after) (?:at last|finally|eventually|at long last) ", r"\g<w> "),
    (r"^(?P<x>(?=.*\b(?:pause|wait|stop|halt|freeze|rest|stand)s?\b)(?=.* (?:for|at|when) ).+?)(?: ,)? (?:and |then |af"
     r"ter "
     r"that )+(?:go|goes|walks?|continues?|carry|carries|moves?|heads?|rolls?) (?:on|onwards?|further)(?: "
     r"(?:to|toward|towards|into) (?:the|its|his) [a-z]+)?$", r"\g<x>"),
    (r"\b(?:at|in) the (?:exact |very )?middle of the (?:film|clip|video|movie|shot|scene|sequence)\b",
     "halfway through the film"),
    (r"\b(?:for|through|throughout|during) the (?:whole|entire|full|complete) (?:story|show|piece|thing|sequence|"
     r"length|duration|run)\b(?: of (?:it|the film))?", "for the whole film"),
    (r"\b(?:from (?:the )?(?:beginning|start) (?:to|until|till) (?:the )?(?:end|finish))\b", "from start to finish"),
    (r"\b(?:right |straight )?from the (?:off|outset|get ?-? ?go|word go)\b", "from the start"),
    (rf"\b(?:through|throughout|in|during|over|for) the (?:opening|initial) (?P<d>{DURATION})",
     r"for the first \g<d>"),
    (rf" , (?:for |only |just |exactly )*(?P<d>{DURATION}) long\b", r" for \g<d>"),
    (rf"^at (?P<a>{POINT}) (?:can |could |should |let |please |, )*(?P<x>(?:the|my) .+? (?:spin|turn|rotate|move|roll|"
     rf"slide|go)s?\b.*?)(?: ,)? and (?:then )?(?:finish|end|be finished|be done)(?:es|s)? (?:at|by) (?P<b>{POINT})$",
     lambda m: f"let {m['x']}{from_to(m)}"),
    (rf"^(?:make |turn |paint |colou?r |let )?(?P<x>(?:the |my )?[a-z]+(?: [a-z]+)??) (?:to |into |go )?(?P<c>{COLOR}) "
     rf"at (?P<a>{POINT})(?: ,| and| then)+ (?:it |goes |go )*back to (?:its|the|his|her) (?:own |normal |usual |old |"
     rf"first |original |former )+(?:colou?r |self |look |one )?(?:again )?at (?P<b>{POINT})$", colored),
    (rf"^(?P<c>(?:when|once|as soon as) .+?)(?: ,)? (?P<x>(?:the|my) [a-z]+(?: [a-z]+)?) (?:should|must|can|is to|has "
     r"to) (?:vanish|disappear|be hidden|go away|be gone)(?: ,| and| then)+ (?:return|come back|reappear|be back)s?"
     rf"(?: only)? (?:at|when|once) (?P<b>{POINT}|.+)$", lambda m: f"{m['c']} , hide {m['x']} until {m['b']}"),
    (rf"\b(?:rest|wait|stay|stand|sit)(?P<s>s?) (?:by|at|beside|near|next to|on) (?:the|its) [a-z]+ (?=for "
     rf"{DURATION} before (?:it|he|she) )", r"wait\g<s> "),
    (rf"(?P<t>\bat {POINT})(?: ,)? (?:(?:a little|a bit|somewhat|slightly|a touch) )?(?:later|earlier|"
     r"sooner)$", r"\g<t>"),
    (r"\bopen (?:full|entirely|in full)(?= ?(?:,|$))", "fully open"),
    (r"\b(?P<n>\d+) ?(?:st|nd|rd|th) second\b", r"\g<n> seconds"),
    (r"\bfor the (?:period|time|while|stretch) (?:that |when |in which )?(?=(?:it|he|she|the [a-z]+(?: [a-z]+)?) (?:is|"
     r"stays|moves|rolls|walks|falls)\b)", "while "),
    (r"\bafter (?P<x>it|he|she|(?:the|my) [a-z]+(?: [a-z]+)??) (?:has|have|is|'s) (?:been|stood|stayed) (?:fully "
     rf")?(?:open|out) for (?P<d>{DURATION})", r"\g<d> after \g<x> is fully open"),
    (r"\bfor (?:a|one|the first|the) sec(?:ond)? (?:right )?at the (?:very )?(?:start|beginning)\b",
     "for the first second"),
    (r"\b(?P<v>fall|falls|drop|drops|roll|rolls|walk|walks|tumble|tumbles|jump|jumps|hop|hops|come down|comes down) (?:"
     r"a second time|one "
     r"more time|another time|once again|again(?= (?:at|from|when|once|as soon as|after) )) ", r"\g<v> once more "),
    (rf"\bwhen (?:it|the (?:clock|film|time|video|clip)|time) (?:gets|comes|reaches)(?: to| up to)? (?P<d>{POINT})",
     r"at \g<d>"),
    (rf" , (?:and )?(?:please )?takes? (?:about |maybe |around )?(?P<d>{DURATION})(?: for (?:it|that)| over it| "
     r"maybe| or so)*$", r" in \g<d>"),
    (r"\b(?:right away |immediately |directly |straight away |just )?(?:when|as soon as|once) the (?:film|clip|video|"
     r"movie|scene|shot|animation) (?:begins|starts|opens)\b", "at the start"),
    (r"\bfrom the (?:very )?first (?:moment|second|frame|instant)? ?(?:on )?(?:to|until|till) the (?:very )?last(?: "
     r"(?:one|moment|second|frame|instant))?\b", "from start to finish"),
    (r"\bjust (?=when\b|as\b)", ""),
    (r"\bat the (?:spot|place|point) where (?:it|he|she) (?:turns|changes direction)\b", "when it turns"),
    (rf"^(?P<np>(?:the |my )?[a-z ]+?) (?:(?:need|needs|should|must|may|has) )?(?:to )?(?:only )?(?:{PLAIN}|{S}) "
     r"(?:only )?(?:as far as|up to|until|to) the (?:point|spot|place) where (?:it|he|she) turns\b",
     r"\g<np> should stop when it turns"),
    (r"\b(?P<l>(?:let|make|have) (?:it|him|her|them|(?:the|my) [a-z ]+?) )(?:stand|wait|stay|rest|hang)(?: open| there|"
     r" out)? (?:a bit|a while|a little|a little while|a moment|for a bit|for a while|for a moment)(?: ,)? and (?:then "
     rf")?(?P<v>(?:at|after|from) |start |{PLAIN} )",
     lambda m: m["v"] if m["v"] in ("at ", "after ", "from ") else m["l"] + m["v"]),
    (r"\b(?P<w>start(?:s|ing)? closing) (?:(?:a bit|a little|much|far) )?(?:sooner|earlier|later)(?: ,)? (?=(?:right "
     r"|exactly |already )?(?:at|from) )", r"\g<w> "),
    (r"\bmid ?-? ?(?:fall|air|flight|swing|walk|roll|way|turn)\b(?! (?:between|up|down|through))", "halfway"),
    (r"(?: ,)? (?:and )?(?:then )?let (?:gravity|physics|nature) (?:win|take over|take its course|do its "
     r"(?:work|job|thing)|finish (?:it|the job))$", ""),
    (r"^(?P<x>(?:hide|paint|make|turn|stop|freeze) .+? from [a-z0-9. ]+? (?:to|until|till) [a-z0-9. ]+?)(?: ,)? "
     r"(?:and )?(?:then )?(?:bring|put|give|get) (?:it|him|her|them) back(?: (?:after(?:wards?)?|then|again|after "
     r"that))?$",
     r"\g<x>"),
    (rf"(?:^|(?<=[.,;] ))(?:let |make |have )?(?P<np>(?:the |my )?[a-z ]+?) waits? (?:until|till|untill) (?P<d>{POINT})"
     r" before (?:it |he |she )?(?:starts? |begins? )?(?:to )?(?:(?:(?:slid(?:es?|ing)|swing(?:s|ing)?|go(?:es|ing)?|"
     r"mov(?:es?|ing)|com(?:es?|ing)) (?:back in|shut|in|closed|back))|clos(?:es?|ing)|shut(?:s|ting)?)(?: again)?$",
     r"close \g<np> at \g<d>"),
    (rf"\b(?P<w>waits?) (?:until|till|untill) (?P<d>{POINT}) before (?:it|he|she|they) (?:{S}|{PLAIN}|starts?|"
     r"begins?)\b", r"\g<w> until \g<d>"),
    (rf"\b(?P<v>starts?|begins?) (?:at|after|from) (?P<a>{POINT}) and (?:then )?(?:work|run|turn|go|last|spin|move|"
     rf"keep going)s? (?:until|till|to|up to) (?P<b>{POINT})", lambda m: f"{m['v']}{from_to(m)}"),
    (r"\b(?P<v>(?:freez|stop|paus|halt)(?:es?|s|ing)? .+?) , (?:and )?(?:then )?(?:hold|wait|pause|stay|rest)s?(?: "
     rf"(?:it|him|her|there|still|for))* (?P<d>{DURATION})", r"\g<v> for \g<d>"),
    (r"\b(?P<w>start|begin)(?P<s>s|ing|ning)? (?:to )?(?:slid(?:e|ing)|swing(?:ing)?|go(?:ing)?|mov(?:e|ing)|com(?:e|"
     r"ing)|roll(?:ing)?) (?:shut|closed|back in|in|back)\b(?: again)?", r"\g<w>\g<s> closing"),
    (r"\b(?P<w>starts?|begins?|starting|beginning) (?:to )?(?:close|shut)(?: again)?(?= |$)", r"\g<w> closing"),
    (r"(?: ,)? (?:only|just) (?:in|for|during|at) (?:this|that) (?:moment|time|part|bit)\b", ""),
    (r"^(?P<x>do not let .+? [a-z]+) (?:, |and )+(?:just |simply )*(?:keep|leave|let) (?:it|them|him|her)(?: stay| "
     r"be)? (?:up|down|over|right|there|where|on|in|at)\b[a-z ]*$", r"\g<x>"),
    (r"\b(?:in|during|for|over|within) the (?:time|period|interval|window|span|stretch)(?: of time)? (?=(?:from|"
     r"between) )", ""),
    (r"\b(?P<w>until|till|til|to) the (?:final|finale|finish|close|curtain|credits|last frame|fade ?out|very end)"
     r"\b(?! of (?:the|its) [a-z]*[^a-z])", r"\g<w> the end"),
    (r"\b(?:right |straight |all the way |on |up |right up )+(?:to|until|till) the (?:very )?end\b", "until the end"),
    (rf"\b(?P<v>keep|keeps|go on|goes on|continue|carry on|stay) (?P<x>.*?{ING}) to the (?:very )?end\b",
     r"\g<v> \g<x> until the end"),
    (r"\b(?:spread|stretched|drawn|spread out|drawn out|stretched out) over (?=[a-z0-9])", "over "),
    (r"\b(?:at (?:the|his|her|its) corner|(?:at|in) (?:the|his|her|its) (?:turning point|turning|turn|bend|curve))\b",
     "when it turns"),
    (r"(?: ,)?(?: and| then| only)* before (?:(?:it|he|she) )?(?:is )?(?:go(?:es|ing)|carr(?:ies|ying)|mov(?:es|ing)|"
     r"walk(?:s|ing)|roll(?:s|ing)|continu(?:es|ing)|proceed(?:s|ing)|head(?:s|ing)|driv(?:es|ing)) ?(?:on|onwards?|"
     r"off)?(?: (?:to|toward|towards|into) (?:the|its) [a-z]+)?$", ""),
    (r"(?: ,)? (?:and|but)? ?(?:it |he |she )?(?:(?:must|should|has to|shall|can) )?(?:stays?|remains?|keeps?|is "
     r"left) (?:so|that way|like that|there|still|gone|hidden|put|where it is)(?: (?:until|till|to) the (?:very "
     r")?end(?: of [a-z ]+)?)$", ""),
    (r"(?: ,)? (?:and |but )?(?:leave|keep|let) (?:it|him|her|them) (?:so|that way|like that|as it is)$", ""),
    (rf" , (?P<d>{DURATION}) for (?:it|that|this|the {EVENT}|the whole thing)$", r" in \g<d>"),
    (rf"\b(?:take|takes|use|uses|need|needs|spend) (?P<d>{DURATION}) (?P<v>coming|going|sliding|moving|rolling|"
     r"swinging) (?P<x>out|in|open|shut|closed)(?: again)?$", lambda m: f"{plain_of(m['v'])} {m['x']} in {m['d']}"),
    (rf"(?: ,)? (?:and )?give (?:it|him|her|them) (?P<d>{DURATION}) (?:to|for) (?:get there|do (?:it|so|that)|it|"
     r"that|arrive|go|move)$", r" in \g<d>"),
    (r"(?: ,)? (?:and |then |after that |afterwards )+(?:it |turn it |go |goes )*back to (?:the |its )?(?:[a-z]+)(?: "
     r"one| colou?r| again)?$", " and then back to normal"),
    (rf"\b(?P<w>until|till|at|from|after) (?P<d>{DURATION}) in(?:to it)?(?= ?(?:[,.]|and\b|then\b|until\b|till\b|"
     r"to\b|$))", r"\g<w> \g<d>"),
    (r"\b(?P<v>(?:freez|stop|paus|halt)(?:es?|s|ing)?)(?: dead)? in (?:mid ?-? ?(?:air|flight|swing|step|fall|turn)|"
     r"its tracks|place)\b", r"\g<v>"),
    (r"(?: ,| and)+(?: it| he| she)? (?:holds?|hangs?|waits?|rests?|stands?)(?: (?:there|still|motionless|frozen|"
     rf"like that|in place|in mid-air))+ (?:for )?(?:exactly |just )?(?P<d>{DURATION})", r" for \g<d>"),
    (r"(?: ,)?(?: and| but)?(?: only)?(?: then| after (?:that|this)| afterwards)*(?: it| he| she)? (?:continues?|"
     rf"carr(?:y|ies) on|goes on|resumes?|proceeds?|keeps? on)(?: (?:to )?(?:{PLAIN}|{ING}))?(?: on)?(?: (?:with "
     rf")?(?:its|the) (?:way|journey|path|{EVENT}))?(?: ,)? (?:until|till|to|up to|as far as) (?:the|its) [a-z]+$",
     " and then it carries on"),
    (r"\b(?P<v>leave|keep|hold) (?P<x>the [a-z ]+?) (?:(?:up|down|over) )?there(?: (?:up |over )?(?:on|in|at) the "
     r"[a-z]+(?: [a-z]+)?)?(?= ?(?:[,.]|$))", r"do not let \g<x> move"),
    (r"\b(?P<w>stays?|remains?) where (?P<it>it|he|she) is(?: (?:up|down|over))? (?:on|in|at) the [a-z]+(?: "
     r"[a-z]+)??(?= (?:while|and|but|until|when|,|[.])|$)", r"\g<w> where \g<it> is"),
    (r"\b(?P<w>until|till|from|at|after|before) (?:exactly |just )?the (?:very |exact )?(?:moment|point|instant|time)"
     r"(?: (?:when|that|where|in which|at which))? (?=(?:the|my|it|he|she|they|all|both) )",
     lambda m: {"at": "when", "from": "once", "after": "after"}.get(m["w"], m["w"]) + " "),
    (rf"(?P<d>{DURATION}) (?:sharp|exactly|precisely|on the dot)(?= ?(?:[,.]|$))", r"\g<d>"),
    (r"^(?P<x>.+?) (?:vanish|disappear|hide|go away|be gone|be hidden|be invisible)(?:s|es)?(?: at| from)? (?:at |"
     rf"from )?(?P<a>{POINT}) (?:, |and |then )+(?:it |he |she )?(?:to )?(?:comes?|is|be|reappears?|appears?|"
     rf"returns?|shows?)(?: (?:back|again|there|up|visible))* (?:at|from) (?P<b>{POINT})$", gone),
    (rf"^(?P<x>(?:the |my )?[a-z ]+?) (?:goes|turns|becomes|is|should (?:be|turn|go|become)) (?P<c>{COLOR}) at "
     rf"(?P<a>{POINT}) (?:, |and |then )+(?:it |turns |goes |is )*(?:back(?: to (?:{COLOR}|normal|its own "
     rf"colou?r))?|{COLOR} again|normal(?: again)?) at (?P<b>{POINT})$", colored),
    (rf"(?: ,)? and (?:this|that|the|its|the whole) (?:whole )?{EVENT} (?:(?:should|must|has to|is to|shall|to) "
     rf")?(?:take|last|takes|lasts) (?P<d>{DURATION})", r" in \g<d>"),
    (rf"(?:^|(?<=[.!?;] ))(?:start|begin) (?P<v>{ING}) (?P<x>it|the [a-z ]+?) (?:at|from) (?P<a>{POINT}) (?:, |and |"
     r"please |then )+(?:have it |be |finish |end |it should be |it must be |let it be )(?:(?:fully|completely|all "
     rf"the way|quite) )?(?:shut|closed|open|done|there|finished)? ?(?:by|at) (?P<b>{POINT})$",
     lambda m: f"{plain_of(m['v'])} {m['x']}{from_to(m)}"),
    (rf"(?: ,)? {SETS_OFF} (?:at|from) (?P<a>{POINT})(?: ,)?(?: and)? {IS_THERE} (?:at|by) (?P<b>{POINT})$", from_to),
    (r"\bfor (?:a|one) (?:sec|second|moment|bit)(?: ,)? (?=(?:from|between) )", ""),
    (r"(?<=\d) already$", ""),
    (r"\b(?:right|just|shortly|immediately|directly|straight) (?=(?:before|after|when|once) (?:the|it|he|she|they|"
     r"all) )", ""),
    (r"\b(?:during|in|for) (?:all )?the (?:whole )?time (?:in which|during which|when|that|while)\b", "while"),
    (rf"^(?P<x>(?:the )?[a-z ]+?) (?:is |are )?(?:starts?|begins?|starting|{S})(?: [a-z]+){{0,2}} (?:too )?(?:early|"
     rf"late|soon) ,(?: please)? (?:let it |have it |make it |it should )?(?:start|begin|{PLAIN})(?: it)? at "
     rf"(?P<d>{POINT})$", lambda m: f"start the {re.sub('^the ', '', m['x'])} at {m['d']}"),
    (r"^(?:(?:move|push|shift|set|put|change|bring|pull)(?: forward| back)? )?the (?:start|beginning|onset) (?:of|"
     rf"for) (?P<x>(?:the |my )?[a-z ]+?)(?: 's)? (?:(?:should|must|shall) be )?(?:(?:to|at|is) )?(?P<d>{DURATION})"
     r"(?: mark)?$", r"start the \g<x> at \g<d>"),
    (rf"^start of (?P<x>[a-z ]+?)(?: :)?(?: to| at)? (?P<d>{DURATION})$", r"start the \g<x> at \g<d>"),
    (r"^start the the ", "start the "),
    (r"\b(?<!the )(?<!final )(?<!its )(?<!his )(?<!her )(?<!'s )(?<!these )(?<!those )lasts? (?:only |just |for )*"
     rf"(?P<d>{DURATION})$", r"take \g<d>"),
    (rf"^(?P<x>.+?) (?:be|being|to be) the (?P<r>last|first)(?: one| thing| of them)? to (?P<v>{PLAIN})\b(?P<y>.*)$",
     lambda m: f"let {unwished(m['x'])} {m['v']} {m['r']}{m['y']}"),
    (r"^(?P<before>.+?)(?: (?P<how>more (?:gently|slowly)|slower|faster))?(?: ,)? (?:beginning|starting|setting off)"
     rf" (?:only )?(?:at|from) (?P<a>{POINT}) and (?:only )?(?:being|ending|finishing|stopping|coming to rest|done)"
     r"(?: (?:fully|completely|all the way|wide|open|closed|shut|done|there|finished|only|just))* (?:at|by) "
     rf"(?P<b>{POINT})$", between),
    (r"(?: ,)? but (?:no|not any) longer(?: than that)?$| , and only then(?= ,)", ""),
    (rf"^(?:let|have|make) (?P<np>(?:the|my|our) [a-z ]+?) wait (?:for )?(?P<d>{DURATION}) before {IT} {BEGIN}$",
     r"keep \g<np> still for the first \g<d>"),
    (rf"(?P<b>^|(?<!until)(?<!till)(?<!from)(?<!between)(?<!by) )(?:at )?(?P<d>{DURATION}) before the (?:very )?end\b",
     r"\g<b>for the last \g<d>"),
    (rf"(?P<b>^|{NO_LENGTH} )(?:at )?(?P<d>{DURATION}) after (?=(?:the|my|our|all|both|it|he|she|they) )",
     lambda m: f"{m['b']}after {re.sub(r'(half )?an? (?=second)', counted, m['d'])} after "),
    (rf"^only after (?P<d>{DURATION}) (?:should|must|may|shall|can) (?P<x>.+)$", r"\g<x> at \g<d>"),
    (r"^only (?P<w>(?:when|once|after) (?:the|it|my|both|all) .+?) (?:should|must|may|shall|can) (?P<x>.+)$",
     r"let \g<x> \g<w>"),
    (r"\b(?P<w>first|last|final) second and a half\b", r"\g<w> one and a half seconds"),
    (r"\bfor (?:just|only) the (?=first|last|final)", "for the "),
    (r"^might (?=(?:the|my|our|this|that|all|every|it) )", ""),
    (rf"^not (?:before|until) (?P<d>{POINT}) (?:should|must|may|shall|can) (?P<x>.+)$", r"\g<x> at \g<d>"),
    (rf"(?: ,)? (?:but |and |though )?not (?:before|earlier than|sooner than|until) (?P<d>{DURATION})$", r" at \g<d>"),
    (rf"\b(?P<e>{EVENT})(?P<aux>(?: (?:to|should|must|shall))?) lasts? (?P<d>{DURATION})$",
     r"\g<e>\g<aux> be over \g<d>"),
    (rf"\b(?P<d>{DURATION}) of (?:stillness|standing still|rest|resting|waiting|doing nothing|quiet|silence)\b",
     r"\g<d>"),
    (rf"\b(?P<w>until|till|after|once|when) (?P<d>{DURATION}) (?:has|have|is|are) (?:gone(?: by)?|passed(?: by)?|"
     r"elapsed|over|up)\b", lambda m: f"{'after' if m['w'] in ('once', 'when') else m['w']} {m['d']}"),
    (rf"\bfor the first (?P<d>{DURATION}|second) (?:before|and (?:only )?then|until) {IT} {BEGIN}(?: (?:to "
     rf")?(?:{PLAIN}|{ING}))?$", r"for the first \g<d>"),
    (r"\b(?:right |straight |on )?through (?:to|until|till) the (?:very )?end\b", "until the end"),
    (r"\bat (?:exactly |just )?(?:the same|one and the same) (?:moment|instant)\b(?! (?:as|when)\b)",
     "at the same time"),
    (r"(?: ,)? (?:and )?(?:arriving|finishing|ending|landing|getting there|being there|coming to rest|done|finished)"
     rf" (?:right |just |exactly |back )?(?:at|by|on) (?P<b>{POINT}|the (?:very )?end(?: of the [a-z]+)?)$",
     r" until \g<b>"),
)  # fmt: skip
