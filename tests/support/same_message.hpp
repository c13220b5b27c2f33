#pragma once

#include <gtest/gtest.h>

#include <typeinfo>

#include "fields.hpp"

namespace graspd::testing {

/// Whether two messages agree in every field: exactly, but for poses, which cross the wire as
/// quaternions and may differ by rounding.
template <class T>
struct Same {
  static ::testing::AssertionResult check(T& a, T& b) {
    if constexpr (requires { fields(a); }) {
      return check_fields(fields(a), fields(b),
                          std::make_index_sequence<std::tuple_size_v<decltype(fields(a))>>());
    } else if (a == b) {
      return ::testing::AssertionSuccess();
    } else {
      return ::testing::AssertionFailure()
             << ::testing::PrintToString(a) << " is not " << ::testing::PrintToString(b);
    }
  }

 private:
  template <class Tuple, std::size_t... I>
  static ::testing::AssertionResult check_fields(const Tuple& a, const Tuple& b,
                                                 std::index_sequence<I...>) {
    ::testing::AssertionResult same = ::testing::AssertionSuccess();
    [[maybe_unused]] const auto check_field = [&](std::size_t i, auto& field_a, auto& field_b) {
      using Field = std::remove_reference_t<decltype(field_a)>;
      const auto result = Same<Field>::check(field_a, field_b);
      if (same && !result) {
        same = ::testing::AssertionFailure()
               << "field " << i << " of " << typeid(T).name() << ": " << result.message();
      }
    };
    (check_field(I, std::get<I>(a), std::get<I>(b)), ...);
    return same;
  }
};

template <>
struct Same<Eigen::Isometry3d> {
  static ::testing::AssertionResult check(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    constexpr double kTolerance = 1e-12;
    if ((a.matrix() - b.matrix()).cwiseAbs().maxCoeff() <= kTolerance) {
      return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure() << "pose\n" << a.matrix() << "\nis not\n" << b.matrix();
  }
};

template <class T>
struct Same<std::optional<T>> {
  static ::testing::AssertionResult check(std::optional<T>& a, std::optional<T>& b) {
    if (a.has_value() != b.has_value()) return ::testing::AssertionFailure() << "one is not given";
    return a ? Same<T>::check(*a, *b) : ::testing::AssertionSuccess();
  }
};

template <class T>
struct Same<std::vector<T>> {
  static ::testing::AssertionResult check(std::vector<T>& a, std::vector<T>& b) {
    if (a.size() != b.size()) {
      return ::testing::AssertionFailure() << a.size() << " entries are not " << b.size();
    }
    for (std::size_t i = 0; i < a.size(); ++i) {
      const auto same = Same<T>::check(a[i], b[i]);
      if (!same) return ::testing::AssertionFailure() << "entry " << i << ": " << same.message();
    }
    return ::testing::AssertionSuccess();
  }
};

template <class... T>
struct Same<std::variant<T...>> {
  static ::testing::AssertionResult check(std::variant<T...>& a, std::variant<T...>& b) {
    if (a.index() != b.index()) return ::testing::AssertionFailure() << "other alternatives";
    return std::visit(
        [&](auto& value) {
          using Value = std::remove_reference_t<decltype(value)>;
          return Same<Value>::check(value, std::get<Value>(b));
        },
        a);
  }
};

/// EXPECT_TRUE(same(decoded, request));
template <class T>
::testing::AssertionResult same(T a, T b) {
  return Same<T>::check(a, b);
}

}  // namespace graspd::testing
