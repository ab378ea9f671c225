// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/trilinos_precondition.h>

#include <viscoplastic_contact/linear_solvers/krylov_solver.h>

#include <Epetra_Import.h>
#include <Epetra_Vector.h>
#include <Teuchos_ParameterList.hpp>
#include <ml_MultiLevelPreconditioner.h>
#include <ml_utils.h>

#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <utility>

namespace Viscoplastic
{
  namespace
  {
    constexpr unsigned int max_cg_iterations = 5000;
  }



  /// P (K + springs) P on vectors of the truncated space.
  struct KrylovSolver::TruncatedOperator
  {
    const KrylovSolver &solver;

    void
    vmult(DistributedVector &y, const DistributedVector &x) const
    {
      solver.matrix.vmult(y, x);
      if (solver.has_springs)
        solver.restriction.add_springs(solver.truncation, x, y);
      solver.restrict_to_unknowns(y);
      solver.restriction.project(solver.truncation, y);
    }
  };



  /**
   * P D M^{-1} D P: the multigrid cycle, filtered by the truncation. The factor
   * D^2 = diag(K + springs known to M)/diag(K + springs), at most 1, tends to 0
   * for a point that comes to rest, so that stiff new springs do not spoil a
   * preconditioner that does not know them.
   */
  struct KrylovSolver::FilteredPreconditioner
  {
    const KrylovSolver       &solver;
    mutable DistributedVector filtered;
    Vector<double>            damping; // of owned face entries

    explicit FilteredPreconditioner(const KrylovSolver &solver)
      : solver(solver)
      , filtered(solver.residual)
    {
      if (!solver.has_springs)
        return;
      damping.reinit(solver.face.n_dofs());
      for (const auto &entry : solver.restriction.owned_entries())
        damping[entry.k] =
          solver.matrix.diag_element(solver.restriction.dofs()[entry.k]);
      for (unsigned int n = 0; n < solver.face.n_nodes(); ++n)
        for (unsigned int i = 0; i < solver.face.n_node_dofs(n); ++i)
          {
            double &d = damping[solver.face.first_dof[n] + i];
            if (d == 0.)
              continue; // of another rank
            const double known   = d + solver.built_for.spring[n][i][i],
                         present = d + solver.truncation.spring[n][i][i];
            d                    = std::sqrt(std::min(1., known / present));
          }
    }

    void
    damp(DistributedVector &v) const
    {
      if (damping.size() > 0)
        for (const auto &entry : solver.restriction.owned_entries())
          v.begin()[entry.i] *= damping[entry.k];
    }

    void
    vmult(DistributedVector &y, const DistributedVector &x) const
    {
      filtered = x;
      damp(filtered);
      solver.precondition(y, filtered);
      damp(y);
      solver.restrict_to_unknowns(y);
      solver.restriction.project(solver.truncation, y);
    }
  };



  KrylovSolver::KrylovSolver(const DistributedMatrix       &matrix,
                             const std::vector<bool>       &excluded,
                             std::vector<DistributedVector> rigid_body_modes_,
                             const FaceRestriction         &restriction,
                             const unsigned int             dim)
    : matrix(matrix)
    , excluded(excluded)
    , rigid_body_modes(std::move(rigid_body_modes_))
    , restriction(restriction)
    , face(restriction.face())
    , dim(dim)
    , communicator(matrix.get_mpi_communicator())
    , residual(rigid_body_modes[0])
    , w(residual)
    , product(residual)
  {
    for (std::size_t i = 0; i < excluded.size(); ++i)
      if (excluded[i])
        excluded_entries.push_back(i);
    if (face.n_dofs() > 0)
      make_face_matrix();
  }



  KrylovSolver::~KrylovSolver() = default;



  void
  KrylovSolver::make_face_matrix()
  {
    // Rows of owned face entries, gathered on all ranks: the face is small.
    std::map<types::global_dof_index, unsigned int> face_index;
    for (unsigned int k = 0; k < face.n_dofs(); ++k)
      face_index[restriction.dofs()[k]] = k;
    // Not by the iterators of the matrix, each of which fills a vector of the
    // size of the whole matrix.
    const Epetra_CrsMatrix              &K = matrix.trilinos_matrix();
    std::vector<SparseFaceMatrix::Entry> entries;
    for (const auto &entry : restriction.owned_entries())
      {
        int     length, *indices;
        double *values;
        K.ExtractMyRowView(static_cast<int>(entry.i), length, values, indices);
        for (int e = 0; e < length; ++e)
          {
            const auto column = face_index.find(
              static_cast<types::global_dof_index>(K.GCID(indices[e])));
            if (column != face_index.end())
              entries.push_back({entry.k, column->second, values[e]});
          }
      }
    std::vector<SparseFaceMatrix::Entry> all;
    for (const auto &part : Utilities::MPI::all_gather(communicator, entries))
      all.insert(all.end(), part.begin(), part.end());
    sparse_face_matrix =
      std::make_unique<SparseFaceMatrix>(face, std::move(all));
  }



  std::string
  KrylovSolver::name() const
  {
    return "conjugate gradients with algebraic multigrid (ML)";
  }



  std::optional<PreconditionerState>
  KrylovSolver::preconditioner_state() const
  {
    if (!amg)
      return {};
    return PreconditionerState{built_for, best_rate, lost_iterations, is_fresh};
  }



  void
  KrylovSolver::restore(const std::optional<PreconditionerState> &state)
  {
    if (!state)
      {
        amg.reset();
        truncation = built_for = FaceTruncation();
        has_springs            = false;
        best_rate = lost_iterations = 0.;
        is_fresh                    = false;
        return;
      }
    const FaceTruncation &wanted = state->built_for;
    AssertThrow(wanted.projector.size() == face.n_nodes() &&
                  wanted.spring.size() == face.n_nodes(),
                ExcMessage("The state of the preconditioner belongs to another "
                           "contact face."));
    truncation  = wanted;
    has_springs = truncation.has_springs();
    if (!amg || built_for.projector != wanted.projector ||
        built_for.spring != wanted.spring)
      build_preconditioner();
    best_rate       = state->best_rate;
    lost_iterations = state->lost_iterations;
    is_fresh        = state->is_fresh;
  }



  void
  KrylovSolver::restrict_to_unknowns(DistributedVector &v) const
  {
    double *entry = v.begin();
    for (const std::size_t i : excluded_entries)
      entry[i] = 0.;
  }



  void
  KrylovSolver::build_preconditioner()
  {
    // Components that are cut off: excluded ones, and the face components of
    // nodes that stick altogether.
    const Epetra_CrsMatrix &K = matrix.trilinos_matrix();
    Epetra_Vector           keep(K.DomainMap());
    for (std::size_t i = 0; i < excluded.size(); ++i)
      keep[i] = excluded[i] ? 0. : 1.;
    Vector<double> cut_off(face.n_dofs());
    for (unsigned int n = 0; n < truncation.projector.size(); ++n)
      {
        const unsigned int first = face.first_dof[n],
                           end   = face.first_dof[n + 1];
        bool sticks              = true;
        for (unsigned int i = 0; i < end - first; ++i)
          sticks &= truncation.projector[n][i][i] == 0.;
        if (sticks)
          std::fill(cut_off.begin() + first, cut_off.begin() + end, 1.);
      }
    for (const auto &entry : restriction.owned_entries())
      if (cut_off[entry.k] == 1.)
        keep[entry.i] = 0.;
    Epetra_Vector keep_column(K.ColMap());
    if (K.Importer() != nullptr)
      keep_column.Import(keep, *K.Importer(), Insert);
    else
      keep_column = keep;

    masked_matrix.copy_from(matrix);
    const Epetra_CrsMatrix &M = masked_matrix.trilinos_matrix();
    for (int i = 0; i < M.NumMyRows(); ++i)
      {
        int     length, *indices;
        double *values;
        M.ExtractMyRowView(i, length, values, indices);
        for (int e = 0; e < length; ++e)
          if (M.GCID(indices[e]) != M.GRID(i))
            values[e] *= keep[i] * keep_column[indices[e]];
      }

    // The springs of slipping points, which the cut-off rows do not have.
    if (has_springs)
      {
        const std::vector<types::global_dof_index> &dofs = restriction.dofs();
        for (unsigned int n = 0; n < face.n_nodes(); ++n)
          for (unsigned int i = 0; i < face.n_node_dofs(n); ++i)
            for (unsigned int j = 0; j < face.n_node_dofs(n); ++j)
              {
                const unsigned int first = face.first_dof[n];
                if (masked_matrix.in_local_range(dofs[first + i]) &&
                    truncation.spring[n][i][j] != 0.)
                  masked_matrix.add(dofs[first + i],
                                    dofs[first + j],
                                    truncation.spring[n][i][j]);
              }
        masked_matrix.compress(VectorOperation::add);
      }

    // ML shifts the diagonal of the coarsest matrix by 1e-12, whatever the unit
    // of stress is. A power of two changes no digit.
    double largest = 0.;
    for (const auto row : masked_matrix.locally_owned_range_indices())
      largest = std::max(largest, masked_matrix.diag_element(row));
    largest  = Utilities::MPI::max(largest, communicator);
    amg_unit = largest > 1e-6 && largest < 1e18 ?
                 1. :
                 std::ldexp(1., std::ilogb(largest));
    if (amg_unit != 1.)
      masked_matrix /= amg_unit;

    // A contiguous copy of the rigid body modes, which ML refers to.
    const std::size_t n = excluded.size();
    near_null_space.resize(
      std::max<std::size_t>(1, n * rigid_body_modes.size())); // never null
    for (unsigned int m = 0; m < rigid_body_modes.size(); ++m)
      for (std::size_t i = 0; i < n; ++i)
        near_null_space[m * n + i] = rigid_body_modes[m].begin()[i] * keep[i];

    Teuchos::ParameterList parameters;
    ML_Epetra::SetDefaults("SA", parameters);
    parameters.set("ML output", 0);
    parameters.set("PDE equations", static_cast<int>(dim));
    parameters.set("aggregation: type", "Uncoupled");
    parameters.set("aggregation: threshold", 0.);
    parameters.set("smoother: type", "Chebyshev");
    parameters.set("smoother: sweeps", 2);
    parameters.set("smoother: Chebyshev alpha", 20.);
    parameters.set("coarse: type", "Amesos-KLU");
    parameters.set("coarse: max size", 2000);
    parameters.set("null space: type", "pre-computed");
    parameters.set("null space: dimension",
                   static_cast<int>(rigid_body_modes.size()));
    parameters.set("null space: vectors", near_null_space.data());
    // The vectors from which ML estimates eigenvalues are random: always the
    // same ones, or a set-up would depend on how many there were before.
    ML_set_random_seed(
      1 + static_cast<int>(Utilities::MPI::this_mpi_process(communicator)));
    amg = std::make_unique<TrilinosWrappers::PreconditionAMG>();
    amg->initialize(masked_matrix, parameters);
    built_for       = truncation;
    is_fresh        = true;
    lost_iterations = 0.;
  }



  void
  KrylovSolver::precondition(DistributedVector       &y,
                             const DistributedVector &x) const
  {
    amg->vmult(y, x);
    if (amg_unit != 1.)
      y /= amg_unit;
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
        if (error <= std::max(tolerance * energy_norm(), rounding_error()))
          return iterations;
        // The first solution sets the scale of a start from zero.
        const double size = energy_norm();
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
    if (change.linfty_norm() == 0.)
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
    has_springs = truncation.has_springs();

    // What ML costs in iterations of this solver: a set-up takes 1.2 (2D) to
    // 2.2 (3D) solves of about 15.
    const double price       = dim == 2 ? 20. : 30.;
    const bool   is_outdated = !(built_for == truncation) || has_springs;
    if (!amg || (may_rebuild && lost_iterations > price && is_outdated))
      build_preconditioner();
  }



  double
  KrylovSolver::dual_norm(const Vector<double> &force)
  {
    // Not filtered by the truncation: the residual on sticking components, if
    // any, is an error, too.
    product = residual;
    restriction.add(-1., force, product);
    precondition(w, product);
    restrict_to_unknowns(w);
    return std::sqrt(std::max(0., w * product));
  }



  double
  KrylovSolver::confirmed_dual_norm(const Vector<double> &force,
                                    unsigned int         &iterations)
  {
    // A hierarchy for another stick set misjudges residuals on the face, so
    // solve A w = R on all unknowns: w . R is the square of the norm up to the
    // square of the error.
    FaceTruncation none;
    std::swap(truncation, none);
    const bool springs = std::exchange(has_springs, false);
    product            = residual;
    restriction.add(-1., force, product);
    w           = 0.;
    double norm = 0.;
    if (product.l2_norm() > 0.)
      {
        ReductionControl            control(max_cg_iterations, 0., 0.1);
        SolverCG<DistributedVector> cg(control);
        try
          {
            cg.solve(TruncatedOperator{*this},
                     w,
                     product,
                     FilteredPreconditioner(*this));
            norm = std::sqrt(std::max(0., w * product));
          }
        catch (const SolverControl::NoConvergence &)
          {
            norm = std::numeric_limits<double>::infinity();
          }
        iterations += control.last_step();
      }
    std::swap(truncation, none);
    has_springs = springs;
    return norm;
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
    restriction.project(truncation, product);
    w                 = 0.;
    const double size = product.l2_norm();
    face_part         = 0.;
    if (size == 0.)
      return 0;

    ReductionControl            control(max_cg_iterations, 0., tolerance);
    SolverCG<DistributedVector> cg(control);
    try
      {
        cg.solve(TruncatedOperator{*this},
                 w,
                 product,
                 FilteredPreconditioner(*this));
      }
    catch (const SolverControl::NoConvergence &failure)
      {
        AssertThrow(std::isfinite(failure.last_residual),
                    ExcMessage("The conjugate gradient method met a value that "
                               "is not finite."));
        AssertThrow(failure.last_residual < 0.5 * size,
                    ExcMessage("The conjugate gradient method does not "
                               "converge; for nearly incompressible bodies use "
                               "'Solver/Linear solver' = direct."));
      }
    face_part = restriction.gather(w);

    const double decades =
      std::log10(size / std::max(control.last_value(), 1e-16 * size));
    if (decades > 0.)
      {
        const double rate = control.last_step() / decades;
        if (is_fresh)
          best_rate = best_rate == 0. ? rate : std::min(best_rate, rate);
        is_fresh = false;
        lost_iterations +=
          std::max(0., control.last_step() - best_rate * decades);
      }
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
  KrylovSolver::take_step(const double step)
  {
    // K w = product; both are zero or irrelevant on excluded components.
    u->add(step, w);
    squared_norm += step * step * (product * w);
    restrict_to_unknowns(product);
    residual.add(-step, product);
  }



  unsigned int
  KrylovSolver::finish()
  {
    return 0;
  }
} // namespace Viscoplastic
