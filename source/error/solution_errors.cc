// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>

#include <viscoplastic_contact/error/solution_errors.h>

namespace Viscoplastic
{
  namespace
  {
    struct Squares : public SolutionNorms
    {
      double memory = 0.;
    };



    template <int dim>
    void
    add_cells(const StressSpace<dim> &stress_space,
              const State<dim>       &state,
              Squares                &error,
              Squares                &exact,
              Vector<double>         &energy_by_cell)
    {
      const FEValuesExtractors::Vector displacement(0);
      const auto               &dof_handler = stress_space.space.dof_handler;
      const ExactSolution<dim> &solution =
        *stress_space.space.scene.exact_solution;
      const AdmissibleSpace<dim>        &space = stress_space.space;
      FEValues<dim>                      fe_values(space.mapping,
                              dof_handler.get_fe(),
                              QGauss<dim>(3),
                              update_values | update_gradients |
                                update_JxW_values | update_quadrature_points);
      const unsigned int                 n = fe_values.n_quadrature_points;
      std::vector<Tensor<1, dim>>        values(n);
      std::vector<Tensor<2, dim>>        gradients(n);
      std::vector<SymmetricTensor<2, 3>> strains(n);
      const auto stress = stress_space.mean_stress(state.u, state.z);
      const bool has_mean_memory =
        stress_space.n_samples == 1 && !state.z.empty();

      std::size_t index = 0;
      for (const auto &cell : stress_space.space.cells)
        {
          fe_values.reinit(cell);
          fe_values[displacement].get_function_values(state.u, values);
          fe_values[displacement].get_function_gradients(state.u, gradients);
          for (unsigned int q = 0; q < n; ++q)
            strains[q] = strain(values[q],
                                gradients[q],
                                fe_values.quadrature_point(q),
                                space.scene.plane_model(),
                                space.axial_strain(state.u.begin()));
          if (stress_space.mean_dilatation)
            {
              const double mean =
                mean_dilatation(fe_values.get_JxW_values(), strains);
              for (SymmetricTensor<2, 3> &strain : strains)
                strain = with_dilatation(strain, mean);
            }
          const Stiffness &stiffness   = stress_space.moduli(index);
          const double     other_cells = error.energy;
          for (unsigned int q = 0; q < n; ++q)
            {
              const Point<dim>    &x = fe_values.quadrature_point(q);
              const double         w = fe_values.JxW(q);
              const Tensor<1, dim> u = solution.displacement(x, state.t);
              const Tensor<2, dim> g = solution.gradient(x, state.t);
              // solution.strain() would evaluate u five or seven times more
              const auto e      = strain(u,
                                    g,
                                    x,
                                    space.scene.plane_model(),
                                    solution.axial_strain(state.t)),
                         defect = e - strains[q];
              error.energy += w * (stiffness.stress(defect) * defect);
              exact.energy += w * (stiffness.stress(e) * e);
              error.h1 += w * ((u - values[q]).norm_square() +
                               (g - gradients[q]).norm_square());
              exact.h1 += w * (u.norm_square() + g.norm_square());
              if (solution.has_stress())
                {
                  const auto sigma      = solution.stress(x, state.t);
                  const auto difference = sigma - stress[index];
                  error.stress += w * (difference * difference);
                  exact.stress += w * (sigma * sigma);
                  if (has_mean_memory)
                    {
                      const auto lack =
                        sigma - stiffness.stress(e) - state.z[index];
                      error.memory += w * (stiffness.strain(lack) * lack);
                    }
                }
            }
          energy_by_cell[cell->active_cell_index()] =
            error.energy - other_cells;
          ++index;
        }
    }



    template <int dim>
    void
    add_contact_faces(const AdmissibleSpace<dim> &space,
                      const double                t,
                      const DistributedVector    &density,
                      Squares                    &error,
                      Squares                    &exact)
    {
      const FEValuesExtractors::Vector displacement(0);
      FEFaceValues<dim>                face_values(space.mapping,
                                    space.dof_handler.get_fe(),
                                    QGauss<dim - 1>(3),
                                    update_values | update_JxW_values |
                                      update_quadrature_points);
      std::vector<Tensor<1, dim>> multiplier(face_values.n_quadrature_points);
      for (const auto &cell : space.cells)
        for (const unsigned int f : cell->face_indices())
          {
            if (!cell->face(f)->at_boundary())
              continue;
            const BoundaryCondition<dim> &condition =
              space.scene.boundary.at(cell->face(f)->boundary_id());
            if (!condition.has_friction())
              continue;
            face_values.reinit(cell, f);
            face_values[displacement].get_function_values(density, multiplier);
            const Tensor<1, dim> &normal = condition.normal;
            for (const unsigned int q : face_values.quadrature_point_indices())
              {
                Tensor<1, dim> lambda =
                  -1. * space.scene.exact_solution->traction(
                          face_values.quadrature_point(q), normal, t);
                lambda -= (lambda * normal) * normal;
                error.multiplier +=
                  (lambda - multiplier[q]).norm_square() * face_values.JxW(q);
                exact.multiplier += lambda.norm_square() * face_values.JxW(q);
              }
          }
    }



    template <int dim>
    double
    squared_error_at_samples(const StressSpace<dim> &stress_space,
                             const State<dim>       &state)
    {
      const ExactSolution<dim> &solution =
        *stress_space.space.scene.exact_solution;
      double sum = 0.;
      for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
        for (unsigned int s = 0; s < stress_space.n_samples; ++s)
          {
            const Point<dim> &x         = stress_space.position(c, s);
            const Stiffness  &stiffness = stress_space.moduli(c);
            const auto        defect    = solution.stress(x, state.t) -
                                stiffness.stress(solution.strain(x, state.t)) -
                                state.z[c * stress_space.n_samples + s];
            sum +=
              stress_space.weight(c, s) * (stiffness.strain(defect) * defect);
          }
      return sum;
    }
  } // namespace



  SolutionNorms
  square_roots(const SolutionNorms &squares, const MPI_Comm communicator)
  {
    std::vector<double> sums{squares.energy,
                             squares.h1,
                             squares.stress,
                             squares.multiplier};
    Utilities::MPI::sum(sums, communicator, sums);
    return {std::sqrt(sums[0]),
            std::sqrt(sums[1]),
            std::sqrt(sums[2]),
            std::sqrt(sums[3])};
  }



  template <int dim>
  SolutionErrors
  solution_errors(const StressSpace<dim>  &stress_space,
                  const State<dim>        &state,
                  const DistributedVector *multiplier_density)
  {
    const Scene<dim> &scene = stress_space.space.scene;
    const MPI_Comm    comm  = stress_space.space.communicator;
    Squares           error, exact;
    SolutionErrors    result;
    result.squared_energy_by_cell.reinit(
      stress_space.space.dof_handler.get_triangulation().n_active_cells());
    add_cells(stress_space, state, error, exact, result.squared_energy_by_cell);
    if (multiplier_density && scene.exact_solution->has_stress())
      add_contact_faces(
        stress_space.space, state.t, *multiplier_density, error, exact);
    result.error = square_roots(error, comm);
    result.exact = square_roots(exact, comm);
    if (stress_space.n_samples > 1 && scene.has_irreversible_stress() &&
        scene.exact_solution->has_stress())
      error.memory = squared_error_at_samples(stress_space, state);
    result.memory = std::sqrt(Utilities::MPI::sum(error.memory, comm));
    return result;
  }



  VISCOPLASTIC_INSTANTIATE(solution_errors);
} // namespace Viscoplastic
