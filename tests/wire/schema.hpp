#pragma once

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/text_format.h>

#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

/// The wire tests look into bytes through protobuf's reflection, by the names of the schema: the
/// generated headers are the codec's alone.
namespace graspd::testing {

namespace pb = google::protobuf;

inline std::span<const std::byte> as_bytes(const std::string& bytes) {
  return std::as_bytes(std::span(bytes));
}

/// Sets one field, in protobuf's text format. A repeated field gets one more entry.
struct Edit {
  std::string path;  ///< "plan.request.parts[0].id"
  std::string text;  ///< "\"tee\"", "nan", "{ x: 1 }", or kClear
};
inline const std::string kClear = "clear";

/// Names a test after its row.
inline const auto kRowName = [](const auto& test) { return test.param.name; };

namespace schema {

inline const pb::Descriptor& type(const std::string& name) {
  const auto* found =
      pb::DescriptorPool::generated_pool()->FindMessageTypeByName("graspd.v1." + name);
  if (!found) throw std::invalid_argument("no message graspd.v1." + name);
  return *found;
}

inline std::unique_ptr<pb::Message> parse(const std::string& type_name, const std::string& bytes) {
  const auto* prototype = pb::MessageFactory::generated_factory()->GetPrototype(&type(type_name));
  std::unique_ptr<pb::Message> message(prototype->New());
  if (!message->ParseFromString(bytes)) {
    throw std::invalid_argument("these bytes are no " + type_name);
  }
  return message;
}

inline const pb::FieldDescriptor* find(const pb::Message& message, std::string_view name) {
  const auto* field = message.GetDescriptor()->FindFieldByName(std::string(name));
  if (!field) throw std::invalid_argument("no field " + std::string(name));
  return field;
}

/// One step of a path: "bin", or "parts[0]".
inline pb::Message& child(pb::Message& parent, std::string_view step) {
  const auto bracket = step.find('[');
  const auto* field = find(parent, step.substr(0, bracket));
  const auto* reflection = parent.GetReflection();
  if (bracket == step.npos) return *reflection->MutableMessage(&parent, field);
  const int index = std::stoi(std::string(step.substr(bracket + 1)));
  return *reflection->MutableRepeatedMessage(&parent, field, index);
}

inline void apply(const Edit& edit, pb::Message& root) {
  pb::Message* message = &root;
  std::string_view path = edit.path;
  for (auto dot = path.find('.'); dot != path.npos; dot = path.find('.')) {
    message = &child(*message, path.substr(0, dot));
    path.remove_prefix(dot + 1);
  }
  const auto* field = find(*message, path);
  if (edit.text == kClear) {
    message->GetReflection()->ClearField(message, field);
  } else if (!pb::TextFormat::Parser().ParseFieldValueFromString(edit.text, field, message)) {
    throw std::invalid_argument(edit.path + " cannot be " + edit.text);
  }
}

inline std::string edit(const std::string& type_name, const std::string& bytes,
                        const std::vector<Edit>& edits) {
  const auto message = parse(type_name, bytes);
  for (const Edit& one : edits) apply(one, *message);
  return message->SerializeAsString();
}

}  // namespace schema
}  // namespace graspd::testing
