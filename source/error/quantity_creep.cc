// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/error/quantity_estimator.h>
#include <viscoplastic_contact/laws/backward_euler.h>

// The error of a quantity by creep: products with the dual solution of one step
// as long as the creep time.

namespace Viscoplastic
{
  namespace
  {
    /// Tangents of creep are kept until the present compliance E^-1 + T
    /// dG/dsigma would differ by this, relatively and averaged over the body.
    constexpr double largest_change = 0.1;
    /// The remainder of a law is in doubt at samples of which the step contains
    /// less than this part of what has crept; rates that vary over the body
    /// leave out a little where flow goes on.
    constexpr double least_share_known = 0.9;



    /// Return int |G' - G| and int |G| of the rates G = @p from and G' = @p to.
    /// Collective.
    template <int dim>
    std::array<double, 2>
    change(const StressSpace<dim>   &stress_space,
           const IrreversibleStress &from,
           const IrreversibleStress &to)
    {
      std::array<double, 2> sums{};
      std::size_t           i = 0;
      for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
        for (unsigned int s = 0; s < stress_space.n_samples; ++s, ++i)
          {
            sums[0] += stress_space.weight(c, s) * (to[i] - from[i]).norm();
            sums[1] += stress_space.weight(c, s) * from[i].norm();
          }
      Utilities::MPI::sum(ArrayView<const double>(sums.data(), 2),
                          stress_space.space.communicator,
                          ArrayView<double>(sums.data(), 2));
      return sums;
    }
  } // namespace



  template <int dim>
  typename QuantityEstimator<dim>::Creep
  QuantityEstimator<dim>::creep_of(const State<dim> &state,
                                   const FlowRate   &rate,
                                   const double      time) const
  {
    const StressSpace<dim> &stress_space = discretization.stress_space;
    std::vector<SymmetricTensor<2, 3>> strains(stress_space.n_samples);
    double      largest = 0., sum = 0.; // squared |G|/|s|, int |s|
    std::size_t i = 0;
    for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
      {
        const Stiffness &stiffness = stress_space.moduli(c);
        stress_space.strains(c, state.u.begin(), strains.data());
        for (unsigned int s = 0; s < stress_space.n_samples; ++s, ++i)
          {
            const SymmetricTensor<2, 3> deviatoric =
              deviator(stiffness.stress(strains[s]) + state.z[i]);
            const double square = stiffness.complementary_square(deviatoric);
            sum += stress_space.weight(c, s) * deviatoric.norm();
            if (square > 0.)
              largest =
                std::max(largest,
                         stiffness.complementary_square(rate.rate[i]) / square);
          }
      }
    const MPI_Comm comm = stress_space.space.communicator;
    return {time,
            rate.relaxation_rate /
              std::sqrt(Utilities::MPI::max(largest, comm)),
            Utilities::MPI::sum(sum, comm)};
  }



  template <int dim>
  typename QuantityEstimator<dim>::CreepStep
  QuantityEstimator<dim>::step_of_creep(const EvaluatedState<dim> &end,
                                        const FlowRate            &rate) const
  {
    // The creep time at this rate, which a new mesh changes.
    const StressSpace<dim> &stress_space = discretization.stress_space;
    double                  square       = 0.;
    std::size_t             i            = 0;
    for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
      for (unsigned int s = 0; s < stress_space.n_samples; ++s, ++i)
        square += stress_space.weight(c, s) *
                  stress_space.moduli(c).complementary_square(rate.rate[i]);
    square = Utilities::MPI::sum(square, stress_space.space.communicator);
    // After a thousand relaxation times the body is practically incompressible.
    // k is a power of sqrt(2), so that linear laws need few matrices.
    const double longest = 1e3 / rate.relaxation_rate,
                 time    = std::min(end.errors.creep_path / std::sqrt(square),
                                 std::max(end.state.t, longest));
    return {time,
            std::exp2(0.5 *
                      std::floor(2. * std::log2(std::min(time, longest))))};
  }



  template <int dim>
  bool
  QuantityEstimator<dim>::has_crept_on(const EvaluatedState<dim> &end,
                                       const FlowRate            &rate) const
  {
    return linearized && step_of_creep(end, rate).k != linearized->k;
  }



  template <int dim>
  Vector<double>
  QuantityEstimator<dim>::products_of_creep(const EvaluatedState<dim> &end,
                                            const Creep               &creep,
                                            const CoulombLaw          *law,
                                            Vector<double> &sides) const
  {
    const State<dim>       &state        = end.state;
    const FlowRate         &rate         = *end.rate;
    const StressSpace<dim> &stress_space = discretization.stress_space;
    const CreepStep         step         = step_of_creep(end, rate);
    const double            time = step.time, k = step.k;
    const auto now = discretization.laws.at(state.t, state.history);
    // The remainder contains the difference to tangents at the present state.
    // Where flow has ended, what has crept is not k |G|, and the tangents of
    // the last flow serve on: those of the elastic body do not know it.
    const auto has_changed = [&] {
      const auto [difference, size] =
        change(stress_space, linearized->rate_slope, rate.rate);
      const double duration =
        creep.time > (1. + 1e-6) * time ? creep.time : k; // but for rounding
      return k * difference >
             largest_change * (creep.stress / creep.exponent + duration * size);
    };
    bool is_new = false;
    if (!linearized || k != linearized->k ||
        (!tangent->is_constant && has_changed()))
      {
        linearized.reset(); // until there are tangents
        is_new = tangent->linearize(state.u, state.z, now, k);
        linearized.emplace();
        linearized->t = state.t;
        linearized->k = k;
        if (!tangent->is_constant)
          {
            linearized->u          = state.u;
            linearized->z          = state.z;
            linearized->history    = state.history;
            linearized->rate_slope = rate.rate;
          }
      }
    if (is_new)
      dual_of_creep = {};
    renew(solver_of_tangents(*tangent, is_new),
          tangent->matrix(),
          end,
          law,
          dual_of_creep);
    const DualSolution<dim> &dual = dual_of_creep.solution;
    using Remainder = typename RecoveryEstimator<dim>::Linearization::Remainder;
    typename RecoveryEstimator<dim>::Linearization linearization{k / time, {}};
    const bool is_sum        = discretization.scene().quantity->is_sum(),
               is_rate_known = discretization.laws.source_solution == nullptr;
    if (!tangent->is_constant)
      linearization.remainder = [&](const std::size_t            c,
                                    const unsigned int           s,
                                    const SymmetricTensor<2, 3> &strain,
                                    const SymmetricTensor<2, 3> &e) {
        const ViscoplasticLaw *flow = now.law(c);
        if (flow == nullptr)
          return Remainder();
        const std::size_t           i         = c * stress_space.n_samples + s;
        const Stiffness            &stiffness = stress_space.moduli(c);
        const SymmetricTensor<2, 3> stress =
                                      stiffness.stress(strain) + state.z[i],
                                    of_law = now.mechanical(strain, c, s),
                                    z      = stress - stiffness.stress(of_law),
                                    change = tangent->at_samples()[i] * e,
                                    flow_change = change - stiffness.stress(e);
        const LawPoint              point       = now.point(c, s);
        const SymmetricTensor<2, 3> rate_now =
          is_rate_known && flow->n_history_variables == 0 ?
            rate.rate[i] :
            flow->step_rate(stress, of_law, k, stiffness, point);
        // The part of what has crept that the creep time contains. Strain
        // errors that came with the rest would count as unloading after it.
        // (The work of friction counts present errors for all past slip: too
        // much rather than too little.)
        const double of_step = time * deviator(rate_now).norm(),
                     of_all  = deviator(z).norm(),
                     share =
                       is_sum || of_all <= of_step ? 1. : of_step / of_all;
        if (share == 0.)
          return Remainder();
        // A correction by Newton's method would not do: from where nothing
        // flows it goes far beyond a yield surface.
        try
          {
            return Remainder{share *
                               (z + flow_change -
                                implicit_irreversible_stress(*flow,
                                                             of_law + e,
                                                             z - k * rate_now,
                                                             k,
                                                             stiffness,
                                                             point,
                                                             z + flow_change)),
                             share < least_share_known};
          }
        catch (const ExceptionBase &)
          {
            return Remainder(); // no such stress, as in softening
          }
      };
    Vector<double> products =
      space_estimator.multiply_recovered(state,
                                         dual,
                                         &tangent->at_samples(),
                                         linearization,
                                         dual_of_creep.recovered);
    sides = boundary_defects.missing_sides(state, dual.cartesian);
    // The same force moves the body more in the longer step.
    if (discretization.scene().quantity->is_force())
      {
        products *= linearization.share;
        dual_of_creep.recovered.in_doubt *= linearization.share;
      }
    else if (sides.size() > 0)
      sides /= linearization.share;
    return products;
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(QuantityEstimator, creep_of);
  VISCOPLASTIC_INSTANTIATE_MEMBER(QuantityEstimator, step_of_creep);
  VISCOPLASTIC_INSTANTIATE_MEMBER(QuantityEstimator, has_crept_on);
  VISCOPLASTIC_INSTANTIATE_MEMBER(QuantityEstimator, products_of_creep);
} // namespace Viscoplastic
