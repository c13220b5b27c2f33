#include "graspd/load/generator.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace graspd::load {

Generator::Generator(std::vector<Cell> cells, const GeneratorOptions& options, Observer observer)
    : observer_(std::move(observer)), budget_(options.budget) {
  for (Cell& cell : cells) {
    if (!cell.plans || cell.plans->empty()) {
      throw std::invalid_argument(fmt::format("cell '{}' has nothing to ask", cell.name));
    }
    auto seat = std::make_unique<Seat>();
    client::ClientOptions own;
    own.cell = cell.name;
    own.keys = cell.keys;
    own.dispatch = options.dispatch;
    seat->client = std::make_unique<client::Client>(options.endpoints, std::move(own));
    seat->cell = std::move(cell);
    cells_.push_back(std::move(seat));
  }
}

Generator::~Generator() { cells_.clear(); }

void Generator::connect() {
  for (const auto& seat : cells_) (void)seat->client->health();
}

void Generator::ask(std::size_t cell, TimePoint planned, std::function<void()> then) {
  Seat& seat = *cells_.at(cell);
  const std::size_t plan = (cell + seat.asked_n++) % seat.cell.plans->size();
  const Asked asked{client::new_request_id(), cell, plan, planned, budget_};
  {
    const std::lock_guard lock(mutex_);
    ++in_flight_n_;
  }
  observer_.asked(asked);
  const TimePoint now = Clock::now();
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(planned + budget_ - now);
  seat.client->submit((*seat.cell.plans)[plan], left, asked.id,
                      [this, asked, now, then = std::move(then)](client::PlanEnd end) {
                        observer_.ended(Ended{asked, now, std::move(end)});
                        if (then) then();
                        const std::lock_guard lock(mutex_);
                        if (--in_flight_n_ == 0) ended_.notify_all();
                      });
}

void Generator::wait_until_idle() {
  std::unique_lock lock(mutex_);
  ended_.wait(lock, [this] { return in_flight_n_ == 0; });
}

ClosedLoop::ClosedLoop(Generator& generator, int in_flight_n) : generator_(generator) {
  for (std::size_t cell = 0; cell < generator.cells_n(); ++cell) {
    for (int i = 0; i < in_flight_n; ++i) ask(cell);
  }
}

void ClosedLoop::ask(std::size_t cell) {
  generator_.ask(cell, Clock::now(), [this, cell] {
    if (!stop_) ask(cell);
  });
}

void ClosedLoop::stop() {
  stop_ = true;
  generator_.wait_until_idle();
}

}  // namespace graspd::load
