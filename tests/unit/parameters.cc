// SPDX-License-Identifier: LGPL-2.1-or-later

// Expressions, time steps and boundary roles, and the messages that refuse
// wrong ones. Tests of parameter files are in parameter_files.cc.

#include "body.h"
#include "refusals.h"
#include <viscoplastic_contact/mesh/mesh.h>
#include <viscoplastic_contact/parameters/time_schedule.h>

#include <cmath>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  // ------------------------------------------------------------ time steps

  TEST(TimeSchedule, PhasesOfEqualSteps)
  {
    const TimeSchedule schedule("1: 4, 1.5 : 1,  3: 3");
    EXPECT_EQ(schedule.n_steps(), 8u);
    EXPECT_EQ(schedule.end_time(), 3.);
    const std::vector<double> times{0., 0.25, 0.5, 0.75, 1., 1.5, 2., 2.5, 3.};
    for (unsigned int n = 1; n <= 8; ++n)
      {
        const TimeStep step = schedule.step(n);
        EXPECT_EQ(step.n, n);
        EXPECT_DOUBLE_EQ(step.t_old, times[n - 1]);
        EXPECT_DOUBLE_EQ(step.t, times[n]);
        EXPECT_EQ(step.k, step.t - step.t_old);
      }
  }



  TEST(TimeSchedule, EndsExactlyOnTheListedTimes)
  {
    const TimeSchedule schedule("0.1: 3, 0.7: 7, 1e4: 11");
    EXPECT_EQ(schedule.step(3).t, 0.1);
    EXPECT_EQ(schedule.step(4).t_old, 0.1);
    EXPECT_EQ(schedule.step(10).t, 0.7);
    EXPECT_EQ(schedule.step(21).t, 1e4);
    for (unsigned int n = 2; n <= 21; ++n)
      EXPECT_EQ(schedule.step(n).t_old, schedule.step(n - 1).t);
  }



  TEST(TimeSchedule, RefusesWhatIsNoPartition)
  {
    for (const std::string text : {"1",
                                   "1: 0",
                                   "1: -3",
                                   "1: 2.5",
                                   "one: 2",
                                   "1: 2: 3",
                                   ": 4",
                                   "1: 2,, 2: 3"})
      expect_refusal([&] { TimeSchedule schedule(text); }, "'Time/Phases'");
    expect_refusal([] { TimeSchedule schedule("1: 2, 1: 3"); },
                   "the end time of '1: 3' must be finite and lie after 1.");
    expect_refusal([] { TimeSchedule schedule("1e-9: 2, 1e-9: 3"); },
                   "lie after 1e-09.");
    expect_refusal([] { TimeSchedule schedule("1: 2, 0.5: 3"); },
                   "must be finite and lie after");
    expect_refusal([] { TimeSchedule schedule("1e40: 2"); },
                   "the end time of '1e40: 2' is 1e+40; it must lie between "
                   "1e-30 and 1e+30");
    expect_refusal([] { TimeSchedule schedule("1e-30: 2"); },
                   "the time step of '1e-30: 2' is 5e-31");
    expect_refusal([] { TimeSchedule schedule("-1: 2"); },
                   "must be finite and lie after");
    for (const std::string text : {"inf: 2", "nan: 2"})
      EXPECT_NE(message_of([&] { TimeSchedule schedule(text); }), "");
    expect_refusal([] { TimeSchedule schedule(""); }, "'Time/Phases'");
    expect_refusal([] { TimeSchedule schedule("1: 1000000000, 2: 1"); },
                   "'Time/Phases' has more than 1e9 steps up to '2: 1'");
  }



  TEST(TimeSchedule, LargestStep)
  {
    const TimeStep in_the_middle =
      TimeSchedule("1: 4, 1.5: 1, 3: 6").largest_step();
    EXPECT_EQ(in_the_middle.n, 5u);
    EXPECT_EQ(in_the_middle.t, 1.5);
    EXPECT_EQ(in_the_middle.k, 0.5);
    // The first of equal steps counts; the search does not visit all steps.
    EXPECT_EQ(TimeSchedule("2: 1, 4: 1, 5: 2").largest_step().n, 1u);
    const TimeStep last =
      TimeSchedule("1: 999999998, 2: 1, 4: 1").largest_step();
    EXPECT_EQ(last.n, 1000000000u);
    EXPECT_EQ(last.k, 2.);
  }



  // ------------------------------------------------------------ expressions

  TEST(Expression, ValuesOfPlaceAndTime)
  {
    const Expression<2> f("2*x - y^2 + t*sin(pi/2)", "f");
    EXPECT_DOUBLE_EQ(f.value(Point<2>(3., 2.), 0.5), 2.5);
    EXPECT_TRUE(f.depends_on_time());
    EXPECT_TRUE(f.depends_on_position());
    EXPECT_FALSE(f.is_zero());
    const Expression<3> g("if(z > 1, x, y)", "g");
    EXPECT_DOUBLE_EQ(g.value(Point<3>(3., 2., 1.5), 0.), 3.);
    EXPECT_DOUBLE_EQ(g.value(Point<3>(3., 2., 0.5), 0.), 2.);
    EXPECT_FALSE(g.depends_on_time());
  }



  TEST(Expression, KnowsWhatItDoesNotDependOn)
  {
    // Names of functions contain the letters of variables.
    const Expression<2> constant("max(1, exp(0)) + sqrt(4) - int(0.2)", "f");
    EXPECT_FALSE(constant.depends_on_time());
    EXPECT_FALSE(constant.depends_on_position());
    EXPECT_DOUBLE_EQ(constant.value(Point<2>(1., 2.), 3.), 3.);
    EXPECT_TRUE(Expression<2>("1 - 1", "f").is_zero());
    EXPECT_TRUE(Expression<2>(" 0 ", "f").is_zero());
    EXPECT_FALSE(Expression<2>("0*t", "f").is_zero());
    EXPECT_TRUE(Expression<2>("2*t", "f").depends_on_time());
    EXPECT_TRUE(Expression<2>("2*(t)", "f").depends_on_time());
    EXPECT_TRUE(Expression<2>("x*1", "f").depends_on_position());
    EXPECT_TRUE(Expression<2>("1e3*y", "f").depends_on_position());
    EXPECT_TRUE(Expression<3>("z/2", "f").depends_on_position());
  }



  TEST(Expression, Gradient)
  {
    const Expression<3> f("x*y + sin(z) + t*x", "f");
    const Point<3>      x(1., 2., 3.);
    const Tensor<1, 3>  gradient = f.gradient(x, 0.5);
    EXPECT_NEAR(gradient[0], 2.5, 1e-9);
    EXPECT_NEAR(gradient[1], 1., 1e-9);
    EXPECT_NEAR(gradient[2], std::cos(3.), 1e-9);
    EXPECT_EQ(Expression<2>("3*t", "f").gradient(Point<2>(), 1.).norm(), 0.);
  }



  TEST(Expression, RefusalsNameEntryAndPlace)
  {
    for (const std::string text : {"2*", "foo(x)", "2 x", "w + 1", "x +* y"})
      expect_refusal([&] { Expression<2> f(text, "Loads/Body force"); },
                     "The expression '" + text +
                       "' of 'Loads/Body force' cannot be parsed");
    // There is no z in 2D.
    expect_refusal([] { Expression<2> f("1 + z", "here"); },
                   "cannot be parsed: there is no 'z'; its variables are x, y "
                   "and t, and pi and functions such as sin, exp, min and if "
                   "are known.");
    expect_refusal([] { Expression<2> f("foo(x)", "here"); },
                   "there is no 'foo'");
    // Known names in a wrong place are not called unknown.
    expect_refusal([] { Expression<2> f("x x", "here"); },
                   "cannot be parsed: Unexpected");
    expect_refusal([] { Expression<2> f("  ", "here"); },
                   "The expression of 'here' is empty.");
    const Expression<2> f("log(x) + t", "Boundary 2/Friction bound");
    expect_refusal([&] { f.value(Point<2>(0., 1.), 0.5); },
                   "'Boundary 2/Friction bound' has the value -inf at "
                   "x = (0 1), t = 0.5; it must be finite.");
    expect_refusal([] { Expression<2>("sqrt(-1)", "here").value({}, 0.); },
                   "it must be finite");
  }



  TEST(Expression, NumberOfComponents)
  {
    const VectorExpression<2> f("t; x; 3", 3, "f");
    EXPECT_EQ(f.value(Point<2>(5., 6.), 2., 0), 2.);
    EXPECT_EQ(f.value(Point<2>(5., 6.), 2., 1), 5.);
    EXPECT_EQ(f.value(Point<2>(5., 6.), 2., 2), 3.);
    EXPECT_TRUE(f.depends_on_time());
    EXPECT_FALSE(f.is_zero());
    EXPECT_TRUE((VectorExpression<2>("0; 0", 2, "f").is_zero()));
    for (const std::string text : {"1", "1; 2; 3", "1, 2"})
      expect_refusal([&] { VectorExpression<2> g(text, 2, "Body force"); },
                     "'Body force' needs 2 components separated by semicolons, "
                     "but '" +
                       text + "' has");
  }



  // ------------------------------------------------------------ boundaries

  template <int dim>
  void
  inspect(const std::string &text)
  {
    const auto parameters =
      read_parameters("set Dimension = " + std::to_string(dim) + "\n" + text);
    Scene<dim>                                scene(*parameters);
    parallel::distributed::Triangulation<dim> triangulation(MPI_COMM_WORLD);
    make_mesh(scene.parameters.geometry, triangulation);
    scene.inspect(triangulation);
  }



  std::string
  all_free_but(const unsigned int id, const std::string &entries)
  {
    std::string text;
    for (unsigned int i = 0; i < 4; ++i)
      text += boundary(i, i == id ? entries : "set Role = free");
    return text;
  }



  TEST(Boundary, IdsAreComparedWithTheMesh)
  {
    expect_refusal(
      [] {
        inspect<2>(box<2>(1) + boundary(0, "set Role = free") +
                   boundary(1, "set Role = free") +
                   boundary(3, "set Role = free"));
      },
      "Boundary id 2 of the mesh has no role; add `subsection Boundary 2' with "
      "a role (free, if it carries no load). The mesh has the ids 0, 1, 2, 3.");
    expect_refusal(
      [] {
        inspect<2>(box<2>(1) + all_free_but(0, "set Role = clamped") +
                   boundary(4, "set Role = free"));
      },
      "'Boundary 4' has a role, but the mesh has no such boundary id; it has "
      "the ids 0, 1, 2, 3.");
    expect_refusal(
      [] { inspect<2>(box<2>(1) + all_free_but(1, "")); },
      "'Boundary 1/Role' is missing; it must be clamped, displacement, "
      "traction, free, symmetry or contact.");
    EXPECT_EQ(message_of([] {
                inspect<2>(box<2>(1) + all_free_but(0, "set Role = clamped"));
              }),
              "");
  }



  TEST(Boundary, ContactAndSymmetryNeedFlatPieces)
  {
    for (const std::string role : {"contact", "symmetry"})
      expect_refusal(
        [&role] {
          inspect<2>(
            geometry("hyper_ball", "0, 0 : 1 : false") +
            boundary(0, "set Role = " + role + "\nset Friction law = none"));
        },
        "Boundary 0 has the role " + role + " but is not flat");
    // A single id around a corner is not flat either.
    expect_refusal(
      [] {
        inspect<2>(geometry("hyper_cube", "0 : 1 : false") +
                   boundary(0, "set Role = symmetry"));
      },
      "is not flat");
  }



  TEST(Boundary, NormalsOfRotatedPieces)
  {
    const auto parameters = read_parameters(
      box<2>(2, oblique<2>()) +
      all_free_but(2, "set Role = contact\nset Friction law = none"));
    Scene<2>                                scene(*parameters);
    parallel::distributed::Triangulation<2> triangulation(MPI_COMM_WORLD);
    make_mesh(scene.parameters.geometry, triangulation);
    scene.inspect(triangulation);
    // The normal is (0, -1) rotated by 30 degrees.
    EXPECT_NEAR(scene.boundary.at(2).normal[0], 0.5, 1e-14);
    EXPECT_NEAR(scene.boundary.at(2).normal[1], -std::sqrt(0.75), 1e-14);
  }



  TEST(Boundary, FrictionBounds)
  {
    BoundaryParameters entries;
    entries.role                      = BoundaryRole::contact;
    entries.entries["Friction law"]   = "tresca";
    entries.entries["Friction bound"] = "0.5 - x + t";
    const BoundaryCondition<2> tresca(2, entries);
    EXPECT_TRUE(tresca.is_bilateral());
    EXPECT_TRUE(tresca.has_friction());
    EXPECT_TRUE(tresca.bound_depends_on_time());
    EXPECT_DOUBLE_EQ(tresca.bound(Point<2>(0.25, 0.), 1.), 1.25);
    expect_refusal([&] { tresca.bound(Point<2>(2., 0.), 1.); },
                   "'Boundary 2/Friction bound' is -0.5 at x = (2 0), t = 1; "
                   "it must not be negative.");

    // The bound is mu |S|: S may have any sign, mu may not.
    entries.entries["Friction law"]         = "coulomb";
    entries.entries["Friction coefficient"] = "0.5 - x";
    entries.entries["Normal stress"]        = "-3";
    const BoundaryCondition<2> coulomb(3, entries);
    EXPECT_FALSE(coulomb.is_bilateral());
    EXPECT_FALSE(coulomb.bound_depends_on_time());
    EXPECT_DOUBLE_EQ(coulomb.bound(Point<2>(0.25, 0.), 1.), 0.75);
    expect_refusal([&] { coulomb.bound(Point<2>(1., 0.), 0.); },
                   "'Boundary 3/Friction coefficient' is -0.5");
    entries.entries["Normal stress"] = "3*t";
    const BoundaryCondition<2> tension(3, entries);
    EXPECT_DOUBLE_EQ(tension.bound(Point<2>(0.25, 0.), 2.), 1.5);
    EXPECT_TRUE(tension.bound_depends_on_time());
  }



  TEST(Boundary, ComponentsThatStayFree)
  {
    BoundaryParameters entries;
    entries.role                    = BoundaryRole::displacement;
    entries.entries["Displacement"] = "free; -0.1*t";
    const BoundaryCondition<2> condition(1, entries);
    EXPECT_FALSE(condition.displacement[0].has_value());
    ASSERT_TRUE(condition.displacement[1].has_value());
    EXPECT_DOUBLE_EQ(condition.displacement[1]->value({}, 2.), -0.2);
    EXPECT_TRUE(condition.constrains());
    entries.entries["Displacement"] = "0";
    expect_refusal([&] { BoundaryCondition<2> c(1, entries); },
                   "'Boundary 1/Displacement' needs 2 components separated by "
                   "semicolons");
  }
} // namespace
