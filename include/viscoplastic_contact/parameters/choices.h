// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/table.h>

#include <algorithm>
#include <memory>
#include <string>

namespace Viscoplastic
{
  using namespace dealii;

  // Entries with a fixed list of values, each with an enumeration.

  /// The names of the values of an enumeration in parameter files, in order.
  template <typename Choice>
  constexpr const char *choices = nullptr;

  /// The body that a plane mesh represents: a slice of a long body with zero or
  /// uniform strain along z, or the meridian section of a body of revolution.
  enum class PlaneModel
  {
    strain,
    generalized_strain,
    axisymmetric
  };

  template <>
  inline constexpr const char *choices<PlaneModel> =
    "strain|generalized strain|axisymmetric";

  enum class VolumetricIntegration
  {
    automatic,
    full,
    mean_dilatation
  };

  template <>
  inline constexpr const char *choices<VolumetricIntegration> =
    "automatic|full|mean dilatation";

  /// The discretization of the irreversible stress z: one value per cell, or
  /// one per quadrature point.
  enum class StressHistory
  {
    cell_means,
    quadrature_points
  };

  template <>
  inline constexpr const char *choices<StressHistory> =
    "cell means|quadrature points";

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

  template <>
  inline constexpr const char *choices<BoundaryRole> =
    "not given|clamped|displacement|traction|free|symmetry|contact";

  /// The origin of loads and boundary values in a scene with an exact solution.
  enum class DataSource
  {
    scene,
    solution
  };

  template <>
  inline constexpr const char *choices<DataSource> = "scene|solution";

  /// `automatic' is replaced when parameters are read.
  enum class TimeScheme
  {
    forward_euler,
    backward_euler,
    heun,
    automatic
  };

  template <>
  inline constexpr const char *choices<TimeScheme> =
    "forward Euler|backward Euler|Heun|automatic";

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

  template <>
  inline constexpr const char *choices<StiffnessPolicy> =
    "refuse|subdivide|backward Euler";

  /// Whether steps are divided until they resolve the beginning and end of
  /// slip. `automatic' is replaced when parameters are read.
  enum class EventResolution
  {
    on,
    off,
    automatic
  };

  template <>
  inline constexpr const char *choices<EventResolution> =
    "true|false|automatic";

  /// How the contact pressure in the bound of Coulomb's law is obtained in
  /// unilateral contact.
  enum class CoulombPressure
  {
    lagged,
    fixed_point,
    newton
  };

  template <>
  inline constexpr const char *choices<CoulombPressure> =
    "lagged|fixed point|Newton";

  enum class LinearSolver
  {
    automatic,
    direct,
    multigrid,
    algebraic_multigrid
  };

  template <>
  inline constexpr const char *choices<LinearSolver> =
    "automatic|direct|multigrid|algebraic multigrid";

  /// `automatic' is replaced when parameters are read.
  enum class RefinementStrategy
  {
    none,
    residual,
    kelly,
    automatic
  };

  template <>
  inline constexpr const char *choices<RefinementStrategy> =
    "none|residual|kelly|automatic";



  template <>
  inline constexpr const char *choices<DataTable::Interpolation> =
    "linear|constant";

  template <>
  inline constexpr const char *choices<DataTable::Outside> = "refuse|constant";

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

  template <>
  inline constexpr const char *choices<RecordedField> =
    "displacement|velocity|stress|von Mises stress|irreversible stress|"
    "total strain|irreversible strain|creep strain|creep "
    "rate|history|principal "
    "stresses|temperature|slip|slip "
    "rate|traction|bound|utilisation|stick|friction "
    "work|contact pressure|gap|normal traction|stress vector";

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
    return Utilities::split_string_list(choices<Choice>,
                                        '|')[static_cast<std::size_t>(choice)];
  }



  /// Return the value with this name, which has to exist.
  template <typename Choice>
  Choice
  choice_named(const std::string &name)
  {
    const auto names = Utilities::split_string_list(choices<Choice>, '|');
    return static_cast<Choice>(std::find(names.begin(), names.end(), name) -
                               names.begin());
  }
} // namespace Viscoplastic



/// Lets deal.II's ParameterHandler::add_parameter() know enumerations by the
/// names of their values, and sets of them as names separated by commas.
namespace dealii::Patterns::Tools
{
  template <typename Choice>
  struct Convert<Choice,
                 std::enable_if_t<Viscoplastic::choices<Choice> != nullptr>>
  {
    static std::unique_ptr<PatternBase>
    to_pattern()
    {
      return std::make_unique<Selection>(Viscoplastic::choices<Choice>);
    }

    static std::string
    to_string(const Choice &choice, const PatternBase &)
    {
      return Viscoplastic::name_of(choice);
    }

    static Choice
    to_value(const std::string &name, const PatternBase &)
    {
      return Viscoplastic::choice_named<Choice>(name);
    }
  };
} // namespace dealii::Patterns::Tools
