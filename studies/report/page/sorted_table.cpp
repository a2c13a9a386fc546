#include "studies/report/page/sorted_table.h"

#include <fmt/format.h>

#include "studies/report/page/html_text.h"

namespace marti::studies::report {

std::string sorted_table_html(const SortedTable& table) {
  std::string html = "<div class=\"table\" role=\"region\" tabindex=\"0\" aria-label=\"" +
                     html_text(table.title) + "\"><table data-sorted><thead><tr>";
  for (const SortedColumn& column : table.columns) {
    html += fmt::format("<th scope=\"col\"{} title=\"{}\">{}</th>", column.number ? " class=\"number\"" : "",
                        html_text(column.description), html_text(column.name));
  }
  html += "</tr></thead><tbody>\n";
  for (const std::vector<SortedCell>& row : table.rows) {
    html += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      html += table.columns[i].number ? "<td class=\"number\"" : "<td";
      html += row[i].number ? fmt::format(" data-number=\"{}\">", *row[i].number) : std::string(">");
      html += html_text(row[i].text) + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

}  // namespace marti::studies::report
