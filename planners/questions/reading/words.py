"""Puts a question into a plain form: lower-case words without politeness, hedges and quotation marks.

"Could you tell me, roughly, how far the sofa is from the window, please?" becomes "how far the sofa is from the
window". Marks between clauses become commas, and "in this bedroom" becomes "in the room".
"""

from __future__ import annotations

from collections.abc import Callable

from ....gaussians import late_re as re
from ....gaussians.errors import UserError
from ...grammar.tagging.words import bag, clean, split

MAX_CHARS = 1000
MAX_WORDS = 120

_MARKS = frozenset(".?!;:()[]–—")
_DASH = re.compile(r"(?<=\s)[-–—]+(?=\s)")
_THOUSANDS = re.compile(r"(?<=\d),(?=\d{3}\b)")
_OPENERS = re.compile(
    r"^(?:(?:hi|hey|hello|hiya|yo(?= (?:,|is|are|how|what|where|which|do|does|can))|hey there|dear assistant|"
    r"ok|okay|alright|so|well|um+|uh+|er+m*|hmm+|please|quick question|question|"
    r"(?:i am )?just (?:curious|wondering|checking|asking)|there (?=, )|everyone|all(?= ,)|good (?:morning|evening|"
    r"day)|"
    r"out of curiosity|one more thing|by the way|btw|fyi|and|but|also|then|now|oh|ah|right(?= ,)|sorry|excuse me|"
    r"actually|"
    r"listen|look|say(?= ,)|i say|remind me(?: again)?|again|thanks|thank you|in your opinion|"
    r"as far as you can (?:see|tell)|"
    r"judging (?:by|from) (?:the )?(?:picture|photo|scene|room|image)s?|from what you (?:can )?see|as it is(?= ,)|"
    r"(?:for|in|of) (?:the|this) (?:scene|room|picture|photo|image)(?= ,)|in (?:the|this) room(?! (?:and|or)\b)|"
    r"(?:looking|going) (?:at|by) (?:the|this) (?:room|scene|picture|photo)(?= ,)|in (?:total|all)(?= ,)|overall|"
    r"generally|"
    r"approximately|roughly|about(?= how)|around(?= how)|exactly(?= (?:how|what))|just|precisely(?= (?:how|what)))"
    r"\b(?: ,)* ?)+"
)
_YOU = r"(?:you|u|ya|someone|somebody|anyone|anybody|we|i)"
_ASKING = re.compile(
    rf"^(?:can|could|would|will|may|might) {_YOU} (?:please |kindly |maybe |possibly |quickly |just |be able to |"
    rf"help me )*"
    r"(?:tell me|tell us|say|check|work out|figure out|find out|let me know|give me|show me|name me|measure|"
    r"describe|list|"
    r"name|count|see(?= (?:if|whether|how|what|which|where))|confirm|verify|estimate|identify|tell|determine|ask)\b"
    r"(?: for me)?(?: ,)?"
    r"|^(?:please )?(?:kindly )?(?:tell me|tell us|let me know|say|check|work out|figure out|find out|measure|"
    r"confirm|verify|"
    r"estimate|determine|state|specify|identify)(?: for me)?(?= (?:what|which|how|where|who|whether|if|the|a|is|are|"
    r"there|when|why|about|,))"
    r"(?: about)?"
    r"|^(?:do|would|might|does) (?:you|anyone|anybody) (?:happen to )?(?:know|have any idea(?: of| about)?|have a "
    r"clue|"
    r"reckon|think|say|guess|remember|recall|mind (?:telling me|checking))(?: that)?\b"
    r"|^(?:have you|you have|got|have|has anyone) (?:got )?any (?:idea|clue|thoughts)(?: of| about| on)?"
    r"|^any (?:idea|clue|chance|guess|thoughts|way)(?: of| about| that| on)?(?: (?:you|i|we) (?:can|"
    r"could) (?:tell me|say|know))?"
    r"|^(?:is|would) there (?:be )?any (?:chance|way|possibility)(?: that| of)?(?: (?:you|i) (?:can|"
    r"could) (?:tell me|say|know))?"
    r"|^(?:i am|i was|we are|we were|was) (?:just )?(?:wondering|curious|interested in|curious about)(?: about|"
    r" to know)?"
    r"|^(?:i am|i was|we are|we were) trying to (?:find out|figure out|work out|see|determine|understand)"
    r"|^(?:i|we) (?:just |would |really )*(?:wonder|wonder about|want to know|need to know|like to know|"
    r"love to know|want to ask|"
    r"can not (?:tell|see)|do not know|forgot|need to find out|am not sure|do not suppose|suppose|think|believe|guess|"
    r"have a question|need|would like to find out|like to find out|have to know|must know|forget)(?: that)?"
    r"(?= (?:what|which|how|where|who|whether|if|there|that|the|is|are|we|you|when|why|,))"
    r"|^(?:i|we) (?:am|are) not (?:quite |entirely )?sure"
    r"|^(?:what i (?:want|need|would like) to know is|the question is|my question is|here is (?:a|my) question)"
    r"|^(?:would|is) (?:it|that) be (?:right|correct|fair|true) to say"
    r"|^(?:is it (?:true|right|correct|the case|a fact|so)|am i (?:right|correct))(?: (?:in|to) (?:thinking|saying|"
    r"assuming|think|say|assume))?(?: that)?"
    r"|^(?:would|could) (?:you|one) say(?: that)?"
    r"|^(?:can|could|would|will) you (?=(?:make|draw|create|build|produce|write|sort|rank|arrange|order|tabulate|"
    r"enumerate|"
    r"find|compare|provide|inventory|itemize)\b)"
    r"|^(?:it is|is it) my (?:impression|guess) that|^i would say(?: that)?|^let us see|^guess"
)
_FIRST_WORDS = bag(
    "what which where who whose when why how is are was were does do did can could has have will would should whether "
    "list name count describe measure any"
)
_KEPT = ("list", "name", "count", "describe", "measure", "show me", "give me", "name me", "see", "identify", "estimate")
_CLOSERS = re.compile(
    r"(?:(?:^| )(?:please|thanks|thank you|thank you very much|many thanks|thx|ta|cheers|for me|mate|pal|buddy|dear|"
    r"exactly|"
    r"roughly|approximately|approx|then|though|anyway|by any chance|at all|right now|at the moment|currently|"
    r"would you say|do you (?:think|reckon|know|suppose|happen to know|believe|guess)|or not|or so|i wonder|"
    r"(?:can|could) you (?:tell(?: me)?|say|check)|if you (?:had|have) to guess|in your opinion|more or less|ish|"
    r"give or take|"
    r"if you (?:do not|would not) mind|if you (?:can|could|may)(?: tell)?|if (?:i|one) may ask|if possible|in total|"
    r"all in all|all together|(?:of )?all (?:kinds|sorts|types)(?: included| counted)?|of any (?:kind|sort|type)|"
    r"altogether|in all|overall|if any|any (?:idea|clue|thoughts)|as far as you (?:know|can (?:see|tell))|actually|"
    r"exactly speaking|in particular|to be (?:exact|precise)|off the top of your head|you think|you reckon|"
    r"you (?:can )?(?:tell me|know)|i am (?:curious|asking)|just (?:curious|asking|wondering)|out of curiosity|"
    r"of interest|"
    r"ok|okay|huh|eh|innit|now|today|or what|or something))+$"
)
_AUX = r"(?:is|are|was|were|does|do|has|have|can|could|would|will|should)"
_THEM = r"(?:it|there|they|he|she|that|we|i|you)"
_TAGS = re.compile(
    rf"(?: , {_AUX} {_THEM}(?: not)?|(?: ,)? {_AUX} not {_THEM}|(?: ,)? (?:yes|yeah|correct|true or false|yes or no)|"
    r" , (?:right|no)|"
    r"(?<! my)(?<! the)(?<! your)(?<! or)(?<! to)(?<! its)(?<! hand)(?<! left)(?<! far)(?<! a)(?<! on)(?<! 's)"
    r"(?<! turn)(?<! turns)(?<!turning)(?<! turned)(?<! go)(?<! goes)(?<! move)(?<! moves)(?<! moving)(?<! roll)(?<! "
    r"rolls)"
    r"(?<! walk)(?<! walks)(?<! swing)(?<! swings)"
    r"(?<! own)(?<! front)(?<! back)(?<! rear)(?<! ahead)(?<! behind) right)$"
)
_HEDGES = re.compile(
    r"\b(?:roughly|approximately|approx|exactly|precisely|actually|currently|basically|really|just|kind of|sort of|"
    r"by any chance|perhaps|maybe|possibly|probably|simply|honestly|overall|altogether|even|roughly speaking|like ,|"
    r"more or less|at the moment|right now|please|pls|plz|kindly|the heck|on earth|bloody|damn)\b "
)
_WHETHER = re.compile(r"^(?:, )*(?:whether or not|whether|if)\b ?")
_CONTRACTED = {
    "whats": "what is", "wheres": "where is", "hows": "how is", "whos": "who is", "theres": "there is",
    "isnt": "is not", "arent": "are not", "doesnt": "does not", "thats": "that is", "whichs": "which is",
    "nite": "night", "what've": "what have",
    "im": "i am", "ive": "i have", "cant": "can not", "wasnt": "was not", "dunno": "do not know", "hasnt": "has not",
    "hasn't": "has not", "haven't": "have not", "havent": "have not", "weren't": "were not", "youre": "you are",
    "theyre": "they are", "wat": "what", "wot": "what", "wich": "which", "hw": "how", "r": "are", "ur": "your",
    "gotta": "have got to", "w/": "with", "b/w": "between", "itll": "it will", "it'll": "it will",
    "they've": "they have",
    "you've": "you have", "we've": "we have", "theyve": "they have", "youve": "you have", "there're": "there are",
    "what're": "what are", "where're": "where are", "which's": "which is", "color's": "color is",
    "when's": "when is", "why's": "why is", "somebody's": "somebody is", "everything's": "everything is",
}  # fmt: skip
_HAVE_IS = re.compile(
    r"\b(what|where|which|who|how|when|colou?r|that|there|one|anything|something|somebody|everything|it) 's\b"
)


def _comparative(found: re.Match[str]) -> str:
    """ "more tall" as "taller"."""
    word = found[1]
    doubled = word[-1] if word in ("big",) else ""
    return f"{word.removesuffix('e')}{doubled}er" if not word.endswith("y") else f"{word[:-1]}ier"


# Parts that only repeat or restrict what a question says.
_REORDERED: tuple[tuple[re.Pattern[str], str | Callable[[re.Match[str]], str]], ...] = tuple(
    (re.compile(pattern), said)
    for pattern, said in (
        (r"\bwhich hand\b", "which side"),
        (r"^how much (?=\w+(?: \w+)?(?<!s)s (?:are|have|do|can|stand|hang|lie)\b)", "how many "),
        (r"^(?:exists?|existing) (?=(?:there )?(?:a|an|any|some)\b)(?:there )?", "is there "),
        (
            r"^(?!.*\b(?:is|are|was|were|who|what|how|which|where|list|name)\b)(?:a |an |any )?"
            r"(\w+(?: \w+)?) (?:present|available)$",
            r"is there a \1",
        ),
        (r"^who is (?=(?:more )?\w+ ?,? )(?=[^?]*\bor\b)", "which is "),
        (r"\bmore (tall|high|wide|big|small|large|short|long|deep|near|close|heavy|low)\b", _comparative),
        (
            r"^(?:seen |viewed |looking )?from (?:my (?:viewpoint|point of view|side|position|spot)|(?:the spot )?"
            r"where (?:i|the viewer|the visitor) (?:look|looks|stand|stands)(?: in)?)(?: outside)? , ",
            "",
        ),
        (r",? (?:as|when) (?:i|you|we) (?:look in|see it|come in|walk in)$", ""),
        (r"\bnot (?:taken up|covered|occupied) by (?:the |any )?(?:furniture|things|stuff)\b", "free"),
        (r",? (?:(?:ignoring|not counting|leaving out) the rugs?(?: as furniture)?|leave the rugs? out of it)$", ""),
        (r"^(?:would|might|will|could) there (?:happen to )?be ", "is there "),
        (
            r"^how (?:high|tall) (is|are) (?!the room|this room)(.+?) from (?:its |the |their )?(?:bottom|base|top) "
            r"to "
            r"(?:its |the |their )?(?:top|bottom)$",
            r"how tall \1 \2",
        ),
        (r"^(how (?:tall|high) is (?:this|the) room) from (?:the )?floor to (?:the )?ceiling$", r"\1"),
        (
            r"^(?:excluding|not counting|not including|apart from|besides|except(?: for)?|other than|aside from|"
            r"ignoring|"
            r"leaving out) ([\w ]+?) , (which|what) (\w[\w ]*?) (is|are) (.+)$",
            r"\2 \3 except \1 \4 \5",
        ),
        (r" ,? ?and how \w+ (?:is|are) (?:it|they|that)$", ""),
        (
            r"^(?:i|we) (?:can )?(?:see|have|spot|notice|found) (?:some |a few |several |many )?([\w ]+?) , how many"
            r"(?: (?:are there|of them are there|exactly))?$",
            r"how many \1",
        ),
        (
            r"^there are (?:some |a few |several |many )?([\w ]+?) , how many(?: (?:are there|"
            r"exactly))?$",
            r"how many \1",
        ),
        (
            r"^(?:would|will) ((?:the|this|that|my|our) [\w ]+?) be (?=(?:any |much )?(?:\w+er|more \w+|"
            r"less \w+) than )",
            r"is \1 ",
        ),
        (
            r"^(what(?: \w+)?|which(?: \w+)?|how \w+) (?:would|do|did) you (?:say|think|reckon|guess) (?=(?:is|are|"
            r"the|has|"
            r"takes|that)\b)",
            r"\1 ",
        ),
        (
            r"^(?:i|we) (?:can|could|do) not (?:see|find|have|spot) ((?:a|an|any) [\w ]+?) ,? ?(?:is|are) there "
            r"(?:one|"
            r"any|some)"
            r"(?: here| anywhere)?$",
            r"is there \1",
        ),
        (
            r"^(how many (?:places|seats|spots|chairs)) (?:are there|do we have|can i find) (to sit.*)$",
            r"\1 \2",
        ),
        (r"^that (?=(?:the|this|there|a|an|these|those|all|both)\b)", "whether "),
        (r" , [\w ]{1,30} i mean(?: , not \w+)?(?: ,)?(?= |$)", ""),
        (
            r"^(?:counting|including|if (?:you|we) (?:count|include)|with) (?![^,]*\b(?:seconds?|secs?|s|minutes?)\b)"
            r"[\w ]+? , (?=how many )",
            "",
        ),
        (
            r"^(?:excluding|not counting|not including|apart from|besides|except(?: for)?|other than|aside from|"
            r"ignoring|leaving out) ([\w ]+?) , (.+)$",
            r"\2 except \1",
        ),
        (
            r" ,? ?(?:excluding|not counting|not including|apart from|besides|except for|other than|aside from|"
            r"ignoring|leaving out|but not(?= the )) (?=[\w ]+$)",
            " except ",
        ),
        (r"^(which|what) (\w[\w ]*?) (is|are) (the \w+est) except (.+)$", r"\1 \2 except \5 \3 \4"),
        (r"^(how many [\w ]+?) (?:are|is) (?:there|here|in the room) except ", r"\1 except "),
        (r"^(?:is|are) there (?:something|anything) ([\w ]+?) ,? ?and (?:if so ,? ?)?what(?: is it)?$", r"what is \1"),
        (
            r" ,? ?(?:and )?if (?:so|yes|there are|there is)? ?,? ?(?:what|which|where|how many)(?: (?:is|are) (?:it|"
            r"they|there))?$",
            "",
        ),
    )
)
# "Is not the sofa blue?" asks whether it is blue.
_NEGATED = re.compile(
    r"(?:(?<=^)|(?<=, ))(is|are|was|were|does|do|did|has|have|can|could|would|will) not "
    r"(?=(?:there|the|this|that|these|those|it|they|we|you|i|one|any|a|an|my|our|your|some|all|both|either|most)\b)"
)
_ROOMS = (
    "room|bedroom|living room|livingroom|sitting room|lounge|kitchen|office|study|bathroom|dining room|studio|hall|"
    "hallway|playroom|nursery|classroom|library|attic|basement|space|place|scene|picture|photo|photograph|image|house|"
    "home|flat|apartment|area|shop|cafe|workshop|garage|gym|model|view|music room|music studio|guest room|meeting room"
)
_IN_ROOM = re.compile(
    rf"\b(?:anywhere |somewhere |elsewhere |present |available |visible |located )*(?:with)?in(?:side)? (?:of )?"
    rf"(?:the|this|that|my|our|your|his|her|their)(?: whole| entire| same| current| given)? (?:{_ROOMS})\b(?! (?:'s|"
    rf"wall|door|"
    r"table|chair|lamp|sink|counter|cabinet|floor|rug|window|desk|furniture)\b)"
)
_THE_ROOM = re.compile(
    r"\b(?:the|this|that|my|our|your)(?: whole| entire)? (?:bedroom|living room|livingroom|sitting room|kitchen|"
    r"office|bathroom|"
    r"dining room|studio|playroom|nursery|classroom|place|scene|apartment|flat|house|music room|guest room|"
    r"meeting room)"
    r"(?=$| (?:,|have|has|contain|contains|include|includes|is|are|be|look|looks|with|that|from|and|or|got|does|"
    r"feel|feels|as|at|"
    r"without|before|after|when|if|measure|measures|need|needs|offer|offers|'s (?!wall|door))\b| ,)"
)
SPELT = {"colour": "color", "colours": "colors", "coloured": "colored", "grey": "gray", "centre": "center",
          "centres": "centers", "furthest": "farthest", "further": "farther", "metre": "meter", "metres": "meters",
          "colur": "color", "clour": "color", "coler": "color", "collor": "color", "hight": "height",
          "heigth": "height",
          "widht": "width", "lenght": "length", "tallist": "tallest", "bigest": "biggest"}  # fmt: skip


# "how high the ceiling is" is asked as "how high is the ceiling"
_INDIRECT = re.compile(
    r"^((?:how|what)(?: (?:much|many|big|large|high|tall|long|wide|deep|far))?) "
    r"((?:the|this|that|its|our|my) (?:(?! is | are ).)+?) (is|are)((?: in [a-z ]+)?)$"
)


def plain_words(text: str) -> tuple[str, ...]:
    """The words of a question in lower case, without politeness; marks between clauses are commas, which are words.

    British spellings of a few words become American ones ("colour", "grey", "metre", "centre", "furthest").

    Raises:
        UserError: it has more than `MAX_CHARS` characters or `MAX_WORDS` words.
    """
    if len(text) > MAX_CHARS:
        raise UserError(f"the question has {len(text)} characters, at most {MAX_CHARS} are read; ask it in parts")
    if len(text.split()) > MAX_WORDS:
        raise UserError(f"the question has {len(text.split())} words, at most {MAX_WORDS} are read; ask it in parts")
    text = _THOUSANDS.sub("", text)
    said = " ".join(_plain(w.text) for w in split(clean(_DASH.sub(",", text))))
    said = _HAVE_IS.sub(r"\1 is", said).replace(" is been ", " has been ").replace(" is got ", " has got ")
    said = _NEGATED.sub(r"\1 ", said)
    said = _THE_ROOM.sub("the room", _IN_ROOM.sub("in the room", _commas(said)))
    said = _stripped(said)
    for pattern, plain in _REORDERED:
        said = pattern.sub(plain, said)
    return tuple(said.split())


def asks(text: str) -> bool:
    """Whether a text that is no edit is a question: by its first word or its question mark."""
    words = plain_words(text)
    return bool(words) and (text.rstrip().endswith("?") or words[0] in _FIRST_WORDS)


def _plain(word: str) -> str:
    if word in _MARKS:
        return ","
    return SPELT.get(word) or _CONTRACTED.get(word, word)


def _commas(said: str) -> str:
    return re.sub(r"(?: ?,)+", " ,", f" {said} ").strip(" ,")


def _stripped(said: str) -> str:
    """The words without openers, closers, question tags and hedges, until nothing more can be taken away.

    A clause behind "tell me whether" keeps the word "whether", by which templates tell statements from questions.
    """
    before = ""
    while said != before:
        before = said
        said = _OPENERS.sub("", said).strip(" ,") or said
        said = _CLOSERS.sub("", said).strip(" ,") or said
        said = _TAGS.sub("", said).strip(" ,") or said
        said = _HEDGES.sub("", said)
        asked = _ASKING.match(said)
        if asked and asked.end() and asked.end() < len(said):
            verb = next((k for k in sorted(_KEPT, key=len, reverse=True) if asked.group().endswith(k)), "")
            rest = said[asked.end() :].strip(" ,")
            said = f"{verb} {rest}" if verb and not _CLAUSE.match(rest) else _WHETHER.sub("whether ", rest)
    return _INDIRECT.sub(r"\1 \3 \2\4", _commas(said))


_CLAUSE = re.compile(r"^(?:what|which|how|where|who|whose|whether|if|when|why|there|is|are|that)\b")
