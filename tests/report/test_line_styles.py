"""Lines that can be told apart, and their legend."""

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from firmtouch.report.figures.canvas import new_figure
from firmtouch.report.figures.line_styles import draw_legend, legend_rows, styles_of
from firmtouch.report.figures.trajectory import COLOURS, FORCES, WIDTH

JOINTS = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
TWO_ARMS = [f"{arm}_{joint}" for arm in ("left", "right") for joint in JOINTS]


@pytest.mark.parametrize(
    "names", [TWO_ARMS, [f"q{i}" for i in range(1, 31)], ["x"], ["a_1", "b_1"], ["left_1", "right_2"]]
)
def test_no_two_lines_look_alike(names):
    styles = styles_of(names, COLOURS)
    assert len(styles.lines) == len(names) == len(set(styles.lines))


def test_two_arms_share_the_colours_of_their_joints_and_have_a_dash_each():
    styles = styles_of(TWO_ARMS, COLOURS)
    left, right = styles.lines[:6], styles.lines[6:]
    assert [each.colour for each in left] == [each.colour for each in right]
    assert len({each.dash for each in left}) == len({each.dash for each in right}) == 1
    assert [each.label for each in styles.keys] == [*(each.replace("_", " ") for each in JOINTS), "left", "right"]


def test_names_that_are_no_arms_are_listed_as_they_are():
    names = ["grip_x", "grip_y", "grip_z", "grip_about_x", "grip_about_y", "grip_about_z"]
    styles = styles_of(names, FORCES)
    assert [each.label for each in styles.keys] == [each.replace("_", " ") for each in names]
    assert len({each.colour for each in styles.lines}) == 6


@pytest.mark.parametrize("names", [TWO_ARMS, [f"joint_of_arm_{i}" for i in range(14)], ["q1", "q2"]])
def test_the_legend_fits_and_names_every_line(names):
    keys = styles_of(names, COLOURS).keys
    figure = new_figure(WIDTH, 2.4, layout=None)
    draw_legend(figure, keys, WIDTH)
    (legend,) = figure.legends
    box = legend.get_window_extent(FigureCanvasAgg(figure).get_renderer()).transformed(
        figure.dpi_scale_trans.inverted()
    )
    assert 0 <= box.x0 < box.x1 <= WIDTH
    assert box.height < 0.17 * legend_rows(keys, WIDTH) + 0.1
    written = [each.get_text() for each in legend.get_texts() if each.get_text()]
    assert sorted(written) == sorted(each.label for each in keys)
