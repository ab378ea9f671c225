// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/contact/contact_points.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Viscoplastic
{
  namespace
  {
    /// A spring along @p row, at most @p stiffest times as stiff as the node;
    /// without limit if @p inverse_diagonal is empty.
    Tensor<2, 3>
    spring_along(const Tensor<1, 3>              &row,
                 const double                     stiffness,
                 const unsigned int               node,
                 const std::vector<Tensor<2, 3>> &inverse_diagonal,
                 const double                     stiffest)
    {
      const double limit = inverse_diagonal.empty() ?
                             std::numeric_limits<double>::max() :
                             stiffest / (row * (inverse_diagonal[node] * row));
      return std::min(stiffness, limit) * outer_product(row, row);
    }
  } // namespace



  Tensor<2, 3>
  turning_spring(const ContactLayout             &face,
                 const unsigned int               node,
                 const ContactState              &state,
                 const std::vector<Tensor<2, 3>> &inverse_diagonal,
                 const double                     stiffest)
  {
    Tensor<2, 3> result;
    for (const unsigned int p : face.friction_points(node))
      if (const ContactLayout::Point &point = face.points[p];
          point.n_tangents == 2 && state.slips(point, p))
        {
          // The spring is rho/|s| (I - e e^T), which tends to infinity as a
          // point comes to rest. A point from another mesh has no slip on this
          // one, so that its multiplier has to give the direction.
          const double       size = state.slip[p].norm();
          const Tensor<1, 2> along =
            size > 0. ? state.slip[p] : state.multiplier[p];
          if (!(along.norm() > 0.))
            continue;
          const Tensor<1, 2> e = along / along.norm();
          result += spring_along(-e[1] * point.map[0] + e[0] * point.map[1],
                                 state.bound[p] / size,
                                 node,
                                 inverse_diagonal,
                                 stiffest);
        }
    return result;
  }



  FaceTruncation
  make_truncation(const ContactLayout             &face,
                  const ContactState              &state,
                  const std::vector<Tensor<2, 3>> &inverse_diagonal,
                  const double                     stiffest)
  {
    FaceTruncation truncation;
    truncation.projector.resize(face.n_nodes(), identity());
    truncation.spring.resize(face.n_nodes());
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      {
        Tensor<2, 3> &projector = truncation.projector[node];
        truncation.spring[node] =
          turning_spring(face, node, state, inverse_diagonal, stiffest);
        for (const unsigned int o : face.compliant(face.obstacles(node)))
          truncation.spring[node] +=
            spring_along(face.points[o].map[0],
                         face.points[o].compliance.slope(state.penetration(o)),
                         node,
                         inverse_diagonal,
                         stiffest);
        for (const unsigned int p : face.node_points(node))
          if (const ContactLayout::Point &point = face.points[p];
              state.blocks(point, p))
            for (unsigned int i = 0; i < point.n_tangents; ++i)
              {
                // Remove the part of this direction that is still free.
                Tensor<1, 3> q = projector * point.map[i];
                if (q.norm() > 1e-8 * point.map[i].norm())
                  {
                    q /= q.norm();
                    projector -= outer_product(q, q);
                  }
              }
        // Remove rounding, so that equal sets compare equal.
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            if (std::abs(projector[i][j]) < 1e-14)
              projector[i][j] = 0.;
      }
    return truncation;
  }
} // namespace Viscoplastic
