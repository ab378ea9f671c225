// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/results/body_fields.h>

namespace Viscoplastic
{
  namespace
  {
    /// Return the equivalent strain (2/3 e:e)^(1/2) of the deviator e of a
    /// strain.
    double
    equivalent_strain(const SymmetricTensor<2, 3> &strain)
    {
      return std::sqrt(2. / 3.) * deviator(strain).norm();
    }



    /// Return the initial z on the present mesh.
    template <int dim>
    IrreversibleStress
    initial_z(const StressSpace<dim> &stress_space, const State<dim> &state)
    {
      const Scene<dim> &scene = stress_space.space.scene;
      if (!scene.initial_displacement)
        return initial_irreversible_stress(stress_space, DistributedVector());
      // state.initial_u is then the displacement of the equilibrium.
      if (scene.parameters.initial_state.equilibrate)
        return make_initial_state(stress_space, true).z;
      return initial_irreversible_stress(stress_space, state.initial_u);
    }



    /// Whether the values of a field are cell means.
    bool
    is_mean(const RecordedField field)
    {
      return !is_of_boundary(field) && field != RecordedField::displacement &&
             field != RecordedField::velocity;
    }



    template <int dim>
    void
    append(const SymmetricTensor<2, 3> &tensor, std::vector<double> &values)
    {
      for (const auto &[i, j] : stress_components<dim>())
        values.push_back(tensor[i][j]);
    }



    /// Return -E^-1 of the mean of a stress at the samples of a cell; zero if
    /// @p stress is empty.
    template <int dim>
    SymmetricTensor<2, 3>
    minus_strain(const StressSpace<dim>   &stress_space,
                 const IrreversibleStress &stress,
                 const std::size_t         cell)
    {
      return stress.empty() ?
               SymmetricTensor<2, 3>() :
               stress_space.moduli(cell).strain(
                 -1. *
                 stress_space.mean(cell,
                                   &stress[cell * stress_space.n_samples]));
    }
  } // namespace



  template <int dim>
  BodyFields<dim>::BodyFields(const FlowLaws<dim>           &laws,
                              const State<dim>              &state,
                              const std::set<RecordedField> &fields)
    : stress_space(laws.stress_space)
    , state(state)
    , u(reported_displacement(laws.stress_space.space.scene, state, difference))
    , irreversible(
        without_thermal_stress(laws.thermal.get(), state.t, state.z, rest))
    , now(laws.at(state.t, state.history))
  {
    for (const RecordedField field : fields)
      if (is_mean(field))
        cell_fields.insert(field);
      else if (!is_of_boundary(field))
        nodal_fields.push_back(
          field == RecordedField::displacement ? &u : &state.velocity);

    const Scene<dim> &scene = stress_space.space.scene;
    // Irreversible strain of the initial data is not creep.
    if (cell_fields.count(RecordedField::creep_strain) > 0 &&
        scene.has_irreversible_stress() && // collective, also without cells
        (scene.initial_stress || scene.initial_displacement))
      {
        const IrreversibleStress initial = initial_z(stress_space, state);
        for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
          initial_strain.push_back(minus_strain(stress_space, initial, c));
      }
    if (cell_fields.count(RecordedField::creep_rate) > 0 &&
        scene.has_viscosity())
      rate = evaluate_flow(laws, state, state.t).rate;
  }



  template <int dim>
  std::set<RecordedField>
  BodyFields<dim>::of_output(const Scene<dim> &scene)
  {
    std::set<RecordedField> result{RecordedField::stress,
                                   RecordedField::von_mises_stress};
    if (scene.has_irreversible_stress())
      result.insert(RecordedField::irreversible_stress);
    if (scene.has_history())
      result.insert(RecordedField::history);
    if (scene.temperature)
      result.insert(RecordedField::temperature);
    for (const RecordedField field : scene.parameters.output.additional_fields)
      if (is_mean(field))
        result.insert(field);
    return result;
  }



  template <int dim>
  void
  BodyFields<dim>::add(const std::size_t         cell,
                       const VertexWeights<dim> &weights,
                       double                   *values) const
  {
    const unsigned int *nodes = stress_space.nodes_of_cell(cell);
    double              sum   = 0.;
    for (const double weight : weights)
      sum += weight;
    for (const DistributedVector *field : nodal_fields)
      {
        for (unsigned int v = 0; v < weights.size(); ++v)
          for (unsigned int d = 0; d < dim; ++d)
            values[d] += weights[v] * field->begin()[nodes[v] + d];
        values += dim;
      }
    for (const double mean : means(cell))
      *values++ += sum * mean;
  }



  template <int dim>
  std::vector<double>
  BodyFields<dim>::means(const std::size_t cell) const
  {
    std::vector<double> result;
    if (cell_fields.empty())
      return result;
    const SymmetricTensor<2, 3> strain =
      stress_space.mean_strain(cell, state.u.begin());
    SymmetricTensor<2, 3> z;
    if (!state.z.empty())
      z = stress_space.mean(cell, &state.z[cell * stress_space.n_samples]);
    const SymmetricTensor<2, 3> stress =
      stress_space.moduli(cell).stress(strain) + z;
    for (const RecordedField field : cell_fields)
      switch (field)
        {
          case RecordedField::stress:
            append<dim>(stress, result);
            break;
          case RecordedField::von_mises_stress:
            result.push_back(von_mises(stress));
            break;
          case RecordedField::irreversible_stress:
            append<dim>(irreversible.empty() ?
                          SymmetricTensor<2, 3>() :
                          stress_space.mean(
                            cell, &irreversible[cell * stress_space.n_samples]),
                        result);
            break;
          case RecordedField::total_strain:
            append<dim>(stress_space.mean_strain(cell, u.begin()), result);
            break;
          case RecordedField::irreversible_strain:
            // eps(u) - E^-1 sigma - alpha (T - T_0) I
            append<dim>(minus_strain(stress_space, irreversible, cell), result);
            break;
          case RecordedField::creep_strain:
            {
              auto creep = minus_strain(stress_space, irreversible, cell);
              if (!initial_strain.empty())
                creep -= initial_strain[cell];
              result.push_back(equivalent_strain(creep));
              break;
            }
          case RecordedField::creep_rate:
            result.push_back(
              equivalent_strain(minus_strain(stress_space, rate, cell)));
            break;
          case RecordedField::history:
            append<dim>(stress_space.mean(
                          cell, &state.history[cell * stress_space.n_samples]),
                        result);
            break;
          case RecordedField::principal_stresses:
            for (const double value : eigenvalues(stress))
              result.push_back(value);
            break;
          case RecordedField::temperature:
            {
              double mean = 0.;
              for (unsigned int s = 0; s < stress_space.n_samples; ++s)
                mean +=
                  now.temperature(cell, s) *
                  (stress_space.weight(cell, s) / stress_space.volume(cell));
              result.push_back(mean);
              break;
            }
          default:
            Assert(false, ExcInternalError());
        }
    return result;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(BodyFields);
} // namespace Viscoplastic
