// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// Messages of errors.

#include <gtest/gtest.h>

#include <functional>
#include <sstream>
#include <string>

namespace Viscoplastic::Testing
{
  /// The message of the exception that the action throws, on one line.
  inline std::string
  message_of(const std::function<void()> &action)
  {
    try
      {
        action();
      }
    catch (const std::exception &exception)
      {
        std::istringstream words(exception.what());
        std::string        message, word;
        while (words >> word)
          message += (message.empty() ? "" : " ") + word;
        return message;
      }
    return "";
  }



  inline void
  expect_refusal(const std::function<void()> &action,
                 const std::string           &sentence)
  {
    const std::string message = message_of(action);
    EXPECT_NE(message.find(sentence), std::string::npos)
      << "expected: " << sentence << "\nobtained: " << message;
  }
} // namespace Viscoplastic::Testing
