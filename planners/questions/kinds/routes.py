"""Ways through the room: whether one can walk from here to there, by which way, how far it is, and what blocks it."""

from __future__ import annotations

from collections.abc import Callable

from ....gaussians.world.person import SHOULDERS
from ..answer import Answer, Evidence
from ..candidates import agreed
from ..floor import ends
from ..floor.routes import Route, in_the_way, is_open, passage, route
from ..kind import Asked, Kind
from ..reading.ends import Walker
from ..reading.phrase_templates import templates
from ..reading.spans import METRE, answer_of, told
from ..survey import NotResolved, Survey, listed

PACE, STRIDE = 1.3, 0.7  # metres a second and metres a step of a walking adult

_GO = (
    "(walk|get|go|reach|make it|make my way|pass|cross|stroll|wander|travel|run|step|move|head|come|navigate|"
    "roll|drive|be pushed|be wheeled|pass through)"
)
_EASILY = "[actually|easily|still|freely|comfortably|safely|even|directly|physically|realistically|always]"
_OVER = (
    "[straight|directly|over|across|all the way|on foot|right|safely|easily|freely|comfortably|unobstructed|unhindered]"
)
_END = (
    "[on foot|without (moving|having to move|having to shift|shifting|having to step over|stepping over|"
    "having to climb over|"
    "climbing over|bumping into|hitting|touching|tripping over|running into|knocking over|squeezing past|"
    "squeezing|moving away|"
    "having to go around|going around|any obstacles|obstacles|obstruction|difficulty|problems|any trouble|trouble) "
    "[anything|any furniture|any of the furniture|furniture|something|things|any things|the furniture|"
    "obstacles|any obstacles]|"
    "with (the furniture|everything|things|the chairs|all the furniture) (where it is|where they are|as it is|"
    "as they are) [now]|"
    "as (it is|things are|it stands|things stand)|in a straight line|safely|easily|freely|comfortably|"
    "unobstructed|at all|unhindered|directly]"
)
_MODAL = "(can|could|would|will|may|might|should|shall)"
_PATH = "(path|route|way|walkway|passage|corridor|aisle|passageway|walking path|walking route|line|access)"
_CLEAR = (
    "[clear|free|walkable|direct|unobstructed|open|accessible|clear and free|unblocked|safe|decent|easy|usable|"
    "possible|continuous|practicable|passable]"
)
_FROM_TO = "(from {a:end} [over|across|all the way|right|straight|through] to {b:end}|between {a:end} and {b:end})"

_CAN = f"""
    (starting|coming|going|walking|beginning) (at|from) {{a:end}} {_MODAL} {{w:walker}} {_EASILY} \
      (get|walk|go|come|make it) {_OVER} to {{b:end}} {_END}
    {_MODAL} {{w:walker}} {_EASILY} {_GO} {_OVER} from {{a:end}} {_OVER} (to|up to|over to|into|onto) {{b:end}} {_END}
    {_MODAL} {{w:walker}} {_EASILY} (walk|get|go|make it|make my way|come|drive|roll|travel|move|step|pass) \
      {_OVER} (to|up to|over to|near) {{b:end}} (from|coming from|starting from|starting at) {{a:end}} {_END}
    {_MODAL} {{w:walker}} {_EASILY} (reach|access|get at|approach|walk to|get to|go to) {{b:end}} (from|coming \
      from|starting from|starting at) {{a:end}} {_END}
    {_MODAL} {{w:walker}} {_EASILY} (reach|access|approach|get at) {{b:end}} {_END}
    {_MODAL} {{w:walker}} {_EASILY} (walk|get|go|make it|come|drive|roll|travel|move|step) {_OVER} (to|up to|over \
      to|near|as far as) {{b:end}} {_END}
    [is it|would it be|will it be] possible (for {{w:walker}} to|to) {_EASILY} {_GO} {_OVER} from {{a:end}} \
      {_OVER} to {{b:end}} {_END}
    [is it|would it be] possible (for {{w:walker}} to|to) {_EASILY} {_GO} {_OVER} between {{a:end}} and {{b:end}} \
      {_END}
    [is it|would it be] possible (for {{w:walker}} to|to) {_EASILY} (walk|get|go|make it|reach|access|get \
      at|approach) {_OVER} [to|up to|over to] {{b:end}} [from {{a:end}}] {_END}
    [am|is|are] {{w:walker}} able to {_EASILY} {_GO} {_OVER} from {{a:end}} {_OVER} to {{b:end}} {_END}
    (do|would|does|will) {{w:walker}} have [a] {_CLEAR} {_PATH} {_FROM_TO} {_END}
    (is|would) there [be] (a|any|some|one) {_CLEAR} {_PATH} [for {{w:walker}}] {_FROM_TO} [for {{w:walker}}] {_END}
    (is|would) there [be] (a|any) {_CLEAR} {_PATH} [for {{w:walker}}] (to|leading to) {{b:end}} [from {{a:end}}] \
      {_END}
    (is|would) there [be] (enough|sufficient) (room|space) [for {{w:walker}}] to {_GO} {_OVER} from {{a:end}} to \
      {{b:end}} {_END}
    BE {{b:end}} (reachable|accessible|within walking reach) from {{a:end}} [for {{w:walker}}|on foot|by foot] {_END}
    BE {{b:end}} (reachable|accessible) [for {{w:walker}}|on foot|by foot|with {{w:walker}}|by {{w:walker}}] {_END}
    (is|are) the {_PATH} {_FROM_TO} (clear|free|open|unobstructed|passable|walkable|unblocked|safe|wide enough \
      for {{w:walker}}|wide enough to walk|wide enough) {_END}
    (is|are) the {_PATH} to {{b:end}} [from {{a:end}}] \
      (clear|free|open|unobstructed|passable|walkable|unblocked|safe|wide enough for {{w:walker}}|wide enough) \
      {_END}
    (is|are) {{a:end}} and {{b:end}} connected by [a] {_CLEAR} {_PATH}
    (does|do) {{w:walker}} fit through [the {_PATH}|on the way] from {{a:end}} to {{b:end}}
"""
_BLOCKED = f"""
    (is|are) there [any|an|some] (obstacles|obstacle|obstructions|obstruction) (on the way|in the way|on the path) \
      {_FROM_TO}
    (is|are) there [any|an|some] (obstacles|obstacle|obstructions|obstruction) {_FROM_TO}
    (is|are) (the|my) {_PATH} {_FROM_TO} (blocked|obstructed|cluttered|barred|too narrow|closed off) [by \
      anything|by something|by furniture|for {{w:walker}}]
    (is|are) (the|my) {_PATH} to {{b:end}} [from {{a:end}}] (blocked|obstructed|barred|too narrow) [by \
      anything|by something|by furniture|for {{w:walker}}]
    (is|are) (there anything|anything|something|any furniture|there any furniture|there something|there any \
      obstacles|there any obstacle|any obstacles) (blocking|obstructing|in|barring) (the|my) {_PATH} {_FROM_TO}
    (is|are) (there anything|anything|something|any furniture|there any furniture|there something) \
      (blocking|obstructing|in|barring) (the|my) {_PATH} (to|of) {{b:end}} [from {{a:end}}]
    (is|are) (there anything|anything|something|any furniture|there any obstacles|there any obstacle|any \
      obstacle|any obstacles|there any furniture) (in the way|in my way|in between) [if {{w:walker}} \
      (walk|walks|go|goes)|when walking|when going|when i walk|when i go|walking|going|of someone walking] from \
      {{a:end}} to {{b:end}}
    (does|do|would|will) (anything|something|any furniture) (block|obstruct|stand in|bar) (the|my) {_PATH} {_FROM_TO}
    (does|do|would|will) (anything|something|any furniture) (block|obstruct|stand in|bar) (the|my) {_PATH} to \
      {{b:end}} [from {{a:end}}]
    (does|do) {{w:walker}} have to (step|climb|go|squeeze) (over|around|past) (anything|something) to get from \
      {{a:end}} to {{b:end}}
"""
_WHAT_BLOCKS = f"""
    what (is|stands|would be|lies|are) [blocking|obstructing|in] (the|my) {_PATH} {_FROM_TO}
    what (is|stands|would be|lies) (blocking|obstructing|in) (the|my) {_PATH} to {{b:end}} [from {{a:end}}]
    what (blocks|obstructs|bars) (the|my) {_PATH} {_FROM_TO}
    what (blocks|obstructs|bars) (the|my) {_PATH} to {{b:end}} [from {{a:end}}]
    what (is|stands|would be|gets) in (the|my) way [when walking|when going|if i walk|if i go|when i \
      walk|walking|going] from {{a:end}} to {{b:end}}
"""
_HOW = f"""
    (starting|coming|going|walking|beginning) (at|from) {{a:end}} how (do|can|could|would|should) {{w:walker}} \
      (get|walk|go|come) {_OVER} to {{b:end}} {_END}
    (starting|coming|going|walking|beginning) (at|from) {{a:end}} how (do|can|could|would|should) {{w:walker}} \
      reach {{b:end}} {_END}
    how (do|can|could|would|should|shall|might|will) {{w:walker}} [best] {_GO} {_OVER} from {{a:end}} {_OVER} to \
      {{b:end}} {_END}
    how (do|can|could|would|should|shall|might|will) {{w:walker}} [best] (get|walk|go|make my \
      way|come|reach|navigate) {_OVER} [to|over to] {{b:end}} (from|starting from|starting at|coming from) \
      {{a:end}} {_END}
    how (do|can|could|would|should|shall|might|will) {{w:walker}} [best] (get|walk|go|make my way|come) {_OVER} \
      (to|over to) {{b:end}} {_END}
    how to (get|walk|go|move|navigate) {_OVER} from {{a:end}} to {{b:end}} {_END}
    (what|which) (is|would be) [the] (best|shortest|quickest|easiest|fastest|most \
      direct|safest|clearest|simplest) {_PATH} {_FROM_TO} {_END}
    (what|which) (is|would be) [the] (best|shortest|quickest|easiest|fastest|most direct|safest|simplest) {_PATH} \
      to {{b:end}} [from {{a:end}}] {_END}
    (what|which) {_PATH} (should|do|would|can|could|must) {{w:walker}} (take|use|follow|walk|go) {_FROM_TO}
    which way (do|should|would|must|can) {{w:walker}} (go|walk|turn) to (get|walk|go) from {{a:end}} to {{b:end}}
    [give me|give|describe|show me|show|list|name] [the] [walking] (directions|route|path|way|shortest \
      path|shortest route|best route|quickest route|best path|walking route|shortest way) {_FROM_TO} {_END}
    (directions|route|path|shortest path|shortest route) to {{b:end}} from {{a:end}}
    (walk|guide|lead|take|direct|navigate) me from {{a:end}} to {{b:end}}
"""
_LENGTH = f"""
    how (long|far|many {{u:length_unit}}) (is|would be) the (walk|path|route|way|walking distance|walking \
        route|shortest \
      path|shortest route|shortest way|shortest walk|quickest route|walkway|walking path) {_FROM_TO} {_END} [in \
      {{u:length_unit}}]
    how (far|many {{u:length_unit}}) (do|does|would|must|will|should) {{w:walker}} (have to|need to) \
      (walk|go|travel|move) {_OVER} from {{a:end}} to {{b:end}} [in {{u:length_unit}}]
    how (far|many {{u:length_unit}}) (do|does|would|must|will|should) {{w:walker}} (walk|go|travel|move) {_OVER} from \
      {{a:end}} to {{b:end}} [in {{u:length_unit}}]
    how (far|many {{u:length_unit}}) (do|does|would|must|will|should) {{w:walker}} (have to|need to) (walk|go|travel) \
      {_OVER} to (get|go) from {{a:end}} to {{b:end}} [in {{u:length_unit}}]
    how (far|many {{u:length_unit}}) is it to walk {_OVER} from {{a:end}} to {{b:end}} [in {{u:length_unit}}]
    how (far|long) a walk is it from {{a:end}} to {{b:end}} [in {{u:length_unit}}]
    how far is it (on foot|walking) from {{a:end}} to {{b:end}} [in {{u:length_unit}}]
    how far is it from {{a:end}} to {{b:end}} (on foot|walking|when walking|if i walk|if you walk|by foot|along \
      the floor) [in {{u:length_unit}}]
    (what|how long|how far) is the (walking distance|length of the walk|length of the path|length of the \
      way|length of the route|length of the shortest path|length of the shortest route|path length|distance on \
      foot|route length|distance i would walk|distance to walk|distance i have to walk|shortest walking distance) \
      {_FROM_TO} [in {{u:length_unit}}]
    (what|how long) is the (shortest|quickest|best) {_PATH} {_FROM_TO} in {{u:length_unit}}
    walking distance {_FROM_TO} [in {{u:length_unit}}]
"""
_STEPS = """
    how many (steps|paces|strides) (is it|are there|would it be|does it take|would it take|do i need|would i \
      need|do you need|would it be) [to (walk|go|get)] from {a:end} to {b:end}
    how many (steps|paces|strides) (is|are) [it] (between {a:end} and {b:end}|from {a:end} to {b:end})
"""
_TIME = f"""
    how (long|many seconds) (does|would|will|might) it take [me|you|one|someone|a person] to (walk|go|get) \
      {_OVER} from {{a:end}} to {{b:end}} [on foot]
"""
_WIDTH = f"""
    how wide is the {_PATH} {_FROM_TO} [in {{u:length_unit}}]
    how wide is the (path|route|way|walkway|passage|narrowest passage|narrowest point|narrowest part|tightest \
      spot|tightest point|corridor|walking path|narrowest spot|narrowest bit|tightest squeeze|narrowest gap) [on \
      the (path|route|way|walk)|of the (path|route|way)] from {{a:end}} to {{b:end}} [at its narrowest] [in \
      {{u:length_unit}}]
    (what|how wide) is the (narrowest|tightest) (point|spot|passage|place|part|gap|bit) (on|of|along) the \
      (path|route|way|walk) {_FROM_TO} [in {{u:length_unit}}]
    how (narrow|tight) (is|does) the (path|route|way|passage|walk) {_FROM_TO} [get] [in {{u:length_unit}}]
    how wide (can|could|may) (something|a thing|a person|a trolley|a cart|an object) be to (get|go|pass|fit) from \
      {{a:end}} to {{b:end}} [in {{u:length_unit}}]
"""


def _cases(asked: Asked, survey: Survey, fn: Callable[[ends.Spot, ends.Spot], Answer]) -> Answer:
    """One answer from every start to every goal that may be meant, as far as they agree.

    A goal without a start is reached from a door; from any of several doors.
    """
    goals = ends.spots(asked.slots["b"], survey)
    start = asked.slots.get("a")
    if start is None and asked.situation is None:
        doors = ends.entrances(survey)
        cases = []
        for goal in goals:
            ways = [fn(door, goal) for door in doors]
            best = next((w for w in ways if w.answer == "yes"), ways[0])
            cases.append((goal.words, best))
        return agreed(cases)
    starts = ends.spots(start, survey, asked.situation)
    return agreed([(name, fn(a, b)) for name, a, b in ends.all_pairs(starts, goals)])


def _ids(*spots: ends.Spot) -> tuple[int | str, ...]:
    return tuple(dict.fromkeys(t.id for s in spots for t in s.things))


def _yes_no(asked: Asked, survey: Survey) -> Answer:
    try:
        return _cases(asked, survey, lambda a, b: _can(a, b, asked.slots.get("w", Walker()), survey))
    except NotResolved as error:
        return ends.absent(error, survey)


def _can(a: ends.Spot, b: ends.Spot, walker: Walker, survey: Survey) -> Answer:
    """Whether there is a way, with its length and narrowest place, or with what is in the way."""
    who = f" for {_with_article(walker.name)} of {walker.width:.2f} m" if walker.name else ""
    found = route(survey.floor, a.end, b.end, walker.width)
    if found is not None:
        widest = passage(survey.floor, a.end, b.end)
        text = f"Yes: {_way(found, a, b)}{who}; its narrowest place is about {max(widest, walker.width):.2f} m wide."
        evidence = Evidence(ids=_ids(b, a), lines=ends.lines(found))
        sure = 0.95 if widest > walker.width + 0.08 else 0.75
        return Answer(answer="yes", answer_type="yesno", text=text, confidence=sure, evidence=evidence)
    things = [survey.thing(n.id) for n in in_the_way(survey.floor, a.end, b.end, walker.width)]
    names = listed([survey.named(t) for t in things if t not in (*a.things, *b.things)] or [b.words])
    near = passage(survey.floor, a.end, b.end)
    room = f"; a passage of at most {near:.2f} m is left" if near > 0.1 else ""
    text = (
        f"No: there is no way from {a.words} to {b.words}{who or ' for a person of 0.50 m'}: {names} in between{room}."
    )
    sure = 0.9 if near < walker.width - 0.08 else 0.7
    ids = tuple(dict.fromkeys((*(t.id for t in things), *_ids(b, a))))
    return Answer(answer="no", answer_type="yesno", text=text, confidence=sure, evidence=Evidence(ids=ids))


def _way(found: Route, a: ends.Spot, b: ends.Spot) -> str:
    return f"it is a walk of {found.length:.1f} m from {a.words} to {b.words}"


def _with_article(name: str) -> str:
    return f"{'an' if name[:1] in 'aeiou' else 'a'} {name}"


def _is_blocked(asked: Asked, survey: Survey) -> Answer:
    """The opposite of whether there is a way; things in the straight line are told."""
    given = _yes_no(asked, survey)
    if given.answer not in ("yes", "no"):
        return given
    if given.text.startswith("There is no"):
        return given
    turned = "no" if given.answer == "yes" else "yes"
    text = given.text.partition(": ")[2]
    return given.model_copy(update={"answer": turned, "text": f"{turned.capitalize()}: {text}"})


def _what_blocks(asked: Asked, survey: Survey) -> Answer:
    """The things that stand in a way."""

    def case(a: ends.Spot, b: ends.Spot) -> Answer:
        things = [survey.thing(n.id) for n in in_the_way(survey.floor, a.end, b.end, SHOULDERS)]
        if is_open(survey.floor, a.end, b.end) or not things:
            return Answer(answer=(), answer_type="list", text=f"Nothing blocks the way from {a.words} to {b.words}.",
                          evidence=Evidence(ids=_ids(b, a)), confidence=0.9)  # fmt: skip
        text = f"{listed([survey.named(t) for t in things]).capitalize()} in the way from {a.words} to {b.words}."
        return Answer(answer=tuple(t.name for t in things), answer_type="list", text=text, confidence=0.85,
                      evidence=Evidence(ids=(*(t.id for t in things), *_ids(b, a))))  # fmt: skip

    return _cases(asked, survey, case)


def _routed(asked: Asked, survey: Survey, fn: Callable[[Route, ends.Spot, ends.Spot], Answer]) -> Answer:
    """`fn` of the way, or an answer without a value where there is none."""
    walker = asked.slots.get("w", Walker())

    def case(a: ends.Spot, b: ends.Spot) -> Answer:
        found = route(survey.floor, a.end, b.end, walker.width)
        if found is None:
            refusal = _can(a, b, walker, survey)
            return Answer(answer=None, answer_type="text", text=refusal.text.removeprefix("No: ").capitalize(),
                          evidence=refusal.evidence, confidence=refusal.confidence)  # fmt: skip
        return fn(found, a, b)

    return _cases(asked, survey, case)


def _directions(asked: Asked, survey: Survey) -> Answer:
    def case(found: Route, a: ends.Spot, b: ends.Spot) -> Answer:
        text = ends.directions(found, a, b, survey)
        text = f"{text[0].upper()}{text[1:]} That is {found.length:.1f} m."
        return Answer(answer=text, answer_type="text", text=text, confidence=0.9, frame="viewer",
                      evidence=Evidence(ids=_ids(b, a), lines=ends.lines(found)))  # fmt: skip

    return _routed(asked, survey, case)


def _length(asked: Asked, survey: Survey) -> Answer:
    unit = asked.slots.get("u", METRE)

    def case(found: Route, a: ends.Spot, b: ends.Spot) -> Answer:
        text = f"The shortest walk from {a.words} to {b.words} is {told(found.length, unit)} long."
        return answer_of(found.length, unit, text, confidence=0.85,
                         evidence=Evidence(ids=_ids(b, a), lines=ends.lines(found)))  # fmt: skip

    return _routed(asked, survey, case)


def _steps(asked: Asked, survey: Survey) -> Answer:
    def case(found: Route, a: ends.Spot, b: ends.Spot) -> Answer:
        steps = max(round(found.length / STRIDE), 1)
        text = f"About {steps} steps of {STRIDE} m: {_way(found, a, b)}."
        return Answer(answer=float(steps), answer_type="number", text=text, confidence=0.7,
                      evidence=Evidence(ids=_ids(b, a), lines=ends.lines(found)))  # fmt: skip

    return _routed(asked, survey, case)


def _time(asked: Asked, survey: Survey) -> Answer:
    def case(found: Route, a: ends.Spot, b: ends.Spot) -> Answer:
        seconds = max(round(found.length / PACE), 1)
        text = f"About {seconds} seconds at {PACE} m/s: {_way(found, a, b)}."
        return Answer(answer=float(seconds), answer_type="number", text=text, confidence=0.7, unit="s",
                      evidence=Evidence(ids=_ids(b, a), lines=ends.lines(found)))  # fmt: skip

    return _routed(asked, survey, case)


def _width(asked: Asked, survey: Survey) -> Answer:
    unit = asked.slots.get("u", METRE)

    def case(a: ends.Spot, b: ends.Spot) -> Answer:
        widest = passage(survey.floor, a.end, b.end)
        text = (
            f"The widest thing that gets from {a.words} to {b.words} over the floor is about {told(widest, unit)} wide."
        )
        found = route(survey.floor, a.end, b.end, max(widest - survey.floor.cell, 0.05))
        evidence = Evidence(ids=_ids(b, a), lines=ends.lines(found) if found else ())
        return answer_of(widest, unit, text, confidence=0.75, evidence=evidence)

    return _cases(asked, survey, case)


BLOCKED = Kind("way is blocked", templates(_BLOCKED), _is_blocked)
KINDS = (
    BLOCKED,
    Kind("way is open", templates(_CAN), _yes_no),
    Kind("what blocks a way", templates(_WHAT_BLOCKS), _what_blocks),
    Kind("length of a walk", templates(_LENGTH), _length),
    Kind("directions", templates(_HOW), _directions),
    Kind("steps of a walk", templates(_STEPS), _steps),
    Kind("time of a walk", templates(_TIME), _time),
    Kind("width of a way", templates(_WIDTH), _width),
)
