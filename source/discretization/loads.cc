// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>

#include <viscoplastic_contact/discretization/loads.h>

#include <iterator>

namespace Viscoplastic
{
  template <int dim>
  Loads<dim>::Loads(const AdmissibleSpace<dim> &space)
    : space(space)
    , constant{space.owned_vector(), Tensor<1, dim>(), {}}
  {
    space.for_each_boundary_face([&](const std::size_t,
                                     const Cell        &cell,
                                     const unsigned int f,
                                     const auto        &condition) {
      if (space.scene.is_present(cell->material_id()) &&
          condition.carries_load())
        faces.push_back({cell, f, &condition});
    });
    add(0., false, constant);
  }



  template <int dim>
  void
  Loads<dim>::add(const double t,
                  const bool   time_dependent,
                  Load<dim>   &load) const
  {
    std::vector<double> cartesian(space.relevant.n_elements());
    // The resultant, and for each boundary and b whether it has a force.
    std::vector<double> sums(dim + space.scene.boundary.size() + 1, 0.);
    bool                any       = false;
    const auto          number_of = [&](const types::boundary_id id) {
      return std::distance(space.scene.boundary.begin(),
                           space.scene.boundary.find(id));
    };

    const auto add_at_point = [&](const auto           &fe_values,
                                  const unsigned int    q,
                                  const Cell           &cell,
                                  const Tensor<1, dim> &force,
                                  const std::ptrdiff_t  load) {
      for (unsigned int d = 0; d < dim; ++d)
        sums[d] += force[d];
      if (force != Tensor<1, dim>())
        sums[dim + load] = 1.;
      for (const unsigned int v : cell->vertex_indices())
        {
          const auto node =
            space.relevant.index_within_set(cell->vertex_dof_index(v, 0));
          const double shape = fe_values.shape_value(v * dim, q);
          for (unsigned int d = 0; d < dim; ++d)
            cartesian[node + d] += shape * force[d];
        }
    };

    const FiniteElement<dim> &fe = space.dof_handler.get_fe();
    const auto               &b  = space.scene.body_force;
    if (b && b->depends_on_time() == time_dependent)
      {
        any = true;
        FEValues<dim> fe_values(space.mapping,
                                fe,
                                QGauss<dim>(2),
                                update_values | update_JxW_values |
                                  update_quadrature_points);
        for (const auto &cell : space.cells)
          {
            if (!space.scene.is_present(cell->material_id()))
              continue;
            fe_values.reinit(cell);
            for (const unsigned int q : fe_values.quadrature_point_indices())
              add_at_point(fe_values,
                           q,
                           cell,
                           b->vector(fe_values.quadrature_point(q), t) *
                             fe_values.JxW(q),
                           space.scene.boundary.size());
          }
      }

    FEFaceValues<dim> face_values(space.mapping,
                                  fe,
                                  QGauss<dim - 1>(2),
                                  update_values | update_JxW_values |
                                    update_quadrature_points |
                                    update_normal_vectors);
    for (const auto &pair : space.scene.boundary)
      any |= pair.second.carries_load() &&
             pair.second.load_depends_on_time() == time_dependent;
    for (const Face &face : faces)
      if (face.condition->load_depends_on_time() == time_dependent)
        {
          face_values.reinit(face.cell, face.face);
          const std::ptrdiff_t load_number = number_of(face.condition->id);
          for (const unsigned int q : face_values.quadrature_point_indices())
            {
              const Tensor<1, dim> force =
                face.condition->load(face_values.quadrature_point(q),
                                     face_values.normal_vector(q),
                                     t);
              add_at_point(face_values,
                           q,
                           face.cell,
                           force * face_values.JxW(q),
                           load_number);
            }
        }

    if (any) // the same on all ranks
      {
        space.add_cartesian_load(cartesian, load.values);
        Utilities::MPI::sum(sums, space.communicator, sums);
        for (unsigned int d = 0; d < dim; ++d)
          load.resultant[d] += sums[d];
        for (const auto &pair : space.scene.boundary)
          if (sums[dim + number_of(pair.first)] > 0.)
            load.acting.insert(pair.first);
        if (sums.back() > 0.)
          load.acting.insert(body_force_id);
      }
  }



  template <int dim>
  Load<dim>
  Loads<dim>::assemble(const double t) const
  {
    Load<dim> load = constant;
    add(t, true, load);
    if (const auto axial = space.owned_axial();
        axial && space.scene.axial_force)
      load.values.begin()[*axial] +=
        space.scene.axial_force->value(Point<dim>(), t) / space.axial_length;
    return load;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(Loads);
} // namespace Viscoplastic
