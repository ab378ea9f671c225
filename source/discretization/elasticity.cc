// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>

#include <viscoplastic_contact/discretization/elasticity.h>

#include <map>

namespace Viscoplastic
{
  template <int dim>
  ElasticModuli<dim>::ElasticModuli(const AdmissibleSpace<dim> &space)
    : max_nu(-1.)
  {
    const Scene<dim> &scene = space.scene;
    if (scene.materials.size() == 1 && scene.materials[0]->is_uniform())
      moduli.push_back(scene.materials[0]->stiffness(Point<dim>()));
    else
      {
        std::map<types::material_id, unsigned int> number_of;
        for (const auto &cell : space.cells)
          {
            const auto  id       = cell->material_id();
            const auto &material = scene.material(id);
            const auto  known    = number_of.find(id);
            number.push_back(known != number_of.end() ? known->second :
                                                        moduli.size());
            if (known != number_of.end())
              continue;
            if (material.is_uniform())
              number_of[id] = moduli.size();
            moduli.push_back(material.stiffness(cell->center()));
          }
      }
    for (const Stiffness &stiffness : moduli)
      max_nu = std::max(max_nu, stiffness.poissons_ratio());
    // max_nu must be the same in all stages, and so must choices based on it.
    if (scene.has_stages())
      for (const auto &cell : space.cells)
        max_nu = std::max(max_nu,
                          scene.lasting_material(cell->material_id())
                            .stiffness(cell->center())
                            .poissons_ratio());
    max_nu = Utilities::MPI::max(max_nu, space.communicator);
  }



  template <int dim>
  ElasticModuli<dim>::ElasticModuli(const Stiffness &stiffness)
    : moduli(1, stiffness)
    , max_nu(stiffness.poissons_ratio())
  {}



  template <int dim>
  void
  elastic_cell_matrix(const FEValues<dim> &fe_values,
                      const Stiffness     &stiffness,
                      const bool           mean_dilatation,
                      FullMatrix<double>  &cell_matrix,
                      const PlaneModel     plane_model,
                      const double         axial_strain)
  {
    const bool         is_ring = plane_model == PlaneModel::axisymmetric;
    const unsigned int n       = fe_values.dofs_per_cell;
    double             volume  = 0.;
    for (const unsigned int q : fe_values.quadrature_point_indices())
      volume += fe_values.JxW(q);

    // Mean divergence of each shape function.
    std::vector<double> mean(n, 0.);
    if (mean_dilatation)
      for (const unsigned int q : fe_values.quadrature_point_indices())
        for (unsigned int i = 0; i < n; ++i)
          mean[i] += (fe_values.shape_grad(i, q)[i % dim] +
                      (is_ring ? hoop_strain(fe_values, i, q) : 0.)) *
                     fe_values.JxW(q) / volume;

    const bool                         has_axial = cell_matrix.m() > n;
    const unsigned int                 n_all     = has_axial ? n + 1 : n;
    std::vector<SymmetricTensor<2, 3>> strain(n_all), stress(n_all);
    if (has_axial)
      strain[n][2][2] = axial_strain;
    cell_matrix = 0.;
    for (const unsigned int q : fe_values.quadrature_point_indices())
      {
        for (unsigned int i = 0; i < n; ++i)
          {
            const unsigned int   c = i % dim;
            const Tensor<1, dim> g = fe_values.shape_grad(i, q);
            strain[i]              = 0.;
            for (unsigned int d = 0; d < dim; ++d)
              strain[i][c][d] = (c == d ? 1. : 0.5) * g[d];
            if (is_ring)
              strain[i][2][2] = hoop_strain(fe_values, i, q);
            if (mean_dilatation)
              strain[i] = with_dilatation(strain[i], mean[i]);
          }
        for (unsigned int i = 0; i < n_all; ++i)
          {
            stress[i] = stiffness.stress(strain[i]) * fe_values.JxW(q);
            for (unsigned int j = 0; j <= i; ++j)
              cell_matrix(i, j) += strain[i] * stress[j];
          }
      }
    for (unsigned int i = 0; i < n_all; ++i)
      for (unsigned int j = i + 1; j < n_all; ++j)
        cell_matrix(i, j) = cell_matrix(j, i);
    // Entries that are no unknowns get a positive diagonal for solvers.
    for (unsigned int i = n_all; i < cell_matrix.m(); ++i)
      cell_matrix(i, i) = cell_matrix(n, n);
  }



  template <int dim>
  void
  assemble_elastic_matrix(const AdmissibleSpace<dim> &space,
                          const ElasticModuli<dim>   &moduli,
                          const bool                  mean_dilatation,
                          DistributedMatrix          &matrix)
  {
    space.reinit(matrix);

    const FiniteElement<dim> &fe = space.dof_handler.get_fe();
    FEValues<dim>             fe_values(space.mapping,
                            fe,
                            QGauss<dim>(2),
                            update_values | update_gradients |
                              update_JxW_values | update_quadrature_points);
    const unsigned int n = fe.n_dofs_per_cell() + (space.axial ? dim : 0);
    // Cells that differ by a translation have one matrix, to the last digit, so
    // that rows of nodes between such cells are equal, too.
    std::map<std::pair<unsigned int, const Stiffness *>, FullMatrix<double>>
                                         known;
    FullMatrix<double>                   cell_matrix;
    std::vector<types::global_dof_index> dofs;
    for (std::size_t c = 0; c < space.cells.size(); ++c)
      {
        const auto &cell = space.cells[c];
        const auto  key  = std::make_pair(space.shapes[c], &moduli(c));
        auto        same = known.find(key);
        if (same == known.end())
          {
            if (known.size() >= 64) // where hardly any are equal
              known.clear();
            same = known.emplace(key, FullMatrix<double>(n, n)).first;
            fe_values.reinit(cell);
            elastic_cell_matrix(fe_values,
                                moduli(c),
                                mean_dilatation,
                                same->second,
                                space.scene.plane_model(),
                                1. / space.axial_length);
          }
        cell_matrix = same->second;
        space.get_dofs(cell, dofs);
        space.add_cell_matrix(dofs, cell_matrix, matrix);
      }
    matrix.compress();
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(ElasticModuli);
  VISCOPLASTIC_INSTANTIATE(elastic_cell_matrix);
  VISCOPLASTIC_INSTANTIATE(assemble_elastic_matrix);
} // namespace Viscoplastic
