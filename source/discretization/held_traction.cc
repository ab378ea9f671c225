// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>

#include <viscoplastic_contact/discretization/held_traction.h>

namespace Viscoplastic
{
  template <int dim>
  LinearAlgebra::distributed::Vector<double>
  boundary_weights(const AdmissibleSpace<dim>         &space,
                   const std::set<types::boundary_id> &ids)
  {
    LinearAlgebra::distributed::Vector<double> weights(space.owned,
                                                       space.relevant,
                                                       space.communicator);
    FEFaceValues<dim>                          face_values(space.mapping,
                                  space.dof_handler.get_fe(),
                                  QGauss<dim - 1>(2),
                                  update_values | update_JxW_values);
    space.for_each_boundary_face([&](const std::size_t,
                                     const auto        &cell,
                                     const unsigned int f,
                                     const auto        &condition) {
      if (!space.scene.is_present(cell->material_id()) ||
          ids.count(condition.id) == 0)
        return;
      face_values.reinit(cell, f);
      for (const unsigned int v : cell->vertex_indices())
        {
          double weight = 0.;
          for (const unsigned int q : face_values.quadrature_point_indices())
            weight += face_values.shape_value(v * dim, q) * face_values.JxW(q);
          for (const auto &[dof, share] :
               space.independent_nodes(cell->vertex_dof_index(v, 0)))
            weights(dof) += share * weight;
        }
    });
    weights.compress(VectorOperation::add);
    return weights;
  }



  namespace
  {
    template <int dim>
    bool
    holds(const BoundaryCondition<dim> &condition)
    {
      return condition.against && condition.is_bilateral();
    }
  } // namespace



  template <int dim>
  HeldTraction<dim>::HeldTraction(const AdmissibleSpace<dim> &space)
    : space(space)
  {
    std::set<types::boundary_id> ids;
    for (const auto &[id, condition] : space.scene.boundary)
      if (holds(condition))
        {
          ids.insert(id);
          ids.insert(*condition.against);
        }
    weights = boundary_weights(space, ids);
  }



  template <int dim>
  bool
  HeldTraction<dim>::is_needed(const Scene<dim> &scene)
  {
    return scene.on_any_boundary([](const auto &b) { return holds(b); });
  }



  template <int dim>
  void
  HeldTraction<dim>::add_density(const DistributedVector &missing,
                                 DistributedVector       &density) const
  {
    LinearAlgebra::distributed::Vector<double> forces(space.owned,
                                                      space.relevant,
                                                      space.communicator);
    for (const auto &node : space.boundary_nodes())
      {
        const NodalFrame<dim> &frame = space.frame(node.frame);
        const std::size_t first = space.owned.index_within_set(node.first_dof);
        Tensor<1, dim>    fixed;
        for (unsigned int i = 0; i < frame.n_fixed; ++i)
          fixed[i] = missing.begin()[first + frame.fixed[i]];
        const Tensor<1, dim> part =
          transpose(invert(condition_matrix(frame))) * fixed;
        Tensor<1, dim> force;
        for (unsigned int i = 0; i < frame.n_fixed; ++i)
          if (const auto condition =
                space.scene.boundary.find(frame.condition_boundary[i]);
              condition != space.scene.boundary.end() &&
              holds(condition->second))
            force += part[i] * frame.condition_direction[i];
        if (force.norm() == 0.)
          continue;
        for (unsigned int d = 0; d < dim; ++d)
          forces.local_element(first + d) += force[d];
        const auto &coupling = space.coupling_at(node.first_dof);
        force                = coupling.projector * force;
        for (const auto &[other, weight] : coupling.others)
          for (unsigned int d = 0; d < dim; ++d)
            forces(space.relevant.nth_index_in_set(other + d)) -=
              weight * force[d];
      }
    forces.compress(VectorOperation::add);
    DistributedVector values  = space.owned_vector(),
                      ghosted = space.ghosted_vector();
    for (std::size_t i = 0; i < space.owned.n_elements(); ++i)
      if (const double force = forces.local_element(i); force != 0.)
        values.begin()[i] = force / weights.local_element(i - i % dim);
    space.distribute_hanging_nodes(values);
    ghosted = values;
    if (density.size() == 0)
      density = ghosted;
    else
      for (std::size_t i = 0; i < space.relevant.n_elements(); ++i)
        density.begin()[i] += ghosted.begin()[i];
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(HeldTraction);
  VISCOPLASTIC_INSTANTIATE(boundary_weights);
} // namespace Viscoplastic
