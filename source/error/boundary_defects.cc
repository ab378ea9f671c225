// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/mapping_q.h>

#include <viscoplastic_contact/error/boundary_defects.h>

namespace Viscoplastic
{
  template <int dim>
  BoundaryDefects<dim>::BoundaryDefects(
    const Discretization<dim> &discretization)
    : discretization(discretization)
  {
    find_sides();
    if (discretization.face)
      find_held_nodes();
    const MPI_Comm communicator = discretization.space.communicator;
    any_sides =
      Utilities::MPI::max<unsigned int>(side_points.size(), communicator) > 0;
    any_held_nodes =
      Utilities::MPI::max<unsigned int>(held_nodes.size(), communicator) > 0;
    bool varies_in_time = false;
    for (const auto &[id, condition] : discretization.space.scene.boundary)
      if (condition.has_friction() && condition.friction_depends_on_position())
        {
          any_varying_bounds = true;
          varies_in_time |= condition.friction_depends_on_time();
        }
    if (any_varying_bounds && !varies_in_time)
      constant_changes = changes_of_bounds(0.);
  }



  template <int dim>
  void
  BoundaryDefects<dim>::find_sides()
  {
    const AdmissibleSpace<dim> &space = discretization.space;
    const FiniteElement<dim>   &fe    = space.dof_handler.get_fe();
    const QGauss<dim - 1>       quadrature(2);
    const MappingQ<dim>         of_manifold(3);
    FEFaceValues<dim>           straight(space.mapping,
                               fe,
                               quadrature,
                               update_values | update_gradients |
                                 update_JxW_values | update_normal_vectors |
                                 update_quadrature_points);
    FEFaceValues<dim>           curved(of_manifold,
                             fe,
                             quadrature,
                             update_JxW_values | update_normal_vectors |
                               update_quadrature_points);
    for (std::size_t c = 0; c < space.cells.size(); ++c)
      for (const unsigned int f : space.cells[c]->face_indices())
        {
          const auto &cell = space.cells[c];
          const auto  face = cell->face(f);
          if (!face->at_boundary() ||
              !space.scene.is_present(cell->material_id()) ||
              face->center().distance(face->center(true)) <
                1e-10 * face->diameter())
            continue;
          straight.reinit(cell, f);
          curved.reinit(cell, f);
          for (const unsigned int q : straight.quadrature_point_indices())
            {
              SidePoint point{
                c,
                &space.scene.boundary.at(face->boundary_id()),
                {{straight.quadrature_point(q), curved.quadrature_point(q)}},
                {{straight.normal_vector(q), curved.normal_vector(q)}},
                {{straight.JxW(q),
                  curved.JxW(q) * extent(space.scene.plane_model(),
                                         curved.quadrature_point(q))}},
                {},
                {}};
              for (const unsigned int v : cell->vertex_indices())
                {
                  point.shape[v]    = straight.shape_value(v * dim, q);
                  point.gradient[v] = straight.shape_grad(v * dim, q);
                }
              side_points.push_back(point);
            }
        }
  }



  template <int dim>
  void
  BoundaryDefects<dim>::find_held_nodes()
  {
    const AdmissibleSpace<dim> &space   = discretization.space;
    const auto                 &hanging = space.cartesian_hanging_nodes();
    FEFaceValues<dim>           face_values(space.mapping,
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
          const BoundaryCondition<dim> &condition =
            space.scene.boundary.at(face->boundary_id());
          if (!condition.has_friction())
            continue;
          face_values.reinit(cell, f);
          std::vector<std::size_t> vertices;
          for (unsigned int v = 0; v < face->n_vertices(); ++v)
            vertices.push_back(
              space.relevant.index_within_set(face->vertex_dof_index(v, 0)));
          const auto add = [&](const types::global_dof_index dof,
                               const Point<dim>             &position,
                               const double                  area) {
            if (condition.against &&
                space.mortar_rows.at(condition.id).count(dof / dim) == 0)
              return; // nothing opposite
            const NodalFrame<dim> &frame  = space.frame_at(dof);
            const Tensor<1, dim>   normal = space.normal_at(dof, condition);
            Tensor<2, dim>         held =
              unit_symmetric_tensor<dim>() - outer_product(normal, normal);
            for (const FrictionPlane<dim> &plane : frame.planes)
              if (const auto &ids = plane.boundary_ids;
                  std::find(ids.begin(), ids.end(), condition.id) != ids.end())
                for (unsigned int i = 0; i < plane.n_tangents; ++i)
                  {
                    const Tensor<1, dim> tangent =
                      frame.directions * plane.map[i];
                    held -=
                      outer_product(tangent, tangent) / tangent.norm_square();
                  }
            if (held.norm() > 1e-6)
              held_nodes.push_back({cell->active_cell_index(),
                                    space.relevant.index_within_set(dof),
                                    position,
                                    area,
                                    &condition,
                                    normal,
                                    held,
                                    vertices});
          };
          for (const unsigned int v : cell->vertex_indices())
            {
              double area = 0.;
              for (const unsigned int q :
                   face_values.quadrature_point_indices())
                area +=
                  face_values.shape_value(v * dim, q) * face_values.JxW(q);
              if (area < 1e-12 * face->measure())
                continue; // not a vertex of the face
              const auto dof = cell->vertex_dof_index(v, 0);
              if (!hanging.is_constrained(dof))
                add(dof, cell->vertex(v), area);
              else
                for (const auto &[master, weight] :
                     *hanging.get_constraint_entries(dof))
                  add(master, cell->vertex(v), weight * area);
            }
        }
  }



  template <int dim>
  Vector<double>
  BoundaryDefects<dim>::missing_sides(const State<dim>        &state,
                                      const DistributedVector &ghosted_w) const
  {
    if (!any_sides)
      return {};
    const AdmissibleSpace<dim> &space        = discretization.space;
    const StressSpace<dim>     &stress_space = discretization.stress_space;
    const auto                 &b            = space.scene.body_force;
    const unsigned int          n            = stress_space.n_samples;
    std::vector<SymmetricTensor<2, 3>> strains(n), of_w(n);
    double                             power = 0.; // sigma : eps(w)
    std::size_t                        last  = numbers::invalid_size_type;
    Vector<double>                     result(
      space.dof_handler.get_triangulation().n_active_cells());
    for (const SidePoint &point : side_points)
      {
        const auto &cell = space.cells[point.cell];
        if (point.cell != last)
          {
            last = point.cell;
            stress_space.strains(last, state.u.begin(), strains.data());
            stress_space.strains(last, ghosted_w.begin(), of_w.data());
            power = 0.;
            for (unsigned int s = 0; s < n; ++s)
              {
                SymmetricTensor<2, 3> stress =
                  stress_space.moduli(last).stress(strains[s]);
                if (!state.z.empty())
                  stress += state.z[last * n + s];
                power += stress * of_w[s] / n;
              }
          }
        const Tensor<1, dim> delta = point.x[1] - point.x[0];
        Tensor<1, dim>       w, change;
        for (const unsigned int v : cell->vertex_indices())
          {
            const std::size_t first =
              space.relevant.index_within_set(cell->vertex_dof_index(v, 0));
            for (unsigned int d = 0; d < dim; ++d)
              {
                const double value = ghosted_w.begin()[first + d];
                w[d] += value * point.shape[v];
                change[d] += value * (point.gradient[v] * delta);
              }
          }
        double &part = result[cell->active_cell_index()];
        part += (delta * point.normal[0]) * point.weight[0] *
                ((b ? b->vector(point.x[0], state.t) * w : 0.) - power);
        if (point.condition->carries_load())
          for (const unsigned int i : {0, 1})
            part +=
              (i == 1 ? 1. : -1.) * point.weight[i] *
              (point.condition->load(point.x[i], point.normal[i], state.t) *
               (w + i * change));
      }
    return result;
  }



  template <int dim>
  Vector<double>
  BoundaryDefects<dim>::held_friction(const State<dim>         &state,
                                      const QuantityOfInterest &quantity,
                                      const DistributedVector  &ghosted_w) const
  {
    if (!any_held_nodes)
      return {};
    const AdmissibleSpace<dim> &space    = discretization.space;
    ContactState                slipping = state.contact;
    for (const unsigned int p : discretization.face->layout().friction_points())
      if (slipping.sticks[p])
        slipping.multiplier[p] = Tensor<1, 2>();
    const DistributedVector density  = discretization.face->density(slipping);
    const auto              is_force = [&](const BoundaryCondition<dim> &of) {
      return quantity.kind == QuantityOfInterest::Kind::friction_force &&
             quantity.is_of(of.id);
    };
    // Between two bodies slip is relative, and both feel the friction.
    DistributedVector u = state.u, w = ghosted_w;
    space.make_relative(u);
    space.make_relative(w);
    Vector<double> result(
      space.dof_handler.get_triangulation().n_active_cells());
    for (const HeldNode &node : held_nodes)
      {
        const auto at = [](const DistributedVector &field,
                           const std::size_t        first) {
          Tensor<1, dim> value;
          for (unsigned int d = 0; d < dim; ++d)
            value[d] = field.begin()[first + d];
          return value;
        };
        const auto at_node = [&](const DistributedVector &field) {
          return at(field, node.first);
        };
        const BoundaryCondition<dim> &condition = *node.condition;
        const Tensor<1, dim>          sliding =
                               condition.sliding(node.position, state.t),
                             moved = tangential(at_node(u), node.normal),
                             slip = moved - sliding, held = node.held * slip;
        double beside = 0., nothing = 1e-9 * (moved.norm() + sliding.norm());
        for (const std::size_t vertex : node.vertices)
          {
            beside = std::max(
              beside,
              std::abs((node.held * at(density, vertex))[quantity.component]));
            // If two bodies are held, slip of less than half of what u varies
            // by on the face is zero: the opposite u is a mean.
            if (condition.against)
              for (const DistributedVector *const field :
                   {&state.u, &std::as_const(u)})
                nothing = std::max(nothing,
                                   0.5 * (node.held * (at(*field, vertex) -
                                                       at_node(*field)))
                                           .norm());
          }
        if (!(held.norm() > nothing))
          {
            if (is_force(condition))
              result[node.active_cell] += beside * node.area;
            continue;
          }
        const auto of_bound = [&](const double bound) {
          return bound * node.area * held.norm() / slip.norm();
        };
        double missing = of_bound(condition.bound(node.position, state.t));
        if (condition.has_computed_pressure())
          missing +=
            of_bound(condition.friction_coefficient(node.position, state.t)) *
            std::abs(at_node(density) * node.normal);
        if (quantity.is_sum())
          missing *= held.norm();
        else if (is_force(condition))
          missing *= std::abs(held[quantity.component]) / held.norm();
        else
          missing *= (node.held * at_node(w)).norm();
        result[node.active_cell] += missing;
      }
    return result;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(BoundaryDefects);
} // namespace Viscoplastic
