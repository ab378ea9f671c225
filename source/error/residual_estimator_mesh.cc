// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/qprojector.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/grid/manifold.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/discretization/mortar_interpolation.h>
#include <viscoplastic_contact/discretization/plane_faces.h>
#include <viscoplastic_contact/discretization/thermal_strain.h>
#include <viscoplastic_contact/error/residual_estimator.h>

#include <algorithm>
#include <cmath>

// The mesh data of ResidualEstimator; residual_estimator.cc uses them.

namespace Viscoplastic
{
  template <int dim>
  ResidualEstimator<dim>::ResidualEstimator(const LocalCells<dim> &local_cells)
    : local(local_cells)
    , stress_space(local_cells.stress_space)
    , shapes(local_cells.shapes)
    , cells(local_cells.cells)
  {
    make_faces();
    interior_faces.shrink_to_fit();
    boundary_faces.shrink_to_fit();
    make_face_values();
    make_initial_stress();
    make_thermal_points();
    if (!stress_space.space.mortar_rows.empty())
      {
        find_other_bodies();
        compare_with_manifold();
      }
    subface_shape_of.clear();
  }



  namespace
  {
    /// Return the first of the @p places nearest to @p x.
    template <std::size_t n, typename Place>
    unsigned int
    nearest(const std::array<Place, n> &places, const Place &x)
    {
      unsigned int result = 0;
      for (unsigned int p = 1; p < n; ++p)
        if ((places[p] - x).norm() < (places[result] - x).norm())
          result = p;
      return result;
    }
  } // namespace



  template <int dim>
  unsigned int
  ResidualEstimator<dim>::add_subface_side(const Cell           &cell,
                                           const unsigned int    number,
                                           const unsigned int    f,
                                           const unsigned int    subface,
                                           FESubfaceValues<dim> &values)
  {
    const auto [entry, is_new] =
      subface_shape_of.emplace(std::make_tuple(cells[number].shape, f, subface),
                               subface_shapes.size());
    if (is_new)
      {
        values.reinit(cell, f, subface);
        subface_shapes.emplace_back();
        subface_shapes.back().reinit(cell->vertex(0), values, local.has_hoops);
      }
    subface_sides.push_back({number, entry->second});
    return entry->second;
  }



  template <int dim>
  void
  ResidualEstimator<dim>::make_faces()
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    FESubfaceValues<dim>        on_subface(space.mapping,
                                    space.dof_handler.get_fe(),
                                    QGauss<dim - 1>(2),
                                    update_values | update_gradients |
                                      update_normal_vectors |
                                      update_quadrature_points |
                                      update_JxW_values);
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
                        {}};
      const FaceShape   &here  = shapes[cells[c].shape].faces[f];
      const auto         shift = other->vertex(0) - fine->vertex(0);
      for (unsigned int q = 0; q < n_face_points; ++q)
        face.partner[q] = nearest(side.positions, here.positions[q] - shift);
      const Stiffness &a      = cells[face.cells[0]].stiffness,
                      &b      = cells[face.cells[1]].stiffness;
      face.is_within_material = a.is_isotropic() && b.is_isotropic() &&
                                a.shear_modulus() == b.shear_modulus() &&
                                a.bulk_modulus() == b.bulk_modulus();
      interior_faces.push_back(face);
    };

    const auto add_subface = [&](const Cell        &fine,
                                 const unsigned int fine_f,
                                 const Cell        &coarse,
                                 const unsigned int f,
                                 const unsigned int subface) {
      const unsigned int traction =
        traction_of(cells.size(), 0) + subface_sides.size() * n_face_points;
      const unsigned int shape =
        add_subface_side(coarse, number_of(coarse), f, subface, on_subface);
      add_face(fine, fine_f, coarse, subface_shapes[shape], traction);
    };

    // Faces between owned cells are visited once: from the finer side, or from
    // the cell that comes first.
    for (const auto &cell : space.cells)
      {
        for (const unsigned int f : cell->face_indices())
          if (cell->at_boundary(f))
            {
              const auto &condition =
                space.scene.boundary.at(cell->face(f)->boundary_id());
              if ((condition.prescribes_all() && !condition.against) ||
                  !cells[number_of(cell)].is_present ||
                  (local.has_hoops && is_on_axis(cell->face(f))))
                continue;
              add_boundary_face(cell, f, number_of(cell), condition);
            }
          else if (cell->face(f)->has_children())
            for (unsigned int s = 0; s < cell->face(f)->n_children(); ++s)
              {
                const Cell child = cell->neighbor_child_on_subface(f, s);
                if (!child->is_locally_owned())
                  add_subface(child, cell->neighbor_of_neighbor(f), cell, f, s);
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
                  number_of(cell) < number_of(neighbor))
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
      }
  }



  template <int dim>
  void
  ResidualEstimator<dim>::add_boundary_face(
    const Cell                   &cell,
    const unsigned int            f,
    const unsigned int            number,
    const BoundaryCondition<dim> &condition)
  {
    BoundaryFace face{};
    face.cell          = number;
    face.face          = f;
    face.condition     = &condition;
    face.diameter      = cell->face(f)->diameter();
    face.is_other_side = stress_space.space.scene.is_other_side(condition.id);
    const FaceShape &shape = shapes[cells[number].shape].faces[f];
    for (unsigned int q = 0; q < n_face_points; ++q)
      {
        const Point<dim> x = cell->vertex(0) + shape.positions[q];
        face.positions[q]  = x;
        if (condition.carries_load() && !condition.load_depends_on_time())
          face.data[q] = condition.load(x, shape.normals[q], 0.);
        if (condition.has_given_bound() && !condition.bound_depends_on_time())
          face.bounds[q] = condition.bound(x, 0.);
        if (condition.is_unilateral() && !condition.bound_depends_on_time())
          face.gaps[q] = condition.gap(x, 0.);
        if (condition.has_normal_compliance())
          face.compliances[q] = condition.compliance(x);
        if (condition.has_springs())
          {
            const Tensor<1, dim> &nu = shape.normals[q];
            const auto            K  = condition.spring_stiffness(x, nu);
            const double          h =
              face.diameter /
              cells[number].stiffness.smallest_deviatoric_eigenvalue();
            const double k_n    = nu * (K * nu),
                         k_t    = (trace(K) - k_n) / (dim - 1),
                         across = 1. / std::sqrt(1. + h * k_t),
                         along  = 1. / std::sqrt(1. + h * k_n);
            face.springs.push_back(
              {K,
               across * unit_symmetric_tensor<dim>() +
                 (along - across) * symmetrize(outer_product(nu, nu))});
          }
      }
    boundary_faces.push_back(face);
  }



  template <int dim>
  void
  ResidualEstimator<dim>::find_other_bodies()
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    const auto softness = [&](const Cell &cell, const unsigned int f) {
      return cell->face(f)->diameter() /
             space.scene.material(cell->material_id())
               .stiffness(cell->center())
               .smallest_deviatoric_eigenvalue();
    };
    for (const auto &of_boundary : space.mortar_rows)
      {
        const BoundaryCondition<dim> &condition =
          space.scene.boundary.at(of_boundary.first);
        std::vector<BoundaryFace *>      faces;
        std::vector<InterfacePlace<dim>> places;
        for (BoundaryFace &face : boundary_faces)
          if (face.condition == &condition)
            {
              faces.push_back(&face);
              for (const Point<dim> &x : face.positions)
                places.push_back({x, condition.normal, 0.});
              if (!condition.normal_varies)
                continue;
              const SurfaceFace<dim> surface =
                space.surface_normals->face(space.cells[face.cell], face.face);
              const QGauss<dim - 1> points(2);
              for (unsigned int q = 0; q < n_face_points; ++q)
                {
                  InterfacePlace<dim> &place =
                    places[places.size() - n_face_points + q];
                  place.position += surface.bulge(points.point(q));
                  place.normal = surface.normal(points.point(q));
                  place.reach  = SurfaceNormals<dim>::reach(surface);
                }
            }
        auto found = places_opposite<dim>(space.dof_handler,
                                          space.cartesian_hanging_nodes(),
                                          space.contact_pair(condition),
                                          places,
                                          softness);
        auto there = found.begin();
        auto place = places.begin();
        for (BoundaryFace *const face : faces)
          for (unsigned int q = 0; q < n_face_points; ++q)
            {
              const Tensor<1, dim>           &normal = (place++)->normal;
              typename BoundaryFace::Opposite opposite{
                {},
                normal,
                there->distance * normal,
                there->softness +
                  face->diameter /
                    cells[face->cell]
                      .stiffness.smallest_deviatoric_eigenvalue()};
              // Nodes beyond the edge of the other body have no mortar row, so
              // that this rank need not know the nodes opposite beside them.
              if (std::all_of(there->nodes.begin(),
                              there->nodes.end(),
                              [&space](const auto &other) {
                                return space.relevant.is_element(other.node *
                                                                 dim);
                              }))
                for (const auto &other : there->nodes)
                  opposite.nodes.emplace_back(space.relevant.index_within_set(
                                                other.node * dim),
                                              other.weight);
              face->opposite.push_back(std::move(opposite));
              ++there;
            }
      }
  }



  template <int dim>
  void
  ResidualEstimator<dim>::compare_with_manifold()
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    if (!space.surface_normals)
      return;
    const Point<dim - 1> middle = reference_center<dim - 1>();
    for (BoundaryFace &face : boundary_faces)
      {
        const auto &condition = *face.condition;
        if (!face.is_other_side &&
            !(condition.against && condition.normal_varies))
          continue;
        const auto &cell    = space.cells[face.cell];
        const auto  on_mesh = cell->face(face.face);
        // A mesh without a curved manifold is the geometry.
        if (dynamic_cast<const FlatManifold<dim> *>(&on_mesh->get_manifold()) !=
            nullptr)
          continue;
        const SurfaceFace<dim> surface =
          space.surface_normals->face(cell, face.face);
        // Hanging nodes are on the chord; the coarser face beside them counts.
        if (std::any_of(surface.lifts.begin(),
                        surface.lifts.end(),
                        [](const auto &lift) { return lift.norm() > 0.; }))
          continue;
        face.offset =
          std::abs((on_mesh->center(/* respect_manifold = */ true) -
                    surface.position(middle) - surface.bulge(middle)) *
                   surface.normal(middle));
        // A smaller offset is rounding of the coordinates.
        if (face.offset < 1e-12 * face.diameter)
          face.offset = 0.;
        largest_offset = std::max(largest_offset, face.offset);
      }
    largest_offset = Utilities::MPI::max(largest_offset, space.communicator);
  }



  template <int dim>
  void
  ResidualEstimator<dim>::make_face_values()
  {
    const FiniteElement<dim> &fe = stress_space.space.dof_handler.get_fe();
    const QGauss<dim - 1>     points(2);
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
  void
  ResidualEstimator<dim>::make_initial_stress()
  {
    // With an initial displacement, z differs from the initial stress.
    const Scene<dim> &scene = stress_space.space.scene;
    if (!scene.initial_stress || scene.initial_displacement)
      return;
    const auto at = [&](const std::size_t c, const Tensor<1, dim> &position) {
      return initial_stress(scene,
                            cells[c].origin + position,
                            cells[c].material_id);
    };
    std::vector<SymmetricTensor<2, 3>> means;
    for (std::size_t c = 0; c < cells.size(); ++c)
      {
        const Shape          &shape = shapes[cells[c].shape];
        SymmetricTensor<2, 3> mean;
        for (unsigned int q = 0; q < n_points; ++q)
          mean += at(c, shape.positions[q]) * (shape.weights[q] / shape.volume);
        means.push_back(mean);
      }
    for_each_face([&](const std::size_t c, const FaceShape &face) {
      for (unsigned int q = 0; q < n_face_points; ++q)
        {
          const SymmetricTensor<2, 3> rest =
            at(c, face.positions[q]) - means[c];
          initial_tractions.push_back(in_plane(rest, face.normals[q]));
        }
    });
  }



  template <int dim>
  template <typename Call>
  void
  ResidualEstimator<dim>::for_each_face(const Call &call) const
  {
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (const FaceShape &face : shapes[cells[c].shape].faces)
        call(c, face);
    for (const SubfaceSide &side : subface_sides)
      call(side.cell, subface_shapes[side.table]);
  }



  template <int dim>
  void
  ResidualEstimator<dim>::make_thermal_points()
  {
    const Scene<dim> &scene = stress_space.space.scene;
    if (!scene.has_thermal_strain() || stress_space.mean_dilatation)
      return;
    fail_together(stress_space.space.communicator, [&] {
      std::vector<SymmetricTensor<2, 3>> of_degree;
      for (const LocalCell &cell : cells)
        {
          Tensor<1, dim> center = cell.origin;
          for (const auto &position : shapes[cell.shape].positions)
            center += position / n_points;
          of_degree.push_back(ThermalStrain<dim>::stress(
            cell.stiffness,
            scene.material(cell.material_id).expansion(Point<dim>(center))));
        }
      std::vector<bool> counts(cells.size() * n_faces + subface_sides.size());
      for (const BoundaryFace &face : boundary_faces)
        counts[face.cell * n_faces + face.face] = true;
      for (const InteriorFace &face : interior_faces)
        {
          const auto [a, b] = face.cells;
          if (of_degree[a] != of_degree[b] ||
              cells[a].is_present != cells[b].is_present)
            for (const unsigned int traction : face.tractions)
              counts[traction / n_face_points] = true;
        }
      const Temperature<dim> &T    = *scene.temperature;
      std::size_t             side = 0;
      for_each_face([&](const std::size_t c, const FaceShape &face) {
        if (counts[side] && of_degree[c].norm() > 0.)
          for (unsigned int q = 0; q < n_face_points; ++q)
            {
              const Point<dim> x = cells[c].origin + face.positions[q];
              thermal_points.push_back(
                {side * n_face_points + q,
                 x,
                 T.reference ? *T.reference : T.value.value(x, 0.),
                 in_plane(of_degree[c], face.normals[q])});
            }
        ++side;
      });
    });
  }



  template <int dim>
  void
  ResidualEstimator<dim>::add_thermal_tractions(
    const double                 t,
    std::vector<Tensor<1, dim>> &tractions) const
  {
    const Expression<dim> &T = stress_space.space.scene.temperature->value;
    if (T.depends_on_time() || !temperatures)
      {
        temperatures.emplace();
        // The temperature may have no value at a point of some rank.
        fail_together(stress_space.space.communicator, [&] {
          for (const ThermalPoint &point : thermal_points)
            temperatures->push_back(T.value(point.x, t));
        });
      }
    for (std::size_t i = 0; i < thermal_points.size(); ++i)
      tractions[thermal_points[i].traction] +=
        ((*temperatures)[i] - thermal_points[i].reference) *
        thermal_points[i].of_degree;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(ResidualEstimator);
} // namespace Viscoplastic
