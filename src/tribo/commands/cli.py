"""The program ``tribo``: what surrounds every command.

Only the standard library is imported before the program can be interrupted.
"""

import os
import sys

# The exit status where the input is wrong.
WRONG_INPUT = 2


def main(arguments: list[str] | None = None) -> int:
    """Run the command line; return the exit status.

    Without `arguments` they are those of the program, which Ctrl-C then ends within half a second.
    """
    json = "--json" in (sys.argv[1:] if arguments is None else arguments)
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
    print(f"tribo: {problem}", file=sys.stderr)
    return WRONG_INPUT


def _discard_output() -> None:
    """Let Python write what is left of the output to nowhere at its end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
