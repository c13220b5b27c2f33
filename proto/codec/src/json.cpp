#include <google/protobuf/util/json_util.h>

#include <stdexcept>

#include "convert.hpp"
#include "graspd/codec/codec.hpp"

namespace graspd::codec {
namespace {

template <class Wire, class T>
std::string print(const T& value, bool indented) {
  Wire message;
  write(value, message);
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = indented;
  options.preserve_proto_field_names = true;
  // A script that reads a count wants to find the 0.
  options.always_print_primitive_fields = true;
  std::string json;
  const auto status = google::protobuf::util::MessageToJsonString(message, &json, options);
  if (!status.ok()) throw std::runtime_error("a message as JSON: " + status.ToString());
  return json;
}

}  // namespace

std::string to_json(const PlanRequest& request, bool indented) {
  return print<v1::PlanRequest>(request, indented);
}

std::string to_json(const PlanAnswer& answer, bool indented) {
  return print<v1::PlanAnswer>(answer, indented);
}

std::string to_json(const HealthAnswer& answer, bool indented) {
  return print<v1::HealthAnswer>(answer, indented);
}

}  // namespace graspd::codec
