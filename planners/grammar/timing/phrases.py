"""What people write about time and motion, as patterns: which instructions may be about it, the same in words that the
readers know, and what goes without saying."""

from __future__ import annotations

from collections.abc import Callable

from ....gaussians import late_re as re
from ..tagging.words import bag
from .clauses import AUXILIARIES
from .manner import MOTION
from .verbs import any_of

TIME_WORDS = re.compile(
    r"\b(?:\d+ ?s|secs?|seconds?|t ?= ?\d|while|whilst|until|till?|untill|when|whenever|once|after|before|as soon "
    r"as|as "
    r"long as|the moment|during|still|motion|movement|rpm|revs?|fast|slow|fast(?:er)?|slower|pause|quicker|"
    r"backwards?|later|"
    r"earlier|"
    r"sooner|slowly|gradually|halfway|way back|(?:half|double) speed|(?:whole|entire|full|complete) (?:time|clip|"
    r"film|video|scene|shot|movie|thing)|(?:middle|half) of the (?:film|clip|video|movie|shot|scene)|half as far|"
    r"\d ?ms|"
    r"on the [a-z]+ [a-z]+ing|"
    r"all the time|way through|pace|tempo|always|permanently|throughout|"
    r"forever|other way|crazy|let|last|beginning|clip|do|does|doing|from \d\S* (?:to|until|till)|between \d|direction|"
    r"speed|moving|moves|that move|not|never|out|back|quick(?:er|ly)?|twice|as fast|"
    r"(?:leave|keep) (?:the|my) [a-z ]+ up (?:there|on|in))\b"
)
TIMELY = (
    *(m for m in MOTION if m != "move"),
    *("stop", "prevent", "stay", "start", "continue", "faster", "slower", "double", "triple", "halve", "reverse"),
    *("delay", "advance", "play", "fade", "off", "on", "hide", "show"),
    *("tip", "orbit", "follow", "repeat", "blink", "cross"),
)
JOINT = r"(?: ,)*(?: (?:and|then|and then|after(?: that|wards)?|but|finally|or)(?: ,)*)+ "
NORMAL = (
    r"(?:normal|how it was|as (?:it was|before|usual)|(?:its |the )?(?:original|old|usual|own|first|previous) "
    r"(?:colou?r|"
    r"look|state|one)|what it was|before)"
)
REMARKS = re.compile(  # what goes without saying behind a time: "..., then back to normal", "..., and stays there"
    rf"(?:{JOINT}(?:(?:it |then |the rest |everything |let it |to )*(?:carr(?:y|ies) on|continues?|goes? on|"
    rf"resumes?|keeps? "
    rf"going|moves? on)(?: as (?:before|usual|normal))?|(?:(?:it|he|she|they|turns?|make|goes?|changes?|"
    rf"switch(?:es)?|returns?|"
    rf"bring|let|put|have) )*(?:back|return|again)+ (?:to )?{NORMAL}(?: again| afterwards| after that)?|back(?: "
    rf"again)?|"
    rf"(?:(?:bring|put|show|get|have|let) (?:it|him|her|them) )+(?:come )?(?:back|again|in again|return|reappear)"
    rf"(?: (?:again|afterwards?|after that|later|then|on))*|(?:show|reveal|unhide) (?:it|him|her|them)|"
    rf"(?:it )?(?:comes?|reappears?|appears?|returns?|shows?)(?: back| again| up)*|normal(?: "
    rf"again)?|"
    rf"(?:it |to |let it |i want it )*(?:stays?|remains?|holds?|keeps?|hold|keep|leave|stand|rest|lies?|waits?|"
    rf"stops?)(?: "
    rf"(?:it|there|red|blue|green|yellow|white|black|pink|purple|orange|gone|hidden|invisible|him|her|them|up|off|"
    rf"out|down|where|is|are|"
    rf"still|so|open|shut|closed|like that|that way|in place|put|there for good|that))*|"
    rf"(?:keep|let|have) (?:it|him|her|them) {any_of(MOTION, 'ing')}(?: (?:at|with) the (?:same|usual|normal) "
    rf"(?:speed|pace|rate))?(?: on)?|(?:it |to |let it )*{any_of(MOTION, 'plain', 's')} (?:further|farther|along|"
    rf"onwards?|on again)|"
    rf"(?:only (?:then|afterwards) )?(?:(?:let it |let him |let her |it )?(?:opens?|goes?|moves?|rolls?|walks?|drives?|"
    rf"falls?|spins?|turns?|runs?)(?: on)?|(?:let it |it )?(?:starts?|begins?) (?:to )?"
    rf"{any_of(MOTION, 'plain', 'ing')})|"
    rf"(?:down|up|on|off|away|round) (?:it|he|she) goes(?: again)?|"
    rf"(?:(?:i|we|you|nobody|no one) )?(?:(?:do|does|will|should|must|can) )?(?:not|never) (?:ever )?(?:sees?|"
    rf"be seen|shows?|comes?|returns?|reappears?|appears?)(?: (?:it|him|her|them))?"
    rf"(?: (?:back|again|any ?more|ever|after that|later|up))*|"
    rf"(?:then )?(?:start|open|move|release|launch|restart) (?:it|him|her|them)(?: again| up)?|"
    rf"not (?:close|open|shut|move|fall|go|start)(?: again| any ?more)?|"
    rf"(?:(?:it|he|she|they) )?(?:(?:should|must|may|shall|does|do|will|can) )?(?:not|never)(?: ever)? "
    rf"{any_of(MOTION, 'plain')}(?: back| again| in| out| down| any ?more)*)"
    rf"|(?: ,)+ (?:and )?(?:not|instead of) (?:to )?{any_of(MOTION, 'plain', 'ing')}\b[^,]*"
    rf"|(?: ,)+ (?:(?:and |it )?(?:is |stays? |stand |be |keep it )?(?:still|stopped|not moving|at rest) "
    rf"(?:before(?: that)?|"
    rf"until then)|otherwise (?:as (?:it )?is|unchanged|normal|as (?:usual|before))|"
    rf"if you (?:would|can|could|please|like)|back to [a-z ]+? when (?:it|the \w+) \w+(?: it)?)"
    rf"|(?: ,)? (?:so (?:that )?|because |as )(?:i|we|you|one|people) (?!take|last).+)$"
)
BACK_WHEN = re.compile(
    r" ?,? ?(?:(?:and|then|and then|but) )*(?:(?:it |turns? |goes? |turn it |change it )*(?:back|again)(?: to "
    r"[a-z ]+?)?|"
    r"normal(?: again)?|off(?: again)?) (?:when|once|as soon as|after) (?:it|the \w+|that|this) (?:leaves?|stops?|"
    r"is off|has "
    r"left|is gone|ends?|does not|is past|has passed|moves? on|rolls? off)(?: it)?$"
)
GOES_BACK_WHEN = re.compile(r"\b(?:back|normal|again|returns?|reverts?)\b.*\b(?:once|when|as soon as|until|till) \w+")
NOISE = re.compile(
    r"(?:^| )(?:lol|haha|pls|plz|please|thanks|thank you|dear|mate|ok|okay|you know|cheers|kindly|if you can|if "
    r"possible|"
    r"can u|could u|would u|u|hmm+|um+|uh|er|btw|"
    r"would you mind|would you|could you|honey|bro|dude|hey|hi|voila|ta da|tada|presto|bam|boom|whoosh)(?= |$)|"
    r"(?<= [,.]) done(?= ?[,.!]|$)"
)
STAYS_SEEN = re.compile(  # what is not hidden; "until" and "after" tell when it is
    r"\b(?:should|must|may|shall|can|does|do) not (?:disappear|vanish|be hidden|be removed|be deleted)\b"
    r"(?!.*\b(?:until|till|before|after|from)\b)"
)
RANGE = re.compile(  # "2s-3s", "from 0-1"
    r"(?:from )?(?P<a>\d+(?:\.\d+)?) ?(?:s|secs?)? ?[-–] ?(?P<b>\d+(?:\.\d+)?) ?(?:s|secs?|seconds)\b|"
    r"from (?P<c>\d+(?:\.\d+)?) ?[-–] ?(?P<d>\d+(?:\.\d+)?)\b"
)
RANKS = {"first": 1, "second": 2, "third": 3, "fourth": 4, "fifth": 5}
RESTATED: tuple[tuple[re.Pattern[str], str | Callable[[re.Match[str]], str]], ...] = tuple(
    # what people write, and the same in words that the readers know
    (re.compile(pattern), plain)
    for pattern, plain in (
        (
            r"^(?:stop|halt|freeze|park) (?P<np>.+?) (?:after|at) (?:(?:it|he|she) has (?:gone|rolled|moved|walked) )?"
            r"(?P<far>(?:\d+(?:\.\d+)?|half an?|an?|one|two|three|four|five|ten|twenty|thirty|forty|fifty) ?"
            r"(?:m|cm|met(?:re|er)s?|centimet(?:re|er)s?))$",
            r"let \g<np> only move \g<far>",
        ),
        (r"(?<=\d) ?= ?", " "), (r"(?: [.!?])+$", ""), (r" ?[!?] ?", " . "), (r"^(?P<x>[\w'.= ]+?) : ", r"\g<x> "),
        (r"\bits (?=(?:fully|completely|wide|all the way|halfway|on|in|under|at|near|next|behind|still|not|over|off|"
         r"open|closed|\w+ing)\b)", "it is "),
        (r"\b(?P<w>after|before) (?=\w+ing\b)(?!(?:after|before) (?:being|having|everything|anything|nothing|something|"
         r"evening|morning|spring|ceiling|painting)\b)", r"\g<w> it is "),
        (r"\b(?P<w>while|when|once|until|whenever|as long as) (?=(?:on|in|under|touching|still|standing still|open|"
         r"closed|"
         r"moving|(?!the|every|any|nothing|some)\w+ing)\b(?! (?:is|has|starts|stops)))", r"\g<w> it is "),
        (r"\bsince (?P<a>[\d.]+)(?P<s> (?:seconds?|secs?|s))? until\b", r"from \g<a> until"),
        (r"\b(?:between|from) seconds? (?P<a>[\d.]+) (?:and|to|until|till) (?P<b>[\d.]+)\b", r"from \g<a> to \g<b> "
            r"seconds"),
        (r"\bbetween the (?P<a>first|second|third|fourth|fifth) and (?:the )?(?P<b>first|second|third|fourth|fifth) "
         r"second\b",
         lambda m: f"from {RANKS[m['a']]} to {RANKS[m['b']]} seconds"),
        (r"^(?:it (?:would|might) be (?:nice|great|good|lovely|cool) if|i (?:would )?(?:love|like) it if|i would "
         r"like to see|"
         r"i want to see|how about|what about) ", ""),
        (r"^slow ?motion (?:on|for) (?P<x>.+?)(?: ,? (?P<f>half|quarter|third) speed)?$", r"play \g<x> at \g<f> speed"),
        (r"\b(?P<w>visible|shown|seen|there) only (?=while|when|from|after|between)", r"\g<w> "),
        (r"\b(?P<w>stop|start|freeze|pause|open|close)(?P<x> .+?)? (?:earlier|sooner|later) ,? "
         r"?(?=at\b)", r"\g<w>\g<x> "),
        (r"\b(?:one|1) time in\b", "once in"),
        (r"\bto (?:the|its) right\b(?! of)", "rightwards"),  # "right" at an end is politeness
        (r"\b(?P<a>as|so) (?:quickly|rapidly)\b", r"\g<a> fast"), (r"\b(?P<a>as|so) slowly\b", r"\g<a> slow"),
        (r"\bmore (?:quickly|rapidly)\b", "faster"), (r"\bmore slowly\b", "slower"),
        (r"(?<= 's) colou?r(?= (?!to\b)\w)(?: is| should be| shall be)?", ""), (r"(?<=\w) 's (?=(?:in )?(?:red|blue|"
            r"green|yellow|white|"
         r"black|brown|pink|purple|orange|gr[ae]y|gold|silver)\b)", " "),
        (r"\b(?P<w>at|until|till|from|after|before) the (?P<a>first|second|third|fourth|fifth) second\b",
         lambda m: f"{m['w']} {RANKS[m['a']]} seconds"),
        (r"\b(?P<w>at|from|until) zero(?! s)", r"\g<w> 0 seconds"), (r"\bfor all (?=\w+ seconds?\b)", "for "),
        (r"^(?:i|we) (?:do not|would not) (?:want|like)(?: that)? (?P<x>.+?) to (?=\w)", r"do not let \g<x> "),
        (r"^(?:would|will) it be (?:possible|ok|okay|great|nice|all right) (?:to|if you|if) ?", ""),
        (r"\bsay (?=half|twice|double|\d)", ""),
        (r"\bquarter speed\b", "a quarter of the speed"), (r"\bhalf speed\b", "half the speed"),
    )
)  # fmt: skip
THINGS_ALL = (
    r"(?:whatever|what|anything|everything|any thing|every thing|all of the things|all (?:the )?(?:things|objects|"
    r"stuff)|"
    r"the "
    r"(?:things?|objects?|stuff)|things|stuff|every object|objects|all)"
)
DETERMINERS = r"(?:the|every|all|all the|any|that|this|both|each)"
MOVES = (
    rf"(?:is |are |s |still )*(?:{any_of(MOTION, 'plain', 's', 'ing')}|in motion|on the move|not standing still|"
    rf"animated|not "
    rf"static|not still)(?: around| about| down| here| there| (?:across|over|on|along|through|in|about|around) "
    rf"(?:(?:the|this|that|our|my) )?"
    rf"(?:floor|ground|room|scene|air|picture|clip|here|there))*"
)
RESTS = (
    r"(?:(?:is |are |s )?(?:standing still|stands? still|static|stationary|not moving|immobile|still|motionless|"
    r"unmoving|at "
    r"rest)|does not move|do not move|never moves?|stays? (?:still|put)|keeps? still)"
)
MOVING = tuple(  # "whatever moves", and "the books that fall"
    (re.compile(rf"\b(?:{THINGS_ALL}(?: that| which)?|(?P<np>{DETERMINERS}(?: \w+){{1,4}}?) (?:that|which|who)) "
                rf"{how}(?= |$)"), moving)
    for how, moving in ((RESTS, False), (MOVES, True))
)  # fmt: skip
PLACES = "|".join(("last", *RANKS))
NTH = re.compile(  # "the book that falls last", "the first one to move"
    rf"(?<!\w)(?:the )?(?:(?P<a>{PLACES}) )?(?P<np>[a-z]+(?: [a-z]+)??)?(?(np) |)(?:that|which|who|to)"
    rf" (?:(?P<b>first|last) )?{MOVES}(?: (?:as the )?(?P<c>{PLACES}|before (?:all )?the others|after (?:all )?the "
    rf"others)(?: of all)?)?(?= |$)"
)
MOVING_ONE = re.compile(
    rf"\b(?P<det>{DETERMINERS}) (?P<how>moving|still|static|stationary|unmoving|motionless) (?=(?P<noun>[a-z]+))"
)
ASKS = re.compile(
    r"^(?:what|where|who|why|how|which|when (?:does|do|did|is|will)|does|did|do (?:the|any|all)|is|are|was|were|has|"
    r"have "
    r"(?:the|any)|tell me)\b"
)
CONTRARY = re.compile(
    r"\b(?:spin|move|turn|roll|walk|rotate|run)s? and (?:stand|stay|be|keep)s? still\b|\bopen and closed?\b.*\bsame "
    r"time\b"
)
RIDDING = re.compile(r"^(?:delete|remove|take|get rid of|throw|put|move|erase|bin|save|catch)\b")
REMARK = re.compile(
    rf"^(?P<np>.+?) (?:is|are|looks?|seems?|starts?|feels?|{any_of(MOTION, 's', 'plain')})(?: \w+){{0,2}} (?:too|"
    r"much too|way "
    r"too|so|very|not|really|a bit) .+$|^(?:leave|keep|hold) (?P<kept>.+?) (?:up )?(?:on|in|at|under|over|by|there|"
    r"where)\b.*$"
)
# Words that no name of a thing holds, begins with, or ends with.
NEVER = AUXILIARIES - bag("s 's first simply all both") | bag(
    "let make when while until i you we instead not at by than no own"
)
NEVER_FIRST = bag(
    "to in at on of for with and or up down out off from into by as so faster slower fast slow back half stop begin , "
    "moving keep hold set please halfway between"
)
NEVER_LAST = bag(
    "to in at on of for with and or the a from into by as up down out off over back again way more much too , red blue "
    "green yellow white black purple pink orange golden later earlier last first there still speed late early open "
    "closed "
    "shut halfway want 's s wants slowly around round about away gone toward towards onto under behind every my"
)
