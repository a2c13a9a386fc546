#include "studies/run/trace/node_list.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "sim/error.h"
#include "sim/parse_number.h"

namespace marti::studies::run {

namespace {

std::uint32_t parse_node(std::string_view text, std::string_view part, std::uint32_t nodes) {
  const auto node = sim::parse_number<std::uint32_t>(part);
  if (!node) {
    throw sim::UserError("--nodes " + std::string(text) + ": \"" + std::string(part) +
                         "\" is not the number of a node; write for instance 0-3 or 0,2,8-9");
  }
  if (*node >= nodes) {
    throw sim::UserError("--nodes " + std::string(text) + ": there is no node " + std::to_string(*node) +
                         "; the machine has nodes 0 to " + std::to_string(nodes - 1));
  }
  return *node;
}

}  // namespace

std::vector<std::uint32_t> parse_nodes(std::string_view text, std::uint32_t nodes) {
  std::vector<std::uint32_t> list;
  if (text.empty()) {
    list.resize(nodes);
    std::iota(list.begin(), list.end(), 0U);
    return list;
  }
  for (std::string_view rest = text;;) {
    const std::size_t comma = rest.find(',');
    const std::string_view part = rest.substr(0, comma);
    const std::size_t dash = part.find('-');
    const std::uint32_t first = parse_node(text, part.substr(0, dash), nodes);
    const std::uint32_t last =
        dash == std::string_view::npos ? first : parse_node(text, part.substr(dash + 1), nodes);
    if (first > last) {
      throw sim::UserError("--nodes " + std::string(text) + ": the range " + std::string(part) +
                           " runs backwards");
    }
    for (std::uint32_t node = first; node <= last; ++node) {
      list.push_back(node);
    }
    if (comma == std::string_view::npos) {
      break;
    }
    rest = rest.substr(comma + 1);
  }
  std::ranges::sort(list);
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

std::string text_of_nodes(std::span<const std::uint32_t> nodes) {
  std::string text;
  for (std::size_t begin = 0; begin < nodes.size();) {
    std::size_t end = begin + 1;
    while (end < nodes.size() && nodes[end] == nodes[end - 1] + 1) {
      ++end;
    }
    text += (text.empty() ? "" : ",") + std::to_string(nodes[begin]);
    text += end - begin > 1 ? "-" + std::to_string(nodes[end - 1]) : "";
    begin = end;
  }
  return text;
}

}  // namespace marti::studies::run
