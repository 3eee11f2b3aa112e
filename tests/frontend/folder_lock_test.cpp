// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/folder_lock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <optional>

#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {
namespace {

using testing::HasSubstr;

/// Whether another process can have the folder; it ends at once.
bool another_process_can_lock(const std::filesystem::path& folder) {
  const pid_t child = fork();
  if (child == 0) {
    try {
      const FolderLock lock(folder);
      _exit(0);
    } catch (const InputError&) {
      _exit(1);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(FolderLock, KeepsOthersOutAsLongAsItLivesAndWritesNothing) {
  const TemporaryFolder folder;
  std::optional<FolderLock> lock(std::in_place, folder.path());
  EXPECT_FALSE(another_process_can_lock(folder.path()));
  EXPECT_THAT(input_error_of([&] { const FolderLock second(folder.path()); }), HasSubstr("another run is at work"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  lock.reset();
  EXPECT_TRUE(another_process_can_lock(folder.path()));
}

TEST(FolderLock, EndsWithTheProcess) {
  const TemporaryFolder folder;
  EXPECT_TRUE(another_process_can_lock(folder.path()));  // and never lets go of it by itself
  EXPECT_TRUE(another_process_can_lock(folder.path()));
}

TEST(FolderLock, NamesAFolderThatIsMissing) {
  const TemporaryFolder folder;
  EXPECT_THAT(input_error_of([&] { const FolderLock lock(folder.path() / "absent"); }), HasSubstr("absent"));
}

}  // namespace
}  // namespace fabloop
