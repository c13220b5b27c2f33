#pragma once

namespace graspd {

/// From now on SIGINT and SIGTERM ask the program to stop, instead of ending it.
void listen_for_stop();
/// Whether one of them has come since. Safe from any thread.
bool asked_to_stop();

}  // namespace graspd
