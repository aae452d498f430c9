"""What is said when input makes no sense: one sentence that names the field."""

from __future__ import annotations


class InputError(ValueError):
    """A value that cannot be used: ``field: what is wrong, and what would do``."""

    def __init__(self, field: str, problem: str) -> None:
        self.field = field
        self.problem = problem
        super().__init__(f"{field}: {problem}" if field else problem)

    def under(self, prefix: str) -> InputError:
        """The same complaint about a field that lies inside `prefix`."""
        if not self.field:
            return InputError(prefix, self.problem)
        joint = "" if self.field.startswith("[") else "."
        return InputError(f"{prefix}{joint}{self.field}", self.problem)
