#pragma once

#include <string>

#include "graspd/keys/key_files.hpp"

namespace graspd::service {

enum class Handshake { kAccepted, kRefused, kNoVerdict };

/// Connects to an endpoint of this machine as any client does, and sees whether it is let in. Waits
/// for some seconds at most.
Handshake try_handshake(const std::string& endpoint, const std::string& server_key,
                        const keys::KeyPair& own);

}  // namespace graspd::service
