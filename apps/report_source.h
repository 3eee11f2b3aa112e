// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace fabloop::apps {

/// The report's page (apps/report/), put together when the program is built; `@TITLE@` and `@DATA@` mark what a run fills in.
extern const std::string_view kReportPage;

}  // namespace fabloop::apps
