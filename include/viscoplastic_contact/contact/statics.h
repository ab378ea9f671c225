// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_layout.h>

#include <vector>

namespace Viscoplastic
{
  /// A body whose rigid motions only contact constrains: these motions, and the
  /// work of the loads on them.
  struct HeldBody
  {
    const ContactLayout &face;
    /// A basis of the free rigid motions, each as a face vector; in a scale in
    /// which no motion is much larger than the others.
    std::vector<Vector<double>> motions;
    /// The work of the loads on each motion, and its largest sum of absolute
    /// values over the degrees of freedom.
    std::vector<double> load;
    double              load_size = 0.;
  };


  /// Whether admissible contact forces balance the loads, with the proof.
  struct Statics
  {
    bool is_balanced = true;
    /// If balanced: an equilibrium's normal force at each obstacle.
    std::vector<double> pressures;
    /// If not: a rigid motion, in the basis of HeldBody::motions, without
    /// penetration, on which the loads do more work than friction can
    /// dissipate.
    std::vector<double> motion;
  };


  /// Whether there are pressures p_c >= 0 and forces of friction within their
  /// bounds, rho_c or rho_c + mu_c p_c, that do as much work as the loads on
  /// each rigid motion. By the lemma of Farkas there is otherwise a motion v
  /// that proves the contrary:
  ///
  ///     n_c . v <= 0 (or n_c . v + mu_c |v_c| <= 0) at all obstacles,
  ///     l(v) > sum_c rho_c |v_c|.
  ///
  /// Least squares with nonnegative coefficients (Lawson, Hanson) in as many
  /// dimensions as there are rigid motions decide; of the infinitely many
  /// forces of a friction cone, each iteration adds the one that helps most.
  /// Loads that miss a balance by less than @p accuracy, the accuracy of loads
  /// and bounds relative to the loads, count as balanced. Collective.
  ///
  /// @p bounds: of friction at each point, infinite where nothing can slip;
  /// entries of obstacles are ignored. @p bounds_of_pressure: what a unit of
  /// pressure at the first, second, ... obstacle of a node adds to the bound of
  /// each point of friction there; empty where bounds are given.
  Statics
  balance(const HeldBody                         &body,
          const std::vector<double>              &bounds,
          const std::vector<std::vector<double>> &bounds_of_pressure,
          const double                            accuracy);


  /// Return the rigid motion, in the basis HeldBody::motions, that takes a body
  /// in the state @p contact, with the present @p slips of its points, to where
  /// its loads and contact forces balance. Newton's method over the motions
  /// that neither sticking points nor rigid obstacles prevent, which only
  /// compliant obstacles and the friction of slipping points resist; ends at
  /// the next rigid obstacle. Collective.
  std::vector<double>
  settle(const HeldBody                  &body,
         const ContactState              &contact,
         const std::vector<Tensor<1, 2>> &slips);
} // namespace Viscoplastic
