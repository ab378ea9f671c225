// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/laws/strain.h>
#include <viscoplastic_contact/scene/scene.h>

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    std::unique_ptr<ExactSolution<dim>>
    make_exact_solution(const ExactSolutionParameters &given,
                        const double                   end_time,
                        const PlaneModel               plane_model)
    {
      const bool is_given = !Utilities::trim(given.displacement).empty() ||
                            !Utilities::trim(given.stress).empty() ||
                            given.data == DataSource::solution;
      return is_given ? std::make_unique<ExactSolution<dim>>(given,
                                                             end_time,
                                                             plane_model) :
                        nullptr;
    }



    /// Read N or eps_zz, of which at most one is given. Throws ExcMessage.
    template <int dim>
    void
    read_axial_datum(Scene<dim> &scene)
    {
      const auto read = [&](const std::string &text, const std::string &name) {
        const std::string              entry = "Loads/" + name;
        std::optional<Expression<dim>> result;
        if (Utilities::trim(text).empty())
          return result;
        if (!scene.is_generalized())
          refuse("'" + entry +
                 "' is that of 'Geometry/Plane model' = generalized strain.");
        result.emplace(text, entry);
        if (result->depends_on_position())
          refuse("'" + entry + "' = " + text +
                 " depends on the place, but it is one for the whole section.");
        return result;
      };
      scene.axial_force =
        read(scene.parameters.loads.axial_force, "Axial force");
      scene.axial_strain =
        read(scene.parameters.loads.axial_strain, "Axial strain");
      if (scene.axial_force && scene.axial_strain)
        refuse("'Loads/Axial force' and 'Loads/Axial strain' follow from each "
               "other; leave one of them out.");
      if (scene.is_generalized() && !scene.axial_strain && !scene.axial_force)
        scene.axial_force.emplace("0", "Loads/Axial force");
    }



    /// Set the primary sides of contact between bodies. Throws ExcMessage.
    template <int dim>
    void
    find_contact_pairs(Scene<dim> &scene)
    {
      for (auto &[id, condition] : scene.boundary)
        {
          const std::string name = Utilities::trim(
            scene.parameters.boundaries.at(id).entries.at("Against"));
          if (name.empty() || condition.role != BoundaryRole::contact ||
              condition.has_given_stress())
            continue;
          const std::string entry =
            "'Boundary " + std::to_string(id) + "/Against' = " + excerpt(name);
          const bool is_number =
            name.find_first_not_of("0123456789") == std::string::npos;
          const auto place = scene.names.find(
            is_number && name.size() < 9 ? "boundary " + name : name);
          if (!place || place->kind != "boundary" ||
              scene.boundary.count(place->number) != 1)
            refuse(entry + " is no boundary of the scene.");
          const auto &other = scene.boundary.at(place->number);
          if (other.role != BoundaryRole::free &&
              other.role != BoundaryRole::traction)
            refuse(
              entry +
              " must have the role free (or traction): what happens between "
              "the two sides is said once, at boundary " +
              std::to_string(id) + ".");
          if (condition.foundation_motion)
            refuse(
              "'Boundary " + std::to_string(id) +
              "/Foundation motion' moves a rigid foundation, but 'Against' "
              "says that another body is there.");
          if (scene.exact_solution && scene.exact_solution->makes_data)
            refuse(entry +
                   ": 'Exact solution/Data' = solution makes no data for "
                   "two bodies; use 'Data' = scene.");
          condition.against = place->number;
        }
    }



    /// Set the data of the exact solution; refuse other data beside them.
    template <int dim>
    void
    derive_data(Scene<dim> &scene)
    {
      for (const auto &[name, text] :
           {std::make_pair("Loads/Body force",
                           scene.parameters.loads.body_force),
            std::make_pair("Loads/Axial force",
                           scene.parameters.loads.axial_force),
            std::make_pair("Loads/Axial strain",
                           scene.parameters.loads.axial_strain),
            std::make_pair("Initial state/Displacement",
                           scene.parameters.initial_state.displacement),
            std::make_pair("Initial state/Stress",
                           scene.parameters.initial_state.stress)})
        if (!Utilities::trim(text).empty())
          refuse("'" + std::string(name) +
                 "' is given, but 'Exact solution/Data' = solution makes it; "
                 "leave one of them out.");
      if (scene.parameters.initial_state.equilibrate)
        refuse(
          "'Initial state/Equilibrate' contradicts 'Exact solution/Data' = "
          "solution, whose initial data are those of the solution.");

      const ExactSolution<dim> &solution = *scene.exact_solution;
      const std::string         stress   = "Exact solution/Stress",
                        displacement     = "Exact solution/Displacement";
      std::vector<typename Expression<dim>::Function> stresses;
      for (const auto &[i, j] : stress_components<dim>())
        stresses.push_back(
          [&solution, i = i, j = j](const Point<dim> &x, const double t) {
            return solution.stress(x, t)[i][j];
          });
      scene.body_force.emplace(
        [&solution](const Point<dim> &x, const double t) {
          return solution.body_force(x, t);
        },
        stress);
      if (scene.is_generalized())
        {
          scene.axial_force.reset();
          scene.axial_strain.emplace(
            [&solution](const Point<dim> &, const double t) {
              return solution.axial_strain(t);
            },
            displacement);
        }
      scene.initial_displacement.emplace(
        [&solution](const Point<dim> &x, const double t) {
          return solution.displacement(x, t);
        },
        displacement);
      scene.initial_stress.emplace(stresses, stress);
    }
  } // namespace



  template <int dim>
  Scene<dim>::Scene(const Parameters &parameters)
    : parameters(parameters)
    , names(parameters)
    , schedule(parameters.time.phases)
    , exact_solution(make_exact_solution<dim>(parameters.exact_solution,
                                              schedule.end_time(),
                                              plane_model()))
    , body_force(optional_vector<dim>(parameters.loads.body_force,
                                      dim,
                                      "Loads/Body force"))
    , initial_displacement(
        optional_vector<dim>(parameters.initial_state.displacement,
                             dim,
                             "Initial state/Displacement"))
    , initial_stress(optional_vector<dim>(parameters.initial_state.stress,
                                          stress_components<dim>().size(),
                                          "Initial state/Stress"))
    , temperature(
        make_temperature<dim>(parameters.temperature, parameters.units))
  {
    if (dim != 2 && plane_model() != PlaneModel::strain)
      refuse("'Geometry/Plane model' = " + name_of(plane_model()) +
             " is that of meshes in 2D, but 'Dimension' = 3.");
    read_axial_datum(*this);
    const ExactSolution<dim> *source_of_data =
      exact_solution && exact_solution->makes_data ? exact_solution.get() :
                                                     nullptr;
    for (const auto &[id, boundary_parameters] : parameters.boundaries)
      boundary.emplace(
        id, BoundaryCondition<dim>(id, boundary_parameters, source_of_data));
    find_contact_pairs(*this);
    supports = read_supports<dim>(parameters.supports);
    if (source_of_data)
      derive_data(*this);

    const OutputParameters &output = parameters.output;
    output_points                  = read_output_points<dim>(output.points);
    output_lines                   = read_output_lines<dim>(output.lines);
    output_integrals = read_output_integrals(output.integrals, names);
    if (output.revolved_angle != 0. && !is_axisymmetric())
      refuse("'Output/Revolved angle' is for bodies of revolution "
             "('Geometry/Plane model' = axisymmetric).");
    if (!parameters.error_control.quantity.empty())
      quantity = quantity_of_interest(
        names.column(parameters.error_control.quantity),
        boundary,
        output_points.size(),
        axial_force  ? std::optional(QuantityOfInterest::Kind::axial_strain) :
        axial_strain ? std::optional(QuantityOfInterest::Kind::axial_force) :
                       std::nullopt,
        names);
  }



  template <int dim>
  bool
  Scene<dim>::has_constant_loads_and_bounds() const
  {
    for (const auto &[id, condition] : boundary)
      if (condition.load_depends_on_time() ||
          (condition.has_contact_points() &&
           condition.bound_depends_on_time()) ||
          condition.has_computed_pressure())
        return false;
    return !(body_force && body_force->depends_on_time()) &&
           !(axial_force && axial_force->depends_on_time()) &&
           !(temperature && temperature->value.depends_on_time());
  }



  template <int dim>
  bool
  Scene<dim>::keeps_friction_work() const
  {
    const OutputParameters              &output = parameters.output;
    std::vector<std::set<RecordedField>> asked{output.additional_fields,
                                               output.point_fields,
                                               output.line_fields};
    for (const OutputIntegral &integral : output_integrals)
      asked.push_back(integral.fields);
    return has_friction() &&
           std::any_of(asked.begin(), asked.end(), [](const auto &fields) {
             return fields.count(RecordedField::friction_work) == 1;
           });
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(Scene);
} // namespace Viscoplastic
