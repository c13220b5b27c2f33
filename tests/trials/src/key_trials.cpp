#include <fmt/format.h>

#include "trial_servers.hpp"

namespace graspd::trials {
namespace {

using std::chrono::seconds;

constexpr seconds kBudget{20};
constexpr int kBlock_n = 100;

client::ClientOptions options_of(const std::string& cell, const Keyring& keys) {
  client::ClientOptions options;
  options.cell = cell;
  options.keys = keys.of_cells().at(cell);
  return options;
}

std::string sentence(const Error& error) {
  return fmt::format("{}: {}", name_of(error.code), error.message);
}

}  // namespace

RevokedKey revoke_a_key(std::size_t requests_n) {
  const Keyring keys({"cell_0", "cell_1", "cell_2", "revoked"});
  const auto server = start_server(2, {}, &keys);
  History history;
  LoadOptions options = cells_of({server->data_endpoint}, 3);
  options.keys = keys.of_cells();
  ClosedLoop load(options, history);
  const Question question = make_question(0, "echo");
  client::Client revoked({server->data_endpoint}, options_of("revoked", keys));
  const auto ask_revoked = [&] { return revoked.plan(question.frame, question.request, kBudget); };

  RevokedKey seen;
  for (int i = 0; i < kBlock_n; ++i) {
    if (ask_revoked()) ++seen.ok_before_n;
  }
  keys.revoke("revoked");
  server->kill(SIGHUP);
  auto answer = ask_revoked();
  while (answer) answer = ask_revoked();  // until the server has read the list
  seen.refusal = sentence(answer.error());
  for (int i = 0; i < kBlock_n; ++i) {
    if (ask_revoked()) ++seen.ok_after_n;
  }
  client::Client newcomer({server->data_endpoint}, options_of("revoked", keys));
  const auto refused = newcomer.plan(question.frame, question.request, kBudget);
  if (!refused) seen.newcomer_refusal = sentence(refused.error());
  history.wait_for(requests_n);
  load.stop();
  static_cast<Seen&>(seen) = seen_in(history);
  return seen;
}

Overhead overhead(int requests_n) {
  const Keyring keys({"cell"});
  const auto plain_server = start_server(1);
  const auto curve_server = start_server(1, {}, &keys);
  client::Client plain({plain_server->data_endpoint});
  client::Client curve({curve_server->data_endpoint}, options_of("cell", keys));
  const Question question = make_question(0, "empty");
  const auto ask_block = [&](client::Client& client, History& history) {
    for (int i = 0; i < kBlock_n; ++i) ask(client, question, kBudget, Clock::now(), history);
  };
  History first_ones;
  ask_block(plain, first_ones);
  ask_block(curve, first_ones);
  History plain_history;
  History curve_history;
  for (int done_n = 0; done_n < requests_n; done_n += kBlock_n) {
    ask_block(plain, plain_history);
    ask_block(curve, curve_history);
  }
  return {seen_in(plain_history).p50_ms, seen_in(curve_history).p50_ms};
}

Seen change_the_server_key(std::size_t requests_n) {
  const std::vector<std::string> names{"a", "b", "c", "d"};
  const Keyring before({"a_0", "b_0", "c_0", "d_0"});
  const Keyring after(before.of_cells());
  std::unique_ptr<testing::ServeProcess> servers[]{start_server(2, {}, &before),
                                                   start_server(2, {}, &before)};
  const std::vector<std::string> endpoints{servers[0]->data_endpoint, servers[1]->data_endpoint};
  History history;
  std::vector<std::unique_ptr<ClosedLoop>> cells;
  const auto start_cell = [&](const std::string& name, const Keyring& keys) {
    LoadOptions options = cells_of(endpoints, 1);
    options.name = name;
    options.keys = keys.of_cells();
    return std::make_unique<ClosedLoop>(options, history);
  };
  const auto change_server = [&](int i) {
    servers[i]->kill(SIGTERM);
    servers[i]->wait();
    servers[i] = start_server(2, endpoints[static_cast<std::size_t>(i)], &after);
    history.wait_for(requests_n);
  };
  for (const std::string& name : names) cells.push_back(start_cell(name, before));
  history.wait_for(requests_n);
  change_server(0);
  for (std::size_t i = 0; i < names.size(); ++i) {
    cells[i]->stop();
    cells[i] = start_cell(names[i], after);
    history.wait_for(requests_n);
  }
  change_server(1);
  for (const auto& cell : cells) cell->stop();
  return seen_in(history);
}

}  // namespace graspd::trials
