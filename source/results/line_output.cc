// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/results/line_output.h>

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
    files.clear();
    fail_together(communicator, [&] {
      if (Utilities::MPI::this_mpi_process(communicator) == 0)
        for (std::size_t i = 0; i < scene.output_lines.size(); ++i)
          files.emplace_back(directory + line_file_name(i),
                             scene.parameters.units,
                             dim,
                             last_step);
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
        probes.emplace_back(*discretization, line.points(), fields);
    for (std::size_t i = 0; i < probes.size(); ++i)
      {
        const std::vector<double> values = probes[i].values(state);
        fail_together(discretization->space.communicator, [&] {
          if (files.empty())
            return;
          const OutputLine<dim>        &line   = scene.output_lines[i];
          const std::vector<Point<dim>> points = line.points();
          const double                 *value  = values.data();
          for (std::size_t p = 0; p < points.size(); ++p)
            {
              TableRow row;
              row.add("step", state.n);
              row.add("t", state.t, Quantity::time);
              row.add("s", line.distance(p), Quantity::length);
              for (unsigned int d = 0; d < dim; ++d)
                row.add({"xyz"[d]}, points[p][d], Quantity::length);
              for (const FieldColumn &column : probes[i].columns())
                row.add(column.name, *value++, column.quantity);
              files[i].write(row);
            }
          files[i].flush();
        });
      }
  }



  template <int dim>
  void
  LineOutput<dim>::synchronize()
  {
    for (const TableFile &file : files)
      file.synchronize();
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(LineOutput);
} // namespace Viscoplastic
