// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/mesh_ids.h>
#include <viscoplastic_contact/mesh_pieces.h>
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
      if (name == "glued")
        return FrictionLaw::glued;
      AssertThrow(false,
                  ExcMessage("'" + entry(id, "Friction law") + "' = " + name +
                             " is unknown; it must be none, tresca, coulomb or "
                             "glued."));
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
        if (has_friction() || is_glued())
          foundation_motion =
            optional_vector<dim>(parameters.foundation_motion,
                                 dim,
                                 entry(id, "Foundation motion"));
        // Only its change counts.
        if (foundation_motion && !foundation_motion->depends_on_time())
          foundation_motion.reset();
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
  Tensor<1, dim>
  BoundaryCondition<dim>::sliding(const Point<dim> &x, const double t) const
  {
    if (!foundation_motion)
      return {};
    const Tensor<1, dim> w =
      foundation_motion->vector(x, t) - foundation_motion->vector(x, 0.);
    return w - (w * normal) * normal;
  }



  template <int dim>
  Tensor<1, dim>
  BoundaryCondition<dim>::glued_displacement(const Point<dim> &x,
                                             const double      t) const
  {
    Tensor<1, dim> u = sliding(x, t);
    if (foundation_displacement)
      u += foundation_displacement->value(x, t) * normal;
    return u;
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

    for (const std::string &point :
         Utilities::split_string_list(parameters.output.points, ';'))
      if (!point.empty())
        output_points.push_back(parse_point<dim>(point, "Output/Points"));
  }



  template <int dim>
  void
  Scene<dim>::inspect(
    const parallel::distributed::Triangulation<dim> &triangulation)
  {
    warnings.clear();
    inspect_boundary_ids(boundary_ids(triangulation));
    inspect_flatness(triangulation);
    inspect_junctions(triangulation);
    make_materials(material_ids(triangulation));
  }



  template <int dim>
  void
  Scene<dim>::inspect_boundary_ids(
    const std::set<types::boundary_id> &ids) const
  {
    for (const types::boundary_id id : ids)
      AssertThrow(boundary.count(id) == 1,
                  ExcMessage("Boundary id " + std::to_string(id) +
                             " of the mesh has no role; add `subsection "
                             "Boundary " +
                             std::to_string(id) +
                             "' with a role (free, if it carries no load). "
                             "The mesh has the ids " +
                             list(ids) +
                             (id == 0 && !parameters.geometry.file.empty() ?
                                "; faces that the file puts into no group "
                                "have the id 0." :
                                ".")));
    for (const auto &pair : boundary)
      AssertThrow(ids.count(pair.first) == 1,
                  ExcMessage("'Boundary " + std::to_string(pair.first) +
                             "' has a role, but the mesh has no such boundary "
                             "id; it has the ids " +
                             list(ids) + "."));
  }



  template <int dim>
  void
  Scene<dim>::inspect_flatness(
    const parallel::distributed::Triangulation<dim> &triangulation)
  {
    const double tolerance = parameters.geometry.flatness_tolerance;
    for (auto &[id, condition] : boundary)
      if (condition.role == BoundaryRole::symmetry ||
          condition.role == BoundaryRole::contact)
        {
          const PieceNormal<dim> piece = piece_normal(triangulation, id);
          condition.normal             = piece.normal;
          std::ostringstream message;
          message << "Boundary " << id << " has the role "
                  << (condition.role == BoundaryRole::contact ? "contact" :
                                                                "symmetry")
                  << " but is not flat: its normals deviate by "
                  << piece.deviation
                  << " degrees from their mean, and 'Geometry/Flatness "
                     "tolerance' is "
                  << tolerance
                  << "; give each flat piece a boundary id of its own.";
          AssertThrow(piece.deviation <= tolerance, ExcMessage(message.str()));
        }
  }



  template <int dim>
  void
  Scene<dim>::inspect_junctions(
    const parallel::distributed::Triangulation<dim> &triangulation)
  {
    // On the coarse mesh, which all ranks know.
    std::map<types::boundary_id, std::set<unsigned int>> vertices;
    for (const auto &cell : triangulation.cell_iterators_on_level(0))
      for (const unsigned int f : cell->face_indices())
        if (cell->face(f)->at_boundary())
          for (const unsigned int v : cell->face(f)->vertex_indices())
            vertices[cell->face(f)->boundary_id()].insert(
              cell->face(f)->vertex_index(v));
    for (const auto &[id, condition] : boundary)
      if (condition.role == BoundaryRole::clamped || condition.is_glued())
        for (const auto &[other_id, other] : boundary)
          if (other.has_friction())
            for (const unsigned int v : vertices[id])
              if (vertices[other_id].count(v) == 1)
                {
                  warnings.push_back(
                    "Boundary " + std::to_string(id) + " (" +
                    (condition.is_glued() ? "glued" : "clamped") +
                    ") touches boundary " + std::to_string(other_id) +
                    " (friction); the theory keeps the closures of Gamma_1 "
                    "and Gamma_3 apart, and stresses may be singular where "
                    "they meet.");
                  break;
                }
  }



  template <int dim>
  void
  Scene<dim>::make_materials(const std::set<types::material_id> &ids)
  {
    materials.clear();
    material_of_id.clear();
    if (parameters.materials.empty())
      {
        materials.push_back(std::make_unique<const Material<dim>>(
          "Material", parameters.material, parameters.handler));
        for (const types::material_id id : ids)
          material_of_id[id] = materials[0].get();
        return;
      }

    const MaterialParameters &plain = parameters.material, defaults;
    AssertThrow(plain.youngs_modulus == defaults.youngs_modulus &&
                  plain.poissons_ratio == defaults.poissons_ratio &&
                  plain.voigt_matrix == defaults.voigt_matrix &&
                  plain.law == defaults.law,
                ExcMessage("'Material' gives elasticity or a law beside "
                           "numbered materials, but no cell would have it; "
                           "give it to `Material <id>', or leave the numbers "
                           "out."));
    for (const types::material_id id : ids)
      {
        const auto section = "Material " + std::to_string(id);
        const auto given   = parameters.materials.find(id);
        AssertThrow(given != parameters.materials.end(),
                    ExcMessage("Cells of the mesh have the material id " +
                               std::to_string(id) +
                               ", but there is no `subsection " + section +
                               "'; the mesh has the material ids " + list(ids) +
                               "."));
        materials.push_back(std::make_unique<const Material<dim>>(
          section, given->second, parameters.handler));
        material_of_id[id] = materials.back().get();
      }
    for (const auto &pair : parameters.materials)
      if (ids.count(pair.first) == 0)
        warnings.push_back("'Material " + std::to_string(pair.first) +
                           "' is not used: the mesh has the material ids " +
                           list(ids) + ".");
  }



  template <int dim>
  bool
  Scene<dim>::has_viscosity() const
  {
    for (const auto &material : materials)
      if (material->law)
        return true;
    return false;
  }



  template <int dim>
  bool
  Scene<dim>::has_moving_foundation() const
  {
    for (const auto &pair : boundary)
      if (pair.second.has_friction() && pair.second.foundation_motion)
        return true;
    return false;
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
    for (const auto &material : materials)
      {
        const std::string of =
          materials.size() > 1 ? " of " + material->section : "";
        if (material->is_anisotropic())
          result.push_back("anisotropic elasticity" + of);
        if (!material->law)
          continue;
        const std::string announcement = material->law->announcement();
        result.push_back("viscoplastic flow" + of + " (" + material->law_name +
                         ", history at " + parameters.stress.stress_history +
                         (announcement.empty() ? "" : "; " + announcement) +
                         ")");
      }
    const auto boundaries = [&](const auto &condition) {
      std::string ids;
      for (const auto &[id, data] : boundary)
        if (condition(data))
          ids += (ids.empty() ? "" : ", ") + std::to_string(id);
      return ids;
    };
    const auto add = [&](const std::string &name, const std::string &ids) {
      if (!ids.empty())
        result.push_back(name + " on boundary " + ids);
    };
    add("bilateral contact with Tresca friction", boundaries([](const auto &b) {
          return b.friction_law == FrictionLaw::tresca;
        }));
    add("Coulomb friction with given normal stress",
        boundaries([](const auto &b) {
          return b.friction_law == FrictionLaw::coulomb;
        }));
    add("frictionless bilateral contact", boundaries([](const auto &b) {
          return b.role == BoundaryRole::contact &&
                 b.friction_law == FrictionLaw::none;
        }));
    add("glued contact",
        boundaries([](const auto &b) { return b.is_glued(); }));
    add("foundation moving in normal direction", boundaries([](const auto &b) {
          return b.foundation_displacement.has_value();
        }));
    add("foundation moving in tangential direction",
        boundaries(
          [](const auto &b) { return b.foundation_motion.has_value(); }));
    if (body_force)
      result.push_back("body force");
    add("surface traction",
        boundaries([](const auto &b) { return b.traction.has_value(); }));
    add("prescribed displacement", boundaries([](const auto &b) {
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
