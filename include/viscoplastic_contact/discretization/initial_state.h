// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/state.h>
#include <viscoplastic_contact/discretization/stress_space.h>

#include <vector>

namespace Viscoplastic
{
  /// Return the state at t = 0: u0^h, the projection of u0 in (eps(u), eps(v)),
  /// and z_0 = sigma0^h - E eps(u0^h) with the L2 projection sigma0^h of
  /// sigma0; zero fields stay absent. Collective.
  ///
  /// Throws ExcMessage if u0 contradicts the displacements prescribed at t = 0,
  /// unless @p equilibrate is true.
  template <int dim>
  State<dim>
  make_initial_state(const StressSpace<dim> &stress_space,
                     const bool              equilibrate);

  /// Return the displacement to report: that of @p state, or with `Reset
  /// displacement` its difference from u_0, which is written to @p difference.
  /// Cartesian, with ghosts.
  template <int dim>
  const DistributedVector &
  reported_displacement(const Scene<dim>  &scene,
                        const State<dim>  &state,
                        DistributedVector &difference);

  /// sigma0 at x in a cell of material @p id; zero if the material is absent,
  /// or is added after t = 0.
  template <int dim>
  SymmetricTensor<2, 3>
  initial_stress(const Scene<dim>        &scene,
                 const Point<dim>        &x,
                 const types::material_id id);

  /// int sigma0 : eps(v), including the initial thermal stress, as a load in
  /// frames, by quadrature with @p n_points points in each direction.
  template <int dim>
  DistributedVector
  work_of_initial_stress(const AdmissibleSpace<dim> &space,
                         const unsigned int          n_points);

  /// z_0 = sigma0^h - E eps(u0^h) at the samples; @p u0 is Cartesian, with
  /// ghosts, or of size 0 if it is zero.
  template <int dim>
  IrreversibleStress
  initial_irreversible_stress(const StressSpace<dim>  &stress_space,
                              const DistributedVector &u0);

  /// |u0 - u0^h| in the energy norm plus |sigma0 - sigma0^h| in that of
  /// stresses, (int E^-1 s : s)^{1/2}, by quadrature, where sigma0^h is the
  /// polynomial through the samples of a cell; @p state as make_initial_state()
  /// gives it. Zero without initial data. @p squared_by_cell gets the squares
  /// that active cells contribute, zero on cells of other ranks, unless it is
  /// null. Collective.
  template <int dim>
  double
  initial_data_error(const StressSpace<dim> &stress_space,
                     const State<dim>       &state,
                     Vector<double>         *squared_by_cell = nullptr);

  /// Turn the state at the end of a stage of construction into that at the
  /// beginning of the present one: removed cells have no stress, and added ones
  /// have none in the deformed body, z = -E eps(u). @p was_present: by owned
  /// cell, in the stage before.
  template <int dim>
  void
  enter_stage(const StressSpace<dim>  &stress_space,
              const std::vector<bool> &was_present,
              State<dim>              &state);
} // namespace Viscoplastic
