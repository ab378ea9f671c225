// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/results/field_probes.h>

#include <fstream>
#include <memory>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The name of the file of the i-th line, counted from 0: `line_0.csv'.
  std::string
  line_file_name(const std::size_t i);


  /// The files of `Output/Lines': comma separated values, a row for each point
  /// of the line at each time, one time after the other. Nothing is done in a
  /// scene without lines.
  template <int dim>
  class LineOutput
  {
  public:
    /// @p scene stays in use.
    explicit LineOutput(const Scene<dim> &scene);

    /// The body is on another mesh now, which stays in use. The points are
    /// looked for at the next output.
    void
    set_mesh(const Discretization<dim> &on_mesh)
    {
      discretization = &on_mesh;
      probes.clear();
    }

    /// Begin the files anew in a directory. Collective. Throws ExcMessage if
    /// they cannot be written, as the other functions do.
    void
    begin(const std::string &directory);

    /// Go on after step @p last_step: later rows go. Collective. Also throws
    /// ExcMessage if the files are not there, before any has changed.
    void
    resume(const std::string &directory, const unsigned int last_step);

    /// Write a state if its turn has come. @p fields_are_due: whether the
    /// fields of this state are written. Collective.
    void
    write(const State<dim> &state, const bool fields_are_due);

    /// Put all rows to disk. On rank 0.
    void
    synchronize();

  private:
    /// Set the names of the files that rank 0 writes; other ranks have none.
    void
    name_files(const std::string &directory);

    const Scene<dim>          &scene;
    std::set<RecordedField>    fields;
    const Discretization<dim> *discretization = nullptr;
    /// The fields along each line on the present mesh; empty until they are
    /// needed.
    std::vector<std::unique_ptr<FieldProbes<dim>>> probes;
    std::vector<std::string>                       names;
    std::vector<std::ofstream>                     files;
  };
} // namespace Viscoplastic
