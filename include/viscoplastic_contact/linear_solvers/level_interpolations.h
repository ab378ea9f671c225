// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/linear_solvers/block_rows.h>
#include <viscoplastic_contact/linear_solvers/node_hierarchy.h>

#include <functional>
#include <map>
#include <vector>

namespace Viscoplastic
{
  /// Interpolations of the unknowns between the spaces of a hierarchy, in
  /// Cartesian components: except at interfaces between bodies, those of
  /// displacements. They are constructed from the finest space down: the nodes
  /// opposite to a coarse node are those on the finest mesh, expressed by
  /// coarse nodes, so that the spaces stay nested. Calls are collective.
  class LevelInterpolations
  {
  public:
    using Node = NodeHierarchy::Node;

    /// Keeps references. @p begins: the first node of each rank, and the end.
    LevelInterpolations(const NodeHierarchy     &hierarchy,
                        const std::vector<Node> &begins,
                        const MPI_Comm           communicator)
      : hierarchy(hierarchy)
      , begins(begins)
      , communicator(communicator)
      , opposite(hierarchy.opposite)
    {}

    /// Return the interpolation to @p space, the finest one in the first call
    /// and then the next coarser each time, from the one below it: rows of its
    /// owned @p nodes, then of @p ghosts.
    Interpolation
    next(const unsigned int       space,
         const std::vector<Node> &nodes,
         const std::vector<Node> &ghosts);

  private:
    using Row = std::vector<NodeHierarchy::Parent>;

    /// Return the rows of owned nodes that differ from the interpolation of
    /// displacements (@p displacement: rows of owned nodes), because the
    /// unknowns of these nodes or their parents are jumps across an interface.
    std::map<Node, Row>
    at_interfaces(const unsigned int                    space,
                  const std::vector<Node>              &nodes,
                  const std::function<Row(const Node)> &displacement);

    const NodeHierarchy     &hierarchy;
    const std::vector<Node> &begins;
    const MPI_Comm           communicator;
    /// Mortar rows of owned nodes in the space of the next call.
    std::map<Node, Row> opposite;
  };
} // namespace Viscoplastic
