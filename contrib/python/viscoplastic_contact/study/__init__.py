# SPDX-License-Identifier: LGPL-2.1-or-later
"""What accuracy costs and what effects are worth: studies of many runs of a scene.

    ladder    refinement studies (contrib/study)
    pricing   the cheapest run for an error (contrib/price)
    effects   ablation: what each effect changes and costs (contrib/effects)

They stand on

    scene, runs        what the program says of a scene; its runs and their records
    record, histories  numbers of a finished run, and their differences
    fit, cost, price, analysis
                       laws of errors and costs, and what follows from them
    variants           what can be left out of a scene
    report, markdown, effects_report, words
                       tables and sentences

Needs numpy and scipy. pandas is not used: tables are columns of numbers, which NumPy
reads, and it would be one more package to install.
"""
