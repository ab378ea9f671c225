// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/laws/viscoplastic_law.h>
#include <viscoplastic_contact/parameters/parameters.h>
#include <viscoplastic_contact/scene/temperature.h>

#include <memory>
#include <optional>
#include <string>

namespace Viscoplastic
{
  /// The material of a part of the body: its elastic tensor E and thermal
  /// expansion as functions of position, and its viscoplastic law G.
  ///
  /// A material may be absent in some stages of construction. Its cells then
  /// stay in the mesh, without loads, flow or stress, and with a stiffness of
  /// absent_stiffness times that of the material: too soft to affect the rest
  /// of the body, whose motion they follow.
  template <int dim>
  class Material
  {
  public:
    /// @p section: the subsection of the parameter file ("Material" or
    /// "Material 2"), which names the material in messages; @p handler is
    /// outside of it. @p temperature: null in scenes without. Throws ExcMessage
    /// for data that are wrong regardless of the position.
    Material(const std::string                 &section,
             const MaterialParameters          &parameters,
             ParameterHandler                  &handler,
             const std::vector<LawDescription> &laws        = built_in_laws(),
             const bool                         is_absent   = false,
             const Temperature<dim>            *temperature = nullptr);

    /// Return E at x. Throws ExcMessage naming section, place and error.
    Stiffness
    stiffness(const Point<dim> &x) const;

    bool
    is_anisotropic() const
    {
      return anisotropic.has_value();
    }

    /// Whether stiffness() is the same everywhere.
    bool
    is_uniform() const
    {
      return anisotropic || (!youngs_modulus->depends_on_position() &&
                             !poissons_ratio->depends_on_position());
    }

    /// The coefficient of thermal expansion alpha at x, in 1/temperature; 0 for
    /// a material that does not expand.
    double
    expansion(const Point<dim> &x) const
    {
      return thermal_expansion ? thermal_expansion->value(x, 0.) : 0.;
    }

    /// Whether the law needs absolute temperatures.
    bool
    needs_absolute_temperature() const
    {
      return law && law->needs_absolute_temperature();
    }

    static constexpr double absent_stiffness = 1e-6;

    const std::string section;
    /// The name of the material in messages: `Material/Name', or the section of
    /// its entries.
    const std::string name;
    const std::string law_name;
    /// Whether this replaces a material in the stages in which that is absent.
    const bool is_absent;
    /// The times at which the material is added and removed; -infinity and
    /// infinity if never.
    double added_at, removed_at;
    /// The law of flow; null for an elastic material.
    std::unique_ptr<const ViscoplasticLaw> law;
    /// Thermal expansion alpha; absent where the material does not expand.
    std::optional<Expression<dim>> thermal_expansion;

  private:
    /// The stiffness from Young's modulus and Poisson's ratio at x.
    Stiffness
    isotropic(const Point<dim> &x) const;

    std::optional<Expression<dim>> youngs_modulus, poissons_ratio; // isotropic
    std::optional<Stiffness>       anisotropic;
  };
} // namespace Viscoplastic
