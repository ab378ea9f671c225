// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact/contact_layout.h>

#include <utility>
#include <vector>

namespace Viscoplastic
{
  struct CoulombCoefficients;

  /// The frictional problem of a single point: the multiplier that minimizes
  /// 1/2 lambda . C lambda - q . lambda over |lambda| <= rho, with C the
  /// symmetric flexibility seen by the point and q its slip at lambda = 0.
  /// |lambda| < rho (or C lambda = q) means stick, otherwise the slip
  /// q - C lambda is parallel to lambda.
  struct PointSolution
  {
    Tensor<1, 2> multiplier;
    bool         sticks;
  };

  PointSolution
  solve_friction_point(const Tensor<2, 2> &flexibility,
                       const Tensor<1, 2> &free_slip,
                       const unsigned int  n_tangents,
                       const double        bound);

  /// Solve the contact law of the single point @p p, friction or obstacle
  /// (`sticks`: it touches), whose node moves by @p start + @p flexibility (@p
  /// force - map^T multiplier).
  PointSolution
  solve_point(const ContactLayout &face,
              unsigned int         p,
              const Tensor<2, 3>  &flexibility,
              const Tensor<1, 3>  &force,
              const ContactState  &state,
              const Tensor<1, 3>  &start = {});

  /// Set the multipliers of @p state to the admissible ones that fit @p
  /// residual = l - A u on the face best and obey the laws exactly: rho s/|s|
  /// where slipping, zero at open obstacles, the force of the law at compliant
  /// ones, the residual clipped to the admissible set where sticking or
  /// touching. Where pieces meet, the fit need not be unique (NodeForces). Sets
  /// @p force to the face vector of their forces, and with a @p law the bounds
  /// to those of the pressures.
  void
  fit_multipliers(const ContactLayout       &face,
                  const Vector<double>      &residual,
                  ContactState              &state,
                  Vector<double>            &force,
                  const CoulombCoefficients *law = nullptr);


  /// Nonlinear Gauss-Seidel step at one node: return the displacement that
  /// minimizes J within the node's obstacles. Solved by duality, point by
  /// point: exact for one friction point with one obstacle, i.e., away from
  /// corners.
  Tensor<1, 3>
  relax_node(const ContactLayout &face,
             const unsigned int   node,
             const Tensor<2, 3>  &inverse_diagonal,
             const Tensor<1, 3>  &force, // residual + D x
             ContactState        &state);


  /// Admissible multipliers for the error bound: those of fit_multipliers()
  /// except for the points in `replaced`.
  struct Certificate
  {
    Vector<double> force;
    /// The complementarity defect over all ranks, an energy: the sum of rho |s|
    /// - lambda . s and of NormalCompliance::defect().
    double                                             defect = 0.;
    std::vector<std::pair<unsigned int, Tensor<1, 2>>> replaced;
  };

  /// Make the certificate for the multipliers of @p state, whose forces are @p
  /// force, but replace multipliers that are blurred by rounding: (1) A point
  /// with two tangents that has hardly begun to slip has an inaccurate
  /// direction s/|s|, so that rho s/|s| misses the residual by more than its
  /// slip is worth; the clipped residual is better, at the price of a small
  /// complementarity defect. A misfit above 1e-5 of the bound is not rounding
  /// unless the slip is as small as @p rounding, an error in the energy norm,
  /// makes it. (2) Where pieces meet, forces may be far above those of the
  /// body: they are turned by up to 1e-9. (3) A compliant obstacle gets a
  /// multiplier between its force and the residual, the closer to the latter
  /// the stiffer it is. Collective.
  Certificate
  certify(const ContactLayout             &face,
          const Vector<double>            &residual,
          const std::vector<Tensor<2, 3>> &diagonal,
          const ContactState              &state,
          const Vector<double>            &force,
          double                           rounding);


  /// Return how the linear system of a Newton step treats the face: sticking
  /// points and touched rigid obstacles are held, slipping points resist
  /// turning, compliant obstacles are springs, of at most @p stiffest times the
  /// stiffness of the node by @p inverse_diagonal (of the face matrix).
  FaceTruncation
  make_truncation(const ContactLayout             &face,
                  const ContactState              &state,
                  const std::vector<Tensor<2, 3>> &inverse_diagonal,
                  const double                     stiffest = 1e10);

  /// The stiffness of a node against turning the direction of slip, rho/|s| (I
  /// - s s^T/|s|^2), limited as in make_truncation().
  Tensor<2, 3>
  turning_spring(const ContactLayout             &face,
                 const unsigned int               node,
                 const ContactState              &state,
                 const std::vector<Tensor<2, 3>> &inverse_diagonal,
                 const double                     stiffest = 1e10);
} // namespace Viscoplastic
