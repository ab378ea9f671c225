// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <set>
#include <string>

namespace Viscoplastic
{
  using namespace dealii;

  // Entries with a fixed list of values. Each has an enumeration and a function
  // choices() with the names of its values in parameter files, in order.

  /// The body that a plane mesh represents: a slice of a long body with zero or
  /// uniform strain along z, or the meridian section of a body of revolution.
  enum class PlaneModel
  {
    strain,
    generalized_strain,
    axisymmetric
  };

  inline const char *
  choices(PlaneModel)
  {
    return "strain|generalized strain|axisymmetric";
  }

  enum class VolumetricIntegration
  {
    automatic,
    full,
    mean_dilatation
  };

  inline const char *
  choices(VolumetricIntegration)
  {
    return "automatic|full|mean dilatation";
  }

  /// The discretization of the irreversible stress z: one value per cell, or
  /// one per quadrature point.
  enum class StressHistory
  {
    cell_means,
    quadrature_points
  };

  inline const char *
  choices(StressHistory)
  {
    return "cell means|quadrature points";
  }

  enum class BoundaryRole
  {
    not_given,
    clamped,
    displacement,
    traction,
    free,
    symmetry,
    contact
  };

  inline const char *
  choices(BoundaryRole)
  {
    return "not given|clamped|displacement|traction|free|symmetry|contact";
  }

  /// The origin of loads and boundary values in a scene with an exact solution.
  enum class DataSource
  {
    scene,
    solution
  };

  inline const char *
  choices(DataSource)
  {
    return "scene|solution";
  }

  /// `automatic' is replaced when parameters are read.
  enum class TimeScheme
  {
    forward_euler,
    backward_euler,
    heun,
    automatic
  };

  inline const char *
  choices(TimeScheme)
  {
    return "forward Euler|backward Euler|Heun|automatic";
  }

  /// Return the order of convergence of a scheme in the time step k.
  inline unsigned int
  order_of(const TimeScheme scheme)
  {
    return scheme == TimeScheme::heun ? 2 : 1;
  }

  /// How explicit steps beyond their stability limit are handled.
  enum class StiffnessPolicy
  {
    refuse,
    subdivide,
    backward_euler
  };

  inline const char *
  choices(StiffnessPolicy)
  {
    return "refuse|subdivide|backward Euler";
  }

  /// Whether steps are divided until they resolve the beginning and end of
  /// slip. `automatic' is replaced when parameters are read.
  enum class EventResolution
  {
    on,
    off,
    automatic
  };

  inline const char *
  choices(EventResolution)
  {
    return "true|false|automatic";
  }

  /// How the contact pressure in the bound of Coulomb's law is obtained in
  /// unilateral contact.
  enum class CoulombPressure
  {
    lagged,
    fixed_point,
    newton
  };

  inline const char *
  choices(CoulombPressure)
  {
    return "lagged|fixed point|Newton";
  }

  enum class LinearSolver
  {
    automatic,
    direct,
    multigrid,
    algebraic_multigrid
  };

  inline const char *
  choices(LinearSolver)
  {
    return "automatic|direct|multigrid|algebraic multigrid";
  }

  /// `automatic' is replaced when parameters are read.
  enum class RefinementStrategy
  {
    none,
    residual,
    kelly,
    automatic
  };

  inline const char *
  choices(RefinementStrategy)
  {
    return "none|residual|kelly|automatic";
  }



  /// Fields that can be recorded at points, along lines and as integrals.
  /// Fields of the body come first, those of its boundary from `slip' on.
  enum class RecordedField
  {
    displacement,
    velocity,
    stress,
    von_mises_stress,
    irreversible_stress,
    total_strain,
    irreversible_strain,
    creep_strain,
    creep_rate,
    history,
    principal_stresses,
    temperature,
    slip,
    slip_rate,
    traction,
    bound,
    utilization,
    stick,
    friction_work,
    contact_pressure,
    gap,
    normal_traction,
    stress_vector
  };

  inline const char *
  choices(RecordedField)
  {
    return "displacement|velocity|stress|von Mises stress|irreversible stress|"
           "total strain|irreversible strain|creep strain|creep "
           "rate|history|principal "
           "stresses|temperature|slip|slip "
           "rate|traction|bound|utilisation|stick|friction "
           "work|contact pressure|gap|normal traction|stress vector";
  }

  inline bool
  is_of_boundary(const RecordedField field)
  {
    return field >= RecordedField::slip;
  }

  /// Return whether the field is defined only in contact, and below: only with
  /// friction, and only in contact that opens and closes.
  inline bool
  is_of_contact(const RecordedField field)
  {
    return is_of_boundary(field) && field <= RecordedField::gap;
  }

  inline bool
  is_of_friction(const RecordedField field)
  {
    return field >= RecordedField::traction &&
           field <= RecordedField::friction_work;
  }

  inline bool
  is_of_unilateral_contact(const RecordedField field)
  {
    return field == RecordedField::contact_pressure ||
           field == RecordedField::gap;
  }



  /// Return the name of a value of an enumeration in parameter files.
  template <typename Choice>
  std::string
  name_of(const Choice choice)
  {
    return Utilities::split_string_list(choices(choice),
                                        '|')[static_cast<std::size_t>(choice)];
  }



  /// Do ParameterHandler::add_parameter() for an enumeration.
  template <typename Choice>
  void
  add_choice(ParameterHandler  &prm,
             const std::string &entry,
             Choice            &choice,
             const std::string &documentation)
  {
    prm.declare_entry(entry,
                      name_of(choice),
                      Patterns::Selection(choices(choice)),
                      documentation);
    prm.add_action(entry, [&choice](const std::string &value) {
      const auto names = Utilities::split_string_list(choices(choice), '|');
      choice           = static_cast<Choice>(
        std::find(names.begin(), names.end(), value) - names.begin());
    });
  }



  /// Add an entry with any number of values, or of those in @p allowed,
  /// separated by commas.
  template <typename Choice>
  void
  add_choices(ParameterHandler  &prm,
              const std::string &entry,
              std::set<Choice>  &chosen,
              const std::string &documentation,
              const std::string &allowed = choices(Choice()))
  {
    prm.declare_entry(entry,
                      "",
                      Patterns::MultipleSelection(allowed),
                      documentation);
    prm.add_action(entry, [&chosen](const std::string &value) {
      chosen.clear();
      const auto names = Utilities::split_string_list(choices(Choice()), '|');
      for (const std::string &name : Utilities::split_string_list(value))
        if (!name.empty())
          chosen.insert(static_cast<Choice>(
            std::find(names.begin(), names.end(), name) - names.begin()));
    });
  }
} // namespace Viscoplastic
