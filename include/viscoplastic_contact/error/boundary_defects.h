// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/scene/quantity_of_interest.h>

#include <array>
#include <optional>
#include <vector>

namespace Viscoplastic
{
  /// Errors of a quantity of interest at the boundary that no residual
  /// contains: straight sides of cells where the body is curved, friction
  /// missing where other conditions hold nodes on Gamma_3, and friction bounds
  /// that vary within faces by more than their quadrature sees. Constructed
  /// once per mesh; does no work in scenes without these.
  template <int dim>
  class BoundaryDefects
  {
  public:
    /// Keeps a reference to @p discretization. Collective.
    explicit BoundaryDefects(const Discretization<dim> &discretization);

    /// Return the error by straight sides of cells where the body is curved, by
    /// active cell, for the dual solution w: the volume between the sides and
    /// the manifold, and loads f on the manifold, contribute
    ///
    ///     int b . w - sigma : eps(w)
    ///         + int_curved f . w - int_straight f . w.
    ///
    /// The sum over all cells is the error to leading order. It is zero for
    /// meshes from files, which are the geometry. Empty if no side is curved.
    Vector<double>
    missing_sides(const State<dim>        &state,
                  const DistributedVector &ghosted_w) const;

    /// Return the size of the error by friction missing where other conditions
    /// hold nodes on Gamma_3, by active cell: such nodes have no friction point
    /// in the held directions. If the foundation slides beneath a node, the
    /// missing force is the friction bound times the held part of the slip
    /// direction; it counts times the held slip for the work of friction, and
    /// times w for others. At a node at rest, as on a plane of symmetry, a
    /// friction force misses what acts on slipping nodes beside it. Empty if no
    /// node is held. Collective.
    Vector<double>
    held_friction(const State<dim>         &state,
                  const QuantityOfInterest &quantity,
                  const DistributedVector  &ghosted_w) const;

    /// Return the error by the quadrature of friction bounds, by active cell,
    /// as by a bound that jumps within a face: the change of the bounds by a
    /// composite rule, times @p change_by_bounds, the change of the quantity
    /// per unit of the bound of each point. Empty if no bound depends on
    /// position. Collective.
    Vector<double>
    unresolved_bounds(const State<dim>          &state,
                      const std::vector<double> &change_by_bounds) const;

    bool
    has_varying_bounds() const
    {
      return any_varying_bounds;
    }

  private:
    /// A quadrature point of a straight side and its image on the manifold.
    struct SidePoint
    {
      std::size_t                   cell; // index of the owned cell
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
      std::size_t                   first; // of its relevant dofs
      Point<dim>                    position;
      double                        area;
      const BoundaryCondition<dim> *condition;
      Tensor<1, dim>                normal;
      /// Projects on the tangential directions in which the node is held.
      Tensor<2, dim> held;
      /// The first relevant dofs of the face's vertices.
      std::vector<std::size_t> vertices;
    };

    /// The change of int f phi at a vertex of a face, by a composite rule, for
    /// f = BoundaryCondition::bound() and f = friction_coefficient().
    struct ChangeOfBound
    {
      unsigned int                  active_cell;
      std::size_t                   first; // of the vertex's relevant dofs
      const BoundaryCondition<dim> *condition;
      double                        bound, coefficient;
    };

    void
    find_sides();
    void
    find_held_nodes();

    /// Return the changes at time t that are more than rounding.
    std::vector<ChangeOfBound>
    changes_of_bounds(const double t) const;

    const Discretization<dim> &discretization;
    std::vector<SidePoint>     side_points;
    std::vector<HeldNode>      held_nodes;
    /// Those at any time, if friction depends on position alone.
    std::optional<std::vector<ChangeOfBound>> constant_changes;
    /// Whether any rank has side points or held nodes.
    bool any_sides, any_held_nodes;
    /// Whether some friction bound depends on position.
    bool any_varying_bounds = false;
  };
} // namespace Viscoplastic
