#include "graspd/trials/load.hpp"

namespace graspd::trials {
namespace {

std::vector<std::unique_ptr<client::Client>> make_clients(const LoadOptions& options) {
  std::vector<std::unique_ptr<client::Client>> clients;
  for (int cell = 0; cell < options.cells_n; ++cell) {
    client::ClientOptions own;
    own.cell = options.name + "_" + std::to_string(cell);
    own.dispatch = options.dispatch;
    if (const auto keys = options.keys.find(own.cell); keys != options.keys.end()) {
      own.keys = keys->second;
    }
    clients.push_back(std::make_unique<client::Client>(options.endpoints, own));
  }
  return clients;
}

std::vector<Question> make_questions(const std::string& script) {
  std::vector<Question> questions;
  for (std::uint32_t number = 0; number < kQuestions_n; ++number) {
    questions.push_back(make_question(number, script));
  }
  return questions;
}

}  // namespace

void ask(client::Client& client, const Question& question, std::chrono::milliseconds budget,
         TimePoint planned, History& history) {
  const RequestId id = client::new_request_id();
  history.asked(id, question.number, planned, budget);
  const auto left =
      std::chrono::duration_cast<std::chrono::milliseconds>(planned + budget - Clock::now());
  const auto answer = client.plan(question.frame, question.request, left, id);
  const TimePoint at = Clock::now();
  if (answer) {
    history.answered(id, at, question_of(*answer), digest_of(*answer));
  } else {
    history.refused(id, at, answer.error().code);
  }
}

ClosedLoop::ClosedLoop(const LoadOptions& options, History& history)
    : options_(options),
      history_(history),
      questions_(make_questions(options.script)),
      clients_(make_clients(options)) {
  for (const auto& client : clients_) {
    for (int i = 0; i < options_.in_flight_n; ++i) {
      threads_.emplace_back([this, &client = *client, first = threads_.size()] {
        for (std::size_t number = first; !stop_; ++number) {
          ask(client, questions_[number % questions_.size()], options_.budget, Clock::now(),
              history_);
        }
      });
    }
  }
}

ClosedLoop::~ClosedLoop() { stop(); }

void ClosedLoop::stop() {
  stop_ = true;
  for (std::thread& thread : threads_) {
    if (thread.joinable()) thread.join();
  }
}

void run_open_loop(const LoadOptions& options, double rate_hz, int requests_n, History& history) {
  const auto clients = make_clients(options);
  for (const auto& client : clients) (void)client->health();  // connected from here on
  const std::vector<Question> questions = make_questions(options.script);
  const int threads_n = options.cells_n * options.in_flight_n;
  const TimePoint start = Clock::now();
  const auto planned = [&](int i) {
    return start +
           std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(i / rate_hz));
  };
  std::vector<std::thread> threads;
  for (int first = 0; first < threads_n; ++first) {
    threads.emplace_back([&, first] {
      for (int i = first; i < requests_n; i += threads_n) {
        std::this_thread::sleep_until(planned(i));
        ask(*clients[static_cast<std::size_t>(i % options.cells_n)],
            questions[static_cast<std::size_t>(i) % questions.size()], options.budget, planned(i),
            history);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace graspd::trials
