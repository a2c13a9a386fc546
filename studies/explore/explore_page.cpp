#include "studies/explore/explore_page.h"

#include <vector>

#include "studies/report/model/chart_library.h"
#include "studies/report/page/page_files.h"
#include "studies/report/page/page_sections.h"
#include "studies/report/page/report_page.h"

namespace marti::studies::explore {

namespace {

constexpr const char* answer = R"html(<ul id="sentences" role="status"></ul>
<p id="state" class="note" role="status"></p>
)html";

constexpr const char* curve = R"html(<p id="axes">
<label>along <select id="axis"></select></label>
<label>values <input id="values" size="40"></label>
<label>of <select id="figure"></select></label>
</p>
<p id="curve-state" class="note"></p>
)html";

constexpr const char* settings = R"html(<p>
<button type="button" id="pin">Pin this machine</button>
<button type="button" id="reset">All settings as in the configuration</button>
<a id="save" download="explored.toml">Save as configuration</a>
<a id="save-sweep" download="explored-sweep.toml">Save the curve as sweep</a>
<button type="button" id="save-report">Save as report</button>
<button type="button" id="end">End marti explore</button>
</p>
<p><label>Search the settings <input type="search" id="search" autocomplete="off" spellcheck="false"></label></p>
<p id="found" class="note" role="status"></p>
)html";

}  // namespace

std::string explore_page(const std::string& what) {
  report::ReportData report;
  report.kind = "run";
  report.title = "marti explore " + what;
  report.about = "simulating the machine of the configuration";
  std::string curve_chart;
  std::string charts = "<p>" + std::string(report::no_vega_scripts) + "</p>\n";
  if (report::have_vega_scripts()) {
    report.charts.push_back(
        report::live_chart("explored_curve", "explored_curve", "One figure along one setting", nullptr));
    report.charts.back().note = "Each point is simulated; a click on a point goes there.";
    curve_chart = report::chart_html(report.charts.back());
    charts = "<div id=\"machine-charts\"></div>\n";
  }
  const std::vector<report::PageSection> sections = {
      {"answer", "The answer", answer},
      {"helps", "What would help", "<ul id=\"steps\"></ul>\n"},
      {"curve", "Curve", curve + curve_chart},
      {"pinned", "Pinned machines", "<div class=\"table\"><table id=\"pins\"></table></div>\n"},
      {"charts", "Charts", charts},
      {"tables", "Tables", "<div id=\"machine-tables\"></div>\n"},
      {"provenance", "Where it comes from", "<div id=\"machine-source\"></div>\n"},
      {"settings", "Settings of the machine", settings}};
  const report::LivePage live{{report::report_address_js(), explore_state_js(), explore_server_js(),
                               explore_values_js(), explore_sliders_js(), explore_controls_js(),
                               explore_answer_js(), explore_curve_js(), explore_save_js(), explore_main_js()},
                              explore_page_css()};
  return report::report_page(report, sections, report::vega_scripts(), live);
}

}  // namespace marti::studies::explore
