// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/results/line_output.h>
#include <viscoplastic_contact/results/unit_labels.h>

#include <cstdlib>
#include <filesystem>
#include <iomanip>

namespace Viscoplastic
{
  namespace
  {
    /// The displacement and what the scene asks for besides.
    std::set<RecordedField>
    fields_of_lines(const OutputParameters &asked)
    {
      std::set<RecordedField> result = asked.line_fields;
      result.insert(RecordedField::displacement);
      return result;
    }



    /// How many bytes of a file belong to steps up to one. Throws ExcMessage
    /// if it has no complete row of that step's output or an earlier one.
    std::uintmax_t
    size_up_to(const std::string &name, const unsigned int last_step)
    {
      std::ifstream  file(name, std::ios::binary);
      std::string    line;
      std::uintmax_t size   = 0;
      std::size_t    n_rows = 0;
      // A line without its end is unfinished.
      for (bool is_header = true; std::getline(file, line) && !file.eof();
           is_header      = false)
        {
               if (!is_header)
            {
                   if (std::strtoul(line.c_str(), nullptr, 10) > last_step)
                break;
              ++n_rows;
            }
          size += line.size() + 1;
        }
      AssertThrow(n_rows > 0,
                  ExcMessage("The rows up to step " +
                             std::to_string(last_step) +
                             ", with which the run would go on, are not in '" +
                             name + "'."));
      return size;
    }



    void
    check(const std::ofstream &file, const std::string &name)
    {
      AssertThrow(file,
                  ExcMessage("Writing to '" + name +
                             "' failed; is the disk full?"));
    }
  } // namespace



  std::string
  line_file_name(const std::size_t i)
  {
    return "line_" + std::to_string(i) + ".csv";
  }



  template <int dim>
  LineOutput<dim>::LineOutput(const Scene<dim> &scene)
    : scene(scene)
    , fields(fields_of_lines(scene.parameters.output))
  {}



  template <int dim>
  void
  LineOutput<dim>::name_files(const std::string &directory)
  {
    names.clear();
    files.clear();
    if (Utilities::MPI::this_mpi_process(discretization->space.communicator) ==
        0)
      for (std::size_t i = 0; i < scene.output_lines.size(); ++i)
        names.push_back(directory + line_file_name(i));
  }



  template <int dim>
  void
  LineOutput<dim>::begin(const std::string &directory)
  {
    name_files(directory);
    fail_together(discretization->space.communicator, [this] {
      for (const std::string &name : names)
        {
          require_writable_file(name);
          files.emplace_back(name);
          AssertThrow(files.back(),
                      ExcMessage("The file '" + name + "' cannot be written."));
        }
    });
  }



  template <int dim>
  void
  LineOutput<dim>::resume(const std::string &directory,
                          const unsigned int last_step)
  {
    name_files(directory);
    fail_together(discretization->space.communicator, [&] {
      std::vector<std::uintmax_t> sizes;
      for (const std::string &name : names)
        {
          require_writable_file(name);
          sizes.push_back(size_up_to(name, last_step));
        }
      for (std::size_t i = 0; i < names.size(); ++i)
        {
          std::error_code error;
          std::filesystem::resize_file(names[i], sizes[i], error);
          files.emplace_back(names[i], std::ios::app);
          AssertThrow(!error && files.back(),
                      ExcMessage("The file '" + names[i] +
                                 "' cannot be written."));
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
          check(file, names[i]);
        });
      }
  }



  template <int dim>
  void
  LineOutput<dim>::synchronize()
  {
    // The streams have no buffer left.
    for (const std::string &name : names)
      Viscoplastic::synchronize(name);
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(LineOutput);
} // namespace Viscoplastic
