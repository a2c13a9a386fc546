// CSV, read back by a reader that was written from the RFC alone.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace marti::test {

using CsvRecord = std::vector<std::string>;

/// RFC 4180, section 2: records end in CR LF; a quoted field may hold anything, with quotes doubled. No value
/// for a text that is not of this form.
inline std::optional<std::vector<CsvRecord>> read_csv(const std::string& csv) {
  std::vector<CsvRecord> records;
  for (std::size_t at = 0; at < csv.size();) {
    CsvRecord& record = records.emplace_back();
    for (bool more = true; more;) {
      std::string& field = record.emplace_back();
      if (csv.compare(at, 1, "\"") == 0) {
        for (++at; csv.compare(at, 1, "\"") != 0 || csv.compare(at, 2, "\"\"") == 0; ++at) {
          if (at >= csv.size()) {
            return std::nullopt;
          }
          at += csv[at] == '"' ? 1 : 0;
          field += csv[at];
        }
        ++at;
      } else {
        const std::size_t end = std::min(csv.find_first_of(",\"\r\n", at), csv.size());
        field = csv.substr(at, end - at);
        at = end;
      }
      more = csv.compare(at, 1, ",") == 0;
      if (!more && csv.compare(at, 2, "\r\n") != 0) {
        return std::nullopt;
      }
      at += more ? 1 : 2;
    }
  }
  return records;
}

}  // namespace marti::test
