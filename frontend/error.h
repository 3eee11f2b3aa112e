// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>

namespace fabloop {

/// The input is bad: a file, a folder, an option value. The message is one line that says what is wrong, where (file and
/// line for files) and how to mend it. Programs print it and exit with code 1.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace fabloop
