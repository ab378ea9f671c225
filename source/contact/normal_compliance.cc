// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/contact/normal_compliance.h>

#include <algorithm>
#include <limits>

namespace Viscoplastic
{
  using namespace dealii;

  namespace
  {
    /// The root of a convex increasing function at or below @p start, to which
    /// Newton's method descends. The last step removes the rounding of the long
    /// ones. It takes ten iterations at most, whatever the exponents, if no
    /// term at @p start is larger than the sum at the root, as below.
    template <typename Function, typename Derivative>
    double
    root_below(double            start,
               const Function   &function,
               const Derivative &derivative)
    {
      for (unsigned int iteration = 0; iteration < 200; ++iteration)
        {
          const double next = start - function(start) / derivative(start);
          if (!(next > 0. && next < start))
            return next > 0. ? next : start;
          start = next;
        }
      refuse("The penetration of a foundation that gives way cannot be found "
             "for its pressure law.");
      return start;
    }
  } // namespace



  double
  NormalCompliance::penetration(const double p) const
  {
    if (is_rigid() || !(p > 0.))
      return 0.;
    // At the root no piece carries more than p.
    double most = std::numeric_limits<double>::max();
    for (const Piece &piece : pieces)
      most = std::min(most, piece.law.penetration(piece.factor, p));
    return pieces.size() == 1 ? most :
                                root_below(
                                  most,
                                  [&](const double w) { return force(w) - p; },
                                  [&](const double w) { return slope(w); });
  }



  double
  NormalCompliance::stopping_force(const double flexibility,
                                   const double free_w) const
  {
    if (!(free_w > 0.))
      return 0.;
    if (is_rigid())
      return free_w / flexibility;
    // At the root w <= free_w and flexibility p(w) <= free_w.
    return force(root_below(
      std::min(free_w, penetration(free_w / flexibility)),
      [&](const double w) { return w + flexibility * force(w) - free_w; },
      [&](const double w) { return 1. + flexibility * slope(w); }));
  }



  double
  NormalCompliance::defect(const double w, const double p) const
  {
    const double there = penetration(p);
    return 0.5 * std::max(slope(w), slope(there)) * (w - there) * (w - there);
  }
} // namespace Viscoplastic
