// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/linear_solvers/block_rows.h>
#include <viscoplastic_contact/linear_solvers/node_hierarchy.h>

#include <functional>
#include <map>
#include <vector>

namespace Viscoplastic
{
  /// The interpolations of the unknowns between the meshes of a hierarchy, in
  /// Cartesian components. Apart from interfaces between bodies they are those
  /// of displacements. They are made from the last mesh down, since what lies
  /// opposite to a node of a coarse mesh is what lies there on the last mesh,
  /// by its coarse nodes: so the spaces stay nested. Calls are collective.
  class LevelInterpolations
  {
  public:
    using Node = NodeHierarchy::Node;

    /// @p begins: the first node of each rank, and the end. Arguments stay in
    /// use.
    LevelInterpolations(const NodeHierarchy     &hierarchy,
                        const std::vector<Node> &begins,
                        const MPI_Comm           communicator)
      : hierarchy(hierarchy)
      , begins(begins)
      , communicator(communicator)
      , opposite(hierarchy.opposite)
    {}

    /// The interpolation to @p mesh, the last one in the first call and then
    /// the one before, from the next coarser one: rows of its owned @p nodes,
    /// then of @p ghosts.
    Interpolation
    next(const unsigned int       mesh,
         const std::vector<Node> &nodes,
         const std::vector<Node> &ghosts);

  private:
    using Row = std::vector<NodeHierarchy::Parent>;

    /// The rows of owned nodes that differ from the interpolation of
    /// displacements (@p displacement: rows of owned nodes), since they or
    /// their parents have jumps across an interface for unknowns.
    std::map<Node, Row>
    at_interfaces(const unsigned int                    mesh,
                  const std::vector<Node>              &nodes,
                  const std::function<Row(const Node)> &displacement);

    const NodeHierarchy     &hierarchy;
    const std::vector<Node> &begins;
    const MPI_Comm           communicator;
    /// Mortar rows of owned nodes of the mesh of the next call.
    std::map<Node, Row> opposite;
  };
} // namespace Viscoplastic
