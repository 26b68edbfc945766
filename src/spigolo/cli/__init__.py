"""Command line of spigolo, built from typed functions. Only this package prints results and sets the exit code.

The exit code is 0 for success, 1 if at least one of several frames failed, and 2 for invalid input. With exit code 2, a
one-line message is printed. Slow modules are imported inside the functions, so that `spigolo --help` starts quickly.
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
    """Run the command line. This function is the entry point of the command `spigolo`."""
    from spigolo.cli.commands import app

    warnings.showwarning = _say_warning
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")  # unsupported characters become question marks
    try:
        code = app(result_action="return_value", exit_on_error=False, print_error=False)
        _flush()
    except SpigoloError as error:
        print(f"spigolo: {error}", file=sys.stderr)
        code = FAILED
    except cyclopts.CycloptsError as error:
        print(f"spigolo: {' '.join(str(error).split())}", file=sys.stderr)
        code = FAILED
    except BrokenPipeError:  # for example, `| head` closed the pipe of the output
        _write_no_more()
        code = DONE
    except OSError as error:  # for example, the disk is full
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
    if sys.stdout is not None:  # None if the parent process closed the output stream
        sys.stdout.flush()


def _write_no_more() -> None:
    """Redirect all further output to the null device, so that Python ends without an error about a closed pipe."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _say_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    """Print a warning on the error stream as one line, without the line of source code that Python adds."""
    print(f"spigolo: warning: {message}", file=sys.stderr)
