#include "bytes.hpp"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

namespace graspd::codec {

namespace pb = google::protobuf;

bool parse(Bytes bytes, pb::Message& message) {
  // It prints why it refuses a string that is not UTF-8. A stranger shall not fill our logs.
  const pb::LogSilencer silencer;
  return message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()));
}

std::string serialize(const pb::Message& message) {
  std::string bytes;
  {  // The streams give the string its size when they are destroyed.
    pb::io::StringOutputStream stream(&bytes);
    pb::io::CodedOutputStream output(&stream);
    output.SetSerializationDeterministic(true);
    message.SerializeToCodedStream(&output);
  }
  return bytes;
}

}  // namespace graspd::codec
