"""What people say, and the same as it is asked plainly: "is there a moment when it moves" is "it moves at some time".

Each line is a pattern and what takes its place, tried in their order on the words of a question.
"""

from __future__ import annotations

from functools import cache

from .....gaussians import late_re as re

_LINES = r"""
^(?:(?:so|well|oh|hey|and|but|dear|my) )*(?:mummy|mum|mom|mommy|daddy|dad|papa|grandma|grandpa|granny|grandad|\
teacher|miss|sir|madam|professor|doctor|guys|folks|kids|children|dude|bro|buddy|mate|honey|darling|dear|love|sweetie|\
computer|assistant|people|everybody|everyone|listen|wait|hm|hmm|oh|yo) , =>
 , (?:my )?(?:mummy|mum|mom|mommy|daddy|dad|papa|grandma|grandpa|granny|grandad|teacher|miss|sir|madam|professor|\
doctor|guys|folks|kids|children|dude|bro|buddy|mate|honey|darling|dear|love|sweetie|computer|assistant|people|\
everybody|everyone|listen|wait|hm|hmm|oh|yo)$ =>
\b(?:his|her|their) (?=(?:walk|way|trip|journey|route|run|roll|fall|drop|turn|movement|motion|place|spot|ride|\
drive)\b) => its
(?<= ,) (?:oh|um|uh|er|erm|say|like|hm|well|let us say) , =>
^(?:(?:ok|okay|so|like|ooh|oo|oh|wow|gosh|hmm|um|uh|er|erm|right|and|then|but|well|wait|hey|yo|lol|haha|now|actually|\
alright|also|just|look|listen|anyway|honestly|please|basically|literally) (?:, )?)+(?=(?:how|what|which|when|where|\
who|whereabouts|is|are|was|does|do|did|has|have|in|at|by|on|the|that|my|our)\b) =>
(?: ,)? (?:or nah|or no|or what|lol|haha|lmao|is that so|is that right|is that correct|is it|do you know|d ?'you \
know|d ?' you know|i reckon|i suppose|i think|i guess|i wonder|i bet|you know|thx|pls|please|though|or so|then|or \
something|as far as you (?:know|see)|roughly speaking|to be (?:precise|exact))$ =>
 (?:even )?(?:a )?(?:tiny |little |teeny )?(?:bit|tad|inch|smidgen|millimeter)(?: at all)?(?= |$) =>
\b(?:volume|tome|paperback|hardback)(s?)\b => book\1
\b(?:the|our|my|that|this) (?:little |small |big |poor |old |funny )*(\w+) (?:fellow|guy|chap|dude|lad|figure|thingy|\
character|creature|friend|machine|gadget|object)\b => the \1 thing
^(?:that|this|our|my|your|those|these) (\w+(?: \w+)?) , ((?:when|how|where|what|which|does|did|has|have|will|is|was|\
are|at|until)\b.*)\b(?:it|they)\b(.*)$ => \2the \1\3
^(the \w+(?: \w+)?) , ((?:has|have|did|do|was|were|will)\b.*)\b(?:it|they)\b(.*)$ => \2\1\3
^(?:the )?(\w+(?: \w+)?)(?: 's)? (?:position|location|whereabouts)((?: at| when| after| before) .*)$ => where is the \
\1\2
^(?!what\b|which\b|where\b|who\b|when\b|how\b|is\b|are\b|does\b|do\b|did\b|in\b)(?:the )?(.+ (?:open|opened|closed|\
shut|out|over|still|stopped|down|back)) at(?: when| what time| what second)?$ => when is the \1
\bat its (?:farthest|furthest|widest|most|maximum|fullest)(?: out| open| extended| opening| extension| point)*(?= |\
$) => fully open
\b(by|at|until|till|after|before) the first second\b => \1 1 s
\b(by|at|until|till|after|before) the third second\b => \1 3 s
\b(by|at|until|till|after|before) the fourth second\b => \1 4 s
\b(by|at|until|till|after|before) the fifth second\b => \1 5 s
^(over|across|on|onto|against|into|past|off) (?:which|what)(?: thing| object| surface)? (does|is|do) (.+)$ => what \
\2 \3 \1
^(?:is|was) the (opening|closing|fall|roll|movement|motion|turn|spin|walk) (?:over|finished|done|complete|\
completed)(?= |$) => does the \1 stop
^(when|at what time|at what second|at which second|by when) (?:is|are|was) (?:the )?(opening|closing|swinging|swing|\
turning|spinning|rolling|roll|walking|walk|falling|fall|movement|motion|sliding|rotation)(?: of (.+?))? (?:all \
)?(?:over|finished|done|complete|completed)$ => \1 does the \2 end \3
^from where it (?:starts|begins|started|began) to where it (?:stops|ends|stopped|ended) , =>
^how much longer (does|is|did|will)\b(?!.* than ) => how long \1
\b(once|after|when|as soon as) (it|the \w+(?: \w+)?) (?:is|'s) off (?=the ) => \1 \2 leaves
^(?:the )?time (the .+?|it) (?:takes?|needs?|took) (?:to (?:go|get|move) )?from (?:fully )?closed to (?:fully \
)?open$ => how long does \1 take to open
^(?:the )?time (the .+?|it) (?:takes?|needs?|took) (?:to (?:go|get|move) )?from (?:fully )?open to (?:fully \
)?closed$ => how long does \1 take to close
\b(past|over|more than|beyond|less than|under) a right angle\b => \1 90 degrees
\b(?:the|this|that) (?:whole )?(?:hallway|hall|room|scene|bedroom|dining room|living room|study|playroom|place) \
(?=(?:completely |perfectly |totally |all )?(?:still|motionless|static|quiet|at rest)) => everything
\b(?:separate|distinct|individual) (?=(?:movements|motions|turns|rotations|times|drops|falls)\b) =>
^when is the (?:very )?first (?:sign|hint|trace) of (?:life|movement|motion|action)(?: from| of| in| by)? (.+)$ => \
when does \1 start to move
^(?:does|did|will) (.+?) (?:end|end up|finish|finish up|stop) (?:back )?where it (?:started|starts|began|begins)(?: \
out)?$ => is \1 back in its place at the end
^(which|what|how many) of the (?:two |three |four |five )?(\w+s)\b => \1 \2
^how many times (?:round|around) (has|does|did) (.+?) (?:gone|go|been)\b => how many turns \1 \2 made
^only one (?:thing|object|item)(?: in the room| in here| here)? (.+?) , (?:which|what)(?: is it| one| thing)?$ => \
what \1
 (?:all told|all in|in all|tops)$ =>
^(?:is there )?(?:any|a) (?:chance|risk|danger) (?:that )?(.+)$ => \1
^(?:list|name|order|sort|give me|rank) (the \w+(?: \w+)?) (?:by|according to) (?:when|the time|the order in which) \
they (\w+)$ => in what order do \1 \2
^how (?:much time|many seconds|long) is left(?: (?:in|of) the (?:clip|video|scene|film|shot))? (?:when|after) (.+)$ \
=> how long is it from when \1 until the end of the clip
\bby the time (\w+(?:\.\d+)?) (?:seconds|secs) (?:have|has|had|are) (?:passed|elapsed|gone|over)\b => by \1 seconds
^(?:what|where) is (the .+?) 's (?:destination|goal|stopping place|final (?:resting )?(?:place|position|spot))$ => \
where does \1 stop
^(?:what is )?(?:the )?(?:final|last|end) (?:resting )?(?:spot|place) of (.+)$ => where does \1 stop
^(?:the )?(?:total |overall )?time until (.+)$ => how long until \1
^(?:what|which) distance (?:separates|lies between) (the .+?) 's (?:start|starting point|beginning) (?:from|and) \
(?:its|the) (?:stop|end|stopping point|finish)$ => how far does \1 move
^(?:is|was|does|did) (the \w+(?: \w+)?) (?:get |gets )?moved(?: by the \w+(?: \w+)?)?(?: in any way)?$ => does \1 move
^of (?:the |these |those |all |its )?(?:\w+ 's )?(?:two |three |four |five |six )?(\w+)(?: here)? , (how many|which|\
what)(?: of them| ones?)? => \2 \1
^(?:the )?(?:walls?|floor|ceiling)(?: and (?:the )?(?:walls?|floor|ceiling))* aside , =>
^(?:name|list|give me|tell me|show me) (?:every|each|all|any) (?:single )?(?:objects?|things?|items?)(?: here| in \
the room)? (?:that|which) => name everything that
^(?:the )?(?:out ?point|end point|last frame|final frame|end frame) of (?:the )?(.+?) (swing|opening|closing|fall|\
drop|roll|walk|spin|turn|movement|motion|slide)$ => when does the \1 stop
^(?:the )?(?:in ?point|start point|first frame|start frame) of (?:the )?(.+?) (swing|opening|closing|fall|drop|roll|\
walk|spin|turn|movement|motion|slide)$ => when does the \1 start to move
^(?:the )?total (\w+(?: \w+)?) (?:travel|movement|motion|distance|way|path)(?: ,)? (?:out (?:plus|and) (?:return|\
back|in|back in)|both ways|there and back|in both directions|out and back)$ => how far does the \1 move in total
^(?:add up|sum up|sum|add) (?:the )?(?:way|trip|movement|travel|path|stroke|distance) out and (?:the )?(?:way |trip |\
movement |travel |stroke )?(?:back|in|back in) (?:for|of) (.+?)(?: ,.*)?$ => how far does \1 move in total
^how (?:many|much) (?:seconds|secs|time) (?:of|in) (?:this|the) (?:clip|video|scene|film|shot|recording) (?:has|have|\
is|are|contains?|shows?) (?:no|without) (?:motion|movement)s?(?: at all)?$ => how long is everything still
^(?:the )?(degrees|turns|rotations|revolutions|meters|centimeters) (?:swept|turned|made|completed|done) by (.+)$ => \
how many \1 does \2 turn
^(?:the )?(meters|centimeters|distance) (?:covered|travell?ed|moved|walked|rolled) by (.+)$ => how many \1 does \2 \
move
^(?:give|list|name|tell|show)(?: me)? (the \w+(?: \w+)?) in (?:the )?(\w+ing|drop|fall) order(?: ,? .*)?$ => in what \
order do \1 \2
^(?:the )?(?:heading|direction|course) change of (.+)$ => how far does \1 turn
(?<=\bdoes )(.+?) (?:drive|walk|roll|run|wander|wheel|zoom|scoot|fly|march)s? off(?= (?:at|when|after|before|at)\b|\
$) => \1 move
^(where|whereabouts) (?:would|will|might|should|could) (.+?) be(?= |$) => where is \2
^how (?:far|long) (?:away )?is (.+?) 's (?:finishing|final|end|last|ending|stopping) (?:spot|position|place|point) \
from (?:its|the) (?:starting|start|initial|first|original) (?:one|spot|position|place|point)(?: as the crow flies)?$ \
=> how far does \1 move
^how (?:far|long) (?:away )?(?:from (?:where it|its) (?:started|starts|start|begins|starting (?:point|place|\
position))) (?:does|is|do|did) (.+?) (?:stop|end up|end|finish|at the end)$ => how far does \1 move
\b(is|are|was|were) (?:already|still|now|all) (?:lying|standing|sitting|resting)\b => \1
^(?:the )?(?:timecode|timestamp|time|moment|second|frame)s? (?:for|of) (?=when ) =>
^(when) (the|it|he|she)\b(?!.* , ) => \1 does \2
(?: ,)? dyou know(?= ,|$) =>
^i (?:suppose|assume|guess|take it|think|believe|bet)(?: that)? =>
(?<= at) ,(?= (?:\d|about|around|roughly)) =>
 ?@ ?(?=\d) => at
^as the crow flies , (.+)$ => \1
 as the crow flies$ =>
 , (?:after|before|past) (?:its|the) (?:corner|turn|bend) , =>
\bthe (start|beginning|end) of (the .+?) 's (\w+)\b => \2 \1s to \3
\bthe start of (the \w+ one) 's$ => \1 starts
\balong its (?:path|way|route)(?= |$) =>
 (?:till|until|to|up to) (?:the )?(?:very )?(?:end|(?:clip|video|scene|film|shot|recording) (?:is|'s) (?:over|done)|\
(?:clip|video|scene|film|shot) ends)(?= once| after| when) =>
\b(?:is|'s|was) (?:all )?(?:done|finished|through) (?:with )?(walking|rolling|moving|turning|spinning|falling|\
opening|closing)\b => stops \1
\b(?:has|have|is|are) (?:all )?(?:calmed|settled|quietened|quieted) down\b => is still
\bevery ?thing is still and nothing (?:falls|moves|happens)(?: any ?more)?\b => everything is still
^whether =>
(?: ,)? or not$ =>
^(which|what|how many) (\w+) in the room (?!is\b|are\b|was\b|has\b|have\b) => \1 \2
\bwhatever(?: it is that)? => everything that
 (?:already |still )?or (?:is it )?not(?: yet)?(?: (?:open|opened|closed|shut|moving|turning|there|on|off))?(?= ,|$| \
(?:at|after|by|when|in|on|before)\b) =>
(?: ,)? or (?:anything|something|so)(?: like that)?$ =>
 (?:off |away |out |around )?(?:anywhere|somewhere)(?: else)?(?= |$) =>
\blet(?:s| us)? go(?= |$) => starts to fall
\b(is|are|was|were|still) (?:up|down|over|out) (?=(?:on|in|by|at|under) the ) => \1
\bthe (\w+) (?:fellow|guy|chap|dude|lad|figure|thingy|character|creature)\b => the \1 thing
^(.*?)\b(?:it|he|she|they)\b (.+?) , ((?:the|that|this|our|my) (?:\w+ )?\w+)(?= ,|$)(.*)$ => \1\3 \2\4
\b(sits?|stands?|stays?|lies?|remains?|rests?|sitting|standing|lying) (?:right |just )?(?:there|around|put)(?= |$) \
=> stays still
^between (.+) and (.+?) , how (?:long|much time|many seconds) (?:does|do|is|did) (.+?) (?:wait|rest|pause|stay|stand|\
sit|idle|stop|waiting|resting|pausing)(?: still| out| open| there)*$ => how long is the pause between \3 \1 and \3 \2
^how many of (?:the |its |these |those )?(?:\w+ )?\w+ 's (\w+) => how many \1
^where (?:would|could|can|might|may|do|should|will) (?:i|you|we|one) (?:find|see|spot|look for|pick up) (.+)$ => \
where is \1
^(?:what|which) (?:surface|floor covering|ground|piece of floor|material) (?:is |lies |is lying )?(?:directly |right \
)?(?:under|underneath|beneath|below) (.+?)((?: at| when| after| before) .+)?$ => what is \1 on\2
^(?:which|what) (?:surface|thing)? ?is (.+?) (?:lying|rolling|standing|resting|sitting|riding|travelling|\
travell?ing) on\b => what is \1 on
^when is the (?:very )?(?:first|start|beginning|onset) (?:frame |sign |moment )?of (?:the )?(.+?)(?: 's)? \
(?:movement|motion|moving)$ => when does the \1 start to move
^when is the (?:very )?(?:last|final|end) (?:frame |sign |moment )?of (?:the )?(.+?)(?: 's)? (?:movement|motion|\
moving)$ => when does the \1 stop
^(?:give me |tell me |what is |list |name |show me )?(?:the )?(drop|fall|falling|landing|opening|moving|movement) \
(?:order|sequence) of (.+)$ => in what order do \2 \1
^(?:what is )?(?:the )?(?:total |overall |whole )?(?:travel|motion|movement|moving|moved) (?:time|duration) (?:of|\
for) (.+)$ => how long does \1 move
^(?:what is )?(?:the )?(?:total |overall |whole )?(rolling|running|walking|spinning|turning|falling|waiting|\
travell?ing|sliding) (?:time|duration) (?:of|for) (.+)$ => how long is \2 \1
^(?:what is )?(?:the )?(?:total |overall |whole )?(rug|carpet|mat|table|desk|floor|board) (?:time|duration) (?:of|\
for) ((?:the )?\w+(?: \w+)?)(?= ,|$) => how long is \2 on the \1
^how (?:many|much) (meters?|centimeters?|cm|m|degrees?|feet|steps) (?:does |is |do )?(.+?) (?:is making|makes|is \
doing|make|doing|making)(?= |$) => how many \1 does \2 move
^(?:does |did |has |will |is )?(?:somebody|someone|anybody|anyone|a person|they) (?:ever )?(shuts?|closes?|opens?|\
pushe?s?|pulls?|moves?|turns?|stops?|closed|opened|moved|touche?s?) (the (?:\w+ )?\w+)(?= (?:again|back|out|in|off|\
on|afterwards|later|at|before|after)\b|$) => does \2 \1
(?: ,)? (?:counted|counting|measured|starting) from (?:its|the) (?:first|initial) (?:movement|move|motion)$ =>
^(how (?:long|many seconds|much time)) (?:does |do |is |will )?(.+?) (?:needs?|takes?|requires?) (?:until|till|\
before) (?:it|he|she) (?:has|is|have) (.+)$ => \1 does \2 take to \3
^((?:for )?how (?:long|many seconds) (?:is|does|stays|remains|will) (?!.* (?:from|between|after) ).+?) (?:till|until|\
to|up to) (?:the (?:very )?end(?: of the (?:clip|video|scene|film|shot))?|the (?:clip|video|scene|film|shot) (?:is|\
's) (?:over|done)|the (?:clip|video|scene|film) ends)$ => \1
^(.+?) , how (long|many seconds|much time) (?:is|takes|does|would) (?:that|it|this)(?: take| last| be)?$ => how \2 \
does \1 take
^(?:after|from|since) (?:what|which) (?:second|time|moment|point|\w+ second)(?: on)? (?:is|does|are|has|do) \
(?:nothing|none of them|no \w+) (?:is |are )?(\w+)(?: any ?more| any longer)?$ => when does everything stop \1
(?: ,)? (?:both|all|the two) (?:bits|parts|legs|stretches|ways|pieces|halves)(?: taken)? (?:together|combined|added \
up)(?= ,|$) =>
^(?:what is )?(?:the )?(?:whole |entire |total |full )?(.+?) 's (?:whole|entire|total|full|complete) (?:walk|way|\
path|trip|journey|route|roll|travel)((?: ,)? in \w+)?$ => how far does \1 move\2
^how many (?:corners|bends|curves|turns) (?:does|do|did) (.+?) (?:walk|go|take|make|turn|drive|come)(?: around| \
round| past)?$ => how often does \1 turn
^the (?:exact |very |precise )?(?:moment|time|second|point|instant) (?:when |at which |that )?(?=(?:the|it|he|she) ) \
=> when does
\b(turn|go|walk|take)s? (the \w+(?: \w+)?) (?:around |round )?(?:the|a) corner$ => does \2 turn
^to (?:which|what) (?:moment|time|second|point)\b => when
^how (much|many seconds|long) (later|earlier|sooner) than (.+?) (does|do|did|is|will) (.+)$ => how \1 \2 \4 \5 than \3
^(?:when|as|once) (?:it|he|she|the \w+(?: \w+)?) (?:changes (?:its )?(?:direction|course)|turns|takes (?:the|its|a) \
(?:turn|corner)) , (.+?) (?:go|turn|move|walk|head|drive|going|turning) (?:to )?(?:the |its )?(left or right|right \
or left|left or (?:to )?(?:the |its )?right|right or (?:to )?(?:the )?left)$ => \1 turn \2
^(.+?) (?:go|turn|move|walk|head|drive) (?:to )?(?:the |its )?(left or right|right or left) (?:when|as|once) (?:it|\
he|she) (?:changes (?:its )?(?:direction|course)|turns)$ => \1 turn \2
^(?:will|would|should|could|shall) (.+?) be\b => is \1
\b(anything|something|else|anybody|nothing) in (?:the|this) (?:whole |entire )?(?:room|scene|clip|film)\b => \1
\b(?:a|one) (?:second|sec) and a half\b => one and a half seconds
\b(two|three|four) (?:seconds|secs) and a half\b => \1 and a half seconds
(?: once and)? for good$ => for the last time
^from (?:what|which|how great a) height (?:does|do|did) (.+?) (?:fall|drop|tumble|plunge)$ => how far does \1 fall
^would i be (?:right|correct)(?: (?:in|to) (?:saying|thinking|say|think))?(?: that)? =>
(?: ,)? (?:when |as |if )?(?:seen|viewed|looking|looked at) (?:from above|from the top)$ =>
\b(?:do|can|will|does) (?:we|you|i|one) (?:first )?(?:see|notice|observe|spot)\b =>
^how (?:many times|often) (a|per|each|every) (second|minute) (.+)$ => how many times \3 per \2
^(?:list|name|give|order) (?:me )?(.+?) in (?:the )?order (?:(?:in which|that) )?(?:they )?(\w.*)$ => in what order \
do \1 \2
^(?:is |was )?(the .+?) (?:is |was )?the only (?:one|thing|object)(?: that| which| to) (.+)$ => nothing besides \1 \2
^(?:what|which) is the (?:only )?(\w+ing) (?:thing|object|one) => what is \1
^(?:is|are) there (anything|something|any \w+) (?:else )?(?:that|which) (.+)$ => does \1 \2
^how does (.+?) end up(?: ,)? (\w+ or \w+)$ => is \1 \2 at the end
^how (?:long|far) (?:is|was) (?:the )?(.+?) (?:'s )?(?:first|initial) (?:leg|stretch|section|straight|part)$ => how \
far does \1 move before the turn
^how (?:long|far) (?:is|was) (?:the )?(.+?) (?:'s )?(?:second|last|final) (?:leg|stretch|section|straight|part)$ => \
how far does \1 move after the turn
^how (?:long|far) (?:is|was) the (first|initial|second|last|final) (?:leg|stretch|section|straight|part) of (?!its |\
the (?:way|walk|trip|journey)$)(.+?)(?: 's (?:way|walk|trip|journey|path|route))?$ => how far is \2 's \1 leg
^how (?:long|far) (?:is|was) (?:the )?(.+?) 's (?:first|initial) leg$ => how far does \1 move before the turn
^how (?:long|far) (?:is|was) (?:the )?(.+?) 's (?:second|last|final) leg$ => how far does \1 move after the turn
^how (?:long|far) (?:is|was) (?:the )?(?:first|initial) (?:leg|stretch|section|straight|part)(?: of .+)?$ => how far \
does it move before the turn
^how (?:long|far) (?:is|was) (?:the )?(?:second|last|final) (?:leg|stretch|section|straight|part)(?: of .+)?$ => how \
far does it move after the turn
^how long is (?:the|its) (?:path|way|route|distance|track|trip)(?: (?:of|that) (.+?))?(?: (?:moves|takes|walks|\
covers))?$ => how far does \1 move
\b(?:is|was) it that (?=\w+s\b) =>
\b(?:would you say|do you think) =>
 , (?=in (?:order|sequence)$) =>
 (?:at|from|in) the moment (?:(?:when|that|at which|where) )?(?=the |it ) => when
\b(opening|closing|sliding|rolling|turning|falling|walking) (?:movement|motion|action|phase)\b => \1
(?: ,)? (?:out and back|there and back)$ =>
 (?:at rest|still|stationary|motionless) between (?:the|its) (?:two )?(?:movements|motions|moves|trips)$ => pausing
^((?:which|what|who) (?!.*\b(?:first|earlier|sooner|later|last|faster|slower|quicker|longer|shorter|farther|wider|\
more|less|most)\b)\w+ .+?) , the \w+(?: \w+)? or the \w+(?: \w+)?$ => \1
^(?:does|do|did|is|are|is it) only (the .+?) (?:that )?(move|moves|moving|fall|falls|falling|turn|turns|turning)$ => \
nothing besides \1 \2
\bon the (last|final|first) frame\b => in the \1 frame
\bon (?:the|its) (?:last|final|second) (?:stretch|leg|part|straight)\b => after the turn
\bon (?:the|its) (?:first|initial) (?:stretch|leg|part|straight)\b => before the turn
^(?:is|are|was) there (?:a|any|some) (?:moment|time|point|instant)s? (?:when|at which|where|that) (.+)$ => \1 at \
some time
^(?:is|are) there (?:still )?(?:any |some )?(?:movements?|motion)(?: in the room)?(?= |$) => does anything move
^(?:is )?(?:there )?anything (else )?(moving|turning|spinning|falling)\b => is anything \1\2
^(does|is|did) anything (?:else )?(.*?)(?: (?:besides|except|apart from|other than|but)) (.+)$ => \1 anything \
besides \3 \2
\b(anything|something) else (?:than|but|besides|except) => \1 besides
^(the [\w ]+?) (does|did|is|was|will|has) (?:it|he|she|they) (.+)$ => \2 \1 \3
^(the \w+(?: \w+)?) , ((?:when|how|where|what|which|does|is|at|until)\b.*)\b(?:it|they)\b(.*)$ => \2\1\3
^(?:in )?(?:what|which) state (?:is|are) (.+?)(?: in)?((?: at .+)?)$ => is \1 open or closed\2
^how (?:(?:far|wide) )?(?:open|out|extended) (is|was) (.+?)((?: at| when| after| before| by) .*)?$ => how far \1 \2 \
open\3
^(how far) ((?:out of|away from|from|off) (?:the|its) (?:\w+ ){1,3}?)((?:does|do|did|is|has) .+)$ => \1 \3 \2
^(?:to )?where (?:is|does) (.+?) (?:heading|head|headed|bound)(?: to| for)?(?= |$) => which way does \1 move
^(?:the )?(?:total |whole )?time (the [\w ]+?) is in motion$ => how long does \1 move
^((?:for )?how long .+) lasts?$ => \1
^(?:the )?time (?:for|to make) (.+)$ => how long does \1 take
^(?:the )?time per (?:one |a )?(.+)$ => how long does one \1 take
 (?:for|to make|to complete|to do|to finish|makes?|made|complete|do) (?:one|half a|a|each|every|two|three|four|five|\
ten|\d+) (?:full |single |whole |complete )?(?:turn|rotation|revolution|spin|round)s?\b => turn
"""


@cache
def _rows() -> tuple[tuple[re.Pattern[str], str], ...]:
    lines = [line.partition("=>") for line in _LINES.replace("\\\n", "").strip("\n").split("\n")]
    return tuple((re.compile(said[:-1]), f" {plain.strip()} " if plain.strip() else " ") for said, _, plain in lines)


def plainly(said: str) -> str:
    """The words of a question in the order in which they are asked plainly."""
    said = said.replace("metre", "meter")
    for row, plain in _rows():
        said = re.sub(r" +", " ", row.sub(plain, said)).strip(" ,")
    return said
