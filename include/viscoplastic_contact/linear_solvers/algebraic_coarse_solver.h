// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/linear_solvers/coarse_solver.h>
#include <viscoplastic_contact/linear_solvers/smoothed_aggregation.h>

#include <array>
#include <memory>
#include <vector>

namespace Viscoplastic
{
  /// A coarse solver for a coarsest level that is large, as meshes from files
  /// are: one cycle of smoothed aggregation.
  ///
  /// A cycle is built for the masks of its first use and kept until the free
  /// directions of more than a tenth of the masks have changed. Meanwhile the
  /// caller projects its corrections onto the free directions, and the smoother
  /// uses the present masks and springs. Truncated and untruncated cycles with
  /// equal masks, as without friction, share one.
  template <int dim>
  class AlgebraicCoarseSolver : public CoarseSolver<dim>
  {
  public:
    using typename CoarseSolver<dim>::Mask;
    using typename CoarseSolver<dim>::Masking;
    using typename CoarseSolver<dim>::Vector;

    /// @p rows: the owned matrix rows of @p level; @p rigid_body_modes: one
    /// after the other, each on the owned entries of @p level.
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
