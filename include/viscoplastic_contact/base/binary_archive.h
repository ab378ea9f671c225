// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/exceptions.h>
#include <deal.II/base/tensor.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  // Like Boost's binary archives, `archive & a & b' writes or reads numbers,
  // tensors and vectors of these in the representation of the machine. Unlike
  // those archives, the reader does not trust the lengths in the data: damaged
  // data end in an exception, not in an allocation of arbitrary size.

  class BinaryWriter
  {
  public:
    template <typename T>
    BinaryWriter &
    operator&(const T &value)
    {
      static_assert(std::is_arithmetic_v<T>);
      text.append(reinterpret_cast<const char *>(&value), sizeof(T));
      return *this;
    }

    template <int rank, int dim>
    BinaryWriter &
    operator&(const Tensor<rank, dim> &value)
    {
      for (unsigned int i = 0; i < value.n_independent_components; ++i)
        *this &value[value.unrolled_to_component_indices(i)];
      return *this;
    }

    template <typename T>
    BinaryWriter &
    operator&(const std::vector<T> &values)
    {
      *this &static_cast<std::uint64_t>(values.size());
      if constexpr (std::is_trivially_copyable_v<T>)
        text.append(reinterpret_cast<const char *>(values.data()),
                    values.size() * sizeof(T));
      else
        for (const T &value : values)
          *this &value;
      return *this;
    }

    BinaryWriter &
    operator&(const std::vector<bool> &values)
    {
      return *this & std::vector<std::uint8_t>(values.begin(), values.end());
    }

    const std::string &
    bytes() const
    {
      return text;
    }

  private:
    std::string text;
  };



  class BinaryReader
  {
  public:
    /// Keeps a copy of @p bytes.
    explicit BinaryReader(std::string bytes)
      : text(std::move(bytes))
    {}

    template <typename T>
    BinaryReader &
    operator&(T &value)
    {
      static_assert(std::is_arithmetic_v<T>);
      if constexpr (std::is_same_v<T, bool>)
        {
          std::uint8_t byte;
          *this       &byte;
          value = byte != 0;
        }
      else
        copy(&value, 1);
      return *this;
    }

    template <int rank, int dim>
    BinaryReader &
    operator&(Tensor<rank, dim> &value)
    {
      for (unsigned int i = 0; i < value.n_independent_components; ++i)
        *this &value[value.unrolled_to_component_indices(i)];
      return *this;
    }

    template <typename T>
    BinaryReader &
    operator&(std::vector<T> &values)
    {
      std::uint64_t size;
      *this        &size;
      AssertThrow(size <= (text.size() - position) / sizeof(T), too_short());
      values.resize(size);
      if constexpr (std::is_trivially_copyable_v<T>)
        copy(values.data(), size);
      else
        for (T &value : values)
          *this &value;
      return *this;
    }

    BinaryReader &
    operator&(std::vector<bool> &values)
    {
      std::vector<std::uint8_t> bytes;
      *this                    &bytes;
      values.assign(bytes.begin(), bytes.end());
      return *this;
    }

    bool
    is_at_end() const
    {
      return position == text.size();
    }

  private:
    static ExcMessage
    too_short()
    {
      return ExcMessage("The data end too early.");
    }

    template <typename T>
    void
    copy(T *target, const std::size_t n)
    {
      AssertThrow(n <= (text.size() - position) / sizeof(T), too_short());
      if (n == 0)
        return; // memcpy() must not be given a null pointer
      std::memcpy(target, text.data() + position, n * sizeof(T));
      position += n * sizeof(T);
    }

    const std::string text;
    std::size_t       position = 0;
  };
} // namespace Viscoplastic
