"""Laws of colour: display RGB to Lab and back, names to RGB and back, and helpful errors."""

from __future__ import annotations

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians import color
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.world.shades import DYES, PAINTS, SHADES
from scenewright.planners.grammar.planner import GrammarPlanner

channel = st.floats(0, 1)


@given(channel, channel, channel)
def test_lab_round_trip(r: float, g: float, b: float) -> None:
    rgb = torch.tensor([r, g, b], dtype=torch.float64)
    back = color.lab_to_rgb(color.rgb_to_lab(rgb))
    # The linear toe and the power law of sRGB meet with a step of 3e-8 at 0.04045, which the inverse may cross.
    assert torch.allclose(back, rgb, atol=1e-6, rtol=0)


@given(st.floats(-0.5, 2), st.floats(-0.5, 2), st.floats(-0.5, 2))
def test_lab_round_trip_outside_the_gamut(r: float, g: float, b: float) -> None:
    rgb = torch.tensor([r, g, b], dtype=torch.float64)
    assert torch.allclose(color.lab_to_rgb(color.rgb_to_lab(rgb)), rgb, atol=1e-6, rtol=0)


def test_lab_of_known_colours() -> None:
    """Values as published for sRGB primaries under D65 (Lindbloom's calculator); two decimals are given there."""
    known = {
        "white": (100, 0, 0), "black": (0, 0, 0), "#808080": (53.59, 0, 0),
        "#ff0000": (53.24, 80.09, 67.20), "#00ff00": (87.73, -86.18, 83.18), "#0000ff": (32.30, 79.19, -107.86),
    }  # fmt: skip
    for name, expected in known.items():
        lab = color.rgb_to_lab(torch.tensor(color.parse(name), dtype=torch.float64))
        assert torch.allclose(lab, torch.tensor(expected, dtype=torch.float64), atol=0.02, rtol=0), name


@given(channel)
def test_grey_has_no_hue_and_lightness_rises(v: float) -> None:
    lab = color.rgb_to_lab(torch.tensor([[v, v, v], [v + 0.01] * 3], dtype=torch.float64))
    assert lab[:, 1:].abs().max() < 1e-4 and lab[0, 0] < lab[1, 0]  # published matrices have seven digits


def test_batches_and_dtype() -> None:
    rgb = torch.rand(4, 5, 3, generator=torch.Generator().manual_seed(0))
    lab = color.rgb_to_lab(rgb)
    assert lab.shape == rgb.shape and lab.dtype == torch.float32
    assert torch.allclose(color.lab_to_rgb(lab), rgb, atol=1e-4)  # float32 powers near black


def test_every_listed_name_parses_into_the_unit_cube() -> None:
    for name in color.names():
        assert len(color.parse(name)) == 3 and all(0 <= c <= 1 for c in color.parse(name)), name


@pytest.mark.parametrize("name", sorted(color.BASIC))
def test_each_basic_colour_is_called_by_its_name(name: str) -> None:
    rgb = torch.tensor(color.parse(color.BASIC[name]), dtype=torch.float64)
    assert color.name_of(color.rgb_to_lab(rgb)) == name


@pytest.mark.parametrize(
    ("text", "hex_value"),
    [
        ("#1F8a8A", "#1f8a8a"), ("#abc", "#aabbcc"), ("Teal", "#008080"), ("Forest-Green", "#228b22"),
        ("light gray", "#d3d3d3"), ("light grey", "#d3d3d3"), ("off-white", "#f5f2e8"), ("  navy ", "#000080"),
        ("reddish", "#ff0000"), ("greenish", color.EVERYDAY["green"]), ("bluish", "#0000ff"),
    ],
)  # fmt: skip
def test_spellings(text: str, hex_value: str) -> None:
    assert color.parse(text) == pytest.approx(color.parse(hex_value), abs=1e-9)


@given(st.floats(0, 100), st.floats(-130, 130), st.floats(-130, 130))
def test_displayable_keeps_lightness_and_hue(lightness: float, a: float, b: float) -> None:
    lab = torch.tensor([lightness, a, b], dtype=torch.float64)
    rgb = color.displayable(lab)
    assert rgb.min() >= 0 and rgb.max() <= 1
    shown = color.rgb_to_lab(rgb)
    # The gamut is taken 1e-4 wide and then clamped, which near black, where the curve is steep, is 0.1 in lightness.
    assert abs(shown[0] - lightness) < 0.1
    cross, dot = a * shown[2] - b * shown[1], a * shown[1] + b * shown[2]
    assert abs(cross) <= 0.1 * max(1.0, lab[1:].norm()) and dot >= -0.1 * max(1.0, lab[1:].norm())


@given(channel, channel, channel)
def test_displayable_leaves_colours_of_the_display_alone(r: float, g: float, b: float) -> None:
    rgb = torch.tensor([r, g, b], dtype=torch.float64)
    assert torch.allclose(color.displayable(color.rgb_to_lab(rgb)), rgb, atol=1e-6, rtol=0)


@pytest.mark.parametrize("base", ["red", "blue", "orange", "purple", "teal", "brown"])
def test_qualifiers_move_lightness_the_way_they_say(base: str) -> None:
    def lightness(text: str) -> float:
        return float(color.rgb_to_lab(torch.tensor(color.parse(text)))[0])

    assert lightness(f"very dark {base}") < lightness(f"deep {base}") < lightness(base)
    assert lightness(base) < lightness(f"pale {base}") < lightness(f"very light {base}")


def test_names_survive_other_users_of_pillow() -> None:
    """Pillow replaces a name's text by numbers in its own table once it has been used."""
    from PIL import ImageColor

    before = color.parse("orchid")
    ImageColor.getrgb("orchid")
    assert color.parse("orchid") == before


@pytest.mark.parametrize(("wrong", "hint"), [("turquiose", "turquoise"), ("pruple", "purple"), ("dark bleu", "blue")])
def test_misspellings_get_suggestions(wrong: str, hint: str) -> None:
    with pytest.raises(UserError, match=hint):
        color.parse(wrong)


@given(st.text(max_size=90) | st.from_regex(r"(dark |light |very dark )*[a-z]{0,9}(ish)*", fullmatch=True))
def test_any_text_is_a_colour_or_a_clear_error(text: str) -> None:
    try:
        assert all(-1e-9 <= c <= 1 + 1e-9 for c in color.parse(text))
    except UserError as error:
        assert "unknown colour" in str(error)


def test_long_text_is_refused_at_once() -> None:
    with pytest.raises(UserError, match="unknown colour"):
        color.parse("dark " * 5000 + "red")


def test_every_colour_that_the_grammar_reads_has_a_value() -> None:
    said = [" ".join(words) for words in SHADES]
    for text in (*said, *PAINTS, *color.FAMILIES, *color.BASIC):
        assert all(0 <= c <= 1 for c in color.parse(text)), text


@pytest.mark.parametrize(
    ("text", "like"),
    [
        ("navy blue", "navy"), ("chocolate brown", "brown"), ("matte black", "black"), ("glossy red", "red"),
        ("mahogany", "#6e2f22"), ("cobalt blue", "#1f4fa8"), ("dark mahogany", None), ("pastel yellow", None),
        ("blue-green", None), ("reddish brown", None), ("fire engine red", None), ("warm white", "white"),
    ],
)  # fmt: skip
def test_colours_said_in_several_words(text: str, like: str | None) -> None:
    found = color.parse(text)
    assert like is None or found in (color.parse(like), color.shade_of(like))


def test_a_mixture_lies_between_its_parts() -> None:
    red, brown, between = (
        color.rgb_to_lab(torch.tensor(color.parse(t))) for t in ("#c8201e", "#7a4a26", "reddish brown")
    )
    assert (between - brown).norm() < (red - brown).norm() and (between - red).norm() < (red - brown).norm()


@pytest.mark.parametrize("text", ["coffee table", "table", "see through", "mahogany desk", "nothing", "blue sofa"])
def test_things_are_no_colours(text: str) -> None:
    with pytest.raises(UserError):
        color.parse(text)


def test_dyes_are_paints_that_need_no_other_word() -> None:
    assert set(PAINTS) > DYES
    for dye in DYES:
        (op,) = GrammarPlanner().plan(f"paint the chair {dye}").ops
        assert (op.op, op.color) == ("recolor", dye)  # type: ignore[union-attr]
