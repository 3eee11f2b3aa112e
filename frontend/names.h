// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <optional>
#include <string_view>

namespace fabloop {

/// An enumerator and its name in options and files.
template <typename Enum>
struct Named {
  Enum value;
  std::string_view name;
};

/// The name of `value`, which must be in the table.
template <typename Enum, std::size_t kSize>
std::string_view name_of(const std::array<Named<Enum>, kSize>& table, Enum value) {
  for (const Named<Enum>& named : table) {
    if (named.value == value) return named.name;
  }
  assert(false && "an enumerator without a name");
  return {};
}

/// The enumerator of that name; none for any other text.
template <typename Enum, std::size_t kSize>
std::optional<Enum> named(const std::array<Named<Enum>, kSize>& table, std::string_view name) {
  for (const Named<Enum>& entry : table) {
    if (entry.name == name) return entry.value;
  }
  return std::nullopt;
}

}  // namespace fabloop
