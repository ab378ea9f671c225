// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/contact/contact_points.h>
#include <viscoplastic_contact/contact/coulomb_law.h>
#include <viscoplastic_contact/contact/coulomb_node.h>

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  double
  CoulombLaw::bound(const ContactLayout &face,
                    const ContactState  &state,
                    const unsigned int   point) const
  {
    double       result = given[point];
    unsigned int o      = face.first_obstacle(face.points[point].node);
    for (const double coefficient : of_pressure[point])
      result += coefficient * state.multiplier[o++][0];
    return result;
  }



  bool
  CoulombLaw::set_bounds(const ContactLayout &face, ContactState &state) const
  {
    bool any = false;
    for (unsigned int p = 0; p < face.points.size(); ++p)
      if (!face.points[p].is_obstacle)
        {
          const double now = bound(face, state, p);
          any |= now != state.bound[p];
          state.bound[p] = now;
        }
    return any;
  }



  bool
  CoulombLaw::is_plain(const ContactLayout &face, const unsigned int node) const
  {
    return face.has_plain_friction(node) &&
           face.first_point[node + 1] - face.first_obstacle(node) == 1 &&
           of_pressure[face.first_point[node]][0] > 0.;
  }



  Tensor<1, 3>
  CoulombLaw::relax_node(const ContactLayout &face,
                         const unsigned int   node,
                         const Tensor<2, 3>  &inverse_diagonal,
                         const Tensor<1, 3>  &force,
                         ContactState        &state) const
  {
    const unsigned int p = face.first_point[node],
                       o = face.first_obstacle(node);
    const auto relax     = [&] {
      return Viscoplastic::relax_node(
        face, node, inverse_diagonal, force, state);
    };
    if (is_plain(face, node))
      {
        const ContactLayout::Point       &friction = face.points[p];
        const std::array<Tensor<1, 3>, 3> rows{
          {face.points[o].map[0], friction.map[0], friction.map[1]}};
        CoulombNode        problem{{},
                            {},
                            friction.n_tangents,
                            given[p],
                            of_pressure[p][0],
                            face.points[o].compliance,
                            state.sticks[o] ? state.multiplier[o][0] : 0.};
        const Tensor<1, 3> free  = inverse_diagonal * force;
        problem.free_motion[0]   = rows[0] * free - state.bound[o];
        const Tensor<1, 2> slips = state.slip_with(friction, p, free);
        for (unsigned int i = 0; i <= friction.n_tangents; ++i)
          {
            if (i > 0)
              problem.free_motion[i] = slips[i - 1];
            for (unsigned int j = 0; j <= friction.n_tangents; ++j)
              problem.flexibility[i][j] =
                rows[i] * (inverse_diagonal * rows[j]);
          }
        // With the bound of its pressure, the minimum at the node is what
        // Coulomb's law asks for.
        state.bound[p] =
          given[p] + of_pressure[p][0] * coulomb_pressure(problem);
        return relax();
      }

    // Where pieces meet, pressures and bounds follow each other; swings are
    // halved.
    constexpr unsigned int max_iterations = 50;
    Tensor<1, 3>           x;
    for (unsigned int iteration = 0;; ++iteration)
      {
        x             = relax();
        double change = 0., sum = 0.;
        for (unsigned int f = p; f < o; ++f)
          {
            const double now = bound(face, state, f);
            change += std::abs(now - state.bound[f]);
            sum += now;
            state.bound[f] =
              iteration < 10 ? now : 0.5 * (now + state.bound[f]);
          }
        if (change <= 1e-14 * sum || iteration == max_iterations)
          return x;
      }
  }



  void
  CoulombLaw::tilt(const ContactLayout &face,
                   const ContactState  &state,
                   FaceTruncation      &truncation) const
  {
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      {
        const unsigned int p = face.first_point[node],
                           o = face.first_obstacle(node);
        if (!is_plain(face, node) || state.sticks[p] || !state.sticks[o] ||
            !(state.multiplier[o][0] > 0.) || !(state.slip[p].norm() > 0.))
          continue;
        if (truncation.tilt.empty())
          {
            Tensor<2, 3> identity;
            for (unsigned int d = 0; d < 3; ++d)
              identity[d][d] = 1.;
            truncation.tilt.assign(face.n_nodes(), identity);
          }
        const Tensor<1, 3> &normal = face.points[o].map[0];
        truncation.tilt[node] -=
          of_pressure[p][0] / normal.norm_square() *
          outer_product(node_force(face.points[p],
                                   state.slip[p] / state.slip[p].norm()),
                        normal);
      }
  }



  void
  CoulombLaw::predict_bounds(const ContactLayout  &face,
                             const Vector<double> &residual,
                             ContactState         &state) const
  {
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      if (is_plain(face, node))
        {
          const unsigned int p       = face.first_point[node],
                             o       = face.first_obstacle(node);
          const Tensor<1, 3> &normal = face.points[o].map[0];
          const double        force =
            state.sticks[o] ?
                     normal * face.node_values(residual, node) / normal.norm_square() :
                     0.;
          state.bound[p] = given[p] + of_pressure[p][0] * std::max(0., force);
        }
  }



  double
  CoulombLaw::largest_coefficient(const ContactLayout &face) const
  {
    double result = 0.;
    for (unsigned int p = 0; p < face.points.size(); ++p)
      if (!face.points[p].is_obstacle)
        {
          double sum = 0.;
          for (const double coefficient : of_pressure[p])
            sum += coefficient;
          result = std::max(result, sum);
        }
    return Utilities::MPI::max(result, face.communicator);
  }
} // namespace Viscoplastic
