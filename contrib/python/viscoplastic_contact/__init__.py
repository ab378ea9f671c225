# SPDX-License-Identifier: LGPL-2.1-or-later
"""Scenes, runs and results of viscoplastic_contact from Python.

    from viscoplastic_contact import Program, Results

    scene     parameter files from nested dictionaries
    program   running them; what the program refuses is raised as RunError
    results   what a run wrote, as NumPy arrays, or pandas where it is installed
    tables    what studies wrote

doc/python.md has examples. Needs numpy, and meshio for fields.
"""

from .program import Program, StudyResults
from .results import NotAvailable, Record, Results, read_parameters, read_statistics
from .scene import scene_text, write_scene
from .tables import RunError, UserError, read_effects, read_study_about, read_study_table
