// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_layout.h>
#include <viscoplastic_contact/contact/node_forces.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// Coulomb's law with the pressure of the step itself. It supplies what a
  /// contact solver for given bounds needs in addition: a Gauss-Seidel step at
  /// a node, and the change of bounds with the pressure in the linear system of
  /// a Newton step.
  struct CoulombLaw : CoulombCoefficients
  {
    /// The position of a node in words, for messages.
    std::function<std::string(unsigned int)> place;

    /// relax_node() with the bounds of the resulting pressures, which are set
    /// in @p state. Where pieces meet, they are solved in turn, which need not
    /// converge: with @p must_settle, nothing is returned or changed then.
    std::optional<Tensor<1, 3>>
    relax_node(const ContactLayout &face,
               const unsigned int   node,
               const Tensor<2, 3>  &inverse_diagonal,
               const Tensor<1, 3>  &force, // residual + D x
               ContactState        &state,
               bool                 must_settle) const;

    /// Add the matrices I - mu d c^T of nodes that slip to @p truncation, which
    /// make_truncation() has made of the other arguments. A slipping point has
    /// lambda = g d + mu p d, d = s/|s|, with the pressure p = c . r of the
    /// residual r of its node, so that r - mu (c . r) d vanishes in the free
    /// directions but for g d. Here c is the unit normal or, where pieces meet,
    /// a vector of NodeForces::pressures_of_force().
    void
    tilt(const ContactLayout             &face,
         const ContactState              &state,
         const std::vector<Tensor<2, 3>> &inverse_diagonal,
         FaceTruncation                  &truncation,
         double                           stiffest = 1e10) const;

    /// Set bounds to those of the pressures that follow from the node forces @p
    /// residual, at nodes that can move.
    void
    predict_bounds(const ContactLayout  &face,
                   const Vector<double> &residual,
                   ContactState         &state) const;

    /// This law with the coefficients mu_ck multiplied by @p part.
    CoulombLaw
    with_part(double part) const
    {
      CoulombLaw result(*this);
      for (std::vector<double> &coefficients : result.of_pressure)
        for (double &coefficient : coefficients)
          coefficient *= part;
      return result;
    }

    /// The largest sum of coefficients at a point. Collective.
    double
    largest_coefficient(const ContactLayout &face) const;

  private:
    /// The obstacle orthogonal to a friction point whose pressure has the
    /// largest coefficient in its bound; an invalid number if there is none.
    unsigned int
    own_obstacle(const ContactLayout &face, const unsigned int point) const;

    /// The pressure of obstacle @p o if only it and the friction @p point held
    /// their node (coulomb_pressure()).
    double
    own_pressure(const ContactLayout &face,
                 const unsigned int   point,
                 const unsigned int   o,
                 const Tensor<2, 3>  &inverse_diagonal,
                 const Tensor<1, 3>  &force,
                 const ContactState  &state) const;
  };



  /// The problem of a single node on a foundation with Coulomb's law, with
  /// component 0 along the normal and the others along the foundation. Without
  /// contact forces the node has the penetration and slip `free_motion`; forces
  /// f on the foundation reduce them by `flexibility` f.
  struct CoulombNode
  {
    Tensor<2, 3> flexibility;
    Tensor<1, 3> free_motion;
    unsigned int n_tangents;
    /// The bound of friction is `given` + `coefficient` p.
    double                  given, coefficient;
    const NormalCompliance &compliance;
    /// The present normal force of the node; zero without contact.
    double present;
  };

  /// Return the normal force p of the node on the foundation. Friction follows
  /// from p (solve_friction_point()), so p is the root of a scalar function:
  /// the penetration that remains at p minus the one at which the foundation
  /// presses with p. A solution always exists: at p = 0 the node penetrates
  /// unless it is open, and at large p friction holds it. With q the free
  /// motion, W the flexibility and g the given bound, a slipping node in 2D on
  /// a rigid foundation has
  ///
  ///     p = (q_n -+ W_nt g)/(W_nn +- mu W_nt).
  ///
  /// For large mu a node that can be open may also have a solution in contact.
  /// It then keeps its state: touching if it touches at present, otherwise
  /// open.
  double
  coulomb_pressure(const CoulombNode &node);
} // namespace Viscoplastic
