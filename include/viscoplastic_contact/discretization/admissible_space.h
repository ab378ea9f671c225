// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/lac/affine_constraints.h>

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/discretization/nodal_frame.h>
#include <viscoplastic_contact/scene/scene.h>

#include <array>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /**
   * Distribute the degrees of freedom of the element FE_Q(1)^dim, numbered on
   * each rank in the order of owned_cells(). Collective.
   */
  template <int dim>
  void
  distribute_nodes(const FiniteElement<dim> &fe, DoFHandler<dim> &dof_handler);


  /**
   * The space V_h of admissible displacements, the paper's U^h, and its
   * translates: continuous, FE_Q(1) in each component, with hanging nodes,
   * prescribed components in nodal frames of any orientation, and their values
   * at time t. Displacement vectors come in two forms:
   *
   * - Cartesian: for evaluation and output;
   * - in frames: each independent node in the components of its NodalFrame,
   *   hanging nodes Cartesian. Matrices and load vectors are assembled in this
   *   form, in which every prescribed component is one degree of freedom.
   *
   * Built anew on every mesh, on degrees of freedom from distribute_nodes():
   * the dim ones of a node are consecutive, so nodes are addressed by their
   * first.
   */
  template <int dim>
  class AdmissibleSpace
  {
  public:
    /**
     * Collective. Throws ExcMessage when the conditions leave a rigid motion
     * free, naming it, unless there is unilateral contact, which may prevent
     * it.
     */
    AdmissibleSpace(const DoFHandler<dim> &dof_handler,
                    const Scene<dim>      &scene);

    const DoFHandler<dim> &dof_handler;
    const Scene<dim>      &scene;
    const MPI_Comm         communicator;
    const IndexSet         owned, relevant;

    /// The owned cells, in the order of owned_cells(): that of all data that
    /// have values in cells.
    const std::vector<typename DoFHandler<dim>::active_cell_iterator> cells;

    /// Whether there is a rigid motion that only contact can prevent. The same
    /// on all ranks.
    bool
    is_held_by_contact() const
    {
      return !free_motions.empty();
    }

    /// Whether there is a rigid motion that springs have to prevent. The same
    /// on all ranks.
    bool
    is_held_by_springs() const
    {
      return needs_springs;
    }

    /// Degrees of freedom on the mesh that this one is refined from; 0 where it
    /// is not refined. The same on all ranks.
    types::global_dof_index
    n_first_dofs() const;

    /// Hanging nodes only, in frames; for assembling matrices.
    const AffineConstraints<double> &
    hanging_nodes() const
    {
      return hanging_in_frames;
    }

    /// Hanging nodes only, in Cartesian components.
    const AffineConstraints<double> &
    cartesian_hanging_nodes() const
    {
      return hanging_cartesian;
    }

    /// A vector of owned entries, and one with ghosts on `relevant`.
    DistributedVector
    owned_vector() const;
    DistributedVector
    ghosted_vector() const;

    /**
     * Add @p cartesian, sums over the owned cells in the order of `relevant`,
     * to a load vector in frames: hanging nodes pass their share on.
     * Changes @p cartesian; collective.
     */
    void
    add_cartesian_load(std::vector<double> &cartesian,
                       DistributedVector   &load) const;

    /// The Cartesian, ghosted form of @p in_frames; hanging nodes are
    /// interpolated. Collective.
    void
    to_cartesian(const DistributedVector &in_frames,
                 DistributedVector       &ghosted) const;

    /// Interpolate hanging nodes of a Cartesian vector of owned entries.
    /// Collective.
    void
    distribute_hanging_nodes(DistributedVector &cartesian) const;

    /// The inverse, into a vector of owned entries, zero at hanging nodes.
    void
    to_frames(const DistributedVector &ghosted,
              DistributedVector       &in_frames) const;

    /// Rotate a Cartesian cell matrix into the frames of its nodes.
    void
    rotate(const std::vector<types::global_dof_index> &dofs,
           FullMatrix<double>                         &cell_matrix) const;

    /// Write the prescribed values at time t into a vector in frames.
    void
    set_prescribed(const double t, DistributedVector &in_frames) const;

    /// Owned degrees of freedom that are no unknowns: prescribed or hanging;
    /// one entry for each owned index.
    const std::vector<bool> &
    excluded() const
    {
      return is_excluded;
    }

    /// Set the entries that are no unknowns to zero.
    void
    restrict_to_unknowns(DistributedVector &in_frames) const;

    /// A node with conditions or contact points on the boundary, owned by this
    /// rank.
    struct BoundaryNode
    {
      types::global_dof_index first_dof;
      Point<dim>              position;
      unsigned int            frame; // index into frames
    };

    const std::vector<BoundaryNode> &
    boundary_nodes() const
    {
      return nodes;
    }

    const NodalFrame<dim> &
    frame(const unsigned int index) const
    {
      return frames[index];
    }

    /// The frame of a node of `relevant', by the first degree of freedom of the
    /// node.
    const NodalFrame<dim> &
    frame_at(const types::global_dof_index first_dof) const
    {
      return frames[frame_of_node[relevant.index_within_set(first_dof) / dim]];
    }

    /// Call @p act (first degree of freedom, directions of the frame) for each
    /// node of `relevant` whose frame is rotated.
    template <typename Function>
    void
    for_each_rotated_node(const Function &act) const
    {
      for (const std::size_t n : rotated_nodes)
        act(relevant.nth_index_in_set(n),
            frames[frame_of_node[n / dim]].directions);
    }

    /**
     * The rigid body modes (3 or 6) in frames on owned entries, zero where
     * excluded; each relative to the center of the body.
     */
    std::vector<DistributedVector>
    rigid_body_modes() const;

    /// A basis of the rigid motions that only contact can prevent, in the same
    /// form; no point moves by more than about 1.
    std::vector<DistributedVector>
    motions_held_by_contact() const;

    /// What a combination of these is called, by its largest part.
    std::string
    name_of_motion(const std::vector<double> &in_free_motions) const;

  private:
    void
    make_frames();
    void
    make_hanging_nodes_in_frames();
    void
    check_rigid_motions();
    /// The mean position of the nodes. Collective.
    Point<dim>
    center() const;

    /// The rigid motions that only contact can prevent, by translations and
    /// rotations times `radius`, the largest distance from the center.
    std::vector<std::array<double, 6>> free_motions;
    double                             radius        = 0.;
    bool                               needs_springs = false;
    AffineConstraints<double>          hanging_cartesian, hanging_in_frames;
    /// Whether any rank has hanging nodes.
    bool any_hanging;
    /// Position of the first owned entry among the relevant ones.
    std::size_t first_owned;
    /// Frame 0 is that of a node without conditions.
    std::vector<NodalFrame<dim>> frames;
    /// Index into frames for each node of `relevant`, by position / dim.
    std::vector<unsigned int> frame_of_node;
    /// The nodes of `relevant` (position of their first entry) whose frames
    /// are rotated: few, so that rotations cost little.
    std::vector<std::size_t>  rotated_nodes;
    std::vector<BoundaryNode> nodes;
    std::vector<bool>         is_excluded;
    /// Owned entries of hanging nodes, by local position.
    std::vector<std::size_t> hanging_entries;
    /// Support point of each owned node.
    std::vector<Point<dim>> node_position;
  };
} // namespace Viscoplastic
