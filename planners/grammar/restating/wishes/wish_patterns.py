"""The patterns of sentences that ask for a change without a command; `wishes.py` restates them.

Each is matched with the words of a sentence, in lower case and parted by spaces. Where a thing ends is left open: what
a pattern yields counts only if the planner understands the whole of it.
"""

from __future__ import annotations

from .....gaussians import late_re as re

SPEAKER = r"(?:i|we|you|he|she|they|everyone|everybody|my (?:wife|husband|mum|mom|dad|boss|partner|girlfriend|"\
          r"boyfriend|"\
     r"son|daughter|sister|brother|kids|flatmate|roommate)|the (?:client|boss|wife|kids|customer))"  # fmt: skip
REALLY = r"(?:(?:really|just|also|still|actually|now|quite|much|so|kind of|sort of|very much|definitely|probably|"\
          r"maybe|perhaps|rather|only|all|both|certainly|please) )*"  # fmt: skip
BETTER = (
    r"(?:a (?:lot|bit|little|touch|good deal) |much |far |so much |way |even |somewhat )?"
    r"(?:better|nicer|handier|comfier|safer|neater|smarter|best|great|good|nice|lovely|cooler|prettier|perfect|fab|"
    r"fantastic|smarter|cosier|happier|safer|"
    r"(?!(?:bigg|larg|small|tall|short|wid|narrow|dark|light|bright|high|low|clos|near|furth|long|warm|cool|"
    r"pal)er)\w{2,}er|"
    r"more at home|more (?:sensible|fun|modern|elegant))"
)
_ASSERTED = r"(?!(?:not|never|nobody|no|none|neither|nor|hardly) )\S+"  # a word that does not deny what follows it
# Before a thing and the state that it is to have.
WANTING = re.compile(
    rf"^(?:(?:{SPEAKER} {REALLY}(?:would|could|will|can|might|may|should|do|does)? ?{REALLY}"
    rf"(?:like|love|prefer|want|wants|need|needs|wish|have|see|fancy|be (?:happy|happier|glad) (?:with|if|to have|"
    rf"to see)|"
    rf"appreciate|enjoy|rather|rather have|rather see|rather that)"
    rf"(?: to (?:see|have|get|find)| seeing| having| for| it if| it that| if| that)?|"
    rf"(?:could|can|may|might|shall|should|would) {SPEAKER} {REALLY}(?:please )?(?:have|get|see|try|like|want)|"
    rf"(?:can|could|would|will) (?:you|someone|somebody) {REALLY}(?:please )?(?:have|get|see (?:to it )?that)|"
    rf"(?:{_ASSERTED} ){{1,4}}?(?:wants?|would (?:like|love|prefer)|prefers?|fanc(?:y|ies)|insists? on|asked for|"
    rf"asks for)(?= (?:the|that|this|my|our|those|these|both|all|every|it|them) )|"
    rf"(?:{_ASSERTED} ){{1,3}}?(?:said|says|reckons|thinks|told (?:me|us)|insists|suggests|asked|asks)(?: (?:for|"
    rf"me|us|to))*(?: that)?|"
    rf"(?:let us )?{REALLY}(?:try|picture|imagine)|let us {REALLY}(?:have|see|get)|let me {REALLY}(?:have|see|try)|"
    rf"(?:just )?(?:have|get|make|let)|"
    rf"make sure(?: that)?|see to it that|make it so(?: that)?|ensure(?: that)?|i (?:think|feel|reckon|guess|suppose|"
    rf"believe|say|vote)(?: that)?|how about|what about|what if|would it be (?:possible|ok|okay) (?:for|to have)|"
    rf"(?:it |that )?(?:would|might|could|may) {REALLY}be {BETTER} (?:if|to have|to see|with)|any (?:chance|way)(?: "
    rf"that)?|it is (?:time|about time|high time) (?:for|that)|"
    rf"it 's time for|please let|let|help me (?:get|have)|i am (?:after|hoping for|thinking)|imagine|picture|"
    rf"my (?:idea|plan|wish|preference) (?:is|would be)(?: to have| for)?)"
    rf" )(?P<rest>\S.*)$"
)
MODAL = re.compile(
    rf"^(?P<thing>\S.*?) (?:(?P<not>(?:can|must|should|may|shall|will|would|could|need|do|does|ought) not|never)|"
    rf"{REALLY}(?:should|must|shall|could|can|may|might|ought to|has to|have to|had to|has got to|have got to|got to|"
    rf"would {REALLY}(?:be|look|fit|go|do|feel|work|stand|sit|suit|make more sense) {BETTER}(?: off)?(?: if it "
    rf"(?:were|was|"
    rf"is))?|"
    rf"needs to|need to|wants to|want to|is to|are to|was to|were to|will|would|had better|gets?|is getting|are "
    rf"getting|is supposed to|"
    rf"are supposed to|is meant to|are meant to|is going to|are going to|is due to|deserves to|cries out to|would "
    rf"be {BETTER} off|"
    rf"would like to|was supposed to|is ready to|is dying to|needs|should all|must all|should both|"
    rf"(?:looks|is|fits|works|goes|are|look) (?:much |far |way |a lot )?(?:better|nicer|best)))"
    rf" {REALLY}(?P<state>\S.*)$"
)
PLACED = re.compile(
    rf"^(?P<thing>\S.*?) {REALLY}(?:belongs?|goes|go|lives?|stand|stood|sit|sat|hang|hung|moves?|moved|"
    rf"turned|were|was)"
    rf" {REALLY}(?P<state>\S.*)$"
)
NEEDS = re.compile(
    rf"^(?P<thing>\S.*?) {REALLY}(?:needs?|wants?|requires?|could {REALLY}(?:do with|use|stand)|should get|"
    rf"deserves?|is (?:due for|ready for|crying out for)|cries out for|would benefit from|calls for|might need|"
    rf"will need) "
    rf"(?:being |to be |getting )?(?P<state>\S.*)$"
)
ASKED = re.compile(
    rf"^(?:can|could|may|might|please can|please could) (?P<thing>\S.*?) {REALLY}"
    rf"(?P<verb>be|go|come|stand|sit|hang|move|turn|face|look|become|have|disappear|vanish|leave|get|shrink|grow|lie|"
    rf"lean|lose|match|swap|point|live|rest|rotate|spin|slide|shift)(?: (?P<state>\S.*))?$"
)
GONE = r"(?:gone|out|away|off|history|toast|outta here|out of (?:here|there|the (?:room|way|house|picture|scene)|"\
       r"my sight|sight)|"\
        r"removed|deleted|erased|got rid of)"  # fmt: skip
KEPT = tuple(
    re.compile(pattern)
    for pattern in (
        rf"^(?:{SPEAKER} {REALLY}(?:only|just) {REALLY}(?:need|want|wish|care about|would like|care for|require)|"
        rf"all {SPEAKER} (?:need|want|would like|wish)|the only (?:things?|one|ones) {SPEAKER} (?:need|want|would "
        rf"like))"
        rf"(?: to (?:see|keep|have|look at|be shown|show))?(?: (?:is|are))?(?: just| only)? (?P<thing>\S.*)$",
        r"^(?:only|just|nothing but) (?P<thing>\S.*?) (?:should|must|can|may|shall|is to|are to) (?:stay|remain|be "
        r"left|be kept|"
        r"be visible|be shown|survive|be there|be in the (?:scene|room))$",
        r"^(?:keep|leave|show(?: me)?|i want to see|i want|i need)? ?(?:only |just )?(?P<thing>\S.*?)(?: ,)* (?:and "
        r")?(?:nothing|"
        r"no thing|not "
        r"anything) (?:else|more|other)$",
        r"^(?:everything|all|anything|the lot) (?:but|except|except for|apart from|other than|bar|besides) "
        r"(?P<thing>\S.*?) "
        r"(?:should|must|can|has to|have to|needs to|need to|may) (?:go|disappear|vanish|leave|be removed|be "
        r"deleted|be gone)$",
        r"^(?:keep|leave) (?P<thing>\S.*?)(?: ,)* (?:and )?(?:lose|ditch|bin|dump|scrap|clear|chuck|get rid of|"
        r"remove|delete) "
        r"(?:everything else|the rest|all the rest|all else|the lot|the others)$",
    )
)
NO_MORE = (
    r"(?:anymore|any more|any longer|again|ever again|here|in here|around|around here|in this room|in the room|"
    r"there|at all|either|too|as well|"
    r"any longer here|in the (?:scene|picture)|hanging around|cluttering (?:up )?the (?:place|room))"
)
_DOWN = r"(?:down|off|out)(?: (?:from|of|off))?(?: (?:the|that|my|our|its) (?:\w+ )?(?:wall|ceiling|hook|room|shelf))?"
_IN_THE_BIN = (
    r"(?:in|into|to|on) the (?:bin|trash|skip|dump|tip|rubbish|garbage|dumpster|scrap heap|recycling|charity shop)"
)
UNWANTED = tuple(
    re.compile(pattern)
    for pattern in (
        rf"^(?P<thing>\S.*?) {REALLY}(?:has to|have to|must|needs? to|should|ought to|is to|are to|can|may|had better|"
        rf"wants to|will have to|is going to have to) (?:come|be taken|get taken|be|go) {_DOWN}$",
        rf"^(?:{SPEAKER}|(?:\S+ ){{1,3}}?\S+) (?:wants?|needs?|would like|asked for|insists? on) (?P<thing>(?:the|that|"
        rf"this|my|our|those|these|both|all) \S.*?) (?:taken )?(?:down|off the wall|down off the wall|off)$",
        rf"^(?P<thing>\S.*?) (?:goes|go|is going|are going|belongs?|can go|has to go|have to go|should go|must go|"
        rf"needs to go) {_IN_THE_BIN}$",
        r"^(?P<thing>(?!(?:it|that|this|there|he|she|they|which|anything|what|here|everything)\b)[^,;:]*?\w) "
        r"(?:goes|is going|are going|"
        r"comes (?:off|out|down)|goes away|has had it|must die)$",
        r"^(?:so |and |then )?(?:out|away|off) (?P<thing>(?:it|they|the \S.*?)) (?:goes|go)$",
        rf"^(?:none|not one|not a single one|not any|not a one) of (?P<thing>(?:the|those|these|my|our) \S.*?) {REALLY}"
        rf"(?:should|must|can|may|shall|is to|are to|gets to|get to|will) (?:stay|remain|be left|be kept|be there|"
        rf"survive|be here)(?: {NO_MORE})*$",
        r"^not (?:one|a single|any) (?P<each>\S.*?) (?:should|must|can|may|shall|is to) (?:stay|remain|be left|be kept|"
        r"be there|survive|be here)(?: behind)?$",
        r"^no (?!one|body|thing|need|problem|worries|way|idea|doubt|more|less|that|this|it|the|not|do|make|i |we |"
        r"longer|room|space|place|reason|point|use|chance|but|and|other|wait|sorry|thanks|thank|please|yes|actually|"
        r"hang|hold|stop|oops|just|\w+er\b)(?P<thing>[^,:]+?)(?: at all| "
        r"whatsoever| in here| here)*$",
        rf"^(?:{SPEAKER} {REALLY}(?:would|will|could|do)? ?{REALLY}(?:want|like|prefer|rather have|have|see) )no "
        rf"(?!one|more)(?P<thing>[^,:]+?)(?: {NO_MORE}| at all)*$",
        r"^(?:(?:the|this|that|my|our) (?:\w+ ){1,2})?without (?P<thing>(?:the|that|this|my|our|any) [^,]+)$",
        rf"^(?:there is|there 's|there are|we have|we have got|i have|i have got|there 's just|i see|i have really) "
        rf"(?:really |just |simply )?(?:no|not any|not enough|no more|hardly any|just no) "
        rf"(?:room|space|place|need|use|call|reason|point|purpose)(?: (?:left|here|in here))?"
        rf"(?: (?:for|in having|to have|to keep|in keeping|having|in))? (?P<thing>\S.*?)(?: {NO_MORE})*$",
        rf"^(?:(?:i|we) (?:have|see) )?no (?:room|space|place|need|use|call|more need) for (?P<thing>\S.*?)(?: "
        rf"{NO_MORE})*$",
        rf"^(?:(?:nobody|no one) {REALLY}(?:will |would |does )?|(?:i|we|you) {REALLY}(?:do not|no longer|never|"
        rf"will not|does not|will never|would not) {REALLY})"
        rf"(?:ever )?(?:need|needs|want|wants|require|use|uses|miss|care for|wish)(?: to (?:see|have|keep|look at))? "
        rf"(?P<thing>\S.*?)(?: {NO_MORE})+$",
        rf"^(?:i|we) {REALLY}(?:do not|no longer|never|will not|will never) {REALLY}(?:ever )?"
        rf"(?:need|want|require)(?: to (?:see|have|keep|look at))? (?P<thing>\S.*)$",
        rf"^(?:i|we) (?:can|could|would|will|should|might|had better) {REALLY}(?:easily |happily |well |gladly "
        rf")?(?:do|live|manage|be fine|"
        rf"be happy|"
        rf"be happier|be better off|be better) "
        rf"without (?P<thing>\S.*?)(?: {NO_MORE})*$",
        rf"^(?P<thing>\S.*?) (?:is|are) (?:no longer|not) {REALLY}(?:needed|wanted|necessary|required|welcome|"
        rf"useful|in "
        rf"use|used|wanted)(?: {NO_MORE})*$",
        rf"^(?P<thing>\S.*?) (?:is|are) {REALLY}(?:superfluous|unnecessary|unwanted|redundant|surplus|surplus to "
        rf"requirements|not needed|not wanted|unneeded|too much|one too many|obsolete|for the (?:bin|tip|skip|dump)|"
        rf"history|toast|past it|past its best)(?: {NO_MORE})*$",
        rf"^(?:i|we) (?:am|are|have been|was) {REALLY}(?:sick|tired|done|through|fed up|bored|finished|sick and "
        rf"tired|over)"
        rf"(?: to death)?(?: (?:of|with|by|looking at|seeing|having|of seeing|of looking at))+ (?P<thing>\S.*?)(?: "
        rf"{NO_MORE})*$",
        r"^(?:(?:i|we) have (?:really )?(?:had|seen) )?(?:quite )?enough of (?P<thing>\S.*)$",
        rf"^(?P<thing>\S.*?) (?:can|must|should|may|does|do|will|could) not {REALLY}(?:stay|be|remain|belong|fit|"
        rf"live|stand)(?: in)?(?: {NO_MORE})*$",
        r"^(?P<thing>\S.*?) (?:has|have) (?:got )?(?:no (?:place|business)(?: being)?|outlived|overstayed|served|had)"
        r"(?: (?:here|in here|in this room|its usefulness|its welcome|its purpose|its day|its time|their day))+$",
        rf"^(?P<thing>\S.*?) {REALLY}(?:must|can|should|could|may|might|shall|will|would|has to|have to|needs to|"
        rf"need to|"
        rf"has got to|have got to|got to|ought to|had better|is to|are to) (?:just |also |all |both |definitely |"
        rf"now |then )*"
        rf"(?:go|disappear|vanish|leave|get lost|get out|be off|go away|be {GONE}|go bye bye|come out|"
        rf"go in the (?:bin|trash|skip)|be history)(?: {NO_MORE})*$",
        rf"^(?P<thing>\S.*?) {REALLY}(?:is|are|be|to be|get|gets)? ?{GONE}$",
        rf"^(?:(?:i|we) would )?(?:rather|prefer) (?:not|not to) (?:have|see|keep|look at) (?P<thing>\S.*?)(?: "
        rf"{NO_MORE})*$",
        rf"^(?:the (?:room|place|space|scene)|it|this room|this place|that|this|the whole thing|everything) "
        rf"(?:would|will) "
        rf"(?:be|look|feel) {BETTER} without (?P<thing>\S.*)$",
        rf"^(?:(?:i|we) (?:would|will) (?:be|look|feel) )?{BETTER} (?:off )?without (?P<thing>\S.*)$",
        r"^(?:away|out|off|down|begone|be gone|be off|goodbye|good bye|bye|bye bye|farewell|say goodbye|say bye|"
        r"off you go)"
        r"(?: with| to)? (?P<thing>\S.*)$",
        r"^no more (?P<thing>\S.*)$",
        r"^not a fan of (?P<thing>\S.*?) , (?:remove|delete|bin|lose)$",
        r"^(?:i|we) (?:want|would like|need) (?:shot|rid) of (?P<thing>\S.*)$",
        r"^(?:i|we) (?:hate|can not stand|loathe|can not bear) (?:looking at |the sight of |seeing )?(?P<thing>\S.*?) "
        rf"(?:{NO_MORE})$",
        r"^(?:lose|loose) (?P<thing>\S.*)$",
        r"^(?P<thing>\S.*?) (?:has|have) (?:had (?:its|their) (?:day|time)|got to go|gotta go|gone too far)$",
        r"^(?P<thing>\S.*?) (?:gotta|got to|gots to|go) go$",
    )
)
NEW = r"(?:a|an|another|some|one more|one|two|three|four|five|six|a couple of|a pair of|a few|more|new)"
_PLACE = (
    r"(?: ,)?(?P<more> (?:on|in|next to|beside|under|by|behind|near|at|between|around|to|above|opposite|against|over|"
    r"in front of) .*)?"
)
WANTED = tuple(
    re.compile(pattern)
    for pattern in (
        rf"^(?P<thing>(?!(?:the|that|this|my|our|your|those|these|no|nothing|it|all|both|every|more|what|is|are) )"
        rf"(?:[a-z]+ ){{0,3}}[a-z]+) (?:is |are )?(?:needed|wanted|required|missing|please){_PLACE}$",
        rf"^(?P<thing>{NEW} [^,]+?) (?:would|will|could|might) not (?:go amiss|be amiss|hurt|go astray|be out of place)"
        rf"(?P<more> .*)?$",
        rf"^(?:i|we) (?:would|could) not (?:mind|say no to|object to|complain about) (?:having |getting "
        rf")?(?P<thing>{NEW} \S.*)$",
        rf"^(?:missing|needed|wanted|required|to add|still missing|still needed) [:,] (?P<thing>{NEW} \S.*)$",
        rf"^(?:is there )?(?:any|a) chance (?:of|for|that there could be|to have|to get) (?P<thing>{NEW} \S.*)$",
        rf"^(?:would|could|might|should)(?: not)? (?P<thing>{NEW} [^,]+?) {REALLY}(?:be|look|go|fit|do|work|suit) "
        rf"(?:{BETTER}|well)(?P<more> .*)?$",
        rf"^(?:what|all|the (?:only )?thing) (?:that )?(?:\S+ ){{1,3}}?(?:needs?|lacks?|wants?|is missing|could do "
        rf"with|is crying out for)"
        rf" is (?P<thing>{NEW} \S.*)$",
        r"^(?P<thing>(?:a|one|two|three|four|five|six|another|\d+) (?:more )?(?:copy|copies|duplicates?|clones?) of "
        r"\S.*)$",
        rf"^(?P<thing>{NEW} (?:more )?)(?P<noun>[^,]+?) , (?:all |both |each |in )?(?P<hue>[^,]+?)(?: "
        rf",)*(?P<more>(?: (?:on|in|"
        rf"next to|beside|under|by|behind|near|at|between|around|to|above) .*)?)$",
        rf"^there (?:should|must|needs? to|ought to|has to|have to|could|might|may|shall|will|can|want to) (?:also "
        rf")?be "
        rf"(?P<thing>{NEW} \S.*)$",
        rf"^there (?:is|are) (?P<thing>{NEW} \S.*?) (?:missing|lacking|needed|wanted)(?P<more> .*)?$",
        rf"^(?:i|we) (?:am|are) (?:still )?(?:missing|lacking|short of|after|in need of|looking for) "
        rf"(?P<thing>{NEW} \S.*)$",
        rf"^(?:i|we|it|you|this room|the room|this place|this|she|he|they|someone|somebody) {REALLY}"
        rf"(?:could|would|can|might|should|will|may) {REALLY}(?:use|do with|need|like|love|have|fancy|get|want|add|put|"
        rf"welcome|appreciate|stand) (?P<thing>{NEW} \S.*)$",
        rf"^(?:how|what) about (?:adding |putting |having |getting |if we (?:add|put|had) )?(?P<thing>{NEW} \S.*)$",
        rf"^(?:can|could|may|might|shall|should) (?:i|we|you|there) {REALLY}(?:please )?(?:have|get|see|add|be|"
        rf"give me|find me|"
        rf"fit(?: in)?|squeeze(?: in)?) (?P<thing>{NEW} \S.*)$",
        rf"^(?P<thing>{NEW} \S.*?) (?:would|will|could|might|should|may) {REALLY}(?:be|look|go|fit|do|work|suit) "
        rf"{REALLY}"
        rf"(?:{BETTER}|handy|useful|welcome|helpful|appreciated|the thing|just the thing|ideal|well)"
        rf"(?P<more> (?!to ).*)?$",
        rf"^(?P<thing>{NEW} \S.*?) (?:is|are) (?:needed|missing|wanted|required|called for|due)(?P<more> .*)?$",
        rf"^(?P<thing>{NEW} \S.*?) {REALLY}(?:should|must|needs to|need to|has to|have to|could|can|belongs?|goes|"
        rf"go|wants? to)"
        rf" ?(?:also )?(?:be|go|stand|sit|hang|live|come|belong|appear|be added|be placed|be put|added|placed)?"
        rf"(?P<more> .*)$",
        rf"^(?:i|we) {REALLY}(?:need|want|require|fancy|miss|demand|request|crave) (?P<thing>{NEW} \S.*)$",
        rf"^(?:what (?:is|was) (?:missing|needed|lacking)(?: here)? is|all (?:we|i|it|this room) (?:need|needs|"
        rf"lacks?) (?:now )?is|"
        rf"the only thing missing is) (?P<thing>{NEW} \S.*)$",
        rf"^(?:i|we) (?:have to|must|need to|should|ought to|want to|would like to) have (?P<thing>{NEW} \S.*)$",
        rf"^(?:it|this room|the room|this place|this|the place|this corner) {REALLY}(?:needs|wants|lacks|is "
        rf"missing|is lacking|"
        rf"cries out for|is crying out for|calls for) (?P<thing>{NEW} \S.*)$",
        rf"^(?:go for|try|time for|make room for|room for|(?:and )?(?:then )?also|plus|and) (?P<thing>{NEW} \S.*)$",
        r"^(?P<thing>(?:one|two|three|four|five|six|a few|a couple of|some) more \S.*)$",
        r"^(?P<thing>another \S.*)$",
    )
)
INSTEAD = tuple(
    re.compile(pattern)
    for pattern in (
        rf"^instead of (?P<old>\S.*?)(?: ,)? (?:put|use|have|add|give me|{SPEAKER} {REALLY}(?:would|could|should|"
        rf"can|will|might)? ?"
        rf"{REALLY}(?:want|need|like|prefer|have|use|take|put|rather have)|let us have|there should be|make it|how "
        rf"about|"
        rf"get|get me)? ?(?P<new>{NEW} \S.*?)(?: (?:in|there))?$",
        rf"^(?:put|use|have|add|place|get|give me|stick|pop|{SPEAKER} {REALLY}(?:would|could|should|can|will|"
        rf"might)? ?{REALLY}"
        rf"(?:want|need|like|prefer|have|use|take|put|rather have)|let us have|there should be|how about|what about|"
        rf"(?:can|could) (?:i|we) have)? ?"
        rf"(?P<new>{NEW} \S.*?) (?:instead of|in place of|rather than|in lieu of|over|than) (?P<old>\S.*)$",
        rf"^(?:put|place|stick|pop|stand) (?P<new>{NEW} \S.*?) (?:where|in the place where|on the spot where) "
        rf"(?P<old>\S.*?) "
        rf"(?:is|are|was|were|stands?|sits?|used to (?:be|stand|sit))(?: now| standing| sitting)?$",
        rf"^(?:i|we) (?:would )?(?:prefer|rather have|favou?r) (?P<new>{NEW} \S.*?) (?:to|over|than) (?P<old>\S.*)$",
        rf"^(?P<old>\S.*?) {REALLY}(?:should|must|could|needs to|has to|ought to|would be {BETTER}|would work "
        rf"{BETTER}) "
        rf"(?:be replaced (?:by|with)|be swapped (?:for|out for|with)|be exchanged for|make way for|give way to|"
        rf"be|become|as) (?P<new>{NEW} \S.*)$",
        rf"^(?P<new>{NEW} \S.*?) (?:should|must|could|can|needs to|has to|shall) (?:replace|take the place of|"
        rf"stand in for) "
        rf"(?P<old>\S.*)$",
        r"^out with (?P<old>\S.*?)(?: ,)*(?: and)? in with (?P<new>\S.*)$",
        rf"^(?:swap|trade|change|exchange|switch|turn|upgrade)(?: out)? (?P<old>\S.*?) (?:for|into|to) "
        rf"(?P<new>{NEW} \S.*)$",
    )
)
# What is left empty: nothing shall be on it.
EMPTIED = tuple(
    re.compile(pattern)
    for pattern in (
        rf"^(?:nothing|no thing|not a thing|not one thing|no clutter|none of it) {REALLY}(?:should|must|can|may|"
        rf"shall|needs to|"
        r"has to|ought to|is to|is allowed to) (?:be|stay|remain|stand|sit|lie|be left|be lying|be standing)(?: "
        r"around)? "
        r"on (?P<thing>the [^,]+)$",
        rf"^(?:{SPEAKER} {REALLY}(?:want|need|would like|would love) |make |have |get |keep )?(?P<thing>(?:the|that|"
        rf"this|"
        rf"my|our) [^,]+?)(?: (?:should|must|has to|needs to|ought to|is to) be| to be)? {REALLY}(?:empty|clear|"
        rf"cleared|bare|"
        r"emptied|cleared off|cleared out|free of clutter)$",
        r"^(?:strip|wipe|sweep|take|get) (?:everything|the lot|all of it|all|it all|anything) (?:off|from) "
        r"(?P<thing>the [^,]+)$",
        r"^(?:clear|empty|strip) (?P<thing>the [^,]+?) (?:completely|entirely|fully|totally|off|out|bare|of everything|"
        r"of all (?:its |the )?(?:clutter|stuff|things|contents))(?: please)*$",
    )
)
# "Black for the chandelier", "let us go with black on the chandelier", "grey suits the chaise longue better".
HUED = tuple(
    re.compile(pattern)
    for pattern in (
        r"^(?:a |some |another )?(?:fresh |new |nice )?(?:lick|coat|splash|layer|touch|dash) of (?P<hue>\S+(?: "
        r"\S+)?)(?: paint)? "
        r"(?:for|on|onto) (?P<thing>(?:the|that|this|my|our|both|all|every) \S.*)$",
        rf"^(?:{SPEAKER} (?!(?:would|could|should|might) have |put |use |apply )"
        rf"(?:have |has |would |could |will |am going to |are going to |might )*|let us |please "
        rf")?(?:go|going|gone|went|"
        rf"decided|settled|settle|decide|choose|chose|opt|opted|vote|voted|stick|try|use|pick|picked|apply|put) "
        rf"(?:with |for |on |to )?(?P<hue>\S.*?) (?:for|on|onto) (?P<thing>(?:the|that|this|my|our|both|all|every) "
        rf"\S.*)$",
        rf"^(?P<hue>\S.*?) (?:would |might |could )?(?:suits?|becomes?|flatters?|fits?|works? (?:better )?(?:on|for)|"
        rf"looks? {BETTER} on|goes {BETTER} with) (?P<thing>(?:the|that|this|my|our) [^,;]+?)(?: (?:{BETTER}|more|"
        rf"best))?$",
        r"^(?P<was>\S+) (?:does|is) not (?:suit|work for|work on|look (?:good|right|great|nice) on|right for) "
        r"(?P<thing>(?:the|that|this|my|our) [^,;]+?) [;,] (?P<hue>\S+(?: \S+)?) (?:would|does|will|might)(?: do| "
        r"be better| work)?$",
        r"^(?:a|the) (?:better|best|nicer|right) colou?r for (?P<thing>(?:the|that|this|my|our) [^,;]+?) (?:is|"
        r"would be|might be)"
        r" (?P<hue>\S.*)$",
    )
)
# "The white stand is where the cake should go".
WHERE = re.compile(
    r"^(?P<place>(?:the|that|this|my|our) [^,]+?) is (?:where|the place where|the spot where) (?P<thing>(?:the|that|"
    r"this|my|our|those|"
    r"these|both|all) [^,]+?) (?:should (?:go|be|stand|sit|hang|live)|goes|go|belongs?|ought to be|has to go|must "
    r"go|needs to be)$"
)
BEST_PLACE = re.compile(
    r"^(?:the|a) (?:best|better|right|ideal|proper|perfect|only|good|nicer) (?:place|spot|position|home|location) for "
    r"(?P<thing>\S.*?) (?:is|would be|might be|has to be|must be|will be) (?P<state>\S.*)$"
)
# "the third bookcase is the one I want gone", "what I want gone is the third bookcase".
CLEFT = tuple(
    re.compile(pattern)
    for pattern in (
        rf"^(?P<thing>\S.*?) (?:is|are) (?:the )?(?:one|ones|thing|things|what|thing that|one that)(?: that| "
        rf"which)? {SPEAKER} {REALLY}"
        rf"(?:want|need|would like|like|prefer|have)(?: to (?:be|see|have))? (?P<state>\S.*)$",
        rf"^(?:what|the (?:one|thing)(?: that| which)?) {SPEAKER} {REALLY}(?:want|need|would like|like)(?: to "
        rf"(?:be|see|have))? "
        rf"(?P<state>\S.*?) (?:is|are) (?P<thing>\S.*)$",
    )
)
OF_COLOR = re.compile(
    r"^(?:the )?(?:colou?r|paint|shade|tint|finish) of (?P<thing>\S.*?) (?:should|must|has to|needs to|ought to|"
    r"could|is "
    r"to|would be \w+) (?:be|become|change to|turn|look)? ?(?P<state>\S.*)$"
)


GIVEN = re.compile(
    r"^give (?P<thing>\S.*?) (?P<amount>(?:a|an|one|another|two|three|half a)(?: [\w°/.]+)*?) "
    r"(?P<verb>turn|turns|spin|rotation|twist|push|nudge|shove|flip|tilt|pull|shift|lift)(?P<rest>(?: .*)?)$"
)
