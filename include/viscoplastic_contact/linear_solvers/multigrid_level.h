// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/partitioner.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <viscoplastic_contact/linear_solvers/block_rows.h>

#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>

namespace Viscoplastic
{
  /**
   * A block of a level's matrix in the registers of any x86 or ARM processor:
   * four numbers at a time, which are a column of a 3 x 3 block and zero, or
   * both columns of a 2 x 2 block.
   */
  template <int dim>
  struct LevelBlock
  {
    using FourNumbers __attribute__((vector_size(16))) = float;

    FourNumbers columns[dim == 2 ? 1 : dim];

    LevelBlock() = default;

    explicit LevelBlock(const NodeBlock<dim> &block)
      : columns{}
    {
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          if (dim == 2)
            columns[0][j * dim + i] = block[i][j];
          else
            columns[j][i] = block[i][j];
    }

    float
    operator()(const unsigned int i, const unsigned int j) const
    {
      return dim == 2 ? columns[0][j * dim + i] : columns[j][i];
    }

    bool
    operator==(const LevelBlock &other) const
    {
      return std::memcmp(columns, other.columns, sizeof(columns)) == 0;
    }

    /// The same for equal blocks.
    std::size_t
    key() const
    {
      std::uint32_t bits[sizeof(columns) / 4];
      std::memcpy(bits, columns, sizeof(columns));
      std::size_t result = 0;
      for (const std::uint32_t part : bits)
        result = (result ^ part) * 0x9E3779B97F4A7C15U + (result >> 29);
      return result;
    }
  };


  /**
   * A mesh of a hierarchy as multigrid works on it: the owned rows of its
   * matrix and the interpolation from the mesh below, in single precision and
   * Cartesian components. Nodes have local numbers, the owned ones first.
   */
  template <int dim>
  class MultigridLevel
  {
  public:
    using Vector = LinearAlgebra::distributed::Vector<float>;

    /**
     * @p nodes: the owned ones; @p begins: the first node of each rank in the
     * last mesh, and the end; @p others: nodes of other ranks that vectors need
     * besides those of the matrix. Collective.
     */
    MultigridLevel(const BlockRows<dim>                   &matrix,
                   const std::vector<NodeHierarchy::Node> &nodes,
                   const std::vector<NodeHierarchy::Node> &others,
                   const std::vector<NodeHierarchy::Node> &begins,
                   const MPI_Comm                          communicator);

    /// By their numbers in the last mesh, ascending.
    const std::vector<NodeHierarchy::Node> &
    owned_nodes() const
    {
      return nodes;
    }

    /// The local number of a node that is owned or a ghost.
    unsigned int
    local_number(const NodeHierarchy::Node node) const;

    /// Consecutive over all ranks, by local number.
    types::global_dof_index
    global_number(const unsigned int node) const
    {
      return partitioner->local_to_global(node * dim) / dim;
    }

    /// Other values in the same pattern.
    void
    set_values(const BlockRows<dim> &matrix);

    /// Interpolation from the level @p coarser, of owned nodes.
    void
    set_interpolation(const Interpolation       &interpolation,
                      const MultigridLevel<dim> &coarser);

    /// The sum of the blocks of a row; springs at a node change it.
    NodeBlock<dim>
    row_sum(const unsigned int node) const;
    void
    set_row_sum(const unsigned int node, const NodeBlock<dim> &block);

    /// The block on the diagonal, with what couplings of ranks add to it for
    /// the smoother.
    NodeBlock<dim>
    smoothing_block(const unsigned int node) const;

    /// What Gauss-Seidel multiplies residuals by.
    void
    set_inverse_block(const unsigned int node, const NodeBlock<dim> &block);

    /// One sweep of Gauss-Seidel for A x = b: forward from x = 0, or backward.
    /// Ranks do not wait for each other.
    void
    smooth_forward_from_zero(Vector &x, const Vector &b) const;
    void
    smooth_backward(Vector &x, const Vector &b) const;

    /// r := b - A x on owned nodes.
    void
    residual(Vector &r, Vector &x, const Vector &b) const;

    /// coarse := P^T fine, without changing @p fine.
    void
    restrict_to_coarse(Vector &coarse, const Vector &fine) const;

    /// fine := P coarse; needs ghosts of @p coarse.
    void
    interpolate(Vector &fine, Vector &coarse) const;

    /// Vectors of a cycle.
    mutable Vector x, b, r;

  private:
    /**
     * rest := b_i - sum_j A_ij x_j over the diagonal and the first @p n
     * neighbors, as b_i - (sum_j A_ij) x_i - sum A_ij (x_j - x_i): of a smooth
     * x the products cancel, all the more in long thin cells, and with them the
     * digits that single precision has.
     */
    void
    row_residual(const unsigned int i,
                 const unsigned int n,
                 const float       *x,
                 const float       *b,
                 float             *rest) const;

    std::vector<NodeHierarchy::Node>                   nodes, ghosts;
    NodeHierarchy::Node                                begin, end;
    unsigned int                                       n_owned;
    std::shared_ptr<const Utilities::MPI::Partitioner> partitioner;
    bool                                               is_serial;

    /// A row without the diagonal: columns of lower owned nodes first, and
    /// where the values begin.
    struct Row
    {
      std::size_t  columns, values;
      unsigned int n_lower, n;
    };
    std::vector<Row>          rows;
    std::vector<unsigned int> columns;
    /// Rows with the same values, of which uniform meshes have many, share
    /// them: what is read in a sweep is what a sweep costs.
    std::vector<LevelBlock<dim>> values, row_sums, inverse;

    std::vector<std::size_t>  parent_begin;
    std::vector<unsigned int> parents;
    std::vector<float>        weights;
  };


  /// The answer of the owner of each node to a question. Collective.
  std::vector<std::vector<NodeHierarchy::Parent>>
  ask_owners(const std::vector<NodeHierarchy::Node> &nodes,
             const std::vector<NodeHierarchy::Node> &begins,
             const MPI_Comm                          communicator,
             const std::function<std::vector<NodeHierarchy::Parent>(
               const NodeHierarchy::Node)>          &answer);
} // namespace Viscoplastic
