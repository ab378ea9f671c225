// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/mesh/point_location.h>
#include <viscoplastic_contact/results/boundary_fields.h>
#include <viscoplastic_contact/results/unit_labels.h>

#include <array>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// Fields at some points of the body, on one mesh, as in the output: a field
  /// of cell means is that of the cell found by locate_points(). Fields of the
  /// boundary have values at points on Gamma_3.
  template <int dim>
  class FieldProbes
  {
  public:
    /// Keeps a reference to @p discretization. Collective.
    FieldProbes(const Discretization<dim>     &discretization,
                const std::vector<Point<dim>> &points,
                const std::set<RecordedField> &fields);

    /// What the values are; those from n_of_body() on are fields of the
    /// boundary.
    const std::vector<FieldColumn> &
    columns() const
    {
      return all_columns;
    }

    std::size_t
    n_of_body() const
    {
      return n_body;
    }

    /// Whether a point is on Gamma_3; false if no field of the boundary is
    /// requested.
    bool
    is_on_contact(const std::size_t point) const
    {
      return is_on_face[point];
    }

    /// The values at all points, point by point, on all ranks; NaN for fields
    /// of the boundary at points that are not on Gamma_3, and for fields of the
    /// body at points in absent materials. Collective.
    std::vector<double>
    values(const State<dim> &state) const;

  private:
    const Discretization<dim>    &discretization;
    const std::set<RecordedField> fields;
    std::vector<FieldColumn>      all_columns;
    std::size_t                   n_body;
    /// The points in cells of the body, and on faces of Gamma_3.
    std::vector<CellPoint<dim>> in_body, on_face;
    std::vector<bool>           is_on_face;
  };



  /// The integrals of `Output/Integrals' on one mesh, over the undeformed body:
  /// for each boundary or material its area or volume, then its fields, then
  /// its energies.
  template <int dim>
  class FieldIntegrals
  {
  public:
    /// Keeps a reference to @p discretization. Collective.
    explicit FieldIntegrals(const Discretization<dim> &discretization);

    /// A value: area_boundary_3, integral_boundary_3_displacement_x, ...
    struct Column
    {
      std::string name;
      Quantity    quantity;
      /// Whether it belongs to a step and is to be summed over steps.
      bool is_of_step;
    };

    const std::vector<Column> &
    columns() const
    {
      return all_columns;
    }

    /// The values after a step from @p old, which may be @p state, on all
    /// ranks. Dissipation is that of this step alone. Collective.
    std::vector<double>
    values(const State<dim> &old, const State<dim> &state) const;

  private:
    /// An owned cell, or one of its faces, with the integrals of the shape
    /// functions over it.
    struct Piece
    {
      std::size_t        cell;
      unsigned int       face;
      VertexWeights<dim> weights;
      /// The mean of the outward unit normal of a face; zero for cells.
      Tensor<1, dim> normal;
    };

    std::vector<Piece>
    pieces_of(const OutputIntegral &integral) const;

    /// The energies stored and dissipated in the given cells.
    std::array<double, 2>
    energies(const std::vector<Piece> &cells,
             const State<dim>         &old,
             const State<dim>         &state) const;


    const Discretization<dim>      &discretization;
    std::vector<Column>             all_columns;
    std::vector<std::vector<Piece>> pieces; // by integral
    /// For strains at quadrature points; null unless energies are requested.
    std::unique_ptr<const StressSpace<dim>> points;
  };
} // namespace Viscoplastic
