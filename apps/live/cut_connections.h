// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fabloop::apps {

/// Ends all connections of this process that were accepted on a port of this machine: whoever reads from one is told that it is
/// over. Their descriptors stay open. Where the system does not list a process's descriptors it does nothing.
void cut_connections(int port);

}  // namespace fabloop::apps
