#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>
#include <zmq.hpp>

#include "client_support.hpp"
#include "graspd/codec/codec.hpp"

/// Frames as they are, where the client library would not send them.
namespace graspd::service {

inline constexpr RequestId kRawId{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};

/// A good request, to spoil.
inline std::vector<std::string> good_frames(std::uint32_t budget_ms = 20'000,
                                            const std::string& cell = "raw",
                                            const RequestId& id = kRawId) {
  const codec::EncodedFrame frame = codec::encode_frame(example_frame(), DepthEncoding::kRaw);
  Request request;
  request.id = id;
  request.cell = cell;
  request.budget_ms = budget_ms;
  request.call = PlanCall{frame.description, example_request()};
  return {codec::encode_request(request),
          std::string(reinterpret_cast<const char*>(frame.payload.data()), frame.payload.size())};
}

class RawClient {
 public:
  explicit RawClient(const std::string& endpoint) {
    socket_.set(zmq::sockopt::linger, 0);
    socket_.connect(endpoint);
  }

  void send(const std::vector<std::string>& frames) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const bool last = i + 1 == frames.size();
      socket_.send(zmq::buffer(frames[i]), last ? zmq::send_flags::none : zmq::send_flags::sndmore);
    }
  }
  bool answered_within(std::chrono::milliseconds time) {
    zmq::pollitem_t item{socket_.handle(), 0, ZMQ_POLLIN, 0};
    return zmq::poll(&item, 1, time) > 0;
  }
  Answer receive() {
    zmq::message_t envelope;
    if (!answered_within(std::chrono::seconds(20)) || !socket_.recv(envelope)) {
      ADD_FAILURE() << "no answer";
      return {};
    }
    EXPECT_FALSE(envelope.more());
    const auto answer =
        codec::decode_answer({static_cast<const std::byte*>(envelope.data()), envelope.size()});
    EXPECT_TRUE(answer) << answer.error().message;
    return answer.value_or(Answer{});
  }
  void close() { socket_.close(); }

 private:
  zmq::context_t context_;
  zmq::socket_t socket_{context_, zmq::socket_type::dealer};
};

}  // namespace graspd::service
