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
    /// u - u_h; sigma - sigma_h with the cell means sigma_h; lambda - lambda_h
    /// with lambda = -sigma_tau and the nodal densities lambda_h.
    SolutionNorms error, exact;
    /// (int E^-1 (z - z_h) : (z - z_h))^(1/2): what the steps before this one
    /// have left, and what cell means cannot hold. A history at quadrature
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

  /// The errors by quadrature with three points in each direction, without the
  /// recovery's. Norms of stress, multiplier and memory stay zero where the
  /// solution has no stress. @p multiplier_density is null without contact
  /// points. Collective.
  template <int dim>
  SolutionErrors
  solution_errors(const StressSpace<dim>  &stress_space,
                  const State<dim>        &state,
                  const DistributedVector *multiplier_density);

  /// Hold the exact solution against the scene whose data it makes: what is
  /// prescribed on clamped, symmetry and contact pieces, the friction law on
  /// Gamma_3, and whether its rates exist. At the times of some 20 steps.
  ///
  /// Throws ExcMessage naming boundary, place, time and what is violated.
  /// Collective: a rank that finds nothing wrong does not wait for others.
  template <int dim>
  void
  check_exact_solution(const AdmissibleSpace<dim> &space);
} // namespace Viscoplastic
