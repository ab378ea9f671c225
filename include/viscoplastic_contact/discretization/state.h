// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_layout.h>
#include <viscoplastic_contact/discretization/stress_space.h>

#include <array>

namespace Viscoplastic
{
  /// The unknowns at one time. A step is a pure function: it makes a new State
  /// from an accepted one, a time and a step size.
  template <int dim>
  struct State
  {
    /// Number of the step that led here, its time and its size.
    unsigned int n = 0;
    double       t = 0., k = 0.;

    /// u_n and delta u_n = (u_n - u_{n-1})/k_n: Cartesian, with ghosts.
    DistributedVector u, velocity;

    /// z_n at the samples of the owned cells; empty in elastic bodies without
    /// initial stress.
    IrreversibleStress z;

    /// At the samples of z, only with viscosity and an error estimate: the
    /// leading term of the time discretization error of z so far, in single
    /// precision and units of time_error_unit, a power of two near the largest
    /// z or its change in a step; and the slope of the rate that the second
    /// order needs (see ErrorEstimator).
    std::vector<SymmetricTensor<2, 3, float>> time_error;
    double                                    time_error_unit = 1.;
    IrreversibleStress                        rate_slope;
    /// With a quantity of interest other than a sum: the time error of z as the
    /// linearized equations carry it on from step to step, and that of u,
    /// Cartesian with ghosts, empty before the first step.
    IrreversibleStress carried_error;
    DistributedVector  carried_error_of_u;

    /// The history variables alpha_n of the laws at the samples, their time
    /// error and the slope of their rates; empty unless a law has any.
    IrreversibleStress history, history_error, history_slope;

    /// The state of contact after the step that led to this state; without
    /// points if the scene has neither friction nor contact that opens.
    ContactState contact;

    /// u_0, Cartesian with ghosts; empty where zero.
    DistributedVector initial_u;

    /// What friction has dissipated per area since t = 0, at the nodes of
    /// Gamma_3 in the place of their first component, with ghosts. Empty unless
    /// the scene asks for it, and before the first step.
    DistributedVector friction_work;

    /// The time error of z at sample i.
    SymmetricTensor<2, 3>
    time_error_at(const std::size_t i) const
    {
      return time_error_unit * SymmetricTensor<2, 3>(time_error[i]);
    }
  };



  /// Call act(field) for each of the n_sample_fields fields of a state that
  /// have values at the samples; absent ones are empty.
  template <typename StateType, typename Action>
  void
  for_each_sample_field(StateType &state, const Action &act)
  {
    act(state.z);
    act(state.time_error);
    act(state.rate_slope);
    act(state.carried_error);
    act(state.history);
    act(state.history_error);
    act(state.history_slope);
  }

  constexpr std::size_t n_sample_fields = 7;



  /// The fields of a state that have values at nodes; absent ones are empty.
  template <typename StateType>
  auto
  nodal_fields(StateType &state)
  {
    return std::array<decltype(&state.u), 5>{{&state.u,
                                              &state.velocity,
                                              &state.initial_u,
                                              &state.friction_work,
                                              &state.carried_error_of_u}};
  }
} // namespace Viscoplastic
