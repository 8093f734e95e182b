"""Loads the prompts for language models, one Markdown file each, and checks and fills their placeholders.

This package imports nothing of the project. A prompt file begins with a header, and each declared name occurs in its
text as `{{name}}`:

    ---
    placeholders: operations, examples
    ---
"""

from __future__ import annotations

import hashlib
import re
import unicodedata
from dataclasses import dataclass
from functools import cache
from importlib import resources

_HEADER = re.compile(r"\A---\nplaceholders:(?P<names>[^\n]*)\n---\n")
_NAME = re.compile(r"[a-z][a-z0-9_]*")
_PLACEHOLDER = re.compile(r"\{\{(.*?)\}\}", re.DOTALL)


class PromptError(ValueError):
    """A prompt file or the values for its placeholders are not as declared: a programming error, not a user's."""


@dataclass(frozen=True)
class Prompt:
    """One prompt.

    Attributes:
        name: the file name without ".md".
        text: the text after the header, normalised (see `normalised`).
        placeholders: the names that must be filled in.
        hash: the first 16 hexadecimal digits of the SHA-256 of the whole normalised file, header included.
    """

    name: str
    text: str
    placeholders: frozenset[str]
    hash: str

    def fill(self, **values: str) -> str:
        """The text with each placeholder replaced by its value; braces within a value are not placeholders.

        Raises:
            PromptError: a placeholder has no value, or a value has no placeholder.
        """
        missing, unknown = sorted(self.placeholders - values.keys()), sorted(values.keys() - self.placeholders)
        if missing or unknown:
            wrong = [
                f"{what}: {', '.join(names)}" for what, names in (("missing", missing), ("unknown", unknown)) if names
            ]
            raise PromptError(
                f"prompt {self.name}: {'; '.join(wrong)}; its placeholders are {sorted(self.placeholders)}"
            )
        return _PLACEHOLDER.sub(lambda found: values[found[1]], self.text)


@cache
def load(name: str) -> Prompt:
    """The prompt in `NAME.md` of this folder.

    Raises:
        PromptError: there is no such prompt, or its header and its text disagree.
    """
    if not _NAME.fullmatch(name):
        raise PromptError(f"{name!r} is not the name of a prompt; prompts are {', '.join(names())}")
    file = resources.files(__name__).joinpath(f"{name}.md")
    if not file.is_file():
        raise PromptError(f"there is no prompt {name!r}; prompts are {', '.join(names())}")
    return parse(name, file.read_text(encoding="utf-8"))


def names() -> tuple[str, ...]:
    """The names of all prompts, in alphabetical order."""
    files = (file.name for file in resources.files(__name__).iterdir())
    return tuple(sorted(name.removesuffix(".md") for name in files if name.endswith(".md")))


def parse(name: str, source: str) -> Prompt:
    """A prompt from the text of its file.

    Raises:
        PromptError: the header is missing or malformed, or its placeholders differ from those in the text.
    """
    text = normalised(source)
    header = _HEADER.match(text)
    if header is None:
        raise PromptError(f"prompt {name}: the file must begin with ---, a line 'placeholders: a, b' and ---")
    listed = [part.strip() for part in header["names"].split(",")] if header["names"].strip() else []
    body = text[header.end() :].strip("\n") + "\n"
    found = frozenset(_PLACEHOLDER.findall(body))
    if wrong := sorted(n for n in {*listed, *found} if not _NAME.fullmatch(n)):
        raise PromptError(f"prompt {name}: {wrong[0]!r} is not the name of a placeholder; use letters, digits and _")
    if len(set(listed)) != len(listed) or set(listed) != found:
        raise PromptError(f"prompt {name}: declares {sorted(listed)}, but its text has {sorted(found)}")
    return Prompt(name, body, found, short_hash(text))


def normalised(source: str) -> str:
    """The text independent of the editor and system that saved it: composed characters (NFC), line feeds as line
    breaks, no spaces at line ends, no byte order mark, one line feed at the end."""
    text = unicodedata.normalize("NFC", source.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n"))
    return "\n".join(line.rstrip() for line in text.strip("\n").split("\n")) + "\n"


def short_hash(*texts: str) -> str:
    """The first 16 hexadecimal digits of the SHA-256 of the texts in this order."""
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:16]
