// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/mesh/cell_order.h>
#include <viscoplastic_contact/mesh/marking_threshold.h>
#include <viscoplastic_contact/mesh/mesh_marking.h>
#include <viscoplastic_contact/mesh/mesh_refinement.h>

#include <cmath>
#include <limits>

namespace Viscoplastic
{
  namespace
  {
    /// Return the number of owned parents whose children are all to be removed;
    /// siblings belong to the same rank.
    template <int dim>
    unsigned int
    n_coarsened_parents(
      const parallel::distributed::Triangulation<dim> &triangulation)
    {
      unsigned int n = 0;
      for (const auto &cell : owned_cells(triangulation))
        if (cell->coarsen_flag_set() && cell->parent()->child(0) == cell)
          {
            bool all = true;
            for (const auto &sibling : cell->parent()->child_iterators())
              all &= sibling->is_active() && sibling->coarsen_flag_set();
            n += all;
          }
      return n;
    }



    /// Flag the cells with the largest estimates that make up a fraction of the
    /// sum for refinement, and those with the smallest ones for coarsening.
    template <int dim>
    void
    flag_fractions(parallel::distributed::Triangulation<dim> &triangulation,
                   const Vector<double>                      &squared_estimate,
                   const RefinementParameters                &parameters)
    {
      const MPI_Comm comm = triangulation.get_communicator();
      std::vector<std::pair<double, double>> estimates;
      double                                 total = 0.;
      for (const auto &cell : owned_cells(triangulation))
        {
          const double value = squared_estimate[cell->active_cell_index()];
          estimates.emplace_back(value, value);
          total += value;
        }
      total = Utilities::MPI::sum(total, comm);

      // The slack lets sums that equal the fraction up to rounding, as on
      // meshes of equal cells, reach it.
      const double slack        = 1e-3;
      const double refined      = parameters.refinement_fraction;
      const double coarsened    = parameters.coarsening_fraction;
      const double infinity     = std::numeric_limits<double>::infinity();
      double       refine_above = refined >= 1. ? -1. : infinity;
      if (total > 0. && refined > 0. && refined < 1.)
        refine_above = marking_threshold(estimates,
                                         (1. - slack) * refined * total,
                                         ThresholdSide::below,
                                         comm);
      double coarsen_below = coarsened >= 1. ? infinity : 0.;
      if (total > 0. && coarsened > 0. && coarsened < 1.)
        coarsen_below =
          marking_threshold(estimates,
                            (1. - (1. + slack) * coarsened) * total,
                            ThresholdSide::below,
                            comm);
      for (const auto &cell : owned_cells(triangulation))
        {
          const double value = squared_estimate[cell->active_cell_index()];
          if (value > refine_above)
            cell->set_refine_flag();
          else if (value < coarsen_below)
            cell->set_coarsen_flag();
        }
    }



    /// Clear the refinement flags with the smallest estimates until at most @p
    /// n_allowed flags are left on all ranks together.
    template <int dim>
    void
    limit_refinement(parallel::distributed::Triangulation<dim> &triangulation,
                     const Vector<double> &squared_estimate,
                     const double          n_allowed)
    {
      std::vector<std::pair<double, double>> marked;
      for (const auto &cell : owned_cells(triangulation))
        if (cell->refine_flag_set())
          marked.emplace_back(squared_estimate[cell->active_cell_index()], 1.);
      const double threshold =
        marking_threshold(marked,
                          std::floor(n_allowed) + 1.,
                          ThresholdSide::above,
                          triangulation.get_communicator());
      for (const auto &cell : owned_cells(triangulation))
        if (squared_estimate[cell->active_cell_index()] <= threshold)
          cell->clear_refine_flag();
    }



    /// Return whether the change of the mesh is worth its cost.
    template <int dim>
    bool
    is_worth_it(const parallel::distributed::Triangulation<dim> &triangulation,
                const Vector<double> &squared_estimate,
                const double          smallest_share)
    {
      double       total = 0., refined = 0.;
      unsigned int n_refined = 0, n_changed = 0;
      for (const auto &cell : owned_cells(triangulation))
        {
          const double value = squared_estimate[cell->active_cell_index()];
          total += value;
          if (cell->refine_flag_set())
            {
              refined += value;
              ++n_refined;
            }
          n_changed += cell->refine_flag_set() || cell->coarsen_flag_set();
        }
      const MPI_Comm comm = triangulation.get_communicator();
      if (Utilities::MPI::sum(n_changed, comm) == 0)
        return false;
      const double n_coarsened =
        Utilities::MPI::sum(n_coarsened_parents(triangulation), comm);
      const double n_gone =
        (Utilities::pow(2, dim) - 1) *
        (n_coarsened - Utilities::MPI::sum(n_refined, comm));
      return Utilities::MPI::sum(refined, comm) >=
               smallest_share * Utilities::MPI::sum(total, comm) ||
             n_gone >= 0.1 * triangulation.n_global_active_cells();
    }
  } // namespace



  template <int dim>
  bool
  mark_cells(parallel::distributed::Triangulation<dim> &triangulation,
             const Vector<double>                      &squared_estimate,
             const RefinementParameters                &parameters,
             const std::function<void()>               &limit_coarsening)
  {
    AssertDimension(squared_estimate.size(), triangulation.n_active_cells());
    const MPI_Comm comm = triangulation.get_communicator();

    flag_fractions(triangulation, squared_estimate, parameters);

    unsigned int n_refined = 0;
    for (const auto &cell : owned_cells(triangulation))
      {
        const auto level = static_cast<unsigned int>(cell->level());
        if (level >= parameters.maximal_level)
          cell->clear_refine_flag();
        if (level <= parameters.minimal_level)
          cell->clear_coarsen_flag();
        n_refined += cell->refine_flag_set();
      }

    // A refined cell adds, and a coarsened family removes, 2^dim - 1 cells.
    const double new_cells = Utilities::pow(2, dim) - 1;
    const double allowed =
      std::max(0.,
               (static_cast<double>(parameters.cell_budget) -
                triangulation.n_global_active_cells()) /
                   new_cells +
                 Utilities::MPI::sum(n_coarsened_parents(triangulation), comm));
    if (Utilities::MPI::sum(static_cast<double>(n_refined), comm) > allowed)
      limit_refinement(triangulation, squared_estimate, allowed);

    prepare_mesh_change(triangulation);
    if (limit_coarsening)
      limit_coarsening();
    if (is_worth_it(triangulation, squared_estimate, parameters.smallest_share))
      return true;
    for (const auto &cell : triangulation.active_cell_iterators())
      {
        cell->clear_refine_flag();
        cell->clear_coarsen_flag();
      }
    return false;
  }



  template <int dim>
  bool
  mark_cells_to_tolerance(
    parallel::distributed::Triangulation<dim> &triangulation,
    const Vector<double>                      &squared_estimate,
    const RefinementParameters                &parameters,
    const double                               ratio,
    const std::function<void()>               &limit_coarsening)
  {
    // Cells of twice the size have four times the squared estimate.
    const double aim = 0.85, coarsen_below = 0.6, square = ratio * ratio;
    RefinementParameters chosen(parameters);
    chosen.refinement_fraction = 0.;
    chosen.coarsening_fraction = 0.;
    if (ratio > 1.)
      {
        chosen.refinement_fraction =
          std::min(0.6, (1. - aim * aim / square) / 0.75);
        if (limit_coarsening)
          chosen.coarsening_fraction = 0.05 / (3. * square);
        // Do not change the mesh for coarsening alone, nor if the limits on
        // levels and cells leave few cells to be refined.
        chosen.smallest_share = 0.1;
      }
    else if (ratio < coarsen_below && limit_coarsening)
      {
        chosen.coarsening_fraction =
          ratio > 0. ? std::min(0.5, (aim * aim - square) / (6. * square)) :
                       0.5;
        chosen.smallest_share = 1.;
      }
    else
      return false;
    return mark_cells(triangulation,
                      squared_estimate,
                      chosen,
                      limit_coarsening);
  }



  VISCOPLASTIC_INSTANTIATE(mark_cells);
  VISCOPLASTIC_INSTANTIATE(mark_cells_to_tolerance);
} // namespace Viscoplastic
