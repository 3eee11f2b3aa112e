// SPDX-License-Identifier: BSD-3-Clause
#include "tests/apps/program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace fabloop::testing_support {
namespace {

namespace fs = std::filesystem;

/// The reading end of a pipe whose writing end a child gets.
struct Pipe {
  Pipe() {
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  }
  std::string read_to_end(const std::function<void(const std::string&)>& on_line = {}) {
    std::string text;
    std::size_t begin = 0;  // of the line that is not yet complete
    std::array<char, 4096> buffer{};
    for (ssize_t n = 0; (n = read(ends[0], buffer.data(), buffer.size())) > 0;) {
      text.append(buffer.data(), static_cast<std::size_t>(n));
      for (std::size_t end = 0; on_line && (end = text.find('\n', begin)) != std::string::npos; begin = end + 1)
        on_line(text.substr(begin, end - begin));
    }
    close(ends[0]);
    return text;
  }
  std::array<int, 2> ends{};
};

/// In the child: only calls that are safe between fork and exec.
[[noreturn]] void become_fabloop(char* const* argv, const Pipe& out, const Pipe& err, const ProgramLimits& limits) {
  dup2(out.ends[1], STDOUT_FILENO);
  dup2(err.ends[1], STDERR_FILENO);
  if (limits.max_file_bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{*limits.max_file_bytes, *limits.max_file_bytes};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  execv(argv[0], argv);
  _exit(127);
}

}  // namespace

ProgramResult run_fabloop(const std::vector<std::string>& arguments, const ProgramLimits& limits) {
  std::vector<std::string> words = arguments;
  words.insert(words.begin(), FABLOOP_PROGRAM);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  Pipe out, err;
  const pid_t child = fork();
  if (child == 0) become_fabloop(argv.data(), out, err, limits);
  close(out.ends[1]);
  close(err.ends[1]);
  ProgramResult result;
  std::atomic<bool> is_done = false;
  std::thread killer([&] {
    while (!limits.kill_when_exists.empty() && !is_done) {
      if (fs::exists(limits.kill_when_exists)) kill(child, SIGKILL);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  std::thread reader([&] { result.err = err.read_to_end(); });
  result.out = out.read_to_end(limits.on_line);
  reader.join();
  is_done = true;
  killer.join();
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  return result;
}

void expect_refused(const ProgramResult& result, const std::string& culprit) {
  EXPECT_EQ(result.exit_code, 1) << result.out << result.err;
  EXPECT_TRUE(result.err.starts_with("fabloop: ")) << result.err;
  EXPECT_NE(result.err.find(culprit), std::string::npos) << "'" << culprit << "' is not named in: " << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_TRUE(result.err.ends_with('\n')) << result.err;
}

void expect_empty(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) ADD_FAILURE() << entry.path() << " was left";
}

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

}  // namespace fabloop::testing_support
