#include "scenes/mtl.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>

#include "scenes/text_lines.h"
#include "sim/parse_number.h"

namespace marti::scenes {

namespace {

constexpr double largest_exponent = 1e5;

/// Statements of the format and of its customary extensions (physically based ones, those of Maya and 3ds
/// Max) that say nothing about what Whitted's model has.
constexpr std::array<std::string_view, 31> counted_values = {
    "Ka",       "Km",       "Kt",     "Pc",          "Pcr",    "Pm",     "Pr",       "Ps",
    "aniso",    "anisor",   "bump",   "decal",       "disp",   "em",     "km",       "map_Bump",
    "map_Ka",   "map_Ke",   "map_Ks", "map_Ns",      "map_Pm", "map_Pr", "map_Ps",   "map_aat",
    "map_bump", "map_disp", "map_Tr", "map_opacity", "norm",   "refl",   "sharpness"};

/// A word of a map's options and the number of values that may follow it.
struct MapOption {
  std::string_view name;
  std::size_t least;
  std::size_t most;
};
constexpr std::array<MapOption, 14> map_options = {{{"-blendu", 1, 1},
                                                    {"-blendv", 1, 1},
                                                    {"-boost", 1, 1},
                                                    {"-bm", 1, 1},
                                                    {"-cc", 1, 1},
                                                    {"-clamp", 1, 1},
                                                    {"-colorspace", 1, 1},
                                                    {"-imfchan", 1, 1},
                                                    {"-mm", 2, 2},
                                                    {"-o", 1, 3},
                                                    {"-s", 1, 3},
                                                    {"-t", 1, 3},
                                                    {"-texres", 1, 1},
                                                    {"-type", 1, 1}}};
/// Of these, those that the format has for other statements, or not at all.
constexpr std::array<std::string_view, 2> foreign_options = {"-colorspace", "-type"};

bool is_number(std::string_view word) { return sim::parse_number<double>(word).has_value(); }

class MtlReader {
 public:
  MtlReader(std::string_view text, const std::string& name, LeftOut& left_out)
      : lines_(text, name, TextLines::Style::wavefront), left_out_(left_out) {}

  std::vector<MtlMaterial> read() {
    while (lines_.next()) {
      statement();
    }
    return std::move(materials_);
  }

 private:
  void statement() {
    const std::string_view word = lines_.words().front();
    if (word == "newmtl") {
      begin();
      return;
    }
    if (materials_.empty()) {
      lines_.fail(in_quotes(word) + " before the first newmtl");
    }
    MtlMaterial& material = materials_.back();
    if (word == "map_Kd" || word == "map_d") {
      read_map(word, word == "map_d" ? material.opacity_map : material.texture);
      return;
    }
    lines_.drop_comment();
    if (word == "Kd") {
      material.diffuse = color(1.0);
    } else if (word == "Ks") {
      material.specular = color(1.0);
    } else if (word == "Ke") {
      material.emission = color(largest_emission);
    } else if (word == "Tf") {
      material.filter = color(1.0);
    } else if (word == "Ns") {
      material.exponent = number(1, largest_exponent);
    } else if (word == "Ni") {
      material.ior = number(1, largest_ior);
    } else if (word == "d") {
      const bool halo = lines_.words().size() > 1 && lines_.words()[1] == "-halo";
      left_out_.features["halos of materials (d -halo)"] += halo ? 1U : 0U;
      material.opacity = number(halo ? 2 : 1, 1.0);
    } else if (word == "Tr") {
      material.transparency = number(1, 1.0);
    } else if (word == "illum") {
      material.illumination = illumination();
    } else if (std::find(counted_values.begin(), counted_values.end(), word) != counted_values.end()) {
      left_out_.features["statements " + std::string(word) + " of materials"] += 1;
    } else {
      lines_.fail(in_quotes(word) + " is no statement of a material library");
    }
  }

  void begin() {
    const std::string_view name = lines_.from(1);
    if (name.empty()) {
      left_out_.replace("materials without a name, by ones whose name is empty",
                        lines_.refusal("newmtl needs a name"));
    }
    MtlMaterial& material = materials_.emplace_back();
    material.name = name;
    material.place = lines_.place();
  }

  void needs(std::size_t first, std::size_t count) const {
    if (lines_.words().size() != first + count) {
      lines_.fail(in_quotes(lines_.words().front()) + " needs " + std::to_string(count) +
                  (count == 1 ? " value" : " values"));
    }
  }

  [[nodiscard]] double in_range(std::size_t word, double highest) const {
    const double value = lines_.number(word);
    if (!(value >= 0.0 && value <= highest)) {
      std::ostringstream text;
      text << in_quotes(lines_.words().front()) << " is " << value << "; it must lie in 0 to " << highest;
      lines_.fail(text.str());
    }
    return value;
  }

  [[nodiscard]] double number(std::size_t word, double highest) const {
    needs(word, 1);
    return in_range(word, highest);
  }

  /// Three channels, or one for all three.
  [[nodiscard]] glm::dvec3 color(double highest) const {
    if (lines_.words().size() > 1 && (lines_.words()[1] == "spectral" || lines_.words()[1] == "xyz")) {
      lines_.fail(in_quotes(lines_.words().front()) +
                  " can be read with red, green and blue only, not with " + in_quotes(lines_.words()[1]));
    }
    if (lines_.words().size() == 2) {
      return glm::dvec3(in_range(1, highest));
    }
    needs(1, 3);
    return {in_range(1, highest), in_range(2, highest), in_range(3, highest)};
  }

  [[nodiscard]] std::int64_t illumination() const {
    needs(1, 1);
    const std::int64_t model = lines_.integer(lines_.words()[1]);
    if (model < 0 || model > 10) {
      lines_.fail("there is no illumination model " + std::to_string(model) + ", only 0 to 10");
    }
    return model;
  }

  void read_map(std::string_view statement, MtlMap& map) {
    const std::vector<std::string_view>& words = lines_.words();
    std::size_t at = 1;
    while (at < words.size() && words[at].starts_with('-')) {
      const auto* const option = std::find_if(map_options.begin(), map_options.end(),
                                              [&](const MapOption& o) { return o.name == words[at]; });
      if (option == map_options.end()) {
        lines_.fail(std::string(statement) + " has no option " + in_quotes(words[at]));
      }
      if (std::find(foreign_options.begin(), foreign_options.end(), option->name) != foreign_options.end()) {
        left_out_.replace("options " + std::string(option->name) + " of textures, by none",
                          lines_.refusal(std::string(statement) + " has no option " + in_quotes(words[at])));
        at = std::min(at + 2, words.size());
        continue;
      }
      std::size_t end = at + 1 + option->least;
      // The last word is the file's name, even if it looks like a number.
      while (end < at + 1 + option->most && end + 1 < words.size() && is_number(words[end])) {
        ++end;
      }
      if (option->name == "-clamp" && end <= words.size()) {
        map.clamp = words[at + 1] == "on";
      } else if (option->name == "-imfchan" && statement == "map_d" && end <= words.size()) {
        map.matte = words[at + 1] == "m";
        left_out_.features["channels of map_d other than l and m"] +=
            map.matte || words[at + 1] == "l" ? 0U : 1U;
      } else {
        left_out_.features["options " + std::string(option->name) + " of textures"] += 1;
      }
      at = end;
    }
    map.file = lines_.from(at);
    map.place = lines_.place();
    if (map.file.empty()) {
      left_out_.replace("textures without a file's name, by none",
                        lines_.refusal(std::string(statement) + " needs the name of a file"));
    }
    std::replace(map.file.begin(), map.file.end(), '\\', '/');
  }

  TextLines lines_;
  LeftOut& left_out_;
  std::vector<MtlMaterial> materials_;
};

}  // namespace

std::vector<MtlMaterial> read_mtl(std::string_view text, const std::string& name, LeftOut& left_out) {
  return MtlReader(text, name, left_out).read();
}

}  // namespace marti::scenes
