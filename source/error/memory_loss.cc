// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/error/memory_loss.h>
#include <viscoplastic_contact/mesh/cell_order.h>
#include <viscoplastic_contact/mesh/marking_threshold.h>
#include <viscoplastic_contact/mesh/mesh_refinement.h>

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    struct Family
    {
      typename Triangulation<dim>::cell_iterator parent;
      double                                     squared_loss;
    };



    /// The families of owned cells that are marked for coarsening, with their
    /// losses. All children of a family are on one rank.
    template <int dim>
    std::vector<Family<dim>>
    marked_families(
      const parallel::distributed::Triangulation<dim> &triangulation,
      const StressSpace<dim>                          &stress_space,
      const IrreversibleStress                        &z)
    {
      const unsigned int        n = stress_space.n_samples;
      const auto                P = stress_space.prolongation();
      std::vector<unsigned int> number(triangulation.n_active_cells());
      unsigned int              index = 0;
      for (const auto &cell : stress_space.space.cells)
        number[cell->active_cell_index()] = index++;

      std::vector<Family<dim>>           result;
      std::vector<SymmetricTensor<2, 3>> coarse(n);
      std::vector<double>                weights(n);
      for (const auto &cell : owned_cells(triangulation))
        {
          if (!cell->coarsen_flag_set() || cell->parent()->child(0) != cell)
            continue;
          const auto parent  = cell->parent();
          bool       is_gone = true;
          for (const auto &child : parent->child_iterators())
            is_gone &= child->is_active() && child->coarsen_flag_set();
          if (!is_gone)
            continue;
          // The projection of StateTransfer: W_r z_r is the sum of w_s P_sr z_s
          // over the samples s of all children.
          coarse.assign(n, SymmetricTensor<2, 3>());
          weights.assign(n, 0.);
          const auto for_each_sample = [&](const auto &action) {
            for (unsigned int c = 0; c < parent->n_children(); ++c)
              for (unsigned int s = 0; s < n; ++s)
                action(c, number[parent->child(c)->active_cell_index()], s);
          };
          for_each_sample([&](const unsigned int c,
                              const unsigned int on,
                              const unsigned int s) {
            for (unsigned int r = 0; r < n; ++r)
              {
                const double weight = stress_space.weight(on, s) * P[c](s, r);
                weights[r] += weight;
                coarse[r] += weight * z[on * n + s];
              }
          });
          for (unsigned int r = 0; r < n; ++r)
            coarse[r] /= weights[r];
          double loss = 0.;
          for_each_sample([&](const unsigned int c,
                              const unsigned int on,
                              const unsigned int s) {
            SymmetricTensor<2, 3> lost = z[on * n + s];
            for (unsigned int r = 0; r < n; ++r)
              lost -= P[c](s, r) * coarse[r];
            loss += stress_space.weight(on, s) *
                    stress_space.moduli(on).complementary_square(lost);
          });
          result.push_back({parent, loss});
        }
      return result;
    }



    template <int dim>
    double
    total(const std::vector<Family<dim>> &families, const MPI_Comm communicator)
    {
      double sum = 0.;
      for (const Family<dim> &family : families)
        sum += family.squared_loss;
      return Utilities::MPI::sum(sum, communicator);
    }



    /// Whether any rank has z; a rank without cells never does.
    bool
    has_memory(const IrreversibleStress &z, const MPI_Comm communicator)
    {
      return Utilities::MPI::max(z.empty() ? 0 : 1, communicator) == 1;
    }
  } // namespace



  template <int dim>
  double
  memory_loss(const parallel::distributed::Triangulation<dim> &triangulation,
              const StressSpace<dim>                          &stress_space,
              const IrreversibleStress                        &z)
  {
    const MPI_Comm communicator = stress_space.space.communicator;
    if (!has_memory(z, communicator))
      return 0.;
    return std::sqrt(
      total(marked_families(triangulation, stress_space, z), communicator));
  }



  template <int dim>
  void
  limit_memory_loss(parallel::distributed::Triangulation<dim> &triangulation,
                    const StressSpace<dim>                    &stress_space,
                    const IrreversibleStress                  &z,
                    const double                               allowed)
  {
    const MPI_Comm communicator = stress_space.space.communicator;
    if (!has_memory(z, communicator))
      return;
    const auto   families = marked_families(triangulation, stress_space, z);
    const double excess   = total(families, communicator) - allowed * allowed;
    if (excess <= 0.)
      return;
    std::vector<std::pair<double, double>> losses;
    for (const Family<dim> &family : families)
      losses.emplace_back(family.squared_loss, family.squared_loss);
    const double threshold =
      marking_threshold(losses, excess, ThresholdSide::below, communicator);
    for (const Family<dim> &family : families)
      if (family.squared_loss > threshold)
        for (const auto &child : family.parent->child_iterators())
          child->clear_coarsen_flag();
    prepare_mesh_change(triangulation);
  }



  VISCOPLASTIC_INSTANTIATE(memory_loss);
  VISCOPLASTIC_INSTANTIATE(limit_memory_loss);
} // namespace Viscoplastic
