// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

#include <viscoplastic_contact/base/largest_place.h>
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/contact/contact_solver.h>
#include <viscoplastic_contact/discretization/bulk_system.h>
#include <viscoplastic_contact/discretization/initial_state.h>

#include <cmath>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    SymmetricTensor<2, 3>
    initial_stress(const Scene<dim> &scene, const Point<dim> &x)
    {
      SymmetricTensor<2, 3> result;
      const auto            components = stress_components<dim>();
      for (unsigned int c = 0; c < components.size(); ++c)
        result[components[c].first][components[c].second] =
          scene.initial_stress->value(x, 0., c);
      return result;
    }



    /// Call visit(cell, fe_values) for each owned cell.
    template <int dim, typename Visitor>
    void
    for_each_cell(const AdmissibleSpace<dim> &space,
                  const unsigned int          n_points,
                  const Visitor              &visit)
    {
      FEValues<dim> fe_values(space.dof_handler.get_fe(),
                              QGauss<dim>(n_points),
                              update_gradients | update_JxW_values |
                                update_quadrature_points);
      for (const auto &cell : space.cells)
        {
          fe_values.reinit(cell);
          visit(cell, fe_values);
        }
    }



    /// int tau(x) : eps(v) as a load vector in frames.
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
              stress(values.quadrature_point(q)) * values.JxW(q);
            for (const unsigned int v : cell->vertex_indices())
              {
                const auto node =
                  space.relevant.index_within_set(cell->vertex_dof_index(v, 0));
                const Tensor<1, dim> gradient = values.shape_grad(v * dim, q);
                for (unsigned int i = 0; i < dim; ++i)
                  for (unsigned int j = 0; j < dim; ++j)
                    cartesian[node + i] += tau[i][j] * gradient[j];
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
      SymmetricTensor<2, 3> strain;
      for (unsigned int i = 0; i < dim; ++i)
        {
          const Tensor<1, dim> gradient =
            (*scene.initial_displacement)[i].gradient(x, 0.);
          for (unsigned int j = 0; j < dim; ++j)
            strain[i][j] += (i == j ? 1. : 0.5) * gradient[j];
        }
      return strain;
    }



    /// u0 at the nodes, in frames: compared with what is prescribed there.
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
        for_each_cell(space, 2, [&](const auto &, const auto &values) {
          for (const unsigned int q : values.quadrature_point_indices())
            {
              const SymmetricTensor<2, 3> stress =
                initial_stress(space.scene, values.quadrature_point(q));
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
        std::ostringstream message;
        message << "The initial displacement contradicts the displacements "
                   "prescribed at t = 0 by "
                << contradiction
                << "; let them agree, or set 'Initial state/Equilibrate'.";
        AssertThrow(false, ExcMessage(message.str()));
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
        const DistributedVector load =
          virtual_work(space, 3, [&](const Point<dim> &x) {
            return initial_strain(scene, x);
          });
        const FaceRestriction no_face;
        make_bulk_solver(make_bulk_system(space, matrix, no_face), {})
          ->solve(load, prescribed, 1e-10);
        space.to_cartesian(prescribed, state.u);
        state.initial_u = state.u;
      }

    if (scene.has_irreversible_stress())
      state.z = initial_irreversible_stress(stress_space, state.u);
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
    std::vector<double>                sums(2, 0.);
    std::vector<SymmetricTensor<2, 3>> strain(stress_space.n_samples);
    std::size_t                        c = 0;
    for_each_cell(space, 3, [&](const auto &cell, const auto &values) {
      const Stiffness &stiffness = stress_space.moduli(c);
      stress_space.strains(c, state.u.begin(), strain.data());
      SymmetricTensor<2, 3> sigma =
        stiffness.stress(stress_space.mean(c, strain.data()));
      sigma += stress_space.mean(c, &state.z[c * stress_space.n_samples]);
      const double before = sums[0] + sums[1];
      for (const unsigned int q : values.quadrature_point_indices())
        {
          SymmetricTensor<2, 3> error;
          for (const unsigned int v : cell->vertex_indices())
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int j = 0; j < dim; ++j)
                error[i][j] -= (i == j ? 1. : 0.5) *
                               state.u.begin()[space.relevant.index_within_set(
                                                 cell->vertex_dof_index(v, 0)) +
                                               i] *
                               values.shape_grad(v * dim, q)[j];
          if (scene.initial_displacement)
            error += initial_strain(scene, values.quadrature_point(q));
          sums[0] += (stiffness.stress(error) * error) * values.JxW(q);
          error = -1. * sigma;
          if (scene.initial_stress)
            error += initial_stress(scene, values.quadrature_point(q));
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



  namespace
  {
    /// The node with the largest of some forces, and its boundaries. Forces of
    /// hanging nodes are zero.
    template <int dim>
    void
    locate_largest_force(const AdmissibleSpace<dim>  &space,
                         const DistributedVector     &forces,
                         CompatibilityViolation<dim> &result)
    {
      LargestPlace<dim> largest;
      for (const auto &cell : space.cells)
        for (const unsigned int v : cell->vertex_indices())
          if (const auto dof = cell->vertex_dof_index(v, 0);
              space.owned.is_element(dof))
            {
              Tensor<1, dim> force;
              for (unsigned int d = 0; d < dim; ++d)
                force[d] =
                  forces.begin()[space.owned.index_within_set(dof) + d];
              largest.add(stable_norm(force), cell->vertex(v));
            }
      largest.reduce(space.communicator);
      result.position = largest.position();

      // Which ranks see its faces, not only the one that owns it.
      std::set<types::boundary_id> here;
      for (const auto &cell : space.cells)
        for (const unsigned int f : cell->face_indices())
          if (cell->face(f)->at_boundary())
            for (const unsigned int v : cell->face(f)->vertex_indices())
              if (cell->face(f)->vertex(v) == result.position)
                here.insert(cell->face(f)->boundary_id());
      result.boundaries =
        Utilities::MPI::compute_set_union(here, space.communicator);
    }
  } // namespace



  template <int dim>
  CompatibilityViolation<dim>
  compatibility_violation(const AdmissibleSpace<dim> &space,
                          const Load<dim>            &load,
                          const ContactFace<dim>     *face,
                          FrictionState              &friction)
  {
    DistributedVector residual = load.values;
    space.restrict_to_unknowns(residual);
    double size = residual.l2_norm(), largest = 0.;
    if (space.scene.initial_stress)
      {
        // More points than elsewhere: what remains is quadrature error.
        DistributedVector internal =
          virtual_work(space, 4, [&](const Point<dim> &x) {
            return initial_stress(space.scene, x);
          });
        largest = internal.l2_norm();
        space.restrict_to_unknowns(internal);
        size = std::max(size, internal.l2_norm());
        residual -= internal;
      }

    if (face != nullptr)
      {
        // (2.12): sigma0 + the subdifferential of j at 0, which are forces
        // within the friction bounds, contains L(0).
        const Vector<double> on_face = face->restriction().gather(residual);
        Vector<double>       force(on_face.size());
        friction = FrictionState(face->bounds(0.));
        fit_multipliers(face->layout(), on_face, friction, force);
        face->restriction().add(-1., force, residual);
      }
    // Where reactions balance the initial stress, nothing but rounding is left
    // of it.
    CompatibilityViolation<dim> result;
    if (size > 1e-12 * largest)
      result.relative = residual.l2_norm() / size;
    if (result.relative > 0.)
      locate_largest_force(space, residual, result);
    return result;
  }



  template State<2>
  make_initial_state<2>(const StressSpace<2> &, const bool);
  template State<3>
  make_initial_state<3>(const StressSpace<3> &, const bool);
  template IrreversibleStress
  initial_irreversible_stress<2>(const StressSpace<2> &,
                                 const DistributedVector &);
  template IrreversibleStress
  initial_irreversible_stress<3>(const StressSpace<3> &,
                                 const DistributedVector &);
  template double
  initial_data_error<2>(const StressSpace<2> &,
                        const State<2> &,
                        Vector<double> *);
  template double
  initial_data_error<3>(const StressSpace<3> &,
                        const State<3> &,
                        Vector<double> *);
  template CompatibilityViolation<2>
  compatibility_violation<2>(const AdmissibleSpace<2> &,
                             const Load<2> &,
                             const ContactFace<2> *,
                             FrictionState &);
  template CompatibilityViolation<3>
  compatibility_violation<3>(const AdmissibleSpace<3> &,
                             const Load<3> &,
                             const ContactFace<3> *,
                             FrictionState &);
} // namespace Viscoplastic
