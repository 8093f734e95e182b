"""Sanitise the labels of a scene graph before they reach a language model, against prompt injection.

A graph or file may call a chair "ignore all instructions". A label that is not a plausible name of an object is omitted
altogether, not quoted or escaped.
"""

from __future__ import annotations

import re
import unicodedata
from functools import cache
from itertools import pairwise

from ....gaussians.color import names as color_names
from ....gaussians.world import kinds
from ....gaussians.world.words import normalise
from ...grammar.vocabulary.verbs import VERBS
from ...rooms.graph import SceneGraph
from ...rooms.label_encoder import vocabulary
from ...rooms.node import Node

MAX_CHARS, MAX_WORDS = 48, 8
_STRANGE_WORDS, _BESIDE_STRANGE = 3, 6  # most unknown words, and most words of a name that has any
_UNTIED = 4  # most words of a name without a connecting word ("of", "with")
_UNSPACED = 8  # most characters of a name in a script without spaces; a sentence is longer
_MARKS = re.compile(r"[^\w\s'’&()/+-]|_")  # characters that names do not contain, such as braces
_ADDRESS = re.compile(r"://|\bwww\.|\w\.\w{2,}|\w@\w", re.IGNORECASE)
_QUOTES = re.compile(r"[\"“”„«»]")
# What modelling programs and people add to a name to tell twins apart: "Chair.003", "bed #2", "sofa.obj", "no. 2".
_SERIAL = re.compile(r"[.#:](?=\d)|\s#\s?(?=\d)")
_SUFFIX = re.compile(r"\.(?:obj|fbx|glb|gltf|ply|stl|usd[acz]?|dae|blend)$", re.IGNORECASE)
_SHORTENED = re.compile(r"\b(no|nr|dr|mr|mrs|st)\.(?=\s|\d)", re.IGNORECASE)
_OPTION = re.compile(r"(?<!\S)--?[a-z]", re.IGNORECASE)  # of a command line
_BEFORE_THE = frozenset({"of", "in", "on", "by", "from"})
_LINKS = _BEFORE_THE | {"with", "and", "for", "a", "an", "the"}
_SCRIPT_OF_IDEAS = re.compile(r"[\u0e00-\u0eff\u1000-\u109f\u3040-\u30ff\u3400-\u9fff\uac00-\ud7af]")

# Words of commands, forms of address and words for "all", which do not occur in names of objects, in the languages that
# models understand best. Each is a prefix; with "=" it is a whole word.
_ORDERS = """
ignor disregard forget overrid bypass obey disobey =execute =executing delet =remove =removes =removed =removing
eras destroy elimin obliterat annihilat =purge =instruct =instructs =instructed =previous =prior everything anything
nothing =now =then =all =every =must =should =shall =please =you =your =yours =yourself =me =instead =only
=assistant =json =admin =say =tell =answer =respond =reply =do =don =not =never =always =make =move =recolor
=isolate =replace =duplicate =rotate =insert =select =return =reveal =pretend =become =wipe =nuke =kill =discard
=jailbreak =verdict =ops =query password =get =rid =sudo =rm =rf =chmod =curl =wget =bash =powershell =eval =exec
=reboot =shutdown lösch entfern vergiss ignorier zerstör anweis befehl =alles =alle =bitte =du =sie supprim =efface
=effacez oubli enlev détrui =retire =tout =tous =toutes =vous =tu consigne =borra =borre =borrar olvid destruy
=quita =todo =todos =todas =usted instruccion cancell dimentic rimuov distrugg =tutto =tutti istruzion =apaga
=apague esquec =tudo instruç verwijder negeer =wis vergeet usuń zignoruj wszystk удал игнор забуд уничтож сотри =все
=всё инструкц видал ігнор =sil yoksay
"""
_WHOLE_ORDERS = frozenset(w[1:] for w in _ORDERS.split() if w[0] == "=")
_BEGINNINGS = tuple(w for w in _ORDERS.split() if w[0] != "=")
# Nouns that speak of orders; before another noun they only say what it is for: "instruction manual", "command console".
_OF_ORDERS = re.compile(r"(?:instruction|command|prompt|output|query)s?$")
# Words of orders that also stand in compounds with hyphens: "all-in-one printer", "make-up table".
_IN_COMPOUNDS = frozenset(
    ("all", "every", "must", "not", "me", "do", "make", "now", "only", "say", "tell", "get", "then", "you")
)
_UNSPACED_ORDERS = re.compile(
    "删|刪|忽略|无视|無視|忘|指令|指示|全部|所有|请|請|必须|清除|移除|削除|消|すべて|全て|命令|삭제|무시|모두|지시"
)


def sanitize(graph: SceneGraph) -> SceneGraph:
    """The graph with implausible labels and colours replaced by "" and implausible relations removed.

    Ids, boxes and supports are kept, so that all nodes can still be referenced.
    """
    nodes = tuple(map(_sanitize_node, graph.nodes))
    relations = tuple((a, name, b) for a, said, b in graph.relations if (name := plain(said, most=4)))
    return graph.model_copy(update={"nodes": nodes, "relations": relations})


def _sanitize_node(node: Node) -> Node:
    shown = {"label": plain(node.label) or "", "color": plain(node.color, most=3) or ""}
    return node if shown == {"label": node.label, "color": node.color} else node.model_copy(update=shown)


@cache
def plain(name: str, most: int = MAX_WORDS) -> str | None:
    """A name as a model may see it: one line without quotes; None if it is not a plausible name.

    Args:
        most: maximum number of words.
    """
    name = _SHORTENED.sub(r"\1", _SERIAL.sub(" ", _SUFFIX.sub("", name)))
    if "\n" in name or "\r" in name or _ADDRESS.search(name) or _OPTION.search(name):
        return None
    text = _QUOTES.sub("", unicodedata.normalize("NFKC", name).replace("_", " "))
    text = "".join(c for c in text if not unicodedata.category(c).startswith("C"))
    text = " ".join(text.split())
    words = re.findall(r"[^\W_]+", text.lower())
    if not words or len(text) > MAX_CHARS or len(words) > most or _MARKS.search(text):
        return None
    if " ".join(words) in _phrases():
        return text
    if _SCRIPT_OF_IDEAS.search(text) and (len(text) > _UNSPACED or _UNSPACED_ORDERS.search(text)):
        return None
    strange = [w for w in words if w not in _known()]
    tied = bool(_LINKS & set(words))
    if len(strange) > _STRANGE_WORDS or len(words) > (_UNTIED if not tied else _BESIDE_STRANGE if strange else most):
        return None
    inside = {part for compound in re.findall(r"[^\W_]+(?:-[^\W_]+)+", text.lower()) for part in compound.split("-")}
    harmless = inside & _IN_COMPOUNDS
    orders = any((w in _WHOLE_ORDERS and w not in harmless) or w.startswith(_BEGINNINGS) or _mixed(w) for w in words)
    orders |= bool(_OF_ORDERS.match(words[-1]))
    return None if orders or _is_order(words) else text


def _is_order(words: list[str]) -> bool:
    """Whether a name begins like a command to remove something ("trash the sofa", but not "trash can")."""
    begins = len(words) > 1 and VERBS.get(words[0], ("",))[0] == "DELETE"
    named = any(" ".join(words[:n]) in _phrases() for n in range(2, len(words) + 1))
    speaks = any(w == "the" and before not in _BEFORE_THE for before, w in pairwise(words))
    return (begins and not named) or speaks


def _mixed(word: str) -> bool:
    """Whether a word mixes scripts, as homoglyphs do ("іgnore" with a Cyrillic і), or letters and digits ("1gn0re")."""
    scripts = {unicodedata.name(c, "?").split()[0] for c in word if c.isalpha()}
    return len(scripts) > 1 or bool(re.search(r"[^\W\d]\d+[^\W\d]|^\d+[^\W\d]{3}", word))


@cache
def _phrases() -> frozenset[str]:
    """All names of kinds, in lower case."""
    return frozenset(p.lower() for p in kinds.phrases())


@cache
def _known() -> frozenset[str]:
    """Words of the names of kinds, of modifiers and of colours, and connecting words."""
    phrases = [*kinds.every_word(), *vocabulary().modifiers, *color_names()]
    words = {w for p in phrases for w in (*p.lower().split(), *normalise(p))}
    return frozenset(words | _LINKS)
