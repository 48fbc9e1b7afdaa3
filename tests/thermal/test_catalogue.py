"""The tables of materials, parts and contacts: each row against the numbers of its source, and rows that files add."""

import math
from dataclasses import replace

import jsonschema
import pytest
from ruamel.yaml import YAML

from firmtouch.errors import InputError, ModelFileError
from firmtouch.thermal.sensorfile import catalogue_schema
from firmtouch.thermal.tables import heat_capacity, parse_catalogue, read_catalogue
from firmtouch.thermal.tables.catalogue import SHIPPED
from firmtouch.thermal.tables.rows import Dissipation, TimeConstant

CATALOGUE = read_catalogue()
MATERIALS = CATALOGUE.materials
PARTS = CATALOGUE.parts

# alpha in m^2/s and e in W s^(1/2)/(m^2 K), as published beside k, rho and c, which are entered apart from them.
PUBLISHED = {
    "eps_foam": (9.0e-7, 37), "cork": (1.8e-7, 92), "foam_backing": (1.28e-7, 140), "parylene_c": (9.2e-8, 278),
    "softwood": (1.7e-7, 291), "hardwood": (1.8e-7, 380), "kapton": (7.75e-8, 431), "pdms": (1.14e-7, 475),
    "abs": (1.2e-7, 514), "pmma": (1.1e-7, 574), "ptfe": (1.1e-7, 755), "fr4": (1.5e-7, 781), "skin": (9.9e-8, 1176),
    "water": (1.45e-7, 1589), "glass": (7.5e-7, 1620), "thermal_silicone": (6.0e-7, 1936), "ntc_oxide": (6.7e-7, 3062),
    "steel_304": (3.95e-6, 7493), "alumina": (9.7e-6, 9626), "steel_1010": (1.8e-5, 14360), "silicon": (8.9e-5, 15669),
    "brass": (3.4e-5, 18883), "aluminium": (9.7e-5, 24047), "copper": (1.17e-4, 37137),
}  # fmt: skip

# Heat capacities in mJ/K as published, or computed apart from these tables from data sheets.
CAPACITIES = {
    "semitec_103kt1005t": (1.54, "delta tau"), "semitec_103kt1608t": (4.5, "delta tau"), "semitec_103jt": (3.5, "delta tau"),
    "semitec_104jt": (3.5, "delta tau"), "vishay_ntcs0402": (8, "delta tau"), "vishay_ntcs0603": (18, "delta tau"),
    "vishay_ntcs0805": (35, "delta tau"), "tdk_b574": (35, "published"), "tdk_b57560g": (20, "published"),
    "tdk_b57885s": (40, "published"), "murata_ncp03wf104": (0.20, "volume"), "amphenol_b05": (0.004, "volume"),
    "amphenol_b14": (0.09, "volume"), "ist_p0k1_161": (1.5, "volume"),
}  # fmt: skip


class TestMaterials:
    @pytest.mark.parametrize("name", PUBLISHED)
    def test_diffusivity_and_effusivity_are_the_published_ones(self, name):
        alpha, e = PUBLISHED[name]
        assert MATERIALS[name].effusivity == pytest.approx(e, abs=0.5)  # given as whole numbers
        assert MATERIALS[name].alpha == pytest.approx(
            alpha, rel=0.03
        )  # two digits: half of the last one is 3 % of 1.7e-7

    @pytest.mark.parametrize("each", MATERIALS.values(), ids=lambda each: each.name)
    def test_alpha_e_and_k_belong_together(self, each):
        assert each.effusivity * math.sqrt(each.alpha) == pytest.approx(each.conductivity, rel=1e-14)
        assert each.volumetric_capacity * each.alpha == pytest.approx(each.conductivity, rel=1e-14)

    def test_the_range_of_objects_is_three_decades_around_skin(self):
        ends = MATERIALS["eps_foam"].effusivity, MATERIALS["copper"].effusivity
        assert math.log10(ends[1] / ends[0]) == pytest.approx(3.00, abs=0.005)
        assert math.sqrt(ends[0] * ends[1]) == pytest.approx(MATERIALS["skin"].effusivity, rel=0.01)


@pytest.mark.parametrize("table", ["materials", "parts", "contacts"])
def test_every_row_has_a_marked_source_and_a_tolerance(table):
    rows = getattr(CATALOGUE, table)
    assert len(rows) >= 4
    for name, row in rows.items():
        assert row.name == name
        assert row.title
        assert any(mark in row.source for mark in ("[S]", "[M]", "[C]")), name
        assert 0 < row.tolerance <= 1, name


@pytest.mark.parametrize("name", SHIPPED)
def test_the_schema_accepts_the_shipped_tables(name):
    from importlib import resources

    text = resources.files("firmtouch.thermal.tables").joinpath(name).read_text(encoding="utf-8")
    validator = jsonschema.Draft202012Validator(catalogue_schema())
    validator.check_schema(validator.schema)
    validator.validate(YAML(typ="safe", pure=True).load(text))


def test_contacts_have_the_published_conductances():
    usual = {name: each.conductance for name, each in CATALOGUE.contacts.items()}
    assert usual == {"rough": 1e3, "finger": 3e3, "smooth": 1e4, "gel": 3e4}
    assert all(each.low < each.conductance < each.high for each in CATALOGUE.contacts.values())


class TestCapacities:
    @pytest.mark.parametrize("name", CAPACITIES)
    def test_they_are_the_published_ones(self, name):
        value, basis = CAPACITIES[name]
        found = PARTS[name].capacity
        assert found.basis == basis
        assert found.value * 1e3 == pytest.approx(value, rel=0.02)  # three digits at most, of which 1.5 is 1.48

    @pytest.mark.parametrize("name", ["tdk_b574", "tdk_b57560g", "tdk_b57885s"])
    def test_what_is_published_is_delta_tau(self, name):
        ways = PARTS[name].capacity.ways
        assert ways["delta tau"] == pytest.approx(ways["published"], rel=0.03)  # as found of TDK's data sheets

    def test_a_chip_that_claims_nine_times_what_its_mass_holds_is_doubted(self):
        found = PARTS["vishay_ntcs0402"].capacity
        assert found.ways["delta tau"] / found.ways["mass"] == pytest.approx(9, abs=0.2)
        assert found.warning == "8 mJ/K (delta tau) is 8.9 times the 0.9 mJ/K of its mass of ntc_oxide"

    def test_who_agrees_with_its_body_within_two_is_not_doubted(self):
        assert PARTS["semitec_103kt1608t"].capacity.warning == ""
        assert PARTS["semitec_103kt1005t"].capacity.ways["volume"] == pytest.approx(1.125e-3)

    @pytest.mark.parametrize("name", ["vishay_ntcle413", "semitec_ft_r"])
    def test_there_is_none_from_two_media_or_from_nothing(self, name):
        assert PARTS[name].capacity is None

    @pytest.mark.parametrize("name", ["wavelength_tcs10k5", "amwei_amf58b"])
    def test_an_unnamed_medium_and_bounds_leave_the_volume_alone(self, name):
        assert list(PARTS[name].capacity.ways) == ["volume"]

    @pytest.mark.parametrize(
        ("of_delta", "of_tau", "holds"),
        [
            ({"medium": "air"}, {"medium": "air"}, True),
            ({"medium": "oil", "mounting": "pcb"}, {"medium": "oil", "mounting": "pcb"}, True),
            ({"medium": "air"}, {"medium": "oil"}, False),
            ({"medium": "air"}, {}, False),
            ({}, {}, False),
            ({"medium": "air"}, {"medium": "air", "mounting": "pcb"}, False),
            ({"medium": "air", "bound": "at_least"}, {"medium": "air"}, False),
            ({"medium": "air"}, {"medium": "air", "bound": "at_most"}, False),
        ],
    )
    def test_delta_tau_needs_one_known_medium_and_mounting(self, of_delta, of_tau, holds):
        delta, tau = Dissipation(value="2 mW/K", **of_delta), TimeConstant(value="3 s", **of_tau)
        found = heat_capacity(MATERIALS["ntc_oxide"], delta=delta, tau=tau)
        assert (found is not None) == holds
        assert found is None or found.value == pytest.approx(6e-3)

    @pytest.mark.parametrize(("factor", "doubted"), [(1.99, False), (2.01, True), (0.51, False), (0.49, True)])
    def test_a_factor_of_two_is_the_limit(self, factor, doubted):
        body = MATERIALS["alumina"]
        found = heat_capacity(body, published=factor * 2e-6 * body.heat_capacity, mass=2e-6)
        assert bool(found.warning) == doubted

    def test_volumes_of_a_bead_a_rod_and_a_box(self):
        assert PARTS["amphenol_b10"].volume == pytest.approx(4 / 3 * math.pi * 0.127e-3**3)
        assert PARTS["wavelength_tcs10k5"].volume == pytest.approx(math.pi * 0.25e-3**2 * 3e-3)
        assert PARTS["ist_p0k1_161"].volume == pytest.approx(0.48e-9)
        assert PARTS["amphenol_b10"].footprint == pytest.approx(math.pi * 0.127e-3**2)
        assert PARTS["wavelength_tcs10k5"].footprint == pytest.approx(1.5e-6)


def test_a_family_has_the_least_and_the_most_and_one_part_the_same_twice():
    assert PARTS["tdk_b57885s"].resistance == (2.1e3, 30e3)
    assert PARTS["semitec_103jt"].resistance == (1e4, 1e4)
    assert PARTS["amwei_amf58b"].resistance_at == pytest.approx(373.15)
    assert PARTS["ist_p0k1_161"].resistance_at == pytest.approx(273.15)
    assert PARTS["semitec_103kt1005t"].B_between == pytest.approx((298.15, 358.15))


GEL = "{k: 0.2 W/m/K, rho: 1000 kg/m^3, c: 2000 J/kg/K, tolerance: 20 %, source: measured"
CHIP = "kind: ntc, tolerance: 20 %, source: data sheet"


def added(text):
    return parse_catalogue(text.encode(), CATALOGUE, file="mine.yaml")


class TestRowsOfAFile:
    def test_they_are_added(self, tmp_path):
        (tmp_path / "one.yaml").write_text(f"materials: {{my_gel: {GEL}}}}}\n")
        (tmp_path / "two.yaml").write_text(f"parts: {{chip: {{{CHIP}, mass: 1 mg, body: my_gel}}}}\n")
        found = read_catalogue(tmp_path / "one.yaml", tmp_path / "two.yaml")
        assert found.materials["my_gel"].effusivity == pytest.approx(math.sqrt(0.2 * 1000 * 2000))
        assert found.parts["chip"].capacity.value == pytest.approx(2e-3)
        assert {**found.materials} == {**MATERIALS, "my_gel": found.materials["my_gel"]}
        assert "my_gel" not in read_catalogue().materials

    def test_a_part_may_be_made_of_a_material_of_its_own_file(self):
        found = added(f"materials: {{my_gel: {GEL}}}}}\nparts: {{chip: {{{CHIP}, mass: 1 mg, body: my_gel}}}}\n")
        assert found.parts["chip"].capacity.value == pytest.approx(2e-3)

    def test_one_takes_the_place_of_another_only_on_purpose(self):
        found = added(f"materials: {{pdms: {GEL}, overrides: true}}}}\n")
        assert found.materials["pdms"] == replace(
            MATERIALS["pdms"], title="pdms", conductivity=0.2, density=1000, heat_capacity=2000, source="measured"
        )

    def test_a_file_that_does_not_exist(self, tmp_path):
        with pytest.raises(InputError, match="cannot be read"):
            read_catalogue(tmp_path / "none.yaml")

    @pytest.mark.parametrize(
        ("text", "told"),
        [
            ("", "1:1: the file is empty; rows stand under `materials:`"),
            (f"materials: {{pdms: {GEL}}}}}", "1:13: `pdms` is in the table already; choose another name, or write `overrides: true`"),
            (f"materials: {{pdmss: {GEL}, overrides: true}}}}", "1:13: `pdmss` overrides nothing: there is no such row; did you mean `pdms`?"),
            ("materials: {a: {k: 0.2 W/m/K, rho: 1, c: 1000, tolerance: 0.1}}", "1:13: `source` is missing here"),
            (f"materials: {{a: {GEL}, kk: 1}}}}", "unknown key `kk`"),
            (f"materials: {{a: {GEL.replace('0.2 W', '-0.2 W')}}}}}", "1:20: `-0.2 W/m/K` is out of range; it must be positive"),
            (f"materials: {{a: {GEL.replace('W/m/K', 'W/m')}}}}}", "1:20: `0.2 W/m` is in kg m s^-3, but W/m/K was expected"),
            (f"materials: {{a: {GEL.replace('20 %', '120 %')}}}}}", "`120 %` is out of range; it must lie between 0 and 1"),
            (f"parts: {{p: {{{CHIP}, body: ntc_oxid}}}}", "`ntc_oxid` is no material"),
            (f"parts: {{p: {{{CHIP}, body: ntc_oxid}}}}", "did you mean `ntc_oxide`?"),
            (f"parts: {{p: {{{CHIP}, size: [1 mm, 1 mm]}}}}", "three lengths were expected"),
            (f"parts: {{p: {{{CHIP}, size: [1 mm, 1 mm, 0 mm]}}}}", "`0 mm` is out of range; it must be positive"),
            (f"parts: {{p: {{{CHIP}, length: 1 mm}}}}", "a rod's `length` needs its `diameter`"),
            (f"parts: {{p: {{{CHIP}, coefficient: 1 %/K}}}}", "`coefficient` does not go with the kind `ntc`"),
            (f"parts: {{p: {{{CHIP}, dissipation: 1 mW/K}}}}", "a mapping `name: value` was expected, not `1 mW/K`"),
            (f"parts: {{p: {{{CHIP}, resistance: [3 ohm, 2 ohm]}}}}", "`[3 ohm, 2 ohm]` holds nothing"),
            (f"parts: {{p: {{{CHIP}, resistance_at: 25}}}}", "`25` may be in degC or in K; write `37 degC` or `310 K`"),
            (f"parts: {{p: {{{CHIP}, resistance_at: 900 degC}}}}", "`900 degC` is out of range"),
            ("contacts: {c: {conductance: 0, low: 1, high: 2, tolerance: 0.1, source: x}}", "1:29: a conductance of zero lets no heat through"),
            ("contacts: {c: {conductance: 5, low: 1, high: 2, tolerance: 0.1, source: x}}", "`low`, `conductance` and `high` must not decrease"),
            ("schema: firmtouch.sensor/1\nmaterials: {}", "1:9: `firmtouch.sensor/1` is not possible here"),
        ],
    )  # fmt: skip
    def test_mistakes_are_told_at_their_places(self, text, told):
        with pytest.raises(ModelFileError) as error:
            added(text)
        assert str(error.value).startswith("mine.yaml:")
        assert told in str(error.value)
        assert len(error.value.diagnostics) == 1
