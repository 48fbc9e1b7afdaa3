"""Interval Newton arguments about p_x on a cell."""

from __future__ import annotations

import contextlib

import numpy as np
from flint import arb, arb_mat

from firmtouch.certificate.attraction.piece import Piece
from firmtouch.certificate.matrices import BallMatrix, exact, identity, middle


def is_regular(H: BallMatrix) -> bool:
    """Prove that no matrix in H is singular: |I - R H| v < v for some v > 0 makes the spectral radius less than 1."""
    try:
        R = np.linalg.inv(middle(H))
    except np.linalg.LinAlgError:
        return False
    if not np.all(np.isfinite(R)):
        return False
    rest = [[abs(each).upper() for each in row] for row in (identity(H.nrows()) - exact(R) * H).tolist()]
    sizes = np.array([[float(each) for each in row] for row in rest])
    if not np.all(np.isfinite(sizes)):
        return False
    try:
        v = np.linalg.solve(np.eye(len(sizes)) - sizes, np.ones(len(sizes)))
    except np.linalg.LinAlgError:
        return False
    weights = [arb(each) for each in v.tolist()]
    return bool(np.all(v > 0)) and all(
        sum((a * w for a, w in zip(row, weights, strict=True)), arb(0)) < weights[i] for i, row in enumerate(rest)
    )


def has_zero(piece: Piece) -> bool:
    """Prove by Krawczyk's operator -R F + (I - R H) xi that p_x vanishes inside a cell."""
    w = [arb(each) for each in piece.place.cell.widths]
    try:
        R = exact(np.linalg.inv(middle(piece.hessian.C)))
    except np.linalg.LinAlgError:
        return False
    xi = arb_mat(len(w), 1, [arb(0, each) for each in w])
    image = (identity(len(w)) - R * piece.mean_hessian()) * xi - R * piece.gradient
    return all(abs(each).upper() < half for each, half in zip(image.entries(), w, strict=True))


def has_no_zero(piece: Piece) -> bool:
    """Prove p_x = F + H xi not to vanish on a cell: |y^T F| > sum_j |y^T H|_j w_j for some y.

    Tried are the rows of H's approximate inverse, which make y^T H small, and the slope itself.
    """
    F, H = piece.gradient, piece.mean_hessian()
    rows = [middle(F).T]
    with contextlib.suppress(np.linalg.LinAlgError):
        rows.append(np.linalg.inv(middle(H)))
    Y = np.vstack(rows)
    if not np.all(np.isfinite(Y)):
        return False
    slopes, turned = (exact(Y) * F).entries(), (exact(Y) * H).tolist()
    for slope, row in zip(slopes, turned, strict=True):
        spread = sum((abs(each).upper() * w for each, w in zip(row, piece.place.cell.widths, strict=True)), arb(0))
        if abs(slope).lower() > spread:
            return True
    return False
