// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <string>

namespace Viscoplastic
{
  /// Iteration counts, error bounds and times of a solve with contact.
  struct ContactReport
  {
    /// Corrections of the active set iteration.
    unsigned int iterations        = 0;
    unsigned int linear_iterations = 0;
    /// Solves in a fixed-point iteration for the friction bounds, and the
    /// largest ratio of successive changes of bounds; with Coulomb's law in the
    /// step itself, CoulombBounds::n_moves() and CoulombBounds::largest_loss().
    unsigned int bound_iterations = 0;
    double       contraction      = 0.;
    /// A sentence on why the solution may not be unique; empty if nothing
    /// suggests that.
    std::string doubt;
    /// Primal minus dual energy, a bound on half the squared energy error.
    double duality_gap = 0.;
    /// The bound on the energy error that follows from the duality gap, over
    /// the energy norm of the solution.
    double relative_error = 0.;
    /// Bound on the error in the energy norm, absolute; without contact, the
    /// one that the linear solver reports.
    double error = 0.;
    /// The part of the error that rounding causes
    /// (SolutionScale::rounding_error).
    double rounding_error = 0.;
    /// The relative tolerance of the solve; zero where nothing was solved.
    double tolerance = 0.;
    /// Wall time of the solve, and an estimate of what the same solve would
    /// have taken without contact.
    double seconds = 0., plain_seconds = 0.;

    /// Add the counts and times of an earlier solve of the same step.
    void
    add_earlier(const ContactReport &earlier)
    {
      iterations += earlier.iterations;
      linear_iterations += earlier.linear_iterations;
      bound_iterations += earlier.bound_iterations;
      contraction = std::max(contraction, earlier.contraction);
      if (doubt.empty())
        doubt = earlier.doubt;
      seconds += earlier.seconds;
      plain_seconds += earlier.plain_seconds;
    }
  };



  /// Thrown on all ranks if the iteration with Coulomb's law does not converge.
  class NoCoulombSolution : public StandardExceptions::ExcMessage
  {
    using StandardExceptions::ExcMessage::ExcMessage;
  };
} // namespace Viscoplastic
