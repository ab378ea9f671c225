// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/distributed/p4est_wrappers.h>
#include <deal.II/grid/grid_tools.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/mesh/mesh_ids.h>
#include <viscoplastic_contact/mesh/mesh_refinement.h>
#include <viscoplastic_contact/mesh/mesh_size.h>

#include <cmath>
#include <map>
#include <regex>

namespace Viscoplastic
{
  namespace
  {
    /// Parse `Boundary refinements': the number of refinements by boundary id.
    template <int dim>
    std::map<types::boundary_id, unsigned int>
    boundary_refinements(
      const std::string                               &text,
      const parallel::distributed::Triangulation<dim> &triangulation)
    {
      const std::string entry =
        "'Geometry/Boundary refinements' = " + excerpt(text);
      std::map<types::boundary_id, unsigned int> result;
      const std::set<types::boundary_id> ids = boundary_ids(triangulation);
      const std::regex                   pair("(\\d{1,9})\\s*:\\s*(\\d{1,2})");
      for (const std::string &part : Utilities::split_string_list(text, ','))
        {
          std::smatch match;
          // std::regex needs a stack as deep as the text is long.
          if (part.size() >= 100 || !std::regex_match(part, match, pair))
            refuse(entry +
                   " consists of `boundary id: times' separated by commas, but "
                   "has '" +
                   excerpt(part) + "'.");
          const types::boundary_id id = std::stoul(match[1]);
          if (ids.count(id) != 1)
            refuse(entry + " names the boundary id " + std::to_string(id) +
                   ", but the mesh has the ids " + list(ids) + ".");
          if (!result.emplace(id, std::stoul(match[2])).second)
            refuse(entry + " names the boundary id " + std::to_string(id) +
                   " twice.");
        }
      return result;
    }



    /// Return a lower bound of the number of cells: in each pass, each face has
    /// a cell that is refined, and is replaced by 2^(dim-1) faces.
    template <int dim>
    double
    n_cells_after(
      const std::map<types::boundary_id, unsigned int> &times,
      const parallel::distributed::Triangulation<dim>  &triangulation)
    {
      double n = 0.;
      for (const auto &cell : triangulation.active_cell_iterators())
        if (cell->is_locally_owned())
          {
            n += 1.;
            for (const unsigned int f : cell->face_indices())
              {
                const auto found = cell->at_boundary(f) ?
                                     times.find(cell->face(f)->boundary_id()) :
                                     times.end();
                if (found != times.end())
                  for (unsigned int pass = 0; pass < found->second; ++pass)
                    n +=
                      std::ldexp(Utilities::pow(2, dim) - 1, (dim - 1) * pass);
              }
          }
      return Utilities::MPI::sum(n, triangulation.get_communicator());
    }
  } // namespace



  template <int dim>
  void
  refine_mesh(const GeometryParameters                  &geometry,
              parallel::distributed::Triangulation<dim> &triangulation)
  {
    std::map<types::boundary_id, unsigned int> times;
    if (!Utilities::trim(geometry.boundary_refinements).empty())
      times =
        boundary_refinements(geometry.boundary_refinements, triangulation);

    // Up to this level, halving is exact and indices suffice.
    const unsigned int global = geometry.global_refinements;
    unsigned int       local  = 0;
    for (const auto &pair : times)
      local = std::max(local, pair.second);
    const unsigned int n_levels = 18;
    if (global > n_levels || global + local > n_levels)
      refuse("'Geometry/Global refinements' = " + std::to_string(global) +
             " with " + std::to_string(local) +
             " further ones at boundaries; together, " +
             std::to_string(n_levels) + " are possible.");
    const MPI_Comm comm = triangulation.get_communicator();
    if (global > 0)
      check_mesh_size(dim,
                      std::ldexp(triangulation.n_cells(0), dim * global),
                      triangulation.n_cells(0),
                      "'Geometry/Global refinements' = " +
                        std::to_string(global),
                      comm);

    triangulation.refine_global(global);
    if (local > 0)
      check_mesh_size(dim,
                      n_cells_after(times, triangulation),
                      triangulation.n_cells(0),
                      "'Geometry/Boundary refinements' = " +
                        excerpt(geometry.boundary_refinements),
                      comm);
    for (unsigned int pass = 0; pass < local; ++pass)
      {
        // Include cells that touch the boundary in a vertex or an edge only.
        std::vector<bool> touches(triangulation.n_vertices(), false);
        for (const auto &cell : triangulation.active_cell_iterators())
          if (!cell->is_artificial())
            for (const unsigned int f : cell->face_indices())
              if (cell->at_boundary(f))
                {
                  const auto face  = cell->face(f);
                  const auto found = times.find(face->boundary_id());
                  if (found != times.end() && pass < found->second)
                    for (const unsigned int v : face->vertex_indices())
                      touches[face->vertex_index(v)] = true;
                }
        for (const auto &cell : triangulation.active_cell_iterators())
          if (cell->is_locally_owned())
            for (const unsigned int v : cell->vertex_indices())
              if (touches[cell->vertex_index(v)])
                cell->set_refine_flag();
        triangulation.execute_coarsening_and_refinement();
      }
  }



  namespace
  {
    enum class Mark : unsigned int
    {
      stays,
      refined,
      coarsened
    };

    template <class Cell>
    Mark
    mark_of(const Cell &cell)
    {
      return cell->refine_flag_set()  ? Mark::refined :
             cell->coarsen_flag_set() ? Mark::coarsened :
                                        Mark::stays;
    }



    /// Clear the coarsening flags of owned families that are not to be
    /// coarsened as a whole; siblings belong to the same rank.
    template <int dim>
    void
    keep_incomplete_families(
      parallel::distributed::Triangulation<dim> &triangulation)
    {
      for (const auto &cell : triangulation.active_cell_iterators())
        if (cell->is_locally_owned() && cell->coarsen_flag_set())
          {
            bool all = cell->level() > 0;
            if (all)
              for (const auto &sibling : cell->parent()->child_iterators())
                all &= sibling->is_active() && sibling->coarsen_flag_set();
            if (!all)
              cell->clear_coarsen_flag();
          }
    }



    /// Copy the flags of cells from their owners to ghost cells. Collective.
    template <int dim>
    void
    exchange_flags(parallel::distributed::Triangulation<dim> &triangulation)
    {
      using Mesh         = parallel::distributed::Triangulation<dim>;
      using CellIterator = typename Mesh::active_cell_iterator;
      for (const CellIterator &cell : triangulation.active_cell_iterators())
        if (!cell->is_locally_owned())
          {
            cell->clear_refine_flag();
            cell->clear_coarsen_flag();
          }
      GridTools::exchange_cell_data_to_ghosts<unsigned int, Mesh>(
        triangulation,
        [](const CellIterator &cell) {
          return static_cast<unsigned int>(mark_of(cell));
        },
        [](const CellIterator &cell, const unsigned int &mark) {
          if (mark == static_cast<unsigned int>(Mark::refined))
            cell->set_refine_flag();
          else if (mark == static_cast<unsigned int>(Mark::coarsened))
            // Flag the whole family, some of which may not be ghost cells.
            for (const auto &sibling : cell->parent()->child_iterators())
              if (sibling->is_active() && !sibling->is_locally_owned())
                sibling->set_coarsen_flag();
        });
    }
  } // namespace



  template <int dim>
  unsigned int
  rank_at_vertex(const parallel::distributed::Triangulation<dim> &triangulation,
                 const CellId                                    &cell,
                 const unsigned int                               vertex)
  {
    namespace P4est = internal::p4est;
    typename P4est::types<dim>::quadrant place;
    P4est::init_coarse_quadrant<dim>(place);
    const auto go_to_child = [&place](const unsigned int child) {
      typename P4est::types<dim>::quadrant children[1U << dim];
      P4est::init_quadrant_children<dim>(place, children);
      place = children[child];
    };
    const auto children = cell.get_child_indices();
    for (const auto child : children)
      go_to_child(child);
    // Descend to the deepest level of the mesh.
    for (unsigned int level = children.size() + 1;
         level < triangulation.n_global_levels();
         ++level)
      go_to_child(vertex);
    using Forest = typename P4est::types<dim>::forest;
    // The index of a coarse cell is that of its tree.
    return P4est::functions<dim>::comm_find_owner(
      const_cast<Forest *>(triangulation.get_p4est()),
      cell.get_coarse_cell_id(),
      &place,
      triangulation.locally_owned_subdomain());
  }



  template <int dim>
  void
  refine_like(const parallel::distributed::Triangulation<dim> &model,
              parallel::distributed::Triangulation<dim>       &triangulation)
  {
    std::set<CellId> refined;
    for (const auto &active : model.active_cell_iterators())
      if (active->is_locally_owned())
        {
          auto cell =
            typename Triangulation<dim>::cell_iterator(&model,
                                                       active->level(),
                                                       active->index());
          while (cell->level() > 0)
            {
              cell = cell->parent();
              refined.insert(cell->id());
            }
        }
    const MPI_Comm comm = triangulation.get_communicator();
    for (bool changes = true; changes;)
      {
        // Any rank that owns a part of a cell of the model knows whether that
        // cell is refined.
        std::map<unsigned int, std::vector<CellId>> to_ask, to_refine;
        for (const auto &cell : triangulation.active_cell_iterators())
          if (cell->is_locally_owned())
            to_ask[rank_at_vertex(model, cell->id(), 0)].push_back(cell->id());
        for (const auto &[rank, asked] :
             Utilities::MPI::some_to_some(comm, to_ask))
          for (const CellId &id : asked)
            if (refined.count(id) > 0)
              to_refine[rank].push_back(id);
        changes = false;
        for (const auto &received :
             Utilities::MPI::some_to_some(comm, to_refine))
          for (const CellId &id : received.second)
            {
              triangulation.create_cell_iterator(id)->set_refine_flag();
              changes = true;
            }
        changes = Utilities::MPI::logical_or(changes, comm);
        if (changes)
          triangulation.execute_coarsening_and_refinement();
      }
  }



  template <int dim>
  void
  prepare_mesh_change(parallel::distributed::Triangulation<dim> &triangulation)
  {
    const auto marks = [&triangulation] {
      std::vector<Mark> result;
      for (const auto &cell : triangulation.active_cell_iterators())
        if (cell->is_locally_owned())
          result.push_back(mark_of(cell));
      return result;
    };
    // This ends, since flags only change to coarsen less or to refine more.
    keep_incomplete_families(triangulation);
    bool any_change = true;
    while (any_change)
      {
        const std::vector<Mark> before = marks();
        exchange_flags(triangulation);
        triangulation.prepare_coarsening_and_refinement();
        any_change =
          Utilities::MPI::logical_or(marks() != before,
                                     triangulation.get_communicator());
      }
  }



  VISCOPLASTIC_INSTANTIATE(refine_mesh);
  VISCOPLASTIC_INSTANTIATE(rank_at_vertex);
  VISCOPLASTIC_INSTANTIATE(refine_like);
  VISCOPLASTIC_INSTANTIATE(prepare_mesh_change);
} // namespace Viscoplastic
