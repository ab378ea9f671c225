// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/state.h>
#include <viscoplastic_contact/discretization/stress_space.h>
#include <viscoplastic_contact/error/solution_norms.h>

namespace Viscoplastic
{
  /// Errors of a state against the exact solution at its time, and the norms of
  /// that solution.
  struct SolutionErrors
  {
    /// Norms of u - u_h, of sigma - sigma_h with cell means sigma_h, and of
    /// lambda - lambda_h with lambda = -sigma_tau and nodal densities lambda_h.
    SolutionNorms error, exact;
    /// (int E^-1 (z - z_h) : (z - z_h))^(1/2): the errors of earlier steps and,
    /// with cell means, what z varies by in cells. A history at quadrature
    /// points is compared at these points only.
    double memory = 0.;
    /// The estimate of the error in the energy norm by
    /// squared_recovery_estimate().
    double recovery = 0.;
    /// The squared error in the energy norm by active cell, of owned cells.
    Vector<double> squared_energy_by_cell;
  };

  /// The norms whose squares are the sums of @p squares over all ranks.
  /// Collective.
  SolutionNorms
  square_roots(const SolutionNorms &squares, const MPI_Comm communicator);

  /// Return the errors by Gauss quadrature with three points in each direction;
  /// `recovery' is not set. Norms of stress, multiplier and memory are zero if
  /// the solution has no stress. @p multiplier_density is null without contact
  /// points. Collective.
  template <int dim>
  SolutionErrors
  solution_errors(const StressSpace<dim>  &stress_space,
                  const State<dim>        &state,
                  const DistributedVector *multiplier_density);

  /// Check that the exact solution satisfies the conditions of its scene on
  /// clamped, symmetry and contact pieces and the friction law on Gamma_3, at
  /// the times of some 20 steps, and that its rates exist.
  ///
  /// Throws ExcMessage naming boundary, place, time and what is violated. Each
  /// rank checks its own cells and does not wait for others.
  template <int dim>
  void
  check_exact_solution(const AdmissibleSpace<dim> &space);
} // namespace Viscoplastic
