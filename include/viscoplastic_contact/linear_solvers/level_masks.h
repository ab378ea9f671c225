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


  /// A on the range of a projector, and a multiple of the identity, of the size
  /// of A, on its kernel.
  template <int dim>
  Tensor<2, dim>
  on_range(const Tensor<2, dim> &A, const Tensor<2, dim> &projector)
  {
    const double size = trace(A) > 0. ? trace(A) / dim : 1.;
    return projector * A * projector + size * (identity<dim>() - projector);
  }


  /// What the levels of a multigrid cycle know of excluded degrees of freedom
  /// and of a truncation on the face: at the nodes concerned a projector onto
  /// what is free, and springs.
  ///
  /// Matrices know nothing of it. Residuals and corrections are zero in the
  /// directions that are cut off, and a coarse node sticks if at least 40 % of
  /// the weight of the face nodes around it does. So another truncation costs
  /// nothing but the inverse diagonal blocks of face nodes.
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

    /// On the first level, where nodes are numbered over all ranks: the
    /// projector onto what is free at a node, and springs there.
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

    /// @p excluded: owned degrees of freedom that are no unknowns.
    LevelMasks(const std::vector<bool> &excluded,
               const NodeHierarchy     &hierarchy,
               const FaceRestriction   &restriction);

    /// Take levels with new matrix values, coarsest first, and set the inverse
    /// diagonal blocks of their nodes off the face. Discards all masks.
    void
    set_levels(const std::vector<MultigridLevel<dim> *> &levels);

    /// Make the masks of all levels for a truncation, or without one those of
    /// the excluded degrees of freedom alone. @p unit: the stiffness in which
    /// levels are measured. Returns what they are on the first level.
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

    /// Project a vector of a level onto the unknowns of the present cycle.
    void
    project(const unsigned int level, Vector &v) const;

  private:
    /// An owned face node of the finest mesh, and its directions.
    struct FaceNode
    {
      Node         node;
      unsigned int index; // among the nodes of the face
      /// Projector onto the directions that are unknowns, and the directions of
      /// the entries of face vectors.
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

    /// The treatments of face nodes on the finest mesh, ...
    std::vector<Treatment>
    treatments(const FaceTruncation *truncation, const double unit) const;

    /// ... their restriction to the level below @p level, ...
    std::vector<Treatment>
    coarsen(const std::vector<Treatment> &fine,
            const FaceTruncation         &truncation,
            const bool                    has_springs,
            const unsigned int            level) const;

    /// ... and the masks that they make on a level.
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
