// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/sparse_direct.h>
#include <deal.II/lac/sparse_matrix.h>
#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/linear_solvers/block_rows.h>

#include <memory>

namespace Viscoplastic
{
  template <int dim>
  Tensor<2, dim>
  identity()
  {
    Tensor<2, dim> result;
    for (unsigned int i = 0; i < dim; ++i)
      result[i][i] = 1.;
    return result;
  }


  /// A on the range of a projector, and a multiple of the identity, of the size
  /// of A, on its kernel.
  template <int dim>
  Tensor<2, dim>
  on_range(const Tensor<2, dim> &A, const Tensor<2, dim> &projector)
  {
    const double size = trace(A) > 0. ? trace(A) / dim : 1.;
    return projector * A * projector + size * (identity<dim>() - projector);
  }


  /**
   * The matrix of the first level of a multigrid cycle, on all ranks, with a
   * direct solver (UMFPACK) for what is free of it. Nodes are numbered over all
   * ranks.
   */
  template <int dim>
  class CoarseProblem
  {
  public:
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

    /// The projector onto what is free at a node, and springs there.
    struct Mask
    {
      NodeHierarchy::Node node;
      Tensor<2, dim>      free, spring;

      bool
      operator==(const Mask &other) const
      {
        return node == other.node && free == other.free &&
               spring == other.spring;
      }

      template <class Archive>
      void
      serialize(Archive &archive, const unsigned int)
      {
        archive &node &free &spring;
      }
    };

    /// @p entries: those of owned rows. Collective.
    CoarseProblem(const std::vector<Entry> &entries,
                  const NodeHierarchy::Node n_nodes,
                  const MPI_Comm            communicator);

    /// A factorization with masks.
    struct Factor
    {
      std::vector<Mask>                    masks;
      SparsityPattern                      pattern;
      SparseMatrix<double>                 matrix;
      std::unique_ptr<SparseDirectUMFPACK> factor;
    };

    /// Factorize with the masks of owned nodes; nothing is done if these are
    /// the masks of @p factor already. Collective.
    void
    factorize(const std::vector<Mask> &masks, Factor &factor) const;

    NodeHierarchy::Node
    n_unknowns() const
    {
      return n_nodes * dim;
    }

  private:
    const NodeHierarchy::Node n_nodes;
    const MPI_Comm            communicator;
    std::vector<Entry>        matrix;
  };
} // namespace Viscoplastic
