#pragma once

#include <string>

namespace graspd::testing {

struct HttpAnswer {
  int status = 0;  ///< 0 where nobody answers
  std::string body;
};

/// \param url http://HOST:PORT
HttpAnswer http_get(const std::string& url, const std::string& path);

}  // namespace graspd::testing
