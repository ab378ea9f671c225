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
  /// Return the relaxation factor by Aitken's rule (Irons and Tuck, Int. J.
  /// Numer. Methods Eng. 1, 1969) for a fixed-point iteration of friction
  /// bounds, whose residual is @p missing after a move by @p factor times the
  /// residual @p last_missing. Nothing if both are equal. Collective.
  std::optional<double>
  aitken_factor(const ContactLayout       &face,
                const double               factor,
                const std::vector<double> &last_missing,
                const std::vector<double> &missing);



  /// The bounds of Coulomb's law in the iterations of a contact solver. As a
  /// rule they follow the pressures (Newton's method): nodes are solved with
  /// the law itself, and the linear system contains the change of bounds with
  /// pressures. Where the error does not fall, bounds rest: they are held until
  /// the step is solved for them, and then moved toward those of the pressures
  /// by a share (aitken_factor()), until they are near enough to follow again.
  /// All calls are collective.
  class CoulombBounds
  {
  public:
    /// @p inverse_diagonal: the inverse diagonal blocks of the face matrix, by
    /// node. Keeps references to all arguments.
    CoulombBounds(const CoulombLaw                &law,
                  const ContactLayout             &face,
                  const std::vector<Tensor<2, 3>> &inverse_diagonal);

    /// Whether bounds follow the pressures at present.
    bool
    follow() const
    {
      return !rest;
    }

    /// Whether the sweeps solve nodes with the law itself. They do not near a
    /// known solution or after Newton's method has stalled: of several
    /// solutions at a node, they may choose one that does not solve the step.
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

    /// Set the bounds of @p state to those predicted after the correction @p w
    /// of the face, and update largest_loss().
    void
    predict(ContactSolve         &bulk,
            const FaceTruncation &truncation,
            const Vector<double> &residual,
            const Vector<double> &w,
            ContactState         &state);

    /// The largest part of the stiffness along any correction so far that slip
    /// has lost to the change of its own bounds. If it is less than 1 for all
    /// corrections of the truncated space, the solution is locally unique.
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

    /// Whether the determinant of the linear system should be examined: for a
    /// largest_loss() from 1/2 or friction coefficients from 1 on.
    bool
    may_be_singular() const
    {
      return loss >= 0.5 || largest_coefficient >= 1.;
    }

    /// An estimate of the error of a step whose error for the present bounds is
    /// at most @p error. Contact forces then have an error of at most 2 error
    /// in the dual norm, and bounds of the friction coefficient times that; the
    /// misfit of bounds at rest is added. (Assumes that normal and tangential
    /// forces weigh alike in this norm, and that a change of bounds causes no
    /// further one: true up to a factor for a small coefficient.)
    double
    error_with_bounds(const double error) const
    {
      return (1. + 2. * largest_coefficient) * error + missed;
    }

    /// Decide whether bounds follow or rest, and move resting ones if the step
    /// is solved for them. @p error: error_with_bounds() after @p
    /// n_corrections. Returns whether anything has changed.
    bool
    damp(const double       error,
         const unsigned int n_corrections,
         ContactState      &state);

    /// The number of moves of bounds at rest.
    unsigned int
    n_moves() const
    {
      return moves;
    }

    /// Why there may be no solution, and where bounds fit pressures worst.
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

    /// Bounds of the present pressures minus bounds, by point, and the norm of
    /// this misfit as an error.
    std::vector<double> missing;
    double              missed = 0.;

    double      loss = 0.;
    std::string doubts;

    bool         rest     = false;
    unsigned int n_stalls = 0, moves = 0;
    /// The error when it was last halved, and the number of corrections then.
    double       least_error   = std::numeric_limits<double>::max();
    unsigned int last_progress = 0;
    /// For bounds at rest: whether they have moved, `missed` at the first move,
    /// `missing` at the last one, and the share of it by which they moved.
    bool                has_moved    = false;
    double              first_missed = 0.;
    std::vector<double> last_missing;
    double              share = 0.5;
  };
} // namespace Viscoplastic
