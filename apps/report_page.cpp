// SPDX-License-Identifier: BSD-3-Clause
#include "apps/report_page.h"

#include <string>
#include <string_view>

#include "apps/report_source.h"
#include "frontend/output_file.h"

namespace fabloop::apps {
namespace {

constexpr std::string_view kDataMark = "@DATA@", kTitleMark = "@TITLE@";

/// JSON as it may stand inside a script element.
std::string as_script(const nlohmann::ordered_json& data) {
  std::string text;
  for (const char c : data.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

std::string as_html(const std::string& text) {
  std::string html;
  for (const char c : text) {
    if (c == '&') html += "&amp;";
    if (c == '<') html += "&lt;";
    if (c != '&' && c != '<') html += c;
  }
  return html;
}

}  // namespace

std::string report_page(const std::string& title, const nlohmann::ordered_json& data) {
  const std::string_view page = kReportPage;
  const std::size_t title_at = page.find(kTitleMark), data_at = page.find(kDataMark);
  std::string text(page.substr(0, title_at));
  text += as_html(title);
  text += page.substr(title_at + kTitleMark.size(), data_at - title_at - kTitleMark.size());
  text += as_script(data);
  text += page.substr(data_at + kDataMark.size());
  return text;
}

void write_report(const std::filesystem::path& path, const ReportInput& input) {
  const nlohmann::ordered_json data = report_data(input);
  OutputFile file(path);
  file.stream() << report_page(data["summary"].value("sequence", std::string("run")), data);
  file.commit();
}

}  // namespace fabloop::apps
