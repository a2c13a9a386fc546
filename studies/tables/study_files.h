// What a study leaves behind: its tables, charts and report, and the files they become.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "processors/program/image.h"
#include "studies/tables/table.h"

namespace marti::studies::tables {

struct StudyImage {
  std::string name;  ///< of its files, without .exr and .png
  processors::program::Image image;
};

struct StudyOutput {
  std::vector<Table> tables;         ///< the same input gives the same rows
  std::vector<Table> host_tables;    ///< measured on the host: they differ from run to run
  std::string report;                ///< for people; the same input gives the same text
  std::string host_report;           ///< for people; what was measured on the host
  std::vector<StudyImage> images{};  ///< the same input gives the same pixels
  std::string fault{};               ///< what the study found wrong with the program itself; empty: nothing
};

/// Writes into `directory`, which must exist:
///   NAME.csv for each table, and columns.csv with unit and meaning of every column;
///   NAME.vl.json for each chart whose table is among them and has rows;
///   NAME.exr and NAME.png for each image;
///   report.txt, and host.txt unless host_report is empty;
///   results.sqlite with all tables and their columns.
/// Only host.txt, the host tables' files and charts and results.sqlite differ between two equal runs. All
/// files are written under temporary names first and renamed together at the end; signals that end the
/// program wait until that is done. Returns the files. Throws UserError with the reason; older results stay
/// as they were then.
std::vector<std::filesystem::path> write_study(const StudyOutput& output,
                                               const std::filesystem::path& directory);

/// Throws UserError where write_study() would replace the store of a sweep by the tables of a study.
void refuse_store_of_sweep(const std::filesystem::path& directory);

}  // namespace marti::studies::tables
