"""Turns of everyday English about motion and time, by what they mean, and the plain words that the readers know.

A turn is said in a notation (`notation`), in which a verb stands for all its forms: "springs into action" and "sprang
to life" are "starts to move". What needs the words around it is a pattern instead (`_AROUND`).
"""

from __future__ import annotations

from functools import cache, partial

from .....gaussians import late_re as re
from .moments import NUMBER, seconds
from .notation import inflected, pattern

_CLIP = "(clip|video|film|movie|scene|shot|recording|footage|animation|whole thing)"
_DEGREE = "[sudden|abrupt|gradual|gentle|slow|complete|full|dead|final|total|grinding]"
# plain words: the turns that mean them
_TURNS = f"""
at the end: when all is said and done | (by|at|in) the end of it all | when the dust settles | \
    (when|once|after) everything is (over|done|finished) | (when|once|after) it is all over | at (long last|closing \
    time) | (at|by) the (close|conclusion|finish|very last moment) [of the {_CLIP}] | (in|on|at) the \
    (last|final|closing) (frame|moment|instant|picture) [of the {_CLIP}] | as the {_CLIP} (~end|~close|~finish) | \
    (at|by) the final curtain
at the start: at the [very] outset | from the [very] (outset|get go|off|word go|first moment) | right off the \
    bat | at time (zero|0) | at t = (zero|0) | (in|on|at) the (first|opening|initial) \
    (frame|moment|instant|picture) [of the {_CLIP}] | (when|as|once) the {_CLIP} (~start|~begin|~open) | before \
    anything else happens
the whole time: from (start to finish|first to last|the first frame to the last|beginning to end|end to end) | \
    at every (moment|instant|point) | for the [whole|entire|full] duration [of the {_CLIP}] | all the while | for \
    the whole of the {_CLIP} | (from the start|from the beginning) [right|all the way] through to the end | the \
    whole {_CLIP} (long|through) | for the entirety of the {_CLIP} | without (interruption|a break)
at some time: at any (stage|juncture|instant) | at some (stage|juncture|instant) | at one (time|moment) or \
    another | at one (stage|moment) | even once | on any occasion | (in|during) the course of the {_CLIP}
~stay still: STAY [firmly] (rooted|glued|nailed|frozen) [in place|to the spot|down] | (rooted|glued) to the \
    spot | (~hold|~keep|~maintain|~stand) [on to] ITS (place|position|ground|spot) | ~stay (unmoved|where it \
    was|exactly where it is|out of it) | ~bide ITS time | ~linger | ~hang (on|around) | ~sit tight | ~stay as it is
motionless: [left] [completely|entirely|totally] (undisturbed|untouched|unmoved) | left alone
~start to move: ~leave [ITS] (state of rest|resting (place|position)|rest) | \
    ~spring (into|to) (motion|action|life|movement) | (~set|~put) (itself|himself|themselves) in \
    motion | (~come|~burst) to life | ~get [itself] (under way|off the mark|into motion) | ~make ITS first \
    [visible|actual] (move|movement|motion) | ~take ITS first step | ~give way | ~break into (motion|movement) | \
    ~kick into (gear|motion) | (START|~set out on) (its|the|his|her) [little|whole] \
    (trip|journey|way|travels|run|movement|motion|voyage) | ~set forth | ~make a move | ~get started | ~stir into \
    (life|motion) | ~stir itself
~stop moving: (~come|~draw|~roll|~grind|~slide|~be brought) to (a|its) {_DEGREE} (stop|halt|standstill|rest) | \
    ~go (quiet|still|silent|dead) | ~run out of (steam|momentum|energy|puff) | ~peter out | ~pull up | ~call it a \
    day | ~lose all [its|the] (speed|momentum) | ~fall (still|idle) | ~cease [all|its|any] (motion|movement|moving) \
    | ~pack it in | ~quit moving | ~be at its journey 's end | (END) (its|the|his|her) [little|whole] \
    (trip|journey|way|travels|run|voyage|movement|motion)
~move: (~change|~shift|~switch) [ITS] (place|position|location|positions|places) | on the go | up and \
    (running|about) | [~get] (involved|engaged) in (any|some|the) (movement|motion|action) | so much as \
    (twitch|budge|stir|move|wobble) | ~show [any] (sign|signs) of (movement|motion|life|moving) | ~take part in the \
    (movement|motion|action) | [~be|~get] (displaced|relocated|disturbed|shifted|dislodged|nudged) | ~see [any] \
    (movement|motion|action) | ~undergo [any] (movement|motion|displacement) | ~do any moving | ~budge an inch
~change direction: ~alter [its|his|the] (course|heading|direction|path|bearing) | ~change (course|heading|tack|bearing)
~fall: ~go over the edge | ~keel over | (~come|~go) (tumbling|crashing|hurtling|toppling|plunging|falling) \
    (down|over|off) | ~take a (tumble|fall|dive|plunge|spill|nosedive) | ~lose ITS (balance|footing|grip|hold) | \
    ~nosedive | ~collapse | ~come a cropper | ~fall victim to gravity
falling: (in|is) mid (fall|flight|air|drop|tumble) | on (its|the|their) way down | midair
~land: ~hit the (deck|dirt) | ~touch ground | ~make contact with the (floor|ground) | ~smack onto the floor | \
    ~meet the (floor|ground) | ~come to earth
~close: ~retreat | ~withdraw | ~slide home | ~be pulled to | ~pull to | ~tuck back in
closed: pushed home
fully open: at [its] (full|maximum|maximal|greatest) (stretch|extension|reach|extent) | \
    [drawn|pulled|slid|sticking] out to (its|the) (full|maximum|maximal) (extent|extension|length)
~reach its full extension: (~hit|~attain|~achieve|~get to) [its|the] (full|maximum|maximal|greatest) \
    (extension|opening|extent|stretch)
on: (perched|balanced|seated|standing|sitting|lying|resting|poised|propped) [up] (on|upon|atop) [top of] | atop | upon
under: (beneath|underneath|below)
next to: adjacent to | alongside | by the side of | at the side of | close by | right by | hard by | in the vicinity of
~enter: (~make|~find) (it|its way|his way) (onto|on to|on) | ~set foot on | ~move up onto | ~wander onto | ~get up onto
~leave: ~get (clear|free) of | ~be clear of | ~clear of | ~part (company|ways) with | ~say goodbye to | ~get off of
~reach: ~make (it|its way|his way) [all the way|as far as|up|over] to | ~make contact with | ~collide with | \
    ~come up against | ~run (into|up against) | ~smack (into|against) | ~draw level with | ~turn up (at|by) | \
    ~pitch up at | ~fetch up (at|against|by) | ~wind up (at|against|by)
~slow down: (~lose|~shed|~drop) (speed|pace|momentum|velocity) | ~grow slower | ~ease off
~speed up: (~gain|~gather|~pick up|~build) (speed|pace|momentum|velocity) | ~grow (faster|quicker)
how long: what (amount|length|stretch|period|span) of time (~elapse|~pass|~go by|is there) (while|with|as|in \
    which|during which) | [for|over|in|during] what (stretch|length|period|amount|span) [of time] | [for] how much \
    of the {_CLIP} | how (much time|many seconds|long) (~elapse|~pass|~go by) (while|with|as|in which|during which)
how often: on how many [separate|different] occasions | (how many|what number of) (separate|different|distinct) times
how far: to what extent | how much ground | what ground | what length of [way|path|road]
when: (what|which) (second|moment|instant|point) is it (that|when) | it is when that | how (far|deep|long|many \
    seconds) into (the {_CLIP}|it) [is it] [when] | (at|by) what (stage|mark|juncture) | how (many seconds|much \
    time|many secs) (have|has|had) (passed|elapsed|gone by) (when|by the time|as) | how (many seconds|much \
    time|many secs) (~pass|~elapse|~go by) (before|until|till)
altogether: all told | all in all | in all | in sum | taken together | when all is added up
"""
_AROUND = r"""
\bbefor\b => before
^when , (?:finally|at last|exactly|precisely|roughly|eventually) , => when
\b(\d+) and a half seconds\b => \1.5 seconds
 or (?:does it |is it |do they )?(?:just |simply |only )?(?:sit|stand|stay|lie)s?(?: (?:there|still|put))+$ =>
\b(?:drive|go|get|roll|walk|move) anywhere\b => move
^(?:\w+ , )?(which|what) (wall|corner) 's (the \w+(?: \w+)?) => \1 \2 is \3
^((?:the|that|this|my) \w+(?: \w+)?) (?:is|stands|sits|hangs|lies|leans) (?:(?:placed|placed right|right|set|fixed) )?\
(?:up )?(?:against|at|on|in|along|by) (which|what) wall\b.*$ => which wall is \1 at
^what about (the \w+(?: \w+)?) , (does|did|is|has|will) (?:that|it|this) => \2 \1
^(?:(?:give|tell) me )?(?:the )?time (the \w+(?: \w+)?) (?:needs|takes|uses) for (?:one|a|each|every) (?:full |whole |\
complete |single )?(?:turn|round|rotation|revolution)$ => how long does one turn take \1
 , (?:both|all|the two) (?:legs|parts|stretches|stages)(?: of .+?)?(?: included| together| combined)?$ =>
^(?:quick |short |brief )?(?:summary|recap|overview|rundown)(?: of .+?)? , (?=\w) =>
^(?:and |so |but )?after(?:wards)? , (?=\w) =>
 , i mean , (?:is|are|does|do|did|has|was|what|when|how|where|which) .+$ =>
\b(spi|ru|begi)ning\b => \1nning
\b(sto|dro|sli|fli)ping\b => \1pping
\b(hi|si|ge|shu)ting\b => \1tting
\bhow much of time\b => how much time
\bmakes? (?:its|his|her|an|the) (?:entrance|entry) (?:onto|on to|on|into|to)\b => enters
\bwhen the curtain (?:falls|comes down)(?: on (?:this|the) \w+)?\b => at the end
\b(?:what|which) speed (?:does|did) (.+?) (?:keep|hold|have|go at)\b => what is the speed of \1
^on average , what is the speed => what is the average speed
^(what is the average speed of .+?) from (?:when (?:it|he|she)|its|his|the) (?:sets off|starts|start|begins|beginning|\
leaves|first movement)(?: to move)? (?:to|until|till) (?:when )?(?:it|he|she|its|the)? ?(?:hits?|reaches|touches|\
stops?|end|ends|arrives|finishes|rest)\b.*$ => \1
^how long (?:did|does) it take (the \w+(?: \w+)?) to (?:get|go|swing|slide|come|move) from (?:closed|shut) to (?:its \
widest|fully open|wide open|open|all the way open|its maximum)$ => how long does \1 take to open
^how long (?:did|does) it take (the \w+(?: \w+)?) to (?:get|go|swing|slide|come|move) from (?:fully |wide )?open to \
(?:closed|shut)$ => how long does \1 take to close
\b(?:stands?|sits?|stays?|remains?|waits?|hangs?)(?: there| out)? (?:all the way|fully|completely|wide|entirely) \
(?:open|out)\b => stay fully open
^how long does (.+?) (?:hold still|stay still|wait|rest|stay|pause|stop|stand still) (?:while|when) (?:it is )?(?:all \
the way|fully|completely) (?:out|open)$ => how long does \1 stay fully open
\b(?:make|makes|made) it (?:all the way )?back in\b => close
^(?:what is )?the (?:maximum|max|maximal|greatest|full|total) (?:extension|opening|extent|travel) of (.+?)(?: in \
(\w+))?$ => how many \2 does \1 open
^(the \w+(?: \w+)?) (clos|mov)es( again| back)? or (?:no|not)$ => does \1 \2e\3
^(the \w+(?: \w+)?) (open|fall|turn|stop|roll)s( again| back)? or (?:no|not)$ => does \1 \2\3
\b(how many (?:full |complete )?(?:turns|rounds|rotations) does .+?) give(?: us| me)?\b => \1 make
^(?:it|they|he|she) (.+?) where , (the \w+(?: \w+)?)(?: , (.+))?$ => where do \2 \1 \3
\bthe (fall|drop|start|stop|landing|turn) of the (red|green|blue|yellow|white|black|brown) (\w+) and (?:the one|that) \
of the (\w+)(?: one)?$ => the \1 of the \2 \3 and the \1 of the \4 \3
^(the \w+(?: \w+)?) turns (?:to|toward) which (?:side|direction|way)(?: , .+)?$ => which way does \1 turn
^on what (?:is|are) (?:put |placed |standing |set |sitting )?(the .+)$ => what is \1 on
^(?:[^,]+) (?:my|the|our) (\w+(?: \w+)?) , i (?:hope|think|guess|suppose|bet|trust) , (does|did|is|has) it\b => \2 \
the \1
^(?:out )?of (?:everything|all (?:the )?(?:things|objects|items|stuff)|the things|the objects)(?: (?:here|there|in \
(?:the|this) room|in the scene|around))? , => 
 , if any(?:thing|one|body)?(?: at all)? ,(?= ) =>
^(what|which|which \w+) , if any(?:thing)? , => \1
^(?:it is|is it) (?=(?:which|what|when|where|how)\b) =>
^(?:(?:i |we )?(?:need|want|log|mark|note|give(?: me| us)?|show(?: me| us)?|get(?: me| us)?|tell(?: me| us)?) )?(?:\
the )?(?:exact )?(?:time|second|moment|instant|timestamp|timecode)(?: (?:when|that|at which))?(?= (?:the|our|that) \
[a-z]+(?: [a-z]+)? (?:hits|reaches|starts|stops|begins|ends|comes|gets|arrives|leaves|touches|lands|falls|opens|closes|\
turns|moves|halts|is (?:fully |all the way |completely )?(?:open|closed|shut)|has)\b) => when
^(?:at |in )?(\w+(?:\.\d+)?) seconds?(?: in)? , has (.+?) (?:already|yet) (.+)$ => has \2 \3 by \1 seconds
^has (.+?) (?:already|yet) (.+) at (\w+(?:\.\d+)?) seconds?$ => has \1 \2 by \3 seconds
\bfull (?:spins|laps|circles|rounds|rotations|circuits) => full turns
^(how many full turns (?:does|did|has) .+?) (?:gets? in|puts? in|fits? in|manages?|completes?)\b => \1 make
^(?:once|after|when) (?:it|he|she|the \w+(?: \w+)?) has turned , (how (?:far|many meters)\b.+)$ => \1 after the turn
 ,? (?:ladies and gentlemen|folks|guys|everybody|everyone|my friends?|people)$ =>
^(?:from (?:the )?first frame of movement to (?:the )?last|from first to last frame of movement) , how long => how long
^(.+) , how long (does it (?:run|take|last)) from first frame of movement to (?:the )?last$ => how long does \1 take
^(\w+(?:\.\d+)?) seconds? on the clock , (.+)$ => \2 at \1 seconds
\bin second (\d+(?:\.\d+)?) => at \1 seconds
\b(?:one|a single|a) (?:trip|time|go|full trip|full circle|complete circle|lap|circle)(?: round| around)? => one turn
(?<=\w)(?: ,)? by the end(?: of (?:it|the (?:film|clip|video)))?$ =>
^(?:(?:please|pls|now|so|and|just|kindly) )*(?:pinpoint|state|specify|identify|indicate|determine|calculate|compute|\
work out|figure out|find out|find|estimate|express|report|provide|quote|note|establish|read off|measure)(?: (?:me|\
us))? (?:an? (?:estimate|idea|figure) (?:of|for) )?(?=(?:the|when|what|where|which|how|at|its)\b)(?!the (?:things?|\
objects?|items?|events?|books?|order|sequence)\b) =>
^(?:tot up|add up|sum up|total up|count up|sum) (?:all )?(?:of )?the (meters?|centimeters?|cm|degrees|seconds|turns|\
revolutions) (?:that )?(.+)$ => how many \1 does \2
^(?:tot up|add up|sum up|total up) (?:all )?(?:of )?(?:the )?(?:walking|rolling|moving|travelling|traveling|distance|\
way|ground)(?: that)? (.+?) (?:does|makes|covers|do|walks|rolls|goes|puts in)((?: ,)? in \w+)?$ => how far does \1 \
move in total\2
^(?:sort|order|rank|arrange|list|line up|put) (the \w+(?: \w+)?) (?:in order )?(?:by|according to|in the order of) \
(?:the )?(?:moment|time|second|instant|order)s?(?: (?:when|at which|in which|that|of))? (?:they|their) (\w+(?: \
(?:down|over|off|to the (?:floor|ground)))?)$ => in what order do \1 \2
^i am (?:curious|keen|eager|itching|dying|interested)(?: (?:to (?:know|learn|find out|hear)|in|about))? (?=(?:when|\
what|where|which|how|at|whether|if)\b) =>
^(?:give|tell|show)(?: (?:me|us))? an? (?:estimate|idea|figure|number) (?:of|for) =>
^(?:would|is|was) it (?:be )?(?:fair|right|correct|true|accurate|safe|reasonable|wrong not) to (?:say|claim|think|\
assume|state)(?: that)? =>
^(?:is it|would it be) (?:a fact|the case|true|so|right|correct)(?: that)? (?=the |it |there |nothing |everything ) =>
^(?:can|could|may|might|do|should) (?:i|we|one|you) (?:safely )?(?:say|assume|conclude|take it|claim)(?: that)? \
(?=the |it |there |nothing |everything |all ) =>
^(?:what|which) (?:stops|halts|brings|brought|stopped) (the \w+(?: \w+)?)(?: to (?:a|its) (?:\w+ )?(?:halt|stop|\
standstill|rest))?$ => what does \1 hit
^(is it) (the \w+(?: \w+)?) that (?:is|was|lies|sits) (under|beneath) (the \w+(?: \w+)?)((?: at| when) .+)?$ => is \4 \
on \2\5
^(is it) (the \w+(?: \w+)?) (?:that|which) (?=\w+s\b) => does \2
\b(bump|bumps|bumped|bumping|ram|rams|rammed|knock|knocks|smack|smacks|clip|clips|graze|grazes|bang|bangs) (?=(?:the|\
a|any) \w) => hits
\bwith (\w+(?:\.\d+)?|\w+ and a half) seconds? (?:gone|passed|elapsed|on the clock|behind us|in)\b => at \1 seconds
\b(?:after|once|when) (\w+(?:\.\d+)?|\w+ and a half) seconds? (?:have|has|had|are|is) (?:passed|elapsed|gone by|gone|\
up|over)\b => at \1 seconds
\bwhen the (?:clock|timer|counter|timecode|timeline|time) (?:shows|reads|says|hits|reaches|is at|stands at|gets to) \
(\w+(?:\.\d+)?)(?: seconds?| s)? => at \1 seconds
\b(\w+(?:\.\d+)?|\w+ and a half) seconds? (?:from|after|past|since) (?:the )?(?:start|beginning|outset|opening)(?: of \
the \w+)?\b => at \1 seconds
\b(at|by|before|after|until) (?:the )?(\d+(?:\.\d+)?) second (?:point|mark|stage) => \1 \2 seconds
\b(?:a|one) quarter (?:of )?a second\b => 0.25 seconds
\bthree quarters of a second\b => 0.75 seconds
\bhalf a second in(?:to (?:it|the \w+))?\b => at 0.5 seconds
\bin the (?:final|last|closing) half (?:a )?second\b => in the last 0.5 seconds
\bin the (?:first|opening|initial) half (?:a )?second\b => in the first 0.5 seconds
 (?:on|along|over|during|throughout) (?:its|the|his) (?:way|journey|trip|path|travels|course|movement|run|walk)(?: \
(?:across|through) the (?:room|floor))?$ =>
 in the process$ =>
^the (start|beginning|onset) of (the .+?) 's (\w+)$ => when does \2 start to \3
^the (?:end|finish|conclusion) of (the .+?) 's (?:\w+)$ => when does \1 stop
^(?:is|are) there (anything|something|any \w+) (?:left |still |else )?(?=\w+ing\b|in motion|on the|in the air|open\b|\
at rest) => is \1
^(how many .+?) (?:puts?|leaves?) behind (?:it|him|itself|himself)$ => \1 moves
^(next to|beside|at|by|near|in front of|against|alongside) (?:which|what)(?: (?:thing|object|piece of furniture|\
item))? (?:does|do|did|is|was) (.+?) (?:starts? (?:to move|off|out|from)|starts?|begins?|sets? (?:out|off)|starting)$ \
=> where is \2 at the start
^(next to|beside|at|by|near|in front of|against|alongside) (?:which|what)(?: (?:thing|object|piece of furniture|\
item))? (?:does|do|did|is|was) (.+?) (?:stops? moving|stops?|ends? up|ends?|finish(?:es)?|comes? to rest|halts?|wind \
up|winds up)$ => where does \2 stop
^(?:what|which)(?: thing| object| piece of furniture| place| spot)? (?:does|do|did) (.+?) (?:sets? (?:out|off) from|\
starts? (?:out |off )?(?:from|at|by|beside|next to)|begins? (?:at|from|by|beside|next to)|departs? from|comes? from)$ \
=> where is \1 at the start
^(?:what|which)(?: thing| object| piece of furniture| place| spot)? (?:does|do|did) (.+?) (?:stops?|ends?(?: up)?|\
finish(?:es)?|halts?|comes? to rest|winds? up)(?: moving)? (?:at|by|beside|next to|near|in front of|against)$ => \
where does \1 stop
^how (?:many|much) (.+?) (?:does|do|did|is) (.+?) average((?: .+)?)$ => what is the average speed of \2 in \1\3
\b(?:in the (?:middle|midst|process|act|course) of|busy) (?=\w+ing\b) =>
^(?:what is )?the (?:total |exact |overall )?(?:number|count|tally) of (\w+) (?:that|which) (.+)$ => how many \1 \2
^how long (?:is )?(the \w+(?: \w+)?) (?=fully|out\b|open|still\b|at rest|closed|motionless) => how long is \1
\bflush(?: with (?:the|its) \w+)?(?: again)? => closed
^(which \w+) (?:is it )?that (?=\w+s\b) => \1
\b(takes?|needs?|took|needed) to (open|close|shut)(?: up)? (?:all the way|fully|completely|entirely)\b => \1 to \2
^(.+?) (?:lasts?|takes?|needs?|requires?) how (long|many seconds|much time)((?: ,)? .+)?$ => how \2 does \1 take\3
^(?:how long|how many seconds|how much time) does (?:a|one|each|every) (?:single |full |complete |whole )*(?:turn|\
rotation|revolution|round|circle|lap|spin|go round)(?: of (.+?))? (?:takes?|lasts?)$ => how long does one turn take \1
\b(describe|trace|traces|describes|reel off|clock up|clocks up|rack up|racks up|manage|manages) (?=(?:\w+ )?(?:turns?|\
circles?|rotations?|revolutions?|rounds?|laps?)\b) => make
^(?:when )?(?:seen|viewed|looking|looked at|watched|as seen|if you look|if one looks|if seen)(?: down)?(?: (?:at it|\
on it|straight down))? (?:down )?from (?:above|the top|overhead|the ceiling)(?: down)? , =>
^(?:which|what)(?: is the)? (?:sense|direction) of (?:rotation|turning|spin|travel)(?: (?:does|has|of|is))? (.+?)(?: \
(?:have|has|follow|take))?$ => which way does \1 turn
^(?:who|which one) is (first|last) to (\w+(?: \w+)?)(?: ,)? (?:among|of|out of) the (\w+)$ => which \3 \2 \1
^how (?:sharp|sharply|tight|tightly|steep|much) (?:is|does) (.+?)(?: 's (?:turn|bend|corner|curve)| turn| swing round|\
 swing around| turning)((?: ,)? in \w+)?$ => how far does \1 turn\2
^how long is the (?:stretch|leg|part|bit|section|distance|path|way|piece|route) (?:that |which )?(the \w+(?: \w+)?|it|\
he|she) (?:walks|moves|rolls|goes|covers|travels|slides)((?: .+)?)$ => how far does \1 move\2
^(?:what|how much) (?:distance|way|ground) (?:remains|is left|is still left)(?: to go)? (?:for (.+?) )?(after .+)$ => \
how far does \1 move \2
\b(?:ahead of|prior to|in advance of|leading up to) (?=(?:the|its|his|her) (?:turn|corner|bend|fall|drop|stop|start|\
opening|closing)\b|turning|falling|stopping|starting|opening|closing) => before
\bthan (?:following|subsequent to) (?=(?:the|its|it|that)\b) => than after
^((?:ends?|stops?|finish(?:es)?|starts?|begins?|opens?|closes?|turns?|moves?|rolls?|falls?|walks?|goes|comes)\b.*?) , \
(the \w+(?: \w+)?)$ => does \2 \1
^((?:for )?how long .+?) before (?:the|this|that) (?:clip|video|film|movie|scene|shot|recording) (?:ends|is over|\
finishes|stops|is done)$ => \1
^when before (.+)$ => how long until \1
^(?:no )?(?:wait|scratch that|correction)(?: no)? , =>
^(?:pray|do) tell(?: me)? , =>
^(?:if|say|suppose|assume|let us say|imagine|supposing)(?: that)? (?:i|we|you|one) (?:look|pause|paused|stop|stopped|\
freeze|froze|peek|check|looked)(?: (?:it|the \w+|in|there))? (at .+?) , => \1 ,
^will (?:i|we|you|one) (?:find|see) (the \w+(?: \w+)?|it) (?=(?:fully |half )?(?:open|closed|shut|moving|turning|\
still|on|in)\b) => is \1
 in (?:that|this) (?:frame|moment|instant|picture)$ =>
\b(?:the |this )?(?:clip|video|film|movie) (?:'s|is|has|was) (?:finished|over|done|through|ended|up)\b => the clip ends
\b(when|as|once|before) (?:the )?(clip|video|film|movie|scene|recording) (?:began|started|opened)\b => \1 the \2 starts
^how (?:much time|long|many seconds) (?:do|have|must|will|would) (?:i|we|you|one) (?:have|got|wait|have to wait|need \
to wait)(?: left)? (?:before|until|till) => how long until
^how (?:long|many seconds|far) into (?:the \w+|it) before => how long until
^the (?:sole|only|single|one|lone) (\w+ing) (?:object|thing|item|one)$ => what is \1
\bis the (\w+ing) (?:one|thing|object)$ => is \1
^(which \w+) (?:in|of|on|among) (?:the|this|that) (?:dresser|chest|cabinet|shelf|board|room|cupboard) (?=(?:is|are|\
does|do|has|moves|falls|opens|slides|comes|turns|stays)\b) => \1
\b(?:pushed|shoved|struck|nudged|knocked|poked|prodded) by (?=anything|something|the) => hit by
^when does (?:the |all |any |all the )?(?:motion|movement|action|moving)(?: (?:here|in (?:the|this) room))? (?:stops? \
moving|ends?|stops?|ceases?|is over|die down|dies down|finish|finishes)(?: for (?:good|the last time))? => from which \
moment on is everything still
(?: ,)? (?:when|if|as) (?:you|one|we|i)? ?(?:look|looks|looking|seen|viewed|see it|watched|watch it) (?:down )?(?:at \
it )?(?:straight )?from (?:above|overhead|the top|up top)$ =>
\b(what|which|who|does|is|anything|thing) (?:up|down|over|in|out) (?:there|here)\b => \1
^(?:by )?how (?:many seconds|much time|much|long) (?:does|do|did) (.+?) (?:precede|lead|beat) (the .+)$ => how much \
earlier does \1 start to move than \2
^(?:by )?how (?:many seconds|much time|much|long) (?:does|do|did) (.+?) (?:follow|trail|lag behind|trail behind|come \
after) (the .+)$ => how much later does \1 start to move than \2
\bat (?:exactly )?the (?:same|very same) (?:moment|instant|second)\b => at the same time
\b(?:in unison|in sync|concurrently|side by side in time)\b => at the same time
^(which \w+) is the only (?:one|book|thing|object)(?: that is| which is)? (?:left |still |remaining )?(?=on|in|open|\
moving|falling) => \1 is
^(from .+ (?:to|until|till) .+) , how (?:much time|long|many seconds) (?:passes|elapses|goes by|is it|is that|does it \
take|go by|pass|is there)$ => how long is it \1
^(?:the )?([a-z]+(?: [a-z]+)?) or (?:the )?([a-z]+(?: [a-z]+)?) , (which|what)(?: one| of them| of the two)? (?:is it \
that |is it )?((?:is |does )?\w+s?\b.*)$ => \3 \4 , the \1 or the \2
(?: (?:on|in|for|over|during|along))? (?:the|its|his) (?:first|initial) (?:leg|stretch|section|straight)(?: of (?:the|\
its|his) (?:way|walk|trip|journey|path))?$ => before the turn
(?: (?:on|in|for|over|during|along))? (?:the|its|his) (?:second|last|final) (?:leg|stretch|section|straight)(?: of \
(?:the|its|his) (?:way|walk|trip|journey|path))?$ => after the turn
^how (long|many seconds|much time) does (?:the|its|his) (?:second|last|final) (?:leg|stretch|section|straight)(?: of \
\w+ \w+)? take(?: (the .+|it))?$ => how \1 does \2 move after the turn
^how (long|many seconds|much time) does (?:the|its|his) (?:first|initial) (?:leg|stretch|section|straight)(?: of \w+ \
\w+)? take(?: (the .+|it))?$ => how \1 does \2 move before the turn
\b(?:full|complete|entire) (?=distance|way|path|route) => total
^(?:what is |what was )?(?:the )?(?:total )?(?:distance|way|path) (?:that )?(?:is |was )?(?:walked|covered|travell?ed|\
moved|rolled|made) by (.+)$ => how far does \1 move
\b(is|was) (the \w+(?: \w+)?|it) (?:already |now |still )?(?:on|along) (?:its|the|his) way (?:to|towards?) (?=the ) \
=> \1 \2 approaching
(?: by)? (?:even |so much as |as much as )?(?:a|an|one) (?:single )?(?:centimeter|inch|millimeter|hair|iota|jot|whit|\
fraction|hair 's breadth)(?= at|$) =>
^(?:the )?(.+?) 's (?:final|last|end|ultimate|eventual) (?:location|position|place|spot|destination|whereabouts)$ => \
where does \1 stop
^(?:the )?(.+?) 's (?:initial|first|starting|original|opening) (?:location|position|place|spot|whereabouts)$ => where \
is \1 at the start
^(?:what|where) is (?:the )?(?:final|end|last) (?:location|position|place|spot) of (.+)$ => where does \1 stop
^(?:what|where) is (?:the )?(?:initial|starting|first|original) (?:location|position|place|spot) of (.+)$ => where is \
\1 at the start
^(how many .+?) (?:are|is|lie|lies) (.+?) after (\w+(?:\.\d+)?|\w+ and a half) (seconds?|secs?|s)$ => \1 are \2 at \3 \
\4
^(.+?) , (?:start to finish|from start to stop|beginning to end|from beginning to end|all in|in full) , => \1
^(?:the )?(?:whole|entire|full|complete) (\w+) (takes?|lasts?) => the \1 \2
^how (?:many) steps (?:does|do|did|has|have) (.+?) (?:take|make|do|walk|taken|made|done|need)(?: altogether| in \
total)?((?: .+)?)$ => how often does \1 bob\2
^(?:the )?number of steps (?:of|taken by|made by) (.+)$ => how often does \1 bob
^how (?:long|many seconds|much time) (?:does|is|do) (?:one|a|each|every)(?: single)? step(?: of (.+?))?(?: take| \
last)?(?: (the .+|it))?$ => how long does \1 \2 bob once
^how (?:long|many seconds|much time) does (.+?) (?:take|need|use) (?:for|per) (?:one|a|each|every|\b)(?: single)? \
?step$ => how long does \1 bob once
^how (?:long|many seconds|much time) does it take (?:for )?(the \w+(?: \w+)?|it) (?:to|for) (?:turn|go|spin|rotate|\
revolve|complete|make|do|come)(?: round| around| full circle)*(?: (?:exactly )?once| one time| a single time| (?:a|\
one)(?: full| complete| whole| single)? (?:turn|rotation|revolution|round|circle|lap|spin))$ => how long does one \
turn take \1
^how (?:long|many seconds|much time) does (the \w+(?: \w+)?|it) (?:take|need) to (?:turn|go|spin|rotate|revolve|\
complete|make|do|come)(?: round| around| full circle)*(?: (?:exactly )?once| one time| a single time| (?:a|one)(?: \
full| complete| whole| single)? (?:turn|rotation|revolution|round|circle|lap|spin))$ => how long does one turn take \1
\b(first|second|third) (\w+) 's (\w+) (to|and|until) the (second|third|last)(?: one)? 's$ => \1 \2 's \3 \4 the \5 \2 \
's \3
^(?:what|which) colou?r is the (first|second|third|last) (\w+) to (\w+)$ => what color is the \2 that \3s \1
^(?:through )?(?:what|which) angle (?:does|is|did) (.+?) (turn|swing|rotate|open|pivot|turned|swung)(?: through| \
by)?$ => how many degrees does \1 \2
^(which way|where|in which direction) (does .+?|is .+?) (?:first|at first|initially|to begin with|to start with)$ => \
\1 \2 before the turn
(the \w+)((?: than| and| to| until| before| after)(?: (?:when|the moment|as|once))*(?: it| he| she)? (?:leaves|exits|\
enters|reaches|touches|hits|quits|crosses|leaving|exiting|entering|reaching|getting off|rolling off)) it\b => \1\2 \1
\b(?:bounces?|rebounds?|ricochets?)(?: back)? (?:off|from|away from) (?:the |a )\w+ => come back
^does (.+?) (open) and (close) (?:at the same (?:speed|pace|rate)|equally (?:fast|quickly))$ => does \1 \2 as fast as \
it \3s
^does (.+?) (?:go|come|slide|move) out and (?:in|back|back in) (?:again )?(?:at the same (?:speed|pace|rate)|equally \
(?:fast|quickly))$ => does \1 open as fast as it closes
^how high(?: up)? is (.+?) (at|when|before|after|once) => how high above the floor is \1 \2
^when (?:has|does|did|will|is) (.+?) (?:be |have )?(?:done|made|completed|complete|finish|finished|make|do|turned|\
turn|rotated|rotate|spun|spin|gone|go)(?: round| around)? (twice|three times|four times|five times|(?:its |the \
)?(?:second|third|fourth|fifth|2nd|3rd|4th)(?: full| complete| whole)? (?:turn|rotation|revolution|round|circle|lap)|\
(?:one|two|three|four|five|\d+|half a)(?: full| complete| whole)? (?:turn|rotation|revolution|round|circle|lap)s?)$ \
=> when has \1 made @\2@
^(?:after|by) how (?:many seconds|long) (?:has|does) (.+?) (?:done|made|completed|complete|made|turned|turn)(?: round|\
 around)? (twice|three times|four times|five times|(?:its |the )?(?:second|third|fourth|fifth|2nd|3rd|4th)(?: full| \
complete| whole)? (?:turn|rotation|revolution|round|circle|lap)|(?:one|two|three|four|five|\d+|half a)(?: full| \
complete| whole)? (?:turn|rotation|revolution|round|circle|lap)s?)$ => when has \1 made @\2@
"""


@cache
def _turns() -> tuple[tuple[re.Pattern[str], str], ...]:
    rows = []
    for line in _TURNS.strip().splitlines():
        plain, _, notation = line.partition(": ")
        rows.append((re.compile(rf"(?<![^ ])(?:{pattern(notation)})"), plain))
    return tuple(rows)


@cache
def _around() -> tuple[tuple[re.Pattern[str], str], ...]:
    rows = []
    for line in _AROUND.replace("\\\n", "").strip("\n").split("\n"):
        said, _, plain = line.partition("=>")
        clause = re.sub(r"^\^", r"(?:^|(?<= , ))", said[:-1])  # a time may stand before a clause
        rows.append((re.compile(clause), f" {plain.strip()} " if plain.strip() else " "))
    return tuple(rows)


_TENTHS = re.compile(r"\b(?P<n>\w+) tenths? of a second\b")
_COUNTED = re.compile(r"@(.+?)@")
_TURNS_SAID = (
    ("two", r"\b(?:twice|second|2nd)\b"), ("three", r"\b(?:three times|third|3rd)\b"),
    ("four", r"\b(?:four times|fourth|4th)\b"), ("five", r"\b(?:five times|fifth)\b"), ("half a", r"\bhalf\b"),
)  # fmt: skip
_THOUSANDTHS = re.compile(r"\b(?P<n>\d+) (?:milliseconds|ms|millis)\b")


def everyday(said: str) -> str:
    """The words of a question with plain ones in place of turns of everyday English."""
    said = said.replace("metre", "meter")
    said = _TENTHS.sub(lambda m: f"{seconds(m['n']) / 10:g} seconds" if re.fullmatch(NUMBER, m["n"]) else m[0], said)
    said = _THOUSANDTHS.sub(lambda m: f"{int(m['n']) / 1000:g} seconds", said)
    for row, plain in _turns():
        said = row.sub(partial(_replaced, plain), f"{said} ").strip()
    for row, plain in _around():
        said = re.sub(r" +", " ", row.sub(plain, said)).strip(" ,")
    return _COUNTED.sub(_turns_said, said)


def _turns_said(found: re.Match[str]) -> str:
    """A number of turns as it is read: "@twice@" is "two full turns"."""
    told = next((n for n, row in _TURNS_SAID if re.search(row, found[1])), found[1].split()[0])
    return f"{told} full turns"


def _replaced(plain: str, found: re.Match[str]) -> str:
    return f"{_in_form(plain, found[0].split()[0])} "


def _in_form(plain: str, like: str) -> str:
    """Plain words whose first is a verb ("~start to move") in the form of another verb: "springing" is "starting"."""
    if not plain.startswith("~"):
        return plain
    verb, _, rest = plain[1:].partition(" ")
    return f"{inflected(verb, like)} {rest}".strip()
