// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_report.h>
#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/discretization/force_balance.h>
#include <viscoplastic_contact/discretization/state.h>
#include <viscoplastic_contact/error/error_estimate.h>
#include <viscoplastic_contact/error/space_estimator.h>

#include <optional>

namespace Viscoplastic
{
  /// A state with its forces, rates and error estimates. A step leads from one
  /// evaluated state, which it does not change, to another one.
  template <int dim>
  struct EvaluatedState
  {
    State<dim>  state;
    Forces<dim> forces;
    /// G at the state; absent until it is needed.
    std::optional<FlowRate> rate;
    /// The error in space; empty where the scene asks for no estimate.
    SpaceEstimate space_estimate;
    /// The error by its causes; zero where the scene asks for no estimate.
    ErrorEstimate errors;
    /// Whether u solves the step of this state on the present mesh; false for
    /// initial data and for a state transferred from another mesh.
    bool is_solution = false;
    /// Whether the slip rate of its step is comparable with that of the next
    /// one; false on a new mesh, whose first step restores equilibrium.
    bool has_slip_rate = true;
    /// The report of the solve that gave u, which may be that of an earlier
    /// step.
    ContactReport report;
  };
} // namespace Viscoplastic
