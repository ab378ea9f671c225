// SPDX-License-Identifier: LGPL-2.1-or-later

// Names of boundaries and materials: their sources and their ids.

#include "folder.h"
#include "refusals.h"
#include <viscoplastic_contact/scene/output_places.h>
#include <viscoplastic_contact/scene/place_names.h>

#include <gtest/gtest.h>

namespace
{
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;



  struct NamedScene
  {
    explicit NamedScene(const std::string &more = "")
      : parameters({folder.add("scene.prm",
                               "subsection Boundary 3\nset Name = roof\nend\n"
                               "subsection Boundary 0\nend\n"
                               "subsection Material 1\nset Name = salt\nend\n"
                               "subsection Output\nset Points = "
                               "crown = 0, 2.5; 1, 1; floor = 0, -2.5\n"
                               "set Lines = wall = 0, 0 : 1, 0 : 3\nend\n" +
                                 more)})
      , names(parameters)
    {}

    Folder           folder;
    const Parameters parameters;
    const PlaceNames names;
  };



  TEST(PlaceNames, OfEntries)
  {
    const NamedScene  scene;
    const PlaceNames &names = scene.names;
    EXPECT_EQ(names.of("boundary", 3), "roof");
    EXPECT_EQ(names.of("boundary", 0), "boundary 0");
    EXPECT_EQ(names.of("material", 1), "salt");
    EXPECT_EQ(names.of("point", 0), "crown");
    EXPECT_EQ(names.of("point", 1), "point 1");
    EXPECT_EQ(names.of("point", 2), "floor");
    EXPECT_EQ(names.of("line", 0), "wall");
    EXPECT_EQ(names.find("floor")->number, 2u);
    EXPECT_EQ(names.find("boundary 7")->number, 7u);
    EXPECT_FALSE(names.find("attic"));

    const auto points = read_output_points<2>(scene.parameters.output.points);
    EXPECT_EQ(points[2], Point<2>(0., -2.5));
    const auto lines = read_output_lines<2>(scene.parameters.output.lines);
    EXPECT_EQ(lines[0].end, Point<2>(1., 0.));
    const auto integrals =
      read_output_integrals("roof: contact pressure; salt: energies", names);
    EXPECT_EQ(integrals[0].name(), "boundary_3");
    EXPECT_EQ(integrals[1].name(), "material_1");
  }



  TEST(PlaceNames, OfColumns)
  {
    const NamedScene  scene;
    const PlaceNames &names = scene.names;
    EXPECT_EQ(names.column("reaction_y of roof"), "reaction_3_y");
    EXPECT_EQ(names.column("reaction_x of boundary 0"), "reaction_0_x");
    EXPECT_EQ(names.column("displacement_y of floor"), "point2_y");
    EXPECT_EQ(names.column("friction_force_x"), "friction_force_x");
    EXPECT_EQ(names.column("friction_force_x of roof"), "friction_force_3_x");
    EXPECT_EQ(names.column("contact_force_y of roof"), "contact_force_3_y");
    expect_refusal([&] { names.column("reaction_y of rof"); },
                   "there is no boundary 'rof'; did you mean 'roof'?");
    expect_refusal([&] { names.column("reaction_y of crown"); },
                   "there is no boundary 'crown'");
    for (const std::string column :
         {"reaction_3_y", "point2_x", "reaction_0_x", "friction_force_x"})
      EXPECT_EQ(names.column(names.quantity(column)), column);
    EXPECT_EQ(names.quantity("point2_x"), "displacement_x of floor");
    EXPECT_EQ(names.words("reaction_3"), "reaction of roof");
    EXPECT_EQ(names.words("reaction_0"), "reaction of boundary 0");
    EXPECT_EQ(names.words("reaction_point0"), "reaction at point0");
    EXPECT_EQ(names.words("point0"), "displacement of crown");
    EXPECT_EQ(names.words("point1_stress_xx"), "stress xx at point 1");
    EXPECT_EQ(names.words("contact_force_3"), "contact force on roof");
    EXPECT_EQ(names.words("contact_force"), "contact force");
    EXPECT_EQ(names.words("slip_area"), "slipping area");
    EXPECT_EQ(names.words("max_pressure"), "largest pressure");
    EXPECT_EQ(names.words("stored_energy"), "stored energy");
  }



  TEST(PlaceNames, RefusesWhatCannotBeTold)
  {
    const auto refuses = [](const std::string &name, const std::string &why) {
      expect_refusal(
        [&] {
          NamedScene("subsection Boundary 1\nset Name = " + name + "\nend\n");
        },
        why);
    };
    refuses("salt", "which boundary 1 is called already");
    refuses("2nd roof", "begins with a digit");
    refuses("roof, left", "has one of the characters");
    refuses("point 4", "is what a place without a name is called");
    refuses(std::string(41, 'a'), "is too long");
  }



  // Names of physical groups of Gmsh: names in the scene take precedence, and
  // numbers as names are ignored.
  TEST(PlaceNames, OfAMeshFile)
  {
    const std::string mesh =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n"
      "1 0 \"open side\"\n1 3 \"top\"\n1 5 \"9\"\n2 1 \"rock\"\n"
      "2 4 \"pad\"\n$EndPhysicalNames\n$Nodes\n";
    Folder     folder;
    const auto names_of = [&](const std::string &text,
                              const std::string &geometry = "") {
      return NamedScene("subsection Geometry\nset File = " +
                        folder.add("body.msh", text) + "\n" + geometry +
                        "end\nsubsection Material 4\nend\n")
        .names;
    };
    const PlaceNames names = names_of(mesh);
    EXPECT_EQ(names.of("boundary", 0), "open side");
    EXPECT_EQ(names.of("boundary", 3), "roof");
    EXPECT_EQ(names.of("boundary", 5), "boundary 5");
    EXPECT_EQ(names.of("material", 1), "salt");
    EXPECT_EQ(names.of("material", 4), "pad");
    expect_refusal(
      [&] {
        NamedScene(
          "subsection Geometry\nset File = " + folder.add("body.msh", mesh) +
          "\nend\nsubsection Boundary 7\nset Name = pad\nend\n");
      },
      "calls boundary 7 'pad', as");
    // Names of a file do not apply to ids that the scene redefines.
    const PlaceNames others = names_of(mesh, "set Boundary ids = id + 1\n");
    EXPECT_FALSE(others.has("boundary", 0));
    EXPECT_TRUE(others.has("material", 4));
    EXPECT_FALSE(names_of("# another format\n" + mesh).has("boundary", 0));
  }
} // namespace
