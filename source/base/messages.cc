// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <viscoplastic_contact/base/messages.h>

#include <algorithm>
#include <cctype>
#include <new>
#include <sstream>

namespace Viscoplastic
{
  void
  refuse(const std::string &sentence)
  {
    throw dealii::StandardExceptions::ExcMessage(sentence);
  }



  std::optional<double>
  number_of(const std::string &text)
  {
    try
      {
        return dealii::Utilities::string_to_double(text);
      }
    catch (const std::exception &)
      {
        return {};
      }
  }



  std::string
  reason(const std::exception &exception)
  {
    std::ostringstream message;
    const auto *const  theirs =
      dynamic_cast<const dealii::ExceptionBase *>(&exception);
    if (theirs != nullptr)
      theirs->print_info(message);
    else if (dynamic_cast<const std::bad_alloc *>(&exception) != nullptr)
      message << "there is not enough memory";
    else
      message << exception.what();
    std::istringstream words(message.str());
    std::string        line, word;
    while (words >> word)
      line += (line.empty() ? "" : " ") + word;
    // Messages of libraries do not always end with a full stop.
    if (theirs != nullptr && !line.empty() &&
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
    refuse(MPI::broadcast(communicator, failure, first));
  }



  std::string
  list(const std::set<unsigned int> &ids)
  {
    std::vector<std::string> names;
    for (const unsigned int id : ids)
      names.push_back(std::to_string(id));
    return enumeration(names, names.size());
  }



  std::string
  number(const double value, const int digits)
  {
    return as_text(value, digits);
  }



  namespace
  {
    /// Letters and digits, in lower case.
    std::string
    skeleton(const std::string &name)
    {
      std::string result;
      for (const unsigned char c : name)
        if (std::isalnum(c) != 0)
          result += static_cast<char>(std::tolower(c));
      return result;
    }



    /// The Damerau-Levenshtein (optimal string alignment) distance: the number
    /// of letters to insert, delete, replace, or swap with their neighbor.
    unsigned int
    edit_distance(const std::string &a, const std::string &b)
    {
      std::vector<std::vector<unsigned int>> d(
        a.size() + 1, std::vector<unsigned int>(b.size() + 1));
      for (unsigned int i = 0; i <= a.size(); ++i)
        for (unsigned int j = 0; j <= b.size(); ++j)
          {
            if (i == 0 || j == 0)
              {
                d[i][j] = i + j;
                continue;
              }
            d[i][j] =
              std::min({d[i - 1][j] + 1,
                        d[i][j - 1] + 1,
                        d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
              d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
          }
      return d[a.size()][b.size()];
    }



    bool
    is_part_of_identifier(const char c)
    {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
    }
  } // namespace



  std::string
  nearest_name(const std::string              &name,
               const std::vector<std::string> &candidates)
  {
    const std::string given = skeleton(name);
    if (given.empty() || given.size() > 100)
      return "";
    // Up to a third of the letters may be wrong.
    unsigned int best_distance =
      1 + static_cast<unsigned int>(given.size()) / 3;
    std::string best;
    for (const std::string &candidate : candidates)
      {
        const std::string wanted   = skeleton(candidate);
        unsigned int      distance = edit_distance(given, wanted);
        if (given.size() >= 3 && wanted.compare(0, given.size(), given) == 0)
          distance = std::min(distance, 1U);
        if (distance < best_distance)
          {
            best_distance = distance;
            best          = candidate;
          }
      }
    return best;
  }



  std::string
  did_you_mean(const std::string              &name,
               const std::vector<std::string> &candidates,
               const std::string              &otherwise)
  {
    const std::string nearest = nearest_name(name, candidates);
    return nearest.empty() ? otherwise : "; did you mean '" + nearest + "'?";
  }



  // Regular expressions would need a stack as deep as the text is long.
  std::string
  identifier_at(const std::string &text, const std::size_t begin)
  {
    if (begin >= text.size() ||
        std::isdigit(static_cast<unsigned char>(text[begin])) != 0)
      return "";
    std::size_t end = begin;
    while (end < text.size() && is_part_of_identifier(text[end]))
      ++end;
    return text.substr(begin, end - begin);
  }



  bool
  mentions(const std::string &text, const std::string &name)
  {
    for (std::size_t begin = text.find(name); begin != std::string::npos;
         begin             = text.find(name, begin + 1))
      {
                    const std::size_t end = begin + name.size();
                    if ((begin == 0 || !is_part_of_identifier(text[begin - 1])) &&
            (end == text.size() || !is_part_of_identifier(text[end])))
          return true;
      }
    return false;
  }



  std::string
  excerpt(const std::string &text, const std::size_t longest)
  {
    std::string result;
    for (const unsigned char c : text.substr(0, longest))
      result += std::iscntrl(c) != 0 ? '?' : static_cast<char>(c);
    return text.size() > longest ? result + "..." : result;
  }



  std::string
  enumeration(const std::vector<std::string> &names, const unsigned int n_max)
  {
    std::string text;
    for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), n_max); ++i)
      text += (i > 0 ? ", " : "") + names[i];
    return names.size() > n_max ? text + ", ..." : text;
  }
} // namespace Viscoplastic
