// SHA-256 against the examples of its standard, Base64 against those of its RFC.
#include <gtest/gtest.h>

#include <string>

#include "sim/base64.h"
#include "sim/error.h"
#include "sim/files.h"
#include "sim/sha256.h"
#include "tests/support/temporary_directory.h"

namespace marti::sim {
namespace {

std::string hex(std::string_view message) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : sha256(message)) {
    text += digits[byte >> 4U];
    text += digits[byte & 15U];
  }
  return text;
}

TEST(Sha256, IsThatOfTheStandardsExamples) {
  EXPECT_EQ(hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(hex(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

// Where the end of the message and its length meet the end of a block.
TEST(Sha256, PadsEveryLengthAroundABlock) {
  EXPECT_EQ(hex(std::string(55, 'a')), "9f4390f8d30c2dd92ec9f095b65e2b9ae9b0a925a5258e241c9f1e910f734318");
  EXPECT_EQ(hex(std::string(56, 'a')), "b35439a4ac6f0948b6d6f9e3c6af0f5f590ce20f1bde7090ef7970686ec6738a");
  EXPECT_EQ(hex(std::string(63, 'a')), "7d3e74a05d7db15bce4ad9ec0658ea98e3f06eeecf16b4c6fff2da457ddc2f34");
  EXPECT_EQ(hex(std::string(64, 'a')), "ffe054fe7ae0cb6dc65c3af9b61d5209f439851db43d0ba5997337df154668eb");
  EXPECT_EQ(hex(std::string(65, 'a')), "635361c48bb9eab14198e76ea8ab7f1a41685d6ad62aa9146d301d4f17eb0ae0");
}

TEST(Sha256, OfAFileIsThatOfItsBytes) {
  const test::TemporaryDirectory directory;
  const std::filesystem::path file = directory.path() / "a";
  for (const std::size_t size : {std::size_t{0}, std::size_t{65536}, std::size_t{200'001}}) {
    const std::string content(size, 'x');
    write_file(file, content);
    EXPECT_EQ(sha256_of_file(file), hex(content));
    EXPECT_EQ(sha256_text(content), hex(content));
  }
  std::filesystem::create_symlink("a", directory.path() / "link");
  EXPECT_THROW((void)sha256_of_file(directory.path() / "link"), UserError);
  EXPECT_THROW((void)sha256_of_file(directory.path() / "none"), UserError);
  EXPECT_THROW((void)sha256_of_file(directory.path()), UserError);
}

TEST(Base64, IsThatOfTheRfcsExamples) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string("\x00\xff\xfe", 3)), "AP/+");
}

}  // namespace
}  // namespace marti::sim
