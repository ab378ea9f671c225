// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_layout.h>

#include <vector>

namespace Viscoplastic
{
  /// The coefficients of friction bounds that depend on the pressures p_k >= 0
  /// of the obstacles of the same node:
  ///
  ///     rho_c = g_c + sum_k mu_ck p_k
  struct CoulombCoefficients
  {
    /// g_c, point by point; of no meaning for obstacles.
    std::vector<double> given;
    /// mu_ck, in the order of the obstacles of the node.
    std::vector<std::vector<double>> of_pressure;

    /// The bound of a point of friction at the pressures of @p state.
    double
    bound(const ContactLayout &face,
          const ContactState  &state,
          const unsigned int   point) const
    {
      double       result = given[point];
      unsigned int o      = face.first_obstacle(face.points[point].node);
      for (const double coefficient : of_pressure[point])
        result += coefficient * state.multiplier[o++][0];
      return result;
    }
  };
} // namespace Viscoplastic
