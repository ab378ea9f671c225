// SPDX-License-Identifier: LGPL-2.1-or-later

// Meshes: from generators and files, ids by expression, refinement at
// boundaries, normals of pieces, and what is refused. On any number of ranks.

#include "body.h"
#include "refusals.h"
#include <viscoplastic_contact/mesh.h>
#include <viscoplastic_contact/mesh_file.h>
#include <viscoplastic_contact/mesh_ids.h>
#include <viscoplastic_contact/mesh_pieces.h>

#include <sys/resource.h>

using namespace Viscoplastic;
using namespace Viscoplastic::Testing;

namespace
{
  template <int dim>
  using Mesh = parallel::distributed::Triangulation<dim>;

  const std::string directory =
    std::string(VISCOPLASTIC_SOURCE_DIR) + "/prm/verification/meshes/";

  /// The files with two materials: the same mesh in all formats.
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



  /// A file with that text, on each rank its own, for the time of the object.
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



  std::string
  replaced(std::string text, const std::string &what, const std::string &by)
  {
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), by);
  }



  template <int dim>
  std::unique_ptr<Mesh<dim>>
  make(const GeometryParameters &geometry)
  {
    auto mesh = std::make_unique<Mesh<dim>>(MPI_COMM_WORLD);
    make_mesh(geometry, *mesh);
    return mesh;
  }



  GeometryParameters
  from_file(const std::string &file)
  {
    GeometryParameters geometry;
    geometry.file = file;
    return geometry;
  }



  GeometryParameters
  generated(const std::string &arguments,
            const std::string &generator = "subdivided_hyper_rectangle")
  {
    GeometryParameters geometry;
    geometry.generator = generator;
    geometry.arguments = arguments;
    return geometry;
  }



  /// Measures by id, of the faces at the boundary or of the cells.
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



  void
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



  /// A mesh file with that text is refused with the end of the sentence.
  void
  expect_text_refused(const std::string &text,
                      const std::string &suffix,
                      const std::string &reason)
  {
    const TemporaryFile file(text, suffix);
    expect_mesh_refused<2>(from_file(file.name),
                           "The mesh file '" + file.name + "' cannot be read");
    expect_mesh_refused<2>(from_file(file.name), reason);
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
  // 4 was at x = 0 and is at y = 0 now.
  EXPECT_NEAR(piece_normal(*mesh, 4).normal[1], -1., 1e-14);
  EXPECT_EQ(mesh->n_global_levels(), 4u);
  // Hanging nodes on boundary 1, whose faces have several sizes.
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



TEST(MeshIds, ByExpression)
{
  GeometryParameters geometry = generated("4, 2 : 0, 0 : 2, 1 : true");
  geometry.boundary_ids       = "if(id == 2 && x > 1, 12, id)";
  geometry.material_ids       = "if(x < 0.5, 7, id + 1)";
  geometry.global_refinements = 1;
  const auto mesh             = make<2>(geometry);
  expect_measures(areas(*mesh), {{0, 1.}, {1, 1.}, {2, 1.}, {12, 1.}, {3, 2.}});
  // The generator colours cells by quadrant: x, y > 0 is 3.
  expect_measures(volumes(*mesh), {{7, 0.5}, {4, 1.5}});
  EXPECT_EQ(boundary_ids(*mesh),
            (std::set<types::boundary_id>{0, 1, 2, 3, 12}));
  EXPECT_EQ(material_ids(*mesh), (std::set<types::material_id>{4, 7}));
}



TEST(MeshIds, AreThoseOfThePlaceBeforeItMoves)
{
  GeometryParameters geometry = generated("2, 1 : 0, 0 : 2, 1 : true");
  geometry.material_ids       = "x > 1";
  geometry.translation        = "100, 0";
  expect_measures(volumes(*make<2>(geometry)), {{0, 1.}, {1, 1.}});
}



TEST(MeshIds, OnCurvedFacesUsePointsOfTheCurve)
{
  GeometryParameters geometry =
    generated("0, 0 : 0.5 : 1 : 8 : true", "hyper_shell");
  geometry.boundary_ids = "if(x^2 + y^2 > 0.99, 5, 6)";
  EXPECT_EQ(boundary_ids(*make<2>(geometry)),
            (std::set<types::boundary_id>{5, 6}));
}



TEST(MeshIds, Refused)
{
  const GeometryParameters box = generated("4, 2 : 0, 0 : 2, 1 : true");
  const auto refused = [&](const std::string &ids, const std::string &why) {
    GeometryParameters geometry = box;
    geometry.boundary_ids       = ids;
    expect_mesh_refused<2>(geometry, "'Geometry/Boundary ids");
    expect_mesh_refused<2>(geometry, why);
  };
  refused("id +", "cannot be parsed: Unexpected end of expression");
  refused("t", "cannot be parsed: Unexpected token \"t\"");
  refused("0.5", "gives 0.5 at (");
  refused("-1", "ids are whole numbers from 0 to 999999999");
  refused("1e9", "ids are whole numbers");
  refused("1/(x-x)", "gives inf");
  refused("if(x < 0.75, 1, 2)",
          "gives 2 and 1 in the face with the centre (0.75 0); an id may "
          "change only between faces of the coarse mesh");
  GeometryParameters geometry = box;
  geometry.material_ids       = "x > 0.7";
  expect_mesh_refused<2>(geometry, "in the cell with the centre (0.75 0.25)");
}



TEST(BoundaryRefinements, RefineWhatTouches)
{
  GeometryParameters geometry   = generated("4, 4 : 0, 0 : 1, 1 : true");
  geometry.boundary_refinements = "2: 1";
  // The lowest row; a further pass takes the eight lowest of these.
  EXPECT_EQ(make<2>(geometry)->n_global_active_cells(), 16u + 3 * 4);
  geometry.boundary_refinements = " 2 : 2 ";
  EXPECT_EQ(make<2>(geometry)->n_global_active_cells(), 16u + 3 * 4 + 3 * 8);
  // Cells that touch a piece in a vertex: five of the lower row.
  geometry                      = generated("8, 8 : 0, 0 : 1, 1 : true");
  geometry.boundary_ids         = "if(y == 0 && x < 0.5, 9, id)";
  geometry.boundary_refinements = "9: 1";
  EXPECT_EQ(make<2>(geometry)->n_global_active_cells(), 64u + 3 * 5);
}



TEST(BoundaryRefinements, Refused)
{
  const auto refused = [](const std::string &text, const std::string &why) {
    GeometryParameters geometry   = generated("4, 4 : 0, 0 : 1, 1 : true");
    geometry.boundary_refinements = text;
    expect_mesh_refused<2>(geometry,
                           "'Geometry/Boundary refinements' = " + text);
    expect_mesh_refused<2>(geometry, why);
  };
  refused("2", "consists of `boundary id: times'");
  refused("2: -1", "but has '2: -1'");
  refused("2: 1; 3: 1", "but has '2: 1; 3: 1'");
  refused("7: 1",
          "names the boundary id 7, but the mesh has the ids 0, 1, 2, 3");
  refused("2: 1, 2: 2", "names the boundary id 2 twice");
  GeometryParameters geometry   = generated("4, 4 : 0, 0 : 1, 1 : true");
  geometry.boundary_refinements = "2: 90";
  expect_mesh_refused<2>(geometry, "18 are possible");
  geometry                    = generated("4, 4 : 0, 0 : 1, 1 : true");
  geometry.global_refinements = 15;
  expect_mesh_refused<2>(geometry, "more than can be numbered");
  // 5.4e8 unknowns, but 9.7e9 entries
  geometry.global_refinements = 12;
  expect_mesh_refused<2>(geometry, "; take at least 5.");
}



TEST(PieceNormals, OfFlatPieces)
{
  GeometryParameters geometry   = generated("2, 1 : 0, 0 : 2, 1 : true");
  geometry.global_refinements   = 2;
  geometry.boundary_refinements = "2: 1";
  for (const double angle : {0., 90., 30.})
    {
      geometry.rotation_angle    = angle;
      const auto           mesh  = make<2>(geometry);
      const PieceNormal<2> piece = piece_normal(*mesh, 2);
      const double         a     = (angle - 90.) * numbers::PI / 180.;
      EXPECT_NEAR(piece.normal[0], std::cos(a), 1e-14);
      EXPECT_NEAR(piece.normal[1], std::sin(a), 1e-14);
      EXPECT_LT(piece.deviation, 1e-12);
      // exactly along axes
      if (angle != 30.)
        {
          EXPECT_EQ(piece.normal.norm(), 1.);
        }
    }
}



TEST(PieceNormals, OfCurvedPieces)
{
  // The sides of an octagon, of 45 degrees each, around a quarter circle.
  GeometryParameters geometry =
    generated("0, 0 : 0.5 : 1 : 2 : true", "quarter_hyper_shell");
  const auto   coarse = make<2>(geometry);
  const double first  = piece_normal(*coarse, 1).deviation;
  EXPECT_NEAR(first, 22.5, 1e-10);
  EXPECT_NEAR(piece_normal(*coarse, 1).normal[0], std::sqrt(0.5), 1e-14);
  geometry.boundary_refinements = "1: 2";
  EXPECT_NEAR(piece_normal(*make<2>(geometry), 1).deviation,
              45. - 45. / 8,
              1e-10);
  // All around: no mean.
  geometry = generated("0, 0 : 0.5 : 1 : 8 : true", "hyper_shell");
  EXPECT_EQ(piece_normal(*make<2>(geometry), 0).deviation, 180.);
}



TEST(PieceNormals, ResolveTinyAngles)
{
  // A step of 1e-9 in the middle of the lower side: an arc cosine of the
  // normals gives zero.
  const TemporaryFile file(
    "6 4 0 0 0\n1 0 0 0\n2 1 -1e-9 0\n3 2 0 0\n4 2 1 0\n5 1 1 0\n6 0 1 0\n"
    "1 0 quad 1 2 5 6\n2 0 quad 2 3 4 5\n3 7 line 1 2\n4 7 line 2 3\n",
    ".ucd");
  const auto mesh = make<2>(from_file(file.name));
  EXPECT_NEAR(piece_normal(*mesh, 7).deviation * numbers::PI / 180.,
              1e-9,
              1e-14);
}



TEST(MeshChecks, InvertedAndDegenerateCells)
{
  const auto quadrilateral = [](const std::string &third) {
    return "4 1 0 0 0\n1 0 0 0\n2 1 0 0\n3 " + third +
           " 0\n4 0 1 0\n1 0 quad 1 2 3 4\n";
  };
  const auto refused = [&](const std::string &third) {
    const TemporaryFile file(quadrilateral(third), ".ucd");
    expect_mesh_refused<2>(from_file(file.name), "is inverted or degenerate");
  };
  refused("0.4 0.4"); // not convex
  refused("0.5 0.5"); // a triangle
  refused("1 0");     // two corners at one place
  refused("1e300 1e300");
  // Clockwise is no defect, nor is a slender cell.
  for (const std::string &text :
       {quadrilateral("1 1"),
        replaced(quadrilateral("1 1"), "1 2 3 4", "4 3 2 1"),
        replaced(quadrilateral("1 1e-5"), "4 0 1", "4 0 1e-5")})
    {
      const TemporaryFile file(text, ".ucd");
      EXPECT_EQ(make<2>(from_file(file.name))->n_global_active_cells(), 1u);
    }
}



TEST(MeshChecks, BodyInParts)
{
  // Two squares that meet in nodes that are there twice.
  const TemporaryFile file("8 2 0 0 0\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n"
                           "5 1 0 0\n6 2 0 0\n7 2 1 0\n8 1 1 0\n"
                           "1 0 quad 1 2 3 4\n2 0 quad 5 6 7 8\n",
                           ".ucd");
  expect_mesh_refused<2>(from_file(file.name),
                         "The mesh consists of 2 parts that share no faces, "
                         "e.g. the cells with the centres (0.5 0.5) and (1.5 "
                         "0.5) are not connected");
}



TEST(MeshChecks, Generators)
{
  expect_mesh_refused<2>(generated("1", "hyper_doughnut"),
                         "The mesh generator 'hyper_doughnut' refuses the "
                         "arguments '1': ");
  expect_mesh_refused<2>(generated("8 : 0"), "refuses the arguments");
  // which deal.II would take for 4294967294
  expect_mesh_refused<2>(generated("-2, 2 : 0, 0 : 1, 1 : true"),
                         "'Geometry/Arguments' = -2, 2 : 0, 0 : 1, 1 : true "
                         "asks for -2, 2 cells; possible are 1 to 10000000");
  GeometryParameters geometry =
    generated("0, 0 : 0.5 : 1 : 8 : true", "hyper_shell");
  geometry.translation = "1, 0";
  expect_mesh_refused<2>(geometry, "'hyper_shell' has curved ones");
  geometry             = generated("2, 2 : 0, 0 : 1, 1 : true");
  geometry.translation = "1, 0, 0";
  expect_mesh_refused<2>(geometry, "'Geometry/Translation' = 1, 0, 0 needs 2");
}



TEST(MeshChecks, CellsOfBoxes)
{
  // deal.II would take these for lists of step sizes, or not look
  const auto refused = [](const std::string &cells, const std::string &why) {
    const std::string  rest = " : 0, 0 : 2, 1 : true";
    GeometryParameters box  = generated(cells + rest);
    box.generator           = "subdivided_hyper_rectangle";
    expect_mesh_refused<2>(box,
                           "'Geometry/Arguments' = " + cells + rest + ": '" +
                             cells + "' has to be " + why);
  };
  const std::string counts = "2 whole numbers of cells separated by commas, or "
                             "2 lists of step sizes";
  refused("1e3, 1", counts);
  refused("3.5, 1", counts);
  refused("8", counts);
  refused("8, 8, 8", counts);
  refused("none", counts);
  const std::string sizes = "lists of positive step sizes that add up";
  refused("1, 1; 0.5", sizes);
  refused("1, 1; 0.5, -0.5, 1", sizes);
  refused("1, 1; 1; 1", "2 lists of step sizes");
  const auto mesh =
    make<2>(generated("0.5, 1.5; 0.25, 0.25, 0.5 : 0, 0 : 2, 1 : true"));
  EXPECT_EQ(mesh->n_global_active_cells(), 6u);
}



TEST(MeshChecks, NumbersOfCellsOfGenerators)
{
  // Beyond the limits deal.II would ask for all the memory, or for as many
  // cells as an unsigned -1.
  const auto refused = [](const std::string &generator,
                          const std::string &arguments,
                          const std::string &n_cells) {
    const std::string sentence = "'Geometry/Arguments' = " + arguments +
                                 " asks for " + n_cells +
                                 " cells; possible are 1 to 10000000";
    expect_mesh_refused<2>(generated(arguments, generator), sentence);
    expect_mesh_refused<3>(generated(arguments, generator), sentence);
  };
  refused("hyper_shell", "0, 0 : 0.5 : 1 : -8 : true", "-8");
  refused("eccentric_hyper_shell", "0, 0 : 0, 0 : 1 : 2 : 3e7", "3e+07");
  refused("cylinder_shell", "1 : 0.5 : 1 : -3 : 4", "-3, 4");
  refused("cylinder_shell", "1 : 0.5 : 1 : 10000 : 2000", "2e+07");
  refused("concentric_hyper_shells",
          "0, 0 : 1 : 2 : 10000 : 0.1 : 2000 : true",
          "2e+07");
  refused("hyper_cross", "20000000, 0, 0, 0 : true", "2e+07");
  refused("hyper_cross", "-1, 0, 0, 0 : true", "-1, 0, 0, 0");
  refused("subdivided_hyper_rectangle",
          "5000, 5000 : 0, 0 : 1, 1 : true",
          "2.5e+07");
  // A power of the dimension.
  expect_mesh_refused<2>(generated("100000 : 0 : 1 : true",
                                   "subdivided_hyper_cube"),
                         "asks for 1e+10 cells");
  expect_mesh_refused<3>(generated("1000 : 0 : 1 : true",
                                   "subdivided_hyper_cube"),
                         "asks for 1e+09 cells");

  // What is large is a radius; and arms of a cross may have no cells.
  EXPECT_EQ(make<2>(
              generated("0, 0 : 0, 0 : 1e7 : 2e7 : 8", "eccentric_hyper_shell"))
              ->n_global_active_cells(),
            8u);
  EXPECT_EQ(make<2>(generated("2, 0, 1, 0 : false", "hyper_cross"))
              ->n_global_active_cells(),
            4u);
}



TEST(MeshChecks, WithoutEnoughMemory)
{
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "AddressSanitizer needs more addresses than it uses";
#endif
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  // In pages: what we have, then what is resident.
  std::ifstream statm("/proc/self/statm");
  rlim_t        n_pages = 0;
  if (!(statm >> n_pages))
    GTEST_SKIP() << "no /proc";
  rlimit limit   = before;
  limit.rlim_cur = n_pages * sysconf(_SC_PAGESIZE) + (rlim_t(100) << 20);
  ASSERT_EQ(setrlimit(RLIMIT_AS, &limit), 0);
  const std::string message = message_of(
    [] { make<2>(generated("3000 : 0 : 1 : true", "subdivided_hyper_cube")); });
  ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
  // Seen before anything is allocated, and cells themselves would not do.
  EXPECT_NE(message.find(
              "would make about 9e+06 cells and 1.8e+07 unknowns, "
              "whose mesh alone takes 7 GB of memory, and there are "),
            std::string::npos)
    << message;
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
                         "cannot be told from its name; set 'Geometry/File "
                         "format' to msh, ucd, vtk or abaqus.");
  GeometryParameters geometry = from_file(other.name);
  geometry.file_format        = "msh";
  EXPECT_EQ(make<2>(geometry)->n_global_active_cells(), 8u);
  geometry.file_format = "vtk";
  expect_mesh_refused<2>(geometry,
                         "as vtk: line 1: expected #, found '$MeshFormat'.");
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
                      "line 5: this element is a triangle; only quadrilaterals "
                      "and hexahedra with nodes at their corners are "
                      "supported (in Gmsh, set Mesh.RecombineAll = 1");
  expect_text_refused("*NODE\n1, 0, 0\n2, 1, 0\n3, 0, 1\n"
                      "*ELEMENT, TYPE=CPE3\n1, 1, 2, 3\n",
                      ".inp",
                      "line 6: this element is a CPE3; only");
  expect_text_refused(replaced(content(two_materials<2>()[0]),
                               "\n1 1 2 1 1 1 4\n",
                               "\n1 8 2 1 1 1 4 7\n"),
                      ".msh",
                      "this element is a line of second order; only");
}



TEST(MeshFilesRefused, WithNumbersBeyondMeasure)
{
  const std::string ucd = content(two_materials<2>()[2]);
  // strtol turns the first two into the ends of its range.
  for (const std::string number :
       {"-99999999999999999999999", "99999999999999999999999", "1000000000001"})
    expect_text_refused(replaced(ucd, "\n1 0.0", "\n" + number + " 0.0"),
                        ".ucd",
                        "expected the number of a node, found '" + number);
}



TEST(MeshFilesRefused, ThatAreAxisymmetric)
{
  const std::string inp = content(two_materials<2>()[4]);
  expect_text_refused(replaced(inp, "CPE4", "CAX4R"),
                      ".inp",
                      "this element is a CAX4R, which is axisymmetric; bodies "
                      "in 2D are in plane strain");
}



TEST(MeshFilesRefused, WithSetsThatContainThemselves)
{
  const std::string inp  = content(two_materials<2>()[4]);
  std::string       line = "B";
  for (unsigned int i = 0; i < 30; ++i)
    line += ",B";
  std::string lines = "*ELSET, ELSET=B\n1\n";
  for (unsigned int i = 0; i < 8; ++i)
    lines += line + "\n";
  expect_text_refused(inp + lines, ".inp", "the set 'B' contains itself");
}



TEST(MeshFilesRefused, ThatContradictThemselves)
{
  const auto        files = two_materials<2>();
  const std::string msh = content(files[0]), msh4 = content(files[1]),
                    ucd = content(files[2]), vtk = content(files[3]),
                    inp = content(files[4]);
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
  expect_text_refused(replaced(ucd, "quad 1 4 5 2", "quad 1 4 5 99"),
                      ".ucd",
                      "there is no node 99");
  expect_text_refused(replaced(ucd, "quad 1 4 5 2", "quad 1 4 5 5"),
                      ".ucd",
                      "a cell has a node twice");
  expect_text_refused(replaced(ucd, "quad 1 4 5 2", "quad 2 5 6 3"),
                      ".ucd",
                      "this cell is already in line");
  expect_text_refused(replaced(ucd, "line 1 4", "line 1 5"),
                      ".ucd",
                      "line 18: this boundary element is not a face of any "
                      "cell");
  expect_text_refused(replaced(ucd, "2 1 line 4 7", "2 3 line 1 4"),
                      ".ucd",
                      "line 19: this boundary element is already in line 18");
  expect_text_refused(replaced(ucd, "1 1 line", "1 -1 line"),
                      ".ucd",
                      "the id -1 is not between 0 and 999999999");
  expect_text_refused(replaced(vtk, "ASCII", "BINARY"), ".vtk", "it is binary");
  expect_text_refused(replaced(vtk, "4 0 3 4 1", "4 0 3 4 77"),
                      ".vtk",
                      "there is no node 77");
  expect_text_refused(replaced(vtk, "4 0 3 4 1", "3 0 3 4"),
                      ".vtk",
                      "a quadrilateral cannot have 3 nodes");
  expect_text_refused(replaced(inp, "1, S4", "1, S7"),
                      ".inp",
                      "expected elements and one of their faces S1, S2");
  expect_text_refused(replaced(inp, "1, S4", "1, S5"),
                      ".inp",
                      "a cell has no face 5");
  expect_text_refused(replaced(inp, "\n1, 2, 3, 4\n", "\n1, 2, 3, 400\n"),
                      ".inp",
                      "there is no element 400");
}



TEST(MeshFilesRefused, ThatEndTooEarly)
{
  // Wherever a file is cut, it is refused with a sentence or is a mesh.
  for (const std::string &name : two_materials<2>())
    {
      const std::string text   = content(name);
      const std::string suffix = std::filesystem::path(name).extension();
      for (std::size_t size = 1; size < text.size(); size += 13)
        {
          const TemporaryFile file(text.substr(0, size), suffix);
          const std::string   message =
            message_of([&] { make<2>(from_file(file.name)); });
          // ABAQUS files are complete before their surfaces.
          EXPECT_TRUE(
            message.find("The mesh") != std::string::npos ||
            (message.empty() && (size > text.size() / 2 || suffix == ".inp")))
            << name << " cut at " << size << ": " << message;
        }
    }
}



TEST(MeshFilesOfOthers, Gmsh)
{
  // Version 4.0; and lines that are no boundary, but where materials meet.
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
  // As Gmsh writes boundaries, and ABAQUS ranges of elements.
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
  // Each has the one before twice; the first gets the last, too. Copies of
  // their elements would be 2^40.
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
