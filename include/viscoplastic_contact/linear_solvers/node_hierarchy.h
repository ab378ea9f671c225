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

  /// The nodes of the nested meshes from which a mesh has come by refinement:
  /// mesh l has the cells of level l and the active cells of lower levels, so
  /// the last one is the mesh itself. The nodes of mesh l-1 are nodes of mesh
  /// l, and hanging nodes hang in all meshes that have them, so that the spaces
  /// are nested, too.
  ///
  /// A node is known by its number in the last mesh on all levels, its first
  /// degree of freedom over their number at a node; the rank that owns it there
  /// owns it everywhere.
  struct NodeHierarchy
  {
    using Node = types::global_dof_index;

    /// The number of meshes, the same on all ranks.
    unsigned int n_levels = 0;
    /// The range of nodes that this rank owns, [begin, end).
    Node begin = 0, end = 0;

    /// The end of the nodes of all ranks: degrees of freedom of nodes beyond
    /// are no displacements of the mesh.
    Node end_of_mesh = numbers::invalid_dof_index;

    /// The first mesh that has each owned node; invalid_unsigned_int for
    /// hanging nodes, which are no unknowns of any mesh.
    std::vector<unsigned int> first_level;

    /// A displacement of the mesh before is, at an owned node that is new, the
    /// sum of the values of its parents with these weights (in Cartesian
    /// components). Compressed rows, empty for nodes of the first mesh.
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

    /// The directions, as columns, of owned nodes and ghosts whose frame is not
    /// Cartesian.
    std::map<Node, Tensor<2, 3>> frames;

    /// Whether bodies touch; and of owned nodes there the nodes opposite, with
    /// their weights: the unknowns of these nodes are displacements relative to
    /// this sum.
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
