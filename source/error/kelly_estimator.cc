// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/numerics/error_estimator.h>

#include <viscoplastic_contact/error/kelly_estimator.h>
#include <viscoplastic_contact/mesh/cell_order.h>

namespace Viscoplastic
{
  template <int dim>
  Vector<double>
  kelly_estimate(const AdmissibleSpace<dim> &space,
                 const DistributedVector    &ghosted_u)
  {
    const Triangulation<dim> &triangulation =
      space.dof_handler.get_triangulation();
    // Units of a scene may exceed the range of KellyErrorEstimator's single
    // precision: scale u to about 1 by a power of two, which is exact.
    double size = 0.;
    for (std::size_t i = 0; i < space.relevant.n_elements(); ++i)
      size = std::max(size, std::abs(ghosted_u.begin()[i]));
    size = Utilities::MPI::max(size, space.communicator);
    const double unit =
      size > 0. ? std::ldexp(1., std::max(std::ilogb(size), -1000)) : 1.;
    DistributedVector scaled_u(ghosted_u);
    scaled_u /= unit;
    Vector<float> estimate(triangulation.n_active_cells());
    KellyErrorEstimator<dim>::estimate(space.dof_handler,
                                       QGauss<dim - 1>(2),
                                       {},
                                       scaled_u,
                                       estimate,
                                       ComponentMask(),
                                       nullptr,
                                       numbers::invalid_unsigned_int,
                                       triangulation.locally_owned_subdomain());
    Vector<double> result(estimate.size());
    for (const auto &cell : space.cells)
      {
        const unsigned int i = cell->active_cell_index();
        result[i]            = Utilities::fixed_power<2>(unit * estimate[i]) *
                    extent(space.scene.plane_model(), cell->center());
      }
    return result;
  }



  template <int dim>
  double
  strain_norm(const AdmissibleSpace<dim> &space,
              const DistributedVector    &ghosted_u)
  {
    const FEValuesExtractors::Vector displacement(0);
    const QMidpoint<dim>             midpoint;
    FEValues<dim>                    values(space.mapping,
                         space.dof_handler.get_fe(),
                         midpoint,
                         update_values | update_gradients | update_JxW_values |
                           update_quadrature_points);
    std::vector<Tensor<1, dim>>      u(1);
    std::vector<Tensor<2, dim>>      gradient(1);
    double                           sum = 0.;
    for (const auto &cell : space.cells)
      {
        values.reinit(cell);
        values[displacement].get_function_values(ghosted_u, u);
        values[displacement].get_function_gradients(ghosted_u, gradient);
        const SymmetricTensor<2, 3> e =
          strain(u[0],
                 gradient[0],
                 values.quadrature_point(0),
                 space.scene.plane_model(),
                 space.axial_strain(ghosted_u.begin()));
        sum += (e * e) * values.JxW(0);
      }
    return std::sqrt(Utilities::MPI::sum(sum, space.communicator));
  }



  template <int dim>
  std::array<double, 2>
  sum_over_cells(const Vector<double>     &values,
                 const Triangulation<dim> &triangulation)
  {
    std::array<double, 2> sums{};
    if (values.size() == 0)
      return sums;
    for (const auto &cell : owned_cells(triangulation))
      {
        const double value = values[cell->active_cell_index()];
        sums[0] += value;
        sums[1] += std::abs(value);
      }
    Utilities::MPI::sum(ArrayView<const double>(sums.data(), 2),
                        triangulation.get_communicator(),
                        ArrayView<double>(sums.data(), 2));
    return sums;
  }



  template <int dim>
  double
  total_estimate(const Vector<double>     &squared_estimate,
                 const Triangulation<dim> &triangulation)
  {
    return std::sqrt(sum_over_cells(squared_estimate, triangulation)[0]);
  }



  VISCOPLASTIC_INSTANTIATE(sum_over_cells);
  VISCOPLASTIC_INSTANTIATE(total_estimate);
  VISCOPLASTIC_INSTANTIATE(strain_norm);
  VISCOPLASTIC_INSTANTIATE(kelly_estimate);
} // namespace Viscoplastic
