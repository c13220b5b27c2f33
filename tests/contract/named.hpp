#pragma once

#include <memory>
#include <ostream>
#include <string>

namespace graspd::testing {

/// One of those that a contract suite runs on, by the name that its tests bear.
template <class Make>
struct Named {
  std::string name;
  Make make;
};
template <class Make>
void PrintTo(const Named<Make>& tested, std::ostream* out) {
  *out << tested.name;
}

template <class Rig>
std::unique_ptr<Rig> make_rig() {
  return std::make_unique<Rig>();
}

}  // namespace graspd::testing
