#include "http_get.hpp"

#include <httplib.h>

namespace graspd::testing {

HttpAnswer http_get(const std::string& url, const std::string& path) {
  httplib::Client client(url);
  client.set_read_timeout(20);
  const auto result = client.Get(path);
  if (!result) return {};
  return {result->status, result->body};
}

}  // namespace graspd::testing
