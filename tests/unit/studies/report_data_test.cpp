// The data of a report, and how texts of any origin become parts of a page.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "processors/cost/accounting.h"
#include "sim/base64.h"
#include "sim/error.h"
#include "sim/sha256.h"
#include "studies/report/model/chart_library.h"
#include "studies/report/model/result_tables.h"
#include "studies/report/model/sweep_answer.h"
#include "studies/report/model/sweep_report.h"
#include "studies/report/page/html_text.h"
#include "studies/report/page/page_files.h"
#include "studies/report/page/report_page.h"
#include "studies/report/read/report_files.h"
#include "studies/sweep/store/axis_effects.h"
#include "studies/sweep/store/points_table.h"
#include "studies/tables/chart.h"
#include "studies/tables/csv.h"
#include "studies/tables/result_directory.h"
#include "studies/tables/run_json.h"
#include "tests/support/files.h"
#include "tests/support/long_tests.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"

namespace marti::studies {

using namespace report;
using namespace sweep;
using namespace tables;

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using test::TemporaryDirectory;
using test::user_error_of;
using test::write;

TEST(HtmlText, LeavesNoMarkup) {
  EXPECT_EQ(html_text("<b a=\"1\" c='2'>&"), "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;");
  EXPECT_EQ(html_text(std::string("a\0b\x1b", 4)),
            "a\xef\xbf\xbd"
            "b\xef\xbf\xbd");
  EXPECT_EQ(html_text("\xff"), "\xef\xbf\xbd");
}

TEST(ScriptJson, CannotEndItsElement) {
  const Json json = {{"</script><!--", "<script>&"}, {"bad", "\xff"}};
  const std::string text = script_json(json);
  EXPECT_EQ(text.find('<'), std::string::npos);
  EXPECT_EQ(Json::parse(text).begin().key(), "</script><!--");
  EXPECT_EQ(Json::parse(text)["bad"], "\xef\xbf\xbd");
}

TEST(ReportPage, EscapesWhatAResultSays) {
  ReportData report;
  report.kind = "run";
  report.title = "</title><script>alert(1)</script>{{data}}";
  report.answer = {"<img src=x>"};
  report.configuration = "scene.source = \"</pre>\"\n";
  Table table("t", "<i>", {{"c", ColumnType::text, "", "\"><b>"}});
  table.add_row({std::string("</table>")});
  report.tables.push_back({table, false});
  report.images.push_back({"x", "\" onerror=\"", "\x89PNG"});
  const std::string page = report_page(report, {});
  for (const char* bad : {"<script>alert", "<img src=x", "</pre>\"", "<i>", "<b>", "\" onerror"}) {
    EXPECT_EQ(page.find(bad), std::string::npos) << bad;
  }
  EXPECT_NE(page.find("{{data}}</title>"), std::string::npos) << "what is put in is not looked at again";
  EXPECT_EQ(page, report_page(report, {}));
}

TEST(ReportPage, AllowsItsOwnScriptsOnly) {
  const Script script{"abc", "ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0="};
  const std::string page = report_page({}, {&script, 1});
  EXPECT_NE(page.find("script-src 'sha256-ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0='"), std::string::npos);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(page.find("unsafe"), std::string::npos);
  // The page's own have the hashes of their texts.
  const auto digest = sim::sha256(report_page_css().text);
  EXPECT_EQ(report_page_css().sha256, sim::base64(std::string(digest.begin(), digest.end())));
  for (const Script& each : vega_scripts()) {
    const auto hash = sim::sha256(each.text);
    EXPECT_EQ(each.sha256, sim::base64(std::string(hash.begin(), hash.end())));
  }
}

std::string table_page(const Column& column, const Cell& cell) {
  Table table("t", "T", {column});
  table.add_row({cell});
  ReportData report;
  report.tables.push_back({table, false});
  const std::string page = report_page(report, {});
  const std::size_t begin = page.find("<thead>");
  return page.substr(begin, page.find("</table>", begin) - begin);
}

// Units stand in the heading, or for sizes beside each value.
TEST(ReportPage, ShowsNumbersAsPeopleWriteThem) {
  const auto shows = [](const char* unit, const Cell& cell, const std::string& heading,
                        const std::string& text) {
    const std::string html = table_page(
        {"some_figure", std::holds_alternative<std::int64_t>(cell) ? ColumnType::integer : ColumnType::real,
         unit, ""},
        cell);
    EXPECT_NE(html.find(">" + heading + "</th>"), std::string::npos) << html;
    EXPECT_NE(html.find(">" + text + "</td>"), std::string::npos) << html;
  };
  shows("ps", std::int64_t{40'858'349'694}, "some figure, ms", "40.8583");
  shows("fraction", 0.9375, "some figure, %", "93.75");
  shows("byte", std::int64_t{16'384}, "some figure", "16 KiB");
  shows("byte", std::int64_t{262'100}, "some figure", "256.0 KiB");
  shows("byte", std::int64_t{100}, "some figure", "100 B");
  shows("us", 2.5, "some figure, us", "2.5");
  shows("1", std::int64_t{16'384}, "some figure", "16384");
  shows("ps", Cell(), "some figure, ms", "");
}

// A sweep whose names would be markup, script or the end of a text if they were not escaped.
TEST(ReportPage, KeepsNamesOfPointsTexts) {
  const std::vector<std::string> names = {"<script>alert(1)</script>", "\"quoted\" 'name' \\",
                                          "</td>{{data}}"};
  ReportPoints sweep;
  ReportAxis axis;
  axis.name = "point";
  for (std::size_t i = 0; i < names.size(); ++i) {
    axis.values.emplace_back(names[i]);
    axis.texts.push_back(names[i]);
    ReportPoint point;
    point.ordinal = static_cast<std::int64_t>(i);
    point.place = {i};
    point.figures = {{"price", 1.0 + static_cast<double>(i)}, {"end", 1e9 / static_cast<double>(i + 1)}};
    sweep.points.push_back(point);
  }
  sweep.axes.push_back(axis);
  sweep.planned = names.size();
  const ReportData report = sweep_report(sweep, 2.0);
  const std::string page = report_page(report, {});
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  EXPECT_EQ(page.find("</td>{{"), std::string::npos);
  EXPECT_NE(page.find("&quot;quoted&quot; &#39;name&#39; \\"), std::string::npos);
  EXPECT_EQ(page, report_page(sweep_report(sweep, 2.0), {}));
  const std::size_t begin = page.find("id=\"data\">") + 10;
  const Json data = Json::parse(page.substr(begin, page.find("</script>", begin) - begin));
  EXPECT_EQ(data["explorer"]["axes"][0]["texts"], Json(names));
  EXPECT_EQ(data["explorer"]["axis"], 0) << "names have bars";
  EXPECT_EQ(data["explorer"]["budget"], 2.0);
  EXPECT_EQ(data["explorer"]["columns"]["end"], Json({1.0, 0.5, 1e9 / 3.0 / 1e9}));
}

TEST(OrderAxes, JoinsKeysThatChangeTogether) {
  const std::vector<std::string> names = {"point", "kind", "nodes", "size", "ways", "fixed"};
  std::vector<std::vector<Cell>> points;
  for (const auto& [point, kind] : {std::pair("b", "bus"), std::pair("a", "bus"), std::pair("c", "ideal")}) {
    for (const std::int64_t nodes : {4, 1}) {
      for (const std::int64_t size : {1024, 4096}) {
        points.push_back({std::string(point), std::string(kind), nodes, size, size / 1024, std::int64_t{7}});
      }
    }
  }
  const std::vector<AxisColumn> axes = order_axes(names, points);
  ASSERT_EQ(axes.size(), 3U);
  EXPECT_EQ(axes[0].name, "point");
  EXPECT_EQ(axes[0].followers, std::vector<std::string>{"kind"});
  EXPECT_EQ(axes[0].values, (std::vector<Cell>{std::string("b"), std::string("a"), std::string("c")}));
  EXPECT_EQ(axes[1].name, "nodes");
  EXPECT_EQ(axes[1].values, (std::vector<Cell>{std::int64_t{1}, std::int64_t{4}}));
  EXPECT_EQ(axes[1].index[0], 1U);
  EXPECT_EQ(axes[2].followers, std::vector<std::string>{"ways"});
}

// Two values of a cache, three of nodes, on a frame time that is a product of both, and of `together` where
// both are largest; without the points of `left_out`.
AxisEffects effects_of(double together, const std::set<std::size_t>& left_out = {}) {
  std::vector<std::vector<Cell>> points;
  std::vector<double> times;
  for (std::size_t i = 0; i < 6; ++i) {
    const std::int64_t cache = std::int64_t{1024} << (i / 3);
    const std::int64_t nodes = std::int64_t{1} << (i % 3);
    if (!left_out.contains(i)) {
      points.push_back({cache, nodes, std::int64_t{7}});
      times.push_back(1e6 * (cache == 1024 ? 1.25 : 1.0) / static_cast<double>(nodes) *
                      (i == 5 ? together : 1.0));
    }
  }
  const std::vector<std::string> names = {"cache.size", "machine.nodes", "fixed"};
  return axis_effects(order_axes(names, points), times);
}

TEST(AxisEffects, AreTheFactorsOfAProduct) {
  for (const std::set<std::size_t>& left_out : {std::set<std::size_t>{}, {1}, {0, 4}}) {
    const AxisEffects effects = effects_of(1.0, left_out);
    ASSERT_EQ(effects.axes.size(), 2U) << "an axis of one value has no effect";
    EXPECT_EQ(effects.axes[0].axis, "machine.nodes");
    EXPECT_NEAR(effects.axes[0].ratio(), 4.0, 1e-6);
    EXPECT_EQ(effects.axes[0].fastest, "4");
    EXPECT_EQ(effects.axes[1].slowest, "1 KiB");
    EXPECT_NEAR(effects.axes[1].ratio(), 1.25, 1e-6);
    EXPECT_TRUE(effects.interactions.empty());
  }
  AxisEffects all = effects_of(1.0);
  EXPECT_NEAR(all.axes[0].fastest_by, 0.5, 1e-12) << "4 nodes by the geometric mean of 1, 2 and 4";
  EXPECT_EQ(effects_text(all), "machine.nodes 4.00 times, cache.size 1.25 times");
  all.noise = {0.26};
  EXPECT_EQ(effects_text(all),
            "machine.nodes 4.00 times, one axis no more than another order of packets, 26.00 %");
  all.noise = {3.1};
  EXPECT_EQ(effects_text(all), "2 axes no more than another order of packets, 310.00 %");
}

TEST(Noise, IsTheShareWithinWhichOtherPointsAreNotTold) {
  const std::vector<double> times = {102.0, 100.0, 100.0, 105.0};
  EXPECT_EQ(within_noise(times, 0.0), 1U) << "an equal frame is not told at all";
  EXPECT_EQ(within_noise(times, 0.02), 2U);
  EXPECT_EQ(within_noise(times, 1.0), 3U);
  EXPECT_EQ(fastest_noise_text({0.004}, 2),
            "another order of packets changes its frame by up to 0.40 %, and 2 other points are within that");
}

// Of the residuals of a 2 by 3 table with one larger cell, t: t/3 there, -t/3 below, -t/6 and t/6 beside (in
// logarithms).
TEST(AxisEffects, NameWhatActsTogether) {
  const AxisEffects effects = effects_of(8.0);
  ASSERT_EQ(effects.interactions.size(), 1U);
  EXPECT_NEAR(effects.interactions[0].ratio, std::pow(8.0, 2.0 / 3.0), 1e-9);
  EXPECT_NE(effects_text(effects).find("; cache.size and machine.nodes together 4.00 times"),
            std::string::npos)
      << effects_text(effects);
}

TEST(Choose, FindsTheFastestTheFrontAndItsKnee) {
  ReportPoints sweep;
  const std::vector<std::pair<double, double>> offers = {{1, 100}, {2, 50},  {4, 26},
                                                         {8, 25},  {16, 24}, {8, 60}};
  for (const auto& [price, end] : offers) {
    ReportPoint point;
    point.figures = {{"price", price}, {"end", end}};
    sweep.points.push_back(point);
  }
  const Chosen chosen = choose(sweep);
  EXPECT_EQ(chosen.front, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(chosen.fastest, 4U);
  EXPECT_EQ(chosen.knee, 2U);
}

// Of random points on few values, so that some are equal; a few have no energy.
TEST(Choose, FindsTheFrontOfEnergyAsBruteForceDoes) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 50; ++round) {
    ReportPoints sweep;
    for (int i = 0; i < 30; ++i) {
      ReportPoint point;
      const auto energy = static_cast<double>(random() % 12);
      point.figures = {{"price", static_cast<double>(1 + random() % 9)},
                       {"end", static_cast<double>(1 + random() % 12)}};
      if (random() % 4 != 0) {
        point.figures["energy"] = energy;
      }
      sweep.points.push_back(point);
    }
    const Chosen chosen = choose(sweep);
    const auto place = [&](std::size_t i) {
      return std::pair(sweep.points[i].figure("energy"), sweep.points[i].figure("end"));
    };
    std::set<std::pair<double, double>> unbeaten;
    for (std::size_t i = 0; i < sweep.points.size(); ++i) {
      bool beaten = !sweep.points[i].has("energy");
      for (std::size_t other = 0; other < sweep.points.size(); ++other) {
        beaten = beaten || (sweep.points[other].has("energy") && place(other) != place(i) &&
                            place(other).first <= place(i).first && place(other).second <= place(i).second);
      }
      if (!beaten) {
        unbeaten.insert(place(i));
      }
    }
    std::set<std::pair<double, double>> front;
    for (const std::size_t i : chosen.energy_front) {
      EXPECT_TRUE(sweep.points[i].has("energy"));
      EXPECT_TRUE(front.insert(place(i)).second);
    }
    EXPECT_EQ(front, unbeaten);
  }
}

// The chart adds activities up, and has a colour for each sum: none is left out.
TEST(ReportCharts, CyclesHaveEveryActivity) {
  const Json spec = Json::parse(chart_named(report_chart_specifications(), "cycles").json);
  std::vector<std::string> shares;
  for (const std::string_view activity : processors::cost::activity_names) {
    shares.push_back("share_" + std::string(activity));
  }
  EXPECT_EQ(spec["usermeta"]["live"]["fields"], Json(shares));
  EXPECT_EQ(spec["transform"][0]["fold"], Json(shares));
  const std::string groups = spec["transform"][1]["calculate"];
  const Json& colours = spec["encoding"]["color"]["scale"];
  std::set<std::string> named;
  for (const std::string& share : shares) {
    const std::size_t at = groups.find(share + ": '");
    ASSERT_NE(at, std::string::npos) << share;
    const std::size_t begin = at + share.size() + 3;
    named.insert(groups.substr(begin, groups.find('\'', begin) - begin));
  }
  EXPECT_EQ(named, std::set<std::string>(colours["domain"].begin(), colours["domain"].end()));
  EXPECT_EQ(colours["domain"].size(), colours["range"].size());
}

TEST(CsvOfRows, QuotesWhatItHasTo) {
  const Json rows = Json::parse(R"([{"a": 1, "b": "x,\"y\""}, {"a": null, "c": "", "d": 0.0001}])");
  EXPECT_EQ(csv_of_rows(rows), "a,b,c,d\r\n1,\"x,\"\"y\"\"\",,\r\n,,\"\",1e-04\r\n");
}

TEST(ReportCharts, AllSpecificationsAreWhole) {
  Table table("t", "A title", {{"x", ColumnType::integer, "1", ""}});
  table.add_row({std::int64_t{1}});
  EXPECT_FALSE(report_chart_specifications().empty());
  for (const ChartSpecification& each : report_chart_specifications()) {
    if (Json::parse(each.json).contains(Json::json_pointer("/usermeta/columns"))) {
      continue;
    }
    const ReportChart chart = make_chart(each.name, table);
    EXPECT_FALSE(chart.spec.contains("usermeta")) << "a page does not need " << each.name << "'s query";
    EXPECT_NE(chart.spec["$schema"].get<std::string>().find("vega-lite"), std::string::npos) << each.name;
    EXPECT_EQ(chart.spec["data"]["values"][0]["x"], 1) << each.name;
    EXPECT_EQ(chart.title, "A title");
  }
  EXPECT_THROW((void)make_chart("none", table), sim::InternalError);
}

// All charts together: the colours of Okabe and Ito, greys, and what tells the parts of stacked bars apart.
TEST(ReportCharts, HaveOnePalette) {
  const std::set<std::string> palette = {"#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7",
                                         "#56B4E9", "#F0E442", "#999999", "#777777", "#ffffff",
                                         "#6b4c9a", "#7fbf9b", "#e5b8d2", "#b39ddb", "#c9b400"};
  const std::regex colour("#[0-9a-fA-F]{3,8}\\b");
  for (const auto charts : {report_chart_specifications(), chart_specifications()}) {
    for (const ChartSpecification& chart : charts) {
      const std::string text(chart.json);
      for (std::sregex_iterator at(text.begin(), text.end(), colour), end; at != end; ++at) {
        EXPECT_TRUE(palette.contains(at->str())) << chart.name << ": " << at->str();
      }
    }
  }
}

// Calls visit for every channel of x and y with a title in a specification.
template <class Visit>
void for_each_axis(const Json& part, const Visit& visit) {
  for (const auto& [key, value] : part.items()) {
    if ((key == "x" || key == "y") && value.is_object() && value.contains("field")) {
      visit(value);
    }
    if (value.is_structured()) {
      for_each_axis(value, visit);
    }
  }
}

// An axis of shares says so in its title, and none has labels like "16.384k".
TEST(ReportCharts, HaveUnitsOnTheirAxes) {
  std::size_t shares = 0;
  for (const auto charts : {report_chart_specifications(), chart_specifications()}) {
    for (const ChartSpecification& chart : charts) {
      for_each_axis(Json::parse(chart.json), [&](const Json& axis) {
        const std::string format = axis.value(Json::json_pointer("/axis/format"), "");
        EXPECT_EQ(format.find('s'), std::string::npos) << chart.name;
        if (format.ends_with("%") && axis.contains("title")) {
          EXPECT_TRUE(axis["title"].get<std::string>().ends_with("%")) << chart.name;
          ++shares;
        }
      });
    }
  }
  EXPECT_GE(shares, 15U);
}

Json nodes_of(std::size_t count) {
  Json nodes = Json::array();
  for (std::size_t i = 0; i < count; ++i) {
    // Whole shares of 16 ps, so that sums are exact.
    const std::size_t idle = (i * 7) % 16;
    nodes.push_back(
        {{"time_ps", {{"traversal", 16 - idle}, {"transfer", 0}, {"bank_wait", 0}, {"idle", idle}}}});
  }
  return Json{{"figures", {{"machine", {{"end", 16}}}}}, {"machine", {{"per_node", nodes}}}};
}

const ReportChart* nodes_chart(const ReportData& report) {
  const auto at = std::find_if(report.charts.begin(), report.charts.end(),
                               [](const ReportChart& chart) { return chart.name == "run_nodes"; });
  return at == report.charts.end() ? nullptr : &*at;
}

TEST(RunCharts, ShowAThousandNodesAsAnEnvelope) {
  for (const std::size_t count : {64U, 65U, 100U, 1000U, 4096U}) {
    ReportData report;
    add_queried(RunJson(nodes_of(count), "f"), report);
    const ReportChart* const chart = nodes_chart(report);
    ASSERT_NE(chart, nullptr);
    const Json& rows = chart->spec["data"]["values"];
    if (count == 64) {
      EXPECT_EQ(rows.size(), 64U) << "a bar each";
      continue;
    }
    ASSERT_EQ(rows.size(), 4U * 64U);
    std::size_t next = 0;
    for (const Json& row : rows) {
      if (row["what"] != "idle") {
        continue;
      }
      ASSERT_EQ(row["node"], next) << "every node is in one group";
      next = row["last"].get<std::size_t>() + 1;
      double least = 1.0;
      double most = 0.0;
      double sum = 0.0;
      for (std::size_t i = row["node"]; i < next; ++i) {
        const double share = static_cast<double>((i * 7) % 16) / 16.0;
        least = std::min(least, share);
        most = std::max(most, share);
        sum += share;
      }
      EXPECT_EQ(row["least"], least);
      EXPECT_EQ(row["most"], most);
      EXPECT_DOUBLE_EQ(row["mean"].get<double>(),
                       sum / static_cast<double>(next - row["node"].get<std::size_t>()));
    }
    EXPECT_EQ(next, count);
  }
}

// A result of two nodes and two levels that has a part of every kind.
RunJson whole_result() {
  return {Json::parse(R"({
    "config": {"keys": {"layout.entry": {"value": 4}, "layout.primitive": {"value": 48},
      "layout.quadric": {"value": 40}, "layout.material": {"value": 64}}},
    "figures": {
      "frame": {"scene": "s", "structure_nodes": 9, "structure_entries": 5, "triangles": 3, "spheres": 1,
        "cylinders": 0, "cones": 2, "materials": 1},
      "machine": {"end": 10, "nodes": 2, "time_traversal": 15, "time_idle": 5, "lost_extra_misses": 0, "lost_contention": 0.5, "lost_imbalance": 0, "lost_overhead": 0, "lost_idle": 0.25,
        "energy_total": 8, "energy_operations": 2, "energy_l1": 6, "node_hits": 3, "node_misses": 1,
        "list_hits": 0, "list_misses": 0, "interconnect_share_data": 0.25, "interconnect_share_no_request": 0.75}},
    "structure": {"node_records": 9, "node_bytes": 8, "levels": [
      {"branches": 1, "leaves": 0, "empty_leaves": 0, "entries": 0},
      {"branches": 0, "leaves": 8, "empty_leaves": 5, "entries": 5}]},
    "plan": {"cache": {"decision": "needed", "fact": "f"}},
    "machine": {
      "build": {"levels": [{"visits": 7}]},
      "counts": {"attribution": [{"level": 1, "record": "node", "references": 4, "misses": 1},
        {"level": 0, "record": "material", "references": 9, "misses": 9},
        {"level": 1, "record": "node", "references": 4, "misses": 3}]},
      "critical_path": {"time_ps": {"work": 6, "wait": 4, "nothing": 0}},
      "intervals": {"count": 2, "columns": {"from_ps": {"unit": "ps", "values": [0, 8]},
        "to_ps": {"unit": "ps", "values": [8, 10]}, "misses": {"unit": "1", "values": [3, null]},
        "energy_l1": {"unit": "fJ", "values": [4, 2]}, "power": {"unit": "W", "values": [0.5, 0.25]}}},
      "what_helps": {"resources": [{"step": {"text": "machine.nodes 2 -> 4", "saved": 0.25, "most_saved": 0.5,
        "price": null}, "best": null}]},
      "per_cluster": [
        {"interconnect": {"waits": {"histogram_ps": [[0, 0, 3], [1, 2, 1]]}},
          "banks": [{"waits": {"histogram_ps": [[0, 0, 1]]}}, {"waits": {"histogram_ps": [[0, 0, 1]]}}]},
        {"interconnect": {"waits": {"histogram_ps": [[0, 0, 4]]}},
          "distributed": {"network": {"waits": {"histogram_ps": [[0, 0, 1]]}}}}],
      "per_node": [{"time_ps": {"traversal": 10}},
        {"time_ps": {"traversal": 4, "bank_wait": 1, "transfer": 1, "idle": 4}}]}})"),
          "some/result.json"};
}

/// Every part of a document, the document itself included, by its path.
void collect_parts(const Json& part, const Json::json_pointer& path, std::vector<Json::json_pointer>& all) {
  all.push_back(path);
  if (part.is_structured()) {  // the only item of anything else is itself
    for (const auto& [key, value] : part.items()) {
      collect_parts(value, part.is_array() ? path / std::stoul(key) : path / key, all);
    }
  }
}

// Anybody may have changed the file: each part of it in turn is missing or something else.
TEST(RunCharts, ShowWhatIsThereOrSayWhatIsWrong) {
  const Json whole = whole_result().json();
  std::vector<Json::json_pointer> parts;
  collect_parts(whole, Json::json_pointer(), parts);
  const std::vector<Json> others = {nullptr,
                                    true,
                                    -1,
                                    0,
                                    0.5,
                                    -0.0,
                                    1e308,
                                    18446744073709551615U,
                                    std::numeric_limits<std::int64_t>::min(),
                                    "",
                                    "1e999",
                                    "\xff\x01",
                                    "$.x",
                                    Json::array(),
                                    Json::array({nullptr, Json::array()}),
                                    Json::object(),
                                    Json::object({{"", 1}, {"a.b", {1, 2}}})};
  std::size_t next = 0;
  std::size_t refused = 0;
  const auto try_one = [&](const Json& changed) {
    ReportData report;
    try {
      add_queried(RunJson(changed, "some/result.json"), report);
    } catch (const sim::UserError& error) {
      ++refused;
      EXPECT_TRUE(std::string_view(error.what()).starts_with("some/result.json: ")) << error.what();
    }
    for (const ReportChart& chart : report.charts) {
      (void)script_json(chart.spec);
    }
  };
  const std::size_t step = test::stride(7, 1);
  for (const Json::json_pointer& part : parts) {
    if (!part.empty() && next++ % step == 0) {
      Json changed = whole;
      Json& parent = changed[part.parent_pointer()];
      parent.is_array() ? parent.erase(std::stoul(part.back())) : (void)parent.erase(part.back());
      try_one(changed);
    }
    for (const Json& other : others) {
      if (next++ % step == 0) {
        Json changed = whole;
        changed[part] = other;
        try_one(changed);
      }
    }
  }
  EXPECT_GT(refused, 0U);
}

// Names of fields that a specification's channels show, and of those that its transforms make.
void collect_fields(const Json& part, std::set<std::string>& shown, std::set<std::string>& made) {
  for (const auto& [key, value] : part.items()) {
    if (key == "field" && value.is_string()) {
      shown.insert(value.get<std::string>());
    } else if (key == "as") {
      for (const Json& name : value.is_array() ? value : Json::array({value})) {
        made.insert(name.get<std::string>());
      }
    } else if (value.is_structured() && key != "data") {
      collect_fields(value, shown, made);
    }
  }
}

TEST(RunCharts, HaveRowsWithAllFieldsThatTheyShow) {
  ResultTables result(whole_result());
  for (const DescribedChart& described : described_charts("run")) {
    const Json rows = result.rows(query_of(described.meta));
    if (described.file == "run_nodes_envelope") {
      EXPECT_TRUE(rows.empty()) << "two nodes have a bar each";
      continue;
    }
    ASSERT_FALSE(rows.empty()) << described.file;
    std::set<std::string> shown;
    std::set<std::string> made;
    for (const Json& column : described.meta.value("columns", Json::array())) {
      shown.insert(column.at("name").get<std::string>());
    }
    const ChartSpecification& file = chart_named(report_chart_specifications(), described.file);
    collect_fields(Json::parse(file.json), shown, made);
    for (const std::string& field : shown) {
      EXPECT_TRUE(made.contains(field) || rows[0].contains(field)) << described.file << ": " << field;
    }
  }
}

TEST(RunCharts, AreThoseOfTheResult) {
  ReportData report;
  add_queried(whole_result(), report);
  const std::map<std::string, std::string> wanted = {
      {"run_cycles",
       R"([{"activity":"traversal","ps":15,"share":0.75},{"activity":"idle","ps":5,"share":0.25}])"},
      {"run_loss",
       R"([{"part":"extra misses","lost":0},{"part":"contention","lost":0.5},{"part":"imbalance","lost":0},{"part":"overhead","lost":0},{"part":"no work at all","lost":0.25}])"},
      {"run_nodes", R"([{"node":0,"compute":1.0,"memory":0.0,"waits":0.0,"idle":0.0},
                        {"node":1,"compute":0.4,"memory":0.1,"waits":0.1,"idle":0.4}])"},
      {"run_references", R"([{"record":"node","hits":3,"misses":1,"hit_ratio":0.75}])"},
      {"run_level_accesses", R"([{"level":1,"record":"node","references":8,"misses":4}])"},
      {"run_level_hit_ratio", R"([{"level":1,"record":"node","hit_ratio":0.5}])"},
      {"run_visits", R"([{"level":1,"visits":7}])"},
      {"run_waits", R"([{"what":"interconnect","highest_ps":0,"count":7,"share":0.875},
                        {"what":"interconnect","highest_ps":2,"count":1,"share":1.0},
                        {"what":"bank","highest_ps":0,"count":2,"share":1.0},
                        {"what":"network","highest_ps":0,"count":1,"share":1.0}])"},
      {"run_level_memory", R"([{"level":1,"node_bytes":8,"list_bytes":0},
                               {"level":2,"node_bytes":64,"list_bytes":20}])"},
      {"run_memory", R"([{"record":"nodes","records":9,"bytes":72},
                         {"record":"list entries","records":5,"bytes":20},
                         {"record":"triangles","records":3,"bytes":144},
                         {"record":"spheres, cylinders, cones","records":3,"bytes":120},
                         {"record":"materials","records":1,"bytes":64}])"},
      {"run_power", R"([{"part":"l1","length_us":8e-6,"end_us":1e-5,"values":"4,2"}])"},
      {"run_intervals", R"([{"figure":"power, W","length_us":8e-6,"end_us":1e-5,"values":"0.5,0.25"},
                            {"figure":"misses","length_us":8e-6,"end_us":1e-5,"values":"3,null"},
                            {"figure":"energy l1, fJ","length_us":8e-6,"end_us":1e-5,"values":"4,2"}])"},
      {"run_path", R"([{"what":"work","ps":6,"share":0.6},{"what":"wait","ps":4,"share":0.4}])"}};
  std::size_t found = 0;
  for (const ReportChart& chart : report.charts) {
    if (const auto rows = wanted.find(chart.name); rows != wanted.end()) {
      EXPECT_EQ(chart.spec["data"]["values"], Json::parse(rows->second)) << chart.name;
      ++found;
    }
  }
  EXPECT_EQ(found, wanted.size());
  ASSERT_EQ(report.tables.size(), 3U);
  EXPECT_EQ(report.tables[0].table.at(0, "step"), Cell("machine.nodes 2 -> 4"));
  EXPECT_EQ(report.tables[0].table.at(0, "price"), Cell());
}

TEST(ReadChartRows, TakesRowsOfNumbersAndTextsOnly) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "a.vl.json";
  write(file, R"({"data": {"url": "x", "values": [{"url": 1, "data": "2"}]}, "params": []})");
  EXPECT_EQ(read_chart_rows(file), Json::parse(R"([{"url": 1, "data": "2"}])"));
  for (const std::string& text :
       {std::string(R"({"data": {)"), std::string("[]"), std::string(R"({"data": []})"),
        std::string(R"({"data": {"url": "http://x"}})"), std::string(R"({"data": {"values": {}}})"),
        std::string(R"({"data": {"values": [1]}})"), std::string(R"({"data": {"values": [{"a": {}}]}})"),
        R"({"data": {"values": [{"a": )" + std::string(10'000, '[') + std::string(10'000, ']') + "}]}}"}) {
    write(file, text);
    const std::string error = user_error_of([&] { (void)read_chart_rows(file); });
    EXPECT_NE(error.find("a.vl.json: has "), std::string::npos) << text << error;
  }
}

TEST(LiveChart, HasOtherWordsAndNoRows) {
  const ReportChart chart = live_chart("over_axis", "n", "T", {{"rows", "explorer"}},
                                       {{"FIGURE", "ms"}, {"TITLE", "frame time, ms"}});
  EXPECT_EQ(chart.spec["encoding"]["y"]["title"], "frame time, ms");
  EXPECT_EQ(chart.spec.dump().find("FIGURE"), std::string::npos);
  EXPECT_TRUE(chart.spec["data"]["values"].empty());
}

TEST(ChartOfResults, IsDrawnAsItIsBuiltIn) {
  const ChartSpecification& built_in = chart_named(chart_specifications(), "working_set");
  const ReportChart chart = chart_of_results(built_in, Json::parse(R"([{"a": 1}])"));
  EXPECT_EQ(chart.name, "working_set");
  EXPECT_EQ(chart.title, Json::parse(built_in.json)["title"]);
  EXPECT_EQ(chart.spec["spec"], Json::parse(built_in.json)["spec"]);
  EXPECT_FALSE(chart.spec["spec"].empty());
  EXPECT_EQ(chart.spec["data"]["values"][0]["a"], 1);
}

std::string png_of(std::string_view size) {
  using namespace std::string_literals;
  return "\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR"s + std::string(size) + "the rest\0\0\0\0IEND\xae\x42\x60\x82"s;
}

TEST(TakeImage, TakesWholePngFilesOnly) {
  using namespace std::string_view_literals;
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "image.png";
  ReportData report;
  const auto error = [&](const std::string& bytes) {
    write(file, bytes);
    return user_error_of([&] { take_image(file, "T", report); });
  };
  const std::string good = png_of("\0\0\0\x10\0\0\0\x08"sv);
  EXPECT_NE(error("GIF89a").find("is no PNG file"), std::string::npos);
  EXPECT_NE(error(good.substr(0, 18)).find("is no PNG file"), std::string::npos);
  EXPECT_NE(error(good.substr(0, good.size() - 1)).find("without its end"), std::string::npos);
  EXPECT_NE(error(png_of("\0\0\0\0\0\0\0\x08"sv)).find("0 x 8"), std::string::npos);
  EXPECT_NE(error(png_of("\0\0\0\x08\xff\xff\xff\xff"sv)).find("8 x 4294967295"), std::string::npos);
  EXPECT_TRUE(report.images.empty());
  EXPECT_EQ(error(good), "no UserError");
  ASSERT_EQ(report.images.size(), 1U);
  EXPECT_EQ(report.images.front().png, good);
  EXPECT_TRUE(report.answer.empty());
}

TEST(TakeImage, SaysThatALargeOneIsLeftOut) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "image.png";
  write(file, "");
  fs::resize_file(file, (16U << 20U) + 1);
  ReportData report;
  take_image(file, "T", report);
  EXPECT_TRUE(report.images.empty());
  ASSERT_EQ(report.answer.size(), 1U);
  EXPECT_EQ(report.answer.front(), "image.png is left out of this page: it has more than 16 MiB.");
}

TEST(IsThere, NamesALinkToNothingAndWhatMayNotBeLookedAt) {
  const TemporaryDirectory directory;
  EXPECT_FALSE(is_there(directory.path() / "none"));
  fs::create_symlink("none", directory.path() / "image.png");
  EXPECT_TRUE(is_there(directory.path() / "image.png"));
  ReportData report;
  const std::string error = user_error_of([&] { take_image(directory.path() / "image.png", "T", report); });
  EXPECT_NE(error.find("image.png: cannot be read"), std::string::npos) << error;
  const std::string loop = (directory.path() / "loop").string();
  fs::create_symlink("loop", loop);  // root may read every file, but cannot follow this link
  const std::string looped = user_error_of([&] { (void)is_there(fs::path(loop) / "result.json"); });
  EXPECT_NE(looped.find("loop/result.json: cannot be read: "), std::string::npos) << looped;
}

TEST(RunJson, IsReadWithCare) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "result.json";
  const auto error = [&](const std::string& text) {
    write(file, text);
    return user_error_of([&] { (void)read_run_json(file, {"config.keys"}); });
  };
  EXPECT_NE(error("{").find("is not JSON"), std::string::npos);
  EXPECT_NE(error("[]").find("marti.schema"), std::string::npos);
  EXPECT_NE(error(R"({"marti": {"schema": 2}})").find("schema 2"), std::string::npos);
  EXPECT_NE(error(R"({"marti": {"schema": 4}})").find("config.keys"), std::string::npos);
  EXPECT_NE(error(std::string(100'000, '[')).find("nested too deeply"), std::string::npos);
  std::string many = "{\"a\": 0";
  for (int i = 0; i < 3000; ++i) {
    many += ", \"a" + std::to_string(i) + "\": {}";
  }
  EXPECT_NE(error(many + "}").find("too many fields"), std::string::npos);
  const RunJson run(Json::parse(R"({"a": {"b": 2, "c": "x", "d": [{"e": 1}, 3]}})"), "f");
  EXPECT_EQ(run.number("a.b"), 2.0);
  EXPECT_FALSE(run.number("a.c").has_value());
  EXPECT_EQ(run.text("a.b"), "");
  EXPECT_EQ(run.list("a.d").size(), 1U);
  EXPECT_TRUE(run.find("a.x.y").is_null());
}

}  // namespace
}  // namespace marti::studies
