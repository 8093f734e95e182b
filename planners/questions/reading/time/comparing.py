"""Reads comparisons as questions for two numbers, or for one that is held against a number that is said.

"Does it open faster than it closes?" asks "how fast does it open" and "how fast does it close"; "does the fan turn
faster than 30 rpm?" asks "how fast does the fan turn in rpm". How these are answered is known elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

from .....gaussians import late_re as re
from .deeds import as_noun, said_in
from .happenings import thing
from .moments import NUMBER, SECONDS, is_main, seconds, without_time

Relation = Literal["more", "less", "same", "at_least", "at_most"]
Asks = Literal["yesno", "which", "difference"]


@dataclass(frozen=True)
class Comparison:
    """Two numbers, or one and a number that is said.

    Attributes:
        relation: in which the first must stand to the second.
        first, second: ways of asking for the numbers, the likeliest first; `second` is empty where one is said.
        asks: "yesno", "which" of the two is more (or less), or by how much they differ.
        number: what is said, in `unit`; or the share of the second that is meant.
        unit: as said, "" if the second is asked for.
        names: what the two are called, of "which".
        denied: whether it is said not to be so.
    """

    relation: Relation
    first: tuple[str, ...]
    second: tuple[str, ...] = ()
    asks: Asks = "yesno"
    number: float = 1.0
    unit: str = ""
    names: tuple[str, ...] = ()
    denied: bool = False


# What a comparing word asks for, and whether it means less of it.
_WORDS: dict[str, tuple[str, bool]] = {
    "faster": ("how fast", False), "quicker": ("how fast", False), "slower": ("how fast", True),
    "more quickly": ("how fast", False), "more rapidly": ("how fast", False), "more slowly": ("how fast", True),
    "longer": ("how long", False), "shorter": ("how long", True), "more time": ("how long", False),
    "less time": ("how long", True), "a longer time": ("how long", False), "a shorter time": ("how long", True),
    "farther": ("how far", False), "a longer way": ("how far", False), "a shorter way": ("how far", True),
    "a longer distance": ("how far", False), "a shorter distance": ("how far", True),
    "a greater distance": ("how far", False), "more distance": ("how far", False), "less far": ("how far", True),
    "wider": ("how far", False), "more": ("how far", False),
    "more often": ("how often", False), "less often": ("how often", True),
    "later": ("when", False), "earlier": ("when", True), "sooner": ("when", True),
}  # fmt: skip
_PLAIN = {
    "fast": "how fast", "quick": "how fast", "quickly": "how fast", "slow": "how fast", "slowly": "how fast",
    "rapidly": "how fast", "long": "how long", "much time": "how long", "far": "how far", "wide": "how far",
    "often": "how often", "many times": "how often", "late": "when", "early": "when",
}  # fmt: skip
_EQUAL_NOUNS = {
    "time": "how long", "amount of time": "how long", "length of time": "how long", "duration": "how long",
    "long": "how long", "seconds": "how long", "speed": "how fast", "pace": "how fast", "rate": "how fast",
    "distance": "how far", "way": "how far",
}  # fmt: skip
_ADJ = "|".join(sorted(_WORDS, key=len, reverse=True))
_BARE_ADJ = "|".join(w for w in sorted(_WORDS, key=len, reverse=True) if w != "more")
_AUX = r"(?:is|are|was|were|does|do|did|has|have|had|will|can)"
_DEGREE = r"(?:much |a lot |a bit |a little |even |any |clearly |slightly |significantly |for |by )"
_MUCH = f"{_DEGREE}*"

_LENGTH = r"(?:meters?|m|centimeters?|cm|millimeters?|mm|feet|foot|ft|inch|inches)"
_RATE = (
    rf"(?:(?:{_LENGTH}|times|degrees?|deg|turns?|rotations?|revolutions?|rounds?|radians?|rad) (?:per|a|an|/|each|"
    rf"every) "
    r"(?:second|sec|s|minute|min|hour|h)|rpm|rps|mps|kmh|kph|mph|hz|hertz)"
)
_TURNS = r"(?:full |complete |whole )?(?:turns?|rotations?|revolutions?|rounds?)"
_UNIT = rf"(?:{_RATE}|{_LENGTH}|{SECONDS}|degrees?|deg|{_TURNS}|times)"
_BOUND: dict[str, Relation] = {
    "more than": "more", "over": "more", "above": "more", "better than": "more", "beyond": "more", "past": "more",
    "greater than": "more", "higher than": "more", "larger than": "more", "bigger than": "more", "longer than": "more",
    "faster than": "more", "quicker than": "more", "farther than": "more", "wider than": "more", "later than": "more",
    "more quickly than": "more", "more rapidly than": "more", "more slowly than": "less",
    "less than": "less", "fewer than": "less", "under": "less", "below": "less", "shorter than": "less",
    "slower than": "less", "lower than": "less", "smaller than": "less", "earlier than": "less",
    "sooner than": "less",
    "at least": "at_least", "no less than": "at_least", "not less than": "at_least", "at most": "at_most",
    "no more than": "at_most", "not more than": "at_most", "no longer than": "at_most", "exactly": "same",
    "as much as": "at_least", "as long as": "at_least", "as fast as": "at_least", "as far as": "at_least",
}  # fmt: skip
_LIMIT = "|".join(sorted(_BOUND, key=len, reverse=True))
_WITH_NUMBER = re.compile(
    rf"^(?P<pre>.+?) {_MUCH}(?P<in>in |by )?(?P<c>{_LIMIT}) (?:about |around |a full )?(?P<n>{NUMBER}) (?P<u>{_UNIT})"
    r"(?: (?:long|in length|of time|in total|in all|altogether))?(?= |$)(?P<post>.*)$"
)
_COUNTED = re.compile(
    rf"^(?P<aux>is|are|do|does|did|were|was|have|has) (?:there )?(?P<c>more than|less than|fewer than|at least|at most|"
    rf"exactly|no more than|only)?(?(c) |)(?P<n>{NUMBER}) (?P<x>(?:\w+ )??\w+s)(?P<post> .+)$"
)
_THERE_IS = re.compile(
    r"^(?:is|are|was|were) there (?:a|an|any|some) (?P<x>(?:\w+ )?\w+)(?: lying| standing| sitting)?(?P<post> (?:on|"
    r"in|at|under|near) "
    r"(?:the|a|its) .+)$"
)
_SHARES = {
    "half": 0.5, "halfway": 0.5, "half way": 0.5, "50 %": 0.5, "50 percent": 0.5, "a quarter": 0.25, "a third": 1 / 3,
    "one third": 1 / 3, "two thirds": 2 / 3, "three quarters": 0.75, "25 %": 0.25, "75 %": 0.75,
}  # fmt: skip
_SHARE = re.compile(
    rf"^(?P<aux>{_AUX}) (?P<x>.+?) (?:(?:come|be|get|been|gone|come out|slid|swung|moved|already|still|now) )*"
    rf"(?P<c>more than|over|at least|less than|under|past|beyond|not even|at most) "
    rf"(?P<s>{'|'.join(sorted(_SHARES, key=len, reverse=True))})"
    r"(?: (?:of (?:its|the) (?:full |total |whole )?(?:way|opening|travel|extension|swing|range)|of the way|way))?"
    r"(?: (?:open|opened|out|extended|pulled out))+(?P<post> .*)?$"
)
_SHARE_OF_WAY = re.compile(
    rf"^(?P<aux>does|do|did|has|have|is) (?P<x>.+?) (?:(?:already|covered|cover|travelled|traveled|travel|done|made|"
    rf"make|gone|rolled|moved|walked|roll|move|walk|go|come) )+(?P<c>more than|over|at least|less than|under) "
    rf"(?P<s>{'|'.join(sorted(_SHARES, key=len, reverse=True))}) (?:of )?(?:its|the|of its|of the) (?:total |whole |"
    r"full )?(?:way|distance|path|route|journey|trip)(?P<post> .*)?$"
)
_THAN = re.compile(rf"^(?P<a>.+?) {_MUCH}(?P<adj>{_BARE_ADJ})(?: (?P<mid>.+?))? than (?P<b>.+)$")
_AS = re.compile(
    rf"^(?P<a>.+?) (?P<not>not )?(?:(?:just|exactly|about) )?as "
    rf"(?P<adj>{'|'.join(sorted(_PLAIN, key=len, reverse=True))})"
    r"(?: (?P<mid>.+?))? as (?P<b>.+)$"
)
_DIFFERENCE = re.compile(
    rf"^(?:by )?how (?:much|many (?P<u>{_UNIT})|far) (?P<adj>{_BARE_ADJ}) (?P<aux>{_AUX}) (?P<x>.+) than (?P<b>.+)$"
)
_SAME = re.compile(
    rf"^(?P<aux>{_AUX}) (?P<a>.+?) (?P<v>take|takes|last|need|cover|travel|move|go|have|roll|fall|turn|spin|at|walk|"
    rf"use)?"
    r" ?(?:for |with |at |of )?(?:(?:exactly |about |roughly )?(?:the same|an equal|equal|the same exact) (?:\w+ )?"
    rf"(?P<n>{'|'.join(sorted(_EQUAL_NOUNS, key=len, reverse=True))})|equally (?P<e>{'|'.join(_PLAIN)}))"
    r"(?P<post>(?: (?:to|for|in) .+)?)$"
)
_WHICH = re.compile(
    rf"^(?:and )?(?:which|what)(?: one| of the two(?: \w+)?| of these| of those)? (?P<v>is|takes|lasts|goes|moves|"
    rf"runs|does|"
    rf"needs|happens|was|took|lasted)?(?: the)? ?{_MUCH}(?P<adj>{_ADJ})(?: one)?(?P<mid> to \w+)?(?: ,| :)? "
    r"(?P<a>.+?)(?: ,)? or (?P<b>.+)$"
)
_WHETHER_OR = re.compile(
    rf"^(?P<aux>does|do|did|is|was) (?P<x>.+?) (?P<v>take|last|spend|need)?(?: |^){_MUCH}(?P<adj>{_BARE_ADJ})(?: ,)? "
    r"(?P<a>(?:to |on |in |at |when |while |before |after )?.+?)(?: ,)? or (?P<b>.+)$"
)
_DOES_OR = re.compile(rf"^(?P<aux>does|do|did) (?P<x>.+?) (?P<a>\w+) or (?P<b>\w+) (?P<adj>{_BARE_ADJ})$")
_TIMES_WORDS = re.compile(
    r"\b(?P<c>more than|less than|at least|exactly|at most|only) (?P<n>once|twice)\b(?! the\b| it\b)|"
    r"\b(?P<m>twice)(?= |$)"
)
_STEADY = re.compile(
    r"^(?:is|are|does|do|did) (?P<x>.+?) (?:\w+ )?(?:at|with) (?:a |an |the )?(?:constant|steady|uniform|even|same) "
    r"(?:speed|pace|"
    r"rate|velocity)(?: throughout| all the time| the whole time)?$"
)
_NEARER = re.compile(
    rf"^{_AUX} (?P<x>.+?) (?P<v>(?:(?:get|gets|come|comes|end up|come to rest|stay|finish|stand|stop|ever) "
    rf")*)(?P<adj>closer|nearer|"
    rf"farther|farther away|"
    r"further)(?: to| from)? (?P<b>(?:the|a|its|that) (?:\w+ )?\w+?)(?: (?P<when>(?:at|in|on|before|after|when|by) "
    r".+?))? than "
    r"(?P<rest>.+)$"
)
_TIMELY = re.compile(r"^(?:at|in|on|before|after|during|when|while|whilst|once|until|between|from)\b")
_LEGS = re.compile(r"\b(?:leg|way|path|distance|route|track|stretch|trip|journey|road)\b")


_RANK = r"(?P<{}>first|opening|initial|second|last|final)"
_LEGS = re.compile(
    rf"\b(?:{_RANK.format('early')}\b.*)?\b(?P<adj>slower|faster|quicker|longer|shorter|more slowly|more quickly)\b"
    rf"(?:.*?\b{_RANK.format('late')}\b)?.*? than\b.*?\b{_RANK.format('other')}\b"
)
_THAN_THE_OTHER = re.compile(
    rf"(?P<one>\b(?P<side>before|after) the turn) than (?:on |in |during |over )?(?:the |its |his |her )?"
    rf"(?:{_RANK.format('rank')}|other)\b.*$"
)
_LEG = re.compile(r"\b(?:leg|walk|stretch|part|bit|section|straight|half|stage|run|trip)s?\b")
_ASKED_IF = re.compile(r"\b(?:is|are|was|were|does|do|did)\b|true|right|correct|confirm|agree")


def _of_legs(said: str) -> str:
    """Words that compare the legs of a way as ones that compare what is before a turn with what is behind it."""
    if (told := _THAN_THE_OTHER.search(said)) is not None:  # "it is faster before the turn than on its second leg"
        return f"{said[: told.end('one')]} than {'after' if told['side'] == 'before' else 'before'} it"
    found = _LEGS.search(said)
    if found is None or not _LEG.search(said) or not _ASKED_IF.search(said):
        return said
    one, other = found["early"] or found["late"], found["other"]
    early = ("first", "opening", "initial")
    if one is None or (one in early) == (other in early):
        return said
    before, after = "before the turn", "after the turn"
    this, that = (before, "after it") if one in early else (after, "before it")
    far = found["adj"] in ("longer", "shorter") and re.search(r"\b(?:way|path|distance|stretch)\b", said)
    return f"is {'its way' if far else 'it'} {found['adj']} {this} than {that}"


def comparisons(said: str) -> Iterator[Comparison]:
    """Each way of reading words as a comparison, the likeliest first."""
    if re.search(r"\bat the same time\b", said):
        return
    said = _of_legs(_TIMES_WORDS.sub(_times, said))
    yield from _nearer(said)
    if (found := _STEADY.match(said)) is not None:
        yield Comparison(
            "same", (f"what is the top speed of {found['x']}",), (f"what is the average speed of {found['x']}",)
        )
    yield from _with_share(said)
    yield from _with_number(said)
    if (found := _DIFFERENCE.match(said)) is not None and found["adj"] not in ("later", "earlier", "sooner"):
        for one in _than(f"{found['aux']} {found['x']}", found["adj"], "", found["b"]):
            yield replace(one, asks="difference", unit=found["u"] or "")
        return
    if is_main(said) or not re.match(r"(?:how|what|which|when|where|who|list|name)\b", said):
        if (found := _THAN.match(said)) is not None:
            yield from _than(found["a"], found["adj"], found["mid"] or "", found["b"])
        if (found := _AS.match(said)) is not None and not re.search(rf"^{NUMBER} ", found["b"]):
            for one in _than(found["a"], found["adj"], found["mid"] or "", found["b"]):
                yield replace(one, relation="same", denied=found["not"] is not None)
        if (found := _SAME.match(said)) is not None:
            yield from _same(found)
    yield from _which(said)


def _times(found: re.Match[str]) -> str:
    limit = "exactly" if found["c"] in (None, "only") else found["c"]
    return f"{limit} {1 if found['n'] == 'once' else 2} times"


def _nearer(said: str) -> Iterator[Comparison]:
    """ "Is it closer to the bed at the end than at the start?", "... to the bed than to the shelf?"."""
    if (found := _NEARER.match(said)) is None:
        return
    relation: Relation = "more" if found["adj"].startswith("far") else "less"
    ends = "at the end" if re.search(r"end up|finish|stop|come to rest", found["v"]) else ""
    away, when, rest = f"how far is {found['x']} from", found["when"] or ends, found["rest"]
    if _TIMELY.match(rest):
        if when:
            yield Comparison(relation, (f"{away} {found['b']} {when}",), (f"{away} {found['b']} {rest}",))
        return
    time, bare = without_time(rest)
    when = rest.replace(bare, "").strip() if time is not None else when
    bare = re.sub(r"^(?:to|from) ", "", bare)
    walls = "wall" in (found["b"].split()[-1], bare.split()[-1])  # of several which is not said
    if thing(bare) is not None and not walls:
        yield Comparison(relation, (f"{away} {found['b']} {when}".strip(),), (f"{away} {bare} {when}".strip(),))


def _asked(cue: str, clause: str) -> tuple[str, ...]:
    """A clause behind a cue, in the ways in which it may be asked: "how long does it take", "how long is the fall"."""
    clause = clause.strip(" ,")
    clause = re.sub(r"^(?:the )?(?:time|duration)(?: span)? (?:that |of |for which )?(?=it |the )", "", clause)
    clause = re.sub(r"^(?:is |was )?the time (?:(?:that )?it (?:spends|is) )?(?=(?:on|in|at) )", "is it ", clause)
    bare = re.sub(rf"^{_AUX} ", "", clause)
    plain = [f"{cue} {clause}", f"{cue} {bare}"]
    if is_main(clause):
        plain.append(f"what {clause}")
    else:
        plain += [f"{cue} does {bare}", f"what is {bare}"]
    if cue == "how long":
        plain.append(f"how long does {bare} take")
    return tuple(dict.fromkeys(p.replace(" 's", "'s") for p in plain))


def _with_number(said: str) -> Iterator[Comparison]:
    if re.match(r"(?:how|what|which|when|where|who|list|name)\b", said):
        return
    if (found := _COUNTED.match(said)) is not None and not re.fullmatch(_UNIT, found["x"]):
        relation: Relation = "same" if found["c"] == "only" else _BOUND[found["c"] or "at least"]
        aux = "" if found["aux"] in ("do", "does", "did") else f" {'are' if found['aux'] == 'is' else found['aux']}"
        asked = f"how many {found['x']}{aux}{found['post']}"
        yield Comparison(relation, (asked,), number=seconds(found["n"]), unit="things")
    if (found := _THERE_IS.match(said)) is not None and without_time(found["post"])[0] is not None:
        some = found["x"] if found["x"].endswith("s") else f"{found['x']}s"
        yield Comparison("at_least", (f"how many {some} are{found['post']}",), number=1.0, unit="things")
    if (found := _WITH_NUMBER.match(said)) is None:
        return
    unit, limit = found["u"], found["c"]
    rest = f"{found['pre']} {found['post'].strip()}".strip(" ,")
    denied = re.search(r"\b(?:not|never) ?$", found["pre"]) is not None
    rest = re.sub(r"\b(?:not|never) ?(?=$| )", "", rest).strip() if denied else rest
    if limit == "faster than" and re.fullmatch(SECONDS, unit):
        return
    cue = _cue_of(unit, limit)
    top = re.search(r" (?:ever|at any (?:time|point|moment)|at some (?:time|point|moment))(?= |$)", rest)
    if top is not None and cue == "how fast":
        rest = f"{rest[: top.start()]}{rest[top.end() :]}"
    rest = re.sub(r" (?:for|by|at|with|in|on average|reach|make|of|on)$", "", rest)
    rest = re.sub(r"^on average(?: ,)? ", "", rest)
    light = r" (?:goes|go|does|do|run|runs|get|gets|come|comes)(?= |$)"
    moving = "turn" if unit.startswith("deg") else "move"
    ways = _asked(cue, rest)
    if top is not None and cue == "how fast":
        ways = (f"what is the top speed of {_subject_of(re.sub(rf'^{_AUX} ', '', rest))[0]}",)
    ways = tuple(dict.fromkeys((*ways, *(re.sub(light, f" {moving}", a) for a in ways))))
    if cue in ("how fast", "how far"):
        ways = tuple(f"{a} in {unit.replace('times', 'turns')}" for a in ways)
    yield Comparison(_BOUND[limit], ways, number=seconds(found["n"]), unit=unit, denied=denied)


def _cue_of(unit: str, limit: str) -> str:
    """How a number in a unit is asked for."""
    if re.fullmatch(SECONDS, unit):
        return "when" if limit in ("later than", "earlier than", "sooner than") else "how long"
    if re.fullmatch(_RATE, unit):
        return "how fast"
    if re.fullmatch(_LENGTH, unit):
        return "how far"
    if unit.startswith("deg"):
        return "how many degrees"
    return "how many times" if unit == "times" else "how many turns"


def _with_share(said: str) -> Iterator[Comparison]:
    if (found := _SHARE.match(said)) is not None and (post := (found["post"] or "").strip()):
        relation: Relation = "at_least" if found["c"] == "not even" else _BOUND[found["c"]]
        now = re.sub(r"^(?:by|after) (?=\S+ (?:seconds?|secs?|s)$)", "at ", re.sub(r"^already ", "", post))
        if without_time(now)[0] is None and not _TIMELY.match(now):
            return
        yield Comparison(
            relation, (f"how far is {found['x']} open {now}",), (f"how far does {found['x']} open",),
            number=_SHARES[found["s"]], denied=found["c"] == "not even",
        )  # fmt: skip
    if (found := _SHARE_OF_WAY.match(said)) is not None and (post := (found["post"] or "").strip()):
        now = re.sub(r"^(?:at|after) (?=\S+ (?:seconds?|secs?|s)$)", "by ", re.sub(r"^already ", "", post))
        yield Comparison(
            _BOUND[found["c"]], (f"how far does {found['x']} move {now}",), (f"how far does {found['x']} move",),
            number=_SHARES[found["s"]],
        )  # fmt: skip


def _than(a: str, adj: str, mid: str, b: str) -> Iterator[Comparison]:
    """Two clauses of which the second leaves out what the first says."""
    cue, less = _WORDS.get(adj, (_PLAIN.get(adj, ""), False))
    a = re.sub(rf" {_DEGREE}$", "", f"{a} ").strip()
    if cue == "how long" and _LEGS.search(a) and adj in ("longer", "shorter", "long"):
        cue = "how far"
    relation: Relation = "less" if less else "more"
    b = re.sub(r" (?:does|do|did|is|are|was|has)$", "", b)
    for one, other in _clauses(a, mid, b):
        yield Comparison(relation, _asked(cue, one), _asked(cue, other))


def _clauses(a: str, mid: str, b: str) -> Iterator[tuple[str, str]]:
    """The first clause in full, and the ways of putting the second in place of a part of it."""
    a = re.sub(r" (?:spend|spends|spent|stay|stays)$", " is", a) if mid else a
    if re.match(r"^does (.+) is$", a):
        a = re.sub(r"^does (.+) is$", r"is \1", a)
    if not mid and " to " not in a and (to := re.match(r"^(?P<b>(?!it ).+?) (?P<mid>to \w+)$", b)) is not None:
        mid, b = to["mid"], to["b"]  # "does it take longer than the other to fall"
    first = f"{a} {mid}".strip()
    place = re.fullmatch(r"(?:the|its) (?P<n>first|second|last|third)(?: one)?", b)
    if place is not None and (own := re.search(r"\b(?:first|second|third)\b", a)) is not None:
        yield first, first.replace(own[0], place["n"], 1)
        return
    aux = re.match(rf"^(?P<aux>{_AUX}) (?P<x>.+)$", a)
    said_by = f"{aux['aux']} " if aux is not None else ""
    whole = aux["x"] if aux is not None else a
    name, verb = _subject_of(whole)
    if _TIMELY.match(b):
        bare = a if without_time(mid)[0] is not None or _TIMELY.match(mid) else first
        when, less = without_time(bare)
        bare = less if when is not None else bare
        lone = re.match(r"^(?P<j>before|after|at|during|when)(?: (?:it|that|then))?$", b)
        clause = re.match(r"^(?:before|after|at|during|when) (?P<c>.+)$", mid)
        cut = re.search(r" (?P<j>before|after|at|during|when|in) (?P<c>.+)$", a) if not mid else None
        if lone and clause:
            yield first, f"{bare} {lone['j']} {clause['c']}"
        elif lone and cut:
            yield first, f"{a[: cut.start()]} {lone['j']} {cut['c']}"
        elif not lone:
            yield first, f"{bare if cut is None else a[: cut.start()]} {b}"
        return
    if b.startswith("to "):
        cut = re.search(r" to .+$", first)
        if cut is not None:
            yield first, f"{first[: cut.start()]} {b}"
        return
    clause = re.match(r"^(?:it|he|she|they|that)(?: (?:is|does|do|are|was|did))? (?P<v>.+)$", b)
    if clause is not None and not b.startswith("that of"):
        aux_b = re.match(r"^\w+ (is|are|was)\b", b)
        yield first, f"{'is' if aux_b else 'does'} {name} {clause['v']}"
        return
    head = re.match(r"^(?P<h>(?:the |its )?(?:\w+ )?\w+) (?:of|by|for) .+$", name)
    if head is not None and re.match(r"^(?:that|the one|the) of ", b):
        yield first, f"{said_by}{head['h']} of {b.partition(' of ')[2]} {verb}".strip()
        return
    if head is not None and re.match(r"^(?:the |that )\w+(?: one| book)?$", b):
        yield first, f"{said_by}{head['h']} of {b} {verb}".strip()
    if any((start, stop) == (0, len(b)) for start, stop, _ in said_in(b)) and thing(b) is None:  # "than still"
        yield first, f"{said_by}{name} {b}"
        return
    rest = f"{verb} {mid}".strip()
    if re.match(r"^(?:the|a|an|its|that|this|my|when|any)\b", b) or len(b.split()) <= 2:
        yield first, f"{said_by}{b} {rest}".strip()
        if mid:
            yield first, f"{said_by}{name} {verb} {b}".replace("  ", " ")


def _subject_of(clause: str) -> tuple[str, str]:
    """A clause without its auxiliary as its subject and the rest: ("the drawer", "open"), ("the robot", "walk")."""
    for cut in (m.start() for m in re.finditer(" ", clause)):
        if thing(clause[:cut]) is not None and (
            re.match(r"(?:take|last|need|spend|use|do|make)s?\b", clause[cut + 1 :])
            or any(start == cut + 1 for start, _, _ in said_in(clause))
        ):
            return clause[:cut], clause[cut + 1 :]
    return clause, ""


def _same(found: re.Match[str]) -> Iterator[Comparison]:
    cue = _EQUAL_NOUNS[found["n"]] if found["n"] else _PLAIN[found["e"]]
    verb = found["v"] or ""
    if verb in ("at", "have", "use", "cover"):
        verb = "take" if cue == "how long" else "move"
    if found["aux"] in ("is", "are", "was", "were") and found["e"]:
        verb = ""
    denied = re.search(r"\bnot$", found["a"]) is not None
    both = re.sub(r"\b(?:both|not) ?", "", found["a"]).strip()
    two = re.match(r"^(?P<a>.+?) and (?P<b>.+)$", both)
    if two is None:
        yield Comparison("same", _asked(cue, f"{found['aux']} {both} {verb}{found['post']}".strip()), denied=denied)
        return
    first, second = two["a"], two["b"]
    if re.fullmatch(r"(?:the )?\w+", first) and as_noun(first) is None and thing(first) is None:
        first = f"{first} {second.split()[-1]}"  # "the red and the blue book"
    a, b = (_asked(cue, f"does {x} {verb}{found['post']}".strip()) + _asked(cue, f"is {x}") for x in (first, second))
    yield Comparison("same", a, b, denied=denied)


def _which(said: str) -> Iterator[Comparison]:
    if (found := _WHICH.match(said)) is not None:
        cue, less = _WORDS[found["adj"]]
        if cue == "when" or (found["adj"] == "more" and found["v"] != "moves"):
            return
        a, b = found["a"], found["b"]
        if cue == "how long" and _LEGS.search(a) and found["v"] in ("is", "was", None):
            cue = "how far"
        tail = f" take{found['mid']}" if found["mid"] else ""
        names = (_bare(a), _bare(b))
        of = re.search(r" (?:of|by) .+$", b)
        first = (a, f"{a}{of.group()}") if of is not None and " of " not in a else (a,)
        yield Comparison(
            "less" if less else "more", tuple(q for x in first for q in _asked(cue, f"{x}{tail}")),
            _asked(cue, f"{b}{tail}"), asks="which", names=names,
        )  # fmt: skip
        return
    if (found := _DOES_OR.match(said)) is not None:
        cue, less = _WORDS[found["adj"]]
        x = f"{found['aux']} {found['x']}"
        yield Comparison("less" if less else "more", _asked(cue, f"{x} {found['a']}"), _asked(cue, f"{x} {found['b']}"),
                         asks="which", names=(found["a"], found["b"]))  # fmt: skip
        return
    if (found := _WHETHER_OR.match(said)) is not None:
        cue, less = _WORDS[found["adj"]]
        if cue == "when":
            return
        a, b = found["a"], re.sub(r"^(?:is it|does it) ", "", found["b"])
        x = f"{found['aux']} {found['x']}{' ' + found['v'] if found['v'] and found['v'] != 'spend' else ''}"
        if found["v"] == "spend":
            x = f"is {found['x']}"
        joined = (
            b if re.match(r"^(?:to|on|in|at|when|while|before|after)\b", b) or not a.startswith("to ") else f"to {b}"
        )
        yield Comparison("less" if less else "more", _asked(cue, f"{x} {a}"), _asked(cue, f"{x} {joined}"),
                         asks="which", names=(_bare(a), _bare(b)))  # fmt: skip


def _bare(said: str) -> str:
    return re.sub(r"^(?:the|a|an|its|to|when it|while it) ", "", said.strip(" ,"))
