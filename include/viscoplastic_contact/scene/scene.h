// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/parameters/parameter_file.h>
#include <viscoplastic_contact/parameters/time_schedule.h>
#include <viscoplastic_contact/scene/boundary_condition.h>
#include <viscoplastic_contact/scene/exact_solution.h>
#include <viscoplastic_contact/scene/material.h>
#include <viscoplastic_contact/scene/output_places.h>
#include <viscoplastic_contact/scene/place_names.h>
#include <viscoplastic_contact/scene/quantity_of_interest.h>
#include <viscoplastic_contact/scene/support.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The mathematical problem, independent of the discretization: the body, its
  /// materials, boundary conditions, loads and time interval, with data as
  /// functions of x and t. Members that a scene does not need are empty.
  template <int dim>
  class Scene
  {
  public:
    /// Throws ExcMessage with a sentence for the user.
    explicit Scene(const Parameters &parameters);

    /// Check the scene against the mesh: boundary ids have roles and roles have
    /// boundaries, symmetry and contact boundaries are flat (sets their
    /// normals), each material id has a material. Constructs the materials of
    /// the mesh. Throws ExcMessage. Collective.
    void
    inspect(const parallel::distributed::Triangulation<dim> &triangulation);

    /// Return the effects in this scene, as words for the user.
    std::vector<std::string>
    effects() const;

    /// Return the entries, in words for the user, that are not given, affect
    /// this scene, and had another default in earlier versions.
    std::vector<std::string>
    changed_defaults() const;

    /// The material of cells in the present stage. Known after inspect().
    const Material<dim> &
    material(const types::material_id id) const
    {
      return *material_of_id.at(id);
    }

    /// Whether cells of this material are part of the body in the present
    /// stage. Known after inspect().
    bool
    is_present(const types::material_id id) const
    {
      return !material(id).is_absent;
    }

    /// The material of cells with this id in the stages in which it is present.
    const Material<dim> &
    lasting_material(const types::material_id id) const
    {
      return *entries.at(id).material;
    }

    /// Whether materials are added or removed, even after the end of the run.
    bool
    has_stages() const
    {
      return has_changing_materials;
    }

    /// Whether faces of a contact boundary or of its primary side are added or
    /// removed with the materials of a stage.
    bool
    contact_changes_with_stages() const
    {
      return has_changing_contact;
    }

    /// The present stage of construction, counted from 0.
    unsigned int
    stage() const
    {
      return present_stage;
    }

    /// Whether another stage begins after a step that ends at time t.
    bool
    stage_is_over(const double t) const
    {
      return present_stage < stage_ends.size() &&
             t >= stage_ends[present_stage];
    }

    /// The stage of a step that ends at time t.
    unsigned int
    stage_of_step_to(const double t) const
    {
      return std::lower_bound(stage_ends.begin(), stage_ends.end(), t) -
             stage_ends.begin();
    }

    /// The names of the materials that are absent in the present stage.
    std::vector<std::string>
    absent_materials() const
    {
      std::vector<std::string> result;
      for (const auto &[id, material] : material_of_id)
        if (material->is_absent)
          result.push_back(material->name);
      return result;
    }

    /// Make the materials of stage @p n present and the others absent.
    void
    enter_stage(const unsigned int n)
    {
      present_stage = n;
      for (const auto &[id, entry] : entries)
        material_of_id[id] =
          entry.begin <= n && n < entry.end ? entry.material : entry.absent;
    }

    /// Whether errors are measured against a known solution.
    bool
    measures_errors() const
    {
      return exact_solution ||
             !parameters.exact_solution.reference_directory.empty();
    }

    /// Whether boundaries of bodies are in contact with each other; such bodies
    /// need not share any face.
    bool
    has_contact_pairs() const
    {
      return on_any_boundary(
        [](const auto &b) { return b.against.has_value(); });
    }

    /// Whether this boundary is the primary side of contact of another one.
    bool
    is_other_side(const types::boundary_id id) const
    {
      return on_any_boundary([id](const auto &b) { return b.against == id; });
    }

    /// Whether z has a rate G, of a law or of a manufactured solution.
    bool
    has_viscosity() const
    {
      return has_source() ||
             on_any_material([](const auto &m) { return m.law != nullptr; });
    }

    /// Whether a law has history variables.
    bool
    has_history() const
    {
      return on_any_material(
        [](const auto &m) { return m.law && m.law->n_history_variables > 0; });
    }

    /// Whether all steps are backward Euler steps. Known after inspect(), as
    /// has_viscosity() is.
    bool
    is_implicit() const
    {
      return has_viscosity() &&
             parameters.time.scheme == TimeScheme::backward_euler;
    }

    /// Whether steps beyond the stability limit are backward Euler steps, and
    /// shorter ones explicit.
    bool
    is_implicit_beyond_the_limit() const
    {
      return has_viscosity() && !is_implicit() &&
             parameters.time.stiffness_policy ==
               StiffnessPolicy::backward_euler;
    }

    /// Whether a source in G makes the exact solution solve the scene.
    bool
    has_source() const
    {
      return exact_solution && exact_solution->makes_data &&
             exact_solution->has_own_stress();
    }

    /// Whether z = sigma - E eps(u) may be nonzero: by viscosity, initial data,
    /// thermal strain or stages of construction.
    bool
    has_irreversible_stress() const
    {
      return has_other_irreversible_stress() || has_thermal_strain();
    }

    /// The same without thermal strain.
    bool
    has_other_irreversible_stress() const
    {
      return has_viscosity() || initial_displacement || initial_stress ||
             has_stages();
    }

    /// Whether some material expands with temperature.
    bool
    has_thermal_strain() const
    {
      return on_any_material(
        [](const auto &m) { return m.thermal_expansion.has_value(); });
    }

    /// Whether the thermal strain at t = 0 may be nonzero.
    bool
    has_initial_thermal_stress() const
    {
      return has_thermal_strain() && temperature->reference;
    }

    PlaneModel
    plane_model() const
    {
      return parameters.geometry.plane_model;
    }

    /// Whether the mesh is the section of a body of revolution about x = 0.
    bool
    is_axisymmetric() const
    {
      return dim == 2 && plane_model() == PlaneModel::axisymmetric;
    }

    /// Whether the strain zz of a plane section is a datum or an unknown.
    bool
    is_generalized() const
    {
      return dim == 2 && plane_model() == PlaneModel::generalized_strain;
    }

    bool
    has_springs() const
    {
      return on_any_boundary([](const auto &b) { return b.has_springs(); });
    }

    /// The condition on the boundary or support with this @p id.
    const BoundaryCondition<dim> &
    condition(const types::boundary_id id) const
    {
      for (const Support<dim> &support : supports)
        if (support.condition.id == id)
          return support.condition;
      return boundary.at(id);
    }

    bool
    has_friction() const
    {
      return on_any_boundary([](const auto &b) { return b.has_friction(); });
    }

    bool
    has_unilateral_contact() const
    {
      return on_any_boundary([](const auto &b) { return b.is_unilateral(); });
    }

    /// Whether nodes are contact points, with friction or unilateral contact.
    bool
    has_contact_points() const
    {
      return has_friction() || has_unilateral_contact();
    }

    /// Whether the error of time steps is estimated: that of z, of the slip
    /// direction in 3D, or of friction bounds from the previous step.
    bool
    has_time_error() const
    {
      return has_viscosity() || (dim == 3 && has_friction()) ||
             has_bounds_of_step_before();
    }

    /// Whether some friction bound uses the pressure or the slip rate of the
    /// previous step.
    bool
    has_bounds_of_step_before() const
    {
      const bool is_lagged =
        parameters.solver.coulomb_pressure == CoulombPressure::lagged;
      return on_any_boundary([is_lagged](const auto &b) {
        return b.has_friction() && (b.slip_rate_factor.has_value() ||
                                    (is_lagged && b.has_computed_pressure()));
      });
    }

    /// Whether z is stored at quadrature points instead of as cell means.
    bool
    keeps_history_at_points() const
    {
      return parameters.stress.stress_history ==
             StressHistory::quadrature_points;
    }

    bool
    has_contact() const
    {
      return !contact_boundaries().empty();
    }

    /// The boundary ids with the role contact.
    std::set<types::boundary_id>
    contact_boundaries() const
    {
      std::set<types::boundary_id> result;
      for (const auto &[id, condition] : boundary)
        if (condition.role == BoundaryRole::contact)
          result.insert(id);
      return result;
    }

    bool
    has_moving_foundation() const
    {
      return on_any_boundary(
        [](const auto &b) { return b.has_friction() && b.foundation_motion; });
    }

    /// Whether @p holds (condition) is true on some boundary.
    template <typename Predicate>
    bool
    on_any_boundary(const Predicate &holds) const
    {
      return std::any_of(boundary.begin(),
                         boundary.end(),
                         [&holds](const auto &pair) {
                           return holds(pair.second);
                         });
    }

    /// Whether @p holds (material) is true of some material.
    template <typename Predicate>
    bool
    on_any_material(const Predicate &holds) const
    {
      return std::any_of(materials.begin(),
                         materials.end(),
                         [&holds](const auto &one) { return holds(*one); });
    }

    /// Whether any output asks for the work of friction per area.
    bool
    keeps_friction_work() const;

    /// Whether neither loads, the temperature nor friction bounds depend on
    /// time.
    bool
    has_constant_loads_and_bounds() const;

    bool
    is_adaptive() const
    {
      return parameters.refinement.strategy != RefinementStrategy::none;
    }

    /// The unit behind a number, as " MPa"; empty if no units are declared.
    std::string
    unit(const Quantity quantity) const
    {
      return parameters.units.suffix(quantity, dim);
    }

    const Parameters &parameters;
    const PlaceNames  names;
    TimeSchedule      schedule;
    /// The exact solution; null if none is known.
    std::unique_ptr<ExactSolution<dim>>                  exact_solution;
    std::map<types::boundary_id, BoundaryCondition<dim>> boundary;
    std::vector<Support<dim>>                            supports;
    /// The materials that some cell has in some stage.
    std::vector<std::unique_ptr<const Material<dim>>> materials;
    /// Data; absent where identically zero.
    std::optional<VectorExpression<dim>> body_force;
    std::optional<VectorExpression<dim>> initial_displacement, initial_stress;
    /// N(t) or eps_zz(t); exactly one of them in generalized plane strain.
    std::optional<Expression<dim>> axial_force, axial_strain;
    /// The temperature T(x,t); null in scenes without.
    std::unique_ptr<const Temperature<dim>> temperature;
    /// Points, lines and integrals at which fields are recorded.
    std::vector<Point<dim>>      output_points;
    std::vector<OutputLine<dim>> output_lines;
    std::vector<OutputIntegral>  output_integrals;
    /// The quantity of `Error control/Quantity'; absent if there is none.
    std::optional<QuantityOfInterest> quantity;
    /// Warnings about data that are allowed but doubtful, one sentence each.
    std::vector<std::string> warnings;
    /// The times at which materials are added or removed, ascending.
    std::vector<double> stage_ends;

  private:
    void
    make_materials(const std::set<types::material_id> &ids);

    /// Find the stages of construction; refuse those without any material.
    void
    find_stages(const parallel::distributed::Triangulation<dim> &triangulation);

    /// Set whether contact changes with stages; refuse unsupported changes.
    void
    inspect_contact_of_stages(
      const std::set<types::material_id>              &changing,
      const parallel::distributed::Triangulation<dim> &triangulation);

    struct Entry
    {
      const Material<dim> *material;
      /// Stands in where the material is absent; null if it is always present.
      const Material<dim> *absent = nullptr;
      /// The material is present in the stages begin <= n < end.
      unsigned int begin = 0, end = numbers::invalid_unsigned_int;
    };

    std::map<types::material_id, Entry>                 entries;
    std::map<types::material_id, const Material<dim> *> material_of_id;
    unsigned int                                        present_stage = 0;
    bool has_changing_materials = false, has_changing_contact = false;
  };
} // namespace Viscoplastic
