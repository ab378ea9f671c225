// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/base/subsection.h>
#include <viscoplastic_contact/laws/arrhenius.h>
#include <viscoplastic_contact/scene/material.h>

#include <limits>

namespace Viscoplastic
{
  namespace
  {
    Stiffness
    read_voigt_matrix(const std::string &text,
                      const std::string &entry,
                      const unsigned int dim)
    {
      const std::string  where = "'" + entry + "': ";
      FullMatrix<double> matrix(6, 6);
      const auto         rows = Utilities::split_string_list(text, ';');
      if (rows.size() != 6)
        refuse(where + "there must be 6 rows separated by semicolons, not " +
               std::to_string(rows.size()) + ".");
      for (unsigned int i = 0; i < 6; ++i)
        {
          const auto numbers = Utilities::split_string_list(rows[i], ',');
          if (numbers.size() != 6)
            refuse(where + "row " + std::to_string(i + 1) +
                   " must have 6 numbers separated by commas, not " +
                   std::to_string(numbers.size()) + ".");
          for (unsigned int j = 0; j < 6; ++j)
            {
              const auto number = number_of(numbers[j]);
              if (!number)
                refuse(where + "'" + numbers[j] + "' in row " +
                       std::to_string(i + 1) + " is not a number.");
              matrix(i, j) = *number;
            }
        }

      // Rows and columns 3 and 4 (from 0) belong to the shears yz and xz.
      if (dim == 2)
        for (const unsigned int in_plane : {0, 1, 2, 5})
          for (const unsigned int out_of_plane : {3, 4})
            if (matrix(in_plane, out_of_plane) != 0. ||
                matrix(out_of_plane, in_plane) != 0.)
              refuse(
                where + "the entry in row " + std::to_string(in_plane + 1) +
                ", column " + std::to_string(out_of_plane + 1) +
                " couples deformations in the plane with shear out of it; it "
                "must be zero in plane strain (2D), or the scene be 3D.");

      try
        {
          return Stiffness::anisotropic(matrix);
        }
      catch (const std::exception &exception)
        {
          refuse(where + reason(exception));
        }
    }


    /// Return the time in @p text, or @p otherwise if that is empty.
    double
    read_time(const std::string &text,
              const std::string &entry,
              const double       otherwise)
    {
      if (Utilities::trim(text).empty())
        return otherwise;
      const auto t = number_of(text);
      if (!t || !(*t > 0.) || !std::isfinite(*t))
        refuse("'" + entry + "' = " + text +
               " is not a time after the beginning.");
      return *t;
    }



    /// Return T_L of `Law temperature'; infinity for `infinite'.
    template <int dim>
    double
    law_temperature(const std::string      &section,
                    const std::string      &text,
                    const Temperature<dim> &temperature)
    {
      const std::string entry = section + "/Law temperature";
      if (Utilities::trim(text) == "infinite")
        return std::numeric_limits<double>::infinity();
      if (const auto given = optional_positive_number(text, entry))
        return *given;
      if (!temperature.reference)
        refuse("'" + section +
               "/Activation energy' needs the temperature for which the "
               "entries of the law hold: give '" +
               entry + "', or 'Temperature/Reference temperature'.");
      if (!(*temperature.reference > 0.))
        refuse("'Temperature/Reference temperature' is no absolute "
               "temperature, as '" +
               section + "/Activation energy' needs it.");
      return *temperature.reference;
    }



    /// @p temperature: null in scenes without.
    template <int dim>
    std::unique_ptr<const ViscoplasticLaw>
    make_law(const std::string                 &section,
             const std::string                 &name,
             const MaterialParameters          &parameters,
             ParameterHandler                  &handler,
             const std::vector<LawDescription> &laws,
             const Temperature<dim>            *temperature)
    {
      auto law = [&] {
        const Subsection subsection(handler, section);
        return make_viscoplastic_law(name, handler, section, dim, laws);
      }();
      if (!law)
        return law;
      if (!temperature && law->depends_on_temperature())
        refuse("'" + section + "/" + name +
               "' is a law of the temperature T, but the scene has none: give "
               "'Temperature/Value'.");
      const std::string entry  = section + "/Activation energy";
      const auto        energy = Utilities::trim(parameters.activation_energy);
      if (energy.empty() || energy == "0")
        return law;
      const double Q = *optional_positive_number(energy, entry);
      if (!temperature)
        refuse("'" + entry +
               "' needs a temperature: give 'Temperature/Value'.");
      return thermally_activated(std::move(law),
                                 Q / temperature->gas_constant,
                                 law_temperature(section,
                                                 parameters.law_temperature,
                                                 *temperature));
    }
  } // namespace



  template <int dim>
  Material<dim>::Material(const std::string                 &section,
                          const MaterialParameters          &parameters,
                          ParameterHandler                  &handler,
                          const std::vector<LawDescription> &laws,
                          const bool                         is_absent,
                          const Temperature<dim>            *temperature)
    : section(section)
    , name(parameters.name.empty() ? section : parameters.name)
    , law_name(is_absent ? "elastic" : parameters.law)
    , is_absent(is_absent)
    , added_at(read_time(parameters.added_at,
                         section + "/Added at",
                         -std::numeric_limits<double>::infinity()))
    , removed_at(read_time(parameters.removed_at,
                           section + "/Removed at",
                           std::numeric_limits<double>::infinity()))
    , law(make_law(section, law_name, parameters, handler, laws, temperature))
  {
    const std::string expansion_entry = section + "/Thermal expansion";
    if (!is_absent && !Utilities::trim(parameters.thermal_expansion).empty())
      {
        thermal_expansion.emplace(parameters.thermal_expansion,
                                  expansion_entry);
        if (thermal_expansion->depends_on_time())
          refuse("'" + expansion_entry +
                 "' depends on t; it must be a function of position only.");
        if (!temperature && !thermal_expansion->is_zero())
          refuse("'" + expansion_entry +
                 "' needs a temperature: give 'Temperature/Value'.");
        if (thermal_expansion->is_zero())
          thermal_expansion.reset();
      }
    if (!(added_at < removed_at))
      refuse("'" + section + "/Removed at' = " + parameters.removed_at +
             " is not later than 'Added at' = " + parameters.added_at + ".");
    if (!parameters.voigt_matrix.empty())
      {
        // Moduli given beside a matrix are refused, except for their default
        // values, since complete parameter files contain these.
        const MaterialParameters defaults;
        if (parameters.youngs_modulus != defaults.youngs_modulus ||
            parameters.poissons_ratio != defaults.poissons_ratio)
          refuse("'" + section +
                 "' has a `Voigt matrix' and Young's modulus or Poisson's "
                 "ratio; give either the matrix or these.");
        anisotropic = read_voigt_matrix(parameters.voigt_matrix,
                                        section + "/Voigt matrix",
                                        dim);
        return;
      }

    youngs_modulus.emplace(parameters.youngs_modulus,
                           section + "/Young's modulus");
    poissons_ratio.emplace(parameters.poissons_ratio,
                           section + "/Poisson's ratio");
    for (const auto &[expression, entry] :
         {std::make_pair(&*youngs_modulus, "Young's modulus"),
          std::make_pair(&*poissons_ratio, "Poisson's ratio")})
      if (expression->depends_on_time())
        refuse(
          "'" + section + "/" + entry +
          "' depends on t; elastic moduli must be functions of position only.");
    if (is_uniform())
      stiffness(Point<dim>());
  }



  template <int dim>
  Stiffness
  Material<dim>::stiffness(const Point<dim> &x) const
  {
    const Stiffness result = anisotropic ? *anisotropic : isotropic(x);
    // Young's modulus is 2 mu if Poisson's ratio is zero.
    return is_absent ?
             Stiffness::isotropic(absent_stiffness *
                                    result.smallest_deviatoric_eigenvalue(),
                                  0.) :
             result;
  }



  template <int dim>
  Stiffness
  Material<dim>::isotropic(const Point<dim> &x) const
  {
    const auto is = [&](const Expression<dim> &expression, const double value) {
      return "'" + expression.name_of_entry() + "' is " + as_text(value) +
             (expression.depends_on_position() ?
                " at x = (" + as_text(x) + ")" :
                "") +
             "; it must be ";
    };
    const double E  = youngs_modulus->value(x, 0.);
    const double nu = poissons_ratio->value(x, 0.);
    if (!(E > 0))
      refuse(is(*youngs_modulus, E) + "positive.");
    require_in_range("'" + section + "/Young's modulus'",
                     E,
                     least_modulus,
                     largest_modulus);
    if (!(nu > -1 && nu < 0.5))
      refuse(is(*poissons_ratio, nu) + "larger than -1 and smaller than 0.5.");
    return Stiffness::isotropic(E, nu);
  }



  template class Material<2>;
  template class Material<3>;
} // namespace Viscoplastic
