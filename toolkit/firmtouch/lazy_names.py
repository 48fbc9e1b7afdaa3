"""Public names of a package that are loaded when they are first used, so that importing it costs nothing."""

from __future__ import annotations

import importlib

TYPE_CHECKING = False  # `typing` itself would cost a third of the package's start
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any


def loader(package: str, home_of: Mapping[str, str]) -> Callable[[str], Any]:
    """Make a package's `__getattr__`: each name comes from its home, a module within the package.

    What it makes raises AttributeError for a name without a home.
    """

    def load(name: str) -> Any:  # noqa: ANN401  # whatever the name stands for
        home = home_of.get(name)
        if home is None:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(importlib.import_module(f"{package}.{home}"), name)

    return load
