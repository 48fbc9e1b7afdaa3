"""What holds for every stack: passivity, splitting, scaling, limits, energy, and levels that agree with each other."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmtouch.thermal import (
    Adiabatic,
    Air,
    Base,
    Contact,
    ContactEvent,
    Disc,
    Film,
    HalfSpace,
    Layer,
    Material,
    Slab,
    Stack,
    ThermalValueError,
    Touch,
    TwoNode,
    contact_transfer,
    heater_transfer,
    hold_power,
    input_impedance,
    object_impedance,
    step,
)

ROUNDING = 1e-11
"""Some tens of operations in each of tens of elements, on numbers that nearly cancel by three digits."""
T = np.logspace(-5, 0, 11)
EXAMPLES = 40
"""A good half of a second for all; each tests some tens of s."""
ALONG_AXIS = 1j * np.logspace(-3, 8, 60)


def log_floats(low, high):
    return st.floats(math.log(low), math.log(high)).map(math.exp)


MATERIALS = st.builds(Material, st.just("drawn"), log_floats(0.03, 400), log_floats(30, 9000), log_floats(300, 4000))
LAYERS = st.builds(Layer, MATERIALS, log_floats(1e-7, 5e-3))
FILMS, CONTACTS = st.builds(Film, log_floats(0.1, 1e3)), st.builds(Contact, log_floats(1e2, 1e6))
ELEMENTS = st.one_of(LAYERS, FILMS, CONTACTS)
BACKINGS = st.one_of(
    st.builds(HalfSpace, MATERIALS), st.just(Base()), st.just(Adiabatic()), st.builds(Air, log_floats(1, 100))
)
TOUCHED = st.one_of(
    st.builds(HalfSpace, MATERIALS),
    st.builds(Slab, MATERIALS, log_floats(1e-4, 0.1)),
    st.builds(Disc, MATERIALS, log_floats(1e-4, 1e-2)),
)
TOUCHES = st.builds(Touch, TOUCHED, st.one_of(log_floats(1e2, 1e5), st.just(math.inf)))


@st.composite
def stacks(draw, elements=ELEMENTS, backings=BACKINGS):
    drawn = tuple(draw(st.lists(elements, min_size=1, max_size=5)))
    return Stack(drawn, sensed=draw(st.integers(0, len(drawn))), backing=draw(backings))


@settings(max_examples=EXAMPLES)
@given(stacks(), TOUCHES)
def test_passive_on_the_whole_axis(stack, touch):
    """No network of resistances and capacities gives power: Re Z >= 0, of a fingertip, of an object, and at a heater."""
    for Z in (
        input_impedance(stack, ALONG_AXIS),
        object_impedance(touch.object, ALONG_AXIS),
        heater_transfer(stack, touch, ALONG_AXIS),
    ):
        finite = Z[~np.isinf(Z)]  # nothing behind a contact but an insulated face: no flux ever
        assert (finite.real >= -1e-13 * np.abs(finite)).all()  # a NaN is not


@settings(max_examples=EXAMPLES)
@given(stacks(), TOUCHES, st.floats(-300, 300), st.floats(-3.1, 3.1))
def test_nothing_overflows_at_any_s(stack, touch, decades, angle):
    s = np.array(10**decades * np.exp(1j * angle))
    with np.errstate(all="raise", under="ignore"):
        found = contact_transfer(stack, touch, s)
        heated = heater_transfer(stack, touch, s)
    assert all(np.isfinite(each) for each in (found.sensed, found.face, found.flux, heated))


@settings(max_examples=EXAMPLES)
@given(stacks(elements=LAYERS), TOUCHES, st.floats(0.01, 0.99), st.data())
def test_a_layer_in_two_is_the_same_layer(stack, touch, part, data):
    i = data.draw(st.integers(0, len(stack.elements) - 1))
    cut = stack.elements[i]
    halves = (replace(cut, thickness=cut.thickness * part), replace(cut, thickness=cut.thickness * (1 - part)))
    elements = stack.elements[:i] + halves + stack.elements[i + 1 :]
    other = replace(stack, elements=elements, sensed=stack.sensed + (stack.sensed > i))
    for whole, cut_up in zip(both_ways(stack, touch), both_ways(other, touch), strict=True):
        assert cut_up == pytest.approx(whole, abs=ROUNDING * np.abs(whole).max())


def both_ways(stack, touch):
    s = np.concatenate([ALONG_AXIS, 1 / T])
    return contact_transfer(stack, touch, s).sensed, heater_transfer(stack, touch, s, heater=0)


@settings(max_examples=EXAMPLES)
@given(stacks(), TOUCHES, MATERIALS, st.data())
def test_a_layer_of_no_thickness_is_nothing(stack, touch, material, data):
    i = data.draw(st.integers(0, len(stack.elements)))
    thin = (*stack.elements[:i], Layer(material, 1e-18), *stack.elements[i:])
    other = replace(stack, elements=thin, sensed=stack.sensed + (stack.sensed > i))
    # 1e-18 m resist 3e-17 m2K/W of at least 1e-9 and store 4e-11 J/m2K of at least 1e-1.
    s = 1 / T
    expected = contact_transfer(stack, touch, s).sensed
    assert contact_transfer(other, touch, s).sensed == pytest.approx(expected, rel=1e-6, abs=1e-12)


@settings(max_examples=EXAMPLES)
@given(
    stacks(elements=LAYERS, backings=st.one_of(st.builds(HalfSpace, MATERIALS), st.just(Base()))),
    MATERIALS,
    log_floats(1e2, 1e5),
    log_floats(0.1, 10),
)
def test_scaling_of_all_lengths(stack, touched, h, scale):
    """t -> scale^2 t under L -> scale L and h -> h/scale, exactly where there are no films."""
    grown = replace(stack, elements=tuple(replace(each, thickness=scale * each.thickness) for each in stack.elements))
    small = ContactEvent(stack, Touch(HalfSpace(touched), h), 1.0).temperature(T)
    large = ContactEvent(grown, Touch(HalfSpace(touched), h / scale), 1.0).temperature(scale**2 * T)
    assert large == pytest.approx(small, abs=ROUNDING)


@settings(max_examples=EXAMPLES)
@given(LAYERS, TOUCHES)
def test_reciprocity_and_the_way_through(layer, touch):
    """Heat put in at either of two planes warms the other alike."""
    stack = Stack((Film(10.0), layer, Contact(1e4), Film(3.0)), sensed=3, backing=Air(10.0))
    s = np.concatenate([ALONG_AXIS, 1 / T])
    there = heater_transfer(stack, touch, s, heater=0, plane=3)
    back = heater_transfer(stack, touch, s, heater=3, plane=0)
    assert back == pytest.approx(there, rel=1e-10, abs=1e-14 * np.abs(there).max())


@settings(max_examples=EXAMPLES)
@given(LAYERS, log_floats(1e2, 1e5), MATERIALS)
def test_step_on_an_insulated_slab_only_rises(layer, h, touched):
    t = layer.thickness**2 / layer.material.alpha * np.logspace(-3, 2, 200)
    found = ContactEvent(Stack((layer,), sensed=1, backing=Adiabatic()), Touch(HalfSpace(touched), h), 1.0).temperature(
        t
    )
    assert (np.diff(found) >= -1e-11).all()
    assert found.max() <= 1 + 1e-11


@settings(max_examples=10)
@given(LAYERS, st.floats(1e3, 1e5), MATERIALS)
def test_what_flowed_in_is_stored(layer, h, touched):
    """The integral of q is rho c times that of theta: Gauss's 24 nodes are exact for so smooth a profile."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    edges = np.concatenate([[0], (nodes + 1) / 2, [1]]) * layer.thickness
    parts = tuple(Layer(layer.material, float(each)) for each in np.diff(edges))
    t = np.array([0.3, 3.0]) * layer.thickness**2 / layer.material.alpha
    stack, touch = Stack(parts, sensed=1, backing=Adiabatic()), Touch(HalfSpace(touched), h)
    event = ContactEvent(stack, touch, 1.0)
    profile = np.array([event.temperature(t, plane=i) for i in range(1, 25)])
    stored = layer.material.volumetric_capacity * layer.thickness / 2 * weights @ profile
    entered = step(lambda s: contact_transfer(stack, touch, s).flux / s, t)
    assert entered == pytest.approx(stored, rel=1e-9)


def test_a_better_contact_becomes_a_perfect_one(m, designs):
    """The difference falls as 1/h."""
    thing = HalfSpace(m.glass)
    perfect = ContactEvent(designs.D3, Touch(thing, math.inf), 1.0).temperature(T)
    errors = [np.abs(ContactEvent(designs.D3, Touch(thing, h), 1.0).temperature(T) - perfect).max() for h in (1e8, 1e9)]
    assert errors[0] < 1e-2
    assert errors[1] == pytest.approx(errors[0] / 10, rel=0.02)  # the next order, of 1e-2


def test_a_thick_slab_is_a_half_space_and_a_thin_one_a_capacity(m):
    s = 1 / T
    assert object_impedance(Slab(m.glass, 0.1), s) == pytest.approx(object_impedance(HalfSpace(m.glass), s), rel=1e-12)
    thin = Slab(m.copper, 1e-6)
    assert object_impedance(thin, s) == pytest.approx(1 / (s * m.copper.volumetric_capacity * 1e-6), rel=1e-3)  # gL/3
    with np.errstate(all="raise"):
        assert np.isinf(object_impedance(Slab(m.glass, 0.1), 0.0))  # an insulated body has no steady flux


def test_many_sections_become_the_layer(m):
    """A ladder of n sections of a resistance and two half capacities errs by 1/n^2."""

    def laddered(n):
        R, C = 50e-6 / m.kapton.conductivity / n, m.kapton.volumetric_capacity * 50e-6 / n
        half, section = Film(C / 2), (Contact(1 / R), Film(C))
        return Stack((half, *section * (n - 1), Contact(1 / R), half), sensed=2 * n, backing=Adiabatic())

    touch, t = Touch(HalfSpace(m.glass), 1e4), np.array([3e-3, 1e-2, 1e-1])
    exact = ContactEvent(Stack((Layer(m.kapton, 50e-6),), sensed=1, backing=Adiabatic()), touch, 1.0).temperature(t)
    errors = [np.abs(ContactEvent(laddered(n), touch, 1.0).temperature(t) - exact).max() for n in (10, 20, 40)]
    assert errors[2] < 1e-4
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx([2, 2], abs=0.1)


def test_the_lumped_level_is_the_layered_one_where_layers_are_thin(m):
    """Two films and two contacts are two nodes exactly; thin well conducting layers are them nearly."""
    nodes = TwoNode(C_h=40.0, G_a=20.0, G_ht=3e3, C_t=25.0, G_c=8e3)
    films = Stack((Film(25.0), Contact(3e3), Film(40.0)), sensed=0, backing=Air(20.0))
    touch, t = Touch(Base(), 8e3), np.array([1e-3, 1e-2, 1e-1])
    lumped = nodes.step(t)
    assert ContactEvent(films, touch, 1.0).temperature(t) == pytest.approx(lumped[:, 1, 1], abs=1e-11)
    heated = step(lambda s: heater_transfer(films, touch, s, heater=2), t)
    assert heated == pytest.approx(lumped[:, 1, 0], rel=1e-10)
    copper = m.copper.volumetric_capacity
    layers = Stack(
        (Layer(m.copper, 25 / copper), Contact(3e3), Layer(m.copper, 40 / copper)), sensed=0, backing=Air(20.0)
    )
    # The layers resist h L/k = 2e-4 of the contact; and diffusion across them takes L^2/alpha = 1e-6 s.
    assert ContactEvent(layers, touch, 1.0).temperature(t) == pytest.approx(lumped[:, 1, 1], abs=1e-3)


def test_a_node_on_a_half_space_is_a_film_on_it(m):
    nodes, area = TwoNode(C_h=40e-6, G_a=20e-6, G_ht=3e-3, C_t=25e-6, G_c=0.0), 1e-6
    films = Stack((Film(25.0), Contact(3e3), Film(40.0)), sensed=0, backing=Air(20.0))
    s, touch = np.concatenate([ALONG_AXIS, 1 / T]), Touch(HalfSpace(m.glass), 8e3)
    by_power, by_object = nodes.half_space_transfers(s, material=m.glass, area=area, conductance=8e3)
    assert by_object.thermistor == pytest.approx(contact_transfer(films, touch, s).sensed, rel=1e-11)
    assert area * by_power.heater == pytest.approx(heater_transfer(films, touch, s, heater=2, plane=2), rel=1e-11)


def test_steady_state_is_the_resistances(m):
    """At s = 0 a layer is L/k, and what holds a rise is what leaves on both sides."""
    stack = Stack((Layer(m.kapton, 50e-6), Layer(m.foam, 1e-3)), sensed=1, backing=Base())
    loss = 1 / (1 / 10.0 + 50e-6 / m.kapton.conductivity) + m.foam.conductivity / 1e-3
    assert hold_power(stack, Air(10.0), heater=1, rise=15.0) == pytest.approx(15 * loss, rel=1e-13)


def test_deep_layers_keep_their_magnitude(m):
    """Through 1 mm at 10 kHz remains e^-630: it is told, and not rounded to nothing of the whole."""
    stack = Stack((Layer(m.kapton, 1e-3),), sensed=1, backing=HalfSpace(m.kapton))
    s = 2j * np.pi * 1e4
    expected = np.exp(-1e-3 * np.sqrt(s / m.kapton.alpha))
    found = contact_transfer(stack, Touch(Base(), math.inf), s).sensed
    assert found == pytest.approx(expected, rel=1e-12)
    assert abs(found) < 1e-200


@pytest.mark.parametrize("wrong", [0.0, -1e-6, math.nan, math.inf])
def test_sizes_that_no_thing_has_are_refused(m, wrong):
    for make in (
        lambda: Layer(m.glass, wrong),
        lambda: Film(wrong),
        lambda: Air(wrong),
        lambda: Slab(m.glass, wrong),
        lambda: Material("wrong", 1.0, wrong, 1.0),
    ):
        with pytest.raises(ThermalValueError) as refused:
            make()
        assert refused.value.value is wrong


@pytest.mark.parametrize("wrong", [0.0, -1.0, math.nan])
def test_a_contact_that_conducts_nothing_is_refused(m, wrong):
    for make in (lambda: Contact(wrong), lambda: Touch(HalfSpace(m.glass), wrong)):
        with pytest.raises(ThermalValueError, match=r"contact conductance is .*positive"):
            make()


def test_only_layers_are_thick(m):
    stack = Stack((Layer(m.glass, 1e-3), Film(3.0), Contact(1e4), Layer(m.pdms, 2e-3)), sensed=1, backing=Base())
    assert stack.thickness == pytest.approx(3e-3, rel=1e-15)


def test_planes_that_are_not_there_are_refused(m, designs):
    with pytest.raises(ThermalValueError, match="sensed plane is 4, but must be between 0 and 3"):
        replace(designs.D1, sensed=4)
    with pytest.raises(ThermalValueError, match="heater's plane"):
        heater_transfer(designs.D1, Adiabatic(), 1.0, heater=-1)
