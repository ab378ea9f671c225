// SPDX-License-Identifier: LGPL-2.1-or-later

// Mesh files: the same meshes in all formats, files of other programs, and
// files that are refused. The tests run on any number of ranks.

#include "meshes.h"
#include <viscoplastic_contact/mesh/files/read_mesh_file.h>
#include <viscoplastic_contact/mesh/mesh_ids.h>

using namespace Viscoplastic;
using namespace Viscoplastic::Testing;

namespace
{
  const std::string directory =
    std::string(VISCOPLASTIC_SOURCE_DIR) + "/prm/verification/meshes/";

  /// The files of a mesh with two materials in all formats.
  template <int dim>
  std::vector<std::string>
  two_materials()
  {
    const std::string name = dim == 2 ? "two_materials" : "two_materials_3d";
    std::vector<std::string> files;
    for (const char *end : {"_2.msh", "_4.msh", ".ucd", ".vtk", ".inp"})
      files.push_back(directory + name + end);
    return files;
  }



  std::string
  content(const std::string &file)
  {
    std::ifstream     input(file);
    std::stringstream text;
    text << input.rdbuf();
    EXPECT_FALSE(text.str().empty()) << file;
    return text.str();
  }



  /// Expect that a mesh file is refused by a sentence that ends in @p reason.
  void
  expect_text_refused(const std::string &text,
                      const std::string &suffix,
                      const std::string &reason)
  {
    const TemporaryFile file(text, suffix);
    const std::string   message =
      message_of([&] { make<2>(from_file(file.name)); });
    EXPECT_NE(message.find("The mesh file '" + file.name + "' cannot be read"),
              std::string::npos)
      << message;
    EXPECT_NE(message.find(reason), std::string::npos) << message;
  }
} // namespace



template <typename Dim>
struct MeshFiles : public testing::Test
{};
TYPED_TEST_SUITE(MeshFiles, Dimensions, );



TYPED_TEST(MeshFiles, HaveTheSameIdsInAllFormats)
{
  constexpr int dim = TypeParam::value;
  for (const std::string &file : two_materials<dim>())
    {
      SCOPED_TRACE(file);
      const auto mesh = make<dim>(from_file(file));
      expect_measures(volumes(*mesh), {{10, 1.}, {20, 1.}});
      std::map<unsigned int, double> expected{{1, 2.},
                                              {2, 1.},
                                              {3, 2.},
                                              {4, 1.}};
      if (dim == 3)
        expected.insert({{5, 2.}, {6, 2.}});
      expect_measures(areas(*mesh), expected);
      EXPECT_DOUBLE_EQ(piece_normal(*mesh, 1).normal[1], -1.);
      EXPECT_DOUBLE_EQ(piece_normal(*mesh, 2).normal[0], 1.);
      for (const auto &cell : mesh->active_cell_iterators())
        {
          if (cell->is_locally_owned())
            {
              EXPECT_EQ(cell->material_id(),
                        cell->center()[0] < 1. ? 10u : 20u);
            }
        }
    }
}



TYPED_TEST(MeshFiles, AreRefinedAndMovedAsOthers)
{
  constexpr int      dim        = TypeParam::value;
  GeometryParameters geometry   = from_file(two_materials<dim>()[1]);
  geometry.rotation_angle       = 90.;
  geometry.translation          = dim == 2 ? "3, 0" : "3, 0, 0";
  geometry.global_refinements   = 1;
  geometry.boundary_refinements = "4: 2, 2: 1";
  const auto mesh               = make<dim>(geometry);
  expect_measures(volumes(*mesh), {{10, 1.}, {20, 1.}});
  EXPECT_NEAR(areas(*mesh)[4], 1., 1e-12);
  EXPECT_NEAR(areas(*mesh)[3], 2., 1e-12);
  // Boundary 4 has moved from x = 0 to y = 0.
  EXPECT_NEAR(piece_normal(*mesh, 4).normal[1], -1., 1e-14);
  EXPECT_EQ(mesh->n_global_levels(), 4u);
  // Boundary 1 has hanging nodes, so that its faces have several sizes.
  double smallest = 1., largest = 0.;
  for (const auto &cell : mesh->active_cell_iterators())
    if (cell->is_locally_owned())
      for (const unsigned int f : cell->face_indices())
        if (cell->at_boundary(f) && cell->face(f)->boundary_id() == 1)
          {
            smallest = std::min(smallest, cell->face(f)->diameter());
            largest  = std::max(largest, cell->face(f)->diameter());
          }
  smallest = Utilities::MPI::min(smallest, MPI_COMM_WORLD);
  largest  = Utilities::MPI::max(largest, MPI_COMM_WORLD);
  EXPECT_NEAR(largest / smallest, 4., 1e-10);
}



TEST(MeshFilesRefused, WhereThereIsNoFile)
{
  const std::string none = directory + "absent.msh";
  expect_mesh_refused<2>(from_file(none),
                         "The mesh file '" + none + "' does not exist.");
  expect_mesh_refused<2>(from_file(directory), "is a directory.");
  expect_mesh_refused<2>(from_file("/dev/zero"), "is not a regular file.");
  const TemporaryFile empty("\n \n", ".msh");
  expect_mesh_refused<2>(from_file(empty.name), "is empty.");
  const TemporaryFile other(content(two_materials<2>()[0]), ".grid");
  expect_mesh_refused<2>(from_file(other.name),
                         "cannot be told from its name; rename it, for example "
                         "mesh.msh, mesh.ucd, mesh.vtk or mesh.inp.");
  const TemporaryFile renamed(content(two_materials<2>()[0]), ".MSH");
  EXPECT_EQ(make<2>(from_file(renamed.name))->n_global_active_cells(), 8u);
  const TemporaryFile wrong(content(two_materials<2>()[0]), ".vtk");
  expect_mesh_refused<2>(from_file(wrong.name),
                         "cannot be read as vtk: meshio refuses it ('Illegal "
                         "VTK header')");
}



TEST(MeshFilesRefused, OfAnotherDimension)
{
  for (const std::string &file : two_materials<3>())
    expect_mesh_refused<2>(from_file(file), "'Dimension' is 2");
  for (const std::string &file : two_materials<2>())
    expect_mesh_refused<3>(from_file(file),
                           "it has no hexahedra but quadrilaterals, and "
                           "'Dimension' is 3");
  expect_text_refused(replaced(content(two_materials<2>()[2]),
                               "2 0.0 0.5 0.0",
                               "2 0.0 0.5 0.1"),
                      ".ucd",
                      "not in a plane z = const.");
}



TEST(MeshFilesRefused, WithOtherCells)
{
  expect_text_refused("3 1 0 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n1 0 tri 1 2 3\n",
                      ".ucd",
                      "as what contrib/convert_mesh makes of it: line 12: this "
                      "element is a triangle; only quadrilaterals and "
                      "hexahedra with nodes at their corners are supported (in "
                      "Gmsh, set Mesh.RecombineAll = 1");
  expect_text_refused(replaced(content(two_materials<2>()[0]),
                               "\n1 1 2 1 1 1 4\n",
                               "\n1 8 2 1 1 1 4 7\n"),
                      ".msh",
                      "this element is a line of second order, with nodes "
                      "between its corners; make the mesh of first order (in "
                      "Gmsh, set Mesh.ElementOrder = 1)");
  for (const std::string suffix : {".stl", ".STL"})
    expect_text_refused("solid part\nendsolid part\n",
                        suffix,
                        "it is a surface of triangles (STL), but the body has "
                        "to be filled with quadrilaterals (2D) or hexahedra "
                        "(3D)");
  expect_text_refused("ISO-10303-21;\n",
                      ".step",
                      "it is a geometry without a mesh (STEP)");
}



TEST(MeshFilesRefused, WithNumbersBeyondMeasure)
{
  const std::string msh = content(two_materials<2>()[0]);
  // strtol clips the first two numbers to the ends of its range.
  for (const std::string number :
       {"-99999999999999999999999", "99999999999999999999999", "1000000000001"})
    expect_text_refused(replaced(msh, "\n1 0.0", "\n" + number + " 0.0"),
                        ".msh",
                        "expected the number of a node, found '" + number);
}



TEST(MeshFilesRefused, ThatContradictThemselves)
{
  const auto        files = two_materials<2>();
  const std::string msh = content(files[0]), msh4 = content(files[1]);
  expect_text_refused(replaced(msh, "2.2 0 8", "2.2 1 8"),
                      ".msh",
                      "line 2: it is binary");
  expect_text_refused(replaced(msh, "2.2 0 8", "1.0 0 8"),
                      ".msh",
                      "line 2: versions 2, 4.0 and 4.1 are supported");
  expect_text_refused(replaced(msh, "$Nodes\n15\n", "$Nodes\n4000000000\n"),
                      ".msh",
                      "line 5: the number of nodes is 4000000000, which the "
                      "rest of the file cannot hold");
  expect_text_refused(replaced(msh, "$Nodes\n15\n", "$Nodes\n14\n"),
                      ".msh",
                      "expected $EndNodes, found '15'");
  expect_text_refused(replaced(msh, "0.5", "nan"),
                      ".msh",
                      "expected a coordinate, found 'nan'");
  expect_text_refused(replaced(msh, "\n2 0.0", "\n1 0.0"),
                      ".msh",
                      "line 7: the node 1 is there twice");
  expect_text_refused(replaced(msh4, " 1 1 0\n", " 2 1 2 0\n"),
                      ".msh",
                      "is in 2 physical groups; it can have one id only");
  expect_text_refused(replaced(msh, " 1 4 5 2\n", " 1 4 5 99\n"),
                      ".msh",
                      "line 36: there is no node 99");
  expect_text_refused(replaced(msh, " 1 4 5 2\n", " 1 4 5 5\n"),
                      ".msh",
                      "line 36: a cell has a node twice");
  expect_text_refused(replaced(msh, " 1 4 5 2\n", " 2 5 6 3\n"),
                      ".msh",
                      "line 37: this cell is already in line 36");
  expect_text_refused(replaced(msh, " 1 1 1 4\n", " 1 1 1 5\n"),
                      ".msh",
                      "line 24: this boundary element is not a face of any "
                      "cell");
  expect_text_refused(replaced(msh, " 1 1 4 7\n", " 1 1 1 4\n"),
                      ".msh",
                      "line 25: this boundary element is already in line 24");
  expect_text_refused(replaced(msh, " 1 1 1 4\n", " 1000000000 1 1 4\n"),
                      ".msh",
                      "the id 1000000000 is not between 0 and 999999999");
  // This error is found after the conversion of the file.
  expect_text_refused(replaced(content(files[2]), "line 1 4", "line 1 5"),
                      ".ucd",
                      "cannot be read as what contrib/convert_mesh makes of "
                      "it: line 24: this boundary element is not a face of any "
                      "cell");
}



TEST(MeshFilesRefused, ThatEndTooEarly)
{
  // A truncated file is refused by a sentence or is a mesh; test_meshes.py
  // truncates files that are converted.
  for (const std::string &name : two_materials<2>())
    {
      if (std::filesystem::path(name).extension() != ".msh")
        continue;
      const std::string text   = content(name);
      const std::string suffix = std::filesystem::path(name).extension();
      for (std::size_t size = 1; size < text.size(); size += 13)
        {
          const TemporaryFile file(text.substr(0, size), suffix);
          const std::string   message =
            message_of([&] { make<2>(from_file(file.name)); });
          EXPECT_TRUE(message.find("The mesh") != std::string::npos ||
                      (message.empty() && size > text.size() / 2))
            << name << " cut at " << size << ": " << message;
        }
    }
}



TEST(MeshFilesOfOthers, Gmsh)
{
  // Format 4.0, with lines between materials, which are no boundary.
  const TemporaryFile file("$MeshFormat\n4 0 8\n$EndMeshFormat\n"
                           "$Comments\nquad and line\n$EndComments\n"
                           "$Entities\n0 2 1 0\n"
                           "1 0 0 0 1 0 0 1 4 0\n2 1 0 0 1 1 0 1 5 0\n"
                           "1 0 0 0 2 1 0 1 9 0\n$EndEntities\n"
                           "$Nodes\n1 6\n1 2 1 6\n"
                           "1 0 0 0 0 0\n2 1 0 0 0 0\n3 2 0 0 0 0\n"
                           "4 2 1 0 0 0\n5 1 1 0 0 0\n6 0 1 0 0 0\n$EndNodes\n"
                           "$Elements\n3 4\n1 1 1 1\n1 1 2\n2 1 1 1\n2 2 5\n"
                           "1 2 3 2\n3 1 2 5 6\n4 2 3 4 5\n$EndElements\n",
                           ".msh");
  const auto          mesh = make<2>(from_file(file.name));
  expect_measures(areas(*mesh), {{0, 5.}, {4, 1.}});
  expect_measures(volumes(*mesh), {{9, 2.}});
}



TEST(MeshFilesOfOthers, AbaqusWithLinesAndRanges)
{
  // Boundaries as Gmsh writes them, and ranges of elements as ABAQUS does.
  const TemporaryFile file(
    "*Heading\n*Part, name=body\n*Node\n1, 0., 0.\n2, 1., 0.\n3, 2., 0.\n"
    "4, 2., 1.\n5, 1., 1.\n6, 0., 1.\n*Element, type=CPE4R\n"
    "11, 1, 2, 5, 6\n12, 2, 3,\n4, 5\n"
    "*Element, type=T3D2, elset=Line1\n13, 1, 2\n14, 2, 3\n"
    "*Elset, elset=\"floor 8\"\n14\n"
    "*Elset, elset=all, generate\n11, 12, 1\n"
    "*Solid Section, elset=all, material=Steel-3\n,\n*End Part\n"
    "*Assembly, name=whole\n*Instance, name=one, part=body\n*End Instance\n"
    "*Node\n1, 5., 5., 0.\n"
    "*Elset, elset=_end_S2, internal, instance=one\n12\n"
    "*Surface, type=ELEMENT, name=end-4\n_end_S2, S2\n*End Assembly\n",
    ".inp");
  const auto mesh = make<2>(from_file(file.name));
  expect_measures(areas(*mesh), {{0, 3.}, {1, 1.}, {4, 1.}, {8, 1.}});
  expect_measures(volumes(*mesh), {{3, 2.}});
}



TEST(MeshFilesOfOthers, AbaqusWithSetsOfSets)
{
  // Each set contains its predecessor twice, and the first the last one.
  // Copying elements would make 2^40 of them.
  std::string text =
    "*NODE\n1, 0, 0\n2, 1, 0\n3, 2, 0\n4, 2, 1\n5, 1, 1\n6, 0, 1\n"
    "*ELEMENT, TYPE=CPS4\n11, 1, 2, 5, 6\n12, 2, 3, 4, 5\n"
    "*ELSET, ELSET=S100\n12\n";
  for (unsigned int i = 101; i <= 140; ++i)
    {
      const std::string before = "S" + std::to_string(i - 1);
      text += "*ELSET, ELSET=S" + std::to_string(i) + "\n" + before + ", " +
              before + "\n";
    }
  text += "*ELSET, ELSET=S100\nS140\n";
  const TemporaryFile file(text, ".inp");
  expect_measures(volumes(*make<2>(from_file(file.name))),
                  {{0, 1.}, {100, 1.}});
}



TEST(MeshFilesOfOthers, VtkOfVersion5)
{
  const TemporaryFile file(
    "# vtk DataFile Version 5.1\n\nASCII\nDATASET UNSTRUCTURED_GRID\n"
    "POINTS 6 double\n0 0 0 1 0 0 2 0 0\n0 1 0 1 1 0 2 1 0\n"
    "METADATA\nINFORMATION 0\n\n"
    "CELLS 4 10\nOFFSETS vtktypeint64\n0 2 6 10\nCONNECTIVITY vtktypeint64\n"
    "0 1 0 1 3 4 1 2 5 4\nCELL_TYPES 3\n3\n8\n9\n"
    "CELL_DATA 3\nSCALARS density double\nLOOKUP_TABLE default\n1. 2. 3.\n"
    "FIELD FieldData 2\ngmsh:physical 1 3 vtktypeint32\n4 5 6\n"
    "gmsh:geometrical 1 3 vtktypeint32\n7 8 9\n",
    ".vtk");
  const auto mesh = make<2>(from_file(file.name));
  expect_measures(areas(*mesh), {{0, 5.}, {4, 1.}});
  expect_measures(volumes(*mesh), {{5, 1.}, {6, 1.}});
}
