// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// A plain implementation of the residual estimator by FEInterfaceValues on
// every face, with which ResidualEstimator has to agree.

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_interface_values.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/grid/grid_tools.h>

#include <viscoplastic_contact/discretization/stress_space.h>
#include <viscoplastic_contact/mesh/cell_order.h>

#include <vector>

namespace Viscoplastic::Testing
{
  template <int dim>
  using Cell = typename DoFHandler<dim>::active_cell_iterator;

  const FEValuesExtractors::Vector displacement(0);



  /// The strain of a displacement gradient, under mean dilatation with the
  /// trace @p dilatation.
  template <int dim>
  SymmetricTensor<2, 3>
  strain(const Tensor<2, dim> &gradient,
         const bool            mean_dilatation,
         const double          dilatation)
  {
    SymmetricTensor<2, 3> result;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = i; j < dim; ++j)
        result[i][j] = 0.5 * (gradient[i][j] + gradient[j][i]);
    if (mean_dilatation)
      {
        const double change = (dilatation - trace(result)) / 3.;
        for (unsigned int d = 0; d < 3; ++d)
          result[d][d] += change;
      }
    return result;
  }



  /**
   * sigma_h = E eps(u_h) + z_h anywhere in owned cells and ghosts, whose z_h
   * comes from their owners.
   */
  template <int dim>
  class StressField
  {
  public:
    StressField(const StressSpace<dim>   &stress_space,
                const DistributedVector  &ghosted_u,
                const IrreversibleStress &z);

    const Stiffness &
    stiffness(const Cell<dim> &cell) const
    {
      return data[cell->active_cell_index()].stiffness;
    }

    /// sigma_h nu at the points of @p fe_face, a face of @p cell.
    void
    tractions(const Cell<dim>                   &cell,
              const FEFaceValuesBase<dim>       &fe_face,
              const std::vector<Tensor<1, dim>> &normals,
              std::vector<Tensor<1, dim>>       &result) const;

  private:
    struct CellData
    {
      Stiffness             stiffness;
      double                dilatation; // cell mean of div u_h
      SymmetricTensor<2, 3> z;
    };

    const bool               mean_dilatation;
    const DistributedVector &u;
    std::vector<CellData>    data; // by active cell index
  };



  template <int dim>
  StressField<dim>::StressField(const StressSpace<dim>   &stress_space,
                                const DistributedVector  &ghosted_u,
                                const IrreversibleStress &z)
    : mean_dilatation(stress_space.mean_dilatation)
    , u(ghosted_u)
    , data(stress_space.space.dof_handler.get_triangulation().n_active_cells(),
           CellData{Stiffness::isotropic(1., 0.), 0., {}})
  {
    const AdmissibleSpace<dim> &space       = stress_space.space;
    const DoFHandler<dim>      &dof_handler = space.dof_handler;

    FEValues<dim>       fe_values(dof_handler.get_fe(),
                            QGauss<dim>(2),
                            update_gradients | update_JxW_values);
    std::vector<double> divergences(fe_values.n_quadrature_points);
    std::size_t         index = 0;
    auto                cells = space.cells;
    for (const auto &cell : ghost_cells(dof_handler))
      cells.push_back(cell);
    for (const auto &cell : cells)
      {
        CellData &here = data[cell->active_cell_index()];
        if (mean_dilatation)
          {
            fe_values.reinit(cell);
            fe_values[displacement].get_function_divergences(u, divergences);
            double volume = 0.;
            for (const unsigned int q : fe_values.quadrature_point_indices())
              {
                here.dilatation += divergences[q] * fe_values.JxW(q);
                volume += fe_values.JxW(q);
              }
            here.dilatation /= volume;
          }
        if (cell->is_locally_owned())
          {
            here.stiffness = stress_space.moduli(index);
            if (!z.empty())
              here.z =
                stress_space.mean(index, &z[index * stress_space.n_samples]);
            ++index;
          }
        else
          here.stiffness =
            space.scene.material(cell->material_id()).stiffness(cell->center());
      }

    // There is z if any rank has it; a rank without cells never does.
    if (Utilities::MPI::max(z.empty() ? 0 : 1, space.communicator) == 1)
      GridTools::exchange_cell_data_to_ghosts<SymmetricTensor<2, 3>,
                                              DoFHandler<dim>>(
        dof_handler,
        [this](const Cell<dim> &cell) {
          return std_cxx17::optional<SymmetricTensor<2, 3>>(
            data[cell->active_cell_index()].z);
        },
        [this](const Cell<dim> &cell, const SymmetricTensor<2, 3> &mean) {
          data[cell->active_cell_index()].z = mean;
        });
  }



  template <int dim>
  void
  StressField<dim>::tractions(const Cell<dim>                   &cell,
                              const FEFaceValuesBase<dim>       &fe_face,
                              const std::vector<Tensor<1, dim>> &normals,
                              std::vector<Tensor<1, dim>>       &result) const
  {
    const CellData             &here = data[cell->active_cell_index()];
    std::vector<Tensor<2, dim>> gradients(fe_face.n_quadrature_points);
    fe_face[displacement].get_function_gradients(u, gradients);
    for (unsigned int q = 0; q < gradients.size(); ++q)
      {
        const SymmetricTensor<2, 3> stress =
          here.stiffness.stress(
            strain(gradients[q], mean_dilatation, here.dilatation)) +
          here.z;
        for (unsigned int i = 0; i < dim; ++i)
          {
            result[q][i] = 0.;
            for (unsigned int j = 0; j < dim; ++j)
              result[q][i] += stress[i][j] * normals[q][j];
          }
      }
  }



  /// r . M^-1 r with the acoustic tensor M = nu . E . nu, whose k-th column is
  /// the traction of the symmetric product of e_k and nu.
  template <int dim>
  double
  compliance_square(const Stiffness      &stiffness,
                    const Tensor<1, dim> &normal,
                    const Tensor<1, dim> &r)
  {
    Tensor<2, dim> acoustic;
    for (unsigned int k = 0; k < dim; ++k)
      {
        Tensor<2, dim> gradient;
        gradient[k] = normal;
        const SymmetricTensor<2, 3> stress =
          stiffness.stress(strain(gradient, /* mean_dilatation = */ false, 0.));
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            acoustic[i][k] += stress[i][j] * normal[j];
      }
    return r * (invert(acoustic) * r);
  }



  /// The residual of @p traction = sigma nu at a boundary point: zero in the
  /// directions in which u is prescribed.
  template <int dim>
  Tensor<1, dim>
  boundary_residual(const BoundaryCondition<dim> &condition,
                    const Point<dim>             &x,
                    const Tensor<1, dim>         &outward_normal,
                    const double                  t,
                    const Tensor<1, dim>         &traction,
                    const Tensor<1, dim>         &multiplier_density)
  {
    const auto tangential = [&condition](const Tensor<1, dim> &v) {
      return v - (v * condition.normal) * condition.normal;
    };
    Tensor<1, dim> residual;
    switch (condition.role)
      {
        case BoundaryRole::not_given:
        case BoundaryRole::clamped:
          break;
        case BoundaryRole::displacement:
          residual = traction - condition.load(x, outward_normal, t);
          for (unsigned int d = 0; d < dim; ++d)
            if (condition.displacement[d])
              residual[d] = 0.;
          break;
        case BoundaryRole::traction:
        case BoundaryRole::free:
          residual = traction - condition.load(x, outward_normal, t);
          break;
        case BoundaryRole::symmetry:
          residual = tangential(traction);
          break;
        case BoundaryRole::contact:
          if (condition.is_glued())
            break;
          residual = tangential(traction + multiplier_density);
          if (condition.has_given_stress())
            residual += (traction * condition.normal -
                         condition.normal_stress->value(x, t)) *
                        condition.normal;
          break;
      }
    return residual;
  }


  template <int dim>
  Vector<double>
  plain_residual_estimate(const StressSpace<dim>   &stress_space,
                          const DistributedVector  &ghosted_u,
                          const IrreversibleStress &z,
                          const double              t,
                          const DistributedVector  *multiplier_density)
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    const Scene<dim>           &scene = space.scene;
    const FiniteElement<dim>   &fe    = space.dof_handler.get_fe();
    const StressField<dim>      stress(stress_space, ghosted_u, z);
    Vector<double>              estimate(
      space.dof_handler.get_triangulation().n_active_cells());

    FEValues<dim>          fe_values(fe, QGauss<dim>(2), update_JxW_values);
    FEInterfaceValues<dim> interface_values(fe,
                                            QGauss<dim - 1>(2),
                                            update_gradients |
                                              update_JxW_values |
                                              update_normal_vectors);
    FEFaceValues<dim>      face_values(fe,
                                  QGauss<dim - 1>(2),
                                  update_values | update_gradients |
                                    update_JxW_values | update_normal_vectors |
                                    update_quadrature_points);

    std::vector<Tensor<1, dim>> traction(face_values.n_quadrature_points),
      neighbor_traction(face_values.n_quadrature_points),
      density(face_values.n_quadrature_points);

    const auto volume = [&](const Cell<dim> &cell) {
      fe_values.reinit(cell);
      double result = 0.;
      for (const double weight : fe_values.get_JxW_values())
        result += weight;
      return result;
    };

    const auto add_boundary_face = [&](const Cell<dim>   &cell,
                                       const unsigned int f) {
      const BoundaryCondition<dim> &condition =
        scene.boundary.at(cell->face(f)->boundary_id());
      if (condition.role == BoundaryRole::clamped)
        return;
      face_values.reinit(cell, f);
      stress.tractions(cell,
                       face_values,
                       face_values.get_normal_vectors(),
                       traction);
      if (condition.has_friction())
        {
          Assert(multiplier_density != nullptr,
                 ExcMessage("A scene with friction has multipliers."));
          face_values[displacement].get_function_values(*multiplier_density,
                                                        density);
        }
      else
        density.assign(density.size(), Tensor<1, dim>());
      double square = 0., area = 0.;
      for (const unsigned int q : face_values.quadrature_point_indices())
        {
          // Nodal multipliers respect nodal bounds; between nodes the density
          // exceeds a bound that jumps.
          if (condition.has_friction())
            {
              const Tensor<1, dim> tangential =
                density[q] - (density[q] * condition.normal) * condition.normal;
              const double excess =
                tangential.norm() -
                condition.bound(face_values.quadrature_point(q), t);
              if (excess > 0.)
                square +=
                  2. * excess * excess * face_values.JxW(q) /
                  stress.stiffness(cell).smallest_deviatoric_eigenvalue();
            }
          square +=
            compliance_square(stress.stiffness(cell),
                              face_values.normal_vector(q),
                              boundary_residual(condition,
                                                face_values.quadrature_point(q),
                                                face_values.normal_vector(q),
                                                t,
                                                traction[q],
                                                density[q])) *
            face_values.JxW(q);
          area += face_values.JxW(q);
        }
      estimate[cell->active_cell_index()] += volume(cell) / area * square / 6.;
    };

    // Face and subface numbers as in FEInterfaceValues::reinit().
    const auto add_jump = [&](const Cell<dim>   &cell,
                              const unsigned int f,
                              const unsigned int subface,
                              const Cell<dim>   &neighbor,
                              const unsigned int neighbor_f,
                              const unsigned int neighbor_subface) {
      interface_values.reinit(
        cell, f, subface, neighbor, neighbor_f, neighbor_subface);
      const auto &normals = interface_values.get_normal_vectors();
      stress.tractions(cell,
                       interface_values.get_fe_face_values(0),
                       normals,
                       traction);
      stress.tractions(neighbor,
                       interface_values.get_fe_face_values(1),
                       normals,
                       neighbor_traction);
      // The width of a coarse cell across a subface is that across the whole
      // face.
      double area = 0.;
      for (const double weight : interface_values.get_JxW_values())
        area += weight;
      const std::array<std::pair<Cell<dim>, unsigned int>, 2> sides{
        {{cell, subface}, {neighbor, neighbor_subface}}};
      for (const auto &[side, part] : sides)
        if (side->is_locally_owned())
          {
            double square = 0.;
            for (unsigned int q = 0; q < traction.size(); ++q)
              square += compliance_square(stress.stiffness(side),
                                          normals[q],
                                          traction[q] - neighbor_traction[q]) *
                        interface_values.JxW(q);
            const bool is_whole = part == numbers::invalid_unsigned_int;
            estimate[side->active_cell_index()] +=
              volume(side) / (is_whole ? area : area * (1u << (dim - 1))) *
              square / 24.;
          }
    };

    // Faces between owned cells are visited once: from the finer side, or from
    // the cell that comes first.
    constexpr unsigned int whole = numbers::invalid_unsigned_int;
    for (const auto &cell : space.dof_handler.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          for (const unsigned int f : cell->face_indices())
            if (cell->at_boundary(f))
              add_boundary_face(cell, f);
            else if (cell->face(f)->has_children())
              {
                for (unsigned int s = 0; s < cell->face(f)->n_children(); ++s)
                  {
                    const Cell<dim> child =
                      cell->neighbor_child_on_subface(f, s);
                    if (!child->is_locally_owned())
                      add_jump(cell,
                               f,
                               s,
                               child,
                               cell->neighbor_of_neighbor(f),
                               whole);
                  }
              }
            else if (cell->neighbor_is_coarser(f))
              {
                const auto [neighbor_f, subface] =
                  cell->neighbor_of_coarser_neighbor(f);
                add_jump(
                  cell, f, whole, cell->neighbor(f), neighbor_f, subface);
              }
            else
              {
                const Cell<dim> neighbor = cell->neighbor(f);
                if (!neighbor->is_locally_owned() ||
                    cell->index() < neighbor->index())
                  add_jump(cell,
                           f,
                           whole,
                           neighbor,
                           cell->neighbor_of_neighbor(f),
                           whole);
              }
        }

    return estimate;
  }
} // namespace Viscoplastic::Testing
