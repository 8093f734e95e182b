"""Write the encoder card, a Markdown page with all figures taken from the `measured.json` that training wrote.

`python -m scenewright.training.card > docs/encoder-card.md`.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from ..gaussians.language.encoders import weights_folder
from ..gaussians.language.encoders.calibration import of_clip
from ..gaussians.language.encoders.vocabulary import Vocabulary

_INTRO = """# Encoder card

The embedded encoder is a small CLIP of our own. Its image tower holds residual convnets over {image_size}-pixel
pictures; its text tower is one attention layer over words. Both map to vectors of {dim} numbers. It ships with the
package as ONNX and needs no network and no GPU. This page is generated from the figures that training measured:
`python -m scenewright.training.card` (from a checkout).

| | |
| --- | --- |
| fingerprint | `{fingerprint}` |
| files | image tower {image_kb} kB, text tower {text_kb} kB, words {words_kb} kB |
| speed, one thread | {milliseconds_per_image} ms a picture, {milliseconds_per_phrase} ms a phrase |
| training set | {pictures:,} pictures of {things:,} things: {designs_per_kind} designs of each of our kinds{too} |
| names | {kinds:.0f} |
| training | {steps:,} steps in {training_minutes:g} minutes on {cores} shared cores, rendering {render_seconds:.0f} s |

    python -m scenewright.training --out FOLDER --assets {designs_per_kind}{objects}

trains such an encoder on a CPU, from a checkout with the extra `train`; `embedded:FOLDER` then selects it. The
length of the training is wall time (`--minutes`), so that another machine makes more or fewer steps and gives other
bytes. `--steps N --seed {seed}` fixes the number of steps; the learning rate then follows steps instead of minutes.
{legs}"""

_DATA = """
## Training set

The training set consists of our own procedural assets{others}. Our own renderer
renders each thing alone, from the sides from which such a thing is usually seen. The picture is cut to the silhouette
and laid over neutral grey, as in the embedding of a scene. Two thirds of our assets are varied: their forms are
tapered, bulged, leaned and stretched, their parts get other colours, grain, stripes, checks, blots and speckles are
printed on them, and light comes from any side, so that names do not hang on the style of the assets. Half of the
things are damaged as segmentation and capture damage them: a side is cut off, the back is never seen, the underside
is lost, the Gaussians are thinned and blurred, they are as uneven, thick, faint and noisy as trained Gaussians, with
floaters around them, or residue of the floor or a fragment of a neighbour is attached. Pieces of things, heaps of
several things, and patches of wall and floor are classes of their own, so that a wrong segment is not called an
object. Light, hue, saturation, resolution, framing, hidden parts and backgrounds vary during training. Random colour
words stand before names: the vectors ignore colour, which is measured on the Gaussians instead.

## Accuracy

Measured on designs whose seeds were not used in training; the calibration was fitted on a third set of seeds{third}.
"""

_RULE = """
## From similarity to probability

For each thing, a phrase competes with the names of all kinds that it does not mean and with the captions of
non-objects, in a softmax at scale {scale:.1f}. If the scene's scale in metres is known, the measured size counts
with weight {size_weight:g}. A thing with a probability of at least {threshold:.2f} counts as named. Scale and weight
were fitted once on held-out things; the threshold is the lowest that refuses 97 % of the absent names in {rooms}
simulated rooms of {room} things and {merges} wrong segments, of our things and of others'. They are not tuned to a
scene. A phrase with a word outside the vocabulary gets probability 0 and a reason.
"""

_LIMITS = """
## Limits

- It knows only the kinds below. A thing of another kind gets the name of the most similar kind or is refused. For
  open vocabularies use another encoder, see the end of this page.
- It learnt the style of our assets and of low-poly models. It recognises other objects less often, above all in real
  captures. The figures on meshes by others show how much.
- Names of food, tools, vehicles and buildings are coarse, since few objects show them. They are there so that such a
  thing is not given the name of a piece of furniture. A word for a sort of them ("cucumber") is answered as
  unconfirmed, and the answer says that it is read as "vegetable".
- It sees shape at {image_size} pixels. Kinds that differ by size alone (a coffee table, a table; a mug, a bin) need
  the measured size, hence metres.
- It ignores colour, material, number, negation and relations by design. Other parts measure or resolve them.
- It reads English words for household objects.
"""

_OTHERS = """
## Other encoders

| encoder | what it needs |
| --- | --- |
| `open_clip:MODEL/PRETRAINED`, `open_clip:DIR` | a real CLIP through open_clip (extra `models`) |
| `onnx:FOLDER` | the same as two ONNX graphs and a tokenizer, as published for transformers.js or by optimum |
| `vectors:PATH` | text vectors with their names, made elsewhere; scenes get theirs from masks with labels or vectors |

`python -m scenewright.gaussians.language.encoders.export open_clip:MODEL/PRETRAINED FOLDER` converts the first into
the second. Without a GPU, ViT-B/32 takes a tenth of a second or more a picture, so that embedding a scene takes
minutes.

They share one rule that is not tuned to a scene. The odds that a thing is the named one are the ratio by which the
phrase fits better than the average name, at the model's own scale, divided by {rivals:g}. A thing with a
probability of at least {threshold:g} counts. Both numbers were fitted with real ViT-B/32 vectors on half of the
LVIS classes (photographs as things, 40 to 1,203 names). On the other half, in simulated scenes of 14 things, the
right thing has the highest probability for {present_right:.0%} of the names; {present_refused:.1%} of the present
names and {absent_refused:.1%} of the absent names are refused. With household things only, against the 140 names
that such encoders propose, {household_present_refused:.1%} of the present and {household_absent_refused:.1%} of the
absent names are refused. Similar kinds are the limit: with 29 kinds of furniture and the like, half of them
present, against all 1,203 names, only {alike_absent_refused:.0%} of the absent names are refused: a cabinet that is
present is taken for the wardrobe that is asked for. Nothing was measured with real towers in real scenes.
"""

_ROWS = (
    ("one crop of a whole thing, top-1", "top1_crop_whole"),
    ("one crop of a damaged thing, top-1", "top1_crop_damaged"),
    ("mean of four crops, whole thing, top-1", "top1_mean_whole"),
    ("mean of four crops, damaged thing, top-1", "top1_mean_damaged"),
    ("the same, whole, with its size known", "top1_mean_size_whole"),
    ("the same, damaged, with its size known", "top1_mean_size_damaged"),
    ("whole or damaged thing classified as one whole object", "whole_called_whole"),
    ("piece, heap, wall or floor classified as one whole object", "not_object_called_whole"),
    ("whole-object score, area under the curve", "wholeness_auc"),
    ("named thing below the threshold", "miss"),
    ("the same with size", "miss_with_sizes"),
    ("other thing over the threshold, for each pair of thing and name", "false_alarm_per_thing"),
    ("the same with size", "false_alarm_per_thing_with_sizes"),
    ("simulated room: present kind answered with the right thing", "room_present_right"),
    ("the same with size", "room_present_right_with_sizes"),
    ("simulated room: absent kind refused", "room_absent_refused"),
    ("the same with size", "room_absent_refused_with_sizes"),
)


def page(folder: Path) -> str:
    """The card of the encoder in `folder`.

    Raises:
        OSError: a file of it is missing.
    """
    card, words, rule = (_read(folder / name) for name in ("measured.json", "words.json", "calibration.json"))
    sizes = {f"{name.split('.')[0]}_kb": round(count / 1000) for name, count in card["bytes"].items()}
    flat = {k: v for k, v in card.items() if isinstance(v, str | int | float)} | sizes
    text = _INTRO.format(
        **flat | {"kinds": card["figures"]["kinds"], "dim": words["dim"]},
        image_size=words["image_size"],
        legs=_legs(card.get("legs", [])) + _joined(card.get("joined")),
        too=f" and {card['objects_by_others']} objects by others" if card["credits"] else "",
        objects=" --objects OBJECTS" if card["credits"] else "",
    )
    others = f" and of {card['objects_by_others']} objects by other artists\n(listed below, all CC0)"
    text += _DATA.format(
        others=others if card["credits"] else "",
        third="\nand on further packs of other artists" if card["credits"] else "",
    )
    text += _figures(card["figures"]) + _rooms(card["rooms"]) + _packs(card) + _strangers(card.get("strangers"))
    text += _RULE.format(**rule, **card["simulated"]) + _LIMITS.format(image_size=words["image_size"])
    real = of_clip()
    others = _OTHERS.format(rivals=real.rivals, threshold=real.threshold, **real.measured)
    return text + _kinds(Vocabulary.from_json(words["vocabulary"]), card["kinds"]) + _credits(card["credits"]) + others


def _legs(legs: list[dict[str, Any]]) -> str:
    """The sentence on trainings that continue one another, if there was more than one."""
    if len(legs) < 2:
        return ""
    each = ", ".join(f"{leg['steps']:,} steps from a rate of {leg['learning_rate']:g}" for leg in legs)
    return (
        f"The shipped weights were trained in {len(legs)} parts, each continuing the last with `--resume`:\n{each}.\n"
    )


def _joined(first: dict[str, Any] | None) -> str:
    """The sentences on the tower that the encoder was joined with, if there is one."""
    if first is None:
        return ""
    return (
        f"\nThe image tower is two: beside the one trained as above stands an earlier and smaller one, trained on "
        f"{first['pictures']:,}\npictures of {first['kinds']} kinds of ours, not varied, in {first['steps']:,} steps. "
        "Their vectors stand side by side, and each label got\none new vector, fitted on the whole training set"
        f"{_in_rooms(first)} (`python -m scenewright.training.join`).\nThe earlier tower tells our own designs apart, "
        "the later one carries over to objects by others.\n"
    )


def _in_rooms(first: dict[str, Any]) -> str:
    """The clause on the groups of rooms that the vectors of labels were fitted on, if there were any."""
    if not first.get("groups"):
        return ""
    return f" and on {first['groups']:,}\ngroups and {first['regions']:,} regions of rooms, as segmentation finds them"


def _figures(figures: dict[str, float]) -> str:
    rows = "\n".join(f"| {said} | {100 * figures[key]:.1f} % |" for said, key in _ROWS)
    return f"\n| on {figures['things']:.0f} unseen things | |\n| --- | --- |\n{rows}\n"


def _rooms(found: dict[str, float]) -> str:
    """The paragraph on furnished rooms."""
    share = {key: f"{100 * value:.1f} %" for key, value in found.items()}
    return (
        f"\nIn {found['rooms']:.0f} furnished rooms with true segments ({found['things']:.0f} objects): top-1 "
        f"{share['top1']}, with true sizes {share['top1_with_size']}; present kinds answered correctly "
        f"{share['present_right']}, absent kinds refused {share['absent_refused']}.\n"
        "This is the upper bound that the encoder sets; segmentation causes any further loss.\n"
    )


def _packs(card: dict[str, Any]) -> str:
    """The paragraph on held-out packs of other artists, if there are any."""
    found = card.get("packs")
    if not found:
        return ""
    share = {key: f"{100 * value:.1f} %" for key, value in found.items()}
    return (
        f"\nOn the packs by other artists that are held out for measurement ({found['things']:.0f} pictures of whole "
        f"things):\ntop-1 {share['top1_whole']}, with sizes {share['top1_size_whole']}; damaged "
        f"{share['top1_damaged']} and {share['top1_size_damaged']}. In simulated rooms of them, with sizes:\npresent "
        f"kinds answered correctly {share['present_right']}, absent kinds refused {share['absent_refused']}.\n"
    )


def _credits(rows: list[dict[str, Any]]) -> str:
    """The table of the objects by others, by pack."""
    if not rows:
        return ""
    lines = [
        "\n## Objects by others\n",
        "Low-poly models that their makers dedicated to the public domain (CC0 1.0); the files are not part of the",
        "package. Packs that calibrate or measure are not trained on, nor are objects that no name fits (a bridge).\n",
        "| pack | artist | licence | use | objects | names |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for row in rows:
        licence = "CC0 1.0" if row["licence"].startswith("CC0") else row["licence"]
        names = ", ".join(sorted(row["names"]))
        lines.append(f"| {row['pack']} | {row['artist']} | {licence} | {row['use']} | {row['count']} | {names} |")
    return "\n".join(lines) + "\n"


def _strangers(found: dict[str, Any] | None) -> str:
    """The row on meshes by others, if they were measured."""
    if not found:
        return ""
    wrong = ", ".join(f"{name} as {guess}" for name, guess in found["wrong"].items())
    named, nameless = found["named"], found["without_name"]
    right, sized = (round(named * found[key]) for key in ("top1", "top1_with_size"))
    refused = f" ({round(nameless * found['refused'])} of them refused)" if nameless else ""
    return (
        f"\nOn {named + nameless} low-poly meshes made by others (Kenney Furniture Kit), which were used for\n"
        f"nothing else: {named} have a name in its vocabulary, {nameless} have none{refused}.\n"
        f"It names {right} correctly, and {sized} with their sizes: top-1 {100 * found['top1']:.0f} % and "
        f"{100 * found['top1_with_size']:.0f} % of those with a name,\n{100 * right / (named + nameless):.0f} % and "
        f"{100 * sized / (named + nameless):.0f} % of all. Asked by name, {100 * found['found']:.0f} % are over the "
        f"threshold.\nMistaken: {wrong}.\n"
    )


def _kinds(vocabulary: Vocabulary, table: dict[str, dict[str, float]]) -> str:
    lines = [
        "\n## Vocabulary, kind by kind\n",
        "Figures are on unseen designs of ours; names that only objects by others show have none.\n",
        "| kind | right | mistaken for | also called |",
        "| --- | --- | --- | --- |",
    ]
    for kind in vocabulary.names:
        row = table.get(kind, {"right": math.nan})
        wrong = ", ".join(f"{k} {100 * v:.0f} %" for k, v in row.items() if k != "right")
        right = "" if math.isnan(row["right"]) else f"{100 * row['right']:.0f} %"
        lines.append(f"| {kind} | {right} | {wrong} | {', '.join(vocabulary.kinds[kind])} |")
    terms = "; ".join(f"{term} ({', '.join(kinds)})" for term, kinds in vocabulary.broader.items())
    return "\n".join(lines) + f"\n\nBroader terms: {terms}.\n\nNon-objects: {', '.join(vocabulary.negatives)}.\n"


def _read(path: Path) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return data


if __name__ == "__main__":
    print(page(weights_folder()), end="")
