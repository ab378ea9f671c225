// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/linear_solvers/level_masks.h>

namespace Viscoplastic
{
  namespace
  {
    /// A coarse node sticks if this part of the weight of the face nodes around
    /// it does.
    constexpr double sticking_share = 0.4;



    /// The inverse of A on the range of a projector, zero on its kernel.
    template <int dim>
    Tensor<2, dim>
    inverse_on_range(const Tensor<2, dim> &A, const Tensor<2, dim> &projector)
    {
      return projector * invert(on_range(A, projector)) * projector;
    }
  } // namespace



  template <int dim>
  Tensor<2, dim>
  LevelMasks<dim>::FaceNode::to_cartesian(const Tensor<2, 3> &block) const
  {
    Tensor<2, dim> result;
    for (unsigned int i = 0; i < n_dofs; ++i)
      for (unsigned int j = 0; j < n_dofs; ++j)
        result += block[i][j] * outer_product(direction[i], direction[j]);
    return result;
  }



  template <int dim>
  double
  LevelMasks<dim>::FaceNode::n_blocked(const Tensor<2, 3> &projector) const
  {
    double result = n_dofs;
    for (unsigned int i = 0; i < n_dofs; ++i)
      result -= projector[i][i];
    return result;
  }



  template <int dim>
  LevelMasks<dim>::LevelMasks(const std::vector<bool> &excluded,
                              const NodeHierarchy     &hierarchy,
                              const FaceRestriction   &restriction)
    : excluded(excluded)
    , hierarchy(hierarchy)
    , restriction(restriction)
  {
    const ContactLayout &face = restriction.face();
    for (unsigned int n = 0; n < face.n_nodes(); ++n)
      {
        const unsigned int first = face.first_dof[n];
        const Node         node  = restriction.dofs()[first] / dim;
        FaceNode           result;
        result.node   = node;
        result.index  = n;
        result.n_dofs = face.n_node_dofs(n);
        for (unsigned int c = 0; c < dim; ++c)
          if (!excluded[(node - hierarchy.begin) * dim + c])
            result.unknown +=
              outer_product(direction(node, c), direction(node, c));
        for (unsigned int i = 0; i < result.n_dofs; ++i)
          result.direction[i] =
            direction(node, restriction.dofs()[first + i] % dim);
        face_nodes.push_back(result);
      }
  }



  template <int dim>
  Tensor<1, dim>
  LevelMasks<dim>::direction(const Node         node,
                             const unsigned int component) const
  {
    Tensor<1, dim> result;
    const auto     frame = hierarchy.frames.find(node);
    if (frame == hierarchy.frames.end())
      result[component] = 1.;
    else
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = frame->second[d][component];
    return result;
  }



  template <int dim>
  void
  LevelMasks<dim>::set_levels(
    const std::vector<std::unique_ptr<MultigridLevel<dim>>> &spaces)
  {
    std::map<Node, unsigned int> face_node;
    for (unsigned int f = 0; f < face_nodes.size(); ++f)
      face_node[face_nodes[f].node] = f;
    levels.clear();
    used.reset();
    for (const auto &space : spaces)
      {
        Level level;
        level.space = space.get();
        for (unsigned int i = 0; i < space->owned_nodes().size(); ++i)
          {
            const Node node = space->owned_nodes()[i];
            const auto face = face_node.find(node);
            if (face != face_node.end())
              {
                level.face.push_back({i,
                                      face->second,
                                      space->row_sum(i),
                                      space->smoothing_block(i)});
                continue;
              }
            Tensor<2, dim> free     = identity<dim>();
            bool           is_fixed = false;
            for (unsigned int c = 0; c < dim; ++c)
              if (excluded[(node - hierarchy.begin) * dim + c])
                {
                  is_fixed = true;
                  free -= outer_product(direction(node, c), direction(node, c));
                }
            const NodeBlock<dim> inverse =
              inverse_on_range(space->smoothing_block(i), free);
            space->set_inverse_block(i, inverse);
            if (is_fixed)
              level.fixed.push_back({i, free, space->row_sum(i), inverse});
          }
        levels.push_back(std::move(level));
      }
  }



  template <int dim>
  std::vector<typename LevelMasks<dim>::Treatment>
  LevelMasks<dim>::treatments(const FaceTruncation *truncation,
                              const double          unit) const
  {
    std::vector<Treatment> result;
    for (const FaceEntry &entry : levels.back().face)
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
  std::vector<typename LevelMasks<dim>::Treatment>
  LevelMasks<dim>::coarsen(const std::vector<Treatment> &treatments,
                           const FaceTruncation         &truncation,
                           const bool                    has_springs,
                           const unsigned int            l) const
  {
    const Level           &level = levels[l], &below = levels[l - 1];
    auto                  &sums = below.space->b;
    std::vector<Treatment> result(below.face.size());
    // Set `sums` at nodes around the face, and of other ranks, to the sum of
    // the weights of face nodes times value(f).
    const auto restrict_from_face = [&](const auto &value) {
      const auto at_parents = [&](const auto &act) {
        for (unsigned int f = 0; f < level.face.size(); ++f)
          level.space->for_each_parent(
            level.face[f].local,
            [&](const unsigned int parent, const float weight) {
              act(f, sums.begin() + parent * dim, weight);
            });
      };
      at_parents([](const unsigned int, float *const sum, const float) {
        std::fill_n(sum, dim, 0.f);
      });
      at_parents(
        [&](const unsigned int f, float *const sum, const float weight) {
          const auto of_node = value(f);
          for (unsigned int d = 0; d < of_node.dimension; ++d)
            sum[d] += weight * static_cast<float>(of_node[d]);
        });
      sums.compress(VectorOperation::add);
    };

    // The weights of sticking and of all face nodes around a coarse one.
    restrict_from_face([&](const unsigned int f) {
      return Point<2>(treatments[f].blocked, 1.);
    });
    for (unsigned int f = 0; f < below.face.size(); ++f)
      {
        const float *const sum    = sums.begin() + below.face[f].local * dim;
        const bool         sticks = sum[0] >= sticking_share * sum[1];
        result[f].blocked         = sticks ? 1. : 0.;
        if (!sticks)
          result[f].projector = identity<3>();
        // A coarse node of which only some directions are blocked, as on edges
        // of the face, keeps its own projector.
        const FaceNode     &node = face_nodes[below.face[f].number];
        const Tensor<2, 3> &own  = truncation.projector[node.index];
        const double        n    = node.n_blocked(own);
        if (n > 0.5 && n < node.n_dofs - 0.5)
          {
            result[f].projector = own;
            result[f].blocked   = n / node.n_dofs;
          }
      }

    // Lump the springs, column by column.
    if (has_springs)
      for (unsigned int j = 0; j < dim; ++j)
        {
          restrict_from_face([&](const unsigned int f) {
            return transpose(treatments[f].spring)[j];
          });
          for (unsigned int f = 0; f < below.face.size(); ++f)
            for (unsigned int i = 0; i < dim && result[f].blocked < 1.; ++i)
              result[f].spring[i][j] =
                sums.begin()[below.face[f].local * dim + i];
        }
    return result;
  }



  template <int dim>
  typename LevelMasks<dim>::Entries
  LevelMasks<dim>::make_entries(const std::vector<Treatment> &treatments,
                                const Level                  &level) const
  {
    Entries result;
    for (unsigned int f = 0; f < level.face.size(); ++f)
      {
        const FaceEntry &entry     = level.face[f];
        const Treatment &treatment = treatments[f];
        const FaceNode  &node      = face_nodes[entry.number];

        const Tensor<2, dim> free =
          node.unknown - node.to_cartesian(identity<3>() - treatment.projector);
        result.push_back(
          {entry.local,
           free,
           entry.row_sum + treatment.spring,
           inverse_on_range(entry.smoothing + treatment.spring, free)});
      }
    return result;
  }



  template <int dim>
  std::vector<typename LevelMasks<dim>::Mask>
  LevelMasks<dim>::set(const Masking         masking,
                       const FaceTruncation *truncation,
                       const double          unit)
  {
    const bool is_masked =
      truncation != nullptr && restriction.n_global_dofs() > 0;
    const bool has_springs =
      is_masked && truncation->has_springs(restriction.face());
    std::vector<Treatment> here = treatments(truncation, unit);
    for (unsigned int l = levels.size(); l-- > 0;)
      {
        levels[l].on_face[masking] = make_entries(here, levels[l]);
        if (l > 0 && is_masked)
          here = coarsen(here, *truncation, has_springs, l);
        else if (l > 0)
          {
            Treatment free;
            free.projector = identity<3>();
            here.assign(levels[l - 1].face.size(), free);
          }
      }
    if (used == masking)
      used.reset();

    const Level      &first = levels[0];
    std::vector<Mask> result;
    for (const Entry &entry : first.fixed)
      result.push_back(
        {first.space->global_number(entry.node), entry.free, Tensor<2, dim>()});
    for (unsigned int f = 0; f < first.face.size(); ++f)
      result.push_back({first.space->global_number(first.face[f].local),
                        first.on_face[masking][f].free,
                        here[f].spring});
    return result;
  }



  template <int dim>
  void
  LevelMasks<dim>::use(const Masking masking) const
  {
    if (used == masking)
      return;
    for (const Level &level : levels)
      for (const Entry &entry : level.on_face[masking])
        {
          level.space->set_row_sum(entry.node, entry.row_sum);
          level.space->set_inverse_block(entry.node, entry.inverse);
        }
    used = masking;
  }



  template <int dim>
  void
  LevelMasks<dim>::project(const unsigned int level, Vector &v) const
  {
    for (const Entries *entries :
         {&levels[level].fixed, &levels[level].on_face[*used]})
      for (const Entry &entry : *entries)
        multiply(entry.free, v.begin() + entry.node * dim);
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(LevelMasks);
} // namespace Viscoplastic
