// A result.json, read with care: a field may be missing or of another type, whoever wrote the file.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace marti::studies {

/// A part of a result. Fields are named by their path: "machine.limit.sentence".
class RunJson {
 public:
  RunJson(nlohmann::ordered_json json, std::string file) : json_(std::move(json)), file_(std::move(file)) {}

  /// The field; null when it is not there.
  [[nodiscard]] const nlohmann::ordered_json& find(std::string_view path) const;
  /// An object that has to be there. Throws UserError, naming the file and the field, when it is not.
  [[nodiscard]] const nlohmann::ordered_json& at(std::string_view path) const;
  /// Nothing when it is not there or no finite number.
  [[nodiscard]] std::optional<double> number(std::string_view path) const;
  /// Both throw UserError, naming the file and the field, when it is there and no number from `low` to
  /// `high`; the first also when it is missing or null, where the second gives nothing.
  [[nodiscard]] double required_number(std::string_view path, double low, double high) const;
  [[nodiscard]] std::optional<double> optional_number(std::string_view path, double low, double high) const;
  /// 0 when it is not there or no number.
  [[nodiscard]] double count(std::string_view path) const { return number(path).value_or(0.0); }
  /// Empty when it is not there or no text.
  [[nodiscard]] std::string text(std::string_view path) const;
  [[nodiscard]] bool boolean(std::string_view path) const;
  /// The objects of a list; none when it is not there or no list. Whatever else is in it is passed over.
  [[nodiscard]] std::vector<RunJson> list(std::string_view path) const;

  /// Throws UserError: the file's name, `reason`, and what file is expected.
  [[noreturn]] void refuse(const std::string& reason) const;

  [[nodiscard]] const nlohmann::ordered_json& json() const { return json_; }
  [[nodiscard]] const std::string& file() const { return file_; }

 private:
  nlohmann::ordered_json json_;
  std::string file_;
};

/// A `result.json`. Throws UserError when the file cannot be read, is no result of a run, is one of another
/// schema, or lacks one of the objects `parts`.
[[nodiscard]] RunJson read_run_json(const std::filesystem::path& file,
                                    std::initializer_list<const char*> parts = {});

}  // namespace marti::studies
