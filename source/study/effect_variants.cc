// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/scene/material.h>
#include <viscoplastic_contact/study/effect_variants.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace Viscoplastic
{
  namespace
  {
    /// The number that a text is; nothing if it is an expression.
    std::optional<double>
    as_number(const std::string &text)
    {
      try
        {
          return Utilities::string_to_double(text);
        }
      catch (const std::exception &)
        {
          return {};
        }
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
          result += part.empty() || part == "free" ? part : "0";
          if (end == std::string::npos)
            return result;
          result += "; ";
          begin = end + 1;
        }
    }



    /// "friction bound" of "Friction bound"; names keep their capitals.
    std::string
    in_a_sentence(std::string entry)
    {
      if (entry.rfind("Young", 0) != 0 && entry.rfind("Poisson", 0) != 0)
        entry[0] =
          static_cast<char>(std::tolower(static_cast<unsigned char>(entry[0])));
      return entry;
    }



    /// muParser refuses expressions of 20000 characters.
    constexpr std::size_t longest_text = 15000;



    /// Collects the variants of one scene.
    class Variants
    {
    public:
      Variants(const Parameters  &scene,
               const SceneData   &means,
               const double       typical_stress,
               const std::string &contact_force)
        : scene(scene)
        , values(scene.values())
        , means(means)
        , typical_stress(typical_stress)
        , contact_force(contact_force)
      {}

      std::vector<EffectVariant>
      collect()
      {
        add_materials();
        for (const auto &[id, boundary] : scene.boundaries)
          add_boundary("Boundary " + std::to_string(id), id, boundary);
        if (!is_zero(scene.loads.body_force))
          {
            is_load = true;
            add("body force", "none", {"Loads/Body force="});
            add_mean_over_space("body force",
                                "Loads/Body force",
                                means.over_body(scene.loads.body_force));
            add_mean_over_time("body force",
                               "Loads/Body force",
                               scene.loads.body_force);
            is_load = false;
          }
        const InitialStateParameters &initial = scene.initial_state;
        if (!initial.stress.empty() || !initial.displacement.empty())
          add("initial state",
              "none",
              {"Initial state/Stress=", "Initial state/Displacement="});
        kind = EffectKind::discretization;
        add_discretization();
        kind = EffectKind::observation;
        add_observation();
        return result;
      }

    private:
      void
      add(const std::string              &effect,
          const std::string              &instead,
          const std::vector<std::string> &overrides,
          const bool                      has_outputs = false)
      {
        result.push_back(
          {effect, instead, overrides, kind, has_outputs, is_load});
      }

      const std::string &
      value(const std::string &path) const
      {
        return values.at(path);
      }

      void
      add_mean_over_space(const std::string                &what,
                          const std::string                &entry,
                          const std::optional<std::string> &mean)
      {
        if (mean && mean->size() < longest_text)
          add(what + " over space", "its mean", {entry + '=' + *mean});
      }

      void
      add_mean_over_time(const std::string &what,
                         const std::string &entry,
                         const std::string &components)
      {
        const auto mean = means.over_time(components);
        if (!mean || mean->size() >= longest_text)
          return;
        std::vector<std::string> overrides{entry + '=' + *mean};
        // What is there from the beginning needs stresses to hold it.
        if (is_load)
          overrides.emplace_back("Initial state/Equilibrate=true");
        add(what + " over time", "its mean", overrides);
      }

      void
      add_materials()
      {
        const unsigned int n = std::max<std::size_t>(1, scene.materials.size());
        std::vector<std::string> sections;
        if (scene.materials.empty())
          {
            sections.emplace_back("Material");
            add_material(sections[0], "", scene.material, {});
          }
        for (const auto &[id, material] : scene.materials)
          {
            sections.push_back("Material " + std::to_string(id));
            add_material(sections.back(),
                         n > 1 ? " of " + sections.back() : "",
                         material,
                         id);
          }

        // All of the first one.
        const std::string        first = sections[0] + '/';
        std::vector<std::string> same;
        for (const auto &[path, text] : values)
          if (path.compare(0, first.size(), first) == 0)
            for (unsigned int m = 1; m < n; ++m)
              {
                const std::string other =
                  sections[m] + '/' + path.substr(first.size());
                if (value(other) != text)
                  same.push_back(other + '=' + text);
              }
        if (!same.empty())
          add("different materials", sections[0] + " everywhere", same);
      }

      void
      add_material(const std::string                &section,
                   const std::string                &of,
                   const MaterialParameters         &material,
                   const std::optional<unsigned int> id)
      {
        add_law(section, of, material.law);
        if (!material.voigt_matrix.empty())
          {
            const Stiffness nearest =
              nearest_isotropic(stiffness(section, material));
            const double mu = nearest.shear_modulus(),
                         nu = nearest.poissons_ratio();
            add("anisotropy" + of,
                "the nearest isotropic stiffness",
                {section + "/Voigt matrix=",
                 section + "/Young's modulus=" + exact(2. * (1. + nu) * mu),
                 section + "/Poisson's ratio=" + exact(nu)});
          }
        else
          for (const std::string modulus :
               {"Young's modulus", "Poisson's ratio"})
            add_mean_over_space(modulus + of,
                                section + '/' + modulus,
                                means.over_body(value(section + '/' + modulus),
                                                id));
        const std::string of_law = section + '/' + material.law + '/';
        for (const auto &[path, text] : values)
          // The strain rate of a parsed law is a function of other things.
          if (path.compare(0, of_law.size(), of_law) == 0 && !text.empty() &&
              path != of_law + "Strain rate")
            {
              const std::string what =
                in_a_sentence(path.substr(of_law.size())) + of;
              try
                {
                  add_mean_over_space(what, path, means.over_body(text, id));
                  add_mean_over_time(what, path, text);
                }
              catch (const ExpressionError &)
                {} // laws of shared libraries may have choices, too
            }
      }

      Stiffness
      stiffness(const std::string        &section,
                const MaterialParameters &material) const
      {
        return scene.dimension == 2 ?
                 Material<2>(section, material, scene.handler)
                   .stiffness(Point<2>()) :
                 Material<3>(section, material, scene.handler)
                   .stiffness(Point<3>());
      }

      void
      add_law(const std::string &section,
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
            const std::string &modulus =
              value(of_law + "Long-term Young's modulus");
            if (!is_zero(modulus))
              add("relaxation" + of,
                  "elastic with the long-term moduli",
                  {section + "/Law=elastic",
                   section + "/Voigt matrix=",
                   section + "/Young's modulus=" + modulus,
                   section + "/Poisson's ratio=" +
                     value(of_law + "Long-term Poisson's ratio")});
            return;
          }
        add("viscous flow" + of, "elastic", {section + "/Law=elastic"});
        if (law == "perzyna" && !is_zero(value(of_law + "Hardening modulus")))
          add("hardening" + of, "none", {of_law + "Hardening modulus=0"});
        if (law == "norton" && typical_stress > 0.)
          {
            const auto exponent = as_number(value(of_law + "Exponent"));
            if (exponent && *exponent != 1.)
              add("power of the flow law" + of,
                  "1, same rate at the mean stress",
                  {of_law + "Exponent=1",
                   of_law + "Rate factor=" +
                     exact(std::pow(typical_stress, *exponent - 1.)) + "*(" +
                     value(of_law + "Rate factor") + ')'});
          }
      }

      void
      add_boundary(const std::string        &section,
                   const unsigned int        id,
                   const BoundaryParameters &data)
      {
        const std::string on         = " on " + section;
        const bool        is_contact = data.role == "contact";
        const bool is_tresca  = is_contact && data.friction_law == "tresca",
                   is_coulomb = is_contact && data.friction_law == "coulomb",
                   gives_way =
                     is_contact && data.contact_law == "normal compliance",
                   is_unilateral =
                     (is_contact && data.contact_law == "unilateral") ||
                     gives_way;
        const auto is_nothing = [this](const std::string &text) {
          return Utilities::trim(text).empty() || is_zero(text);
        };
        // The data that this role reads.
        std::vector<std::pair<std::string, std::string>> loads, others;
        if (is_tresca || is_coulomb)
          {
            const std::string name =
              is_tresca ? "Friction bound" : "Friction coefficient";
            const std::string &bound =
              is_tresca ? data.friction_bound : data.friction_coefficient;
            const std::string entry = section + '/' + name + '=';
            add("friction" + on, "none", {entry + '0'});
            // Where there is none, there is none.
            add("slip" + on, "never", {entry + "1e6*(" + bound + ')'});
            others.emplace_back(name, bound);
            if (Utilities::trim(data.slip_rate_factor) != "1")
              add("dependence of friction on the slip rate" + on,
                  "none",
                  {section + "/Slip rate factor=1"});
          }
        if (is_unilateral)
          {
            if (gives_way)
              add("compliance of the foundation" + on,
                  "rigid",
                  {section + "/Contact law=unilateral"});
            // On curved pieces there is nothing but the foundation's normal.
            else if (!is_coulomb && data.foundation_normal.empty())
              add("opening of contact" + on,
                  "bilateral",
                  {section + "/Contact law=bilateral",
                   section + "/Foundation displacement=(" +
                     (is_nothing(data.gap) ? "0" : data.gap) + ") + (" +
                     (is_nothing(data.foundation_displacement) ?
                        "0" :
                        data.foundation_displacement) +
                     ')'});
            if (is_coulomb)
              {
                const CoulombPressure other =
                  scene.solver.coulomb_pressure == CoulombPressure::lagged ?
                    CoulombPressure::fixed_point :
                    CoulombPressure::lagged;
                add("pressure of Coulomb's law (" +
                      name_of(scene.solver.coulomb_pressure) + ')' + on,
                    name_of(other),
                    {"Solver/Coulomb pressure=" + name_of(other)});
                add_given_pressure(section, on, id, data);
              }
            if (!is_nothing(data.gap))
              others.emplace_back("Gap", data.gap);
          }
        if (is_coulomb && !is_unilateral)
          loads.emplace_back("Normal stress", data.normal_stress);
        else if (is_contact)
          loads.emplace_back("Foundation displacement",
                             data.foundation_displacement);
        if (data.role == "traction")
          loads.emplace_back("Traction", data.traction);
        if (data.role == "displacement")
          loads.emplace_back("Displacement", data.displacement);
        if (data.role == "traction" || data.role == "displacement")
          {
            loads.emplace_back("Pressure", data.pressure);
            for (const auto &[name, text] :
                 {std::make_pair("Normal stiffness", data.normal_stiffness),
                  std::make_pair("Tangential stiffness",
                                 data.tangential_stiffness)})
              if (!is_nothing(text))
                {
                  add(in_a_sentence(name) + " of springs" + on,
                      "none",
                      {section + '/' + name + "=0"});
                  others.emplace_back(name, text);
                }
          }
        const auto add_over_space = [&](const std::string &name,
                                        const std::string &components) {
          if (!is_zero(components))
            add_mean_over_space(in_a_sentence(name) + on,
                                section + '/' + name,
                                means.over_boundary(components, id));
        };
        for (const auto &[name, text] : others)
          {
            add_mean_over_time(in_a_sentence(name) + on,
                               section + '/' + name,
                               text);
            add_over_space(name, text);
          }
        is_load = true;
        if (is_contact && !is_zero(data.foundation_motion))
          {
            add("motion of the foundation" + on,
                "at rest",
                {section + "/Foundation motion="});
            // Its mean over time is no motion.
            add_over_space("Foundation motion", data.foundation_motion);
          }
        for (const auto &[name, components] : loads)
          if (!is_zero(components))
            {
              add(in_a_sentence(name) + on,
                  "none",
                  {section + '/' + name + '=' + zeros_for(components)});
              add_mean_over_time(in_a_sentence(name) + on,
                                 section + '/' + name,
                                 components);
              add_over_space(name, components);
            }
        is_load = false;
      }

      /// The normal force of the run, spread evenly over the face. What the
      /// foundation held along its normal, something else has to hold.
      void
      add_given_pressure(const std::string        &section,
                         const std::string        &on,
                         const unsigned int        id,
                         const BoundaryParameters &data)
      {
        const auto n_unilateral =
          std::count_if(scene.boundaries.begin(),
                        scene.boundaries.end(),
                        [](const auto &entry) {
                          const std::string &law = entry.second.contact_law;
                          return entry.second.role == "contact" &&
                                 (law == "unilateral" ||
                                  law == "normal compliance");
                        });
        if (n_unilateral == 1 && data.foundation_normal.empty() &&
            !contact_force.empty() && contact_force.size() < longest_text)
          add("computed pressure" + on,
              "given, the mean over the face",
              {section + "/Contact law=given normal stress",
               section + "/Normal stress=-(" + contact_force + ")/" +
                 exact(means.area(id)),
               section + "/Gap=",
               section + "/Foundation displacement=0"});
      }

      void
      add_discretization()
      {
        const StressParameters &stress = scene.stress;
        const std::string       other_integration =
          name_of(stress.volumetric_integration == VolumetricIntegration::full ?
                    VolumetricIntegration::mean_dilatation :
                    VolumetricIntegration::full);
        add("volumetric integration (" +
              name_of(stress.volumetric_integration) + ')',
            other_integration,
            {"Material/Volumetric integration=" + other_integration});
        bool has_flow =
          scene.materials.empty() && scene.material.law != "elastic";
        for (const auto &entry : scene.materials)
          has_flow |= entry.second.law != "elastic";
        if (has_flow)
          {
            const std::string other =
              name_of(stress.stress_history == StressHistory::cell_means ?
                        StressHistory::quadrature_points :
                        StressHistory::cell_means);
            add("stress history (" + name_of(stress.stress_history) + ')',
                other,
                {"Material/Stress history=" + other});
            for (const TimeScheme scheme : {TimeScheme::forward_euler,
                                            TimeScheme::backward_euler,
                                            TimeScheme::heun})
              if (scheme != scene.time.scheme)
                add("time scheme (" + name_of(scene.time.scheme) + ')',
                    name_of(scheme),
                    {"Time/Scheme=" + name_of(scheme)});
          }
        if (scene.step_control.is_on())
          add("step control",
              "the steps of the phases",
              {"Step control/Tolerance=0"});
        if (!scene.error_control.has_tolerance() &&
            scene.refinement.strategy != RefinementStrategy::none)
          add("adaptive mesh",
              "the first mesh",
              {"Mesh refinement/Strategy=none"});
      }

      void
      add_observation()
      {
        const bool needs_estimate =
          scene.error_control.has_tolerance() ||
          !scene.error_control.quantity.empty() ||
          scene.refinement.strategy != RefinementStrategy::none ||
          scene.step_control.is_on();
        if (!needs_estimate && scene.error_control.error_estimator)
          add("error bar",
              "none, and a fixed tolerance",
              {"Error control/Error bar=false"});
        if (scene.output.fields_every > 0 ||
            scene.output.fields_interval > 0. ||
            scene.checkpoint.every_n_steps > 0 ||
            scene.checkpoint.wall_time_interval > 0.)
          add("fields and checkpoints", "none", {}, /* has_outputs = */ true);
      }

      const Parameters                        &scene;
      const std::map<std::string, std::string> values;
      const SceneData                         &means;
      const double                             typical_stress;
      const std::string                       &contact_force;
      EffectKind                               kind    = EffectKind::problem;
      bool                                     is_load = false;
      std::vector<EffectVariant>               result;
    };
  } // namespace



  std::string
  EffectVariant::name() const
  {
    std::string result = effect + "__" + instead;
    for (char &c : result)
      if (std::isalnum(static_cast<unsigned char>(c)) == 0)
        c = '_';
    return result;
  }



  bool
  EffectVariant::excludes(const EffectVariant &other) const
  {
    if (effect == other.effect)
      return true;
    for (const std::string &a : overrides)
      for (const std::string &b : other.overrides)
        {
          const std::string entry = a.substr(0, a.find('='));
          if (a != b && entry == b.substr(0, b.find('=')))
            return true;
        }
    // Without a law there are no parameters of it.
    const auto contains = [](const EffectVariant &law,
                             const EffectVariant &part) {
      const std::string suffix = "/Law=elastic";
      for (const std::string &a : law.overrides)
        if (a.size() > suffix.size() &&
            a.compare(a.size() - suffix.size(), suffix.size(), suffix) == 0)
          for (const std::string &b : part.overrides)
            {
              const std::string section = a.substr(0, a.find('/') + 1),
                                entry   = b.substr(0, b.find('='));
              if (entry.compare(0, section.size(), section) == 0 &&
                  entry.find('/', section.size()) != std::string::npos)
                return true;
            }
      return false;
    };
    return contains(*this, other) || contains(other, *this);
  }



  std::vector<EffectVariant>
  effect_variants(const Parameters  &scene,
                  const SceneData   &means,
                  const double       typical_stress,
                  const std::string &contact_force)
  {
    return Variants(scene, means, typical_stress, contact_force).collect();
  }



  Stiffness
  nearest_isotropic(const Stiffness &stiffness)
  {
    // Voigt's averages are the coefficients of the projection.
    const double mu = stiffness.shear_modulus(),
                 nu = stiffness.poissons_ratio();
    return Stiffness::isotropic(2. * (1. + nu) * mu, nu);
  }



  EffectVariant
  both(const EffectVariant &first, const EffectVariant &second)
  {
    EffectVariant result = first;
    result.effect += " and " + second.effect;
    result.instead += "; " + second.instead;
    result.overrides.insert(result.overrides.end(),
                            second.overrides.begin(),
                            second.overrides.end());
    return result;
  }
} // namespace Viscoplastic
