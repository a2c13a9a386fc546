#include "scenes/pbrt_color.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string>

#include <glm/common.hpp>

#include "scenes/scene.h"
#include "scenes/text_lines.h"

namespace marti::scenes::pbrt {

namespace {

struct NamedGlass {
  std::string_view name;
  double index;
};
constexpr std::array<NamedGlass, 7> glasses = {{{"glass-BK7", 1.5168},
                                                {"glass-BAF10", 1.67003},
                                                {"glass-FK51A", 1.48656},
                                                {"glass-LASF9", 1.85025},
                                                {"glass-F5", 1.60342},
                                                {"glass-SF10", 1.72825},
                                                {"glass-SF11", 1.78472}}};

struct NamedMetal {
  std::string_view name;  // between "metal-" and "-eta" or "-k"
  glm::dvec3 color;
};
const std::array<NamedMetal, 5> metals = {{{"Ag", {0.972, 0.960, 0.915}},
                                           {"Al", {0.913, 0.922, 0.924}},
                                           {"Au", {1.000, 0.766, 0.336}},
                                           {"Cu", {0.955, 0.638, 0.538}},
                                           {"CuZn", {0.910, 0.778, 0.423}}}};

glm::dvec3 black_body(double kelvin) {
  const double t = 1000.0 / std::clamp(kelvin, 1667.0, 25000.0);
  const double x = t >= 0.25 ? ((-0.2661239 * t - 0.2343589) * t + 0.8776956) * t + 0.179910
                             : ((-3.0258469 * t + 2.1070379) * t + 0.2226347) * t + 0.240390;
  const double y = t >= 0.45   ? ((-1.1063814 * x - 1.34811020) * x + 2.18555832) * x - 0.20219683
                   : t >= 0.25 ? ((-0.9549476 * x - 1.37418593) * x + 2.09137015) * x - 0.16748867
                               : ((3.0817580 * x - 5.87338670) * x + 3.75112997) * x - 0.37001483;
  const double big_x = x / y;
  const double big_z = (1.0 - x - y) / y;
  // IEC 61966-2-1: linear sRGB of X, Y = 1, Z.
  return glm::max(glm::dvec3(0.0), glm::dvec3(3.2406 * big_x - 1.5372 - 0.4986 * big_z,
                                              -0.9689 * big_x + 1.8758 + 0.0415 * big_z,
                                              0.0557 * big_x - 0.2040 + 1.0570 * big_z));
}

/// The mean from `from` to `to` of a function that is linear between its points and constant beyond them.
double mean(const std::vector<double>& points, double from, double to) {
  constexpr int steps = 20;
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double at = from + (to - from) * (i + 0.5) / steps;
    std::size_t next = 0;
    while (next < points.size() && points[next] < at) {
      next += 2;
    }
    if (next == 0 || next == points.size()) {
      sum += points[next == 0 ? 1 : next - 1];
      continue;
    }
    const double part = (at - points[next - 2]) / (points[next] - points[next - 2]);
    sum += points[next - 1] + part * (points[next + 1] - points[next - 1]);
  }
  return sum / steps;
}

glm::dvec3 spectrum(const Parameters& parameters, const Parameter& given) {
  const std::vector<double>& points = parameters.numbers(given.name, 2);
  if (points.empty()) {
    parameters.fail("the parameter " + in_quotes(given.name) + " is an empty spectrum");
  }
  for (std::size_t i = 2; i < points.size(); i += 2) {
    if (!(points[i] > points[i - 2])) {
      parameters.fail("the wavelengths of the spectrum " + in_quotes(given.name) + " do not rise");
    }
  }
  if (!std::all_of(points.begin(), points.end(), [](double value) { return std::isfinite(value); })) {
    parameters.fail("the spectrum " + in_quotes(given.name) + " has a number that is not finite");
  }
  return {mean(points, 600.0, 700.0), mean(points, 500.0, 600.0), mean(points, 400.0, 500.0)};
}

std::string_view metal_of(const std::string& spectrum, std::string_view ending) {
  const std::string_view name = spectrum;
  constexpr std::string_view begin = "metal-";
  return name.starts_with(begin) && name.ends_with(ending) && name.size() > begin.size() + ending.size()
             ? name.substr(begin.size(), name.size() - begin.size() - ending.size())
             : std::string_view();
}

/// The text of a spectrum that has a name; empty for any other.
std::string name_of(const Parameters& parameters, std::string_view name) {
  const Parameter* const found = parameters.find(name);
  return found != nullptr && found->type == "spectrum" && !found->texts.empty() ? parameters.text(name)
                                                                                : std::string();
}

}  // namespace

glm::dvec3 color_in(const Parameters& parameters, std::string_view name, const glm::dvec3& otherwise,
                    double highest, LeftOut& left_out) {
  const Parameter* const found = parameters.find(name);
  if (found == nullptr || found->type == "texture") {
    return otherwise;
  }
  glm::dvec3 color(1.0);
  if (found->type == "blackbody") {
    color = black_body(parameters.number(name, 0.0, 0.0, 1e6));
  } else if (found->type == "spectrum" && !found->texts.empty()) {
    left_out.replace(
        "spectra that are named, by white",
        parameters.place() + ": the spectrum " + in_quotes(parameters.text(name)) + " is not known");
  } else if (found->type == "spectrum") {
    color = spectrum(parameters, *found);
  } else if (found->type == "float") {
    color = glm::dvec3(parameters.number(name, 0.0, 0.0, highest));
  } else if (found->type == "rgb" || found->type == "color") {
    color = parameters.vector(name, otherwise);
  } else {
    parameters.fail("the parameter " + in_quotes(name) + " is no colour: its type is " +
                    in_quotes(found->type));
  }
  for (int i = 0; i < 3; ++i) {
    if (!(color[i] >= 0.0 && color[i] <= highest)) {
      std::ostringstream text;
      text << "a channel of the colour " << in_quotes(name) << " is " << color[i] << "; it must lie in 0 to "
           << highest;
      parameters.fail(text.str());
    }
  }
  return color;
}

double index_of_refraction(const Parameters& parameters, LeftOut& left_out) {
  const std::string name = parameters.find("eta") != nullptr ? "eta" : "index";
  const std::string spectrum = name_of(parameters, name);
  if (!spectrum.empty()) {
    const auto glass =
        std::find_if(glasses.begin(), glasses.end(), [&](const auto& g) { return g.name == spectrum; });
    if (glass != glasses.end()) {
      return glass->index;
    }
    left_out.replace("glasses that are not known, by one of index 1.5",
                     parameters.place() + ": the spectrum " + in_quotes(spectrum) + " is not known");
    return 1.5;
  }
  const Parameter* const found = parameters.find(name);
  return found == nullptr || found->type == "texture"
             ? 1.5
             : std::clamp(color_in(parameters, name, glm::dvec3(1.5), largest_ior, left_out).y, 1.0,
                          largest_ior);
}

glm::dvec3 metal_color(const Parameters& parameters, LeftOut& left_out) {
  if (parameters.find("reflectance") != nullptr) {
    return color_in(parameters, "reflectance", glm::dvec3(1.0), 1.0, left_out);
  }
  const Parameter* const eta = parameters.find("eta");
  const Parameter* const k = parameters.find("k");
  const std::string eta_name = name_of(parameters, "eta");
  const std::string k_name = name_of(parameters, "k");
  if (!eta_name.empty() || !k_name.empty() || (eta == nullptr && k == nullptr)) {
    const std::string_view metal = !eta_name.empty() ? metal_of(eta_name, "-eta")
                                   : !k_name.empty() ? metal_of(k_name, "-k")
                                                     : std::string_view("Cu");
    const auto known =
        std::find_if(metals.begin(), metals.end(), [&](const auto& m) { return m.name == metal; });
    if (known != metals.end()) {
      return known->color;
    }
    left_out.replace("metals that are not known, by white ones",
                     parameters.place() + ": the metal " + in_quotes(eta_name.empty() ? k_name : eta_name) +
                         " is not known");
    return glm::dvec3(1.0);
  }
  constexpr double most = 100.0;
  const glm::dvec3 n = color_in(parameters, "eta", glm::dvec3(1.0), most, left_out);
  const glm::dvec3 absorbs = color_in(parameters, "k", glm::dvec3(0.0), most, left_out);
  const glm::dvec3 squares = absorbs * absorbs;
  return ((n - 1.0) * (n - 1.0) + squares) / ((n + 1.0) * (n + 1.0) + squares);
}

}  // namespace marti::scenes::pbrt
