// SPDX-License-Identifier: LGPL-2.1-or-later

// The order of cells and the numbers of nodes are functions of the mesh,
// however it has come about.

#include "body.h"
#include <viscoplastic_contact/checkpoint/checkpoint_fields.h>
#include <viscoplastic_contact/error/kelly_estimator.h>
#include <viscoplastic_contact/mesh/cell_order.h>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  template <typename Dimension>
  class CellOrder : public testing::Test
  {};
  TYPED_TEST_SUITE(CellOrder, Dimensions, );



  /// Cells in orders of their own, and the degrees of freedom of each.
  struct Numbering
  {
    std::vector<CellId>                  owned, ghosts, as_they_come;
    std::vector<types::global_dof_index> dofs;
    /// Sums of a value that differs between cells: in the order of
    /// owned_cells() and in that of the triangulation's iterators.
    std::array<double, 2> sums;
    double                sum_as_they_come;
  };



  template <int dim>
  struct HistoricBody : Body<dim>
  {
    HistoricBody()
      : Body<dim>(box_with<dim>("set Role = clamped\n"))
    {}

    /// Refine what the condition holds for, coarsen the rest.
    void
    change(const std::function<bool(const Point<dim> &)> &is_fine)
    {
      for (const auto &cell : this->triangulation.active_cell_iterators())
        if (cell->is_locally_owned())
          {
            if (is_fine(cell->center()) && cell->level() == 0)
              cell->set_refine_flag();
            else if (!is_fine(cell->center()) && cell->level() > 0)
              cell->set_coarsen_flag();
          }
      this->triangulation.execute_coarsening_and_refinement();
    }

    Numbering
    numbering()
    {
      distribute_nodes(this->fe, this->dof_handler);
      Numbering                            result;
      std::vector<types::global_dof_index> dofs(this->fe.n_dofs_per_cell());
      const auto add = [&](const auto &cells, std::vector<CellId> &ids) {
        for (const auto &cell : cells)
          {
            ids.push_back(cell->id());
            cell->get_dof_indices(dofs);
            result.dofs.insert(result.dofs.end(), dofs.begin(), dofs.end());
          }
      };
      add(owned_cells(this->dof_handler), result.owned);
      add(ghost_cells(this->dof_handler), result.ghosts);
      Vector<double> values(this->triangulation.n_active_cells());
      for (const auto &cell : this->triangulation.active_cell_iterators())
        {
          result.as_they_come.push_back(cell->id());
          if (cell->is_locally_owned())
            values[cell->active_cell_index()] =
              std::exp(20. * std::sin(1e3 * cell->center().norm()));
        }
      result.sums             = sum_over_cells(values, this->triangulation);
      result.sum_as_they_come = values.l1_norm();
      return result;
    }
  };



  void
  expect_same(const Numbering &one, const Numbering &other)
  {
    EXPECT_EQ(one.owned, other.owned);
    EXPECT_EQ(one.ghosts, other.ghosts);
    EXPECT_EQ(one.dofs, other.dofs);
    EXPECT_EQ(one.sums, other.sums);
  }



  TYPED_TEST(CellOrder, DoesNotDependOnTheHistoryOfTheMesh)
  {
    constexpr int dim     = TypeParam::value;
    const auto    is_left = [](const Point<dim> &x) { return x[0] < 0.9; };

    HistoricBody<dim> straight;
    straight.change(is_left);
    const Numbering expected = straight.numbering();

    HistoricBody<dim> crooked;
    crooked.change([](const Point<dim> &x) { return x[1] > 0.5; });
    crooked.change([](const Point<dim> &x) { return x[0] > 0.5; });
    crooked.change(is_left);
    const Numbering after_detours = crooked.numbering();
    expect_same(after_detours, expected);
    // Order of iterators depends on the history of the mesh.
    EXPECT_TRUE(Utilities::MPI::logical_or(after_detours.as_they_come !=
                                             expected.as_they_come,
                                           MPI_COMM_WORLD));
    // In two dimensions the few cells happen to have equal sums.
    EXPECT_TRUE(dim == 2 ||
                Utilities::MPI::logical_or(after_detours.sum_as_they_come !=
                                             expected.sum_as_they_come,
                                           MPI_COMM_WORLD));

    // Restore the mesh as a restart does.
    HistoricBody<dim> restored;
    restore_mesh(Utilities::MPI::all_gather(MPI_COMM_WORLD,
                                            pack_mesh(crooked.triangulation)),
                 restored.triangulation);
    expect_same(restored.numbering(), expected);
  }
} // namespace
