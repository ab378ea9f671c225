// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>

#include <viscoplastic_contact/error/boundary_defects.h>

// Friction bounds that vary within faces by more than their quadrature sees.

namespace Viscoplastic
{
  namespace
  {
    /// The pieces of a face in each direction: a bound that jumps nearer to a
    /// vertex than a fifth of a piece is not seen.
    constexpr unsigned int n_pieces = 8;
  } // namespace



  template <int dim>
  std::vector<typename BoundaryDefects<dim>::ChangeOfBound>
  BoundaryDefects<dim>::changes_of_bounds(const double t) const
  {
    const AdmissibleSpace<dim> &space = discretization.space;
    FEFaceValues<dim>           rule_of_bounds(space.mapping,
                                     space.dof_handler.get_fe(),
                                     QGauss<dim - 1>(2),
                                     update_values | update_JxW_values |
                                       update_quadrature_points),
      composite(space.mapping,
                space.dof_handler.get_fe(),
                QIterated<dim - 1>(QGauss<1>(2), n_pieces),
                update_values | update_JxW_values | update_quadrature_points);
    std::vector<ChangeOfBound> result;
    space.for_each_boundary_face([&](const std::size_t,
                                     const auto        &cell,
                                     const unsigned int f,
                                     const auto        &condition) {
      if (!condition.has_friction() ||
          !condition.friction_depends_on_position() ||
          !space.scene.is_present(cell->material_id()))
        return;
      std::array<ChangeOfBound, (1u << dim)> changes{};
      double bounds = 0., coefficients = 0.; // integrals over the face
      for (const double sign : {-1., 1.})
        {
          FEFaceValues<dim> &values = sign < 0. ? rule_of_bounds : composite;
          values.reinit(cell, f);
          for (const unsigned int q : values.quadrature_point_indices())
            {
              const Point<dim> &x      = values.quadrature_point(q);
              const double      bound  = condition.bound(x, t) * values.JxW(q),
                           coefficient = condition.friction_coefficient(x, t) *
                                         values.JxW(q);
              bounds += bound;
              coefficients += coefficient;
              for (const unsigned int v : cell->vertex_indices())
                {
                  const double shape = sign * values.shape_value(v * dim, q);
                  changes[v].bound += shape * bound;
                  changes[v].coefficient += shape * coefficient;
                }
            }
        }
      for (const unsigned int v : cell->vertex_indices())
        if (std::abs(changes[v].bound) > 1e-10 * bounds ||
            std::abs(changes[v].coefficient) > 1e-10 * coefficients)
          result.push_back(
            {cell->active_cell_index(),
             space.relevant.index_within_set(cell->vertex_dof_index(v, 0)),
             &condition,
             changes[v].bound,
             changes[v].coefficient});
    });
    return result;
  }



  template <int dim>
  Vector<double>
  BoundaryDefects<dim>::unresolved_bounds(
    const State<dim>          &state,
    const std::vector<double> &change_by_bounds) const
  {
    if (!any_varying_bounds)
      return {};
    const ContactFace<dim> &face        = *discretization.face;
    const ContactLayout    &layout      = face.layout();
    std::vector<double>     by_pressure = change_by_bounds;
    for (const unsigned int p : layout.friction_points())
      {
        double pressure = 0.;
        for (const unsigned int o : layout.obstacles(layout.points[p].node))
          pressure += state.contact.multiplier[o][0] / face.weights()[o];
        by_pressure[p] *= pressure;
      }
    const DistributedVector of_bound       = face.nodal_field(change_by_bounds),
                            of_coefficient = face.nodal_field(by_pressure);
    const bool by_rate = discretization.space.scene.on_any_boundary(
      [](const auto &b) { return b.slip_rate_factor.has_value(); });
    DistributedVector of_rate;
    if (by_rate)
      of_rate = face.nodal_field(
        face.slip_rates(state.velocity, state.t - state.k, state.t));
    Vector<double> result(
      discretization.space.dof_handler.get_triangulation().n_active_cells());
    const auto add = [&](const std::vector<ChangeOfBound> &changes) {
      for (const ChangeOfBound &change : changes)
        result[change.active_cell] +=
          (change.bound * of_bound.begin()[change.first] +
           change.coefficient * of_coefficient.begin()[change.first]) *
          (by_rate ?
             change.condition->bound_factor(of_rate.begin()[change.first]) :
             1.);
    };
    add(constant_changes ? *constant_changes : changes_of_bounds(state.t));
    return result;
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(BoundaryDefects, changes_of_bounds);
  VISCOPLASTIC_INSTANTIATE_MEMBER(BoundaryDefects, unresolved_bounds);
} // namespace Viscoplastic
