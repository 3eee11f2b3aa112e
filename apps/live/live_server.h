// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "apps/live/live_feed.h"

namespace fabloop::apps {

/// Serves a page about a run, to browsers of this machine alone: it listens on 127.0.0.1, and answers only to requests that were
/// meant for that address by name, so that no web site can read it through a name of its own that leads here. GET and HEAD of
///   `/` the page, `/live.json?since=N` what is new (see live_json()), `/report.html` the report of a run that has ended.
class LiveServer {
 public:
  /// Answers from here on, from threads of its own. `port` 0: any that is free. The feed must outlive it. Throws InputError when
  /// the port is in use or may not be used, and when the program was built without a server.
  LiveServer(const LiveFeed& feed, std::string page, int port = 0);
  /// Stops and joins its threads: within seconds, but for clients that keep sending.
  ~LiveServer();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  int port() const;

  /// Waits until the pages that were asking lately have got the end of the run, and its report where there is one; at most so
  /// long.
  void wait_for_pages(std::chrono::milliseconds at_most) const;

 private:
  class Implementation;  // keeps the library's header out of this one
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace fabloop::apps
