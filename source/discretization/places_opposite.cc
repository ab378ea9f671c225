// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/discretization/interface_sides.h>
#include <viscoplastic_contact/discretization/places_opposite.h>

namespace Viscoplastic
{
  template <int dim>
  std::vector<PlaceOpposite<dim>>
  places_opposite(const DoFHandler<dim>                  &dof_handler,
                  const AffineConstraints<double>        &hanging_nodes,
                  const ContactPair<dim>                 &pair,
                  const std::vector<InterfacePlace<dim>> &places,
                  const std::function<double(
                    const typename DoFHandler<dim>::active_cell_iterator &,
                    const unsigned int)>                 &softness)
  {
    using Sides              = InterfaceSides<dim>;
    constexpr unsigned int d = Sides::d;
    const Sides            sides(dof_handler, hanging_nodes, pair);
    const auto             primary = sides.primary_faces(softness);
    const auto             tree    = sides.tree_of(primary);

    std::vector<PlaceOpposite<dim>> result;
    for (const InterfacePlace<dim> &place : places)
      {
        result.emplace_back();
        const Projection<dim> along(place.normal);
        const Point<d>        x = along(place.position);
        for (const auto &[box, i] :
             tree | boost::geometry::index::adaptors::queried(
                      boost::geometry::index::intersects(sides.box_before(
                        place.position, place.normal, place.reach))))
          {
            const PrimaryFace<dim> &other = primary[i];
            const PlaneFace<d>      seen  = other.seen(along);
            if (!sides.faces(place.normal, other) || !contains(seen, x))
              continue;
            const Point<d> xi = reference_position<d>(seen, x);
            std::map<typename Sides::Node, double> weights;
            for (unsigned int v = 0; v < Sides::n; ++v)
              for (const auto &[node, share] : other.nodes[v])
                weights[node] +=
                  GeometryInfo<d>::d_linear_shape_function(xi, v) * share;
            for (const auto &[node, weight] : weights)
              result.back().nodes.push_back({node, weight});
            result.back().distance = other.position(xi) - place.position;
            if (pair.normals != nullptr)
              result.back().distance += other.bulge(xi);
            result.back().softness = other.softness;
            break;
          }
      }
    return result;
  }



  VISCOPLASTIC_INSTANTIATE(places_opposite);
} // namespace Viscoplastic
