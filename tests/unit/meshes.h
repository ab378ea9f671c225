// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// Meshes from generators and files, their measures and refusals.

#include "body.h"
#include "refusals.h"
#include <viscoplastic_contact/mesh/mesh.h>
#include <viscoplastic_contact/mesh/mesh_ids.h>

#include <algorithm>
#include <map>

namespace Viscoplastic::Testing
{
  template <int dim>
  using Mesh = parallel::distributed::Triangulation<dim>;

  /// A file with a given text, separate on each rank, deleted at destruction.
  class TemporaryFile
  {
  public:
    TemporaryFile(const std::string &text, const std::string &suffix)
      : name(std::filesystem::temp_directory_path() /
             ("unit_mesh_" + std::to_string(getpid()) + suffix))
    {
      std::ofstream(name, std::ios::binary) << text;
    }

    ~TemporaryFile()
    {
      std::remove(name.c_str());
    }

    const std::string name;
  };



  inline std::string
  replaced(std::string text, const std::string &what, const std::string &by)
  {
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), by);
  }



  /// A mesh file of Gmsh with these lines of nodes and elements.
  inline std::string
  msh(const std::string &nodes, const std::string &elements)
  {
    const auto section = [](const std::string &name, const std::string &lines) {
      return "$" + name + "\n" +
             std::to_string(std::count(lines.begin(), lines.end(), '\n')) +
             "\n" + lines + "$End" + name + "\n";
    };
    return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + section("Nodes", nodes) +
           section("Elements", elements);
  }



  template <int dim>
  std::unique_ptr<Mesh<dim>>
  make(const GeometryParameters &geometry)
  {
    auto mesh = std::make_unique<Mesh<dim>>(MPI_COMM_WORLD);
    make_mesh(geometry, *mesh);
    return mesh;
  }



  inline GeometryParameters
  from_file(const std::string &file)
  {
    GeometryParameters geometry;
    geometry.file = file;
    return geometry;
  }



  inline GeometryParameters
  generated(const std::string &arguments,
            const std::string &generator = "subdivided_hyper_rectangle")
  {
    GeometryParameters geometry;
    geometry.generator = generator;
    geometry.arguments = arguments;
    return geometry;
  }



  /// Areas of the boundary by id; volumes() has those of cells.
  template <int dim>
  std::map<unsigned int, double>
  areas(const Mesh<dim> &mesh)
  {
    std::map<unsigned int, double> result;
    for (const auto id : boundary_ids(mesh))
      result[id] = 0.;
    for (const auto &cell : mesh.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int f : cell->face_indices())
          if (cell->at_boundary(f))
            result.at(cell->face(f)->boundary_id()) += cell->face(f)->measure();
    for (auto &pair : result)
      pair.second = Utilities::MPI::sum(pair.second, MPI_COMM_WORLD);
    return result;
  }



  template <int dim>
  std::map<unsigned int, double>
  volumes(const Mesh<dim> &mesh)
  {
    std::map<unsigned int, double> result;
    for (const auto id : material_ids(mesh))
      result[id] = 0.;
    for (const auto &cell : mesh.active_cell_iterators())
      if (cell->is_locally_owned())
        result.at(cell->material_id()) += cell->measure();
    for (auto &pair : result)
      pair.second = Utilities::MPI::sum(pair.second, MPI_COMM_WORLD);
    return result;
  }



  inline void
  expect_measures(const std::map<unsigned int, double> &measures,
                  const std::map<unsigned int, double> &expected)
  {
    ASSERT_EQ(measures.size(), expected.size());
    for (const auto &[id, value] : expected)
      {
        ASSERT_EQ(measures.count(id), 1u) << "id " << id;
        EXPECT_NEAR(measures.at(id), value, 1e-12) << "id " << id;
      }
  }



  template <int dim>
  void
  expect_mesh_refused(const GeometryParameters &geometry,
                      const std::string        &sentence)
  {
    expect_refusal([&] { make<dim>(geometry); }, sentence);
  }
} // namespace Viscoplastic::Testing
