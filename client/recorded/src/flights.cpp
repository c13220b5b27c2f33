#include <algorithm>
#include <fstream>
#include <vector>

#include "sources.hpp"

namespace graspd::recorded {
namespace {

namespace fs = std::filesystem;

Result<PlanAnswer> answer_of(const FlightRecord& flight) {
  auto answer = codec::decode_answer(bytes_of(flight.answer));
  if (!answer) return tl::unexpected(answer.error());
  if (auto* plan = std::get_if<PlanAnswer>(&answer->body)) return std::move(*plan);
  return fail(answer->code, "{}", answer->message);
}

/// Of the server's flight recorder, one file each.
class Flights final : public Questions {
 public:
  Flights(fs::path folder, std::vector<fs::path> files)
      : folder_(std::move(folder)), files_(std::move(files)) {}

  Result<std::optional<Question>> next() override {
    while (next_ < files_.size()) {
      const fs::path& file = files_[next_++];
      std::ifstream stream(file, std::ios::binary);
      // A server that goes on recording takes the oldest ones away.
      if (!stream && !fs::exists(file) && files_.size() > 1) continue;
      const std::string bytes(std::istreambuf_iterator<char>(stream), {});
      if (!stream) return invalid("{}: can't be read; may you read it?", file.string());
      auto flight = codec::decode_flight(bytes_of(bytes));
      if (!flight) return invalid("{}: {}", file.string(), flight.error().message);
      auto answer = answer_of(*flight);
      return Question{file.lexically_relative(folder_).string(), *std::move(flight),
                      std::move(answer)};
    }
    return std::nullopt;
  }

 private:
  fs::path folder_;
  std::vector<fs::path> files_;
  std::size_t next_ = 0;
};

/// In the order of their time, with which their names begin.
std::vector<fs::path> flights_in(const fs::path& folder, const fs::path& after) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path& file = entry->path();
    if (file.extension() == kFlightExtension && file.filename() > after.filename()) {
      files.push_back(file);
    }
  }
  std::ranges::sort(files, {}, [](const fs::path& file) { return file.filename(); });
  return files;
}

}  // namespace

Result<std::unique_ptr<Questions>> open_flights(const fs::path& path) {
  std::error_code error;
  if (fs::is_regular_file(path, error)) {
    return std::make_unique<Flights>(path.parent_path(), std::vector{path});
  }
  auto files = flights_in(path, {});
  if (files.empty()) {
    return invalid("{}: there is no flight record (*{})", path.string(), kFlightExtension);
  }
  return std::make_unique<Flights>(path, std::move(files));
}

Result<std::unique_ptr<Questions>> open_flights_after(const fs::path& folder,
                                                      const std::string& name) {
  return std::make_unique<Flights>(folder, flights_in(folder, name));
}

}  // namespace graspd::recorded
