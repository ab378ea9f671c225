// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/results/body_fields.h>

#include <cmath>
#include <functional>

namespace Viscoplastic
{
  namespace
  {
    /// The strain in one direction that has the same (2/3 e:e)^(1/2), without
    /// the change of volume.
    double
    equivalent_strain(const SymmetricTensor<2, 3> &strain)
    {
      return std::sqrt(2. / 3.) * deviator(strain).norm();
    }



    /// z_0 as it would be on the present mesh.
    template <int dim>
    IrreversibleStress
    initial_z(const StressSpace<dim> &stress_space, const State<dim> &state)
    {
      const Scene<dim> &scene = stress_space.space.scene;
      if (!scene.initial_displacement)
        return initial_irreversible_stress(stress_space, DistributedVector());
      // The displacement that the state has kept is that of equilibrium.
      if (scene.parameters.initial_state.equilibrate)
        return make_initial_state(stress_space, true).z;
      return initial_irreversible_stress(stress_space, state.initial_u);
    }



    /// The cell means of fields of stresses and strains at samples.
    template <int dim>
    class Fields
    {
    public:
      explicit Fields(const StressSpace<dim> &stress_space)
        : stress_space(stress_space)
      {}

      /// Add a scalar, value(c) in the owned cell c.
      void
      add(const std::string                              &name,
          const std::function<double(const std::size_t)> &value)
      {
        const auto &cells = stress_space.space.cells;
        CellField   field{name,
                        Vector<double>(
                          stress_space.space.dof_handler.get_triangulation()
                            .n_active_cells())};
        for (std::size_t c = 0; c < cells.size(); ++c)
          field.values[cells[c]->active_cell_index()] = value(c);
        fields.push_back(std::move(field));
      }

      /// Add the components of a tensor.
      void
      add_tensor(const std::string                        &name,
                 const std::vector<SymmetricTensor<2, 3>> &values)
      {
        const std::string xyz = "xyz";
        for (const auto &[i, j] : stress_components<dim>())
          add(name + "_" + xyz[i] + xyz[j],
              [&values, i = i, j = j](const std::size_t c) {
                return values[c][i][j];
              });
      }

      /// -E^-1 of the mean of a stress at samples, zero if there is none.
      std::vector<SymmetricTensor<2, 3>>
      minus_strain(const IrreversibleStress &stress) const
      {
        std::vector<SymmetricTensor<2, 3>> result(stress_space.n_cells());
        if (!stress.empty())
          for (std::size_t c = 0; c < result.size(); ++c)
            result[c] = stress_space.moduli(c).strain(
              -1. * stress_space.mean(c, &stress[c * stress_space.n_samples]));
        return result;
      }

      std::vector<CellField> fields;

    private:
      const StressSpace<dim> &stress_space;
    };
  } // namespace



  template <int dim>
  std::vector<CellField>
  additional_fields(const FlowLaws<dim> &laws, const State<dim> &state)
  {
    using Strains                        = std::vector<SymmetricTensor<2, 3>>;
    const StressSpace<dim> &stress_space = laws.stress_space;
    const Scene<dim>       &scene        = stress_space.space.scene;
    const OutputParameters &asked        = scene.parameters.output;
    const std::size_t       n_cells      = stress_space.n_cells();
    Fields<dim>             result(stress_space);

    if (asked.has(AdditionalField::total_strain))
      {
        Strains strain(n_cells), samples(stress_space.n_samples);
        for (std::size_t c = 0; c < n_cells; ++c)
          {
            stress_space.strains(c, state.u.begin(), samples.data());
            strain[c] = stress_space.mean(c, samples.data());
          }
        result.add_tensor("strain", strain);
      }

    // eps(u) - E^-1 sigma = -E^-1 z
    const bool needs_creep = asked.has(AdditionalField::creep_strain);
    Strains    irreversible;
    if (asked.has(AdditionalField::irreversible_strain) || needs_creep)
      irreversible = result.minus_strain(state.z);
    if (asked.has(AdditionalField::irreversible_strain))
      result.add_tensor("irreversible_strain", irreversible);
    if (needs_creep)
      {
        // What the initial data have of it has not crept.
        if (scene.has_irreversible_stress() && // collective, also without cells
            (scene.initial_stress || scene.initial_displacement))
          {
            const Strains initial =
              result.minus_strain(initial_z(stress_space, state));
            for (std::size_t c = 0; c < n_cells; ++c)
              irreversible[c] -= initial[c];
          }
        result.add("creep_strain", [&](const std::size_t c) {
          return equivalent_strain(irreversible[c]);
        });
      }
    if (asked.has(AdditionalField::creep_rate))
      {
        const Strains rate = result.minus_strain(
          scene.has_viscosity() ?
            evaluate_flow(laws, state.u, state.z, state.t).rate :
            IrreversibleStress());
        result.add("creep_rate", [&](const std::size_t c) {
          return equivalent_strain(rate[c]);
        });
      }

    if (asked.has(AdditionalField::principal_stresses))
      {
        std::vector<std::array<double, 3>> principal;
        for (const auto &stress : stress_space.mean_stress(state.u, state.z))
          principal.push_back(eigenvalues(stress));
        for (unsigned int i = 0; i < 3; ++i)
          result.add("principal_stress_" + std::to_string(i + 1),
                     [&principal, i](const std::size_t c) {
                       return principal[c][i];
                     });
      }
    return std::move(result.fields);
  }



  template std::vector<CellField>
  additional_fields<2>(const FlowLaws<2> &, const State<2> &);
  template std::vector<CellField>
  additional_fields<3>(const FlowLaws<3> &, const State<3> &);
} // namespace Viscoplastic
