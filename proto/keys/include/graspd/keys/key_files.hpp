#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "graspd/types/result.hpp"

/// Keys of CURVE, ZeroMQ's encryption, and the files they live in. A key is 32 bytes, written as 40
/// characters of Z85 (ZeroMQ RFC 32). A file is one line, blank lines and lines that begin with #
/// apart:
///
///     CELL.pub   CELL PUBLIC_KEY                 may be copied to whom it concerns
///     CELL.key   CELL PUBLIC_KEY SECRET_KEY      stays where it was made; mode 0600
///
/// A server's own pair has the same form, under a name of its own. No sentence of these functions
/// holds a key.
namespace graspd::keys {

/// A line of a .pub file.
struct PublicKey {
  std::string cell;
  std::string public_key;
};

/// A line of a .key file. Its last member goes nowhere but into that file and the socket.
struct KeyPair {
  std::string cell;
  std::string public_key;
  std::string secret_key;
};

/// A name that can stand in a key file: as cells' names, and without blanks, slashes or a # in
/// front.
Result<void> validate_cell_name(std::string_view cell);

/// \throws std::runtime_error where this machine's libzmq was built without CURVE.
KeyPair make_key_pair(std::string cell);

/// The two files of a pair.
struct KeyPaths {
  std::filesystem::path secret;
  std::filesystem::path public_key;
};
/// Makes FOLDER (0700) where it is missing, then FOLDER/CELL.key (0600) and FOLDER/CELL.pub.
/// \returns INVALID_ARGUMENT where one of them is there already: keys are never overwritten.
Result<KeyPaths> write_key_pair(const KeyPair& pair, const std::filesystem::path& folder);

/// \returns INVALID_ARGUMENT for a file that others than its user may read, too.
Result<KeyPair> read_key_pair(const std::filesystem::path& path);
/// \returns INVALID_ARGUMENT for a file that is none, a secret key's among them.
Result<PublicKey> read_public_key(const std::filesystem::path& path);

/// What a client needs where servers authenticate.
struct ClientKeys {
  std::string server_key;  ///< of all its servers: they share one pair
  KeyPair own;
};
/// \param server_key the server's .pub file. \param key_file the cell's own .key file. \returns
/// INVALID_ARGUMENT as the two above.
Result<ClientKeys> read_client_keys(const std::filesystem::path& server_key,
                                    const std::filesystem::path& key_file);

}  // namespace graspd::keys
