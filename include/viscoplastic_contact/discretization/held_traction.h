// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/la_parallel_vector.h>

#include <viscoplastic_contact/discretization/admissible_space.h>

#include <set>

namespace Viscoplastic
{
  /// int phi over some boundaries, of the basis functions that hanging nodes
  /// leave, at the first entry of each node. Collective.
  template <int dim>
  LinearAlgebra::distributed::Vector<double>
  boundary_weights(const AdmissibleSpace<dim>         &space,
                   const std::set<types::boundary_id> &ids);


  /// The traction at interfaces without contact points: all of it where bodies
  /// are glued, the normal part in bilateral contact. It is the residual of the
  /// equations of the prescribed jumps.
  template <int dim>
  class HeldTraction
  {
  public:
    /// The argument stays in use. Collective.
    explicit HeldTraction(const AdmissibleSpace<dim> &space);

    static bool
    is_needed(const Scene<dim> &scene);

    /// Add the nodal density lambda_p/m_p, Cartesian with ghosts, as
    /// ContactFace::density() has those of contact points: with the reverse
    /// forces on the other side. @p missing is L(v) - (sigma_h, eps(v)), in
    /// frames; @p density may be empty before. Collective.
    void
    add_density(const DistributedVector &missing,
                DistributedVector       &density) const;

  private:
    const AdmissibleSpace<dim> &space;
    /// int phi over both sides of the interfaces.
    LinearAlgebra::distributed::Vector<double> weights;
  };
} // namespace Viscoplastic
