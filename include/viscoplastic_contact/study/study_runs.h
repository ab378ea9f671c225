// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/parameters/parameter_file.h>
#include <viscoplastic_contact/run/command_line.h>
#include <viscoplastic_contact/study/price_list.h>
#include <viscoplastic_contact/study/study_record.h>

#include <optional>

namespace Viscoplastic
{
  /**
   * The runs of one scene on other meshes and with other steps, each in a
   * directory of its own below that of the study. A finished run leaves
   * result.json there, which is written at once (a file is renamed) and last of
   * all: a run is finished if that file exists and belongs to the same scene,
   * program and number of ranks. Member functions are collective.
   */
  class StudyRuns
  {
  public:
    /// @p overrides of all runs, as for Parameters. Throws ExcMessage.
    StudyRuns(const std::vector<std::string> &files,
              const std::vector<std::string> &overrides,
              const MPI_Comm                  communicator);

    ~StudyRuns();

    StudyRuns(const StudyRuns &) = delete;
    StudyRuns &
    operator=(const StudyRuns &) = delete;

    const std::vector<std::string> files, overrides;
    const Parameters               scene;
    /// `study/' in the directory of results.
    const std::string directory;
    /// Steps of the scene.
    const std::vector<StepsUntil> phases;

    /// Cells and mesh width of the scene as it is: the largest diameter of a
    /// cell over sqrt(dim).
    double n_cells = 0., h = 0.;

    /// The run that writes its fields, and with whose fields those of all
    /// others are compared, if any. Records of runs that have been compared
    /// with another one, or none, do not count as finished.
    std::optional<RunKey> reference;

    /// Make the directory of the study, and take its lock, so that no two
    /// studies make the same runs at once.
    void
    lock_directory();

    /// The scene as it is.
    RunKey
    scene_key() const;

    /// How often the mesh can be made coarser by halving.
    int
    n_coarser_meshes() const;

    std::string
    name(const RunKey &key) const;

    /// All overrides that make the run of the scene. Throws ExcMessage for a
    /// mesh that is too coarse.
    std::vector<std::string>
    overrides_of(const RunKey &key) const;

    /// What overrides_of() says of mesh and steps, for steps of any number.
    std::vector<std::string>
    discretisation(const RunKey                  &key,
                   const std::vector<StepsUntil> &steps) const;

    /// The record of a finished run.
    std::optional<RunRecord>
    find(const RunKey &key) const;

    /// How a run has ended: one of these.
    struct Outcome
    {
      std::optional<RunRecord> record;
      /// Sentences: why the scene could not be computed, or which signal has
      /// ended it.
      std::string failure, interruption;
    };

    /// Compute a run. It goes on from a checkpoint that a signal has left.
    Outcome
    make(const RunKey &key) const;

    /// Mean number of cells to the mesh width that a uniform mesh would have.
    double
    mesh_width(const double n_cells) const;

  private:
    std::map<std::string, std::string>
    stamp(const Parameters &parameters) const;

    MPI_Comm      communicator, agreement;
    DirectoryLock lock; // on rank 0
  };


  /**
   * Run a scene. Returns the sentence of a signal, if one has ended it early;
   * @p measurements may be null. Collective.
   */
  std::string
  run_scene(const Parameters          &parameters,
            Console                   &console,
            const CommandLine::Restart restart,
            RunMeasurements           *measurements);

} // namespace Viscoplastic
