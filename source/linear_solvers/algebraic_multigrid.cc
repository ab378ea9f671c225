// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/lac/dynamic_sparsity_pattern.h>

#include <viscoplastic_contact/linear_solvers/algebraic_multigrid.h>

#include <cmath>

namespace Viscoplastic
{
  namespace
  {
    /// Return a copy of @p matrix without the off-diagonal entries in rows and
    /// columns where @p keep_column is 0 instead of 1. Collective.
    std::unique_ptr<TrilinosWrappers::SparseMatrix>
    masked(const DistributedMatrix   &matrix,
           const std::vector<double> &keep_column,
           const unsigned int         dim)
    {
      const IndexSet &owned = matrix.locally_owned_range_indices();
      const DistributedMatrix::WholeRows   rows = matrix.whole_rows();
      std::vector<types::global_dof_index> columns;
      std::vector<double>                  values;
      const auto                           for_each_row = [&](const auto &act) {
        for (unsigned int i = 0; i < matrix.n_rows(); ++i)
          {
            columns.clear();
            for (std::size_t e = rows.begin[i]; e < rows.begin[i + 1]; ++e)
              for (unsigned int d = 0; d < dim; ++d)
                columns.push_back(matrix.global_node(rows.columns[e]) * dim +
                                  d);
            for (unsigned int c = 0; c < dim; ++c)
              act(i, c);
          }
      };
      DynamicSparsityPattern pattern(owned.size(), owned.size(), owned);
      for_each_row([&](const unsigned int i, const unsigned int c) {
        pattern.add_entries(matrix.global_node(i) * dim + c,
                            columns.begin(),
                            columns.end());
      });
      auto result = std::make_unique<TrilinosWrappers::SparseMatrix>();
      result->reinit(owned, pattern, matrix.get_mpi_communicator());
      for_each_row([&](const unsigned int i, const unsigned int c) {
        values.clear();
        for (std::size_t e = rows.begin[i]; e < rows.begin[i + 1]; ++e)
          for (unsigned int d = 0; d < dim; ++d)
            {
              const unsigned int j = rows.columns[e];
              const double       value =
                rows.blocks[e][j < i ? d * dim + c : c * dim + d];
              values.push_back(j == i && c == d ?
                                 value :
                                 value * keep_column[i * dim + c] *
                                   keep_column[j * dim + d]);
            }
        result->set(matrix.global_node(i) * dim + c, columns, values);
      });
      result->compress(VectorOperation::insert);
      return result;
    }
  } // namespace



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
    // Cut off excluded components and face components that are blocked by
    // themselves, such as the normal component of a node that slips on the
    // foundation.
    std::vector<double> keep(excluded.size());
    for (std::size_t i = 0; i < excluded.size(); ++i)
      keep[i] = excluded[i] ? 0. : 1.;
    for (unsigned int n = 0; n < truncation.projector.size(); ++n)
      for (unsigned int i = 0; i < face.n_node_dofs(n); ++i)
        if (truncation.projector[n][i][i] == 0.)
          keep[restriction.positions()[face.first_dof[n] + i]] = 0.;
    auto masked_matrix = masked(matrix, matrix.at_columns(keep.data()), dim);

    // Add the springs of slipping points; rows that are cut off have none.
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
    amg.reset(); // free its memory before the next one is built
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
      damping[k] = matrix.diagonal(restriction.positions()[k]);
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
    // A set-up costs 1.2 (2D) to 2.2 (3D) solves of about 15 iterations.
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
