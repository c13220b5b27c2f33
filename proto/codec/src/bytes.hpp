#pragma once

#include <google/protobuf/message.h>

#include <string>

#include "graspd/codec/codec.hpp"

/// Between messages and bytes, for the codec's own files.
namespace graspd::codec {

/// From an array, whose end protobuf knows: from a stream it would reserve up to 50 MB for a string
/// that says it is so long. Protobuf itself stops at a hundred nested messages; ours nest seven.
bool parse(Bytes bytes, google::protobuf::Message& message);

/// The same message is always the same bytes.
std::string serialize(const google::protobuf::Message& message);

}  // namespace graspd::codec
