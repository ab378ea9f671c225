// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/largest_place.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/laws/backward_euler.h>


namespace Viscoplastic
{
  namespace
  {
    /// A point in three dimensions; in 2D, z = 0.
    template <int dim>
    Point<3>
    in_space(const Point<dim> &of)
    {
      Point<3> x;
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = of[d];
      return x;
    }



    /// Refuse laws that depend on the total strain if the material is added to
    /// a strained body.
    template <int dim>
    void
    check_added_material(const Material<dim> &material,
                         const Stiffness     &stiffness,
                         const LawPoint      &point)
    {
      if (!std::isfinite(material.added_at))
        return;
      // A strain of one is beyond any yield limit.
      SymmetricTensor<2, 3> strain;
      strain[0][0] = strain[0][1] = 1.;
      if (material.law->tangents(stiffness.stress(strain), {}, stiffness, point)
            .strain.norm() != 0.)
        refuse(
          "'" + material.section + "/Law' = " + material.law_name +
          " depends on the total strain, which a material that is added "
          "('Added at') does not begin with; take a law that depends on the "
          "stress alone (maxwell, norton, perzyna without hardening).");
    }
  } // namespace



  template <int dim>
  FlowLaws<dim>::FlowLaws(const StressSpace<dim> &stress_space)
    : stress_space(stress_space)
    , thermal(stress_space.space.scene.temperature ?
                std::make_unique<const ThermalStrain<dim>>(stress_space) :
                nullptr)
    , any(false)
    , any_cap(false)
    , any_own_energy(false)
    , source_solution(stress_space.space.scene.has_source() ?
                        stress_space.space.scene.exact_solution.get() :
                        nullptr)
  {
    const Scene<dim> &scene         = stress_space.space.scene;
    bool              any_to_sample = false;
    for (const auto &material : scene.materials)
      {
        const ViscoplasticLaw *law = material->law.get();
        const bool of_temperature = law && law->has_parameters_of_temperature();
        materials.push_back(
          {law,
           law && (law->depends_on_position() ||
                   (of_temperature &&
                    scene.temperature->value.depends_on_position())),
           law && (law->depends_on_time() ||
                   (of_temperature && thermal->varies_in_time)),
           law && law->depends_on_temperature() && thermal->varies_in_time});
        any |= law != nullptr;
        any_cap |= law && law->has_cap();
        any_own_energy |= law && law->has_own_energy();
        any_to_sample |=
          materials.back().varies_in_space && !materials.back().varies_in_time;
      }
    if (!any)
      return;

    if (materials.size() > 1)
      {
        std::map<const Material<dim> *, unsigned int> index;
        for (const auto &material : scene.materials)
          index.emplace(material.get(), index.size());
        for (const auto &cell : stress_space.space.cells)
          material_of_cell.push_back(
            index.at(&scene.material(cell->material_id())));
      }

    if (source_solution != nullptr && scene.has_history())
      refuse("'Exact solution' makes no data for laws with history variables, "
             "of which it knows nothing.");
    const AtTime start = at(0.);
    for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
      for (unsigned int s = 0; s < stress_space.n_samples; ++s)
        {
          const ViscoplasticLaw *law = start.law(c);
          if (any_to_sample)
            parameters.push_back(
              law ? law
                      ->point(in_space(stress_space.position(c, s)),
                              0.,
                              start.temperature(c, s))
                      .parameters :
                    LawParameters());
          if (law && (s == 0 || start.varies_in_space(c)))
            law->check(stress_space.moduli(c), start.point(c, s));
          if (law && s == 0)
            check_added_material(scene.material(
                                   stress_space.space.cells[c]->material_id()),
                                 stress_space.moduli(c),
                                 start.point(c, s));
        }
  }



  template <int dim>
  bool
  FlowLaws<dim>::have_constant_tangents() const
  {
    return std::all_of(materials.begin(),
                       materials.end(),
                       [](const Entry &entry) {
                         return !entry.law ||
                                (entry.law->has_constant_tangents() &&
                                 !entry.varies_in_time &&
                                 !entry.follows_temperature);
                       });
  }



  template <int dim>
  bool
  FlowLaws<dim>::are_autonomous() const
  {
    return source_solution == nullptr &&
           std::none_of(materials.begin(),
                        materials.end(),
                        [](const Entry &entry) {
                          return entry.varies_in_time ||
                                 entry.follows_temperature;
                        });
  }



  template <int dim>
  void
  FlowLaws<dim>::check(const double t) const
  {
    if (std::none_of(materials.begin(),
                     materials.end(),
                     [](const Entry &entry) { return entry.varies_in_time; }) &&
        !(thermal && thermal->varies_in_time))
      return;
    const AtTime now = at(t); // evaluates what depends on t alone
    for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
      if (now.law(c) && now.entry(c).varies_in_time &&
          now.entry(c).varies_in_space)
        for (unsigned int s = 0; s < stress_space.n_samples; ++s)
          now.point(c, s);
  }



  template <int dim>
  SymmetricTensor<2, 3>
  FlowLaws<dim>::source(const AtTime                           &now,
                        const std::size_t                       cell,
                        const unsigned int                      s,
                        const typename ExactSolution<dim>::Side side) const
  {
    SymmetricTensor<2, 3> result;
    if (source_solution == nullptr)
      return result;
    const Point<dim> &x         = stress_space.position(cell, s);
    const Stiffness  &stiffness = stress_space.moduli(cell);
    result                      = source_solution->stress_rate(x, now.t, side) -
             stiffness.stress(source_solution->strain_rate(x, now.t, side));
    if (const ViscoplasticLaw *law = now.law(cell))
      result -= law->rate(source_solution->stress(x, now.t),
                          source_solution->strain(x, now.t),
                          stiffness,
                          now.point(cell, s));
    return result;
  }



  template <int dim>
  FlowLaws<dim>::AtTime::AtTime(const FlowLaws           &laws,
                                const double              t,
                                const IrreversibleStress *history)
    : thermal(laws.thermal ? laws.thermal->at(t) : nullptr)
    , laws(laws)
    , t(t)
    , history(history)
  {
    // Uniform parameters may take T at any sample.
    const double T =
      thermal && !thermal->temperature.empty() ? thermal->temperature[0] : 0.;
    for (const Entry &entry : laws.materials)
      uniform.push_back(entry.law && !entry.varies_in_space ?
                          entry.law->point(Point<3>(), t, T) :
                          LawPoint{{}, t});
  }



  template <int dim>
  bool
  FlowLaws<dim>::AtTime::varies_in_space(const std::size_t cell) const
  {
    return entry(cell).varies_in_space ||
           (laws.thermal &&
            laws.stress_space.space.scene.temperature->value
              .depends_on_position() &&
            entry(cell).law && entry(cell).law->depends_on_temperature());
  }



  template <int dim>
  void
  FlowLaws<dim>::AtTime::set_points(const std::size_t  cell,
                                    const unsigned int first,
                                    const unsigned int n,
                                    LawPoint          *points) const
  {
    const StressSpace<dim> &space  = laws.stress_space;
    const Entry            &of     = entry(cell);
    const Point<dim>        origin = space.origin(cell);
    std::fill_n(points, n, uniform[material(cell)]);
    for (unsigned int s = first; s < first + n; ++s)
      points[s - first].x =
        in_space(Point<dim>(origin + space.offset(cell, s)));
    if (!of.varies_in_space && !thermal && history == nullptr)
      return;
    for (unsigned int s = first; s < first + n; ++s)
      {
        LawPoint         &point = points[s - first];
        const std::size_t i     = cell * space.n_samples + s;
        point.temperature       = temperature(cell, s);
        if (of.varies_in_space && of.varies_in_time)
          point = of.law->point(point.x, t, point.temperature);
        else if (of.varies_in_space)
          point.parameters = laws.parameters[i];
        if (history != nullptr)
          point.history = &(*history)[i];
      }
  }



  namespace
  {
    void
    refuse_rate(const double r, const Point<3> &x, const double t)
    {
      refuse("The relaxation rate is " + as_text(r) + " at x = (" + as_text(x) +
             "), t = " + as_text(t) +
             "; relaxation_rate() of a law must be zero or positive, since it "
             "limits the time step.");
    }



    void
    refuse_history(const Point<3> &x, const double t)
    {
      refuse(
        "The rate of a history variable at x = (" + as_text(x) +
        "), t = " + as_text(t) +
        " is not finite; look for what history_rate() of the law divides by.");
    }
  } // namespace



  template <int dim>
  FlowRate
  evaluate_flow(const FlowLaws<dim>                    &laws,
                const State<dim>                       &state,
                const double                            t,
                const typename ExactSolution<dim>::Side side)
  {
    const StressSpace<dim>   &stress_space = laws.stress_space;
    const unsigned int        n            = stress_space.n_samples;
    const MPI_Comm            comm         = stress_space.space.communicator;
    const IrreversibleStress &z            = state.z;
    const auto                now          = laws.at(t, state.history);
    FlowRate                  result{{}, 0., 0.};
    result.rate.reserve(z.size());
    result.history_rate.resize(state.history.size());
    // Predictions, evaluated on the side before t, do not need it.
    const auto &quantity = stress_space.space.scene.quantity;
    if (quantity && !quantity->is_sum() && laws.source_solution == nullptr &&
        side == ExactSolution<dim>::Side::after)
      result.relaxation.resize(z.size());
    std::array<SymmetricTensor<2, 3>, GeometryInfo<dim>::vertices_per_cell>
                                                               strain, stress;
    std::array<LawPoint, GeometryInfo<dim>::vertices_per_cell> points;
    std::array<Flow, GeometryInfo<dim>::vertices_per_cell>     flow;
    LargestPlace<3>                                            worst;
    // An expression may have no value at a point of some rank.
    fail_together(comm, [&] {
      for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
        {
          const ViscoplasticLaw *law = now.law(c);
          if (law == nullptr)
            {
              for (unsigned int s = 0; s < n; ++s)
                result.rate.push_back(laws.source(now, c, s, side));
              continue;
            }
          const Stiffness &stiffness = stress_space.moduli(c);
          stress_space.strains(c, state.u.begin(), strain.data());
          for (unsigned int s = 0; s < n; ++s)
            {
              stress[s] = stiffness.stress(strain[s]) + z[c * n + s];
              if (laws.thermal)
                strain[s] = now.mechanical(strain[s], c, s);
            }
          now.set_points(c, 0, n, points.data());
          law->flow({n, stress.data(), strain.data(), points.data(), stiffness},
                    flow.data());
          for (unsigned int s = 0; s < n; ++s)
            {
              result.rate.push_back(flow[s].rate);
              if (laws.source_solution)
                result.rate.back() += laws.source(now, c, s, side);
              const double r = flow[s].relaxation_rate;
              // A NaN would compare as no limit at all.
              if (!(r >= 0.))
                refuse_rate(r, points[s].x, t);
              if (worst.may_take(r))
                worst.add(r, points[s].x);
              if (flow[s].is_beyond_cap)
                result.capped_volume += stress_space.weight(c, s);
              if (result.relaxation.empty())
                continue;
              const double size            = deviator(stress[s]).norm();
              result.relaxation[c * n + s] = {
                {size > 0. ? flow[s].rate.norm() / size : r, r}};
            }
          for (unsigned int s = 0; law->n_history_variables > 0 && s < n; ++s)
            {
              SymmetricTensor<2, 3> &H = result.history_rate[c * n + s];
              H = law->history_rate(stress[s], strain[s], stiffness, points[s]);
              if (!std::isfinite(H.norm()))
                refuse_history(points[s].x, t);
            }
        }
    });
    worst.reduce(comm);
    result.relaxation_rate   = worst.value();
    result.critical_position = worst.position();
    if (laws.any_cap)
      result.capped_volume = Utilities::MPI::sum(result.capped_volume, comm);
    return result;
  }



  namespace
  {
    /// A Newton step for a law with constant tangents, which is exact; caches
    /// the inverse, which most samples share.
    class LinearEquation
    {
    public:
      SymmetricTensor<2, 3>
      solve(const BackwardEulerEquation &equation,
            const SymmetricTensor<2, 3> &start)
      {
        if (law != &equation.law || stiffness != &equation.stiffness ||
            k != equation.k || parameters != equation.point.parameters ||
            temperature != equation.point.temperature)
          {
            law         = &equation.law;
            stiffness   = &equation.stiffness;
            k           = equation.k;
            parameters  = equation.point.parameters;
            temperature = equation.point.temperature;
            inverse     = invert(
              identity_tensor<3>() -
              k * law->step_tangents({}, {}, k, *stiffness, equation.point)
                    .stress);
          }
        return start - inverse * equation.residual(start);
      }

    private:
      const ViscoplasticLaw *law       = nullptr;
      const Stiffness       *stiffness = nullptr;
      double                 k         = 0.;
      LawParameters          parameters{};
      double                 temperature = 0.;
      SymmetricTensor<4, 3>  inverse;
    };
  } // namespace



  template <int dim>
  IrreversibleStress
  implicit_irreversible_stress(const typename FlowLaws<dim>::AtTime &laws,
                               const StressSpace<dim>   &stress_space,
                               const DistributedVector  &ghosted_u,
                               const IrreversibleStress &old_z,
                               const double              k,
                               const IrreversibleStress &start)
  {
    IrreversibleStress                 z(old_z);
    std::vector<SymmetricTensor<2, 3>> strain(stress_space.n_samples);
    LinearEquation                     linear_equation;
    const auto                         solve_cell = [&](const std::size_t c) {
      const ViscoplasticLaw &law = *laws.law(c);
      const Stiffness       &stiffness = stress_space.moduli(c);
      stress_space.strains(c, ghosted_u.begin(), strain.data());
      // Inverting for a single sample costs more than radial return.
      const bool keeps_inverse =
        law.has_constant_tangents() &&
        !(laws.varies_in_space(c) && stiffness.is_isotropic() &&
          law.radial_flow(0., laws.point(c, 0)));
      for (unsigned int s = 0; s < stress_space.n_samples; ++s)
        {
          const std::size_t i = c * stress_space.n_samples + s;
          const LawPoint    point = laws.point(c, s);
          // The stress is that of the mechanical strain and the part of z that
          // is not thermal.
          const SymmetricTensor<2, 3> strain_of_law =
            laws.mechanical(strain[s], c, s);
          const double                excess = laws.thermal_strain(c, s);
          const SymmetricTensor<2, 3> thermal =
            excess != 0. ? ThermalStrain<dim>::stress(stiffness, excess) :
                                                   SymmetricTensor<2, 3>();
          const SymmetricTensor<2, 3> old = old_z[i] - thermal,
                                      from = start[i] - thermal;
          z[i]                             = thermal +
                 (keeps_inverse ?
                                            linear_equation.solve(
                      {law, strain_of_law, old, k, stiffness, point}, from) :
                                            implicit_irreversible_stress(
                      law, strain_of_law, old, k, stiffness, point, from));
        }
    };

    // A sample without a solution fails the step.
    fail_together(stress_space.space.communicator, [&] {
      for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
        if (laws.law(c) != nullptr)
          solve_cell(c);
    });
    return z;
  }



  template <int dim>
  void
  advance_history(const typename FlowLaws<dim>::AtTime &laws,
                  const StressSpace<dim>               &stress_space,
                  const double                          k,
                  State<dim>                           &state)
  {
    if (!stress_space.space.scene.has_history())
      return;
    const unsigned int                 n = stress_space.n_samples;
    std::vector<SymmetricTensor<2, 3>> strain(n);
    fail_together(stress_space.space.communicator, [&] {
      for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
        if (const ViscoplasticLaw *law = laws.law(c);
            law && law->n_history_variables > 0)
          {
            const Stiffness &stiffness = stress_space.moduli(c);
            stress_space.strains(c, state.u.begin(), strain.data());
            for (unsigned int s = 0; s < n; ++s)
              state.history[c * n + s] =
                law->history_after_step(stiffness.stress(strain[s]) +
                                          state.z[c * n + s],
                                        laws.mechanical(strain[s], c, s),
                                        k,
                                        stiffness,
                                        laws.point(c, s));
          }
    });
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(FlowLaws);
  VISCOPLASTIC_INSTANTIATE(evaluate_flow);
  VISCOPLASTIC_INSTANTIATE(advance_history);
  VISCOPLASTIC_INSTANTIATE(implicit_irreversible_stress);
} // namespace Viscoplastic
