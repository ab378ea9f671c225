// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/discretization/contact_limits.h>
#include <viscoplastic_contact/discretization/held_traction.h>

namespace Viscoplastic
{
  template <int dim>
  ContactTension<dim>::ContactTension(const StressSpace<dim> &stress_space)
    : stress_space(stress_space)
    , total_area(0.)
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    space.for_each_boundary_face([&](const std::size_t  c,
                                     const auto        &cell,
                                     const unsigned int f,
                                     const auto        &condition) {
      // Glued contact is meant to carry tension.
      if (condition.role != BoundaryRole::contact ||
          !condition.is_bilateral() || condition.is_glued() ||
          !space.scene.is_present(cell->material_id()))
        return;
      const auto     face = cell->face(f);
      Tensor<1, dim> normal;
      for (const unsigned int v : face->vertex_indices())
        normal += space.normal_at(face->vertex_dof_index(v, 0), condition);
      faces.push_back(
        {c,
         normal / normal.norm(),
         face->measure() * extent(space.scene.plane_model(), face->center())});
      total_area += faces.back().area;
    });
    total_area = Utilities::MPI::sum(total_area, space.communicator);
  }



  template <int dim>
  double
  ContactTension<dim>::tension_area(const State<dim> &state) const
  {
    const unsigned int                 n = stress_space.n_samples;
    std::vector<SymmetricTensor<2, 3>> strain(n);
    std::vector<double>                normal_stress;
    double                             largest = 0.;
    for (const Face &face : faces)
      {
        stress_space.strains(face.cell, state.u.begin(), strain.data());
        SymmetricTensor<2, 3> stress = stress_space.moduli(face.cell).stress(
          stress_space.mean(face.cell, strain.data()));
        if (!state.z.empty())
          stress += stress_space.mean(face.cell, &state.z[face.cell * n]);
        double value = 0.;
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            value += stress[i][j] * face.normal[i] * face.normal[j];
        normal_stress.push_back(value);
        // The whole stress counts: in pure shear the normal stress is rounding.
        largest = std::max(largest, stress.norm());
      }
    const MPI_Comm comm = stress_space.space.communicator;
    largest             = Utilities::MPI::max(largest, comm);
    double area         = 0.;
    for (std::size_t i = 0; i < faces.size(); ++i)
      if (normal_stress[i] > 1e-3 * largest)
        area += faces[i].area;
    return Utilities::MPI::sum(area, comm);
  }



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



  VISCOPLASTIC_INSTANTIATE_CLASS(ContactTension);
  VISCOPLASTIC_INSTANTIATE_CLASS(InterfaceSlide);
} // namespace Viscoplastic
