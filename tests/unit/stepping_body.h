// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// A body that makes time steps without a run.

#include <deal.II/base/timer.h>

#include "body.h"
#include <viscoplastic_contact/discretization/initial_state.h>
#include <viscoplastic_contact/time_stepping/time_stepper.h>

#include <sstream>

namespace Viscoplastic::Testing
{
  /// A block that is pushed over its foundation until parts of it slip, with a
  /// hanging node on the contact face.
  template <int dim>
  struct SteppingBody : Body<dim>
  {
    explicit SteppingBody(const std::string &more,
                          const std::string &friction_bound = "0.03")
      : SteppingBody(WholeScene{scene_text(more, friction_bound)})
    {}

    struct WholeScene
    {
      std::string text;
    };

    /// A body of another scene on the same mesh.
    explicit SteppingBody(const WholeScene &whole)
      : Body<dim>(whole.text)
    {
      this->refine_where(
        [](const Point<dim> &x) { return x[0] < 0.6 && x[dim - 1] < 0.6; });
      this->scene.inspect(this->triangulation);
      distribute_nodes(this->fe, this->dof_handler);
      discretization =
        std::make_unique<Discretization<dim>>(this->dof_handler, this->scene);
      discretization->assemble_matrix();
      const Parameters &p = *this->parameters;
      if (p.error_control.error_estimator)
        error_estimator = std::make_unique<ErrorEstimator<dim>>(this->scene);
      control = std::make_unique<StepControl>(p.step_control,
                                              p.time.stiffness_policy,
                                              this->scene.schedule,
                                              order_of(p.time.scheme),
                                              0.);
      control->set_has_estimate(this->scene.has_viscosity());
      stepper        = std::make_unique<TimeStepper<dim>>(*discretization,
                                                   error_estimator.get(),
                                                   *control,
                                                   timer);
      accepted.state = make_initial_state(discretization->stress_space, false);
      if (discretization->face)
        accepted.state.contact = ContactState(discretization->face->bounds(0.));
      if (error_estimator)
        error_estimator->begin(discretization->stress_space, accepted);
      accepted.forces = evaluate_forces(discretization->stress_space,
                                        discretization->matrix,
                                        discretization->loads.assemble(0.),
                                        accepted.state);
    }

    static std::string
    scene_text(const std::string &more, const std::string &friction_bound)
    {
      const std::string zero = dim == 3 ? "; 0" : "";
      std::string       text =
        box<dim>(2) +
        boundary(0,
                 "set Role = traction\nset Traction = 0.3*t; -0.1*t" + zero) +
        boundary(1, "set Role = free") +
        boundary(2 * (dim - 1),
                 "set Role = contact\nset Friction law = tresca\n"
                 "set Friction bound = " +
                   friction_bound) +
        boundary(2 * (dim - 1) + 1, "set Role = clamped") + more;
      if (dim == 3)
        text +=
          boundary(2, "set Role = symmetry") + boundary(3, "set Role = free");
      return text;
    }

    FlowRate
    rate() const
    {
      return evaluate_flow(discretization->laws,
                           accepted.state,
                           accepted.state.t);
    }

    /// Make @p n steps and accept them.
    void
    advance(const unsigned int n)
    {
      for (unsigned int i = 0; i < n; ++i)
        accepted = stepper->next(accepted).end;
    }

    std::ostringstream nowhere;
    TimerOutput timer{nowhere, TimerOutput::never, TimerOutput::wall_times};
    std::unique_ptr<Discretization<dim>> discretization;
    std::unique_ptr<ErrorEstimator<dim>> error_estimator;
    std::unique_ptr<StepControl>         control;
    std::unique_ptr<TimeStepper<dim>>    stepper;
    EvaluatedState<dim>                  accepted;
  };



  inline const std::string maxwell =
    subsection("Material", "set Law = maxwell\nset Poisson's ratio = 0.3");

  inline std::string
  time(const std::string &scheme, const std::string &phases)
  {
    return subsection("Time",
                      "set Phases = " + phases + "\nset Scheme = " + scheme);
  }

  inline std::string
  solver(const std::string &name)
  {
    return subsection("Solver", "set Linear solver = " + name);
  }
} // namespace Viscoplastic::Testing
