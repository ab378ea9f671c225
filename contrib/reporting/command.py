# SPDX-License-Identifier: LGPL-2.1-or-later
"""The command line of contrib/report."""

import argparse
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # draws to files, also without a display

from plotting import style
from plotting.results import UserError

from . import run, written

DESCRIPTION = """\
Make one HTML page of a directory of results, RESULTS/<its name>.html: what was
computed, the body to turn with its fields over time, results, curves, the
estimated error, where the seconds went, balances, warnings and how to do it
again. The page needs nothing beside it, no network, and a browser of 2023 or
later.

The directory of a study (with study.md), of a price (price.md) or of a study of
effects (effects.md) gets a page with its tables and pictures.
"""
EPILOG = """\
examples:
  contrib/report output/block
  contrib/report output/block --output block.html
  contrib/report output/block/study
"""


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog="contrib/report",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "results", type=Path, metavar="RESULTS", help="directory of results"
    )
    parser.add_argument(
        "--output", type=Path, metavar="FILE", help="where the page goes"
    )
    return parser.parse_args(arguments)


def main(arguments=None):
    options = parse(arguments)
    style.set_up()
    try:
        kind = written.kind_of(options.results)
        is_written = kind and not written.has_run(options.results)
        page = (written if is_written else run).page(options.results)
        directory = options.results.resolve()
        path = options.output or directory / f"{kind or directory.name}.html"
        path.write_text(page.html(), encoding="utf-8")
    except (UserError, OSError) as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1
    print(path)
    return 0
