"""What the tests share: the shipped models and what is derived from them, and makers of special mechanisms."""

import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import settings
from scipy.integrate import solve_ivp

import firmtouch
from firmtouch.regulation import OperatingPoint, closed_loop_acceleration

ROOT = Path(__file__).parents[1]

# The same examples everywhere, so that a tolerance is met or missed for good.
settings.register_profile("firmtouch", deadline=None, derandomize=True, database=None)
settings.load_profile("firmtouch")


def shipped_model(path: Path):
    """Real arms take seconds each, so what holds for all models is tested on them in the long suite."""
    marks = [pytest.mark.slow] if "urdf:" in path.read_text(encoding="utf-8") else []
    return pytest.param(path, id=path.stem, marks=marks)


@pytest.fixture(scope="session", params=map(shipped_model, sorted((ROOT / "models").glob("*.yaml"))))
def model(request) -> firmtouch.ModelFile:
    return firmtouch.read_model(request.param)


@pytest.fixture(scope="session")
def plant(model) -> firmtouch.Plant:
    return firmtouch.derive_plant(model.spec)


@pytest.fixture(scope="session")
def place(plant) -> np.ndarray:
    """Give a configuration where every expression of the file has a value: what it names, before any projection."""
    point = plant.spec.operating_point
    named = point.q_d or point.guess or (point.reach and point.reach.near)
    if named is None:  # a robot that shall be at a point, the file does not say how
        return firmtouch.find_operating_point(plant).q_d
    return np.array([named[name] for name in plant.spec.coordinates])


@pytest.fixture(scope="session")
def op(plant) -> OperatingPoint:
    return firmtouch.find_operating_point(plant)


@pytest.fixture(scope="session")
def loop(op) -> firmtouch.ClosedLoop:
    return firmtouch.assign_poles(op, op.plant.spec.design)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(1993)


@pytest.fixture(scope="session")
def make_model() -> Callable[..., firmtouch.ModelFile]:
    """Make a model from the sections that matter; coordinates `"q1 q2"` are angles, `"x:m"` is a length."""

    def make(coordinates: str, *, constraints, guess, lambda_d=None, **sections) -> firmtouch.ModelFile:
        names = [each.partition(":")[::2] for each in coordinates.split()]
        free = 2 * (len(names) - len(constraints))
        point = {"guess": guess, "lambda_d": lambda_d or dict.fromkeys(constraints, 10)}
        document = {
            "schema": "firmtouch.model/1",
            "title": "A mechanism made by a test",
            "coordinates": {name: unit or "rad" for name, unit in names},
            "constraints": {
                name: each if isinstance(each, dict) else {"expression": each, "unit": "m"}
                for name, each in constraints.items()
            },
            "operating_point": point,
            "design": {"poles": [-(4.0 + i) for i in range(free)], "force_feedback": 0.5},
        }
        for key, value in sections.items():
            document[key] = document[key] | value if key in ("operating_point", "design") else value
        document["operating_point"] = {k: v for k, v in document["operating_point"].items() if v is not None}
        return firmtouch.parse_model(json.dumps(document).encode(), name="made")

    return make


@pytest.fixture(scope="session")
def make_arm(make_model) -> Callable[..., firmtouch.ModelFile]:
    """Make a planar arm of equal links; expressions may use its joints p0, p1, .. and its angles a1, a2, .."""

    def make(links: int, constraints, guess, **sections) -> firmtouch.ModelFile:
        names = [f"q{i}" for i in range(1, links + 1)]
        definitions = {"p0": "[0*l, 0*l]", "a0": "0*q1"}
        bodies = {}
        for i, name in enumerate(names, start=1):
            along = f"[cos(a{i}), sin(a{i})]"
            definitions |= {f"a{i}": f"a{i - 1} + {name}", f"p{i}": f"p{i - 1} + l*{along}"}
            centre = f"p{i - 1} + c*{along}"
            bodies[f"link{i}"] = {"mass": "m", "inertia": "I", "centre_of_mass": centre, "orientation": f"a{i}"}
        parameters = {"l": "0.4 m", "c": "0.18 m", "m": "2 kg", "I": "0.03 kg*m^2"} | sections.pop("parameters", {})
        return make_model(
            " ".join(names),
            parameters=parameters,
            definitions=definitions,
            mechanism={"gravity": "[0, -9.81]", "bodies": bodies},
            constraints=constraints,
            guess=dict(zip(names, guess, strict=True)),
            **sections,
        )

    return make


@pytest.fixture(scope="session")
def arm_on_circle(make_arm) -> firmtouch.ModelFile:
    """A 3R arm whose tip presses on a round obstacle from outside: n = 3, m = 1, and curvature matters."""
    return make_arm(3, {"circle": "norm(p3 - [0.9, 0.2]) - 0.25"}, [1.2, -0.9, -0.7], lambda_d={"circle": 20})


@pytest.fixture(scope="session")
def arm_in_corner(make_arm) -> firmtouch.ModelFile:
    """A 4R arm with m = 2: its tip on a circle, and its third joint on a parabola."""
    constraints = {"circle": "norm(p4 - [0.9, 0.2]) - 0.3", "parabola": "y(p3) - x(p3)**2/(4*l) - 0.3"}
    return make_arm(4, constraints, [1.4, -0.6, -0.5, -0.8], lambda_d={"circle": 15, "parabola": -8})


@pytest.fixture(scope="session")
def loop_of() -> Callable[..., firmtouch.ClosedLoop]:
    """Walk from a model to its closed loop."""

    def walk(model: firmtouch.ModelFile) -> firmtouch.ClosedLoop:
        op = firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))
        return firmtouch.assign_poles(op, model.spec.design)

    return walk


@pytest.fixture(scope="session")
def random_point() -> Callable[..., OperatingPoint]:
    """Draw an operating point of no particular mechanism: M > 0, J of full rank, any symmetric Hessians."""

    def draw(n: int, m: int, seed: int, *, curvature: float = 1.0) -> OperatingPoint:
        rng = np.random.default_rng(seed)

        def symmetric(size: float) -> np.ndarray:
            X = rng.normal(size=(n, n)) * size
            return X + X.T

        turn, _ = np.linalg.qr(rng.normal(size=(n, n)))
        J, lambda_d, hessians = rng.normal(size=(m, n)), rng.normal(size=m), [symmetric(curvature) for _ in range(m)]
        P_qq, g = symmetric(curvature), rng.normal(size=n)
        spec = SimpleNamespace(coordinates=range(n), constraints=range(m))
        return OperatingPoint(
            plant=SimpleNamespace(n=n, m=m, spec=spec),
            q_d=rng.normal(size=n),
            lambda_d=lambda_d,
            f_d=J.T @ lambda_d,
            M=turn @ np.diag(rng.uniform(0.2, 5, n)) @ turn.T,
            J=J,
            g=g,
            P_qq=P_qq,
            constraint_hessians=np.array(hessians),
            N0=P_qq - np.tensordot(lambda_d, hessians, axes=1),
            residual=0.0,
            moved=0.0,
        )

    return draw


@pytest.fixture(scope="session")
def random_positive() -> Callable[..., np.ndarray]:
    """Draw a symmetric matrix with eigenvalues between two numbers, spread evenly in the logarithm."""

    def draw(size: int, seed: int, low: float = 0.1, high: float = 10.0) -> np.ndarray:
        rng = np.random.default_rng(seed)
        turn, _ = np.linalg.qr(rng.normal(size=(size, size)))
        return turn @ np.diag(np.geomspace(low, high, size)) @ turn.T

    return draw


@pytest.fixture(scope="session")
def observed_order() -> Callable[..., float]:
    """Measure the order p of error(h) ~ h^p by halving h; below `exact` it counts as infinite."""

    def order(error: Callable[[float], float], h: float, *, exact: float = 0.0) -> float:
        first, second = error(h), error(h / 2)
        return float(np.log2(first / second)) if second > exact else np.inf

    return order


@pytest.fixture(scope="session")
def simulate() -> Callable[..., SimpleNamespace]:
    """Integrate the nonlinear closed loop from a state on the constraint, with integrals of (q, q', lambda) beside."""

    def run(op, law, q, v, duration, *, d=None, integrands=lambda *_: (), tolerance=1e-10) -> SimpleNamespace:
        n, force = op.n, np.zeros(op.n) if d is None else d

        def rate(_, state):
            q, v = state[:n], state[n : 2 * n]
            acceleration, lambda_ = closed_loop_acceleration(op, law, q, v, d=force)
            return np.concatenate([v, acceleration, integrands(q, v, lambda_)])

        start = np.concatenate([q, v, np.zeros(len(integrands(q, v, op.lambda_d)))])
        found = solve_ivp(rate, (0, duration), start, method="DOP853", rtol=tolerance, atol=tolerance)
        q, v = found.y[:n].T, found.y[n : 2 * n].T
        lambda_ = np.array([closed_loop_acceleration(op, law, *each, d=force)[1] for each in zip(q, v, strict=True)])
        return SimpleNamespace(t=found.t, q=q, v=v, lambda_=lambda_, integrals=found.y[2 * n :].T)

    return run
