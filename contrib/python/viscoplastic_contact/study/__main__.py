# SPDX-License-Identifier: LGPL-2.1-or-later
"""The commands of contrib/study, contrib/price and contrib/effects:

    python3 -m viscoplastic_contact.study study|effects|price ...

Exit codes are those of the program: 1 something was wrong (one sentence says
what), 2 wrong arguments, 3 ended by a signal, 0 otherwise."""

import argparse
import signal
import sys
from pathlib import Path

from ..program import Program
from ..tables import UserError

USAGE = {
    "study": "Computes a scene on several meshes and with several steps, as 'Study' in "
    "it describes them, and says what accuracy costs.",
    "effects": "Leaves out one effect of a scene at a time, and says what each changes "
    "and costs.",
    "price": "Finds the cheapest mesh and steps for a relative error by a few short "
    "runs, says what they cost, and runs them.",
}

RESTART = {"yes": "--restart", "auto": "--restart=auto"}


class Parser(argparse.ArgumentParser):
    """Says what is wrong in one sentence."""

    def error(self, message):
        print(f"contrib/{self.prog}: {message}", file=sys.stderr)
        sys.exit(2)


def parser_of(task):
    parser = Parser(
        prog=task, description=USAGE[task] + " Finished runs are not computed again."
    )
    if task == "price":
        parser.add_argument("error", help="relative error from 1e-6 to 0.5", type=wanted)
    parser.add_argument(
        "files",
        nargs="+",
        metavar="scene.prm",
        help="parameter files, of which later ones override earlier ones",
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="'SECTION/ENTRY=VALUE'",
        help="override an entry of the files; may be repeated",
    )
    parser.add_argument("-n", dest="ranks", type=int, default=1, help="MPI ranks of runs")
    parser.add_argument("--log", metavar="FILE", help="write the messages to FILE, too")
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
    # Where the script learns of the directory of results.
    parser.add_argument("--directory", metavar="FILE", help=argparse.SUPPRESS)
    if task == "price":
        parser.add_argument("--check", action="store_true", help="only say the price")
        parser.add_argument(
            "--verbose", action="store_true", help="a line for each step of the run"
        )
        parser.add_argument(
            "--restart",
            choices=RESTART,
            help="go on from the last checkpoint of the run; =auto: if there is one",
        )
    return parser


def wanted(text):
    """The relative error that is asked for."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 1e-6 <= value <= 0.5:
        raise argparse.ArgumentTypeError(
            f"needs a relative error from 1e-6 to 0.5, such as 0.01, not '{text}'"
        )
    return value


def run(task, options, program):
    """The directory of the results."""
    from .effects import EffectsStudy
    from .ladder import Study
    from .pricing import run_at_price
    from .runs import StudyRuns
    from .words import Console

    console = Console(options.quiet, options.log)
    if task == "effects":
        study = EffectsStudy(program, options.files, options.set, console)
    else:
        runs = StudyRuns(program, options.files, options.set)
    if task == "price":
        names = ("quiet", "verbose")
        of_run = [f"--{name}" for name in names if getattr(options, name)]
        of_run += [RESTART[options.restart]] if options.restart else []
        return run_at_price(runs, options.error, console, options.check, of_run)
    if task == "study":
        study = Study(runs, console)
    study.run()
    return study.directory


def main(arguments):
    task = arguments[0] if arguments else ""
    if task not in USAGE:
        print(__doc__, file=sys.stderr)
        return 2
    # Without a value it would take the next argument for one.
    words = ["--restart=yes" if word == "--restart" else word for word in arguments[1:]]
    options = parser_of(task).parse_intermixed_args(words)
    # Between runs a signal ends the command at once.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        directory = run(task, options, Program(ranks=max(1, options.ranks)))
        if options.directory:
            Path(options.directory).write_text(str(Path(directory).resolve()))
        return 0
    except (UserError, OSError) as error:
        print(f"contrib/{task}: {error}", file=sys.stderr)
        code = getattr(error, "code", 1)
        return code if code in (1, 2, 3) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
