// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/laws/viscoplastic_law.h>
#include <viscoplastic_contact/parameters/parameters.h>

#include <memory>
#include <optional>
#include <string>

namespace Viscoplastic
{
  /**
   * What one part of the body consists of: its elastic tensor E as a function
   * of position, and its law G.
   */
  template <int dim>
  class Material
  {
  public:
    /**
     * @p section is the subsection of the parameter file ("Material" or
     * "Material 2"), in which @p handler stands outside; it names the material
     * in messages. Throws ExcMessage for data that cannot be right anywhere.
     */
    Material(const std::string                 &section,
             const MaterialParameters          &parameters,
             ParameterHandler                  &handler,
             const std::vector<LawDescription> &laws = built_in_laws());

    /// E at x. Throws ExcMessage naming section, place and what is wrong.
    Stiffness
    stiffness(const Point<dim> &x) const;

    bool
    is_anisotropic() const
    {
      return anisotropic.has_value();
    }

    /// Whether stiffness() is the same everywhere.
    bool
    is_uniform() const;

    const std::string section, law_name;
    /// The law of flow; null for an elastic material.
    std::unique_ptr<const ViscoplasticLaw> law;

  private:
    std::optional<Expression<dim>> youngs_modulus, poissons_ratio; // isotropic
    std::optional<Stiffness>       anisotropic;
  };
} // namespace Viscoplastic
