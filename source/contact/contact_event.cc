// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/contact/contact_event.h>

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  bool
  has_contact_event(const ContactLayout &face,
                    const ContactState  &old_state,
                    const ContactState  &state,
                    const bool           from_kink)
  {
    // Whether slip or contact begins, comes to cover all points, or ends.
    const auto has_event_of = [&](double n_points, double n_old, double n_new) {
      n_points          = face.sum(n_points);
      n_old             = face.sum(n_old);
      n_new             = face.sum(n_new);
      const bool begins = n_old == 0. && n_new > 0.,
                 covers =
                   n_old < n_points && n_new == n_points && n_points > 0.,
                 ends = n_old > 0. && n_new == 0.;
      return begins || covers || (ends && !from_kink);
    };
    double n_points = 0., n_old = 0., n_new = 0., n_obstacles = 0.,
           n_old_touch = 0., n_touch = 0.;
    bool turns_back = false;
    for (const unsigned int o : face.obstacles())
      {
        ++n_obstacles;
        n_old_touch += old_state.multiplier[o][0] > 0.;
        n_touch += state.multiplier[o][0] > 0.;
      }
    for (const unsigned int p : face.friction_points())
      if (state.bound[p] > 0. && std::isfinite(state.bound[p]))
        {
          const bool slipped = !old_state.sticks[p], slips = !state.sticks[p];
          ++n_points;
          n_old += slipped;
          n_new += slips;
          // Multipliers are parallel to the slip. In 3D a turn by less than a
          // right angle is no reversal.
          turns_back |= slipped && slips && !from_kink &&
                        old_state.multiplier[p] * state.multiplier[p] < 0.;
        }
    const bool of_slip    = has_event_of(n_points, n_old, n_new),
               of_contact = face.has_obstacles &&
                            has_event_of(n_obstacles, n_old_touch, n_touch) &&
                            !(from_kink && face.sum(n_old_touch) == 0.);
    return face.any(turns_back) || of_slip || of_contact;
  }



  SlipDefects
  slip_defects(const ContactLayout             &face,
               const ContactState              &old_state,
               const ContactState              &state,
               const std::vector<Tensor<1, 2>> &slips,
               const double                     k,
               const double                     old_k)
  {
    AssertDimension(slips.size(), state.n_points());
    SlipDefects defects{0.,
                        std::vector<Tensor<1, 2>>(slips.size()),
                        std::vector<Tensor<1, 2>>(slips.size())};
    double      power = 0., old_power = 0.;
    for (const unsigned int p : face.friction_points())
      {
        const Tensor<1, 2> &old = old_state.multiplier[p],
                           &now = state.multiplier[p];
        const double force      = stable_norm(now);
        if (old_state.sticks[p] || state.sticks[p] || force == 0. ||
            stable_norm(old) == 0.)
          continue;
        const Tensor<1, 2> direction = now / force,
                           turn      = direction - old / stable_norm(old);
        const double slip            = stable_norm(slips[p]);
        // In 2D slip can only reverse, and does so through rest.
        if (face.points[p].n_tangents > 1)
          {
            defects.work += force * slip * std::min(0.5 * turn * turn, 1.);
            defects.turning[p] = 0.5 * slip * turn;
          }
        const double rate     = slip / k,
                     old_rate = stable_norm(old_state.slip[p]) / old_k,
                     slope    = 2. * (rate - old_rate) * k / (k + old_k),
                     last     = rate + slope;
        if (now * old > 0.)
          {
            power += force * rate;
            old_power += force * old_rate;
          }
        // The slip of a point at rest may be rounding.
        if (last < 0. && rate > 1e-6 * old_rate)
          {
            const double missed = k * last * last / (-4. * slope);
            defects.work += force * missed;
            defects.resting[p] = missed * direction;
          }
      }
    defects.work = face.sum(defects.work);
    power        = face.sum(power);
    old_power    = face.sum(old_power);
    if (power > 0.)
      defects.rate_before = std::min(1., old_power / power);
    return defects;
  }



  double
  slip_begun(const ContactLayout &face,
             const ContactState  &old_state,
             const ContactState  &state)
  {
    double slipping = 0., begun = 0.;
    for (const unsigned int p : face.friction_points())
      if (const double bound = state.bound[p];
          std::isfinite(bound) && !state.sticks[p])
        {
          slipping += bound;
          if (old_state.sticks[p] ||
              !(old_state.multiplier[p] * state.multiplier[p] > 0.))
            begun += bound;
        }
    slipping = face.sum(slipping);
    return slipping > 0. ? face.sum(begun) / slipping : 0.;
  }
} // namespace Viscoplastic
