#include "valid_utf8.hpp"

#include <utf8.h>

#include <iterator>
#include <string>
#include <vector>

namespace graspd::codec {
namespace {

namespace pb = google::protobuf;

bool is_valid(const std::string& text) { return utf8::is_valid(text.begin(), text.end()); }

std::string mended(const std::string& text) {
  std::string valid;
  utf8::replace_invalid(text.begin(), text.end(), std::back_inserter(valid));
  return valid;
}

void mend_strings(const pb::FieldDescriptor* field, pb::Message& message) {
  const pb::Reflection& at = *message.GetReflection();
  std::string scratch;
  if (!field->is_repeated()) {
    const std::string& text = at.GetStringReference(message, field, &scratch);
    if (!is_valid(text)) at.SetString(&message, field, mended(text));
    return;
  }
  for (int i = 0; i < at.FieldSize(message, field); ++i) {
    const std::string& text = at.GetRepeatedStringReference(message, field, i, &scratch);
    if (!is_valid(text)) at.SetRepeatedString(&message, field, i, mended(text));
  }
}

void mend_messages(const pb::FieldDescriptor* field, pb::Message& message) {
  const pb::Reflection& at = *message.GetReflection();
  if (!field->is_repeated()) {
    make_strings_valid_utf8(*at.MutableMessage(&message, field));
    return;
  }
  for (int i = 0; i < at.FieldSize(message, field); ++i) {
    make_strings_valid_utf8(*at.MutableRepeatedMessage(&message, field, i));
  }
}

}  // namespace

void make_strings_valid_utf8(pb::Message& message) {
  std::vector<const pb::FieldDescriptor*> fields;
  message.GetReflection()->ListFields(message, &fields);
  for (const pb::FieldDescriptor* field : fields) {
    if (field->type() == pb::FieldDescriptor::TYPE_STRING) mend_strings(field, message);
    if (field->cpp_type() == pb::FieldDescriptor::CPPTYPE_MESSAGE) mend_messages(field, message);
  }
}

}  // namespace graspd::codec
