"""The way to MuJoCo, which is an optional extra."""

from __future__ import annotations

from types import ModuleType

from firmtouch.errors import InputError


class MissingOracleError(InputError):
    """MuJoCo is asked for and not installed."""

    def __init__(self) -> None:
        super().__init__(
            "the comparison with MuJoCo needs the package `mujoco`, which is not installed; "
            "install it with `pip install 'firmtouch[oracle]'`"
        )


class NotExpressibleError(InputError):
    """A mechanism, a constraint or a setting that MuJoCo has no words for."""


def load_mujoco() -> ModuleType:
    """Import MuJoCo.

    Raises
    ------
    MissingOracleError
        If it is not installed.
    """
    try:
        import mujoco
    except ModuleNotFoundError as error:
        if error.name != "mujoco":
            raise
        raise MissingOracleError from error
    return mujoco  # type: ignore[no-any-return]
