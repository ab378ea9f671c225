// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping.h>

#include <viscoplastic_contact/laws/strain.h>
#include <viscoplastic_contact/parameters/choices.h>

#include <algorithm>
#include <cmath>

// The body that a plane mesh represents. Axial symmetry changes integrals only
// by the measure 2 pi r, which the mapping includes, and by the hoop strain
// u_r/r; both are here. Coordinates are (x, y) = (r, z); the third direction of
// tensors, called z in their components, is circumferential.

namespace Viscoplastic
{
  /// Return the (bi-, tri-)linear mapping; for bodies of revolution, its
  /// weights JxW include 2 pi r.
  template <int dim>
  const Mapping<dim> &
  mapping_of(const PlaneModel model);



  /// Return the extent of the body across its section at @p x: 2 pi r for a
  /// body of revolution, otherwise 1.
  template <int dim>
  double
  extent(const PlaneModel model, const Point<dim> &x)
  {
    return model == PlaneModel::axisymmetric ? 2. * numbers::PI * x[0] : 1.;
  }



  /// Return whether a face is on the axis x = 0, up to errors in mesh files.
  template <typename Face>
  bool
  is_on_axis(const Face &face)
  {
    double largest = 0.;
    for (const unsigned int v : face->vertex_indices())
      largest = std::max(largest, std::abs(face->vertex(v)[0]));
    return largest <= 1e-9 * face->diameter();
  }



  /// Return the hoop strain u_r/r of shape function @p i of V_h at a quadrature
  /// point of a body of revolution; on the axis it is the radial strain.
  template <int dim>
  double
  hoop_strain(const FEValuesBase<dim> &values,
              const unsigned int       i,
              const unsigned int       q)
  {
    if (i % dim != 0)
      return 0.;
    const double r = values.quadrature_point(q)[0];
    return r > 0. ? values.shape_value(i, q) / r : values.shape_grad(i, q)[0];
  }



  /// Return the strain of a displacement with this value and gradient at @p x;
  /// its component zz is @p axial unless the model is axisymmetric.
  template <int dim>
  SymmetricTensor<2, 3>
  strain(const Tensor<1, dim> &displacement,
         const Tensor<2, dim> &gradient,
         const Point<dim>     &x,
         const PlaneModel      model,
         const double          axial)
  {
    return strain(gradient,
                  model != PlaneModel::axisymmetric ? axial :
                  x[0] > 0.                         ? displacement[0] / x[0] :
                                                      gradient[0][0]);
  }
} // namespace Viscoplastic
