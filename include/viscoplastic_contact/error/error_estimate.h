// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cmath>

namespace Viscoplastic
{
  /// The error of a state by its causes, in the energy norm a(.,.)^{1/2} where
  /// nothing else is said.
  struct ErrorParts
  {
    /// The error of the mesh, see SpaceEstimator.
    double space = 0.;
    /// The error that meshes have left in the irreversible stress z and that
    /// the strain does not show: from rates at cell means, and from cells that
    /// have been refined since.
    double history = 0.;
    /// The error of the time steps up to now, (int E^-1 D : D)^{1/2}, with D
    /// the sum of their defects (see ErrorEstimator), and `swing', by squares.
    double time = 0.;
    /// The error of slip that has turned its direction within steps, and of
    /// friction bounds that follow the step before.
    double friction = 0.;
    /// The error of coarsening: (int E^-1 d : d)^{1/2} with d the change of z
    /// in coarsened cells, summed over the changes of the mesh.
    double transfer = 0.;
    /// The error of the iterations that solved the step.
    double algebraic = 0.;
    /// The error of the initial data.
    double initial = 0.;

    /// Whether the history error adds to the mesh error linearly, as with cell
    /// means, and not by squares: the error that former meshes have left is
    /// orthogonal to what the present mesh cannot resolve.
    bool history_adds = false;

    /// The error of the present mesh and of former ones together.
    double
    of_meshes() const
    {
      return history_adds ? space + history : std::hypot(space, history);
    }

    /// The sum, a bound by the triangle inequality.
    double
    total() const
    {
      return of_meshes() + time + friction + transfer + algebraic + initial;
    }

    /// Write to, or read from, an archive.
    template <typename Archive>
    void
    serialize(Archive &archive, const unsigned int)
    {
      archive &space &history &time &friction &transfer &algebraic &initial
        &history_adds;
    }
  };



  /// A quantity of interest, with its error.
  struct QuantityEstimate : public ErrorParts
  {
    double value = 0.;
    /// Corrections to be added to the value: the signed errors of the mesh and
    /// of the time steps, as far as their signs are known.
    double space_correction = 0., time_correction = 0.;
    /// If the quantity is a sum over the steps: the parts of both corrections
    /// that later steps can no longer change.
    double settled_space = 0., settled_time = 0.;
    /// The work of friction, under present bounds, of all slip of points that
    /// slip now; and its ratio to that of the last step.
    double slip_work = 0., slip_steps = 1.;
    /// The settled error of a force before relaxation, as of the time when
    /// points came to rest.
    double rest_space = 0.;
    /// The sum of absolute contributions of cells to the error of the mesh.
    double unsigned_space = 0.;
    /// The least mesh error that counts, as signs may cancel by chance.
    double space_at_least = 0.;
    /// The part of the present mesh error due to straight sides of curved
    /// bodies, and the unsigned errors at the boundary (BoundaryDefects).
    double of_sides = 0., of_boundary = 0.;
    /// Errors of slip that turns and of slip that comes to rest within steps
    /// (SlipDefects), summed over the steps.
    double turning = 0., resting = 0.;
    /// The increments of the last step: of `friction', and of `time' by data
    /// that oscillate within the step.
    double friction_indicator = 0.;
    /// a(w, w)^{1/2} of the dual solution w, and its own estimated error.
    double dual_norm = 0., dual_error = 0.;

    /// Write to, or read from, an archive.
    template <typename Archive>
    void
    serialize(Archive &archive, const unsigned int)
    {
      ErrorParts::serialize(archive, 0);
      archive &value &space_correction &time_correction &settled_space
        &settled_time &slip_work &slip_steps &rest_space &unsigned_space
          &space_at_least &of_sides &of_boundary &turning &resting &dual_norm
            &dual_error;
    }
  };



  /// All that is estimated of a state.
  struct ErrorEstimate : public ErrorParts
  {
    /// The estimate for the quantity of interest (`Error control/Quantity');
    /// zero without one.
    QuantityEstimate quantity;

    /// The variation of data within steps that their ends do not show, see
    /// swing_of_data(): root of the sum of squares over the steps.
    double swing = 0., swing_share = 0.;
    /// The increment of `time' in the last step.
    double time_indicator = 0.;
    /// The part of that increment that does not relax in a force J.
    double remembered_indicator = 0.;
    /// The share of earlier errors of a force that the last step leaves, by
    /// relaxation at constant strain.
    double remembered_share = 1.;
    /// The share of them that stress regains as the law resists strain.
    double remembered_gain = 0.;
    /// slip_begun() of the last step.
    double slip_begun = 0.;
    /// (sum_j (k_j/3) |du_j - du_{j-1}|^2)^{1/2}, the computable part of
    /// I^k(u')^{1/2}, (5.19); energy^{1/2} time^{-1/2}.
    double velocity_variation = 0.;
    /// a(u_h, u_h)^{1/2}.
    double energy_norm = 0.;
    /// a(du_n, du_n).
    double velocity_square = 0.;
    /// (int E^-1 dz : dz)^{1/2} of the change of z in the step.
    double irreversible_change = 0.;
    /// The sum of k |G| over all steps, in the same norm; and the time in which
    /// the last |G| alone makes that sum.
    double creep_path = 0., creep_time = 0.;
    /// The change of the state, relative to its size, since the space estimate
    /// was made, see TimeStepper::growth_since_estimate().
    double since_estimate = 0.;

    /// Write to, or read from, an archive all but the members for step control,
    /// which each step sets anew.
    template <typename Archive>
    void
    serialize(Archive &archive, const unsigned int)
    {
      ErrorParts::serialize(archive, 0);
      archive &quantity &swing &swing_share &time_indicator &velocity_variation
        &energy_norm &velocity_square &creep_path &creep_time &since_estimate
          &slip_begun;
    }
  };



  /// The largest errors and sizes over all steps of a run.
  struct ErrorSummary
  {
    /// The estimate with the largest total, and its time.
    ErrorParts largest;
    double     t = 0.;
    /// The largest size of the solution over the run: its energy norm, or the
    /// absolute value of the quantity.
    double size = 0.;

    /// Take a state at time t into account.
    void
    update(const ErrorParts &errors, const double size_at_t, const double at_t)
    {
      if (errors.total() > largest.total())
        {
          largest = errors;
          t       = at_t;
        }
      size = std::max(size, size_at_t);
    }

    /// 0 for a body that never deforms.
    double
    relative() const
    {
      return size > 0. ? largest.total() / size : 0.;
    }

    /// Write to, or read from, an archive.
    template <typename Archive>
    void
    serialize(Archive &archive, const unsigned int)
    {
      archive &largest &t &size;
    }
  };
} // namespace Viscoplastic
