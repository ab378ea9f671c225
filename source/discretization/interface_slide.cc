// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/discretization/held_traction.h>
#include <viscoplastic_contact/discretization/interface_slide.h>

namespace Viscoplastic
{
  template <int dim>
  InterfaceSlide<dim>::InterfaceSlide(const AdmissibleSpace<dim> &space)
    : space(space)
  {
    for (const auto &[id, rows] : space.mortar_rows)
      {
        const auto  weights   = boundary_weights(space, {id});
        const auto &condition = space.scene.boundary.at(id);
        double      uncovered = 0., whole = 0.;
        for (std::size_t i = 0; i < space.owned.n_elements(); i += dim)
          if (const double area = weights.local_element(i); area > 0.)
            {
              const auto dof = space.owned.nth_index_in_set(i);
              whole += area;
              if (rows.count(dof / dim) == 0)
                uncovered += area;
            }
        std::map<types::global_dof_index, double> widths;
        for (const auto &cell : space.dof_handler.active_cell_iterators())
          if (!cell->is_artificial())
            for (const unsigned int f : cell->face_indices())
              if (const auto face = cell->face(f);
                  face->at_boundary() && face->boundary_id() == id)
                for (const unsigned int v : face->vertex_indices())
                  {
                    double &width = widths[face->vertex_dof_index(v, 0)];
                    width         = std::max(width,
                                     std::pow(face->measure(), 1. / (dim - 1)));
                  }
        for (const auto &[dof, width] : widths)
          if (rows.count(dof / dim) == 1)
            nodes.push_back({space.relevant.index_within_set(dof),
                             space.normal_at(dof, condition),
                             width});
        shares[id] = Utilities::MPI::sum(uncovered, space.communicator) /
                     Utilities::MPI::sum(whole, space.communicator);
      }
  }



  template <int dim>
  double
  InterfaceSlide<dim>::largest(const DistributedVector &ghosted_u) const
  {
    DistributedVector relative = ghosted_u;
    space.make_relative(relative);
    double result = 0.;
    for (const Node &node : nodes)
      {
        Tensor<1, dim> slide;
        for (unsigned int d = 0; d < dim; ++d)
          slide[d] = relative.begin()[node.position + d];
        result =
          std::max(result, tangential(slide, node.normal).norm() / node.width);
      }
    return Utilities::MPI::max(result, space.communicator);
  }



  template class InterfaceSlide<2>;
  template class InterfaceSlide<3>;
} // namespace Viscoplastic
