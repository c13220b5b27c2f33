#include "graspd/keys/key_files.hpp"

#include <sys/stat.h>
#include <zmq.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>

#include "key_text.hpp"
#include "text_file.hpp"

namespace graspd::keys {
namespace {

constexpr std::size_t kLongestCell_bytes = 100;  // it names files, too

using KeyText = char[kKeyCharacters_n + 1];

/// The one line of a key file that says something.
Result<std::vector<std::string>> read_key_line(const std::filesystem::path& path,
                                               const std::string& text) {
  std::optional<std::vector<std::string>> words;
  for (const std::string& line : lines_of(text)) {
    if (says_nothing(line)) continue;
    if (words) return invalid("{}: has more than one key; one was expected", path.string());
    words = words_of(line);
  }
  if (!words) return invalid("{}: there is no key in it", path.string());
  if (auto ok = validate_cell_name((*words)[0]); !ok) {
    return invalid("{}: {}", path.string(), ok.error().message);
  }
  return *std::move(words);
}

std::string derived_public_key(const std::string& secret_key) {
  KeyText text;
  return zmq_curve_public(text, secret_key.c_str()) == 0 ? text : std::string();
}

}  // namespace

bool is_key(std::string_view text) {
  std::uint8_t key[32];
  return text.size() == kKeyCharacters_n &&
         zmq_z85_decode(key, std::string(text).c_str()) != nullptr;
}

Result<void> validate_cell_name(std::string_view cell) {
  const auto usable = [](char c) {
    return static_cast<unsigned char>(c) > 0x20 && c != 0x7f && c != '/';
  };
  if (cell.empty() || std::string_view(".-#").find(cell[0]) != std::string_view::npos ||
      cell.size() > kLongestCell_bytes || !std::all_of(cell.begin(), cell.end(), usable)) {
    return invalid(
        "'{}' can't be the name of a cell with a key: 1 to {} characters, no blanks, no slashes, "
        "no '.', '-' or '#' in front",
        cell, kLongestCell_bytes);
  }
  return {};
}

KeyPair make_key_pair(std::string cell) {
  KeyText public_key;
  KeyText secret_key;
  if (zmq_curve_keypair(public_key, secret_key) != 0) {
    throw std::runtime_error("this machine's libzmq can't make keys: it was built without CURVE");
  }
  return {std::move(cell), public_key, secret_key};
}

Result<KeyPaths> write_key_pair(const KeyPair& pair, const std::filesystem::path& folder) {
  if (auto ok = validate_cell_name(pair.cell); !ok) return tl::unexpected(ok.error());
  if (!std::filesystem::is_directory(folder)) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return invalid("{}: can't be made: {}", folder.string(), error.message());
    std::filesystem::permissions(folder, std::filesystem::perms::owner_all, error);
  }
  KeyPaths paths{folder / (pair.cell + ".key"), folder / (pair.cell + ".pub")};
  // The secret one first: without it a public one is of no use.
  auto written = create_file(
      paths.secret,
      fmt::format("# Secret key of '{}'. Whoever has it is '{}': keep it where it was made, mode "
                  "0600.\n{} {} {}\n",
                  pair.cell, pair.cell, pair.cell, pair.public_key, pair.secret_key),
      0600);
  if (!written) return tl::unexpected(written.error());
  written = create_file(paths.public_key, public_line({pair.cell, pair.public_key}), 0644);
  if (!written) {
    std::error_code ignored;
    std::filesystem::remove(paths.secret, ignored);
    return tl::unexpected(written.error());
  }
  return paths;
}

Result<KeyPair> read_key_pair(const std::filesystem::path& path) {
  const auto file = read_text(path);
  if (!file) return tl::unexpected(file.error());
  if ((file->mode & 077U) != 0) {
    return invalid(
        "{}: others than its user may use this secret key (mode {:04o}); chmod 600 it, and make "
        "a new one if others had access",
        path.string(), file->mode);
  }
  const auto words = read_key_line(path, file->text);
  if (!words) return tl::unexpected(words.error());
  if (words->size() == 2) {
    return invalid("{}: is a public key; the secret one is in the file that ends in .key",
                   path.string());
  }
  if (words->size() != 3 || !is_key((*words)[1]) || !is_key((*words)[2]) ||
      derived_public_key((*words)[2]) != (*words)[1]) {
    return invalid("{}: is no key, or a damaged one; make one with 'grasp keys new'",
                   path.string());
  }
  return KeyPair{(*words)[0], (*words)[1], (*words)[2]};
}

Result<PublicKey> read_public_key(const std::filesystem::path& path) {
  const auto file = read_text(path);
  if (!file) return tl::unexpected(file.error());
  const auto words = read_key_line(path, file->text);
  if (!words) return tl::unexpected(words.error());
  if (words->size() == 3) {
    return invalid(
        "{}: is a secret key, which stays where it was made; say the file that ends in "
        ".pub",
        path.string());
  }
  if (words->size() != 2 || !is_key((*words)[1])) {
    return invalid("{}: is no public key; 'grasp keys new' makes them", path.string());
  }
  return PublicKey{(*words)[0], (*words)[1]};
}

Result<ClientKeys> read_client_keys(const std::filesystem::path& server_key,
                                    const std::filesystem::path& key_file) {
  if (server_key.empty() || key_file.empty()) {
    return invalid(
        "{} is missing: a client has both the server's public key and a key of its own, or none",
        server_key.empty() ? "the server's public key (server_key)" : "its own key (key_file)");
  }
  auto server = read_public_key(server_key);
  if (!server) return tl::unexpected(server.error());
  auto own = read_key_pair(key_file);
  if (!own) return tl::unexpected(own.error());
  return ClientKeys{std::move(server->public_key), *std::move(own)};
}

std::string public_line(const PublicKey& key) {
  return fmt::format("{} {}\n", key.cell, key.public_key);
}

}  // namespace graspd::keys
