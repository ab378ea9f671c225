// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/contact_face.h>
#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/discretization/state.h>
#include <viscoplastic_contact/results/run_record.h>

#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  template <int dim>
  struct BodyData;
  struct DataSet;

  /// Results in one directory: fields of the body (solution.pvd; revolved.pvd
  /// of one of revolution) and of Gamma_3 (contact.pvd; opposite.pvd on other
  /// bodies) as VTU series, the body also as HDF5 (solution.xdmf), and what is
  /// needed to reproduce the run (parameters.prm, run.json).
  template <int dim>
  class Output
  {
  public:
    /// Makes the directory and writes the record of the run. Collective. Throws
    /// ExcMessage if the directory cannot be written, or has files of somebody
    /// else under the names of results.
    Output(const Scene<dim> &scene, const MPI_Comm communicator);

    /// Go on after the outputs at the times @p earlier: the series list these
    /// and no later ones. On all ranks.
    void
    resume(const std::vector<double> &earlier);

    const std::vector<double> &
    output_times() const
    {
      return times;
    }

    /// Add the estimated error, the costs and what the run has remarked on to
    /// its record. On all ranks.
    void
    record_end(const RunSummary<dim>          &summary,
               const RunCosts                 &costs,
               const std::vector<std::string> &remarks) const;

    const std::string &
    directory() const
    {
      return path;
    }

    /// Whether the fields of step @p n, from t_old to t, are to be written.
    bool
    is_due(const TimeStep &step) const;

    /// Write the fields of a state, those of `Output/Additional fields' among
    /// them. @p face is null without contact points,
    /// @p squared_estimate without an estimator. Returns sentences about fields
    /// that are beyond the range of the files for the first time. On one rank
    /// files are written by a thread of its own while the run goes on, one
    /// output at a time. Collective.
    std::vector<std::string>
    write_fields(const FlowLaws<dim>    &laws,
                 const State<dim>       &state,
                 const ContactFace<dim> *face,
                 const Vector<double>   *squared_estimate);

    /// Wait for the files of the last output. Throws ExcMessage if they could
    /// not be written. On all ranks.
    void
    finish()
    {
      if (writing.valid())
        writing.get();
    }

    /// Throw ExcMessage if it is known by now that the files of the last output
    /// cannot be written.
    void
    report_failure();

  private:
    /// Write the faces of the boundary with their ids, once, as they are at
    /// the first output: pictures draw supports and loads there.
    void
    write_boundary(const AdmissibleSpace<dim> &space);
    // What these return: see write_fields().
    std::string
    write_body(const FlowLaws<dim>  &laws,
               const State<dim>     &state,
               const Vector<double> *squared_estimate);
    /// Write Gamma_3 ("contact") or the primary boundaries ("opposite").
    std::string
    write_contact(const std::string      &name,
                  const StressSpace<dim> &stress_space,
                  const State<dim>       &state,
                  const ContactFace<dim> *face);
    /// Have the piece of this rank and, on rank 0, the record of all of them
    /// and that of the series written by the next write_in_background().
    template <typename Data>
    std::string
    write_vtu(const std::string &name,
              Data               data, // a PatchOutput
              const bool         is_series = true);
    /// As write_vtu(), of the body.
    std::string
    write_in_hdf5(const BodyData<dim> &body, const double t);
    /// A sentence about data sets of a file whose values have been cut off for
    /// the first time: their indices, the number of data sets for the
    /// coordinates. Collective.
    std::string
    remark_on_range(const std::string              &file,
                    const std::vector<std::string> &data_sets,
                    const std::set<unsigned int>   &cut_off);
    /// Begin to write what is in `files`; with several ranks, which leave no
    /// processor idle, write it.
    void
    write_in_background();
    /// The file that lists the outputs of a series, and its text.
    std::pair<std::string, std::string>
    list(const std::string &name) const;
    /// Whether these files are in HDF5.
    bool
    is_in_hdf5(const std::string &name) const;
    std::vector<std::string>
    series() const;
    /// Remove pieces of outputs that do not count, on rank 0: those behind the
    /// last one, and those that no record lists any more. Returns how many.
    std::size_t
    remove_others(const std::string &name, const std::size_t n_outputs) const;
    /// Remove what an earlier run has left in the directory, on rank 0.
    void
    remove_files_of_earlier_run() const;

    const Scene<dim>   &scene;
    const MPI_Comm      communicator;
    std::string         path; // ends with a slash
    std::vector<double> times;
    /// The mesh of the last output in HDF5, and the file that has it.
    std::shared_ptr<const std::vector<DataSet>> mesh;
    std::string                                 mesh_file;
    /// What writes the files of the output at the last of these times.
    std::vector<std::function<void()>> files;
    /// Done when they are written; its destructor waits for that.
    std::future<void> writing;
    /// Fields that the user has been told of.
    std::set<std::string> cut_fields;
  };
} // namespace Viscoplastic
