// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/contact/contact_iteration.h>
#include <viscoplastic_contact/contact/contact_solver.h>

#include <exception>

namespace Viscoplastic
{
  namespace
  {
    /// If no solution is found, it is approached by those for these parts of
    /// the friction coefficients, which are found to this tolerance.
    constexpr std::array<double, 4> parts_of_friction{{0., 0.25, 0.5, 0.75}};
    constexpr double                tolerance_of_parts = 1e-3;
  } // namespace



  ContactSolver::ContactSolver(const unsigned int max_iterations)
    : max_iterations(max_iterations)
  {}



  ContactReport
  ContactSolver::solve(ContactSolve        &bulk,
                       const ContactLayout &face,
                       const double         tolerance,
                       Vector<double>      &x,
                       ContactState        &state,
                       const CoulombLaw    *law) const
  {
    AssertDimension(x.size(), face.n_dofs());
    AssertDimension(state.n_points(), face.points.size());
    if (law == nullptr)
      return ContactIteration(bulk, face, tolerance, x, state, nullptr)
        .solve(max_iterations);
    const Vector<double> first_x(x);
    const ContactState   first(state);
    try
      {
        return ContactIteration(bulk, face, tolerance, x, state, law)
          .solve(max_iterations);
      }
    catch (const ExceptionBase &)
      {
        // Start without friction, and follow the solution as friction grows.
        const std::exception_ptr failure = std::current_exception();
        Vector<double>           back(first_x);
        face.add(-1., x, back);
        bulk.move_face(back);
        x     = first_x;
        state = first;
        try
          {
            for (const double part : parts_of_friction)
              {
                const CoulombLaw weaker = law->with_part(part);
                ContactIteration(bulk,
                                 face,
                                 std::max(tolerance, tolerance_of_parts),
                                 x,
                                 state,
                                 &weaker,
                                 part > 0.)
                  .iterate(max_iterations);
              }
            ContactReport report =
              ContactIteration(bulk, face, tolerance, x, state, law, true)
                .solve(max_iterations);
            if (report.doubt.empty())
              report.doubt = "from the last step no solution was found, but "
                             "one along those for smaller friction "
                             "coefficients";
            return report;
          }
        catch (const ExceptionBase &)
          {
            std::rethrow_exception(failure);
          }
      }
  }
} // namespace Viscoplastic
