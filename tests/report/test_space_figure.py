"""Pictures in space: seen from where contact and arm can be seen, and words that lie over no link."""

import re
from itertools import pairwise

import numpy as np
import pytest

from firmtouch.mechanics import Scene
from firmtouch.mechanics.scene import Base, ContactForce, Held, Patch, Round
from firmtouch.report.figures import mechanism_picture
from firmtouch.report.figures.canvas import ARM, FORCE
from firmtouch.report.figures.view import View, best_view

SIDES = {
    "table": (0, 0, 1),
    "ceiling": (0, 0, -1),
    "wall ahead": (-1, 0, 0),
    "wall beside": (0, 1, 0),
    "slope": (-0.6, 0.5, 0.6),
}


def sheet(contact, normal, *, bend=0.0, size=0.4, count=9):
    """A piece of surface around a contact, bent towards (bend < 0: away from) its normal."""
    first, second = np.linalg.svd(normal[None, :])[2][1:]
    u, v = np.meshgrid(*[np.linspace(-size / 2, size / 2, count)] * 2, indexing="ij")
    points = contact + u[..., None] * first + v[..., None] * second + bend * (u**2 + v**2)[..., None] * normal
    corners = np.array([contact + 0.1 * (a * first + b * second) for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))])
    return Patch(points, contact, normal, corners)


def reaching(normal, **bent):
    """An arm of four links whose tip touches a surface with this normal, coming from its outer side."""
    normal = np.array(normal, dtype=float) / np.linalg.norm(normal)
    tip = np.array([0.6, 0.15, 0.3])
    line = np.array([[0, 0, 0], [0, 0, 0.35], [0.25, 0.05, 0.65], tip + 0.15 * normal, tip])
    aside = line + np.array([0.0, 0.05, 0.02]) * np.linspace(0, 1, 5)[:, None]
    return Scene(
        3,
        (line,),
        ghosts=((aside,),),
        forces=(ContactForce("table", tip, 40 * normal, 0.0),),
        patches=(sheet(tip, normal, **bent),),
        bases=(Base(np.zeros(3), np.array([0.0, 0.0, 1.0])),),
    )


def holding(push):
    """Two arms with something between their hands, at which they push with this force."""
    left = np.array([[-0.5, 0, 0], [-0.5, 0, 0.4], [-0.35, 0.3, 0.5], [-0.15, 0.35, 0.4]])
    right = left * [-1, 1, 1]
    middle = np.array([0, 0.35, 0.4])
    force = ContactForce("grip", middle, np.array([push, 0.0, 0.0]), 0.0, middle)
    held = Held("grip", np.array([left[-1], right[-1]]), np.array([0.0, 0.0, 1.0]))
    return Scene(3, (left, right), forces=(force,), held=(held,))


def words(svg):
    return [each.strip() for each in re.findall(r"<!--(.*?)-->", svg)]


def place_of(svg, word):
    """The middle of a word in the picture, in points; letters of bold type are 7 points wide."""
    found = re.search(rf"<!-- {re.escape(word)} -->\s*<g[^>]*translate\(([-0-9.]+) ([-0-9.]+)\)", svg)
    return np.array([float(found[1]) + 3.5 * len(word), float(found[2]) - 3.5])


def strokes(svg, colour, width):
    """Lines of a colour and width, each as its points."""
    style = rf"stroke: {colour}; stroke-width: {width}"
    return [
        np.array(re.findall(r"([-0-9.]+) ([-0-9.]+)", path), dtype=float)
        for path in re.findall(rf'<path d="([^"]*)"[^>]*style="[^"]*{style}[;"]', svg)
    ]


def gap(point, line):
    away = []
    for a, b in pairwise(line):
        share = np.clip((point - a) @ (b - a) / max((b - a) @ (b - a), 1e-12), 0, 1)
        away.append(np.linalg.norm(point - a - share * (b - a)))
    return min(away)


class TestTheView:
    @pytest.mark.parametrize("normal", SIDES.values(), ids=list(SIDES))
    def test_it_is_on_the_side_from_which_the_surface_is_touched(self, normal):
        scene = reaching(normal)
        assert scene.patches[0].normal @ best_view(scene).towards > 0.2

    def test_a_hollow_is_looked_into(self):
        scene = reaching((0, 0, 1), bend=2.0)  # its rim rises by 0.16 m where it is 0.2 m away: seen from above alone
        patch = scene.patches[0]
        away = patch.points.reshape(-1, 3) - patch.contact
        towards = best_view(scene).towards
        ahead = away @ towards
        beside = np.linalg.norm(away - np.outer(ahead, towards), axis=1)
        assert not np.any((ahead > 0.05) & (beside < 0.02))

    @pytest.mark.parametrize("side", [(-1, 0, 0), (0, 1, 0), (0, -1, 0), (1, 0, 0)])
    def test_a_contact_on_a_balls_side_is_before_the_ball(self, side):
        scene = reaching(side)
        tip, n = scene.patches[0].contact, scene.patches[0].normal
        ball = Round(tip - 0.2 * n, 0.2)
        assert best_view(Scene(3, scene.lines, forces=scene.forces, rounds=(ball,))).towards @ n > 0.2

    def test_it_projects_without_distortion_across_the_way_to_the_eye(self):
        view = View(40.0, 25.0)
        flat = view.flat(np.eye(3))
        assert flat.T @ flat == pytest.approx(np.eye(2), abs=1e-12)  # a few products of numbers below one
        assert view.flat(view.towards[None, :]) == pytest.approx(np.zeros((1, 2)), abs=1e-12)
        assert view.flat(np.array([[0.0, 0.0, 1.0]]))[0, 1] > 0  # up is up

    def test_what_is_held_is_seen_at_its_length(self):
        scene = holding(30.0)
        assert abs(best_view(scene).towards[0]) < 0.5


class TestThePicture:
    @pytest.mark.parametrize("scene", [reaching(SIDES["table"]), reaching(SIDES["wall ahead"]), holding(30.0)])
    def test_no_word_lies_over_a_link_or_outside(self, scene):
        svg = mechanism_picture(scene)
        force = "40 N" if scene.patches else "30 N"
        x, y, width, height = map(float, re.search(r'viewBox="([^"]+)"', svg)[1].split())
        assert (x, y) == (0, 0)
        links = strokes(svg, ARM, 5)
        assert len(links) >= sum(len(each) - 1 for each in scene.lines)
        for word in (force, "n") if scene.patches else (force,):
            at = place_of(svg, word)
            assert min(gap(at, each) for each in links) > 6  # half the height of the letters, and half the link
            assert np.all(at > 5)
            assert np.all(at < np.array([width, height]) - 5)

    def test_the_arrow_ends_at_the_contact_from_within_the_surface(self):
        svg = mechanism_picture(reaching((0, 0, 1)))
        (arrow,) = strokes(svg, FORCE, "2.6")
        tip = strokes(svg, ARM, 5)
        ends = np.vstack([each[[0, -1]] for each in tip])
        assert np.linalg.norm(ends - arrow[-1], axis=1).min() < 0.5
        assert arrow[0, 1] > arrow[-1, 1]  # y grows downwards in SVG: it comes from below

    @pytest.mark.parametrize(("push", "outwards"), [(30.0, True), (-30.0, False)])
    def test_forces_on_two_hands_point_apart_where_the_hands_are_pushed_apart(self, push, outwards):
        svg = mechanism_picture(holding(push))
        arrows = strokes(svg, FORCE, "2.6")
        assert len(arrows) == 2
        middle = np.mean([each.mean(axis=0) for each in arrows], axis=0)
        for each in arrows:
            farther = np.linalg.norm(each[-1] - middle) > np.linalg.norm(each[0] - middle)
            assert farther == outwards

    def test_a_surface_that_ends_is_drawn_as_far_as_it_goes(self):
        scene = reaching((0, 0, 1))
        whole = mechanism_picture(scene)
        points = scene.patches[0].points.copy()
        points[:3] = np.nan
        patch = scene.patches[0]
        ended = Scene(
            3, scene.lines, forces=scene.forces, patches=(Patch(points, patch.contact, patch.normal, patch.tangent),)
        )
        svg = mechanism_picture(ended)
        assert "nan" not in svg
        assert 0.4 < svg.count("<path") / whole.count("<path") < 0.95

    def test_the_axes_are_named_once_and_numbered_with_few_numbers(self):
        written = words(mechanism_picture(reaching((0, 0, 1))))
        assert {"x, m", "y, m", "z, m"} <= set(written)
        numbers = [each for each in written if re.fullmatch(r"[−-]?[0-9.]+", each)]
        assert 6 <= len(numbers) <= 18
        assert all(len(each.strip("−-")) <= 4 for each in numbers)
