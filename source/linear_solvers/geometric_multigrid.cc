// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/linear_solvers/algebraic_coarse_solver.h>
#include <viscoplastic_contact/linear_solvers/direct_coarse_solver.h>
#include <viscoplastic_contact/linear_solvers/geometric_multigrid.h>
#include <viscoplastic_contact/linear_solvers/multigrid_level.h>

#include <algorithm>
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
    /// Owned, ascending.
    std::vector<Node>                    nodes;
    Interpolation                        interpolation; // from below
    std::unique_ptr<MultigridLevel<dim>> space;
  };



  /// The matrix on the last mesh in double precision and Cartesian components.
  template <int dim>
  struct GeometricMultigrid<dim>::Operator
  {
    SharedRows<dim, double>                    rows;
    LinearAlgebra::distributed::Vector<double> x, y;
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
    , opposite(hierarchy.opposite)
    , has_direct_coarse_solver(rigid_body_modes.empty())
    , largest_shared_part(options.largest_shared_part)
  {
    for (const Node n_owned :
         Utilities::MPI::all_gather(communicator,
                                    Node(hierarchy.first_level.size())))
      begins.push_back(begins.back() + n_owned);

    // The first level is the last mesh that is still small.
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
    // Values that change are not worth it.
    shared_matrix.reset();
    fill();
    return true;
  }



  template <int dim>
  Interpolation
  GeometricMultigrid<dim>::make_interpolation(const unsigned int       level,
                                              const std::vector<Node> &ghosts)
  {
    const unsigned int mesh         = first_mesh + level;
    const auto         displacement = [&](const Node node) {
      const std::size_t n = node - hierarchy.begin;
      if (hierarchy.first_level[n] < mesh)
        return Row{{node, 1.}};
      return Row(hierarchy.parents.begin() + hierarchy.row_begin[n],
                 hierarchy.parents.begin() + hierarchy.row_begin[n + 1]);
    };
    std::map<Node, Row> at_interfaces;
    if (hierarchy.has_interfaces)
      at_interfaces = pass_interfaces_on(level, displacement);
    const auto row = [&](const Node node) {
      const auto found = at_interfaces.find(node);
      return found == at_interfaces.end() ? displacement(node) : found->second;
    };
    Interpolation result;
    const auto    add = [&](const Row &parents) {
      result.parents.insert(result.parents.end(),
                            parents.begin(),
                            parents.end());
      result.begin.push_back(result.parents.size());
    };
    for (const Node node : levels[level]->nodes)
      add(row(node));
    if (begins.size() > 2)
      for (const auto &parents : ask_owners(ghosts, begins, communicator, row))
        add(parents);
    return result;
  }



  template <int dim>
  std::map<NodeHierarchy::Node, std::vector<NodeHierarchy::Parent>>
  GeometricMultigrid<dim>::pass_interfaces_on(
    const unsigned int                    level,
    const std::function<Row(const Node)> &displacement)
  {
    const auto is_owned = [this](const Node node) {
      return node >= hierarchy.begin && node < hierarchy.end;
    };
    // Rows of nodes of other ranks.
    const auto from_owners = [&](const std::set<Node> &foreign,
                                 const auto           &row) {
      const std::vector<Node> asked(foreign.begin(), foreign.end());
      const auto answers = ask_owners(asked, begins, communicator, row);
      std::map<Node, Row> result;
      for (std::size_t i = 0; i < asked.size(); ++i)
        result[asked[i]] = answers[i];
      return result;
    };
    const auto add =
      [](std::map<Node, double> &sums, const double factor, const Row &row) {
        for (const auto &[node, weight] : row)
          sums[node] += factor * weight;
      };
    const auto to_row = [](const std::map<Node, double> &sums) {
      Row row;
      for (const auto &[node, weight] : sums)
        if (std::abs(weight) > 1e-12)
          row.push_back({node, weight});
      return row;
    };
    static const Row nothing;
    const auto       row_of = [](const std::map<Node, Row> &rows,
                           const Node                 node) -> const Row       &{
      const auto found = rows.find(node);
      return found == rows.end() ? nothing : found->second;
    };

    // What lies opposite, by nodes of the coarser mesh.
    std::set<Node> others;
    for (const auto &of_node : opposite)
      for (const auto &other : of_node.second)
        if (!is_owned(other.node))
          others.insert(other.node);
    const auto          of_others = from_owners(others, displacement);
    std::map<Node, Row> by_coarse_nodes, coarse_opposite;
    for (const auto &[node, row] : opposite)
      {
        std::map<Node, double> sums;
        for (const auto &[other, weight] : row)
          add(sums,
              weight,
              is_owned(other) ? displacement(other) : of_others.at(other));
        by_coarse_nodes[node] = to_row(sums);
        if (hierarchy.first_level[node - hierarchy.begin] < first_mesh + level)
          coarse_opposite[node] = by_coarse_nodes[node];
      }

    // A displacement is that of its parents, and of what lies opposite to them;
    // the unknown at an interface is what it differs by from the other side.
    std::set<Node> foreign_parents;
    if (begins.size() > 2)
      for (const Node node : levels[level]->nodes)
        for (const auto &parent : displacement(node))
          if (!is_owned(parent.node))
            foreign_parents.insert(parent.node);
    const auto of_foreign_parents =
      from_owners(foreign_parents, [&](const Node node) {
        return row_of(coarse_opposite, node);
      });
    std::map<Node, Row> result;
    for (const Node node : levels[level]->nodes)
      {
        const Row              row     = displacement(node);
        const Row             &here    = row_of(by_coarse_nodes, node);
        bool                   is_near = !here.empty();
        std::map<Node, double> sums;
        for (const auto &[parent, weight] : row)
          {
            const Row &across =
              row_of(is_owned(parent) ? coarse_opposite : of_foreign_parents,
                     parent);
            is_near |= !across.empty();
            add(sums, weight, across);
          }
        if (!is_near)
          continue;
        add(sums, 1., row);
        add(sums, -1., here);
        result[node] = to_row(sums);
      }
    opposite = coarse_opposite;
    return result;
  }



  template <int dim>
  void
  GeometricMultigrid<dim>::fill()
  {
    const bool is_new = levels[0]->space == nullptr;
    // A power of two changes no digit.
    double largest = 0.;
    for (const auto row : matrix.locally_owned_range_indices())
      largest = std::max(largest, matrix.diag_element(row));
    unit =
      std::ldexp(1., std::ilogb(Utilities::MPI::max(largest, communicator)));
    BlockRows<dim> rows = cartesian_rows<dim>(
      matrix, excluded, hierarchy, levels.back()->nodes, unit);
    std::vector<Node> others; // that the interpolation above needs
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
        if (is_new && l + 1 == levels.size())
          share_matrix(rows);
        if (l == 0)
          break;
        std::set<Node> ghosts;
        if (begins.size() > 2)
          for (const Node node : rows.columns)
            if (is_foreign(node))
              ghosts.insert(node);
        const std::vector<Node> ghost_list(ghosts.begin(), ghosts.end());
        if (is_new)
          level.interpolation = make_interpolation(l, ghost_list);
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
  void
  GeometricMultigrid<dim>::share_matrix(const BlockRows<dim> &matrix_rows)
  {
    const MultigridLevel<dim> &level     = *levels.back()->space;
    const auto                 is_shared = [this](const auto &rows) {
      const std::vector<std::uint64_t> on_rank{rows.n_blocks(),
                                               rows.n_stored_blocks()};
      std::vector<std::uint64_t>       n_blocks(2);
      Utilities::MPI::sum(on_rank, communicator, n_blocks);
      return n_blocks[1] <= largest_shared_part * n_blocks[0];
    };
    // What differs in single precision does so in double precision, too.
    if (!has_four_doubles() || !is_shared(level.matrix_rows()))
      return;
    auto result = std::make_unique<Operator>();
    result->rows.set_values(matrix_rows,
                            level.local_numbers(matrix_rows.columns));
    if (!is_shared(result->rows))
      return;
    result->x.reinit(level.x.get_partitioner());
    result->y.reinit(level.x.get_partitioner());
    shared_matrix = std::move(result);
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
    // In single precision numbers have a small range.
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
  }



  template <int dim>
  bool
  GeometricMultigrid<dim>::vmult_matrix(DistributedVector       &y,
                                        const DistributedVector &x) const
  {
    if (shared_matrix == nullptr)
      return false;
    y                 = 0.;
    auto       &u     = shared_matrix->x;
    auto       &v     = shared_matrix->y;
    const auto &nodes = levels.back()->nodes;
    for (unsigned int i = 0; i < nodes.size(); ++i)
      {
        const double *const from =
          x.begin() + (nodes[i] - hierarchy.begin) * dim;
        for (unsigned int d = 0; d < dim; ++d)
          u.begin()[i * dim + d] = unit * from[d];
      }
    for (const auto &[i, directions] : rotated_nodes)
      multiply(directions, u.begin() + i * dim);
    u.update_ghost_values();
    shared_matrix->rows.vmult(v.begin(), u.begin());
    u.zero_out_ghost_values();
    for (const auto &[i, directions] : rotated_nodes)
      multiply(transpose(directions), v.begin() + i * dim);
    for (unsigned int i = 0; i < nodes.size(); ++i)
      {
        double *const to = y.begin() + (nodes[i] - hierarchy.begin) * dim;
        for (unsigned int d = 0; d < dim; ++d)
          to[d] = v.begin()[i * dim + d];
      }
    return true;
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



  template class GeometricMultigrid<2>;
  template class GeometricMultigrid<3>;
} // namespace Viscoplastic
