// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/results/line_output.h>
#include <viscoplastic_contact/results/statistics.h>
#include <viscoplastic_contact/results/unit_labels.h>

#include <iomanip>

namespace Viscoplastic
{
  std::string
  line_file_name(const std::size_t i)
  {
    return "line_" + std::to_string(i) + ".csv";
  }



  template <int dim>
  LineOutput<dim>::LineOutput(const Scene<dim> &scene)
    : scene(scene)
    , fields(scene.parameters.output.line_fields)
  {
    fields.insert(RecordedField::displacement);
  }



  template <int dim>
  void
  LineOutput<dim>::open(const std::string                 &directory,
                        const std::optional<unsigned int> &last_step)
  {
    const MPI_Comm communicator = discretization->space.communicator;
    names.clear();
    files.clear();
    if (Utilities::MPI::this_mpi_process(communicator) == 0)
      for (std::size_t i = 0; i < scene.output_lines.size(); ++i)
        names.push_back(directory + line_file_name(i));
    fail_together(communicator, [&] {
      std::vector<TableBeginning> beginnings;
      for (const std::string &name : names)
        if (last_step)
          beginnings.push_back(beginning_of_table(name, *last_step));
        else
          require_writable_file(name);
      for (std::size_t i = 0; i < names.size(); ++i)
        {
          files.push_back(last_step ? append_to_table(names[i], beginnings[i]) :
                                      std::ofstream(names[i]));
          if (!files.back())
            refuse("The file '" + names[i] + "' cannot be written.");
        }
    });
  }



  template <int dim>
  void
  LineOutput<dim>::write(const State<dim> &state, const bool fields_are_due)
  {
    if (scene.output_lines.empty() ||
        !(fields_are_due || scene.parameters.output.lines_every_step))
      return;
    if (probes.empty())
      for (const OutputLine<dim> &line : scene.output_lines)
        probes.push_back(std::make_unique<FieldProbes<dim>>(*discretization,
                                                            line.points(),
                                                            fields));
    for (std::size_t i = 0; i < probes.size(); ++i)
      {
        const std::vector<double> values = probes[i]->values(state);
        fail_together(discretization->space.communicator, [&] {
          if (files.empty())
            return;
          std::ofstream                  &file    = files[i];
          const std::vector<std::string> &columns = probes[i]->names();
          if (state.n == 0)
            {
              const Units      &units  = scene.parameters.units;
              const std::string length = units.label(Quantity::length, dim);
              file << "step,t" << units.label(Quantity::time, dim) << ",s"
                   << length;
              for (unsigned int d = 0; d < dim; ++d)
                file << ',' << "xyz"[d] << length;
              for (const std::string &column : columns)
                file << ',' << column << label_of_field(scene, column);
              file << '\n';
            }
          file << std::setprecision(12);
          const OutputLine<dim>        &line   = scene.output_lines[i];
          const std::vector<Point<dim>> points = line.points();
          const double                 *value  = values.data();
          for (std::size_t p = 0; p < points.size(); ++p)
            {
              file << state.n << ',' << state.t << ',' << line.distance(p);
              for (unsigned int d = 0; d < dim; ++d)
                file << ',' << points[p][d];
              for (std::size_t c = 0; c < columns.size(); ++c)
                file << ',' << *value++;
              file << '\n';
            }
          file << std::flush;
          if (!file)
            refuse("Writing to '" + names[i] + "' failed; is the disk full?");
        });
      }
  }



  template <int dim>
  void
  LineOutput<dim>::synchronize()
  {
    // The streams have been flushed by write().
    for (const std::string &name : names)
      Viscoplastic::synchronize(name);
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(LineOutput);
} // namespace Viscoplastic
