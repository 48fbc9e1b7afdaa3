"""The exact equilibrium: it balances every force, and where there is none it says so."""

import numpy as np
import pytest

from firmtouch.regulation import NoEquilibriumError, closed_loop_equilibrium, control_law
from firmtouch.regulation.controllers import Controller, closed_loop_acceleration


def test_at_the_equilibrium_nothing_accelerates(loop, rng):
    op = loop.operating_point
    d = rng.normal(size=op.n) * 0.3
    rest = closed_loop_equilibrium(loop, d=d)
    law = control_law(op, loop.gains, Controller.AFFINE_WITH_FORCE)
    acceleration, lambda_ = closed_loop_acceleration(op, law, rest.q, np.zeros(op.n), d=d)
    assert np.abs(op.plant.Phi(rest.q)).max() < 1e-12  # what Newton's method reaches at metre size
    # Forces of 1e2 N cancel to rounding, over inertias down to 1e-2 kg m^2: 1e2 * 1e-16 * 1e2, and the last step's 1e-10.
    assert np.abs(acceleration).max() < 1e-8
    assert lambda_ == pytest.approx(rest.lambda_, abs=1e-8)


def test_without_errors_it_is_the_operating_point(loop):
    op, rest = loop.operating_point, closed_loop_equilibrium(loop)
    assert rest.q == pytest.approx(op.q_d, abs=1e-10)
    assert rest.lambda_ == pytest.approx(op.lambda_d, abs=1e-8)


def test_an_offset_out_of_reach_has_no_equilibrium(arm_on_circle, loop_of):
    with pytest.raises(NoEquilibriumError, match="no equilibrium near q_d") as error:
        closed_loop_equilibrium(loop_of(arm_on_circle), Delta=[5.0])  # the arm is 1.2 m long
    assert error.value.step > 1e-10
