// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_layout.h>
#include <viscoplastic_contact/contact/contact_solve.h>

#include <optional>
#include <vector>

namespace Viscoplastic
{
  // The energy J of a step has kinks: where slip changes sides, and where a
  // node meets an obstacle. These functions search along corrections w of the
  // face and take the kinks into account. All are collective.

  /// A step along a correction, and what it does to J.
  struct SearchResult
  {
    double step, energy_change;
  };


  /// The step that minimizes J along the correction @p w, at most 2 and as far
  /// as the obstacles allow; 1 if that is as good to the accuracy of the linear
  /// solve, 0 without descent.
  SearchResult
  search_along(ContactSolve         &bulk,
               const ContactLayout  &face,
               const ContactState   &state,
               const Vector<double> &w);


  /// Return how many times the change @p w of the face can be repeated from @p
  /// state until J has its minimum along @p w or an obstacle that is not
  /// touched yet is met. @p terms: minus the slope of J at @p state, and the
  /// curvature of the bulk energy.
  double
  repetitions(const ContactSolve::SearchTerms &terms,
              const ContactLayout             &face,
              const ContactState              &state,
              const Vector<double>            &w);


  /// Shorten a correction @p w at nodes that it would take beyond a kink of J:
  /// slip that would reverse comes to rest, motion into an obstacle ends at it.
  /// Corners, where points share a node, are left to the line search. @p x: the
  /// increment of the face. Returns whether any node stops.
  bool
  stop_at_kinks(const ContactLayout  &face,
                const ContactState   &state,
                const Vector<double> &x,
                Vector<double>       &w);


  /// Move the nodes that the correction @p w would take beyond a kink of J to
  /// that kink: updates the increment @p x and the sets of @p state, and sets
  /// @p change to the change of @p x. Returns the change of the friction
  /// functional j.
  double
  bring_to_kinks(const ContactLayout  &face,
                 const Vector<double> &w,
                 Vector<double>       &x,
                 ContactState         &state,
                 Vector<double>       &change);


  /// A correction with nodes held at kinks of J, and its line search.
  struct KinkStep
  {
    Vector<double> correction;
    SearchResult   search;
    unsigned int   linear_iterations;
  };

  /// Call bring_to_kinks(), solve with these nodes held to the relative
  /// accuracy @p tolerance (or less, if the move has enlarged the residual),
  /// and search along the new correction. If J is lower then, the step is
  /// returned for the caller to take, and @p x and @p state stay changed;
  /// otherwise everything but the correction of @p bulk is restored.
  std::optional<KinkStep>
  step_from_kinks(ContactSolve                    &bulk,
                  const ContactLayout             &face,
                  const std::vector<Tensor<2, 3>> &inverse_diagonal,
                  const Vector<double>            &residual,
                  const Vector<double>            &w,
                  const double                     tolerance,
                  Vector<double>                  &x,
                  ContactState                    &state);


  /// Solve for the correction with @p truncation, and search along it. If
  /// obstacles that are not touched yet limit the step to less than @p least,
  /// their nodes are held at the present distance, and the solve is repeated
  /// until the step is longer or J gets no lower. @p force: the face vector of
  /// contact forces in ContactSolve::correct().
  KinkStep
  step_past_obstacles(ContactSolve                    &bulk,
                      const ContactLayout             &face,
                      const std::vector<Tensor<2, 3>> &inverse_diagonal,
                      const FaceTruncation            &truncation,
                      const Vector<double>            &force,
                      const double                     tolerance,
                      const double                     least,
                      const ContactState              &state);
} // namespace Viscoplastic
