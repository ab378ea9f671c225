// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/lac/affine_constraints.h>

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/discretization/mortar_interpolation.h>
#include <viscoplastic_contact/discretization/nodal_frame.h>
#include <viscoplastic_contact/mesh/plane_model.h>
#include <viscoplastic_contact/scene/scene.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// Distribute the degrees of freedom of the element FE_Q(1)^dim, numbered on
  /// each rank in the order of owned_cells(). Collective.
  template <int dim>
  void
  distribute_nodes(const FiniteElement<dim> &fe, DoFHandler<dim> &dof_handler);


  /// The space V_h of admissible displacements, the paper's U^h, and its
  /// translates: continuous, FE_Q(1) in each component, with hanging nodes,
  /// prescribed components in nodal frames of any orientation, and their values
  /// at time t. Displacement vectors come in two forms:
  ///
  /// - Cartesian: for evaluation and output;
  /// - in frames: each independent node in the components of its NodalFrame,
  ///   hanging nodes Cartesian. Matrices and load vectors are assembled in this
  ///   form, in which every prescribed component is one degree of freedom.
  ///
  /// At interfaces of two bodies, the second form has the jump w = u - Q u of
  /// the displacement in place of u at the nodes p of the secondary side, with
  /// Q = mortar_interpolation(): the change of variables u_p = w_p + C_p sum_q
  /// Q_pq u_q (Wohlmuth and Krause, SIAM J. Sci. Comput. 25, 2003), which turns
  /// two bodies into one on a rigid foundation. C_p excludes the directions
  /// that other conditions prescribe at the node.
  ///
  /// Constructed once per mesh, on degrees of freedom from distribute_nodes():
  /// the dim ones of a node are consecutive, so nodes are addressed by their
  /// first.
  template <int dim>
  class AdmissibleSpace
  {
  public:
    /// Collective. Throws ExcMessage, naming the motion, if the conditions
    /// leave a rigid motion free, unless unilateral contact may prevent it.
    AdmissibleSpace(const DoFHandler<dim> &dof_handler,
                    const Scene<dim>      &scene);

    const DoFHandler<dim> &dof_handler;
    const Scene<dim>      &scene;
    const MPI_Comm         communicator;
    /// The mapping whose JxW weight integrals over the body, including 2 pi r
    /// for bodies of revolution.
    const Mapping<dim> &mapping;
    /// Normals of the curved boundaries that are in contact with another body;
    /// null if there are none.
    const std::unique_ptr<const SurfaceNormals<dim>> surface_normals;
    /// The mortar interpolation of each secondary boundary, see
    /// mortar_interpolation().
    const std::map<types::boundary_id, MortarRows> mortar_rows;
    /// Degrees of freedom; relevant ones are at owned cells, their neighbors,
    /// and opposite to these on another body.
    const IndexSet owned, relevant;
    /// In generalized plane strain, the local index of the unknown eps_zz
    /// axial_length: the elongation of a slice of the length axial_length. It
    /// is the first component of an extra node behind the mesh, whose second
    /// one is no unknown. The last rank owns it, and it is relevant to all.
    const std::optional<std::size_t> axial;
    /// The length that scales the unknown of the axial strain in generalized
    /// plane strain: the size of the body, equal on all its meshes.
    const double axial_length;

    /// The owned cells, in the order of owned_cells(), as in all cell data.
    const std::vector<typename DoFHandler<dim>::active_cell_iterator> cells;
    /// Numbers of their shapes (see CellShapes).
    const std::vector<unsigned int> shapes;

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

    /// Return eps_zz of a displacement; @p u: local array of a ghosted vector.
    double
    axial_strain(const double *u) const
    {
      return axial ? u[*axial] / axial_length : 0.;
    }

    /// Return the owned index of the axial unknown, if this rank owns it.
    std::optional<std::size_t>
    owned_axial() const
    {
      if (axial && owned.is_element(dof_handler.n_dofs()))
        return *axial - first_owned;
      return {};
    }

    /// Set @p dofs to the rows of a cell's matrix: the degrees of freedom of
    /// its nodes, and the axial ones.
    void
    get_dofs(const typename DoFHandler<dim>::active_cell_iterator &cell,
             std::vector<types::global_dof_index>                 &dofs) const
    {
      dofs.resize(dof_handler.get_fe().n_dofs_per_cell());
      cell->get_dof_indices(dofs);
      for (unsigned int d = 0; axial && d < dim; ++d)
        dofs.push_back(dof_handler.n_dofs() + d);
    }

    /// Return the number of degrees of freedom on the coarse mesh; 0 if the
    /// mesh is not refined. The same on all ranks.
    types::global_dof_index
    n_first_dofs() const;

    /// Set @p matrix to zero, in frames, with entries for all cells.
    /// Collective.
    void
    reinit(DistributedMatrix &matrix) const;

    /// Add a Cartesian cell matrix to one in nodal frames; changes both.
    void
    add_cell_matrix(std::vector<types::global_dof_index> &dofs,
                    FullMatrix<double>                   &cell_matrix,
                    DistributedMatrix                    &matrix) const;

    /// The constraints of hanging nodes alone, in Cartesian components.
    const AffineConstraints<double> &
    cartesian_hanging_nodes() const
    {
      return hanging_cartesian;
    }

    /// Return the first degrees of freedom of the nodes on which a node
    /// depends, with their weights: its own unless it hangs.
    std::vector<std::pair<types::global_dof_index, double>>
    independent_nodes(const types::global_dof_index first_dof) const
    {
      const auto *const parents =
        hanging_cartesian.get_constraint_entries(first_dof);
      if (parents == nullptr)
        return {{first_dof, 1.}};
      return *parents;
    }

    /// Return a vector of owned entries, and one with ghosts on `relevant`.
    DistributedVector
    owned_vector() const
    {
      return DistributedVector(owned, communicator);
    }
    DistributedVector
    ghosted_vector() const
    {
      return DistributedVector(owned, relevant, communicator);
    }

    /// Give a vector that has the owned entries the ghosts of this space.
    void
    renew_ghosts(DistributedVector &vector) const;

    /// Add @p cartesian, sums over the owned cells in the order of `relevant`,
    /// to a load vector in frames, including the shares of hanging nodes.
    /// Changes @p cartesian; collective.
    void
    add_cartesian_load(std::vector<double> &cartesian,
                       DistributedVector   &load) const;

    /// Set @p ghosted to the Cartesian form of @p in_frames, with hanging nodes
    /// interpolated. Collective.
    void
    to_cartesian(const DistributedVector &in_frames,
                 DistributedVector       &ghosted) const;

    /// Subtract, at nodes of secondary boundaries, the mortar interpolation of
    /// the other body's displacement. Cartesian, with ghosts. Collective.
    void
    make_relative(DistributedVector &ghosted) const;

    /// Interpolate hanging nodes of a Cartesian vector of owned entries.
    /// Collective.
    void
    distribute_hanging_nodes(DistributedVector &cartesian) const
    {
      if (any_hanging)
        hanging_cartesian.distribute(cartesian);
    }

    /// Invert to_cartesian(): owned entries, zero at hanging nodes.
    void
    to_frames(const DistributedVector &ghosted,
              DistributedVector       &in_frames) const;

    /// The coupling u_p = w_p + projector sum weight u_q at an independent
    /// node; nodes by the relevant index of their first component.
    struct Coupling
    {
      std::size_t                                 node;
      Tensor<2, dim>                              projector; // C_p
      std::vector<std::pair<std::size_t, double>> others;
      /// The opposite position, interpolated likewise, and MortarRow::bulge.
      Point<dim> opposite;
      double     bulge;
    };

    /// Return the coupling of the independent node of a secondary boundary
    /// whose first degree of freedom is @p first_dof.
    const Coupling &
    coupling_at(const types::global_dof_index first_dof) const
    {
      return couplings
        [couplings_of_node.at(relevant.index_within_set(first_dof))[0].first];
    }

    /// Return the normal of a contact boundary at a locally relevant node.
    Tensor<1, dim>
    normal_at(const types::global_dof_index first_dof,
              const BoundaryCondition<dim> &condition) const
    {
      return condition.normal_varies ? surface_normals->at(first_dof) :
                                       condition.normal;
    }

    /// Return the pair whose secondary boundary is that of @p condition.
    ContactPair<dim>
    contact_pair(const BoundaryCondition<dim> &condition) const
    {
      return {condition.id,
              *condition.against,
              condition.normal,
              condition.normal_varies ? surface_normals.get() : nullptr,
              scene};
    }

    /// Call @p act (number of the cell, cell, number of the face, condition)
    /// for the boundary faces of the owned cells.
    template <typename Action>
    void
    for_each_boundary_face(const Action &act) const
    {
      for (std::size_t c = 0; c < cells.size(); ++c)
        for (const unsigned int f : cells[c]->face_indices())
          if (cells[c]->face(f)->at_boundary())
            act(c,
                cells[c],
                f,
                scene.boundary.at(cells[c]->face(f)->boundary_id()));
    }

    /// Return, for each owned index, whether the degree of freedom is
    /// prescribed or hanging, and so no unknown.
    const std::vector<bool> &
    excluded() const
    {
      return is_excluded;
    }

    void
    restrict_to_unknowns(DistributedVector &in_frames) const
    {
      for (std::size_t i = 0; i < is_excluded.size(); ++i)
        if (is_excluded[i])
          in_frames.begin()[i] = 0.;
    }

    /// A node with conditions or contact points on the boundary, owned by this
    /// rank.
    struct BoundaryNode
    {
      types::global_dof_index first_dof;
      Point<dim>              position;
      unsigned int            frame; // index into frames
    };

    /// Return the prescribed values at time t of a node, in the order of the
    /// fixed components of its frame, padded by zeros.
    Tensor<1, dim>
    prescribed_at(const BoundaryNode &node, const double t) const;

    /// Write the prescribed values at time t into a vector in frames.
    void
    set_prescribed(const double t, DistributedVector &in_frames) const;

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

    /// Return the frame of a relevant node, by its first degree of freedom.
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

    /// Return the rigid body modes (3 or 6) in frames on owned entries, zero
    /// where excluded; each relative to the center of the body. Collective.
    std::vector<DistributedVector>
    rigid_body_modes() const;

    /// Return a basis of the rigid motions that only contact can prevent, in
    /// the same form; no point moves by more than about 1. Collective.
    std::vector<DistributedVector>
    motions_held_by_contact() const;

    /// Return the name of a combination of free rigid motions, e.g. "rotation",
    /// by its largest component; @p in_free_motions: its coefficients.
    std::string
    name_of_motion(const std::vector<double> &in_free_motions) const;

  private:
    void
    make_frames();
    void
    make_couplings();
    /// Add factor C Q u to v at owned nodes, u Cartesian: the mortar
    /// interpolation Q u in the coupled directions C, or in all of them.
    void
    add_opposite(const double             factor,
                 const DistributedVector &ghosted_u,
                 DistributedVector       &v,
                 const bool               also_where_held = false) const;
    /// Whether a node of a cell is coupled to another body.
    bool
    is_coupled(const std::vector<types::global_dof_index> &dofs) const
    {
      if (couplings.empty())
        return false;
      for (std::size_t a = 0; a < dofs.size(); a += dim)
        if (coupled_nodes[relevant.index_within_set(dofs[a]) / dim])
          return true;
      return false;
    }
    /// Transform a cell matrix to jumps across interfaces, and append the
    /// opposite degrees of freedom to @p dofs.
    void
    couple(std::vector<types::global_dof_index> &dofs,
           FullMatrix<double>                   &cell_matrix) const;
    /// Distribute rows of hanging nodes to their parents, which are appended to
    /// @p dofs; the diagonal entries of hanging nodes stay positive.
    void
    resolve_hanging_nodes(std::vector<types::global_dof_index> &dofs,
                          FullMatrix<double> &cell_matrix) const;
    void
    rotate(const std::vector<types::global_dof_index> &dofs,
           FullMatrix<double>                         &cell_matrix) const;
    void
    check_rigid_motions();
    /// Number the connected parts of the body; return the numbers of nodes,
    /// with ghosts, at the first entry of each node. Collective.
    DistributedVector
    number_parts(const std::vector<unsigned int> &part_of_coarse_cell);
    /// Return a rigid motion of one part or of all, in frames. Collective.
    DistributedVector
    rigid_motion(const unsigned int motion, const unsigned int part) const;
    /// Return the mean position of the nodes. Collective.
    Point<dim>
    center() const
    {
      Tensor<1, dim> sum;
      const double   count = node_position.size();
      for (const auto &x : node_position)
        sum += x;
      return Point<dim>(Utilities::MPI::sum(sum, communicator) /
                        Utilities::MPI::sum(count, communicator));
    }

    /// The rigid motions that only contact can prevent, by coefficients for
    /// each separate part: of translations, and of rotations times `radius`,
    /// the largest distance from the center.
    std::vector<std::vector<double>> free_motions;
    /// The part of the body of each owned node; empty where there is one part.
    std::vector<unsigned int> part_of_node;
    double                    radius        = 0.;
    bool                      needs_springs = false;
    AffineConstraints<double> hanging_cartesian;
    bool                      any_hanging;
    /// Relevant index of the first owned entry.
    std::size_t first_owned;
    /// Frame 0 is that of a node without conditions.
    std::vector<NodalFrame<dim>> frames;
    /// Index into frames for each node of `relevant', by relevant index / dim.
    std::vector<unsigned int> frame_of_node;
    /// The nodes of `relevant` (index of the first component) with rotated
    /// frames: few, so that rotations cost little.
    std::vector<std::size_t>  rotated_nodes;
    std::vector<BoundaryNode> nodes;
    std::vector<bool>         is_excluded;
    /// Owned entries of hanging nodes, by local position.
    std::vector<std::size_t> hanging_entries;
    /// Support point of each owned node of the mesh.
    std::vector<Point<dim>> node_position;

    std::vector<Coupling> couplings;
    /// The couplings of a node, with weight 1, or those of its parents, with
    /// their weights, if it hangs; by relevant index of the node.
    std::map<std::size_t, std::vector<std::pair<std::size_t, double>>>
      couplings_of_node;
    /// Whether a node is in couplings_of_node, by relevant index / dim.
    std::vector<bool> coupled_nodes;
  };
} // namespace Viscoplastic
