"""The command line: one file a command; nothing but arguments, one call, and printing.

Exit codes: 0 good, 1 the answer is no, 2 the question was wrong. Results go to stdout, talk to stderr.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

GOOD, NO, WRONG = 0, 1, 2


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command and give its exit code."""
    from firmtouch.cli.arguments import build_parser

    # Matrices here are small: a second thread costs more than it gives. Read when NumPy is loaded.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

    arguments = build_parser().parse_args(argv)
    if arguments.verbose:
        _talk()
    from firmtouch.errors import InputError, NoDesignError

    try:
        return int(arguments.run(arguments))
    except InputError as error:
        sys.stderr.write(f"{error}\n")
        return WRONG
    except NoDesignError as error:
        sys.stderr.write(f"no design: {error}\n")
        return NO
    except KeyboardInterrupt:
        sys.stderr.write("stopped\n")
        return 130


def _talk() -> None:
    """Let the package's logger speak on stderr."""
    import logging

    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(logging.Formatter("firmtouch: %(message)s"))
    logger = logging.getLogger("firmtouch")
    logger.handlers[:] = [handler]
    logger.setLevel(logging.DEBUG)


def entry() -> None:
    """Run as a program."""
    try:
        sys.exit(main())
    except BrokenPipeError:
        # The reader has gone (`firmtouch schema | head`); nothing more can be written, not even on exit.
        sys.stdout = None
        sys.exit(GOOD)
