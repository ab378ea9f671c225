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
  /// A multigrid cycle on the nested meshes from which the mesh has come: one
  /// sweep of Gauss-Seidel by nodes before and after the correction by the mesh
  /// below. On the first mesh there is a direct solver or, where it is large,
  /// one cycle of smoothed aggregation between two sweeps.
  ///
  /// The matrices of coarser meshes are those of the same bilinear form on
  /// their spaces (Galerkin products), whatever the material. They know nothing
  /// of the truncation: LevelMasks do, and another truncation costs little.
  /// Multigrid on truncated spaces is that of Graeser and Kornhuber, J. Comput.
  /// Math. 27, 2009.
  ///
  /// The levels are in single precision, which is enough for a preconditioner.
  template <int dim>
  class GeometricMultigrid : public Preconditioner
  {
  public:
    struct Options
    {
      /// The first level is the finest mesh with at most so many unknowns, or
      /// the first mesh.
      unsigned int coarse_size = 100;
    };

    /// @p excluded: owned degrees of freedom that are no unknowns;
    /// @p rigid_body_modes: on owned entries, zero where excluded, if the first
    /// level is too large for a direct solver; none otherwise. Collective.
    GeometricMultigrid(const DistributedMatrix              &matrix,
                       const std::vector<bool>              &excluded,
                       NodeHierarchy                         hierarchy,
                       const std::vector<DistributedVector> &rigid_body_modes,
                       const FaceRestriction                &restriction,
                       const Options                        &options);
    ~GeometricMultigrid() override;

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

    /// The truncation for which smoothed aggregation was built.
    std::optional<PreconditionerState>
    state() const override;

    void
    restore(const std::optional<PreconditionerState> &state) override;

  private:
    struct Level;

    /// Give all levels the values of the present matrix.
    void
    fill();

    /// The rigid body modes on the first level, one after the other.
    std::vector<double>
    on_first_level(const std::vector<DistributedVector> &modes) const;

    /// Make masks and what goes with them on the first level. Returns whether
    /// that was set up anew.
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

    /// The first node of each rank, and the end.
    std::vector<NodeHierarchy::Node> begins;
    /// The mesh of the first level; the others follow.
    unsigned int first_mesh = 0;
    /// Nodes of the last level whose frames are rotated, and their directions.
    std::vector<std::pair<unsigned int, Tensor<2, dim>>> rotated_nodes;
    std::vector<std::unique_ptr<Level>>                  levels;
    LevelMasks<dim>                                      masks;
    const bool                         has_direct_coarse_solver;
    std::vector<double>                coarse_modes;
    std::unique_ptr<CoarseSolver<dim>> coarse;
    /// The truncation for which smoothed aggregation was built.
    std::optional<FaceTruncation> built_for;
    /// The unit of stiffness on the levels, whose single precision has a small
    /// range.
    double unit = 1.;
  };
} // namespace Viscoplastic
