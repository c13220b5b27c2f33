#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "message.hpp"

namespace graspd::simple_message {

/// Messages over one TCP connection. Reading and sending may be in different threads.
class MessageStream {
 public:
  static Result<MessageStream> connect(const std::string& host, std::uint16_t port,
                                       std::chrono::milliseconds timeout);
  MessageStream(MessageStream&& other) noexcept;
  MessageStream& operator=(MessageStream&& other) noexcept;
  ~MessageStream();

  /// \returns UNAVAILABLE where the connection is closed or takes nothing for the timeout.
  Result<void> send(const Message& message, std::chrono::milliseconds timeout);
  /// The next message; nothing where none is complete within the timeout.
  /// \returns UNAVAILABLE where the connection is closed, INVALID_ARGUMENT where it is garbled.
  Result<std::optional<Message>> next(std::chrono::milliseconds timeout);
  /// Ends a `next` that waits in another thread, and all that follow.
  void shut_down();

  const std::string& name() const { return name_; }

 private:
  MessageStream(int socket, std::string name) : socket_(socket), name_(std::move(name)) {}

  int socket_;
  std::string name_;  ///< "host:port"
  std::vector<std::byte> received_;
};

}  // namespace graspd::simple_message
