// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/linear_solvers/level_interpolations.h>
#include <viscoplastic_contact/linear_solvers/multigrid_level.h>

#include <cmath>
#include <set>

namespace Viscoplastic
{
  Interpolation
  LevelInterpolations::next(const unsigned int       space,
                            const std::vector<Node> &nodes,
                            const std::vector<Node> &ghosts)
  {
    const auto displacement = [&](const Node node) {
      const std::size_t n = node - hierarchy.begin;
      if (hierarchy.first_level[n] < space)
        return Row{{node, 1.}};
      return Row(hierarchy.parents.begin() + hierarchy.row_begin[n],
                 hierarchy.parents.begin() + hierarchy.row_begin[n + 1]);
    };
    std::map<Node, Row> others;
    if (hierarchy.has_interfaces)
      others = at_interfaces(space, nodes, displacement);
    const auto row = [&](const Node node) {
      const auto found = others.find(node);
      return found == others.end() ? displacement(node) : found->second;
    };
    Interpolation result;
    const auto    add = [&](const Row &parents) {
      result.parents.insert(result.parents.end(),
                            parents.begin(),
                            parents.end());
      result.begin.push_back(result.parents.size());
    };
    for (const Node node : nodes)
      if (others.empty() &&
          hierarchy.first_level[node - hierarchy.begin] < space)
        {
          result.parents.push_back({node, 1.}); // as row() says
          result.begin.push_back(result.parents.size());
        }
      else
        add(row(node));
    if (begins.size() > 2)
      for (const auto &parents : ask_owners(ghosts, begins, communicator, row))
        add(parents);
    return result;
  }



  std::map<LevelInterpolations::Node, LevelInterpolations::Row>
  LevelInterpolations::at_interfaces(
    const unsigned int                    space,
    const std::vector<Node>              &nodes,
    const std::function<Row(const Node)> &displacement)
  {
    const auto is_owned = [this](const Node node) {
      return node >= hierarchy.begin && node < hierarchy.end;
    };
    // Ask other ranks for rows of their nodes.
    const auto from_owners = [&](const std::set<Node> &foreign,
                                 const auto           &row) {
      const std::vector<Node> asked(foreign.begin(), foreign.end());
      const auto answers = ask_owners(asked, begins, communicator, row);
      std::map<Node, Row> result;
      for (std::size_t i = 0; i < asked.size(); ++i)
        result[asked[i]] = answers[i];
      return result;
    };
    const auto add =
      [](std::map<Node, double> &sums, const double factor, const Row &row) {
        for (const auto &[node, weight] : row)
          sums[node] += factor * weight;
      };
    const auto to_row = [](const std::map<Node, double> &sums) {
      Row row;
      for (const auto &[node, weight] : sums)
        if (std::abs(weight) > 1e-12)
          row.push_back({node, weight});
      return row;
    };
    static const Row nothing;
    const auto       row_of = [](const std::map<Node, Row> &rows,
                           const Node                 node) -> const Row       &{
      const auto found = rows.find(node);
      return found == rows.end() ? nothing : found->second;
    };

    // Express the mortar rows by nodes of the coarser space.
    std::set<Node> others;
    for (const auto &of_node : opposite)
      for (const auto &other : of_node.second)
        if (!is_owned(other.node))
          others.insert(other.node);
    const auto          of_others = from_owners(others, displacement);
    std::map<Node, Row> by_coarse_nodes, coarse_opposite;
    for (const auto &[node, row] : opposite)
      {
        std::map<Node, double> sums;
        for (const auto &[other, weight] : row)
          add(sums,
              weight,
              is_owned(other) ? displacement(other) : of_others.at(other));
        by_coarse_nodes[node] = to_row(sums);
        if (hierarchy.first_level[node - hierarchy.begin] < space)
          coarse_opposite[node] = by_coarse_nodes[node];
      }

    // Parents have the displacements opposite to them plus their jumps; a
    // node's jump is its interpolated displacement minus the one opposite to
    // it.
    std::set<Node> foreign_parents;
    if (begins.size() > 2)
      for (const Node node : nodes)
        for (const auto &parent : displacement(node))
          if (!is_owned(parent.node))
            foreign_parents.insert(parent.node);
    const auto of_foreign_parents =
      from_owners(foreign_parents, [&](const Node node) {
        return row_of(coarse_opposite, node);
      });
    std::map<Node, Row> result;
    for (const Node node : nodes)
      {
        const Row              row     = displacement(node);
        const Row             &here    = row_of(by_coarse_nodes, node);
        bool                   is_near = !here.empty();
        std::map<Node, double> sums;
        for (const auto &[parent, weight] : row)
          {
            const Row &across =
              row_of(is_owned(parent) ? coarse_opposite : of_foreign_parents,
                     parent);
            is_near |= !across.empty();
            add(sums, weight, across);
          }
        if (!is_near)
          continue;
        add(sums, 1., row);
        add(sums, -1., here);
        result[node] = to_row(sums);
      }
    opposite = coarse_opposite;
    return result;
  }
} // namespace Viscoplastic
