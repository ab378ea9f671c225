// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace Viscoplastic
{
  /// The type of a member function without its class.
  template <typename Pointer>
  struct MemberFunction;

  template <typename Function, typename Class>
  struct MemberFunction<Function Class::*>
  {
    using type = Function;
  };
} // namespace Viscoplastic

/// As VISCOPLASTIC_INSTANTIATE, of a member function without overloads that
/// stands apart from the others of its class, in a file of its own.
#define VISCOPLASTIC_INSTANTIATE_MEMBER(Class, function)       \
  template MemberFunction<decltype(&Class<2>::function)>::type \
    Class<2>::function;                                        \
  template MemberFunction<decltype(&Class<3>::function)>::type \
    Class<3>::function
