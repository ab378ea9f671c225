// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/contact_face.h>
#include <viscoplastic_contact/discretization/energy.h>
#include <viscoplastic_contact/discretization/loads.h>
#include <viscoplastic_contact/discretization/state.h>

#include <map>

namespace Viscoplastic
{
  /// The forces of a state, in nodal frames.
  template <int dim>
  struct Forces
  {
    /// u of the state, in nodal frames.
    DistributedVector u;
    /// The load L(t, .), and its resultant.
    Load<dim> load;
    /// (z, eps(.)), empty if the scene has no z, and a(u, .) + (z, eps(.)).
    DistributedVector irreversible, internal;
    /// 1/2 a(u, u), (z, eps(u)) and 1/2 int E^-1 z : z.
    double strain_energy = 0., irreversible_work = 0., irreversible_energy = 0.;

    /// a(u, .).
    DistributedVector
    elastic() const
    {
      DistributedVector result(internal);
      if (irreversible.size() > 0)
        result -= irreversible;
      return result;
    }
  };

  /// Evaluate the forces of a state; @p irreversible: irreversible_forces() of
  /// the state, if known. Collective.
  template <int dim>
  Forces<dim>
  evaluate_forces(const StressSpace<dim>  &stress_space,
                  const DistributedMatrix &matrix,
                  Load<dim>                load,
                  const State<dim>        &state,
                  DistributedVector        irreversible = DistributedVector());

  /// The rounding error of a state in the energy norm: by displacements of the
  /// whole body, and by loads and forces of z that cancel.
  struct EnergyRounding
  {
    double size;
    /// Whether the strain energy of the body is below it.
    bool is_all_of_the_strain;
  };

  /// Estimate the rounding error of a state. Collective.
  template <int dim>
  EnergyRounding
  energy_rounding(const AdmissibleSpace<dim> &space,
                  const DistributedMatrix    &matrix,
                  const Forces<dim>          &forces);

  /// Return the forces on the body at prescribed components, summed by boundary
  /// and support id. At nodes with several conditions, the force is split into
  /// parts along their directions, each counted for its id, so that the sum
  /// over the ids is the total. Collective.
  template <int dim>
  std::map<types::boundary_id, Tensor<1, dim>>
  reactions(const AdmissibleSpace<dim> &space, const Forces<dim> &forces);

  /// Return the integral of sigma_zz over the section, the axial force.
  /// Collective.
  template <int dim>
  double
  axial_force(const AdmissibleSpace<dim> &space, const Forces<dim> &forces);

  /// Return the work of prescribed displacements and loads between two states,
  /// with mean forces (trapezoidal rule). Collective.
  template <int dim>
  double
  external_work(const AdmissibleSpace<dim> &space,
                const Forces<dim>          &old_forces,
                const Forces<dim>          &forces);


  /// Defects of the discrete friction law, zero up to rounding, and areas, slip
  /// and work of friction in a step.
  struct FrictionIdentities
  {
    /// max |lambda_c|/rho_c, at most 1.
    double max_utilization = 0.;
    /// max |s_c| where sticking, computed from the displacement.
    double max_stick_slip = 0.;
    /// max |lambda_c - rho_c s_c/|s_c||/rho_c where slipping.
    double slip_misalignment = 0.;
    /// max |s_c| where slipping.
    double max_slip   = 0.;
    double stick_area = 0., slip_area = 0.;
    /// sum_c lambda_c . s_c of the step.
    double dissipation = 0.;
    /// Work of a moving foundation on the body, -sum_c lambda_c . dw_c with the
    /// mean of the multipliers before and after, as in external_work().
    double foundation_work = 0.;
  };

  /// Forces, areas and gaps of unilateral contact and normal compliance.
  template <int dim>
  struct NormalContact
  {
    /// sum_c p_c n_c: the force of the body on the foundation.
    Tensor<1, dim> force;
    /// The area of the points in contact, and of all.
    double contact_area = 0., area = 0.;
    /// The largest pressure p_c/area, gap, and penetration of compliant
    /// foundations.
    double max_pressure = 0., max_gap = 0., max_penetration = 0.;
    /// Work of a foundation that moves along its normal: -sum_c p_c n_c . du_c,
    /// the work on the body with the mean of the multipliers before and after,
    /// plus the energy that the foundation stores in the step.
    double foundation_work = 0.;
  };

  /// Summarize contact; @p change: of u in the step, in frames. Collective.
  template <int dim>
  NormalContact<dim>
  summarize_contact(const ContactFace<dim>  &face,
                    const ContactState      &old_state,
                    const ContactState      &state,
                    const DistributedVector &change);

  /// Check the friction law; @p change: of u in the step, in frames; @p
  /// max_displacement: the scale of rounding. Collective.
  template <int dim>
  FrictionIdentities
  check_friction(const ContactFace<dim>  &face,
                 const ContactState      &old_state,
                 const ContactState      &state,
                 const DistributedVector &change,
                 const double             max_displacement);
} // namespace Viscoplastic
