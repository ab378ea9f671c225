// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/discretization/conditions_at_nodes.h>

namespace Viscoplastic
{
  namespace
  {
    /// Call act(cell, boundary id, number of the node) for owned nodes of
    /// boundary faces, except hanging nodes.
    template <int dim, typename Action>
    void
    for_each_boundary_node(const DoFHandler<dim>           &dof_handler,
                           const AffineConstraints<double> &hanging_nodes,
                           const Action                    &act)
    {
      const IndexSet &owned = dof_handler.locally_owned_dofs();
      for (const auto &cell : dof_handler.active_cell_iterators())
        if (!cell->is_artificial())
          for (const unsigned int f : cell->face_indices())
            if (cell->face(f)->at_boundary())
              for (const unsigned int v : cell->face(f)->vertex_indices())
                if (const auto dof = cell->face(f)->vertex_dof_index(v, 0);
                    owned.is_element(dof) && !hanging_nodes.is_constrained(dof))
                  act(cell,
                      cell->face(f)->boundary_id(),
                      owned.index_within_set(dof) / dim);
    }



    /// For each owned node, whether it belongs to a material that is present.
    template <int dim>
    std::vector<bool>
    nodes_of_body(const DoFHandler<dim> &dof_handler, const Scene<dim> &scene)
    {
      const IndexSet   &owned = dof_handler.locally_owned_dofs();
      std::vector<bool> result(owned.n_elements() / dim, false);
      for (const auto &cell : dof_handler.active_cell_iterators())
        if (!cell->is_artificial() && scene.is_present(cell->material_id()))
          for (const unsigned int v : cell->vertex_indices())
            if (const auto dof = cell->vertex_dof_index(v, 0);
                owned.is_element(dof))
              result[owned.index_within_set(dof) / dim] = true;
      return result;
    }
  } // namespace



  template <int dim>
  ConditionsAtNodes<dim>
  conditions_at_nodes(
    const DoFHandler<dim>                          &dof_handler,
    const Scene<dim>                               &scene,
    const AffineConstraints<double>                &hanging_nodes,
    const std::map<types::boundary_id, MortarRows> &mortar_rows,
    const std::vector<Point<dim>>                  &node_position)
  {
    const IndexSet &owned = dof_handler.locally_owned_dofs();

    std::vector<const BoundaryCondition<dim> *> listed;
    for (const auto &pair : scene.boundary)
      if (pair.second.constrains() || pair.second.has_contact_points())
        listed.push_back(&pair.second);
    const std::size_t n_boundaries = listed.size();
    for (const Support<dim> &support : scene.supports)
      listed.push_back(&support.condition);
    if (listed.size() > 52)
      refuse("At most 52 boundary ids and supports may carry displacement or "
             "contact conditions.");

    // Conditions of an absent material do not hold the nodes that it shares
    // with the body.
    const std::vector<bool> is_of_body = scene.has_stages() ?
                                           nodes_of_body(dof_handler, scene) :
                                           std::vector<bool>();
    const auto              is_contact = [&](const types::boundary_id id) {
      return scene.boundary.at(id).role == BoundaryRole::contact;
    };
    std::vector<bool> waits(
      scene.contact_changes_with_stages() ? node_position.size() : 0, false);
    const auto is_released = [&](const auto              &cell,
                                 const types::boundary_id id,
                                 const std::size_t        node) {
      if (!scene.has_stages() || scene.is_present(cell->material_id()))
        return false;
      if (!is_of_body[node] && is_contact(id) &&
          (!scene.boundary.at(id).against ||
           mortar_rows.at(id).count(owned.nth_index_in_set(node * dim) / dim) ==
             1))
        waits[node] = true;
      return is_of_body[node] || is_contact(id);
    };

    // For each owned node the boundaries that it is on.
    const auto boundaries_of_nodes =
      [&](const std::vector<types::boundary_id> &ids) {
        std::vector<std::uint64_t> result(node_position.size(), 0);
        for_each_boundary_node(dof_handler,
                               hanging_nodes,
                               [&](const auto              &cell,
                                   const types::boundary_id id,
                                   const std::size_t        node) {
                                 for (unsigned int i = 0; i < ids.size(); ++i)
                                   if (ids[i] == id &&
                                       !is_released(cell, id, node))
                                     result[node] |= std::uint64_t(1) << i;
                               });
        return result;
      };
    std::vector<types::boundary_id> ids;
    for (unsigned int i = 0; i < n_boundaries; ++i)
      ids.push_back(listed[i]->id);
    std::vector<std::uint64_t> mask = boundaries_of_nodes(ids);
    // Where nothing lies opposite, there is no contact.
    for (unsigned int i = 0; i < n_boundaries; ++i)
      if (listed[i]->against)
        for (std::size_t n = 0; n < mask.size(); ++n)
          if (mortar_rows.at(ids[i]).count(owned.nth_index_in_set(n * dim) /
                                           dim) == 0)
            mask[n] &= ~(std::uint64_t(1) << i);
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      {
        const Support<dim> &support = scene.supports[s];
        const std::uint64_t bit     = std::uint64_t(1) << (n_boundaries + s),
                            all =
                              (std::uint64_t(1) << support.boundaries.size()) -
                              1;
        std::vector<std::uint64_t> here;
        if (!support.position)
          here = boundaries_of_nodes(
            {support.boundaries.begin(), support.boundaries.end()});
        // Positions of coarse vertices are bit for bit the same on all meshes.
        for (std::size_t n = 0; n < mask.size(); ++n)
          if (support.position ? node_position[n] == *support.position :
                                 here[n] == all)
            mask[n] |= bit;
      }
    return {listed, mask, waits};
  }



  VISCOPLASTIC_INSTANTIATE(conditions_at_nodes);
} // namespace Viscoplastic
