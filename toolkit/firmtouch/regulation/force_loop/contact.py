"""Contact that gives way [T9]: lambda = -k_e phi(q), with the force path in the loop, and the poles of it all.

    M s^2 + C s + K + J^T (I + G_f L(s)) D J = 0,   D = diag(k_e), one stiffness for each constraint

It is worked on in coordinates z with M = I whose first m directions are those that the constraints hold: the large
entries of J^T D J then stand in one block, and the slow poles keep their digits.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from firmtouch.errors import InputError
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation.closed_loop import ClosedLoop
from firmtouch.regulation.force_loop.delay_line import delay_line, order_for, refined
from firmtouch.regulation.force_loop.path import ForcePath

Complex = NDArray[np.complex128]

MOST_STATES: Final = 120
"""Of the delay lines together; what would need more is not computed."""
GONE: Final = 1e-12
"""Eigenvalues z this small are states of the delay that fade within a sample: no poles."""


@dataclass(frozen=True, slots=True)
class Contact:
    """The loop in coordinates with M = I: C, K (n x n), J (m x n) with zeros right of its first m columns, and G_f."""

    C: Array
    K: Array
    J: Array
    G_f: Array

    def with_feedback(self, G_f: Array) -> Contact:
        """Give the same loop with another G_f."""
        return Contact(self.C, self.K, self.J, frozen(G_f))

    def fastest(self, stiffness: Array) -> float:
        """Bound |s| of all roots that are not stable, for a stiffness of each constraint (m).

        There |L| <= 1, so |s|^2 <= |C| |s| + |K| + |J|^2 |D| (1 + |G_f|), in 2-norms.
        """
        held = float(np.linalg.norm(self.J, 2)) ** 2 * float(np.max(stiffness))
        k = float(np.linalg.norm(self.K, 2)) + held * (1 + float(np.linalg.norm(self.G_f, 2)))
        c = float(np.linalg.norm(self.C, 2))
        return (c + float(np.sqrt(c * c + 4 * k))) / 2


def contact_of(loop: ClosedLoop) -> Contact:
    """Put a closed loop into those coordinates."""
    op, m = loop.operating_point, loop.operating_point.m
    root = np.linalg.inv(np.linalg.cholesky(op.M)).T  # q = root Q z
    Q, R = np.linalg.qr(root.T @ op.J.T, mode="complete")
    T = root @ Q
    J = np.zeros((m, op.n))
    J[:, :m] = R[:m].T
    C, K = (frozen(T.T @ X @ T) for X in (loop.gains.C, loop.K))
    return Contact(C, K, frozen(J), loop.gains.G_f)


class DelayTooLongError(InputError):
    """The delay is too long beside the contact's own motion for its poles to be computed."""


def contact_poles(contact: Contact, path: ForcePath, stiffness: Array) -> Complex:
    """Give the poles for a stiffness of each constraint (m), the slowest first.

    Without delay and sampling these are all of them, eigenvalues of a matrix. With a delay there are infinitely many:
    eigenvalues with the delay as a line of states, then Newton's method on the characteristic equation itself; given
    are those that the line resolves, and all that are not stable are among them. Sampled: eigenvalues z over one
    sample, exactly, told as s = log(z) / sample; faster motion than half the sampling rate shows a lower frequency.

    Raises
    ------
    DelayTooLongError
        If the line would be longer than is computed.
    """
    if path.sample:
        poles = _sampled(contact, path, stiffness)
    else:
        order = order_for(path.delay * contact.fastest(stiffness))
        if order * len(stiffness) > MOST_STATES:
            raise DelayTooLongError(
                f"a delay of {path.delay:g} s beside a contact of {np.max(stiffness):.3g} N/m needs {order} states for "
                f"each constraint; {MOST_STATES} in all are computed"
            )
        poles = _continuous(contact, path, stiffness, order)
        if path.delay:
            poles = poles[np.abs(poles) * path.delay <= order]
            poles = refined(contact.C, _held(contact, stiffness), _fed_back(contact, stiffness), path, poles)
    return poles[np.lexsort((poles.imag, np.abs(poles.imag), -poles.real))]


def _held(contact: Contact, stiffness: Array) -> Array:
    """K + J^T D J: what remains without force feedback."""
    return np.asarray(contact.K + contact.J.T @ (stiffness[:, None] * contact.J))


def _fed_back(contact: Contact, stiffness: Array) -> Array:
    """J^T G_f D J: what the force feedback adds, to be multiplied by L(s)."""
    return np.asarray(contact.J.T @ contact.G_f @ (stiffness[:, None] * contact.J))


def _continuous(contact: Contact, path: ForcePath, stiffness: Array, order: int) -> Complex:
    """Eigenvalues of (z, z' / w, low-pass, delay line), time counted in 1/w of the fastest motion."""
    n, m = len(contact.K), len(stiffness)
    measured = -stiffness[:, None] * contact.J
    push = contact.J.T @ contact.G_f
    if path.ideal:
        K = _held(contact, stiffness) + _fed_back(contact, stiffness)
        return _eigenvalues(np.block([[np.zeros((n, n)), np.eye(n)], [-K, -contact.C]]), n)
    lag, line = m * bool(path.lag), m * order * bool(path.delay)
    A = np.zeros((2 * n + lag + line, 2 * n + lag + line))
    A[:n, n : 2 * n] = np.eye(n)
    A[n : 2 * n, :n], A[n : 2 * n, n : 2 * n] = -_held(contact, stiffness), -contact.C
    source, columns = (np.eye(m), slice(2 * n, 2 * n + lag)) if lag else (measured, slice(0, n))
    if lag:
        A[2 * n : 2 * n + lag, :n] = measured / path.lag
        A[2 * n : 2 * n + lag, 2 * n : 2 * n + lag] = -np.eye(m) / path.lag
    if line:
        D = delay_line(path.delay, order)
        A[2 * n + lag :, columns] = np.kron(D[1:, :1], source)
        A[2 * n + lag :, 2 * n + lag :] = np.kron(D[1:, 1:], np.eye(m))
        source, columns = np.eye(m), slice(len(A) - m, len(A))
    A[n : 2 * n, columns] += push @ source
    return _eigenvalues(A, n)


def _eigenvalues(A: Array, n: int) -> Complex:
    """Count velocities in the unit of the stiffest motion, so that the entries of A are not far apart."""
    w = float(np.sqrt(np.linalg.norm(A[n : 2 * n, :n], 2))) or 1.0
    scale = np.ones(len(A))
    scale[n : 2 * n] = w
    return np.asarray(np.linalg.eigvals(A * scale / scale[:, None]), dtype=np.complex128)


def _sampled(contact: Contact, path: ForcePath, stiffness: Array) -> Complex:
    """Eigenvalues over one sample of (z, z' / w, low-pass) with a held input, and of the measurements on their way."""
    from scipy.linalg import expm

    n, m, lag = len(contact.K), len(stiffness), len(stiffness) * bool(path.lag)
    size, T = 2 * n + lag, path.sample
    measured = -stiffness[:, None] * contact.J
    K = _held(contact, stiffness)
    w = float(np.sqrt(np.linalg.norm(K, 2))) or 1.0
    A = np.zeros((size + m, size + m))
    A[:n, n : 2 * n] = w * np.eye(n)
    A[n : 2 * n, :n], A[n : 2 * n, n : 2 * n] = -K / w, -contact.C
    A[n : 2 * n, size:] = contact.J.T @ contact.G_f / w
    output = np.zeros((m, size))
    output[:, :n] = measured
    if lag:
        A[2 * n : size, :n], A[2 * n : size, 2 * n : size] = measured / path.lag, -np.eye(m) / path.lag
        output = np.hstack([np.zeros((m, 2 * n)), np.eye(m)])
    over = expm(A * T)[:size]
    steps = path.steps
    whole = np.zeros((size + steps * m, size + steps * m))
    whole[:size, :size] = over[:, :size]
    if steps:
        whole[:size, size + (steps - 1) * m :] = over[:, size:]
        whole[size : size + m, :size] = output
        whole[size + m :, size : size + (steps - 1) * m] = np.eye((steps - 1) * m)
    else:
        whole[:size, :size] += over[:, size:] @ output
    z = np.linalg.eigvals(whole).astype(np.complex128)
    return np.asarray(np.log(z[np.abs(z) > GONE]) / T)
