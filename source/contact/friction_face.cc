// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/contact/friction_face.h>

namespace Viscoplastic
{
  Tensor<1, 2>
  slip(const FrictionFace::Point &point, const Tensor<1, 3> &x)
  {
    Tensor<1, 2> s;
    for (unsigned int i = 0; i < point.n_tangents; ++i)
      s[i] = point.map[i] * x;
    return s;
  }



  Tensor<1, 3>
  node_force(const FrictionFace::Point &point, const Tensor<1, 2> &multiplier)
  {
    Tensor<1, 3> f;
    for (unsigned int i = 0; i < point.n_tangents; ++i)
      f += multiplier[i] * point.map[i];
    return f;
  }



  bool
  FaceTruncation::has_springs() const
  {
    for (const Tensor<2, 3> &block : spring)
      if (block.norm() > 0.)
        return true;
    return false;
  }



  void
  FaceTruncation::project(const FrictionFace &face, Vector<double> &x) const
  {
    for (unsigned int n = 0; n < face.n_nodes(); ++n)
      face.set_node_values(projector[n] * face.node_values(x, n), n, x);
  }
} // namespace Viscoplastic
