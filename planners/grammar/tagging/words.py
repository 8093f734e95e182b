"""Tokenizes an instruction: splits it into lower-case words and punctuation marks.

Handles quotes, contractions, fractions, hyphens, possessives and numbers attached to units. Every word keeps its
position in the text, so that a refusal can quote the original.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass

from ....gaussians import late_re as re
from ....gaussians.errors import UserError
from ....gaussians.world.everyday_names import PEOPLE
from ....gaussians.world.words import singular

MAX_CHARS = 1000
MAX_WORDS = 200

_QUOTES = str.maketrans(
    {"‘": "'", "’": "'", "ʼ": "'", "`": "'", "´": "'", "“": '"', "”": '"', "„": '"', "…": ".", "−": "-"}
)
# Marks of Markdown and of chats around words: "**delete the rug**", "- delete the rug", "1) delete the rug", "`rug`".
_MARKUP = re.compile(
    r"(?<!\S)[:;]-?[)(DP](?!\S)|(?<!\w)(?:[*_~]{1,3}|`{1,3})(?=[\w\"'])"
    r"|(?<=[\w.!?,;\"'%°)])(?:[*_~]{1,3}|`{1,3})(?!\w)"
)
_ITEM = re.compile(r"(?:^|[.;!?,]*\s*\n)[ \t]*(?:[-*+•>]|#{1,6}|\d{1,2}[.)])[ \t]+")
_SIGNS = "°℃℉"  # of the symbols that are no words these say something
_VULGAR = {"½": 0.5, "¼": 0.25, "¾": 0.75, "⅓": 1 / 3, "⅔": 2 / 3, "⅛": 0.125}
_VULGAR_FORM = re.compile(rf"([0-9]{{0,4}})\s?([{''.join(_VULGAR)}])")
_CONTRACTIONS = {
    "don't": "do not", "dont": "do not", "doesn't": "does not", "didn't": "did not", "can't": "can not",
    "cannot": "can not", "won't": "will not", "wouldn't": "would not", "couldn't": "could not",
    "shouldn't": "should not", "isn't": "is not", "aren't": "are not", "wasn't": "was not", "i'd": "i would",
    "we'd": "we would", "you'd": "you would", "i'll": "i will", "we'll": "we will", "i'm": "i am", "i've": "i have",
    "you're": "you are", "they're": "they are", "we're": "we are", "it's": "it is", "that's": "that is",
    "what's": "what is", "where's": "where is", "who's": "who is", "how's": "how is", "there's": "there is",
    "here's": "here is", "let's": "let us", "lets": "let us", "gimme": "give me", "lemme": "let me",
    "whatever's": "whatever is", "everything's": "everything is", "that'll": "that will", "it'll": "it will",
    "that'd": "that would", "there'd": "there would",
    "you'll": "you will", "they'd": "they would", "it'd": "it would", "she'd": "she would",
    "he'd": "he would", "we've": "we have", "you've": "you have", "they've": "they have", "weren't": "were not",
    "hasn't": "has not", "haven't": "have not", "hadn't": "had not", "mustn't": "must not",
    "oughtn't": "ought not", "needn't": "need not",
    "mightn't": "might not", "ain't": "is not", "gotta": "have to", "hafta": "have to", "dunno": "do not know",
    "shan't": "shall not", "y'all": "you all", "outta": "out of", "kinda": "kind of", "sorta": "sort of",
    "wanna": "want to", "gonna": "going to", "pls": "please", "plz": "please", "thx": "thanks", "u": "you",
    "shes": "she is", "hes": "he is", "thats": "that is", "theres": "there is", "heres": "here is", "whats": "what is",
    "wheres": "where is", "theyre": "they are", "youre": "you are", "im": "i am", "ive": "i have", "youve": "you have",
    "weve": "we have", "isnt": "is not", "arent": "are not", "wasnt": "was not", "werent": "were not",
    "doesnt": "does not", "didnt": "did not", "cant": "can not", "couldnt": "could not", "wouldnt": "would not",
    "shouldnt": "should not", "wont": "will not", "havent": "have not", "hasnt": "has not", "itll": "it will",
    "cld": "could", "wld": "would", "shld": "should", "ur": "your", "n": "and", "em": "them", "'em": "them",
    "ya": "you", "wot": "what", "cuz": "because", "bc": "because", "tho": "though", "abit": "a bit", "alot": "a lot",
    "teh": "the", "hte": "the", "adn": "and", "nad": "and", "b4": "before", "lil": "little", "bot": "robot",
    "telly": "tv", "dinnae": "do not", "disnae": "does not", "tae": "to", "efter": "after", "hauf": "half",
    "frae": "from",
}  # fmt: skip
# In the singular behind a number above one these are parts of a name: "a two-seater sofa".
_COUNTED = frozenset({"two", "three", "four", "five", "six", "eight", "ten", "twelve"})
_COUNTABLE = frozenset(
    {"seater", "person", "legged", "tier", "tiered", "burner", "drawer", "door", "armed", "bulb", "shelf", "panel"}
)
_TOKEN = re.compile(
    r"->|=>|"
    r"#[0-9a-f]{3}(?:[0-9a-f]{3})?(?![0-9a-z])"
    r"|\d+(?:st|nd|rd|th)\b"
    r"|(?<!\S)-(?=\d)\d+(?:\.\d+)?"
    r"|(?<!\S)-[xyz](?![^\W_])"
    r"|\d+(?:[.,]\d+)*(?:\s*/\s*\d+)?"
    r"|[^\W\d_]+(?:'[^\W\d_]+)*"
    r"|[.;!?,:%°\"'\n]"
    r"|\S",
    re.IGNORECASE,
)


def bag(text: str) -> frozenset[str]:
    """The set of the words in a text, for writing word tables compactly."""
    return frozenset(text.split())


def phrases(text: str, mark: str = ",") -> frozenset[tuple[str, ...]]:
    """The set of the phrases in a text, separated by `mark`, each as a tuple of words."""
    return frozenset(tuple(phrase.split()) for phrase in text.split(mark))


@dataclass(frozen=True)
class Word:
    """One word or mark.

    Attributes:
        text: in lower case; contractions and possessives are split ("'s" is a word of its own).
        start: offset of its first character in the cleaned instruction.
        end: offset behind its last character.
    """

    text: str
    start: int
    end: int


def clean(text: str) -> str:
    """`text` without control characters, emoji and Markdown and with plain quotes, fractions and spaces; case is kept.

    Raises:
        UserError: it is longer than `MAX_CHARS`.
    """
    if len(text) > MAX_CHARS:
        raise UserError(f"the instruction has {len(text)} characters, at most {MAX_CHARS} are read; say it in parts")
    text = _VULGAR_FORM.sub(lambda m: f" {int(m.group(1) or 0) + _VULGAR[m.group(2)]:.12g} ", text)
    text = _ITEM.sub(lambda m: ". " if m.start() else "", unicodedata.normalize("NFKC", text).strip())
    text = _MARKUP.sub("", text).translate(_QUOTES)
    return "".join(" " if _says_nothing(c) else c for c in text).strip()


def _says_nothing(c: str) -> bool:
    """Whether a character is none of a text: control characters, emoji and what joins or tints them."""
    if c == "\n" or (c.isascii() and c.isprintable()) or c in _SIGNS:
        return False
    return not c.isprintable() or unicodedata.category(c) in ("So", "Sk") or "\ufe00" <= c <= "\ufe0f"


def without_owners(words: Sequence[Word]) -> tuple[Word, ...]:
    """The words with people as the first part of a name: "the teacher's desk" is "the teacher desk"."""
    return tuple(
        w
        for i, w in enumerate(words)
        if not (w.text == "'s" and 0 < i < len(words) - 1 and singular(words[i - 1].text) in PEOPLE)
        or words[i + 1].text in ("gotta", "got", "have", "has", "too", "not", "in", "going", "been", "the", "a")
    )


def split(cleaned: str) -> tuple[Word, ...]:
    """The words of a cleaned instruction.

    Raises:
        UserError: it has more than `MAX_WORDS` words.
    """
    words: list[Word] = []
    for found in _TOKEN.finditer(cleaned):
        if _is_dash(cleaned, found.start(), found.end()):
            words.append(Word(",", found.start(), found.end()))  # "the lamp - delete it"
            continue
        words += _parts(found.group().lower(), found.start(), found.end(), words)
    if len(words) > MAX_WORDS:
        raise UserError(f"the instruction has {len(words)} words, at most {MAX_WORDS} are read; say it in parts")
    return tuple(words)


def _is_dash(cleaned: str, start: int, end: int) -> bool:
    """Whether a mark is a dash between two parts of a sentence, not a hyphen or a minus."""
    if cleaned[start:end] not in ("-", "–", "—", "―"):
        return False
    return cleaned[start:end] != "-" or (
        cleaned[end : end + 1] in (" ", "-") and cleaned[start - 1 : start] in (" ", "-")
    )


def _parts(text: str, start: int, end: int, before: list[Word]) -> list[Word]:
    """The words that one raw token stands for: expands contractions, splits possessives, drops quotes and hyphens."""
    if text in ("'", '"') and not (before and before[-1].end == start and before[-1].text[-1].isdigit()):
        plural_owner = text == "'" and before and before[-1].end == start and before[-1].text.endswith("s")
        return [Word("'s", start, end)] if plural_owner else []
    if text in ("->", "=>"):
        return [Word(":", start, end)]
    if text == "-":
        return []
    if text in _COUNTABLE and before and before[-1].text in _COUNTED:
        first = before.pop()
        return [Word(f"{first.text}-{text}", first.start, end)]  # "a two-seater sofa"
    if full := _CONTRACTIONS.get(text):
        return [Word(part, start, end) for part in full.split()]
    if text.endswith("'s"):
        return [Word(text[:-2], start, end), Word("'s", start, end)]
    return [Word(text.replace("'", "") if len(text) > 1 else text, start, end)]
