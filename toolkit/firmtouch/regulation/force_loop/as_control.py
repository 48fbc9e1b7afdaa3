"""The force path as a system of python-control, for those who want its Bode or Nyquist picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

from firmtouch.regulation.force_loop.path import ForcePath

if TYPE_CHECKING:
    import control


def as_control_system(path: ForcePath, *, order: int = 6) -> control.TransferFunction:
    """Give L: sampled, L(z) exactly; continuous, L(s) with the delay by a Padé approximant of this order.

    `g * as_control_system(path)` is the open loop of an eigenvalue g of G_f, for `control.nyquist_plot`,
    `control.stability_margins` and the like.
    """
    import control

    if path.sample:
        # one minus a, over z to the steps, times z minus a
        denominator = [1.0, path.decay - 1, *[0.0] * path.steps]
        return control.tf([path.decay], denominator, path.sample, name="force_path")
    system = control.tf([1.0], [path.lag, 1.0] if path.lag else [1.0])
    if path.delay:
        system = control.tf(*control.pade(path.delay, order)) * system
    return control.tf(system, name="force_path")
