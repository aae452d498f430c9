"""The program ``tribo``: what surrounds every command.

Only the standard library is imported before the program can be interrupted.
"""

import os
import sys
from contextlib import suppress

# The exit status where the input is wrong.
WRONG_INPUT = 2


def main(arguments: list[str] | None = None) -> int:
    """Run the command line; return the exit status.

    Without `arguments` they are those of the program, which Ctrl-C then ends within half a second.
    """
    json = "--json" in (sys.argv[1:] if arguments is None else arguments)
    _open_closed_streams()
    try:
        from tribo import interrupts

        if arguments is None:
            interrupts.watch(json)
        return _run(arguments)
    except KeyboardInterrupt:
        from tribo import interrupts

        interrupts.answer()
        interrupts.report(json)
        return interrupts.STOPPED


def _open_closed_streams() -> None:
    """Read from and write to nowhere where a shell or a daemon has closed a stream.

    A file that was opened later would have its number, and what is printed would go into the file.
    """
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is not None:
            continue
        try:
            os.fstat(number)
        except OSError:  # the lowest number that is free
            os.dup2(os.open(os.devnull, os.O_RDWR), number)
        stream = open(os.devnull, "w" if number else "r", encoding="utf-8")  # noqa: SIM115
        setattr(sys, name, stream)


def _run(arguments: list[str] | None) -> int:
    """Run a command, and turn the errors that a user can cause into one sentence."""
    from tribo.commands.parser import run_command
    from tribo.interrupts import STOPPED
    from tribo.validation import InputError

    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # a title may have letters that a terminal lacks
            stream.reconfigure(errors="backslashreplace")
    try:
        status = run_command(arguments)
        sys.stdout.flush()
        return status
    except InputError as error:
        problem = str(error)
    except MemoryError as error:
        problem = f"this scene needs more memory ({error})"
    except BrokenPipeError:
        _discard_output()
        return STOPPED
    except OSError as error:
        _discard_output()
        problem = f"the output cannot be written ({error.strerror or error})"
    with suppress(OSError):  # of a full device, or of a program that reads no more
        print(f"tribo: {problem}", file=sys.stderr)
        sys.stderr.flush()
    return WRONG_INPUT


def _discard_output() -> None:
    """Let Python write what is left of the output to nowhere at its end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
