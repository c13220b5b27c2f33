#include "graspd/recorded/questions.hpp"

#include "sources.hpp"

namespace graspd::recorded {

Result<std::unique_ptr<Questions>> open_questions(const std::filesystem::path& path,
                                                  std::optional<AskWith> ask_with) {
  std::error_code error;
  const bool is_folder = std::filesystem::is_directory(path, error);
  if (is_folder || path.extension() == kFlightExtension) return open_flights(path);
  return open_rawlog(path, std::move(ask_with));
}

}  // namespace graspd::recorded
