// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/unexpected_end.h>

#include <cstdlib>
#include <exception>
#include <iostream>

namespace Viscoplastic
{
  namespace
  {
    /// What the last object says; null if there is none.
    const std::string *current = nullptr;



    void
    end(const std::string &event)
    {
      // One write: several ranks may end at the same time.
      std::cerr << "viscoplastic_contact: " + event + " while " + *current +
                     "; a law of a shared library may do so.\n";
      std::_Exit(1);
    }



    extern "C" void
    end_at_exit()
    {
      if (current != nullptr)
        end("exit() has been called");
    }



    [[noreturn]] void
    end_at_terminate()
    {
      if (current != nullptr && std::current_exception())
        end("an exception has been thrown where none can be caught ('" +
            reason_of_current_exception() + "')");
      std::abort();
    }
  } // namespace



  UnexpectedEnd::UnexpectedEnd(const std::string &doing)
    : doing(doing)
    , before(current)
  {
    static const bool is_registered = [] {
      std::set_terminate(end_at_terminate);
      return std::atexit(end_at_exit) == 0 &&
             std::at_quick_exit(end_at_exit) == 0;
    }();
    (void)is_registered;
    current = &this->doing;
  }



  UnexpectedEnd::~UnexpectedEnd()
  {
    current = before;
  }
} // namespace Viscoplastic
