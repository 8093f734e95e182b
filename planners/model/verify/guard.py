"""Semantic checks of a valid plan: unknown ids, invalid colours, and removals that the instruction does not ask for.

Plans are not repaired, except that choices which the instruction does not state are removed (`unstated_choices`), so
that the session asks. Each fault is reported to the model; `Fault.verdict` is the outcome if the model repeats it.

Absent and ambiguous phrases are reported to the model once, because it may have meant something else in the scene. If
it repeats them, the plan is accepted: the graph has only those labels that the encoder is sure of, while the session
resolves against the scene itself and can show the user the candidates.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property

from ....gaussians.color import parse as parse_color
from ....gaussians.color import plain_color
from ....gaussians.errors import UserError
from ....gaussians.language.query.nested import queries
from ....gaussians.language.query.query import Query
from ....gaussians.language.query.terms import STRUCTURE
from ....tools.operation import EditOp
from ...grammar.vocabulary.verbs import VERBS
from ...impossible import NOT_FOR_STRUCTURE, Step
from ...plan import Planner, Verdict
from ...rooms.graph import SceneGraph
from ...rooms.graph_scene import Id
from ...rooms.label_encoder import words
from ...rooms.plan_on_graph import Resolved
from ..prompt.pruning import Relevance
from .asked_for import clears, is_english, names_target, speaks_of_any, too_many, unwanted
from .meant import Meant
from .rehearsal import Rehearsal
from .removal_words import Ground, mentions
from .said import Said
from .second_reading import alike, unlike
from .unstated_choices import drop_unstated_colors, drop_unstated_ids, singular_picks, stems

# Operations that remove things, and the kinds of words that justify each. A new operation that removes belongs here.
_REMOVALS: dict[str, tuple[Ground, ...]] = {
    "delete": ("removing", "exchanging"),
    "replace": ("removing", "exchanging"),
    "isolate": ("keeping", "removing"),
    "opacity": ("hiding", "removing", "keeping"),
}
_HIDDEN_OPACITY = 0.15  # opacity up to which a thing counts as removed
_MANY = 4  # unnamed things; a plan that removes as many is a fault
_FILLERS = re.compile(r"^(?:(?:and|now|then|next|ok|okay|please|so)\b[\s,]*)+")
_SAME_AGAIN = re.compile(r"\b(?:too|also|as well|same|again|likewise|either|neither)\b")
# Words for things of any kind, beside which the noun phrases of an instruction do not say all that it is about.
_ANYTHING = re.compile(
    r"\b(?:everything|anything|all|things?|stuff|objects?|items?|furniture|something|whatever|what|where|who\w*|rest|others?|"
    r"clutter|mess|lot|decor|whole|entire|machine|room|scene)\b"
)
# A place that is meant without its name.
_SOMEWHERE = re.compile(
    r"\b(?:there|here)\b|"
    r"\b(?:in|on|onto|into|under|behind|beside|of|to|by|near|above|over|with|beneath|against|around) "
    r"(?:it|them|that|this|those|these|(?:the )?(?:others?|one|ones))\b"
)
_EVERYTHING = frozenset({"", "everything", "anything", "thing", "object", "item", "stuff", "furniture"})


@dataclass(frozen=True)
class Fault:
    """A fault of a valid plan.

    Attributes:
        kind: each kind is reported to the model once.
        told: message for the model.
        verdict: outcome if the model repeats the fault. "ok": the plan is accepted, and the session decides. None: it
            counts as an invalid answer.
        reason: message for the user.
    """

    kind: str
    told: str
    verdict: Verdict | None = None
    reason: str = ""


class Guard:
    """Checks the plans for one instruction.

    Args:
        text: the instruction.
        previous: the previous instruction, if any.
        graph: the scene with sanitised names; None if there is none.
        recall: plans the previous instruction, to resolve "it".
    """

    def __init__(self, text: str, previous: str | None, graph: SceneGraph | None, recall: Planner) -> None:
        self._text = text
        self._previous = previous
        self._recall = recall
        self._scene = Rehearsal(graph, previous, recall) if graph is not None else None

    def drop_unstated(self, ops: Sequence[EditOp]) -> tuple[EditOp, ...]:
        """The operations without choices of ids, colours and "all" that the instruction does not make."""
        if self._scene is None:
            return tuple(ops)
        stated = drop_unstated_ids(ops, self._text, self._scene)
        if self._said.turns_either_way and is_english(self._text):
            stated = tuple(map(_counterclockwise, stated))
        stated = drop_unstated_colors(stated, self._text, self._previous)
        return singular_picks(stated, self._text, self._scene)

    def faults(self, ops: Sequence[EditOp]) -> list[Fault]:
        """Faults of the operations, worst first, one of each kind."""
        found = [f for check in (self._ids, self._colors, self._unknown_it) for f in check(ops)]
        if any(f.verdict is None for f in found):
            return _first_of_each_kind(found)  # a dry run needs existing ids
        resolved = self._scene.dry_run(ops) if self._scene is not None and ops else None
        found += [*self._unjustified_removals(ops), *self._broad_removals(ops, resolved)]
        if not any(f.kind == "color" for f in found):  # what is no colour cannot be compared with the words
            found += self._unlike_the_reading(ops, resolved) if self._reading else self._unasked(ops, resolved)
        found += self._structure(ops) if resolved is None else self._dry_run_faults(resolved)
        return _first_of_each_kind(found)

    # -- the words of a plan ----------------------------------------------------------------------------------------

    def _ids(self, ops: Sequence[EditOp]) -> Iterator[Fault]:
        """Ids that do not exist, and ids whose node has another name than the query."""
        for _, query in queries(tuple(ops)):
            if not query.groups:
                continue
            if self._scene is None:
                yield Fault("ids", "no scene was shown, so groups must be left out: say in words what is meant")
            elif missing := self._scene.missing_ids(query):
                near = self._scene.shown(n.id for n in self._scene.alternatives(query, missing[0]))
                yield Fault("ids", f"groups: no thing has the id {missing[0]}; near are\n{near}")
            elif (node := self._scene.misnamed(query)) is not None:
                told = f'groups: {node.id} is a {node.label}, not "{query.text}"; correct the id or the text'
                yield Fault("ids", told)

    def _colors(self, ops: Sequence[EditOp]) -> Iterator[Fault]:
        """Words that are not colours; all colours written in the graph are valid."""
        written = {plain_color(n.color) for n in self._scene.graph.nodes} if self._scene is not None else set()
        painted = [c for op in ops if isinstance(c := getattr(op, "color", None), str)]
        sought = (c for _, q in queries(tuple(ops)) for c in (*q.colors, *q.not_colors))
        for color in (*painted, *(c for c in sought if plain_color(c) not in written)):
            try:
                parse_color(color)
            except UserError as error:
                yield Fault("color", str(error), "not_understood", str(error))

    def _structure(self, ops: Sequence[EditOp]) -> Iterator[Fault]:
        """Operations that would move floor, walls or ceiling."""
        for op in ops:
            query = op.query()
            name = STRUCTURE.get(query.text) if query is not None and not query.groups else None
            if op.op in NOT_FOR_STRUCTURE and name:
                reason = f"the {name} stays: {op.op} is for things in the room"
                told = f'{reason}; if that was asked, answer with verdict "impossible"'
                yield Fault("shell", told, "impossible", reason)

    def _unknown_it(self, ops: Sequence[EditOp]) -> Iterator[Fault]:
        """ "it" without a previous instruction."""
        if not self._previous and any(q.last for _, q in queries(tuple(ops[:1]))):
            told = "last: there was no instruction before, so it means nothing; name the thing"
            yield Fault("last", told, "not_understood", "nothing was done before that 'it' could mean; name the thing")

    # -- removals ---------------------------------------------------------------------------------------------------

    def _unjustified_removals(self, ops: Sequence[EditOp]) -> Iterator[Fault]:
        """Operations that remove something although the instruction does not ask for it."""
        for op in filter(_removes, ops):
            asked = any(mentions(g, self._text, self._before) for g in _REMOVALS[op.op])
            asked |= unwanted(self._text) and names_target(op, self._text, self._before)
            asked |= op.op in ("delete", "opacity") and self._said.asks_to_remove
            if not asked and not (op.op == "replace" and self._names(getattr(op, "asset", ""))):
                what = f"{op.op} {op.subject()}"
                told = (
                    f"{op.op}: the instruction does not ask to take anything away. Do only what it says; if it cannot "
                    'be done otherwise, answer with verdict "not_understood"'
                )
                yield Fault("groundless", told, "not_understood", f"{_REFUSED}: {what}. {_REPHRASE}")

    def _unasked(self, ops: Sequence[EditOp], resolved: Resolved | None) -> Iterator[Fault]:
        """Steps that the instruction does not ask for: on things that it neither names nor points at, of a kind, with a
        value or in a number that its words speak against."""
        if not is_english(f"{self._text} {self._before or ''}"):
            return
        pointing = speaks_of_any(self._text) or speaks_of_any(self._before)
        pointing |= self._scene is None or not self._named  # nothing in the scene is called as the words say
        for step, op in enumerate(ops):
            meant = set(resolved.steps[step].targets) if resolved is not None and step < len(resolved.steps) else set()
            meant |= {self._support[i] for i in meant if clears(self._text) and i in self._support}
            named = not meant or bool(self._scene is not None and meant & self._named)
            strange = bool(self._scene is not None and meant and self._meant.called and not meant & self._meant.called)
            pointed = pointing and not (strange and not _ANYTHING.search(self._text.lower()) and not self._said.refers)
            if not (pointed or named or names_target(op, self._text, self._before)):
                yield self._unasked_fault(op, f"{op.subject()} is not named")
            for why in self._said.against(op, len(ops) == 1):
                yield self._unasked_fault(op, why)
        for op in too_many(ops, self._text, self._before):
            yield self._unasked_fault(op, "it speaks of one thing, not of several")
        yield from self._other_things(ops, resolved)

    def _other_things(self, ops: Sequence[EditOp], resolved: Resolved | None) -> Iterator[Fault]:
        """Steps on others than the things that the noun phrases of the instruction mean."""
        if self._scene is None or resolved is None or resolved.verdict != "ok":
            return
        for step in resolved.steps:
            placed = {i for i in step.anchors if i in self._support}
            if (
                placed
                and self._meant.called
                and not placed & self._meant.called
                and not _SOMEWHERE.search(self._text.lower())
            ):
                yield self._unasked_fault(step.op, "another place is meant")
            color = getattr(step.op, "color", None)
            if color and self._said.likens and not self._is_color_of_named(color, set(step.targets)):
                yield self._unasked_fault(step.op, f"{color} is the colour of nothing that is named")
        spared = {plain_color(c) for c in self._said.left_out}
        kept = {n.id for n in self._scene.graph.nodes if plain_color(n.color) in spared}
        if any(step.op.op not in ("select", "isolate") and kept & set(step.targets) for step in resolved.steps):
            yield self._unasked_fault(resolved.steps[0].op, "what is to be left out is not left out")
        if self._said.points or clears(self._text):
            return
        for step in resolved.steps:
            for role, ids in (("target", step.targets), ("place", step.anchors)):
                own = {i for i in ids if i in self._support}
                if own and step.op.op != "arrange" and not self._meant.may_be(own, role == "place"):
                    yield self._unasked_fault(step.op, f"another {role} is meant")

    def _is_color_of_named(self, color: str, targets: set[Id]) -> bool:
        """Whether a colour is that of a thing that is named and does not get it, or is said itself."""
        assert self._scene is not None
        others = [n.color for n in self._scene.graph.nodes if n.id in self._named - targets and n.color]
        said = [str(c) for c in self._said.values("HUE", "COLOR")]
        return any(alike(color, other) for other in (*others, *said))

    @cached_property
    def _said(self) -> Said:
        return Said(self._text, self._before)

    @cached_property
    def _meant(self) -> Meant:
        assert self._scene is not None
        return Meant(self._scene, self._said.phrases(self._recall), self._said.refers)

    def _unlike_the_reading(self, ops: Sequence[EditOp], resolved: Resolved | None) -> Iterator[Fault]:
        """Steps that do what the grammar does not read in the instruction, and what it reads and no step does.

        Where the grammar is not sure, it may have left a part out; what a plan does beyond its reading is then judged
        by the words.
        """
        if self._scene is None or resolved is None or resolved.verdict != "ok":
            return
        labels = {n.id: n.label for n in self._scene.graph.nodes}
        extra, missing = unlike(resolved.steps, self._reading, self._said.given, labels)
        if extra and not missing and not self._is_sure:
            yield from self._unasked(ops, resolved)
            return
        for effect in extra[:1]:
            op = effect.step.op
            yield self._unasked_fault(op, f"{op.op} {op.subject()} with these values is not what the words say")
        for effect in () if extra else missing[:1]:
            what = f"{effect.op} {labels.get(effect.thing) or effect.thing}"
            told = f"the instruction also asks to {what}. Give all the steps that it asks for"
            reason = f"the model left a part undone, so nothing was done: {what}"
            yield Fault("missing", told, "not_understood", reason)

    @property
    def _is_sure(self) -> bool:
        sure = getattr(self._recall, "is_sure", None)
        return sure is not None and bool(sure(self._text, previous=self._previous))

    @cached_property
    def _reading(self) -> tuple[Step, ...]:
        """What the grammar would do, where it reads the instruction and the scene has what it names; else nothing."""
        if self._scene is None:
            return ()
        try:
            ops = self._recall.plan(self._text, previous=self._previous).ops
        except UserError:  # too long for the grammar
            return ()
        if any(q.pick == "any" for _, q in queries(tuple(ops))):
            return ()
        resolved = self._scene.dry_run(ops) if ops else None
        return resolved.steps if resolved is not None and resolved.verdict == "ok" else ()

    @cached_property
    def _support(self) -> dict[Id, Id]:
        """What each thing stands on."""
        assert self._scene is not None
        return {n.id: n.support for n in self._scene.graph.nodes}

    def _unasked_fault(self, op: EditOp, why: str) -> Fault:
        told = f"{op.op}: {why} in the instruction. Give only the steps that it asks for, on what it names"
        return Fault("unasked", told, "not_understood", f"{_REFUSED}: {op.op} {op.subject()} ({why}). {_REPHRASE}")

    def _broad_removals(self, ops: Sequence[EditOp], resolved: Resolved | None) -> Iterator[Fault]:
        """Operations that remove everything, or many unnamed things, although the instruction does not say "all"."""
        if mentions("all", self._text, self._before):
            return
        sweeping = [op for op in ops if _removes(op) and op.op != "isolate" and _is_everything(op.query())]
        unnamed = self._unnamed(resolved)
        count = len(self._scene.graph.nodes) if self._scene is not None else 0
        if sweeping or len(unnamed) >= max(_MANY, count / 2):
            what = sweeping[0].subject() if sweeping else f"{len(unnamed)} things that it does not name"
            told = f"the instruction does not say that {what} should go. Do only what it says"
            yield Fault("sweeping", told, "not_understood", f"{_REFUSED}: remove {what}. {_REPHRASE}")

    @cached_property
    def _before(self) -> str | None:
        """The previous instruction if it may justify removals too: this one has no command of its own, or says
        "too"."""
        own = _FILLERS.sub("", self._text.casefold()).split(maxsplit=1)
        commands = bool(own) and own[0] in _commands() and not _SAME_AGAIN.search(self._text.casefold())
        return None if commands else self._previous

    def _unnamed(self, resolved: Resolved | None) -> set[Id]:
        """Nodes that would be removed although the instruction names neither their label nor their colour."""
        if resolved is None or self._scene is None:
            return set()
        gone = {i for s in resolved.steps if _removes(s.op) and s.op.op != "isolate" for i in s.targets}
        return gone - self._named if gone else gone

    @cached_property
    def _named(self) -> set[Id]:
        """Nodes that the instruction names."""
        assert self._scene is not None
        relevance = Relevance(self._scene.graph, (self._text, self._previous or ""))
        return {n.id for i, n in enumerate(self._scene.graph.nodes) if relevance.named(i)}

    def _names(self, asset: str) -> bool:
        """Whether the instruction names a new thing ("make the chair a sofa")."""
        heard = stems(self._text) | stems(self._previous or "")
        return bool(set(words(asset)[-1:]) & heard)

    # -- the dry run ------------------------------------------------------------------------------------------------

    def _dry_run_faults(self, resolved: Resolved) -> Iterator[Fault]:
        """Why the plan fails on the graph, if it does."""
        if resolved.verdict == "ok" or self._scene is None:
            return
        shown = self._scene.shown(resolved.candidates)
        if resolved.verdict in ("absent", "ambiguous"):
            how = _IF_ABSENT if resolved.verdict == "absent" else _IF_AMBIGUOUS
            yield Fault(
                resolved.verdict, f"{resolved.verdict}: {resolved.reason}\n{shown}\n{how}", "ok", resolved.reason
            )
        else:
            told = f"{resolved.verdict}: {resolved.reason}. Correct it, or answer with this verdict"
            yield Fault(resolved.verdict, told, resolved.verdict, resolved.reason)


_REFUSED = "the model wanted what the instruction does not ask for, and nothing was done"
_IF_ABSENT = (
    "If the instruction means something that is there, say what, as the scene calls it; if it does not, give the same "
    "ops with this verdict"
)
_IF_AMBIGUOUS = (
    "If the instruction says which one, say it as it does (colors, relations, pick, all); if it does not, give the "
    "same ops with this verdict. Do not choose by id"
)
_REPHRASE = "If you mean it, say so ('delete …', 'keep only …', 'delete everything')"


@cache
def _commands() -> frozenset[str]:
    """First words of commands, except those of "do the same"."""
    alike = {phrase.split()[0] for phrase, (kind, _) in VERBS.items() if kind in ("SAME", "UNITIS")}
    return frozenset(phrase.split()[0] for phrase in VERBS) - alike


def _counterclockwise(op: EditOp) -> EditOp:
    """A turn of which nobody says the way, the way that counts as positive."""
    degrees = getattr(op, "degrees", None)
    turns = op.op == "rotate" and degrees is not None and degrees < 0 and getattr(op, "toward", None) is None
    return op.model_copy(update={"degrees": -degrees}) if turns and degrees is not None else op


def _removes(op: EditOp) -> bool:
    return op.op in _REMOVALS and (op.op != "opacity" or float(getattr(op, "value", 1.0)) <= _HIDDEN_OPACITY)


def _is_everything(query: Query | None) -> bool:
    """Whether a query selects everything."""
    if query is None or query.groups or query.last:
        return query is not None and query.invert
    open_ended = not (query.colors or query.not_colors or query.size or query.relations or query.region)
    return query.invert or query.pick == "rest" or (query.pick == "all" and query.text in _EVERYTHING and open_ended)


def _first_of_each_kind(faults: Sequence[Fault]) -> list[Fault]:
    """The first fault of each kind: invalid plans first, then refusals, then accepted ones."""
    first: dict[str, Fault] = {}
    for fault in faults:
        first.setdefault(fault.kind, fault)
    return sorted(first.values(), key=lambda f: 0 if f.verdict is None else 2 if f.verdict == "ok" else 1)
