// SPDX-License-Identifier: BSD-3-Clause
#include "apps/live/live_server.h"

#include <gmock/gmock.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "frontend/error.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/support/http_client.h"

namespace fabloop::apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing_support::ask_http;
constexpr auto kSeconds = [](double seconds) { return std::chrono::duration<double>(seconds); };

class LiveServerTest : public ::testing::Test {
 protected:
  LiveFeed feed_;
  LiveServer server_{feed_, "<html>the page</html>"};
};

TEST_F(LiveServerTest, AnswersToThisMachineAlone) {
  const auto page = ask_http(server_.port(), "GET", "/");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.body, "<html>the page</html>");
  EXPECT_THAT(page.head, HasSubstr("text/html"));
  EXPECT_EQ(ask_http(server_.port(), "GET", "/", "localhost:" + std::to_string(server_.port())).status, 200);
  EXPECT_FALSE(testing_support::other_addresses_accept(server_.port()));
}

TEST_F(LiveServerTest, RefusesRequestsThatWereMeantForAnotherName) {
  const std::string port = ":" + std::to_string(server_.port());
  for (const std::string& host : {std::string("evil.example"), "evil.example" + port, std::string("127.0.0.1"),
                                  std::string("localhost"), std::string("127.0.0.1:1"), "127.0.0.1.evil.example" + port}) {
    const auto answer = ask_http(server_.port(), "GET", "/", host);
    EXPECT_EQ(answer.status, 403) << host;
    EXPECT_THAT(answer.body, Not(HasSubstr("the page"))) << host;
  }
  EXPECT_EQ(ask_http(server_.port(), "GET", "/", "127.0.0.1" + port, "Host: evil.example\r\n").status, 403) << "two of them";
}

TEST_F(LiveServerTest, OnlyReads) {
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "PATCH"}) {
    const auto answer = ask_http(server_.port(), method, "/live.json", {}, "Content-Length: 0\r\n");
    EXPECT_EQ(answer.status, 405) << method;
    EXPECT_THAT(answer.head, HasSubstr("Allow: GET, HEAD")) << method;
  }
  const auto head = ask_http(server_.port(), "HEAD", "/");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.body, "");
}

TEST_F(LiveServerTest, HasNothingElse) {
  for (const char* path : {"/nothing", "/../etc/passwd", "/live.json/x", "/report.html"}) {
    EXPECT_EQ(ask_http(server_.port(), "GET", path).status, 404) << path;
  }
}

TEST_F(LiveServerTest, TellsWhatIsNewAndIsReadByNoOtherSite) {
  LiveMap map;
  map.placed = {{0, {0, 0, 0}}, {1, {1, 0, 0}}};
  feed_.show(map);
  const auto all = ask_http(server_.port(), "GET", "/live.json?since=0");
  EXPECT_EQ(nlohmann::json::parse(all.body).at("placed").size(), 8U);
  EXPECT_EQ(nlohmann::json::parse(ask_http(server_.port(), "GET", "/live.json?since=1").body).at("placed").size(), 4U);
  EXPECT_EQ(nlohmann::json::parse(ask_http(server_.port(), "GET", "/live.json?since=x").body).at("placed").size(), 8U);
  EXPECT_THAT(all.head, HasSubstr("application/json"));
  EXPECT_THAT(all.head, HasSubstr("nosniff"));
  EXPECT_THAT(all.head, HasSubstr("Cross-Origin-Resource-Policy: same-origin"));
  EXPECT_THAT(all.head, HasSubstr("frame-ancestors 'none'"));
  EXPECT_THAT(all.head, Not(HasSubstr("Access-Control-Allow-Origin")));
}

TEST_F(LiveServerTest, SendsALargeReportAsItIs) {
  const test::ScratchFolder scratch;
  const std::string text(15'000'000, 'x');
  feed_.end(scratch.write("report.html", text));
  const auto report = ask_http(server_.port(), "GET", "/report.html", {}, "Accept-Encoding: gzip, br\r\n");
  EXPECT_EQ(report.status, 200);
  EXPECT_TRUE(report.body == text);
}

TEST_F(LiveServerTest, WaitsForOpenPagesUntilTheyHaveTheReport) {
  const test::ScratchFolder scratch;
  server_.wait_for_pages(std::chrono::seconds(100));  // there is none
  ask_http(server_.port(), "GET", "/live.json?since=0&page=a");
  feed_.end(scratch.write("report.html", "the report"));
  std::thread page([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    ask_http(server_.port(), "GET", "/live.json?since=0&page=a");
    ask_http(server_.port(), "GET", "/report.html?page=a");
  });
  const auto start = LiveClock::now();
  server_.wait_for_pages(std::chrono::seconds(100));
  EXPECT_GT(LiveClock::now() - start, kSeconds(0.1));
  page.join();
}

TEST(LiveServer, RefusesAPortThatIsInUse) {
  const testing_support::ListeningSocket other;
  const LiveFeed feed;
  const std::string message = test::message_of<InputError>([&] { const LiveServer server(feed, "", other.port()); });
  EXPECT_THAT(message, HasSubstr("--live " + std::to_string(other.port()) + ": the port is in use"));
}

TEST(LiveServer, RefusesThePortOfAnotherLiveServer) {
  const LiveFeed feed;
  const LiveServer first(feed, "");
  EXPECT_THAT(test::message_of<InputError>([&] { const LiveServer second(feed, "", first.port()); }), HasSubstr("in use"));
}

TEST(LiveServer, StopsSoonWhateverItsClientsDo) {
  const LiveFeed feed;
  auto server = std::make_unique<LiveServer>(feed, "");
  const testing_support::SilentConnection a(server->port()), b(server->port());
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const auto start = LiveClock::now();
  server.reset();
  EXPECT_LT(LiveClock::now() - start, kSeconds(3.0));
}

TEST(LiveServer, StopsSoonAlthoughAClientGoesOnSending) {
  const LiveFeed feed;
  auto server = std::make_unique<LiveServer>(feed, "");
  const testing_support::TalkativeConnection a(server->port()), b(server->port());
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const auto start = LiveClock::now();
  server.reset();
  EXPECT_LT(LiveClock::now() - start, kSeconds(5.0));
}

TEST(LiveServer, ComesAndGoesManyTimes) {
  const LiveFeed feed;
  for (int i = 0; i < 20; ++i) {
    const LiveServer server(feed, "x");
    if (i % 2 == 0) {  // else it goes before anybody has asked
      EXPECT_EQ(ask_http(server.port(), "GET", "/").status, 200);
    }
  }
}

}  // namespace
}  // namespace fabloop::apps
