// SPDX-License-Identifier: LGPL-2.1-or-later
#include "krylov_solve.h"
#include <viscoplastic_contact/base/messages.h>

namespace Viscoplastic
{
  KrylovSolver::KrylovSolver(const DistributedMatrix        &matrix,
                             const std::vector<bool>        &excluded,
                             const FaceRestriction          &restriction,
                             std::unique_ptr<Preconditioner> preconditioner_)
    : matrix(matrix)
    , excluded(excluded)
    , restriction(restriction)
    , face(restriction.face())
    , preconditioner(std::move(preconditioner_))
  {
    for (std::size_t i = 0; i < excluded.size(); ++i)
      if (excluded[i])
        excluded_entries.push_back(i);
    if (restriction.n_global_dofs() > 0)
      make_face_matrix();
  }



  bool
  KrylovSolver::renew(const DistributedMatrix &of)
  {
    if (&of != &matrix || !preconditioner->renew())
      return false;
    if (restriction.n_global_dofs() > 0)
      make_face_matrix();
    return true;
  }



  std::unique_ptr<ContactSolve>
  KrylovSolver::begin(const DistributedVector &load,
                      DistributedVector       &u,
                      const SolutionScale     &scale)
  {
    return std::make_unique<Solve>(*this, load, u, scale);
  }



  BulkSolver::Report
  KrylovSolver::solve(const DistributedVector &load,
                      DistributedVector       &u,
                      const double             tolerance,
                      const SolutionScale     &scale)
  {
    Solve          solve(*this, load, u, scale);
    FaceTruncation free_face;
    Tensor<2, 3>   identity;
    for (unsigned int d = 0; d < 3; ++d)
      identity[d][d] = 1.;
    free_face.projector.assign(face.n_nodes(), identity);
    free_face.spring.assign(face.n_nodes(), Tensor<2, 3>());
    solve.set_truncation(free_face, /* may_rebuild = */ true);

    const Vector<double> no_force(face.n_dofs());
    unsigned int         iterations = 0;
    Vector<double>       face_part(face.n_dofs());
    for (unsigned int pass = 0; pass < 20; ++pass)
      {
        const double error = pass == 0 ? solve.truncated_dual_norm(no_force) :
                                         solve.dual_norm(no_force);
        // From zero, the first solution sets the scale.
        const double size = solve.size();
        const double left = std::max(tolerance * size, scale.rounding_error);
        if (error <= left)
          return {iterations, left};
        iterations +=
          solve.correct(no_force,
                        size > 0. ?
                          std::min(0.3, 0.3 * tolerance * size / error) :
                          0.3 * tolerance,
                        face_part);
        solve.search_terms(face_part);
        solve.take_step(1.);
      }
    refuse("The linear solver stagnates above the relative error " +
           as_text(tolerance) + ".");
    return {};
  }
} // namespace Viscoplastic
