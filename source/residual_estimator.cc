// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/qprojector.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/distributed/tria_base.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <viscoplastic_contact/residual_estimator.h>

#include <cmath>
#include <limits>

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    Tensor<1, dim>
    tangential(const Tensor<1, dim> &v, const Tensor<1, dim> &normal)
    {
      return v - (v * normal) * normal;
    }



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



    /// Gradients, normals, places and weights at the points of a (sub)face.
    template <int dim, typename FaceShape>
    void
    copy_face(const Point<dim>            &origin,
              const FEFaceValuesBase<dim> &values,
              FaceShape                   &face)
    {
      for (const unsigned int q : values.quadrature_point_indices())
        {
          for (unsigned int v = 0; v < face.gradients[q].size(); ++v)
            face.gradients[q][v] = values.shape_grad(v * dim, q);
          face.normals[q]   = values.normal_vector(q);
          face.positions[q] = values.quadrature_point(q) - origin;
          face.weights[q]   = values.JxW(q);
        }
    }



    constexpr UpdateFlags on_faces = update_gradients | update_normal_vectors |
                                     update_quadrature_points |
                                     update_JxW_values;



    /// The strain of a displacement gradient, with its trace moved to
    /// @p dilatation under mean dilatation.
    template <int dim>
    SymmetricTensor<2, 3>
    strain(const Tensor<2, dim> &gradient,
           const bool            mean_dilatation,
           const double          dilatation)
    {
      SymmetricTensor<2, 3> result;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = i; j < dim; ++j)
          result[i][j] = 0.5 * (gradient[i][j] + gradient[j][i]);
      if (mean_dilatation)
        {
          const double change = (dilatation - trace(result)) / 3.;
          for (unsigned int d = 0; d < 3; ++d)
            result[d][d] += change;
        }
      return result;
    }



    template <int dim>
    bool
    depends_on_position(const VectorExpression<dim> &expression)
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (expression[d].depends_on_position())
          return true;
      return false;
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
  ResidualEstimator<dim>::ResidualEstimator(const StressSampling<dim> &sampling)
    : sampling(sampling)
    , uniform_body_force(false)
  {
    make_cells();
    make_faces();
    shape_of_key.clear();
    subface_shape_of.clear();

    const auto &b = sampling.space.scene.body_force;
    if (!b)
      return;
    uniform_body_force = !depends_on_position(*b);
    if (!b->depends_on_time() && !uniform_body_force)
      for (std::size_t c = 0; c < sampling.n_cells(); ++c)
        for (const auto &x : shapes[cells[c].shape].positions)
          body_force.push_back(b->vector(origins[c] + x, 0.));
  }



  template <int dim>
  unsigned int
  ResidualEstimator<dim>::find_shape(const Cell &cell)
  {
    // Vertices from the first, relative to the diameter and rounded: equal for
    // translated cells, whatever rounding did to their vertices.
    constexpr double resolution = 1ll << 36;
    ShapeKey         key;
    int              exponent;
    const double     diameter = cell->diameter();
    key[0] = std::llround(std::frexp(diameter, &exponent) * resolution);
    key[1] = exponent;
    for (unsigned int v = 1, i = 2; v < n_vertices; ++v)
      for (unsigned int d = 0; d < dim; ++d, ++i)
        key[i] = std::llround((cell->vertex(v)[d] - cell->vertex(0)[d]) /
                              diameter * resolution);
    const auto [entry, is_new] = shape_of_key.emplace(key, shapes.size());
    if (!is_new)
      return entry->second;

    const FiniteElement<dim> &fe = sampling.space.dof_handler.get_fe();
    FEValues<dim>             values(fe,
                         QGauss<dim>(2),
                         update_gradients | update_hessians |
                           update_quadrature_points | update_JxW_values);
    values.reinit(cell);
    shapes.emplace_back();
    Shape &shape   = shapes.back();
    shape.diameter = diameter;
    double volume  = 0.;
    for (const unsigned int q : values.quadrature_point_indices())
      {
        shape.weights[q]   = values.JxW(q);
        shape.positions[q] = values.quadrature_point(q) - cell->vertex(0);
        volume += values.JxW(q);
        for (unsigned int v = 0; v < n_vertices; ++v)
          {
            shape.mean_gradients[v] +=
              values.shape_grad(v * dim, q) * values.JxW(q);
            shape.hessians[q][v] = symmetrize(values.shape_hessian(v * dim, q));
          }
      }
    for (auto &gradient : shape.mean_gradients)
      gradient /= volume;
    FEFaceValues<dim> on_face(fe, QGauss<dim - 1>(2), on_faces);
    for (unsigned int f = 0; f < n_faces; ++f)
      {
        on_face.reinit(cell, f);
        copy_face(cell->vertex(0), on_face, shape.faces[f]);
      }
    return entry->second;
  }



  template <int dim>
  void
  ResidualEstimator<dim>::make_cells()
  {
    const AdmissibleSpace<dim> &space = sampling.space;
    for (const bool owned : {true, false})
      for (const auto &cell : space.dof_handler.active_cell_iterators())
        if (cell->is_locally_owned() == owned && !cell->is_artificial())
          {
            LocalCell here{find_shape(cell),
                           cell->active_cell_index(),
                           {},
                           owned ? sampling.moduli(cells.size()) :
                                   space.scene.material(cell->material_id())
                                     .stiffness(cell->center())};
            for (unsigned int v = 0; v < n_vertices; ++v)
              here.nodes[v] =
                space.relevant.index_within_set(cell->vertex_dof_index(v, 0));
            cells.push_back(std::move(here));
            if (owned)
              origins.push_back(cell->vertex(0));
            else
              ghosts.push_back(cell->global_active_cell_index());
          }
  }



  template <int dim>
  void
  ResidualEstimator<dim>::make_faces()
  {
    const AdmissibleSpace<dim> &space = sampling.space;
    const FiniteElement<dim>   &fe    = space.dof_handler.get_fe();
    std::vector<unsigned int>   number(
      space.dof_handler.get_triangulation().n_active_cells());
    for (unsigned int c = 0; c < cells.size(); ++c)
      number[cells[c].active_index] = c;
    const auto number_of = [&number](const Cell &cell) {
      return number[cell->active_cell_index()];
    };
    const auto traction_of = [](const unsigned int cell,
                                const unsigned int face) {
      return (cell * n_faces + face) * n_face_points;
    };
    FESubfaceValues<dim> on_subface(fe, QGauss<dim - 1>(2), on_faces);

    // @p side: the shape of the second cell's (sub)face.
    const auto add_face = [&](const Cell        &fine,
                              const unsigned int f,
                              const Cell        &other,
                              const FaceShape   &side,
                              const unsigned int other_traction) {
      const unsigned int c = number_of(fine);
      InteriorFace       face{{{c, number_of(other)}},
                        f,
                        {{traction_of(c, f), other_traction}},
                        {},
                        fine->face(f)->diameter()};
      const FaceShape   &here  = shapes[cells[c].shape].faces[f];
      const auto         shift = other->vertex(0) - fine->vertex(0);
      for (unsigned int q = 0; q < n_face_points; ++q)
        {
          double nearest = std::numeric_limits<double>::max();
          for (unsigned int p = 0; p < n_face_points; ++p)
            {
              const double distance =
                (side.positions[p] + shift - here.positions[q]).norm();
              if (distance < nearest)
                {
                  nearest         = distance;
                  face.partner[q] = p;
                }
            }
        }
      interior_faces.push_back(face);
    };

    const auto add_subface = [&](const Cell        &fine,
                                 const unsigned int fine_f,
                                 const Cell        &coarse,
                                 const unsigned int f,
                                 const unsigned int subface) {
      const unsigned int c = number_of(coarse);
      const auto [entry, is_new] =
        subface_shape_of.emplace(std::make_tuple(cells[c].shape, f, subface),
                                 subface_shapes.size());
      if (is_new)
        {
          on_subface.reinit(coarse, f, subface);
          subface_shapes.emplace_back();
          copy_face(coarse->vertex(0), on_subface, subface_shapes.back());
        }
      add_face(fine,
               fine_f,
               coarse,
               subface_shapes[entry->second],
               traction_of(cells.size(), 0) +
                 subface_sides.size() * n_face_points);
      subface_sides.push_back({c, entry->second});
    };

    // Faces between owned cells are visited once: from the finer side, or from
    // the cell that comes first.
    for (const auto &cell : space.dof_handler.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int f : cell->face_indices())
          if (cell->at_boundary(f))
            {
              const auto &condition =
                space.scene.boundary.at(cell->face(f)->boundary_id());
              if (condition.prescribes_all())
                continue;
              BoundaryFace     face{number_of(cell),
                                f,
                                &condition,
                                cell->face(f)->diameter(),
                                {},
                                {},
                                {}};
              const FaceShape &shape = shapes[cells[face.cell].shape].faces[f];
              for (unsigned int q = 0; q < n_face_points; ++q)
                {
                  const Point<dim> x = cell->vertex(0) + shape.positions[q];
                  face.positions[q]  = x;
                  if (condition.carries_load() &&
                      !condition.load_depends_on_time())
                    face.data[q] = condition.load(x, shape.normals[q], 0.);
                  if (condition.has_friction() &&
                      !condition.bound_depends_on_time())
                    face.bounds[q] = condition.bound(x, 0.);
                }
              boundary_faces.push_back(face);
            }
          else if (cell->face(f)->has_children())
            {
              for (unsigned int s = 0; s < cell->face(f)->n_children(); ++s)
                {
                  const Cell child = cell->neighbor_child_on_subface(f, s);
                  if (!child->is_locally_owned())
                    add_subface(
                      child, cell->neighbor_of_neighbor(f), cell, f, s);
                }
            }
          else if (cell->neighbor_is_coarser(f))
            {
              const auto [neighbor_f, subface] =
                cell->neighbor_of_coarser_neighbor(f);
              add_subface(cell, f, cell->neighbor(f), neighbor_f, subface);
            }
          else
            {
              const Cell neighbor = cell->neighbor(f);
              if (!neighbor->is_locally_owned() ||
                  cell->index() < neighbor->index())
                {
                  const unsigned int n          = number_of(neighbor),
                                     neighbor_f = cell->neighbor_of_neighbor(f);
                  add_face(cell,
                           f,
                           neighbor,
                           shapes[cells[n].shape].faces[neighbor_f],
                           traction_of(n, neighbor_f));
                }
            }

    const QGauss<dim - 1> points(2);
    for (unsigned int f = 0; f < n_faces; ++f)
      {
        const Quadrature<dim> on_face =
          QProjector<dim>::project_to_face(fe.reference_cell(), points, f);
        for (unsigned int q = 0; q < n_face_points; ++q)
          for (unsigned int v = 0; v < n_vertices; ++v)
            face_values[f][q][v] = fe.shape_value(v * dim, on_face.point(q));
      }
  }



  template <int dim>
  std::vector<SymmetricTensor<2, 3>>
  ResidualEstimator<dim>::mean_irreversible_stress(
    const IrreversibleStress &z) const
  {
    const AdmissibleSpace<dim>        &space = sampling.space;
    std::vector<SymmetricTensor<2, 3>> means;
    // A rank without cells has an empty z in every scene.
    if (Utilities::MPI::max(z.empty() ? 0 : 1, space.communicator) == 0)
      return means;
    means.resize(cells.size());
    const std::size_t n_owned = sampling.n_cells();
    for (std::size_t c = 0; c < n_owned; ++c)
      means[c] = sampling.mean(c, &z[c * sampling.n_samples]);
    if (Utilities::MPI::n_mpi_processes(space.communicator) == 1)
      return means;

    const auto &triangulation =
      dynamic_cast<const parallel::TriangulationBase<dim> &>(
        space.dof_handler.get_triangulation());
    const auto partitioner =
      triangulation.global_active_cell_index_partitioner().lock();
    LinearAlgebra::distributed::Vector<double> component(partitioner);
    for (unsigned int i = 0; i < 6; ++i)
      {
        for (std::size_t c = 0; c < n_owned; ++c)
          component.local_element(c) = means[c].access_raw_entry(i);
        component.update_ghost_values();
        for (std::size_t g = 0; g < ghosts.size(); ++g)
          means[n_owned + g].access_raw_entry(i) = component(ghosts[g]);
        component.zero_out_ghost_values();
      }
    return means;
  }



  template <int dim>
  typename ResidualEstimator<dim>::StressTerms
  ResidualEstimator<dim>::stress_terms(
    const std::size_t                         cell,
    const double                             *u,
    const std::vector<SymmetricTensor<2, 3>> &mean_z) const
  {
    StressTerms terms;
    for (unsigned int v = 0; v < n_vertices; ++v)
      for (unsigned int d = 0; d < dim; ++d)
        terms.u[v][d] = u[cells[cell].nodes[v] + d];
    terms.stiffness  = &cells[cell].stiffness;
    terms.dilatation = 0.;
    if (sampling.mean_dilatation)
      for (unsigned int v = 0; v < n_vertices; ++v)
        terms.dilatation +=
          terms.u[v] * shapes[cells[cell].shape].mean_gradients[v];
    if (!mean_z.empty())
      terms.z = mean_z[cell];
    return terms;
  }



  template <int dim>
  void
  ResidualEstimator<dim>::add_tractions(const FaceShape   &face,
                                        const StressTerms &terms,
                                        Tensor<1, dim>    *tractions) const
  {
    const Stiffness &stiffness       = *terms.stiffness;
    const bool       mean_dilatation = sampling.mean_dilatation;
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
        tractions[q] = in_plane(terms.z, normal);
        if (stiffness.is_isotropic())
          {
            const double divergence = trace(gradient);
            const double pressure =
              mean_dilatation ?
                bulk * terms.dilatation - 2. / 3. * mu * divergence :
                (bulk - 2. / 3. * mu) * divergence;
            for (unsigned int i = 0; i < dim; ++i)
              {
                double shear = 0.;
                for (unsigned int j = 0; j < dim; ++j)
                  shear += (gradient[i][j] + gradient[j][i]) * normal[j];
                tractions[q][i] += mu * shear + pressure * normal[i];
              }
          }
        else
          tractions[q] +=
            in_plane(stiffness.stress(
                       strain(gradient, mean_dilatation, terms.dilatation)),
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
    const bool       mean_dilatation = sampling.mean_dilatation;
    const double     mu              = stiffness.shear_modulus(),
                 lambda = (mean_dilatation ? 0. : stiffness.bulk_modulus()) -
                          2. / 3. * mu;
    double square = 0.;
    for (unsigned int q = 0; q < n_points; ++q)
      {
        std::array<SymmetricTensor<2, dim>, dim> hessian; // of u_i
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
                stiffness.stress(strain(gradient, mean_dilatation, 0.));
              for (unsigned int i = 0; i < dim; ++i)
                residual[i] += stress[i][j];
            }
        square += residual.norm_square() * shape.weights[q];
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
    const AdmissibleSpace<dim> &space   = sampling.space;
    const std::size_t           n_owned = sampling.n_cells();
    const double               *u       = ghosted_u.begin();
    const auto                  mean_z  = mean_irreversible_stress(z);
    std::vector<double>         eta(cells.size()); // squared

    // Tractions on all faces, and what is amiss within the cells.
    std::vector<Tensor<1, dim>> tractions(
      (cells.size() * n_faces + subface_sides.size()) * n_face_points);
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
