#include "sim/document.h"

#include <algorithm>
#include <sstream>

#include "sim/shown.h"

namespace marti::sim {

namespace {

struct Words {
  std::string operator()(std::monostate /*date*/) const { return "a date or time"; }
  std::string operator()(bool /*value*/) const { return "a boolean"; }
  std::string operator()(std::int64_t value) const { return "the integer " + std::to_string(value); }
  std::string operator()(double value) const {
    std::ostringstream out;
    out << "the real " << value;
    return out.str();
  }
  std::string operator()(const std::string& value) const { return "the text \"" + shown(value) + "\""; }
  std::string operator()(const DocumentValue::List& /*list*/) const { return "a list"; }
  std::string operator()(const DocumentValue::Table& /*table*/) const { return "a table"; }
};

}  // namespace

std::string describe(const DocumentValue& value) { return std::visit(Words{}, value.content); }

const DocumentEntry* find(const DocumentValue::Table& table, std::string_view name) {
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const DocumentEntry& entry) { return entry.name == name; });
  return found == table.end() ? nullptr : &*found;
}

}  // namespace marti::sim
