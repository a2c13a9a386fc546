// A case of the stability study: something that breaks careless ray tracers or simulators, and an oracle
// that would notice.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "studies/tables/text_units.h"  // grouped(), which every case uses

namespace marti::studies::stability {

/// How large the cases are.
struct CaseSize {
  std::uint32_t rays = 20'000;   ///< of each geometry case, roughly; at least 100
  std::uint32_t nodes = 65'536;  ///< of the largest machine; at least 64
};

/// What a case found. It passes when `value`, what its oracle objects to, is at most `limit`; so NaN fails.
struct CaseOutcome {
  std::string figure;  ///< for people
  double value = 0.0;
  double limit = 0.0;

  [[nodiscard]] bool passed() const { return value <= limit; }
};

enum class CaseGroup : std::uint8_t { geometry, machine };

struct StabilityCase {
  std::string id;  ///< lower-case letters, digits and '-'
  CaseGroup group = CaseGroup::geometry;
  std::string risk;    ///< what could go wrong
  std::string oracle;  ///< what must hold instead
  std::function<CaseOutcome(const CaseSize&)> run;
};

/// Counts what was tried and what went wrong.
struct Tally {
  std::uint64_t wrong = 0;
  std::uint64_t of = 0;

  void add(bool good) {
    wrong += good ? 0U : 1U;
    ++of;
  }
  Tally& operator+=(const Tally& other) {
    wrong += other.wrong;
    of += other.of;
    return *this;
  }
};

/// None may be wrong: "0 of 20,000 WHAT". A case that tried nothing fails.
[[nodiscard]] CaseOutcome none_wrong(const Tally& tally, std::string_view what);

/// A relative error, and what it may be at most.
[[nodiscard]] CaseOutcome error_within(double error, double limit, std::string_view what);

/// `call` must refuse its input by a UserError that says `words`.
[[nodiscard]] CaseOutcome refuses(const std::function<void()>& call, std::string_view words);

/// Runs a case. An exception from it becomes a failure with the exception's message.
[[nodiscard]] CaseOutcome run_case(const StabilityCase& one, const CaseSize& size);

/// All cases, in the order of the table.
[[nodiscard]] std::vector<StabilityCase> stability_cases();

/// Appends cases of one group. A case that has no size is a function without an argument.
class CaseAdder {
 public:
  CaseAdder(std::vector<StabilityCase>& cases, CaseGroup group) : cases_(cases), group_(group) {}

  template <class Run>
  void operator()(std::string id, std::string risk, std::string oracle, Run run) const {
    std::function<CaseOutcome(const CaseSize&)> sized;
    if constexpr (std::is_invocable_v<Run, const CaseSize&>) {
      sized = run;
    } else {
      sized = [run](const CaseSize& /*size*/) { return run(); };
    }
    cases_.push_back({std::move(id), group_, std::move(risk), std::move(oracle), std::move(sized)});
  }

 private:
  std::vector<StabilityCase>& cases_;
  CaseGroup group_;
};

// The cases of each file; they append.
void add_kernel_cases(std::vector<StabilityCase>& cases);
void add_structure_cases(std::vector<StabilityCase>& cases);
void add_scene_cases(std::vector<StabilityCase>& cases);
void add_precision_cases(std::vector<StabilityCase>& cases);
void add_origin_cases(std::vector<StabilityCase>& cases);
void add_input_cases(std::vector<StabilityCase>& cases);
void add_time_cases(std::vector<StabilityCase>& cases);
void add_overflow_cases(std::vector<StabilityCase>& cases);
void add_queue_cases(std::vector<StabilityCase>& cases);
void add_cache_cases(std::vector<StabilityCase>& cases);
void add_scale_cases(std::vector<StabilityCase>& cases);
void add_order_cases(std::vector<StabilityCase>& cases);

}  // namespace marti::studies::stability
