// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_layout.h>

#include <vector>

namespace Viscoplastic
{
  /// Whether something happens in a step whose time matters: slip begins where
  /// there was none, comes to cover the face, ends everywhere, or turns back
  /// somewhere (the slip of the step is against that of the step before, with
  /// no rest between); or contact that opens and closes begins, covers its
  /// face, or ends. Points that cannot slip or that slip without friction do
  /// not count.
  ///
  /// @p from_kink: slip may end in this step without being an event, since its
  /// beginning is a known kink of the data. Collective.
  bool
  has_contact_event(const ContactLayout &face,
                    const ContactState  &old_state,
                    const ContactState  &state,
                    const bool           from_kink);

  /// The two errors that a time step makes in the slip of points that slip in
  /// it and in the step before.
  struct SlipDefects
  {
    /// sum of |lambda| |s| (1 - cos theta), with theta the angle between the
    /// multipliers of both steps, or pi/2 if it is larger: how much more work
    /// slip in the old direction would have asked for. And sum of |lambda|
    /// times the slip that `resting' points miss.
    double work = 0.;
    /// The error of each point's slip from taking its direction at the end of
    /// the step instead of the mean of both ends.
    std::vector<Tensor<1, 2>> turning;
    /// Points slow down so fast that they come to rest before the end, where
    /// the step sees them slip. With the rates v_0 > 0 > v_1 of a line through
    /// the mean rate of the step, twice as steep as the one through the mean
    /// rates of both steps, since slip may slow down faster towards its end,
    /// they miss k v_1^2 / (2 (v_0 - v_1)).
    std::vector<Tensor<1, 2>> resting;
    /// The mean slip rate of the step before over that of this step, at most 1.
    double rate_before = 0.;
  };

  /// @p slips: the slip increments of the step, whose size is @p k, after one
  /// of size @p old_k. Collective.
  SlipDefects
  slip_defects(const ContactLayout             &face,
               const ContactState              &old_state,
               const ContactState              &state,
               const std::vector<Tensor<1, 2>> &slips,
               const double                     k,
               const double                     old_k);

  /// Of what slips at the end of a step, the part that has been at rest before,
  /// or has slipped the other way, by bounds. Collective.
  double
  slip_begun(const ContactLayout &face,
             const ContactState  &old_state,
             const ContactState  &state);
} // namespace Viscoplastic
