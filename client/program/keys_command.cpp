#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "graspd/command_line/help.hpp"
#include "graspd/formats/table.hpp"
#include "graspd/keys/allow_list.hpp"
#include "graspd/keys/key_files.hpp"

namespace graspd::program {
namespace {

struct KeysArguments {
  std::string name;
  std::string folder = ".";
  std::string file;
  std::string list = "allowed_cells";
};

constexpr std::string_view kReload = "a running server takes it up on SIGHUP";

Result<int> make(const KeysArguments& arguments) {
  // A wrong name is said before a key is made for it.
  if (auto ok = keys::validate_cell_name(arguments.name); !ok) return tl::unexpected(ok.error());
  const auto paths = keys::write_key_pair(keys::make_key_pair(arguments.name), arguments.folder);
  if (!paths) return tl::unexpected(paths.error());
  fmt::print(
      "{}  secret: stays on the machine of '{}', readable by its user alone\n"
      "{}  public: a cell's is for 'grasp keys allow', a server's is for its cells\n",
      paths->secret.string(), arguments.name, paths->public_key.string());
  return 0;
}

Result<int> allow(const KeysArguments& arguments) {
  const auto key = keys::read_public_key(arguments.file);
  if (!key) return tl::unexpected(key.error());
  if (auto ok = keys::allow(arguments.list, *key); !ok) return tl::unexpected(ok.error());
  fmt::print("{}: '{}' is allowed; {}\n", arguments.list, key->cell, kReload);
  return 0;
}

Result<int> revoke(const KeysArguments& arguments) {
  const auto revoked_n = keys::revoke(arguments.list, arguments.name);
  if (!revoked_n) return tl::unexpected(revoked_n.error());
  fmt::print("{}: '{}' is not allowed any more ({} key{}); {}\n", arguments.list, arguments.name,
             *revoked_n, *revoked_n == 1 ? "" : "s", kReload);
  return 0;
}

Result<int> list(const KeysArguments& arguments) {
  const auto allowed = keys::AllowList::read(arguments.list);
  if (!allowed) return tl::unexpected(allowed.error());
  for (const std::string& fault : allowed->faults()) fmt::print(stderr, "grasp: {}\n", fault);
  Table table({"cell", "public key"});
  for (const keys::PublicKey& key : allowed->entries()) table.add({key.cell, key.public_key});
  fmt::print("{}", table.to_text());
  return 0;
}

void add_list_option(CLI::App& command, KeysArguments& arguments) {
  command.add_option("--list", arguments.list, "the server's list of allowed cells")
      ->type_name("FILE")
      ->capture_default_str();
}

}  // namespace

void add_keys_command(CLI::App& app) {
  const auto arguments = std::make_shared<KeysArguments>();
  CLI::App* keys = app.add_subcommand("keys", "make keys, and say which cells may use a server");
  keys->require_subcommand(1);
  const std::string serve =
      "grasp_server serve --config deploy/server.yaml --key build/keys/server.key \\\n    "
      "--allowed-cells build/keys/allowed_cells";
  set_help(*keys, "",
           {"grasp keys new server --out build/keys", "grasp keys new tees --out build/keys",
            "grasp keys allow build/keys/tees.pub --list build/keys/allowed_cells", serve,
            "grasp health --server-key build/keys/server.pub --key build/keys/tees.key"});

  CLI::App* command = keys->add_subcommand("new", "make a key pair; never overwrites one");
  command->add_option("NAME", arguments->name, "the cell, or 'server'")->required();
  command->add_option("--out", arguments->folder, "folder for NAME.key and NAME.pub")
      ->type_name("DIR")
      ->capture_default_str();
  set_help(*command, "", {"grasp keys new elbows --out build/keys"});
  command->callback([arguments] { finish(make(*arguments)); });

  command = keys->add_subcommand("allow", "add a cell's public key to a server's list");
  command->add_option("FILE", arguments->file, "its .pub file")->required();
  add_list_option(*command, *arguments);
  set_help(*command, "",
           {"grasp keys allow build/keys/elbows.pub --list build/keys/allowed_cells"});
  command->callback([arguments] { finish(allow(*arguments)); });

  command = keys->add_subcommand("revoke", "take a cell's keys out of a server's list");
  command->add_option("CELL", arguments->name, "the cell")->required();
  add_list_option(*command, *arguments);
  set_help(*command, "", {"grasp keys revoke elbows --list build/keys/allowed_cells"});
  command->callback([arguments] { finish(revoke(*arguments)); });

  command = keys->add_subcommand("list", "show which cells a server allows");
  add_list_option(*command, *arguments);
  set_help(*command, "", {"grasp keys list --list build/keys/allowed_cells"});
  command->callback([arguments] { finish(list(*arguments)); });
}

}  // namespace graspd::program
