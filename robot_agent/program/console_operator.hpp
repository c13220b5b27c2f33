#pragma once

#include "graspd/agent/ports.hpp"

namespace graspd::robot_agent {

/// An operator at the terminal, or with `kill`: a line on standard input goes on, unless it is
/// "stop"; so does SIGUSR1, and SIGTERM stops. Where standard input is closed, only signals count.
class ConsoleOperator final : public agent::Operator {
 public:
  agent::OperatorSays ask(const std::string& what) override;

 private:
  bool input_is_open_ = true;
};

}  // namespace graspd::robot_agent
