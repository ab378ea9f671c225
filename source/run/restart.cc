// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/spelling.h>
#include <viscoplastic_contact/base/table.h>
#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/checkpoint/checkpoint.h>
#include <viscoplastic_contact/checkpoint/parameter_changes.h>
#include <viscoplastic_contact/run/viscoplastic_contact.h>

#include <iomanip>
#include <limits>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    const std::string run_file = "run.bin";

    std::string
    mesh_file(const unsigned int rank)
    {
      return "mesh_" + Utilities::int_to_string(rank, 5) + ".bin";
    }

    std::string
    fields_file(const unsigned int rank)
    {
      return "fields_" + Utilities::int_to_string(rank, 5) + ".bin";
    }



    /// The entries and, of tables, what is in their files.
    std::map<std::string, std::string>
    values_with_tables(const Parameters &parameters)
    {
      auto values = parameters.values();
      for (const auto &table : tables_in_use())
        values[table->section + "/Checksum of the file"] =
          std::to_string(table->checksum);
      return values;
    }



    /// All but the truncation, which has values at nodes.
    template <typename Archive>
    void
    exchange_preconditioner(Archive                            &archive,
                            std::optional<PreconditionerState> &preconditioner)
    {
      bool     has_state = preconditioner.has_value();
      archive &has_state;
      if (!has_state)
        return;
      if (!preconditioner)
        preconditioner.emplace();
      archive & preconditioner->best_rate & preconditioner->lost_iterations &
        preconditioner->is_fresh;
    }



    /// Tell what is not as it was when a checkpoint was written.
    void
    remark_on_changes(const CheckpointManifest &checkpoint,
                      const ParameterChanges   &changes,
                      Console                  &console)
    {
      const unsigned int n_ranks =
        Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
      if (checkpoint.n_ranks != n_ranks)
        console.remark("Note: the checkpoint is from " +
                       std::to_string(checkpoint.n_ranks) +
                       " MPI rank(s), this run has " + std::to_string(n_ranks) +
                       "; results will differ by the contact tolerance.");
      const std::string version =
        VISCOPLASTIC_CONTACT_VERSION " (" VISCOPLASTIC_CONTACT_GIT_REVISION ")";
      if (checkpoint.version != version)
        console.remark("Note: the checkpoint is from version '" +
                       excerpt(checkpoint.version) + "', this is " + version +
                       ".");
      if (!changes.allowed.empty())
        console.remark("Note: changed since the checkpoint: " +
                       enumeration(changes.allowed) + ".");
    }
  } // namespace



  template <int dim>
  template <typename Archive>
  void
  ViscoplasticContact<dim>::exchange(Archive &archive)
  {
    // What record() and estimate() make anew in each step is not here.
    State<dim> &state = accepted.state;
    archive &state.n &state.t &state.k &accepted.is_solution &accepted
      .has_slip_rate;
    archive &accepted.space_estimate.total &accepted.space_estimate.rate_defect;
    ContactReport                          &report = accepted.report;
    archive &report.duality_gap &report.relative_error &report.error &report
      .tolerance;
    control.exchange(archive);
    if (budget)
      archive & budget->expected_size;
    if (error_estimator)
      accepted.errors.exchange(archive);
    recorder.exchange(archive);
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::write_checkpoint()
  {
    TimerOutput::Scope    phase(timer, "checkpoint");
    const unsigned int    rank = Utilities::MPI::this_mpi_process(communicator);
    const State<dim>     &state = accepted.state;
    const Vector<double> &indicators =
      accepted.space_estimate.squared_indicators;
    CheckpointManifest manifest;
    manifest.n         = state.n;
    manifest.t         = state.t;
    manifest.dimension = dim;
    manifest.n_ranks   = Utilities::MPI::n_mpi_processes(communicator);
    manifest.version =
      VISCOPLASTIC_CONTACT_VERSION " (" VISCOPLASTIC_CONTACT_GIT_REVISION ")";
    manifest.parameters = values_with_tables(parameters);

    std::map<std::string, std::string> files;
    files[mesh_file(rank)] = pack_mesh(triangulation);
    auto preconditioner    = time_stepper->method().preconditioner_state();
    files[fields_file(rank)] =
      pack_fields(discretization->stress_space,
                  discretization->face.get(),
                  state,
                  preconditioner ? &preconditioner->built_for : nullptr,
                  indicators);
    if (rank == 0)
      {
        const CoarseMesh coarse_mesh = describe_coarse_mesh(triangulation);
        BinaryWriter     archive;
        archive &coarse_mesh.topology &coarse_mesh.vertices;
        for (const DistributedVector *field : nodal_fields(state))
          archive &(field->size() > 0);
        archive &(indicators.size() > 0);
        archive & output->output_times();
        archive &recorder.elapsed_in_all();
        exchange(archive);
        exchange_preconditioner(archive, preconditioner);
        files[run_file] = archive.bytes();
        // Whose rows the checkpoint relies on.
        recorder.synchronize();
        lines.synchronize();
      }
    directories.write_checkpoint(manifest, files);
  }



  template <int dim>
  std::string
  ViscoplasticContact<dim>::keep_checkpoints(const SignalRequests &signals)
  {
    const State<dim>           &state   = accepted.state;
    const CheckpointParameters &wanted  = parameters.checkpoint;
    const bool                  is_last = is_finished();
    bool                        is_due =
      wanted.every_n_steps > 0 && state.n % wanted.every_n_steps == 0;
    // The last one, for who adds a phase later.
    is_due |=
      is_last && (wanted.every_n_steps > 0 || wanted.wall_time_interval > 0.);
    // The clock of one rank counts.
    bool         is_late = false;
    const double now     = recorder.elapsed();
    if (Utilities::MPI::this_mpi_process(communicator) == 0)
      {
        is_due |= wanted.wall_time_interval > 0. &&
                  now - last_checkpoint >= wanted.wall_time_interval;
        // Would another step as long as this one end in time?
        is_late = wanted.wall_time_limit > 0. &&
                  now + (now - last_step) >= wanted.wall_time_limit;
      }
    last_step = now;

    const SignalRequests::Request request =
      signals.agree(communicator, is_due, is_late);
    const bool stops = !request.stop.empty() && !is_last;
    if (!request.checkpoint && !stops)
      return "";
    write_checkpoint();
    last_checkpoint = recorder.elapsed();
    std::ostringstream text;
    text << "step " << state.n << " (t = " << state.t
         << parameters.units.suffix(Quantity::time, dim) << "): '"
         << directories.checkpoints.path(state.n) << "'";
    if (!stops)
      {
        // Regular ones need no words.
        if (!is_due)
          out << "Checkpoint of " << text.str() << std::endl;
        return "";
      }
    std::ostringstream error;
    if (const auto relative = recorder.relative_error(accepted.errors))
      error << " The error up to there is estimated as " << std::setprecision(2)
            << 100. * *relative << " %.";
    const std::string interruption = request.stop +
                                     " has ended the run after the checkpoint "
                                     "of " +
                                     text.str() + "; --restart goes on." +
                                     error.str();
    console.log() << interruption << std::endl;
    return interruption;
  }



  template <int dim>
  void
  ViscoplasticContact<dim>::resume(const CheckpointManifest &checkpoint)
  {
    State<dim>            &state = accepted.state;
    const CheckpointStore &store = directories.checkpoints;
    const std::string      name = "The checkpoint '" + store.path(checkpoint.n);
    const unsigned int rank    = Utilities::MPI::this_mpi_process(communicator);
    const unsigned int n_ranks = Utilities::MPI::n_mpi_processes(communicator);

    const ParameterChanges changes =
      compare_parameters(checkpoint.parameters, values_with_tables(parameters));
    AssertThrow(checkpoint.dimension == dim && changes.forbidden.empty(),
                ExcMessage(name + "' cannot go on with other unknowns: " +
                           enumeration(changes.forbidden) +
                           "; undo that, or begin without --restart."));
    BinaryReader        archive(store.read(checkpoint, run_file));
    CoarseMesh          coarse_mesh;
    std::array<bool, 4> has_nodal_field;
    bool                has_estimate;
    double              earlier_seconds;
    std::vector<double> output_times;
    archive &coarse_mesh.topology &coarse_mesh.vertices;
    AssertThrow(coarse_mesh.agrees_with(describe_coarse_mesh(triangulation)),
                ExcMessage(name + "' belongs to another coarse mesh."));
    for (bool &has_field : has_nodal_field)
      archive &has_field;
    AssertThrow(has_nodal_field[3] == scene.keeps_friction_work(),
                ExcMessage(name +
                           "' cannot go on with another sum: `friction work' "
                           "among 'Output/Additional fields' has to be there "
                           "from the beginning or not at all."));
    archive &has_estimate &output_times &earlier_seconds;
    exchange(archive);
    std::optional<PreconditionerState> preconditioner;
    exchange_preconditioner(archive, preconditioner);

    // Steps of the phases must be there; others, chosen by the run, must not
    // pass its end.
    const bool is_on_schedule =
      state.n >= 1 &&
      (control.may_reject() ? state.t <= scene.schedule.end_time() :
                              state.n <= scene.schedule.n_steps() &&
                                scene.schedule.step(state.n).t == state.t &&
                                scene.schedule.step(state.n).k == state.k);
    AssertThrow(is_on_schedule,
                ExcMessage("'Time/Phases' = " + parameters.time.phases +
                           " does not contain the step of the checkpoint '" +
                           store.path(checkpoint.n) +
                           "'; change only what comes after it."));

    std::vector<std::string> meshes;
    for (unsigned int r = 0; r < checkpoint.n_ranks; ++r)
      meshes.push_back(store.read(checkpoint, mesh_file(r)));
    restore_mesh(meshes, triangulation);
    const bool is_solution = accepted.is_solution;
    scene.enter_stage(scene.stage_of_step_to(state.t));
    set_up(); // which knows of no solution
    const Discretization<dim> &d = *discretization;

    // On as many ranks as before, each finds all in its own file.
    const auto unpack = [&](const unsigned int begin, const unsigned int end) {
      PackedFields packed{{meshes.begin() + begin, meshes.begin() + end},
                          {},
                          has_nodal_field,
                          has_estimate,
                          ErrorEstimator<dim>::n_sample_fields(scene)};
      for (unsigned int r = begin; r < end; ++r)
        packed.fields.push_back(store.read(checkpoint, fields_file(r)));
      const bool complete =
        unpack_fields(packed,
                      d.stress_space,
                      d.face.get(),
                      state,
                      preconditioner ? &preconditioner->built_for : nullptr,
                      accepted.space_estimate.squared_indicators);
      return Utilities::MPI::min(complete ? 1 : 0, communicator) == 1;
    };
    AssertThrow(((n_ranks == checkpoint.n_ranks && unpack(rank, rank + 1)) ||
                 unpack(0, checkpoint.n_ranks)) &&
                  archive.is_at_end(),
                ExcMessage(name + "' does not fit the scene."));
    time_stepper->method().restore(accepted, preconditioner);
    // Of these data: with others nothing may stay as it is.
    accepted.is_solution = is_solution && !changes.of_data;
    accepted.forces      = evaluate_forces(d.stress_space,
                                      d.matrix,
                                      d.loads.assemble(state.t),
                                      state);

    std::string failure;
    if (rank == 0)
      {
        try
          {
            recorder.write_to(std::make_unique<Statistics>(
              results_directory(parameters) + "statistics.csv", state.n));
          }
        catch (const std::exception &exception)
          {
            failure = reason(exception);
          }
      }
    failure = Utilities::MPI::broadcast(communicator, failure);
    AssertThrow(failure.empty(), ExcMessage(failure));
    output.emplace(scene, communicator);
    output->resume(output_times);
    lines.resume(output->directory(), state.n);
    // A run without checkpoints of its own keeps those that there are.
    const auto        &wanted = parameters.checkpoint;
    const unsigned int n_kept =
      wanted.every_n_steps > 0 || wanted.wall_time_interval > 0. ?
        wanted.keep :
        std::numeric_limits<unsigned int>::max();
    for (const std::string &remark :
         store.remove_others(state.n, n_kept).remarks)
      console.remark(remark);

    out << "Restart after step " << state.n << " (t = " << state.t
        << parameters.units.suffix(Quantity::time, dim) << ") from '"
        << store.path(state.n) << "'" << std::endl;
    remark_on_changes(checkpoint, changes, console);

    recorder.resume(state, earlier_seconds);
    last_checkpoint = recorder.elapsed();
  }



  template class ViscoplasticContact<2>;
  template class ViscoplasticContact<3>;
} // namespace Viscoplastic
