"""The arguments of every command; the commands themselves are imported when they run."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable

DESCRIPTION = (
    "Feedback gains for mechanisms that press on surfaces: position and contact force, with poles, errors and a report."
)
EXAMPLES = """examples:
  firmtouch new polisher                    write polisher.yaml, a commented model file
  firmtouch new polisher --urdf arm.urdf    the same for a robot
  firmtouch check polisher.yaml             is the model what it says it is?
  firmtouch design polisher.yaml            gains, their proof and a report in reports/polisher/
  firmtouch simulate reports/polisher       does it do that on the nonlinear mechanism?
  firmtouch verify reports/polisher/certificate.json --model polisher.yaml
  firmtouch montecarlo reports/polisher     a thousand drawn starts, parameters and disturbances
  firmtouch thermal fingertip.yaml          the fingertip that feels heat: how fast, and what limits it

exit codes: 0 good, 1 the answer is no, 2 the question was wrong"""

TYPE_CHECKING = False  # as in the package: `typing` itself would cost a good part of the start
if TYPE_CHECKING:
    Commands = argparse._SubParsersAction[argparse.ArgumentParser]  # noqa: SLF001  # argparse has no public name for it
LEAST_TOLERANCE, MOST_TOLERANCE = 1e-14, 1e-2


def build_parser() -> argparse.ArgumentParser:
    """Describe the command line."""
    parser = argparse.ArgumentParser(
        prog="firmtouch", description=DESCRIPTION, epilog=EXAMPLES, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--version", action=_Version, help="show the version and exit")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for add in (
        _add_design,
        _add_simulate,
        _add_montecarlo,
        _add_check,
        _add_verify,
        _add_thermal,
        _add_new,
        _add_schema,
    ):
        add(commands)
    for each in commands.choices.values():
        each.add_argument("-v", "--verbose", action="store_true", help="say what is done behind the scenes, on stderr")
    return parser


_DESIGN = (
    "Find W, C and G_f for a model, prove what is claimed of them, and write design.json, certificate.json, "
    "report.html and report.pdf."
)


def _add_design(commands: Commands) -> None:
    design = commands.add_parser("design", help="find gains for a model, and write a report", description=_DESIGN)
    design.add_argument("model", metavar="MODEL", help="a model file (YAML)")
    design.add_argument(
        "--method", choices=("poles", "region"), help="assign poles, or search a region (default: as the file says)"
    )
    design.add_argument(
        "--front",
        metavar="A,B",
        help="weigh two objectives of a region design, as in gains,margin (or cost)",
    )
    design.add_argument("--out", metavar="DIR", help="where to write (default: reports/<model>)")
    design.add_argument("--json", action="store_true", help="print design.json on stdout instead of words")
    design.add_argument("--no-pdf", action="store_true", help="leave out report.pdf")
    design.add_argument(
        "--no-attraction", action="store_true", help="prove no region of attraction, which takes longest"
    )
    design.add_argument("--no-simulation", action="store_true", help="simulate nothing")
    design.set_defaults(run=_command("design"))


_SIMULATE = (
    "Simulate the nonlinear closed loop, and write simulation.json, simulation.html and a CSV file for each scenario; "
    "exit code 1 if it diverges, loses contact, comes to rest elsewhere, or cannot be followed. "
    "For a model, its gains are found first."
)


def _add_simulate(commands: Commands) -> None:
    simulate = commands.add_parser(
        "simulate", help="simulate the nonlinear closed loop in given or usual scenarios", description=_SIMULATE
    )
    simulate.add_argument("target", metavar="MODEL_OR_DESIGN", help="a model file, a design.json, or its folder")
    simulate.add_argument("--scenario", metavar="FILE", help="a scenario file (YAML; default: the usual scenarios)")
    simulate.add_argument("--only", metavar="NAME", help="one scenario alone")
    simulate.add_argument("--out", metavar="DIR", help="where to write (default: reports/<model>/simulation)")
    simulate.add_argument(
        "--tolerance", type=_tolerance, default=1e-10, metavar="T", help="of the integrator (default: 1e-10)"
    )
    simulate.add_argument("--json", action="store_true", help="print simulation.json on stdout instead of words")
    simulate.set_defaults(run=_command("simulate"))


_MONTECARLO = (
    "Draw starts, parameters and disturbances from the file's intervals and bounds (or a scenario file's `draw`), "
    "simulate each, and tell what part converges, with its exact 95 % interval. A run has converged if it comes to "
    "rest at the equilibrium of its own world; one that still moves at the end has not, and is counted apart. Where a "
    "region of attraction is proven (in a design's certificate, or by --prove), further runs start inside it: all of "
    "them must converge. Stopped and started again, it goes on where it was."
)
_MONTECARLO_CODES = (
    "exit codes: 0 done, whatever the fraction; 1 a start inside the proven region did not converge, or --at-least is "
    "not reached; 2 the question was wrong"
)


def _add_montecarlo(commands: Commands) -> None:
    study = commands.add_parser(
        "montecarlo",
        help="simulate many drawn starts, parameters and disturbances",
        description=_MONTECARLO,
        epilog=_MONTECARLO_CODES,
    )
    study.add_argument("target", metavar="MODEL_OR_DESIGN", help="a model file, a design.json, or its folder")
    study.add_argument("--scenario", metavar="FILE", help="a scenario file (default: the model itself, at rest at q_d)")
    study.add_argument("--name", "--only", metavar="SCENARIO", help="which scenario of the file, if it holds several")
    study.add_argument("--runs", metavar="N", type=int, default=1000, help="how many runs (default: 1000)")
    study.add_argument("--seed", metavar="N", type=int, default=1, help="another seed draws others (default: 1)")
    study.add_argument("--jobs", metavar="N", type=int, help="how many processes (default: one for each core)")
    study.add_argument("--out", metavar="DIR", help="where to write (default: reports/<model>/montecarlo)")
    study.add_argument("--fresh", action="store_true", help="throw away the runs that DIR holds, and begin anew")
    study.add_argument("--run", dest="once_more", metavar="K", help="run number K alone once more, and write run-K.csv")
    study.add_argument(
        "--at-least",
        metavar="F",
        type=float,
        help="exit code 1 unless the lower end of the interval for the converged fraction is at least F, as in 0.99",
    )
    study.add_argument(
        "--prove", action="store_true", help="prove a region of attraction first, where no certificate holds one"
    )
    study.add_argument("--json", action="store_true", help="print montecarlo.json on stdout instead of words")
    study.set_defaults(run=_command("montecarlo"))


_CHECK = "Check models, one table each; exit code 1 if a check fails, 2 if a file cannot be read."


def _add_check(commands: Commands) -> None:
    check = commands.add_parser(
        "check", help="check models: constraints, inertia, derivatives, energy", description=_CHECK
    )
    check.add_argument("models", nargs="+", metavar="MODEL", help="model files (YAML)")
    check.add_argument("--json", action="store_true", help="print JSON on stdout instead of tables")
    check.set_defaults(run=_command("check"))


_VERIFY = (
    "Derive the mechanics from the model file and prove every claim of a certificate again; exit code 1 if anything "
    "differs, 2 if the file is no certificate. The design.json beside the certificate is compared if there is one."
)


def _add_verify(commands: Commands) -> None:
    verify = commands.add_parser("verify", help="prove a certificate again, from the model file", description=_VERIFY)
    verify.add_argument("certificate", metavar="CERTIFICATE", help="a certificate.json")
    verify.add_argument("--model", metavar="MODEL", required=True, help="the model file (YAML) it was made for")
    verify.add_argument("--json", action="store_true", help="print JSON on stdout instead of words")
    verify.set_defaults(run=_command("verify"))


_THERMAL = (
    "Analyse a heated fingertip of layers, or, where the file has a `search:` section, design it: rise times, what it "
    "tells apart, its heat, and what binds where a requirement is not met. Writes thermal.json, responses.csv, "
    "report.html and report.pdf, and of a design sensor.yaml; exit code 1 if a requirement is not met."
)


def _add_thermal(commands: Commands) -> None:
    thermal = commands.add_parser("thermal", help="analyse or design a fingertip that feels heat", description=_THERMAL)
    thermal.add_argument("sensor", metavar="SENSOR", help="a sensor file (YAML)")
    thermal.add_argument(
        "--catalogue", action="append", default=[], metavar="FILE", help="more materials, parts and contacts (YAML)"
    )
    thermal.add_argument("--out", metavar="DIR", help="where to write (default: reports/<sensor>)")
    thermal.add_argument("--json", action="store_true", help="print thermal.json on stdout instead of words")
    thermal.add_argument("--jobs", metavar="N", type=int, help="processes of a search (default: one for each core)")
    thermal.add_argument("--no-pdf", action="store_true", help="leave out report.pdf")
    thermal.set_defaults(run=_command("thermal"))


_NEW = "Write NAME.yaml, a commented model file that works as it is."


def _add_new(commands: Commands) -> None:
    new = commands.add_parser("new", help="write a commented model file to start from", description=_NEW)
    new.add_argument("name", metavar="NAME", help="the model's name; NAME.yaml is written, and never overwritten")
    new.add_argument("--urdf", metavar="FILE", help="start from this robot instead of a planar arm")
    new.add_argument("--sensor", action="store_true", help="write a sensor file for `firmtouch thermal` instead")
    new.add_argument("--tool", metavar="LINK", help="the link of the robot that touches (default: the last one)")
    new.set_defaults(run=_command("new"))


_SCHEMA = (
    "Print the JSON Schema of model files (or of scenario, sensor or catalogue files), for editors that complete and "
    "check YAML."
)


def _add_schema(commands: Commands) -> None:
    schema = commands.add_parser("schema", help="print the JSON Schema of model files", description=_SCHEMA)
    which = schema.add_mutually_exclusive_group()
    which.add_argument("--scenario", action="store_true", help="that of scenario files instead")
    which.add_argument("--sensor", action="store_true", help="that of sensor files")
    which.add_argument("--catalogue", action="store_true", help="that of files of materials, parts and contacts")
    schema.set_defaults(run=_command("schema"))


def _tolerance(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no number") from None
    if not LEAST_TOLERANCE <= value <= MOST_TOLERANCE:
        raise argparse.ArgumentTypeError(f"{text} is not between {LEAST_TOLERANCE:g} and {MOST_TOLERANCE:g}")
    return value


def _command(name: str) -> Callable[[argparse.Namespace], int]:
    def run(arguments: argparse.Namespace) -> int:
        import importlib

        return int(importlib.import_module(f"firmtouch.cli.{name}").run(arguments))

    return run


class _Version(argparse.Action):
    """`--version`, which reads the installed version only when asked."""

    def __init__(self, option_strings: list[str], dest: str, **options: object) -> None:
        super().__init__(option_strings, dest, nargs=0, help=str(options.get("help")))

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import version

        sys.stdout.write(f"firmtouch {version('firmtouch')}\n")
        parser.exit()
