// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/state.h>
#include <viscoplastic_contact/discretization/thermal_strain.h>
#include <viscoplastic_contact/laws/viscoplastic_law.h>

#include <array>
#include <vector>

namespace Viscoplastic
{
  /// The flow law G of each owned cell, with the law's parameters at each
  /// sample of the irreversible stress. Parameters of laws that do not depend
  /// on time are evaluated once.
  template <int dim>
  class FlowLaws
  {
  public:
    /// Throws ExcMessage if a parameter is out of range somewhere, or a law is
    /// not compatible with the elastic tensor of a cell.
    explicit FlowLaws(const StressSpace<dim> &stress_space);

    const StressSpace<dim> &stress_space;

    /// The temperature; null in scenes that have none.
    const std::unique_ptr<const ThermalStrain<dim>> thermal;

    /// Whether any material has a law, a cap on the stress, and a stored energy
    /// of its own. Known on all ranks.
    bool any, any_cap, any_own_energy;

    /// Whether the derivatives of G are the same at all times and states.
    bool
    have_constant_tangents() const;

    /// Whether G depends on the state alone, not on t or on a temperature that
    /// does.
    bool
    are_autonomous() const;

    /// The exact solution whose source is added to G; null if there is none.
    const ExactSolution<dim> *const source_solution;

    /// Throws ExcMessage if a parameter is out of range somewhere at time t.
    void
    check(const double t) const;

    /// Evaluates time-dependent parameters at one time.
    class AtTime
    {
    public:
      /// The law of a cell; null where it is elastic.
      const ViscoplasticLaw *
      law(const std::size_t cell) const
      {
        return laws.materials[material(cell)].law;
      }

      /// The point at which law(cell) is evaluated for one of its samples, with
      /// the history variables of at().
      LawPoint
      point(const std::size_t cell, const unsigned int s) const
      {
        LawPoint result;
        set_points(cell, s, 1, &result);
        return result;
      }

      /// Set @p points to point() of @p n samples, beginning with @p first.
      void
      set_points(const std::size_t  cell,
                 const unsigned int first,
                 const unsigned int n,
                 LawPoint          *points) const;

      /// Whether point() differs from sample to sample.
      bool
      varies_in_space(const std::size_t cell) const;

      /// T at a sample, 0 in scenes without temperature.
      double
      temperature(const std::size_t cell, const unsigned int s) const
      {
        return thermal ?
                 thermal->temperature[cell * laws.stress_space.n_samples + s] :
                 0.;
      }

      /// alpha (T - T_0) at a sample.
      double
      thermal_strain(const std::size_t cell, const unsigned int s) const
      {
        return thermal && !thermal->strain.empty() ?
                 thermal->strain[cell * laws.stress_space.n_samples + s] :
                 0.;
      }

      /// The mechanical strain eps - alpha (T - T_0) I, on which laws depend.
      SymmetricTensor<2, 3>
      mechanical(SymmetricTensor<2, 3> strain,
                 const std::size_t     cell,
                 const unsigned int    s) const
      {
        if (const double excess = thermal_strain(cell, s); excess != 0.)
          for (unsigned int i = 0; i < 3; ++i)
            strain[i][i] -= excess;
        return strain;
      }

    private:
      friend class FlowLaws;
      AtTime(const FlowLaws           &laws,
             const double              t,
             const IrreversibleStress *history);

      unsigned int
      material(const std::size_t cell) const
      {
        return laws.material_of_cell.empty() ? 0 : laws.material_of_cell[cell];
      }

      const auto &
      entry(const std::size_t cell) const
      {
        return laws.materials[material(cell)];
      }

      std::shared_ptr<const typename ThermalStrain<dim>::Samples> thermal;

      const FlowLaws           &laws;
      const double              t;
      const IrreversibleStress *history; // null if nobody has any
      std::vector<LawPoint>     uniform; // a material
    };

    /// The laws at time t before the first step: history variables are zero.
    AtTime
    at(const double t) const
    {
      return AtTime(*this, t, nullptr);
    }

    /// The laws at time t with these history variables, which are referenced.
    AtTime
    at(const double t, const IrreversibleStress &history) const
    {
      return AtTime(*this, t, history.empty() ? nullptr : &history);
    }

    /// Return the source of a manufactured solution in G at a sample, sigma' -
    /// E eps(u') - G(t, sigma, eps(u)) of that solution; zero in other scenes.
    /// @p side: the one-sided time derivatives at the time of @p now.
    SymmetricTensor<2, 3>
    source(const AtTime                           &now,
           const std::size_t                       cell,
           const unsigned int                      s,
           const typename ExactSolution<dim>::Side side) const;

  private:
    struct Entry
    {
      const ViscoplasticLaw *law;
      bool                   varies_in_space, varies_in_time;
      /// Whether the rate varies with a temperature that changes.
      bool follows_temperature;
    };

    std::vector<Entry> materials;
    /// Index into materials; empty if there is only one.
    std::vector<unsigned int> material_of_cell;
    /// The parameters at each sample; empty unless some law's depend on
    /// position but not on time.
    std::vector<LawParameters> parameters;
  };


  /// G at a state, and the stability limit that follows.
  struct FlowRate
  {
    /// G at each sample.
    IrreversibleStress rate;
    /// The largest relaxation rate r; forward Euler is stable for k <= 2/r.
    /// Collective result.
    double relaxation_rate;
    /// Volume of the samples with stresses beyond their law's cap. Collective
    /// result.
    double capped_volume;
    /// The position of the largest relaxation rate, the first one if several
    /// are equal. Collective result.
    Point<3> critical_position = {};
    /// The history rate H at each sample; empty without history variables.
    IrreversibleStress history_rate = {};
    /// The relaxation rates of the stress under radial flow, at each sample:
    /// across its deviator s, |G|/|s|, and along. Only for quantities of
    /// interest whose time errors are carried from step to step.
    std::vector<std::array<double, 2>> relaxation = {};
  };

  /// Evaluate G and H at all samples, by one evaluation of the law per cell. @p
  /// side: of a source's time derivatives at t. Collective.
  template <int dim>
  FlowRate
  evaluate_flow(const FlowLaws<dim>                    &laws,
                const State<dim>                       &state,
                const double                            t,
                const typename ExactSolution<dim>::Side side =
                  ExactSolution<dim>::Side::after);



  /// Return z_n by backward Euler at all samples for the strains of @p
  /// ghosted_u, by Newton's method from @p start; elastic cells keep their z.
  /// Throws on all ranks if there is no solution. Collective.
  template <int dim>
  IrreversibleStress
  implicit_irreversible_stress(const typename FlowLaws<dim>::AtTime &laws,
                               const StressSpace<dim>   &stress_space,
                               const DistributedVector  &ghosted_u,
                               const IrreversibleStress &old_z,
                               const double              k,
                               const IrreversibleStress &start);

  /// Advance the history variables of a state by backward Euler, at the stress
  /// of the end of the step. Collective.
  template <int dim>
  void
  advance_history(const typename FlowLaws<dim>::AtTime &laws,
                  const StressSpace<dim>               &stress_space,
                  const double                          k,
                  State<dim>                           &state);
} // namespace Viscoplastic
