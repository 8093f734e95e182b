"""Regular expressions for wishes, over lower-case words with single blanks between them.

Each pattern belongs to a kind of wish and captures its parts, from which parsing.py builds a goal: `things` and `goal`
are noun phrases, `middle` or `near` with `anchor` give a place, `size` a length, `people` a number, `why` a purpose.
"""

from __future__ import annotations

import re

_ROOM = (
    r"(?:the|this|my|our) (?:whole |entire )?"
    r"(?:room|living room|bedroom|kitchen|office|dining room|place|space|apartment|flat|house|cafe|lounge|study)"
)
_MIDDLE = rf"(?P<middle>middle|center|centre)(?: of {_ROOM})?"
_THINGS = r"(?P<things>(?:(?:the|my|our|all|every|each|both|these|those|any)\b ?[a-z ]*?|everything|furniture|[a-z]+s))"
_GOAL = r"(?P<goal>(?:the|my|our|this|that)\b[a-z ]+?)"
_NEAR = r"(?P<near>in front of|before|next to|beside|by|near|close to|at|around|under)"
_WHERE = rf"(?:(?:in|at|around|from) the {_MIDDLE}|{_NEAR} (?P<anchor>(?:the|my|our|a)\b[a-z ]+?))"
_PUT = (
    r"(?:push|move|shove|slide|put|place|bring|pull|drag|arrange|rearrange|set|set up|organise|organize|group|gather"
    r"|position|get|seat|shift|stand|have|assemble|align)"
)
_SPACE = (
    r"(?:(?:free|empty|open|clear|extra) )*"
    r"(?P<called>dance floor|dance area|dancing space|dancefloor|(?:floor )?(?:space|room|area)|spot|floor)"
)
_AMOUNT = r"(?:(?:some|a|an|enough|the|a bit of|a little|a lot of|lots of|more|plenty of|as much) )?"
_GRAND = r"(?:(?:big|large|wide|small|little|spacious|generous|nice) )*"
_SIZE = r"(?:(?P<size>[a-z0-9./ ]+?) (?:wide|across|large|big|in diameter|square) )?"
_MAKE = (
    r"(?:clear|clear out|clear up|make|free up|free|open up|open|create|leave|get|keep|provide|reserve|have|need|want"
    r"|i need|we need|i want|we want|i would like|we would like|give me|give us)"
)
_FREE = r"(?:clear|clear out|clear up|make|create|free|free up|open up)"
_WHY = r"(?:for|to|so|where) (?P<why>[a-z ]+?)"
_FREED = r"(?: (?:free|clear|empty|open))?"
_EVERYBODY = r"(?:everybody|everyone|all of us|we all|they all|all|we|people|they|each of them|anybody|anyone)"
_MESS = (
    rf"(?:{_ROOM}|everything|(?:this|the|my|that) mess|the furniture|things|all|all the furniture|all of it|it|here)"
)
_NEAT = r"(?:tidy|neat|orderly|neat and tidy|tidier|neater)"
_FOR = r"(?: for (?:a |the |our |my )?(?:dinner|lunch|breakfast|supper|tea|brunch|a meal|coffee))?"
_PEOPLE = r"(?: for (?P<people>[a-z0-9]+)(?: (?:people|persons|guests|of us|friends))?)?"
_EVEN = r"(?:even|evenly|symmetrical|symmetric|symmetrically|balanced)"
_FACING = rf"(?: (?:facing|around|that faces|so that they face|looking at|in front of) {_GOAL})?"

PATTERNS: dict[str, tuple[str, ...]] = {
    "clear": (
        rf"{_MAKE} {_AMOUNT}{_SIZE}{_GRAND}{_SPACE}{_FREED} {_WHERE}(?: {_WHY})?",
        rf"{_MAKE} {_AMOUNT}{_SIZE}{_GRAND}{_SPACE}{_FREED} {_WHY}(?: {_WHERE})?",
        rf"(?:clear|clear out|clear up|empty|free|free up|open up|vacate) the {_MIDDLE}",
        rf"(?:keep|leave|make) the {_MIDDLE} (?:free|clear|empty|open)",
        rf"{_FREE} (?:(?:some|more|enough|plenty of|a bit of|a little|a lot of|lots of) )?"
        r"(?:(?:free|empty|open|clear|extra|more|floor) )*(?:space|room)",
        r"(?:clear|free|free up|open up) the floor",
    ),
    "walls": (
        rf"{_PUT} {_THINGS} (?:back )?(?:to|against|along|up against|at|around|over to|out to"
        rf"|towards?) (?:all )?(?:the )?"
        rf"(?:walls|wall|sides|edges|edge|perimeter|periphery)(?: of {_ROOM})?",
        rf"line (?:the walls|{_ROOM}) with {_THINGS}",
        rf"line {_THINGS} up (?:along|against) the (?:wall|walls)",
    ),
    "circle": (
        rf"{_PUT} {_THINGS} (?:in|into|to form|so they form|as|to make) (?:a|one) (?:big |large |small |wide |round )?"
        rf"(?:circle|ring|round)(?: {_WHERE})?{_FACING}",
        rf"(?:form|make|create|build) (?:a|one) (?:big |large |small |wide )?(?:circle|ring) (?:with"
        rf"|of|from|out of|using) "
        rf"{_THINGS}(?: {_WHERE})?",
    ),
    "arc": (
        rf"{_PUT} {_THINGS} (?:in|into|to form|as|to make) (?:a|one) (?:semicircle|semi circle"
        rf"|half circle|arc|horseshoe|u)"
        rf"(?: shape)?{_FACING}",
        rf"(?:form|make|create) (?:a|one) (?:semicircle|semi circle|half circle|arc|horseshoe) (?:with|of|from|out of) "
        rf"{_THINGS}{_FACING}",
    ),
    "row": (
        rf"{_PUT} {_THINGS} (?:in|into|to form|as) (?:a|an|(?P<rows>one|two|three|four)) (?:single "
        rf"|straight |neat |even )*"
        rf"(?:row|line|rows|lines){_FACING}",
        rf"(?:line up|align) {_THINGS}{_FACING}",
        rf"line {_THINGS} up{_FACING}",
        rf"{_PUT} {_THINGS} side by side",
    ),
    "around": (rf"{_PUT} {_THINGS} (?:around|round|all around) {_GOAL}",),
    "tidy": (
        rf"(?:tidy|tidy up|neaten|neaten up|straighten|straighten up|straighten out|clean up|sort out"
        rf"|organise|organize)"
        rf"(?: {_MESS})?(?: up| out)?",
        rf"(?:make|get|put|leave) {_MESS} (?:look )?{_NEAT}",
        rf"(?:put|bring|get) {_MESS} (?:in|into|back in) (?:order|its place|place|shape)",
    ),
    "declutter": (
        rf"(?:declutter|clear off|clean off|empty|clear up|tidy up|tidy|unclutter) {_GOAL}(?: off)?",
        rf"(?:take|move|get|clear) (?:everything|all things|all the stuff|all the things|the stuff"
        rf"|the clutter|the things) "
        rf"(?:off|off of|from|away from) {_GOAL}",
    ),
    "set_table": (rf"(?:set|lay|prepare|set up) (?P<goal>(?:the|a|my|our) (?:[a-z]+ )??table){_FOR}{_PEOPLE}{_FOR}",),
    "see": (
        rf"{_PUT} {_THINGS} (?:so|so that|such that|in a way that) {_EVERYBODY} (?:can )?(?:sees?"
        rf"|faces?|watch|look at) "
        rf"{_GOAL}",
        rf"(?:turn|point|face|orient|rotate|aim) (?P<things>all the seats|the seats|all seats|the seating) "
        rf"(?:to|toward|towards|at|to face) {_GOAL}",
    ),
    "watch": (
        r"(?:(?:i|we) (?:want|would like|like|plan) to |set up to |prepare to |get ready to )?watch "
        r"(?:a |the |some )?(?:movie|movies|film|films|tv|television|game|match|football)(?: (?:with"
        r"|together)[a-z ]*)?",
        rf"(?:prepare|set up|get|arrange|rearrange) {_ROOM} (?:ready )?for (?:a |the |our )?(?:movie"
        rf"|film|tv) (?:night|evening)",
    ),
    "spread": (
        rf"(?:spread|spread out|distribute|scatter|disperse) {_THINGS}(?: out)?(?: (?:evenly|apart"
        rf"|around|everywhere|more))*"
        rf"(?: (?:all )?(?:around|over|about|across|throughout|in) {_ROOM})?(?: evenly)?",
    ),
    "reading_corner": (
        rf"(?:make|create|set up|build|add|arrange|put together|i want|i would like|give me)(?: me)? (?:a|an|some) "
        rf"(?:(?:cozy|cosy|nice|comfy|comfortable|small|little|quiet|lovely) )*reading (?:corner|nook|spot|area|place)"
        rf"(?: {_WHERE})?",
    ),
    "symmetric": (
        rf"(?:make|arrange|rearrange|get|set up) (?:{_MESS}|the furniture|the layout"
        rf"|the arrangement) (?:look )?(?:more )?{_EVEN}",
    ),
    "become": (
        rf"(?:turn|convert|transform|change|make|remake|redo) (?:{_ROOM}|it)(?: (?:into|to|in to"
        rf"|as))? (?:a|an) (?:new )?"
        r"(?P<kind>[a-z ]*?(?:nursery|office|bedroom|kitchen|dining room|living room|library|gym|playroom|cafe|studio"
        r"|classroom|studio|bathroom|study))",
    ),
    "party": (
        rf"(?:rearrange|prepare|get|set up|make|arrange|ready|do up|decorate) {_ROOM} (?:ready |fit )?for "
        r"(?:a |the |our |my |some )?(?:[a-z]+ )?(?:party|celebration|birthday)",
    ),
}

COMPILED = tuple((kind, re.compile(pattern)) for kind, patterns in PATTERNS.items() for pattern in patterns)
