// Configurations of sweeps for tests, and what is said of wrong ones.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/config.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/plan/sweep_plan.h"

namespace marti::test {

inline sim::Config sweep_config(std::string_view text, const std::vector<std::string>& assignments = {}) {
  static const sim::Schema schema = studies::sweep::sweep_schema();
  return sim::Config::from_text(schema, text, "s.toml", assignments);
}

inline studies::sweep::SweepPlan plan_of(std::string_view text,
                                         const std::vector<std::string>& assignments = {}) {
  sim::Config config = sweep_config(text, assignments);
  return studies::sweep::plan_sweep(config);
}

/// `message_of` must give a message for each text that begins with what stands beside the text.
template <class MessageOf>
void expect_messages(const std::vector<std::pair<std::string, std::string>>& texts,
                     const MessageOf& message_of) {
  for (const auto& [text, message] : texts) {
    EXPECT_EQ(message_of(text).substr(0, message.size()), message) << text;
  }
}

}  // namespace marti::test
