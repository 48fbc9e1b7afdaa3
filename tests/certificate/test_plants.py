"""The plants of a certificate, enclosed: against mpmath at the vertices, and against the true plants between them."""

import itertools
from collections.abc import Callable
from dataclasses import replace

import flint
import mpmath as mp
import numpy as np
import pytest
from flint import arb
from scipy.optimize import linprog
from tests.certificate.exactly import DIGITS, digits, matrix_holds

import firmtouch
from firmtouch.certificate.matrices import middle
from firmtouch.certificate.plants import NOMINAL, Plants
from firmtouch.modelfile.sections.region import LambdaUncertainty
from firmtouch.regulation import OperatingPoint
from firmtouch.regulation.operating_point import operating_point_at
from firmtouch.regulation.projection import Projection
from firmtouch.regulation.uncertainty import uncertainty_polytope

INSIDE = 1e-9  # the linear programme's feasibility, relative


@pytest.fixture
def point_of() -> Callable[[firmtouch.ModelFile], OperatingPoint]:
    return lambda model: firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))


@pytest.fixture
def make_bent(make_model, point_of):
    """Make a 2R arm whose second centre of mass lies `c` along and at the angle `delta` off the link."""

    def make(across="c*[cos(q1 + q2 + delta), sin(q1 + q2 + delta)]", inertia="I"):
        p = {"l": "0.4 m", "c": "0.18 m", "delta": "0.3 rad", "m": "2 kg", "I": "0.03 kg*m^2"}
        upper = {"mass": "m", "inertia": "I", "centre_of_mass": "c*[cos(q1), sin(q1)]", "orientation": "q1"}
        lower = {"mass": "m", "inertia": inertia, "centre_of_mass": f"elbow + {across}", "orientation": "q1 + q2"}
        return point_of(
            make_model(
                "q1 q2",
                parameters=p,
                definitions={"elbow": "l*[cos(q1), sin(q1)]", "tip": "elbow + l*[cos(q1 + q2), sin(q1 + q2)]"},
                mechanism={"gravity": "[0, -9.81]", "bodies": {"upper": upper, "lower": lower}},
                constraints={"circle": "norm(tip - [0.6, 0.2]) - 0.25"},
                guess={"q1": 1.2, "q2": -1.4},
            )
        )

    return make


@pytest.fixture
def on_circle(point_of, arm_on_circle):
    return point_of(arm_on_circle)


@pytest.fixture
def in_corner(point_of, arm_in_corner):
    return point_of(arm_in_corner)


def enclosed(op, intervals, forces=None, bits=128, q=None):
    with flint.ctx.workprec(bits):
        return Plants(op, intervals, forces).at([arb(each) for each in op.q_d.tolist()] if q is None else q)


def true_plant(op, q, lambda_d=None, **values):
    """Give M and N0 with 60 digits, at parameter values and multipliers."""
    names, n, m = list(op.plant.spec.parameters), op.n, op.m
    lambda_d = op.lambda_d.tolist() if lambda_d is None else lambda_d
    with mp.workdps(DIGITS):
        p = [mp.mpf(each) for each in op.plant.p.tolist()]
        for name, value in values.items():
            p[names.index(name)] = mp.mpf(value)
        M, P_qq, Phi_qq = (digits(op.plant.functions[name], q, p) for name in ("M", "P_qq", "Phi_qq"))

        def square(entries):
            return mp.matrix([[entries[i + n * j] for j in range(n)] for i in range(n)])

        N0 = square(P_qq)
        for j in range(m):
            N0 -= square(Phi_qq[j * n * n : (j + 1) * n * n]) * mp.mpf(lambda_d[j])
        return square(M), N0


def at(op, lambda_d=None, **values):
    """Evaluate the true plant in floats."""
    names, p = list(op.plant.spec.parameters), np.array(op.plant.p)
    for name, value in values.items():
        p[names.index(name)] = value
    projection = Projection(op.q_d, op.residual, op.moved)
    lambda_d = op.lambda_d if lambda_d is None else np.asarray(lambda_d)
    return operating_point_at(op.plant.with_parameters(p), projection, lambda_d)


def flat(M, N0):
    return np.concatenate([np.ravel(M), np.ravel(N0)])


def miss(vertices, point):
    """Measure by a linear programme how far a plant is from the hull of balls: what is over after their radii."""
    centres = np.array([flat(middle(each.M), middle(each.N0)) for each in vertices]).T
    radii = np.max([[float(x.rad()) for X in (each.M, each.N0) for x in X.entries()] for each in vertices], axis=0)
    scale = np.abs(centres).max()
    V, x, count = centres / scale, flat(point.M, point.N0) / scale, centres.shape[1]
    ones, room = np.ones((len(x), 1)), radii / scale
    found = linprog(
        np.append(np.zeros(count), 1),
        A_ub=np.block([[V, -ones], [-V, -ones]]),
        b_ub=np.concatenate([x + room, -x + room]),
        A_eq=[[1] * count + [0]],
        b_eq=[1],
    )
    assert found.success
    return found.fun


def test_nothing_that_varies_leaves_the_nominal_plant_alone(subject):
    op = subject.op
    nominal, vertices = enclosed(op, {})
    assert vertices == (nominal,)
    assert nominal.label == NOMINAL
    assert not Plants(op, {}, None).vary
    M, N0 = true_plant(op, op.q_d.tolist())
    assert matrix_holds(nominal.M, M)
    assert matrix_holds(nominal.N0, N0)
    size = max(1.0, np.abs(op.N0).max())
    assert np.abs(middle(nominal.N0) - op.N0).max() < 1e-12 * size
    assert np.abs(middle(nominal.M) - op.M).max() < 1e-12


@pytest.mark.parametrize("radius", [1e-12, 1e-5])
def test_the_nominal_plant_is_enclosed_on_a_box_of_configurations(subject, rng, radius):
    op = subject.op
    nominal, _ = enclosed(op, {}, q=[arb(each, radius) for each in op.q_d.tolist()])
    for _ in range(2):
        with mp.workdps(DIGITS):
            q = [
                mp.mpf(a) + mp.mpf(radius) * mp.mpf(t)
                for a, t in zip(op.q_d.tolist(), rng.uniform(-1, 1, op.n).tolist(), strict=True)
            ]
        M, N0 = true_plant(op, q)
        assert matrix_holds(nominal.M, M)
        assert matrix_holds(nominal.N0, N0)


def test_intervals_of_shipped_models_give_corner_plants(op):
    intervals = {
        name: tuple(end.value for end in each.interval)
        for name, each in op.plant.spec.parameters.items()
        if each.interval
    }
    nominal, vertices = enclosed(op, intervals)
    assert len(vertices) == 2 ** len(intervals)
    for vertex, corner in zip(vertices, itertools.product(*intervals.values()), strict=True):
        M, N0 = true_plant(op, op.q_d.tolist(), **dict(zip(intervals, corner, strict=True)))
        assert matrix_holds(vertex.M, M)
        assert matrix_holds(vertex.N0, N0)
    assert matrix_holds(nominal.M, true_plant(op, op.q_d.tolist())[0])


CASES = {
    "a mass": ({}, {"m": (1.5, 3.0)}, [1]),
    "a centre of mass": ({}, {"c": (0.1, 0.3)}, [2]),
    "both": ({}, {"m": (1.5, 3.0), "c": (0.1, 0.3)}, [1, 2]),
    "an angle": ({}, {"delta": (0.1, 0.5)}, [4]),
    "an angle and a centre": ({}, {"delta": (0.1, 0.5), "c": (0.1, 0.3)}, [4, 2]),
    "a reciprocal": ({"inertia": "I + m*l**3/c"}, {"c": (0.15, 0.2)}, [4]),
    "a root": ({"inertia": "I + m*l**2*sqrt(c/l)"}, {"c": (0.1, 0.2)}, [4]),
    "a reciprocal and an angle": ({"inertia": "I + m*l**3/c"}, {"c": (0.15, 0.2), "delta": (0.2, 0.3)}, [4, 4]),
    "a cube": ({"inertia": "I + m*c**3/l"}, {"c": (0.1, 0.3)}, [3]),
    "a negative power": ({"inertia": "I + m*l**4/c**2"}, {"c": (0.15, 0.2)}, [4]),
    "through zero": ({}, {"delta": (-0.2, 0.3), "c": (-0.1, 0.1)}, [4, 2]),
}


@pytest.mark.parametrize("case", CASES.values(), ids=list(CASES))
def test_true_plants_lie_in_the_hull(make_bent, rng, case):
    """By Bernstein's weights: sum b_i(t) c_i holds the true M and N0, whose vertices' balls have the spread in them."""
    made, intervals, degrees = case
    op = make_bent(**made)
    _, vertices = enclosed(op, intervals)
    assert len(vertices) == np.prod(np.array(degrees) + 1)
    for _ in range(12):
        t = rng.uniform(size=len(degrees)).tolist() if _ else [0.0] * len(degrees)
        with mp.workdps(DIGITS):
            values = {
                name: (1 - mp.mpf(each)) * mp.mpf(low) + mp.mpf(each) * mp.mpf(high)
                for each, (name, (low, high)) in zip(t, intervals.items(), strict=True)
            }
        M, N0 = true_plant(op, op.q_d.tolist(), **values)
        with flint.ctx.workprec(300):
            weights = [arb(1)]
            for each, d in zip(t, degrees, strict=True):
                b = [arb(flint.fmpz.bin_uiui(d, i)) * arb(each) ** i * (1 - arb(each)) ** (d - i) for i in range(d + 1)]
                weights = [w * x for w in weights for x in b]
            pairs = list(zip(weights, vertices, strict=True))
            first, *others = ((v.M * w, v.N0 * w) for w, v in pairs)
            mean_M, mean_N0 = first
            for a, b in others:
                mean_M, mean_N0 = mean_M + a, mean_N0 + b
        assert matrix_holds(mean_M, M)
        assert matrix_holds(mean_N0, N0)


@pytest.mark.parametrize("case", CASES.values(), ids=list(CASES))
def test_vertices_agree_with_the_polytope_of_the_search(make_bent, rng, case):
    made, intervals, _ = case
    op = make_bent(**made)
    polytope = uncertainty_polytope(op, parameters=intervals)
    _, vertices = enclosed(op, intervals)
    assert len(vertices) == len(polytope.vertices)
    for mine, theirs in zip(vertices, polytope.vertices, strict=True):
        for X, Y in ((mine.M, theirs.M), (mine.N0, theirs.N0)):
            assert np.abs(middle(X) - Y).max() < 1e-11 * max(
                1, np.abs(Y).max()
            )  # Bernstein's matrix, inverted in floats
        radius = max(float(each.rad()) for each in mine.M.entries())
        assert radius <= polytope.remainder_M * 1.01 + 1e-30
        assert (radius > 1e-30) == (polytope.remainder_M > 0)
    for _ in range(10):
        values = {name: rng.uniform(*interval) for name, interval in intervals.items()}
        assert miss(vertices, at(op, **values)) < INSIDE


def test_the_spread_is_a_bound_and_not_an_absurd_one(make_bent, rng):
    """What the interpolation misses, at 60 digits: it is in the balls, and needs a good part of them."""
    op, interval = make_bent(inertia="I + m*l**3/c"), (0.15, 0.2)
    _, vertices = enclosed(op, {"c": interval})
    radius = max(float(each.rad()) for each in vertices[0].M.entries())
    worst = 0.0
    for t in np.linspace(0, 1, 41).tolist():
        M, _ = true_plant(op, op.q_d.tolist(), c=(1 - t) * interval[0] + t * interval[1])
        b = [float(flint.fmpz.bin_uiui(4, i)) * t**i * (1 - t) ** (4 - i) for i in range(5)]
        mean = sum(w * middle(v.M) for w, v in zip(b, vertices, strict=True))
        worst = max(worst, float(max(abs(mean[i, j] - float(M[i, j])) for i in range(2) for j in range(2))))
    assert radius / 20 < worst <= radius * (1 + 1e-6)


@pytest.mark.parametrize("forces", [{"box": {"circle": 6.0}}, {"ball": 6.0}], ids=["box", "ball"])
def test_one_uncertain_force_is_an_interval(on_circle, rng, forces):
    intervals = {"m": (1.5, 3.0)}
    _, vertices = enclosed(
        on_circle, intervals, LambdaUncertainty.model_construct(**{"box": None, "ball": None} | forces)
    )
    assert len(vertices) == 4
    expected = [(mass, force) for mass in (1.5, 3.0) for force in (14.0, 26.0)]
    for vertex, (mass, force) in zip(vertices, expected, strict=True):
        M, N0 = true_plant(on_circle, on_circle.q_d.tolist(), [force], m=mass)
        assert matrix_holds(vertex.M, M)
        assert matrix_holds(vertex.N0, N0)
        assert vertex.label == f"m = {mass:g}, lambda_d.circle = {force:g}"


def test_two_uncertain_forces_in_a_box_and_in_a_ball(in_corner, rng):
    op = in_corner
    for forces, reach in (({"box": {"circle": 3.0, "parabola": 2.0}}, (3.0, 2.0)), ({"ball": 3.0}, None)):
        _, vertices = enclosed(op, {}, LambdaUncertainty.model_construct(**{"box": None, "ball": None} | forces))
        assert len(vertices) == 4
        for _ in range(20):
            move = rng.uniform(-1, 1, 2) * reach if reach else on_sphere(rng, 2) * 3.0
            assert miss(vertices, at(op, op.lambda_d + move)) < INSIDE
        polytope = uncertainty_polytope(op, parameters={}, **{f"lambda_{name}": each for name, each in forces.items()})
        for mine, theirs in zip(vertices, polytope.vertices, strict=True):
            assert np.abs(middle(mine.N0) - theirs.N0).max() < 1e-12 * np.abs(theirs.N0).max()
    outside = at(op, op.lambda_d + np.array([3.0, 2.01]))
    _, vertices = enclosed(op, {}, LambdaUncertainty.model_construct(box={"circle": 3.0, "parabola": 2.0}, ball=None))
    assert miss(vertices, outside) > INSIDE


def on_sphere(rng, m):
    direction = rng.normal(size=m)
    return direction / np.linalg.norm(direction)


@pytest.mark.parametrize("m", [3, 4])
def test_a_ball_of_many_forces_lies_within_few_vertices(m, rng):
    """The offsets alone: 2 m of them, whose hull holds the ball (its dual norm is at least the radius everywhere)."""
    plants = object.__new__(Plants)
    plants._forces, plants._names = LambdaUncertainty.model_construct(box=None, ball=2.0), [f"c{j}" for j in range(m)]
    plants._curved, plants._lambda_d = list(range(m)), [arb(0)] * m
    with flint.ctx.workprec(64):
        offsets = plants._offsets()
    assert len(offsets) == 2 * m
    corners = np.array([[float(move.get(j, arb(0)).mid()) for j in range(m)] for move, _ in offsets])
    for _ in range(200):
        assert (corners @ on_sphere(rng, m)).max() >= 2.0 * (1 - 1e-12)


def test_no_radius_and_flat_constraints_make_no_vertices(on_circle, point_of, make_model):
    for forces in (
        LambdaUncertainty.model_construct(box={"circle": 0.0}, ball=None),
        LambdaUncertainty.model_construct(box=None, ball=0.0),
    ):
        nominal, vertices = enclosed(on_circle, {}, forces)
        assert vertices == (nominal,)
    flat_one = point_of(
        make_model(
            "x:m y:m",
            parameters={"m": "2 kg", "g": "9.81 m/s^2"},
            mechanism={"kinetic_energy": "m*(dot(x)**2 + dot(y)**2)/2", "potential_energy": "m*g*y"},
            constraints={"floor": "y"},
            guess={"x": 0.1, "y": 0},
        )
    )
    assert not Plants(flat_one, {}, LambdaUncertainty.model_construct(box={"floor": 5.0}, ball=None)).vary


def test_an_interval_of_one_value_and_an_idle_parameter_make_no_vertices(on_circle):
    plants = Plants(on_circle, {"m": (2.0, 2.0)}, None)
    assert not plants.vary
    op = on_circle
    nominal, vertices = enclosed(op, {"m": (float(op.plant.p[list(op.plant.spec.parameters).index("m")]),) * 2})
    assert vertices == (nominal,)


def test_more_bits_stay_within_fewer(make_bent):
    op = make_bent()
    wide, narrow = (enclosed(op, {"delta": (0.1, 0.5)}, bits=bits)[1] for bits in (64, 256))
    for a, b in zip(wide, narrow, strict=True):
        for X, Y in ((a.M, b.M), (a.N0, b.N0)):
            assert X.overlaps(Y)
            pairs = zip(X.entries(), Y.entries(), strict=True)
            assert all(float(y.rad()) <= float(x.rad()) * (1 + 1e-6) + 1e-15 for x, y in pairs)


def test_the_gradient_is_enclosed(subject):
    op = subject.op
    with flint.ctx.workprec(64):
        found = Plants(op, {}, None).gradient([arb(each) for each in op.q_d.tolist()])
    values = digits(op.plant.functions["P_q"], op.q_d.tolist(), op.plant.p.tolist())
    assert matrix_holds(found, mp.matrix(values))


def test_a_plant_where_a_division_by_zero_hides_is_no_number(make_bent):
    op = make_bent(inertia="I + m*l**3/c")
    _, vertices = enclosed(op, {"c": (-0.1, 0.2)})
    assert not all(each.is_finite() for vertex in vertices for each in vertex.M.entries())


def test_it_is_the_point_that_is_enclosed_and_not_the_operating_points_floats(on_circle):
    """M of the operating point is not looked at."""
    spoilt = replace(on_circle, M=on_circle.M * 2, P_qq=on_circle.P_qq * 2)
    assert np.abs(middle(enclosed(spoilt, {})[0].M) - on_circle.M).max() < 1e-12
