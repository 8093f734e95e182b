"""The command line: the list of verbs, and how errors become exit codes and one line of text.

Heavy packages are imported neither here nor at module level in the modules of the verbs.

Exit codes: 0 done; 2 the command was wrong; 3 the instruction could not be carried out as said and nothing was changed;
4 a file or back end failed; 130 interrupted.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Sequence
from typing import Annotated, Any, NoReturn

import typer

from ..gaussians.errors import ScenewrightError
from . import startup
from .options import with_values
from .terminal.output import error_json, terminal
from .urls import local_words

VERBS = (
    "demo", "info", "embed", "name-all", "select", "ask", "describe", "plan", "schema", "check", "compose", "edit",
    "chat", "view", "render", "find-view", "convert", "tile", "export", "mesh", "slim", "mcp", "fit", "dream", "batch",
    "bench", "doctor",
)  # fmt: skip

# They collect no garbage until a session is open or their modules are loaded, and then call `startup.end`.
LOADING_FIRST = (
    "select", "ask", "edit", "describe", "plan", "chat", "find-view", "name-all", "mesh", "info", "render", "convert",
    "embed", "slim", "export", "tile", "fit",
)  # fmt: skip


def _version(value: bool) -> None:
    if value:
        from .. import __version__

        print(f"scenewright {__version__}")
        raise typer.Exit()


def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Edit, build and question 3D Gaussian Splatting scenes in plain words."""


def command_line(verbs: Sequence[str] = VERBS) -> typer.Typer:
    """The command line with some of its verbs. Loading all of them and reading their options takes 0.06 s."""
    app = typer.Typer(
        name="scenewright",
        help="Edit, build and question 3D Gaussian Splatting scenes in plain words.",
        no_args_is_help=True,
        add_completion=False,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback()(_root)
    for verb in verbs:
        module = importlib.import_module(f".commands.{verb.replace('-', '_')}", __package__)
        app.command(verb)(module.command)
    return app


def main(arguments: list[str] | None = None) -> NoReturn:
    """Run the command line on `arguments` and exit with its code.

    Without arguments those of the process are run, and the process ends by `startup.leave_with`.
    """
    if arguments is None:
        startup.own_process()
    try:
        _run(sys.argv[1:] if arguments is None else arguments)
    except SystemExit as end:
        if arguments is None and isinstance(end.code, int):
            startup.leave_with(end.code)
        raise


def _run(given: list[str]) -> NoReturn:
    terminal.as_json = terminal.debug = False
    code: object = 0
    if given and given[0] in LOADING_FIRST:
        startup.begin()
    try:
        verbs = given[:1] if given and given[0] in VERBS else VERBS  # an option or a slip needs the list of all
        given = local_words(given)
        code = command_line(verbs)(with_values(given), standalone_mode=False)
    except ScenewrightError as error:
        if terminal.debug:
            raise
        _report(error_json(error))
        sys.exit(error.exit_code)
    except (KeyboardInterrupt, typer.Abort):
        terminal.say("interrupted")
        sys.exit(130)
    except BrokenPipeError:
        terminal.debug = False
        sys.stderr.close()  # the reader of our output has gone; this keeps Python from reporting it at exit
        sys.exit(0)
    except Exception as error:
        if hasattr(error, "format_message"):  # a usage error of typer
            terminal.as_json = "--json" in given
            _usage_error(error)
        if terminal.debug:
            raise
        note = f"internal error ({type(error).__name__}: {error}); run again with --debug and report it"
        _report({"verdict": "internal", "reason": note, "exit_code": 4})
        sys.exit(4)
    finally:
        startup.end()
        if terminal.debug:
            for line in startup.told():
                terminal.say(line)
    if code == 130:  # an interrupt, as typer reports it
        terminal.say("interrupted")
    sys.exit(code if isinstance(code, int) else 0)


def _usage_error(error: Any) -> NoReturn:
    """Report a command line that cannot be parsed in one line that names the help, and exit with code 2."""
    message = str(error.format_message()).strip()
    if "\n" in message:  # without arguments the message is the help itself
        terminal.say(message)
        sys.exit(2)
    path = error.ctx.command_path if getattr(error, "ctx", None) else "scenewright"
    _report({"verdict": "user", "reason": f"{message.rstrip('.')}; see {path} --help", "exit_code": 2})
    sys.exit(2)


def _report(data: dict[str, Any]) -> None:
    """Print an error as one line on stderr and, with --json, as an object on stdout."""
    if terminal.as_json:
        terminal.row(data)
    terminal.say(f"scenewright: {data['reason']}")
