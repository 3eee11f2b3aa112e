// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <string>
#include <thread>

namespace fabloop::testing_support {

/// What a server of this machine answered; `status` 0: nothing.
struct HttpAnswer {
  int status = 0;
  std::string head;  ///< Status line and header lines.
  std::string body;
};

/// One request to 127.0.0.1: `METHOD PATH` with this Host header (empty: 127.0.0.1:PORT), and whatever header lines are added.
HttpAnswer ask_http(int port, const std::string& method, const std::string& path, const std::string& host = {},
                    const std::string& more_lines = {});

/// A socket that listens on 127.0.0.1, on a port that was free, for as long as it lives.
class ListeningSocket {
 public:
  ListeningSocket();
  ~ListeningSocket();
  ListeningSocket(const ListeningSocket&) = delete;
  ListeningSocket& operator=(const ListeningSocket&) = delete;
  int port() const { return port_; }

 private:
  int socket_ = -1;
  int port_ = 0;
};

/// A connection to 127.0.0.1 that says nothing, for as long as it lives.
class SilentConnection {
 public:
  explicit SilentConnection(int port);
  ~SilentConnection();
  SilentConnection(const SilentConnection&) = delete;
  SilentConnection& operator=(const SilentConnection&) = delete;

 private:
  int socket_ = -1;
};

/// A connection to 127.0.0.1 that goes on sending lines of a request that never ends, for as long as it lives.
class TalkativeConnection {
 public:
  explicit TalkativeConnection(int port);
  ~TalkativeConnection();
  TalkativeConnection(const TalkativeConnection&) = delete;
  TalkativeConnection& operator=(const TalkativeConnection&) = delete;

 private:
  int socket_ = -1;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

/// Whether an address of this machine other than 127.0.0.1 accepts connections on the port. 127.0.0.2 stands for all: a server
/// that listens on every address listens there.
bool other_addresses_accept(int port);

}  // namespace fabloop::testing_support
