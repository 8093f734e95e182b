"""Everyday words for things that the table of kinds does not list: clippings ("amp"), British and American names,
people.

`kinds.json` holds the synonyms of what can be built; these hold for any label. All words are in the singular.
"""

from __future__ import annotations

_SAME = """
amp amplifier / mic mike microphone / phone cellphone / vac hoover / comp computer / pic picture photo / plane
aeroplane airplane / cam camera / sax saxophone / synth synthesizer synthesiser / uke ukulele / specs glasses
spectacles / lorry truck / trike tricycle / dino dinosaur / hippo hippopotamus / rhino rhinoceros / motorbike
motorcycle / can tin pot / nappy diaper / tyre tire / torch flashlight / rubber eraser / pram stroller
pushchair / jumper sweater / mower lawnmower / keyboard keys / hob cooktop / spanner wrench / vice vise /
duvet comforter quilt / plaster bandage / case suitcase / noticeboard corkboard pinboard / pupil student /
register till
"""
_NAMES: dict[str, frozenset[str]] = {}
for _group in _SAME.split("/"):
    for _word in _group.split():
        _NAMES[_word] = _NAMES.get(_word, frozenset()) | frozenset(_group.split()) - {_word}

# Words for a thing of any kind.
GENERIC = frozenset("tool machine appliance gadget device instrument".split())  # noqa: SIM905
# Those whose a thing is said to be, which its label need not tell: "the teacher's desk".
PEOPLE = frozenset(
    """
    teacher pupil student kid child baby toddler mum mom mother dad father granny grandma grandpa wife husband boss
    client customer barber hairdresser doctor nurse patient visitor guest boy girl man woman lady neighbour neighbor
    friend dog
    cat parent brother sister son daughter musician drummer singer player worker owner landlord lodger flatmate roommate
    """.split()  # noqa: SIM905
)


def same_name(word: str) -> frozenset[str]:
    """Other words for what a word names."""
    return _NAMES.get(word, frozenset())


def words() -> tuple[str, ...]:
    """Every word that has other words for what it names."""
    return tuple(_NAMES)
