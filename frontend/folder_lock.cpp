// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "frontend/error.h"

namespace fabloop {

FolderLock::FolderLock(const std::filesystem::path& folder)
    : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0) throw InputError(folder.string() + ": the folder cannot be opened: " + std::strerror(errno));
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(descriptor_);
  throw InputError(folder.string() + ": another run is at work in this folder; wait for its end, or choose another folder");
}

FolderLock::~FolderLock() { ::close(descriptor_); }

}  // namespace fabloop
