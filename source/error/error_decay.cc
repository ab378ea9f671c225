// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/error/error_decay.h>

namespace Viscoplastic
{
  namespace
  {
    /// Return k dG/deps E^-1 of linear laws that depend on the strain. If
    /// strains compensate an error of z, so that it makes no stress, a step
    /// leaves (1 + k dG/deps E^-1)^-1 of it. Return nothing for other laws,
    /// where such an error persists.
    std::optional<SymmetricTensor<4, 3>>
    growth_with_strain(const ViscoplasticLaw &law,
                       const double           k,
                       const Stiffness       &stiffness,
                       const LawPoint        &point)
    {
      if (!law.has_constant_tangents() || law.radial_flow(0., point))
        return {};
      return k * law.tangents({}, {}, stiffness, point).strain *
             invert(stiffness.tensor());
    }
  } // namespace



  template <int dim>
  void
  ErrorDecay<dim>::enter(const std::size_t c)
  {
    const ViscoplasticLaw *last_law       = law;
    const Stiffness       *last_stiffness = stiffness;
    law                                   = now.law(c);
    stiffness                             = &stress_space.moduli(c);
    // In most bodies these are the same in all cells.
    if (c > 0 && law == last_law && stiffness == last_stiffness &&
        !(law && now.varies_in_space(c)))
      return;
    growth = law ? growth_with_strain(*law, k, *stiffness, now.point(c, 0)) :
                   std::nullopt;
    if (growth)
      fading = invert(identity_tensor<3>() + *growth);
    is_uniform = law && law->has_constant_tangents() && !now.varies_in_space(c);
    is_radial  = law && !rate.relaxation.empty() && stiffness->is_isotropic() &&
                law->radial_flow(0., now.point(c, 0));
    asks_for_stress = law && !is_uniform && !is_radial;
    relaxation      = {};
    is_known        = law == nullptr;
    cell            = c;
  }



  template <int dim>
  const ErrorRelaxation &
  ErrorDecay<dim>::relaxation_at(const std::size_t            i,
                                 const SymmetricTensor<2, 3> &stress,
                                 const SymmetricTensor<2, 3> &strain,
                                 const LawPoint              &point)
  {
    if (is_known)
      return relaxation;
    if (is_uniform)
      relaxation =
        error_relaxation(*law, {}, {}, k, *stiffness, now.point(cell, 0));
    else if (is_radial)
      relaxation.set_radial(k * rate.relaxation[i][0],
                            k * rate.relaxation[i][1],
                            rate.rate[i]);
    else
      relaxation = error_relaxation(*law, stress, strain, k, *stiffness, point);
    is_known = is_uniform;
    return relaxation;
  }



  template <int dim>
  void
  relax_carried_error(const FlowLaws<dim> &laws,
                      const State<dim>    &old,
                      EvaluatedState<dim> &end)
  {
    State<dim>             &state = end.state;
    const StressSpace<dim> &space = laws.stress_space;
    const Scene<dim>       &scene = space.space.scene;
    // The sums are for forces, whose errors persist: the first one for the
    // choice of steps, the others for points that come to rest.
    const bool is_force = scene.quantity->is_force(),
               chooses =
                 is_force && scene.parameters.error_control.has_tolerance(),
               rests = is_force && scene.has_contact_points();
    ErrorDecay<dim>                    decay(laws, old, end);
    std::vector<SymmetricTensor<2, 3>> strains(space.n_samples),
      errors(space.n_samples);
    SymmetricTensor<2, 3> stress, strain;
    LawPoint              point;
    // Squared norms: of the increment, of D, of its kept and regained parts.
    std::vector<double> sums(4, 0.);
    std::size_t         i = 0;
    for (std::size_t c = 0; c < space.n_cells(); ++c)
      {
        decay.enter(c);
        if (decay.law == nullptr)
          {
            i += space.n_samples;
            continue;
          }
        const Stiffness &stiffness = *decay.stiffness;
        space.strains(c, state.carried_error_of_u.begin(), errors.data());
        if (decay.asks_for_stress)
          space.strains(c, state.u.begin(), strains.data());
        for (unsigned int s = 0; s < space.n_samples; ++s, ++i)
          {
            if (decay.asks_for_stress)
              {
                stress = stiffness.stress(strains[s]) + state.z[i];
                strain = decay.now.mechanical(strains[s], c, s);
                point  = decay.now.point(c, s);
              }
            const ErrorRelaxation &relaxation =
              decay.relaxation_at(i, stress, strain, point);
            SymmetricTensor<2, 3>      &error = state.carried_error[i];
            const SymmetricTensor<2, 3> moves = state.time_error_at(i);
            const auto                  add_square = [&](const unsigned int           sum,
                                        const SymmetricTensor<2, 3> &value) {
              sums[sum] +=
                space.weight(c, s) * stiffness.complementary_square(value);
            };
            if (chooses)
              add_square(0, relaxation * (error - old.carried_error[i]));
            if (rests)
              {
                add_square(1, moves);
                add_square(2, relaxation * moves);
                if (decay.growth)
                  add_square(3, relaxation * (*decay.growth * moves));
              }
            // Split the step: the error's stress relaxes at fixed strain, then
            // what strains compensate fades at fixed stress.
            const SymmetricTensor<2, 3> elastic = stiffness.stress(errors[s]),
                                        left = relaxation * (error + elastic);
            error                            = left - elastic;
            if (decay.growth)
              error = decay.fading * (error + *decay.growth * left);
          }
      }
    if (!is_force)
      return;
    Utilities::MPI::sum(sums, space.space.communicator, sums);
    ErrorEstimate &estimate = end.errors;
    const auto     share    = [&](const double part) {
      return std::sqrt(part / sums[1]);
    };
    estimate.remembered_indicator = std::sqrt(sums[0]);
    estimate.remembered_share     = sums[1] > 0. ? share(sums[2]) : 1.;
    estimate.remembered_gain      = sums[1] > 0. ? share(sums[3]) : 0.;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(ErrorDecay);
  VISCOPLASTIC_INSTANTIATE(relax_carried_error);
} // namespace Viscoplastic
