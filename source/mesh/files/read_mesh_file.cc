// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/mesh/files/mesh_reader.h>
#include <viscoplastic_contact/mesh/files/python.h>
#include <viscoplastic_contact/mesh/files/read_mesh_file.h>

#include <boost/process.hpp>

#include <filesystem>
#include <fstream>
#include <future>
#include <iterator>
#include <map>
#include <regex>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace Viscoplastic
{
  namespace
  {
    std::string
    all_of(std::istream &stream)
    {
      return {std::istreambuf_iterator<char>(stream),
              std::istreambuf_iterator<char>()};
    }



    /// Return the converted mesh or, if that fails, the end of a sentence why.
    std::pair<std::string, std::string>
    run_script(const std::string &name, const PlaneModel plane_model)
    {
      namespace process         = boost::process;
      const std::string python  = VISCOPLASTIC_CONTACT_PYTHON;
      const std::string by_hand = "; where there is Python with meshio, run "
                                  "contrib/convert_mesh MESH MESH.msh by hand "
                                  "and set 'Geometry/File' to its result";
      process::ipstream output, messages;
      std::error_code   error;
      process::child    script(
        python,
        path_of_resource("contrib/convert_mesh"),
        "--plane-model",
        name_of(plane_model),
        "--",
        name,
        process::std_in<process::null, process::std_out> output,
        process::std_err > messages,
        error);
      if (error)
        return {"",
                "cannot be converted, since " + python +
                  " cannot be started: " + error.message() + by_hand};

      // Read both at the same time: the script waits if either pipe is full.
      std::future<std::string> all_messages =
        std::async(std::launch::async, [&] { return all_of(messages); });
      std::string text = all_of(output);
      // Keep the last line; Python may print others before it.
      std::string message = Utilities::trim(all_messages.get());
      message             = message.substr(message.rfind('\n') + 1);
      script.wait(error);
      if (!error && script.exit_code() == 0)
        return {std::move(text), ""};
      if (message.compare(0, name.size() + 2, name + ": ") == 0)
        return {"", message.substr(name.size() + 2)};
      return {"",
              "cannot be converted: contrib/convert_mesh ends with code " +
                std::to_string(script.exit_code()) +
                (message.empty() ? "" : " (" + message + ")") + by_hand};
    }



    /// Convert the mesh file @p name by contrib/convert_mesh and return the
    /// mesh in Gmsh's format, as text, on all ranks. Rank 0 runs the script in
    /// a separate process, so that a damaged file can only crash that one.
    /// Throws ExcMessage with a sentence for the user that names the file, also
    /// if the elements are not of @p plane_model. Collective.
    std::string
    convert_mesh_file(const std::string &name,
                      const PlaneModel   plane_model,
                      const MPI_Comm     communicator)
    {
      std::pair<std::string, std::string> result;
      if (Utilities::MPI::this_mpi_process(communicator) == 0)
        result = run_script(name, plane_model);
      result = Utilities::MPI::broadcast(communicator, result, 0);
      if (!result.second.empty())
        refuse("The mesh file '" + name + "' " + result.second + ".");
      return std::move(result.first);
    }



    std::string
    content(const std::string &name)
    {
      namespace fs             = std::filesystem;
      const std::string     it = "The mesh file '" + name + "' ";
      std::error_code       error;
      const fs::file_status status = fs::status(name, error);
      if (!fs::exists(status))
        refuse(it + "does not exist.");
      if (fs::is_directory(status))
        refuse(it + "is a directory.");
      if (!fs::is_regular_file(status))
        refuse(it + "is not a regular file.");
      std::ifstream input(name, std::ios::binary);
      if (!input)
        refuse(it + "cannot be opened.");
      std::string text{std::istreambuf_iterator<char>(input),
                       std::istreambuf_iterator<char>()};
      if (text.find_first_not_of(" \t\r\n") == std::string::npos)
        refuse(it + "is empty.");
      return text;
    }



    /// Refuse formats of CAD programs that contain no volume mesh.
    void
    refuse_geometry(const std::string &name, const std::string &suffix)
    {
      static const std::map<std::string, std::string> formats{{".stl", "STL"},
                                                              {".ply", "PLY"},
                                                              {".obj", "OBJ"},
                                                              {".step", "STEP"},
                                                              {".stp", "STEP"},
                                                              {".iges", "IGES"},
                                                              {".igs", "IGES"},
                                                              {".brep", "BREP"},
                                                              {".geo", "geo"}};
      const auto format = formats.find(suffix);
      if (format == formats.end())
        return;
      const bool is_surface =
        suffix == ".stl" || suffix == ".ply" || suffix == ".obj";
      refuse("The mesh file '" + name + "' cannot be read: it is " +
             (is_surface ? "a surface of triangles (" :
                           "a geometry without a mesh (") +
             format->second + "), but the body has to be filled with " +
             "quadrilaterals (2D) or hexahedra (3D). " +
             (is_surface ? "Gmsh makes them of it: Classify 2D reparametrizes "
                           "the surface, then add a volume" :
                           "Open it in Gmsh") +
             ", set Mesh.RecombineAll = 1 and Mesh.SubdivisionAlgorithm = 1 "
             "(in 3D 2), give boundaries physical groups, and save as .msh.");
    }



    /// Return the nodes of the faces of a cell, as indices into Element::nodes.
    std::vector<std::vector<unsigned int>>
    faces_of_cell(const unsigned int dim)
    {
      if (dim == 2)
        return {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
      return {{0, 1, 2, 3},
              {4, 5, 6, 7},
              {0, 1, 5, 4},
              {1, 2, 6, 5},
              {2, 3, 7, 6},
              {3, 0, 4, 7}};
    }



    std::string
    at_line(const MeshFile::Element &element)
    {
      return "line " + std::to_string(element.line) + ": ";
    }



    /// Return the sorted nodes of a cell or of one of its faces, by which equal
    /// cells or faces are found.
    template <typename Nodes>
    Nodes
    sorted_nodes(const MeshFile::Element         &element,
                 const std::vector<unsigned int> &which = {})
    {
      Nodes result;
      for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = element.nodes[which.empty() ? i : which[i]];
      std::sort(result.begin(), result.end());
      return result;
    }



    void
    check_plane(const MeshFile &mesh)
    {
      double z_min = mesh.nodes[mesh.cells[0].nodes[0]][2], z_max = z_min;
      double extent = 0.;
      for (const auto &cell : mesh.cells)
        for (unsigned int n = 0; n < 4; ++n)
          {
            const Point<3> &x = mesh.nodes[cell.nodes[n]];
            z_min             = std::min(z_min, x[2]);
            z_max             = std::max(z_max, x[2]);
            extent =
              std::max(extent, x.distance(mesh.nodes[mesh.cells[0].nodes[0]]));
          }
      if (z_max - z_min > 1e-6 * extent)
        throw std::runtime_error("its quadrilaterals are not in a plane z = "
                                 "const., as a 2D body has to be");
    }



    /// Check what create_triangulation() assumes, and keep only boundary faces.
    template <int dim>
    void
    check(MeshFile &mesh)
    {
      constexpr unsigned int n_face_nodes = 1 << (dim - 1);
      using Face            = std::array<unsigned int, n_face_nodes>;
      using Cell            = std::array<unsigned int, 1 << dim>;
      const auto cell_faces = faces_of_cell(dim);
      // Sorted nodes, with the index of the cell.
      std::vector<std::pair<Cell, std::size_t>> cells;
      std::vector<std::pair<Face, std::size_t>> faces;
      for (std::size_t c = 0; c < mesh.cells.size(); ++c)
        {
          const MeshFile::Element &element = mesh.cells[c];
          const Cell               cell    = sorted_nodes<Cell>(element);
          if (std::adjacent_find(cell.begin(), cell.end()) != cell.end())
            throw std::runtime_error(at_line(element) +
                                     "a cell has a node twice; collapsed "
                                     "cells are not supported");
          cells.emplace_back(cell, c);
          for (const auto &face : cell_faces)
            faces.emplace_back(sorted_nodes<Face>(element, face), c);
        }

      std::sort(cells.begin(), cells.end());
      for (std::size_t c = 1; c < cells.size(); ++c)
        if (cells[c].first == cells[c - 1].first)
          throw std::runtime_error(
            at_line(mesh.cells[cells[c].second]) +
            "this cell is already in line " +
            std::to_string(mesh.cells[cells[c - 1].second].line) +
            "; a cell can be in one group only");

      std::sort(faces.begin(), faces.end());
      for (std::size_t f = 0; f < faces.size();)
        {
          std::size_t end = f;
          while (end < faces.size() && faces[end].first == faces[f].first)
            ++end;
          if (end - f > 2)
            throw std::runtime_error(at_line(mesh.cells[faces[f].second]) +
                                     "a face of this cell belongs to more "
                                     "than two cells");
          f = end;
        }

      // Ignore ids of inner faces; a face that belongs to no cell is an error.
      std::vector<MeshFile::Element> kept;
      std::map<Face, unsigned int>   lines;
      for (const auto &element : mesh.faces)
        {
          const Face face = sorted_nodes<Face>(element);
          const auto first =
            std::lower_bound(faces.begin(),
                             faces.end(),
                             std::make_pair(face, std::size_t(0)));
          if (first == faces.end() || first->first != face)
            throw std::runtime_error(at_line(element) +
                                     "this boundary element is not a face of "
                                     "any cell");
          if (std::next(first) != faces.end() &&
              std::next(first)->first == face)
            continue;
          if (!lines.emplace(face, element.line).second)
            throw std::runtime_error(
              at_line(element) + "this boundary element is already in line " +
              std::to_string(lines[face]) +
              "; a face can be in one group only");
          kept.push_back(element);
        }
      mesh.faces = std::move(kept);
    }
  } // namespace



  MeshFile
  read_mesh_file(const std::string &name,
                 const unsigned int dim,
                 const PlaneModel   plane_model,
                 const MPI_Comm     communicator)
  {
    std::string text;
    // Nodes of a cluster may not all see the file.
    fail_together(communicator, [&] { text = content(name); });
    std::string suffix = std::filesystem::path(name).extension();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(), ::tolower);
    refuse_geometry(name, suffix);
    const bool is_msh = suffix == ".msh";
    if (!is_msh)
      text = convert_mesh_file(name, plane_model, communicator);

    MeshReader reader(std::move(text), dim);
    try
      {
        read_msh(reader);
        if (reader.mesh.cells.empty())
          throw std::runtime_error(
            std::string("it has no ") +
            (dim == 2 ? "quadrilaterals" : "hexahedra") +
            (reader.has_dimension[5 - dim] ?
               std::string(" but ") +
                 (dim == 2 ? "hexahedra" : "quadrilaterals") +
                 ", and 'Dimension' is " + std::to_string(dim) :
             is_msh ? "; once there are physical groups, Gmsh writes nothing "
                      "but their elements" :
                      ""));
        if (dim == 2 && reader.has_dimension[3])
          throw std::runtime_error("it has hexahedra, and 'Dimension' is 2");
        if (dim == 2)
          {
            check_plane(reader.mesh);
            check<2>(reader.mesh);
          }
        else
          check<3>(reader.mesh);
      }
    catch (const std::exception &exception)
      {
        // Line numbers are those of the text that has been parsed.
        refuse("The mesh file '" + name + "' cannot be read as " +
               (is_msh ? "msh" : "what contrib/convert_mesh makes of it") +
               ": " + reason(exception) + ".");
      }
    return std::move(reader.mesh);
  }



  std::map<std::pair<unsigned int, unsigned int>, std::string>
  physical_names(const std::string &file)
  {
    std::map<std::pair<unsigned int, unsigned int>, std::string> result;
    std::ifstream                                                input(file);
    std::string                                                  line;
    if (!std::getline(input, line) || line.compare(0, 11, "$MeshFormat") != 0)
      return result;
    // The section $PhysicalNames comes before the nodes.
    while (std::getline(input, line) && line.size() < 1000 &&
           line.compare(0, 14, "$PhysicalNames") != 0)
      if (line.compare(0, 6, "$Nodes") == 0)
        return result;
    static const std::regex group("\\s*([0-3])\\s+(\\d{1,9})\\s+\"(.*)\"\\s*");
    std::smatch             match;
    while (std::getline(input, line) && line.size() < 1000 && line[0] != '$')
      if (std::regex_match(line, match, group))
        result[{static_cast<unsigned int>(std::stoul(match[1])),
                static_cast<unsigned int>(std::stoul(match[2]))}] = match[3];
    return result;
  }
} // namespace Viscoplastic
