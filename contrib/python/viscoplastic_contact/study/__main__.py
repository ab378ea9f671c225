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
# What the program is told of --restart.
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
    add = parser.add_argument
    if task == "price":
        add("error", help="relative error from 1e-6 to 0.5", type=wanted)
    files = "parameter files, of which later ones override earlier ones"
    add("files", nargs="+", metavar="scene.prm", help=files)
    entry = "override an entry of the files; may be repeated"
    name = "'SECTION/ENTRY=VALUE'"
    add("--set", action="append", default=[], metavar=name, help=entry)
    add("-n", dest="ranks", type=int, default=1, help="MPI ranks of runs")
    add("--log", metavar="FILE", help="write the messages to FILE, too")
    add("--quiet", action="store_true", help="print nothing but errors")
    # Where the script learns of the directory of results.
    add("--directory", metavar="FILE", help=argparse.SUPPRESS)
    if task == "price":
        add("--check", action="store_true", help="only say the price")
        add("--verbose", action="store_true", help="a line for each step of the run")
        restart = "go on from the last checkpoint of the run; =auto: if there is one"
        add("--restart", choices=RESTART, help=restart)
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
    from .pricing import Pricing
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
        study = Pricing(runs, options.error, console)
        study.run(options.check, of_run)
        return study.directory
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
