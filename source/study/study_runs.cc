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
    template <typename Function>
    void
    on_first_rank(const MPI_Comm communicator, const Function &function)
    {
      std::string failure;
      if (Utilities::MPI::this_mpi_process(communicator) == 0)
        {
          try
            {
              function();
            }
          catch (const std::exception &exception)
            {
              failure = reason(exception);
            }
        }
      failure = Utilities::MPI::broadcast(communicator, failure);
      AssertThrow(failure.empty(), ExcMessage(failure));
    }



    /// Numbers of cells by direction with @p factor times as many.
    std::string
    scale_subdivisions(const std::string &arguments, const double factor)
    {
      const std::size_t colon = arguments.find(':');
      std::string       result;
      for (const std::string &n :
           Utilities::split_string_list(arguments.substr(0, colon), ','))
        result += (result.empty() ? "" : ", ") +
                  std::to_string(std::max<long>(
                    1, std::lround(factor * Utilities::string_to_int(n))));
      return result + ' ' + arguments.substr(colon);
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
                 RunMeasurements           *measurements)
    {
      ViscoplasticContact<dim> problem(parameters, console);
      const std::string        interruption = problem.run(restart);
      if (measurements != nullptr)
        measurements->seconds = problem.seconds();
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
      for (unsigned int i = 0; failed && i < 200; ++i)
        {
          int done = 0;
          ierr     = MPI_Test(&request, &done, MPI_STATUS_IGNORE);
          AssertThrowMPI(ierr);
          if (done != 0)
            break;
          std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
      if (failed)
        {
          int done = request == MPI_REQUEST_NULL ? 1 : 0;
          if (done == 0)
            return false;
        }
      else
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
            RunMeasurements           *measurements)
  {
    reset_peak_memory();
    const std::string interruption =
      parameters.dimension == 2 ?
        run_scene_in<2>(parameters, console, restart, measurements) :
        run_scene_in<3>(parameters, console, restart, measurements);
    if (measurements != nullptr)
      measurements->peak_memory = peak_memory(MPI_COMM_WORLD);
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
    key.strategy = scene.refinement.strategy == "none" ? "uniform" : "adaptive";
    key.scheme   = scene.time.scheme;
    key.history  = scene.stress.stress_history;
    return key;
  }



  int
  StudyRuns::n_coarser_meshes() const
  {
    int n = static_cast<int>(scene.geometry.global_refinements);
    if (scene.geometry.file.empty() &&
        scene.geometry.generator == generator_with_subdivisions)
      {
        const std::string &arguments = scene.geometry.arguments;
        int                fewest    = 1 << 20;
        for (const std::string &cells : Utilities::split_string_list(
               arguments.substr(0, arguments.find(':')), ','))
          fewest = std::min(fewest, Utilities::string_to_int(cells));
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
    return key.strategy + add(key.scheme, scene.time.scheme) +
           add(key.history, scene.stress.stress_history) + "_h" +
           std::to_string(key.mesh_level) + "_k" +
           std::to_string(key.time_level);
  }



  std::vector<std::string>
  StudyRuns::discretisation(const RunKey                  &key,
                            const std::vector<StepsUntil> &steps) const
  {
    const bool adaptive = key.strategy == "adaptive";
    // Adaptive runs begin one level coarser: from a much coarser mesh,
    // refinement at singular points would leave the rest too coarse.
    const int level = adaptive && key.mesh_level > 0 ? key.mesh_level - 1 :
                                                       key.mesh_level,
              base  = static_cast<int>(scene.geometry.global_refinements);
    AssertThrow(-level <= n_coarser_meshes(),
                ExcMessage("The mesh of the scene cannot be made coarser by " +
                           std::to_string(-level) +
                           " levels: 'Geometry/Global refinements' = " +
                           std::to_string(base) + "."));
    const int                refinements = std::max(0, base + level);
    std::vector<std::string> result{"Geometry/Global refinements=" +
                                      std::to_string(refinements),
                                    "Time/Phases=" + write_phases(steps),
                                    "Time/Scheme=" + key.scheme,
                                    "Material/Stress history=" + key.history};
    // Runs have the steps that the study says, or none.
    if (scene.time.stiffness_policy == "subdivide")
      result.emplace_back("Time/Stiffness policy=refuse");
    if (base + level < 0)
      result.push_back("Geometry/Arguments=" +
                       scale_subdivisions(scene.geometry.arguments,
                                          std::pow(2., base + level)));
    const bool scene_is_adaptive = scene.refinement.strategy != "none";
    if (!adaptive)
      {
        result.push_back("Mesh refinement/Strategy=none");
        return result;
      }
    if (!scene_is_adaptive)
      {
        result.push_back("Mesh refinement/Strategy=residual");
        result.push_back("Mesh refinement/Refinement fraction=0.6");
        result.push_back("Mesh refinement/Coarsening fraction=0.05");
        result.push_back("Mesh refinement/Every n steps=" +
                         std::to_string(std::max(1u, n_steps(steps) / 10)));
      }
    const double cells =
      n_cells *
      std::pow(2., static_cast<double>(scene.dimension) * key.mesh_level);
    result.push_back("Mesh refinement/Minimal level=" +
                     std::to_string(std::min(refinements, base)));
    result.push_back(
      "Mesh refinement/Maximal level=" +
      std::to_string(std::max(refinements, base + key.mesh_level + 2)));
    result.push_back("Mesh refinement/Cell budget=" +
                     std::to_string(std::max<long>(1, std::lround(cells))));
    return result;
  }



  std::vector<std::string>
  StudyRuns::overrides_of(const RunKey &key) const
  {
    std::vector<std::string> result = overrides;
    const std::string        place  = directory + name(key);
    for (const std::string &text :
         discretisation(key,
                        scale_phases(phases, std::pow(2., key.time_level))))
      result.push_back(text);
    for (const std::string &text :
         {"Output/Directory=" + place,
          std::string("Output/Fields every=0"),
          std::string("Output/Fields interval=0"),
          std::string("Checkpoint/Every n steps=0"),
          std::string("Checkpoint/Wall time interval=0"),
          "Checkpoint/Directory=" + place + "/checkpoint",
          std::string("Error control/Two-level comparison=false")})
      result.push_back(text);
    const bool is_reference = reference && key == *reference;
    result.push_back(std::string("Output/Reference fields=") +
                     (is_reference ? "true" : "false"));
    if (reference && !is_reference)
      result.push_back("Exact solution/Reference directory=" + directory +
                       name(*reference));
    return result;
  }



  std::map<std::string, std::string>
  StudyRuns::stamp(const Parameters &parameters) const
  {
    boost::crc_32_type crc;
    const auto         add = [&crc](const std::string &text) {
      crc.process_bytes(text.data(), text.size());
    };
    for (const auto &[path, value] : parameters.values())
      if (path == "Output/Points" || path == "Output/Reference fields" ||
          (path.compare(0, 7, "Output/") != 0 &&
           path.compare(0, 6, "Study/") != 0 &&
           path.compare(0, 11, "Checkpoint/") != 0 &&
           !(reference && path == "Exact solution/Reference directory")))
        add(path + '=' + value + '\n');
    if (reference)
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
    const auto        expected = stamp(parameters);
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
    auto                           run_stamp = stamp(parameters);

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
    bool            failed = false;
    Console         console(communicator, true, place + "log.txt");
    try
      {
        outcome.interruption =
          run_scene(parameters,
                    console,
                    may_restart ? CommandLine::Restart::automatic :
                                  CommandLine::Restart::no,
                    &measurements);
      }
    catch (const std::exception &exception)
      {
        outcome.failure = reason(exception);
        failed          = true;
        if (!all_have_failed(true, agreement))
          throw;
      }
    if (!failed)
      {
        AssertThrow(!all_have_failed(false, agreement), ExcInternalError());
        if (outcome.interruption.empty())
          {
            on_first_rank(communicator, [&] {
              console.check();
              RunRecord record =
                make_record(key,
                            read_table(place + "statistics.csv"),
                            measurements,
                            reference.has_value() && !(key == *reference));
              record.name         = name(key);
              record.stamp        = run_stamp;
              record.numbers["h"] = mesh_width(record.number("cells"));
              const double every  = parameters.refinement.strategy == "none" ?
                                      0. :
                                      parameters.refinement.every_n_steps;
              record.numbers["set_ups"] =
                every > 0. ?
                  std::max(1., std::ceil(record.number("steps") / every)) :
                  1.;
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
          }
      }
    return outcome;
  }
} // namespace Viscoplastic
