"""The report's certificate: `Certified` only if every claim is proven, and bounds that are rounded to the safe side."""

import math
from dataclasses import replace
from decimal import Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmtouch.certificate.certificate import Certificate
from firmtouch.certificate.decision import Verdict
from firmtouch.report import design_document, verdict
from firmtouch.report.contents import certificate, head
from firmtouch.report.document import Callout, Paragraph, Table
from firmtouch.report.numbers import bound

SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")


def plain(line) -> str:
    return "".join(
        each if isinstance(each, str) else getattr(each, "text", getattr(each, "source", "")) for each in line
    )


def certificate_section(design):
    return certificate.section(design)


def table_of(section):
    (found,) = [each for each in section.blocks if isinstance(each, Table)]
    return found


def spoilt(design, i, to):
    """Let one claim end otherwise."""
    claims = list(design.certificate.claims)
    claims[i] = replace(claims[i], verdict=to, figure=math.inf)
    return replace(design, certificate=Certificate(design.certificate.subject, tuple(claims)))


@pytest.fixture(scope="module")
def pendulum(shipped_report):
    return shipped_report("pendulum_rod").design


@pytest.fixture(params=["pendulum_rod", "planar_3r_wall"])
def some_report(request, shipped_report):
    return shipped_report(request.param)


def head_mood(design):
    return next(each for each in head.section(design).blocks if isinstance(each, Callout)).mood


def test_a_proven_design_is_called_certified(pendulum):
    assert pendulum.certificate.certified
    assert verdict(pendulum).startswith("Certified: ")
    assert head_mood(pendulum) == "good"
    assert certificate_section(pendulum) in design_document(pendulum).sections
    section = certificate_section(pendulum)
    count = len(pendulum.certificate.claims)
    assert plain(section.blocks[0].line).startswith(f"All {count} claims are proven")
    assert len(table_of(section).rows) == count


@pytest.mark.parametrize("to", [Verdict.UNDECIDED, Verdict.REFUTED])
def test_the_head_is_no_good_news_then(pendulum, to):
    for i in (0, len(pendulum.certificate.claims) - 1):
        assert head_mood(spoilt(pendulum, i, to)) == "warning"


@pytest.mark.parametrize("to", [Verdict.UNDECIDED, Verdict.REFUTED])
def test_one_claim_that_is_not_proven_changes_every_word_of_it(pendulum, to):
    count = len(pendulum.certificate.claims)
    for i, claim in enumerate(pendulum.certificate.claims):
        design = spoilt(pendulum, i, to)
        assert verdict(design).startswith(f"Not certified (1 of {count} claims are not proven): ")
        section = certificate_section(design)
        assert plain(section.blocks[0].line).startswith(f"Of {count} claims {count - 1} are proven, and 1 not")
        row = table_of(section).rows[i]
        assert plain(row[2]) == to.value, claim.name
        others = [plain(each[2]) for k, each in enumerate(table_of(section).rows) if k != i]
        assert not {"undecided", "refuted"} & set(others)


def test_the_certificate_tells_how_to_prove_it_again(some_report):
    section = certificate_section(some_report.design)
    paragraphs = [plain(each.line) for each in section.blocks if isinstance(each, Paragraph)]
    assert f"firmtouch verify certificate.json --model {some_report.design.model.name}.yaml" in paragraphs[-1]


def test_bounds_in_the_table_are_on_the_safe_side(some_report):
    claims, rows = some_report.design.certificate.claims, table_of(certificate_section(some_report.design)).rows
    for claim, row in zip(claims, rows, strict=True):
        sign, _, rest = plain(row[2]).partition(" ")
        told = read(rest.split(" ")[0])
        assert sign == (claim.relation if claim.figure else "=")
        assert told <= Decimal(claim.figure) if claim.relation == ">" else told >= Decimal(claim.figure)
        assert claim.unit in plain(row[2])


def test_who_the_claims_are_for_is_told_where_plants_vary(arm_in_region, pendulum):
    region = arm_in_region({"decay": 4, "damping": 0.6, "bandwidth": 30})
    headings = [plain(each) for each in table_of(certificate_section(region.design)).headings]
    assert "for" in headings
    scopes = {plain(row[headings.index("for")]) for row in table_of(certificate_section(region.design)).rows}
    assert scopes == {"nominal plant", "vertices", "all plants"}
    assert "for" not in [plain(each) for each in table_of(certificate_section(pendulum)).headings]


def read(text: str) -> Decimal:
    """Read a number as the report writes it, exactly."""
    mantissa, _, power = text.replace("−", "-").partition("×10")
    return Decimal(mantissa).scaleb(int(power.translate(SUPERSCRIPTS)) if power else 0)


numbers = st.floats(allow_nan=False, allow_infinity=False).filter(lambda x: x == 0 or abs(x) > 1e-290)


@given(value=numbers, upwards=st.booleans(), figures=st.integers(2, 8))
def test_a_bound_is_never_rounded_to_the_wrong_side(value, upwards, figures):
    """What is written is on the safe side of the exact binary64 number, and near it."""
    text = bound(value, upwards=upwards, figures=figures)
    if text in ("∞", "−∞"):
        assert (text == "∞") == upwards
        return
    told, exact = read(text), Decimal(value)
    assert told >= exact if upwards else told <= exact
    assert abs(told - exact) <= abs(exact) * Decimal(10) ** (1 - figures)


@given(value=st.integers(-99999, 99999), power=st.integers(-12, 12), upwards=st.booleans())
def test_a_bound_that_needs_no_more_figures_is_left_as_it_is_or_moved_by_one_of_them(value, power, upwards):
    """0.1 is no binary64 number: upwards it is 0.10001, downwards 0.1."""
    number = float(Decimal(value).scaleb(power))
    told = read(bound(number, upwards=upwards))
    assert abs(told - Decimal(number)) <= abs(Decimal(number)) * Decimal("1e-4")


@pytest.mark.parametrize(
    ("value", "upwards", "text"),
    [
        (0.0, True, "0"),
        (-0.0, False, "0"),
        (1.0, True, "1"),
        (1.0, False, "1"),
        (2 / 3, True, "0.66667"),
        (2 / 3, False, "0.66666"),
        (-2 / 3, True, "−0.66666"),
        (-2 / 3, False, "−0.66667"),
        (99999.6, True, "1×10⁵"),
        (99999.6, False, "99999"),
        (1e-300, True, "1.0001×10⁻³⁰⁰"),
        (math.inf, True, "∞"),
    ],
)
def test_bounds_that_one_can_check_by_hand(value, upwards, text):
    assert bound(value, upwards=upwards) == text
