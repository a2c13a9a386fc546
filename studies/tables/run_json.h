// A result.json, read with care: anybody may have changed the file, so a field may be missing or of another
// type.
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace marti::studies::tables {

/// Which command has made a result: a refusal says that it has to be run again.
enum class MadeBy : std::uint8_t { run, sweep };

/// A result, or a part of one. Fields are named by their path: "machine.what_helps.sentence".
class RunJson {
 public:
  RunJson(nlohmann::ordered_json json, std::string file, MadeBy made_by = MadeBy::run)
      : json_(std::move(json)), file_(std::move(file)), made_by_(made_by) {}

  /// The field; null when it is missing.
  [[nodiscard]] const nlohmann::ordered_json& find(std::string_view path) const;
  /// An object that must be there. Throws UserError, naming the file and the field, when it is missing.
  [[nodiscard]] const nlohmann::ordered_json& at(std::string_view path) const;
  /// std::nullopt when the field is missing or not a finite number.
  [[nodiscard]] std::optional<double> number(std::string_view path) const;
  /// Both throw UserError, naming the file and the field, when the field is present and not a number from
  /// `low` to `high`. If it is missing or null, the first throws as well and the second returns std::nullopt.
  [[nodiscard]] double required_number(std::string_view path, double low, double high) const;
  [[nodiscard]] std::optional<double> optional_number(std::string_view path, double low, double high) const;
  /// 0 when the field is missing or not a number.
  [[nodiscard]] double count(std::string_view path) const { return number(path).value_or(0.0); }
  /// Empty when the field is missing or not a text.
  [[nodiscard]] std::string text(std::string_view path) const;
  [[nodiscard]] bool boolean(std::string_view path) const;
  /// Another part of the same result: the field, or `json`, which was found in it.
  [[nodiscard]] RunJson part(std::string_view path) const { return of(find(path)); }
  [[nodiscard]] RunJson of(const nlohmann::ordered_json& json) const { return {json, file_, made_by_}; }
  /// The objects of a list; empty when the field is missing or not a list. Items that are not objects are
  /// ignored.
  [[nodiscard]] std::vector<RunJson> list(std::string_view path) const;

  /// Throws UserError: the file's name, `reason`, and what is expected.
  [[noreturn]] void refuse(const std::string& reason) const;

  [[nodiscard]] const nlohmann::ordered_json& json() const { return json_; }
  [[nodiscard]] const std::string& file() const { return file_; }

 private:
  nlohmann::ordered_json json_;
  std::string file_;
  MadeBy made_by_;
};

/// A `result.json`. Throws UserError when the file cannot be read, is not the result of a run, has another
/// schema, or lacks one of the objects `parts`.
[[nodiscard]] RunJson read_run_json(const std::filesystem::path& file,
                                    std::initializer_list<const char*> parts = {});

}  // namespace marti::studies::tables
