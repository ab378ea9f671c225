// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/linear_solvers/coarse_solver.h>
#include <viscoplastic_contact/linear_solvers/smoothed_aggregation.h>

#include <array>
#include <memory>
#include <vector>

namespace Viscoplastic
{
  /// One cycle of smoothed aggregation for a first level that is large, as
  /// meshes from files are.
  ///
  /// It is built for the masks of its first use and kept while they change,
  /// until a tenth of them lets other directions free. Meanwhile its
  /// corrections are cut to what is free, and the sweeps around it know the
  /// present masks and springs. Cycles with the same masks, as without
  /// friction, share one.
  template <int dim>
  class AlgebraicCoarseSolver : public CoarseSolver<dim>
  {
  public:
    using typename CoarseSolver<dim>::Mask;
    using typename CoarseSolver<dim>::Masking;
    using typename CoarseSolver<dim>::Vector;

    /// @p rows: the owned ones of @p level; @p rigid_body_modes: on its owned
    /// entries, one after the other.
    AlgebraicCoarseSolver(const BlockRows<dim>      &rows,
                          const MultigridLevel<dim> &level,
                          const std::vector<double> &rigid_body_modes,
                          const MPI_Comm             communicator);

    bool
    is_exact() const override
    {
      return false;
    }

    bool
    set_masks(const Masking            masking,
              const std::vector<Mask> &masks,
              const bool               may_rebuild) override;

    void
    forget(const Masking masking) override
    {
      cycles[masking].aggregation.reset();
    }

    void
    solve(const Masking masking, Vector &x, const Vector &b) const override;

  private:
    struct Cycle
    {
      std::vector<Mask>                    built_for;
      std::shared_ptr<SmoothedAggregation> aggregation;
    };

    void
    build(const std::vector<Mask> &masks, Cycle &cycle) const;

    const BlockRows<dim>       rows;
    const MultigridLevel<dim> &level;
    const std::vector<double> &rigid_body_modes;
    const MPI_Comm             communicator;
    std::array<Cycle, 2>       cycles; // by masking
    mutable DistributedVector  source, solution;
  };
} // namespace Viscoplastic
