#include "sim/sha256.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cstddef>
#include <system_error>

#include "sim/descriptor.h"
#include "sim/error.h"

namespace marti::sim {

namespace {

constexpr std::size_t block_bytes = 64;

// The first 32 bits of the fractions of the cube roots of the first 64 primes (section 4.2.2).
constexpr std::array<std::uint32_t, 64> constants = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

using State = std::array<std::uint32_t, 8>;

std::uint32_t byte_at(std::string_view bytes, std::size_t at) {
  return static_cast<unsigned char>(bytes[at]);
}

// Section 6.2.2.
void add_block(State& state, std::string_view block) {
  std::array<std::uint32_t, 64> words{};
  for (std::size_t i = 0; i < 16; ++i) {
    words[i] = byte_at(block, 4 * i) << 24U | byte_at(block, 4 * i + 1) << 16U |
               byte_at(block, 4 * i + 2) << 8U | byte_at(block, 4 * i + 3);
  }
  for (std::size_t i = 16; i < words.size(); ++i) {
    const std::uint32_t a = words[i - 15];
    const std::uint32_t b = words[i - 2];
    words[i] = words[i - 16] + (std::rotr(a, 7) ^ std::rotr(a, 18) ^ a >> 3U) + words[i - 7] +
               (std::rotr(b, 17) ^ std::rotr(b, 19) ^ b >> 10U);
  }
  auto [a, b, c, d, e, f, g, h] = state;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::uint32_t first = h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) +
                                ((e & f) ^ (~e & g)) + constants[i] + words[i];
    const std::uint32_t second =
        (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
    h = g;
    g = f;
    f = e;
    e = d + first;
    d = c;
    c = b;
    b = a;
    a = first + second;
  }
  const State mixed = {a, b, c, d, e, f, g, h};
  for (std::size_t i = 0; i < state.size(); ++i) {
    state[i] += mixed[i];
  }
}

/// The hash of a message that is given piece by piece.
class Hash {
 public:
  void add(std::string_view piece) {
    bytes_ += piece.size();
    rest_ += piece;
    std::string_view whole = rest_;
    for (; whole.size() >= block_bytes; whole.remove_prefix(block_bytes)) {
      add_block(state_, whole.substr(0, block_bytes));
    }
    rest_.erase(0, rest_.size() - whole.size());
  }

  [[nodiscard]] std::array<std::uint8_t, 32> end() {
    // Section 5.1.1: a one, zeros, and the length in bits.
    const std::uint64_t bits = bytes_ * 8;
    std::string end(1, '\x80');
    const std::size_t length = rest_.size() + 1;
    end.resize((length + 8 <= block_bytes ? block_bytes : 2 * block_bytes) - 8 - rest_.size(), '\0');
    for (int shift = 56; shift >= 0; shift -= 8) {
      end += static_cast<char>(bits >> static_cast<unsigned>(shift) & 0xffU);
    }
    add(end);
    std::array<std::uint8_t, 32> digest{};
    for (std::size_t i = 0; i < digest.size(); ++i) {
      digest[i] = static_cast<std::uint8_t>(state_[i / 4] >> (24U - 8U * (i % 4)));
    }
    return digest;
  }

 private:
  State state_ = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                  0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::string rest_;  // less than a block
  std::uint64_t bytes_ = 0;
};

std::string text_of(const std::array<std::uint8_t, 32>& digest) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : digest) {
    text += digits[byte >> 4U];
    text += digits[byte & 15U];
  }
  return text;
}

}  // namespace

std::array<std::uint8_t, 32> sha256(std::string_view message) {
  Hash hash;
  hash.add(message);
  return hash.end();
}

std::string sha256_text(std::string_view message) { return text_of(sha256(message)); }

std::string sha256_of_file(const std::filesystem::path& file) {
  const auto fail = [&](int error) {
    throw UserError(file.string() + ": cannot be read: " + std::generic_category().message(error));
  };
  // O_NONBLOCK: it may be a pipe.
  const Descriptor input(::open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat status {};
  if (input.get() < 0 || ::fstat(input.get(), &status) != 0) {
    fail(errno);
  }
  if (!S_ISREG(status.st_mode)) {
    throw UserError(file.string() + ": cannot be read: not a regular file");
  }
  Hash hash;
  std::string buffer(std::size_t{1} << 16U, '\0');
  for (;;) {
    const ssize_t count = ::read(input.get(), buffer.data(), buffer.size());
    if (count == 0) {
      return text_of(hash.end());
    }
    if (count < 0 && errno != EINTR) {
      fail(errno);
    }
    hash.add({buffer.data(), count > 0 ? static_cast<std::size_t>(count) : 0});
  }
}

}  // namespace marti::sim
