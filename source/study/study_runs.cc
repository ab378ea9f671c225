// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/grid/grid_tools.h>

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/mesh/mesh.h>
#include <viscoplastic_contact/run/viscoplastic_contact.h>
#include <viscoplastic_contact/study/study_runs.h>

#include <boost/crc.hpp>
#include <malloc.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

namespace Viscoplastic
{
  namespace
  {
    const std::string generator_with_subdivisions =
      "subdivided_hyper_rectangle";



    /// Do something on rank 0; all ranks learn whether it worked.
    void
    on_first_rank(const MPI_Comm               communicator,
                  const std::function<void()> &function)
    {
      fail_together(communicator, [&] {
        if (Utilities::MPI::this_mpi_process(communicator) == 0)
          function();
      });
    }



    bool
    is_adaptive(const Parameters &scene)
    {
      return scene.refinement.strategy != RefinementStrategy::none;
    }



    /// Numbers of cells by direction, from the arguments of a mesh generator.
    std::vector<int>
    subdivisions(const std::string &arguments)
    {
      return Utilities::string_to_int(
        Utilities::split_string_list(arguments.substr(0, arguments.find(':')),
                                     ','));
    }



    /// The arguments with @p factor times as many cells in each direction.
    std::string
    scale_subdivisions(const std::string &arguments, const double factor)
    {
      std::string result;
      for (const int n : subdivisions(arguments))
        result += (result.empty() ? "" : ", ") +
                  std::to_string(std::max<long>(1, std::lround(factor * n)));
      return result + ' ' + arguments.substr(arguments.find(':'));
    }



    template <int dim>
    void
    measure_mesh(const GeometryParameters &geometry,
                 const MPI_Comm            communicator,
                 double                   &n_cells,
                 double                   &h)
    {
      parallel::distributed::Triangulation<dim> triangulation(communicator);
      make_mesh(geometry, triangulation);
      n_cells = static_cast<double>(triangulation.n_global_active_cells());
      h       = GridTools::maximal_cell_diameter(triangulation) /
          std::sqrt(static_cast<double>(dim));
    }



    template <int dim>
    std::string
    run_scene_in(const Parameters          &parameters,
                 Console                   &console,
                 const CommandLine::Restart restart,
                 RunMeasurements           &measurements)
    {
      ViscoplasticContact<dim> problem(parameters, console);
      const std::string        interruption = problem.run(restart);
      measurements.seconds                  = problem.seconds();
      measurements.solver_demand            = problem.solver_demand();
      return interruption;
    }



    /// Begin a new record of the largest memory of this process, where Linux
    /// allows that; what earlier runs have left to the allocator goes back.
    void
    reset_peak_memory()
    {
      malloc_trim(0);
      std::ofstream file("/proc/self/clear_refs");
      file << 5 << std::flush;
    }



    /// In MB, of all ranks.
    double
    peak_memory(const MPI_Comm communicator)
    {
      Utilities::System::MemoryStats stats;
      Utilities::System::get_memory_stats(stats); // kB
      return Utilities::MPI::sum(stats.VmHWM / 1024., communicator);
    }



    /**
     * Whether all ranks have failed, or none. A rank that waits longer than
     * others can take to fail has failed alone: they still compute.
     */
    bool
    all_have_failed(const bool failed, const MPI_Comm communicator)
    {
      // Static: the request of a rank that has failed alone stays open.
      static int mine, sum;
      mine = failed ? 1 : 0;
      MPI_Request request;
      int         ierr = MPI_Iallreduce(
        &mine, &sum, 1, MPI_INT, MPI_SUM, communicator, &request);
      AssertThrowMPI(ierr);
      int done = 0;
      for (unsigned int i = 0; failed && done == 0; ++i)
        {
          if (i == 200)
            return false;
          ierr = MPI_Test(&request, &done, MPI_STATUS_IGNORE);
          AssertThrowMPI(ierr);
          if (done == 0)
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
      if (!failed)
        {
          ierr = MPI_Wait(&request, MPI_STATUS_IGNORE);
          AssertThrowMPI(ierr);
        }
      return sum ==
             static_cast<int>(Utilities::MPI::n_mpi_processes(communicator));
    }
  } // namespace



  std::string
  run_scene(const Parameters          &parameters,
            Console                   &console,
            const CommandLine::Restart restart,
            RunMeasurements           &measurements)
  {
    reset_peak_memory();
    const std::string interruption =
      parameters.dimension == 2 ?
        run_scene_in<2>(parameters, console, restart, measurements) :
        run_scene_in<3>(parameters, console, restart, measurements);
    measurements.peak_memory = peak_memory(MPI_COMM_WORLD);
    return interruption;
  }



  StudyRuns::StudyRuns(const std::vector<std::string> &files,
                       const std::vector<std::string> &overrides,
                       const MPI_Comm                  communicator)
    : files(files)
    , overrides(overrides)
    , scene(files, overrides)
    , directory(results_directory(scene) + "study/")
    , phases((TimeSchedule(scene.time.phases), // throws what a user can read
              read_phases(scene.time.phases)))
    , communicator(communicator)
  {
    AssertThrow(!scene.step_control.is_on(),
                ExcMessage("A study compares runs with the steps of "
                           "'Time/Phases'; set 'Step control/Tolerance' = 0 "
                           "for it."));
    AssertThrow(!scene.error_control.has_tolerance(),
                ExcMessage("A study compares runs with given meshes and steps; "
                           "set 'Error control/Tolerance' = 0 for it."));
    int ierr = MPI_Comm_dup(communicator, &agreement);
    AssertThrowMPI(ierr);
    if (scene.dimension == 2)
      measure_mesh<2>(scene.geometry, communicator, n_cells, h);
    else
      measure_mesh<3>(scene.geometry, communicator, n_cells, h);
  }



  StudyRuns::~StudyRuns()
  {
    MPI_Comm_free(&agreement);
  }



  void
  StudyRuns::lock_directory()
  {
    on_first_rank(communicator, [&] {
      make_results_directory(directory);
      lock.acquire(directory);
    });
  }



  RunKey
  StudyRuns::scene_key() const
  {
    RunKey key;
    key.variant = {is_adaptive(scene) ? MeshStrategy::adaptive :
                                        MeshStrategy::uniform,
                   name_of(scene.time.scheme),
                   name_of(scene.stress.stress_history)};
    return key;
  }



  unsigned int
  StudyRuns::steps_per_mesh(const MeshStrategy strategy,
                            const unsigned int n_steps) const
  {
    return strategy == MeshStrategy::uniform ? 0 :
           is_adaptive(scene)                ? scene.refinement.every_n_steps :
                                               std::max(1u, n_steps / 10);
  }



  double
  StudyRuns::n_set_ups(const MeshStrategy strategy, const double n_steps) const
  {
    const double every =
      steps_per_mesh(strategy, static_cast<unsigned int>(n_steps));
    return every > 0. ? std::max(1., std::ceil(n_steps / every)) : 1.;
  }



  int
  StudyRuns::n_coarser_meshes() const
  {
    int n = static_cast<int>(scene.geometry.global_refinements);
    if (scene.geometry.file.empty() &&
        scene.geometry.generator == generator_with_subdivisions)
      {
        const auto cells  = subdivisions(scene.geometry.arguments);
        int        fewest = *std::min_element(cells.begin(), cells.end());
        for (; fewest >= 2; fewest = (fewest + 1) / 2)
          ++n;
      }
    return n;
  }



  std::string
  StudyRuns::name(const RunKey &key) const
  {
    const auto add = [](const std::string &choice,
                        const std::string &of_scene) {
      std::string text = choice == of_scene ? "" : '_' + choice;
      for (char &c : text)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0)
          c = '_';
      return text;
    };
    return to_string(key.variant.strategy) +
           add(key.variant.scheme, name_of(scene.time.scheme)) +
           add(key.variant.history, name_of(scene.stress.stress_history)) +
           "_h" + std::to_string(key.mesh_level) + "_k" +
           std::to_string(key.time_level) + (key.is_timing ? "_timing" : "");
  }



  std::vector<std::string>
  StudyRuns::discretization(const RunKey                  &key,
                            const std::vector<StepsUntil> &steps) const
  {
    const bool adaptive = key.variant.strategy == MeshStrategy::adaptive;
    // Adaptive runs begin one level coarser: from a much coarser mesh,
    // refinement at singular points would leave the rest too coarse.
    const int level = adaptive && key.mesh_level > 0 ? key.mesh_level - 1 :
                                                       key.mesh_level,
              base  = static_cast<int>(scene.geometry.global_refinements),
              refinements = std::max(0, base + level);
    AssertThrow(-level <= n_coarser_meshes(),
                ExcMessage("The mesh of the scene cannot be made coarser by " +
                           std::to_string(-level) +
                           " levels: 'Geometry/Global refinements' = " +
                           std::to_string(base) + "."));
    std::vector<std::string> result;
    const auto set = [&result](const std::string &entry, const auto &value) {
      std::ostringstream assignment;
      assignment << entry << '=' << value;
      result.push_back(assignment.str());
    };
    set("Geometry/Global refinements", refinements);
    set("Time/Phases", write_phases(steps));
    set("Time/Scheme", key.variant.scheme);
    set("Material/Stress history", key.variant.history);
    // Runs have the steps that the study says, or none.
    if (scene.time.stiffness_policy == StiffnessPolicy::subdivide)
      set("Time/Stiffness policy", "refuse");
    if (base + level < 0)
      set("Geometry/Arguments",
          scale_subdivisions(scene.geometry.arguments,
                             std::pow(2., base + level)));
    if (!adaptive)
      {
        set("Mesh refinement/Strategy", "none");
        return result;
      }
    if (!is_adaptive(scene))
      {
        set("Mesh refinement/Strategy", "residual");
        set("Mesh refinement/Refinement fraction", 0.6);
        set("Mesh refinement/Coarsening fraction", 0.05);
        set("Mesh refinement/Every n steps",
            steps_per_mesh(key.variant.strategy, n_steps(steps)));
      }
    const double cells =
      n_cells *
      std::pow(2., static_cast<double>(scene.dimension) * key.mesh_level);
    set("Mesh refinement/Minimal level", std::min(refinements, base));
    set("Mesh refinement/Maximal level",
        std::max(refinements, base + key.mesh_level + 2));
    set("Mesh refinement/Cell budget", std::max<long>(1, std::lround(cells)));
    return result;
  }



  std::vector<std::string>
  StudyRuns::overrides_of(const RunKey &key) const
  {
    std::vector<std::string> result       = overrides;
    const std::string        place        = directory + name(key);
    const bool               is_reference = reference && key == *reference;
    for (const std::string &assignment :
         discretization(key,
                        scale_phases(phases, std::pow(2., key.time_level))))
      result.push_back(assignment);
    for (const std::string &assignment :
         {"Output/Directory=" + place,
          std::string("Output/Fields every=0"),
          std::string("Output/Fields interval=0"),
          std::string("Output/Reference fields=") +
            (is_reference ? "true" : "false"),
          std::string("Checkpoint/Every n steps=0"),
          std::string("Checkpoint/Wall time interval=0"),
          "Checkpoint/Directory=" + place + "/checkpoint",
          std::string("Error control/Two-level comparison=false")})
      result.push_back(assignment);
    if (is_compared(key))
      result.push_back("Exact solution/Reference directory=" + directory +
                       name(*reference));
    return result;
  }



  std::map<std::string, std::string>
  StudyRuns::stamp(const Parameters &parameters, const RunKey &key) const
  {
    const bool         knows_reference = reference && !key.is_timing;
    boost::crc_32_type crc;
    const auto         add = [&crc](const std::string &text) {
      crc.process_bytes(text.data(), text.size());
    };
    for (const auto &[path, value] : parameters.values())
      if (path == "Output/Points" || path == "Output/Reference fields" ||
          (path.compare(0, 7, "Output/") != 0 &&
           path.compare(0, 6, "Study/") != 0 &&
           path.compare(0, 11, "Checkpoint/") != 0 &&
           !(knows_reference && path == "Exact solution/Reference directory")))
        add(path + '=' + value + '\n');
    if (knows_reference)
      add(name(*reference));
    if (!scene.geometry.file.empty())
      add(read_file_if_any(scene.geometry.file).value_or(""));
    return {{"version", VISCOPLASTIC_CONTACT_VERSION},
            {"revision", VISCOPLASTIC_CONTACT_GIT_REVISION},
            {"ranks",
             std::to_string(Utilities::MPI::n_mpi_processes(communicator))},
            {"scene", std::to_string(crc.checksum())}};
  }



  double
  StudyRuns::mesh_width(const double cells) const
  {
    return h * std::pow(n_cells / cells, 1. / scene.dimension);
  }



  std::optional<RunRecord>
  StudyRuns::find(const RunKey &key) const
  {
    const Parameters  parameters(files, overrides_of(key));
    const auto        expected = stamp(parameters, key);
    const std::string file     = directory + name(key) + "/result.json";
    std::string       text;
    on_first_rank(communicator,
                  [&] { text = read_file_if_any(file).value_or(""); });
    text = Utilities::MPI::broadcast(communicator, text);
    if (text.empty())
      return {};
    try
      {
        RunRecord record = from_json(text, file);
        record.stamp.erase("overrides");
        if (record.key == key && record.stamp == expected)
          return record;
      }
    catch (const std::exception &)
      {} // the run is made again
    return {};
  }



  StudyRuns::Outcome
  StudyRuns::make(const RunKey &key) const
  {
    const std::vector<std::string> all_overrides = overrides_of(key);
    const Parameters               parameters(files, all_overrides);
    const std::string              place     = directory + name(key) + '/';
    auto                           run_stamp = stamp(parameters, key);

    // What has been left of the same run goes on, of another one goes.
    std::string begun;
    for (const auto &[name, value] : run_stamp)
      begun += name + ' ' + value + '\n';
    bool may_restart = false;
    on_first_rank(communicator, [&] {
      make_results_directory(place);
      std::filesystem::remove(place + "result.json");
      may_restart = read_file_if_any(place + "begun") == begun;
      replace_file(place + "begun", begun, /* to_disk = */ true);
    });
    may_restart = Utilities::MPI::broadcast(communicator, may_restart);

    Outcome         outcome;
    RunMeasurements measurements;
    Console         console(communicator, true, place + "log.txt");
    try
      {
        outcome.interruption =
          run_scene(parameters,
                    console,
                    may_restart ? CommandLine::Restart::automatic :
                                  CommandLine::Restart::no,
                    measurements);
      }
    catch (const std::exception &exception)
      {
        if (!all_have_failed(true, agreement))
          throw;
        outcome.failure = reason(exception);
        return outcome;
      }
    AssertThrow(!all_have_failed(false, agreement), ExcInternalError());
    if (!outcome.interruption.empty())
      return outcome;
    on_first_rank(communicator, [&] {
      console.check();
      RunRecord record          = make_record(key,
                                     read_table(place + "statistics.csv"),
                                     measurements,
                                     is_compared(key));
      record.name               = name(key);
      record.stamp              = run_stamp;
      record.numbers["h"]       = mesh_width(record.number("cells"));
      const double steps        = record.number("steps");
      record.numbers["set_ups"] = n_set_ups(key.variant.strategy, steps);
      std::string &list         = record.stamp["overrides"];
      for (const std::string &assignment : all_overrides)
        list += (list.empty() ? "" : "; ") + assignment;
      replace_file(place + "result.json",
                   to_json(record),
                   /* to_disk = */ true);
    });
    outcome.record = find(key);
    AssertThrow(outcome.record,
                ExcMessage("'" + place +
                           "result.json' has changed since it was "
                           "written."));
    return outcome;
  }
} // namespace Viscoplastic
