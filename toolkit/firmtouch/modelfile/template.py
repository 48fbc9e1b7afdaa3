"""The model files that `firmtouch new` writes."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence

TEMPLATE = """\
# A model file of firmtouch. It works as it is:  firmtouch check {name}.yaml && firmtouch design {name}.yaml
# Quantities are written with a unit (0.6 m, 70 deg, 40 N); a bare number is in SI.
# Expressions know + - * / ** ( ), vectors [a, b], sin cos tan asin acos atan atan2 sinh cosh tanh exp log sqrt,
# x(p) y(p) z(p) norm(p) inner(p, r) cross(p, r), and pi.
schema: firmtouch.model/1
title: {title}
description: A planar arm with two joints presses its tip against a vertical wall.

# Constants. An interval says how well one is known.
parameters:
  l1: {{value: 0.50 m, label: length of the upper arm}}
  l2: {{value: 0.45 m, label: length of the forearm}}
  m1: 6.0 kg
  m2: {{value: 4.0 kg, interval: [3.5 kg, 5.0 kg], label: mass of the forearm with its tool}}
  I1: 0.14 kg*m^2
  I2: 0.08 kg*m^2
  g: 9.81 m/s^2
  d: {{value: 0.62 m, label: distance of the wall}}

# The generalised coordinates q, in order.
coordinates:
  q1: {{unit: rad, effort: 60 N*m, label: shoulder}}   # effort: the most that the drive can do
  q2: {{unit: rad, effort: 40 N*m, label: elbow}}

# Names for intermediate expressions; each may use those above it.
definitions:
  elbow: [l1*cos(q1), l1*sin(q1)]
  along: [cos(q1 + q2), sin(q1 + q2)]
  tip: elbow + l2*along

# Either rigid bodies, in the plane (two entries) or in space (three), ...
mechanism:
  gravity: [0, -g]
  bodies:
    upper_arm:
      mass: m1
      inertia: I1                        # about the centre of mass
      centre_of_mass: 0.5*elbow
      orientation: q1                    # in space: [{{z: q1}}, {{y: q2}}]
    forearm:
      mass: m2
      inertia: I2
      centre_of_mass: elbow + 0.5*l2*along
      orientation: q1 + q2
# ... or the two energies of any mechanism, with dot(q1) for a velocity:
#   kinetic_energy: 0.5*m*(dot(x)**2 + dot(y)**2)
#   potential_energy: m*g*y

# phi = 0. lambda > 0 pushes the mechanism towards growing phi; with phi in metres, lambda is in newtons.
constraints:
  wall: {{expression: d - x(tip), unit: m, one_sided: true}}   # one_sided: it cannot pull

# Where to rest, and how hard to press. `guess` is projected onto the constraints; `q_d` must lie on them.
operating_point:
  guess: {{q1: 70 deg, q2: -75 deg}}
  lambda_d: {{wall: 40 N}}                # or f_d, in joint coordinates

# 2(n - m) poles, in 1/s. Complex ones in pairs: [-6+3j, -6-3j].
design:
  method: poles
  poles: [-6, -8]
  force_feedback: 0.8                    # G_f: a number, one for each constraint, a matrix, or auto (see force_path)
  normal_blocks: decouple                # or reject, or {{policy: blend, weight: 0.5}}

# How the measured force comes to the controller: what bounds the force feedback.
# force_path: {{bandwidth: 80 Hz, sample: 1 ms, margins: {{gain: 2, modulus: 0.5}}, contact_stiffness: 1e4 N/m}}

# How large the causes of steady-state errors may be.
bounds:
  disturbance: 2 N*m
  offset: 2 mm
  tilt: 2 deg

# What the report's picture shows.
drawing:
  lines:
    arm: [[0, 0], elbow, tip]
  surfaces:
    wall: {{through: [[d, 0.05], [d, 0.75]]}}
  contacts:
    wall: tip
"""


ROBOT = """\
# A model file of firmtouch for a robot. It works as it is:  firmtouch check {name}.yaml && firmtouch design {name}.yaml
# Quantities are written with a unit (0.6 m, 70 deg, 40 N); a bare number is in SI.
schema: firmtouch.model/1
title: {title}

# The joints of the file are the coordinates, and its limits of position, speed and effort are the design's.
mechanism:
  urdf: {urdf}
  tool: {tool}
  # locked: {{finger_joint: 0.02 m}}      # joints that do not move
  # base: {{position: [0, 0, 0.8 m], orientation: [{{z: 90 deg}}]}}
  # payload: {{mass: 1 kg, centre_of_mass: [0, 0, 0.05 m]}}

# What is touched. Other surfaces: sphere, cylinder, cone, torus, ellipsoid, superellipsoid, implicit, height_field.
# `align: z` keeps the tool's z axis along the normal: two more rows. Other constraints: rail, distance, join.
constraints:
  table:
    surface: {{plane: {{point: {point}, normal: {normal}}}}}
    # point: {{frame: {tool}, position: [0, 0, 0.1 m]}}    # what touches, if not the tool's origin

# Where to rest, and how hard to press. Instead of a guess, a point on the surface and a direction:
#   reach: {{point: {point}, direction: {direction}}}
operating_point:
  guess: {guess}
  normal_force: 20 N

# 2(n - m) poles, in 1/s. Light wrists follow slow poles with little stiffness; `method: region` weighs the joints.
design:
  method: poles
  poles: {poles}
  force_feedback: 0.8

# How large the causes of steady-state errors may be.
bounds:
  disturbance: {disturbance}
  offset: 1 mm
  tilt: 1 deg
"""


def robot_template(
    name: str,
    *,
    urdf: str,
    tool: str,
    guess: Mapping[str, float],
    units: Mapping[str, str],
    point: Sequence[float],
    axis: Sequence[float],
) -> str:
    """Give the text of a commented model file for a robot: its tool at `point`, on a plane square to its axis there.

    `guess` are positions by the coordinates' names, in rad or m as `units` say.
    """
    positions = {
        each: f"{value:.4g} m" if units[each] == "m" else f"{math.degrees(value):.1f} deg"
        for each, value in guess.items()
    }
    lengths = "[" + ", ".join(f"{each:.4f} m" for each in point) + "]"
    direction = [round(each, 4) + 0.0 for each in axis]
    efforts = {each: "0.1 N" if units[each] == "m" else "0.1 N*m" for each in guess}
    same = set(efforts.values())
    return ROBOT.format(
        name=name,
        title=_title(name),
        urdf=json.dumps(urdf, ensure_ascii=False),
        tool=json.dumps(tool, ensure_ascii=False),
        point=lengths,
        normal=[-each + 0.0 for each in direction],
        direction=direction,
        guess="{" + ", ".join(f"{each}: {text}" for each, text in positions.items()) + "}",
        poles=[-8 - 0.5 * i for i in range(2 * (len(guess) - 1))],
        disturbance=same.pop() if len(same) == 1 else "{" + ", ".join(f"{k}: {v}" for k, v in efforts.items()) + "}",
    )


def model_template(name: str) -> str:
    """Give the text of a commented model file."""
    return TEMPLATE.format(name=name, title=_title(name))


def _title(name: str) -> str:
    title = " ".join(name.replace("_", " ").replace("-", " ").split()).capitalize() or "Model"
    # A JSON string is a YAML string, whatever the name holds.
    return json.dumps(title, ensure_ascii=False)
