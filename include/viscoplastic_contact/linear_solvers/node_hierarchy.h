// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>
#include <deal.II/base/tensor.h>
#include <deal.II/base/types.h>

#include <algorithm>
#include <map>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  /// The nodes of nested spaces of linear elements, from that of the coarse
  /// mesh to that of the mesh itself. A node that refinement has added depends
  /// on the vertices of the refined cell, its parents; each space has the nodes
  /// of the next finer one on which others there depend, and those of the
  /// coarse mesh. So all parts of a mesh become coarser at once, whatever their
  /// width, and all spaces together have hardly more nodes than the mesh (those
  /// without its finest cells, without the finest two, ... would have several
  /// times as many).
  ///
  /// On all levels, a node has its number in the mesh, which is its first
  /// degree of freedom divided by the dimension, and its owner there.
  struct NodeHierarchy
  {
    using Node = types::global_dof_index;

    /// The number of spaces, the same on all ranks.
    unsigned int n_levels = 0;
    /// The range of nodes that this rank owns, [begin, end).
    Node begin = 0, end = 0;

    /// The end of the node numbers of all ranks. Degrees of freedom beyond it
    /// are not displacements of mesh nodes.
    Node end_of_mesh = numbers::invalid_dof_index;

    /// For each owned node the first space that has it; invalid_unsigned_int
    /// for hanging nodes, which are not unknowns of any space.
    std::vector<unsigned int> first_level;

    /// A coarse node and its weight in the interpolation, in Cartesian
    /// components, to an owned node that the next space adds. Rows of parents
    /// are compressed, and empty for nodes of the first space.
    struct Parent
    {
      Node   node;
      double weight;

      template <class Archive>
      void
      serialize(Archive &archive, const unsigned int)
      {
        archive &node &weight;
      }
    };
    std::vector<std::size_t> row_begin;
    std::vector<Parent>      parents;

    /// The frames of owned and ghost nodes whose frame is not Cartesian, with
    /// directions as columns.
    std::map<Node, Tensor<2, 3>> frames;

    /// Whether there are interfaces between bodies, and the nodes opposite
    /// owned nodes there, with weights: the unknowns of an owned one are its
    /// displacement minus the weighted sum of displacements opposite.
    bool                                has_interfaces = false;
    std::map<Node, std::vector<Parent>> opposite;
  };


  /// The rank that owns a node; @p begins: the first node of each rank, and the
  /// end.
  inline unsigned int
  owner_of(const NodeHierarchy::Node               node,
           const std::vector<NodeHierarchy::Node> &begins)
  {
    return std::upper_bound(begins.begin(), begins.end(), node) -
           begins.begin() - 1;
  }


  /// The leading dim x dim block of a padded tensor.
  template <int dim>
  Tensor<2, dim>
  leading_block(const Tensor<2, 3> &tensor)
  {
    Tensor<2, dim> result;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = 0; j < dim; ++j)
        result[i][j] = tensor[i][j];
    return result;
  }
} // namespace Viscoplastic
