// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/error/dual_problem.h>
#include <viscoplastic_contact/scene/quantity_of_interest.h>

namespace Viscoplastic
{
  /**
   * What straight sides of cells do to a quantity where the body is curved, by
   * active cell: between a face and the manifold, at a distance delta from its
   * middle, there is the volume 2/3 delta |face|, in which the equations miss
   *
   *     sigma : eps(w) + p div w,
   *
   * the latter of a pressure p, which follows the surface. Their sum is the
   * error to leading order. Of meshes from files, zero: they are the geometry.
   * Collective.
   */
  template <int dim>
  Vector<double>
  missing_sides(const Discretization<dim> &discretization,
                const State<dim>          &state,
                const DistributedVector   &ghosted_w);

  /**
   * The friction that a quantity misses where nodes on Gamma_3 are held in its
   * direction by other conditions, by active cell: such nodes have no friction
   * point, and what their part of the face carries goes to what holds them. It
   * is the bound there, for the work of friction times the slip; zero where the
   * foundation does not slide relative to the node, as at planes of symmetry.
   * At contact between two bodies it is not known, and zero. Collective.
   */
  template <int dim>
  Vector<double>
  held_friction(const Discretization<dim> &discretization,
                const State<dim>          &state,
                const QuantityOfInterest  &quantity,
                const DistributedVector   &ghosted_w);
} // namespace Viscoplastic
