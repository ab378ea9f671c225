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

  /// Solve for the multiplier of one point @p p, friction or obstacle, and
  /// whether it sticks or is in contact, of a node that moves by @p start + @p
  /// flexibility (@p force - map^T multiplier).
  PointSolution
  solve_point(const ContactLayout &face,
              unsigned int         p,
              const Tensor<2, 3>  &flexibility,
              const Tensor<1, 3>  &force,
              const ContactState  &state,
              const Tensor<1, 3>  &start = {});

  /// Admissible multipliers that fit @p residual = l - A u on the face best and
  /// obey the laws exactly: rho s/|s| where slipping, zero off an obstacle,
  /// that of its compliance where it gives way, the residual clipped where
  /// sticking and touching. Where pieces meet, the fit may leave a choice
  /// (NodeForces). Gives the face vector of their forces, too. With a @p law
  /// bounds are those of the pressures, and are set.
  void
  fit_multipliers(const ContactLayout       &face,
                  const Vector<double>      &residual,
                  ContactState              &state,
                  Vector<double>            &force,
                  const CoulombCoefficients *law = nullptr);


  /// The nonlinear Gauss-Seidel step at one node: minimize J over the node's
  /// components, within its obstacles. By duality, block by block over the
  /// node's points; exact at once for one obstacle and a single point of
  /// friction, i.e. away from corners.
  Tensor<1, 3>
  relax_node(const ContactLayout &face,
             const unsigned int   node,
             const Tensor<2, 3>  &inverse_diagonal,
             const Tensor<1, 3>  &force, // residual + D x
             ContactState        &state);


  /// Multipliers that bound the error: those of fit_multipliers() but for
  /// the points listed.
  struct Certificate
  {
    Vector<double> force;
    /// sum of rho |s| - lambda . s over all ranks, an energy.
    double                                             defect = 0.;
    std::vector<std::pair<unsigned int, Tensor<1, 2>>> replaced;
  };

  /// A point that has hardly begun to slip in the plane has a direction s/|s|
  /// blurred by rounding: its multiplier rho s/|s| misses the residual by more
  /// than its slip is worth. There the clipped residual is the better
  /// multiplier, at the price of a small defect of complementarity. A miss of
  /// more than 1e-5 of the bound is not rounding, unless the slip is as small
  /// as
  /// @p rounding, an error in the energy norm, makes it. Where pieces meet, one
  /// may push along what the other holds with forces far above those of the
  /// body: multipliers are turned by up to 1e-9 there. An obstacle that gives
  /// way gets a multiplier between its force and the residual, the nearer to
  /// the latter the stiffer it is. Collective.
  Certificate
  certify(const ContactLayout             &face,
          const Vector<double>            &residual,
          const std::vector<Tensor<2, 3>> &diagonal,
          const ContactState              &state,
          const Vector<double>            &force,
          double                           rounding);


  /// How the linear system of a Newton step treats the face: sticking points
  /// are held, slipping ones resist turning, obstacles that give way are
  /// springs. @p inverse_diagonal: of the blocks of the face matrix; a spring
  /// that is @p stiffest times as stiff is as good as stick.
  FaceTruncation
  make_truncation(const ContactLayout             &face,
                  const ContactState              &state,
                  const std::vector<Tensor<2, 3>> &inverse_diagonal,
                  const double                     stiffest = 1e10);

  /// Stiffness against turning slip: rho/|s| (I - s s^T/|s|^2), limited.
  Tensor<2, 3>
  turning_spring(const ContactLayout             &face,
                 const unsigned int               node,
                 const ContactState              &state,
                 const std::vector<Tensor<2, 3>> &inverse_diagonal,
                 const double                     stiffest = 1e10);
} // namespace Viscoplastic
