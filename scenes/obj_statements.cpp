#include "scenes/obj_statements.h"

#include <algorithm>
#include <array>

namespace marti::scenes {

namespace {

constexpr std::array<std::string_view, 3> without_effect = {"g", "o", "s"};

struct CountedStatement {
  std::string_view statement;
  const char* what;  ///< in the plural
};
constexpr const char* free_form = "statements of free-form curves and surfaces";
constexpr const char* display = "settings of the display";
constexpr std::array<CountedStatement, 33> counted_statements = {
    {{"p", "statements of points"},
     {"l", "statements of lines"},
     {"vp", free_form},
     {"cstype", free_form},
     {"deg", free_form},
     {"bmat", free_form},
     {"step", free_form},
     {"curv", free_form},
     {"curv2", free_form},
     {"surf", free_form},
     {"parm", free_form},
     {"trim", free_form},
     {"hole", free_form},
     {"scrv", free_form},
     {"sp", free_form},
     {"end", free_form},
     {"con", free_form},
     {"bzp", free_form},
     {"bsp", free_form},
     {"cdc", free_form},
     {"cdp", free_form},
     {"res", free_form},
     {"mg", "merging groups"},
     {"bevel", display},
     {"c_interp", display},
     {"d_interp", display},
     {"lod", display},
     {"shadow_obj", display},
     {"trace_obj", display},
     {"ctech", display},
     {"stech", display},
     {"maplib", "statements of texture libraries"},
     {"usemap", "statements of texture libraries"}}};

}  // namespace

bool is_without_effect(std::string_view statement) {
  return std::find(without_effect.begin(), without_effect.end(), statement) != without_effect.end();
}

const char* left_out_kind(std::string_view statement) {
  const auto* const known =
      std::find_if(counted_statements.begin(), counted_statements.end(),
                   [&](const CountedStatement& counted) { return counted.statement == statement; });
  return known == counted_statements.end() ? nullptr : known->what;
}

}  // namespace marti::scenes
