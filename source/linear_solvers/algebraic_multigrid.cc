// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/lac/trilinos_precondition.h>

#include <viscoplastic_contact/linear_solvers/algebraic_multigrid.h>

#include <Epetra_Import.h>
#include <Epetra_Vector.h>
#include <Teuchos_ParameterList.hpp>
#include <ml_MultiLevelPreconditioner.h>
#include <ml_utils.h>

#include <cmath>
#include <utility>

namespace Viscoplastic
{
  AlgebraicMultigrid::AlgebraicMultigrid(
    const DistributedMatrix       &matrix,
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
    , damped(rigid_body_modes[0])
  {}



  AlgebraicMultigrid::~AlgebraicMultigrid() = default;



  std::string
  AlgebraicMultigrid::name() const
  {
    return "algebraic multigrid (ML)";
  }



  void
  AlgebraicMultigrid::build()
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
    for (unsigned int k = 0; k < face.n_dofs(); ++k)
      if (cut_off[k] == 1.)
        keep[restriction.positions()[k]] = 0.;
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
                if (truncation.spring[n][i][j] != 0.)
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
    largest = Utilities::MPI::max(largest, matrix.get_mpi_communicator());
    unit    = largest > 1e-6 && largest < 1e18 ?
                1. :
                std::ldexp(1., std::ilogb(largest));
    if (unit != 1.)
      masked_matrix /= unit;

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
    ML_set_random_seed(1 + static_cast<int>(Utilities::MPI::this_mpi_process(
                             matrix.get_mpi_communicator())));
    amg = std::make_unique<TrilinosWrappers::PreconditionAMG>();
    amg->initialize(masked_matrix, parameters);
    built_for       = truncation;
    is_fresh        = true;
    lost_iterations = 0.;
  }



  void
  AlgebraicMultigrid::make_damping()
  {
    damping.reinit(0);
    if (!has_springs)
      return;
    damping.reinit(face.n_dofs());
    for (unsigned int k = 0; k < face.n_dofs(); ++k)
      damping[k] = matrix.diag_element(restriction.dofs()[k]);
    for (unsigned int n = 0; n < face.n_nodes(); ++n)
      for (unsigned int i = 0; i < face.n_node_dofs(n); ++i)
        {
          double      &d       = damping[face.first_dof[n] + i];
          const double known   = d + built_for.spring[n][i][i],
                       present = d + truncation.spring[n][i][i];
          d                    = std::sqrt(std::min(1., known / present));
        }
  }



  void
  AlgebraicMultigrid::set_truncation(const FaceTruncation &truncation_,
                                     const bool            may_rebuild)
  {
    truncation  = truncation_;
    has_springs = truncation.has_springs(face);

    // What ML costs in iterations of conjugate gradients: a set-up takes 1.2
    // (2D) to 2.2 (3D) solves of about 15.
    const double price = dim == 2 ? 20. : 30.;
    const bool   is_outdated =
      !built_for.blocks_as(truncation, face) || has_springs;
    if (!amg || (may_rebuild && lost_iterations > price && is_outdated))
      build();
    make_damping();
  }



  void
  AlgebraicMultigrid::vmult(DistributedVector       &y,
                            const DistributedVector &x) const
  {
    const auto damp = [this](DistributedVector &v) {
      for (unsigned int k = 0; k < face.n_dofs(); ++k)
        v.begin()[restriction.positions()[k]] *= damping[k];
    };
    if (!has_springs)
      return vmult_untruncated(y, x);
    damped = x;
    damp(damped);
    vmult_untruncated(y, damped);
    damp(y);
  }



  void
  AlgebraicMultigrid::vmult_untruncated(DistributedVector       &y,
                                        const DistributedVector &x) const
  {
    amg->vmult(y, x);
    if (unit != 1.)
      y /= unit;
  }



  void
  AlgebraicMultigrid::learn(const unsigned int iterations, const double decades)
  {
    if (!(decades > 0.))
      return;
    const double rate = iterations / decades;
    if (is_fresh)
      best_rate = best_rate == 0. ? rate : std::min(best_rate, rate);
    is_fresh = false;
    lost_iterations += std::max(0., iterations - best_rate * decades);
  }



  std::optional<PreconditionerState>
  AlgebraicMultigrid::state() const
  {
    if (!amg)
      return {};
    return PreconditionerState{built_for, best_rate, lost_iterations, is_fresh};
  }



  void
  AlgebraicMultigrid::restore(const std::optional<PreconditionerState> &state)
  {
    if (!state)
      {
        amg.reset();
        truncation = built_for = FaceTruncation();
        has_springs            = false;
        damping.reinit(0);
        best_rate = lost_iterations = 0.;
        is_fresh                    = false;
        return;
      }
    const FaceTruncation &wanted = state->built_for;
    AssertThrow(!face.any(wanted.projector.size() != face.n_nodes() ||
                          wanted.spring.size() != face.n_nodes()),
                ExcMessage("The state of the preconditioner belongs to another "
                           "contact face."));
    truncation  = wanted;
    has_springs = truncation.has_springs(face);
    if (!amg || face.any(built_for.projector != wanted.projector ||
                         built_for.spring != wanted.spring))
      build();
    best_rate       = state->best_rate;
    lost_iterations = state->lost_iterations;
    is_fresh        = state->is_fresh;
  }
} // namespace Viscoplastic
