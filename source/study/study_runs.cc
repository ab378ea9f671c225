// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/grid/grid_tools.h>

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/table.h>
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
      ViscoplasticContact<dim> problem(parameters,
                                       console,
                                       runs_ahead<dim>(parameters, console));
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



    /// Now and at the most, in MB, of all ranks.
    std::pair<double, double>
    memory(const MPI_Comm communicator)
    {
      Utilities::System::MemoryStats stats;
      Utilities::System::get_memory_stats(stats); // kB
      return {Utilities::MPI::sum(stats.VmRSS / 1024., communicator),
              Utilities::MPI::sum(stats.VmHWM / 1024., communicator)};
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
    measurements.first_memory = memory(MPI_COMM_WORLD).first;
    const std::string interruption =
      parameters.dimension == 2 ?
        run_scene_in<2>(parameters, console, restart, measurements) :
        run_scene_in<3>(parameters, console, restart, measurements);
    measurements.peak_memory = memory(MPI_COMM_WORLD).second;
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
          (has_outputs && path.compare(0, 13, "Output/Fields") == 0) ||
          (path.compare(0, 7, "Output/") != 0 &&
           path.compare(0, 6, "Study/") != 0 &&
           path.compare(0, 11, "Checkpoint/") != 0 &&
           !(knows_reference && path == "Exact solution/Reference directory")))
        add(path + '=' + value + '\n');
    if (knows_reference)
      add(name(*reference));
    std::vector<std::string> files = scene.shared_libraries;
    if (!scene.geometry.file.empty())
      files.push_back(scene.geometry.file);
    for (const auto &table : tables_in_use())
      add(std::to_string(table->checksum));
    for (const std::string &file : files)
      add(read_file_if_any(file).value_or(""));
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
        // Levels count from a tolerance that may have changed, names do not.
        const bool has_key =
          key.variant.strategy == MeshStrategy::tolerance ?
            record.key.variant == key.variant && record.name == name(key) :
            record.key == key;
        record.key = key;
        if (has_key && record.stamp == expected)
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
      RunRecord record    = make_record(key,
                                     read_table(place + "statistics.csv"),
                                     measurements,
                                     is_compared(key),
                                     scene.error_control.quantity);
      record.name         = name(key);
      record.stamp        = run_stamp;
      record.numbers["h"] = mesh_width(record.number("cells"));
      if (key.variant.strategy == MeshStrategy::tolerance)
        record.numbers["tolerance"] = tolerance(key);
      else
        record.numbers["set_ups"] = n_set_ups(key.variant.strategy,
                                              record.number("steps"),
                                              n_steps(phases_of(key)));
      if (key.variant.strategy != MeshStrategy::tolerance &&
          scene.step_control.is_on())
        record.numbers["step_tolerance"] = step_tolerance(key);
      std::string &list = record.stamp["overrides"];
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
