// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/stress_history.h>

namespace Viscoplastic
{
  /**
   * The residual estimator for the friction inequality of one step,
   *
   *     eta_K^2 = ( h_K^2 |b + div E eps(u_h)|^2
   *                 + sum_e 1/2 h_e |[sigma_h nu]|^2     interior faces
   *                 + h_e |F - sigma_h nu|^2             Gamma_2
   *                 + h_e |lambda_h + (sigma_h nu)_tau|^2
   *                 + h_e |S - sigma_nu|^2 ) / (2 mu),   Gamma_3
   *
   * with L2 norms on cell and faces, sigma_h = E eps(u_h) + z_h and z_h the
   * cell means of z. The scaling makes the sum comparable to the squared error
   * in the energy norm. On Gamma_3 the normal part appears where the normal
   * stress is given. Where only some components of u are prescribed, the
   * residual of the others counts with F = 0 (symmetry: the tangential ones).
   *
   * The terms of complementarity and of violated bounds are zero: the contact
   * solver's multipliers satisfy the friction law to rounding.
   *
   * The estimate bounds the error of one step for given z; the error that has
   * accumulated in z is not part of it.
   *
   * Returns an entry for each active cell, zero on cells of other ranks.
   * @p z may be empty. @p multiplier_density is the nodal field lambda_h on
   * Gamma_3, Cartesian with ghosts, and null without friction. Collective.
   */
  template <int dim>
  Vector<double>
  residual_estimate(const StressSampling<dim> &sampling,
                    const DistributedVector   &ghosted_u,
                    const IrreversibleStress  &z,
                    const double               t,
                    const DistributedVector   *multiplier_density);

  /// Squared jumps of the displacement gradient after Kelly, weighted by the
  /// cell size; the layout of residual_estimate().
  template <int dim>
  Vector<double>
  kelly_estimate(const AdmissibleSpace<dim> &space,
                 const DistributedVector    &ghosted_u);

  /// The root of the sum over all cells of all ranks. Collective.
  double
  total_estimate(const Vector<double> &squared_estimate, const MPI_Comm comm);
} // namespace Viscoplastic
