"""What colour things are, whether they have a colour, and whether two have the same: "what colour is the sofa?"."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence

from ....gaussians.color import plain_color
from ....gaussians.language.query.query import Query
from ..answer import Answer, AnswerType
from ..kind import Asked, Kind, Undecided
from ..reading.phrase_templates import templates
from ..resolving import Meant, all_of, meant
from ..survey import Survey, Thing, as_plural, listed
from ..telling import GRAPH_SURE, evidence, label, things_listed, yes_no

_COLOR = "(color|colors|shade|hue|colouring|tone|tint)"
_WHAT = f"(what|which|wat) [kind of|sort of|main|exact|sort] {_COLOR}"
_BE = "(is|are|was|were|does|do|has|have|would)"
_PHRASES = f"""
    (is|are) {{x}} [of|in] the same {_COLOR} [as each other|as one another]
    (is|are) {{x}} all [of|in] [the same|one] {_COLOR}
    (do|does|have) {{x}} [all] [both] (have|share|got) the same {_COLOR}
    (is|are) [all|both] {{x}} [all|both] the same {_COLOR}
    [whether] {{x}} (is|are) [all|both] the same {_COLOR}
    (is|are) {{a}} [of|in] the same {_COLOR} (as|like|than) {{b}}
    [whether] {{a}} (is|are) [of|in] the same {_COLOR} as {{b}}
    (does|do) {{a}} have the same {_COLOR} (as|like) {{b}}
    (does|do) {{a}} match {{b}} [in color|color wise]
    (does|do) {{a}} match the color of {{b}}
    (do|does) {{x}} match [in color|each other|one another|color wise]
    is the color of {{a}} the same as [that of|the color of] {{b}}
    (is|are) {{x}} [a] different {_COLOR}
    (is|are) {{x}} [all] (differently colored|of different colors|in different colors)
    (is|are) {{a}} [a] different {_COLOR} (from|than|to) {{b}}
    BE {{x}} {{c:color}} or [is it|are they|rather|more] {{other:color}} [in color]
    BE {{x}} {{c:color}} , {{third:color}} or {{other:color}} [in color]
    BE {{x}} {{c:color}} or {{third:color}} or {{other:color}} [in color]
    {_WHAT} {_BE} {{x}} [painted|in|have|got|made in]
    {_WHAT} {{x}} {_BE} [there]
    {_WHAT} of {{of}} [is it|is there|are there|do we have]
    [in] {_WHAT} (is|are) {{x}} (painted|in|done in|finished in)
    [what (is|are|was)] [the] [main|dominant|exact] {_COLOR} of {{x}} [is|are]
    the {_COLOR} of {{x}} is (what|which)
    [what (is|are)] {{x}} 's [main] {_COLOR}
    {{x}} (is|are) {_WHAT}
    {{x}} (color|colour)
    (what|which) {_COLOR} {{x}}
    how (is|are) {{x}} colored
    (describe|name|give) [me] [the] {_COLOR} of {{x}}
    (what|which) is the (most common|main|dominant|predominant|prevailing|commonest) color [of {{of}}|here|in the \
        room|among {{of}}]
    {_WHAT} (occurs|appears|is used|dominates|prevails|is) [the] most [often] [here|in the room]
    {_WHAT} is the most (common|frequent) [here|in the room]
    (what|which) {_COLOR} (are there|can you see|do you see|occur|appear|are used|are present|do we have) [here|in \
        the room]
    how many [different] {_COLOR} [are there|do {{of}} have|are used] [here|in the room]
    (what|which) {{which:noun}} (is|are|has|have|look|looks) {{c:color}} [in color]
    (what|which) [thing|things|object|objects|item|items|ones|of them|of the things|else] [here|in the room] (is|are|\
        has|have|look|looks) [colored] {{c:color}} [in color|here|in the room]
    (what|which) of {{which:noun}} (is|are) {{c:color}}
    (does|do|is|are) (any|one|some|either|anything|something) [of] {{any}} (have|be) [the color] {{c:color}}
    (is|are) (any|one|some|either) [of] {{any}} {{c:color}}
    (is|are) (any|one|some|either) [of] {{other_than}} not {{c:color}}
    (is|are) (most|the majority|more than half|at least half) of {{most}} {{c:color}}
    (is|are) most {{most}} {{c:color}}
    (is|are) none of {{none_of}} {{c:color}}
    (is|are) {{none_of}} not {{c:color}}
    (is|are) (anything|something) {{c:color}} [here|in here|in the room|anywhere]
    BE {{x}} [all|both|each|mostly|mainly|painted|colored] (of the color|of color|of|in) {{c:color}}
    BE {{x}} [all|both|each|mainly|mostly|painted|colored|a|an|the color|rather|a bit|somewhat|a kind of|a shade of] \
        {{c:color}} [in color|colored|one|ones|color|thing]
    BE the {_COLOR} of {{x}} {{c:color}}
    (does|do|has|have) {{x}} [have] [a|an|the] {{c:color}} (color|colour|surface|paint|finish|cover|body)
    (does|do) {{x}} look {{c:color}}
"""


# By hole: whether a share of things of a colour is what is asked for.
_SHARES: Mapping[str, Callable[[int, int], bool]] = {
    "other_than": lambda fit, all: fit < all,
    "most": lambda fit, all: 2 * fit > all,
    "none_of": lambda fit, all: fit == 0,
}


def answer(asked: Asked, survey: Survey) -> Answer | Undecided | None:
    """A colour, a yes or no about one, or the things of a colour."""
    slots = asked.slots
    if "a" in slots:
        return _alike([meant(survey, slots["a"]), meant(survey, slots["b"])], "different" in asked.words, survey)
    if {"same", "match", "different", "differently"} & set(asked.words) and "x" in slots and "c" not in slots:
        return _alike([_each(survey, slots["x"])], bool({"different", "differently"} & set(asked.words)), survey)
    if "which" in slots or ("c" in slots and not {"x", "any", *_SHARES} & slots.keys()):
        return _of_color(asked, survey)
    if "other" in slots:
        choices = [slots[n] for n in ("c", "third", "other") if n in slots]
        return _one_of(meant(survey, slots["x"]), choices, survey)
    if "c" in slots:
        return _has(asked, survey)
    if "x" in slots:
        return _colors(_definite(survey, slots["x"]), survey)
    return _palette(asked, survey)


def _definite(survey: Survey, query: Query) -> Meant:
    """What a phrase means; "chairs" without an article are all of them."""
    return meant(survey, query.model_copy(update={"count": None}) if query.pick == "all" else query)


def _each(survey: Survey, query: Query) -> Meant:
    """What a phrase means of which each is compared with the others: "the two chairs", "the sofa and the rug"."""
    return meant(survey, query)


def _colors(phrase: Meant, survey: Survey) -> Answer | Undecided:
    """The colour of what a phrase means; several where things have different ones."""
    known = [t for t in phrase.things if t.color]
    if not known:
        return _untold(phrase, "label", survey)
    colors = list(dict.fromkeys(t.color for t in known))
    if len(colors) > 1 and not phrase.plural:
        raise phrase.differ()
    if len(colors) == 1:
        many = len(known) > 1
        named = _every(known) if many else survey.named(known[0])
        text = f"{named} {'are' if many else 'is'} {colors[0]}."
        return Answer(answer=colors[0], answer_type="label", text=_up(text), confidence=_sure(survey),
                      evidence=evidence(known))  # fmt: skip
    told = listed([f"{survey.named(t)} is {t.color}" for t in known])
    return Answer(answer=tuple(colors), answer_type="list", text=_up(f"{told}."), confidence=_sure(survey),
                  evidence=evidence(known))  # fmt: skip


def _every(things: Sequence[Thing]) -> str:
    """Several things that are told together: "both chairs", "all 4 lamps", "all 3"."""
    labels = {t.label for t in things}
    noun = f" {as_plural(things[0].label)}" if len(labels) == 1 and things[0].label else ""
    return f"{'both' if len(things) == 2 else f'all {len(things)}'}{noun}"


def _has(asked: Asked, survey: Survey) -> Answer | Undecided | None:
    """Whether things have a colour: each of several, or any where the question says so."""
    color = asked.slots["c"]
    for name, fits in _SHARES.items():
        if name in asked.slots:
            things, _ = all_of(survey, asked.slots[name])
            fit = [t for t in things if survey.has_color(t, color)]
            told = f"{len(fit)} of {len(things)} {'is' if len(fit) == 1 else 'are'} {color}."
            return yes_no(bool(things) and fits(len(fit), len(things)), told, things, _sure(survey))
    if "any" in asked.slots:
        things, _ = all_of(survey, asked.slots["any"])
        fit = [t for t in things if survey.has_color(t, color)]
        told = f"{listed([survey.named(t) for t in fit])} {'is' if len(fit) == 1 else 'are'} {color}." if fit else ""
        return yes_no(bool(fit), told or f"none is {color}.", fit or things, _sure(survey))
    query: Query = asked.slots["x"]
    if query.text == "" and query.pick in ("all", "any") and not query.relations and "anything" in asked.words:
        return None
    phrase = _definite(survey, query)
    known = [(t, survey.has_color(t, color)) for t in phrase.things]
    if any(fits is None for _, fits in known):
        return _untold(phrase, "yesno", survey)
    fit = [t for t, fits in known if fits]
    if not phrase.plural and 0 < len(fit) < len(known):
        raise phrase.differ()
    holds = len(fit) == len(known)
    other = phrase.things if holds or not fit else [t for t, fits in known if not fits]
    told = listed([f"{survey.named(t)} is {t.color}" for t in other[:6]])
    return yes_no(holds, f"{told}.", phrase.things, _sure(survey))


def _untold(phrase: Meant, answer_type: AnswerType, survey: Survey) -> Undecided:
    """That the colour, or the shade, of things is not told here."""
    named = listed(list(dict.fromkeys(survey.named(t) for t in phrase.things[:6])))
    known = list(dict.fromkeys(t.color for t in phrase.things if t.color))
    text = f"Nothing here tells the exact shade; {named}: {listed(known)}." if known else ""
    return Undecided(text or f"Nothing here tells the colour of {named}.", True, answer_type, phrase.things)


def _one_of(phrase: Meant, choices: Sequence[str], survey: Survey) -> Answer | Undecided:
    """Which of the named colours things have; their own if it is none of them."""
    colors = list(dict.fromkeys(t.color for t in phrase.things))
    if "" in colors:
        return _colors(Meant(phrase.query, tuple(t for t in phrase.things if not t.color), True, phrase.found), survey)
    if len(colors) > 1:
        return _colors(phrase, survey)
    fit = [c for c in choices if survey.has_color(phrase.things[0], c)]
    said = plain_color(fit[0]) if len(fit) == 1 else colors[0]
    text = f"{survey.named(phrase.things[0])} is {said}."
    if not fit:
        text = f"Neither: {text}"
    return Answer(answer=said, answer_type="label", text=_up(text), confidence=_sure(survey),
                  evidence=evidence(phrase.things))  # fmt: skip


def _alike(phrases: Sequence[Meant], different: bool, survey: Survey) -> Answer | Undecided:
    """Whether all things have one colour."""
    for phrase in phrases:
        if not phrase.plural and len(phrase.things) > 1 and len({t.color for t in phrase.things}) > 1:
            raise phrase.differ()
    things = [t for phrase in phrases for t in phrase.things]
    if any(not t.color for t in things):
        return Undecided("Nothing here tells the colour of all of them.", True, "yesno", tuple(things))
    same = len({t.color for t in things}) == 1
    told = listed([f"{survey.named(t)} is {t.color}" for t in things[:12]])
    return yes_no(same != different, f"{told}.", things, _sure(survey) - 0.03)


def _of_color(asked: Asked, survey: Survey) -> Answer | None:
    """The things that have a colour."""
    from ..reading.noun_phrase import thing

    color = asked.slots["c"]
    words = asked.slots.get("which", ("things",))
    query = thing(words)
    if query is None:
        return None
    single = query.pick == "one" and "which" in asked.slots
    things, _ = all_of(survey, query.model_copy(update={"pick": "all", "count": None}))
    fit = [t for t in things if survey.has_color(t, color)]
    told = f"{listed([survey.named(t) for t in fit])} {'is' if len(fit) == 1 else 'are'} {color}."
    if asked.words[0] in ("is", "are"):
        return yes_no(bool(fit), told if fit else f"nothing here is {color}.", fit, _sure(survey))
    if not fit:
        return Answer(answer=(), answer_type="list", text=f"None of them is {color}.", confidence=_sure(survey),
                      evidence=evidence(things))  # fmt: skip
    if single and len(fit) == 1:
        return label(fit[0], _up(told), _sure(survey))
    return things_listed(fit, _up(told), _sure(survey))


def _palette(asked: Asked, survey: Survey) -> Answer | None:
    """The colours of everything here, or of the things that are named."""
    things: Sequence[Thing] = survey.things
    if "of" in asked.slots:
        things, _ = all_of(survey, asked.slots["of"])
    counted = Counter(t.color for t in things if t.color)
    if not counted:
        return None
    ranked = [c for c, _ in counted.most_common()]
    told = listed([f"{c} ({counted[c]})" for c in ranked])
    words = set(asked.words)
    if {"many"} & words:
        return Answer(answer=float(len(ranked)), answer_type="number", text=f"{len(ranked)}: {told}.", confidence=0.9)
    if {"most", "main", "dominant", "predominant", "prevailing", "commonest"} & words:
        return Answer(answer=ranked[0], answer_type="label", text=f"Mostly {ranked[0]}, by number of things: {told}.",
                      confidence=0.7, evidence=evidence([t for t in things if t.color == ranked[0]]))  # fmt: skip
    return Answer(answer=tuple(ranked), answer_type="list", text=f"By number of things: {told}.", confidence=0.9,
                  evidence=evidence(things))  # fmt: skip


def _sure(survey: Survey) -> float:
    return 0.9 if survey.measured else GRAPH_SURE


def _up(text: str) -> str:
    return text[:1].upper() + text[1:]


KIND = Kind("colour", templates(_PHRASES), answer)
