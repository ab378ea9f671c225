// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/distributed/tria_base.h>

#include <viscoplastic_contact/error/local_cells.h>
#include <viscoplastic_contact/mesh/cell_order.h>
#include <viscoplastic_contact/mesh/cell_shapes.h>

namespace Viscoplastic
{
  template <int dim>
  void
  LocalCells<dim>::FaceShape::reinit(const Point<dim>            &vertex_0,
                                     const FEFaceValuesBase<dim> &values,
                                     const bool                   is_of_ring)
  {
    for (const unsigned int q : values.quadrature_point_indices())
      {
        for (unsigned int v = 0; v < n_vertices; ++v)
          {
            gradients[q][v] = values.shape_grad(v * dim, q);
            hoops[q][v]     = is_of_ring ? hoop_strain(values, v * dim, q) : 0.;
          }
        normals[q]   = values.normal_vector(q);
        positions[q] = values.quadrature_point(q) - vertex_0;
        weights[q]   = values.JxW(q);
        area += weights[q];
      }
  }



  template <int dim>
  void
  LocalCells<dim>::add_shape(const CellIterator &cell,
                             FEValues<dim>      &values,
                             FEFaceValues<dim>  &on_face)
  {
    values.reinit(cell);
    shapes.emplace_back();
    Shape &shape   = shapes.back();
    shape.diameter = cell->diameter();
    double volume  = 0.;
    for (const unsigned int q : values.quadrature_point_indices())
      {
        shape.weights[q]   = values.JxW(q);
        shape.positions[q] = values.quadrature_point(q) - cell->vertex(0);
        volume += values.JxW(q);
        for (unsigned int v = 0; v < n_vertices; ++v)
          {
            shape.mean_gradients[v] +=
              values.shape_grad(v * dim, q) * values.JxW(q);
            shape.gradients[q][v] = values.shape_grad(v * dim, q);
            if (has_hoops)
              {
                shape.hoops[q][v] = hoop_strain(values, v * dim, q);
                shape.mean_hoops[v] += shape.hoops[q][v] * values.JxW(q);
              }
          }
      }
    for (auto &gradient : shape.mean_gradients)
      gradient /= volume;
    for (double &hoop : shape.mean_hoops)
      hoop /= volume;
    shape.volume = volume;
    for (unsigned int f = 0; f < n_faces; ++f)
      {
        on_face.reinit(cell, f);
        shape.faces[f].reinit(cell->vertex(0), on_face, has_hoops);
      }
  }



  template <int dim>
  LocalCells<dim>::LocalCells(const StressSpace<dim> &stress_space)
    : stress_space(stress_space)
    , has_hoops(stress_space.space.scene.is_axisymmetric())
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    const FiniteElement<dim>   &fe    = space.dof_handler.get_fe();
    FEValues<dim>               values(space.mapping,
                         fe,
                         QGauss<dim>(2),
                         update_values | update_gradients |
                           update_quadrature_points | update_JxW_values);
    FEFaceValues<dim>           on_face(space.mapping,
                              fe,
                              QGauss<dim - 1>(2),
                              update_values | update_gradients |
                                update_normal_vectors |
                                update_quadrature_points | update_JxW_values);
    CellShapes<dim>             number_of(space.scene.plane_model());
    cells.reserve(space.cells.size());
    const auto add = [&](const CellIterator &cell,
                         const unsigned int  shape,
                         const Stiffness    &E) {
      if (shape == shapes.size())
        add_shape(cell, values, on_face);
      LocalCell here{shape,
                     cell->active_cell_index(),
                     cell->global_active_cell_index(),
                     {},
                     E,
                     cell->vertex(0),
                     cell->material_id(),
                     space.scene.is_present(cell->material_id())};
      for (unsigned int v = 0; v < n_vertices; ++v)
        here.nodes[v] =
          space.relevant.index_within_set(cell->vertex_dof_index(v, 0));
      cells.push_back(std::move(here));
    };
    for (std::size_t c = 0; c < space.cells.size(); ++c)
      {
        if (space.shapes[c] == shapes.size())
          number_of.add(space.cells[c]);
        add(space.cells[c], space.shapes[c], stress_space.moduli(c));
      }
    for (const auto &cell : ghost_cells(space.dof_handler))
      add(cell,
          number_of.add(cell).first,
          space.scene.material(cell->material_id()).stiffness(cell->center()));
  }



  template <int dim>
  typename LocalCells<dim>::NodalValues
  LocalCells<dim>::displacements(const LocalCell &cell, const double *u) const
  {
    NodalValues result;
    for (unsigned int v = 0; v < n_vertices; ++v)
      for (unsigned int d = 0; d < dim; ++d)
        result[v][d] = u[cell.nodes[v] + d];
    result.axial_strain = stress_space.space.axial_strain(u);
    return result;
  }



  template <int dim>
  SymmetricTensor<2, 3>
  LocalCells<dim>::mean_strain(const LocalCell   &cell,
                               const NodalValues &displacements) const
  {
    const Shape &shape = shapes[cell.shape];
    return strain(gradient(displacements, shape.mean_gradients),
                  strain_zz(displacements, shape.mean_hoops));
  }



  template <int dim>
  typename LocalCells<dim>::Strains
  LocalCells<dim>::strains(const LocalCell   &cell,
                           const NodalValues &displacements,
                           double            *dilatations) const
  {
    const Shape &shape = shapes[cell.shape];
    Strains      result;
    for (unsigned int q = 0; q < n_points; ++q)
      result[q] = strain(gradient(displacements, shape.gradients[q]),
                         strain_zz(displacements, shape.hoops[q]));
    if (dilatations != nullptr)
      std::fill_n(dilatations, n_points, 0.);
    if (!stress_space.mean_dilatation)
      return result;
    double mean = 0.;
    for (unsigned int q = 0; q < n_points; ++q)
      mean += trace(result[q]) * shape.weights[q] / shape.volume;
    for (unsigned int q = 0; q < n_points; ++q)
      {
        if (dilatations != nullptr)
          dilatations[q] = trace(result[q]) - mean;
        result[q] = with_dilatation(result[q], mean);
      }
    return result;
  }



  template <int dim>
  std::vector<typename LocalCells<dim>::Strains>
  LocalCells<dim>::strains(const DistributedVector &u) const
  {
    std::vector<Strains> result;
    result.reserve(stress_space.n_cells());
    for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
      result.push_back(strains(cells[c], displacements(cells[c], u.begin())));
    return result;
  }



  template <int dim>
  const SymmetricTensor<2, 3> *
  LocalCells<dim>::mean_irreversible_stress(const IrreversibleStress &z,
                                            IrreversibleStress &means) const
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    // A rank without cells has an empty z in every scene.
    if (Utilities::MPI::max(z.empty() ? 0 : 1, space.communicator) == 0)
      return nullptr;
    const bool is_alone =
      Utilities::MPI::n_mpi_processes(space.communicator) == 1;
    if (is_alone && stress_space.n_samples == 1)
      return z.data();
    means.resize(cells.size());
    const std::size_t n_owned = stress_space.n_cells();
    for (std::size_t c = 0; c < n_owned; ++c)
      means[c] = stress_space.mean(c, &z[c * stress_space.n_samples]);
    if (is_alone)
      return means.data();

    const auto &triangulation =
      dynamic_cast<const parallel::TriangulationBase<dim> &>(
        space.dof_handler.get_triangulation());
    const auto partitioner =
      triangulation.global_active_cell_index_partitioner().lock();
    LinearAlgebra::distributed::Vector<double> component(partitioner);
    for (unsigned int i = 0; i < 6; ++i)
      {
        for (std::size_t c = 0; c < n_owned; ++c)
          component(cells[c].global_active_index) =
            means[c].access_raw_entry(i);
        component.update_ghost_values();
        for (std::size_t c = n_owned; c < cells.size(); ++c)
          means[c].access_raw_entry(i) =
            component(cells[c].global_active_index);
        component.zero_out_ghost_values();
      }
    return means.data();
  }



  template <int dim>
  Vector<double>
  LocalCells<dim>::by_active_index(const std::vector<double> &by_cell) const
  {
    Vector<double> result(
      stress_space.space.dof_handler.get_triangulation().n_active_cells());
    for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
      result[cells[c].active_index] = by_cell[c];
    return result;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(LocalCells);
} // namespace Viscoplastic
