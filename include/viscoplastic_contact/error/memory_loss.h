// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/discretization/stress_space.h>

namespace Viscoplastic
{
  /// Return the norm of what z loses when the cells marked are coarsened,
  ///
  ///     ( int E^-1 (z - z_H) : (z - z_H) )^{1/2},
  ///
  /// with the projection z_H of z to the coarser cells. It bounds the resulting
  /// error e of u in the energy norm, since a(e, v) = -(z - z_H, eps(v)).
  /// Refined cells lose nothing. Zero without z. Collective.
  template <int dim>
  double
  memory_loss(const parallel::distributed::Triangulation<dim> &triangulation,
              const StressSpace<dim>                          &stress_space,
              const IrreversibleStress                        &z);

  /// Withdraw marks from the families of cells that lose most until
  /// memory_loss() of the others is at most @p allowed. Collective.
  template <int dim>
  void
  limit_memory_loss(parallel::distributed::Triangulation<dim> &triangulation,
                    const StressSpace<dim>                    &stress_space,
                    const IrreversibleStress                  &z,
                    const double                               allowed);
} // namespace Viscoplastic
