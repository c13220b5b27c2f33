#pragma once

#include <map>
#include <optional>
#include <string>

#include "graspd/recorded/answer_diff.hpp"
#include "graspd/types/result.hpp"

namespace graspd::program {

/// What has become of recorded answers, question by question, and in sum.
class DiffReport {
 public:
  /// \param before nothing: none was recorded
  /// \returns a line, and a table of the grasps that changed.
  std::string add(const std::string& name, const std::optional<Result<PlanAnswer>>& before,
                  const Result<PlanAnswer>& now);
  std::string summary() const;

  std::size_t asked_n() const { return asked_n_; }
  bool any_differs() const { return differ_n_ > 0; }
  /// The last refusal.
  std::optional<Error> failure() const { return failure_; }

 private:
  std::string compare(const PlanAnswer& before, const PlanAnswer& now);

  std::size_t asked_n_ = 0;
  std::size_t same_n_ = 0;
  std::size_t differ_n_ = 0;
  std::map<std::string, std::size_t> differ_since_n_;
  std::size_t failed_before_n_ = 0;
  std::size_t failed_n_ = 0;
  std::optional<Error> failure_;
  std::string servers_;  ///< how the servers differ, as last seen
};

}  // namespace graspd::program
