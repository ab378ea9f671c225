// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/results/field_probes.h>
#include <viscoplastic_contact/results/statistics.h>

#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The name of the file of the i-th line, counted from 0: `line_0.csv'.
  std::string
  line_file_name(const std::size_t i);


  /// The files of `Output/Lines': comma separated values with a row for each
  /// point of the line, time by time. Does nothing in a scene without lines.
  template <int dim>
  class LineOutput
  {
  public:
    /// Keeps a reference to @p scene.
    explicit LineOutput(const Scene<dim> &scene);

    /// Set the present mesh and keep a reference to it. Points are located at
    /// the next output.
    void
    set_mesh(const Discretization<dim> &on_mesh)
    {
      discretization = &on_mesh;
      probes.clear();
    }

    /// Begin new files in a directory, or continue after step @p last_step,
    /// dropping later rows. Throws ExcMessage if a file is missing or cannot be
    /// written, as the functions below do. Collective.
    void
    open(const std::string                 &directory,
         const std::optional<unsigned int> &last_step = {});

    /// Write a state if it is due. @p fields_are_due: whether the fields of
    /// this state are written. Collective.
    void
    write(const State<dim> &state, const bool fields_are_due);

    /// Flush all rows to disk. On rank 0.
    void
    synchronize();

  private:
    const Scene<dim>          &scene;
    std::set<RecordedField>    fields;
    const Discretization<dim> *discretization = nullptr;
    /// The fields along each line on the present mesh; empty until the first
    /// output.
    std::vector<FieldProbes<dim>> probes;
    /// Empty on ranks other than 0.
    std::vector<TableFile> files;
  };
} // namespace Viscoplastic
