// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/solution_transfer.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/discretization/state.h>
#include <viscoplastic_contact/error/history_reconstruction.h>

#include <array>
#include <vector>

namespace Viscoplastic
{
  /// Transfers a state to a changed mesh and to the ranks that own the new
  /// cells:
  ///
  /// - displacements and multiplier density by interpolation;
  /// - z and the other fields at samples by an L2 projection that conserves int
  /// z over every cell that is refined or coarsened. Samples on the children of
  /// a cell are values of the polynomial through the parent's samples: a copy
  /// of cell means, the (bi-, tri-)linear interpolant of quadrature points.
  /// With viscosity, slopes of z and sigma_h of children are fitted to the
  /// means of neighbors (see HistoryReconstruction).
  ///
  /// Equilibrium is restored by the next step, which solves for the total
  /// displacement.
  ///
  /// Construct it when the cells are marked, change the mesh, distribute the
  /// degrees of freedom, then call unpack(). Copies the fields, but refers to
  /// the DoFHandler of @p old_stress_space until unpack().
  template <int dim>
  class StateTransfer
  {
  public:
    /// @p multiplier_density is ghosted, and null without contact points.
    /// Collective.
    StateTransfer(parallel::distributed::Triangulation<dim> &triangulation,
                  const StressSpace<dim>                    &old_stress_space,
                  const State<dim>                          &state,
                  const DistributedVector *multiplier_density);

    /// Not copyable: the triangulation calls pack() of this object.
    StateTransfer(const StateTransfer &) = delete;
    StateTransfer &
    operator=(const StateTransfer &) = delete;

    struct Result
    {
      /// Without contact points, whose number depends on the new face.
      State<dim> state;
      /// Ghosted; empty without contact points.
      DistributedVector multiplier_density;
      /// sigma_h, carried like z; empty without viscosity.
      IrreversibleStress stress;
      /// The squared error of z in cells that have been refined (see
      /// HistoryReconstruction). Besides marked cells these are others that the
      /// mesh refines to keep neighbors within one level.
      double of_refined_cells = 0.;
    };

    /// Return the state on the new mesh. To be called once. Collective.
    Result
    unpack(const StressSpace<dim> &new_stress_space);

  private:
    using CellIterator = typename Triangulation<dim>::cell_iterator;
    using CellStatus   = typename Triangulation<dim>::CellStatus;

    std::vector<char>
    pack(const CellIterator &cell, const CellStatus status) const;

    /// Set the field @p z at the samples of the new cells that replace @p cell,
    /// from one field of pack(). @p new_cell: numbers by active cell index.
    template <typename Field>
    void
    unpack_samples(const CellIterator              &cell,
                   const CellStatus                 status,
                   const SymmetricTensor<2, 3>     *values,
                   const StressSpace<dim>          &new_stress_space,
                   const std::vector<unsigned int> &new_cell,
                   Field                           &z) const;

    parallel::distributed::Triangulation<dim> &triangulation;
    const unsigned int                         n_samples;
    /// The largest number of samples of a field that pack() writes.
    static constexpr unsigned int n_values = 1u << dim;

    /// The old nodal_fields() and the multiplier density; absent ones are
    /// empty.
    std::array<DistributedVector, 6> old_fields;
    /// The entry at AdmissibleSpace::axial of each field that is present.
    std::vector<double> old_axial;
    parallel::distributed::SolutionTransfer<dim, DistributedVector>
      field_transfer;

    /// Which fields of for_each_sample_field() are present, and whether sigma_h
    /// is, with viscosity; the old values of these (if none: nothing else
    /// below), the weights of samples, and numbers of owned cells by active
    /// cell index.
    std::vector<bool>               is_carried;
    std::vector<IrreversibleStress> old_samples;
    std::vector<double>             old_weights;
    std::vector<unsigned int>       old_cell;
    unsigned int                    handle;
    /// Samples on each child = prolongation * samples on the parent.
    std::vector<FullMatrix<double>> prolongation;

    /// With viscosity: z and sigma_h of cells that are refined.
    HistoryReconstruction for_children;
    mutable double        of_refined_cells = 0.;

    unsigned int n;
    double       t, k, time_error_unit;
  };


  /// Correct z of a state transferred to a new mesh, in which u, z and sigma,
  /// each transferred by itself, violate E eps(u) + z = sigma: new vertices of
  /// curved cells are not where displacements were interpolated, and u moves
  /// when equilibrium is restored. If the stress took all of the mismatch, a
  /// thousandth of the strain of long creep would be a stress beyond all
  /// others. In each cell z takes its share |z|/(|z| + |sigma|) of the
  /// mismatch's deviator. @p stress: the transferred sigma.
  ///
  /// Return false and leave z unchanged if all shares together are at most @p
  /// enough times the stress and @p error, in energy norms. Collective.
  template <int dim>
  bool
  share_mismatch(const StressSpace<dim>   &stress_space,
                 const IrreversibleStress &stress,
                 const double              enough,
                 const double              error,
                 State<dim>               &state);


  /// Return the contact state on the new mesh of a StateTransfer: multipliers
  /// follow from their density, shortened to the bounds, and active sets from
  /// multipliers and velocities. Collective.
  template <int dim>
  ContactState
  contact_on_new_mesh(const Discretization<dim> &discretization,
                      const State<dim>          &state,
                      const DistributedVector   &multiplier_density);
} // namespace Viscoplastic
