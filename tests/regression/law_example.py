# SPDX-License-Identifier: LGPL-2.1-or-later
"""The shared library of doc/adding_a_law.md, built as that page says."""

import os
import re
import subprocess

from harness import SOURCE

PAGE = SOURCE / "doc" / "adding_a_law.md"


def blocks(language=""):
    """The texts of the blocks of the page in a language."""
    found = re.findall(r"^```(\w*)\n(.*?)^```$", PAGE.read_text(), re.M | re.S)
    return [text for name, text in found if name == language]


def scene_block():
    """What the page writes into a scene."""
    (block,) = (b for b in blocks() if "Additional shared libraries" in b)
    return block


def write_project(directory):
    law, library = blocks("cpp")[:2]
    (directory / "garofalo.cc").write_text(law)
    (directory / "garofalo_library.cc").write_text(library)
    (project,) = blocks("cmake")
    (directory / "CMakeLists.txt").write_text(project)


def build(directory, *options):
    """The library, from the project in a directory; options are for cmake. What ccache
    keeps for it (see python_test_environment) holds for directories of other names."""
    build = directory / "build"
    environment = {**os.environ, "CCACHE_BASEDIR": str(directory.parent)}
    for command in (
        ["cmake", "-S", directory, "-B", build, *options], ["cmake", "--build", build]
    ):
        process = subprocess.run(
            list(map(str, command)),
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        if process.returncode != 0:
            raise AssertionError(f"{command}:\n{process.stdout}")
    return build / "garofalo.so"
