#include "studies/report/model/rounded.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string>

namespace marti::studies::report {

double rounded(double value, int digits) {
  if (!std::isfinite(value)) {
    return value;
  }
  const std::string text = fmt::format("{:.{}g}", value, digits);
  double result = value;
  std::from_chars(text.data(), text.data() + text.size(), result);
  return result;
}

}  // namespace marti::studies::report
