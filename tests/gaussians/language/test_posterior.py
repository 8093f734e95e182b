"""Names from all sources: what pictures, detectors and sizes say is multiplied, each within the trust in it."""

from __future__ import annotations

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from scenewright.gaussians.language.encoders import Encoder
from scenewright.gaussians.language.encoders.calibration import Calibration, SizePrior
from scenewright.gaussians.language.encoders.probability import probability
from scenewright.gaussians.language.encoders.vocabulary import Vocabulary
from scenewright.gaussians.language.field.detectors import OTHER, detector_of
from scenewright.gaussians.language.field.language_field import Group, LanguageField, Names
from scenewright.gaussians.language.field.making import Making
from scenewright.gaussians.language.field.posterior import MOST_BELIEFS, MOST_TRUST, USUAL, Belief, belief_of, sharpened
from scenewright.gaussians.language.field.resting import with_rests
from scenewright.gaussians.language.field.scale import estimate_scale
from scenewright.gaussians.language.query.readings import Reading, readings
from scenewright.gaussians.world.box import Box

KINDS = ("chair", "armchair", "sofa", "bicycle", "potted plant", "vase", "mug", "rug", "lamp", "books")
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
LARGE, SMALL = (0.5, 0.5, 0.9), (0.09, 0.09, 0.1)


def prior(*size: float) -> SizePrior:
    return SizePrior(tuple(np.log(size)), (0.3, 0.3, 0.3))  # type: ignore[arg-type]


class Axes:
    """One axis for each kind and one for what is no object."""

    fingerprint = "axes:1"
    dim = len(KINDS) + 1
    image_size = 8
    vocabulary = Vocabulary({k: () for k in KINDS}, {"chair": ("chair", "armchair")}, ("part of something",))
    calibration = Calibration(8.0, 0.21, 1.0, {"chair": prior(*LARGE), "mug": prior(*SMALL)})

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        rows = np.zeros((len(texts), self.dim), np.float32)
        for row, text in zip(rows, texts, strict=True):
            kinds = self.vocabulary.covered(text)
            row[[self.vocabulary.names.index(k) for k in kinds] or [-1]] = 1 / np.sqrt(max(len(kinds), 1))
        return rows

    def encode_images(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        return np.eye(self.dim, dtype=np.float32)[[-1] * len(images)]

    def unknown_words(self, text: str) -> tuple[str, ...]:
        return tuple(w for w in text.split() if not self.vocabulary.covered(text))

    def knows(self, text: str) -> bool:
        return bool(text) and not self.unknown_words(text)


ENCODER: Encoder = Axes()


def picture(kind: str, sure: float = 1.0) -> list[float]:
    """A vector between a kind and no object at all."""
    row = np.zeros(Axes.dim)
    row[KINDS.index(kind)], row[-1] = sure, 1 - sure
    return list(row / np.linalg.norm(row))


def field(
    pictures: list[list[float]], votes: list[Names] | None = None,
    sizes: list[tuple[float, float, float]] | None = None, trust: float | None = None,
) -> LanguageField:  # fmt: skip
    """Objects with these pictures, votes and sizes."""
    groups = tuple(
        Group(
            i, "object", -1, "", 0.0, Box((0, 0, 0), AXES, (sizes or [LARGE] * len(pictures))[i]), (50, 0, 0), 100, 3,
            1.0, votes=(votes or [()] * len(pictures))[i],
        )
        for i in range(len(pictures))
    )  # fmt: skip
    making = None if trust is None else Making("axes", trust=trust)
    return LanguageField(groups, np.array(pictures, np.float32), ENCODER.fingerprint, (), making)


def believed(table: LanguageField, metres: float | None = None) -> Belief:
    return Belief(table, ENCODER, metres)


def test_pictures_that_are_trusted_say_what_the_encoder_says() -> None:
    table = field([picture("chair"), picture("mug", 0.6), picture("vase", 0.5)])
    belief = believed(table)
    assert belief.trust == pytest.approx(MOST_TRUST, abs=0.15)
    for kind in KINDS:
        alone = probability(ENCODER, kind, table.embeddings)
        assert np.allclose(belief.shares(kind).total, alone, atol=0.12)
        assert (belief.shares(kind).total.argsort() == alone.argsort()).all()


@pytest.mark.parametrize("usual", [0.4, 0.6, 0.85])
def test_an_encoder_of_many_names_is_trusted_where_it_is_as_sure_as_usual(usual: float) -> None:
    assert sharpened(usual, usual) == pytest.approx(sharpened(USUAL, USUAL))
    assert sharpened(usual / 3, usual) < sharpened(usual, usual) < sharpened(0.99, usual)
    assert sharpened(0.5, USUAL) == pytest.approx(0.5) and sharpened(1.0, usual) == pytest.approx(1.0)


def test_posteriors_of_disjoint_kinds_sum_to_at_most_one() -> None:
    votes: list[Names] = [(("bicycle", 5.0), ("vase", 2.0), ("", 9.0)), ()]
    belief = believed(field([picture("chair", 0.7), picture("bicycle")], votes), 1.0)
    total = sum(belief.shares(kind).total for kind in KINDS if kind not in ("chair", "armchair"))
    assert (np.asarray(total) <= 1.001).all()
    for names in belief.named():
        assert sum(p for _, p in names) <= 1.001 and [p for _, p in names] == sorted(
            (p for _, p in names), reverse=True
        )


def test_a_detector_beats_look_alikes_where_pictures_are_not_trusted() -> None:
    """All five pictures look like bicycles to an encoder that is lost; one is a bicycle by the detector."""
    pictures = [picture("bicycle", 0.55)] * 4 + [picture("lamp", 0.55)]
    votes: list[Names] = [(), (), (("chair", 9.0),), (("vase", 6.0), ("", 3.0)), (("bicycle", 20.0), ("chair", 1.0))]
    belief = believed(field(pictures, votes, trust=0.2))
    found = belief.shares("bicycle").total
    assert found.argmax() == 4 and found[4] > belief.confirms > found[:4].max()
    assert [names[0][0] for names in belief.named()][2:] == ["chair", "vase", "bicycle"]


def test_no_picture_confirms_a_name_in_a_scene_that_the_encoder_does_not_know() -> None:
    belief = believed(field([picture("sofa")] + [picture("mug", 0.1)] * 9))
    assert belief.trust < 0.3
    assert belief.shares("sofa").total[0] < belief.confirms
    sure = believed(field([picture("sofa")] + [picture("mug")] * 9))
    assert sure.shares("sofa").total[0] > sure.confirms


def test_agreement_with_detectors_raises_the_trust_in_pictures_and_contradiction_lowers_it() -> None:
    pictures = [picture(k, 0.5) for k in ("mug", "vase", "rug", "books")]
    right: list[Names] = [((k, 9.0),) for k in ("mug", "vase", "rug", "books")]
    wrong: list[Names] = [((k, 9.0),) for k in ("vase", "rug", "books", "mug")]
    alone, agreeing, contradicted = (believed(field(pictures, v)).trust for v in (None, right, wrong))
    assert contradicted < alone < agreeing


def test_votes_that_contradict_each_other_speak_for_no_name_that_was_never_heard() -> None:
    """They speak for a kind that is not in question: else, of few names, the unheard ones would share all of it."""
    votes: list[Names] = [(("mug", 1.0), ("vase", 0.9), ("books", 0.8), ("", 6.0)), (("sofa", 9.0),)]
    belief = believed(field([picture("mug", 0.0)] * 2, votes))
    for kind in set(KINDS) - {"mug", "vase", "books", "sofa"}:
        assert belief.shares(kind).total[0] < 1.01 / len(belief.names)  # no more than by chance
    assert belief.shares("sofa").total[1] > belief.confirms
    assert belief.names[-1] == OTHER and all(name != OTHER for names in belief.named() for name, _ in names)


def test_sizes_that_tell_look_alikes_apart_raise_the_trust_in_pictures() -> None:
    """A picture between chair and mug is unsure alone; its size in metres says which of both it is."""
    between = [(a + b) / 2 for a, b in zip(picture("chair"), picture("mug"), strict=True)]
    table = field([between] * 4, sizes=[LARGE, SMALL, LARGE, SMALL])
    assert believed(table, 1.0).confidence > believed(table).confidence + 0.2
    assert believed(table, 1.0).trust > believed(table).trust


def test_one_view_in_thirty_names_nothing() -> None:
    belief = believed(field([picture("mug", 0.0)], [(("sofa", 1.0), ("", 29.0))], trust=0.2))
    assert belief.shares("sofa").total[0] < 0.2


def test_what_a_detector_calls_differently_in_every_view_has_no_sure_name() -> None:
    votes: list[Names] = [(("sofa", 3.0), ("chair", 3.0), ("vase", 3.0), ("books", 3.0))]
    belief = believed(field([picture("mug", 0.0)], votes, trust=0.2))
    assert all(belief.shares(kind).total[0] < belief.confirms for kind in KINDS)


@pytest.mark.parametrize("wrong", [0.0, 0.2, 0.35])
def test_labels_that_are_wrong_now_and_then_still_name_things(wrong: float) -> None:
    """24 views of each of ten things; a wrong label is any of 30 others."""
    rng = np.random.default_rng(3)
    votes: list[Names] = []
    for kind in KINDS:
        said = [kind if rng.random() >= wrong else f"noise {rng.integers(30)}" for _ in range(24)]
        count = {name: float(said.count(name)) for name in dict.fromkeys(said)}
        votes.append(tuple(sorted(count.items(), key=lambda v: -v[1])))
    belief = believed(field([picture("mug", 0.0)] * 10, votes, trust=0.1))
    assert [names[0][0] for names in belief.named()] == list(KINDS)
    assert belief.detector is not None and abs(belief.detector.right - (1 - wrong)) < 0.1


def test_the_size_decides_between_kinds_that_look_alike() -> None:
    between = (np.array(picture("chair")) + np.array(picture("mug"))).tolist()
    table = field([between, between], sizes=[LARGE, SMALL])
    assert [n[0][0] for n in believed(table, 1.0).named()] == ["chair", "mug"]
    shares = believed(table, 1.0).shares("mug")
    assert shares.sources["size"][1] > shares.sources["size"][0]
    assert "size" not in believed(table).shares("mug").sources  # the scale is not known


def test_a_kind_that_only_the_detector_knows_is_found_by_its_votes() -> None:
    votes: list[Names] = [(("cat", 12.0), ("", 4.0)), (("mug", 12.0),)]
    belief = believed(field([picture("rug", 0.3), picture("mug", 0.8)], votes, trust=0.3))
    found = belief.shares("cat")
    assert found.total[0] > belief.confirms > found.total[1]
    assert belief.named()[0][0][0] == "cat"
    assert not belief.shares("giraffe").total.any()  # nobody knows it


def test_a_label_covers_narrower_kinds() -> None:
    """A detector that knows chairs alone calls armchairs so; the picture says which it is."""
    votes: list[Names] = [(("chair", 12.0),), (("chair", 12.0),)]
    table = field([picture("armchair", 0.8), picture("sofa", 0.3)], votes, trust=0.8)
    names = believed(table).named()
    assert names[0][0][0] == "armchair" and names[1][0][0] == "chair"


@given(st.lists(st.floats(0, 40), min_size=3, max_size=3), st.floats(0.05, 0.97))
@settings(max_examples=60, deadline=None)
def test_another_vote_for_the_leading_name_never_lowers_it(weights: list[float], trust: float) -> None:
    """While nothing else changes; the reliability of the detector is held by a second group."""
    weights.sort(reverse=True)
    steady: Names = (("vase", 10.0),)
    base: Names = (("mug", weights[0]), ("vase", weights[1]), ("", weights[2]))
    more: Names = (("mug", weights[0] + 1), ("vase", weights[1]), ("", weights[2]))
    pictures = [picture("mug", 0.5), picture("vase", 0.5)]
    before = believed(field(pictures, [base, steady], trust=trust))
    after = believed(field(pictures, [more, steady], trust=trust))
    detector = detector_of(before.field.groups)
    for belief in (before, after):
        belief.__dict__["detector"] = detector
    if detector is not None and "mug" in detector.heard:
        assert after.shares("mug").total[0] >= before.shares("mug").total[0] - 1e-9


def test_the_same_evidence_gives_the_same_names() -> None:
    votes: list[Names] = [(("mug", 1.0),), ()]
    pictures = [picture("mug", 0.4), picture("vase", 0.4)]
    assert believed(field(pictures, votes)).named() == believed(field(pictures, votes)).named()


# -- readings of a noun ------------------------------------------------------------------------------------------------


def first(table: LanguageField, text: str, metres: float | None = None) -> tuple[Reading, set[int]]:
    """The first reading under which something matches, else the plain one, and what matches."""
    every = list(readings(table, ENCODER, text, metres))
    chosen = next((r for r in every if (r.scores >= r.limit).any()), every[0])
    return chosen, set(np.flatnonzero(chosen.scores >= chosen.limit).tolist())


def test_a_word_means_its_own_kind_first_and_what_it_covers_only_where_none_stands() -> None:
    both = field([picture("chair"), picture("armchair"), picture("sofa")])
    reading, found = first(both, "chair")
    assert found == {0} and reading.confirmed and not reading.note
    reading, found = first(field([picture("sofa"), picture("armchair")]), "chair")
    assert found == {1} and reading.confirmed and "no plain chair" in reading.note
    reading, found = first(field([picture("sofa"), picture("armchair")]), "armchair")
    assert found == {1} and not reading.note


def test_a_name_in_a_scene_that_the_encoder_does_not_know_is_only_likely() -> None:
    table = field([picture("sofa", 0.7), picture("mug", 0.2), picture("mug", 0.0)], trust=0.15)
    reading, found = first(table, "sofa")
    assert found == {0} and not reading.confirmed and "likely" in reading.note
    assert first(table, "bicycle")[1] == set()  # nothing looks like one


def test_a_sort_of_a_kind_is_read_as_the_kind_and_said() -> None:
    reading, found = first(field([picture("chair"), picture("sofa")]), "barstool highchair")
    assert found == {0} and not reading.confirmed and "is read as chair" in reading.note
    assert first(field([picture("chair")]), "zyzzyva")[1] == set()


def test_a_word_of_a_coarse_kind_is_read_as_the_kind_and_said() -> None:
    """The encoder answers "cucumber" with any vegetable; "vegetable" is what the kind is called."""
    coarse: dict[str, tuple[str, ...]] = {"vegetable" if k == "mug" else k: () for k in KINDS}
    coarse["vegetable"] = ("cucumber",)

    class Coarse(Axes):
        fingerprint = "axes:3"
        vocabulary = Vocabulary(coarse, {}, ("part of something",))

    groups = field([picture("mug")]).groups
    table = LanguageField(groups, np.array([picture("mug")], np.float32), "axes:3")
    reading, *_ = readings(table, Coarse(), "cucumber", 1.0)
    assert reading.scores[0] > reading.limit and not reading.confirmed and "is read as vegetable" in reading.note
    reading, *_ = readings(table, Coarse(), "vegetable", 1.0)
    assert reading.scores[0] > reading.limit and reading.confirmed and not reading.note


def test_another_kind_of_a_known_name_must_have_its_size() -> None:
    """The encoder knows "loveseat" as a word for sofas; one of six metres is a sofa and no loveseat."""
    sofas = Vocabulary({**Axes.vocabulary.kinds, "sofa": ("loveseat",)}, {}, ("part of something",))

    class Short(Axes):
        fingerprint = "axes:2"
        vocabulary = sofas

    sizes = [(1.5, 0.85, 0.8), (6.0, 0.85, 0.8)]
    groups = field([picture("sofa")] * 2, sizes=sizes).groups
    table = LanguageField(groups, np.array([picture("sofa")] * 2, np.float32), "axes:2")
    plain, *_ = readings(table, Short(), "loveseat", 1.0)
    assert plain.scores[0] > plain.limit > plain.scores[1] and plain.confirmed
    plain, *_ = readings(table, Short(), "loveseat", None)
    assert plain.scores[1] > plain.limit and not plain.confirmed  # without a scale nothing tells them apart


# -- what things rest on -----------------------------------------------------------------------------------------------


def standing(kind_sizes: list[tuple[tuple[float, float, float], tuple[float, float, float]]]) -> list[str]:
    """Where objects with these centres and sizes rest in a room of 4 x 4 x 2.5 metres."""
    boxes = [Box(center, AXES, size) for center, size in kind_sizes]
    shell = [("floor", (0, 0, -0.01), (4, 4, 0.02)), ("wall", (0, 2, 1.25), (4, 0.1, 2.5))]
    rows = [Group(i, "object", -1, "", 0.0, box, (50, 0, 0), 100, 3, 1.0) for i, box in enumerate(boxes)]
    for name, center, size in shell:
        box = Box(tuple(map(float, center)), AXES, tuple(map(float, size)))  # type: ignore[arg-type]
        rows.append(Group(len(rows), "structure", -1, name, 1.0, box, (50, 0, 0), 100, 3, 1.0))
    table = LanguageField(tuple(rows), np.zeros((len(rows), Axes.dim), np.float32), ENCODER.fingerprint)
    return [g.rests for g in with_rests(table, np.array([0.0, 0.0, 1.0]), 0.0)[: len(boxes)]]


def test_where_things_rest() -> None:
    desk, mug = ((0.0, 0.0, 0.37), (1.2, 0.6, 0.74)), ((0.3, 0.1, 0.79), (0.1, 0.1, 0.1))
    picture_, lamp = ((0.0, 1.93, 1.5), (0.6, 0.03, 0.4)), ((0.0, 0.0, 2.3), (0.3, 0.3, 0.4))
    floating = ((-1.0, -1.0, 1.2), (0.2, 0.2, 0.2))
    assert standing([desk, mug, picture_, lamp, floating]) == ["floor", "surface", "wall", "ceiling", ""]


def test_what_a_thing_rests_on_decides_between_look_alikes_and_outweighs_no_clear_picture() -> None:
    between = (np.array(picture("rug")) + np.array(picture("mug"))).tolist()
    table = field([between, between, picture("mug")])
    where = ("floor", "surface", "floor")
    rows = tuple(replace(g, rests=r) for g, r in zip(table.groups, where, strict=True))
    belief = believed(replace(table, groups=rows))
    assert [n[0][0] for n in belief.named()] == ["rug", "mug", "mug"]
    assert belief.shares("mug").sources["support"][1] > belief.shares("mug").sources["support"][0]


def test_the_scale_is_that_on_which_most_named_things_agree() -> None:
    """A unit is a tenth of a metre; one thing is not what it is called."""
    sizes = {"chair": (0.46, 0.5, 0.88), "sofa": (1.95, 0.87, 0.82), "bicycle": (1.7, 0.5, 1.0), "mug": (2.0, 2.0, 2.0)}
    rows = tuple(
        Group(i, "object", -1, kind, 0.8, Box((0, 0, 0), AXES, tuple(10 * v for v in size)), (50, 0, 0), 100, 3, 1.0)  # type: ignore[arg-type]
        for i, (kind, size) in enumerate(sizes.items())
    )
    found = estimate_scale(rows)
    assert (
        found is not None and found.metres == pytest.approx(0.1, rel=0.1) and found.by == ("bicycle", "chair", "sofa")
    )
    assert estimate_scale(rows[:1]) is None and estimate_scale((rows[0], rows[3])) is None  # one, or two that disagree
    assert estimate_scale([replace(g, label_score=0.3) for g in rows]) is None


def test_the_evidence_is_computed_once_and_freed_with_its_field() -> None:
    asked = field([picture("chair"), picture("sofa")])
    first = belief_of(asked, ENCODER, None)
    assert belief_of(asked, ENCODER, None) is first and belief_of(asked, ENCODER, 2.0) is not first
    assert first.shares("chair").total[0] > 0.5
    for metres in range(3 * MOST_BELIEFS):
        belief_of(asked, ENCODER, float(metres + 1))
    assert len(asked.beliefs) <= MOST_BELIEFS
    freed = [weakref.ref(thing) for thing in (asked, first)]
    del asked, first
    gc.collect()
    assert [thing() for thing in freed] == [None, None]
