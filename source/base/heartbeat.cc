// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/heartbeat.h>
#include <viscoplastic_contact/base/progress.h>

namespace Viscoplastic
{
  namespace
  {
    Heartbeat *present = nullptr;

    constexpr std::array<const char *, 3> names{
      {" Newton", " contact", " linear"}};
  } // namespace



  Heartbeat::Heartbeat(Console &console, const double seconds)
    : console(console)
    , seconds(seconds)
  {
    if (console.is_heard())
      present = this;
  }



  Heartbeat::~Heartbeat()
  {
    if (present == this)
      present = nullptr;
  }



  void
  Heartbeat::begin_step(const unsigned int n, const double t)
  {
    if (present == nullptr)
      return;
    present->n            = n;
    present->t            = t;
    present->n_iterations = {};
  }



  void
  Heartbeat::count(const Loop loop)
  {
    if (present == nullptr)
      return;
    ++present->n_iterations[static_cast<unsigned int>(loop)];
    if (present->console.is_silent_for(present->seconds))
      present->speak(present->console.age());
  }



  void
  Heartbeat::speak(const double elapsed)
  {
    std::ostringstream text;
    text << "Still at ";
    if (n == 0)
      text << "the initial state";
    else
      text << "step " << n << " (t = " << t << ')';
    const char *separator = ": ";
    for (unsigned int loop = 0; loop < names.size(); ++loop)
      if (n_iterations[loop] > 0)
        {
          text << separator << n_iterations[loop] << names[loop];
          separator = ", ";
        }
    text << " iterations  elapsed " << duration(elapsed);
    console.stream() << text.str() << std::endl;
  }
} // namespace Viscoplastic
