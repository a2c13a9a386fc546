#include "studies/compare/compare.h"

#include "studies/compare/comparison.h"
#include "studies/compare/page.h"
#include "studies/compare/results.h"

namespace marti::studies::compare {

std::string compare_results(const std::string& a, const std::string& b, const CompareOptions& options,
                            ComparisonPage* page) {
  Results from(a);
  Results to(b);
  const Comparison found = compared(from, to);
  const ComparisonPage shown = page_of(found, options.all);
  if (page != nullptr) {
    *page = shown;
  }
  return options.json ? json_of(found, options.all) : text_of(shown, options.all);
}

}  // namespace marti::studies::compare
