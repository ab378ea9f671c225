// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/linear_solvers/node_hierarchy.h>

namespace Viscoplastic
{
  /// The entries of a matrix between two nodes.
  template <int dim>
  using NodeBlock = Tensor<2, dim>;


  /// Block rows of a matrix for some nodes, in compressed form; columns are
  /// node numbers, in ascending order.
  template <int dim>
  struct BlockRows
  {
    std::vector<std::size_t>         begin{0};
    std::vector<NodeHierarchy::Node> columns;
    std::vector<NodeBlock<dim>>      values;

    std::size_t
    n_rows() const
    {
      return begin.size() - 1;
    }
  };


  /// Return the rows of @p nodes, owned ones of the last mesh of @p hierarchy,
  /// of a matrix in nodal frames, in Cartesian components and divided by
  /// @p unit. Rows and columns of @p excluded degrees of freedom are zero.
  /// Collective.
  template <int dim>
  BlockRows<dim>
  cartesian_rows(const DistributedMatrix                &matrix,
                 const std::vector<bool>                &excluded,
                 const NodeHierarchy                    &hierarchy,
                 const std::vector<NodeHierarchy::Node> &nodes,
                 const double                            unit);


  /// Interpolation from one mesh of a hierarchy to the next: for each fine node
  /// the coarse nodes and weights. Rows of owned nodes come first, then those
  /// of the ghosts in the columns of a matrix.
  struct Interpolation
  {
    std::vector<std::size_t>           begin{0};
    std::vector<NodeHierarchy::Parent> parents;

    std::size_t
    n_rows() const
    {
      return begin.size() - 1;
    }
  };


  /// Return the owned rows of P^T A P, the matrix of the bilinear form of @p A
  /// on the coarser mesh.
  ///
  /// @p owned_nodes: the owned fine nodes, ascending; @p ghosts: the other
  /// nodes among the columns of @p A, ascending; @p coarse_nodes: the owned
  /// coarse nodes, ascending; @p begins: the first node of each rank, and the
  /// end. Collective.
  template <int dim>
  BlockRows<dim>
  galerkin_product(const BlockRows<dim>                   &A,
                   const std::vector<NodeHierarchy::Node> &owned_nodes,
                   const std::vector<NodeHierarchy::Node> &ghosts,
                   const Interpolation                    &P,
                   const std::vector<NodeHierarchy::Node> &coarse_nodes,
                   const std::vector<NodeHierarchy::Node> &begins,
                   const MPI_Comm                          communicator);
} // namespace Viscoplastic
