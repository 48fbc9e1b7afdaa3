"""The polytope around what the parameters and lambda_d do to M and N0: nothing outside, and how much too large."""

import itertools
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.special import comb

import firmtouch
from firmtouch.errors import InputError, NoDesignError
from firmtouch.mechanics import intervals
from firmtouch.modelfile.expression.functions import SCALAR
from firmtouch.regulation import dependence, operating_point
from firmtouch.regulation.dependence import LEBESGUE
from firmtouch.regulation.uncertainty import (
    IndefiniteInertiaError,
    sample,
    uncertainty_polytope,
    vertex_point,
)


@pytest.fixture
def point_of():
    return lambda model: firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))


@pytest.fixture
def on_circle(point_of, arm_on_circle):
    return point_of(arm_on_circle)


@pytest.fixture
def make_bent(make_model, point_of):
    """Make a 2R arm whose second centre of mass lies `c` along and at the angle `delta` off the link."""

    def make(across="c*[cos(q1 + q2 + delta), sin(q1 + q2 + delta)]", inertia="I", **parameters):
        p = {"l": "0.4 m", "c": "0.18 m", "delta": "0.3 rad", "m": "2 kg", "I": "0.03 kg*m^2"} | parameters
        bodies = {
            "upper": {"mass": "m", "inertia": "I", "centre_of_mass": "c*[cos(q1), sin(q1)]", "orientation": "q1"},
            "lower": {
                "mass": "m",
                "inertia": inertia,
                "centre_of_mass": f"elbow + {across}",
                "orientation": "q1 + q2",
            },
        }
        return point_of(
            make_model(
                "q1 q2",
                parameters=p,
                definitions={"elbow": "l*[cos(q1), sin(q1)]", "tip": "elbow + l*[cos(q1 + q2), sin(q1 + q2)]"},
                mechanism={"gravity": "[0, -9.81]", "bodies": bodies},
                constraints={"circle": "norm(tip - [0.6, 0.2]) - 0.25"},
                guess={"q1": 1.2, "q2": -1.4},
            )
        )

    return make


def at(op, lambda_d=None, **values):
    """Evaluate the true plant at parameter values, at the same q_d."""
    names = list(op.plant.spec.parameters)
    p = np.array(op.plant.p)
    for name, value in values.items():
        p[names.index(name)] = value
    projection = operating_point.Projection(op.q_d, op.residual, op.moved)
    return operating_point.operating_point_at(
        op.plant.with_parameters(p), projection, op.lambda_d if lambda_d is None else lambda_d
    )


def flat(point):
    return np.concatenate([point.M.ravel(), point.N0.ravel(), point.g])


def miss(polytope, point):
    """Measure by a linear programme how far (largest entry, relative to its size) a point is from the hull."""
    scale = np.abs(flat(polytope.vertices[0])).max()
    V = np.array([flat(each) for each in polytope.vertices]).T / scale
    x = flat(point) / scale
    count = V.shape[1]
    ones = np.ones((len(x), 1))
    found = linprog(
        np.append(np.zeros(count), 1),
        A_ub=np.block([[V, -ones], [-V, -ones]]),
        b_ub=np.concatenate([x, -x]),
        A_eq=[[1] * count + [0]],
        b_eq=[1],
    )
    assert found.success
    return found.fun


def assert_same(vertex, point):
    for mine, true in ((vertex.M, point.M), (vertex.N0, point.N0), (vertex.g, point.g)):
        assert np.allclose(mine, true, rtol=0, atol=1e-13 * max(1, np.abs(true).max()))  # sums in another order


def misses(op, polytope, rng, count):
    return max(miss(polytope, sample(op, polytope, rng)) for _ in range(count))


INSIDE = 1e-9  # the linear programme's feasibility, relative
CENTRE, MASS = {"c": (0.1, 0.3)}, {"m": (1.5, 3.0)}


def test_without_uncertainty_the_polytope_is_the_nominal_point(random_point):
    op = random_point(4, 2, 0)
    polytope = uncertainty_polytope(op, parameters={})
    (vertex,) = polytope.vertices
    assert_same(vertex, op)
    assert (vertex.label, vertex.untaken, str(vertex)) == ({}, (), "nominal")
    assert polytope.enlargement == 1
    assert polytope.remainder_M == polytope.remainder_N0 == polytope.remainder_g == 0


def test_masses_and_inertias_give_the_corner_plants(on_circle, rng):
    intervals = {"m": (1.5, 3.0), "I": (0.02, 0.05)}
    polytope = uncertainty_polytope(on_circle, parameters=intervals)
    assert [each.label for each in polytope.vertices] == [
        dict(zip(intervals, corner, strict=True)) for corner in itertools.product(*intervals.values())
    ]
    for vertex in polytope.vertices:
        assert_same(vertex, at(on_circle, **vertex.label))
        assert vertex.untaken == ()
    assert str(polytope.vertices[1]) == "m = 1.5, I = 0.05"
    assert polytope.enlargement == 1
    assert misses(on_circle, polytope, rng, 50) < INSIDE


def test_a_centre_of_mass_gives_a_triangle_around_the_parabola(on_circle, rng):
    polytope = uncertainty_polytope(on_circle, parameters=CENTRE)
    first, middle, last = polytope.vertices
    assert_same(first, at(on_circle, c=0.1))
    assert_same(last, at(on_circle, c=0.3))
    assert (middle.label, middle.untaken) == ({"c": pytest.approx(0.2)}, ("c",))
    assert str(middle) == "c near 0.2 (control point)"
    # The tangents at both ends meet in the middle control point, and the parabola passes halfway below it.
    assert np.allclose(flat(middle), 2 * flat(at(on_circle, c=0.2)) - (flat(first) + flat(last)) / 2, atol=1e-12)
    V = np.vstack([np.array([flat(each) for each in polytope.vertices]).T, np.ones(3)])
    for _ in range(1000):
        point = sample(on_circle, polytope, rng)
        weights = np.linalg.lstsq(V, np.append(flat(point), 1), rcond=None)[0]
        assert weights.min() > -1e-12
        assert np.abs(V[:-1] @ weights - flat(point)).max() < 1e-12 * np.abs(V).max()
    assert 1.001 < polytope.enlargement < 1.5
    narrow = uncertainty_polytope(on_circle, parameters={"c": (0.19, 0.21)})
    assert 1 < narrow.enlargement < 1 + (polytope.enlargement - 1) / 5  # the curve bends with the square of its length


def test_enlargement_of_a_parabola_in_figures(on_circle):
    # From the definition, in the plane of the triangle: h is half the height over the chord, d the length of the chord.
    polytope = uncertainty_polytope(on_circle, parameters=CENTRE)
    halves = []
    for part in ("M", "N0"):
        first, middle, last = (getattr(each, part).ravel() for each in polytope.vertices)
        values = np.array([getattr(at(on_circle, c=c), part).ravel() for c in np.linspace(*CENTRE["c"], 101)])
        reach = np.linalg.norm(np.ptp(values, axis=0))
        halves.append(np.array([first, middle, last]) / reach)
    first, middle, last = np.hstack(halves)
    curve = [(1 - t) ** 2 * first + 2 * t * (1 - t) * middle + t**2 * last for t in np.linspace(0, 1, 4001)]
    height = min(np.linalg.norm(middle - each) for each in curve)  # the nearest point of the hull is on the curve
    assert polytope.enlargement == pytest.approx(1 + 2 * height / np.linalg.norm(last - first), rel=1e-4)


def test_mass_and_centre_together(on_circle, rng):
    polytope = uncertainty_polytope(on_circle, parameters=MASS | CENTRE)
    assert len(polytope.vertices) == 6
    assert sum(each.untaken == ("c",) for each in polytope.vertices) == 2
    for vertex in polytope.vertices:
        if not vertex.untaken:
            assert_same(vertex, at(on_circle, **vertex.label))
    assert polytope.enlargement > 1
    assert misses(on_circle, polytope, rng, 100) < INSIDE


def test_what_does_not_matter_makes_no_vertex(make_bent):
    op = make_bent(unused="3 kg")
    polytope = uncertainty_polytope(op, parameters={"unused": (1.0, 5.0), "m": (2.5, 2.5)})
    (vertex,) = polytope.vertices
    assert_same(vertex, at(op, m=2.5))
    assert polytope.parameters == {"unused": (1.0, 5.0), "m": (2.5, 2.5)}


def test_a_box_or_a_ball_of_one_force_is_an_interval(on_circle, rng):
    box = uncertainty_polytope(on_circle, parameters=MASS, lambda_box={"circle": 6.0})
    ball = uncertainty_polytope(on_circle, parameters=MASS, lambda_ball=6.0)
    for polytope in (box, ball):
        assert [each.label["lambda_d.circle"] for each in polytope.vertices] == [14, 26, 14, 26]
        for vertex in polytope.vertices:
            assert vertex.untaken == ()
            assert_same(vertex, at(on_circle, [vertex.label["lambda_d.circle"]], m=vertex.label["m"]))
        assert polytope.enlargement == 1
        assert misses(on_circle, polytope, rng, 30) < INSIDE


def test_a_box_of_two_forces_is_exact_and_a_ball_is_enclosed(point_of, arm_in_corner, rng):
    op = point_of(arm_in_corner)
    box = uncertainty_polytope(op, parameters={}, lambda_box={"circle": 3.0, "parabola": 2.0})
    assert len(box.vertices) == 4
    assert box.enlargement == 1
    for vertex in box.vertices:
        assert_same(vertex, at(op, list(vertex.label.values())))
    ball = uncertainty_polytope(op, parameters={}, lambda_ball=3.0)
    assert ball.enlargement == pytest.approx(np.sqrt(2))
    assert all(each.untaken == ("lambda_d.circle", "lambda_d.parabola") for each in ball.vertices)
    for polytope in (box, ball):
        assert misses(op, polytope, rng, 50) < INSIDE
    touching = at(op, op.lambda_d + np.array([3.0, 0]))
    assert miss(ball, touching) < INSIDE < miss(ball, at(op, op.lambda_d + np.array([3.01, 0])))
    half = uncertainty_polytope(op, parameters={}, lambda_box={"parabola": 2.0})
    assert [list(each.label) for each in half.vertices] == [["lambda_d.parabola"]] * 2


@pytest.mark.parametrize("m", [3, 4])
def test_a_ball_of_many_forces_is_enclosed_by_few_vertices(random_point, rng, m):
    op = random_point(6, m, 1)
    polytope = uncertainty_polytope(op, parameters={}, lambda_ball=2.0)
    assert len(polytope.vertices) == 2 * m
    assert polytope.enlargement == pytest.approx(np.sqrt(m))
    for _ in range(50):
        direction = rng.normal(size=m)
        lambda_d = op.lambda_d + 2 * direction / np.linalg.norm(direction)
        N0 = op.P_qq - np.tensordot(lambda_d, op.constraint_hessians, axes=1)
        assert miss(polytope, replace(op, N0=N0)) < INSIDE


def test_forces_of_flat_constraints_do_not_matter(make_model, point_of):
    op = point_of(
        make_model(
            "x:m y:m z:m",
            parameters={"m": "2 kg", "g": "9.81 m/s^2"},
            mechanism={"kinetic_energy": "m*(dot(x)**2 + dot(y)**2 + dot(z)**2)/2", "potential_energy": "m*g*z"},
            constraints={"table": "z", "rod": "norm([x, y, z]) - 1"},
            guess={"x": 1, "y": 0.2, "z": 0},
        )
    )
    box = uncertainty_polytope(op, parameters={}, lambda_box={"table": 5.0, "rod": 1.0})
    ball = uncertainty_polytope(op, parameters={}, lambda_ball=1.0)
    assert [each.label for each in box.vertices] == [{"lambda_d.rod": 9}, {"lambda_d.rod": 11}]
    assert [each.label for each in ball.vertices] == [{"lambda_d.rod": 9}, {"lambda_d.rod": 11}]
    assert ball.enlargement == 1


def test_box_and_ball_together_are_refused(on_circle):
    with pytest.raises(InputError, match="give one of them"):
        uncertainty_polytope(on_circle, parameters={}, lambda_box={"circle": 1.0}, lambda_ball=1.0)


def bernstein(t, degree):
    i = np.arange(degree + 1)
    return comb(degree, i) * t**i * (1 - t) ** (degree - i)


def errors(op, polytope, rng, degrees, count=300):
    """Compare true plants with the point of the hull that has the Bernstein polynomials for weights."""
    for _ in range(count):
        t = rng.uniform(size=len(degrees))
        p = {
            name: (1 - s) * low + s * high
            for s, (name, (low, high)) in zip(t, polytope.parameters.items(), strict=True)
        }
        weights = np.array([1.0])
        for s, degree in zip(t, degrees, strict=True):
            weights = np.kron(weights, bernstein(s, degree))
        assert weights.min() >= 0
        true = at(op, **p)
        yield [
            np.linalg.norm(
                np.tensordot(weights, [getattr(v, part) for v in polytope.vertices], 1) - getattr(true, part), o
            )
            for part, o in (("M", 2), ("N0", 2), ("g", None))
        ]


@pytest.mark.parametrize(
    ("made", "intervals", "degrees"),
    [
        ({}, {"delta": (-0.2, 0.6)}, [4]),
        ({}, {"delta": (0.2, 0.4), "m": (1.0, 3.0), "c": (0.1, 0.2)}, [4, 1, 2]),
        ({"inertia": "I + m*l**3/c"}, {"c": (0.15, 0.2)}, [4]),
        ({"inertia": "I + m*l**2*sqrt(c/l)"}, {"delta": (0.1, 0.5), "c": (0.15, 0.2)}, [4, 4]),
        ({"inertia": "I + m*l**2*(atan(delta) + asin(delta/2) + acos(delta/2) + exp(delta)**delta)"}, {"delta": (0.2, 0.4)}, [4]),
        ({"inertia": "I*(1 + tanh(delta) + sinh(delta) + cosh(delta) + tan(delta) + log(delta))"}, {"delta": (0.2, 0.3)}, [4]),
    ],
)  # fmt: skip
def test_what_is_no_polynomial_stays_within_the_remainder(make_bent, rng, made, intervals, degrees):
    op = make_bent(**made)
    polytope = uncertainty_polytope(op, parameters=intervals)
    assert len(polytope.vertices) == np.prod(np.array(degrees) + 1)
    for vertex in polytope.vertices:
        if not vertex.untaken:
            assert_same(vertex, at(op, **vertex.label))
    found = np.array(list(errors(op, polytope, rng, degrees))).max(axis=0)
    bounds = np.array([polytope.remainder_M, polytope.remainder_N0, polytope.remainder_g])
    rounding = 1e-13 * max(np.abs(flat(each)).max() for each in polytope.vertices)
    assert np.all(found <= bounds + rounding)
    assert bounds[0] < 20 * found[0] + rounding  # a bound, and not an absurd one
    assert bounds[0] < 1e-3 * np.linalg.norm(op.M, 2)


def test_the_constants_of_the_interpolation():
    nodes, x = dependence.nodes_of(4), np.linspace(0, 1, 20001)
    basis = [np.prod([(x - b) / (a - b) for b in nodes if b != a], axis=0) for a in nodes]
    assert 1.79 < np.abs(basis).sum(axis=0).max() < LEBESGUE
    assert np.abs(np.prod([x - a for a in nodes], axis=0)).max() < 0.5**5 / 8
    error = dependence.interpolation_error(np.array([120.0]), 1.0)  # of p^5, whose fifth derivative is 120
    assert error == pytest.approx(0.5**5 / 8)
    axes = [dependence.Axis("p", nodes, np.full(3, size)) for size in (0.0, 1.0, 2.0)]  # n = 1: M, P_qq and P_q
    assert dependence.remainders_of(axes, 1) == pytest.approx([2 + LEBESGUE] * 3)


def test_intervals_hold_the_values_of_each_operation(rng):
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    unary = [getattr(ca, name) for name in SCALAR if SCALAR[name] == 1 and hasattr(ca, name)]
    values = [each(x) for each in (*unary, ca.asin, ca.acos, ca.atan, ca.fabs, ca.sign)]
    values += [x + y, x - y, x * y, x / y, 1 / y, -x, x**2, x + x, x**y, x**0.5, y**-3]
    values += [ca.atan2(y, x), ca.atan2(y, -x), y + ca.fabs(x - 2), y - ca.sign(x - y)]
    function, box = ca.Function("f", [ca.vertcat(x, y)], [ca.vertcat(*values)]), [(0.3, 0.7), (1.2, 1.4)]
    bounds = intervals.enclose(function, box, "the test")
    points = [*itertools.product(*box), *rng.uniform(*np.transpose(box), size=(500, 2))]
    largest = np.max([np.abs(function(point).full().ravel()) for point in points], axis=0)
    assert np.all(largest <= bounds * (1 + 1e-15))  # CasADi rounds too
    assert bounds == pytest.approx(largest, rel=0.1)  # exact but for cosh, a sum of two exponentials


@pytest.mark.parametrize(
    ("made", "intervals", "told"),
    [
        ({"inertia": "I + m*l**3/c"}, {"c": (-0.1, 0.2)}, "dependence on `c` cannot be bounded over its interval"),
        (
            {"inertia": "I + m*l**2*sqrt(c/l)"},
            {"c": (-0.1, 0.2)},
            "dependence on `c` cannot be bounded over its interval",
        ),
        ({"across": "norm([c, 0*c])*[cos(q1 + q2), sin(q1 + q2)]"}, {"c": (-0.1, 0.2)}, "kink"),
        ({"across": "c*[cos(q1 + q2 + atan2(c, -l)), 0]"}, {"c": (-0.1, 0.2)}, "jumps"),
    ],
)
def test_what_has_no_bound_is_refused(make_bent, made, intervals, told):
    with pytest.raises(NoDesignError, match=told):
        uncertainty_polytope(make_bent(**made), parameters=intervals)


def test_an_absolute_value_away_from_zero_is_no_kink(make_bent):
    op = make_bent(across="norm([c, 0*c])*[cos(q1 + q2), sin(q1 + q2)]")
    assert len(uncertainty_polytope(op, parameters=CENTRE).vertices) == 3


def test_an_unknown_operation_is_named(monkeypatch, make_bent):
    monkeypatch.setattr(intervals, "_interval_operations", dict)
    with pytest.raises(NoDesignError, match="`delta` cannot be bounded: no intervals for the operation OP_"):
        uncertainty_polytope(make_bent(), parameters={"delta": (0.1, 0.5)})


def test_too_many_vertices_say_who_makes_them(make_bent):
    op = make_bent(inertia="I*k1*k2*k3*k4", **{f"k{i}": "1" for i in range(1, 5)})
    intervals = {"delta": (0.1, 0.5), "c": (0.1, 0.2)} | {f"k{i}": (0.9, 1.1) for i in range(1, 5)}
    with pytest.raises(
        NoDesignError, match=r"480 vertices.*`delta` makes 5, `c` makes 3, .*`k4` makes 2, `lambda_d` makes 2"
    ):
        uncertainty_polytope(op, parameters=intervals, lambda_ball=1.0)


def test_a_corner_without_inertia_is_refused_with_its_values(on_circle):
    with pytest.raises(IndefiniteInertiaError, match=r"at m = -0.1, I = 0.02 \(in SI\)") as refusal:
        uncertainty_polytope(on_circle, parameters={"m": (-0.1, 3.0), "I": (0.02, 0.04)}, lambda_ball=1.0)
    assert isinstance(refusal.value, InputError)
    assert refusal.value.parameters == {"m": -0.1, "I": 0.02}
    assert refusal.value.smallest == pytest.approx(np.linalg.eigvalsh(at(on_circle, m=-0.1, I=0.02).M)[0])


def test_a_control_point_without_inertia_is_no_fault_of_the_file(make_bent):
    # (c - 0.2)^2 is positive at every c, and its middle control point over an interval around 0.2 is not.
    op = make_bent(inertia="0.001*I + 100*m*(c - 0.18)**2", across="0*c*[cos(q1 + q2), sin(q1 + q2)]")
    with pytest.raises(NoDesignError, match=r"too large.*c near 0.18 \(control point\)"):
        uncertainty_polytope(op, parameters={"c": (0.08, 0.28)})
    assert len(uncertainty_polytope(op, parameters={"c": (0.18, 0.28)}).vertices) == 3


def test_parameters_of_constraints_are_not_for_this(on_circle):
    with pytest.raises(AssertionError, match="q_d would move"):
        uncertainty_polytope(on_circle, parameters={"l": (0.3, 0.5)})


def test_a_vertex_in_the_operating_points_place(on_circle, loop_of, arm_on_circle):
    (_, heavy) = uncertainty_polytope(on_circle, parameters=MASS).vertices
    point = vertex_point(on_circle, heavy)
    assert (point.M is heavy.M, point.N0 is heavy.N0, point.g is heavy.g) == (True, True, True)
    assert point.q_d is on_circle.q_d
    gains = loop_of(arm_on_circle).gains
    poles = firmtouch.close_loop(point, gains).poles.pencil
    true = firmtouch.close_loop(at(on_circle, m=3.0), gains).poles.pencil
    assert np.sort_complex(poles) == pytest.approx(np.sort_complex(true), rel=1e-9)


def test_shipped_intervals(op, rng):
    spec = op.plant.spec
    intervals = {
        name: tuple(end.value for end in each.interval) for name, each in spec.parameters.items() if each.interval
    }
    polytope = uncertainty_polytope(op, parameters=intervals)
    assert len(polytope.vertices) == 2 ** len(intervals)
    assert polytope.enlargement == 1
    assert misses(op, polytope, rng, 10) < INSIDE
