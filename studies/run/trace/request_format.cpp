#include "studies/run/trace/request_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <vector>

#include "memory/dram_mapping.h"
#include "sim/error.h"

namespace marti::studies::run {

namespace {

using processors::machine::MachineConfig;

// Calls use(address) for each burst that the request touches.
template <class Use>
void for_each_burst(const TraceEntry& request, std::uint32_t burst, const Use& use) {
  const memory::Address end = request.address + request.bytes;
  for (memory::Address at = request.address - request.address % burst; at < end; at += burst) {
    use(at);
  }
}

std::string_view kind_name(const TraceEntry& entry) {
  return entry.kind ? memory::record_kind_names[static_cast<std::size_t>(*entry.kind)] : "stack";
}

std::string nothing(bool /*references*/) { return {}; }

// Dinero's traditional form: label, address in hexadecimal digits, and what its readers pass over.
AppendEntry append_din(const MachineConfig& /*machine*/) {
  return [](const TraceEntry& request, std::string& file) {
    fmt::format_to(std::back_inserter(file), "{} {:x} {}\n", request.write ? 1 : 0, request.address,
                   kind_name(request));
  };
}

std::string csv_head(bool references) {
  return references ? "time_ps,node,access,kind,address,bytes,hit\n"
                    : "time_ps,node,access,kind,address,bytes\n";
}

AppendEntry append_csv(const MachineConfig& /*machine*/) {
  return [](const TraceEntry& request, std::string& file) {
    fmt::format_to(std::back_inserter(file), "{},{},{},{},{},{}{}\n", request.time, request.node,
                   request.write ? "write" : "read", kind_name(request), request.address, request.bytes,
                   !request.hit   ? ""
                   : *request.hit ? ",1"
                                  : ",0");
  };
}

AppendEntry append_load_store(const MachineConfig& machine) {
  return [burst = burst_of(machine)](const TraceEntry& request, std::string& file) {
    for_each_burst(request, burst, [&](memory::Address address) {
      fmt::format_to(std::back_inserter(file), "{} 0x{:x}\n", request.write ? "ST" : "LD", address);
    });
  };
}

AppendEntry append_read_write(const MachineConfig& machine) {
  using memory::DramField;
  if (!machine.banks.dram) {
    throw sim::UserError(
        "--format ramulator-readwrite: names channels, banks and rows of a DRAM; give memory.model = "
        "\"dram\", "
        "or take ramulator-loadstore");
  }
  std::vector<DramField> fields = {DramField::channel, DramField::rank};
  if (machine.banks.dram->stacks > 1) {
    fields.push_back(DramField::stack);
  }
  fields.insert(fields.end(), {DramField::bank_group, DramField::bank, DramField::row, DramField::column});
  return [burst = burst_of(machine), fields, mapping = memory::DramMapping(*machine.banks.dram)](
             const TraceEntry& request, std::string& file) {
    for_each_burst(request, burst, [&](memory::Address address) {
      file += request.write ? "W " : "R ";
      for (const DramField field : fields) {
        fmt::format_to(std::back_inserter(file), "{},", mapping.field(field, address));
      }
      file.back() = '\n';
    });
  };
}

AppendEntry append_dramsim3(const MachineConfig& machine) {
  return
      [burst = burst_of(machine), period = cycle_of(machine)](const TraceEntry& request, std::string& file) {
        for_each_burst(request, burst, [&](memory::Address address) {
          fmt::format_to(std::back_inserter(file), "0x{:X} {} {}\n", address,
                         request.write ? "WRITE" : "READ", request.time / period);
        });
      };
}

// gem5's packet traces (src/proto/packet.proto, src/proto/protoio.cc): a magic number, then messages of
// Protocol Buffers, each behind its length; a number is written seven bits at a time, the lowest first.
void append_number(std::string& file, std::uint64_t number) {
  for (; number >= 0x80; number >>= 7U) {
    file += static_cast<char>(number | 0x80U);
  }
  file += static_cast<char>(number);
}

void append_field(std::string& message, std::uint32_t field, std::uint64_t number) {
  append_number(message, field << 3U);
  append_number(message, number);
}

void append_message(std::string& file, const std::string& message) {
  append_number(file, message.size());
  file += message;
}

std::string gem5_head(bool /*references*/) {
  const std::string name = "marti";
  std::string header;
  append_number(header, 1U << 3U | 2U);  // obj_id, a text
  append_message(header, name);
  constexpr std::uint64_t ticks_a_second = 1'000'000'000'000;
  append_field(header, 3, ticks_a_second);
  std::string file = "gem5";
  append_message(file, header);
  return file;
}

AppendEntry append_gem5(const MachineConfig& /*machine*/) {
  return [message = std::string()](const TraceEntry& request, std::string& file) mutable {
    constexpr std::uint64_t read_request = 1;   // MemCmd::ReadReq, src/mem/packet.hh
    constexpr std::uint64_t write_request = 4;  // MemCmd::WriteReq
    message.clear();
    append_field(message, 1, static_cast<std::uint64_t>(request.time));
    append_field(message, 2, request.write ? write_request : read_request);
    append_field(message, 3, request.address);
    append_field(message, 4, request.bytes);
    append_field(message, 6, request.node);
    append_message(file, message);
  };
}

void append_word(std::string& file, std::uint64_t word) {
  for (unsigned k = 0; k < 8; ++k) {
    file += static_cast<char>(word >> 8U * k);
  }
}

// ChampSim's input_instr (inc/trace_instruction.h), 64 bytes: the address of the instruction; two bytes for
// branches; two registers written and four read; two addresses written and four read. ChampSim takes address
// 0 for none, so all addresses are moved up by `first_address`. The address of the instruction tells kinds of
// records apart.
AppendEntry append_champsim(const MachineConfig& /*machine*/) {
  return [](const TraceEntry& request, std::string& file) {
    constexpr std::uint64_t first_instruction = 0x400000;
    constexpr std::uint64_t first_address = std::uint64_t{1} << 32U;
    const std::uint64_t number =
        2 * (request.kind ? static_cast<std::uint64_t>(*request.kind) : memory::record_kinds) +
        (request.write ? 1 : 0);
    append_word(file, first_instruction + 4 * number);
    append_word(file, 0);  // no branch, no registers
    for (unsigned k = 0; k < 6; ++k) {
      append_word(file, k == (request.write ? 0U : 2U) ? request.address + first_address : 0);
    }
  };
}

constexpr std::array formats = {
    RequestFormat{"din", ".din", true, true, nothing, append_din},
    RequestFormat{"csv", ".csv", false, false, csv_head, append_csv},
    RequestFormat{"ramulator-loadstore", "-loadstore.trace", false, false, nothing, append_load_store},
    RequestFormat{"ramulator-readwrite", "-readwrite.trace", false, false, nothing, append_read_write},
    RequestFormat{"dramsim3", "-dramsim3.trace", false, false, nothing, append_dramsim3},
    RequestFormat{"gem5", ".ptrc", false, false, gem5_head, append_gem5},
    RequestFormat{"champsim", ".champsim", true, false, nothing, append_champsim}};

}  // namespace

std::uint32_t burst_of(const MachineConfig& machine) {
  return machine.banks.dram ? machine.banks.dram->burst_bytes : machine.reference_bytes();
}

sim::Ticks cycle_of(const MachineConfig& machine) {
  return machine.banks.dram ? machine.banks.dram->period : machine.banks.clock.period();
}

std::span<const RequestFormat> request_formats() { return formats; }

}  // namespace marti::studies::run
