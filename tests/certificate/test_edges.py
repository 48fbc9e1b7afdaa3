"""Edges of the region: a polynomial's roots are inside if and only if the moved one's are in the left half plane."""

import cmath
import math
from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from flint import arb
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from tests.certificate.exactly import DIGITS

from firmtouch.certificate.decision import Verdict, decide
from firmtouch.certificate.edges import Edge, EdgeKind, is_hurwitz
from firmtouch.certificate.matrices import middle

DECAY, DAMPING, BANDWIDTH = EdgeKind

whole = st.integers(-12, 12)
root = st.one_of(st.tuples(whole, st.just(0)), st.tuples(whole, st.integers(1, 12)))  # in quarters; with its conjugate
polynomials = st.lists(root, min_size=1, max_size=4)


def product(*factors):
    found = [1]
    for each in factors:
        longer = [0] * (len(found) + len(each) - 1)
        for i, a in enumerate(found):
            for j, b in enumerate(each):
                longer[i + j] += a * b
        found = longer
    return found


def with_roots(roots):
    """Multiply out, exactly: roots (a + b j)/4 with their conjugates, the coefficients from the constant one on."""
    factors = [[-a / 4, 1] if b == 0 else [(a * a + b * b) / 16, -a / 2, 1] for a, b in roots]
    return [arb(each) for each in product(*factors)]


def inside(roots, edge):
    return all(_inside(complex(a, b) / 4, edge) for a, b in roots)


def _inside(s, edge):
    match edge.kind:
        case EdgeKind.DECAY:
            return s.real < -edge.value
        case EdgeKind.DAMPING:
            return s != 0 and -s.real > edge.value * abs(s)
        case EdgeKind.BANDWIDTH:
            return abs(s) < edge.value


def distance(roots, edge):
    """How far the nearest root is from the edge."""
    match edge.kind:
        case EdgeKind.DECAY:
            return min(abs(a / 4 + edge.value) for a, _ in roots)
        case EdgeKind.DAMPING:
            return min(abs(a / 4 + edge.value * math.hypot(a, b) / 4) for a, b in roots)
        case EdgeKind.BANDWIDTH:
            return min(abs(math.hypot(a, b) / 4 - edge.value) for a, b in roots)


def verdict(p, edge, unit=1.0):
    return decide(lambda: is_hurwitz(edge.moved(p, unit)))[0]


edges = st.one_of(
    st.builds(Edge, st.just(DECAY), st.floats(-2, 2)),
    st.builds(Edge, st.just(DAMPING), st.floats(0, 0.999)),
    st.builds(Edge, st.just(BANDWIDTH), st.floats(0.1, 4)),
)


@settings(max_examples=150)
@given(roots=polynomials, edge=edges, unit=st.sampled_from([1.0, 0.5, 4.0]))
def test_routh_tells_whether_all_roots_are_inside(roots, edge, unit):
    """Roots counted in `unit` 1/s: those of s = unit z."""
    assume(distance(roots, edge) > 1e-9)
    counted = edge if edge.kind is DAMPING else Edge(edge.kind, edge.value * unit)
    found = verdict(with_roots(roots), counted, unit)
    if inside(roots, edge):
        assert found is Verdict.PROVEN
    else:
        # A root exactly at -w goes to infinity, and leaves the question open.
        assert found is not Verdict.PROVEN


@given(roots=polynomials, times=st.integers(2, 3))
def test_repeated_roots_count_as_often_as_they_stand(roots, times):
    edge = Edge(DECAY, 0.1)
    found = verdict(with_roots(roots * times), edge)
    assert (found is Verdict.PROVEN) == inside(roots, edge)


@pytest.mark.parametrize(
    ("roots", "edge"),
    [
        ([(-4, 3)], Edge(DECAY, 1.0)),
        ([(-4, 0)], Edge(DECAY, 1.0)),
        ([(0, 5), (-3, 0)], Edge(DECAY, 0.0)),
        ([(0, 0), (-3, 0)], Edge(DECAY, 0.0)),
        ([(0, 5), (0, 5), (-3, 0)], Edge(DECAY, 0.0)),
        ([(-3, 4)], Edge(BANDWIDTH, 1.25)),  # |s| = 5/4 exactly
        ([(-5, 0)], Edge(BANDWIDTH, 1.25)),  # -w, which goes to infinity
        ([(-5, 0), (-5, 0), (-1, 2)], Edge(BANDWIDTH, 1.25)),
        ([(5, 0)], Edge(BANDWIDTH, 1.25)),
        ([(0, 5), (-1, 0)], Edge(BANDWIDTH, 1.25)),
        ([(0, 4), (-1, 0)], Edge(DAMPING, 0.0)),
        ([(0, 0), (-1, 0)], Edge(DAMPING, 0.5)),
        ([(-4, 0)], Edge(DAMPING, 1.0)),
    ],
)
def test_a_root_exactly_on_the_edge_is_never_proven(roots, edge):
    assert distance(roots, edge) == 0 or edge.value == 1
    assert verdict(with_roots(roots), edge) is not Verdict.PROVEN


def test_a_root_on_a_sector_of_3_4_5_is_never_proven():
    """zeta = 0.6 is no binary64 number: the nearest one tells on which side the root is."""
    for value in (0.6, math.nextafter(0.6, 1), math.nextafter(0.6, 0)):
        is_inside = Fraction(value) < Fraction(3, 5)
        found = verdict(with_roots([(-3, 4)]), Edge(DAMPING, value))
        assert found is (Verdict.PROVEN if is_inside else Verdict.REFUTED)


@settings(max_examples=40)
@given(seed=st.integers(0, 10**6), degree=st.integers(1, 7), part=st.sampled_from([1e-12, 1e-9, 1e-4]))
@pytest.mark.parametrize("kind", EdgeKind)
def test_a_hair_beside_the_worst_root_decides(kind, seed, degree, part):
    """Random polynomials: the edge is a part of itself beside what their roots reach, by mpmath."""
    rng = np.random.default_rng(seed)
    p = rng.normal(size=degree + 1)
    if kind is DAMPING:  # which a random polynomial has none of
        factors = [[r * r, 2 * zeta * r, 1] for zeta, r in rng.uniform(0.1, 0.9, size=(degree // 2 + 1, 2))]
        p = np.array(product(*factors))
    with mp.workdps(DIGITS):
        found = mp.polyroots([mp.mpf(x) for x in p[::-1].tolist()], maxsteps=500, extraprec=400)
        match kind:
            case EdgeKind.DECAY:
                reached = min(-s.real for s in found)
            case EdgeKind.DAMPING:
                reached = min(-s.real / abs(s) for s in found)
            case EdgeKind.BANDWIDTH:
                reached = max(abs(s) for s in found)
        assert kind is not DAMPING or 0 < reached < 0.999
        easier, harder = (float(reached + sign * part * abs(reached)) for sign in (-1, 1))
    if kind is BANDWIDTH:
        easier, harder = harder, easier
    balls = [arb(x) for x in p.tolist()]
    assert verdict(balls, Edge(kind, easier)) is Verdict.PROVEN
    assert verdict(balls, Edge(kind, harder)) is Verdict.REFUTED


@given(roots=polynomials, edge=edges, seed=st.integers(0, 100))
def test_the_moved_polynomial_has_the_moved_roots(roots, edge, seed):
    """Checked at a point: what is said in the docstring of `moved`."""
    p, rng = with_roots(roots), np.random.default_rng(seed)
    z, d = complex(*rng.normal(size=2)), len(p) - 1

    def value(coefficients, s):
        return sum(float(each.mid()) * s**k for k, each in enumerate(coefficients))

    moved = edge.moved(p, 1.0)
    match edge.kind:
        case EdgeKind.DECAY:
            expected = value(p, z - edge.value)
        case EdgeKind.DAMPING:
            turn = cmath.exp(1j * (math.pi / 2 - math.acos(edge.value)))
            expected = value(p, z * turn) * value(p, z / turn)
        case EdgeKind.BANDWIDTH:
            expected = (1 - z) ** d * value(p, edge.value * (1 + z) / (1 - z))
    assert len(moved) == (2 * d if edge.kind is DAMPING else d) + 1
    size = sum(abs(float(each.mid())) * max(1, abs(z)) ** k for k, each in enumerate(moved))
    assert abs(value(moved, z) - expected) < 1e-9 * (1 + size)


def test_a_sector_of_all_angles_is_the_half_plane():
    for roots, found in (([(-1, 12)], Verdict.PROVEN), ([(1, 12)], Verdict.REFUTED)):
        assert verdict(with_roots(roots), Edge(DAMPING, 0.0)) is found


def test_coefficients_that_are_zero_stay_in_their_place():
    assert len(Edge(DECAY, 0.0).moved([arb(1), arb(2), arb(0)], 1.0)) == 3
    assert is_hurwitz([arb(1), arb(2), arb(0)]) is not True  # a root at infinity
    assert is_hurwitz([arb(1), arb(1), arb(0, 1e-30)]) is None
    assert is_hurwitz([arb(0), arb(0), arb(0)]) is not True


def test_signs_do_not_matter_and_balls_leave_open_what_they_do_not_tell():
    p = with_roots([(-4, 1), (-8, 0)])
    assert is_hurwitz(p) is is_hurwitz([-each for each in p]) is True
    assert is_hurwitz([arb(1), arb(0, 0.5), arb(1)]) is None
    assert is_hurwitz([arb(1), arb(-1, 0.5), arb(1)]) is False
    assert is_hurwitz([arb(1), arb(0), arb(1)]) is False  # +-j
    assert is_hurwitz([arb(1), arb.nan(), arb(1)]) is None
    assert is_hurwitz([arb.nan(), arb(1), arb(1)]) is not True
    assert is_hurwitz([arb(1)]) is True  # no roots at all


@pytest.mark.parametrize("kind", EdgeKind)
def test_the_lmi_region_is_the_edge(kind, rng):
    """L + s R + conj(s) R^T < 0 exactly where `of_pole` is on the good side; time is counted in 1/unit."""
    for _ in range(300):
        s, value = (
            complex(rng.uniform(-5, 1), rng.normal() * 3),
            rng.uniform(0.05, 0.95) * (5 if kind is BANDWIDTH else 1),
        )
        for unit in (1.0, 4.0):
            L, R = (middle(X) for X in Edge(kind, value).lmi(unit))
            z = s / unit
            largest = np.linalg.eigvalsh(L + z * R + z.conjugate() * R.T)[-1]
            reached = kind.of_pole(s)
            good = reached > value if kind.relation == ">=" else reached < value
            assert (largest < 0) == good


def test_no_pole_at_all_has_no_damping():
    assert DAMPING.of_pole(0) == 0
    assert DAMPING.of_pole(complex(-3, 4)) == pytest.approx(0.6)
    assert DECAY.of_pole(complex(-3, 4)) == 3
    assert BANDWIDTH.of_pole(complex(-3, 4)) == 5
    assert {each.words for each in EdgeKind} == {"decay rate", "damping ratio", "greatest |s|"}
    assert [each.unit for each in EdgeKind] == ["1/s", "", "rad/s"]
