// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/contact/contact_layout.h>

namespace Viscoplastic
{
  bool
  ContactLayout::has_plain_friction(const unsigned int node) const
  {
    const Range here = obstacles(node);
    if (*here.begin() - first_point[node] != 1)
      return false;
    const Point &friction = points[first_point[node]];
    for (const unsigned int o : here)
      for (unsigned int i = 0; i < friction.n_tangents; ++i)
        if (friction.map[i] * points[o].map[0] != 0.)
          return false;
    return true;
  }



  Tensor<1, 2>
  slip(const ContactLayout::Point &point, const Tensor<1, 3> &x)
  {
    Tensor<1, 2> s;
    for (unsigned int i = 0; i < point.n_tangents; ++i)
      s[i] = point.map[i] * x;
    return s;
  }



  Tensor<1, 3>
  node_force(const ContactLayout::Point &point, const Tensor<1, 2> &multiplier)
  {
    Tensor<1, 3> f;
    for (unsigned int i = 0; i < point.n_tangents; ++i)
      f += multiplier[i] * point.map[i];
    return f;
  }



  namespace
  {
    /// (map map^T)^{-1} s.
    Tensor<1, 2>
    solve_with_gram(const ContactLayout::Point &point, const Tensor<1, 2> &s)
    {
      const double a = point.map[0].norm_square();
      Tensor<1, 2> result;
      if (point.n_tangents == 1)
        {
          result[0] = s[0] / a;
          return result;
        }
      const double b           = point.map[0] * point.map[1];
      const double c           = point.map[1].norm_square();
      const double determinant = a * c - b * b;
      result[0]                = (c * s[0] - b * s[1]) / determinant;
      result[1]                = (a * s[1] - b * s[0]) / determinant;
      return result;
    }
  } // namespace



  Tensor<1, 2>
  nearest_multiplier(const ContactLayout::Point &point,
                     const Tensor<1, 3>         &force)
  {
    return solve_with_gram(point, slip(point, force));
  }



  Tensor<1, 3>
  motion_with_slip(const ContactLayout::Point &point, const Tensor<1, 2> &slip)
  {
    return node_force(point, solve_with_gram(point, slip));
  }



  Vector<double>
  face_motion(const ContactLayout &face, const std::vector<Tensor<1, 2>> &slips)
  {
    AssertDimension(slips.size(), face.points.size());
    Vector<double> result(face.n_dofs());
    for (unsigned int p = 0; p < slips.size(); ++p)
      {
        const ContactLayout::Point &point  = face.points[p];
        const Tensor<1, 3>          motion = motion_with_slip(point, slips[p]);
        if (motion.norm() > face.node_values(result, point.node).norm())
          face.set_node_values(motion, point.node, result);
      }
    return result;
  }



  void
  ContactState::set_slip(const ContactLayout::Point &point,
                         const unsigned int          p,
                         const Tensor<1, 3>         &x)
  {
    slip[p] =
      !sticks[p] || point.is_obstacle ? slip_with(point, p, x) : Tensor<1, 2>();
    if (!point.compliance.is_rigid())
      sticks[p] = penetration(p) > 0.;
    else if (!point.is_obstacle && bound[p] > 0. && slip[p].norm() == 0.)
      sticks[p] = true;
  }



  Tensor<1, 2>
  ContactState::multiplier_of_slip(const ContactLayout::Point &point,
                                   const unsigned int          p) const
  {
    Tensor<1, 2> result;
    if (point.is_obstacle)
      result[0] = point.compliance.force(penetration(p));
    else if (const double size = slip[p].norm(); slips(point, p) && size > 0.)
      result = slip[p] * (bound[p] / size);
    return result;
  }
} // namespace Viscoplastic
