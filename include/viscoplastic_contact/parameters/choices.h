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

  // Entries with a closed list of values. Each has an enumeration and
  // choices(), the names of its values in their order as in parameter files.

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

  /// The discretization of the irreversible stress z: one value a cell, or one
  /// a quadrature point.
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

  /// The order of a scheme in k.
  inline unsigned int
  order_of(const TimeScheme scheme)
  {
    return scheme == TimeScheme::heun ? 2 : 1;
  }

  /// What becomes of explicit steps beyond their stability limit.
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

  /// Whether steps are divided until they resolve events of slip.
  /// `automatic' is replaced when parameters are read.
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

  /// The pressure of unilateral contact with which Coulomb's law bounds
  /// friction.
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



  /// Fields that can be recorded at points, along lines and as integrals:
  /// fields of the body first, those of its boundary from `slip' on.
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

  /// Whether the field is that of contact alone, of friction alone, and of
  /// contact that opens and closes alone.
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



  /// The name of a value of an enumeration in parameter files.
  template <typename Choice>
  std::string
  name_of(const Choice choice)
  {
    return Utilities::split_string_list(choices(choice),
                                        '|')[static_cast<std::size_t>(choice)];
  }



  /// ParameterHandler::add_parameter() for an enumeration.
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



  /// An entry with any number of the values, or of those that are @p allowed,
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
