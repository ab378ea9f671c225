// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/parameters/parameter_file.h>
#include <viscoplastic_contact/run/expectation.h>

namespace Viscoplastic
{
  /**
   * By runs of the scene without files. One on the first mesh with at most
   * eight steps for each phase tells the size. For the tolerance of a quantity
   * of interest on adaptive meshes, all steps are made once, and the first
   * mesh is refined as the last one of this run: what creeps or slips remembers
   * each mesh, as the estimate of a quantity does not. The displacement of a
   * body that creeps does so most of all, so that this run begins again on each
   * new mesh. Arguments stay in use.
   */
  template <int dim>
  RunsAhead<dim>
  runs_ahead(const Parameters &parameters, Console &console);
} // namespace Viscoplastic
