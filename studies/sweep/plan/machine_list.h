// The frames and machines that points ask for, each once.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <unordered_map>
#include <vector>

#include "studies/sweep/plan/read_point.h"
#include "studies/sweep/plan/sweep_plan.h"

namespace marti::studies::sweep {

class MachineList {
 public:
  /// Makes room for as many machines as there may be: a list that grows by doubling takes thrice that for a
  /// while.
  void reserve(std::size_t machines);
  /// The machine's number, in the order of entering; equal machines have one. Takes the settings out of
  /// `read`. Opens a scene that is a file when its frame is new. Throws UserError when it cannot be used.
  std::size_t enter(ReadPoint& read);
  /// Says that a point asks for the machine, which otherwise only serves as a base or a comparison.
  void used_by_point(std::size_t machine, std::size_t point);
  /// Moves everything into the plan, whose points and comparison have the numbers of enter(). Machines are
  /// ordered by frame, those of the points in the points' order, then the others.
  void move_into(SweepPlan& plan) &&;

 private:
  static constexpr std::size_t no_point = std::numeric_limits<std::size_t>::max();

  std::size_t enter_frame(const ReadPoint& read);

  SettingsPool settings_;
  std::vector<SweepFrame> frames_;
  std::vector<SweepMachine> machines_;
  std::vector<std::size_t> first_point_;  // that asks for the machine, or no_point
  std::unordered_map<std::string, std::size_t> frame_of_digest_;
  std::unordered_map<std::string, std::size_t> machine_of_key_;
  std::unordered_map<std::string, std::size_t> timing_of_key_;
};

}  // namespace marti::studies::sweep
