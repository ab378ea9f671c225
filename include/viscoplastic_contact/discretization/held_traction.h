// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/la_parallel_vector.h>

#include <viscoplastic_contact/discretization/admissible_space.h>

#include <set>

namespace Viscoplastic
{
  /// Return int phi over the boundaries @p ids, with the basis functions phi
  /// that hanging-node constraints leave, at the first entry of each node.
  /// Collective.
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
    /// Keeps a reference to the argument. Collective.
    explicit HeldTraction(const AdmissibleSpace<dim> &space);

    /// Whether the scene has interfaces that are glued or bilateral.
    static bool
    is_needed(const Scene<dim> &scene);

    /// Add the nodal density lambda_p/m_p, Cartesian with ghosts, and that of
    /// the reverse forces on the other side, like ContactFace::density().
    /// @p missing is the residual L(v) - (sigma_h, eps(v)), in frames; an empty
    /// @p density counts as zero. Collective.
    void
    add_density(const DistributedVector &missing,
                DistributedVector       &density) const;

  private:
    const AdmissibleSpace<dim> &space;
    /// int phi over both sides of the interfaces.
    LinearAlgebra::distributed::Vector<double> weights;
  };
} // namespace Viscoplastic
