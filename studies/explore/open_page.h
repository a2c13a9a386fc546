// The user's browser.
#pragma once

#include <string>

namespace marti::studies::explore {

/// Whether somebody sits before this computer who would see a browser: the program writes to a terminal, and
/// a screen is known.
[[nodiscard]] bool has_screen();

/// Has the desktop open the address. What goes wrong is not told: the address is printed anyway.
void open_page(const std::string& address);

}  // namespace marti::studies::explore
