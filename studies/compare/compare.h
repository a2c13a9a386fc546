// `marti compare A B`: what differs between two results, between two sweeps, or between a result and every
// point of a sweep.
#pragma once

#include <string>

namespace marti::studies::compare {

struct CompareOptions {
  bool json = false;  ///< for programs
  bool all = false;   ///< everything: all differences, and what is equal too
};

struct ComparisonPage;

/// Each of `a` and `b` is a directory that `marti run` has written or its result.json, `DIR:N`, which is
/// point N of the sweep in that directory, or the directory of a sweep. The text ends in a line break; equal
/// files give equal texts. `page`, if given, gets what a page of the comparison shows. Throws UserError for
/// what cannot be read or compared.
[[nodiscard]] std::string compare_results(const std::string& a, const std::string& b,
                                          const CompareOptions& options = {}, ComparisonPage* page = nullptr);

/// The page; its tables have at most 20,000 rows. UserError when the program was built without the scripts
/// that draw charts.
[[nodiscard]] std::string html_of(const ComparisonPage& page);

}  // namespace marti::studies::compare
