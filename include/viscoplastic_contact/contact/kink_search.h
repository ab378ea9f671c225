// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_layout.h>
#include <viscoplastic_contact/contact/contact_solve.h>

#include <optional>
#include <vector>

namespace Viscoplastic
{
  // The energy J of a step has kinks: where slip changes sides, and where a
  // node meets an obstacle. What follows searches along corrections w of the
  // face with them in view. All calls are collective.

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


  /// How many times the change @p w of the face, after which its state is
  /// @p state, can be repeated until J has its minimum along it, or an obstacle
  /// that is not touched yet ends it. @p terms: the descent of J after the
  /// change and the curvature of the energy of the body.
  double
  repetitions(const ContactSolve::SearchTerms &terms,
              const ContactLayout             &face,
              const ContactState              &state,
              const Vector<double>            &w);


  /// Shorten a correction @p w where it meets kinks of J: slip that would
  /// change sides comes to rest, a way into an obstacle ends at it. At corners,
  /// where points share a node, the line search alone decides. @p x: the
  /// increment. Returns whether there is such a node.
  bool
  stop_at_kinks(const ContactLayout  &face,
                const ContactState   &state,
                const Vector<double> &x,
                Vector<double>       &w);


  /// Bring the nodes that the correction @p w would take beyond a kink of J
  /// there: the increment @p x and the sets of @p state change, @p change is
  /// set to that of the face. Returns the change of j.
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

  /// Bring the nodes that the correction @p w takes beyond a kink of J there,
  /// solve with them held to the relative accuracy @p tolerance (or what the
  /// stop asks for), and search along that correction. If J is lower
  /// then, the stop is made (@p x and @p state change) and the step is
  /// returned, to be taken; otherwise everything is as before but the
  /// correction.
  std::optional<KinkStep>
  step_from_kinks(ContactSolve                    &bulk,
                  const ContactLayout             &face,
                  const std::vector<Tensor<2, 3>> &inverse_diagonal,
                  const Vector<double>            &residual,
                  const Vector<double>            &w,
                  const double                     tolerance,
                  Vector<double>                  &x,
                  ContactState                    &state);


  /// The correction with @p truncation, and the search along it. Where an
  /// obstacle that a node does not touch ends it before the part @p least, such
  /// nodes are held at the distance that they have, and the solve is repeated
  /// until nothing else is in the way or J gets no lower. @p force: what is to
  /// be corrected.
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
