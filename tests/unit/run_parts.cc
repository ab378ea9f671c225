// SPDX-License-Identifier: LGPL-2.1-or-later

// Parts of a run: when its mesh changes, when it writes checkpoints, and that a
// checkpoint restores everything. On any number of ranks.

#include "folder.h"
#include "stepping_body.h"
#include <viscoplastic_contact/checkpoint/checkpoint_schedule.h>
#include <viscoplastic_contact/checkpoint/run_archive.h>
#include <viscoplastic_contact/error/mesh_controller.h>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;



  TEST(CheckpointSchedule, CountsStepsAndSeconds)
  {
    CheckpointParameters wanted;
    EXPECT_FALSE(CheckpointSchedule(wanted).is_regular());
    EXPECT_FALSE(CheckpointSchedule(wanted).after_step(1, true, 1e9).is_due);

    wanted.every_n_steps = 3;
    CheckpointSchedule by_steps(wanted);
    EXPECT_TRUE(by_steps.is_regular());
    for (const unsigned int n : {1, 2, 3, 4, 6})
      EXPECT_EQ(by_steps.after_step(n, false, n).is_due, n % 3 == 0) << n;
    EXPECT_TRUE(by_steps.after_step(7, /* is_last_step = */ true, 7.).is_due);

    wanted                    = {};
    wanted.wall_time_interval = 10.;
    CheckpointSchedule by_time(wanted);
    EXPECT_FALSE(by_time.after_step(1, false, 9.).is_due);
    EXPECT_TRUE(by_time.after_step(2, false, 10.).is_due);
    by_time.restart_clock(11.);
    EXPECT_FALSE(by_time.after_step(3, false, 20.).is_due);
    EXPECT_TRUE(by_time.after_step(4, false, 21.).is_due);
  }



  TEST(CheckpointSchedule, EndsBeforeAStepThatWouldBeTooLong)
  {
    CheckpointParameters wanted;
    wanted.wall_time_limit = 100.;
    CheckpointSchedule schedule(wanted);
    schedule.begin_steps(20.);
    EXPECT_FALSE(schedule.after_step(1, false, 50.).is_late); // next end: 80
    EXPECT_FALSE(schedule.after_step(2, false, 74.).is_late); // 98
    EXPECT_TRUE(schedule.after_step(3, false, 88.).is_late);  // 102
    // A short last step does not change that.
    EXPECT_TRUE(schedule.after_step(4, false, 100.).is_late);
  }



  template <typename Dimension>
  class RunParts : public testing::Test
  {};
  TYPED_TEST_SUITE(RunParts, Dimensions);

  const std::string adaptive = subsection("Mesh refinement",
                                          "set Strategy = residual\n"
                                          "set Every n steps = 3\n"
                                          "set Cell budget = 100000"),
                    to_tolerance =
                      subsection("Error control", "set Tolerance = 0.1");



  /// Change the mesh as marked; return the numbers of cells before and after.
  template <int dim>
  std::pair<unsigned int, unsigned int>
  carry_out(parallel::distributed::Triangulation<dim> &triangulation)
  {
    const unsigned int before = triangulation.n_global_active_cells();
    triangulation.execute_coarsening_and_refinement();
    return {before, triangulation.n_global_active_cells()};
  }



  TYPED_TEST(RunParts, MeshChangesEverySoManySteps)
  {
    constexpr int     dim = TypeParam::value;
    SteppingBody<dim> body(maxwell + time("forward Euler", "1: 8") + adaptive);
    MeshController<dim> controller(body.scene, body.triangulation, nullptr);
    for (const unsigned int n : {0, 1, 3, 4, 6})
      EXPECT_EQ(controller.is_due(n), n > 0 && n % 3 == 0) << n;
    EXPECT_FALSE(controller.repeats_steps());
    body.advance(3);
    EXPECT_TRUE(controller.mark(*body.discretization, body.accepted, 0.));
    const auto [before, after] = carry_out(body.triangulation);
    EXPECT_GT(after, before);
  }



  TYPED_TEST(RunParts, EstimateOfRoundingChangesNoMesh)
  {
    constexpr int     dim = TypeParam::value;
    SteppingBody<dim> body(maxwell + time("forward Euler", "1: 8") + adaptive);
    MeshController<dim> controller(body.scene, body.triangulation, nullptr);
    body.advance(3);
    body.accepted.space_estimate.total *= 1e-14;
    body.accepted.space_estimate.squared_indicators *= 1e-28;
    EXPECT_FALSE(controller.mark(*body.discretization, body.accepted, 0.));
  }



  TYPED_TEST(RunParts, StepsAreRepeatedOnlyWhereTheMeshIsTooCoarse)
  {
    constexpr int     dim = TypeParam::value;
    SteppingBody<dim> body(maxwell + time("forward Euler", "1: 8") + adaptive +
                           to_tolerance);
    body.advance(3);
    const EvaluatedState<dim> &end  = body.accepted;
    const double               size = end.errors.energy_norm;
    for (const double tolerance : {1e4, 1e-4})
      {
        SCOPED_TRACE(tolerance);
        ErrorBudget budget(tolerance, dim, 1);
        budget.expect_size(size);
        MeshController<dim> controller(body.scene, body.triangulation, &budget);
        EXPECT_TRUE(controller.repeats_steps());
        EXPECT_TRUE(controller.is_due(1));
        const bool is_too_coarse = tolerance < 1.;
        EXPECT_EQ(
          controller.mark_for_step(*body.discretization, end, end, size),
          is_too_coarse);
        EXPECT_EQ(controller.excess() > 1., is_too_coarse);
        // The mesh is not due for coarsening between tries of a step.
        EXPECT_EQ(controller.is_due(1), !is_too_coarse);
        controller.accept_step();
        EXPECT_TRUE(controller.is_due(1));
        // The first mesh, by its equilibrium and by its initial data.
        EXPECT_EQ(controller.mark_first(*body.discretization, end, nullptr),
                  is_too_coarse);
        EvaluatedState<dim> initial;
        initial.errors.initial = 0.1 * size;
        EXPECT_EQ(controller.mark_first(*body.discretization,
                                        initial,
                                        &end.space_estimate.squared_indicators),
                  is_too_coarse);
        for (const auto &cell : body.triangulation.active_cell_iterators())
          {
            cell->clear_refine_flag();
            cell->clear_coarsen_flag();
          }
      }
  }



  TYPED_TEST(RunParts, MeshesAreNotRefinedInVain)
  {
    constexpr int     dim = TypeParam::value;
    SteppingBody<dim> body(maxwell + time("forward Euler", "1: 8") + adaptive +
                           to_tolerance);
    body.advance(3);
    const double size = body.accepted.errors.energy_norm;
    ErrorBudget  budget(1e-4, dim, 1);
    budget.expect_size(size);
    MeshController<dim> controller(body.scene, body.triangulation, &budget);
    const auto          refines = [&] {
      const bool result = controller.mark_for_step(*body.discretization,
                                                   body.accepted,
                                                   body.accepted,
                                                   size);
      for (const auto &cell : body.triangulation.active_cell_iterators())
        {
          cell->clear_refine_flag();
          cell->clear_coarsen_flag();
        }
      return result;
    };
    // Refinement goes on as long as the error decreases.
    const double error = body.accepted.errors.space;
    for (unsigned int i = 0; i < 6; ++i, body.accepted.errors.space *= 0.9)
      EXPECT_TRUE(refines()) << i;
    EXPECT_EQ(budget.unavoidable, 0.);
    controller.accept_step();
    // An error that does not decrease is accepted, also in later steps.
    body.accepted.errors.space = error;
    for (unsigned int i = 0; i < 3; ++i)
      EXPECT_TRUE(refines()) << i;
    for (unsigned int step = 0; step < 2; ++step, controller.accept_step())
      EXPECT_FALSE(refines()) << step;
    EXPECT_EQ(budget.unavoidable, body.accepted.errors.of_meshes());
    body.accepted.errors.space *= 2.;
    EXPECT_TRUE(refines());
  }



  /// A body with all that a run writes to checkpoints.
  template <int dim>
  struct Archived : SteppingBody<dim>
  {
    explicit Archived(const std::string &more)
      : SteppingBody<dim>(more)
      , recorder(this->scene, *this->control, console, this->timer, nullptr)
      , run{this->scene,
            this->accepted,
            *this->control,
            nullptr,
            pass,
            recorder}
    {}

    Console       console{MPI_COMM_WORLD, /* quiet = */ true};
    PassState     pass;
    Recorder<dim> recorder;
    RunState<dim> run;
  };



  TYPED_TEST(RunParts, ArchiveBringsBackTheState)
  {
    constexpr int     dim  = TypeParam::value;
    const std::string text = maxwell + time("Heun", "1: 8");
    Archived<dim>     first(text);
    first.advance(4);
    const Folder          folder; // the one of rank 0 is used
    const CheckpointStore store(
      Utilities::MPI::broadcast(MPI_COMM_WORLD, folder.path.string()) +
        "/checkpoint",
      MPI_COMM_WORLD);
    store.make_directory();
    const PackedRun packed = pack_run(first.run,
                                      first.triangulation,
                                      *first.discretization,
                                      *first.stepper,
                                      {0., 0.25});
    EXPECT_EQ(packed.manifest.n, 4u);
    store.write(packed.manifest, packed.files, 1);

    std::vector<std::string> remarks;
    const auto               checkpoint = store.newest(remarks);
    ASSERT_TRUE(checkpoint);
    Archived<dim>   second(text);
    RunArchive<dim> archive(store,
                            *checkpoint,
                            second.run,
                            second.triangulation);
    EXPECT_TRUE(archive.changes.allowed.empty());
    EXPECT_EQ(archive.data.output_times, (std::vector<double>{0., 0.25}));
    archive.read_fields(*second.discretization);
    const EvaluatedState<dim> &a = first.accepted, &b = second.accepted;
    EXPECT_EQ(a.state.n, b.state.n);
    EXPECT_EQ(a.state.t, b.state.t);
    EXPECT_EQ(a.state.z, b.state.z);
    EXPECT_EQ(a.state.time_error, b.state.time_error);
    EXPECT_EQ(a.state.contact.multiplier, b.state.contact.multiplier);
    EXPECT_EQ(a.errors.total(), b.errors.total());
    for (std::size_t i = 0; i < a.state.u.locally_owned_size(); ++i)
      EXPECT_EQ(a.state.u.begin()[i], b.state.u.begin()[i]);
    EXPECT_TRUE(b.is_solution);

    // A checkpoint of another scene is refused.
    Archived<dim> other(maxwell + time("Heun", "1: 3"));
    EXPECT_THROW(
      RunArchive<dim>(store, *checkpoint, other.run, other.triangulation),
      ExcMessage);
  }
} // namespace
