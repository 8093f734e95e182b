"""The exceptions that Scenewright raises on purpose, named by who must act. Each message says what to do next.

    ScenewrightError                 exit code
    ├── UserError             2      the request itself is wrong: change the words, the argument, the flag
    ├── InstructionError      3      understood, but cannot be carried out as stated; nothing was changed
    │   ├── AbsentError              the named object is not in the scene
    │   ├── AmbiguousError           several objects match
    │   ├── UnconfirmedError         something was chosen, but not by its name; the user must confirm it
    │   └── CheckFailedError         the edit was made, failed its own check and was rolled back
    ├── FileError             4      a file is missing, broken, unwritable or of an unknown format
    └── BackendError          4      a back end (encoder, planner, renderer) is missing or failed

`assert` is for programming errors, never for a user's input.
"""

from __future__ import annotations


class ScenewrightError(Exception):
    """Base of all deliberate errors; `exit_code` is what the command line returns for it."""

    exit_code = 4


class UserError(ScenewrightError):
    """The request is wrong as written; the message says how to write it."""

    exit_code = 2


class InstructionError(ScenewrightError):
    """The instruction was understood but cannot be carried out as stated. The scene is unchanged."""

    exit_code = 3


class AbsentError(InstructionError):
    """The named object is not in the scene."""


class AmbiguousError(InstructionError):
    """Several objects match and the instruction asks for one."""


class UnconfirmedError(InstructionError):
    """Something was chosen whose name is not confirmed; the user must confirm it before it is edited."""


class CheckFailedError(InstructionError):
    """An edit failed its own post-condition and was rolled back."""


class FileError(ScenewrightError):
    """A file is missing, truncated, malformed, unwritable or of an unknown format."""


class BackendError(ScenewrightError):
    """A back end is not installed, not reachable or gave an unusable answer."""
