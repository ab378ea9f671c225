// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/sparse_direct.h>
#include <deal.II/lac/sparse_matrix.h>

#include <viscoplastic_contact/linear_solvers/coarse_solver.h>

#include <array>
#include <memory>
#include <vector>

namespace Viscoplastic
{
  /// A direct solver (UMFPACK) for a small coarsest level. Each rank factorizes
  /// the whole matrix.
  template <int dim>
  class DirectCoarseSolver : public CoarseSolver<dim>
  {
  public:
    using typename CoarseSolver<dim>::Mask;
    using typename CoarseSolver<dim>::Masking;
    using typename CoarseSolver<dim>::Vector;

    /// @p rows: the owned matrix rows of @p level.
    DirectCoarseSolver(const BlockRows<dim>      &rows,
                       const MultigridLevel<dim> &level,
                       const MPI_Comm             communicator);

    bool
    is_exact() const override
    {
      return true;
    }

    /// Factorizes, unless the masks are those of the last factorization.
    bool
    set_masks(const Masking            masking,
              const std::vector<Mask> &masks,
              const bool               may_rebuild) override;

    void
    forget(const Masking masking) override
    {
      factors[masking].factor.reset();
    }

    void
    solve(const Masking masking, Vector &x, const Vector &b) const override;

  private:
    struct Entry
    {
      NodeHierarchy::Node row, column;
      NodeBlock<dim>      block;

      template <class Archive>
      void
      serialize(Archive &archive, const unsigned int)
      {
        archive &row &column &block;
      }
    };

    struct Factor
    {
      std::vector<Mask>                    masks;
      SparseMatrix<double>                 matrix;
      std::unique_ptr<SparseDirectUMFPACK> factor;
    };

    const MultigridLevel<dim> &level;
    const MPI_Comm             communicator;
    const NodeHierarchy::Node  n_nodes;
    std::vector<Entry>         matrix;
    SparsityPattern            pattern;
    std::array<Factor, 2>      factors; // by masking
  };
} // namespace Viscoplastic
