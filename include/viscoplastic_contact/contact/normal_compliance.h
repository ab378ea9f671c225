// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/laws/contact_laws.h>

#include <vector>

namespace Viscoplastic
{
  /// Normal compliance of the foundation at a node: the force p(w) at the
  /// penetration w = u_n - g, summed over the pieces that meet there.
  class NormalCompliance
  {
  public:
    /// Add a piece with the pressure law @p law and k = @p factor, the integral
    /// of the coefficient of the law times the basis function of the node.
    void
    add(const double factor, const PressureLaw &law)
    {
      pieces.push_back({factor, law});
    }

    /// Whether the obstacle is rigid: no compliant piece has been added.
    bool
    is_rigid() const
    {
      return pieces.empty();
    }

    double
    force(const double w) const
    {
      double sum = 0.;
      if (w > 0.)
        for (const Piece &piece : pieces)
          sum += piece.law.force(piece.factor, w);
      return sum;
    }

    /// p'(w) in force per length.
    double
    slope(const double w) const
    {
      double sum = 0.;
      if (w > 0.)
        for (const Piece &piece : pieces)
          sum += piece.law.slope(piece.factor, w);
      return sum;
    }

    /// The energy int_0^w p.
    double
    energy(const double w) const
    {
      double sum = 0.;
      if (w > 0.)
        for (const Piece &piece : pieces)
          sum += piece.law.energy(piece.factor, w);
      return sum;
    }

    /// The penetration at a force p; zero without force or compliance.
    double
    penetration(const double p) const;

    /// The force at which the obstacle, also a rigid one, stops a node that
    /// would penetrate by @p free_w without it, and by @p flexibility less for
    /// each unit of force: p(w) with w = @p free_w - @p flexibility p(w).
    double
    stopping_force(const double flexibility, const double free_w) const;

    /// A bound on the complementarity defect Phi(w) + Phi*(p) - p w >= 0 of a
    /// force @p p >= 0 at @p w > 0, with Phi = energy() and its conjugate Phi*;
    /// zero for p = force(w). (The defect is the integral of force(x) - p over
    /// x from penetration(p) to w.)
    double
    defect(const double w, const double p) const;

  private:
    struct Piece
    {
      double      factor;
      PressureLaw law;
    };
    std::vector<Piece> pieces;
  };
} // namespace Viscoplastic
