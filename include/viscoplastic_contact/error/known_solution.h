// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/timer.h>

#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/error/solution_errors.h>

#include <string>

namespace Viscoplastic
{
  /// Compares states with the exact solution of a scene, or with the reference
  /// that a finer run has written at the ends of the phases of `Time/Phases',
  /// and writes references for coarser runs.
  template <int dim>
  class KnownSolution
  {
  public:
    /// Keeps references to both; @p timer measures the phase `errors'.
    KnownSolution(const Scene<dim> &scene, TimerOutput &timer);

    /// Throws ExcMessage if there are both an exact solution and a reference,
    /// or if a file of the reference is missing. Collective.
    void
    check() const;

    /// Return the errors of a state; NaN if no solution is known at its time.
    /// Throws ExcMessage if the phase of the reference ends at another time.
    /// Collective.
    SolutionErrors
    errors(const Discretization<dim> &discretization,
           const State<dim>          &state) const;

    /// Write the state to @p directory as a reference for coarser runs, if it
    /// ends a phase and the scene asks for that. Throws ExcMessage. Collective.
    void
    write_reference(const Discretization<dim> &discretization,
                    const State<dim>          &state,
                    const std::string         &directory) const;

  private:
    const Scene<dim>  &scene;
    TimerOutput       &timer;
    const std::string &reference_directory;
  };
} // namespace Viscoplastic
