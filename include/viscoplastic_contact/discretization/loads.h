// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/admissible_space.h>

#include <set>
#include <vector>

namespace Viscoplastic
{
  /// The id under which the body force b is listed among the boundaries with
  /// loads.
  constexpr types::boundary_id body_force_id = numbers::invalid_boundary_id;



  /// The loads at one time.
  template <int dim>
  struct Load
  {
    /// L(t, .) in nodal frames.
    DistributedVector values;
    /// The resultant force of b, F, p and S.
    Tensor<1, dim> resultant;
    /// The boundaries whose loads are not zero everywhere. The same on all
    /// ranks.
    std::set<types::boundary_id> acting;
  };


  /// The load functional
  ///
  ///     L(t,v) = int b.v + int_Gamma2 (F - p nu).v + int_Gamma3 S v_nu
  ///
  /// and, in generalized plane strain, N eps_zz(v), with nu as it is on the
  /// faces of the mesh. Parts that do not depend on time are integrated once.
  template <int dim>
  class Loads
  {
  public:
    explicit Loads(const AdmissibleSpace<dim> &space);

    /// Return the loads at time t. Collective.
    Load<dim>
    assemble(const double t) const;

  private:
    using Cell = typename DoFHandler<dim>::active_cell_iterator;

    struct Face
    {
      Cell                          cell;
      unsigned int                  face;
      const BoundaryCondition<dim> *condition;
    };

    /// Add the part of the load that does or does not depend on time.
    void
    add(const double t, const bool time_dependent, Load<dim> &load) const;

    const AdmissibleSpace<dim> &space;
    std::vector<Face>           faces; // owned, with F, p or S
    Load<dim>                   constant;
  };
} // namespace Viscoplastic
