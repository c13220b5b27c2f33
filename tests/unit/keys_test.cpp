#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <thread>

#include "graspd/keys/allow_list.hpp"
#include "graspd/keys/key_files.hpp"
#include "temporary_folder.hpp"

namespace graspd::keys {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::TemporaryFolder;

class KeysTest : public ::testing::Test {
 protected:
  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
  KeyPair make(const std::string& cell) const {
    const KeyPair pair = make_key_pair(cell);
    const auto written = write_key_pair(pair, folder_.path());
    EXPECT_TRUE(written) << written.error().message;
    return pair;
  }
  void allow_all(const std::vector<PublicKey>& keys) const {
    for (const PublicKey& key : keys) {
      const auto allowed = allow(path("list"), key);
      EXPECT_TRUE(allowed) << allowed.error().message;
    }
  }

  TemporaryFolder folder_;
};

mode_t mode_of(const std::filesystem::path& path) {
  struct stat status {};
  EXPECT_EQ(stat(path.c_str(), &status), 0);
  return status.st_mode & 07777U;
}

std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST_F(KeysTest, WhatIsWrittenReadsBack) {
  const KeyPair pair = make("tees");
  const auto secret = read_key_pair(path("tees.key"));
  ASSERT_TRUE(secret) << secret.error().message;
  EXPECT_EQ(secret->cell, "tees");
  EXPECT_EQ(secret->public_key, pair.public_key);
  EXPECT_EQ(secret->secret_key, pair.secret_key);
  const auto known = read_public_key(path("tees.pub"));
  ASSERT_TRUE(known) << known.error().message;
  EXPECT_EQ(known->cell, "tees");
  EXPECT_EQ(known->public_key, pair.public_key);
  EXPECT_THAT(text_of(path("tees.pub")), Not(HasSubstr(pair.secret_key)));
}

TEST_F(KeysTest, ASecretKeyIsForItsUserAloneWhateverTheUmask) {
  const mode_t before = umask(0);
  make("loose");
  umask(0777);
  make("tight");
  umask(before);
  EXPECT_EQ(mode_of(path("loose.key")), 0600u);
  EXPECT_EQ(mode_of(path("tight.key")), 0600u);
  EXPECT_EQ(mode_of(path("loose.pub")), 0644u);
}

TEST_F(KeysTest, AKeyIsNeverOverwritten) {
  const KeyPair pair = make("tees");
  const auto again = write_key_pair(make_key_pair("tees"), folder_.path());
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error().message, HasSubstr("never overwritten"));
  EXPECT_EQ(read_key_pair(path("tees.key"))->secret_key, pair.secret_key);
  EXPECT_EQ(read_public_key(path("tees.pub"))->public_key, pair.public_key);

  std::filesystem::remove(path("tees.key"));
  EXPECT_FALSE(write_key_pair(make_key_pair("tees"), folder_.path()));
  EXPECT_FALSE(std::filesystem::exists(path("tees.key"))) << "half a pair is left";
  EXPECT_EQ(read_public_key(path("tees.pub"))->public_key, pair.public_key);
}

TEST_F(KeysTest, ASecretKeyThatOthersMayUseIsRefusedWithoutSayingIt) {
  const KeyPair pair = make("tees");
  for (const mode_t mode : {0640U, 0604U, 0660U, 0644U, 0610U}) {
    chmod(path("tees.key").c_str(), mode);
    const auto read = read_key_pair(path("tees.key"));
    ASSERT_FALSE(read) << mode;
    EXPECT_THAT(read.error().message, AllOf(HasSubstr("chmod 600"), Not(HasSubstr(pair.secret_key)),
                                            Not(HasSubstr(pair.public_key))));
  }
  for (const mode_t mode : {0600U, 0400U}) {
    chmod(path("tees.key").c_str(), mode);
    EXPECT_TRUE(read_key_pair(path("tees.key"))) << mode;
  }
}

TEST_F(KeysTest, AFileThatItsUserMayNotReadIsNamed) {
  make("tees");
  allow_all({{"tees", read_public_key(path("tees.pub"))->public_key}});
  chmod(path("tees.key").c_str(), 0);
  chmod(path("list").c_str(), 0);
  // Root may read everything, and is nobody for as long.
  const bool is_root = geteuid() == 0;
  ASSERT_EQ(seteuid(is_root ? 65534 : geteuid()), 0);
  const auto key = read_key_pair(path("tees.key"));
  const auto list = AllowList::read(path("list"));
  ASSERT_EQ(seteuid(is_root ? 0 : geteuid()), 0);
  ASSERT_FALSE(key);
  EXPECT_THAT(key.error().message, AllOf(HasSubstr("tees.key"), HasSubstr("Permission denied")));
  ASSERT_FALSE(list);
  EXPECT_THAT(list.error().message, AllOf(HasSubstr("list"), HasSubstr("Permission denied")));
}

TEST_F(KeysTest, EveryDamageToAKeyFileIsNoticed) {
  const KeyPair pair = make("tees");
  const std::string good = text_of(path("tees.key"));
  const std::size_t begin = good.find(pair.public_key);
  for (std::size_t at = begin; at < begin + 81; ++at) {
    std::string text = good;
    text[at] = text[at] == '0' ? '1' : '0';
    folder_.write("damaged", text);
    chmod(path("damaged").c_str(), 0600);
    EXPECT_FALSE(read_key_pair(path("damaged"))) << at;
  }
  for (const std::string& text : {std::string(), std::string("# nothing\n"), good + good,
                                  good.substr(0, good.size() - 3), std::string("tees a b\n")}) {
    folder_.write("damaged", text);
    EXPECT_FALSE(read_key_pair(path("damaged"))) << text;
  }
}

TEST_F(KeysTest, TheWrongFileIsNamedForWhatItIs) {
  make("tees");
  chmod(path("tees.pub").c_str(), 0600);
  EXPECT_THAT(read_key_pair(path("tees.pub")).error().message, HasSubstr("is a public key"));
  EXPECT_THAT(read_public_key(path("tees.key")).error().message, HasSubstr("is a secret key"));
  EXPECT_THAT(read_public_key(path("none")).error().message, HasSubstr("No such file"));
  EXPECT_THAT(read_public_key(folder_.path()).error().message, HasSubstr("is no file"));
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_THAT(read_public_key(path("pipe")).error().message, HasSubstr("is no file"));
}

TEST_F(KeysTest, AClientHasBothKeysOrNone) {
  make("server");
  make("tees");
  EXPECT_TRUE(read_client_keys(path("server.pub"), path("tees.key")));
  EXPECT_THAT(read_client_keys("", path("tees.key")).error().message, HasSubstr("server_key"));
  EXPECT_THAT(read_client_keys(path("server.pub"), "").error().message, HasSubstr("key_file"));
}

TEST_F(KeysTest, NamesThatCanNotStandInAFileAreRefused) {
  for (const char* name : {"", "a b", "a/b", "../a", ".a", "-a", "#a", "a\nb", "a\tb", "a\x7f"}) {
    EXPECT_FALSE(write_key_pair(make_key_pair(name), folder_.path())) << name;
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
  for (const char* name : {"a", "cell-7", "line_2.left", "Zelle-ö"}) {
    EXPECT_TRUE(write_key_pair(make_key_pair(name), folder_.path())) << name;
  }
}

TEST_F(KeysTest, AListKnowsWhomItAllows) {
  const KeyPair tees = make("tees");
  const KeyPair elbows = make("elbows");
  allow_all({{"tees", tees.public_key}, {"elbows", elbows.public_key}});
  const auto list = AllowList::read(path("list"));
  ASSERT_TRUE(list) << list.error().message;
  EXPECT_EQ(list->cell_of(tees.public_key), "tees");
  EXPECT_EQ(list->cell_of(elbows.public_key), "elbows");
  EXPECT_EQ(list->cell_of(make_key_pair("x").public_key), std::nullopt);
  EXPECT_THAT(list->faults(), ::testing::IsEmpty());
}

TEST_F(KeysTest, TheListsFormIsThatOfPublicKeyFiles) {
  const KeyPair tees = make("tees");
  make("elbows");
  folder_.write("list", text_of(path("tees.pub")) + text_of(path("elbows.pub")));
  EXPECT_EQ(AllowList::read(path("list"))->entries().size(), 2u);
}

TEST_F(KeysTest, BrokenLinesAreNamedAndTheRestIsKept) {
  const KeyPair tees = make("tees");
  const KeyPair other = make("other");
  folder_.write("list", fmt::format("# a comment\n\ntees {0}\nelbows {1}\nelbows\n{0} elbows\n"
                                    "again {0}\nother {2} {3}\nlast {4}\n",
                                    tees.public_key, tees.public_key.substr(1), other.public_key,
                                    other.secret_key, other.public_key));
  const auto list = AllowList::read(path("list"));
  ASSERT_TRUE(list) << list.error().message;
  ASSERT_EQ(list->faults().size(), 5u);
  for (const int line : {4, 5, 6, 7, 8}) {
    EXPECT_THAT(list->faults().at(static_cast<std::size_t>(line - 4)),
                AllOf(HasSubstr(fmt::format("list:{}: ", line)), Not(HasSubstr(tees.public_key)),
                      Not(HasSubstr(other.secret_key))));
  }
  EXPECT_EQ(list->cell_of(tees.public_key), "tees");
  EXPECT_EQ(list->cell_of(other.public_key), "last");
}

TEST_F(KeysTest, AListThatOthersMayWriteIsRefused) {
  allow_all({{"tees", make("tees").public_key}});
  for (const mode_t mode : {0664U, 0646U}) {
    chmod(path("list").c_str(), mode);
    EXPECT_THAT(AllowList::read(path("list")).error().message, HasSubstr("chmod 644")) << mode;
  }
}

TEST_F(KeysTest, TheSameKeyIsNotAllowedTwiceAndACellMayHaveSeveral) {
  const KeyPair old_pair = make("tees");
  const KeyPair new_pair = make_key_pair("tees");
  allow_all({{"tees", old_pair.public_key}, {"tees", new_pair.public_key}});
  const auto again = allow(path("list"), {"other", old_pair.public_key});
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error().message, HasSubstr("already, as 'tees'"));
  const auto list = AllowList::read(path("list"));
  EXPECT_EQ(list->cell_of(old_pair.public_key), "tees");
  EXPECT_EQ(list->cell_of(new_pair.public_key), "tees");
}

TEST_F(KeysTest, OfChangesAtTheSameTimeNoneIsLost) {
  allow_all({{"first", make_key_pair("first").public_key}});
  std::vector<std::thread> threads;
  for (int thread = 0; thread < 4; ++thread) {
    threads.emplace_back([&, thread] {
      for (int i = 0; i < 5; ++i) {
        allow_all({{fmt::format("cell-{}-{}", thread, i), make_key_pair("x").public_key}});
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(AllowList::read(path("list"))->entries().size(), 21u);
}

TEST_F(KeysTest, RevokingTakesACellsKeysOutAndNothingElse) {
  allow_all({{"tees", make("tees").public_key}});
  const std::string rest = text_of(path("list")) + "# by hand\nbroken line of mine\n";
  folder_.write("list", rest);
  chmod(path("list").c_str(), 0600);
  allow_all({{"elbows", make("elbows").public_key}, {"elbows", make_key_pair("e").public_key}});
  const auto revoked_n = revoke(path("list"), "elbows");
  ASSERT_TRUE(revoked_n) << revoked_n.error().message;
  EXPECT_EQ(*revoked_n, 2u);
  EXPECT_EQ(text_of(path("list")), rest);
  EXPECT_EQ(mode_of(path("list")), 0600u);
  EXPECT_THAT(revoke(path("list"), "elbows").error().message, HasSubstr("no key of 'elbows'"));
  EXPECT_EQ(text_of(path("list")), rest);
}

}  // namespace
}  // namespace graspd::keys
