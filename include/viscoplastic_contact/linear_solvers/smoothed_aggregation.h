// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/trilinos_sparse_matrix.h>

#include <viscoplastic_contact/base/linear_algebra.h>

#include <memory>
#include <vector>

namespace dealii::TrilinosWrappers
{
  class PreconditionAMG;
}

namespace Viscoplastic
{
  /// A cycle of smoothed aggregation (Vanek, Mandel and Brezina, Computing 56,
  /// 1996; Trilinos' ML) for a symmetric positive definite matrix of
  /// elasticity: Chebyshev smoothers, a direct solver on the last level. The
  /// same matrix always gives the same cycle, whatever was set up earlier.
  class SmoothedAggregation
  {
  public:
    /// @p near_null_space: rigid body modes on owned entries, one after the
    /// other, zero at constrained degrees of freedom; @p dim degrees of freedom
    /// a node. Collective.
    SmoothedAggregation(std::unique_ptr<TrilinosWrappers::SparseMatrix> matrix,
                        std::vector<double> near_null_space,
                        const unsigned int  dim);
    ~SmoothedAggregation();

    /// y := M^{-1} x.
    void
    vmult(DistributedVector &y, const DistributedVector &x) const;

  private:
    // ML keeps references to these two.
    std::unique_ptr<TrilinosWrappers::SparseMatrix> matrix;
    std::vector<double>                             near_null_space;
    /// The unit of stiffness by which the matrix is divided.
    double                                             unit = 1.;
    std::unique_ptr<TrilinosWrappers::PreconditionAMG> amg;
  };
} // namespace Viscoplastic
