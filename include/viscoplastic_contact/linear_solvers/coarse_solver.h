// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/linear_solvers/level_masks.h>

namespace Viscoplastic
{
  /// The solver on the coarsest level of a multigrid cycle, exact or
  /// approximate, in Cartesian components: a symmetric operator, positive
  /// definite on the free directions. All calls are collective.
  template <int dim>
  class CoarseSolver
  {
  public:
    using Masking = typename LevelMasks<dim>::Masking;
    using Mask    = typename LevelMasks<dim>::Mask;
    using Vector  = typename MultigridLevel<dim>::Vector;

    virtual ~CoarseSolver() = default;

    /// Whether a solution is exact and needs no smoothing.
    virtual bool
    is_exact() const = 0;

    /// Take the masks of owned nodes for one kind of cycle. Where this would
    /// cost a set-up, @p may_rebuild allows it. Returns whether one was made.
    virtual bool
    set_masks(const Masking            masking,
              const std::vector<Mask> &masks,
              const bool               may_rebuild) = 0;

    /// Make the next set_masks() of this kind set up anew.
    virtual void
    forget(const Masking masking) = 0;

    /// x := M^{-1} b, where @p b is zero on what is not free; entries of @p x
    /// there mean nothing.
    virtual void
    solve(const Masking masking, Vector &x, const Vector &b) const = 0;
  };
} // namespace Viscoplastic
