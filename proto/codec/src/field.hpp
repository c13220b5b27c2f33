#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "graspd/types/result.hpp"

namespace graspd::codec {

/// Where a decoder stands in a message. Decoders read a message from top to bottom as if all were
/// well, and tell the field where it is not; the first refusal is kept, with the field's path as in
/// the schema. A path costs nothing until a sentence needs it.
class Field {
 public:
  explicit Field(std::optional<Error>& refusal) : refusal_(refusal) {}

  Field operator()(std::string_view name) const& { return {*this, name, kNoIndex}; }
  Field operator[](int index) const& { return {*this, {}, index}; }
  // A field refers to the one it is in, which therefore must have a name of its own.
  Field operator()(std::string_view name) const&& = delete;
  Field operator[](int index) const&& = delete;

  bool ok() const { return !refusal_; }

  template <class... Args>
  void refuse(fmt::format_string<Args...> format, Args&&... args) const {
    if (!ok()) return;
    const std::string sentence = fmt::format(format, std::forward<Args>(args)...);
    refusal_ = Error{Code::kInvalidArgument, fmt::format("{}: {}", path(), sentence)};
  }
  /// What `validate` says of the struct that was read from here; it names fields relative to it.
  void accept(const Result<void>& valid) const {
    if (ok() && !valid) {
      refusal_ = Error{valid.error().code, fmt::format("{}.{}", path(), valid.error().message)};
    }
  }

  /// The field of a sub-message, refused where that is missing.
  const Field& required(bool present) const {
    if (!present) refuse("missing; it is required");
    return *this;
  }
  double number(double value) const {
    if (!std::isfinite(value)) refuse("{} is not a finite number", value);
    return value;
  }
  /// Names end up in sentences, logs and metrics: short, and nothing that moves a cursor.
  std::string name(std::string value) const {
    constexpr std::size_t kMaxName_bytes = 128;
    if (value.size() > kMaxName_bytes) {
      refuse("a name of {} bytes; at most {} are taken", value.size(), kMaxName_bytes);
    }
    for (const char c : value) {
      const auto byte = static_cast<unsigned char>(c);
      if (byte < 0x20 || byte == 0x7f) {
        refuse("control character {:#04x} in a name; take it out", byte);
      }
    }
    return value;
  }

 private:
  static constexpr int kNoIndex = -1;

  Field(const Field& parent, std::string_view name, int index)
      : refusal_(parent.refusal_), parent_(&parent), name_(name), index_(index) {}

  std::string path() const {
    if (!parent_) return {};
    const std::string before = parent_->path();
    if (index_ != kNoIndex) return fmt::format("{}[{}]", before, index_);
    return before.empty() ? std::string(name_) : fmt::format("{}.{}", before, name_);
  }

  std::optional<Error>& refusal_;
  const Field* parent_ = nullptr;
  std::string_view name_;
  int index_ = kNoIndex;
};

}  // namespace graspd::codec
