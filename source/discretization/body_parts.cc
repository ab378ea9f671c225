// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/discretization/body_parts.h>

namespace Viscoplastic
{
  template <int dim>
  BodyParts
  find_parts(const AdmissibleSpace<dim> &space)
  {
    const auto &nodes = space.boundary_nodes();
    BodyParts   result;
    if (!space.scene.has_stages() && !space.scene.has_contact_pairs())
      {
        result.of_node.assign(nodes.size(), {0});
        return result;
      }
    // All ranks have the coarse mesh, whose cells are present or absent as a
    // whole.
    const auto &triangulation = space.dof_handler.get_triangulation();
    const auto  is_present    = [&space](const auto &cell) {
      return space.scene.is_present(cell->material_id());
    };
    unsigned int              &n_parts      = result.n;
    std::vector<unsigned int> &part_of_cell = result.of_cell;
    n_parts                                 = 0;
    part_of_cell.assign(triangulation.n_cells(0),
                        numbers::invalid_unsigned_int);
    const auto part_of = [&part_of_cell](const auto &cell) -> unsigned int & {
      return part_of_cell[cell->id().get_coarse_cell_id()];
    };
    for (const auto &first : triangulation.cell_iterators_on_level(0))
      {
        std::vector<typename Triangulation<dim>::cell_iterator> open{first};
        const unsigned int n_found = n_parts;
        while (!open.empty())
          {
            const auto cell = open.back();
            open.pop_back();
            if (!is_present(cell) ||
                part_of(cell) != numbers::invalid_unsigned_int)
              continue;
            part_of(cell) = n_found;
            n_parts       = n_found + 1;
            for (const unsigned int f : cell->face_indices())
              if (!cell->at_boundary(f))
                open.push_back(cell->neighbor(f));
          }
      }

    std::map<types::global_dof_index, std::size_t> number;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      number[nodes[i].first_dof] = i;
    result.of_node.resize(nodes.size());
    for (const auto &cell : space.dof_handler.active_cell_iterators())
      if (!cell->is_artificial() && is_present(cell))
        for (const unsigned int v : cell->vertex_indices())
          {
            const auto node = number.find(cell->vertex_dof_index(v, 0));
            if (node == number.end())
              continue;
            result.of_node[node->second].insert(part_of(cell));
          }
    return result;
  }



  VISCOPLASTIC_INSTANTIATE(find_parts);
} // namespace Viscoplastic
