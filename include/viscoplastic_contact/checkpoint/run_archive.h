// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/checkpoint/checkpoint_fields.h>
#include <viscoplastic_contact/checkpoint/checkpoint_store.h>
#include <viscoplastic_contact/error/error_budget.h>
#include <viscoplastic_contact/results/recorder.h>
#include <viscoplastic_contact/time_stepping/time_stepper.h>

#include <map>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The position of a run that repeats its time interval in passes, see
  /// run_in_passes().
  struct PassState
  {
    bool follows_another = false, has_changed_mesh = false;
  };



  /// The complete state of a run between two steps, except for its mesh, which
  /// a restart restores.
  template <int dim>
  struct RunState
  {
    const Scene<dim>    &scene;
    EvaluatedState<dim> &accepted;
    StepControl         &control;
    ErrorBudget         *budget; // null without a tolerance
    PassState           &pass;
    Recorder<dim>       &recorder;
  };

  /// The differences between the parameters of a run and those of its
  /// checkpoint.
  struct ParameterChanges
  {
    /// Sentences as "'Time/Phases' is 2: 20 (was 1: 10)" on changes with which
    /// a run can continue, and on those with which it cannot.
    std::vector<std::string> allowed, forbidden;
    /// Whether an allowed change concerns loads, boundary conditions or laws.
    bool of_data = false;
  };

  /// The contents of a checkpoint: manifest, and files of this rank by name.
  struct PackedRun
  {
    CheckpointManifest                 manifest;
    std::map<std::string, std::string> files;
  };

  /// Pack a run. @p output_times: times of the fields written. Collective.
  template <int dim>
  PackedRun
  pack_run(RunState<dim>                                   &run,
           const parallel::distributed::Triangulation<dim> &triangulation,
           const Discretization<dim>                       &discretization,
           const TimeStepper<dim>                          &time_stepper,
           const std::vector<double>                       &output_times);

  /// What a checkpoint has besides the state and the members of RunState.
  struct ArchivedData
  {
    /// The results of pack_mesh() by rank.
    std::vector<std::vector<unsigned int>> meshes;
    /// Which fields were present, of the state and of the quantity of interest,
    /// and whether there was an estimate of the error of the mesh.
    std::array<std::vector<bool>, 2> fields;
    bool                             has_estimate = false;
    /// Whether the state solves the step that it ends.
    bool is_solution = false;
    /// The times of the fields written, and the seconds that the run had taken.
    std::vector<double> output_times;
    double              earlier_seconds = 0.;
  };

  /// A checkpoint from which a run continues. It is read in two parts, since
  /// fields need a discretization, which needs the mesh. Errors are ExcMessage
  /// with a sentence for the user. Collective.
  template <int dim>
  class RunArchive
  {
  public:
    /// Read the data common to all ranks into @p run and restore the mesh.
    /// Throws if the checkpoint belongs to another scene. Keeps references to
    /// the first three arguments.
    RunArchive(const CheckpointStore                     &store,
               const CheckpointManifest                  &checkpoint,
               RunState<dim>                             &run,
               parallel::distributed::Triangulation<dim> &triangulation);

    /// Read the fields of the accepted state, and evaluate its forces. Returns
    /// the data that the time stepper keeps between steps.
    StepperMemory<dim>
    read_fields(const Discretization<dim> &discretization);

    /// Tell the user how this run differs from that of the checkpoint.
    void
    remark_on_changes(Console &console) const;

    /// Parameters that have changed since the checkpoint was written.
    const ParameterChanges changes;
    ArchivedData           data;

  private:
    /// Return the values of the owned cells from the files of this kind.
    CellValues
    read_cells(const std::string          &kind,
               const AdmissibleSpace<dim> &space) const;

    const CheckpointStore    &store;
    const CheckpointManifest &checkpoint;
    RunState<dim>            &run;
    StepperMemory<dim>        memory;
  };
} // namespace Viscoplastic
