"""Constraints on frames of robots: derivatives, what zero means, and what their multipliers do to the arm.

Each mechanism is built so that it meets its constraint in a random configuration: the surface, the curve or the second
frame is put where the tool is. What the multipliers do is then computed from the geometric Jacobians of the frames.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

import firmtouch
from firmtouch.mechanics.arm import arm_of
from firmtouch.mechanics.constraints import constraints_of
from firmtouch.mechanics.symbols import Symbols
from firmtouch.mechanics.tree import frame_jacobian, frame_pose
from firmtouch.modelfile.files import kept

URDF = Path(__file__).parents[2] / "models" / "urdf"
FILES = {path.name: path.read_bytes() for path in URDF.glob("*.urdf")}
TOOLS = {"ur5e.urdf": ["flange"], "panda.urdf": ["flange"], "dual_ur5e.urdf": ["left_tool0", "right_tool0"]}
STEP = 1e-5
DIFFERENCE = 1e-8  # STEP^2 times a third derivative below 100, and 1e-15 / STEP of rounding
EXACT = 1e-12  # arms of a metre or two; some thousand operations
OFFSET = {"position": [0.03, -0.02, 0.1], "orientation": [{"z": 0.4}, {"x": -0.7}]}


@dataclass(frozen=True)
class Frame:
    """Where a frame is in the world, and how it moves: v = Jv q' of its origin, w = Jw q'."""

    p: np.ndarray
    R: np.ndarray
    Jv: np.ndarray
    Jw: np.ndarray

    def beyond(self, position, R):
        """Give a frame that stands off from this one."""
        r = self.R @ position
        return Frame(self.p + r, self.R @ R, self.Jv - cross(r) @ self.Jw, self.Jw)


class Arm:
    """An arm of a file: its frames in numbers, and the rows of entries of `constraints`."""

    def __init__(self, file, chain=None):
        self.file = file
        self.mechanism = {"planar_chain": chain} if chain else {"urdf": file, "tool": TOOLS[file]}
        self.n = chain["n"] if chain else {"ur5e.urdf": 6, "panda.urdf": 7, "dual_ur5e.urdf": 12}[file]

    def model(self, entries, rows=1, **sections):
        document = {
            "schema": "firmtouch.model/1",
            "title": "A robot made by a test",
            "mechanism": self.mechanism,
            "constraints": entries,
            "operating_point": {"guess": dict.fromkeys(self.names, 0), "lambda_d": dict.fromkeys(self.plain(entries), 0)},
            "design": {"poles": [-4 - i for i in range(2 * (self.n - rows))], "force_feedback": 0.5},
        }  # fmt: skip
        document["mechanism"] = document["mechanism"] | sections.pop("mechanism", {})
        return firmtouch.parse_model(json.dumps(document | sections).encode(), name="made", attached=kept(FILES))

    @staticmethod
    def plain(entries):
        """Give the rows whose multipliers must be given."""
        return [name for name, each in entries.items() if {"surface", "distance", "expression"} & each.keys()]

    @property
    def names(self):
        if "planar_chain" in self.mechanism:
            return [f"q{i + 1}" for i in range(self.n)]
        one = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]
        return {
            "ur5e.urdf": one,
            "panda.urdf": [f"joint{i}" for i in range(1, 8)],
            "dual_ur5e.urdf": [f"{side}_{each}" for side in ("left", "right") for each in one],
        }[self.file]

    def rows(self, entry, count):
        """Give Phi, J, the Hessians and J' q' of an entry as functions of numbers, and the rows' names."""
        spec = self.model({"held": entry}, count).spec
        symbols = Symbols(spec)
        rows = constraints_of(spec, symbols, arm_of(spec, symbols))
        q, v = symbols.q, symbols.qdot
        outputs = {
            "Phi": ca.vertcat(*(each.phi for each in rows)),
            "J": ca.vertcat(*(each.gradient.T for each in rows)),
            "Phi_qq": ca.horzcat(*(each.hessian for each in rows)),
            "rate": ca.vertcat(*(each.rate(q, v) for each in rows)),
        }
        f = ca.Function(
            "f", [q, v, symbols.p], [ca.densify(each) for each in outputs.values()], ["q", "v", "p"], [*outputs]
        )

        def call(name, q, v=None):
            got = f(q=q, v=np.zeros(self.n) if v is None else v)[name].full()
            return got[:, 0] if name in ("Phi", "rate") else got

        return Rows(call, tuple(spec.constraints), self.n)

    def frame(self, name, q):
        if not hasattr(self, "_tree"):
            spec = self.model({"held": {"distance": 1, "between": self.ends}}).spec
            self._tree = arm_of(spec, Symbols(spec)).tree
            self._frames = {}
        if name not in self._frames:
            x = ca.SX.sym("q", self.n)
            outputs = [*frame_pose(self._tree, name, x), frame_jacobian(self._tree, name, x)]
            self._frames[name] = ca.Function("frame", [x], [ca.densify(each) for each in outputs])
        p, R, J = (each.full() for each in self._frames[name](q))
        return Frame(p[:, 0], R, J[:3], J[3:])

    @property
    def ends(self):
        return (
            TOOLS[self.file]
            if len(TOOLS[self.file]) == 2
            else [TOOLS[self.file][0], {"ur5e.urdf": "base", "panda.urdf": "link0"}[self.file]]
        )


@dataclass(frozen=True)
class Rows:
    call: object
    names: tuple
    n: int

    def __getattr__(self, name):
        return lambda *state: self.call(name, *state)


def cross(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def turn(axis, angle):
    a = cross(np.eye(3)["xyz".index(axis)])
    return np.eye(3) + np.sin(angle) * a + (1 - np.cos(angle)) * a @ a


def turns(R):
    """Give the rotations about moving axes z, y, x that make R."""
    z, y, x = np.arctan2(R[1, 0], R[0, 0]), -np.arcsin(R[2, 0]), np.arctan2(R[2, 1], R[2, 2])
    assert turn("z", z) @ turn("y", y) @ turn("x", x) == pytest.approx(R, abs=EXACT)
    return [{"z": z}, {"y": y}, {"x": x}]


ARMS = {name.removesuffix(".urdf"): Arm(name) for name in FILES}
OFF = turn("z", 0.4) @ turn("x", -0.7)


def tool_of(arm, q):
    """Give the tool that stands off from the flange, and what a file says of it."""
    name = TOOLS[arm.file][0]
    return arm.frame(name, q).beyond(OFFSET["position"], OFF), {"frame": name} | OFFSET


def right_of(arm, q):
    """Give the frame at the right arm that coincides with the left one's tool, and what a file says of it."""
    left, (_, name) = tool_of(arm, q)[0], TOOLS[arm.file]
    right = arm.frame(name, q)
    R, p = right.R.T @ left.R, right.R.T @ (left.p - right.p)
    return right.beyond(p, R), {"frame": name, "position": p.tolist(), "orientation": turns(R)}


# Each sort gives an entry, the number of its rows, and what J must be: the rows' forces on the arm.


def contact(arm, q, align, curved):
    tool, frame = tool_of(arm, q)
    a = "xyz".index(align or "z")
    into, (e1, e2) = tool.R[:, a], (tool.R[:, (a + i) % 3] for i in (1, 2))
    radius = 0.3
    surface = (
        {"sphere": {"centre": (tool.p + radius * into).tolist(), "radius": radius}}
        if curved
        else {"plane": {"point": (tool.p + 0.2 * e1).tolist(), "normal": (-3 * into).tolist()}}
    )
    bend = 1 / radius if curved else 0.0  # the normal turns as the point moves along
    J = [-into @ tool.Jv]
    if align:
        J += [e1 @ tool.Jw - bend * e2 @ tool.Jv, e2 @ tool.Jw + bend * e1 @ tool.Jv]
    return {"surface": surface, "point": frame} | ({"align": align} if align else {}), np.array(J)


HELD = {"point": 0, "axis": 2, "frame": 3}


def line(arm, q, hold):
    tool, frame = tool_of(arm, q)
    x, y, z = tool.R.T
    rail = {"line": {"point": (tool.p - 0.3 * z).tolist(), "direction": (2 * z).tolist(), "up": y.tolist()}}
    J = [x @ tool.Jv, y @ tool.Jv, *(tool.R.T @ tool.Jw)[: HELD[hold]]]
    return {"rail": rail, "frame": frame, "hold": hold}, np.array(J)


def circle(arm, q, hold):
    tool, frame = tool_of(arm, q)
    x, y, z = tool.R.T
    radius = 0.4
    rail = {"circle": {"centre": (tool.p - radius * x).tolist(), "axis": (0.5 * y).tolist(), "radius": radius}}
    along = np.outer(-y, z @ tool.Jv) / radius  # how the curve's own frame turns as the point moves along
    J = [x @ tool.Jv, y @ tool.Jv, *(tool.R.T @ (tool.Jw - along))[: HELD[hold]]]
    return {"rail": rail, "frame": frame, "hold": hold}, np.array(J)


def rod(arm, q):
    tool, frame = tool_of(arm, q)
    a, b = frame, arm.ends[1]
    other = arm.frame(b, q)
    gap = tool.p - other.p
    length = np.linalg.norm(gap)
    return {"distance": length, "between": [a, b]}, (gap / length @ (tool.Jv - other.Jv))[None]


def join(arm, q, hold):
    left, frame = tool_of(arm, q)
    right, other = right_of(arm, q)
    J = [*(left.R.T @ (right.Jv - left.Jv)), *(left.R.T @ (right.Jw - left.Jw))[: HELD[hold]]]
    return {"join": [frame, other], "hold": hold}, np.array(J)


SORTS = {
    **{f"{arm} touches with {align}{' a ball' * curved}": (arm, contact, (align, curved)) for arm, align, curved in [("ur5e", None, False), ("panda", "z", False), ("ur5e", "x", False), ("ur5e", "y", True), ("panda", None, True)]},
    **{f"{arm} on a line, {hold}": (arm, line, (hold,)) for arm, hold in [("ur5e", "point"), ("panda", "axis"), ("ur5e", "frame")]},
    **{f"{arm} on a circle, {hold}": (arm, circle, (hold,)) for arm, hold in [("panda", "point"), ("ur5e", "axis"), ("panda", "frame")]},
    **{f"{arm} on a rod": (arm, rod, ()) for arm in ("ur5e", "dual_ur5e")},
    **{f"two arms joined, {hold}": ("dual_ur5e", join, (hold,)) for hold in HELD},
}  # fmt: skip


@pytest.fixture(params=SORTS)
def held(request, rng):
    """Give a constraint that holds at q, and the J that its meaning asks for."""
    name, sort, options = SORTS[request.param]
    arm = ARMS[name]
    q = rng.uniform(-1.2, 1.2, arm.n)
    entry, J = sort(arm, q, *options)
    return arm, q, entry, arm.rows(entry, len(J)), J


def test_zero_means_what_it_says_and_multipliers_are_the_stated_forces(held):
    _, q, _, rows, J = held
    assert rows.Phi(q) == pytest.approx(np.zeros(len(J)), abs=EXACT)
    # J^T lambda are the joint forces of a unit force or moment at the frame, for each row.
    assert rows.J(q) == pytest.approx(J, abs=1e-11)  # Jacobians of two derivations, with curvatures of 1 / 0.3 m


def test_derivatives_equal_central_differences(held, rng):
    arm, q, _, rows, _ = held
    for x in (q, q + rng.uniform(-0.3, 0.3, arm.n)):  # where the constraint holds, and where not
        m = len(rows.Phi(x))
        J, hessians = np.empty((m, arm.n)), np.empty((m, arm.n, arm.n))
        for i, h in enumerate(STEP * np.eye(arm.n)):
            J[:, i] = (rows.Phi(x + h) - rows.Phi(x - h)) / (2 * STEP)
            hessians[:, :, i] = (rows.J(x + h) - rows.J(x - h)) / (2 * STEP)
        assert rows.J(x) == pytest.approx(J, abs=DIFFERENCE)
        assert np.array(np.hsplit(rows.Phi_qq(x), m)) == pytest.approx(hessians, abs=DIFFERENCE * 10)


def test_phi_along_a_motion_has_the_second_rate_that_the_dynamics_use(held, rng):
    arm, q, _, rows, _ = held
    A, w = rng.uniform(-0.3, 0.3, (2, arm.n))

    def motion(t):
        return q + A * np.sin(t) + w * t, A * np.cos(t) + w, -A * np.sin(t)

    def first(t):
        x, v, _ = motion(t)
        return rows.J(x) @ v

    t = 0.7
    x, v, a = motion(t)
    second = (first(t + STEP) - first(t - STEP)) / (2 * STEP)
    assert rows.J(x) @ a + rows.rate(x, v) == pytest.approx(second, abs=DIFFERENCE * 10)


def test_phi_measures_distances_away_from_zero(rng):
    """A gap is in metres, wherever the arm is."""
    arm = ARMS["ur5e"]
    q = rng.uniform(-1, 1, arm.n)
    x = q + rng.uniform(-0.4, 0.4, arm.n)
    here, there = (tool_of(arm, each)[0] for each in (q, x))
    moved = there.p - here.p
    entry, J = line(arm, q, "point")
    beside = arm.rows(entry, len(J)).Phi(x)
    z = here.R[:, 2]
    assert np.hypot(*beside) == pytest.approx(np.linalg.norm(np.cross(moved, z)), abs=EXACT)
    entry["rail"]["line"].pop("up")  # the two directions may be any then
    assert np.hypot(*arm.rows(entry, len(J)).Phi(x)) == pytest.approx(np.hypot(*beside), abs=EXACT)
    entry, J = circle(arm, q, "point")
    away, y = there.p - np.array(entry["rail"]["circle"]["centre"]), here.R[:, 1]
    round_ = np.linalg.norm(np.cross(away, y)) - entry["rail"]["circle"]["radius"]
    assert arm.rows(entry, len(J)).Phi(x) == pytest.approx([round_, away @ y], abs=EXACT)
    entry, J = contact(arm, q, None, curved=False)
    assert arm.rows(entry, 1).Phi(x) == pytest.approx([-here.R[:, 2] @ moved], abs=EXACT)
    entry, J = rod(arm, q)
    base = arm.frame("base", x).p
    assert arm.rows(entry, 1).Phi(x) == pytest.approx([np.linalg.norm(there.p - base) - entry["distance"]], abs=EXACT)


def test_a_join_pushes_both_arms_equally_in_opposite_directions(rng):
    arm = ARMS["dual_ur5e"]
    q = rng.uniform(-1, 1, arm.n)
    entry, _ = join(arm, q, "frame")
    lambda_ = rng.normal(size=6)
    load = arm.rows(entry, 6).J(q).T @ lambda_
    left, right = tool_of(arm, q)[0], right_of(arm, q)[0]
    force, moment = left.R @ lambda_[:3], left.R @ lambda_[3:]  # in the world, on the right arm
    expected = right.Jv.T @ force + right.Jw.T @ moment
    assert load[6:] == pytest.approx(expected[6:], abs=1e-11)
    assert load[:6] == pytest.approx(-(left.Jv.T @ force + left.Jw.T @ moment)[:6], abs=1e-11)


WITHOUT = [("about_x",), ("x", "about_y"), ("y", "z", "about_x", "about_z"), ("x", "y", "z")]


@pytest.mark.parametrize("without", WITHOUT, ids="-".join)
def test_rows_are_left_out_by_name(without, rng):
    arm = ARMS["dual_ur5e"]
    q = rng.uniform(-1, 1, arm.n)
    entry, _ = join(arm, q, "frame")
    whole = arm.rows(entry, 6)
    names = ["x", "y", "z", "about_x", "about_y", "about_z"]
    assert whole.names == tuple(f"held_{each}" for each in names)
    kept_rows = [i for i, name in enumerate(names) if name not in without]
    part = arm.rows(entry | {"without": list(without)}, len(kept_rows))
    assert part.names == tuple(f"held_{names[i]}" for i in kept_rows)
    x = q + 0.1
    assert np.array_equal(part.J(x), whole.J(x)[kept_rows])
    assert np.array_equal(part.Phi(x), whole.Phi(x)[kept_rows])


def test_an_aligned_contact_leaves_out_a_turn(rng):
    arm = ARMS["ur5e"]
    q = rng.uniform(-1, 1, arm.n)
    entry, _ = contact(arm, q, "x", curved=True)
    whole, part = arm.rows(entry, 3), arm.rows(entry | {"without": ["about_y"]}, 2)
    assert whole.names == ("held", "held_about_y", "held_about_z")
    assert part.names == ("held", "held_about_z")
    assert np.array_equal(part.J(q + 0.1), whole.J(q + 0.1)[[0, 2]])


@pytest.mark.parametrize("angle", [0.3, 1.0, 2.5, 3.1])
def test_a_turn_is_measured_by_its_half_angle_and_vanishes_at_none_alone(angle, rng):
    """(R - R^T) / 2 would vanish at half a turn too, where the joint would be shut the wrong way round."""
    arm = ARMS["dual_ur5e"]
    q = rng.uniform(-1, 1, arm.n)
    entry, _ = join(arm, q, "frame")
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    A = cross(axis)
    more = np.eye(3) + np.sin(angle) * A + (1 - np.cos(angle)) * A @ A
    second = entry["join"][1]
    _, right = right_of(arm, q)
    R = np.eye(3)
    for each in right["orientation"]:
        R = R @ turn(*next(iter(each.items())))
    turned = entry | {"join": [entry["join"][0], second | {"orientation": turns(R @ more)}]}
    Phi = arm.rows(turned, 6).Phi(q)
    assert Phi[:3] == pytest.approx(np.zeros(3), abs=EXACT)
    # Near half a turn 1 + trace(R) = 4 cos^2(angle / 2) has lost digits.
    assert Phi[3:] == pytest.approx(2 * np.sin(angle / 2) * axis, abs=EXACT / np.cos(angle / 2) ** 2)
