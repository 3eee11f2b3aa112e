// SPDX-License-Identifier: BSD-3-Clause
// In place of live_server.cpp where cpp-httplib is missing.
#include "apps/live/live_server.h"
#include "frontend/error.h"

namespace fabloop::apps {

class LiveServer::Implementation {};

LiveServer::LiveServer(const LiveFeed&, std::string, int) {
  throw InputError("--live: the program was built without cpp-httplib (Debian: libcpp-httplib-dev); install it and build again");
}

LiveServer::~LiveServer() = default;

int LiveServer::port() const { return 0; }

void LiveServer::wait_for_pages(std::chrono::milliseconds) const {}

}  // namespace fabloop::apps
