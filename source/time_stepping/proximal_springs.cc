// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/contact/kink_search.h>
#include <viscoplastic_contact/time_stepping/proximal_springs.h>

#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    /// The stiffness of springs, relative to the diagonal of the matrix. Each
    /// solve of the step reduces their forces by about this factor; softer ones
    /// would magnify rounding of resultants beyond what StepSolver counts as
    /// rounding.
    constexpr double spring_stiffness = 1e-3;
    /// Rounding of loads, relative to the diagonal times the displacement.
    constexpr double rounding_of_forces = 1e-14;
    /// Rounding errors of a solve may remain in the springs, too, so that the
    /// error may be this times the rounding error.
    constexpr double rounding_margin = 2.;
    /// A body that still moves after this many solves is not held.
    constexpr unsigned int max_proximal_steps = 200;
    /// If the body has not come to rest after this many solves, something much
    /// softer than the springs holds it, such as a slender part that bends, and
    /// learned_step() is used.
    constexpr unsigned int first_learned_step = 4;
  } // namespace



  template <int dim>
  ProximalSprings<dim>::ProximalSprings(
    const Discretization<dim> &discretization)
    : discretization(discretization)
    , motions(discretization.space.motions_held_by_contact())
  {
    if (motions.empty())
      return;
    for (DistributedVector motion : motions) // a copy
      {
        for (const DistributedVector &other : orthonormal_motions)
          motion.add(-(motion * other), other);
        motion /= motion.l2_norm();
        orthonormal_motions.push_back(motion);
      }
    // Elimination with pivots: take the component that moves most in the
    // motions that earlier ones leave free.
    const ContactLayout &face = discretization.face->layout();
    const auto &positions     = discretization.face_restriction().positions();
    std::vector<Vector<double>> left;
    for (const DistributedVector &motion : motions)
      left.push_back(discretization.face_restriction().gather(motion));
    const MPI_Comm communicator = discretization.space.communicator;
    while (!left.empty())
      {
        double       largest = 0.;
        unsigned int pivot   = 0;
        for (unsigned int node = 0; node < face.n_nodes(); ++node)
          for (unsigned int k = face.first_dof[node];
               k < face.first_dof[node + 1];
               ++k)
            {
              double square = 0.;
              for (const Vector<double> &motion : left)
                square += motion[k] * motion[k];
              // Avoid nodes where pieces push against each other.
              if (face.node_points(node).size() > 1 &&
                  !face.has_plain_friction(node))
                square *= 0.1;
              // Of equal components take the first.
              if (square > (1. + 1e-10) * largest)
                {
                  largest = square;
                  pivot   = k;
                }
            }
        const auto of_ranks = Utilities::MPI::all_gather(communicator, largest);
        unsigned int rank   = 0;
        for (unsigned int i = 1; i < of_ranks.size(); ++i)
          if (of_ranks[i] > (1. + 1e-10) * of_ranks[rank])
            rank = i;
        std::vector<double> row(left.size(), 0.);
        if (rank == Utilities::MPI::this_mpi_process(communicator))
          {
            supports.push_back(positions[pivot]);
            for (unsigned int i = 0; i < left.size(); ++i)
              row[i] = left[i][pivot];
          }
        row = Utilities::MPI::broadcast(communicator, row, rank);
        // Keep the motions in which this component does not move.
        const unsigned int most =
          std::max_element(row.begin(),
                           row.end(),
                           [](const double a, const double b) {
                             return std::abs(a) < std::abs(b);
                           }) -
          row.begin();
        const Vector<double> out = left[most];
        for (unsigned int i = 0; i < left.size(); ++i)
          if (i != most && out.size() > 0)
            left[i].add(-row[i] / row[most], out);
        left.erase(left.begin() + most);
      }
  }



  template <int dim>
  const DistributedMatrix &
  ProximalSprings<dim>::attach(const DistributedMatrix &matrix)
  {
    const AdmissibleSpace<dim> &space = discretization.space;
    singular_matrix                   = &matrix;
    regular_matrix                    = matrix;
    springs                           = space.owned_vector();
    rounding = std::numeric_limits<double>::epsilon() / spring_stiffness;
    for (const unsigned int i : supports)
      {
        springs.begin()[i] = spring_stiffness * matrix.diagonal(i);
        regular_matrix.add_to_diagonal(i, springs.begin()[i]);
      }

    // Rigid motions must need little force besides that of the springs.
    DistributedVector force(springs), held(springs);
    for (const DistributedVector &motion : motions)
      {
        matrix.vmult(force, motion);
        force.scale(motion);
        held = springs;
        held.scale(motion);
        if (!(force.l2_norm() <= 0.1 * (motion * held)))
          refuse(
            "The stiffness of the body differs so much from place to place "
            "that its rigid motions, which only contact prevents, are lost in "
            "rounding. Let materials differ by less (a factor of 1e8 is safe), "
            "or prescribe displacements where the body is stiff.");
      }
    return regular_matrix;
  }



  template <int dim>
  double
  ProximalSprings<dim>::learned_step(const DistributedVector &last_center,
                                     const DistributedVector &center,
                                     const DistributedVector &last_change,
                                     const DistributedVector &change) const
  {
    DistributedVector way(center), fall(last_change), of_springs(springs);
    of_springs.scale(change);
    // Beyond the minimum the springs press the body onto what holds it, so that
    // it is near its final place.
    if (!(last_change * of_springs > 0.))
      return 0.;
    way -= last_center;
    fall -= change;
    of_springs = springs;
    of_springs.scale(fall);
    const double square = fall * of_springs;
    return square > 0. ? (way * of_springs) / square : 0.;
  }



  template <int dim>
  HeldBody
  ProximalSprings<dim>::held_body(const StepProblem<dim> &problem) const
  {
    HeldBody body{discretization.face->layout(), {}, {}};
    for (const DistributedVector &motion : motions)
      {
        body.motions.push_back(
          discretization.face->restriction().gather(motion));
        double work = 0., parts = 0.;
        for (std::size_t i = 0; i < motion.locally_owned_size(); ++i)
          {
            const double part =
              problem.load.values.begin()[i] * motion.begin()[i];
            work += part;
            parts += std::abs(part);
          }
        body.load.push_back(body.face.sum(work));
        body.load_size = std::max(body.load_size, body.face.sum(parts));
      }
    return body;
  }



  template <int dim>
  Statics
  ProximalSprings<dim>::statics(const StepProblem<dim>    &problem,
                                const std::vector<double> &bounds,
                                const bool                 with_pressure) const
  {
    std::vector<std::vector<double>> bounds_of_pressure;
    if (with_pressure)
      bounds_of_pressure =
        discretization.face->bounds_of_pressure(problem.time_step.t,
                                                problem.slip_rates);
    // Bounds that follow from computed pressures are only as accurate as the
    // solves.
    const double accuracy =
      with_pressure || !discretization.face->has_computed_pressure() ? 1e-9 :
                                                                       1e-6;
    return balance(held_body(problem), bounds, bounds_of_pressure, accuracy);
  }



  template <int dim>
  std::vector<double>
  ProximalSprings<dim>::bounds_that_hold(
    const StepProblem<dim>    &problem,
    const std::vector<double> &bounds) const
  {
    const ContactFace<dim> &face    = *discretization.face;
    const bool              follows = problem.bounds_follow_pressure;
    // Bounds that follow the pressure of the step are examined first.
    const auto with_pressure = [&] {
      return statics(problem, follows ? problem.given_bounds : bounds, true);
    };
    const Statics own   = follows ? with_pressure() : Statics(),
                  given = statics(problem, bounds, false);
    if (own.is_balanced && given.is_balanced)
      return bounds;
    if (!follows || !own.is_balanced)
      refuse("No contact force balances the loads: they do work on a " +
             discretization.space.name_of_motion(follows ? own.motion :
                                                           given.motion) +
             " of the body, which contact that opens and friction cannot "
             "prevent. Let the loads press the body onto its foundation, or "
             "prescribe displacements that hold it." +
             (!follows && face.has_computed_pressure() &&
                  with_pressure().is_balanced ?
                " With the pressure of the step before, Coulomb's law has no "
                "friction in the step in which contact begins; 'Solver/Coulomb "
                "pressure' = Newton has." :
                ""));
    // Take the bounds of the pressures in the equilibrium found.
    ContactState        state(bounds);
    std::vector<double> result = problem.given_bounds;
    for (unsigned int p = 0; p < bounds.size(); ++p)
      state.multiplier[p][0] = own.pressures[p];
    face.add_computed_bounds(problem.time_step.t,
                             state,
                             result,
                             problem.slip_rates);
    for (const unsigned int p : face.layout().friction_points())
      result[p] = std::max(result[p], bounds[p]);
    return result;
  }



  template <int dim>
  bool
  ProximalSprings<dim>::rests(const StepProblem<dim>  &problem,
                              const HeldBody          &body,
                              const DistributedVector &right_side) const
  {
    const ContactLayout &face   = discretization.face->layout();
    double               pushes = 0.;
    bool                 moves  = false;
    for (const double work : body.load)
      moves |= std::abs(work) > 1e-10 * body.load_size;
    for (const unsigned int o : face.obstacles())
      moves |= problem.bounds[o] < 0.;
    for (const Tensor<1, 2> &multiplier : problem.old.state.contact.multiplier)
      pushes += multiplier.norm();
    return !face.any(moves) && face.sum(pushes) <= 1e-8 * right_side.l1_norm();
  }



  template <int dim>
  void
  ProximalSprings<dim>::settle_whole(const StepProblem<dim>  &problem,
                                     const HeldBody          &body,
                                     const ContactState      &contact,
                                     const DistributedVector &old_u,
                                     DistributedVector       &center,
                                     DistributedVector       &u) const
  {
    DistributedVector change(center);
    change -= old_u;
    const std::vector<double> way =
      settle(body,
             contact,
             discretization.face->slips(change, problem.foundation_step));
    for (unsigned int i = 0; i < motions.size(); ++i)
      {
        center.add(way[i], motions[i]);
        u.add(way[i], motions[i]);
      }
  }



  template <int dim>
  std::string
  ProximalSprings<dim>::restlessness(DistributedVector change,
                                     const double      left_by_rounding) const
  {
    std::ostringstream message;
    message << "The body that only contact holds has not come to rest in "
            << max_proximal_steps << " solves of a step";
    if (left_by_rounding > 0.)
      message << ", in which rounding leaves the error " << left_by_rounding
              << ": cells that are less flat, stiffness that differs less, "
                 "Poisson's ratio farther from 1/2 or prescribed displacements "
                 "mend that.";
    else
      {
        // Expand the last motion in the basis, last vector first, since each
        // orthonormal motion combines those up to it.
        std::vector<double> way(motions.size());
        for (std::size_t i = motions.size(); i-- > 0;)
          {
            way[i] = change * orthonormal_motions[i] /
                     (motions[i] * orthonormal_motions[i]);
            change.add(-way[i], motions[i]);
          }
        message << ": it goes on by a "
                << discretization.space.name_of_motion(way)
                << ". Even closed everywhere, contact and friction can hardly "
                   "balance the loads against that. Prescribe displacements "
                   "that hold the body, or end the run before.";
      }
    return message.str();
  }



  template <int dim>
  typename ProximalSprings<dim>::Held
  ProximalSprings<dim>::measure(const StepProblem<dim>  &problem,
                                const DistributedVector &right_side,
                                const double             tolerance,
                                const DistributedVector &u,
                                const DistributedVector &change,
                                const DistributedVector &whole,
                                ContactReport           &report) const
  {
    Held              held;
    DistributedVector force(springs);
    force.scale(change);
    held.in_springs = norm(change);
    // Norms of a body that moves on without end are nothing but rounding, but
    // in equilibrium the springs carry no forces.
    const double force_in_springs = force.l1_norm();
    singular_matrix->vmult(force, u);
    held.size =
      std::max(std::sqrt(std::max(0., u * force)), problem.former_size());
    held.in_balance =
      force_in_springs <=
        0.01 * std::max(force.l1_norm(), right_side.l1_norm()) ||
      held.in_springs <= rounding * norm(whole);
    report.error += held.in_springs;
    // For a body that moves without strain, under no loads but rounding of old
    // stresses, the rounding error is the only scale.
    force = springs;
    force.scale(whole);
    const double reference =
      right_side.l1_norm() >
          rounding_of_forces / spring_stiffness * force.l1_norm() ?
        held.size :
        std::max(held.size,
                 rounding_margin * report.rounding_error / tolerance);
    report.relative_error = reference > 0. ? report.error / reference : 0.;
    report.tolerance      = tolerance;
    return held;
  }



  template <int dim>
  ContactReport
  ProximalSprings<dim>::solve(const StepProblem<dim>  &problem,
                              const DistributedVector &right_side,
                              const double             tolerance,
                              const Solve             &solve,
                              DistributedVector       &u,
                              ContactState            &contact) const
  {
    // The error of inner solves is measured with the springs, relative to a
    // norm that includes the body's way to the foundation.
    ContactReport     report;
    double            inner_tolerance = tolerance, left_by_rounding = 0.;
    const HeldBody    body = held_body(problem);
    DistributedVector center(u), right(u), change(u), last_center, last_change;
    if (rests(problem, body, right_side))
      {
        // Remove the rigid part of the extrapolation in the first guess.
        change -= problem.old_u();
        u -= rigid_part(change);
        center = u;
      }
    // A rigid motion makes no strain, but its rounding would make forces that
    // soft ground does not tell from loads. So all displacements below are
    // relative to rigid_motion.
    DistributedVector old_u(problem.old_u()),
      rigid_motion = discretization.space.owned_vector();
    for (unsigned int n = 0; n < max_proximal_steps; ++n)
      {
        change = rigid_part(u);
        rigid_motion += change;
        for (DistributedVector *vector : {&u, &center, &old_u})
          *vector -= change;
        right = right_side;
        add_load(center, right);
        ContactReport again = solve(old_u, right, inner_tolerance);
        again.add_earlier(report);
        report           = again;
        left_by_rounding = report.relative_error > 1.01 * inner_tolerance ?
                             report.relative_error :
                             0.;

        change = u;
        change -= center;
        DistributedVector whole(center);
        whole += rigid_motion;
        const auto [in_springs, size, in_balance] =
          measure(problem, right_side, tolerance, u, change, whole, report);
        if (in_balance &&
            report.error <= std::max(tolerance * size,
                                     rounding_margin * report.rounding_error))
          {
            u += rigid_motion;
            return report;
          }
        if (in_springs < 0.5 * report.error)
          inner_tolerance *=
            std::clamp(0.3 * tolerance * size / report.error, 1e-3, 0.5);
        // Repeat the change: of a body on its way to the foundation, until it
        // touches; of one held by a soft part, soft ground or little friction,
        // until its energy has its minimum.
        singular_matrix->vmult(right, change);
        double step =
          repetitions({in_springs * in_springs, std::max(0., change * right)},
                      discretization.face->layout(),
                      contact,
                      discretization.face_restriction().gather(change));
        const bool learns = n >= first_learned_step;
        if (n + 1 >= first_learned_step)
          {
            if (learns)
              {
                const double learned =
                  learned_step(last_center, whole, last_change, change);
                step = learned > 0. ? std::max(step, learned - 1.) : 0.;
              }
            last_center = whole;
            last_change = change;
          }
        center = u;
        center.add(step, change);
        // Move a body on soft ground to where its loads balance as a whole,
        // which the springs would delay. Not with learned steps: these place
        // the springs well, but exaggerate the strains.
        if (discretization.face->has_normal_compliance() && !learns)
          settle_whole(problem, body, contact, old_u, center, u);
      }
    refuse(restlessness(change, left_by_rounding));
    return report;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(ProximalSprings);
} // namespace Viscoplastic
