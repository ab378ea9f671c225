// SPDX-License-Identifier: LGPL-2.1-or-later

// Meshes: ids by expression, refinement at boundaries, normals of pieces, and
// generators and bodies that are refused. The tests run on any number of ranks.

#include "meshes.h"
#include "refusals.h"
#include <viscoplastic_contact/mesh/mesh_check.h>
#include <viscoplastic_contact/mesh/mesh_ids.h>

#include <sys/resource.h>

using namespace Viscoplastic;
using namespace Viscoplastic::Testing;

TEST(MeshIds, ByExpression)
{
  GeometryParameters geometry = generated("4, 2 : 0, 0 : 2, 1 : true");
  geometry.boundary_ids       = "if(id == 2 && x > 1, 12, id)";
  geometry.material_ids       = "if(x < 0.5, 7, id + 1)";
  geometry.global_refinements = 1;
  const auto mesh             = make<2>(geometry);
  expect_measures(areas(*mesh), {{0, 1.}, {1, 1.}, {2, 1.}, {12, 1.}, {3, 2.}});
  // The generator colors cells by quadrant: x, y > 0 is 3.
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



/// A graded box has the boundaries and the volume of the box, cells of
/// different sizes, and ids by positions before the map.
TEST(MeshCoordinates, GradeAndMapTheCoarseMesh)
{
  GeometryParameters geometry = generated("4, 4 : 0, 0 : 1, 1 : true");
  geometry.coordinates        = "2*x; y^2";
  geometry.material_ids       = "y > 0.5";
  geometry.global_refinements = 1;
  geometry.translation        = "0, 5";
  const auto mesh             = make<2>(geometry);
  expect_measures(areas(*mesh), {{0, 1.}, {1, 1.}, {2, 2.}, {3, 2.}});
  expect_measures(volumes(*mesh), {{0, 0.5}, {1, 1.5}});
  double lowest = 1.;
  for (const auto &cell : mesh->active_cell_iterators())
    if (cell->is_locally_owned())
      lowest = std::min(lowest, cell->extent_in_direction(1));
  EXPECT_NEAR(Utilities::MPI::min(lowest, MPI_COMM_WORLD), 1. / 32., 1e-14);

  geometry             = generated("2, 2, 2 : 0, 0, 0 : 1, 1, 1 : true");
  geometry.coordinates = "x + 0.5*z; y; 3*z";
  // The generator colors cells by octant.
  expect_measures(volumes(*make<3>(geometry)), {{7, 3.}});
}



TEST(MeshCoordinates, Refused)
{
  const auto refused = [](const std::string &text, const std::string &why) {
    GeometryParameters geometry = generated("4, 4 : 0, 0 : 1, 1 : true");
    geometry.coordinates        = text;
    expect_mesh_refused<2>(geometry, why);
  };
  refused("x", "'Geometry/Coordinates' needs 2 components");
  refused("x; y + t", "the mesh does not change with time");
  refused("x; q", "there is no 'q'");
  refused("1/x; y", "has the value inf");
  GeometryParameters shell =
    generated("0, 0 : 0.5 : 1 : 8 : true", "hyper_shell");
  shell.coordinates = "x; 2*y";
  expect_mesh_refused<2>(shell, "meshes with straight edges only");
  // The map folds the body onto itself.
  GeometryParameters folded = generated("4, 4 : -1, 0 : 1, 1 : true");
  folded.coordinates        = "x^2; y";
  EXPECT_NE(message_of([&] { make<2>(folded); }), "");
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
  refused("t", "there is no 't'; its variables are x, y and id,");
  refused("0.5", "gives 0.5 at (");
  refused("-1", "ids are whole numbers from 0 to 999999999");
  refused("1e9", "ids are whole numbers");
  refused("1/(x-x)", "gives inf");
  refused("if(x < 0.75, 1, 2)",
          "gives 2 and 1 in the face with the center (0.75 0); an id may "
          "change only between faces of the coarse mesh");
  GeometryParameters geometry = box;
  geometry.material_ids       = "x > 0.7";
  expect_mesh_refused<2>(geometry, "in the cell with the center (0.75 0.25)");
}



TEST(BoundaryRefinements, RefineWhatTouches)
{
  GeometryParameters geometry   = generated("4, 4 : 0, 0 : 1, 1 : true");
  geometry.boundary_refinements = "2: 1";
  // The first pass refines the lowest row, the second one its lowest cells.
  EXPECT_EQ(make<2>(geometry)->n_global_active_cells(), 16u + 3 * 4);
  geometry.boundary_refinements = " 2 : 2 ";
  EXPECT_EQ(make<2>(geometry)->n_global_active_cells(), 16u + 3 * 4 + 3 * 8);
  // Cells that touch a piece in a vertex count: five of the lowest row.
  geometry                      = generated("8, 8 : 0, 0 : 1, 1 : true");
  geometry.boundary_ids         = "if(y == 0 && x < 0.5, 9, id)";
  geometry.boundary_refinements = "9: 1";
  EXPECT_EQ(make<2>(geometry)->n_global_active_cells(), 64u + 3 * 5);
}



/// In deal.II's quarter of a ball, common lines have different orientations in
/// cells; p4est would refine other cells than deal.II and crash.
TEST(BoundaryRefinements, OfMeshesWithTurnedLines)
{
  GeometryParameters geometry;
  geometry.generator            = "quarter_hyper_ball";
  geometry.arguments            = "0, 0, 0 : 1";
  geometry.boundary_ids         = "if(id == 0 && x < z && y < z, 9, id)";
  geometry.global_refinements   = 1;
  geometry.boundary_refinements = "9: 3";
  const auto mesh               = make<3>(geometry);
  EXPECT_EQ(mesh->get_boundary_ids(),
            (std::vector<types::boundary_id>{0, 1, 9}));
  double volume = 0.;
  for (const auto &cell : mesh->active_cell_iterators())
    {
      for (const unsigned int l : cell->line_indices())
        EXPECT_TRUE(
          cell->is_artificial() ||
          cell->line(l)->vertex_index(0) ==
            cell->vertex_index(GeometryInfo<3>::line_to_cell_vertices(l, 0)));
      if (cell->is_locally_owned())
        volume += cell->measure();
    }
  // an eighth of the ball but for the error of its facets
  EXPECT_NEAR(Utilities::MPI::sum(volume, MPI_COMM_WORLD),
              numbers::PI / 6.,
              0.1 * numbers::PI / 6.);
  for (unsigned int round = 0; round < 3; ++round)
    {
      for (const auto &cell : mesh->active_cell_iterators())
        if (cell->is_locally_owned() && cell->at_boundary())
          for (const unsigned int v : cell->vertex_indices())
            if (std::abs(cell->vertex(v).norm() - 1.) < 1e-12 &&
                cell->vertex(v)[2] > 0.99)
              cell->set_refine_flag();
      DoFHandler<3> dof_handler(*mesh); // follows the change of cells
      mesh->execute_coarsening_and_refinement();
      EXPECT_EQ(mesh->n_global_active_cells() % 7, 4u);
    }
}



/// Cells of different sizes have the same common faces; when the sizes are
/// equal again, nodes are on the manifold.
template <int dim>
void
check_hanging_vertices(const std::string &shell)
{
  GeometryParameters geometry = generated(shell, "hyper_shell");
  geometry.global_refinements = 1;
  const auto   mesh           = make<dim>(geometry);
  unsigned int n_hanging      = 0;
  for (const double side : {1., -1.})
    {
      n_hanging = 0;
      for (const auto &cell : mesh->active_cell_iterators())
        if (cell->is_locally_owned() && side * cell->center()[0] > 0.)
          cell->set_refine_flag();
      mesh->execute_coarsening_and_refinement();
      for (const auto &cell : mesh->active_cell_iterators())
        if (!cell->is_artificial())
          {
            for (const unsigned int l : cell->line_indices())
              if (const auto line = cell->line(l); line->has_children())
                {
                  const Point<dim> middle = line->child(0)->vertex(1);
                  EXPECT_LT(middle.distance(line->center()), 1e-14);
                  ++n_hanging;
                }
            if constexpr (dim == 3)
              for (const unsigned int f : cell->face_indices())
                if (const auto face = cell->face(f); face->has_children())
                  {
                    const Point<3> middle = face->child(0)->vertex(3);
                    EXPECT_LT(middle.distance(face->center()), 1e-14);
                  }
          }
      n_hanging = Utilities::MPI::sum(n_hanging, MPI_COMM_WORLD);
      EXPECT_EQ(n_hanging > 0, side > 0.);
    }
  for (const auto &cell : mesh->active_cell_iterators())
    if (!cell->is_artificial())
      for (const unsigned int v : cell->vertex_indices())
        {
          const double quarters = 4. * cell->vertex(v).norm();
          EXPECT_NEAR(quarters, std::round(quarters), 1e-12);
        }
}



TEST(HangingVertices, OfCurvedMeshesStandOnCoarserCells)
{
  check_hanging_vertices<2>("0, 0 : 1 : 2 : 8 : true");
  check_hanging_vertices<3>("0, 0, 0 : 1 : 2 : 6 : true");
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
  // 5.4e8 unknowns can be numbered, but not 9.7e9 matrix entries
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
      // normals along axes are exact
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
  // A piece all around has no mean normal.
  geometry = generated("0, 0 : 0.5 : 1 : 8 : true", "hyper_shell");
  EXPECT_EQ(piece_normal(*make<2>(geometry), 0).deviation, 180.);
}



TEST(PieceNormals, ResolveTinyAngles)
{
  // The lower side has a kink of 1e-9 in its middle, for which the arc cosine
  // between normals is zero.
  const TemporaryFile file(
    msh("1 0 0 0\n2 1 -1e-9 0\n3 2 0 0\n4 2 1 0\n5 1 1 0\n6 0 1 0\n",
        "1 3 0 1 2 5 6\n2 3 0 2 3 4 5\n3 1 1 7 1 2\n4 1 1 7 2 3\n"),
    ".msh");
  const auto mesh = make<2>(from_file(file.name));
  EXPECT_NEAR(piece_normal(*mesh, 7).deviation * numbers::PI / 180.,
              1e-9,
              1e-14);
}



TEST(MeshChecks, InvertedAndDegenerateCells)
{
  const auto quadrilateral = [](const std::string &third) {
    return msh("1 0 0 0\n2 1 0 0\n3 " + third + " 0\n4 0 1 0\n",
               "1 3 0 1 2 3 4\n");
  };
  const auto refused = [&](const std::string &third) {
    const TemporaryFile file(quadrilateral(third), ".msh");
    expect_mesh_refused<2>(from_file(file.name), "is inverted or degenerate");
  };
  refused("0.4 0.4"); // not convex
  refused("0.5 0.5"); // a triangle
  refused("1 0");     // two corners at one place
  // Clockwise vertices and slender cells are accepted.
  for (const std::string &text :
       {quadrilateral("1 1"),
        replaced(quadrilateral("1 1"), "1 2 3 4", "4 3 2 1"),
        replaced(quadrilateral("1 1e-5"), "4 0 1", "4 0 1e-5")})
    {
      const TemporaryFile file(text, ".msh");
      EXPECT_EQ(make<2>(from_file(file.name))->n_global_active_cells(), 1u);
    }
}



TEST(MeshChecks, LengthsWhoseCubesVanish)
{
  GeometryParameters geometry;
  geometry.arguments = "1, 1 : 0, 0 : 1e-110, 1e-110 : true";
  expect_mesh_refused<2>(geometry,
                         "The size of the smallest cell is 1e-110; it must lie "
                         "between 1e-30 and 1e+30");
  geometry.arguments = "1, 1 : 0, 0 : 1, 1e300 : true";
  expect_mesh_refused<2>(geometry,
                         "The largest coordinate of the mesh is 1e+300");
}



TEST(MeshChecks, BodyInParts)
{
  // Two squares meet in duplicate nodes.
  const TemporaryFile file(msh("1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n"
                               "5 1 0 0\n6 2 0 0\n7 2 1 0\n8 1 1 0\n",
                               "1 3 0 1 2 3 4\n2 3 0 5 6 7 8\n"),
                           ".msh");
  parallel::distributed::Triangulation<2> mesh(MPI_COMM_WORLD);
  make_mesh(from_file(file.name), mesh);
  expect_refusal([&] { check_connection(mesh); },
                 "The mesh consists of 2 parts that share no faces, e.g. the "
                 "cells with the centers (0.5 0.5) and (1.5 0.5) are not "
                 "connected");
}



TEST(MeshChecks, Generators)
{
  expect_mesh_refused<2>(generated("1", "hyper_doughnut"),
                         "The mesh generator 'hyper_doughnut' refuses the "
                         "arguments '1': ");
  expect_mesh_refused<2>(generated("8 : 0"), "refuses the arguments");
  // deal.II would take -2 for 4294967294
  expect_mesh_refused<2>(generated("-2, 2 : 0, 0 : 1, 1 : true"),
                         "'Geometry/Arguments' = -2, 2 : 0, 0 : 1, 1 : true "
                         "asks for -2, 2 cells; possible are 1 to 10000000");
  GeometryParameters geometry =
    generated("0, 0 : 0.5 : 1 : 8 : true", "hyper_shell");
  geometry.translation = "1, 0";
  expect_mesh_refused<2>(geometry, "'hyper_shell' has curved ones");
  geometry             = generated("2, 2 : 0, 0 : 1, 1 : true");
  geometry.translation = "1, 0, 0";
  expect_mesh_refused<2>(geometry,
                         "'Geometry/Translation' is '1, 0, 0', but it needs 2");
}



TEST(MeshChecks, CellsOfBoxes)
{
  // deal.II would take these for lists of step sizes, or not check them
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
  // Beyond the limits deal.II would exhaust the memory, or make as many cells
  // as an unsigned -1.
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
  // The number of cells is a power with the exponent dim.
  expect_mesh_refused<2>(generated("100000 : 0 : 1 : true",
                                   "subdivided_hyper_cube"),
                         "asks for 1e+10 cells");
  expect_mesh_refused<3>(generated("1000 : 0 : 1 : true",
                                   "subdivided_hyper_cube"),
                         "asks for 1e+09 cells");

  // Radii may be large, and arms of a cross may have no cells.
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
  // The first number is the size of the address space in pages.
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
  // The refusal comes before anything is allocated, by the memory of cells
  // alone. Each of several ranks has all coarse cells.
  const unsigned int n_ranks = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
  const double n_bytes = 9e6 * (760. + (n_ranks > 1 ? n_ranks * 650. : 0.));
  EXPECT_NE(message.find("would make about 9e+06 cells and 1.8e+07 unknowns, "
                         "whose mesh alone takes " +
                         std::to_string(int(std::ceil(n_bytes / 1e9))) +
                         " GB of memory, and there are "),
            std::string::npos)
    << message;
}
