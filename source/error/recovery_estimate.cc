// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <viscoplastic_contact/error/recovery_estimate.h>

#include <array>

namespace Viscoplastic
{
  namespace
  {
    constexpr unsigned int n_components =
      SymmetricTensor<2, 3>::n_independent_components;

    using NodalVector = LinearAlgebra::distributed::Vector<double>;



    /// Continuous strains of each material.
    template <int dim>
    class RecoveredStrain
    {
    public:
      explicit RecoveredStrain(const StressSpace<dim> &stress_space)
        : stress_space(stress_space)
        , fe(1)
        , dof_handler(stress_space.space.dof_handler.get_triangulation())
        , dofs(fe.n_dofs_per_cell())
      {
        dof_handler.distribute_dofs(fe);
        IndexSet relevant;
        DoFTools::extract_locally_relevant_dofs(dof_handler, relevant);
        hanging_nodes.reinit(relevant);
        DoFTools::make_hanging_node_constraints(dof_handler, hanging_nodes);
        hanging_nodes.close();
        weight.reinit(dof_handler.locally_owned_dofs(),
                      relevant,
                      stress_space.space.communicator);
        for (NodalVector &value : values)
          value.reinit(weight);
      }

      /// Take the means of the cells of a material. Collective.
      void
      recover(const State<dim> &state, const types::material_id material)
      {
        weight = 0.;
        for (NodalVector &value : values)
          value = 0.;
        std::vector<SymmetricTensor<2, 3>> samples(stress_space.n_samples);
        for_each_cell(material, [&](const std::size_t c) {
          stress_space.strains(c, state.u.begin(), samples.data());
          const SymmetricTensor<2, 3> mean =
            stress_space.mean(c, samples.data());
          for (const types::global_dof_index dof : dofs)
            {
              weight(dof) += stress_space.volume(c);
              for (unsigned int i = 0; i < n_components; ++i)
                values[i](dof) +=
                  stress_space.volume(c) * mean.access_raw_entry(i);
            }
        });
        weight.compress(VectorOperation::add);
        weight.update_ghost_values();
        for (NodalVector &value : values)
          {
            value.compress(VectorOperation::add);
            for (std::size_t i = 0; i < value.locally_owned_size(); ++i)
              if (weight.local_element(i) > 0.)
                value.local_element(i) /= weight.local_element(i);
            value.update_ghost_values();
          }
      }

      /// Its value at a node: hanging ones take that of their parents, if the
      /// material is at all of them.
      SymmetricTensor<2, 3>
      at(const types::global_dof_index dof) const
      {
        SymmetricTensor<2, 3> result;
        const auto *parents         = hanging_nodes.get_constraint_entries(dof);
        bool        is_interpolated = parents != nullptr;
        if (parents != nullptr)
          for (const auto &parent : *parents)
            is_interpolated &= weight(parent.first) > 0.;
        for (unsigned int i = 0; i < n_components; ++i)
          if (is_interpolated)
            for (const auto &[parent, factor] : *parents)
              result.access_raw_entry(i) += factor * values[i](parent);
          else
            result.access_raw_entry(i) = values[i](dof);
        return result;
      }

      /// Call @p work(c) for each owned cell of a material, c its place among
      /// all of them; its nodes are in @p dofs.
      template <typename Work>
      void
      for_each_cell(const types::material_id material, const Work &work)
      {
        std::size_t c = 0;
        for (const auto &cell : stress_space.space.cells)
          {
            if (cell->material_id() == material)
              {
                const typename DoFHandler<dim>::active_cell_iterator here(
                  &dof_handler.get_triangulation(),
                  cell->level(),
                  cell->index(),
                  &dof_handler);
                here->get_dof_indices(dofs);
                work(c);
              }
            ++c;
          }
      }

    private:
      const StressSpace<dim>   &stress_space;
      const FE_Q<dim>           fe;
      DoFHandler<dim>           dof_handler;
      AffineConstraints<double> hanging_nodes;
      NodalVector               weight;

      std::array<NodalVector, n_components> values;

    public:
      /// The nodes of the cell in hand.
      std::vector<types::global_dof_index> dofs;
    };
  } // namespace



  template <int dim>
  Vector<double>
  squared_recovery_estimate(const StressSpace<dim> &stress_space,
                            const State<dim>       &state)
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    const auto       &triangulation   = space.dof_handler.get_triangulation();
    const FE_Q<dim>   fe(1);
    const QGauss<dim> quadrature(2);
    const StressSpace<dim>             points(space,
                                  stress_space.moduli,
                                  /* at_quadrature_points = */ true,
                                  stress_space.mean_dilatation);
    std::vector<SymmetricTensor<2, 3>> strains(points.n_samples);
    Vector<double>                     result(triangulation.n_active_cells());
    std::vector<std::size_t>           number;
    for (const auto &cell : space.cells)
      number.push_back(cell->active_cell_index());

    std::set<types::material_id> materials;
    for (const auto &cell : triangulation.cell_iterators_on_level(0))
      materials.insert(cell->material_id()); // the same on all ranks
    RecoveredStrain<dim> recovered(stress_space);
    for (const types::material_id material : materials)
      {
        recovered.recover(state, material);
        recovered.for_each_cell(material, [&](const std::size_t c) {
          points.strains(c, state.u.begin(), strains.data());
          std::vector<SymmetricTensor<2, 3>> at_nodes;
          for (const types::global_dof_index dof : recovered.dofs)
            at_nodes.push_back(recovered.at(dof));
          double sum = 0.;
          for (unsigned int q = 0; q < points.n_samples; ++q)
            {
              SymmetricTensor<2, 3> defect = -1. * strains[q];
              for (unsigned int v = 0; v < at_nodes.size(); ++v)
                defect += fe.shape_value(v, quadrature.point(q)) * at_nodes[v];
              sum += points.weight(c, q) *
                     (stress_space.moduli(c).stress(defect) * defect);
            }
          result[number[c]] = sum;
        });
      }
    return result;
  }



  template Vector<double>
  squared_recovery_estimate<2>(const StressSpace<2> &, const State<2> &);
  template Vector<double>
  squared_recovery_estimate<3>(const StressSpace<3> &, const State<3> &);
} // namespace Viscoplastic
