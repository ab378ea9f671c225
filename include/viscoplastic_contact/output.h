// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/contact_face.h>
#include <viscoplastic_contact/error_ledger.h>
#include <viscoplastic_contact/state.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  /// `Output/Directory', or what it is by default; ends with a slash.
  std::string
  results_directory(const Parameters &parameters);



  /**
   * Results in one directory: fields of the body (solution.pvd) and of Gamma_3
   * (contact.pvd) as VTU series, and what is needed to reproduce the run
   * (parameters.prm, run.json).
   */
  template <int dim>
  class Output
  {
  public:
    /**
     * Makes the directory and writes the record of the run. Collective. Throws
     * ExcMessage if the directory cannot be written.
     */
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

    /// Add the estimated error to the record of the run. On all ranks.
    void
    record_errors(const ErrorSummary &errors) const;

    const std::string &
    directory() const
    {
      return path;
    }

    /// Whether the fields of step @p n, from t_old to t, are to be written.
    bool
    is_due(const TimeStep &step) const;

    /**
     * Write the fields of a state. @p face is null without friction,
     * @p squared_estimate without an estimator. Collective.
     */
    void
    write_fields(const StressSampling<dim> &sampling,
                 const State<dim>          &state,
                 const ContactFace<dim>    *face,
                 const Vector<double>      *squared_estimate);

  private:
    void
    write_body(const StressSampling<dim> &sampling,
               const State<dim>          &state,
               const Vector<double>      *squared_estimate);
    void
    write_contact(const AdmissibleSpace<dim> &space,
                  const State<dim>           &state,
                  const ContactFace<dim>     *face);
    void
    write_pvd(const std::string &name) const;
    /// Remove pieces of outputs that do not count, on rank 0.
    void
    remove_later(const std::string &name) const;

    const Scene<dim>   &scene;
    const MPI_Comm      communicator;
    std::string         path; // ends with a slash
    std::vector<double> times;
  };
} // namespace Viscoplastic
