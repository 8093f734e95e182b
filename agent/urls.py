"""URLs on the command line become paths of local copies, before a verb reads its words.

A verb that writes into or beside what it is given gets a copy of its own, where there is a folder for it (a job of a
batch), and is refused otherwise: its work would be lost with the cache.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from ..gaussians.errors import UserError

BESIDE = frozenset({"chat", "embed", "mcp", "name-all", "view"})  # verbs that write beside or into their scene
_OUTPUTS = ("-o", "--output", "--log", "--ids")
_SERVERS = ("http://", "https://")  # values of options: addresses of servers, which their verbs read themselves


def local_words(words: Sequence[str], own: Path | None = None) -> list[str]:
    """The words of a command line with local copies in the place of URLs.

    Args:
        own: folder for copies of what the verb writes to; None: such verbs are refused.

    Raises:
        UserError: a URL stands where the verb writes.
        FileError, BackendError: a URL cannot be read.
    """
    if not any("://" in word for word in words):
        return list(words)
    found = list(words)
    for k, option, url in _named(words):
        if not (words[0] == "batch" and option in ("-o", "--output")):
            found[k] = f"{option}=" * (words[k] != url) + _local(words, option, url, own)
    return found


def urls(words: Sequence[str]) -> list[str]:
    """The URLs of files among the words of a command line."""
    return [url for _, _, url in _named(words)]


def _named(words: Sequence[str]) -> Iterator[tuple[int, str, str]]:
    """The place, the option (empty for an argument) and the URL of each word that names a file by URL."""
    for k, word in enumerate(words):
        option, value = _parted(word)
        option = option or (words[k - 1] if k and words[k - 1].startswith("-") else "")
        if _names_a_file(option, value):
            yield k, option, value


def _parted(word: str) -> tuple[str, str]:
    """The option of `--option=value` and the value; no option and the word of any other."""
    option, equals, value = word.partition("=")
    return (option, value) if word.startswith("--") and equals else ("", word)


def _names_a_file(option: str, value: str) -> bool:
    from ..gaussians.files.remote import is_url

    return "://" in value and is_url(value) and not (option and value.startswith(_SERVERS))


def _local(words: Sequence[str], option: str, url: str, own: Path | None) -> str:
    from ..gaussians.files.remote import cleaned, copied, fetched
    from ..gaussians.tiles.store import is_tiles

    if option in _OUTPUTS:
        raise UserError(
            f"results are written to a path here, not to {cleaned(url)}; `scenewright batch JOBS.jsonl -o URL` writes "
            "to URLs"
        )
    if words[0] not in BESIDE and not (words[0] == "edit" and is_tiles(fetched(url))):
        return str(fetched(url))
    if own is None:
        raise UserError(f"{words[0]} writes beside or into its scene: copy {cleaned(url)} here, or use a batch")
    return str(copied(url, own))
