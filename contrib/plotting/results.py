# SPDX-License-Identifier: LGPL-2.1-or-later
"""What pictures need of results, which the module in contrib/python reads."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))

from viscoplastic_contact.results import NotAvailable as NoPicture
from viscoplastic_contact.results import (
    Record,
    Results,
    by_numbers,
    is_empty,
    number,
    pieces,
    read_parameters,
    read_statistics,
    series,
)
from viscoplastic_contact.tables import (
    LEVELS,
    VARIANT,
    UserError,
    read_effects,
    read_study_about,
    read_study_table,
)
