// SPDX-License-Identifier: LGPL-2.1-or-later
#include "output_grid.h"
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/results/line_output.h>
#include <viscoplastic_contact/results/output.h>

#include <filesystem>
#include <iomanip>
#include <regex>
#include <sstream>

// The files of a directory of results: which ones belong to a run, and what
// lists them.

namespace Viscoplastic
{
  namespace
  {
    /// The text of a PVD file that lists a series and its times for ParaView.
    std::string
    pvd_record(const std::string &series, const std::vector<double> &times)
    {
      std::vector<std::pair<double, std::string>> records;
      for (unsigned int i = 0; i < times.size(); ++i)
        records.emplace_back(times[i], record_name(series, i) + ".pvtu");
      std::ostringstream text;
      text << std::setprecision(15);
      DataOutBase::write_pvd_record(text, records);
      return text.str();
    }



    /// The same in XDMF. Each time has its own file, so that earlier outputs
    /// are not rewritten; all three readers of ParaView require this pointer.
    std::string
    xdmf_record(const std::string &series, const std::size_t n_outputs)
    {
      std::string text =
        "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\" "
        "xmlns:xi=\"http://www.w3.org/2001/XInclude\">\n<Domain>\n<Grid "
        "Name=\"body\" GridType=\"Collection\" "
        "CollectionType=\"Temporal\">\n";
      for (unsigned int i = 0; i < n_outputs; ++i)
        text += "<xi:include href=\"" + record_name(series, i) +
                ".xml\" xpointer=\"element(/1)\"/>\n";
      return text + "</Grid>\n</Domain>\n</Xdmf>\n";
    }



    constexpr const char *beginning_of_lines = "step,t,s,x,y,";



    /// Whether a file begins like a file of this program.
    bool
    is_own(const std::string &name, const std::string &beginning)
    {
      std::ifstream file(name, std::ios::binary);
      std::string   text(200, ' ');
      file.read(text.data(), static_cast<std::streamsize>(text.size()));
      text.resize(file.gcount());
      // Names of columns may be followed by unit labels.
      static const std::regex label(" \\[[^\\]\n]*\\]?");
      text = std::regex_replace(text, label, "").substr(0, beginning.size());
      // The file may be truncated.
      return file.is_open() && beginning.compare(0, text.size(), text) == 0;
    }
  } // namespace



  template <int dim>
  void
  Output<dim>::refuse_foreign_files() const
  {
    std::vector<std::pair<std::string, std::string>> own{
      {"parameters.prm", "# Listing of Parameters\n"},
      {"run.json", "{\n  \"program\": \"viscoplastic_contact\""},
      {"statistics.csv", "step,t,k,"}};
    for (std::size_t i = 0; i < scene.output_lines.size(); ++i)
      own.emplace_back(line_file_name(i), beginning_of_lines);
    for (const auto &[name, beginning] : own)
      if (std::error_code none;
          std::filesystem::is_regular_file(path + name, none) &&
          !is_own(path + name, beginning))
        refuse("The results would overwrite '" + path + name +
               "', which this program has not written; choose another "
               "'Output/Directory'.");
  }



  template <int dim>
  std::vector<std::string>
  Output<dim>::series() const
  {
    std::vector<std::string> result{"solution"};
    if (scene.has_contact())
      result.emplace_back("contact");
    if (scene.has_contact_pairs())
      result.emplace_back("opposite");
    if (scene.parameters.output.revolved_angle > 0.)
      result.emplace_back("revolved");
    return result;
  }



  template <int dim>
  bool
  Output<dim>::is_in_hdf5(const std::string &name) const
  {
    return scene.parameters.output.in_hdf5 && name == "solution";
  }



  template <int dim>
  std::pair<std::string, std::string>
  Output<dim>::list(const std::string &name) const
  {
    return is_in_hdf5(name) ?
             std::make_pair(path + name + ".xdmf",
                            xdmf_record(name, times.size())) :
             std::make_pair(path + name + ".pvd", pvd_record(name, times));
  }



  template <int dim>
  void
  Output<dim>::resume(const std::vector<double> &earlier)
  {
    times = earlier;
    fail_together(communicator, [&]() {
      if (Utilities::MPI::this_mpi_process(communicator) != 0)
        return;
      for (const std::string &name : series())
        {
          const auto [file, text] = list(name);
          replace_file(file, text);
        }
      remove_unlisted_files();
    });
  }



  template <int dim>
  void
  Output<dim>::remove_unlisted_files() const
  {
    namespace fs = std::filesystem;
    std::set<std::string> listed;
    // Earlier parts of a run may have had other numbers of ranks and thus of
    // pieces, and new meshes at other times.
    const auto add = [&](const std::string &record) {
      static const std::regex file("[a-z]+_[0-9]+[.]([0-9]+[.]vtu|h5)");
      listed.insert(record);
      std::ifstream stream(path + record);
      for (std::string line; std::getline(stream, line);)
        for (std::sregex_iterator name(line.begin(), line.end(), file), end;
             name != end;
             ++name)
          listed.insert(name->str());
    };
    for (const std::string &name : series())
      {
        listed.insert(name + (is_in_hdf5(name) ? ".xdmf" : ".pvd"));
        for (unsigned int n = 0; n < times.size(); ++n)
          add(record_name(name, n) + (is_in_hdf5(name) ? ".xml" : ".pvtu"));
      }
    if (!times.empty())
      add(record_name("boundary", 0) + ".pvtu");

    static const std::regex piece(
      "(boundary|contact|mesh|opposite|revolved|solution)_[0-9]{5,9}[.]"
      "(pvtu|[0-9]+[.]vtu|xml|h5)([.]part)?");
    std::vector<std::string> others;
    std::set<std::string>    with_others;
    std::smatch              parts;
    std::error_code          none;
    for (const auto &entry : fs::directory_iterator(path, none))
      if (const std::string file = entry.path().filename().string();
          listed.count(file) == 0 && std::regex_match(file, parts, piece))
        {
          others.push_back(file);
          with_others.insert(parts[1]);
        }
    for (const std::string record : {"contact.pvd",
                                     "opposite.pvd",
                                     "revolved.pvd",
                                     "solution.pvd",
                                     "solution.xdmf"})
      if (listed.count(record) == 0 &&
          with_others.count(record.substr(0, record.find('.'))) == 1)
        others.push_back(record);
    for (const std::string &file : others)
      fs::remove(path + file, none);

    // Lines of an earlier run that has had more of them.
    for (std::size_t i = scene.output_lines.size();; ++i)
      if (const std::string name = path + line_file_name(i);
          !fs::is_regular_file(name, none) ||
          !is_own(name, beginning_of_lines) || !fs::remove(name, none))
        break;
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(Output, refuse_foreign_files);
  VISCOPLASTIC_INSTANTIATE_MEMBER(Output, series);
  VISCOPLASTIC_INSTANTIATE_MEMBER(Output, is_in_hdf5);
  VISCOPLASTIC_INSTANTIATE_MEMBER(Output, list);
  VISCOPLASTIC_INSTANTIATE_MEMBER(Output, resume);
  VISCOPLASTIC_INSTANTIATE_MEMBER(Output, remove_unlisted_files);
} // namespace Viscoplastic
