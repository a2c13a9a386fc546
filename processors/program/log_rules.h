// The rules of a work log, checked word by word: a log that keeps them can be timed on every machine,
// wherever it comes from.
#pragma once

#include <string>

#include "processors/program/work_log.h"

namespace marti::processors::program {

/// What is wrong with the operands of a log, for example "row 3, pixel 5: a node that the tree does not
/// have"; empty: nothing. Every operand names something that exists, every step is of a kind that its node
/// allows, rows and pixels are all of the words, and the tree is one.
[[nodiscard]] std::string fault_of(const WorkLog& log);

/// What is wrong with the order of a log's steps, and with what it has beside its words, where fault_of() has
/// found nothing; empty: nothing. A ray begins before it visits; it visits a node only after the branch
/// above; it takes a node of a bounding volume hierarchy only if it has entered it; bounces are no more than
/// a ray can have; and the work of splitting a branch is that of what the leaves below it list. The machines
/// that build the tree, and those of SIMT nodes, rest on this. Takes as long as reading the log once, on all
/// host threads.
[[nodiscard]] std::string fault_of_order(const WorkLog& log);

}  // namespace marti::processors::program
