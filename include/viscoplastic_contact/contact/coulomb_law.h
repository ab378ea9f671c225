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
  /// Coulomb's law with the pressure of the step itself. What is here makes a
  /// solver of given bounds one of this law: a Gauss-Seidel step at a node, and
  /// how the linear system of a Newton step knows that bounds change with the
  /// pressure.
  struct CoulombLaw : CoulombCoefficients
  {
    /// The position of a node in words, for messages.
    std::function<std::string(unsigned int)> place;

    /// relax_node() with the bounds of the pressures that come out, which are
    /// set. Where pieces meet, one after the other obeys the law, again and
    /// again, which need not settle: if it @p must_settle, then nothing comes
    /// out, and the state stays.
    std::optional<Tensor<1, 3>>
    relax_node(const ContactLayout &face,
               const unsigned int   node,
               const Tensor<2, 3>  &inverse_diagonal,
               const Tensor<1, 3>  &force, // residual + D x
               ContactState        &state,
               bool                 must_settle) const;

    /// A slipping point has lambda = g d + mu p d, d = s/|s|, with the pressure
    /// p = c . r of the same equation: of the residual r of its node, what
    /// r - mu (c . r) d leaves is zero in the directions that are free (c is
    /// the unit normal; where pieces meet, NodeForces has it). Adds the
    /// matrices I - mu d c^T of such nodes to @p truncation, which
    /// make_truncation() has made of the other arguments.
    void
    tilt(const ContactLayout             &face,
         const ContactState              &state,
         const std::vector<Tensor<2, 3>> &inverse_diagonal,
         FaceTruncation                  &truncation,
         double                           stiffest = 1e10) const;

    /// Let bounds be those of the pressures in the nodes' forces @p residual,
    /// wherever nodes can move.
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
    /// The obstacle whose pressure most of a point's bound follows, across it;
    /// an invalid number if there is none.
    unsigned int
    own_obstacle(const ContactLayout &face, const unsigned int point) const;

    /// The pressure of this obstacle @p o of @p point if it alone held the node
    /// with it (coulomb_pressure()).
    double
    own_pressure(const ContactLayout &face,
                 const unsigned int   point,
                 const unsigned int   o,
                 const Tensor<2, 3>  &inverse_diagonal,
                 const Tensor<1, 3>  &force,
                 const ContactState  &state) const;
  };



  /// A node by itself on a foundation with Coulomb's law: without contact it
  /// would move by `free_motion`, first along the normal of the foundation as
  /// far as it is beyond it, then along it; forces against these motions take
  /// `flexibility` times as much of it.
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

  /// The force p of the node on the foundation. Friction of a given p is known
  /// in closed form (solve_friction_point()); then p is the root of a scalar
  /// function, the penetration that is left at p less that at which the
  /// foundation presses by p. There is always a solution: for p = 0 the node is
  /// beyond the foundation if it is not open, and where p is large friction
  /// holds it. In 2D on a rigid foundation the root of slip is
  ///
  ///     p = (q_n -+ W_nt g)/(W_nn +- mu W_nt).
  ///
  /// For a large mu a node that could be open may be held, or slip, as well.
  /// Then it stays what it is: touching if it touches now, otherwise open.
  double
  coulomb_pressure(const CoulombNode &node);
} // namespace Viscoplastic
