// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/timer.h>

#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/error/solution_errors.h>

#include <string>

namespace Viscoplastic
{
  /// What a scene knows of its solution: the exact one, or a reference that a
  /// finer run has left at the ends of the phases of `Time/Phases'; and what it
  /// leaves for coarser runs.
  template <int dim>
  class KnownSolution
  {
  public:
    /// Both stay in use; @p timer gets the seconds of the phase `errors'.
    KnownSolution(const Scene<dim> &scene, TimerOutput &timer);

    /// Throws ExcMessage if there are two of them, or if a file of the
    /// reference is missing. Collective.
    void
    check() const;

    /// The errors of a state; not a number where nothing is known at its time.
    /// Throws ExcMessage if the reference ends a phase at another time.
    /// Collective.
    SolutionErrors
    errors(const Discretization<dim> &discretization,
           const State<dim>          &state) const;

    /// Leave the state for coarser runs if it ends a phase and the scene wants
    /// that. Throws ExcMessage. Collective.
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
