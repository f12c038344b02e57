"""Refusals: one line each, which says what was met and what to do."""

from __future__ import annotations


class Refused(Exception):
    """What was given cannot be used."""


class Error(Refused):
    """The library refused a call, and nothing was changed.

    status  the planefold.Status
    text    the line, as str() gives it
    field   of a configuration: the name of the first bad field, as in "capacity.max_state_dim"; else None
    """

    def __init__(self, text: str, status: int, field: str | None = None) -> None:
        from ._core import Status

        super().__init__(text)
        self.text = text
        self.status = Status(status)
        self.field = field
