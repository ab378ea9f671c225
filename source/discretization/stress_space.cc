// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_dgq.h>

#include <viscoplastic_contact/discretization/stress_space.h>

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    std::unique_ptr<const FiniteElement<dim>>
    make_element(const bool at_quadrature_points)
    {
      if (at_quadrature_points)
        return std::make_unique<FE_DGQArbitraryNodes<dim>>(QGauss<1>(2));
      return std::make_unique<FE_DGQ<dim>>(0);
    }
  } // namespace



  template <int dim>
  StressSpace<dim>::StressSpace(const AdmissibleSpace<dim> &space,
                                const ElasticModuli<dim>   &moduli,
                                const bool at_quadrature_points,
                                const bool mean_dilatation)
    : space(space)
    , moduli(moduli)
    , mean_dilatation(mean_dilatation)
    , element(make_element<dim>(at_quadrature_points))
    , n_samples(element->n_dofs_per_cell())
  {
    const QGauss<dim> quadrature(2);
    FEValues<dim>     fe_values(space.mapping,
                            space.dof_handler.get_fe(),
                            quadrature,
                            update_values | update_gradients |
                              update_JxW_values | update_quadrature_points);
    const bool        has_hoops = space.scene.is_axisymmetric();
    nodes.reserve(space.cells.size() * n_vertices);
    for (std::size_t c = 0; c < space.cells.size(); ++c)
      {
        const auto &cell = space.cells[c];
        for (const unsigned int v : cell->vertex_indices())
          nodes.push_back(
            space.relevant.index_within_set(cell->vertex_dof_index(v, 0)));
        const unsigned int shape = space.shapes[c];
        if (shape < volumes.size())
          continue;
        fe_values.reinit(cell);
        double volume = 0.;
        for (const unsigned int q : fe_values.quadrature_point_indices())
          volume += fe_values.JxW(q);
        volumes.push_back(volume);
        if (at_quadrature_points)
          for (const unsigned int q : fe_values.quadrature_point_indices())
            {
              weights.push_back(fe_values.JxW(q));
              offsets.push_back(fe_values.quadrature_point(q) -
                                cell->vertex(0));
              for (const unsigned int v : cell->vertex_indices())
                {
                  gradients.push_back(fe_values.shape_grad(v * dim, q));
                  if (has_hoops)
                    hoops.push_back(hoop_strain(fe_values, v * dim, q));
                }
            }
        else
          {
            weights.push_back(volume);
            offsets.push_back(cell->center() - cell->vertex(0));
            for (const unsigned int v : cell->vertex_indices())
              {
                Tensor<1, dim> mean;
                double         mean_hoop = 0.;
                for (const unsigned int q :
                     fe_values.quadrature_point_indices())
                  {
                    mean += fe_values.shape_grad(v * dim, q) * fe_values.JxW(q);
                    if (has_hoops)
                      mean_hoop +=
                        hoop_strain(fe_values, v * dim, q) * fe_values.JxW(q);
                  }
                // P_Qh of a strain, (3.1): its mean.
                gradients.push_back(mean / volume);
                if (has_hoops)
                  hoops.push_back(mean_hoop / volume);
              }
          }
        for (const unsigned int v : cell->vertex_indices())
          {
            Tensor<1, dim> gradient;
            double         hoop = 0.;
            for (unsigned int q = 0; q < n_samples; ++q)
              {
                const std::size_t i = (shape * n_samples + q) * n_vertices + v;
                const double part   = weights[shape * n_samples + q] / volume;
                gradient += part * gradients[i];
                if (has_hoops)
                  hoop += part * hoops[i];
              }
            mean_gradients.push_back(gradient);
            mean_hoops.push_back(hoop);
          }
      }
  }



  template <int dim>
  SymmetricTensor<2, 3>
  StressSpace<dim>::mean_strain(const std::size_t cell, const double *u) const
  {
    // Mean dilatation does not change the mean strain.
    const std::size_t first = space.shapes[cell] * n_vertices;
    return strain_at(displacements(cell, u),
                     &mean_gradients[first],
                     hoops.empty() ? nullptr : &mean_hoops[first],
                     space.axial_strain(u));
  }



  template <int dim>
  void
  StressSpace<dim>::strains(const std::size_t      cell,
                            const double          *u,
                            SymmetricTensor<2, 3> *strain) const
  {
    const NodalValues     values   = displacements(cell, u);
    const double          zz       = space.axial_strain(u);
    const std::size_t     first    = space.shapes[cell] * n_samples;
    const Tensor<1, dim> *gradient = &gradients[first * n_vertices];
    const double         *weight   = &weights[first];
    double                mean     = 0.;
    for (unsigned int s = 0; s < n_samples; ++s)
      {
        strain[s] =
          strain_at(values,
                    gradient + s * n_vertices,
                    hoops.empty() ? nullptr : &hoops[(first + s) * n_vertices],
                    zz);
        mean += trace(strain[s]) * weight[s];
      }
    if (mean_dilatation && n_samples > 1)
      {
        mean /= volume(cell);
        for (unsigned int s = 0; s < n_samples; ++s)
          strain[s] = with_dilatation(strain[s], mean);
      }
  }



  template <int dim>
  void
  StressSpace<dim>::add_virtual_work(const std::size_t            cell,
                                     const SymmetricTensor<2, 3> *stress,
                                     const double                 factor,
                                     double                      *load) const
  {
    const unsigned int *node          = &nodes[cell * n_vertices];
    const bool          mean_pressure = mean_dilatation && n_samples > 1;
    double              pressure      = 0.;
    if (mean_pressure)
      {
        for (unsigned int s = 0; s < n_samples; ++s)
          pressure += trace(stress[s]) / 3. * weight(cell, s);
        pressure /= volume(cell);
      }
    double forces[n_vertices][dim] = {};
    for (unsigned int s = 0; s < n_samples; ++s)
      {
        const Tensor<1, dim> *g =
          &gradients[(space.shapes[cell] * n_samples + s) * n_vertices];
        const double weighted = factor * weight(cell, s);
        // The stress in the plane, in 2D, and the hoop stress.
        double acting[dim][dim], around = 0.;
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            acting[i][j] = stress[s][i][j];
        if (mean_pressure)
          for (unsigned int d = 0; d < dim; ++d)
            acting[d][d] += pressure - trace(stress[s]) / 3.;
        if (!hoops.empty())
          around = weighted *
                   (stress[s][2][2] +
                    (mean_pressure ? pressure - trace(stress[s]) / 3. : 0.));
        if (space.axial)
          load[*space.axial] += weighted * stress[s][2][2] / space.axial_length;
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            acting[i][j] *= weighted;
        for (unsigned int v = 0; v < n_vertices; ++v)
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int j = 0; j < dim; ++j)
              forces[v][i] += acting[i][j] * g[v][j];
        if (!hoops.empty())
          for (unsigned int v = 0; v < n_vertices; ++v)
            forces[v][0] +=
              around *
              hoops[(space.shapes[cell] * n_samples + s) * n_vertices + v];
      }
    for (unsigned int v = 0; v < n_vertices; ++v)
      for (unsigned int i = 0; i < dim; ++i)
        load[node[v] + i] += forces[v][i];
  }



  template <int dim>
  void
  StressSpace<dim>::add_stiffness(const std::size_t            cell,
                                  const SymmetricTensor<4, 3> *tangent,
                                  FullMatrix<double> &cell_matrix) const
  {
    constexpr unsigned int n             = n_vertices * dim;
    const bool             mean_pressure = mean_dilatation && n_samples > 1;
    const unsigned int     n_all         = n + (space.axial ? 1 : 0);
    // Components of SymmetricTensor<2, 3>; plane strains have the first ones.
    constexpr unsigned int n_components    = dim == 2 ? 4 : 6;
    constexpr unsigned int component[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    // The upper triangle.
    std::array<std::array<double, n + 1>, n + 1> sums{};
    for (unsigned int s = 0; s < n_samples; ++s)
      {
        const std::size_t first =
          (space.shapes[cell] * n_samples + s) * n_vertices;
        const Tensor<1, dim> *g = &gradients[first];
        const double         *h = hoops.empty() ? nullptr : &hoops[first];
        const double         *C = tangent[s].begin_raw(), w = weight(cell, s);
        const auto            hoop = [&h](const unsigned int i) {
          return h != nullptr && i % dim == 0 ? h[i / dim] : 0.;
        };
        // A third of each shape function's mean divergence minus its
        // divergence.
        std::array<double, n> excess{};
        if (mean_pressure)
          for (unsigned int i = 0; i < n; ++i)
            {
              const std::size_t v = space.shapes[cell] * n_vertices + i / dim;
              excess[i] =
                (mean_gradients[v][i % dim] - g[i / dim][i % dim] - hoop(i)) /
                3.;
              if (h != nullptr && i % dim == 0)
                excess[i] += mean_hoops[v] / 3.;
            }
        for (unsigned int j = 0; j < n_all; ++j)
          {
            // C eps of shape function j, and its work on the others, most of
            // whose strain components are zero.
            std::array<double, 6> stress{};
            for (unsigned int i = 0; i < n_components; ++i)
              {
                const double *of = &C[6 * i];
                if (j == n)
                  stress[i] = of[2] / space.axial_length;
                else
                  {
                    for (unsigned int d = 0; d < dim; ++d)
                      stress[i] += of[component[j % dim][d]] * g[j / dim][d];
                    stress[i] +=
                      (of[0] + of[1] + of[2]) * excess[j] + of[2] * hoop(j);
                  }
                stress[i] *= w;
              }
            const double pressure = stress[0] + stress[1] + stress[2];
            for (unsigned int i = 0; i <= j && i < n; ++i)
              {
                double work = pressure * excess[i] + stress[2] * hoop(i);
                for (unsigned int d = 0; d < dim; ++d)
                  work += stress[component[i % dim][d]] * g[i / dim][d];
                sums[j][i] += work;
              }
            if (j == n)
              sums[n][n] += stress[2] / space.axial_length;
          }
      }
    for (unsigned int j = 0; j < n_all; ++j)
      for (unsigned int i = 0; i <= j; ++i)
        {
          cell_matrix(i, j) += sums[j][i];
          if (i < j)
            cell_matrix(j, i) += sums[j][i];
        }
  }



  template <int dim>
  std::vector<FullMatrix<double>>
  StressSpace<dim>::prolongation() const
  {
    // Samples are values at the support points of the element, whose shape
    // functions are constant or (bi-, tri-)linear.
    std::vector<FullMatrix<double>> result(
      GeometryInfo<dim>::max_children_per_cell,
      FullMatrix<double>(n_samples, n_samples));
    for (unsigned int child = 0; child < result.size(); ++child)
      for (unsigned int s = 0; s < n_samples; ++s)
        for (unsigned int r = 0; r < n_samples; ++r)
          result[child](s, r) =
            element->shape_value(r,
                                 GeometryInfo<dim>::child_to_cell_coordinates(
                                   element->get_unit_support_points()[s],
                                   child));
    return result;
  }



  template <int dim>
  std::vector<SymmetricTensor<2, 3>>
  StressSpace<dim>::mean_stress(const DistributedVector  &ghosted_u,
                                const IrreversibleStress &z) const
  {
    std::vector<SymmetricTensor<2, 3>> result(n_cells());
    for (std::size_t c = 0; c < n_cells(); ++c)
      {
        result[c] = moduli(c).stress(mean_strain(c, ghosted_u.begin()));
        if (!z.empty())
          result[c] += mean(c, &z[c * n_samples]);
      }
    return result;
  }



  template <int dim>
  DistributedVector
  irreversible_forces(const StressSpace<dim>   &stress_space,
                      const IrreversibleStress &z)
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    std::vector<double>         cartesian(space.relevant.n_elements());
    for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
      stress_space.add_virtual_work(c,
                                    &z[c * stress_space.n_samples],
                                    1.,
                                    cartesian.data());
    DistributedVector result = space.owned_vector();
    space.add_cartesian_load(cartesian, result);
    return result;
  }



  template <int dim>
  void
  add_irreversible_load(const StressSpace<dim>   &stress_space,
                        const IrreversibleStress &z,
                        DistributedVector        &load)
  {
    load -= irreversible_forces(stress_space, z);
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(StressSpace);
  VISCOPLASTIC_INSTANTIATE(irreversible_forces);
  VISCOPLASTIC_INSTANTIATE(add_irreversible_load);
} // namespace Viscoplastic
