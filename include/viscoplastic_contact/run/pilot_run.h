// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/parameters/parameter_file.h>

namespace Viscoplastic
{
  /**
   * About how large the solution of a scene becomes, in the energy norm or by
   * its quantity of interest: in a run on its first mesh with at most eight
   * steps for each phase. A run to a relative tolerance has to know it before
   * its first step. Zero, and @p failure says why, if that run fails.
   * Collective.
   */
  template <int dim>
  double
  size_in_pilot_run(const Parameters &parameters, std::string &failure);
} // namespace Viscoplastic
