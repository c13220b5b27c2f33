#pragma once

#include <cstddef>
#include <vector>

namespace graspd::perception {

/// One value for each ordered pair of parts.
template <class T>
class Pairs {
 public:
  explicit Pairs(std::size_t parts_n) : parts_n_(parts_n), values_(parts_n * parts_n) {}
  T& operator()(std::size_t a, std::size_t b) { return values_[a * parts_n_ + b]; }
  const T& operator()(std::size_t a, std::size_t b) const { return values_[a * parts_n_ + b]; }

 private:
  std::size_t parts_n_;
  std::vector<T> values_;
};

}  // namespace graspd::perception
