// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/scene/quantity_of_interest.h>

#include <array>
#include <vector>

namespace Viscoplastic
{
  /// The part of the discretization error of a quantity of interest that comes
  /// from the boundary (interpolated data, faces opposite each other), which no
  /// residual contains. Constructed once a mesh; nothing is computed in scenes
  /// without it.
  template <int dim>
  class BoundaryDefects
  {
  public:
    /// @p discretization stays in use. Collective.
    explicit BoundaryDefects(const Discretization<dim> &discretization);

    /// What straight sides of cells do where the body is curved, by active
    /// cell, with the dual solution w: over the volume between the sides and
    /// the manifold, and with the loads f where they belong, the equations miss
    ///
    ///     int b . w - sigma : eps(w)
    ///         + int_curved f . w - int_straight f . w.
    ///
    /// Their sum is the error to leading order. Of meshes from files it is
    /// zero: they are the geometry. Empty where no side is curved.
    Vector<double>
    missing_sides(const State<dim>        &state,
                  const DistributedVector &ghosted_w) const;

    /// The friction that is missing where other conditions hold nodes on
    /// Gamma_3, by active cell: these have no friction point in that direction,
    /// and what holds them carries their part of the face. Along a foundation
    /// that slides beneath them it is the bound times the part of the slip in
    /// that direction, for the work of friction times the slip. At rest, as on
    /// a plane of symmetry, a friction force has there what acts on the nodes
    /// beside it that slip. Empty where no node is held. Collective.
    Vector<double>
    held_friction(const State<dim>         &state,
                  const QuantityOfInterest &quantity,
                  const DistributedVector  &ghosted_w) const;

  private:
    /// A quadrature point of a straight side, and where it is on the manifold.
    struct SidePoint
    {
      std::size_t                   cell; // of the owned ones
      const BoundaryCondition<dim> *condition;
      std::array<Point<dim>, 2>     x; // straight, curved
      std::array<Tensor<1, dim>, 2> normal;
      std::array<double, 2>         weight;
      /// The shape functions of the vertices and their gradients.
      std::array<double, (1u << dim)>         shape;
      std::array<Tensor<1, dim>, (1u << dim)> gradient;
    };

    /// The part of a face that a held node stands for.
    struct HeldNode
    {
      unsigned int                  active_cell;
      std::size_t                   first; // entry among the relevant ones
      Point<dim>                    position;
      double                        area;
      const BoundaryCondition<dim> *condition;
      Tensor<1, dim>                normal;
      /// Projects on the tangential directions in which it is held.
      Tensor<2, dim> held;
      /// The first entries of the vertices of the face.
      std::vector<std::size_t> vertices;
    };

    void
    find_sides();
    void
    find_held_nodes();

    const Discretization<dim> &discretization;
    std::vector<SidePoint>     side_points;
    std::vector<HeldNode>      held_nodes;
    /// Whether any rank has them.
    bool any_sides, any_held_nodes;
  };
} // namespace Viscoplastic
