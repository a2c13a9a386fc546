// Rays from arrays of NumPy: what is read, and what is refused.
#include "scenes/given_rays.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "scenes/npy.h"
#include "scenes/open.h"
#include "sim/key_error.h"
#include "tests/support/files.h"
#include "tests/support/ray_file.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"

namespace marti::scenes {
namespace {

using test::bytes_of;
using test::npy_file;
using test::ray_file;
using test::says;
using test::user_error_of;

std::string dictionary(const std::string& type, const std::string& shape,
                       const std::string& fortran = "False") {
  return "{'descr': '" + type + "', 'fortran_order': " + fortran + ", 'shape': " + shape + ", }";
}

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
const std::vector<double> two_rays = {1.0, 2.0, 3.0, 0.5,  0.0, 0.0, -1.0, infinite,  //
                                      0.0, 0.0, 9.0, 0.25, 2.0, 0.0, 0.0,  4.0};

class RaysOfFiles : public ::testing::Test {
 protected:
  [[nodiscard]] GivenRays read(const std::string& bytes, const sim::MemoryBudget& memory = {}) const {
    test::write(file_, bytes);
    GivenRays given = read_rays(file_, memory);
    EXPECT_EQ(count_rays(file_), given.rays.size());
    return given;
  }

  [[nodiscard]] std::string refusal(const std::string& bytes) const {
    test::write(file_, bytes);
    const std::string message = user_error_of([&] { (void)read_rays(file_, {}); });
    EXPECT_TRUE(message.starts_with(file_.string() + ": ")) << message;
    return message;
  }

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  test::TemporaryDirectory directory_;
  std::filesystem::path file_ = directory_.path() / "some.npy";
};

TEST_F(RaysOfFiles, AreReadFromBothTypes) {
  for (const bool floats : {false, true}) {
    const GivenRays given = read(floats ? ray_file<float>(two_rays) : ray_file(two_rays));
    ASSERT_EQ(given.rays.size(), 2U);
    EXPECT_EQ(given.rays[0].origin, glm::dvec3(1.0, 2.0, 3.0));
    EXPECT_EQ(given.rays[0].direction, glm::dvec3(0.0, 0.0, -1.0));
    EXPECT_EQ(given.rays[0].least, 0.5);
    EXPECT_EQ(given.rays[0].greatest, infinite);
    EXPECT_EQ(given.rays[1].least, 0.25);
    EXPECT_EQ(given.rays[1].greatest, 4.0);
    EXPECT_FALSE(given.wants_any(0) || given.wants_any(1));
  }
}

TEST_F(RaysOfFiles, SayInANinthColumnWhetherAnyHitWillDo) {
  std::vector<double> numbers;
  for (std::size_t ray = 0; ray < 5000; ++ray) {  // more than are read at a time
    numbers.insert(numbers.end(), {double(ray), 0, 0, 0, 0, 0, 1, 1, ray % 3 == 0 ? 1.0 : 0.0});
  }
  const GivenRays given = read(ray_file(numbers, 9));
  ASSERT_EQ(given.rays.size(), 5000U);
  for (std::size_t ray = 0; ray < 5000; ++ray) {
    EXPECT_EQ(given.wants_any(ray), ray % 3 == 0);
    EXPECT_EQ(given.rays[ray].origin.x, double(ray));
  }
}

TEST_F(RaysOfFiles, AreRefusedWithTheirNumber) {
  struct Wrong {
    std::size_t column;
    double number;
    const char* what;
  };
  for (const Wrong& wrong :
       std::vector<Wrong>{{0, nan, "its origin is not finite or beyond 1e30"},
                          {1, infinite, "its origin is not finite or beyond 1e30"},
                          {2, -2e30, "its origin is not finite or beyond 1e30"},
                          {3, nan, "its least distance is negative or not finite"},
                          {3, -1e-300, "its least distance is negative or not finite"},
                          {3, infinite, "its least distance is negative or not finite"},
                          {3, 4.5, "its greatest distance is below its least"},
                          {4, nan, "its direction is not finite or longer than 1e30"},
                          {4, 0.0, "its direction is 0"},
                          {4, 1e-31, "its direction is shorter than 1e-30"},
                          {5, -infinite, "its direction is not finite or longer than 1e30"},
                          {7, nan, "its greatest distance is not a number"},
                          {7, -infinite, "its greatest distance is below its least"},
                          {8, 0.5, "its ninth number is neither 0 (closest hit) nor 1 (any hit)"},
                          {8, nan, "its ninth number is neither 0 (closest hit) nor 1 (any hit)"}}) {
    std::vector<double> numbers(two_rays.begin(), two_rays.begin() + 8);
    numbers.push_back(0.0);
    numbers.insert(numbers.end(), two_rays.begin() + 8, two_rays.end());
    numbers.push_back(1.0);
    numbers[9 + wrong.column] = wrong.number;
    EXPECT_EQ(refusal(ray_file(numbers, 9)), file().string() + ": ray 1 (counted from 0): " + wrong.what);
  }
}

TEST_F(RaysOfFiles, AreRefusedInOtherArrays) {
  const std::string data = bytes_of<double>(two_rays);
  const auto expect = [&](const std::string& bytes, const char* what) {
    EXPECT_TRUE(says(refusal(bytes), what)) << refusal(bytes) << "\nlacks: " << what;
  };
  expect(npy_file(dictionary(">f8", "(2, 8)"), data), "its elements are of type >f8");
  expect(npy_file(dictionary("<i8", "(2, 8)"), data), "its elements are of type <i8");
  expect(npy_file("{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (2,), }", data),
         "are structures");
  expect(npy_file(dictionary("<f8", "(2, 8)", "True"), data), "Fortran order");
  expect(npy_file(dictionary("<f8", "(16,)"), data), "its shape is (16)");
  expect(npy_file(dictionary("<f8", "()"), data), "its shape is ()");
  expect(npy_file(dictionary("<f8", "(2, 2, 4)"), data), "its shape is (2, 2, 4)");
  expect(npy_file(dictionary("<f8", "(2, 7)"), data), "its shape is (2, 7)");
  expect(npy_file(dictionary("<f8", "(2, 10)"), data), "its shape is (2, 10)");
  expect(npy_file(dictionary("<f8", "(0, 8)"), ""), "it has no rays");
  expect(npy_file(dictionary("<f8", "(1073741825, 8)"), data), "at most 1073741824 are traced");
  expect(npy_file(dictionary("<f8", "(18446744073709551615, 8)"), data), "at most 1073741824 are traced");
  expect(npy_file(dictionary("<f8", "(2, 8)"), data.substr(1)), "2 rays of 64 bytes need 256");
  expect(npy_file(dictionary("<f8", "(2, 8)"), data + "x"), "it has 257 bytes");
}

TEST_F(RaysOfFiles, AreRefusedWithWrongHeaders) {
  const std::string good = ray_file(two_rays);
  const auto expect = [&](const std::string& bytes, const char* what) {
    EXPECT_TRUE(says(refusal(bytes), what)) << refusal(bytes) << "\nlacks: " << what;
  };
  expect("", "no array of NumPy");
  expect("v 0 0 0\n", "no array of NumPy");
  expect("PK\x03\x04 an .npz file", "no array of NumPy");
  for (std::size_t length = 8; length < 128; ++length) {
    expect(good.substr(0, length), "ends within the header");
  }
  std::string wrong = good;
  wrong[6] = '\x04';
  expect(wrong, "format 4");
  wrong = good;
  wrong[9] = '\x7f';
  expect(wrong, "at most 10000 are read");
  expect(std::string("\x93NUMPY\x02\x00\xff\xff\xff\xff", 12) + good.substr(10), "at most 10000 are read");
  const std::string data = bytes_of<double>(two_rays);
  expect(npy_file("", data), "'{' is missing");
  expect(npy_file("{'descr': '<f8', 'shape': (2, 8)}", data), "does not have 'descr', 'fortran_order'");
  expect(npy_file("{'descr': '<f8', 'descr': '<f8'}", data), "unknown or repeated key 'descr'");
  expect(npy_file("{'dtype': '<f8'}", data), "unknown or repeated key 'dtype'");
  expect(npy_file("{'descr': '<f8}", data), "a text is missing");
  expect(npy_file("{'descr': [('x', '<f8'}", data), "']' is missing");
  expect(npy_file(dictionary("<f8", "(2, 8)", "0"), data), "other than True or False");
  expect(npy_file(dictionary("<f8", "(-2, 8)"), data), "no list of sizes");
  expect(npy_file(dictionary("<f8", "(99999999999999999999, 8)"), data), "no list of sizes");
  expect(npy_file(dictionary("<f8", "(2 8)"), data), "')' is missing");
  expect(npy_file(dictionary("<f8", "(2, 8)") + " {}", data), "goes on behind its dictionary");
  EXPECT_TRUE(says(user_error_of([&] { (void)count_rays(file().parent_path()); }), "no regular file"));
  EXPECT_TRUE(says(user_error_of([&] { (void)count_rays(file().parent_path() / "none"); }), "no such file"));
}

// Formats 2 and 3 have longer lengths and else the same header; spaces and quotes may be others.
TEST_F(RaysOfFiles, AreReadFromAllFormats) {
  const std::string text = "{\"shape\":(2,8),\"fortran_order\":False,\"descr\":\"<f8\"}\n";
  for (const char format : {'\x02', '\x03'}) {
    const std::string file = std::string("\x93NUMPY") + format + '\0' + static_cast<char>(text.size()) +
                             std::string(3, '\0') + text + bytes_of<double>(two_rays);
    EXPECT_EQ(read(file).rays.size(), 2U);
  }
}

TEST_F(RaysOfFiles, TakeNoMoreThanTheMemory) {
  test::write(file(), ray_file(two_rays));
  EXPECT_TRUE(says(user_error_of([&] { (void)read_rays(file(), sim::MemoryBudget(100, true)); }),
                   "the rays of image.rays take"));
}

TEST_F(RaysOfFiles, ComeWithTheScene) {
  test::write(file(), ray_file(two_rays));
  OpenOptions options;
  options.rays = file();
  const Scene scene = open_scene("teapot:2", options, nullptr);
  EXPECT_EQ(scene.rays.rays.size(), 2U);
  EXPECT_TRUE(scene.notes.back().starts_with("Rays of some.npy: 2; SHA-256 ")) << scene.notes.back();
  options.rays = file().parent_path() / "none.npy";
  EXPECT_TRUE(user_error_of<sim::KeyError>([&] {
                (void)open_scene("teapot:2", options, nullptr);
              }).starts_with("image.rays: "));
}

TEST(HeadersOfArrays, AreReadAsTheyAreWritten) {
  for (const std::uint64_t rows : {0ULL, 1ULL, 123456789ULL, 18446744073709551615ULL}) {
    const std::string text = npy_header("'<f8'", rows);
    EXPECT_EQ(text.size() % 64, 0U);
    std::istringstream in(text);
    const NpyHeader header = read_npy_header(in);
    EXPECT_EQ(header.type, "<f8");
    EXPECT_EQ(header.shape, std::vector<std::uint64_t>{rows});
    EXPECT_EQ(header.bytes, text.size());
    EXPECT_FALSE(header.fortran);
  }
}

}  // namespace
}  // namespace marti::scenes
