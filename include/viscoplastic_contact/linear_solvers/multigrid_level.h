// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/partitioner.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <viscoplastic_contact/linear_solvers/shared_rows.h>

#include <functional>
#include <memory>

namespace Viscoplastic
{
  /// A level of multigrid: the owned rows of its matrix and the interpolation
  /// from the next coarser level, in single precision and Cartesian components.
  /// Nodes have local numbers, the owned ones first.
  template <int dim>
  class MultigridLevel
  {
  public:
    using Vector = LinearAlgebra::distributed::Vector<float>;

    /// @p nodes: the owned ones; @p begins: the first node of each rank on the
    /// finest mesh, and the end; @p others: nodes of other ranks that vectors
    /// need in addition to those of the matrix. Collective.
    MultigridLevel(const BlockRows<dim>                   &matrix,
                   const std::vector<NodeHierarchy::Node> &nodes,
                   const std::vector<NodeHierarchy::Node> &others,
                   const std::vector<NodeHierarchy::Node> &begins,
                   const MPI_Comm                          communicator);

    /// Return the level's nodes by their numbers on the finest mesh, ascending.
    const std::vector<NodeHierarchy::Node> &
    owned_nodes() const
    {
      return nodes;
    }

    unsigned int
    local_number(const NodeHierarchy::Node node) const;

    std::vector<unsigned int>
    local_numbers(const std::vector<NodeHierarchy::Node> &nodes) const;

    /// Return a local node's number, consecutive over all ranks.
    types::global_dof_index
    global_number(const unsigned int node) const
    {
      return partitioner->local_to_global(node * dim) / dim;
    }

    /// Set other values in the same sparsity pattern.
    void
    set_values(const BlockRows<dim> &matrix);

    void
    set_interpolation(const Interpolation       &interpolation,
                      const MultigridLevel<dim> &coarser);

    NodeBlock<dim>
    row_sum(const unsigned int node) const
    {
      return rows.row_sum(node);
    }
    void
    set_row_sum(const unsigned int node, const NodeBlock<dim> &block)
    {
      rows.set_row_sum(node, block);
    }

    /// Return the diagonal block of the smoother: that of the matrix, plus a
    /// term for couplings between ranks.
    NodeBlock<dim>
    smoothing_block(const unsigned int node) const;

    void
    set_inverse_block(const unsigned int node, const NodeBlock<dim> &block)
    {
      rows.set_inverse_block(node, block);
    }

    /// Apply one sweep of Gauss-Seidel to A x = b: forward from x = 0, or
    /// backward. Ranks do not wait for each other.
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

    /// Call act(parent, weight) for each node of the next coarser level from
    /// which an owned node interpolates, with its local number there.
    template <typename Function>
    void
    for_each_parent(const unsigned int node, const Function &act) const
    {
      for (std::size_t e = parent_begin[node]; e < parent_begin[node + 1]; ++e)
        act(parents[e], weights[e]);
    }

    /// fine := P coarse; needs ghosts of @p coarse.
    void
    interpolate(Vector &fine, Vector &coarse) const;

    /// Work vectors of a cycle on this level.
    mutable Vector x, b, r;

  private:
    std::vector<NodeHierarchy::Node>                   nodes, ghosts;
    NodeHierarchy::Node                                begin, end;
    unsigned int                                       n_owned;
    std::shared_ptr<const Utilities::MPI::Partitioner> partitioner;
    bool                                               is_serial;

    SharedRows<dim> rows;

    std::vector<std::size_t>  parent_begin;
    std::vector<unsigned int> parents;
    std::vector<float>        weights;
  };


  /// Return answer(node) of the owner of each node. Collective.
  std::vector<std::vector<NodeHierarchy::Parent>>
  ask_owners(const std::vector<NodeHierarchy::Node> &nodes,
             const std::vector<NodeHierarchy::Node> &begins,
             const MPI_Comm                          communicator,
             const std::function<std::vector<NodeHierarchy::Parent>(
               const NodeHierarchy::Node)>          &answer);
} // namespace Viscoplastic
