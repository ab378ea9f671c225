// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/results/line_output.h>

#include <iomanip>
#include <sstream>

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
          files.push_back(
            std::make_unique<TableFile>(directory + line_file_name(i),
                                        last_step));
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
          std::ostringstream              file;
          const std::vector<FieldColumn> &columns = probes[i]->columns();
          if (state.n == 0)
            {
              const Units      &units  = scene.parameters.units;
              const std::string length = units.label(Quantity::length, dim);
              file << "step,t" << units.label(Quantity::time, dim) << ",s"
                   << length;
              for (unsigned int d = 0; d < dim; ++d)
                file << ',' << "xyz"[d] << length;
              for (const FieldColumn &column : columns)
                file << ',' << column.name << units.label(column.quantity, dim);
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
          files[i]->write(file.str());
        });
      }
  }



  template <int dim>
  void
  LineOutput<dim>::synchronize()
  {
    for (const auto &file : files)
      file->synchronize();
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(LineOutput);
} // namespace Viscoplastic
