"""Which models SymPy is asked to derive: an estimate of what it would write, held against what it writes."""

import pytest
import sympy

from firmtouch.checks import check_model
from firmtouch.checks.derivatives import worth_comparing
from firmtouch.checks.growth import Size, second_derivatives, size_of
from firmtouch.checks.subject import make_subject
from firmtouch.modelfile.expression import parse
from firmtouch.modelfile.sections.joint_tree import Robot

q = sympy.Symbol("q", real=True)
FORMULAS = [
    "q",
    "q**2",
    "3*sin(q) + cos(2*q)",
    "sin(q)*cos(q)",
    "*".join(f"sin({i}*q)" for i in range(1, 12)),
    "sin(sin(sin(sin(sin(q)))))",
    "(1 + q**2)**(1/3)",
    "1/(1 + 1/(1 + 1/(1 + q)))",
    "exp(q)*atan2(q, 1 + q**2)",
]


def nodes(expression):
    return sum(1 for _ in sympy.preorder_traversal(expression))


@pytest.mark.parametrize("formula", FORMULAS)
def test_the_estimate_is_what_sympy_writes_within_a_small_factor(formula):
    found = size_of(parse(formula), {"q": Size(1, 1)})
    written = sympy.parse_expr(formula, {"q": q})
    first, second = sympy.diff(written, q), sympy.diff(written, q, 2)
    # SymPy writes a quotient as a product with a power, and drops what is zero or one: a factor in each direction.
    assert found.value / 3 <= nodes(written) <= 3 * found.value
    assert nodes(first) <= 4 * found.first
    assert nodes(second) <= 6 * found.second + 1
    assert found.second <= 10 * nodes(second)


def test_what_does_not_move_has_no_derivative():
    assert size_of(parse("l*sin(m)**2 + 3"), {"q": Size(1, 1)}) == Size(8)
    assert size_of(parse("dot(q)"), {}) == Size(1, 1)


def test_a_long_product_grows_with_the_cube_of_its_length():
    def second(k):
        return size_of(parse("*".join(["sin(q)"] * k)), {"q": Size(1, 1)}).second

    assert second(80) / second(40) == pytest.approx(8, rel=0.1)  # the cube, and lower powers of the length


def test_definitions_count_where_they_are_used(make_model):
    def second(definitions, angle):
        model = make_model(
            "q1 q2",
            parameters={"l": "1 m", "m": "1 kg", "g": "9.81 m/s^2"},
            definitions=definitions,
            mechanism={
                "kinetic_energy": "0.5*m*l**2*(dot(q1)**2 + dot(q2)**2)",
                "potential_energy": f"m*g*l*sin({angle})*cos({angle})",
            },
            constraints={"c": "l*q2"},
            guess={"q1": 0.1, "q2": 0},
        )
        return second_derivatives(model.spec)

    assert second({"a": "q1**2 + q2"}, "a") == second({"b": "0*q1"}, "(q1**2 + q2)")


def test_every_shipped_model_but_the_largest_is_compared(model):
    report, symbolic = check_model(model)
    robot = isinstance(model.spec.mechanism, Robot)  # which has two derivations without SymPy
    compared = model.name != "spatial_6r_plane" and not robot
    assert (symbolic is not None) == compared
    assert worth_comparing(make_subject(model.spec)) == compared
    words = "M and theta by recursion" if robot else "CasADi against SymPy" if compared else "not compared"
    assert report.results[-1].detail.startswith(words)
