// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/grid/grid_tools.h>

#include <viscoplastic_contact/time_stepping/proximal_springs.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Viscoplastic
{
  namespace
  {
    /// The springs of the proximal point method, relative to the diagonal of
    /// the matrix, of up to fifty nodes; more of them share it. What they carry
    /// is reduced by something like this factor each time that the step is
    /// solved.
    constexpr double spring_stiffness = 1e-4;
    /// A body that still moves after so many solves is not held.
    constexpr unsigned int max_proximal_steps = 200;



    /// The sum of a geometric series without its first term.
    double
    geometric_sum(const double ratio)
    {
      const double bounded = std::min(ratio, 0.99);
      return bounded / (1. - bounded);
    }
  } // namespace



  template <int dim>
  ProximalSprings<dim>::ProximalSprings(
    const Discretization<dim> &discretization)
    : discretization(discretization)
  {}



  template <int dim>
  const DistributedMatrix &
  ProximalSprings<dim>::attach(const DistributedMatrix &matrix)
  {
    const AdmissibleSpace<dim> &space = discretization.space;
    singular_matrix                   = &matrix;
    regular_matrix.copy_from(matrix);
    springs = space.owned_vector();
    // Of all of them together, whatever the mesh.
    const double n_nodes =
      Utilities::MPI::sum(static_cast<double>(
                            discretization.face->layout().n_nodes()),
                          space.communicator);
    const double stiffness = spring_stiffness * std::min(1., 50. / n_nodes);
    rounding               = std::numeric_limits<double>::epsilon() / stiffness;
    for (const unsigned int i : discretization.face_restriction().positions())
      {
        const auto   dof      = space.owned.nth_index_in_set(i);
        const double diagonal = matrix.diag_element(dof);
        springs.begin()[i]    = stiffness * diagonal;
        regular_matrix.set(dof, dof, diagonal + springs.begin()[i]);
      }
    regular_matrix.compress(VectorOperation::insert);
    return regular_matrix;
  }



  template <int dim>
  void
  ProximalSprings<dim>::add_load(const DistributedVector &u,
                                 DistributedVector       &load) const
  {
    DistributedVector force(springs);
    force.scale(u);
    load += force;
  }



  template <int dim>
  double
  ProximalSprings<dim>::norm(const DistributedVector &u) const
  {
    DistributedVector force(springs);
    force.scale(u);
    return std::sqrt(std::max(0., u * force));
  }



  template <int dim>
  double
  ProximalSprings<dim>::way_to_obstacles(const StepProblem<dim>  &problem,
                                         const ContactState      &contact,
                                         const DistributedVector &u,
                                         const DistributedVector &motion) const
  {
    const ContactFace<dim> &face = *discretization.face;
    DistributedVector       increment(u);
    increment -= problem.old_u();
    const auto here   = face.slips(increment);
    const auto steps  = face.slips(motion);
    double     result = std::numeric_limits<double>::max();
    for (unsigned int p = 0; p < here.size(); ++p)
      if (const ContactLayout::Point &point = face.layout().points[p];
          point.is_obstacle && steps[p][0] > 0.)
        {
          const double left = contact.bound[p] - here[p][0];
          // One that gives way ends nothing once it presses.
          if (!point.gives_way() || left > 0.)
            result = std::min(result, std::max(0., left) / steps[p][0]);
        }
    return Utilities::MPI::min(result, discretization.space.communicator);
  }



  template <int dim>
  ContactReport
  ProximalSprings<dim>::solve(const StepProblem<dim>  &problem,
                              const DistributedVector &right_side,
                              const double             tolerance,
                              const BulkSolver        &bulk,
                              const Solve             &solve,
                              DistributedVector       &u,
                              ContactState            &contact) const
  {
    // The error of the solver is measured with the springs, relative to a norm
    // in which the body's way to the foundation counts, too.
    ContactReport report;
    double        inner_tolerance = tolerance, last_in_springs = 0., reach = 0.;
    bool          goes_on = false;
    // Farther away rounding is all that there is.
    const auto box = GridTools::compute_bounding_box(
                       discretization.space.dof_handler.get_triangulation())
                       .get_boundary_points();
    const double longest_way =
      1e6 * box.first.distance(box.second) + 10. * u.linfty_norm();
    DistributedVector center(u), right(u), change(u);
    for (unsigned int n = 0; n < max_proximal_steps; ++n)
      {
        right = right_side;
        add_load(center, right);
        ContactReport again = solve(right, inner_tolerance);
        again.add_earlier(report);
        report = again;

        change = u;
        change -= center;
        right = springs;
        right.scale(change);
        const double in_springs = norm(change);
        // Of a way without end nothing but rounding is left in norms, but
        // forces that balance leave nothing in the springs.
        const double force_in_springs = right.l1_norm();
        singular_matrix->vmult(right, u);
        const double size = std::sqrt(std::max(0., u * right));
        const bool   in_balance =
          force_in_springs <=
            0.01 * std::max(right.l1_norm(), right_side.l1_norm()) ||
          in_springs <= rounding * norm(center);
        report.error += in_springs;
        if (in_balance &&
            report.error <= std::max(tolerance * size, bulk.rounding_error()))
          {
            report.relative_error = size > 0. ? report.error / size : 0.;
            report.tolerance      = tolerance;
            return report;
          }
        if (in_springs < 0.5 * report.error)
          inner_tolerance *=
            std::clamp(0.3 * tolerance * size / report.error, 1e-3, 0.5);
        // A body on its way to the foundation goes on as it goes, until it
        // touches it. One that is held comes to rest like a geometric series,
        // slowly where a soft part of itself or of the ground holds it; two
        // steps without a reach tell its ratio.
        const double ratio = in_springs / last_in_springs;
        if (n > 0 && (goes_on || reach == 0.))
          {
            goes_on = ratio > 0.99 && ratio < 1.1 && in_springs > 0.01 * size;
            reach   = goes_on                    ? 4. * reach + 3. :
                      reach == 0. && ratio > 0.2 ? geometric_sum(ratio) :
                                                   0.;
          }
        else
          reach = 0.;
        last_in_springs = in_springs;
        if (u.linfty_norm() > longest_way)
          break;
        center = u;
        center.add(goes_on ?
                     std::min(reach,
                              way_to_obstacles(problem, contact, u, change)) :
                     reach,
                   change);
      }
    AssertThrow(false,
                ExcMessage(
                  "No contact force balances the loads: where only "
                  "contact that opens and friction could hold it, the "
                  "body moves on without end. Let the loads press it "
                  "onto its foundation, or prescribe displacements "
                  "that hold it." +
                  std::string(
                    discretization.face->has_computed_pressure() &&
                        !problem.bounds_follow_pressure ?
                      " With the pressure of the step before, Coulomb's "
                      "law has no friction in the step in which contact "
                      "begins; 'Solver/Coulomb pressure' = fixed point "
                      "has." :
                      "")));
    return report;
  }



  template class ProximalSprings<2>;
  template class ProximalSprings<3>;
} // namespace Viscoplastic
