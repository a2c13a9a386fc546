#include "scenes/gltf_json.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <nlohmann/json.hpp>

#include "scenes/gltf_extensions.h"
#include "sim/shown.h"

namespace marti::scenes::gltf {

namespace {

constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();

/// Members that are whole numbers, or lists of them, wherever glTF has them.
constexpr std::array<std::string_view, 24> whole_members = {"nodes",    "scene",      "children",
                                                            "mesh",     "skin",       "camera",
                                                            "skeleton", "joints",     "inverseBindMatrices",
                                                            "buffer",   "bufferView", "byteStride",
                                                            "target",   "node",       "componentType",
                                                            "indices",  "material",   "mode",
                                                            "input",    "output",     "sampler",
                                                            "source",   "index",      "texCoord"};
/// Members that are numbers, or lists of them.
constexpr std::array<std::string_view, 16> number_members = {
    "translation", "rotation",        "scale",          "matrix",          "weights",
    "yfov",        "znear",           "zfar",           "aspectRatio",     "xmag",
    "ymag",        "baseColorFactor", "metallicFactor", "roughnessFactor", "emissiveFactor",
    "alphaCutoff"};
/// Members of compressed data that are sizes; outside of extensions tinygltf reads them in 64 bits.
constexpr std::array<std::string_view, 3> sizes = {"byteOffset", "byteLength", "count"};

template <std::size_t N>
bool is_among(const std::array<std::string_view, N>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Walks through the text and stops at the first fault.
class Checker : public nlohmann::json_sax<nlohmann::json> {
 public:
  [[nodiscard]] const std::string& fault() const { return fault_; }

  bool null() override { return other("null"); }
  bool boolean(bool value) override { return other(value ? "true" : "false"); }
  bool string(string_t& text) override {
    if (place_.size() == 2 && place_[0].name == "asset") {
      if (place_[1].name == "version" && !text.starts_with("2.")) {
        return refuse(quoted(text) + "; only versions 2 can be read");
      }
      if (place_[1].name == "minVersion" && text != "2.0") {
        return refuse(quoted(text) + "; it can be read as version 2.0 only");
      }
    }
    return other(quoted(text));
  }
  bool binary(binary_t& /*value*/) override { return true; }
  bool number_integer(number_integer_t value) override {
    return number(value >= -most, [&] { return std::to_string(value); });
  }
  bool number_unsigned(number_unsigned_t value) override {
    return number(value <= static_cast<number_unsigned_t>(most), [&] { return std::to_string(value); });
  }
  bool number_float(number_float_t /*value*/, const string_t& text) override {
    return number(false, [&] { return sim::shown(text); });
  }
  bool start_object(std::size_t /*elements*/) override {
    place_.emplace_back();
    return true;
  }
  bool key(string_t& name) override {
    place_.back().name = name;
    return true;
  }
  bool end_object() override { return end(); }
  bool start_array(std::size_t /*elements*/) override {
    if (is_extension()) {
      return refuse("a list" + std::string(no_extension));
    }
    place_.push_back({{}, true});
    return true;
  }
  bool end_array() override { return end(); }
  bool parse_error(std::size_t /*at*/, const std::string& /*token*/,
                   const nlohmann::json::exception& /*error*/) override {
    return false;  // tinygltf says what it is
  }

 private:
  static constexpr std::string_view no_extension = "; an extension is an object";

  // A member of an object or an element of a list, which is inside of all before it.
  struct Place {
    std::string name;
    bool in_list = false;
    std::uint64_t index = 0;
  };

  static std::string quoted(const std::string& text) { return '"' + sim::shown(text) + '"'; }

  bool refuse(const std::string& what) {
    for (const Place& place : place_) {
      fault_ += "/" + (place.in_list ? std::to_string(place.index) : sim::shown(place.name));
    }
    fault_ += " is " + what;
    return false;
  }

  // A value has ended: the next one in its list has another number.
  bool next() {
    if (!place_.empty() && place_.back().in_list) {
      ++place_.back().index;
    }
    return true;
  }
  bool end() {
    place_.pop_back();
    return next();
  }

  // `fits`: it is whole and fits into 32 bits. `text`: makes its text.
  template <class Text>
  bool number(bool fits, const Text& text) {
    if (is_extension()) {
      return refuse(text() + std::string(no_extension));
    }
    if (!fits && is_whole()) {
      return refuse(text() + ", which is no whole number of at most 2147483647");
    }
    return next();
  }
  // A value that is no number, list or object.
  bool other(const std::string& value) {
    if (is_extension()) {
      return refuse(value + std::string(no_extension));
    }
    if (!within("extensions") && !within("extras") && (is_whole() || is_among(number_members, member()))) {
      return refuse(value + ", which is no number");
    }
    return next();
  }

  // The name of the member that the value is, or is an element of.
  [[nodiscard]] std::string_view member() const {
    const auto at =
        std::find_if(place_.rbegin(), place_.rend(), [](const Place& place) { return !place.in_list; });
    return at == place_.rend() ? std::string_view() : at->name;
  }
  [[nodiscard]] bool within(std::string_view name) const {
    return std::any_of(place_.begin(), place_.end(), [&](const Place& place) { return place.name == name; });
  }
  [[nodiscard]] bool is_extension() const {
    return place_.size() >= 2 && place_[place_.size() - 2].name == "extensions" && !within("extras");
  }
  // Whether the value must be a whole number that fits into 32 bits.
  [[nodiscard]] bool is_whole() const {
    if (within("extras")) {
      return false;
    }
    const auto extensions = std::find_if(place_.begin(), place_.end(),
                                         [](const Place& place) { return place.name == "extensions"; });
    if (extensions == place_.end()) {
      return is_among(whole_members, member()) || is_attribute();
    }
    return extensions + 1 != place_.end() && is_compression((extensions + 1)->name) &&
           (is_among(whole_members, member()) || is_among(sizes, member()) || is_attribute());
  }
  // Whether the value is an accessor of a primitive's attributes, or of one of its morph targets.
  [[nodiscard]] bool is_attribute() const {
    const std::size_t depth = place_.size();
    return (depth >= 2 && place_[depth - 2].name == "attributes") ||
           (depth >= 3 && place_[depth - 2].in_list && place_[depth - 3].name == "targets");
  }

  std::vector<Place> place_;
  std::string fault_;
};

}  // namespace

std::string json_fault(std::string_view text) {
  Checker checker;
  static_cast<void>(nlohmann::json::sax_parse(text, &checker, nlohmann::json::input_format_t::json, false));
  return checker.fault();
}

}  // namespace marti::scenes::gltf
