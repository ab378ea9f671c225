// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/distributed/tria_base.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <viscoplastic_contact/error/residual_estimator.h>
#include <viscoplastic_contact/laws/strain.h>

#include <cmath>

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    Tensor<1, dim>
    in_plane(const SymmetricTensor<2, 3> &stress, const Tensor<1, dim> &normal)
    {
      Tensor<1, dim> traction;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          traction[i] += stress[i][j] * normal[j];
      return traction;
    }



    /// What the data contradict in @p traction = sigma nu: zero in the
    /// directions in which u is prescribed.
    template <int dim>
    Tensor<1, dim>
    contradiction(const BoundaryCondition<dim> &condition,
                  const Tensor<1, dim>         &traction,
                  const Tensor<1, dim>         &given,
                  const Tensor<1, dim>         &multiplier_density)
    {
      Tensor<1, dim> residual;
      switch (condition.role)
        {
          case BoundaryRole::clamped:
            break;
          case BoundaryRole::displacement:
            residual = traction - given;
            for (unsigned int d = 0; d < dim; ++d)
              if (condition.displacement[d])
                residual[d] = 0.;
            break;
          case BoundaryRole::traction:
          case BoundaryRole::free:
            residual = traction - given;
            break;
          case BoundaryRole::symmetry:
            residual = tangential(traction, condition.normal);
            break;
          case BoundaryRole::contact:
            if (condition.is_glued())
              break;
            residual =
              tangential(traction + multiplier_density, condition.normal);
            if (condition.friction_law == FrictionLaw::coulomb)
              residual +=
                ((traction - given) * condition.normal) * condition.normal;
            break;
        }
      return residual;
    }
  } // namespace



  template <int dim>
  const SymmetricTensor<2, 3> *
  ResidualEstimator<dim>::mean_irreversible_stress(
    const IrreversibleStress &z,
    IrreversibleStress       &means) const
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    // A rank without cells has an empty z in every scene.
    if (Utilities::MPI::max(z.empty() ? 0 : 1, space.communicator) == 0)
      return nullptr;
    const bool is_alone =
      Utilities::MPI::n_mpi_processes(space.communicator) == 1;
    if (is_alone && stress_space.n_samples == 1)
      return z.data();
    means.resize(cells.size());
    const std::size_t n_owned = stress_space.n_cells();
    for (std::size_t c = 0; c < n_owned; ++c)
      means[c] = stress_space.mean(c, &z[c * stress_space.n_samples]);
    if (is_alone)
      return means.data();

    const auto &triangulation =
      dynamic_cast<const parallel::TriangulationBase<dim> &>(
        space.dof_handler.get_triangulation());
    const auto partitioner =
      triangulation.global_active_cell_index_partitioner().lock();
    LinearAlgebra::distributed::Vector<double> component(partitioner);
    for (unsigned int i = 0; i < 6; ++i)
      {
        for (std::size_t c = 0; c < n_owned; ++c)
          component(cells[c].global_active_index) =
            means[c].access_raw_entry(i);
        component.update_ghost_values();
        for (std::size_t c = n_owned; c < cells.size(); ++c)
          means[c].access_raw_entry(i) =
            component(cells[c].global_active_index);
        component.zero_out_ghost_values();
      }
    return means.data();
  }



  template <int dim>
  typename ResidualEstimator<dim>::StressTerms
  ResidualEstimator<dim>::stress_terms(
    const std::size_t            cell,
    const double                *u,
    const SymmetricTensor<2, 3> *mean_z) const
  {
    StressTerms terms;
    for (unsigned int v = 0; v < n_vertices; ++v)
      for (unsigned int d = 0; d < dim; ++d)
        terms.u[v][d] = u[cells[cell].nodes[v] + d];
    terms.stiffness  = &cells[cell].stiffness;
    terms.dilatation = 0.;
    if (stress_space.mean_dilatation)
      for (unsigned int v = 0; v < n_vertices; ++v)
        terms.dilatation +=
          terms.u[v] * shapes[cells[cell].shape].mean_gradients[v];
    if (mean_z != nullptr)
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          terms.z[i][j] = mean_z[cell][i][j];
    return terms;
  }



  template <int dim>
  void
  ResidualEstimator<dim>::add_tractions(const FaceShape   &face,
                                        const StressTerms &terms,
                                        Tensor<1, dim>    *tractions) const
  {
    const Stiffness &stiffness       = *terms.stiffness;
    const bool       mean_dilatation = stress_space.mean_dilatation;
    const double     mu              = stiffness.shear_modulus(),
                 bulk                = stiffness.bulk_modulus();
    for (unsigned int q = 0; q < n_face_points; ++q)
      {
        const Tensor<1, dim> &normal = face.normals[q];
        Tensor<2, dim>        gradient;
        for (unsigned int v = 0; v < n_vertices; ++v)
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int j = 0; j < dim; ++j)
              gradient[i][j] += terms.u[v][i] * face.gradients[q][v][j];
        if (stiffness.is_isotropic())
          {
            const double divergence = trace(gradient);
            const double pressure =
              mean_dilatation ?
                bulk * terms.dilatation - 2. / 3. * mu * divergence :
                (bulk - 2. / 3. * mu) * divergence;
            Tensor<2, dim> stress = terms.z;
            for (unsigned int i = 0; i < dim; ++i)
              {
                stress[i][i] += pressure;
                for (unsigned int j = 0; j < dim; ++j)
                  stress[i][j] += mu * (gradient[i][j] + gradient[j][i]);
              }
            tractions[q] = stress * normal;
          }
        else
          tractions[q] =
            terms.z * normal +
            in_plane(stiffness.stress(reduced_strain(gradient,
                                                     mean_dilatation,
                                                     terms.dilatation)),
                     normal);
      }
  }



  template <int dim>
  double
  ResidualEstimator<dim>::volume_residual(
    const Shape          &shape,
    const StressTerms    &terms,
    const Tensor<1, dim> *body_force) const
  {
    // From the second derivatives of u_h; z_h has none, and under mean
    // dilatation the volumetric part is constant on the cell.
    const Stiffness &stiffness       = *terms.stiffness;
    const bool       mean_dilatation = stress_space.mean_dilatation;
    const double     mu              = stiffness.shear_modulus(),
                 lambda = (mean_dilatation ? 0. : stiffness.bulk_modulus()) -
                          2. / 3. * mu;
    // Without a force that varies, one point speaks for all where the second
    // derivatives are constant.
    const bool one_point =
      shape.constant_hessians && (body_force == nullptr || uniform_body_force);
    double square = 0.;
    for (unsigned int q = 0; q < (one_point ? 1 : n_points); ++q)
      {
        std::array<Tensor<2, dim>, dim> hessian; // of u_i
        for (unsigned int v = 0; v < n_vertices; ++v)
          for (unsigned int i = 0; i < dim; ++i)
            hessian[i] += terms.u[v][i] * shape.hessians[q][v];
        Tensor<1, dim> residual;
        if (body_force != nullptr)
          residual = body_force[uniform_body_force ? 0 : q];
        if (stiffness.is_isotropic())
          for (unsigned int i = 0; i < dim; ++i)
            {
              double gradient = 0.; // of div u_h
              for (unsigned int k = 0; k < dim; ++k)
                gradient += hessian[k][k][i];
              residual[i] += mu * trace(hessian[i]) + (mu + lambda) * gradient;
            }
        else
          for (unsigned int j = 0; j < dim; ++j)
            {
              Tensor<2, dim> gradient; // of u_,j
              for (unsigned int i = 0; i < dim; ++i)
                for (unsigned int k = 0; k < dim; ++k)
                  gradient[i][k] = hessian[i][k][j];
              const SymmetricTensor<2, 3> stress =
                stiffness.stress(reduced_strain(gradient, mean_dilatation, 0.));
              for (unsigned int i = 0; i < dim; ++i)
                residual[i] += stress[i][j];
            }
        square += residual.norm_square() *
                  (one_point ? shape.volume : shape.weights[q]);
      }
    return square;
  }



  template <int dim>
  double
  ResidualEstimator<dim>::boundary_residual(
    const BoundaryFace      &face,
    const double             t,
    const Tensor<1, dim>    *tractions,
    const DistributedVector *multiplier_density) const
  {
    const BoundaryCondition<dim> &condition = *face.condition;
    const LocalCell              &cell      = cells[face.cell];
    const FaceShape              &shape = shapes[cell.shape].faces[face.face];
    const bool                    friction = condition.has_friction(),
               varies =
                 condition.carries_load() && condition.load_depends_on_time(),
               bounds_vary = friction && condition.bound_depends_on_time();
    Assert(!friction || multiplier_density != nullptr,
           ExcMessage("A scene with friction has multipliers."));
    double square = 0.;
    for (unsigned int q = 0; q < n_face_points; ++q)
      {
        Tensor<1, dim> density;
        if (friction)
          {
            for (unsigned int v = 0; v < n_vertices; ++v)
              for (unsigned int d = 0; d < dim; ++d)
                density[d] += face_values[face.face][q][v] *
                              multiplier_density->begin()[cell.nodes[v] + d];
            // Nodal multipliers respect nodal bounds; between nodes the
            // density exceeds a bound that jumps.
            const double excess =
              tangential(density, condition.normal).norm() -
              (bounds_vary ? condition.bound(face.positions[q], t) :
                             face.bounds[q]);
            if (excess > 0.)
              square += excess * excess * shape.weights[q];
          }
        const Tensor<1, dim> given =
          varies ? condition.load(face.positions[q], shape.normals[q], t) :
                   face.data[q];
        square +=
          contradiction(condition, tractions[q], given, density).norm_square() *
          shape.weights[q];
      }
    return face.diameter * square;
  }



  template <int dim>
  Vector<double>
  ResidualEstimator<dim>::estimate(
    const DistributedVector  &ghosted_u,
    const IrreversibleStress &z,
    const double              t,
    const DistributedVector  *multiplier_density) const
  {
    const AdmissibleSpace<dim>  &space   = stress_space.space;
    const std::size_t            n_owned = stress_space.n_cells();
    const double                *u       = ghosted_u.begin();
    IrreversibleStress           means;
    const SymmetricTensor<2, 3> *mean_z = mean_irreversible_stress(z, means);
    std::vector<double>          eta(cells.size()); // squared

    // Tractions on all faces, and what is amiss within the cells.
    std::vector<Tensor<1, dim>> &tractions = traction_buffer;
    tractions.resize((cells.size() * n_faces + subface_sides.size()) *
                     n_face_points);
    const auto                          &b = space.scene.body_force;
    std::array<Tensor<1, dim>, n_points> force;
    if (b && uniform_body_force)
      force[0] = b->vector(Point<dim>(), t);
    for (std::size_t c = 0; c < cells.size(); ++c)
      {
        const StressTerms terms = stress_terms(c, u, mean_z);
        const Shape      &shape = shapes[cells[c].shape];
        for (unsigned int f = 0; f < n_faces; ++f)
          add_tractions(shape.faces[f],
                        terms,
                        &tractions[(c * n_faces + f) * n_face_points]);
        if (c >= n_owned)
          continue;
        const bool is_kept = !body_force.empty();
        if (b && !uniform_body_force && !is_kept)
          for (unsigned int q = 0; q < n_points; ++q)
            force[q] = b->vector(origins[c] + shape.positions[q], t);
        eta[c] = Utilities::fixed_power<2>(shape.diameter) *
                 volume_residual(shape,
                                 terms,
                                 is_kept ? &body_force[c * n_points] :
                                 b       ? force.data() :
                                           nullptr);
      }
    for (std::size_t s = 0; s < subface_sides.size(); ++s)
      add_tractions(subface_shapes[subface_sides[s].table],
                    stress_terms(subface_sides[s].cell, u, mean_z),
                    &tractions[(cells.size() * n_faces + s) * n_face_points]);

    // Half of each jump goes to each side. Normals point out of both.
    for (const InteriorFace &face : interior_faces)
      {
        const FaceShape &shape =
          shapes[cells[face.cells[0]].shape].faces[face.face];
        double square = 0.;
        for (unsigned int q = 0; q < n_face_points; ++q)
          square += (tractions[face.tractions[0] + q] +
                     tractions[face.tractions[1] + face.partner[q]])
                      .norm_square() *
                    shape.weights[q];
        for (const unsigned int cell : face.cells)
          eta[cell] += 0.5 * face.diameter * square;
      }
    for (const BoundaryFace &face : boundary_faces)
      eta[face.cell] += boundary_residual(
        face,
        t,
        &tractions[(face.cell * n_faces + face.face) * n_face_points],
        multiplier_density);

    Vector<double> result(
      space.dof_handler.get_triangulation().n_active_cells());
    for (std::size_t c = 0; c < n_owned; ++c)
      result[cells[c].active_index] =
        eta[c] / cells[c].stiffness.smallest_deviatoric_eigenvalue();
    return result;
  }



  template class ResidualEstimator<2>;
  template class ResidualEstimator<3>;
} // namespace Viscoplastic
