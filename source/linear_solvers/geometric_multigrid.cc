// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/linear_solvers/algebraic_coarse_solver.h>
#include <viscoplastic_contact/linear_solvers/direct_coarse_solver.h>
#include <viscoplastic_contact/linear_solvers/geometric_multigrid.h>
#include <viscoplastic_contact/linear_solvers/level_interpolations.h>

#include <cmath>
#include <set>

namespace Viscoplastic
{
  namespace
  {
    using Node = NodeHierarchy::Node;
  } // namespace



  template <int dim>
  struct GeometricMultigrid<dim>::Level
  {
    /// Owned nodes of the level, ascending.
    std::vector<Node>                    nodes;
    Interpolation                        interpolation; // from below
    std::unique_ptr<MultigridLevel<dim>> space;
  };



  template <int dim>
  GeometricMultigrid<dim>::GeometricMultigrid(
    const DistributedMatrix              &matrix,
    const std::vector<bool>              &excluded,
    NodeHierarchy                         hierarchy_,
    const std::vector<DistributedVector> &rigid_body_modes,
    const FaceRestriction                &restriction,
    const Options                        &options)
    : matrix(matrix)
    , excluded(excluded)
    , hierarchy(std::move(hierarchy_))
    , communicator(matrix.get_mpi_communicator())
    , face(restriction.face())
    , begins(1, 0)
    , masks(excluded, hierarchy, restriction)
    , has_direct_coarse_solver(rigid_body_modes.empty())
  {
    for (const Node n_owned :
         Utilities::MPI::all_gather(communicator,
                                    Node(hierarchy.first_level.size())))
      begins.push_back(begins.back() + n_owned);

    // The first level is the finest mesh of at most coarse_size unknowns.
    std::vector<Node> n_new(hierarchy.n_levels, 0);
    for (const unsigned int mesh : hierarchy.first_level)
      if (mesh < hierarchy.n_levels)
        n_new[mesh] += dim;
    Utilities::MPI::sum(n_new, communicator, n_new);
    Node n_unknowns = n_new[0];
    while (first_mesh + 1 < hierarchy.n_levels &&
           n_unknowns + n_new[first_mesh + 1] <= options.coarse_size)
      n_unknowns += n_new[++first_mesh];

    for (unsigned int mesh = first_mesh; mesh < hierarchy.n_levels; ++mesh)
      {
        levels.push_back(std::make_unique<Level>());
        for (std::size_t n = 0; n < hierarchy.first_level.size(); ++n)
          if (hierarchy.first_level[n] <= mesh)
            levels.back()->nodes.push_back(hierarchy.begin + n);
      }
    const std::vector<Node> &nodes = levels.back()->nodes;
    for (unsigned int i = 0; i < nodes.size() && !hierarchy.frames.empty(); ++i)
      {
        const auto frame = hierarchy.frames.find(nodes[i]);
        if (frame != hierarchy.frames.end())
          rotated_nodes.emplace_back(i, leading_block<dim>(frame->second));
      }
    coarse_modes = on_first_level(rigid_body_modes);
    fill();
  }



  template <int dim>
  GeometricMultigrid<dim>::~GeometricMultigrid() = default;



  template <int dim>
  std::string
  GeometricMultigrid<dim>::name() const
  {
    return has_direct_coarse_solver ?
             "geometric multigrid" :
             "geometric multigrid (over ML on the first mesh)";
  }



  template <int dim>
  bool
  GeometricMultigrid<dim>::renew()
  {
    fill();
    return true;
  }



  template <int dim>
  void
  GeometricMultigrid<dim>::fill()
  {
    const bool is_new = levels[0]->space == nullptr;
    // Scaling by a power of two is exact.
    double largest = 0.;
    for (std::size_t i = 0; i < excluded.size(); ++i)
      largest = std::max(largest, matrix.diagonal(i));
    unit =
      std::ldexp(1., std::ilogb(Utilities::MPI::max(largest, communicator)));
    BlockRows<dim> rows = cartesian_rows<dim>(
      matrix, excluded, hierarchy, levels.back()->nodes, unit);
    LevelInterpolations interpolations(hierarchy, begins, communicator);
    std::vector<Node>   others; // that the interpolation above needs
    for (unsigned int l = levels.size(); l-- > 0;)
      {
        Level     &level      = *levels[l];
        const auto is_foreign = [this](const Node node) {
          return node < hierarchy.begin || node >= hierarchy.end;
        };
        if (!is_new)
          level.space->set_values(rows);
        else
          level.space = std::make_unique<MultigridLevel<dim>>(
            rows, level.nodes, others, begins, communicator);
        if (l == 0)
          break;
        std::set<Node> ghosts;
        if (begins.size() > 2)
          for (const Node node : rows.columns)
            if (is_foreign(node))
              ghosts.insert(node);
        const std::vector<Node> ghost_list(ghosts.begin(), ghosts.end());
        if (is_new)
          level.interpolation =
            interpolations.next(first_mesh + l, level.nodes, ghost_list);
        others.clear();
        for (std::size_t e = 0;
             e < level.interpolation.begin[level.nodes.size()];
             ++e)
          if (is_foreign(level.interpolation.parents[e].node))
            others.push_back(level.interpolation.parents[e].node);
        rows = galerkin_product(rows,
                                level.nodes,
                                ghost_list,
                                level.interpolation,
                                levels[l - 1]->nodes,
                                begins,
                                communicator);
      }
    for (unsigned int l = 1; l < levels.size(); ++l)
      levels[l]->space->set_interpolation(levels[l]->interpolation,
                                          *levels[l - 1]->space);

    std::vector<MultigridLevel<dim> *> spaces;
    for (const auto &level : levels)
      spaces.push_back(level->space.get());
    masks.set_levels(spaces);
    if (has_direct_coarse_solver)
      coarse = std::make_unique<DirectCoarseSolver<dim>>(rows,
                                                         *spaces[0],
                                                         communicator);
    else
      coarse = std::make_unique<AlgebraicCoarseSolver<dim>>(rows,
                                                            *spaces[0],
                                                            coarse_modes,
                                                            communicator);
    built_for.reset();
    set_masks(LevelMasks<dim>::untruncated, nullptr, true);
  }



  template <int dim>
  std::vector<double>
  GeometricMultigrid<dim>::on_first_level(
    const std::vector<DistributedVector> &modes) const
  {
    std::vector<double> result;
    for (const DistributedVector &mode : modes)
      for (const Node node : levels[0]->nodes)
        {
          const double *const value =
            mode.begin() + (node - hierarchy.begin) * dim;
          result.insert(result.end(), value, value + dim);
          const auto frame = hierarchy.frames.find(node);
          if (frame != hierarchy.frames.end())
            multiply(leading_block<dim>(frame->second), &*result.end() - dim);
        }
    return result;
  }



  template <int dim>
  bool
  GeometricMultigrid<dim>::set_masks(
    const typename LevelMasks<dim>::Masking masking,
    const FaceTruncation                   *truncation,
    const bool                              may_rebuild)
  {
    return coarse->set_masks(masking,
                             masks.set(masking, truncation, unit),
                             may_rebuild);
  }



  template <int dim>
  void
  GeometricMultigrid<dim>::set_truncation(const FaceTruncation &truncation,
                                          const bool            may_rebuild)
  {
    if (set_masks(LevelMasks<dim>::truncated, &truncation, may_rebuild) &&
        !has_direct_coarse_solver)
      built_for = truncation;
  }



  template <int dim>
  void
  GeometricMultigrid<dim>::cycle(const unsigned int l) const
  {
    const Level &level = *levels[l];
    auto        &x = level.space->x, &b = level.space->b, &r = level.space->r;
    if (l == 0)
      masks.project(l, b);
    if (l == 0 && coarse->is_exact())
      {
        coarse->solve(masks.in_use(), x, b);
        masks.project(l, x);
        return;
      }
    level.space->smooth_forward_from_zero(x, b);
    level.space->residual(r, x, b);
    masks.project(l, r);
    if (l == 0)
      coarse->solve(masks.in_use(), r, r);
    else
      {
        level.space->restrict_to_coarse(levels[l - 1]->space->b, r);
        cycle(l - 1);
        level.space->interpolate(r, levels[l - 1]->space->x);
      }
    masks.project(l, r);
    x.add(1.f, r);
    level.space->smooth_backward(x, b);
  }



  template <int dim>
  void
  GeometricMultigrid<dim>::vmult_in_frames(DistributedVector       &y,
                                           const DistributedVector &x) const
  {
    // x is scaled, since single precision has a small range.
    const double size = x.linfty_norm();
    y                 = 0.;
    if (!(size > 0.) || !std::isfinite(size))
      return;
    const double scale = std::ldexp(1., -std::ilogb(size));
    const Level &fine  = *levels.back();
    float *const b     = fine.space->b.begin();
    float *const u     = fine.space->x.begin();
    for (unsigned int i = 0; i < fine.nodes.size(); ++i)
      {
        const double *const from =
          x.begin() + (fine.nodes[i] - hierarchy.begin) * dim;
        for (unsigned int d = 0; d < dim; ++d)
          b[i * dim + d] = scale * from[d];
      }
    for (const auto &[i, directions] : rotated_nodes)
      multiply(directions, b + i * dim);
    cycle(levels.size() - 1);
    for (const auto &[i, directions] : rotated_nodes)
      multiply(transpose(directions), u + i * dim);
    for (unsigned int i = 0; i < fine.nodes.size(); ++i)
      {
        double *const to = y.begin() + (fine.nodes[i] - hierarchy.begin) * dim;
        for (unsigned int d = 0; d < dim; ++d)
          to[d] = u[i * dim + d] / (scale * unit);
      }
    // Unknowns that belong to no node of the mesh are solved for separately.
    for (std::size_t i = hierarchy.first_level.size() * dim;
         i < excluded.size();
         ++i)
      y.begin()[i] = x.begin()[i] / matrix.diagonal(i);
  }



  template <int dim>
  void
  GeometricMultigrid<dim>::vmult(DistributedVector       &y,
                                 const DistributedVector &x) const
  {
    masks.use(LevelMasks<dim>::truncated);
    vmult_in_frames(y, x);
  }



  template <int dim>
  void
  GeometricMultigrid<dim>::vmult_untruncated(DistributedVector       &y,
                                             const DistributedVector &x) const
  {
    masks.use(LevelMasks<dim>::untruncated);
    vmult_in_frames(y, x);
  }



  template <int dim>
  std::optional<PreconditionerState>
  GeometricMultigrid<dim>::state() const
  {
    if (!built_for)
      return {};
    return PreconditionerState{*built_for, 0., 0., false};
  }



  template <int dim>
  void
  GeometricMultigrid<dim>::restore(
    const std::optional<PreconditionerState> &state)
  {
    if (has_direct_coarse_solver)
      return;
    if (!state)
      {
        coarse->forget(LevelMasks<dim>::truncated);
        built_for.reset();
        return;
      }
    const FaceTruncation &wanted = state->built_for;
    wanted.check_belongs_to(face);
    if (built_for && built_for->is_same_as(wanted, face))
      return;
    coarse->forget(LevelMasks<dim>::truncated);
    set_truncation(wanted, true);
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(GeometricMultigrid);
} // namespace Viscoplastic
