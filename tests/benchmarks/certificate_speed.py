"""How long a proof takes: all matrix inequalities of planar arms on a wall, and `firmtouch verify` of seven joints, cold."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from tests.benchmarks.chain import chain_on_wall
from tests.benchmarks.measure import Figure, best_of, run

import firmtouch
from firmtouch.certificate.certificate import questions_of
from firmtouch.certificate.decision import decide
from firmtouch.certificate.question import Question
from firmtouch.certificate.subject import subject_of

ROUTES = ("LDL^T", "Lyapunov", "[T4]")
"""What is a matrix inequality."""
REPETITIONS = 5


def model_text(joints: int) -> bytes:
    """Write the model file: a chain on a wall, with poles from -4 to -12."""
    poles = [-(4 + 8 * i / (2 * joints - 2)) for i in range(2 * joints - 2)]
    return chain_on_wall(joints, {"poles": poles, "force_feedback": 0.5, "level": "tangent", "modes": "plant"})


def inequalities(joints: int) -> tuple[float, int]:
    """Time the proof of all matrix inequalities, enclosing the plant included; gives seconds and their number."""
    spec = firmtouch.parse_model(model_text(joints), name="arm").spec
    loop = firmtouch.assign_poles(firmtouch.find_operating_point(firmtouch.derive_plant(spec)), spec.design)
    found: list[Question] = []

    def prove() -> None:
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
