#include "studies/report/model/cycle_groups.h"

#include "processors/cost/accounting.h"

namespace marti::studies::report {

namespace {

std::size_t group_of(processors::cost::Activity activity) {
  using processors::cost::Activity;
  switch (activity) {
    case Activity::traversal:
      return 0;
    case Activity::intersection:
      return 1;
    case Activity::shading:
    case Activity::building:
      return 2;
    case Activity::cache_access:
    case Activity::switching:
    case Activity::messaging:
      return 3;
    case Activity::transfer:
    case Activity::bank_access:
      return 4;
    case Activity::interconnect_wait:
      return 5;
    case Activity::bank_wait:
      return 6;
    case Activity::idle:
      return 8;
    default:
      return 7;
  }
}

}  // namespace

std::array<double, cycle_groups> group_cycles(const std::function<double(std::string_view)>& of_activity) {
  std::array<double, cycle_groups> parts{};
  for (std::size_t i = 0; i < processors::cost::activity_names.size(); ++i) {
    parts[group_of(static_cast<processors::cost::Activity>(i))] +=
        of_activity(processors::cost::activity_names[i]);
  }
  return parts;
}

}  // namespace marti::studies::report
