#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace graspd {

/// The one table that names an enumeration's values, in messages, files and on command lines.
/// Specialise with `what` (the noun for error messages) and `values` (pairs of value and name).
template <class E>
struct EnumNames;

/// "?" for a value that the table does not have.
template <class E>
constexpr std::string_view name_of(E value) {
  for (const auto& [candidate, name] : EnumNames<E>::values) {
    if (candidate == value) return name;
  }
  return "?";
}

/// The value of that name, by the letter; nothing where there is none.
template <class E>
constexpr std::optional<E> parse_enum(std::string_view text) {
  for (const auto& [candidate, name] : EnumNames<E>::values) {
    if (name == text) return candidate;
  }
  return std::nullopt;
}

/// "a | b | c", for messages that say what would have been right.
template <class E>
std::string names_of() {
  std::string names;
  for (const auto& [candidate, name] : EnumNames<E>::values) {
    if (!names.empty()) names += " | ";
    names += name;
  }
  return names;
}

}  // namespace graspd
