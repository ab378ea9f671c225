// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/table.h>
#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/checkpoint/run_archive.h>

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



    /// Return the values of all entries and the checksums of files of tables.
    std::map<std::string, std::string>
    values_with_tables(const Parameters &parameters)
    {
      auto values = parameters.values();
      for (const auto &table : tables_in_use())
        values[table->section + "/Checksum of the file"] =
          std::to_string(table->checksum);
      return values;
    }



    /// Write or read the data that are the same on all ranks, except for those
    /// that each step computes anew.
    template <int dim, typename Archive>
    void
    exchange_run(Archive &archive, RunState<dim> &run)
    {
      EvaluatedState<dim> &accepted = run.accepted;
      State<dim>          &state    = accepted.state;
      archive &state.n &state.t &state.k &state.time_error_unit &accepted
        .is_solution &accepted.has_slip_rate;
      archive &accepted.space_estimate.total &accepted.space_estimate
        .rate_defect;
      ContactReport &report = accepted.report;
      archive &report.duality_gap &report.relative_error &report.error &report
        .tolerance;
      run.control.exchange(archive);
      if (run.budget != nullptr)
        archive &run.budget->expected_size &run.budget->unavoidable &run.pass
          .follows_another &run.pass.has_changed_mesh;
      if (run.scene.parameters.error_control.error_estimator)
        accepted.errors.exchange(archive);
      run.recorder.exchange(archive);
    }



    /// Write or read whether a value is present; on reading, make it so.
    template <typename Archive, typename T>
    bool
    exchange_presence(Archive &archive, std::optional<T> &value)
    {
      bool     is_there = value.has_value();
      archive &is_there;
      if (is_there && !value)
        value.emplace();
      return is_there;
    }



    /// Write or read the data that the time stepper keeps between steps, except
    /// for truncations and fields, which have values at nodes and samples.
    template <int dim, typename Archive>
    void
    exchange_memory(Archive &archive, StepperMemory<dim> &memory)
    {
      for (std::optional<PreconditionerState> &kept : memory.preconditioners)
        if (exchange_presence(archive, kept))
          archive & kept->best_rate & kept->lost_iterations & kept->is_fresh;
      std::optional<State<dim>> &linearized = memory.quantity.linearized;
      if (exchange_presence(archive, linearized))
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



    /// Whether an entry determines the unknowns or their meaning.
    bool
    is_fixed(const std::string &path)
    {
      const std::size_t slash   = path.find('/');
      const std::string section = path.substr(0, slash),
                        entry   = slash == std::string::npos ?
                                    "" :
                                    path.substr(slash + 1);
      const auto is_one_of = [&entry](const std::vector<std::string> &names) {
        return std::find(names.begin(), names.end(), entry) != names.end();
      };
      const std::string kind = section.substr(0, section.find(' '));
      // Meshes are compared themselves, not the names of files.
      if (section == "Geometry")
        return entry != "File";
      if (kind == "Material")
        return is_one_of({"Young's modulus",
                          "Poisson's ratio",
                          "Voigt matrix",
                          "Law",
                          "Thermal expansion",
                          "Added at",
                          "Removed at",
                          "Volumetric integration",
                          "Stress history"});
      // Files are compared by checksums.
      if (kind == "Table")
        return entry != "File";
      if (kind == "Boundary")
        return is_one_of({"Role",
                          "Contact law",
                          "Against",
                          "Foundation normal",
                          "Friction law",
                          "Normal stiffness",
                          "Tangential stiffness"}) ||
               find_named(entries_of(contact_laws()), entry) != nullptr;
      return section == "Initial state" || section == "Dimension" ||
             section == "Units" || section == "Supports" ||
             path == "Temperature/Reference temperature" ||
             path == "Mesh refinement/Strategy" || path == "Output/Points" ||
             path == "Output/Point fields" || path == "Output/Lines" ||
             path == "Output/Line fields" || path == "Output/Integrals" ||
             path == "Output/Fields in HDF5" ||
             path == "Error control/Error bar" ||
             path == "Error control/Quantity";
    }



    /// Whether error control to a tolerance is switched on or off, which needs
    /// other meshes and schemes. The tolerance itself may change.
    bool
    is_switched(const std::string &path,
                const std::string &old_value,
                const std::string &value)
    {
      return path == "Error control/Tolerance" &&
             (Utilities::string_to_double(old_value) > 0.) !=
               (Utilities::string_to_double(value) > 0.);
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
    PackedRun           packed;
    CheckpointManifest &manifest = packed.manifest;
    manifest.n                   = state.n;
    manifest.t                   = state.t;
    manifest.dimension           = dim;
    manifest.n_ranks    = Utilities::MPI::n_mpi_processes(communicator);
    manifest.version    = version;
    manifest.parameters = values_with_tables(run.scene.parameters);

    packed.files[file_of_rank("mesh", rank)] = pack_mesh(triangulation);
    StepperMemory<dim> memory                = time_stepper.memory();
    packed.files[file_of_rank("fields", rank)] =
      pack_fields(discretization.stress_space,
                  discretization.face.get(),
                  state,
                  truncations(std::as_const(memory)),
                  indicators);
    const State<dim> of_quantity =
      fields_of_quantity<dim>(memory.quantity, state.contact);
    if (run.scene.quantity)
      packed.files[file_of_rank("quantity", rank)] =
        pack_fields(discretization.stress_space,
                    discretization.face.get(),
                    of_quantity,
                    dual_truncations(std::as_const(memory)),
                    Vector<double>());
    if (rank == 0)
      {
        const CoarseMesh coarse_mesh = describe_coarse_mesh(triangulation);
        BinaryWriter     archive;
        archive &coarse_mesh.topology &coarse_mesh.vertices;
        for (const DistributedVector *field : nodal_fields(state))
          archive &(field->size() > 0);
        archive &(indicators.size() > 0);
        archive &output_times;
        archive &run.recorder.elapsed_in_all();
        exchange_run(archive, run);
        exchange_memory(archive, memory);
        for (const DistributedVector *field : nodal_fields(of_quantity))
          archive &(field->size() > 0);
        packed.files[run_file] = archive.bytes();
      }
    return packed;
  }



  template <int dim>
  RunArchive<dim>::RunArchive(
    const CheckpointStore                     &store,
    const CheckpointManifest                  &checkpoint,
    RunState<dim>                             &run,
    parallel::distributed::Triangulation<dim> &triangulation)
    : changes(compare_parameters(checkpoint.parameters,
                                 values_with_tables(run.scene.parameters)))
    , store(store)
    , checkpoint(checkpoint)
    , run(run)
  {
    const std::string path = store.path(checkpoint.n),
                      name = "The checkpoint '" + path + "'";
    if (checkpoint.dimension != dim || !changes.forbidden.empty())
      refuse(name + " cannot go on with other unknowns: " +
             enumeration(changes.forbidden) +
             "; undo that, or begin without --restart.");
    BinaryReader archive(store.read(checkpoint, run_file));
    CoarseMesh   coarse_mesh;
    archive &coarse_mesh.topology &coarse_mesh.vertices;
    if (!coarse_mesh.agrees_with(describe_coarse_mesh(triangulation)))
      refuse(name + " belongs to another coarse mesh.");
    for (bool &has_field : has_nodal_field)
      archive &has_field;
    if (has_nodal_field[3] != run.scene.keeps_friction_work())
      refuse(name + " cannot go on with another sum: `friction work' among "
                    "'Output/Additional fields' has to be there from the "
                    "beginning or not at all.");
    archive &has_estimate &output_times &earlier_seconds;
    exchange_run(archive, run);
    is_solution = run.accepted.is_solution;
    exchange_memory(archive, memory);
    for (bool &has_field : has_field_of_quantity)
      archive &has_field;
    has_bytes_to_spare = !archive.is_at_end();
    check_schedule(run, path);
    for (unsigned int r = 0; r < checkpoint.n_ranks; ++r)
      meshes.push_back(store.read(checkpoint, file_of_rank("mesh", r)));
    restore_mesh(meshes, triangulation);
  }



  template <int dim>
  StepperMemory<dim>
  RunArchive<dim>::read_fields(const Discretization<dim> &discretization)
  {
    const MPI_Comm communicator =
      discretization.space.dof_handler.get_communicator();
    const unsigned int rank    = Utilities::MPI::this_mpi_process(communicator);
    const unsigned int n_ranks = Utilities::MPI::n_mpi_processes(communicator);
    const auto unpack = [&](const unsigned int begin, const unsigned int end) {
      PackedFields packed{{meshes.begin() + begin, meshes.begin() + end},
                          {},
                          has_nodal_field,
                          has_estimate,
                          ErrorEstimator<dim>::has_sample_fields(run.scene)};
      for (unsigned int r = begin; r < end; ++r)
        packed.fields.push_back(
          store.read(checkpoint, file_of_rank("fields", r)));
      bool complete =
        unpack_fields(packed,
                      discretization.stress_space,
                      discretization.face.get(),
                      run.accepted.state,
                      truncations(memory),
                      run.accepted.space_estimate.squared_indicators);
      if (complete && run.scene.quantity)
        {
          packed.fields.clear();
          for (unsigned int r = begin; r < end; ++r)
            packed.fields.push_back(
              store.read(checkpoint, file_of_rank("quantity", r)));
          const bool has_state    = has_field_of_quantity[0];
          packed.has_nodal_field  = has_field_of_quantity;
          packed.has_sample_field = {{has_state,
                                      false,
                                      has_state,
                                      false,
                                      has_state && packed.has_sample_field[4],
                                      false,
                                      false}};
          packed.has_estimate     = false;
          Vector<double> no_estimate;
          State<dim>     fields =
            fields_of_quantity<dim>(memory.quantity, ContactState());
          complete          = unpack_fields(packed,
                                   discretization.stress_space,
                                   discretization.face.get(),
                                   fields,
                                   dual_truncations(memory),
                                   no_estimate);
          memory.quantity.w = {{fields.velocity, fields.initial_u}};
          if (memory.quantity.linearized)
            memory.quantity.linearized = std::move(fields);
        }
      return !Utilities::MPI::logical_or(!complete, communicator);
    };
    // On as many ranks as before, each rank has all data in its own file.
    if (((n_ranks != checkpoint.n_ranks || !unpack(rank, rank + 1)) &&
         !unpack(0, checkpoint.n_ranks)) ||
        has_bytes_to_spare)
      refuse("The checkpoint '" + store.path(checkpoint.n) +
             "' does not fit the scene.");
    if (changes.of_data) // linearized with other data
      memory.quantity = {};
    // With changed data, the restored state does not solve its step.
    run.accepted.is_solution = is_solution && !changes.of_data;
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
