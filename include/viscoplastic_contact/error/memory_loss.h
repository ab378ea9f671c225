// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/discretization/stress_space.h>

namespace Viscoplastic
{
  /// What z loses when the cells that are marked are coarsened,
  ///
  ///     ( int E^-1 (z - z_H) : (z - z_H) )^{1/2},
  ///
  /// with z_H its projection to the coarser cells. It bounds what that does to
  /// the error of u in the energy norm, a(e, v) = -(z - z_H, eps(v)). Refined
  /// cells lose nothing. Zero without z. Collective.
  template <int dim>
  double
  memory_loss(const parallel::distributed::Triangulation<dim> &triangulation,
              const StressSpace<dim>                          &stress_space,
              const IrreversibleStress                        &z);

  /// Withdraw marks from the families that lose most until the others lose at
  /// most @p allowed together. Collective.
  template <int dim>
  void
  limit_memory_loss(parallel::distributed::Triangulation<dim> &triangulation,
                    const StressSpace<dim>                    &stress_space,
                    const IrreversibleStress                  &z,
                    const double                               allowed);
} // namespace Viscoplastic
