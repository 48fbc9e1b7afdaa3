"""The linearised closed loop as a system of python-control, for those who want its step, Bode or margins."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from firmtouch.regulation.closed_loop import ClosedLoop

if TYPE_CHECKING:
    import control


def state_space(loop: ClosedLoop) -> control.StateSpace:
    """Give the map from a disturbance force d (n) to (dq, dlambda) (n + m) around the operating point.

    The state is (x2, x2'), 2(n - m) entries, of Eqs. (38) and (37) with the disturbance of (21):

        M22 x2'' + C22 x2' + K22 x2 = V2^T d,   dq = V2 x2
        S U^T (I + G_f) dlambda = M12 x2'' + C12 x2' + K12 x2 - V1^T d
    """
    import control

    op, split = loop.operating_point, loop.split
    M, C, K = (split.blocks(X) for X in (op.M, loop.gains.C, loop.K))
    free = op.n - op.m
    acceleration = np.linalg.solve(M.X22, np.hstack([-K.X22, -C.X22]))
    push = np.linalg.solve(M.X22, split.V2.T)
    to_lambda = np.linalg.inv(np.diag(split.S) @ split.U.T @ (np.eye(op.m) + loop.gains.G_f))
    A = np.vstack([np.hstack([np.zeros((free, free)), np.eye(free)]), acceleration])
    B = np.vstack([np.zeros((free, op.n)), push])
    outputs = np.vstack(
        [
            np.hstack([split.V2, np.zeros((op.n, free))]),
            to_lambda @ (np.hstack([K.X12, C.X12]) + M.X12 @ acceleration),
        ]
    )
    through = np.vstack([np.zeros((op.n, op.n)), to_lambda @ (M.X12 @ push - split.V1.T)])
    spec = op.plant.spec
    return control.ss(
        A,
        B,
        outputs,
        through,
        inputs=[f"d_{name}" for name in spec.coordinates],
        outputs=[f"dq_{name}" for name in spec.coordinates] + [f"dlambda_{name}" for name in spec.constraints],
        name="closed_loop",
    )
