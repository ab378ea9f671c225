// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/discretization/bulk_system.h>
#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/discretization/springs.h>
#include <viscoplastic_contact/discretization/thermal_strain.h>


namespace Viscoplastic
{
  template <int dim>
  SymmetricTensor<2, 3>
  initial_stress(const Scene<dim>        &scene,
                 const Point<dim>        &x,
                 const types::material_id id)
  {
    SymmetricTensor<2, 3> result;
    const Material<dim>  &material = scene.material(id);
    if (!scene.initial_stress || material.is_absent ||
        std::isfinite(material.added_at))
      return result;
    const auto components = stress_components<dim>();
    for (unsigned int c = 0; c < components.size(); ++c)
      result[components[c].first][components[c].second] =
        scene.initial_stress->value(x, 0., c);
    return result;
  }



  namespace
  {
    /// The thermal stress -E alpha (T - T_0) I at t = 0.
    template <int dim>
    SymmetricTensor<2, 3>
    initial_thermal_stress(const Scene<dim>        &scene,
                           const Point<dim>        &x,
                           const types::material_id id)
    {
      const Material<dim> &material = scene.material(id);
      if (!scene.has_initial_thermal_stress() || !material.thermal_expansion)
        return {};
      return ThermalStrain<dim>::stress(
        material.stiffness(x),
        material.expansion(x) * (scene.temperature->value.value(x, 0.) -
                                 *scene.temperature->reference));
    }



    /// Call visit(cell, fe_values) for each owned cell.
    template <int dim, typename Visitor>
    void
    for_each_cell(const AdmissibleSpace<dim> &space,
                  const unsigned int          n_points,
                  const Visitor              &visit)
    {
      FEValues<dim> fe_values(space.mapping,
                              space.dof_handler.get_fe(),
                              QGauss<dim>(n_points),
                              update_values | update_gradients |
                                update_JxW_values | update_quadrature_points);
      for (const auto &cell : space.cells)
        {
          fe_values.reinit(cell);
          visit(cell, fe_values);
        }
    }



    /// int tau(x, material) : eps(v) as a load vector in frames.
    template <int dim, typename Stress>
    DistributedVector
    virtual_work(const AdmissibleSpace<dim> &space,
                 const unsigned int          n_points,
                 const Stress               &stress)
    {
      std::vector<double> cartesian(space.relevant.n_elements());
      for_each_cell(space, n_points, [&](const auto &cell, const auto &values) {
        for (const unsigned int q : values.quadrature_point_indices())
          {
            const SymmetricTensor<2, 3> tau =
              stress(values.quadrature_point(q), cell->material_id()) *
              values.JxW(q);
            if (space.axial)
              cartesian[*space.axial] += tau[2][2] / space.axial_length;
            for (const unsigned int v : cell->vertex_indices())
              {
                const auto node =
                  space.relevant.index_within_set(cell->vertex_dof_index(v, 0));
                const Tensor<1, dim> gradient = values.shape_grad(v * dim, q);
                for (unsigned int i = 0; i < dim; ++i)
                  for (unsigned int j = 0; j < dim; ++j)
                    cartesian[node + i] += tau[i][j] * gradient[j];
                if (space.scene.is_axisymmetric())
                  cartesian[node] +=
                    tau[2][2] * hoop_strain(values, v * dim, q);
              }
          }
      });
      DistributedVector result = space.owned_vector();
      space.add_cartesian_load(cartesian, result);
      return result;
    }



    template <int dim>
    SymmetricTensor<2, 3>
    initial_strain(const Scene<dim> &scene, const Point<dim> &x)
    {
      Tensor<2, dim> gradient;
      for (unsigned int i = 0; i < dim; ++i)
        gradient[i] = (*scene.initial_displacement)[i].gradient(x, 0.);
      return strain(scene.initial_displacement->vector(x, 0.),
                    gradient,
                    x,
                    scene.plane_model(),
                    0.);
    }



    /// u0 at the nodes, in frames, to compare with prescribed values.
    template <int dim>
    DistributedVector
    interpolate_initial_displacement(const AdmissibleSpace<dim> &space)
    {
      DistributedVector values    = space.owned_vector(),
                        ghosted   = space.ghosted_vector(),
                        in_frames = space.owned_vector();
      if (space.scene.initial_displacement)
        {
          for (const auto &cell : space.cells)
            for (const unsigned int v : cell->vertex_indices())
              {
                const auto dof = cell->vertex_dof_index(v, 0);
                if (!space.owned.is_element(dof))
                  continue;
                const Tensor<1, dim> u =
                  space.scene.initial_displacement->vector(cell->vertex(v), 0.);
                for (unsigned int d = 0; d < dim; ++d)
                  values.begin()[space.owned.index_within_set(dof) + d] = u[d];
              }
          ghosted = values;
          space.to_frames(ghosted, in_frames);
        }
      return in_frames;
    }
  } // namespace



  template <int dim>
  DistributedVector
  work_of_initial_stress(const AdmissibleSpace<dim> &space,
                         const unsigned int          n_points)
  {
    return virtual_work(space,
                        n_points,
                        [&](const Point<dim> &x, const types::material_id id) {
                          return initial_stress(space.scene, x, id) +
                                 initial_thermal_stress(space.scene, x, id);
                        });
  }



  template <int dim>
  const DistributedVector &
  reported_displacement(const Scene<dim>  &scene,
                        const State<dim>  &state,
                        DistributedVector &difference)
  {
    if (!scene.parameters.initial_state.reset_displacement ||
        state.initial_u.size() == 0)
      return state.u;
    difference = state.u;
    difference -= state.initial_u;
    return difference;
  }



  template <int dim>
  IrreversibleStress
  initial_irreversible_stress(const StressSpace<dim>  &stress_space,
                              const DistributedVector &u0)
  {
    const AdmissibleSpace<dim>        &space     = stress_space.space;
    const unsigned int                 n_samples = stress_space.n_samples;
    IrreversibleStress                 z(stress_space.n_cells() * n_samples);
    std::vector<SymmetricTensor<2, 3>> strain(n_samples);
    if (u0.size() > 0)
      for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
        {
          stress_space.strains(c, u0.begin(), strain.data());
          for (unsigned int s = 0; s < n_samples; ++s)
            z[c * n_samples + s] =
              -1. * stress_space.moduli(c).stress(strain[s]);
        }
    // (3.18): sigma0^h = P_Qh sigma0.
    if (space.scene.initial_stress)
      {
        std::size_t c = 0;
        for_each_cell(space, 2, [&](const auto &cell, const auto &values) {
          for (const unsigned int q : values.quadrature_point_indices())
            {
              const SymmetricTensor<2, 3> stress =
                initial_stress(space.scene,
                               values.quadrature_point(q),
                               cell->material_id());
              if (n_samples == 1)
                z[c] += stress * (values.JxW(q) / stress_space.volume(c));
              else
                z[c * n_samples + q] += stress;
            }
          ++c;
        });
      }
    return z;
  }



  template <int dim>
  State<dim>
  make_initial_state(const StressSpace<dim> &stress_space,
                     const bool              equilibrate)
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    const Scene<dim>           &scene = space.scene;

    // Do u0 and the prescribed displacements agree at t = 0?
    DistributedVector u          = interpolate_initial_displacement(space);
    DistributedVector prescribed = u;
    space.set_prescribed(0., prescribed);
    DistributedVector difference = prescribed;
    difference -= u;
    const double contradiction = difference.linfty_norm();
    const double size          = std::max(u.linfty_norm(), 1e-300);
    if (!equilibrate && contradiction > 1e-8 * size)
      {
        refuse("The initial displacement contradicts the displacements "
               "prescribed at t = 0 by " +
               as_text(contradiction) +
               "; let them agree, or set 'Initial state/Equilibrate'.");
      }

    State<dim> state;
    state.u        = space.ghosted_vector();
    state.velocity = space.ghosted_vector();
    if (scene.initial_displacement)
      {
        // (3.18): u0^h = P_Vh u0 in (eps(u), eps(v)), the form a(.,.) with
        // E = identity: Young's modulus 1, Poisson's ratio 0.
        const ElasticModuli<dim> identity(Stiffness::isotropic(1., 0.));
        DistributedMatrix        matrix;
        assemble_elastic_matrix(space, identity, false, matrix);
        DistributedVector load =
          virtual_work(space,
                       3,
                       [&](const Point<dim> &x, const types::material_id) {
                         return initial_strain(scene, x);
                       });
        if (scene.has_springs())
          {
            // Add springs to the form, as they may be all that holds the body.
            const Springs<dim> springs(space);
            double             unit = 0.;
            for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
              unit = std::max(
                unit, stress_space.moduli(c).smallest_deviatoric_eigenvalue());
            unit = Utilities::MPI::max(unit, space.communicator);
            space.to_cartesian(prescribed, state.u);
            springs.add_force(state.u, load, -1. / unit);
            springs.add_to(matrix, 1. / unit);
          }
        const FaceRestriction no_face;
        make_bulk_solver(make_bulk_system(space, matrix, no_face), {})
          ->solve(load, prescribed, 1e-10);
        space.to_cartesian(prescribed, state.u);
        state.initial_u = state.u;
      }

    if (scene.has_irreversible_stress())
      state.z = initial_irreversible_stress(stress_space, state.u);
    if (scene.has_initial_thermal_stress())
      ThermalStrain<dim>(stress_space).add_stress(0., 1., state.z);
    if (scene.has_history())
      state.history.resize(state.z.size());
    return state;
  }



  template <int dim>
  double
  initial_data_error(const StressSpace<dim> &stress_space,
                     const State<dim>       &state,
                     Vector<double>         *squared_by_cell)
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    const Scene<dim>           &scene = space.scene;
    if (squared_by_cell != nullptr)
      squared_by_cell->reinit(
        space.dof_handler.get_triangulation().n_active_cells());
    if (!scene.initial_displacement && !scene.initial_stress)
      return 0.;
    // The thermal stress counts as exact and is left out.
    IrreversibleStress        rest;
    const auto                thermal = scene.has_initial_thermal_stress() ?
                                          std::make_unique<ThermalStrain<dim>>(stress_space) :
                                          nullptr;
    const IrreversibleStress &z =
      without_thermal_stress(thermal.get(), 0., state.z, rest);
    std::vector<double>                sums(2, 0.);
    std::vector<SymmetricTensor<2, 3>> strain(stress_space.n_samples);
    std::size_t                        c = 0;
    for_each_cell(space, 3, [&](const auto &cell, const auto &values) {
      const Stiffness &stiffness = stress_space.moduli(c);
      stress_space.strains(c, state.u.begin(), strain.data());
      // sigma0^h at the samples
      for (unsigned int s = 0; s < stress_space.n_samples; ++s)
        strain[s] =
          stiffness.stress(strain[s]) + z[c * stress_space.n_samples + s];
      const std::vector<SymmetricTensor<2, 3>> &sigma  = strain;
      const double                              before = sums[0] + sums[1];
      for (const unsigned int q : values.quadrature_point_indices())
        {
          SymmetricTensor<2, 3> error;
          error[2][2] = -space.axial_strain(state.u.begin());
          for (const unsigned int v : cell->vertex_indices())
            {
              const double *u =
                &state.u.begin()[space.relevant.index_within_set(
                  cell->vertex_dof_index(v, 0))];
              for (unsigned int i = 0; i < dim; ++i)
                for (unsigned int j = 0; j < dim; ++j)
                  error[i][j] -= (i == j ? 1. : 0.5) * u[i] *
                                 values.shape_grad(v * dim, q)[j];
              if (scene.is_axisymmetric())
                error[2][2] -= u[0] * hoop_strain(values, v * dim, q);
            }
          if (scene.initial_displacement)
            error += initial_strain(scene, values.quadrature_point(q));
          sums[0] += (stiffness.stress(error) * error) * values.JxW(q);
          error = 0.;
          for (unsigned int s = 0; s < stress_space.n_samples; ++s)
            error -= stress_space.element->shape_value(
                       s, values.get_quadrature().point(q)) *
                     sigma[s];
          if (scene.initial_stress)
            error += initial_stress(scene,
                                    values.quadrature_point(q),
                                    cell->material_id());
          sums[1] += (stiffness.strain(error) * error) * values.JxW(q);
        }
      if (squared_by_cell != nullptr)
        (*squared_by_cell)[cell->active_cell_index()] =
          sums[0] + sums[1] - before;
      ++c;
    });
    Utilities::MPI::sum(sums, space.communicator, sums);
    return std::sqrt(sums[0]) + std::sqrt(sums[1]);
  }



  template <int dim>
  void
  enter_stage(const StressSpace<dim>  &stress_space,
              const std::vector<bool> &was_present,
              State<dim>              &state)
  {
    const unsigned int                 n     = stress_space.n_samples;
    const Scene<dim>                  &scene = stress_space.space.scene;
    std::vector<SymmetricTensor<2, 3>> strain(n);
    for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
      {
        const bool is_present =
          scene.is_present(stress_space.space.cells[c]->material_id());
        if (is_present == was_present[c])
          continue;
        for_each_sample_field(state, [&](auto &field) {
          if (!field.empty())
            for (unsigned int s = 0; s < n; ++s)
              field[c * n + s].clear();
        });
        if (!is_present)
          continue;
        stress_space.strains(c, state.u.begin(), strain.data());
        for (unsigned int s = 0; s < n; ++s)
          state.z[c * n + s] = -1. * stress_space.moduli(c).stress(strain[s]);
      }
  }



  VISCOPLASTIC_INSTANTIATE(work_of_initial_stress);
  VISCOPLASTIC_INSTANTIATE(initial_stress);
  VISCOPLASTIC_INSTANTIATE(make_initial_state);
  VISCOPLASTIC_INSTANTIATE(reported_displacement);
  VISCOPLASTIC_INSTANTIATE(initial_irreversible_stress);
  VISCOPLASTIC_INSTANTIATE(initial_data_error);
  VISCOPLASTIC_INSTANTIATE(enter_stage);
} // namespace Viscoplastic
