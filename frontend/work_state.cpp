// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/work_state.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <sstream>
#include <utility>
#include <vector>

#include "frontend/checksum.h"
#include "frontend/error.h"
#include "frontend/output_file.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

// A state file is: magic, size of the content (u64), its checksum (u64), content. It is read on the machine that wrote it.
constexpr std::array<char, 8> kStateMagic = {'F', 'A', 'B', 'L', 'O', 'O', 'P', 'S'};

std::optional<std::string> text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  return std::string{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// The first line in which two texts differ, as the second has it.
std::string first_difference(const std::string& before, const std::string& now) {
  std::istringstream old_lines(before), new_lines(now);
  std::string old_line, new_line;
  while (std::getline(new_lines, new_line)) {
    if (!std::getline(old_lines, old_line) || old_line != new_line) return "now: " + new_line;
  }
  return "there is less now";
}

/// A folder that nobody else can have filled: empty, or killed before its first file was complete.
bool is_unused(const fs::path& folder) {
  return std::all_of(fs::directory_iterator(folder), fs::directory_iterator(), [](const fs::directory_entry& entry) {
    return entry.path().filename() == std::string(WorkState::kInputsName) + ".part";
  });
}

/// The inputs go last: killed on the way, what is left is still known as a state.
void remove_state(const fs::path& folder, std::error_code& error) {
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().filename() != WorkState::kInputsName) fs::remove_all(entry->path(), error);
  }
  if (!error) fs::remove_all(folder, error);
}

}  // namespace

WorkState::WorkState(fs::path folder, std::string work, const std::string& inputs, IfFound if_found, Warn warn)
    : folder_(std::move(folder)), work_(std::move(work)), warn_(std::move(warn)) {
  try {
    open(inputs, if_found);
  } catch (const fs::filesystem_error& error) {
    throw InputError(folder_.string() + ": cannot be used to keep the " + work_ + "'s state (" + error.code().message() +
                     "); choose another --out");
  }
}

void WorkState::open(const std::string& inputs, IfFound if_found) {
  // A file of this name is the unfinished result of a program that kept no state.
  if (fs::is_regular_file(folder_)) fs::remove(folder_);
  fs::create_directories(folder_);
  const std::optional<std::string> former = text_of(folder_ / kInputsName);
  if (!former && !is_unused(folder_) && if_found == IfFound::Resume) {
    throw InputError(folder_.string() + ": is needed for the " + work_ +
                     "'s state but holds something else; give --fresh to replace it, or choose another --out");
  }
  if (former == inputs && if_found == IfFound::Resume) return;
  if (former && if_found == IfFound::Resume && warn_) {
    warn_(folder_.string() + " was left by a " + work_ + " on other images or with other options (" +
          first_difference(*former, inputs) + "); starting anew");
  }
  std::error_code failure;
  remove_state(folder_, failure);
  if (failure) throw fs::filesystem_error("", failure);
  fs::create_directories(folder_);
  try {
    OutputFile file(folder_ / kInputsName);
    file.stream() << inputs;
    file.commit();
  } catch (const InputError& error) {
    give_up(error.what());
  }
}

void WorkState::give_up(const std::string& why) {
  if (warn_) warn_(why + "; the " + work_ + " goes on, but if it is stopped it must start anew");
  discard();
}

void WorkState::discard() {
  std::error_code ignored;
  if (keeps()) remove_state(folder_, ignored);
  folder_.clear();
}

bool WorkState::has(const std::string& name) const { return keeps() && fs::exists(folder_ / name); }

void WorkState::warn_damaged(const std::string& name) const {
  if (warn_) warn_((folder_ / name).string() + " is damaged; what it held is done again");
}

void WorkState::remove(const std::string& name) {
  std::error_code ignored;
  if (keeps()) fs::remove(folder_ / name, ignored);
}

void WorkState::remove_all_but(const std::string& what) {
  if (!keeps()) return;
  std::vector<fs::path> others;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
    const std::string name = entry.path().filename().string();
    if (name != kInputsName && !name.starts_with(what + "-")) others.push_back(entry.path());
  }
  std::error_code ignored;
  for (const fs::path& path : others) fs::remove(path, ignored);
}

std::optional<StateBytes> WorkState::read(const std::string& name) const {
  if (!has(name)) return std::nullopt;
  std::ifstream file(folder_ / name, std::ios::binary);
  std::array<char, kStateMagic.size()> magic{};
  std::uint64_t size = 0, expected = 0;
  file.read(magic.data(), magic.size());
  file.read(reinterpret_cast<char*>(&size), sizeof(size));
  file.read(reinterpret_cast<char*>(&expected), sizeof(expected));
  std::error_code error;
  const auto file_size = fs::file_size(folder_ / name, error);
  if (file && !error && magic == kStateMagic && file_size == magic.size() + sizeof(size) + sizeof(expected) + size) {
    std::string bytes(size, '\0');
    if (file.read(bytes.data(), static_cast<std::streamsize>(size)) && checksum(bytes) == expected) {
      return StateBytes(std::move(bytes));
    }
  }
  warn_damaged(name);
  return std::nullopt;
}

void WorkState::write(const std::string& name, const StateBytes& bytes) {
  if (!keeps()) return;
  const std::uint64_t size = bytes.bytes().size(), sum = checksum(bytes.bytes());
  try {
    OutputFile file(folder_ / name);
    file.stream().write(kStateMagic.data(), kStateMagic.size());
    file.stream().write(reinterpret_cast<const char*>(&size), sizeof(size));
    file.stream().write(reinterpret_cast<const char*>(&sum), sizeof(sum));
    file.stream().write(bytes.bytes().data(), static_cast<std::streamsize>(size));
    file.commit();
  } catch (const InputError& error) {
    give_up(error.what());
  }
}

std::string numbered_name(const std::string& what, std::size_t number) {
  constexpr std::size_t kDigits = 5;
  const std::string digits = std::to_string(number);
  return what + "-" + std::string(digits.size() < kDigits ? kDigits - digits.size() : 0, '0') + digits;
}

std::string file_identity(const fs::path& path) {
  std::error_code ignored;  // reading it will tell
  const auto time = fs::last_write_time(path, ignored).time_since_epoch().count();
  const auto size = fs::file_size(path, ignored);
  return path.filename().string() + ' ' + std::to_string(size) + ' ' + std::to_string(time) + '\n';
}

}  // namespace fabloop
