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

void write_report(const std::filesystem::path& path, const ReportInput& input) {
  const nlohmann::ordered_json data = report_data(input);
  const std::string_view page = kReportPage;
  const std::size_t title = page.find(kTitleMark), body = page.find(kDataMark);
  OutputFile file(path);
  file.stream() << page.substr(0, title) << as_html(data["summary"].value("sequence", std::string("run")))
                << page.substr(title + kTitleMark.size(), body - title - kTitleMark.size()) << as_script(data)
                << page.substr(body + kDataMark.size());
  file.commit();
}

}  // namespace fabloop::apps
