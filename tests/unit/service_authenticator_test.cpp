#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "authenticator.hpp"
#include "handshake_probe.hpp"

// What libzmq itself does with what we tell it.
namespace graspd::service {
namespace {

using ::testing::HasSubstr;

class AuthenticatorTest : public ::testing::Test {
 protected:
  zmq::socket_t bound_router(const Authenticator* authenticator) {
    zmq::socket_t socket(context_, zmq::socket_type::router);
    if (authenticator != nullptr) {
      authenticator->protect(socket);
    } else {
      socket.set(zmq::sockopt::curve_server, true);
      socket.set(zmq::sockopt::curve_secretkey, server_.secret_key);
    }
    socket.bind("tcp://127.0.0.1:*");
    return socket;
  }
  static std::string endpoint_of(const zmq::socket_t& socket) {
    return socket.get(zmq::sockopt::last_endpoint);
  }

  zmq::context_t context_;
  keys::KeyPair server_ = keys::make_key_pair("server");
};

TEST_F(AuthenticatorTest, PassesItsTestOnASocketThatItProtects) {
  Authenticator authenticator(context_, server_, {});
  const zmq::socket_t socket = bound_router(&authenticator);
  const auto tested = authenticator.test(endpoint_of(socket));
  EXPECT_TRUE(tested) << tested.error().message;
}

TEST_F(AuthenticatorTest, FailsItsTestOnASocketThatLetsEverybodyIn) {
  // The surprise: CURVE without ZAP is encryption, and no more.
  const zmq::socket_t socket = bound_router(nullptr);
  zmq::context_t elsewhere;
  const auto tested = Authenticator(elsewhere, server_, {}).test(endpoint_of(socket));
  ASSERT_FALSE(tested);
  EXPECT_THAT(tested.error().message, HasSubstr("lets in a client whose key nobody has allowed"));
}

TEST_F(AuthenticatorTest, CountsEveryRefusalButNamesFewOfMany) {
  Authenticator authenticator(context_, server_, {});
  const zmq::socket_t socket = bound_router(&authenticator);
  const keys::KeyPair stranger = keys::make_key_pair("stranger");
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(try_handshake(endpoint_of(socket), server_.public_key, stranger),
              Handshake::kRefused);
  }
  ASSERT_TRUE(authenticator.test(endpoint_of(socket)));
  const Authenticator::News news = authenticator.news();
  EXPECT_EQ(news.refused_n, 20u) << "its own test is none";
  ASSERT_EQ(news.notices.size(), 9u);
  EXPECT_THAT(news.notices.front(), HasSubstr("a client at 127.0.0.1 was refused"));
  EXPECT_EQ(news.notices.back(), "12 more clients were refused");
  EXPECT_EQ(authenticator.news().refused_n, 0u);
}

TEST_F(AuthenticatorTest, WhatItProtectedStaysClosedWhenItIsGone) {
  auto authenticator = std::make_unique<Authenticator>(context_, server_, keys::AllowList());
  const zmq::socket_t socket = bound_router(authenticator.get());
  authenticator.reset();
  EXPECT_NE(try_handshake(endpoint_of(socket), server_.public_key, keys::make_key_pair("x")),
            Handshake::kAccepted);
}

}  // namespace
}  // namespace graspd::service
