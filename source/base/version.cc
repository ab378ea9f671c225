// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/version.h>

namespace Viscoplastic
{
  const char *const program_version = VISCOPLASTIC_CONTACT_VERSION;
  const char *const git_revision    = VISCOPLASTIC_CONTACT_GIT_REVISION;
} // namespace Viscoplastic
