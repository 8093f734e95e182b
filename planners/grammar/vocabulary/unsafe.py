"""Detects requests that are not about the scene but unsafe: files, shell commands, secrets, prompt injection.

A computing noun alone is not enough if such a thing may be in a room: a folder on a desk or a server rack is furniture.
"""

from __future__ import annotations

import re
from functools import cache

_CODE = r"""
\brm\s+-?rf?\b | \bsudo\b | \bchmod\b | \bmkfs\b | \bos\.\w+\( | \bsubprocess\b | \b(?:eval|exec|system)\s?\(
| \bimport\ os\b | \b(?:curl|wget|ssh|scp|powershell|cmd\.exe|bash\ -c|drop\ table)\b
| \b(?:pip|apt(?:-get)?)\ install\b
| \bexecute\b | \b(?:run|launch|invoke)\b.*\b(?:commands?|scripts?|code|programs?|shell|bash|python)\b
| \bopen\ (?:a|the|up\ a)\ (?:terminal|shell|command\ (?:prompt|line)|browser)\b | \bdownload\b | \bhack\b
| \b(?:kill|terminate)\ (?:the\ |all\ |every\ )?process(?:es)?\b | \breboot\b | \bshut\s?down\b
| \brestart\ the\ (?:computer|machine|server|system)\b
| \b(?:format|wipe|erase|nuke|delete|destroy|encrypt)\b.*\b(?:disk|partition|registry|backups?|data\ ?base)\b
"""
# A file cabinet is furniture.
_FILES = r"""
\bfiles?\b(?!\ (?:cabinet|box|holder|rack|organi[sz]er|drawer|folder|tray|storage))
| \b(?:home|root|system|working)\ (?:directory|folder)\b | \bdirector(?:y|ies)\b
| \b(?:documents?|downloads?|desktop|user'?s?|pictures)\ (?:documents?\ )?folder\b | /etc/ | /home/ | ~/ | \bc:\\
| \b(?:hard\ drive|hard\ disk|file\ ?system|malware|ransomware|database)\b
"""
_SECRETS = r"""
\bpass(?:word|code|phrase)s?\b | \bcredentials?\b | \b(?:api|secret|private|access)\ (?:keys?|tokens?)\b
| \bcredit\ card\b | \bbank\ account\b | \benvironment\ variables?\b | \bsystem\ prompt\b
| [$€£]\s?\d | \b(?:transfer|wire|send)\b.*\b(?:money|dollars|euros|bitcoin|funds)\b
| \b(?:upload|e-?mail|exfiltrate|tweet)\b
| \bleak\ (?:the|my|your|our|all|this|it|them)\b | \bsend\ me\ the\ contents?\b | \w@\w+\.\w | \bhttps?://
| \b(?:send|post|share|forward|publish|copy|transmit|move)\b.*
  \b(?:server\b(?!\ (?:rack|cabinet|stand|room))|internet|the\ web|online|twitter|facebook|instagram|reddit|cloud|ftp)\b
"""
# Prompt injection.
_ORDERS = r"""
\b(?:ignore|disregard|forget|override|bypass|disobey|skip)\b.{0,40}
  \b(?:instructions?|rules?|prompts?|guidelines?|restrictions?|safety|polic(?:y|ies)|commands?)\b
| \b(?:previous|prior|your|earlier|above)\ instructions\b | \breveal\ your\b | \bjailbreak\b | \byou\ are\ now\b
| \bdeveloper\ mode\b
"""


@cache
def _patterns() -> tuple[re.Pattern[str], ...]:
    return tuple(re.compile(p, re.IGNORECASE | re.VERBOSE) for p in (_CODE, _FILES, _SECRETS, _ORDERS))


def unsafe_words(cleaned: str) -> str:
    """The words that make an instruction unsafe, "" if there are none."""
    for pattern in _patterns():
        if found := pattern.search(cleaned):
            return found.group()
    return ""
