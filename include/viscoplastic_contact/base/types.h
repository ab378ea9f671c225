// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace dealii
{
  namespace TrilinosWrappers
  {
    namespace MPI
    {
      class Vector;
    }
  } // namespace TrilinosWrappers
} // namespace dealii

/// Quasi-static frictional contact of elastic-viscoplastic bodies after Chen,
/// Han, Sofonea, SIAM J. Numer. Anal. 38(4), 2000. Numbers in round brackets
/// in the documentation are equations of that paper.
namespace Viscoplastic
{
  // These types are only declared, since their headers are heavy and code that
  // only passes references does without. See base/linear_algebra.h.
  using DistributedVector = dealii::TrilinosWrappers::MPI::Vector;
  class DistributedMatrix;

  /// The largest id of boundaries and materials in files and expressions.
  constexpr unsigned int largest_id = 999999999;



  /// The type of a member function without its class.
  template <typename Pointer>
  struct MemberFunction;

  template <typename Function, typename Class>
  struct MemberFunction<Function Class::*>
  {
    using type = Function;
  };
} // namespace Viscoplastic

/// Explicit instantiation of a function template whose only parameter is the
/// dimension. Overloaded functions have to be instantiated by hand.
#define VISCOPLASTIC_INSTANTIATE(function)    \
  template decltype(function<2>) function<2>; \
  template decltype(function<3>) function<3>

/// Explicit instantiation of a class template with the only parameter dim.
#define VISCOPLASTIC_INSTANTIATE_CLASS(Class) \
  template class Class<2>;                    \
  template class Class<3>

/// The same for a member function without overloads that has its own file.
#define VISCOPLASTIC_INSTANTIATE_MEMBER(Class, function)       \
  template MemberFunction<decltype(&Class<2>::function)>::type \
    Class<2>::function;                                        \
  template MemberFunction<decltype(&Class<3>::function)>::type \
    Class<3>::function
