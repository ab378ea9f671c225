// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/discretization/thermal_strain.h>


namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    void
    require_absolute(const Material<dim> &material,
                     const double         T,
                     const Point<dim>    &x,
                     const double         t)
    {
      if (T > 0.)
        return;
      refuse("'Temperature/Value' is " + as_text(T) + " at x = (" + as_text(x) +
             "), t = " + as_text(t) + ", but '" + material.section +
             "/Activation energy' asks for absolute temperatures, in kelvin: "
             "add 273.15 to degrees Celsius.");
    }
  } // namespace



  template <int dim>
  ThermalStrain<dim>::ThermalStrain(const StressSpace<dim> &stress_space)
    : expands(stress_space.space.scene.has_thermal_strain())
    , varies_in_time(
        stress_space.space.scene.temperature->value.depends_on_time())
    , is_alone(!stress_space.space.scene.has_other_irreversible_stress())
    , stress_space(stress_space)
  {
    if (!expands)
      return;
    const AdmissibleSpace<dim> &space = stress_space.space;
    fail_together(space.communicator, [&] {
      for (const auto &cell : space.cells)
        expansion.push_back(
          space.scene.material(cell->material_id()).expansion(cell->center()));
    });
    // Without a given T_0, it is the temperature at t = 0 at each sample.
    const auto &given = space.scene.temperature->reference;
    reference =
      given ?
        std::vector<double>(stress_space.n_cells() * stress_space.n_samples,
                            *given) :
        at(0.)->temperature;
    last = {};
  }



  template <int dim>
  std::shared_ptr<const typename ThermalStrain<dim>::Samples>
  ThermalStrain<dim>::at(const double t) const
  {
    for (const auto &samples : last)
      if (samples && (samples->t == t || !varies_in_time))
        return samples;
    const Scene<dim>      &scene  = stress_space.space.scene;
    const Expression<dim> &T      = scene.temperature->value;
    const unsigned int     n      = stress_space.n_samples;
    const std::size_t      size   = stress_space.n_cells() * n;
    auto                   result = std::make_shared<Samples>();
    std::vector<double>   &values = result->temperature;
    result->t                     = t;
    values.reserve(size);
    fail_together(stress_space.space.communicator, [&] {
      if (!T.depends_on_position())
        values.assign(size, T.value(Point<dim>(), t));
      else
        for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
          for (unsigned int s = 0; s < n; ++s)
            values.push_back(T.value(stress_space.position(c, s), t));
      for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
        if (const Material<dim> &material =
              scene.material(stress_space.space.cells[c]->material_id());
            material.needs_absolute_temperature())
          for (unsigned int s = 0; s < n; ++s)
            require_absolute(material,
                             values[c * n + s],
                             stress_space.position(c, s),
                             t);
    });
    if (!reference.empty())
      {
        result->strain.resize(size);
        for (std::size_t c = 0, i = 0; c < expansion.size(); ++c)
          for (unsigned int s = 0; s < n; ++s, ++i)
            result->strain[i] = expansion[c] * (values[i] - reference[i]);
      }
    std::swap(last[0], last[1]);
    last[0] = result;
    return result;
  }



  template <int dim>
  bool
  ThermalStrain<dim>::changes(const double t_old, const double t) const
  {
    if (!varies_in_time || t == t_old)
      return false;
    const bool differs = at(t_old)->temperature != at(t)->temperature;
    return Utilities::MPI::max(differs ? 1 : 0,
                               stress_space.space.communicator) == 1;
  }



  template <int dim>
  void
  ThermalStrain<dim>::add_stress(const double        t,
                                 const double        factor,
                                 IrreversibleStress &z) const
  {
    if (!expands)
      return;
    const auto         now = at(t);
    const unsigned int n   = stress_space.n_samples;
    for (std::size_t i = 0; i < z.size(); ++i)
      z[i] += stress(stress_space.moduli(i / n), factor * now->strain[i]);
  }



  template <int dim>
  void
  ThermalStrain<dim>::follow(const double        t_old,
                             const double        t,
                             IrreversibleStress &z) const
  {
    // Leave z as it is, bit for bit, where nothing changes.
    if (!expands || !varies_in_time || t == t_old)
      return;
    const auto         before = at(t_old), now = at(t);
    const unsigned int n = stress_space.n_samples;
    for (std::size_t c = 0, i = 0; c < expansion.size(); ++c)
      for (unsigned int s = 0; s < n; ++s, ++i)
        if (const double change = now->strain[i] - before->strain[i];
            change != 0.)
          z[i] += stress(stress_space.moduli(c), change);
  }



  template <int dim>
  const IrreversibleStress &
  without_thermal_stress(const ThermalStrain<dim> *thermal,
                         const double              t,
                         const IrreversibleStress &z,
                         IrreversibleStress       &rest)
  {
    if (thermal == nullptr || !thermal->expands)
      return z;
    if (thermal->is_alone)
      return rest; // not z minus z with its rounding
    rest = z;
    thermal->add_stress(t, -1., rest);
    return rest;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(ThermalStrain);
  VISCOPLASTIC_INSTANTIATE(without_thermal_stress);
} // namespace Viscoplastic
