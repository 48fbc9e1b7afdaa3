"""Units at the file's boundary: what they are in SI, and what is no unit."""

import math
import time
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmtouch.modelfile.units import DIMENSIONLESS, Dimension, UnitError, parse_unit, split_quantity

METRE, SECOND, KILOGRAM = (parse_unit(each).dimension for each in ("m", "s", "kg"))
NEWTON = KILOGRAM * METRE / SECOND ** Fraction(2)


@pytest.mark.parametrize(
    ("text", "factor", "dimension"),
    [
        ("m", 1, METRE),
        ("mm", 1e-3, METRE),
        ("kg*m^2", 1, KILOGRAM * METRE * METRE),
        ("kg*m**2", 1, KILOGRAM * METRE * METRE),
        ("kg m2", 1, KILOGRAM * METRE * METRE),
        ("kg · m^2", 1, KILOGRAM * METRE * METRE),
        ("g*cm^2", 1e-7, KILOGRAM * METRE * METRE),
        ("N m/rad", 1, NEWTON * METRE),
        ("N*m", 1, NEWTON * METRE),
        ("N/m", 1, NEWTON / METRE),
        ("kN", 1e3, NEWTON),
        ("m/s^2", 1, METRE / SECOND / SECOND),
        ("m s^-2", 1, METRE / SECOND / SECOND),
        ("m/s/s", 1, METRE / SECOND / SECOND),
        ("1/s", 1, DIMENSIONLESS / SECOND),
        ("/s", 1, DIMENSIONLESS / SECOND),
        ("Hz", 1, DIMENSIONLESS / SECOND),
        ("rad", 1, DIMENSIONLESS),
        ("deg", math.pi / 180, DIMENSIONLESS),
        ("°", math.pi / 180, DIMENSIONLESS),
        ("%", 0.01, DIMENSIONLESS),
        ("1", 1, DIMENSIONLESS),
        ("", 1, DIMENSIONLESS),
        ("  ", 1, DIMENSIONLESS),
        ("lbf", 4.4482216152605, NEWTON),
        ("inch", 0.0254, METRE),
        ("µm", 1e-6, METRE),
        ("m^12", 1, METRE ** Fraction(12)),
    ],
)
def test_a_unit_is_a_factor_and_a_dimension(text, factor, dimension):
    unit = parse_unit(text)
    assert unit.factor == pytest.approx(factor, rel=1e-14)  # definitions, and a handful of roundings
    assert unit.dimension == dimension


@pytest.mark.parametrize(
    ("text", "offset", "words"),
    [
        ("metres_", 0, "`metres_` is no unit"),
        ("newtn", 0, "`newtn` is no unit; did you mean `newton`?"),
        ("kg*mtr^2", 3, "`mtr` is no unit"),
        ("degC", 0, "`degC` is no multiple of an SI unit"),
        ("kg*degF", 3, "`degF` is no multiple of an SI unit"),
        ("dBm", 0, "no multiple of an SI unit"),
        ("pixel", 0, "no unit of mechanics or heat"),
        ("m*", 1, "`*` is no unit"),
        ("m**0.5", 4, "`.5` is no unit"),
        ("m^(2)", 1, "`^(2)` is no unit"),
        ("m^13", 2, "a power of 13; at most 12"),
        ("m^-99", 2, "a power of -99"),
        ("m//s", 1, "`//s` is no unit"),
        ("kg2m", 3, "`m` is no unit"),
        ("**9**9 m", 0, "`**9**9 m` is no unit"),
        ("__class__", 0, "`__class__` is no unit"),
        ("m.real", 1, "`.real` is no unit"),
        ("m\x1b[31m", 1, "\N{REPLACEMENT CHARACTER}[31m"),
        ("Ypc^9", 0, "`Ypc^9` has no finite factor to SI"),
        ("Ypc^-9", 0, "has no finite factor to SI"),
        ("m" * 61, 0, "a unit of 61 characters; at most 60"),
    ],
)
def test_what_is_no_unit_is_refused_at_its_place(text, offset, words):
    with pytest.raises(UnitError) as caught:
        parse_unit(text)
    assert words in str(caught.value)
    assert caught.value.offset == offset


def test_a_tower_of_powers_is_refused_at_once():
    parse_unit("m")  # the first unit loads the registry
    start = time.process_time()
    with pytest.raises(UnitError):
        parse_unit("9**9**9 m")
    assert split_quantity("9**9**9 m") == (9.0, "**9**9 m", 1)
    assert time.process_time() - start < 0.5  # some microseconds; evaluating it would never end


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0.6 m", (0.6, " m", 3)),
        ("-75 deg", (-75.0, " deg", 3)),
        ("40N", (40.0, "N", 2)),
        (" +1.5e-3 m", (1.5e-3, " m", 8)),
        (".5", (0.5, "", 2)),
        ("5.", (5.0, "", 2)),
        ("2 /s", (2.0, " /s", 1)),
        ("m", None),
        ("", None),
        ("nan m", None),
        ("inf", None),
        ("--1 m", None),
        ("one m", None),
        ("١ m", None),
    ],
)
def test_a_quantity_is_a_number_and_the_text_of_a_unit(text, expected):
    assert split_quantity(text) == expected


def test_dimensions_are_written_in_si_or_as_the_usual_unit():
    written = {
        "N*m": "J",
        "N": "N",
        "kg*m^2": "kg*m^2",
        "m^3": "m^3",
        "1": "1",
        "kg/s": "kg s^-1",
        "1/s": "1/s",
        "A s": "s A",
    }
    assert {unit: str(parse_unit(unit).dimension) for unit in written} == written
    assert str(METRE ** Fraction(1, 2)) == "m^1/2"


EXPONENTS = st.tuples(*[st.integers(-3, 3)] * 7)


@given(EXPONENTS, EXPONENTS, st.fractions(-4, 4, max_denominator=6))
def test_dimensions_are_a_vector_space_over_the_fractions(a, b, power):
    A, B = Dimension(a), Dimension(b)
    assert A * B == B * A
    assert A / B * B == A
    assert (A * B) ** power == A**power * B**power
    assert A ** Fraction(1) == A
    assert hash(A ** Fraction(2)) == hash(A * A)


@given(st.text(max_size=20))
def test_any_text_is_a_unit_or_refused_and_nothing_else(text):
    try:
        unit = parse_unit(text)
    except UnitError as error:
        assert str(error)
        assert 0 <= error.offset <= len(text)
    else:
        assert 0 < unit.factor < math.inf
