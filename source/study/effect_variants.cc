// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/study/effect_variants.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    std::string
    file_name(std::string text)
    {
      for (char &c : text)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0)
          c = '_';
      return text;
    }



    std::string
    exact(const double value)
    {
      std::ostringstream text;
      text << std::setprecision(17) << value;
      return text.str();
    }



    /// Whether an expression is zero for everybody to see.
    bool
    is_zero(const std::string &expression)
    {
      for (const std::string &part :
           Utilities::split_string_list(expression, ';'))
        if (part.find_first_not_of("0. -+") != std::string::npos)
          return false;
      return true;
    }



    /// The expression with every component that it gives replaced by zero.
    std::string
    zeros_for(const std::string &expression)
    {
      std::string result;
      std::size_t begin = 0;
      for (;;)
        {
          const std::size_t end = expression.find(';', begin);
          const std::string part =
            Utilities::trim(expression.substr(begin, end - begin));
          result += part.empty() ? "" : "0";
          if (end == std::string::npos)
            return result;
          result += "; ";
          begin = end + 1;
        }
    }



    /// Collects the variants of one scene.
    class Variants
    {
    public:
      Variants(const Parameters &scene, const double typical_stress)
        : scene(scene)
        , values(scene.values())
        , typical_stress(typical_stress)
      {}

      std::vector<EffectVariant>
      collect()
      {
        add_materials();
        for (const auto &[id, boundary] : scene.boundaries)
          add_boundary("Boundary " + std::to_string(id), boundary);
        if (!is_zero(scene.loads.body_force))
          add("body force", "none", {"Loads/Body force="});
        const InitialStateParameters &initial = scene.initial_state;
        if (!initial.stress.empty() || !initial.displacement.empty())
          add("initial state",
              "none",
              {"Initial state/Stress=", "Initial state/Displacement="});
        is_physical = false;
        add_discretization();
        return result;
      }

    private:
      void
      add(const std::string              &effect,
          const std::string              &instead,
          const std::vector<std::string> &overrides)
      {
        result.push_back({file_name(effect) + "__" + file_name(instead),
                          effect,
                          instead,
                          overrides,
                          is_physical});
      }

      std::string
      value(const std::string &path) const
      {
        return values.at(path);
      }

      void
      add_materials()
      {
        std::vector<std::pair<std::string, const MaterialParameters *>> all;
        for (const auto &[id, material] : scene.materials)
          all.emplace_back("Material " + std::to_string(id), &material);
        if (all.empty())
          all.emplace_back("Material", &scene.material);
        for (const auto &[section, material] : all)
          add_material(section,
                       all.size() > 1 ? " of " + section : "",
                       material->law);

        // All of the first one.
        const std::string        first = all[0].first + '/';
        std::vector<std::string> same;
        for (const auto &[path, text] : values)
          if (path.compare(0, first.size(), first) == 0)
            for (std::size_t m = 1; m < all.size(); ++m)
              if (values.at(all[m].first + '/' + path.substr(first.size())) !=
                  text)
                same.push_back(all[m].first + '/' + path.substr(first.size()) +
                               '=' + text);
        if (!same.empty())
          add("different materials", all[0].first + " everywhere", same);
      }

      void
      add_material(const std::string &section,
                   const std::string &of,
                   const std::string &law)
      {
        if (law == "elastic")
          return;
        const std::string of_law = section + '/' + law + '/';
        if (law == "zener")
          {
            add("relaxation" + of,
                "elastic at once",
                {section + "/Law=elastic"});
            add("relaxation" + of,
                "elastic with the long-term moduli",
                {section + "/Law=elastic",
                 section + "/Young's modulus=" +
                   value(of_law + "Long-term Young's modulus"),
                 section + "/Poisson's ratio=" +
                   value(of_law + "Long-term Poisson's ratio")});
            return;
          }
        add("viscous flow" + of, "elastic", {section + "/Law=elastic"});
        if (law == "perzyna" && !is_zero(value(of_law + "Hardening modulus")))
          add("hardening" + of, "none", {of_law + "Hardening modulus=0"});
        if (law == "norton" && typical_stress > 0.)
          {
            const double exponent = std::stod(value(of_law + "Exponent"));
            const double factor   = std::stod(value(of_law + "Rate factor"));
            if (exponent != 1.)
              add("power of the flow law" + of,
                  "1, with the rate at the mean stress",
                  {of_law + "Exponent=1",
                   of_law + "Rate factor=" +
                     exact(factor * std::pow(typical_stress, exponent - 1.))});
          }
      }

      void
      add_boundary(const std::string &section, const BoundaryParameters &data)
      {
        const std::string on = " on " + section;
        const bool        is_tresca =
                     data.role == "contact" && data.friction_law == "tresca",
                   is_coulomb =
                     data.role == "contact" && data.friction_law == "coulomb";
        if (is_tresca || is_coulomb)
          {
            const std::string entry =
              section +
              (is_tresca ? "/Friction bound=" : "/Friction coefficient=");
            const std::string &bound =
              is_tresca ? data.friction_bound : data.friction_coefficient;
            add("friction" + on, "none", {entry + '0'});
            // Where there is none, there is none.
            add("slip" + on, "never", {entry + "1e6*(" + bound + ')'});
          }
        if (data.role == "contact")
          {
            if (!is_zero(data.foundation_motion))
              add("motion of the foundation" + on,
                  "at rest",
                  {section + "/Foundation motion="});
            if (!is_zero(data.foundation_displacement))
              add("displacement of the foundation" + on,
                  "none",
                  {section + "/Foundation displacement=0"});
          }
        if (data.role == "traction" && !is_zero(data.traction))
          add("traction" + on,
              "none",
              {section + "/Traction=" + zeros_for(data.traction)});
        if (data.role == "displacement" && !is_zero(data.displacement))
          add("displacement" + on,
              "zero",
              {section + "/Displacement=" + zeros_for(data.displacement)});
      }

      void
      add_discretization()
      {
        const std::string mean =
                            name_of(VolumetricIntegration::mean_dilatation),
                          full = name_of(VolumetricIntegration::full);
        const auto &stress     = scene.stress;
        add("volumetric integration",
            stress.volumetric_integration == VolumetricIntegration::full ?
              mean :
              full,
            {"Material/Volumetric integration=" +
             (stress.volumetric_integration == VolumetricIntegration::full ?
                mean :
                full)});
        bool has_flow =
          scene.materials.empty() && scene.material.law != "elastic";
        for (const auto &entry : scene.materials)
          has_flow |= entry.second.law != "elastic";
        if (has_flow)
          {
            const StressHistory other =
              stress.stress_history == StressHistory::cell_means ?
                StressHistory::quadrature_points :
                StressHistory::cell_means;
            add("history at " + name_of(stress.stress_history),
                name_of(other),
                {"Material/Stress history=" + name_of(other)});
            for (const TimeScheme scheme : {TimeScheme::forward_euler,
                                            TimeScheme::backward_euler,
                                            TimeScheme::heun})
              if (scheme != scene.time.scheme)
                add(name_of(scene.time.scheme),
                    name_of(scheme),
                    {"Time/Scheme=" + name_of(scheme)});
          }
        const bool to_tolerance = scene.error_control.has_tolerance();
        if (!to_tolerance &&
            scene.refinement.strategy != RefinementStrategy::none)
          add("adaptive mesh",
              "the first mesh",
              {"Mesh refinement/Strategy=none"});
        else if (!to_tolerance && scene.error_control.error_estimator &&
                 scene.error_control.quantity.empty())
          add("error bar",
              "none, and a fixed tolerance",
              {"Error control/Error bar=false"});
      }

      const Parameters                        &scene;
      const std::map<std::string, std::string> values;
      const double                             typical_stress;
      bool                                     is_physical = true;
      std::vector<EffectVariant>               result;
    };
  } // namespace



  std::vector<EffectVariant>
  effect_variants(const Parameters &scene, const double typical_stress)
  {
    return Variants(scene, typical_stress).collect();
  }



  EffectVariant
  both(const EffectVariant &first, const EffectVariant &second)
  {
    EffectVariant result = first;
    result.name += "__and__" + second.name;
    result.effect += " and " + second.effect;
    result.instead += "; " + second.instead;
    result.overrides.insert(result.overrides.end(),
                            second.overrides.begin(),
                            second.overrides.end());
    return result;
  }
} // namespace Viscoplastic
