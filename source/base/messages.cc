// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/messages.h>

#include <cctype>
#include <iomanip>
#include <new>
#include <sstream>

namespace Viscoplastic
{
  std::string
  reason(const std::exception &exception)
  {
    std::ostringstream message;
    if (const auto *e = dynamic_cast<const dealii::ExceptionBase *>(&exception))
      e->print_info(message);
    else if (dynamic_cast<const std::bad_alloc *>(&exception) != nullptr)
      message << "there is not enough memory";
    else
      message << exception.what();
    std::istringstream words(message.str());
    std::string        line, word;
    while (words >> word)
      line += (line.empty() ? "" : " ") + word;
    // What libraries say does not always end as a sentence does.
    const bool is_theirs =
      dynamic_cast<const dealii::ExceptionBase *>(&exception) != nullptr;
    if (is_theirs && !line.empty() &&
        std::isalnum(static_cast<unsigned char>(line.back())) != 0)
      line += '.';
    return line;
  }



  std::string
  reason_of_current_exception()
  {
    try
      {
        throw;
      }
    catch (const std::exception &exception)
      {
        return reason(exception);
      }
    catch (...)
      {
        return "something has been thrown that is no std::exception, as only "
               "laws of shared libraries do.";
      }
  }



  void
  fail_together(const MPI_Comm communicator, const std::function<void()> &work)
  {
    namespace MPI = dealii::Utilities::MPI;
    std::string failure;
    try
      {
        work();
      }
    catch (...)
      {
        failure = reason_of_current_exception();
      }
    const unsigned int n_ranks = MPI::n_mpi_processes(communicator);
    const unsigned int first =
      MPI::min(failure.empty() ? n_ranks : MPI::this_mpi_process(communicator),
               communicator);
    if (first == n_ranks)
      return;
    AssertThrow(
      false, dealii::ExcMessage(MPI::broadcast(communicator, failure, first)));
  }



  std::string
  list(const std::set<unsigned int> &ids)
  {
    std::string result;
    for (const unsigned int id : ids)
      result += (result.empty() ? "" : ", ") + std::to_string(id);
    return result;
  }



  std::string
  number(const double value, const int digits)
  {
    std::ostringstream text;
    text << std::setprecision(digits) << value;
    return text.str();
  }
} // namespace Viscoplastic
