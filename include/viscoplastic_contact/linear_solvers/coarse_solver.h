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

    /// Set the masks of owned nodes for one kind of cycle. Inexact solvers
    /// replace a set-up only if @p may_rebuild. Returns whether one was made.
    virtual bool
    set_masks(const Masking            masking,
              const std::vector<Mask> &masks,
              const bool               may_rebuild) = 0;

    /// Discard the set-up, so that the next set_masks() makes a new one.
    virtual void
    forget(const Masking masking) = 0;

    /// Compute x := M^{-1} b, where @p b is zero in directions that are not
    /// free; the components of @p x in these are arbitrary.
    virtual void
    solve(const Masking masking, Vector &x, const Vector &b) const = 0;
  };
} // namespace Viscoplastic
