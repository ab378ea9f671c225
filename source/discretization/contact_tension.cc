// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/discretization/contact_tension.h>

namespace Viscoplastic
{
  template <int dim>
  ContactTension<dim>::ContactTension(const StressSpace<dim> &stress_space)
    : stress_space(stress_space)
    , total_area(0.)
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    std::size_t                 index = 0;
    for (const auto &cell : space.cells)
      {
        for (const unsigned int f : cell->face_indices())
          if (cell->face(f)->at_boundary())
            {
              const auto &condition =
                space.scene.boundary.at(cell->face(f)->boundary_id());
              // Glue is meant to pull.
              if (condition.role != BoundaryRole::contact ||
                  !condition.is_bilateral() || condition.is_glued() ||
                  !space.scene.is_present(cell->material_id()))
                continue;
              Tensor<1, dim> normal;
              for (const unsigned int v : cell->face(f)->vertex_indices())
                normal += space.normal_at(cell->face(f)->vertex_dof_index(v, 0),
                                          condition);
              faces.push_back(
                {index,
                 normal / normal.norm(),
                 cell->face(f)->measure() *
                   extent(space.scene.plane_model(), cell->face(f)->center())});
              total_area += faces.back().area;
            }
        ++index;
      }
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
        // Of the whole stress: in pure shear the normal stress is rounding.
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



  template class ContactTension<2>;
  template class ContactTension<3>;
} // namespace Viscoplastic
