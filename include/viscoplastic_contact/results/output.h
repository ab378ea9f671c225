// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/contact_face.h>
#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/discretization/state.h>
#include <viscoplastic_contact/results/run_record.h>

#include <functional>
#include <future>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  template <int cell_dim, int dim>
  struct OutputGrid;
  struct DataSet;

  /// Results in one directory: fields of the body (solution.pvd; revolved.pvd
  /// for bodies of revolution) and of Gamma_3 (contact.pvd; opposite.pvd for
  /// primary sides) as VTU series, those of the body also in HDF5
  /// (solution.xdmf), and what reproduces the run (parameters.prm, run.json).
  template <int dim>
  class Output
  {
  public:
    /// Writes the record of the run. Collective. Throws ExcMessage if the
    /// directory, which exists, has other files with the names of results.
    Output(const Scene<dim> &scene, const MPI_Comm communicator);

    /// Continue after the outputs at the times @p earlier, which are all that
    /// the series list. On all ranks.
    void
    resume(const std::vector<double> &earlier);

    const std::vector<double> &
    output_times() const
    {
      return times;
    }

    /// Complete the record of the run. On all ranks.
    void
    record_end(const RunEnd<dim> &end) const;

    const std::string &
    directory() const
    {
      return path;
    }

    /// Whether the fields at the end of @p step are to be written.
    bool
    is_due(const TimeStep &step) const;

    /// Write the fields of a state, including `Output/Additional fields'. @p
    /// face is null without contact points, @p squared_estimate without an
    /// estimator. In a run with one rank, a thread writes the files in the
    /// background, one output at a time. Collective.
    void
    write_fields(const FlowLaws<dim>    &laws,
                 const State<dim>       &state,
                 const ContactFace<dim> *face,
                 const Vector<double>   *squared_estimate);

    /// Wait for the files of the last output. Throws ExcMessage if writing them
    /// has failed. On all ranks.
    void
    finish()
    {
      if (writing.valid())
        writing.get();
    }

    /// Throw ExcMessage if writing the last output is known to have failed.
    void
    report_failure();

  private:
    /// Write the faces of the boundary with their ids, once, on the mesh of the
    /// first output; pictures show supports and loads there.
    void
    write_boundary(const AdmissibleSpace<dim> &space);
    void
    write_body(const FlowLaws<dim>  &laws,
               const State<dim>     &state,
               const Vector<double> *squared_estimate);
    /// Write Gamma_3 ("contact") or the primary boundaries ("opposite").
    void
    write_contact(const std::string      &name,
                  const StressSpace<dim> &stress_space,
                  const State<dim>       &state,
                  const ContactFace<dim> *face);
    /// Queue the piece of this rank and, on rank 0, the record of all pieces
    /// and that of the series for the next write_in_background().
    template <typename Grid>
    void
    write_vtu(const std::string &name,
              Grid               grid, // an OutputGrid
              const bool         is_series = true);
    /// As write_vtu(), for the body.
    void
    write_in_hdf5(const AdmissibleSpace<dim> &space,
                  const OutputGrid<dim, dim> &body,
                  const double                t);
    /// Start writing the queued `files`; with several ranks, which leave no
    /// processor idle, write them at once.
    void
    write_in_background();
    /// The name and the text of the file that lists the outputs of a series.
    std::pair<std::string, std::string>
    list(const std::string &name) const;
    /// Whether the files of a series are in HDF5.
    bool
    is_in_hdf5(const std::string &name) const;
    std::vector<std::string>
    series() const;
    /// Throw ExcMessage if results would overwrite files that another program
    /// has written. On one rank.
    void
    refuse_foreign_files() const;
    /// Remove files of fields, of earlier runs or of times after the last
    /// output, that no list names, and those of more lines. On one rank.
    void
    remove_unlisted_files() const;

    const Scene<dim>   &scene;
    const MPI_Comm      communicator;
    std::string         path; // ends with a slash
    std::vector<double> times;
    /// The mesh of the last output in HDF5, and the file that contains it.
    std::shared_ptr<const std::vector<DataSet>> mesh;
    std::string                                 mesh_file;
    /// Functions that write the files of the last output.
    std::vector<std::function<void()>> files;
    /// Ready when the files are written, for which its destructor waits.
    std::future<void> writing;
  };
} // namespace Viscoplastic
