// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/distributed/tria.h>
#include <deal.II/grid/grid_tools.h>

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/table.h>
#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/mesh/mesh.h>
#include <viscoplastic_contact/results/run_record.h>
#include <viscoplastic_contact/run/scene_as_json.h>
#include <viscoplastic_contact/run/scene_data.h>
#include <viscoplastic_contact/scene/material.h>

#include <nlohmann/json.hpp>

namespace Viscoplastic
{
  namespace
  {
    using Json = nlohmann::ordered_json;



    /// Entries of boundaries that may depend on position and time.
    const std::vector<std::string> boundary_data{"Gap",
                                                 "Foundation motion",
                                                 "Foundation displacement",
                                                 "Normal stress",
                                                 "Traction",
                                                 "Displacement",
                                                 "Pressure",
                                                 "Normal stiffness",
                                                 "Tangential stiffness"};



    std::map<std::string, std::string>
    values_in_use(const Parameters &scene)
    {
      auto values                        = scene.values();
      values["Time/Scheme"]              = name_of(scene.time.scheme);
      values["Time/Stiffness policy"]    = name_of(scene.time.stiffness_policy);
      values["Mesh refinement/Strategy"] = name_of(scene.refinement.strategy);
      return values;
    }



    /// Return a checksum of mesh, libraries and tables that the scene reads.
    unsigned int
    checksum_of_files(const Parameters &scene)
    {
      std::vector<std::string> files = scene.shared_libraries;
      if (!scene.geometry.file.empty())
        files.push_back(scene.geometry.file);
      std::string text;
      for (const auto &table : tables_in_use())
        text += std::to_string(table->checksum) + ' ';
      for (const std::string &file : files)
        text += read_file_if_any(file).value_or("");
      return checksum(text);
    }



    /// Return what the automatic choice of `Material/Volumetric integration'
    /// stands for. Collective.
    template <int dim>
    VolumetricIntegration
    volumetric_integration(
      const Parameters                                &parameters,
      const parallel::distributed::Triangulation<dim> &triangulation)
    {
      Scene<dim> scene(parameters);
      scene.inspect(triangulation);
      double max_nu = -1.;
      for (const auto &cell : triangulation.active_cell_iterators())
        if (cell->is_locally_owned())
          max_nu = std::max(max_nu,
                            scene.material(cell->material_id())
                              .stiffness(cell->center())
                              .poissons_ratio());
      max_nu = Utilities::MPI::max(max_nu, triangulation.get_communicator());
      return uses_mean_dilatation(scene, max_nu) ?
               VolumetricIntegration::mean_dilatation :
               VolumetricIntegration::full;
    }



    /// Adds the means of the data of a scene to its record.
    template <int dim>
    class Means
    {
    public:
      Means(const Parameters &scene, const SceneData<dim> &data, Json &json)
        : scene(scene)
        , data(data)
        , json(json)
      {}

      void
      add_all()
      {
        for (const char *name : {"means", "areas", "nearest_isotropic"})
          json[name] = Json::object();
        if (scene.materials.empty())
          add_material("Material", scene.material, {});
        for (const auto &[id, material] : scene.materials)
          add_material("Material " + std::to_string(id),
                       material,
                       {Domain::Kind::material, id});
        for (const auto &[id, boundary] : scene.boundaries)
          {
            const Domain             domain{Domain::Kind::boundary, id};
            std::vector<std::string> names = boundary_data;
            for (const LawEntry &entry : entries_of(friction_laws()))
              names.push_back(entry.name);
            for (const std::string &name : names)
              add("Boundary " + std::to_string(id) + '/' + name, domain);
            if (boundary.role == BoundaryRole::contact)
              json["areas"][std::to_string(id)] = data.measure(domain);
          }
        for (const char *path : {"Loads/Body force", "Temperature/Value"})
          add(path, {});
      }

    private:
      void
      add_material(const std::string        &section,
                   const MaterialParameters &material,
                   const Domain             &domain)
      {
        // The nearest isotropic stiffness has the same Voigt averages.
        if (!material.voigt_matrix.empty())
          {
            const Stiffness stiffness =
              Material<dim>(section, material, scene.handler)
                .stiffness(Point<dim>());
            const double nu                    = stiffness.poissons_ratio();
            json["nearest_isotropic"][section] = {2. * (1. + nu) *
                                                    stiffness.shear_modulus(),
                                                  nu};
          }
        const std::string of_law = section + '/' + material.law + '/';
        for (const auto &[path, text] : values)
          if (path == section + "/Young's modulus" ||
              path == section + "/Poisson's ratio" ||
              path == section + "/Thermal expansion" ||
              // The strain rate of a parsed law, and parameters that depend on
              // T, are not functions of x and t alone.
              (!mentions(text, "T") &&
               path.compare(0, of_law.size(), of_law) == 0 &&
               path != of_law + "Strain rate"))
            add(path, domain);
      }

      void
      add(const std::string &path, const Domain &domain)
      {
        try
          {
            const std::string &text = values.at(path);
            if (const auto mean = data.over_space(text, domain))
              json["means"][path]["over_space"] = *mean;
            if (const auto mean = data.over_time(text))
              json["means"][path]["over_time"] = *mean;
          }
        catch (const ExpressionError &)
          {} // entries that are no expressions, such as choices
      }

      const Parameters                        &scene;
      const std::map<std::string, std::string> values = scene.values();
      const SceneData<dim>                    &data;
      Json                                    &json;
    };



    /// Add what depends on the mesh. Collective.
    template <int dim>
    void
    add_mesh(const Parameters &scene,
             const bool        with_means,
             const MPI_Comm    communicator,
             Json             &json)
    {
      parallel::distributed::Triangulation<dim> triangulation(communicator);
      make_mesh(scene.geometry, triangulation);
      json["cells"] = triangulation.n_global_active_cells();
      json["h"]     = GridTools::maximal_cell_diameter(triangulation) /
                  std::sqrt(static_cast<double>(dim));
      json["volumetric_integration"] =
        name_of(volumetric_integration(scene, triangulation));
      for (const auto &[place, name] : PlaceNames(scene).names)
        json["names"][place.text()] = name;
      if (with_means)
        Means<dim>(scene, SceneData<dim>(scene, triangulation), json).add_all();
    }
  } // namespace



  std::string
  scene_as_json(const Parameters &scene,
                const bool        with_means,
                const MPI_Comm    communicator)
  {
    const TimeSchedule schedule(scene.time.phases); // throws
    Json               json{{"version", program_version},
              {"revision", git_revision},
              {"ranks", Utilities::MPI::n_mpi_processes(communicator)},
              {"file", scene.file},
              {"directory", results_directory(scene)},
              {"dimension", scene.dimension},
              {"values", values_in_use(scene)},
              {"files", checksum_of_files(scene)}};
    if (scene.dimension == 2)
      add_mesh<2>(scene, with_means, communicator, json);
    else
      add_mesh<3>(scene, with_means, communicator, json);
    return json_text(json);
  }
} // namespace Viscoplastic
