// The measured errors that are built into the program.
#include "studies/estimate/measured_errors.h"

#include <gtest/gtest.h>

#include <string>

#include "sim/error.h"
#include "studies/estimate/simulator_methods.h"

namespace marti::studies {

using namespace estimate;

namespace {

TEST(MeasuredErrors, CoverEveryClassOfLoad) {
  const std::vector<MeasuredError> errors = parse_measured_errors(measured_errors_csv());
  ASSERT_EQ(errors.size(), load_classes.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    EXPECT_EQ(errors[i].use_to, load_classes[i]);
    EXPECT_GE(errors[i].cases, 30U);
    EXPECT_GE(errors[i].covered, 0.9);
    EXPECT_LE(errors[i].covered, 1.0);
    EXPECT_GE(errors[i].allowance[Figure::end], 0.0);
    EXPECT_EQ(load_class_of(load_classes[i]), i);
  }
  EXPECT_EQ(load_class_of(0.0), 0U);
  EXPECT_EQ(load_class_of(0.31), 1U);
  EXPECT_EQ(load_class_of(1.01), load_classes.size() - 1);
}

TEST(MeasuredErrors, AnotherTableIsAFault) {
  const std::string good(measured_errors_csv());
  const auto refused = [](const std::string& text) {
    EXPECT_THROW((void)parse_measured_errors(text), sim::InternalError) << text.substr(0, 200);
  };
  const std::string header = good.substr(0, good.find('\n') + 1);
  const std::string version = std::to_string(methods_version) + ",";
  const std::string first = version + "0.3,60,0.95,0.01,0.01,0.1,0.1,1\n";
  const std::string second = version + "0.7,60,0.95,0.01,0.01,0.1,0.1,1\n";
  const std::string third = version + "1,60,0.95,0.01,0.01,0.1,0.1,inf\n";
  EXPECT_EQ(parse_measured_errors(header + first + second + third).size(), 3U);
  refused("");
  refused("a,b\n");
  refused(header);
  refused(header + first + second);
  refused(header + second + first + third);
  refused(header + first + second + third + third);
  refused(header + "9" + first + second + third);  // the version
  refused(header + first + second + version + "1,60,half,0.01,0.01,0.1,0.1,1\n");
  refused(header + first + second + version + "1,60,-0.5,0.01,0.01,0.1,0.1,1\n");
  refused(header + first + second + version + "1,60,0.5,0.01,0.01,0.1,0.1\n");
  refused(header + first + second + version + "1,60,0.5,0.01,0.01,0.1,0.1,1,1\n");
}

}  // namespace
}  // namespace marti::studies
