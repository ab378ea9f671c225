// SPDX-License-Identifier: LGPL-2.1-or-later

// An effect that a scene does not have is not constructed, evaluated or
// allocated. Tests count allocations and calls; they measure no times.

#include "stepping_body.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace
{
  std::atomic<std::size_t> n_allocations{0};
}

// Count all allocations of the test executable, except for deal.II's aligned
// vectors, which do not use operator new.
void *
operator new(const std::size_t size)
{
  ++n_allocations;
  if (void *const memory = std::malloc(size > 0 ? size : 1))
    return memory;
  throw std::bad_alloc();
}

void
operator delete(void *const memory) noexcept
{
  std::free(memory);
}

void
operator delete(void *const memory, const std::size_t) noexcept
{
  std::free(memory);
}



namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;



  template <typename Dimension>
  class AbsentEffects : public testing::Test
  {};
  TYPED_TEST_SUITE(AbsentEffects, Dimensions);



  /// An elastic body on a symmetry plane under a growing load; @p foundation
  /// and @p push replace the entries of both, @p more are further entries.
  template <int dim>
  std::string
  bare(const std::string &more       = "",
       const std::string &foundation = "set Role = symmetry",
       const std::string &push       = "0.3*t")
  {
    const std::string zero = dim == 3 ? "; 0" : "";
    std::string       text =
      box<dim>(2) +
      boundary(0,
               "set Role = traction\nset Traction = " + push + "; 0" + zero) +
      boundary(1, "set Role = free") + boundary(2 * (dim - 1), foundation) +
      boundary(2 * (dim - 1) + 1, "set Role = clamped") +
      time("forward Euler", "1: 8") + solver("multigrid") + more;
    if (dim == 3)
      text +=
        boundary(2, "set Role = symmetry") + boundary(3, "set Role = free");
    return text;
  }



  const std::string no_law = subsection("Material", "set Law = elastic"),
                    no_error_bar =
                      subsection("Error control", "set Error bar = false");



  /// The bare scene with entries of effects that it does not have.
  template <int dim>
  std::string
  with_entries_without_effect()
  {
    const std::string zero = dim == 3 ? "; 0" : "";
    return bare<dim>(
      no_law + no_error_bar +
        subsection("Material", subsection("perzyna", "set Viscosity = 3")) +
        subsection("Loads", "set Body force = 0; 0" + zero) +
        subsection("Mesh refinement",
                   "set Strategy = none\nset Every n steps = 1") +
        subsection("Error control", "set Algebraic fraction = 0.01"),
      "set Role = symmetry\nset Friction bound = 0.01\n"
      "set Foundation motion = t; 0" +
        zero);
  }



  /// Count the allocations of the fourth step, after all one-time set-up.
  template <int dim>
  std::size_t
  allocations_of_a_step(const std::string &scene)
  {
    SteppingBody<dim> body(typename SteppingBody<dim>::WholeScene{scene});
    body.advance(3);
    const std::size_t       before = n_allocations;
    const AcceptedStep<dim> step   = body.stepper->next(body.accepted);
    EXPECT_FALSE(step.is_unchanged);
    return n_allocations - before;
  }



  TYPED_TEST(AbsentEffects, AreNotConstructed)
  {
    constexpr int     dim = TypeParam::value;
    SteppingBody<dim> body(typename SteppingBody<dim>::WholeScene{
      with_entries_without_effect<dim>()});
    body.advance(2);
    EXPECT_EQ(body.discretization->face, nullptr);
    EXPECT_EQ(body.discretization->slipping_face(), nullptr);
    EXPECT_FALSE(body.discretization->laws.any);
    EXPECT_EQ(body.error_estimator, nullptr);
    EXPECT_FALSE(body.stepper->needs_rate());
    const EvaluatedState<dim> &end = body.accepted;
    EXPECT_TRUE(end.state.z.empty());
    EXPECT_TRUE(end.state.time_error.empty());
    EXPECT_TRUE(end.state.rate_slope.empty());
    EXPECT_EQ(end.state.contact.n_points(), 0u);
    EXPECT_EQ(end.state.initial_u.size(), 0u);
    EXPECT_FALSE(end.rate.has_value());
    EXPECT_EQ(end.space_estimate.squared_indicators.size(), 0u);
    EXPECT_EQ(end.errors.total(), 0.);
    // A step runs no phases but these.
    for (const auto &[phase, calls] :
         body.timer.get_summary_data(TimerOutput::n_calls))
      EXPECT_TRUE(phase == "load" || phase == "contact" || phase == "balance")
        << phase;
  }



  TYPED_TEST(AbsentEffects, AllocateNothing)
  {
    constexpr int     dim   = TypeParam::value;
    const std::string plain = no_law + no_error_bar;
    const std::size_t none  = allocations_of_a_step<dim>(bare<dim>(plain));
    EXPECT_GT(none, 0u);
    EXPECT_EQ(allocations_of_a_step<dim>(with_entries_without_effect<dim>()),
              none);
    // Effects that are present do allocate.
    EXPECT_GT(allocations_of_a_step<dim>(bare<dim>(maxwell + no_error_bar)),
              none);
    EXPECT_GT(allocations_of_a_step<dim>(bare<dim>(no_law)), none);
    EXPECT_GT(allocations_of_a_step<dim>(
                bare<dim>(plain,
                          "set Role = contact\nset Friction law = tresca\n"
                          "set Friction bound = 0.01")),
              none);
  }



  TYPED_TEST(AbsentEffects, StepsWithoutChangeAllocateLess)
  {
    // Steps without change neither solve nor evaluate forces.
    constexpr int     dim   = TypeParam::value;
    const std::string plain = no_law + no_error_bar;
    SteppingBody<dim> body(typename SteppingBody<dim>::WholeScene{
      bare<dim>(plain, "set Role = symmetry", "0.1")});
    body.advance(3);
    const std::size_t       before = n_allocations;
    const AcceptedStep<dim> step   = body.stepper->next(body.accepted);
    EXPECT_TRUE(step.is_unchanged);
    const std::size_t here = n_allocations - before;
    EXPECT_LT(here, allocations_of_a_step<dim>(bare<dim>(plain)));

    // The result of a loose solve is no solution for a strict tolerance.
    body.accepted.report.relative_error = 1e-6;
    EXPECT_FALSE(body.stepper->next(body.accepted).is_unchanged);
  }
} // namespace
