#pragma once

#include <functional>
#include <string_view>
#include <utility>

#include "graspd/types/enum_names.hpp"

namespace graspd::service {

/// Where one is chosen, its lines and those of the ones after it are written.
enum class LogLevel { kDebug, kInfo, kWarning, kError, kOff };

/// Where log lines go: each is one JSON object without a line feed. Called from the front's thread
/// only.
using Log = std::function<void(LogLevel, std::string_view)>;

}  // namespace graspd::service

template <>
struct graspd::EnumNames<graspd::service::LogLevel> {
  using LogLevel = graspd::service::LogLevel;
  static constexpr std::string_view what = "log level";
  static constexpr std::pair<LogLevel, std::string_view> values[] = {
      {LogLevel::kDebug, "debug"},
      {LogLevel::kInfo, "info"},
      {LogLevel::kWarning, "warning"},
      {LogLevel::kError, "error"},
      {LogLevel::kOff, "off"}};
};
