"""How long a proof takes: all matrix inequalities of planar arms on a wall, and `firmtouch verify` of seven joints, cold."""

from __future__ import annotations

import json
import math
import sys
import tempfile
from pathlib import Path

from tests.benchmarks.measure import Figure, best_of, run

import firmtouch
from firmtouch.certificate.decision import decide
from firmtouch.certificate.question import Question
from firmtouch.certificate.subject import subject_of

ROUTES = ("LDL^T", "Lyapunov", "[T4]")
"""What is a matrix inequality."""
REPETITIONS = 5


def model_text(joints: int) -> bytes:
    """Write the model file of a chain of equal links that touches a wall with its tip, and asks for poles."""
    names, length = [f"q{i}" for i in range(1, joints + 1)], 2.8 / joints
    guess = [1.2, *[-1.9 / (joints - 1)] * (joints - 1)]
    reach = length * sum(math.cos(sum(guess[: i + 1])) for i in range(joints))
    definitions, bodies, before = {}, {}, "[0*l, 0*l]"
    for i, name in enumerate(names, start=1):
        definitions[f"a{i}"] = f"a{i - 1} + {name}" if i > 1 else name
        along = f"[cos(a{i}), sin(a{i})]"
        definitions[f"p{i}"] = f"{before} + l*{along}"
        centre = f"{before} + 0.45*l*{along}"
        bodies[f"link{i}"] = {"mass": "m", "inertia": "I", "centre_of_mass": centre, "orientation": f"a{i}"}
        before = f"p{i}"
    document = {
        "schema": "firmtouch.model/1",
        "title": f"A planar {joints}R arm on a wall",
        "parameters": {"l": f"{length!r} m", "m": "2 kg", "I": "0.03 kg*m^2", "d": f"{reach!r} m"},
        "coordinates": dict.fromkeys(names, "rad"),
        "definitions": definitions,
        "mechanism": {"gravity": "[0, -9.81]", "bodies": bodies},
        "constraints": {"wall": {"expression": f"d - x({before})", "unit": "m"}},
        "operating_point": {"guess": dict(zip(names, guess, strict=True)), "lambda_d": {"wall": 20}},
        "design": {
            "poles": [-(4 + 8 * i / (2 * joints - 2)) for i in range(2 * joints - 2)],
            "force_feedback": 0.5,
            "level": "tangent",
            "modes": "plant",
        },
    }
    return json.dumps(document).encode()


def inequalities(joints: int) -> tuple[float, int]:
    """Time the proof of all matrix inequalities, enclosing the plant included; gives seconds and their number."""
    spec = firmtouch.parse_model(model_text(joints), name="arm").spec
    loop = firmtouch.assign_poles(firmtouch.find_operating_point(firmtouch.derive_plant(spec)), spec.design)
    found: list[Question] = []

    def prove() -> None:
        from firmtouch.certificate.certificate import questions_of

        subject = subject_of(loop.operating_point, loop.gains)
        found[:] = [each for each in questions_of(subject) if each.route.startswith(ROUTES)]
        for each in found:
            value = each.estimate() * (1 + (-1e-6 if each.relation == ">" else 1e-6))
            asked = value if each.asked is None else each.asked
            verdict, _ = decide(lambda each=each, asked=asked: each.answer(asked))
            assert verdict.value == "proven", (each.name, verdict)

    return best_of(REPETITIONS if joints < 10 else 1, prove), len(found)


def verification(joints: int) -> float:
    """Time `firmtouch verify` as a new process."""
    firm = str(Path(sys.executable).with_name("firmtouch"))
    with tempfile.TemporaryDirectory() as folder:
        model = Path(folder) / "arm.yaml"
        model.write_bytes(model_text(joints))
        run([firm, "design", str(model), "--out", folder, "--no-pdf"])
        command = [firm, "verify", f"{folder}/certificate.json", "--model", str(model)]
        return min(run(command) for _ in range(3))


def figures() -> list[Figure]:
    made = []
    for joints, bound in ((7, 50.0), (30, 2000.0)):
        seconds, count = inequalities(joints)
        name, detail = f"{joints}R: all inequalities", f"{count} of them, with the plant's enclosure"
        made.append(Figure(name, 1e3 * seconds, "<=", bound, "ms", detail))
    made.append(Figure("7R: verify, cold", verification(7), "<=", 2, "s", "a new process, files included"))
    return made
