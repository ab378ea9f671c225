// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/discretization/admissible_space.h>

#include <map>

// The part of AdmissibleSpace for interfaces between bodies, where unknowns are
// jumps instead of displacements.

namespace Viscoplastic
{
  template <int dim>
  void
  AdmissibleSpace<dim>::make_couplings()
  {
    std::map<std::size_t, std::size_t> coupling_of;
    for (const auto &[id, rows] : mortar_rows)
      for (const auto &[node, row] : rows)
        {
          Coupling coupling;
          coupling.node      = relevant.index_within_set(node * dim);
          coupling.projector = unit_symmetric_tensor<dim>();
          const NodalFrame<dim> &frame =
            frames[frame_of_node[coupling.node / dim]];
          for (unsigned int i = 0; i < frame.n_fixed; ++i)
            if (frame.condition_boundary[i] != id)
              {
                // Project out the part that earlier conditions have left.
                const Tensor<1, dim> e =
                  coupling.projector * frame.condition_direction[i];
                coupling.projector -= outer_product(e, e) / e.norm_square();
              }
          coupling.bulge = row.bulge;
          for (const auto &other : row.nodes)
            coupling.others.emplace_back(relevant.index_within_set(other.node *
                                                                   dim),
                                         other.weight);
          // Scene::inspect() ensures one coupling a node.
          Assert(coupling_of.count(coupling.node) == 0, ExcInternalError());
          coupling_of[coupling.node] = couplings.size();
          couplings.push_back(coupling);
        }

    for (const auto &[node, number] : coupling_of)
      couplings_of_node[node] = {{number, 1.}};
    for (const auto &line : hanging_cartesian.get_lines())
      if (line.index % dim == 0)
        for (const auto &[parent, weight] : line.entries)
          if (const auto coupling =
                coupling_of.find(relevant.index_within_set(parent));
              coupling != coupling_of.end())
            couplings_of_node[relevant.index_within_set(line.index)]
              .emplace_back(coupling->second, weight);

    coupled_nodes.assign(relevant.n_elements() / dim, false);
    for (const auto &of_node : couplings_of_node)
      coupled_nodes[of_node.first / dim] = true;

    DistributedVector positions = owned_vector(), ghosted = ghosted_vector();
    for (std::size_t n = 0; n < node_position.size(); ++n)
      for (unsigned int d = 0; d < dim; ++d)
        positions.begin()[n * dim + d] = node_position[n][d];
    ghosted = positions;
    for (Coupling &coupling : couplings)
      for (const auto &[other, weight] : coupling.others)
        for (unsigned int d = 0; d < dim; ++d)
          coupling.opposite[d] += weight * ghosted.begin()[other + d];
  }



  template <int dim>
  void
  AdmissibleSpace<dim>::make_relative(DistributedVector &ghosted) const
  {
    if (mortar_rows.empty())
      return;
    DistributedVector relative = owned_vector();
    for (std::size_t i = 0; i < owned.n_elements(); ++i)
      relative.begin()[i] = ghosted.begin()[first_owned + i];
    add_opposite(-1., ghosted, relative, /* also_where_held = */ true);
    distribute_hanging_nodes(relative);
    ghosted = relative;
  }



  template <int dim>
  void
  AdmissibleSpace<dim>::add_opposite(const double             factor,
                                     const DistributedVector &ghosted,
                                     DistributedVector       &v,
                                     const bool also_where_held) const
  {
    for (const Coupling &coupling : couplings)
      if (coupling.node >= first_owned &&
          coupling.node < first_owned + owned.n_elements())
        {
          Tensor<1, dim> u;
          for (const auto &[other, weight] : coupling.others)
            for (unsigned int d = 0; d < dim; ++d)
              u[d] += weight * ghosted.begin()[other + d];
          u = factor * (also_where_held ? u : coupling.projector * u);
          for (unsigned int d = 0; d < dim; ++d)
            v.begin()[coupling.node - first_owned + d] += u[d];
        }
  }



  template <int dim>
  void
  AdmissibleSpace<dim>::couple(std::vector<types::global_dof_index> &dofs,
                               FullMatrix<double> &cell_matrix) const
  {
    // The rows of T = I + C Q beyond I: blocks of nodes opposite, which become
    // further degrees of freedom.
    struct Entry
    {
      unsigned int   row;
      std::size_t    other;
      Tensor<2, dim> block;
    };
    const unsigned int                  n = dofs.size();
    std::vector<Entry>                  entries;
    std::map<std::size_t, unsigned int> column_of;
    for (unsigned int a = 0; a < n; a += dim)
      {
        const std::size_t node = relevant.index_within_set(dofs[a]);
        column_of.emplace(node, a);
        const auto of_node = couplings_of_node.find(node);
        if (of_node == couplings_of_node.end())
          continue;
        for (const auto &[number, share] : of_node->second)
          for (const auto &[other, weight] : couplings[number].others)
            entries.push_back(
              {a, other, share * weight * couplings[number].projector});
      }
    for (const Entry &entry : entries)
      if (column_of.emplace(entry.other, dofs.size()).second)
        for (unsigned int d = 0; d < dim; ++d)
          dofs.push_back(relevant.nth_index_in_set(entry.other + d));
    if (cell_matrix.m() == 0)
      return; // only the pattern is asked for
    FullMatrix<double> T(n, dofs.size()), product(n, dofs.size());
    for (unsigned int i = 0; i < n; ++i)
      T(i, i) = 1.;
    for (const auto &[a, other, block] : entries)
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          T(a + i, column_of.at(other) + j) += block[i][j];
    cell_matrix.mmult(product, T);
    cell_matrix.reinit(dofs.size(), dofs.size());
    T.Tmmult(cell_matrix, product);
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(AdmissibleSpace, make_couplings);
  VISCOPLASTIC_INSTANTIATE_MEMBER(AdmissibleSpace, make_relative);
  VISCOPLASTIC_INSTANTIATE_MEMBER(AdmissibleSpace, add_opposite);
  VISCOPLASTIC_INSTANTIATE_MEMBER(AdmissibleSpace, couple);
} // namespace Viscoplastic
