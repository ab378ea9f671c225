// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/state.h>
#include <viscoplastic_contact/discretization/stress_space.h>

namespace Viscoplastic
{
  /**
   * The estimate of Zienkiewicz and Zhu: how far the strain eps_h of u_h is
   * from a continuous one, eps*, whose values at the nodes are means of the
   * cells around them, weighted by volume (materials apart),
   *
   *     eta_K^2 = int_K (eps* - eps_h) : E (eps* - eps_h).
   *
   * Returns eta_K^2 by active cell; zero in cells of other ranks. No bound, and
   * blind to what goes on in the law of friction; but without a constant, and
   * exact in the limit where solutions are smooth and meshes regular: something
   * to compare the residual estimator with. Collective.
   */
  template <int dim>
  Vector<double>
  squared_recovery_estimate(const StressSpace<dim> &stress_space,
                            const State<dim>       &state);
} // namespace Viscoplastic
