// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/contact/contact_solve.h>

#include <cmath>

namespace Viscoplastic
{
  unsigned int
  solve_truncated(ContactSolve         &solve,
                  const ContactLayout  &face,
                  const FaceTruncation &truncation,
                  const bool            is_kept,
                  Vector<double>        force,
                  const double          reduction,
                  const double          enough)
  {
    constexpr unsigned int max_corrections = 5;
    Vector<double>         w(face.n_dofs());
    unsigned int           iterations = 0;
    solve.set_truncation(truncation, is_kept);
    // If these are not enough, the caller takes what they have reached.
    for (unsigned int n = 0; n < max_corrections; ++n)
      {
        iterations += solve.correct(force, reduction, w);
        const double curvature = solve.search_terms(w).curvature;
        solve.take_step(1.);
        if (solve.is_exact ||
            std::sqrt(std::max(0., curvature)) <= enough * solve.energy_norm())
          break;
        // The forces of springs have changed. With a tilt the change is not
        // known, since in a transposed system springs do not act on w.
        if (face.any(!truncation.tilt.empty()) && truncation.has_springs(face))
          break;
        for (unsigned int node = 0; node < face.n_nodes(); ++node)
          face.add_node_values(
            truncation.spring[node] * face.node_values(w, node), node, force);
      }
    solve.finish();
    return iterations;
  }
} // namespace Viscoplastic
