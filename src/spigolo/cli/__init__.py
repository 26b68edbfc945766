"""Command line, built from typed functions. Only this package prints and exits.

Exit codes: 0 = done, 1 = some of several frames failed, 2 = an error in the input, with a one-line message. Heavy
modules are imported inside the verbs, so that help appears at once.
"""

from __future__ import annotations

import os
import sys
import warnings
from io import TextIOWrapper
from typing import Any

import cyclopts

from spigolo.errors import SpigoloError

DONE, SOME_FAILED, FAILED = 0, 1, 2


def main() -> None:
    """Run the command line: the entry point of `spigolo`."""
    from spigolo.cli.verbs import app

    warnings.showwarning = _say_warning
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")  # unsupported characters become question marks
    try:
        code = app(result_action="return_value", exit_on_error=False, print_error=True)
        _flush()
    except SpigoloError as error:
        print(f"spigolo: {error}", file=sys.stderr)
        code = FAILED
    except cyclopts.CycloptsError:
        code = FAILED  # already printed
    except BrokenPipeError:  # for example, `| head` closed the pipe
        _write_no_more()
        code = DONE
    except OSError as error:  # for example, the disk of the output is full
        print(f"spigolo: {error}", file=sys.stderr)
        code = FAILED
        try:
            _flush()
        except OSError:
            _write_no_more()
    except KeyboardInterrupt:
        print("spigolo: interrupted", file=sys.stderr)
        code = 130
    sys.exit(code)


def _flush() -> None:
    if sys.stdout is not None:  # None if it was closed
        sys.stdout.flush()


def _write_no_more() -> None:
    """Discard all further output, so that the process ends without a message about a closed pipe."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _say_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    """Print a warning as one line, without the source line that Python adds."""
    print(f"spigolo: warning: {message}", file=sys.stderr)
