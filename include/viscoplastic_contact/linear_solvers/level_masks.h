// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/linear_solvers/face_restriction.h>
#include <viscoplastic_contact/linear_solvers/multigrid_level.h>

#include <array>
#include <optional>
#include <vector>

namespace Viscoplastic
{
  template <int dim>
  Tensor<2, dim>
  identity()
  {
    Tensor<2, dim> result;
    for (unsigned int i = 0; i < dim; ++i)
      result[i][i] = 1.;
    return result;
  }


  /// Return P A P + c (I - P) for a projector P, which is regular if A is
  /// positive definite; c has the size of A.
  template <int dim>
  Tensor<2, dim>
  on_range(const Tensor<2, dim> &A, const Tensor<2, dim> &projector)
  {
    const double size = trace(A) > 0. ? trace(A) / dim : 1.;
    return projector * A * projector + size * (identity<dim>() - projector);
  }


  /// The masks by which levels of a multigrid cycle respect excluded degrees of
  /// freedom and a truncation of the face: at each node concerned a projector
  /// onto the free directions, and springs.
  ///
  /// Level matrices do not depend on masks. Instead, residuals and corrections
  /// are projected, and a coarse node sticks if at least 40 % of the weight of
  /// the face nodes around it does. So a new truncation costs nothing but
  /// inverse diagonal blocks of face nodes.
  template <int dim>
  class LevelMasks
  {
  public:
    using Node   = NodeHierarchy::Node;
    using Vector = typename MultigridLevel<dim>::Vector;

    /// Masks are kept for cycles without and with a truncation.
    enum Masking
    {
      untruncated,
      truncated
    };

    /// The mask of a node on the first (coarsest) level: the projector onto its
    /// free directions, and its springs. Nodes are numbered over all ranks.
    struct Mask
    {
      Node           node;
      Tensor<2, dim> free, spring;

      bool
      operator==(const Mask &other) const
      {
        return node == other.node && free == other.free &&
               spring == other.spring;
      }

      template <class Archive>
      void
      serialize(Archive &archive, const unsigned int)
      {
        archive &node &free &spring;
      }
    };

    /// @p excluded: owned degrees of freedom that are not unknowns.
    LevelMasks(const std::vector<bool> &excluded,
               const NodeHierarchy     &hierarchy,
               const FaceRestriction   &restriction);

    /// Use these levels with new matrix values, coarsest first, and set the
    /// inverse diagonal blocks of nodes off the face. Discards all masks.
    void
    set_levels(const std::vector<std::unique_ptr<MultigridLevel<dim>>> &levels);

    /// Make the masks of all levels for @p truncation, or of the excluded
    /// degrees of freedom alone if it is null. @p unit: the stiffness by which
    /// level matrices are divided. Returns the masks on the first level.
    /// Collective.
    std::vector<Mask>
    set(const Masking         masking,
        const FaceTruncation *truncation,
        const double          unit);

    /// Use these masks in the next cycles.
    void
    use(const Masking masking) const;

    Masking
    in_use() const
    {
      return *used;
    }

    /// Project a vector of a level onto the free directions of masks in use.
    void
    project(const unsigned int level, Vector &v) const;

  private:
    /// An owned face node of the finest mesh, and its directions.
    struct FaceNode
    {
      Node         node;
      unsigned int index; // among the nodes of the face
      /// The projector onto the directions that are unknowns, and the direction
      /// of each of the node's entries in face vectors.
      Tensor<2, dim>                  unknown;
      std::array<Tensor<1, dim>, dim> direction;
      unsigned int                    n_dofs;

      Tensor<2, dim>
      to_cartesian(const Tensor<2, 3> &block) const;

      /// The number of directions that a projector of face entries removes.
      double
      n_blocked(const Tensor<2, 3> &projector) const;
    };

    /// The constraint and the spring that a truncation puts on a face node.
    struct Treatment
    {
      /// The projector onto the free directions of face entries, and the
      /// fraction of directions that it removes.
      Tensor<2, 3>   projector;
      double         blocked = 0.;
      Tensor<2, dim> spring; // Cartesian
    };

    /// The mask of a truncation at a node of a level.
    struct Entry
    {
      unsigned int   node; // local
      Tensor<2, dim> free; // a projector
      NodeBlock<dim> row_sum, inverse;
    };
    using Entries = std::vector<Entry>;

    /// A face node on a level: its local number, its number among the face
    /// nodes, the sum of its row and its block for the smoother, without
    /// springs.
    struct FaceEntry
    {
      unsigned int   local, number;
      NodeBlock<dim> row_sum, smoothing;
    };

    struct Level
    {
      MultigridLevel<dim>   *space;
      std::vector<FaceEntry> face;
      /// The masks of nodes off the face with excluded components, and of face
      /// nodes without and with the truncation.
      Entries                fixed;
      std::array<Entries, 2> on_face;
    };

    Tensor<1, dim>
    direction(const Node node, const unsigned int component) const;

    /// The treatments of face nodes on the finest mesh.
    std::vector<Treatment>
    treatments(const FaceTruncation *truncation, const double unit) const;

    /// The restriction of treatments on @p level to the next coarser level.
    std::vector<Treatment>
    coarsen(const std::vector<Treatment> &fine,
            const FaceTruncation         &truncation,
            const bool                    has_springs,
            const unsigned int            level) const;

    /// The masks of the face nodes of a level for given treatments.
    Entries
    make_entries(const std::vector<Treatment> &treatments,
                 const Level                  &level) const;

    const std::vector<bool> &excluded;
    const NodeHierarchy     &hierarchy;
    const FaceRestriction   &restriction;

    std::vector<FaceNode>          face_nodes;
    std::vector<Level>             levels;
    mutable std::optional<Masking> used;
  };


  template <int dim, typename Number>
  void
  multiply(const Tensor<2, dim> &tensor, Number *value)
  {
    Tensor<1, dim> x;
    for (unsigned int d = 0; d < dim; ++d)
      x[d] = value[d];
    x = tensor * x;
    for (unsigned int d = 0; d < dim; ++d)
      value[d] = x[d];
  }
} // namespace Viscoplastic
