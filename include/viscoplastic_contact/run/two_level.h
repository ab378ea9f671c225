// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/parameters/parameter_file.h>
#include <viscoplastic_contact/results/run_summary.h>
#include <viscoplastic_contact/run/command_line.h>

#include <string>
#include <vector>

namespace Viscoplastic
{
  /**
   * The assignments `Section/Entry=value' that make a scene coarser: one
   * refinement less, on adaptive meshes also of the least and the finest cells,
   * and half the steps of every phase, but at least one. Throws ExcMessage if
   * `Geometry/Global refinements' is 0.
   */
  std::vector<std::string>
  coarser_scene(const Parameters &parameters);

  /// Run the coarser scene without a word and without files. Throws ExcMessage
  /// as a run does. Collective.
  template <int dim>
  RunSummary<dim>
  run_coarser_scene(const Parameters  &parameters,
                    const CommandLine &command_line);
} // namespace Viscoplastic
