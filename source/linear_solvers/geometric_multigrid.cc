// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/linear_solvers/coarse_problem.h>
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

    /// A coarse node sticks if this part of the weight of the face nodes around
    /// it does.
    constexpr double sticking_share = 0.4;



    /// Multiply the values of a node by a tensor.
    template <int dim>
    void
    multiply(const Tensor<2, dim> &tensor, float *value)
    {
      Tensor<1, dim> x;
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = value[d];
      x = tensor * x;
      for (unsigned int d = 0; d < dim; ++d)
        value[d] = x[d];
    }



    /// The inverse of A on the range of a projector, zero on its kernel.
    template <int dim>
    Tensor<2, dim>
    inverse_on_range(const Tensor<2, dim> &A, const Tensor<2, dim> &projector)
    {
      return projector * invert(on_range(A, projector)) * projector;
    }
  } // namespace



  template <int dim>
  struct GeometricMultigrid<dim>::FaceNode
  {
    Node         node;
    unsigned int index; // among the nodes of the face
    /// Projector onto the directions that are unknowns, and the directions of
    /// the entries of face vectors.
    Tensor<2, dim>                  unknown;
    std::array<Tensor<1, dim>, dim> direction;
    unsigned int                    n_dofs;

    /// A block of face entries in Cartesian components.
    Tensor<2, dim>
    to_cartesian(const Tensor<2, 3> &block) const
    {
      Tensor<2, dim> result;
      for (unsigned int i = 0; i < n_dofs; ++i)
        for (unsigned int j = 0; j < n_dofs; ++j)
          result += block[i][j] * outer_product(direction[i], direction[j]);
      return result;
    }

    /// How many of the directions a projector of face entries blocks.
    double
    n_blocked(const Tensor<2, 3> &projector) const
    {
      double result = n_dofs;
      for (unsigned int i = 0; i < n_dofs; ++i)
        result -= projector[i][i];
      return result;
    }
  };



  template <int dim>
  struct GeometricMultigrid<dim>::Treatment
  {
    /// Onto what is free of the entries of face vectors, and which share of
    /// them is not.
    Tensor<2, 3>   projector;
    double         blocked = 0.;
    Tensor<2, dim> spring; // Cartesian
  };



  template <int dim>
  struct GeometricMultigrid<dim>::Masks
  {
    struct Entry
    {
      unsigned int   node; // local
      Tensor<2, dim> free; // a projector
      NodeBlock<dim> row_sum, inverse;
    };
    std::vector<Entry> entries;

    /// Cut off what is not free.
    void
    project(typename MultigridLevel<dim>::Vector &v) const
    {
      for (const Entry &entry : entries)
        multiply(entry.free, v.begin() + entry.node * dim);
    }
  };



  template <int dim>
  struct GeometricMultigrid<dim>::Level
  {
    /// Owned, ascending.
    std::vector<Node>                    nodes;
    Interpolation                        interpolation; // from below
    std::unique_ptr<MultigridLevel<dim>> space;
    /// A face node on this level: its local number, its number among the face
    /// nodes, the sum of its row and its block for the smoother, without
    /// springs.
    struct FaceEntry
    {
      unsigned int   local, number;
      NodeBlock<dim> row_sum, smoothing;
    };
    std::vector<FaceEntry> face;
    /// Of other nodes with excluded components, and of face nodes without and
    /// with the present truncation.
    Masks                fixed;
    std::array<Masks, 2> masks;
  };



  template <int dim>
  GeometricMultigrid<dim>::GeometricMultigrid(
    const DistributedMatrix &matrix,
    const std::vector<bool> &excluded,
    NodeHierarchy            hierarchy_,
    const FaceRestriction   &restriction,
    const unsigned int       coarse_size)
    : matrix(matrix)
    , excluded(excluded)
    , hierarchy(std::move(hierarchy_))
    , restriction(restriction)
    , communicator(matrix.get_mpi_communicator())
    , begins(1, 0)
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
           n_unknowns + n_new[first_mesh + 1] <= coarse_size)
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
    make_face_nodes();
    fill();
  }



  template <int dim>
  GeometricMultigrid<dim>::~GeometricMultigrid() = default;



  template <int dim>
  std::string
  GeometricMultigrid<dim>::name() const
  {
    return "geometric multigrid";
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
  GeometricMultigrid<dim>::make_face_nodes()
  {
    const FrictionFace &face = restriction.face();
    for (unsigned int n = 0; n < face.n_nodes(); ++n)
      {
        const unsigned int first = face.first_dof[n];
        const Node         node  = restriction.dofs()[first] / dim;
        if (node < hierarchy.begin || node >= hierarchy.end)
          continue;
        FaceNode result;
        result.node       = node;
        result.index      = n;
        result.n_dofs     = face.n_node_dofs(n);
        const auto frame  = hierarchy.frames.find(node);
        const auto column = [&](const unsigned int c) {
          Tensor<1, dim> direction;
          if (frame == hierarchy.frames.end())
            direction[c] = 1.;
          else
            for (unsigned int d = 0; d < dim; ++d)
              direction[d] = frame->second[d][c];
          return direction;
        };
        for (unsigned int c = 0; c < dim; ++c)
          if (!excluded[(node - hierarchy.begin) * dim + c])
            result.unknown += outer_product(column(c), column(c));
        for (unsigned int i = 0; i < result.n_dofs; ++i)
          result.direction[i] = column(restriction.dofs()[first + i] % dim);
        face_nodes.push_back(result);
      }
  }



  template <int dim>
  Interpolation
  GeometricMultigrid<dim>::make_interpolation(
    const unsigned int       level,
    const std::vector<Node> &ghosts) const
  {
    const unsigned int mesh = first_mesh + level;
    const auto         row  = [&](const Node node) {
      const std::size_t n = node - hierarchy.begin;
      if (hierarchy.first_level[n] < mesh)
        return std::vector<NodeHierarchy::Parent>{{node, 1.}};
      return std::vector<NodeHierarchy::Parent>(hierarchy.parents.begin() +
                                                  hierarchy.row_begin[n],
                                                hierarchy.parents.begin() +
                                                  hierarchy.row_begin[n + 1]);
    };
    Interpolation result;
    const auto    add = [&](const std::vector<NodeHierarchy::Parent> &parents) {
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

    const Level                                    &first = *levels[0];
    std::vector<typename CoarseProblem<dim>::Entry> entries;
    for (unsigned int i = 0; i < rows.n_rows(); ++i)
      for (std::size_t e = rows.begin[i]; e < rows.begin[i + 1]; ++e)
        entries.push_back({first.space->global_number(i),
                           first.space->global_number(
                             first.space->local_number(rows.columns[e])),
                           rows.values[e]});
    coarse = std::make_unique<CoarseProblem<dim>>(entries,
                                                  first.space->x.size() / dim,
                                                  communicator);
    for (auto &coarse_factor : coarse_factors)
      coarse_factor.factor.reset();
    make_fixed_masks();
    set_masks(untruncated, nullptr);
    masks_in_use.reset();
  }



  template <int dim>
  void
  GeometricMultigrid<dim>::make_fixed_masks()
  {
    std::map<Node, unsigned int> face_node;
    for (unsigned int f = 0; f < face_nodes.size(); ++f)
      face_node[face_nodes[f].node] = f;
    for (const auto &level : levels)
      {
        level->fixed.entries.clear();
        level->face.clear();
        for (unsigned int i = 0; i < level->nodes.size(); ++i)
          {
            const Node     node     = level->nodes[i];
            Tensor<2, dim> free     = identity<dim>();
            const auto     frame    = hierarchy.frames.find(node);
            bool           is_fixed = false;
            for (unsigned int c = 0; c < dim; ++c)
              if (excluded[(node - hierarchy.begin) * dim + c])
                {
                  is_fixed = true;
                  Tensor<1, dim> direction;
                  for (unsigned int d = 0; d < dim; ++d)
                    direction[d] = frame == hierarchy.frames.end() ?
                                     double(d == c) :
                                     frame->second[d][c];
                  free -= outer_product(direction, direction);
                }
            const auto face = face_node.find(node);
            if (face != face_node.end())
              {
                level->face.push_back({i,
                                       face->second,
                                       level->space->row_sum(i),
                                       level->space->smoothing_block(i)});
                continue;
              }
            const NodeBlock<dim> inverse =
              inverse_on_range(level->space->smoothing_block(i), free);
            level->space->set_inverse_block(i, inverse);
            if (is_fixed)
              level->fixed.entries.push_back(
                {i, free, level->space->row_sum(i), inverse});
          }
      }
  }



  template <int dim>
  std::vector<typename GeometricMultigrid<dim>::Treatment>
  GeometricMultigrid<dim>::treatments(const FaceTruncation *truncation) const
  {
    std::vector<Treatment> result;
    for (const auto &entry : levels.back()->face)
      {
        const FaceNode &node = face_nodes[entry.number];
        Treatment       treatment;
        if (truncation == nullptr)
          treatment.projector = identity<3>();
        else
          {
            treatment.projector = truncation->projector[node.index];
            treatment.spring =
              node.to_cartesian(truncation->spring[node.index]) / unit;
          }
        treatment.blocked = node.n_blocked(treatment.projector) / node.n_dofs;
        result.push_back(treatment);
      }
    return result;
  }



  template <int dim>
  std::vector<typename GeometricMultigrid<dim>::Treatment>
  GeometricMultigrid<dim>::coarsen(const std::vector<Treatment> &treatments,
                                   const FaceTruncation         &truncation,
                                   const unsigned int            l) const
  {
    const Level           &level = *levels[l], &below = *levels[l - 1];
    auto                  &fine = level.space->r, &sums = below.space->b;
    std::vector<Treatment> result(below.face.size());

    // The weight of face nodes around a coarse one that sticks, and all of it.
    fine = 0.f;
    for (unsigned int f = 0; f < level.face.size(); ++f)
      {
        float *const value = fine.begin() + level.face[f].local * dim;
        value[0]           = treatments[f].blocked;
        value[1]           = 1.f;
      }
    level.space->restrict_to_coarse(sums, fine);
    for (unsigned int f = 0; f < below.face.size(); ++f)
      {
        const float *const sum    = sums.begin() + below.face[f].local * dim;
        const bool         sticks = sum[0] >= sticking_share * sum[1];
        result[f].blocked         = sticks ? 1. : 0.;
        if (!sticks)
          result[f].projector = identity<3>();
        // On edges of the face, where only some directions stick, a node goes
        // by itself.
        const FaceNode     &node = face_nodes[below.face[f].number];
        const Tensor<2, 3> &own  = truncation.projector[node.index];
        const double        n    = node.n_blocked(own);
        if (n > 0.5 && n < node.n_dofs - 0.5)
          {
            result[f].projector = own;
            result[f].blocked   = n / node.n_dofs;
          }
      }

    // Springs are lumped, column by column.
    if (truncation.has_springs())
      for (unsigned int j = 0; j < dim; ++j)
        {
          for (unsigned int f = 0; f < level.face.size(); ++f)
            for (unsigned int i = 0; i < dim; ++i)
              fine.begin()[level.face[f].local * dim + i] =
                treatments[f].spring[i][j];
          level.space->restrict_to_coarse(sums, fine);
          for (unsigned int f = 0; f < below.face.size(); ++f)
            for (unsigned int i = 0; i < dim && result[f].blocked < 1.; ++i)
              result[f].spring[i][j] =
                sums.begin()[below.face[f].local * dim + i];
        }
    return result;
  }



  template <int dim>
  typename GeometricMultigrid<dim>::Masks
  GeometricMultigrid<dim>::make_masks(const std::vector<Treatment> &treatments,
                                      const Level                  &level) const
  {
    Masks masks;
    for (unsigned int f = 0; f < level.face.size(); ++f)
      {
        const auto      &entry     = level.face[f];
        const Treatment &treatment = treatments[f];
        const FaceNode  &node      = face_nodes[entry.number];

        const Tensor<2, dim> free =
          node.unknown - node.to_cartesian(identity<3>() - treatment.projector);
        masks.entries.push_back(
          {entry.local,
           free,
           entry.row_sum + treatment.spring,
           inverse_on_range(entry.smoothing + treatment.spring, free)});
      }
    return masks;
  }



  template <int dim>
  void
  GeometricMultigrid<dim>::set_masks(const Masking         masking,
                                     const FaceTruncation *truncation)
  {
    std::vector<Treatment> here = treatments(truncation);
    for (unsigned int l = levels.size(); l-- > 0;)
      {
        levels[l]->masks[masking] = make_masks(here, *levels[l]);
        if (l > 0 && truncation != nullptr && !truncation->projector.empty())
          here = coarsen(here, *truncation, l);
        else if (l > 0)
          {
            Treatment free;
            free.projector = identity<3>();
            here.assign(levels[l - 1]->face.size(), free);
          }
      }

    const Level                                   &first = *levels[0];
    std::vector<typename CoarseProblem<dim>::Mask> coarse_masks;
    for (const auto &entry : first.fixed.entries)
      coarse_masks.push_back(
        {first.space->global_number(entry.node), entry.free, Tensor<2, dim>()});
    for (unsigned int f = 0; f < first.face.size(); ++f)
      coarse_masks.push_back({first.space->global_number(first.face[f].local),
                              first.masks[masking].entries[f].free,
                              here[f].spring});
    coarse->factorize(coarse_masks, coarse_factors[masking]);
    if (masks_in_use == masking)
      masks_in_use.reset();
  }



  template <int dim>
  void
  GeometricMultigrid<dim>::use_masks(const Masking masking) const
  {
    if (masks_in_use == masking)
      return;
    for (const auto &level : levels)
      for (const auto &entry : level->masks[masking].entries)
        {
          level->space->set_row_sum(entry.node, entry.row_sum);
          level->space->set_inverse_block(entry.node, entry.inverse);
        }
    masks_in_use = masking;
  }



  template <int dim>
  void
  GeometricMultigrid<dim>::set_truncation(const FaceTruncation &truncation,
                                          const bool /*may_rebuild*/)
  {
    set_masks(truncated, &truncation);
  }



  template <int dim>
  void
  GeometricMultigrid<dim>::cycle(const unsigned int l) const
  {
    const Level &level = *levels[l];
    auto        &x = level.space->x, &b = level.space->b, &r = level.space->r;
    const auto   project = [&](typename MultigridLevel<dim>::Vector &v) {
      level.fixed.project(v);
      level.masks[*masks_in_use].project(v);
    };
    if (l == 0)
      {
        project(b);
        Vector<double> sum(coarse->n_unknowns());
        for (unsigned int i = 0; i < level.nodes.size(); ++i)
          for (unsigned int d = 0; d < dim; ++d)
            sum[level.space->global_number(i) * dim + d] =
              b.begin()[i * dim + d];
        Utilities::MPI::sum(sum, communicator, sum);
        coarse_factors[*masks_in_use].factor->solve(sum);
        for (unsigned int i = 0; i < level.nodes.size(); ++i)
          for (unsigned int d = 0; d < dim; ++d)
            x.begin()[i * dim + d] =
              sum[level.space->global_number(i) * dim + d];
        project(x);
        return;
      }
    level.space->smooth_forward_from_zero(x, b);
    level.space->residual(r, x, b);
    project(r);
    level.space->restrict_to_coarse(levels[l - 1]->space->b, r);
    cycle(l - 1);
    level.space->interpolate(r, levels[l - 1]->space->x);
    project(r);
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
  void
  GeometricMultigrid<dim>::vmult(DistributedVector       &y,
                                 const DistributedVector &x) const
  {
    use_masks(truncated);
    vmult_in_frames(y, x);
  }



  template <int dim>
  void
  GeometricMultigrid<dim>::vmult_untruncated(DistributedVector       &y,
                                             const DistributedVector &x) const
  {
    use_masks(untruncated);
    vmult_in_frames(y, x);
  }



  template class GeometricMultigrid<2>;
  template class GeometricMultigrid<3>;
} // namespace Viscoplastic
