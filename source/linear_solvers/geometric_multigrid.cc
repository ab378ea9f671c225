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

    // The first level is the finest space of at most coarse_size unknowns.
    std::vector<Node> n_new(hierarchy.n_levels, 0);
    for (const unsigned int space : hierarchy.first_level)
      if (space < hierarchy.n_levels)
        n_new[space] += dim;
    Utilities::MPI::sum(n_new, communicator, n_new);
    Node n_unknowns = n_new[0];
    while (first_space + 1 < hierarchy.n_levels &&
           n_unknowns + n_new[first_space + 1] <= options.coarse_size)
      n_unknowns += n_new[++first_space];

    levels.resize(hierarchy.n_levels - first_space);
    const std::vector<Node> nodes = nodes_of(levels.size() - 1);
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
  std::vector<NodeHierarchy::Node>
  GeometricMultigrid<dim>::nodes_of(const unsigned int level) const
  {
    std::vector<Node> result;
    for (std::size_t n = 0; n < hierarchy.first_level.size(); ++n)
      if (hierarchy.first_level[n] <= first_space + level)
        result.push_back(hierarchy.begin + n);
    return result;
  }



  template <int dim>
  void
  GeometricMultigrid<dim>::fill()
  {
    // Scaling by a power of two is exact.
    double largest = 0.;
    for (std::size_t i = 0; i < excluded.size(); ++i)
      largest = std::max(largest, matrix.diagonal(i));
    unit =
      std::ldexp(1., std::ilogb(Utilities::MPI::max(largest, communicator)));
    std::vector<Node> nodes = nodes_of(levels.size() - 1);
    BlockRows<dim>    rows =
      cartesian_rows<dim>(matrix, excluded, hierarchy, nodes, unit);
    LevelInterpolations interpolations(hierarchy, begins, communicator);
    Interpolation       upper;  // from the present level to the one above
    std::vector<Node>   others; // that it needs
    for (unsigned int l = levels.size(); l-- > 0;)
      {
        const auto is_foreign = [this](const Node node) {
          return node < hierarchy.begin || node >= hierarchy.end;
        };
        if (levels[l])
          levels[l]->set_values(rows);
        else
          levels[l] = std::make_unique<MultigridLevel<dim>>(
            rows, nodes, others, begins, communicator);
        if (l + 1 < levels.size())
          levels[l + 1]->set_interpolation(upper, *levels[l]);
        if (l == 0)
          break;
        std::set<Node> ghosts;
        if (begins.size() > 2)
          for (const Node node : rows.columns)
            if (is_foreign(node))
              ghosts.insert(node);
        const std::vector<Node> ghost_list(ghosts.begin(), ghosts.end());
        // Those of all levels would take much memory until the next filling.
        upper = interpolations.next(first_space + l, nodes, ghost_list);
        others.clear();
        for (std::size_t e = 0; e < upper.begin[nodes.size()]; ++e)
          if (is_foreign(upper.parents[e].node))
            others.push_back(upper.parents[e].node);
        std::vector<Node> coarse_nodes = nodes_of(l - 1);
        rows                           = galerkin_product(
          rows, nodes, ghost_list, upper, coarse_nodes, begins, communicator);
        nodes = std::move(coarse_nodes);
      }
    masks.set_levels(levels);
    if (has_direct_coarse_solver)
      coarse = std::make_unique<DirectCoarseSolver<dim>>(rows,
                                                         *levels[0],
                                                         communicator);
    else
      coarse = std::make_unique<AlgebraicCoarseSolver<dim>>(rows,
                                                            *levels[0],
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
    std::vector<double>     result;
    const std::vector<Node> nodes = nodes_of(0);
    for (const DistributedVector &mode : modes)
      for (const Node node : nodes)
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
    const MultigridLevel<dim> &level = *levels[l];
    auto                      &x = level.x, &b = level.b, &r = level.r;
    if (l == 0)
      masks.project(l, b);
    if (l == 0 && coarse->is_exact())
      {
        coarse->solve(masks.in_use(), x, b);
        masks.project(l, x);
        return;
      }
    level.smooth_forward_from_zero(x, b);
    level.residual(r, x, b);
    masks.project(l, r);
    if (l == 0)
      coarse->solve(masks.in_use(), r, r);
    else
      {
        level.restrict_to_coarse(levels[l - 1]->b, r);
        cycle(l - 1);
        level.interpolate(r, levels[l - 1]->x);
      }
    masks.project(l, r);
    x.add(1.f, r);
    level.smooth_backward(x, b);
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
    const double               scale = std::ldexp(1., -std::ilogb(size));
    const MultigridLevel<dim> &fine  = *levels.back();
    const std::vector<Node>   &nodes = fine.owned_nodes();
    float *const               b     = fine.b.begin();
    float *const               u     = fine.x.begin();
    for (unsigned int i = 0; i < nodes.size(); ++i)
      {
        const double *const from =
          x.begin() + (nodes[i] - hierarchy.begin) * dim;
        for (unsigned int d = 0; d < dim; ++d)
          b[i * dim + d] = scale * from[d];
      }
    for (const auto &[i, directions] : rotated_nodes)
      multiply(directions, b + i * dim);
    cycle(levels.size() - 1);
    for (const auto &[i, directions] : rotated_nodes)
      multiply(transpose(directions), u + i * dim);
    for (unsigned int i = 0; i < nodes.size(); ++i)
      {
        double *const to = y.begin() + (nodes[i] - hierarchy.begin) * dim;
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
