// What combines, as a table for people.
#pragma once

#include <string>

namespace marti::studies::keys {

/// A section in Markdown: a table of which features of a machine combine, and why the others do not.
[[nodiscard]] std::string combinations_as_markdown();

}  // namespace marti::studies::keys
