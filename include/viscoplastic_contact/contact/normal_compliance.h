// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/laws/contact_laws.h>

#include <vector>

namespace Viscoplastic
{
  /// A foundation that gives way at a node: the force p(w), the sum of those of
  /// the pieces that meet there, at the penetration w = u_n - g.
  class NormalCompliance
  {
  public:
    /// Add a piece that presses by @p law with k = @p factor, the integral of
    /// that of the law times the basis function of the node.
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

    /// The penetration at a force p > 0.
    double
    penetration(const double p) const;

    /// The penetration w with w = @p free_w - @p flexibility p(w), for a
    /// penetration @p free_w > 0 without contact force.
    double
    penetration(const double flexibility, const double free_w) const;

    /// A bound on energy(w) + its conjugate at @p p - p w >= 0, which is zero
    /// for p = force(w): what it costs to take another force p >= 0 for the one
    /// at w > 0. (The integral of p(x) - p from where p is the force to w.)
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
