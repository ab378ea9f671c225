// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_layout.h>

#include <vector>

namespace Viscoplastic
{
  /// Return whether the step contains an event whose time matters: slip begins
  /// where all points stuck, comes to cover all points, ends everywhere, or
  /// reverses at a point without rest in between; or unilateral contact begins,
  /// comes to cover all obstacles, or ends. Glued and frictionless points do
  /// not count.
  ///
  /// @p from_kink: the step starts at a known kink of the data in time, so that
  /// slip or contact that ends, slip that reverses, and contact that begins are
  /// no events. Collective.
  bool
  has_contact_event(const ContactLayout &face,
                    const ContactState  &old_state,
                    const ContactState  &state,
                    const bool           from_kink);

  /// Time discretization errors in the slip of points that slip both in a step
  /// and in the one before it.
  struct SlipDefects
  {
    /// The sum of |lambda| |s| (1 - cos theta), where theta is the angle
    /// between the multipliers of both steps, at most pi/2: the complementarity
    /// defect of friction in its old direction. Plus the sum of |lambda| times
    /// the size of `resting`.
    double work = 0.;
    /// The error in the slip of each point due to taking its direction at the
    /// end of the step instead of the mean of the directions at both ends.
    std::vector<Tensor<1, 2>> turning;
    /// The slip missed by a point that comes to rest before the end of the
    /// step. The slip rate is taken as linear, with the mean rate of the step
    /// and twice the slope of the line through the mean rates of both steps,
    /// since slip may decelerate toward its end. Falling from v_0 > 0 to v_1 <
    /// 0 in the step, it misses k v_1^2 / (2 (v_0 - v_1)).
    std::vector<Tensor<1, 2>> resting;
    /// The mean slip rate of the step before over that of this step, weighted
    /// by |lambda|, over points that do not reverse; at most 1.
    double rate_before = 0.;
  };

  /// Estimate the defects of a step of size @p k with the slip increments @p
  /// slips, by point, after a step of size @p old_k. Collective.
  SlipDefects
  slip_defects(const ContactLayout             &face,
               const ContactState              &old_state,
               const ContactState              &state,
               const std::vector<Tensor<1, 2>> &slips,
               const double                     k,
               const double                     old_k);

  /// Return which part of the slipping points, weighted by bounds, stuck or
  /// slipped the other way in the step before. Collective.
  double
  slip_begun(const ContactLayout &face,
             const ContactState  &old_state,
             const ContactState  &state);
} // namespace Viscoplastic
