#pragma once

#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>

/// Prometheus's text format, read as strictly as Prometheus does.
namespace graspd::testing {

struct MetricsText {
  std::map<std::string, double> series;  ///< by name and labels, as `name{a="b"}`
  std::map<std::string, std::string> type;

  double at(const std::string& name) const {
    const auto found = series.find(name);
    if (found == series.end()) {
      ADD_FAILURE() << "no series " << name;
      return -1;
    }
    return found->second;
  }
  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& [name, value] : series) all.insert(name);
    return all;
  }
};

inline MetricsText parse_metrics(const std::string& text) {
  static const std::regex type(R"(# TYPE ([a-z_]+) (counter|gauge|histogram))");
  static const std::regex help(R"(# HELP [a-z_]+ \S.*)");
  static const std::regex sample(
      R"re(([a-z_]+(?:\{[a-z_]+="[^"\n]*"(?:,[a-z_]+="[^"\n]*")*\})?) (\S+))re");
  MetricsText parsed;
  std::istringstream lines(text);
  std::string line;
  std::smatch match;
  while (std::getline(lines, line)) {
    if (std::regex_match(line, match, type)) {
      parsed.type[match[1]] = match[2];
    } else if (std::regex_match(line, match, sample)) {
      EXPECT_TRUE(parsed.series.emplace(match[1], std::stod(match[2])).second) << line << " twice";
    } else {
      EXPECT_TRUE(std::regex_match(line, help)) << line;
    }
  }
  return parsed;
}

}  // namespace graspd::testing
