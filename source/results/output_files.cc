// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vtu_output.h"
#include <viscoplastic_contact/base/files.h>
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
  } // namespace



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
    return scene.parameters.output.in_hdf5 &&
           (name == "solution" || name == "mesh");
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
      if (Utilities::MPI::this_mpi_process(communicator) == 0)
        for (const std::string &name : series())
          {
            const auto [file, text] = list(name);
            replace_file(file, text);
            remove_others(name, times.size());
          }
    });
  }



  template <int dim>
  std::size_t
  Output<dim>::remove_others(const std::string &name,
                             const std::size_t  n_outputs) const
  {
    if (Utilities::MPI::this_mpi_process(communicator) != 0)
      return 0;
    namespace fs             = std::filesystem;
    const bool       is_hdf5 = is_in_hdf5(name);
    const std::regex piece(
      name + "_([0-9]{5,9})[.](pvtu|[0-9]+[.]vtu|xml|h5)([.]part)?");
    // Earlier parts of a run may have had other numbers of ranks and thus of
    // pieces, and new meshes at other times.
    const auto is_listed = [&](const std::string &n, const std::string &file) {
      std::ifstream list(
        path + (is_hdf5 ? "solution_" + n + ".xml" : name + '_' + n + ".pvtu"));
      std::stringstream text;
      text << list.rdbuf();
      return text.str().find((is_hdf5 ? '>' : '"') + file) != std::string::npos;
    };
    std::vector<fs::path> others;
    std::error_code       error;
    for (const auto &entry : fs::directory_iterator(path, error))
      {
        const std::string file = entry.path().filename().string();
        std::smatch       parts;
        if (!std::regex_match(file, parts, piece))
          continue;
        const std::string ending = parts[2];
        if (std::stoul(parts[1]) >= n_outputs ||
            (ending == "xml" || ending == "h5") != is_hdf5 ||
            (ending != "pvtu" && ending != "xml" && !is_listed(parts[1], file)))
          others.push_back(entry.path());
      }
    for (const fs::path &file : others)
      fs::remove(file, error);
    return others.size();
  }



  template <int dim>
  void
  Output<dim>::remove_files_of_earlier_run() const
  {
    const std::vector<std::string> present = series();
    for (const std::string name :
         {"boundary", "contact", "mesh", "opposite", "revolved", "solution"})
      {
        const std::size_t n_outputs =
          name == "boundary" ? std::min<std::size_t>(1, times.size()) :
          is_in_hdf5(name) ||
              std::count(present.begin(), present.end(), name) > 0 ?
                               times.size() :
                               0;
        if (std::error_code none; remove_others(name, n_outputs) > 0)
          for (const std::string list : {".pvd", ".xdmf"})
            if (n_outputs == 0 ||
                (name == "solution" && is_in_hdf5(name) == (list == ".pvd")))
              std::filesystem::remove(path + name + list, none);
      }
    remove_other_lines(path, scene.output_lines.size());
  }



  VISCOPLASTIC_INSTANTIATE_MEMBER(Output, series);
  VISCOPLASTIC_INSTANTIATE_MEMBER(Output, is_in_hdf5);
  VISCOPLASTIC_INSTANTIATE_MEMBER(Output, list);
  VISCOPLASTIC_INSTANTIATE_MEMBER(Output, resume);
  VISCOPLASTIC_INSTANTIATE_MEMBER(Output, remove_others);
  VISCOPLASTIC_INSTANTIATE_MEMBER(Output, remove_files_of_earlier_run);
} // namespace Viscoplastic
