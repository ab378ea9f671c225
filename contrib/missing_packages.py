# SPDX-License-Identifier: LGPL-2.1-or-later
"""To be imported by the commands of contrib before packages that this Python may lack:
then they end with a sentence instead of a traceback."""

import sys

DEBIAN = {"vtkmodules": "python3-vtk9", "mpl_toolkits": "python3-matplotlib"}


def explain(kind, error, traceback):
    name = (getattr(error, "name", None) or "").split(".")[0]
    if not issubclass(kind, ModuleNotFoundError) or not name:
        sys.__excepthook__(kind, error, traceback)
        return
    package = DEBIAN.get(name, f"python3-{name}")
    print(
        f"Error: {sys.executable} has no {name} (Debian: {package}); install it, or "
        f"take another Python: /usr/bin/python3 {sys.argv[0]} ...",
        file=sys.stderr,
    )


sys.excepthook = explain
