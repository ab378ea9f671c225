// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/linear_solvers/coarse_solver.h>
#include <viscoplastic_contact/linear_solvers/face_restriction.h>
#include <viscoplastic_contact/linear_solvers/level_masks.h>
#include <viscoplastic_contact/linear_solvers/node_hierarchy.h>
#include <viscoplastic_contact/linear_solvers/preconditioner.h>

#include <memory>
#include <optional>
#include <vector>

namespace Viscoplastic
{
  /// A multigrid V-cycle on the nested spaces of a NodeHierarchy: one sweep of
  /// nodal block Gauss-Seidel before and after the coarse-mesh correction. The
  /// first level has a direct solver or, if it is large, one cycle of smoothed
  /// aggregation between two sweeps.
  ///
  /// The matrices of coarser spaces are Galerkin products, for any material.
  /// They do not contain the truncation: LevelMasks apply it, so that changing
  /// it costs little. Multigrid on truncated spaces is that of Graeser and
  /// Kornhuber, J. Comput. Math. 27, 2009.
  ///
  /// Levels use single precision, which suffices for a preconditioner.
  template <int dim>
  class GeometricMultigrid : public Preconditioner
  {
  public:
    struct Options
    {
      /// The first level is the finest space with at most so many unknowns, or
      /// the coarsest one if all have more.
      unsigned int coarse_size = 100;
    };

    /// @p excluded: owned degrees of freedom that are no unknowns; @p
    /// rigid_body_modes: on owned entries, zero where excluded, if the first
    /// level is too large for a direct solver; otherwise empty. Collective.
    GeometricMultigrid(const DistributedMatrix              &matrix,
                       const std::vector<bool>              &excluded,
                       NodeHierarchy                         hierarchy,
                       const std::vector<DistributedVector> &rigid_body_modes,
                       const FaceRestriction                &restriction,
                       const Options                        &options);

    std::string
    name() const override;

    bool
    renew() override;

    void
    set_truncation(const FaceTruncation &truncation,
                   const bool            may_rebuild) override;

    void
    vmult(DistributedVector &y, const DistributedVector &x) const override;

    void
    vmult_untruncated(DistributedVector       &y,
                      const DistributedVector &x) const override;

    /// Return the truncation for which smoothed aggregation was set up.
    std::optional<PreconditionerState>
    state() const override;

    void
    restore(const std::optional<PreconditionerState> &state) override;

  private:
    /// Return the owned nodes of a level, ascending.
    std::vector<NodeHierarchy::Node>
    nodes_of(const unsigned int level) const;

    /// Set all levels to the values of the present matrix.
    void
    fill();

    /// Return the rigid body modes on the first level, one after the other.
    std::vector<double>
    on_first_level(const std::vector<DistributedVector> &modes) const;

    /// Set the masks and the coarse solver for a truncation. Returns whether
    /// the coarse solver was set up anew.
    bool
    set_masks(const typename LevelMasks<dim>::Masking masking,
              const FaceTruncation                   *truncation,
              const bool                              may_rebuild);

    void
    cycle(const unsigned int level) const;

    void
    vmult_in_frames(DistributedVector &y, const DistributedVector &x) const;

    const DistributedMatrix &matrix;
    const std::vector<bool> &excluded;
    const NodeHierarchy      hierarchy;
    const MPI_Comm           communicator;
    const ContactLayout     &face;

    /// The first node of each rank, and the total number.
    std::vector<NodeHierarchy::Node> begins;
    /// The space of the first level; finer ones follow.
    unsigned int first_space = 0;
    /// Nodes of the last level whose frames are rotated, and their directions.
    std::vector<std::pair<unsigned int, Tensor<2, dim>>> rotated_nodes;
    std::vector<std::unique_ptr<MultigridLevel<dim>>>    levels;
    LevelMasks<dim>                                      masks;
    const bool                         has_direct_coarse_solver;
    std::vector<double>                coarse_modes;
    std::unique_ptr<CoarseSolver<dim>> coarse;
    /// The truncation for which smoothed aggregation was built.
    std::optional<FaceTruncation> built_for;
    /// The unit of stiffness on the levels, as single precision has a small
    /// range.
    double unit = 1.;
  };
} // namespace Viscoplastic
