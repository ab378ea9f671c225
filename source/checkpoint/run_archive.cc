// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/table.h>
#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/checkpoint/run_archive.h>

#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/serialization/vector.hpp>

#include <numeric>
#include <regex>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    const std::string run_file = "run.bin";
    const std::string version =
      std::string(program_version) + " (" + git_revision + ")";

    std::string
    file_of_rank(const std::string &kind, const unsigned int rank)
    {
      return kind + '_' + Utilities::int_to_string(rank, 5) + ".bin";
    }



    /// Return the values of all entries and the checksums of files of tables
    /// and meshes.
    template <int dim>
    std::map<std::string, std::string>
    values_with_files(
      const Parameters                                &parameters,
      const parallel::distributed::Triangulation<dim> &triangulation)
    {
      auto values = parameters.values();
      for (const auto &table : tables_in_use())
        values[table->section + "/Checksum of the file"] =
          std::to_string(table->checksum);
      values["Geometry/Checksum of the mesh"] =
        checksum_of_coarse_mesh(triangulation);
      return values;
    }



    /// Write or read whether a value is present; on reading, make it so.
    template <typename Archive, typename T>
    bool
    serialize_presence(Archive &archive, std::optional<T> &value)
    {
      bool     is_there = value.has_value();
      archive &is_there;
      if (is_there && !value)
        value.emplace();
      return is_there;
    }



    /// Write or read the data that are the same on all ranks, except for those
    /// that each step computes anew.
    template <int dim, typename Archive>
    void
    serialize_run(Archive            &archive,
                  RunState<dim>      &run,
                  StepperMemory<dim> &memory,
                  ArchivedData       &data)
    {
      archive &data.meshes &data.fields[0] & data.fields[1];
      archive &data.has_estimate &data.is_solution &data.output_times &data
        .earlier_seconds;
      EvaluatedState<dim> &accepted = run.accepted;
      State<dim>          &state    = accepted.state;
      archive &state.n &state.t &state.k &state.time_error_unit &accepted
        .has_slip_rate;
      archive &accepted.space_estimate.total &accepted.space_estimate
        .rate_defect;
      ContactReport &report = accepted.report;
      archive &report.duality_gap &report.relative_error &report.error &report
        .tolerance &run.control;
      if (run.budget != nullptr)
        archive &run.budget->expected_size &run.budget->unavoidable &run.pass
          .follows_another &run.pass.has_changed_mesh;
      archive &accepted.errors &run.recorder;
      for (std::optional<PreconditionerState> &kept : memory.preconditioners)
        if (serialize_presence(archive, kept))
          archive & kept->best_rate & kept->lost_iterations & kept->is_fresh;
      std::optional<State<dim>> &linearized = memory.quantity.linearized;
      if (serialize_presence(archive, linearized))
        archive & linearized->t & linearized->k;
    }



    /// Return the fields of a quantity of interest as a state: those of the
    /// linearization, with dual solutions in place of velocity and initial_u.
    template <int dim>
    State<dim>
    fields_of_quantity(const typename QuantityEstimator<dim>::Memory &memory,
                       const ContactState                            &contact)
    {
      State<dim> result;
      if (memory.linearized)
        result = *memory.linearized;
      result.velocity  = memory.w[0];
      result.initial_u = memory.w[1];
      result.contact   = contact; // of the same points
      return result;
    }



    /// Return the truncations for which preconditioners were built.
    template <typename MemoryType>
    auto
    truncations(MemoryType &memory)
    {
      std::vector<decltype(&memory.preconditioners[0]->built_for)> result;
      for (auto &kept : memory.preconditioners)
        if (kept)
          result.push_back(&kept->built_for);
      return result;
    }

    /// Return the truncations of the dual solutions.
    template <typename MemoryType>
    auto
    dual_truncations(MemoryType &memory)
    {
      auto &[of_step, of_creep] = memory.quantity.truncations;
      return std::vector<decltype(&of_step)>{&of_step, &of_creep};
    }



    /// Throw unless the schedule contains the step of the checkpoint, or, for
    /// steps of controlled size, does not end before it.
    template <int dim>
    void
    check_schedule(const RunState<dim> &run, const std::string &path)
    {
      const State<dim> &state    = run.accepted.state;
      const auto       &schedule = run.scene.schedule;
      const bool        is_on_schedule =
        state.n >= 1 &&
        (run.control.may_reject() ? state.t <= schedule.end_time() :
                                    state.n <= schedule.n_steps() &&
                                      schedule.step(state.n).t == state.t &&
                                      schedule.step(state.n).k == state.k);
      if (!is_on_schedule)
        refuse("'Time/Phases' = " + run.scene.parameters.time.phases +
               " does not contain the step of the checkpoint '" + path +
               "'; change only what comes after it.");
    }



    /// Whether an entry determines the unknowns or their meaning. Meshes and
    /// tables are compared by checksums, not by the names of their files.
    bool
    is_fixed(const std::string &path)
    {
      static const std::regex fixed(
        "Dimension|(Units|Supports|Initial state)/.*|"
        "(Geometry|Table [0-9]+)/(?!File$).*|"
        "Material[^/]*/(Young's modulus|Poisson's ratio|Voigt matrix|Law|"
        "Thermal expansion|Added at|Removed at|Volumetric integration|"
        "Stress history)|"
        "Boundary[^/]*/(Role|Contact law|Against|Foundation normal|"
        "Friction law|Normal stiffness|Tangential stiffness)|"
        "Temperature/Reference temperature|Mesh refinement/Strategy|"
        "Output/(Points|Point fields|Lines|Line fields|Integrals|"
        "Fields in HDF5)|Error control/(Error bar|Quantity)");
      return std::regex_match(path, fixed) ||
             (path.compare(0, 8, "Boundary") == 0 &&
              find_named(entries_of(contact_laws()),
                         path.substr(path.find('/') + 1)) != nullptr);
    }



    /// Whether error control to a tolerance is switched on or off, which needs
    /// other meshes and schemes, or a field that is a sum over all steps. The
    /// tolerance and other fields may change.
    bool
    is_switched(const std::string &path,
                const std::string &old_value,
                const std::string &value)
    {
      const auto is_on = [&path](const std::string &text) {
        return path == "Error control/Tolerance" ?
                 Utilities::string_to_double(text) > 0. :
                 text.find("friction work") != std::string::npos;
      };
      return (path == "Error control/Tolerance" ||
              path == "Output/Additional fields") &&
             is_on(old_value) != is_on(value);
    }



    ParameterChanges
    compare_parameters(const std::map<std::string, std::string> &old_values,
                       const std::map<std::string, std::string> &new_values)
    {
      ParameterChanges changes;
      const auto       quoted = [](const std::string &value) {
        return value.empty() ? "empty" : excerpt(value);
      };
      for (const auto &[path, value] : new_values)
        {
          const auto old = old_values.find(path);
          if (old == old_values.end())
            changes.forbidden.push_back("'" + path + "' is new");
          else if (old->second != value)
            {
              (is_fixed(path) || is_switched(path, old->second, value) ?
                 changes.forbidden :
                 changes.allowed)
                .push_back("'" + path + "' is " + quoted(value) + " (was " +
                           quoted(old->second) + ")");
              for (const std::string section : {"Boundary",
                                                "Material",
                                                "Loads",
                                                "Temperature",
                                                "Exact solution"})
                changes.of_data |=
                  path.compare(0, section.size(), section) == 0;
            }
        }
      for (const auto &[path, value] : old_values)
        if (new_values.count(path) == 0)
          changes.forbidden.push_back("'" + excerpt(path) + "' is gone (was " +
                                      quoted(value) + ")");
      return changes;
    }
  } // namespace



  template <int dim>
  PackedRun
  pack_run(RunState<dim>                                   &run,
           const parallel::distributed::Triangulation<dim> &triangulation,
           const Discretization<dim>                       &discretization,
           const TimeStepper<dim>                          &time_stepper,
           const std::vector<double>                       &output_times)
  {
    const MPI_Comm        communicator = triangulation.get_communicator();
    const unsigned int    rank = Utilities::MPI::this_mpi_process(communicator);
    const State<dim>     &state = run.accepted.state;
    const Vector<double> &indicators =
      run.accepted.space_estimate.squared_indicators;
    StepperMemory<dim> memory = time_stepper.memory();
    const State<dim>   of_quantity =
      fields_of_quantity<dim>(memory.quantity, state.contact);
    const auto mesh = pack_mesh(triangulation);
    using Meshes    = std::vector<std::vector<unsigned int>>;
    ArchivedData data{Utilities::MPI::n_mpi_processes(communicator) == 1 ?
                        Meshes{mesh} : // gather() would compress it
                        Utilities::MPI::gather(communicator, mesh),
                      {{fields_present(state, communicator),
                        fields_present(of_quantity, communicator)}},
                      indicators.size() > 0,
                      run.accepted.is_solution,
                      output_times,
                      run.recorder.elapsed_in_all()};
    PackedRun  packed{{state.n,
                       state.t,
                       Utilities::MPI::n_mpi_processes(communicator),
                       version,
                       values_with_files(run.scene.parameters, triangulation),
                       {}},
                     {}};
    const auto write = [&packed](const std::string &name, const auto &act) {
      std::ostringstream              bytes;
      boost::archive::binary_oarchive archive(bytes);
      act(archive);
      packed.files[name] = bytes.str();
    };
    const auto write_fields = [&](const std::string    &kind,
                                  const State<dim>     &fields,
                                  const auto           &truncations,
                                  const Vector<double> &estimate) {
      const CellValues values = pack_fields(discretization.stress_space,
                                            discretization.face.get(),
                                            fields,
                                            truncations,
                                            estimate);
      write(file_of_rank(kind, rank),
            [&](auto &archive) { archive << values; });
    };
    write_fields("fields",
                 state,
                 truncations(std::as_const(memory)),
                 indicators);
    if (run.scene.quantity)
      write_fields("quantity",
                   of_quantity,
                   dual_truncations(std::as_const(memory)),
                   Vector<double>());
    if (rank == 0)
      write(run_file,
            [&](auto &archive) { serialize_run(archive, run, memory, data); });
    return packed;
  }



  template <int dim>
  RunArchive<dim>::RunArchive(
    const CheckpointStore                     &store,
    const CheckpointManifest                  &checkpoint,
    RunState<dim>                             &run,
    parallel::distributed::Triangulation<dim> &triangulation)
    : changes(compare_parameters(checkpoint.parameters,
                                 values_with_files(run.scene.parameters,
                                                   triangulation)))
    , store(store)
    , checkpoint(checkpoint)
    , run(run)
  {
    const std::string path = store.path(checkpoint.n);
    if (!changes.forbidden.empty())
      refuse("The checkpoint '" + path +
             "' cannot go on with other unknowns: " +
             enumeration(changes.forbidden) +
             "; undo that, or begin without --restart.");
    std::istringstream              bytes(store.read(checkpoint, run_file));
    boost::archive::binary_iarchive archive(bytes);
    serialize_run(archive, run, memory, data);
    check_schedule(run, path);
    restore_mesh(data.meshes, triangulation);
  }



  template <int dim>
  CellValues
  RunArchive<dim>::read_cells(const std::string          &kind,
                              const AdmissibleSpace<dim> &space) const
  {
    // Ranks own consecutive cells, now and when the checkpoint was written.
    const auto sizes =
      Utilities::MPI::all_gather(space.communicator, space.cells.size());
    const std::size_t end = std::accumulate(
      sizes.begin(),
      sizes.begin() + Utilities::MPI::this_mpi_process(space.communicator) + 1,
      std::size_t(0));
    const std::size_t begin = end - space.cells.size();
    CellValues        result;
    std::size_t       first = 0; // of a rank of the checkpoint
    fail_together(space.communicator, [&]() {
      for (unsigned int r = 0; r < data.meshes.size(); ++r)
        {
          const std::size_t n =
            data.meshes[r].size() / std::tuple_size_v<CellId::binary_type>;
          if (begin < first + n && first < end)
            {
              std::istringstream bytes(
                store.read(checkpoint, file_of_rank(kind, r)));
              CellValues part;
              boost::archive::binary_iarchive(bytes) >> part;
              auto value = part.values.begin();
              for (std::size_t i = 0; i < part.sizes.size();
                   value += part.sizes[i++])
                if (begin <= first + i && first + i < end)
                  {
                    result.sizes.push_back(part.sizes[i]);
                    result.values.insert(result.values.end(),
                                         value,
                                         value + part.sizes[i]);
                  }
            }
          first += n;
        }
    });
    return result;
  }



  template <int dim>
  StepperMemory<dim>
  RunArchive<dim>::read_fields(const Discretization<dim> &discretization)
  {
    Vector<double> &indicators = run.accepted.space_estimate.squared_indicators;
    if (data.has_estimate)
      indicators.reinit(
        discretization.space.dof_handler.get_triangulation().n_active_cells());
    unpack_fields(read_cells("fields", discretization.space),
                  data.fields[0],
                  discretization.stress_space,
                  discretization.face.get(),
                  run.accepted.state,
                  truncations(memory),
                  indicators);
    if (changes.of_data)
      memory.quantity = {}; // linearized with other data
    else if (run.scene.quantity)
      {
        Vector<double> no_estimate;
        State<dim>     fields =
          fields_of_quantity<dim>(memory.quantity, ContactState());
        unpack_fields(read_cells("quantity", discretization.space),
                      data.fields[1],
                      discretization.stress_space,
                      discretization.face.get(),
                      fields,
                      dual_truncations(memory),
                      no_estimate);
        memory.quantity.w = {{fields.velocity, fields.initial_u}};
        if (memory.quantity.linearized)
          memory.quantity.linearized = std::move(fields);
      }
    // With changed data, the restored state does not solve its step.
    run.accepted.is_solution = data.is_solution && !changes.of_data;
    run.accepted.forces =
      evaluate_forces(discretization.stress_space,
                      discretization.matrix,
                      discretization.loads.assemble(run.accepted.state.t),
                      run.accepted.state);
    return memory;
  }



  template <int dim>
  void
  RunArchive<dim>::remark_on_changes(Console &console) const
  {
    const unsigned int n_ranks =
      Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
    if (checkpoint.n_ranks != n_ranks)
      console.remark("Note: the checkpoint is from " +
                     std::to_string(checkpoint.n_ranks) +
                     " MPI rank(s), this run has " + std::to_string(n_ranks) +
                     "; results will differ by the contact tolerance.");
    if (checkpoint.version != version)
      console.remark("Note: the checkpoint is from version '" +
                     excerpt(checkpoint.version) + "', this is " + version +
                     ".");
    if (!changes.allowed.empty())
      console.remark("Note: changed since the checkpoint: " +
                     enumeration(changes.allowed) + ".");
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(RunArchive);
  VISCOPLASTIC_INSTANTIATE(pack_run);
} // namespace Viscoplastic
