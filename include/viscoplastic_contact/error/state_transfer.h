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
  /// Carries a state over a change of the mesh and to the ranks that own the
  /// new cells:
  ///
  /// - displacements and multiplier density by interpolation;
  /// - z and the other fields at samples by an L2 projection that conserves int
  /// z over every cell that is refined or coarsened. Samples on the children of
  /// a cell are values of the polynomial through the parent's samples: a copy
  /// of cell means, the (bi-, tri-)linear interpolant of quadrature points.
  /// With viscosity, z and sigma_h of children have slopes that fit to the
  /// neighbors (see HistoryReconstruction).
  ///
  /// Equilibrium is restored by the next step, which solves for the total
  /// displacement.
  ///
  /// Construct it when the cells are marked, change the mesh, distribute the
  /// degrees of freedom, then unpack(). Keeps copies of what it carries, but
  /// addresses the DoFHandler of @p old_stress_space until unpack().
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

    /// The triangulation calls back until unpack().
    StateTransfer(const StateTransfer &) = delete;
    StateTransfer &
    operator=(const StateTransfer &) = delete;

    struct Result
    {
      /// Without contact points: their number depends on the new face.
      State<dim> state;
      /// Ghosted; empty without contact points.
      DistributedVector multiplier_density;
      /// sigma_h, carried like z; empty without viscosity.
      IrreversibleStress stress;
      /// What is wrong in z of the cells that have been refined, squared (see
      /// HistoryReconstruction). Which these are only the mesh itself knows: it
      /// keeps neighbors within one level.
      double of_refined_cells = 0.;
    };

    /// The state on the new mesh. To be called once. Collective.
    Result
    unpack(const StressSpace<dim> &new_stress_space);

  private:
    using CellIterator = typename Triangulation<dim>::cell_iterator;
    using CellStatus   = typename Triangulation<dim>::CellStatus;

    std::vector<char>
    pack(const CellIterator &cell, const CellStatus status) const;

    /// Set a field at the samples of the new cells of an old one from what
    /// pack() has made of it; @p new_cell: their numbers by active cell index.
    void
    unpack_samples(const CellIterator              &cell,
                   const CellStatus                 status,
                   const SymmetricTensor<2, 3>     *values,
                   const StressSpace<dim>          &new_stress_space,
                   const std::vector<unsigned int> &new_cell,
                   IrreversibleStress              &z) const;

    parallel::distributed::Triangulation<dim> &triangulation;
    const unsigned int                         n_samples;
    /// Of a field that a cell passes on, at most.
    static constexpr unsigned int n_values = 1u << dim;

    /// The old nodal_fields() and the multiplier density; absent ones are
    /// empty.
    std::array<DistributedVector, 6> old_fields;
    /// The entry at AdmissibleSpace::axial of each of them that is there.
    std::vector<double> old_axial;
    parallel::distributed::SolutionTransfer<dim, DistributedVector>
      field_transfer;

    /// Which of the fields at samples there are, sigma_h among them if there is
    /// viscosity (without any: nothing else below), their old values, the
    /// weights of the samples, and the number of each owned cell by active cell
    /// index.
    static constexpr unsigned int   stress = numbers::invalid_unsigned_int;
    std::vector<unsigned int>       carried;
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
    double       t, k;
  };


  /// Make up for what the mesh has done to strains in a state that has come to
  /// it. E eps(u), z and sigma, each carried by itself, miss E eps(u) + z =
  /// sigma: new vertices of curved cells are not where displacements were
  /// interpolated, and u moves when it is brought into equilibrium. Left to the
  /// stress alone, a thousandth of the strain of long creep would be a stress
  /// beyond all others. In each cell z takes its share |z|/(|z| + |sigma|) of
  /// the deviator. @p stress: what has been carried over.
  ///
  /// False, and z stays as it is, where all shares together are at most @p
  /// enough of the stress and of @p error, in energy norms. Collective.
  template <int dim>
  bool
  share_mismatch(const StressSpace<dim>   &stress_space,
                 const IrreversibleStress &stress,
                 const double              enough,
                 const double              error,
                 State<dim>               &state);


  /// The contact state that a StateTransfer has brought to a new mesh: the
  /// multipliers from their density, within the bounds, and the sets by what
  /// multipliers and velocities say. Collective.
  template <int dim>
  ContactState
  contact_on_new_mesh(const Discretization<dim> &discretization,
                      const State<dim>          &state,
                      const DistributedVector   &multiplier_density);
} // namespace Viscoplastic
