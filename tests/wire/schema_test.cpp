#include "schema.hpp"

#include <gtest/gtest.h>

#include <set>

#include "graspd/codec/codec.hpp"
#include "random_messages.hpp"
#include "same_message.hpp"

namespace graspd::testing {
namespace {

template <class F>
void for_each_type(const pb::Descriptor& type, std::set<std::string>& seen, const F& visit) {
  if (!seen.insert(type.full_name()).second) return;
  visit(type);
  for (int i = 0; i < type.field_count(); ++i) {
    if (const auto* child = type.field(i)->message_type()) for_each_type(*child, seen, visit);
  }
}

template <class F>
void for_each_type(const F& visit) {
  std::set<std::string> seen;
  for (const char* type : {"Request", "Answer"}) {
    for_each_type(schema::type(type), seen, visit);
  }
}

bool is_real(const pb::FieldDescriptor& field) {
  return field.cpp_type() == pb::FieldDescriptor::CPPTYPE_DOUBLE ||
         field.cpp_type() == pb::FieldDescriptor::CPPTYPE_FLOAT;
}

/// One scalar of a message.
struct Leaf {
  pb::Message* parent;
  const pb::FieldDescriptor* field;
  int index;  ///< −1 where the field is not repeated
};

void collect_leaves(pb::Message& message, std::vector<Leaf>& leaves) {
  const auto* reflection = message.GetReflection();
  std::vector<const pb::FieldDescriptor*> set_fields;
  reflection->ListFields(message, &set_fields);
  for (const auto* field : set_fields) {
    const bool is_message = field->cpp_type() == pb::FieldDescriptor::CPPTYPE_MESSAGE;
    const int n = field->is_repeated() ? reflection->FieldSize(message, field) : 1;
    for (int i = 0; i < n; ++i) {
      if (!is_message) {
        leaves.push_back({&message, field, field->is_repeated() ? i : -1});
      } else if (field->is_repeated()) {
        collect_leaves(*reflection->MutableRepeatedMessage(&message, field, i), leaves);
      } else {
        collect_leaves(*reflection->MutableMessage(&message, field), leaves);
      }
    }
  }
}

std::vector<Leaf> leaves_of(pb::Message& message) {
  std::vector<Leaf> leaves;
  collect_leaves(message, leaves);
  return leaves;
}

void set(const Leaf& leaf, const std::string& text) {
  const auto [message, field, index] = leaf;
  ASSERT_TRUE(pb::TextFormat::Parser().ParseFieldValueFromString(text, field, message));
  if (!field->is_repeated()) return;
  // Text only adds entries: the new one changes places with the old, which is then the last.
  const auto* reflection = message->GetReflection();
  reflection->SwapElements(message, field, index, reflection->FieldSize(*message, field) - 1);
  reflection->RemoveLast(message, field);
}

/// Another value of the same type, near the one that is there.
std::string another(const Leaf& leaf) {
  std::string text;
  pb::TextFormat::PrintFieldValueToString(*leaf.parent, leaf.field, leaf.index, &text);
  switch (leaf.field->cpp_type()) {
    case pb::FieldDescriptor::CPPTYPE_STRING:
      return text.insert(text.size() - 1, "x");
    case pb::FieldDescriptor::CPPTYPE_BOOL:
      return text == "true" ? "false" : "true";
    case pb::FieldDescriptor::CPPTYPE_ENUM: {
      const auto* type = leaf.field->enum_type();
      const int number = type->FindValueByName(text)->number();
      return type->FindValueByNumber(number > 1 ? number - 1 : number + 1)->name();
    }
    case pb::FieldDescriptor::CPPTYPE_DOUBLE:
    case pb::FieldDescriptor::CPPTYPE_FLOAT:
      return std::to_string(std::stod(text) + 1e-4);
    default:
      return std::to_string(std::stoull(text) - 1);
  }
}

/// Changes one scalar after the other. Each must be refused or come out changed: a field that the
/// codec forgets would do neither.
template <class Decode>
void expect_every_field_matters(const std::string& type, const std::string& bytes,
                                const Decode& decode) {
  const auto original = decode(as_bytes(bytes));
  ASSERT_TRUE(original) << original.error().message;
  const std::size_t leaves_n = leaves_of(*schema::parse(type, bytes)).size();
  for (std::size_t i = 0; i < leaves_n; ++i) {
    const auto message = schema::parse(type, bytes);
    const Leaf leaf = leaves_of(*message)[i];
    set(leaf, another(leaf));
    ASSERT_NE(message->SerializeAsString(), bytes) << leaf.field->full_name();
    const auto changed = decode(as_bytes(message->SerializeAsString()));
    EXPECT_TRUE(!changed || !same(*changed, *original)) << leaf.field->full_name();
  }
}

TEST(Schema, EveryFieldOfARequestMatters) {
  RandomMessages random(1);
  for (int i = 0; i < 4; ++i) {
    expect_every_field_matters("Request", codec::encode_request(random.plan_request()),
                               codec::decode_request);
  }
}

TEST(Schema, EveryFieldOfAnAnswerMatters) {
  RandomMessages random(2);
  Answer refusal = random.refusal();
  refusal.code = Code::kBusy;  // the version of UNSUPPORTED_VERSION may be any
  for (const Answer& answer : {random.plan_answer(), random.health_answer(), refusal}) {
    expect_every_field_matters("Answer", codec::encode_answer(answer), codec::decode_answer);
  }
}

/// Puts NaN and infinity into one real number after the other.
template <class Decode>
void expect_only_finite_numbers(const std::string& type, const std::string& bytes,
                                const Decode& decode) {
  const std::size_t leaves_n = leaves_of(*schema::parse(type, bytes)).size();
  for (std::size_t i = 0; i < leaves_n; ++i) {
    for (const std::string text : {"nan", "inf", "-inf"}) {
      const auto message = schema::parse(type, bytes);
      const Leaf leaf = leaves_of(*message)[i];
      if (!is_real(*leaf.field)) continue;
      set(leaf, text);
      const auto decoded = decode(as_bytes(message->SerializeAsString()));
      ASSERT_FALSE(decoded) << leaf.field->full_name() << ": " << text;
      const std::string& sentence = decoded.error().message;
      EXPECT_NE(sentence.find(leaf.field->name()), std::string::npos) << sentence;
      EXPECT_NE(sentence.find(text + " is not a finite number"), std::string::npos) << sentence;
    }
  }
}

TEST(Schema, EveryNumberMustBeFinite) {
  RandomMessages random(4);
  for (int i = 0; i < 4; ++i) {
    expect_only_finite_numbers("Request", codec::encode_request(random.plan_request()),
                               codec::decode_request);
  }
  for (const Answer& answer : {random.plan_answer(), random.health_answer()}) {
    expect_only_finite_numbers("Answer", codec::encode_answer(answer), codec::decode_answer);
  }
}

void note_set_fields(const pb::Message& message, std::set<std::string>& names) {
  std::vector<const pb::FieldDescriptor*> set_fields;
  const auto* reflection = message.GetReflection();
  reflection->ListFields(message, &set_fields);
  for (const auto* field : set_fields) {
    names.insert(field->full_name());
    if (field->cpp_type() != pb::FieldDescriptor::CPPTYPE_MESSAGE) continue;
    if (!field->is_repeated()) note_set_fields(reflection->GetMessage(message, field), names);
    for (int i = 0; field->is_repeated() && i < reflection->FieldSize(message, field); ++i) {
      note_set_fields(reflection->GetRepeatedMessage(message, field, i), names);
    }
  }
}

TEST(Schema, TheEncoderSetsEveryField) {
  RandomMessages random(3);
  std::set<std::string> set_fields;
  for (int i = 0; i < 20; ++i) {
    note_set_fields(*schema::parse("Request", codec::encode_request(random.any_request())),
                    set_fields);
    note_set_fields(*schema::parse("Answer", codec::encode_answer(random.any_answer())),
                    set_fields);
  }
  for_each_type([&](const pb::Descriptor& type) {
    for (int i = 0; i < type.field_count(); ++i) {
      EXPECT_TRUE(set_fields.contains(type.field(i)->full_name())) << type.field(i)->full_name();
    }
  });
}

TEST(Schema, ZeroOfEveryEnumerationIsUnspecified) {
  int enums_n = 0;
  for_each_type([&](const pb::Descriptor& type) {
    for (int i = 0; i < type.enum_type_count(); ++i, ++enums_n) {
      const std::string zero = type.enum_type(i)->FindValueByNumber(0)->name();
      EXPECT_TRUE(zero.ends_with("_UNSPECIFIED")) << type.enum_type(i)->full_name();
    }
  });
  EXPECT_GT(enums_n, 0);
}

/// A real number that is a length, an angle or a time says its unit; the others are listed here.
TEST(Schema, NumbersSayTheirUnits) {
  const std::set<std::string> dimensionless = {"x",
                                               "y",
                                               "z",
                                               "w",
                                               "k1",
                                               "k2",
                                               "k3",
                                               "p1",
                                               "p2",
                                               "priority",
                                               "score",
                                               "grs",
                                               "p_self",
                                               "p_grasp",
                                               "p_system",
                                               "visible_fraction",
                                               "inlier_fraction",
                                               "refuted_fraction",
                                               "fill_level",
                                               "load",    // in parts
                                               "cover"};  // likewise
  const std::vector<std::string> units = {"_m", "_rad", "_px", "_s"};
  for_each_type([&](const pb::Descriptor& type) {
    for (int i = 0; i < type.field_count(); ++i) {
      const auto* field = type.field(i);
      if (!is_real(*field)) continue;
      const bool has_unit = std::any_of(units.begin(), units.end(), [&](const std::string& unit) {
        return field->name().ends_with(unit);
      });
      EXPECT_TRUE(has_unit || dimensionless.contains(field->name())) << field->full_name();
    }
  });
}

}  // namespace
}  // namespace graspd::testing
