// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/distributed/tria.h>
#include <deal.II/dofs/dof_handler.h>

#include <viscoplastic_contact/mesh/cell_order.h>

namespace Viscoplastic
{
  namespace
  {
    template <class Cell, class Function>
    void
    visit_active(const Cell &cell, const Function &visit)
    {
      if (cell->has_children())
        for (unsigned int c = 0; c < cell->n_children(); ++c)
          visit_active<Cell>(cell->child(c), visit);
      else
        visit(cell);
    }



    template <class Mesh, class Condition>
    std::vector<typename Mesh::active_cell_iterator>
    cells_that(const Mesh &mesh, const Condition &condition)
    {
      std::vector<typename Mesh::active_cell_iterator> cells;
      for (const auto &cell : mesh.cell_iterators_on_level(0))
        visit_active<typename Mesh::cell_iterator>(
          cell, [&](const typename Mesh::cell_iterator &active) {
            if (condition(*active))
              cells.emplace_back(active);
          });
      return cells;
    }
  } // namespace



  template <class Mesh>
  std::vector<typename Mesh::active_cell_iterator>
  owned_cells(const Mesh &mesh)
  {
    return cells_that(mesh,
                      [](const auto &cell) { return cell.is_locally_owned(); });
  }



  template <class Mesh>
  std::vector<typename Mesh::active_cell_iterator>
  ghost_cells(const Mesh &mesh)
  {
    return cells_that(mesh, [](const auto &cell) { return cell.is_ghost(); });
  }



#define INSTANTIATE(Mesh)                                                     \
  template std::vector<Mesh::active_cell_iterator> owned_cells(const Mesh &); \
  template std::vector<Mesh::active_cell_iterator> ghost_cells(const Mesh &);

  INSTANTIATE(DoFHandler<2>)
  INSTANTIATE(DoFHandler<3>)
  INSTANTIATE(Triangulation<2>)
  INSTANTIATE(Triangulation<3>)
  INSTANTIATE(parallel::distributed::Triangulation<2>)
  INSTANTIATE(parallel::distributed::Triangulation<3>)
#undef INSTANTIATE
} // namespace Viscoplastic
