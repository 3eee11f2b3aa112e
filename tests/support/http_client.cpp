// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/http_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <stdexcept>

namespace fabloop::testing_support {
namespace {

sockaddr_in address_of(int port, const char* address = "127.0.0.1") {
  sockaddr_in where{};
  where.sin_family = AF_INET;
  where.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, address, &where.sin_addr);
  return where;
}

/// As the sockets' functions want it.
const sockaddr* as_sockaddr(const sockaddr_in& where) { return reinterpret_cast<const sockaddr*>(&where); }

int connected_to(const sockaddr_in& where) {
  const int connection = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (connect(connection, as_sockaddr(where), sizeof(where)) == 0) return connection;
  close(connection);
  return -1;
}

}  // namespace

HttpAnswer ask_http(int port, const std::string& method, const std::string& path, const std::string& host,
                    const std::string& more_lines) {
  HttpAnswer answer;
  const int connection = connected_to(address_of(port));
  if (connection < 0) return answer;
  const std::string request = method + ' ' + path +
                              " HTTP/1.1\r\nHost: " + (host.empty() ? "127.0.0.1:" + std::to_string(port) : host) +
                              "\r\nConnection: close\r\n" + more_lines + "\r\n";
  std::string text;
  if (send(connection, request.data(), request.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(request.size())) {
    std::array<char, 65536> buffer{};
    for (ssize_t n = 0; (n = recv(connection, buffer.data(), buffer.size(), 0)) > 0;)
      text.append(buffer.data(), static_cast<std::size_t>(n));
  }
  close(connection);
  const std::size_t end = text.find("\r\n\r\n");
  if (end == std::string::npos || text.size() < 12) return answer;
  answer.status = std::stoi(text.substr(9, 3));  // "HTTP/1.1 200 OK"
  answer.head = text.substr(0, end);
  answer.body = text.substr(end + 4);
  return answer;
}

ListeningSocket::ListeningSocket() : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in where = address_of(0);
  socklen_t size = sizeof(where);
  if (bind(socket_, as_sockaddr(where), sizeof(where)) != 0 || listen(socket_, 1) != 0) throw std::runtime_error("no port");
  getsockname(socket_, reinterpret_cast<sockaddr*>(&where), &size);
  port_ = ntohs(where.sin_port);
}

ListeningSocket::~ListeningSocket() { close(socket_); }

SilentConnection::SilentConnection(int port) : socket_(connected_to(address_of(port))) {}

SilentConnection::~SilentConnection() {
  if (socket_ >= 0) close(socket_);
}

TalkativeConnection::TalkativeConnection(int port) : socket_(connected_to(address_of(port))) {
  thread_ = std::thread([this] {
    std::string line = "GET / HTTP/1.1\r\n";
    while (!is_over_ && send(socket_, line.data(), line.size(), MSG_NOSIGNAL) >= 0) {
      line = "X: and then\r\n";
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
}

TalkativeConnection::~TalkativeConnection() {
  is_over_ = true;
  thread_.join();
  if (socket_ >= 0) close(socket_);
}

bool other_addresses_accept(int port) {
  const int connection = connected_to(address_of(port, "127.0.0.2"));
  if (connection >= 0) close(connection);
  return connection >= 0;
}

}  // namespace fabloop::testing_support
