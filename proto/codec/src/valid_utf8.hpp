#pragma once

#include <google/protobuf/message.h>

namespace graspd::codec {

/// Protobuf writes any bytes into a string, but no reader takes a message with bytes that are not
/// UTF-8. What an exception or a file's name brought in becomes U+FFFD, and the rest can be read.
void make_strings_valid_utf8(google::protobuf::Message& message);

}  // namespace graspd::codec
