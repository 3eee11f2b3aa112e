// SPDX-License-Identifier: BSD-3-Clause
#include "apps/live/live_server.h"

#include <httplib.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <sstream>
#include <thread>
#include <utility>

#include "apps/live/cut_connections.h"
#include "apps/live/live_json.h"
#include "apps/live/live_pages.h"
#include "frontend/error.h"

namespace fabloop::apps {
namespace {

constexpr const char* kAddress = "127.0.0.1";
/// For answers that are under way when the server stops; longer than the waits for silent clients.
constexpr auto kGrace = std::chrono::seconds(2);
constexpr int kForbidden = 403, kNotFound = 404, kMethodNotAllowed = 405;

/// Content of a known length, which the library sends as it is: it would compress text for longer than it takes to send it.
/// Calls back when all of it was sent.
void answer(httplib::Response& response, std::string text, const char* type, const std::function<void()>& when_sent = {}) {
  const auto content = std::make_shared<const std::string>(std::move(text));
  const auto send = [content](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
    constexpr std::size_t kPiece = 1U << 16U;
    return sink.write(content->data() + offset, std::min(length, kPiece));
  };
  response.set_content_provider(content->size(), type, send, [when_sent](bool is_sent) {
    if (is_sent && when_sent) when_sent();
  });
}

void refuse(httplib::Response& response, int status, const std::string& why) {
  response.status = status;
  answer(response, why + "\n", "text/plain; charset=utf-8");
}

/// Never more than this page's own: no scripts, pictures or frames from elsewhere, and none of it for pages from elsewhere.
httplib::Headers common_headers() {
  return {{"Cache-Control", "no-store"},
          {"Content-Security-Policy",
           "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; connect-src 'self'; "
           "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
          {"Cross-Origin-Resource-Policy", "same-origin"},
          {"Referrer-Policy", "no-referrer"},
          {"X-Content-Type-Options", "nosniff"}};
}

std::uint64_t since_of(const httplib::Request& request) {
  const std::string text = request.get_param_value("since");
  std::uint64_t since = 0;
  std::istringstream(text) >> since;
  return since;
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string why_not_bound(int port, int error) {
  const std::string where = "--live " + std::to_string(port) + ": ";
  const std::string mend = "; give another port, or none to take any that is free";
  if (error == EADDRINUSE) return where + "the port is in use on " + kAddress + mend;
  if (error == EACCES) return where + "the port needs rights that this user has not" + mend;
  return where + "cannot listen on " + kAddress + (error != 0 ? std::string(": ") + std::strerror(error) : "") + mend;
}

}  // namespace

class LiveServer::Implementation {
 public:
  Implementation(const LiveFeed& feed, std::string page, int port) : feed_(feed), page_(std::move(page)) {
    configure();
    bind(port);
    route();
    thread_ = std::thread([this] {
      server_.listen_after_bind();
      has_stopped_ = true;
    });
    // Before it runs, stop() would do nothing.
    while (!server_.is_running() && !has_stopped_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  ~Implementation() {
    server_.stop();
    // A client that never ends its request would keep the program waiting for as long as it pleases.
    const auto until = LiveClock::now() + kGrace;
    while (!has_stopped_ && LiveClock::now() < until) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (!has_stopped_) cut_connections(port_);
    thread_.join();
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  int port() const { return port_; }

  void wait_for_pages(std::chrono::milliseconds at_most) const {
    const auto until = LiveClock::now() + at_most;
    while (LiveClock::now() < until && pages_.is_any_waiting(LiveClock::now())) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

 private:
  void configure() {
    constexpr std::size_t kThreads = 4;
    server_.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };  // the library takes it over
    // The library's default shares the port with whoever else asks for it in that way, another run for one.
    server_.set_socket_options([](int socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    });
    // Connections that say nothing, as browsers open ahead, keep the end of the program waiting for no longer.
    server_.set_keep_alive_max_count(1);
    server_.set_keep_alive_timeout(1);
    server_.set_read_timeout(1);
    server_.set_write_timeout(2);
    server_.set_payload_max_length(0);
    server_.set_default_headers(common_headers());
  }

  void bind(int port) {
    errno = 0;
    if (port == 0) {
      port_ = server_.bind_to_any_port(kAddress);
    } else {
      port_ = server_.bind_to_port(kAddress, port) ? port : -1;
    }
    if (port_ <= 0) throw InputError(why_not_bound(port, errno));
  }

  void route() {
    using Handling = httplib::Server::HandlerResponse;
    server_.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      if (request.method != "GET" && request.method != "HEAD") {
        response.set_header("Allow", "GET, HEAD");
        refuse(response, kMethodNotAllowed, "only GET and HEAD");
        return Handling::Handled;
      }
      if (!is_meant_for_us(request)) {
        refuse(response, kForbidden, "this address answers to its own name alone");
        return Handling::Handled;
      }
      return Handling::Unhandled;
    });
    server_.Get("/", [this](const httplib::Request&, httplib::Response& response) {
      answer(response, page_, "text/html; charset=utf-8");
    });
    server_.Get(R"(/live\.json)", [this](const httplib::Request& request, httplib::Response& response) {
      const auto snapshot = feed_.latest();
      const auto json = live_json(*snapshot, since_of(request), LiveClock::now());
      answer(response, json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace), "application/json",
             [this, snapshot, page = request.get_param_value("page")] {
               pages_.answered(page, snapshot->state, !snapshot->report.empty(), LiveClock::now());
             });
    });
    server_.Get(R"(/report\.html)",
                [this](const httplib::Request& request, httplib::Response& response) { answer_report(request, response); });
    server_.Get(
        ".*", [](const httplib::Request&, httplib::Response& response) { refuse(response, kNotFound, "there is nothing here"); });
  }

  void answer_report(const httplib::Request& request, httplib::Response& response) {
    const auto snapshot = feed_.latest();
    std::string text = snapshot->report.empty() ? std::string() : text_of(snapshot->report);
    if (text.empty()) return refuse(response, kNotFound, "the run has no report yet");
    answer(response, std::move(text), "text/html; charset=utf-8",
           [this, page = request.get_param_value("page")] { pages_.got_report(page); });
  }

  bool is_meant_for_us(const httplib::Request& request) const {
    if (request.get_header_value_count("Host") != 1) return false;
    constexpr int kUnnamedPort = 80;  // browsers leave it out
    const std::string host = request.get_header_value("Host");
    const std::string port = port_ == kUnnamedPort ? std::string() : ":" + std::to_string(port_);
    return host == kAddress + port || host == "localhost" + port;
  }

  const LiveFeed& feed_;
  const std::string page_;
  LivePages pages_;
  httplib::Server server_;
  int port_ = -1;
  std::atomic<bool> has_stopped_ = false;
  std::thread thread_;
};

LiveServer::LiveServer(const LiveFeed& feed, std::string page, int port)
    : implementation_(std::make_unique<Implementation>(feed, std::move(page), port)) {}

LiveServer::~LiveServer() = default;

int LiveServer::port() const { return implementation_->port(); }

void LiveServer::wait_for_pages(std::chrono::milliseconds at_most) const { implementation_->wait_for_pages(at_most); }

}  // namespace fabloop::apps
