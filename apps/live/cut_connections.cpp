// SPDX-License-Identifier: BSD-3-Clause
#include "apps/live/cut_connections.h"

#include <netinet/in.h>
#include <sys/socket.h>

#include <charconv>
#include <filesystem>
#include <string>
#include <system_error>

namespace fabloop::apps {
namespace {

/// None (-1) for what is no number.
int descriptor_named(const std::string& name) {
  int descriptor = -1;
  std::from_chars(name.data(), name.data() + name.size(), descriptor);
  return descriptor;
}

bool is_accepted_on(int descriptor, int port) {
  sockaddr_in here{}, there{};
  socklen_t size = sizeof(here);
  if (getsockname(descriptor, reinterpret_cast<sockaddr*>(&here), &size) != 0 || here.sin_family != AF_INET) return false;
  size = sizeof(there);
  const bool is_connected = getpeername(descriptor, reinterpret_cast<sockaddr*>(&there), &size) == 0;
  return is_connected && ntohs(here.sin_port) == port;
}

}  // namespace

void cut_connections(int port) {
  std::error_code error;
  for (std::filesystem::directory_iterator entry("/proc/self/fd", error), end; !error && entry != end; entry.increment(error)) {
    const int descriptor = descriptor_named(entry->path().filename().string());
    if (descriptor >= 0 && is_accepted_on(descriptor, port)) shutdown(descriptor, SHUT_RDWR);
  }
}

}  // namespace fabloop::apps
