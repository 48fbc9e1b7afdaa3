"""Numbers as readers see them: four figures, true minus signs, powers of ten in superscripts."""

import math

import numpy as np
import pytest

from firmtouch.report.numbers import complex_number, entries, matrix, number, unit, vector


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (1.0, "1"),
        (3.14159265, "3.142"),
        (148.25, "148.2"),  # half to even, as binary64 holds it exactly
        (1234.5678, "1235"),
        (98765.4, "98765"),
        (0.62, "0.62"),
        (0.0012345, "0.001234"),  # 0.0012345 is a little less in binary64
        (0.00012345678, "1.235×10⁻⁴"),
        (123456.0, "1.235×10⁵"),
        (1e21, "1×10²¹"),
        (-6.0, "−6"),
        (-2.5e-12, "−2.5×10⁻¹²"),
    ],
)
def test_a_number_has_four_figures_and_no_trailing_zeros(value, text):
    assert number(value) == text


@pytest.mark.parametrize(
    ("value", "figures", "text"),
    [(math.pi, 2, "3.1"), (math.pi, 6, "3.14159"), (1234.5, 2, "1234"), (1e-7 * math.pi, 3, "3.14×10⁻⁷")],
)
def test_the_figures_can_be_chosen_but_digits_before_the_point_are_never_dropped(value, figures, text):
    assert number(value, figures) == text


@pytest.mark.parametrize(
    ("value", "text"), [(9.9996, "10"), (-9.9996, "−10"), (999.96, "1000"), (0.99996, "1"), (9.9996e6, "1×10⁷")]
)
def test_rounding_up_to_a_power_of_ten_leaves_no_stray_figures(value, text):
    assert number(value) == text


def test_a_negative_zero_is_zero():
    assert number(-0.0) == "0"
    assert vector([-0.0, 1.0]) == "(0, 1)"
    assert complex_number(complex(-2.0, -0.0)) == "−2"


def test_what_is_no_finite_number_says_so():
    assert number(math.inf) == "∞"
    assert number(-math.inf) == "−∞"
    assert number(math.nan) == "not a number"


@pytest.mark.parametrize("value", [5e-324, -2.2e-308, 1.7976931348623157e308])
def test_the_ends_of_the_range_of_floats_are_written(value):
    assert "×10" in number(value)


@pytest.mark.parametrize("exponent", range(-30, 31))
@pytest.mark.parametrize("lead", [1.0, 1.2344999, 9.9994, 9.99951, 5.0])
def test_a_written_number_reads_back_to_four_figures(lead, exponent):
    value = -lead * 10.0**exponent
    mantissa, _, power = number(value).replace("−", "-").partition("×10")
    superscripts = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
    back = float(mantissa) * 10.0 ** int(power.translate(superscripts) or 0)
    assert back == pytest.approx(value, rel=5.001e-4)  # half a unit of the fourth figure of 1.000, and rounding


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (-4 + 2j, "−4 + 2j"),
        (-4 - 2j, "−4 − 2j"),
        (-0.5 + 12.3456j, "−0.5 + 12.35j"),
        (-6 + 1e-15j, "−6"),
        (-6 - 1e-15j, "−6"),
        (0j, "0"),
    ],
)
def test_a_complex_number_shows_its_imaginary_part_unless_it_is_rounding(value, text):
    assert complex_number(value) == text


def test_a_matrix_keeps_its_shape_and_a_vector_stands_as_a_column():
    assert matrix(np.array([[1.0, -2.0], [0.25, 1e6]])) == (("1", "−2"), ("0.25", "1×10⁶"))
    assert matrix(np.array([1.0, 2.0])) == (("1",), ("2",))
    assert matrix(np.array([[3.0]])) == (("3",),)


def test_entries_of_rounding_size_are_shown_as_zero_relative_to_their_matrix():
    assert matrix(np.array([[40.0, 1e-14], [-3e-15, 20.0]])) == (("40", "0"), ("0", "20"))
    assert matrix(np.array([[1e-14, -3e-15]])) == (("1×10⁻¹⁴", "−3×10⁻¹⁵"),)  # small as a whole is no rounding
    assert matrix(np.zeros((2, 2))) == (("0", "0"), ("0", "0"))
    assert vector([1.0, 1e-13]) == "(1, 0)"


@pytest.mark.parametrize(
    ("text", "written"),
    [("kg*m^2", "kg m²"), ("m/s^2", "m/s²"), ("kg*m**2", "kg m²"), ("s^-1", "s⁻¹"), ("rad", "rad"), ("1", "1")],
)
def test_a_unit_is_written_with_spaces_and_superscripts(text, written):
    assert unit(text) == written


def test_rounding_beside_the_largest_of_some_numbers_is_zero():
    assert entries([1.5, -1.2e-17, 1e-3]) == ("1.5", "0", "0.001")
    assert entries([1e-17]) == ("1×10⁻¹⁷",)  # alone, it is a number
    assert entries([]) == ()
