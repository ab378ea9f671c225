// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/lac/affine_constraints.h>

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/discretization/mortar_interpolation.h>
#include <viscoplastic_contact/discretization/nodal_frame.h>
#include <viscoplastic_contact/mesh/plane_model.h>
#include <viscoplastic_contact/scene/scene.h>

#include <array>
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
  /// Where two bodies touch, the second form has the jump w = u - Q u of the
  /// displacement across the interface in place of u at the nodes p of the
  /// secondary side, Q being mortar_interpolation(): the change of variables
  /// u_p = w_p + C_p sum_q Q_pq u_q (Wohlmuth and Krause, SIAM J. Sci. Comput.
  /// 25, 2003), in which two bodies are one on a rigid foundation. C_p leaves
  /// out what other conditions prescribe at the node.
  ///
  /// Built anew on every mesh, on degrees of freedom from distribute_nodes():
  /// the dim ones of a node are consecutive, so nodes are addressed by their
  /// first.
  template <int dim>
  class AdmissibleSpace
  {
  public:
    /// Collective. Throws ExcMessage when the conditions leave a rigid motion
    /// free, naming it, unless there is unilateral contact, which may prevent
    /// it.
    AdmissibleSpace(const DoFHandler<dim> &dof_handler,
                    const Scene<dim>      &scene);

    const DoFHandler<dim> &dof_handler;
    const Scene<dim>      &scene;
    const MPI_Comm         communicator;
    /// The mapping whose JxW are weights of integrals over the body: with 2 pi
    /// r for bodies of revolution.
    const Mapping<dim> &mapping;
    /// Normals of the curved boundaries that are in contact with another body;
    /// null if there are none.
    const std::unique_ptr<const SurfaceNormals<dim>> surface_normals;
    /// The mortar interpolation of each secondary boundary, see
    /// mortar_interpolation().
    const std::map<types::boundary_id, MortarRows> mortar_rows;
    /// Degrees of freedom; relevant ones are at owned cells, their neighbors,
    /// and opposite of these on another body.
    const IndexSet owned, relevant;
    /// The position among the relevant ones of one more unknown, where there
    /// is: eps_zz axial_length in generalized plane strain, by how much a slice
    /// of the length axial_length becomes longer. It is the first component of
    /// a node of no mesh, behind all others; the second one is no unknown. The
    /// last rank owns it, and it is relevant to all.
    const std::optional<std::size_t> axial;
    /// The length that scales the unknown of the axial strain in generalized
    /// plane strain: the size of the body, equal on all its meshes.
    const double axial_length;

    /// The owned cells, in the order of owned_cells(): that of all data that
    /// have values in cells.
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

    /// eps_zz of a displacement, by the local array of a ghosted vector.
    double
    axial_strain(const double *u) const
    {
      return axial ? u[*axial] / axial_length : 0.;
    }

    /// The position of the axial unknown among the owned ones, if it is.
    std::optional<std::size_t>
    owned_axial() const
    {
      if (axial && owned.is_element(dof_handler.n_dofs()))
        return *axial - first_owned;
      return {};
    }

    /// The rows and columns of a cell's matrix: the degrees of freedom of its
    /// nodes, and the axial one.
    void
    get_dofs(const typename DoFHandler<dim>::active_cell_iterator &cell,
             std::vector<types::global_dof_index>                 &dofs) const
    {
      dofs.resize(dof_handler.get_fe().n_dofs_per_cell());
      cell->get_dof_indices(dofs);
      for (unsigned int d = 0; axial && d < dim; ++d)
        dofs.push_back(dof_handler.n_dofs() + d);
    }

    /// Degrees of freedom on the mesh that this one is refined from; 0 where it
    /// is not refined. The same on all ranks.
    types::global_dof_index
    n_first_dofs() const;

    /// Make a matrix in frames zero, with entries for all cells. Collective.
    void
    reinit(DistributedMatrix &matrix) const;

    /// Add a Cartesian cell matrix to one in nodal frames. Both change.
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

    /// A vector of owned entries, and one with ghosts on `relevant`.
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

    /// Add @p cartesian, sums over the owned cells in the order of `relevant`,
    /// to a load vector in frames: hanging nodes pass their share on.
    /// Changes @p cartesian; collective.
    void
    add_cartesian_load(std::vector<double> &cartesian,
                       DistributedVector   &load) const;

    /// The Cartesian, ghosted form of @p in_frames; hanging nodes are
    /// interpolated. Collective.
    void
    to_cartesian(const DistributedVector &in_frames,
                 DistributedVector       &ghosted) const;

    /// Make the displacement at nodes of secondary boundaries that relative to
    /// the other body: subtract its mortar interpolation. Cartesian, with
    /// ghosts. Collective.
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

    /// The inverse of to_cartesian(): owned entries, zero at hanging nodes.
    void
    to_frames(const DistributedVector &ghosted,
              DistributedVector       &in_frames) const;

    /// u_p = w_p + projector sum weight u_q at an independent node; nodes by
    /// the position of their first entries among the relevant ones.
    struct Coupling
    {
      std::size_t                                 node;
      Tensor<2, dim>                              projector; // C_p
      std::vector<std::pair<std::size_t, double>> others;
      /// The place opposite, by the same interpolation, and MortarRow::bulge.
      Point<dim> opposite;
      double     bulge;
    };

    /// The coupling of the independent node of a secondary boundary whose first
    /// degree of freedom is @p first_dof.
    const Coupling &
    coupling_at(const types::global_dof_index first_dof) const
    {
      return couplings
        [couplings_of_node.at(relevant.index_within_set(first_dof))[0].first];
    }

    /// The normal of a boundary in contact at a locally relevant node.
    Tensor<1, dim>
    normal_at(const types::global_dof_index first_dof,
              const BoundaryCondition<dim> &condition) const
    {
      return condition.normal_varies ? surface_normals->at(first_dof) :
                                       condition.normal;
    }

    /// The pair of boundaries of which a condition makes the secondary one.
    ContactPair<dim>
    contact_pair(const BoundaryCondition<dim> &condition) const
    {
      return {condition.id,
              *condition.against,
              condition.normal,
              condition.normal_varies ? surface_normals.get() : nullptr,
              scene};
    }

    /// Owned degrees of freedom that are no unknowns: prescribed or hanging;
    /// one entry for each owned index.
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

    /// The prescribed values at time t of a node, in the order of the fixed
    /// components of its frame; zero behind them.
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

    /// The rigid body modes (3 or 6) in frames on owned entries, zero where
    /// excluded; each relative to the center of the body.
    std::vector<DistributedVector>
    rigid_body_modes() const;

    /// A basis of the rigid motions that only contact can prevent, in the same
    /// form; no point moves by more than about 1.
    std::vector<DistributedVector>
    motions_held_by_contact() const;

    /// The name of a combination of free rigid motions, such as "rotation", by
    /// its largest component; @p in_free_motions: its coefficients.
    std::string
    name_of_motion(const std::vector<double> &in_free_motions) const;

  private:
    void
    make_frames();
    void
    make_couplings();
    /// v := v + factor C Q u at owned nodes, u Cartesian: the mortar
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
    /// Replace a cell matrix by that in the jumps across interfaces, whose
    /// degrees of freedom include those opposite.
    void
    couple(std::vector<types::global_dof_index> &dofs,
           FullMatrix<double>                   &cell_matrix) const;
    /// Replace hanging nodes by those that they hang on, which become further
    /// degrees of freedom; on their own diagonal something is left.
    void
    resolve_hanging_nodes(std::vector<types::global_dof_index> &dofs,
                          FullMatrix<double> &cell_matrix) const;
    void
    rotate(const std::vector<types::global_dof_index> &dofs,
           FullMatrix<double>                         &cell_matrix) const;
    void
    check_rigid_motions();
    /// Number the parts of the body that owned nodes are of; returns these
    /// numbers with ghosts, at the first entry of each node. Collective.
    DistributedVector
    number_parts(const std::vector<unsigned int> &part_of_coarse_cell);
    /// A rigid motion of one part or of all, in nodal frames. Collective.
    DistributedVector
    rigid_motion(const unsigned int motion, const unsigned int part) const;
    /// The mean position of the nodes. Collective.
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

    /// The rigid motions that only contact can prevent: of each of the parts
    /// that move by themselves, translations and rotations times `radius`, the
    /// largest distance from the center.
    std::vector<std::vector<double>> free_motions;
    /// The part of the body of each owned node; empty where there is one part.
    std::vector<unsigned int> part_of_node;
    double                    radius        = 0.;
    bool                      needs_springs = false;
    AffineConstraints<double> hanging_cartesian;
    bool                      any_hanging;
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
    /// Support point of each owned node of the mesh.
    std::vector<Point<dim>> node_position;

    std::vector<Coupling> couplings;
    /// The couplings of a node, with weight 1, or of the parents that it hangs
    /// on, with theirs; by position of the node.
    std::map<std::size_t, std::vector<std::pair<std::size_t, double>>>
      couplings_of_node;
    /// Whether a node is in couplings_of_node, by position / dim.
    std::vector<bool> coupled_nodes;
  };
} // namespace Viscoplastic
