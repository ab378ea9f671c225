// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/results/boundary_fields.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace Viscoplastic
{
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
    pieces_of_cells(const OutputIntegral &integral) const;

    /// What the pieces store, and have dissipated.
    std::array<double, 2>
    energies(const std::vector<Piece> &cells,
             const State<dim>         &old,
             const State<dim>         &state) const;

    std::vector<Piece>
    pieces_of_faces(const OutputIntegral &integral) const;

    const Discretization<dim>      &discretization;
    std::vector<std::string>        all_names;
    std::vector<bool>               is_dissipation;
    std::vector<std::vector<Piece>> pieces; // an integral
    /// The strain within cells, for their elastic energy; null unless needed.
    std::unique_ptr<const StressSpace<dim>> points;
  };
} // namespace Viscoplastic
