// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_solve.h>
#include <viscoplastic_contact/contact/coulomb_law.h>

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The relaxation factor of friction bounds that follow what they miss, by
  /// Aitken's rule (Irons and Tuck, Int. J. Numer. Methods Eng. 1, 1969): after
  /// a move by @p factor times @p last_missing they miss @p missing. Nothing
  /// where these are equal. Collective.
  std::optional<double>
  aitken_factor(const ContactLayout       &face,
                const double               factor,
                const std::vector<double> &last_missing,
                const std::vector<double> &missing);



  /// The bounds of Coulomb's law in the iterations of a contact solver. As a
  /// rule they follow the pressures at once: nodes are solved with the law
  /// itself, and the linear system knows that bounds change with pressures.
  /// That is a Newton method, which need not converge. Where the error does not
  /// fall, bounds rest until the step is solved for them, and are moved towards
  /// those of the pressures by the share that two such moves tell (Aitken),
  /// until they are near enough to follow again. All calls are collective.
  class CoulombBounds
  {
  public:
    /// @p inverse_diagonal: of the face matrix, by node. All stay in use.
    CoulombBounds(const CoulombLaw                &law,
                  const ContactLayout             &face,
                  const std::vector<Tensor<2, 3>> &inverse_diagonal);

    /// Whether bounds follow the pressures at present.
    bool
    follow() const
    {
      return !rest;
    }

    /// Whether the sweeps solve nodes with the law itself. Not near a solution,
    /// and not after Newton's method has stalled: of several solutions at a
    /// node, sweeps may choose the one that is none of the step.
    bool
    nodes_obey_law() const
    {
      return n_stalls == 0;
    }

    void
    begin_near_solution()
    {
      n_stalls = 1;
    }

    /// Compare the present bounds with those of the pressures in @p state.
    void
    measure(const ContactState &state);

    /// Let bounds be those to which the correction @p w of the face leads.
    void
    predict(ContactSolve         &bulk,
            const FaceTruncation &truncation,
            const Vector<double> &residual,
            const Vector<double> &w,
            ContactState         &state);

    /// The largest part of the stiffness against a correction so far that slip
    /// has lost to the change of its own bounds. A solution at which this is
    /// less than 1 for all corrections that its sets leave free is the only one
    /// near it.
    double
    largest_loss() const
    {
      return loss;
    }

    /// If largest_loss() is at least 1: the friction and the node where it is
    /// largest, in words for messages.
    const std::string &
    doubt() const
    {
      return doubts;
    }

    /// Whether the system itself is worth a look, too: that is what corrections
    /// so far tell, or friction that may be as large as the pressure.
    bool
    may_be_singular() const
    {
      return loss >= 0.5 || largest_coefficient >= 1.;
    }

    /// The error of a step whose error for the present bounds is at most @p
    /// error. The forces of the solution for these differ from those here by at
    /// most twice as much in the dual norm; bounds follow with the coefficient
    /// of friction, and what bounds at rest miss comes on top. (That forces
    /// along and across the foundation weigh alike in this norm, and that
    /// bounds do not follow further, is true up to a factor for a small
    /// coefficient.)
    double
    error_with_bounds(const double error) const
    {
      return (1. + 2. * largest_coefficient) * error + missed;
    }

    /// Decide whether bounds go on to follow or to rest, and move them if they
    /// are due, from the error with bounds after @p n_corrections. Returns
    /// whether something has changed.
    bool
    damp(const double       error,
         const unsigned int n_corrections,
         ContactState      &state);

    /// The number of moves of bounds that rest in between.
    unsigned int
    n_moves() const
    {
      return moves;
    }

    /// Why there may be no solution, and where it is missed most.
    std::string
    failure() const;

  private:
    /// The place of the node with the largest of these values. Collective.
    std::string
    place_of_largest(const std::vector<double> &of_nodes) const;

    const CoulombLaw                &law;
    const ContactLayout             &face;
    const std::vector<Tensor<2, 3>> &inverse_diagonal;
    const double                     largest_coefficient;

    /// Bounds of the present pressures minus bounds, by point, and as an error.
    std::vector<double> missing;
    double              missed = 0.;

    double      loss = 0.;
    std::string doubts;

    bool         rest     = false;
    unsigned int n_stalls = 0, moves = 0;
    /// The error that counts as progress, and the corrections then.
    double       least_error   = std::numeric_limits<double>::max();
    unsigned int last_progress = 0;
    /// Whether they have moved since, what has been missed at the first move
    /// and at the last one, and the share of it that the last one has made up
    /// for.
    bool                has_moved    = false;
    double              first_missed = 0.;
    std::vector<double> last_missing;
    double              share = 0.5;
  };
} // namespace Viscoplastic
