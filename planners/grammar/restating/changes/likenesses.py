"""Sentences that ask for the material of another thing or of a photograph: "the pattern of the curtain on the sofa".

They become sentences about a new colour: "paint the sofa like~material the curtain", "paint the floor #photo"
(see `vocabulary.materials`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache

from .....gaussians import late_re as re
from .....gaussians.world import kinds
from .....gaussians.world.finishes import said as finish_said
from .....gaussians.world.finishes import words as finish_words
from .....gaussians.world.lengths import UNITS
from ...tagging.lookahead import color_at
from ...tagging.words import Word, bag
from ...vocabulary.materials import ANYTHING, LIKE, PHOTO, mark
from ..chunks import is_thing
from ..speech.frames import unframed
from .covering import covered, names_material, spelled
from .styles import names_style, styled

Size = tuple[str, str]  # a number and its unit, as they are said
_SURFACES = (
    "patterns?|materials?|fabric|texture|textile|print|design|finish|surface|motif|weave|upholstery|cloth|covering|"
    "stone|wood grain|grain|tiling|look|cladding|veneer|wallpaper|stuff|kind of wood|sort of wood|type of wood"
)
_OWNED = "pattern|texture|fabric|print|design|motif|material|upholstery|cover fabric"
_ONES = r"(?:(?:that|those|the one|the ones|what is|what you see) )?(?:of|on|in|from|for) |that of |"
_DET = r"(?:the|that|this|those|these|my|our|your|his|her|their|both|all|every)"
_NP = rf"(?:(?:{_DET} )?[a-z][^,;]*?|it|them|this|that|these|those|everything)"
_DO = (
    "make|do|paint|cover|upholster|reupholster|clad|wrap|finish|refinish|restyle|texture|retexture|redo|dress|line|"
    "style|have|want|turn|i want|i would like|i need|i would love|render|tile|panel|surface|resurface|decorate|change|"
    "switch|convert|build|rebuild|remake|redecorate|wallpaper|recover|coat|match|get|let|give|skin|re cover|veneer|set|"
    "re upholster|re texture|re do|replace|swap|exchange"
)
_OUGHT = "(?:should|needs to|must|has to|shall|ought to|could|is to)"
_LINK = (
    r"(?:(?:to be|be|have|has|to have|get|gets|wear|become|show|up|over|again|completely|entirely|all over|made|done|"
    r"covered|upholstered|finished|look|looks|looking|appear|using) )*"
    r"(?:(?:out of|of|from|in|into|with|to|using|by|after|for) )?"
)
_LAY = (
    "put|use|apply|lay|copy|transfer|bring|add|spread|place|try|take|extend|repeat|clone|carry|map|project|paste|have"
)
_ONTO = r"(?:(?:over|across|all over|also|too) )?(?:on|onto|to|for|over|across|upon|on to|over to)"
_POLITE = (
    r"(?P<polite>(?:(?:please|now|then|also|next|finally|and|ok|okay|can you|could you|would you|can we|could we|"
    r"i would like you to|i want you to|just|go ahead and|let us) )*)"
)
_TAIL = r"(?P<tail>(?: (?:,|please|too|as well|instead|now|thanks|again|exactly|everywhere|all over))*)"
_PHOTO = (
    r"(?:(?:the|this|that|my|our|a|an|attached|given|uploaded|sample|supplied|provided|same) )*"
    r"(?:photo|photograph|swatch|photo file|reference|reference (?:photo|picture|image|photograph|pic)|"
    r"(?:sample|uploaded|attached|given|supplied) (?:picture|image|pic|photo))"
)
_PICTURE = rf"(?:{_PHOTO}|(?:(?:the|this|that|my) )+(?:picture|image|pic|file))"
_UNIT = "|".join(sorted((u for u in UNITS if u.isalpha() and UNITS[u] != "units"), key=lambda u: (-len(u), u)))
_LENGTH = rf"(?P<n>\d+(?:\.\d+)?) ?(?P<u>{_UNIT})"
_WIDE = re.compile(
    rf" ?(?:, ?|; ?)?(?:and |where |which |it |the photo |the picture |the image |that |photo |that one )*"
    rf"(?:is |shows |which is |covers |being |about |taken as |at |roughly )*{_LENGTH} "
    r"(?:wide|across|in width|broad)$"
)
_SAID_SIZE = re.compile(rf"(?:\d+(?:\.\d+)? ?(?:x|by) )?{_LENGTH} ?(?:wide |square |long |big )?$")
_SHOWN = re.compile(r"\b(?:photo|photograph|swatch|reference|picture|image|pic|file)\b")
_FILE = re.compile(
    r"(?:\bthe (?:photo|picture|image|file) )?(?<![\w./\\-])\"?"
    r"(?P<name>[\w-][\w.-]{0,80}?\.(?:jpe?g|png|webp|bmp|tiff?|gif))\b\"?",
    re.IGNORECASE,
)
_MARKS = (".", "!", "?", "\n")
_ASKED = re.compile(r"^(?:can|could|may|should|shall|would) (?=(?:the|my|our|this|that) )")
_CARRIED = re.compile(rf"^{_POLITE}(?:put|place|bring|take|carry|lay|spread|add) (?:the|that) (?!same)")
# What may be picked up from a thing.
_LOOSE = bag(
    "cloth carpet canvas textile felt fur grass sand gravel pebbles rock rocks boards tile tiles bricks sheepskin"
)
_SENT = (
    r"(?:that )?i (?:have |had |'ve |just )*(?:uploaded|sent|attached|shared|posted|gave you|showed you)(?: you)?"
    r"(?: before| earlier)?"
)
_SAME = re.compile(
    rf"^(?:(?:make|turn|do|have|get|finish|render) )?(?P<thing>(?:the |my |our )?[a-z]+(?: [a-z]+)??) (?:in |be |"
    rf"look |: )*"
    rf"(?:(?:exactly |just )?(?:the )?same (?:material |fabric |wood |finish |look )?(?:as|like)|(?P<color>the "
    rf"colou?r of)) (?P<src>{_DET} [^,;]+)$"
)
_LATE = re.compile(r" ,? ?but in (?P<hue>[a-z ]+)$")
_KEPT = re.compile(
    r" ,? ?(?:and |but )?(?:(?:the|its) [^,]+? (?:stays?|remains?) (?:as (?:it )?(?:is|it is)|the same|unchanged)|"
    r"keep (?:the|its) [^,]+|leave (?:the|its) [^,]+|, (?:all (?:of them|three|four|two)|both)|if you can|if possible|"
    r"please(?: , (?:all (?:of them|three|four|two)|both))?)$"
)
_BESIDE = frozenset({"of", "from", "off", "as", "like", "to", "with", "matching", "'s", "on", "in"})
_LOOKS = re.compile(r"\b(?:look|appear|finished|match)\b")
_DOING = (
    "put|use|give|make|move|delete|remove|paint|turn|cover|upholster|add|rotate|scale|apply|lay|replace|copy|take|do|"
    "change|recolor|recolour"
)
_JOINT = re.compile(rf" (?:, )?(?:and then|and|then|but) (?=(?:{_DOING})\b)| , (?=(?:{_DOING})\b)| ; ")


@cache
def _surface() -> str:
    """What a surface is called: "pattern", "wood", "brick"."""
    names = sorted(finish_words(), key=lambda w: (-len(w), w))
    size = rf"(?P<size>(?:\d[\d.]* ?(?:x|by) )?\d[\d.]* ?(?:{_UNIT}) (?:wide |square |big )?)?"
    more = "(?: (?:pattern|texture|design|print|finish|covering|material))?"
    return rf"{size}(?P<w>{'|'.join(map(re.escape, names))}|{_SURFACES}){more}"


@cache
def _sources() -> tuple[str, ...]:
    """How the surface of another thing is named."""
    w = _surface()
    source = rf"(?P<src>{_DET} [^,;]+?)"
    same = r"(?:exact same|very same|same|identical|matching|exact)"
    also = r"(?: and (?:colou?r|pattern|material))?"
    alike = "like|matching|as on|as in|to match|similar to"
    return (
        rf"(?:the |a |an )?{same} {w}{also} (?:as|like|to|with|of|from) (?:{_ONES}){source}",
        rf"(?:(?:some|a|the|of|real) )*{w} (?:just |exactly )?(?:{alike}) (?:{_ONES}){source}",
        rf"(?:the|that|a|its) {w} (?:of|from|off|used for|used on|that is on|seen on|found on) {source}",
        rf"(?:the|that) (?P<w>{_SURFACES}) (?:on|in) {source}",
        rf"{w} (?:of|from|off) {source}",
        rf"(?P<src>(?:the )?(?!(?:same|that) )[a-z]+(?: [a-z]+)?) (?P<w>{_OWNED})",
        rf"{source} 's (?P<w>{_SURFACES}|wood|stone|brick|tiles|marble|leather|carpet)",
    )


@cache
def _of_things() -> tuple[re.Pattern[str], ...]:
    thing = rf"(?P<thing>{_NP})"
    found = list[str]()
    for source in _sources():
        found += [
            rf"(?:{_DO}) {thing} {_LINK}(?:(?:match|matches|matching|be) (?:with |to )?)?{source}",
            rf"(?:{_LAY}) {source} {_ONTO} {thing}",
            rf"(?:{_LAY}) {source} and (?:put|use|apply|lay|copy) it {_ONTO} {thing}",
            rf"{thing} (?:in|with|made of|made from|out of|of|gets|get|{_OUGHT} (?:be|have|get|match|wear|look)|to|"
            rf"wants|needs|to get|to have|to be|to match) {_LINK}{source}",
            rf"{thing} (?:should|must|needs to) match {source}",
            rf"{source} (?:on|for|onto|over|to) {thing}",
        ]
    likened = (rf"(?:{_DO}) {thing} (?:match|to match) (?P<src>{_DET} [^,;]+?) (?:in|by) (?P<w>{_SURFACES})",)
    return tuple(re.compile(rf"^{_POLITE}{form}{_TAIL}$") for form in (*found, *likened))


@cache
def _of_photographs() -> tuple[re.Pattern[str], ...]:
    w, thing = _surface(), rf"(?P<thing>{_NP})"
    inside = "of|in|on|from|shown in|shown on|seen in|out of|as in|like in"
    shown = rf"(?:(?:the|that|those|these) )?(?:[a-z]+ )?{w} (?:{inside}) {_PICTURE}"
    as_ = rf"(?:as|like|for) (?:(?:a|an|the|new|its) )*{w} (?:of|on|for|onto|over|to|across) {thing}"
    like = rf"like|as|(?:(?:with|in|of|to|out of) )?(?:the )?same(?: {w})? as|the same as|similar to|matching|to match"
    ones = "it is|that|the one|the ones|shown|seen|those|what is|what you see"
    there = rf"(?:{like}|match|after) (?:(?:{ones}) )*(?:in|on|from) {_PICTURE}"
    alike = r"(?:like|as|match|matching|to match|the same as) (?:the one in )?"
    rooms = "floor|flooring|ceiling|wall|walls|worktop|wallpaper"
    found = (
        rf"(?:(?:{_DO}) )?{thing} {_LINK}(?:exactly |just |something )?{there}",
        rf"(?:(?:{_DO}) )?{thing} {_LINK}(?:exactly |just )?{alike}{_PHOTO}",
        rf"(?:{_DO}) {thing} {_LINK}(?:look )?(?:like|match|matching) {_PICTURE}",
        rf"(?:{_LAY}) {_PICTURE} {as_}",
        rf"(?:{_LAY}) {_PHOTO} {_ONTO} {thing}",
        rf"(?:use|take|apply) {_PICTURE} {_ONTO} {thing}",
        rf"(?:{_LAY}) {_PICTURE} (?:as|for) (?P<thing>the (?:new )?(?:{rooms}))",
        rf"(?:{_DO}) {thing} {_LINK}{_PHOTO}",
        rf"(?:{_DO}) {thing} {_LINK}{shown}",
        rf"(?:{_LAY}) {shown} {_ONTO} {thing}",
        rf"{thing} (?:in|with|out of|of|from|using) {shown}",
        rf"{shown} (?:on|for|onto|over) {thing}",
        rf"{_PHOTO} (?:on|for|onto|over) {thing}",
        rf"{w} (?:like|as) (?:in|on|from) {_PICTURE} ?,? (?:on|for|onto) {thing}",
        rf"{thing} {_OUGHT} (?:look |be )?(?:exactly )?(?:like|as|as in|like in|match) {_PICTURE}",
        rf"(?:{_LAY}) {shown} and (?:put|use|apply|lay|copy) it {_ONTO} {thing}",
        rf"(?:{_LAY}) {_PHOTO} and (?:put|use|apply|lay|copy) it {_ONTO} {thing}",
    )
    return tuple(re.compile(rf"^{_POLITE}{form}{_TAIL}$") for form in found)


def with_photo(text: str) -> tuple[str, str]:
    """A text with the name of one picture file as "the photo", and that name; "" if it names none, or several."""
    found = list(_FILE.finditer(text))
    if len(found) != 1:
        return text, ""
    (name,) = found
    return f"{text[: name.start()]}the photo{text[name.end() :]}", name["name"]


def with_likenesses(words: Sequence[Word]) -> tuple[Word, ...]:
    """The words of an instruction with its sentences as `likened` says them; each such word has the place of all."""
    found = list[Word]()
    start = 0
    for i in range(len(words) + 1):
        if i < len(words) and words[i].text not in _MARKS:
            continue
        sentence = words[start:i]
        text = " ".join(w.text for w in sentence)
        plain = likened(text) if sentence else None
        if plain is None:
            found += sentence
        else:
            found += [Word(text, sentence[0].start, sentence[-1].end) for text in plain.split()]
        found += words[i : i + 1]
        start = i + 1
    return tuple(found)


def likened(said: str) -> str | None:
    """A sentence with each of its commands for the surface of another thing or of a photograph in other words; None if
    it has none."""
    said = spelled(said)
    shown = _SHOWN.search(said) is not None
    if not (
        shown
        or " same " in said
        or " the colour of " in said
        or names_material(said)
        or names_style(said)
        or _LOOKS.search(said)
        or _names_surface(said)
    ):
        return None
    size: Size | None = None
    if shown and (wide := _WIDE.search(said)) is not None:
        said, size = said[: wide.start()].rstrip(" ,;"), (wide["n"], wide["u"])
    if (whole := _clause(said, size, shown)) is not None:
        return whole
    parts = _JOINT.split(said)
    joints = [m[0] for m in _JOINT.finditer(said)]
    plain = [_clause(part, size, shown) for part in parts]
    if not any(plain):
        return None
    told = [new or old for new, old in zip(plain, parts, strict=True)]
    return told[0] + "".join(joint + part for joint, part in zip(joints, told[1:], strict=True))


@cache
def _surface_words() -> frozenset[str]:
    names = (*finish_words(), *_SURFACES.replace("?", "").split("|"), "pattern", "material")
    return frozenset(w for name in names for w in name.split())


def _names_surface(said: str) -> bool:
    """Whether it names a surface, and something beside it that may have it."""
    texts = said.split()
    linked = not _BESIDE.isdisjoint(texts)
    return linked and not _surface_words().isdisjoint(texts)


def _clause(said: str, size: Size | None, shown: bool) -> str | None:
    """One command in other words, None if it asks for nothing of the kind."""
    if (look := styled(said)) is not None:
        return look
    spoken = said
    said = _KEPT.sub("", _ASKED.sub("", _in_photo(said)))
    shown = shown or _SHOWN.search(said) is not None
    hue = ""
    late = _LATE.search(said)
    color = color_at(late["hue"].split(), 0) if late is not None else None
    if late is not None and color is not None and color[1] == len(late["hue"].split()):
        said, hue = said[: late.start()], f" and paint it {late['hue']}"
    for pattern in _of_photographs() if shown else ():
        for found in _matches(pattern, said):
            named = mark(PHOTO, *filter(None, (_material(found),)), size=_length(found) or size)
            return f"{found['polite']}paint {_wall(found['thing'])} {named}{found['tail']}"
    plain = unframed(said)
    for pattern, words in ((p, w) for w in dict.fromkeys((said, plain)) for p in _of_things()):
        for found in _matches(pattern, words):
            carried = _CARRIED.match(words) is not None and found.groupdict().get("w") in _LOOSE
            bare = found["src"].removeprefix("the ")
            if "(?!(?:same|that) )" in pattern.pattern and kinds.find(bare) is None:
                continue  # "a flower pattern on the sofa" is no flower's
            if carried or not is_thing(tuple(found["src"].split())):
                continue
            name = _material(found) or ANYTHING
            return f"{found['polite']}paint {found['thing']} {LIKE}{name} {found['src']}{found['tail']}{hue}"
    return _same(plain) or covered(spoken)


def _same(said: str) -> str | None:
    """ "bookshelf same as the side table", "walls the colour of the sofa"."""
    found = _SAME.match(said)
    if found is None or not all(is_thing(tuple(found[side].split())) for side in ("thing", "src")):
        return None
    way = "the colour of" if found["color"] else LIKE + ANYTHING
    return f"paint {found['thing']} {way} {found['src']}"


def _in_photo(said: str) -> str:
    """A sentence whose words for what somebody sent or uploaded name the photograph."""
    said = re.sub(r"\bfotos?\b", "photo", said)
    said = re.sub(rf"\b(photo|picture|image|pic) {_SENT}", "photo", said)
    return re.sub(rf"\b(?:that|the|a|this) ((?:[a-z]+ )?[a-z]+) {_SENT}", r"the \1 from the photo", said)


def _matches(pattern: re.Pattern[str], said: str) -> Iterator[re.Match[str]]:
    """The reading of a command by a pattern whose target is one noun phrase."""
    found = pattern.match(said)
    if found is not None and (found["thing"] in _PRONOUNS or is_thing(tuple(found["thing"].split()))):
        yield found


_PRONOUNS = frozenset({"it", "them", "this", "that", "these", "those", "everything"})


def _material(found: re.Match[str]) -> str:
    """What a surface is said to be: "wood"; "" for a pattern."""
    name = found.groupdict().get("w")
    known = finish_said(name) if name else None
    return known.finish if known is not None else ""


def _length(found: re.Match[str]) -> Size | None:
    """The length of what repeats, None where none is said."""
    said = found.groupdict().get("size")
    told = _SAID_SIZE.search(said.strip()) if said else None
    return (told["n"], told["u"]) if told is not None else None


def _wall(thing: str) -> str:
    """A wall of which only the paper is named."""
    return "the walls" if thing in ("the wallpaper", "the new wallpaper") else thing.replace("the new ", "the ")
