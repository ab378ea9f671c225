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
    /// The runs of the scene that @p files and @p overrides give, as for
    /// Parameters. Throws ExcMessage.
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
    /// Runs with larger tolerances have hardly an error that obeys a law.
    static constexpr double largest_tolerance = 0.5;
    /// The time steps of the scene.
    const std::vector<StepsUntil> phases;

    /// Cells and mesh width of the scene as it is: the largest diameter of a
    /// cell over sqrt(dim).
    double n_cells = 0., h = 0.;

    /// The run that writes its fields, and with whose fields those of all
    /// others are compared, if any. Records of runs that have been compared
    /// with another one, or none, do not count as finished.
    std::optional<RunKey> reference;

    /// Whether runs divide given steps beyond the stability limit where the
    /// scene does. Otherwise they have the given steps, or fail.
    bool may_subdivide = false;

    /// Whether runs write fields and checkpoints as the scene does.
    bool has_outputs = false;

    /// Make the directory of the study, and take its lock, so that no two
    /// studies make the same runs at once.
    void
    lock_directory();

    /// The run of the scene as it is.
    RunKey
    scene_key() const;

    /// After how many of its steps a run has a new mesh: as the scene says if
    /// that is adaptive, else ten times in all; 0 for uniform meshes.
    unsigned int
    steps_per_mesh(const MeshStrategy strategy,
                   const unsigned int n_steps) const;

    /// How often a run of so many steps is set up, once for each of its meshes,
    /// where its phases have @p n_planned steps: by step control these are
    /// others.
    double
    n_set_ups(const MeshStrategy strategy,
              const double       n_steps,
              const unsigned int n_planned) const;

    /// The phases of time of a run: those of the scene with twice the steps for
    /// each time level.
    std::vector<StepsUntil>
    phases_of(const RunKey &key) const;

    /// The tolerance of a run's steps where step control chooses them, so that
    /// they are half as long for each time level: half of the scene's, or a
    /// quarter with a scheme of second order. 0 where steps are given.
    double
    step_tolerance(const RunKey &key) const;

    /// The tolerance of a run that chooses meshes and steps itself: that of the
    /// scene, halved level by level. 0 of other runs.
    double
    tolerance(const RunKey &key) const;

    /// Of a scene with a tolerance: the level of the largest one that still
    /// asks for something.
    int
    coarsest_tolerance_level() const;

    /// How often the mesh can be made coarser by halving.
    int
    n_coarser_meshes() const;

    /// The name of a run and of its directory.
    std::string
    name(const RunKey &key) const;

    /// All overrides that make the run of the scene. Throws ExcMessage for a
    /// mesh that is too coarse.
    std::vector<std::string>
    overrides_of(const RunKey &key) const;

    /// Those of the overrides that choose mesh, steps and method, for steps of
    /// any number, or to any tolerance of the steps where the scene has one.
    std::vector<std::string>
    discretization(const RunKey                  &key,
                   const std::vector<StepsUntil> &steps,
                   const double                   step_tolerance) const;

    /// The record of a run that is finished. One that is damaged or belongs
    /// to something else does not count.
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

    /// The width that a uniform mesh with so many cells would have.
    double
    mesh_width(const double n_cells) const;

  private:
    /// Whether a run is compared with the reference.
    bool
    is_compared(const RunKey &key) const
    {
      return reference && !(key == *reference) && !key.is_timing;
    }

    /// What tells a run from those of other scenes and programs.
    std::map<std::string, std::string>
    stamp(const Parameters &parameters, const RunKey &key) const;

    MPI_Comm      communicator, agreement;
    DirectoryLock lock; // on rank 0
  };


  /**
   * Run a scene and measure it. Returns the sentence of a signal, if one has
   * ended the run early. Collective.
   */
  std::string
  run_scene(const Parameters          &parameters,
            Console                   &console,
            const CommandLine::Restart restart,
            RunMeasurements           &measurements);

} // namespace Viscoplastic
