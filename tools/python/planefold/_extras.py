"""Packages that only some parts need, imported when these are used."""

from __future__ import annotations

import importlib
from typing import Any


def load(module: str, extra: str) -> Any:
    """A module that an extra of the package brings; one line says which extra is missing."""
    try:
        return importlib.import_module(module, __package__)
    except ModuleNotFoundError as error:
        if error.name is None or error.name.startswith("planefold"):
            raise
        raise ModuleNotFoundError(f"{error.name} is not installed; pip install 'planefold[{extra}]' brings it", name=error.name) from None
