#include "graspd/trials/load.hpp"

#include "graspd/load/pace.hpp"

namespace graspd::trials {
namespace {

std::shared_ptr<const std::vector<client::PreparedPlan>> make_plans(const std::string& script) {
  std::vector<client::PreparedPlan> plans;
  for (std::uint32_t number = 0; number < kQuestions_n; ++number) {
    const Question question = make_question(number, script);
    plans.push_back(client::prepare(question.frame, question.request).value());
  }
  return std::make_shared<const std::vector<client::PreparedPlan>>(std::move(plans));
}

void note(const RequestId& id, const client::PlanEnd& end, History& history) {
  if (end.answer) {
    history.answered(id, end.ended, question_of(*end.answer), digest_of(*end.answer));
  } else {
    history.refused(id, end.ended, end.answer.error().code);
  }
}

std::unique_ptr<load::Generator> make_generator(const LoadOptions& options, History& history) {
  const auto plans = make_plans(options.script);
  std::vector<load::Cell> cells;
  for (int number = 0; number < options.cells_n; ++number) {
    load::Cell cell{options.name + "_" + std::to_string(number), std::nullopt, plans};
    if (const auto keys = options.keys.find(cell.name); keys != options.keys.end()) {
      cell.keys = keys->second;
    }
    cells.push_back(std::move(cell));
  }
  load::Observer observer;
  observer.asked = [&history](const load::Asked& asked) {
    history.asked(asked.id, static_cast<std::uint32_t>(asked.plan), asked.planned, asked.budget);
  };
  observer.ended = [&history](const load::Ended& ended) { note(ended.id, ended.end, history); };
  return std::make_unique<load::Generator>(
      std::move(cells), load::GeneratorOptions{options.endpoints, options.budget, options.dispatch},
      std::move(observer));
}

}  // namespace

void ask(client::Client& client, const Question& question, std::chrono::milliseconds budget,
         TimePoint planned, History& history) {
  const RequestId id = client::new_request_id();
  history.asked(id, question.number, planned, budget);
  const auto left =
      std::chrono::duration_cast<std::chrono::milliseconds>(planned + budget - Clock::now());
  auto answer = client.plan(question.frame, question.request, left, id);
  note(id, {std::move(answer), std::nullopt, Clock::now()}, history);
}

ClosedLoop::ClosedLoop(const LoadOptions& options, History& history)
    : generator_(make_generator(options, history)), loop_(*generator_, options.in_flight_n) {}

void run_open_loop(const LoadOptions& options, double rate_hz, int requests_n, History& history) {
  const auto generator = make_generator(options, history);
  generator->connect();
  const auto pace = load::fixed_pace(Clock::now(), rate_hz, generator->cells_n());
  load::run_open_loop(*generator, pace,
                      [left_n = requests_n](const load::Due&) mutable { return left_n-- > 0; });
  generator->wait_until_idle();
}

}  // namespace graspd::trials
