// The measured errors that are built into the program.
#include "studies/estimate/measured_errors.h"

#include <gtest/gtest.h>

#include <string>

#include "sim/error.h"
#include "studies/estimate/simulator_methods.h"

namespace marti::studies {

using namespace estimate;

namespace {

TEST(MeasuredErrors, CoverEveryClass) {
  const MeasuredErrors errors = parse_measured_errors(measured_errors_csv());
  for (std::size_t load = 0; load < load_classes.size(); ++load) {
    for (std::size_t size = 0; size < sample_sizes.size(); ++size) {
      const MeasuredError& error = errors[load][size];
      EXPECT_EQ(error.use_to, load_classes[load]);
      EXPECT_EQ(error.windows, sample_sizes[size]);
      EXPECT_GE(error.cases, 12U);
      EXPECT_GE(error.covered, 0.85);
      EXPECT_LE(error.covered, 1.0);
      EXPECT_GE(error.allowance[Figure::end], 0.0);
    }
    EXPECT_EQ(load_class_of(load_classes[load]), load);
  }
  EXPECT_EQ(load_class_of(0.0), 0U);
  EXPECT_EQ(load_class_of(0.31), 1U);
  EXPECT_EQ(load_class_of(1.01), load_classes.size() - 1);
  EXPECT_THROW((void)size_class_of(least_windows - 1), sim::InternalError);
  EXPECT_EQ(size_class_of(32), 0U);
  EXPECT_EQ(size_class_of(63), 0U);
  EXPECT_EQ(size_class_of(64), 1U);
  EXPECT_EQ(size_class_of(4096), 1U);
}

TEST(MeasuredErrors, AnotherTableIsAFault) {
  const std::string good(measured_errors_csv());
  const auto refused = [](const std::string& text) {
    EXPECT_THROW((void)parse_measured_errors(text), sim::InternalError) << text.substr(0, 200);
  };
  const std::string header = good.substr(0, good.find('\n') + 1);
  const std::string version = std::to_string(methods_version) + ",";
  const auto rows = [&](const std::string& use_to) {
    return version + use_to + ",32,60,0.95,0.01,0.01,0.1,0.1,1\n" + version + use_to +
           ",64,60,0.95,0.01,0.01,0.1,0.1,inf\n";
  };
  const std::string first = rows("0.3") + rows("0.7") + rows("0.95");
  const std::string row = version + "1,32,60,0.95,0.01,0.01,0.1,0.1,1\n";
  const auto last = [&](const std::string& cells) { return header + first + row + version + cells + "\n"; };
  EXPECT_EQ(parse_measured_errors(header + first + rows("1"))[3][0].cases, 60U);
  EXPECT_EQ(parse_measured_errors(last("1,64,60,0.5,0.01,0.01,0.1,0.1,1"))[3][1].covered, 0.5);
  refused("");
  refused("a,b\n");
  refused(header);
  refused(header + first);
  refused(header + rows("0.7") + rows("0.3") + rows("0.95") + rows("1"));
  refused(header + first + rows("1") + row);
  refused(header + "9" + first + rows("1"));  // the version
  refused(header + first + row + row);        // twice the small size
  refused(last("1,64,60,half,0.01,0.01,0.1,0.1,1"));
  refused(last("1,64,60,-0.5,0.01,0.01,0.1,0.1,1"));
  refused(last("1,64,60,0.5,0.01,0.01,0.1,0.1"));
  refused(last("1,64,60,0.5,0.01,0.01,0.1,0.1,1,1"));
}

}  // namespace
}  // namespace marti::studies
