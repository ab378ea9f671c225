// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/mesh/files/mesh_converter.h>
#include <viscoplastic_contact/mesh/files/python.h>

#include <boost/process.hpp>

#include <iterator>
#include <system_error>
#include <utility>

namespace Viscoplastic
{
  using namespace dealii;

  namespace
  {
    std::string
    all_of(std::istream &stream)
    {
      return {std::istreambuf_iterator<char>(stream),
              std::istreambuf_iterator<char>()};
    }



    /// The text and, if there is none, why: the end of a sentence.
    std::pair<std::string, std::string>
    run_script(const std::string &name, const PlaneModel plane_model)
    {
      namespace process         = boost::process;
      const std::string python  = VISCOPLASTIC_CONTACT_PYTHON;
      const std::string by_hand = "; where there is Python with meshio, run "
                                  "contrib/convert_mesh MESH MESH.msh by hand "
                                  "and set 'Geometry/File' to its result";
      process::ipstream output, messages;
      std::error_code   error;
      process::child    script(
        python,
        path_of_resource("contrib/convert_mesh"),
        "--plane-model",
        name_of(plane_model),
        "--",
        name,
        process::std_in<process::null, process::std_out> output,
        process::std_err > messages,
        error);
      if (error)
        return {"",
                "cannot be converted, since " + python +
                  " cannot be started: " + error.message() + by_hand};

      std::string text = all_of(output);
      // The last line, after what Python may have to say.
      std::string message = Utilities::trim(all_of(messages));
      message             = message.substr(message.rfind('\n') + 1);
      script.wait(error);
      if (!error && script.exit_code() == 0)
        return {std::move(text), ""};
      if (message.compare(0, name.size() + 2, name + ": ") == 0)
        return {"", message.substr(name.size() + 2)};
      return {"",
              "cannot be converted: contrib/convert_mesh ends with code " +
                std::to_string(script.exit_code()) +
                (message.empty() ? "" : " (" + message + ")") + by_hand};
    }
  } // namespace



  std::string
  convert_mesh_file(const std::string &name,
                    const PlaneModel   plane_model,
                    const MPI_Comm     communicator)
  {
    std::pair<std::string, std::string> result;
    if (Utilities::MPI::this_mpi_process(communicator) == 0)
      result = run_script(name, plane_model);
    result = Utilities::MPI::broadcast(communicator, result, 0);
    AssertThrow(result.second.empty(),
                ExcMessage("The mesh file '" + name + "' " + result.second +
                           "."));
    return std::move(result.first);
  }
} // namespace Viscoplastic
