// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/solver_gmres.h>

#include <viscoplastic_contact/base/heartbeat.h>
#include <viscoplastic_contact/contact/sparse_face_matrix.h>
#include <viscoplastic_contact/linear_solvers/krylov_solver.h>
#include <viscoplastic_contact/linear_solvers/residual_rounding.h>

#include <Epetra_CrsMatrix.h>
#include <Epetra_Import.h>
#include <Epetra_IntVector.h>

#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

namespace Viscoplastic
{
  namespace
  {
    constexpr unsigned int max_cg_iterations = 5000;
  }



  /// P (K + springs) P on vectors of the truncated space; without a truncation
  /// K on all unknowns.
  struct KrylovSolver::TruncatedOperator
  {
    const KrylovSolver &solver;
    const bool          is_truncated;

    void
    vmult(DistributedVector &y, const DistributedVector &x) const
    {
      Heartbeat::count(Loop::linear);
      if (is_truncated && solver.truncation.transposed)
        {
          DistributedVector motion(x);
          solver.restriction.tilt_motions(solver.truncation, motion);
          multiply(y, motion);
        }
      else
        multiply(y, x);
      if (is_truncated)
        solver.restriction.tilt_equations(solver.truncation, y);
      if (is_truncated && solver.has_springs)
        solver.restriction.add_springs(solver.truncation, x, y);
      solver.restrict_to_unknowns(y);
      if (is_truncated)
        solver.restriction.project(solver.truncation, y);
    }

  private:
    void
    multiply(DistributedVector &y, const DistributedVector &x) const
    {
      // The residuals that decide are those of the matrix itself.
      if (!solver.preconditioner->vmult_matrix(y, x))
        solver.matrix.vmult(y, x);
    }
  };



  /// P M^{-1} P, likewise.
  struct KrylovSolver::TruncatedPreconditioner
  {
    const KrylovSolver &solver;
    const bool          is_truncated;
    const bool          is_whole = false;

    void
    vmult(DistributedVector &y, const DistributedVector &x) const
    {
      if (is_whole)
        solver.preconditioner->vmult_whole(y, x);
      else if (is_truncated)
        solver.preconditioner->vmult(y, x);
      else
        solver.preconditioner->vmult_untruncated(y, x);
      solver.restrict_to_unknowns(y);
      if (is_truncated)
        solver.restriction.project(solver.truncation, y);
    }
  };



  KrylovSolver::KrylovSolver(const DistributedMatrix        &matrix,
                             const std::vector<bool>        &excluded,
                             const FaceRestriction          &restriction,
                             std::unique_ptr<Preconditioner> preconditioner_)
    : matrix(matrix)
    , excluded(excluded)
    , restriction(restriction)
    , face(restriction.face())
    , communicator(matrix.get_mpi_communicator())
    , preconditioner(std::move(preconditioner_))
    , residual(matrix.locally_owned_range_indices(), communicator)
    , w(residual)
    , product(residual)
  {
    for (std::size_t i = 0; i < excluded.size(); ++i)
      if (excluded[i])
        excluded_entries.push_back(i);
    if (restriction.n_global_dofs() > 0)
      make_face_matrix();
  }



  KrylovSolver::~KrylovSolver() = default;



  bool
  KrylovSolver::renew(const DistributedMatrix &of)
  {
    if (&of != &matrix || !preconditioner->renew())
      return false;
    truncation  = FaceTruncation();
    has_springs = false;
    if (restriction.n_global_dofs() > 0)
      make_face_matrix();
    return true;
  }



  void
  KrylovSolver::make_face_matrix()
  {
    // Which columns are entries of the face, on whatever rank.
    const Epetra_CrsMatrix &K    = matrix.trilinos_matrix();
    constexpr int           none = -1;
    Epetra_IntVector        number(K.DomainMap());
    number.PutValue(none);
    for (unsigned int k = 0; k < face.n_dofs(); ++k)
      number[restriction.positions()[k]] =
        restriction.global_numbers().nth_index_in_set(k);
    Epetra_IntVector number_of_column(K.ColMap());
    if (K.Importer() != nullptr)
      number_of_column.Import(number, *K.Importer(), Insert);
    else
      number_of_column = number;

    // Not by the iterators of the matrix, each of which fills a vector of the
    // size of the whole matrix.
    std::vector<SparseFaceMatrix::Entry> entries;
    for (unsigned int k = 0; k < face.n_dofs(); ++k)
      {
        int     length, *indices;
        double *values;
        K.ExtractMyRowView(restriction.positions()[k], length, values, indices);
        for (int e = 0; e < length; ++e)
          if (number_of_column[indices[e]] != none)
            entries.push_back({k,
                               static_cast<types::global_dof_index>(
                                 number_of_column[indices[e]]),
                               values[e]});
      }
    sparse_face_matrix =
      std::make_unique<SparseFaceMatrix>(face,
                                         restriction.global_numbers(),
                                         std::move(entries));
  }



  std::string
  KrylovSolver::name() const
  {
    return "conjugate gradients with " + preconditioner->name();
  }



  std::optional<PreconditionerState>
  KrylovSolver::preconditioner_state() const
  {
    return preconditioner->state();
  }



  void
  KrylovSolver::restore(const std::optional<PreconditionerState> &state)
  {
    preconditioner->restore(state);
    truncation  = state ? state->built_for : FaceTruncation();
    has_springs = truncation.has_springs(face);
  }



  void
  KrylovSolver::restrict_to_unknowns(DistributedVector &v) const
  {
    double *entry = v.begin();
    for (const std::size_t i : excluded_entries)
      entry[i] = 0.;
  }



  unsigned int
  KrylovSolver::solve(const DistributedVector &load,
                      DistributedVector       &u,
                      const double             tolerance)
  {
    begin(load, u);
    FaceTruncation free_face;
    Tensor<2, 3>   identity;
    for (unsigned int d = 0; d < 3; ++d)
      identity[d][d] = 1.;
    free_face.projector.assign(face.n_nodes(), identity);
    free_face.spring.assign(face.n_nodes(), Tensor<2, 3>());
    set_truncation(free_face);

    const Vector<double> no_force(face.n_dofs());
    unsigned int         iterations = 0;
    Vector<double>       face_part(face.n_dofs());
    for (unsigned int pass = 0; pass < 20; ++pass)
      {
        const double error = dual_norm(no_force);
        // The first solution sets the scale of a start from zero.
        const double size = this->size();
        if (error <= std::max(tolerance * size, rounding_error()))
          return iterations;
        iterations +=
          correct(no_force,
                  size > 0. ? std::min(0.3, 0.3 * tolerance * size / error) :
                              0.3 * tolerance,
                  face_part);
        search_terms(face_part);
        take_step(1.);
      }
    std::ostringstream message;
    message << "The linear solver stagnates above the relative error "
            << tolerance << ".";
    AssertThrow(false, ExcMessage(message.str()));
    return iterations;
  }



  void
  KrylovSolver::begin(const DistributedVector &load_, DistributedVector &u_)
  {
    load = &load_;
    u    = &u_;
    matrix.vmult(residual, *u);
    squared_norm = *u * residual;
    residual.sadd(-1., 1., *load);
    restrict_to_unknowns(residual);
  }



  const FaceMatrix &
  KrylovSolver::face_matrix() const
  {
    return *sparse_face_matrix;
  }



  void
  KrylovSolver::face_residual(Vector<double> &r)
  {
    r = restriction.gather(residual);
  }



  void
  KrylovSolver::move_face(const Vector<double> &change)
  {
    if (!face.any(change.size() > 0 && change.linfty_norm() > 0.))
      return;
    w = 0.;
    restriction.set(change, w);
    matrix.vmult(product, w);
    take_step(1.);
  }



  void
  KrylovSolver::set_truncation(const FaceTruncation &truncation_,
                               const bool            may_rebuild)
  {
    truncation  = truncation_;
    has_springs = truncation.has_springs(face);
    preconditioner->set_truncation(truncation, may_rebuild);
  }



  double
  KrylovSolver::dual_norm(const Vector<double> &force)
  {
    // Not filtered by the truncation: the residual on sticking components, if
    // any, is an error, too.
    product = residual;
    restriction.add(-1., force, product);
    preconditioner->vmult_untruncated(w, product);
    restrict_to_unknowns(w);
    return std::sqrt(std::max(0., w * product));
  }



  double
  KrylovSolver::confirmed_dual_norm(const Vector<double> &force,
                                    const double          limit,
                                    unsigned int         &iterations)
  {
    product = residual;
    restriction.add(-1., force, product);
    return dual_norm_of_product(limit, iterations);
  }



  double
  KrylovSolver::rounding_of_residual()
  {
    return Viscoplastic::rounding_of_residual(
      matrix, *load, *u, [&](const DistributedVector &error) {
        product = error;
        restrict_to_unknowns(product);
        unsigned int iterations = 0;
        return Utilities::fixed_power<2>(
          dual_norm_of_product(std::numeric_limits<double>::infinity(),
                               iterations));
      });
  }



  double
  KrylovSolver::dual_norm_of_product(const double  limit,
                                     unsigned int &iterations)
  {
    // A preconditioner for another stick set misjudges residuals on the face,
    // so solve A w = R on all unknowns: w . R is the square of the norm less
    // the square of the error, which grows from step to step.
    // One that is made for all unknowns is worth its price where this takes
    // long; beginning again makes all of it the same after a restart.
    if (!(product.l2_norm() > 0.))
      return 0.;
    const auto square = [&](const DistributedVector &x) {
      return std::max(0., x * product);
    };
    const unsigned int patience =
      std::min(preconditioner->iterations_for_whole(), max_cg_iterations);
    for (const bool is_whole : {false, true})
      {
        w                         = 0.;
        bool             is_above = false;
        ReductionControl control(is_whole ? max_cg_iterations : patience,
                                 0.,
                                 0.1);
        SolverCG<DistributedVector> cg(control);
        if (std::isfinite(limit))
          cg.connect([&](const unsigned int, const double, const auto &x) {
            is_above = square(x) > Utilities::fixed_power<2>(limit);
            return is_above ? SolverControl::failure : SolverControl::success;
          });
        bool has_ended = true;
        try
          {
            cg.solve(TruncatedOperator{*this, false},
                     w,
                     product,
                     TruncatedPreconditioner{*this, false, is_whole});
          }
        catch (const SolverControl::NoConvergence &)
          {
            has_ended = is_above;
          }
        iterations += control.last_step();
        if (has_ended)
          return std::sqrt(square(w));
        if (patience == max_cg_iterations)
          break;
      }
    return std::numeric_limits<double>::infinity();
  }



  double
  KrylovSolver::energy_norm() const
  {
    // Of a translation it is rounding, of either sign.
    return std::sqrt(std::max(0., squared_norm));
  }



  unsigned int
  KrylovSolver::correct(const Vector<double> &force,
                        const double          tolerance,
                        Vector<double>       &face_part)
  {
    product = residual;
    restriction.add(-1., force, product);
    restriction.tilt_equations(truncation, product);
    restriction.project(truncation, product);
    w                 = 0.;
    const double size = product.l2_norm();
    face_part         = 0.;
    if (size == 0.)
      return 0;

    ReductionControl              control(max_cg_iterations, 0., tolerance);
    const TruncatedOperator       system{*this, true};
    const TruncatedPreconditioner inverse{*this, true};
    try
      {
        if (face.any(!truncation.tilt.empty()))
          SolverGMRES<DistributedVector>(
            control,
            SolverGMRES<DistributedVector>::AdditionalData(
              /* max_n_tmp_vectors = */ 50, /* right_preconditioning = */ true))
            .solve(system, w, product, inverse);
        else
          SolverCG<DistributedVector>(control).solve(system,
                                                     w,
                                                     product,
                                                     inverse);
      }
    catch (const SolverControl::NoConvergence &failure)
      {
        AssertThrow(std::isfinite(failure.last_residual),
                    ExcMessage("The conjugate gradient method met a value that "
                               "is not finite."));
        AssertThrow(failure.last_residual < 0.5 * size,
                    ExcMessage(
                      "The conjugate gradient method does not "
                      "converge; for nearly incompressible bodies use "
                      "'Solver/Linear solver' = direct, on one rank."));
      }
    restriction.tilt_motions(truncation, w);
    face_part = restriction.gather(w);

    preconditioner->learn(control.last_step(),
                          std::log10(size / std::max(control.last_value(),
                                                     1e-16 * size)));
    return control.last_step();
  }



  BulkSolver::SearchTerms
  KrylovSolver::search_terms(const Vector<double> &face_part)
  {
    restriction.set(face_part, w);
    matrix.vmult(product, w);
    return {residual * w, product * w};
  }



  void
  KrylovSolver::face_response(Vector<double> &response)
  {
    response = restriction.gather(product);
  }



  void
  KrylovSolver::take_step(const double step)
  {
    // K w = product, all rows of it; w is zero on excluded components.
    squared_norm += step * (2. * (*u * product) + step * (w * product));
    u->add(step, w);
    restrict_to_unknowns(product);
    residual.add(-step, product);
  }



  unsigned int
  KrylovSolver::finish()
  {
    return 0;
  }
} // namespace Viscoplastic
