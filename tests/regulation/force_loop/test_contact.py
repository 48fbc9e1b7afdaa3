"""[T9]: poles of a contact that gives way: known answers, the argument principle, an integration, and the rigid limit."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from firmtouch.regulation import Gains, close_loop
from firmtouch.regulation.force_loop import (
    DelayTooLongError,
    ForcePath,
    contact_stiffness_sweep,
    critical_feedback,
    poles_in_contact,
    stability_bound,
)
from firmtouch.regulation.force_loop.contact import contact_of
from firmtouch.regulation.force_loop.delay_line import delay_line

MS = 1e-3
PATHS = {
    "ideal": None,
    "lag": ForcePath(lag=2 * MS),
    "delay": ForcePath(delay=1 * MS),
    "lag and delay": ForcePath(delay=1 * MS, lag=2 * MS),
    "sampled": ForcePath(sample=1 * MS, lag=2 * MS),
    "sampled late": ForcePath(sample=1 * MS, delay=2 * MS, lag=2 * MS),
}
CONTINUOUS = {name: path for name, path in PATHS.items() if path is not None and not path.sample}


@pytest.fixture(scope="module")
def random_loop(random_point, random_positive):
    """A closed loop of no particular mechanism, with G_f given."""

    def make(n, m, seed, G_f, damping=1.0):
        op = random_point(n, m, seed, curvature=0.1)
        W, C = random_positive(n, seed + 1, 20, 60), damping * random_positive(n, seed + 2, 3, 9)
        return close_loop(op, Gains(W=W, C=C, G_f=np.asarray(G_f, dtype=float), bias=np.zeros(n)))

    return make


def mass_on_a_wall(G_f, *, damping=4.0):
    """Two masses of 1 kg and 2 kg, not coupled: x1 presses on the wall, x2 is free."""
    M, C, K = np.diag([1.0, 2.0]), np.diag([damping, 8.0]), np.diag([9.0, 26.0])
    spec = SimpleNamespace(coordinates=range(2), constraints=range(1))
    op = SimpleNamespace(n=2, m=1, M=M, J=np.array([[1.0, 0.0]]), N0=np.zeros((2, 2)), plant=SimpleNamespace(spec=spec))
    return close_loop(op, Gains(W=K, C=C, G_f=np.array([[G_f]]), bias=np.zeros(2)))


def characteristic(loop, path, s, stiffness):
    """det of [T9] in the plant's own coordinates, relative to its largest singular value."""
    op, G_f = loop.operating_point, loop.gains.G_f
    L = np.exp(-s * path.delay) / (1 + s * path.lag) if path else 1.0
    D = np.diag(stiffness)
    return op.M * s**2 + loop.gains.C * s + loop.K + op.J.T @ (np.eye(op.m) + G_f * L) @ D @ op.J


def test_an_undelayed_contact_is_a_spring_that_force_feedback_makes_stiffer():
    k, g = 1e4, 3.0
    found = poles_in_contact(mass_on_a_wall(g), None, [k])
    w = math.sqrt(9 + (1 + g) * k - 4)
    expected = [-2 + 1j * w, -2 - 1j * w, -2 + 3j, -2 - 3j]
    for each in expected:
        assert min(abs(each - s) for s in found.poles) < 1e-10 * abs(each)  # rounding
    assert sorted(found.tangent, key=lambda s: s.imag) == pytest.approx([-2 - 3j, -2 + 3j], rel=1e-12)
    assert found.stable
    assert found.kept


def test_a_low_pass_is_borne_as_long_as_the_contacts_damping_is_greater_than_g_over_the_lag():
    """(s^2 + c s + k)(1 + s lag) + g k_e by Hurwitz: (1 + c lag)(c + lag k) > lag (k + g k_e), k = K + k_e."""
    c, lag, k_e, K = 4.0, 2 * MS, 1e4, 9.0
    k = K + k_e
    critical = ((1 + c * lag) * (c + lag * k) / lag - k) / k_e
    found = critical_feedback(mass_on_a_wall(0.0, damping=c), ForcePath(lag=lag), [k_e])
    assert found == pytest.approx(critical, rel=1e-5)  # 20 halvings of a tenth of a decade
    stiff = critical_feedback(mass_on_a_wall(0.0, damping=c), ForcePath(lag=lag), [1e9])
    assert stiff == pytest.approx(c * lag, rel=0.01)  # what remains of it as k_e grows; c lag itself is 0.8 % of it


@pytest.mark.parametrize("path", [PATHS["delay"], PATHS["lag and delay"]], ids=["delay", "lag and delay"])
@pytest.mark.parametrize("k_e", [1e3, 1e5])
def test_the_critical_feedback_of_a_delayed_contact_puts_a_pole_on_the_axis_by_nyquist(path, k_e):
    """1 + g L(jw) H(jw) = 0 with H = k_e / (s^2 + c s + K + k_e): the least real positive -1/(L H)."""
    w = np.linspace(1, 3e3, 500_001)
    H = k_e / (-(w**2) + 4j * w + 9 + k_e)
    inverse = -1 / (path.response(w) * H)
    crossings = np.flatnonzero(np.diff(np.sign(inverse.imag)) != 0)
    expected = min(each for each in inverse.real[crossings] if each > 0)
    # The grid stands 6e-3 rad/s apart; near the contact's own frequency the curve turns by a third in c/2 = 2 rad/s.
    assert critical_feedback(mass_on_a_wall(0.0), path, [k_e]) == pytest.approx(expected, rel=2e-3)


@settings(max_examples=12)
@given(st.sampled_from([(2, 1), (3, 1), (4, 2), (6, 3)]), st.integers(0, 10**6), st.sampled_from(list(CONTINUOUS)))
def test_every_pole_is_a_root_of_the_characteristic_equation(random_loop, size, seed, name):
    (n, m), path = size, CONTINUOUS[name]
    loop = random_loop(n, m, seed, 0.8 * np.eye(m))
    stiffness = np.geomspace(1e3, 1e5, m)
    found = poles_in_contact(loop, path, stiffness)
    assert len(found.poles) >= 2 * n
    for s in found.poles:
        T = characteristic(loop, path, s, stiffness)
        singular = np.linalg.svd(T, compute_uv=False)
        # Rounding of the largest entries, 1e6 of a det's factor, times the conditioning of M and J.
        assert singular[-1] / singular[0] < 1e-9, s


def winding(loop, path, stiffness, reach):
    """Count roots to the right of the axis: turns of det[T9] / (its value without feedback) along jw and back."""
    op, G_f, D = loop.operating_point, loop.gains.G_f, np.diag(stiffness)
    own = poles_in_contact(loop, None, stiffness)
    near = [s.imag + s.real * np.linspace(-8, 8, 801) for s in own.poles]
    w = np.unique(np.abs(np.concatenate([np.linspace(0, reach, 20_001), *near])))
    s = 1j * w[:, None, None]
    held = op.M * s**2 + loop.gains.C * s + loop.K + op.J.T @ D @ op.J
    L = path.response(w)[:, None, None]
    ratio = np.linalg.det(np.eye(op.m) + L * G_f @ D @ op.J @ np.linalg.solve(held, op.J.T[None]))
    turn = np.sum(np.angle(ratio[1:] / ratio[:-1]))
    return -turn / math.pi  # both halves of the axis, in turns; the arc at infinity adds none, since H falls as 1/w^2


@settings(max_examples=8)
@given(
    st.sampled_from([(2, 1), (3, 1), (4, 2), (6, 3)]),
    st.integers(0, 10**6),
    st.sampled_from(list(CONTINUOUS)),
    st.sampled_from([1e3, 3e4, 1e6]),
)
def test_as_many_poles_are_unstable_as_the_argument_principle_counts(random_loop, size, seed, name, k_e):
    (n, m), path = size, CONTINUOUS[name]
    loop = random_loop(n, m, seed, np.diag(np.linspace(0.3, 1.5, m)), damping=20.0)
    stiffness = np.full(m, k_e)
    found = poles_in_contact(loop, path, stiffness)
    reach = 30 * contact_of(loop).fastest(stiffness)
    turns = winding(loop, path, stiffness, reach)
    assert sum(s.real >= 0 for s in found.poles) == pytest.approx(turns, abs=0.05)  # what is left beyond the reach


def test_the_delay_line_differentiates_polynomials_and_exponentials():
    D, delay, order = delay_line(2.0, 18), 2.0, 18
    x = delay / 2 * (np.cos(np.pi * np.arange(order + 1) / order) - 1)
    np.testing.assert_allclose(D @ x**5, 5 * x**4, atol=1e-11)  # order^2 roundings of values up to 32
    np.testing.assert_allclose(D @ np.exp(3j * x), 3j * np.exp(3j * x), atol=1e-11)


def one_sample(contact, path, k, state):
    """Integrate the loop from one sample to the next; the state is (z, z', low-pass, inputs on their way)."""
    n, m = len(contact.K), len(k)
    x, waiting = state[: 2 * n + m], state[2 * n + m :].reshape(-1, m)
    waiting = np.vstack([contact.G_f @ x[2 * n :], waiting])
    measured = -k[:, None] * contact.J

    def rate(_, x):
        z, v, y = x[:n], x[n : 2 * n], x[2 * n :]
        acceleration = -contact.K @ z - contact.C @ v + contact.J.T @ (measured @ z + waiting[-1])
        return np.concatenate([v, acceleration, (measured @ z - y) / path.lag])

    after = solve_ivp(rate, (0, path.sample), x, method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    return np.concatenate([after, waiting[:-1].ravel()])


@pytest.mark.parametrize("name", ["sampled", "sampled late"])
def test_a_sampled_contact_integrated_over_one_sample_has_the_same_poles(name):
    loop, path, k = mass_on_a_wall(0.8), PATHS[name], np.array([2e4])
    found = poles_in_contact(loop, path, k).poles
    size = 2 * 2 + 1 + path.steps
    step = np.array([one_sample(contact_of(loop), path, k, each) for each in np.eye(size)]).T
    expected = np.linalg.eigvals(step)
    assert len(found) == size - (expected == 0).sum()
    assert found[0].real > 5
    for s in found:
        # The integrations are good to 1e-11 of forces of 2e4, and Newton per kilogram.
        assert min(abs(np.exp(s * path.sample) - z) for z in expected) < 1e-7


@pytest.mark.parametrize("T", [1e-4, 5e-5])
def test_quick_sampling_tends_to_the_continuous_loop_with_half_a_sample_of_delay(T):
    """A held input is late by T/2; what is left is of second order in T."""
    loop, k = mass_on_a_wall(0.8), [2e4]
    sampled = poles_in_contact(loop, ForcePath(sample=T, lag=2 * MS), k).poles[0]
    late = poles_in_contact(loop, ForcePath(delay=T / 2, lag=2 * MS), k).poles[0]
    w = abs(sampled)
    assert abs(sampled - late) < w * (w * T) ** 2


@pytest.mark.parametrize("name", [name for name in PATHS if "sampled" not in name])
def test_the_slow_poles_tend_to_those_of_38_as_one_over_the_stiffness(arm_in_corner, loop_of, name, observed_order):
    loop = loop_of(arm_in_corner)
    loop = close_loop(
        loop.operating_point, Gains(W=loop.gains.W * 1.3, C=loop.gains.C + 2, G_f=loop.gains.G_f, bias=loop.gains.bias)
    )
    path = PATHS[name]

    def error(h):
        found = poles_in_contact(loop, path, np.full(2, 1 / h))
        return max(abs(a - b) for a, b in zip(found.tangent, loop.poles.reduced, strict=True))

    assert 0 < error(1e-6) < 0.1
    assert observed_order(error, 1e-6) == pytest.approx(1, abs=0.02)  # the next order is 1e-3 of the first here


@pytest.mark.parametrize(
    ("name", "g"), [("lag", 0.8), ("delay", 0.8), ("delay", 1.3), ("lag and delay", 3.0), ("lag and delay", 4.5)]
)
def test_the_other_finite_poles_tend_to_those_of_the_force_loop_of_t8(name, g):
    """1 + g L(s) = 0 near the axis; the contact's own pair leaves for infinity and is not among them."""
    path = PATHS[name]
    if name == "lag":
        roots = [-(1 + g) / path.lag]
    elif name == "delay":
        roots = [(math.log(g) + 1j * math.pi) / path.delay]
    else:  # Newton's method from the crossing frequency
        s = 1j * 1836.6
        for _ in range(50):
            f = 1 + s * path.lag + g * np.exp(-s * path.delay)
            s -= f / (path.lag - path.delay * g * np.exp(-s * path.delay))
        roots = [s]
    assert (g < stability_bound(path)) == (np.real(roots[0]) < 0)

    def error(k):
        poles = poles_in_contact(mass_on_a_wall(g), path, [k]).poles
        return min(abs(each - roots[0]) for each in poles)

    errors = [error(k) for k in (4e8, 8e8)]
    assert errors[1] < 0.05 * abs(roots[0])
    assert errors[0] / errors[1] == pytest.approx(2, abs=0.15)  # first order in 1/k_e, its second at (s^2/k_e)^2


def test_a_stiff_contact_with_a_late_force_signal_swings_up_although_the_rigid_one_is_stable():
    """With a low-pass alone Re s of the contact's pair tends to g / (2 lag) - c / 2."""
    g, lag = 0.8, 2 * MS
    sweep = contact_stiffness_sweep(mass_on_a_wall(g), ForcePath(lag=lag), stiffest=1e9)
    assert stability_bound(ForcePath(lag=lag)) == np.inf
    (span,) = sweep.unstable
    # Hurwitz, with c = 4 and k = 9 + k_e: (1 + c lag)(c + lag k) = lag (k + g k_e)
    assert span.low == pytest.approx(((1 + 4 * lag) * (4 + lag * 9) / lag - 9) / (g - 4 * lag), rel=1e-5)
    assert span.high == np.inf
    assert sweep.points[-1].poles[0].real == pytest.approx(g / (2 * lag) - 2, rel=0.02)  # as 1 / (w lag)^2


class TestTheSweep:
    def test_an_ideal_path_is_stable_all_along_and_its_ends_are_told(self, loop):
        sweep = contact_stiffness_sweep(loop, None, loop.operating_point.plant.spec.design)
        assert sweep.unstable == ()
        assert sweep.stiffness[[0, -1]] == pytest.approx([1e3, 1e7], rel=1e-12)
        assert all(len(each.poles) == 2 * loop.operating_point.n for each in sweep.points)
        assert all(len(each.tangent) == len(loop.poles.reduced) for each in sweep.points)

    def test_each_end_of_an_unstable_span_has_a_pole_on_the_axis(self):
        loop, path = mass_on_a_wall(0.8), PATHS["sampled late"]
        sweep = contact_stiffness_sweep(loop, path)
        edges = [each for span in sweep.unstable for each in (span.low, span.high) if 0 < each < np.inf]
        assert edges
        for k in edges:
            real = poles_in_contact(loop, path, [k]).poles[0].real
            assert abs(real) < 1e-3  # the edge is good to 1e-6 of k, and Re s changes by 100 1/s a decade

    def test_the_poles_are_kept_from_where_the_slowest_is_a_tenth_off(self, random_loop):
        loop = random_loop(3, 1, 1, [[0.5]])
        sweep = contact_stiffness_sweep(loop, None, softest=1.0)
        assert 1 < sweep.kept_from < 1e7
        for factor, kept in ((1.001, True), (0.999, False)):
            at = poles_in_contact(loop, None, [factor * sweep.kept_from])
            assert at.kept == kept
        slowest = max(range(len(at.tangent)), key=lambda i: at.tangent[i].real)
        apart = abs(at.tangent[slowest] - loop.poles.reduced[slowest]) / abs(loop.poles.reduced[slowest])
        assert apart == pytest.approx(0.10, abs=1e-3)

    def test_a_region_is_left_where_an_edge_is_missed(self, random_loop):
        loop = random_loop(3, 1, 1, [[0.5]])
        decay = 0.95 * min(-s.real for s in loop.poles.reduced)
        region = SimpleNamespace(decay=decay, damping=None, bandwidth=None)
        sweep = contact_stiffness_sweep(loop, None, SimpleNamespace(method="region", region=region), softest=1.0)
        assert sweep.by_region
        at = poles_in_contact(loop, None, [sweep.kept_from])
        assert max(s.real for s in at.tangent) == pytest.approx(-0.99 * decay, rel=1e-4)  # 1 % of leeway

    def test_it_ends_where_the_delay_is_too_long_and_one_point_beyond_is_refused(self):
        path = ForcePath(delay=0.1)
        sweep = contact_stiffness_sweep(mass_on_a_wall(0.5), path)
        assert sweep.stiffness[-1] < 1e7
        with pytest.raises(DelayTooLongError, match=r"a delay of 0.1 s .* 1e\+09 N/m needs [0-9]+ states"):
            poles_in_contact(mass_on_a_wall(0.5), path, [1e9])


def test_an_unstable_loop_needs_no_feedback_to_be_so(random_loop):
    loop = random_loop(3, 1, 3, [[0.5]])
    unstable = close_loop(
        loop.operating_point, Gains(W=-loop.gains.W, C=loop.gains.C, G_f=loop.gains.G_f, bias=loop.gains.bias)
    )
    assert critical_feedback(unstable, PATHS["lag and delay"], [1e4]) == 0
    assert critical_feedback(loop, None, [1e4]) == np.inf
