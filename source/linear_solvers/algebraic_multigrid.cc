// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/linear_solvers/algebraic_multigrid.h>

#include <Epetra_Import.h>
#include <Epetra_Vector.h>

#include <cmath>

namespace Viscoplastic
{
  AlgebraicMultigrid::AlgebraicMultigrid(
    const DistributedMatrix       &matrix,
    std::vector<bool>              excluded_,
    std::vector<DistributedVector> rigid_body_modes_,
    const FaceRestriction         &restriction,
    const unsigned int             dim)
    : matrix(matrix)
    , excluded(std::move(excluded_))
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



  std::unique_ptr<SmoothedAggregation>
  AlgebraicMultigrid::make(const FaceTruncation &truncation) const
  {
    // Components that are cut off: excluded ones, and those of the face that
    // are blocked by themselves, such as the normal one of a node that slips on
    // the foundation.
    const Epetra_CrsMatrix &K = matrix.trilinos_matrix();
    Epetra_Vector           keep(K.DomainMap());
    for (std::size_t i = 0; i < excluded.size(); ++i)
      keep[i] = excluded[i] ? 0. : 1.;
    for (unsigned int n = 0; n < truncation.projector.size(); ++n)
      for (unsigned int i = 0; i < face.n_node_dofs(n); ++i)
        if (truncation.projector[n][i][i] == 0.)
          keep[restriction.positions()[face.first_dof[n] + i]] = 0.;
    Epetra_Vector keep_column(K.ColMap());
    if (K.Importer() != nullptr)
      keep_column.Import(keep, *K.Importer(), Insert);
    else
      keep_column = keep;

    auto masked_matrix = std::make_unique<DistributedMatrix>();
    masked_matrix->copy_from(matrix);
    const Epetra_CrsMatrix &M = masked_matrix->trilinos_matrix();
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
    if (truncation.has_springs(face))
      {
        const std::vector<types::global_dof_index> &dofs = restriction.dofs();
        for (unsigned int n = 0; n < face.n_nodes(); ++n)
          for (unsigned int i = 0; i < face.n_node_dofs(n); ++i)
            for (unsigned int j = 0; j < face.n_node_dofs(n); ++j)
              {
                const unsigned int first = face.first_dof[n];
                if (truncation.spring[n][i][j] != 0.)
                  masked_matrix->add(dofs[first + i],
                                     dofs[first + j],
                                     truncation.spring[n][i][j]);
              }
        masked_matrix->compress(VectorOperation::add);
      }

    const std::size_t   n = excluded.size();
    std::vector<double> near_null_space(n * rigid_body_modes.size());
    for (unsigned int m = 0; m < rigid_body_modes.size(); ++m)
      for (std::size_t i = 0; i < n; ++i)
        near_null_space[m * n + i] = rigid_body_modes[m].begin()[i] * keep[i];

    return std::make_unique<SmoothedAggregation>(std::move(masked_matrix),
                                                 std::move(near_null_space),
                                                 dim);
  }



  void
  AlgebraicMultigrid::build()
  {
    amg.reset(); // before there is another one: memory
    amg             = make(truncation);
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

    const bool is_outdated =
      !built_for.blocks_as(truncation, face) || has_springs;
    if (!amg || (may_rebuild && lost_iterations > price() && is_outdated))
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
  }



  void
  AlgebraicMultigrid::vmult_whole(DistributedVector       &y,
                                  const DistributedVector &x) const
  {
    if (!whole)
      whole = make(FaceTruncation());
    whole->vmult(y, x);
  }



  unsigned int
  AlgebraicMultigrid::iterations_for_whole() const
  {
    return price();
  }



  unsigned int
  AlgebraicMultigrid::price() const
  {
    // A set-up takes 1.2 (2D) to 2.2 (3D) solves of about 15.
    return dim == 2 ? 20 : 30;
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
    wanted.check_belongs_to(face);
    truncation  = wanted;
    has_springs = truncation.has_springs(face);
    if (!amg || !built_for.is_same_as(wanted, face))
      build();
    best_rate       = state->best_rate;
    lost_iterations = state->lost_iterations;
    is_fresh        = state->is_fresh;
  }
} // namespace Viscoplastic
