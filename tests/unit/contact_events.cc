// SPDX-License-Identifier: LGPL-2.1-or-later

// Which changes count as an event of contact, and the work of turning slip.

#include <viscoplastic_contact/contact/contact_event.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;

  /// Points with sticking given by '.', slip to the right or left by '>', '<'.
  ContactState
  points(const std::string &signs, const std::vector<double> &bounds = {})
  {
    ContactState state(bounds.empty() ? std::vector<double>(signs.size(), 1.) :
                                        bounds);
    for (unsigned int p = 0; p < signs.size(); ++p)
      {
        state.sticks[p] = signs[p] == '.';
        if (!state.sticks[p])
          state.multiplier[p][0] = signs[p] == '>' ? 1. : -1.;
      }
    return state;
  }



  TEST(ContactEvent, BeginCoverEndTurn)
  {
    ContactLayout face;
    face.points.resize(3); // of friction
    const auto event = [&](const std::string &from, const std::string &to) {
      return has_contact_event(face, points(from), points(to), false);
    };
    EXPECT_TRUE(event("...", "..>"));
    EXPECT_TRUE(event(".>>", ">>>"));
    EXPECT_TRUE(event("...", ">>>"));
    EXPECT_TRUE(event("..>", "..."));
    EXPECT_TRUE(event(".<>", ".>>"));
    EXPECT_FALSE(event("...", "..."));
    EXPECT_FALSE(event("..>", ".>>"));
    EXPECT_FALSE(event(".>>", "..>"));
    EXPECT_FALSE(event(">>>", ".>>"));
    EXPECT_FALSE(event(">>>", ">>>"));
    // After a kink of the data, end and reversal of slip are no events.
    EXPECT_FALSE(has_contact_event(face, points("..>"), points("..."), true));
    EXPECT_FALSE(has_contact_event(face, points("..>"), points("..<"), true));
    EXPECT_TRUE(has_contact_event(face, points("..."), points("..<"), true));
    // Points without friction always slip, glued ones never; both do not count.
    const std::vector<double> bounds{0.,
                                     1.,
                                     std::numeric_limits<double>::infinity()};
    EXPECT_FALSE(
      has_contact_event(face, points(">.."), points(">..", bounds), false));
    EXPECT_TRUE(
      has_contact_event(face, points(">.."), points(">>.", bounds), false));
    EXPECT_TRUE(has_contact_event(
      face, points(".>>"), points("..>", {1., 1., 0.}), false));
    EXPECT_FALSE(has_contact_event({}, points(""), points(""), false));
  }



  TEST(ContactEvent, TouchCoverLiftOff)
  {
    // '|' marks obstacles in contact.
    ContactLayout face;
    face.has_obstacles = true;
    face.points.resize(3);
    for (auto &point : face.points)
      point.is_obstacle = true;
    const auto obstacles = [](const std::string &signs) {
      ContactState state(std::vector<double>(signs.size(), 0.1));
      for (unsigned int p = 0; p < signs.size(); ++p)
        {
          state.sticks[p]        = signs[p] == '|';
          state.multiplier[p][0] = signs[p] == '|' ? 1. : 0.;
        }
      return state;
    };
    const auto event = [&](const std::string &from,
                           const std::string &to,
                           const bool         from_kink = false) {
      return has_contact_event(face, obstacles(from), obstacles(to), from_kink);
    };
    EXPECT_TRUE(event("   ", "  |"));
    EXPECT_TRUE(event(" ||", "|||"));
    EXPECT_TRUE(event("  |", "   "));
    EXPECT_FALSE(event("   ", "   "));
    EXPECT_FALSE(event("  |", " ||"));
    EXPECT_FALSE(event("|||", " ||"));
    EXPECT_FALSE(event("|||", "|||"));
    // After a kink, beginning and end of contact are no events.
    EXPECT_FALSE(event("   ", "  |", true));
    EXPECT_FALSE(event("  |", "   ", true));
    EXPECT_TRUE(event(" ||", "|||", true));
  }



  TEST(ContactEvent, TurningCostsWork)
  {
    // Points with the bound 2 whose multiplier turns by an angle while they
    // slip by 3.
    const auto state = [](const std::vector<double> &angles) {
      ContactState result(std::vector<double>(angles.size(), 2.));
      for (unsigned int p = 0; p < angles.size(); ++p)
        {
          result.sticks[p]        = false;
          result.multiplier[p][0] = 2. * std::cos(angles[p]);
          result.multiplier[p][1] = 2. * std::sin(angles[p]);
        }
      return result;
    };
    ContactLayout face;
    face.points.resize(3); // of friction
    for (auto &point : face.points)
      point.n_tangents = 2;
    const auto work = [&](const ContactState &from, const ContactState &to) {
      std::vector<Tensor<1, 2>> slips(to.multiplier);
      for (Tensor<1, 2> &slip : slips)
        slip *= 1.5;
      return slip_defects(face, from, to, slips, 1., 1.).work;
    };
    const double n_ranks = face.sum(1.);
    EXPECT_NEAR(work(state({0., 1.}), state({0., 1.})), 0., 1e-14);
    EXPECT_NEAR(work(state({0., 0.2}), state({0.3, 0.1})),
                n_ranks * 6. * (2. - std::cos(0.3) - std::cos(0.1)),
                1e-13);
    // Slip that reverses counts as a right angle, slip that begins or ends does
    // not count.
    EXPECT_NEAR(work(state({0.}), state({numbers::PI})), n_ranks * 6., 1e-13);
    ContactState at_rest = state({0.});
    at_rest.sticks[0]    = true;
    EXPECT_EQ(work(at_rest, state({0.5})), 0.);
    EXPECT_EQ(work(state({0.5}), at_rest), 0.);
  }



  TEST(ContactEvent, SlipThatComesToRestInAStep)
  {
    // Mean rates 3 and 1 of steps of equal length: 3 and -1 at the ends.
    ContactLayout face;
    face.points.resize(1);
    face.points[0].n_tangents = 1;
    const auto work = [&face](const double rate, const double old_rate) {
      const double k = 0.1;
      ContactState from(std::vector<double>(1, 2.)), to = from;
      from.sticks[0] = to.sticks[0] = false;
      from.multiplier[0][0] = to.multiplier[0][0] = -2.;
      from.slip[0][0]                             = -k * old_rate;
      std::vector<Tensor<1, 2>> slips(1);
      slips[0][0] = -k * rate;
      return slip_defects(face, from, to, slips, k, k).work;
    };
    const double n_ranks = face.sum(1.);
    EXPECT_NEAR(work(1., 3.), 2. * n_ranks * 0.1 / 8., 1e-14);
    EXPECT_EQ(work(1., 2.), 0.);
    EXPECT_EQ(work(3., 1.), 0.);
  }
} // namespace
