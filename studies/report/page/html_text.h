// Texts of any origin as parts of an HTML page.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace marti::studies::report {

/// The text as the content of an element or of an attribute between double quotation marks. Control
/// characters and bytes that are not UTF-8 become the replacement character.
[[nodiscard]] std::string html_text(std::string_view text);

/// The value as the content of a <script type="application/json">: no text in it can end the element or begin
/// a comment.
[[nodiscard]] std::string script_json(const nlohmann::ordered_json& json);

}  // namespace marti::studies::report
