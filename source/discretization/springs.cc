// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>

#include <viscoplastic_contact/discretization/springs.h>

namespace Viscoplastic
{
  template <int dim>
  Springs<dim>::Springs(const AdmissibleSpace<dim> &space)
    : space(space)
  {
    FEFaceValues<dim> face_values(space.mapping,
                                  space.dof_handler.get_fe(),
                                  QGauss<dim - 1>(2),
                                  update_values | update_JxW_values |
                                    update_quadrature_points |
                                    update_normal_vectors);
    space.for_each_boundary_face([&](const std::size_t,
                                     const auto        &cell,
                                     const unsigned int f,
                                     const auto        &condition) {
      if (!condition.has_springs())
        return;
      face_values.reinit(cell, f);
      Face face{cell, f, {}};
      for (const unsigned int q : face_values.quadrature_point_indices())
        {
          face.stiffness[q] =
            condition.spring_stiffness(face_values.quadrature_point(q),
                                       face_values.normal_vector(q)) *
            face_values.JxW(q);
          for (unsigned int v = 0; v < n_nodes; ++v)
            shape_values[f][q][v] = face_values.shape_value(v * dim, q);
        }
      faces.push_back(face);
    });
  }



  template <int dim>
  Tensor<1, dim>
  Springs<dim>::displacement(const DistributedVector           &ghosted_u,
                             const Face                        &face,
                             const std::array<double, n_nodes> &shapes) const
  {
    Tensor<1, dim> result;
    for (unsigned int v = 0; v < n_nodes; ++v)
      {
        const auto node =
          space.relevant.index_within_set(face.cell->vertex_dof_index(v, 0));
        for (unsigned int d = 0; d < dim; ++d)
          result[d] += shapes[v] * ghosted_u.begin()[node + d];
      }
    return result;
  }



  template <int dim>
  void
  Springs<dim>::add_to(DistributedMatrix &matrix, const double factor) const
  {
    constexpr unsigned int               n = n_nodes * dim;
    FullMatrix<double>                   cell_matrix;
    std::vector<types::global_dof_index> dofs;
    for (const Face &face : faces)
      {
        cell_matrix.reinit(n, n);
        for (unsigned int q = 0; q < n_points; ++q)
          for (unsigned int i = 0; i < n; ++i)
            for (unsigned int j = 0; j < n; ++j)
              cell_matrix(i, j) += factor *
                                   shape_values[face.number][q][i / dim] *
                                   shape_values[face.number][q][j / dim] *
                                   face.stiffness[q][i % dim][j % dim];
        dofs.resize(n);
        face.cell->get_dof_indices(dofs);
        space.add_cell_matrix(dofs, cell_matrix, matrix);
      }
    matrix.compress();
  }



  template <int dim>
  void
  Springs<dim>::add_force(const DistributedVector &ghosted_u,
                          DistributedVector       &load,
                          const double             factor) const
  {
    std::vector<double> cartesian(space.relevant.n_elements());
    for_each_point([&](const Face &face, const auto &shapes, const auto &K) {
      const Tensor<1, dim> force =
        -factor * (K * displacement(ghosted_u, face, shapes));
      for (unsigned int v = 0; v < n_nodes; ++v)
        for (unsigned int d = 0; d < dim; ++d)
          cartesian[space.relevant.index_within_set(
                      face.cell->vertex_dof_index(v, 0)) +
                    d] += shapes[v] * force[d];
    });
    space.add_cartesian_load(cartesian, load);
  }



  template <int dim>
  typename Springs<dim>::Summary
  Springs<dim>::summarize(const DistributedVector &ghosted_u) const
  {
    Summary result;
    for (const auto &[id, condition] : space.scene.boundary)
      if (condition.has_springs())
        result.forces[id]; // the same entries on all ranks
    for_each_point([&](const Face &face, const auto &shapes, const auto &K) {
      const Tensor<1, dim> u     = displacement(ghosted_u, face, shapes),
                           force = K * u;
      result.forces[face.cell->face(face.number)->boundary_id()] -= force;
      result.energy += 0.5 * (force * u);
    });
    for (auto &pair : result.forces)
      pair.second = Utilities::MPI::sum(pair.second, space.communicator);
    result.energy = Utilities::MPI::sum(result.energy, space.communicator);
    return result;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(Springs);
} // namespace Viscoplastic
