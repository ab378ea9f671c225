// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/largest_place.h>
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/discretization/energy.h>

namespace Viscoplastic
{
  namespace
  {
    double
    square(const SymmetricTensor<2, 3> &tensor)
    {
      return tensor * tensor;
    }
  } // namespace



  template <int dim>
  FlowEnergies
  energies_of_cell(const FlowLaws<dim>                  &laws,
                   const typename FlowLaws<dim>::AtTime &before,
                   const typename FlowLaws<dim>::AtTime &now,
                   const State<dim>                     &old_state,
                   const State<dim>                     &state,
                   const std::size_t                     c)
  {
    const StressSpace<dim> &stress_space = laws.stress_space;
    const unsigned int      n            = stress_space.n_samples;
    const Stiffness        &stiffness    = stress_space.moduli(c);
    const ViscoplasticLaw  *law          = now.law(c);
    // There are at most 2^dim samples, which need no heap memory.
    using Samples =
      std::array<SymmetricTensor<2, 3>, GeometryInfo<dim>::vertices_per_cell>;
    FlowEnergies result;
    if (state.z.empty())
      return result;
    // A source makes flow also in cells without a law.
    const bool flows = law || laws.source_solution;
    const bool is_heated =
      laws.thermal && laws.thermal->expands && laws.thermal->varies_in_time;
    const SymmetricTensor<2, 3> *of_cell     = &state.z[c * n],
                                *old_of_cell = &old_state.z[c * n];
    result.irreversible_energy =
      0.5 * stress_space.complementary_square(c, of_cell);
    if (!flows && !is_heated)
      return result;
    Samples strain, old_strain;
    stress_space.strains(c, state.u.begin(), strain.data());
    stress_space.strains(c, old_state.u.begin(), old_strain.data());
    for (unsigned int s = 0; s < n; ++s)
      {
        const SymmetricTensor<2, 3> &z = of_cell[s], &old_z = old_of_cell[s];
        const double                 weight = stress_space.weight(c, s);
        const double                 growth =
          is_heated ? now.thermal_strain(c, s) - before.thermal_strain(c, s) :
                                      0.;
        if (growth != 0.)
          result.thermal_work -=
            0.5 * weight * growth *
            trace(stiffness.stress(old_strain[s] + strain[s]) + old_z + z);
        if (!flows)
          continue;
        const SymmetricTensor<2, 3> mean_strain =
                                      0.5 * (old_strain[s] + strain[s]),
                                    mean_z = 0.5 * (old_z + z);
        // E^-1 sigma of the mean stress in the step.
        SymmetricTensor<2, 3> driving_strain =
          mean_strain + stiffness.strain(mean_z);
        SymmetricTensor<2, 3> flow = z - old_z;
        if (growth != 0.)
          flow -= ThermalStrain<dim>::stress(stiffness, growth);
        // Parameters may be costly expressions: only these laws evaluate them.
        if (law && law->has_own_energy())
          {
            const LawPoint              point = now.point(c, s);
            const SymmetricTensor<2, 3> old_strain_of_law =
                                          before.mechanical(old_strain[s],
                                                            c,
                                                            s),
                                        strain_of_law =
                                          now.mechanical(strain[s], c, s);
            // The stored energy minus that of the stress.
            const auto own_energy = [&](const SymmetricTensor<2, 3> &total,
                                        const SymmetricTensor<2, 3> &z,
                                        const SymmetricTensor<2, 3> &of_law,
                                        const LawPoint              &at) {
              const SymmetricTensor<2, 3> stress = stiffness.stress(total) + z;
              return weight *
                     (law->stored_energy(stress, of_law, stiffness, at) -
                      0.5 * stiffness.complementary_square(stress));
            };
            const double energy =
              own_energy(strain[s], z, strain_of_law, point);
            result.irreversible_energy += energy;
            if (law->n_history_variables > 0)
              {
                LawPoint start = point;
                start.history  = before.point(c, s).history;
                result.viscous_dissipation -=
                  energy -
                  own_energy(old_strain[s], old_z, old_strain_of_law, start);
              }
            else
              driving_strain =
                law->driving_strain(stiffness.stress(mean_strain) + mean_z,
                                    0.5 * (old_strain_of_law + strain_of_law),
                                    stiffness,
                                    point);
          }
        result.viscous_dissipation -= weight * (flow * driving_strain);
      }
    return result;
  }



  template <int dim>
  FlowEnergies
  energies_of_flow(const FlowLaws<dim> &laws,
                   const State<dim>    &old_state,
                   const State<dim>    &state)
  {
    const AdmissibleSpace<dim> &space = laws.stress_space.space;
    const auto before                 = laws.at(old_state.t, old_state.history),
               now                    = laws.at(state.t, state.history);
    std::vector<double> sums(3, 0.);
    for (std::size_t c = 0; c < laws.stress_space.n_cells(); ++c)
      if (space.scene.is_present(space.cells[c]->material_id()))
        {
          const FlowEnergies of_cell =
            energies_of_cell(laws, before, now, old_state, state, c);
          sums[0] += of_cell.irreversible_energy;
          sums[1] += of_cell.viscous_dissipation;
          sums[2] += of_cell.thermal_work;
        }
    Utilities::MPI::sum(sums, space.communicator, sums);
    return {sums[0], sums[1], sums[2]};
  }



  template <int dim>
  StressSummary<dim>
  summarize_stress(const StressSpace<dim> &stress_space,
                   const State<dim>       &state)
  {
    StressSummary<dim> result;
    LargestPlace<dim>  largest_mises;
    const bool         has_stages = stress_space.space.scene.has_stages();
    double             volume = 0., strains = 0.;
    for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
      {
        const auto &cell = stress_space.space.cells[c];
        if (has_stages &&
            !stress_space.space.scene.is_present(cell->material_id()))
          continue;
        const SymmetricTensor<2, 3> mean_strain =
          stress_space.mean_strain(c, state.u.begin());
        SymmetricTensor<2, 3> stress =
          stress_space.moduli(c).stress(mean_strain);
        if (!state.z.empty())
          stress += stress_space.mean(c, &state.z[c * stress_space.n_samples]);
        const double mises = std::sqrt(1.5) * stable_norm(deviator(stress));
        if (largest_mises.may_take(mises))
          largest_mises.add(mises, cell->center());
        const double strain  = mean_strain.norm(),
                     of_cell = stress_space.volume(c),
                     weight  = strain * strain * of_cell;
        strains += weight;
        result.mean_strain += weight * strain;
        result.mean_von_mises += mises * of_cell;
        result.stress_norm += (stress * stress) * of_cell;
        volume += of_cell;
      }

    const MPI_Comm      comm = stress_space.space.communicator;
    std::vector<double> sums{result.mean_von_mises,
                             result.stress_norm,
                             volume,
                             strains,
                             result.mean_strain};
    Utilities::MPI::sum(sums, comm, sums);
    largest_mises.reduce(comm);
    result.max_von_mises      = largest_mises.value();
    result.von_mises_position = largest_mises.position();
    result.mean_von_mises     = sums[0] / sums[2];
    result.stress_norm        = std::sqrt(sums[1]);
    result.mean_strain        = sums[3] > 0. ? sums[4] / sums[3] : 0.;
    return result;
  }



  template <int dim>
  double
  relative_stress_fluctuation(const StressSpace<dim> &stress_space,
                              const State<dim>       &state)
  {
    // A space of cell means does not contain the strain within cells.
    const StressSpace<dim>             points(stress_space.space,
                                  stress_space.moduli,
                                  /* at_quadrature_points = */ true,
                                  stress_space.mean_dilatation);
    std::vector<SymmetricTensor<2, 3>> stress(points.n_samples);
    std::vector<double>                sums(2, 0.);
    for (std::size_t c = 0; c < points.n_cells(); ++c)
      {
        points.strains(c, state.u.begin(), stress.data());
        for (unsigned int s = 0; s < points.n_samples; ++s)
          {
            stress[s] = stress_space.moduli(c).stress(stress[s]);
            if (!state.z.empty())
              stress[s] += state.z[c * stress_space.n_samples +
                                   (stress_space.n_samples == 1 ? 0 : s)];
          }
        const SymmetricTensor<2, 3> mean = points.mean(c, stress.data());
        for (unsigned int s = 0; s < points.n_samples; ++s)
          {
            sums[0] += square(stress[s] - mean) * points.weight(c, s);
            sums[1] += square(stress[s]) * points.weight(c, s);
          }
      }
    Utilities::MPI::sum(sums, stress_space.space.communicator, sums);
    return sums[1] > 0. ? std::sqrt(sums[0] / sums[1]) : 0.;
  }



  VISCOPLASTIC_INSTANTIATE(summarize_stress);
  VISCOPLASTIC_INSTANTIATE(energies_of_cell);
  VISCOPLASTIC_INSTANTIATE(energies_of_flow);
  VISCOPLASTIC_INSTANTIATE(relative_stress_fluctuation);
} // namespace Viscoplastic
