// `marti explore CONFIG`: a page on this computer where every setting of the machine is a control.
#pragma once

#include <string>
#include <vector>

namespace marti::studies::explore {

struct ExploreArguments {
  std::string config;
  std::vector<std::string> assignments;
  int port = 0;          ///< 0: a free one
  double seconds = 0.0;  ///< after which the command ends by itself; 0: never
  bool no_browser = false;
};

/// Renders the frame, prints the page's address, and serves it until the page asks for the end. Throws
/// UserError for a wrong configuration.
void explore_command(const ExploreArguments& arguments, void (*print)(const std::string&));

}  // namespace marti::studies::explore
