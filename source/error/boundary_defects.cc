// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

#include <viscoplastic_contact/error/boundary_defects.h>

#include <algorithm>

namespace Viscoplastic
{
  template <int dim>
  Vector<double>
  missing_sides(const Discretization<dim> &discretization,
                const State<dim>          &state,
                const DistributedVector   &ghosted_w)
  {
    const AdmissibleSpace<dim> &space        = discretization.space;
    const StressSpace<dim>     &stress_space = discretization.stress_space;
    const Scene<dim>           &scene        = space.scene;
    // Of the displacement in the plane, which is what a pressure works on.
    const unsigned int n_directions =
      scene.plane_model() == PlaneModel::axisymmetric ? 3 : dim;
    FEFaceValues<dim>                  face_values(space.mapping,
                                  space.dof_handler.get_fe(),
                                  QGauss<dim - 1>(2),
                                  update_JxW_values | update_normal_vectors |
                                    update_quadrature_points);
    std::vector<SymmetricTensor<2, 3>> strains(stress_space.n_samples),
      of_w(stress_space.n_samples);
    Vector<double> result(
      space.dof_handler.get_triangulation().n_active_cells());
    for (std::size_t c = 0; c < space.cells.size(); ++c)
      {
        const auto &cell = space.cells[c];
        if (!cell->at_boundary() || !scene.is_present(cell->material_id()))
          continue;
        bool is_strained = false;
        for (const unsigned int f : cell->face_indices())
          {
            const auto face = cell->face(f);
            if (!face->at_boundary())
              continue;
            const Tensor<1, dim> delta =
              face->center(/* respect_manifold = */ true) - face->center();
            if (delta.norm() < 1e-10 * face->diameter())
              continue;
            face_values.reinit(cell, f);
            double volume = 0.;
            for (const unsigned int q : face_values.quadrature_point_indices())
              volume += 2. / 3. * face_values.JxW(q) *
                        (delta * face_values.normal_vector(q));
            if (!is_strained)
              {
                stress_space.strains(c, state.u.begin(), strains.data());
                stress_space.strains(c, ghosted_w.begin(), of_w.data());
                is_strained = true;
              }
            const auto  &condition = scene.boundary.at(face->boundary_id());
            const double pressure =
              condition.role == BoundaryRole::traction && condition.pressure ?
                condition.pressure->value(face->center(), state.t) :
                0.;
            for (unsigned int s = 0; s < stress_space.n_samples; ++s)
              {
                double divergence = 0.;
                for (unsigned int d = 0; d < n_directions; ++d)
                  divergence += of_w[s][d][d];
                const SymmetricTensor<2, 3> stress =
                  stress_space.moduli(c).stress(strains[s]) +
                  (state.z.empty() ? SymmetricTensor<2, 3>() :
                                     state.z[c * stress_space.n_samples + s]);
                result[cell->active_cell_index()] -=
                  volume / stress_space.n_samples *
                  (stress * of_w[s] + pressure * divergence);
              }
          }
      }
    return result;
  }



  template <int dim>
  Vector<double>
  held_friction(const Discretization<dim> &discretization,
                const State<dim>          &state,
                const QuantityOfInterest  &quantity,
                const DistributedVector   &ghosted_w)
  {
    using Kind                        = QuantityOfInterest::Kind;
    const AdmissibleSpace<dim> &space = discretization.space;
    const Scene<dim>           &scene = space.scene;
    Vector<double>              result(
      space.dof_handler.get_triangulation().n_active_cells());
    if (!discretization.face)
      return result;
    const DistributedVector density =
      discretization.face->density(state.contact);
    FEFaceValues<dim> face_values(space.mapping,
                                  space.dof_handler.get_fe(),
                                  QGauss<dim - 1>(2),
                                  update_values | update_JxW_values |
                                    update_quadrature_points);
    for (const auto &cell : space.cells)
      for (const unsigned int f : cell->face_indices())
        {
          const auto face = cell->face(f);
          if (!face->at_boundary())
            continue;
          const auto &condition = scene.boundary.at(face->boundary_id());
          if (!condition.has_friction() || condition.against)
            continue;
          for (const unsigned int v : cell->vertex_indices())
            {
              const auto dof = cell->vertex_dof_index(v, 0);
              if (space.cartesian_hanging_nodes().is_constrained(dof))
                continue;
              const auto &planes = space.frame_at(dof).planes;
              if (std::any_of(planes.begin(),
                              planes.end(),
                              [&](const FrictionPlane<dim> &plane) {
                                const auto &ids = plane.boundary_ids;
                                return std::find(ids.begin(),
                                                 ids.end(),
                                                 condition.id) != ids.end();
                              }))
                continue;
              face_values.reinit(cell, f);
              double area = 0.;
              for (const unsigned int q :
                   face_values.quadrature_point_indices())
                area +=
                  face_values.shape_value(v * dim, q) * face_values.JxW(q);
              if (area < 1e-12 * face->measure())
                continue; // not a vertex of the face
              Tensor<1, dim>    slip, w, force;
              const std::size_t first = space.relevant.index_within_set(dof);
              for (unsigned int d = 0; d < dim; ++d)
                {
                  slip[d]  = state.u.begin()[first + d];
                  w[d]     = ghosted_w.begin()[first + d];
                  force[d] = density.begin()[first + d];
                }
              const auto tangential = [&](const Tensor<1, dim> &a) {
                return a - (a * condition.normal) * condition.normal;
              };
              const Tensor<1, dim> sliding =
                condition.sliding(cell->vertex(v), state.t);
              slip              = tangential(slip);
              const double size = slip.norm() + sliding.norm();
              slip -= sliding;
              if (!(slip.norm() > 1e-9 * size))
                continue;
              const double missing = condition.bound(cell->vertex(v), state.t) *
                                     area *
                                     (condition.has_computed_pressure() ?
                                        std::abs(force * condition.normal) :
                                        1.);
              result[cell->active_cell_index()] +=
                missing * (quantity.is_sum() ?
                             slip.norm() :
                           quantity.kind == Kind::friction_force ?
                             std::abs(slip[quantity.component]) / slip.norm() :
                             tangential(w).norm());
            }
        }
    return result;
  }



  template Vector<double>
  missing_sides<2>(const Discretization<2> &,
                   const State<2> &,
                   const DistributedVector &);
  template Vector<double>
  missing_sides<3>(const Discretization<3> &,
                   const State<3> &,
                   const DistributedVector &);
  template Vector<double>
  held_friction<2>(const Discretization<2> &,
                   const State<2> &,
                   const QuantityOfInterest &,
                   const DistributedVector &);
  template Vector<double>
  held_friction<3>(const Discretization<3> &,
                   const State<3> &,
                   const QuantityOfInterest &,
                   const DistributedVector &);
} // namespace Viscoplastic
