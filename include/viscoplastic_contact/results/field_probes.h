// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/mesh/point_location.h>
#include <viscoplastic_contact/results/boundary_fields.h>

#include <array>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// Fields at some points of the body, on one mesh, as the outputs have them:
  /// a field that is constant in cells is that of the cell that locate_points()
  /// gives. Fields of the boundary are known at points on Gamma_3.
  template <int dim>
  class FieldProbes
  {
  public:
    /// @p discretization stays in use. Collective.
    FieldProbes(const Discretization<dim>     &discretization,
                const std::vector<Point<dim>> &points,
                const std::set<RecordedField> &fields);

    /// The names of the values; those from n_of_body() on are fields of the
    /// boundary.
    const std::vector<std::string> &
    names() const
    {
      return all_names;
    }

    std::size_t
    n_of_body() const
    {
      return n_body;
    }

    /// Whether a point is on Gamma_3; false if no field of the boundary is
    /// asked for.
    bool
    is_on_contact(const std::size_t point) const
    {
      return is_on_face[point];
    }

    /// The values at one point after the other, on all ranks; nan for fields of
    /// the boundary at points that are not on Gamma_3, and for those of the
    /// body at points in an absent material. Collective.
    std::vector<double>
    values(const State<dim> &state) const;

  private:
    const Discretization<dim>    &discretization;
    const std::set<RecordedField> fields;
    std::vector<std::string>      all_names;
    std::size_t                   n_body;
    /// The places of the points among the cells of the body, and among the
    /// faces of Gamma_3.
    std::vector<CellPoint<dim>> in_body, on_face;
    std::vector<bool>           is_on_face;
    /// The points that only cells of absent materials hold.
    std::vector<std::size_t> absent_points;
  };



  /// The integrals of `Output/Integrals' on one mesh, over the undeformed body:
  /// for each boundary or material first its area or volume, then its fields,
  /// then its energies.
  template <int dim>
  class FieldIntegrals
  {
  public:
    /// @p discretization stays in use. Collective.
    explicit FieldIntegrals(const Discretization<dim> &discretization);

    /// The names of the values: area_boundary_3,
    /// integral_boundary_3_displacement_x, ...
    const std::vector<std::string> &
    names() const
    {
      return all_names;
    }

    /// After a step from @p old, which may be the same state, on all ranks.
    /// What has been dissipated is that of the step alone. Collective.
    std::vector<double>
    values(const State<dim> &old, const State<dim> &state) const;

    /// The physical quantity of a value.
    Quantity
    quantity(const std::size_t value) const
    {
      return quantities[value];
    }

    /// Whether a value is to be summed over the steps.
    bool
    is_of_step(const std::size_t value) const
    {
      return is_dissipation[value];
    }

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

    /// What the pieces store, and have dissipated.
    std::array<double, 2>
    energies(const std::vector<Piece> &cells,
             const State<dim>         &old,
             const State<dim>         &state) const;


    const Discretization<dim>      &discretization;
    std::vector<std::string>        all_names;
    std::vector<Quantity>           quantities; // of the names
    std::vector<bool>               is_dissipation;
    std::vector<std::vector<Piece>> pieces; // an integral
    /// The strain within cells, for their elastic energy; null unless needed.
    std::unique_ptr<const StressSpace<dim>> points;
  };
} // namespace Viscoplastic
