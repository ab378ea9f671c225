// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/physics/transformations.h>

#include <viscoplastic_contact/messages.h>
#include <viscoplastic_contact/scene.h>

#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    std::string
    entry(const types::boundary_id id, const std::string &name)
    {
      return "Boundary " + std::to_string(id) + "/" + name;
    }



    BoundaryRole
    role_by_name(const types::boundary_id id, const std::string &name)
    {
      if (name == "clamped")
        return BoundaryRole::clamped;
      if (name == "displacement")
        return BoundaryRole::displacement;
      if (name == "traction")
        return BoundaryRole::traction;
      if (name == "free")
        return BoundaryRole::free;
      if (name == "symmetry")
        return BoundaryRole::symmetry;
      if (name == "contact")
        return BoundaryRole::contact;
      AssertThrow(false,
                  ExcMessage("'" + entry(id, "Role") +
                             "' is missing; it must be clamped, displacement, "
                             "traction, free, symmetry or contact."));
      return BoundaryRole::free;
    }



    FrictionLaw
    friction_law_by_name(const types::boundary_id id, const std::string &name)
    {
      if (name == "none")
        return FrictionLaw::none;
      if (name == "tresca")
        return FrictionLaw::tresca;
      if (name == "coulomb")
        return FrictionLaw::coulomb;
      AssertThrow(false,
                  ExcMessage("'" + entry(id, "Friction law") + "' = " + name +
                             " is unknown; it must be none, tresca or "
                             "coulomb."));
      return FrictionLaw::none;
    }



    template <int dim>
    std::optional<VectorExpression<dim>>
    optional_vector(const std::string &text,
                    const unsigned int n_components,
                    const std::string &entry)
    {
      if (Utilities::trim(text).empty())
        return {};
      VectorExpression<dim> expression(text, n_components, entry);
      if (expression.is_zero())
        return {};
      return expression;
    }



    template <int dim>
    Point<dim>
    parse_vector(const std::string &text, const std::string &entry)
    {
      std::vector<double> numbers;
      try
        {
          numbers = Utilities::string_to_double(
            Utilities::split_string_list(text, ','));
        }
      catch (const std::exception &)
        {
          numbers.clear(); // refused below
        }
      AssertThrow(numbers.size() == dim,
                  ExcMessage("'" + entry + "' = " + text + " needs " +
                             std::to_string(dim) + " numbers."));
      Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = numbers[d];
      return result;
    }
  } // namespace



  template <int dim>
  BoundaryCondition<dim>::BoundaryCondition(
    const types::boundary_id  id,
    const BoundaryParameters &parameters)
    : id(id)
    , role(role_by_name(id, parameters.role))
  {
    if (role == BoundaryRole::displacement)
      {
        const auto parts =
          Utilities::split_string_list(parameters.displacement, ';');
        AssertThrow(parts.size() == dim,
                    ExcMessage("'" + entry(id, "Displacement") + "' needs " +
                               std::to_string(dim) +
                               " components separated by semicolons, but '" +
                               parameters.displacement + "' has " +
                               std::to_string(parts.size()) + "."));
        for (unsigned int d = 0; d < dim; ++d)
          if (parts[d] != "free")
            displacement[d].emplace(parts[d], entry(id, "Displacement"));
      }
    else if (role == BoundaryRole::traction)
      traction =
        optional_vector<dim>(parameters.traction, dim, entry(id, "Traction"));
    else if (role == BoundaryRole::contact)
      {
        friction_law = friction_law_by_name(id, parameters.friction_law);
        if (friction_law == FrictionLaw::coulomb)
          {
            friction_coefficient.emplace(parameters.friction_coefficient,
                                         entry(id, "Friction coefficient"));
            normal_stress.emplace(parameters.normal_stress,
                                  entry(id, "Normal stress"));
          }
        else
          {
            Expression<dim> d(parameters.foundation_displacement,
                              entry(id, "Foundation displacement"));
            if (!d.is_zero())
              foundation_displacement = std::move(d);
          }
        if (friction_law == FrictionLaw::tresca)
          friction_bound.emplace(parameters.friction_bound,
                                 entry(id, "Friction bound"));
      }
  }



  template <int dim>
  double
  BoundaryCondition<dim>::bound(const Point<dim> &x, const double t) const
  {
    const bool   is_tresca = friction_law == FrictionLaw::tresca;
    const double factor    = is_tresca ? friction_bound->value(x, t) :
                                         friction_coefficient->value(x, t);
    if (factor < 0.)
      {
        std::ostringstream message;
        message << "'"
                << entry(id,
                         is_tresca ? "Friction bound" : "Friction coefficient")
                << "' is " << factor << " at x = (" << x << "), t = " << t
                << "; it must not be negative.";
        AssertThrow(false, ExcMessage(message.str()));
      }
    return is_tresca ? factor : factor * std::abs(normal_stress->value(x, t));
  }



  template <int dim>
  bool
  BoundaryCondition<dim>::bound_depends_on_time() const
  {
    return (friction_bound && friction_bound->depends_on_time()) ||
           (friction_coefficient && friction_coefficient->depends_on_time()) ||
           (normal_stress && normal_stress->depends_on_time());
  }



  template <int dim>
  Scene<dim>::Scene(const Parameters &parameters)
    : parameters(parameters)
    , youngs_modulus(parameters.material.youngs_modulus,
                     "Material/Young's modulus")
    , poissons_ratio(parameters.material.poissons_ratio,
                     "Material/Poisson's ratio")
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
    , schedule(parameters.time.phases)
  {
    for (const auto &[id, boundary_parameters] : parameters.boundaries)
      boundary.emplace(id, BoundaryCondition<dim>(id, boundary_parameters));

    for (const Expression<dim> *modulus : {&youngs_modulus, &poissons_ratio})
      AssertThrow(!modulus->depends_on_time(),
                  ExcMessage("'Material/Young's modulus' and 'Poisson's ratio' "
                             "may depend on position, but not on t."));
    for (const std::string &point :
         Utilities::split_string_list(parameters.output.points, ';'))
      if (!point.empty())
        output_points.push_back(parse_vector<dim>(point, "Output/Points"));

    parameters.handler.enter_subsection("Material");
    law = make_viscoplastic_law(parameters.material.law, parameters.handler);
    parameters.handler.leave_subsection();
  }



  template <int dim>
  void
  Scene<dim>::make_mesh(
    parallel::distributed::Triangulation<dim> &triangulation) const
  {
    const GeometryParameters &geometry = parameters.geometry;
    try
      {
        GridGenerator::generate_from_name_and_arguments(triangulation,
                                                        geometry.generator,
                                                        geometry.arguments);
      }
    catch (const std::exception &exception)
      {
        AssertThrow(false,
                    ExcMessage("The mesh generator '" + geometry.generator +
                               "' refuses the arguments '" +
                               geometry.arguments + "': " + reason(exception)));
      }
    AssertThrow(triangulation.all_reference_cells_are_hyper_cube(),
                ExcMessage("The mesh must consist of quadrilaterals or "
                           "hexahedra; simplices are not supported."));

    const bool rotated = geometry.rotation_angle != 0.;
    const bool shifted = !geometry.translation.empty();
    if (rotated || shifted)
      {
        for (const types::manifold_id id : triangulation.get_manifold_ids())
          AssertThrow(id == numbers::flat_manifold_id,
                      ExcMessage("'Geometry/Rotation angle' and 'Translation' "
                                 "apply to meshes with straight edges only; '" +
                                 geometry.generator + "' has curved ones."));
        const double angle = geometry.rotation_angle * numbers::PI / 180.;
        if (rotated)
          {
            if constexpr (dim == 2)
              GridTools::rotate(angle, triangulation);
            else
              {
                const Point<3> axis = parse_vector<3>(geometry.rotation_axis,
                                                      "Geometry/Rotation axis");
                AssertThrow(axis.norm() > 0.,
                            ExcMessage("'Geometry/Rotation axis' must not be "
                                       "zero."));
                GridTools::rotate(Tensor<1, 3>(axis / axis.norm()),
                                  angle,
                                  triangulation);
              }
          }
        if (shifted)
          GridTools::shift(parse_vector<dim>(geometry.translation,
                                             "Geometry/Translation"),
                           triangulation);
      }
    triangulation.refine_global(geometry.global_refinements);
  }



  template <int dim>
  void
  Scene<dim>::inspect_boundary(
    const parallel::distributed::Triangulation<dim> &triangulation)
  {
    const MPI_Comm comm = triangulation.get_communicator();

    // The ids of the mesh, agreed upon by all ranks.
    std::set<types::boundary_id> ids;
    for (const auto &local_ids :
         Utilities::MPI::all_gather(comm, triangulation.get_boundary_ids()))
      ids.insert(local_ids.begin(), local_ids.end());
    std::string list;
    for (const types::boundary_id id : ids)
      list += (list.empty() ? "" : ", ") + std::to_string(id);
    for (const types::boundary_id id : ids)
      AssertThrow(boundary.count(id) == 1,
                  ExcMessage("Boundary id " + std::to_string(id) +
                             " of the mesh has no role; add `subsection "
                             "Boundary " +
                             std::to_string(id) +
                             "' with a role (free, if it carries no load). "
                             "The mesh has the ids " +
                             list + "."));
    for (const auto &pair : boundary)
      AssertThrow(ids.count(pair.first) == 1,
                  ExcMessage("'Boundary " + std::to_string(pair.first) +
                             "' has a role, but the mesh has no such boundary "
                             "id; it has the ids " +
                             list + "."));

    // The mean normal of each piece, and how far any face deviates from it.
    const FE_Q<dim>   fe(1);
    FEFaceValues<dim> face_values(fe,
                                  QGauss<dim - 1>(2),
                                  update_normal_vectors | update_JxW_values);
    for (auto &[id, condition] : boundary)
      {
        if (condition.role != BoundaryRole::symmetry &&
            condition.role != BoundaryRole::contact)
          continue;
        const auto for_each_normal = [&](const auto &visit) {
          for (const auto &cell : triangulation.active_cell_iterators())
            if (cell->is_locally_owned())
              for (const unsigned int f : cell->face_indices())
                if (cell->face(f)->at_boundary() &&
                    cell->face(f)->boundary_id() == id)
                  {
                    face_values.reinit(cell, f);
                    for (const unsigned int q :
                         face_values.quadrature_point_indices())
                      visit(face_values.normal_vector(q), face_values.JxW(q));
                  }
        };
        Tensor<1, dim> sum;
        for_each_normal([&](const Tensor<1, dim> &normal, const double JxW) {
          sum += normal * JxW;
        });
        sum = Utilities::MPI::sum(sum, comm);

        double deviation = sum.norm() > 0. ? 0. : 1.;
        if (sum.norm() > 0.)
          {
            condition.normal = sum / sum.norm();
            // Exact axes keep the nodal frames of axis-parallel bodies trivial.
            for (unsigned int d = 0; d < dim; ++d)
              if (std::abs(std::abs(condition.normal[d]) - 1.) < 1e-12)
                {
                  const double sign   = condition.normal[d] > 0. ? 1. : -1.;
                  condition.normal    = 0.;
                  condition.normal[d] = sign;
                }
            for_each_normal([&](const Tensor<1, dim> &normal, const double) {
              deviation =
                std::max(deviation, (normal - condition.normal).norm());
            });
            deviation = Utilities::MPI::max(deviation, comm);
          }
        std::ostringstream message;
        message << "Boundary " << id << " has the role "
                << (condition.role == BoundaryRole::contact ? "contact" :
                                                              "symmetry")
                << " but is not flat: its normals deviate by "
                << deviation * 180. / numbers::PI
                << " degrees, and 1e-6 are allowed; give each flat piece a "
                   "boundary id of its own.";
        AssertThrow(deviation * 180. / numbers::PI <= 1e-6,
                    ExcMessage(message.str()));
      }
  }



  template <int dim>
  bool
  Scene<dim>::has_friction() const
  {
    for (const auto &pair : boundary)
      if (pair.second.has_friction())
        return true;
    return false;
  }



  template <int dim>
  bool
  Scene<dim>::has_contact() const
  {
    for (const auto &pair : boundary)
      if (pair.second.role == BoundaryRole::contact)
        return true;
    return false;
  }



  template <int dim>
  std::vector<std::string>
  Scene<dim>::effects() const
  {
    std::vector<std::string> result{dim == 2 ? "elasticity (plane strain)" :
                                               "elasticity (3D)"};
    if (has_viscosity())
      result.push_back("viscoplastic flow (" + parameters.material.law +
                       ", history at " + parameters.material.stress_history +
                       ")");
    const auto boundaries = [&](const auto &condition) {
      std::string ids;
      for (const auto &[id, data] : boundary)
        if (condition(data))
          ids += (ids.empty() ? "" : ", ") + std::to_string(id);
      return ids;
    };
    const auto list = [&](const std::string &name, const std::string &ids) {
      if (!ids.empty())
        result.push_back(name + " on boundary " + ids);
    };
    list("bilateral contact with Tresca friction",
         boundaries([](const auto &b) {
           return b.friction_law == FrictionLaw::tresca;
         }));
    list("Coulomb friction with given normal stress",
         boundaries([](const auto &b) {
           return b.friction_law == FrictionLaw::coulomb;
         }));
    list("frictionless bilateral contact", boundaries([](const auto &b) {
           return b.role == BoundaryRole::contact && !b.has_friction();
         }));
    list("moving foundation", boundaries([](const auto &b) {
           return b.foundation_displacement.has_value();
         }));
    if (body_force)
      result.push_back("body force");
    list("surface traction",
         boundaries([](const auto &b) { return b.traction.has_value(); }));
    list("prescribed displacement", boundaries([](const auto &b) {
           return b.role == BoundaryRole::displacement;
         }));
    if (initial_displacement || initial_stress)
      result.push_back("initial displacement or stress");
    if (is_adaptive())
      result.push_back("adaptive mesh (" + parameters.refinement.strategy +
                       " estimator)");
    return result;
  }



  template struct BoundaryCondition<2>;
  template struct BoundaryCondition<3>;
  template class Scene<2>;
  template class Scene<3>;
} // namespace Viscoplastic
