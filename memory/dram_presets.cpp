#include "memory/dram_presets.h"

#include "sim/error.h"

namespace marti::memory {

namespace {

// Times in cycles. All figures are those that Ramulator 2.1 (github.com/CMU-SAFARI/ramulator2, commit
// c5b1c3a) has under the names given here, so that results can be compared with its results; it takes them
// from the standards, and where it differs from them the comment says so.

// DDR4_2400R, DDR4_8Gb_x8, after JEDEC JESD79-4C, tables 169 and 170 for tRRD and tFAW: eight devices of 8
// bits make 64, with pages of 1 KiB each. In ns: tRAS 32, tFAW 21, tWR 15, tRTP 7.5, tWTR 2.5 and 7.5, tCCD_L
// 5, tREFI 7800; tRFC 360, where the standard has 350 for 8 Gb.
DramConfig ddr4_2400() {
  DramConfig config;
  config.period = 833;
  config.timing = {.bl = 4,
                   .cl = 16,
                   .cwl = 12,
                   .rcd = 16,
                   .rcd_write = 16,
                   .rp = 16,
                   .ras = 39,
                   .rc = 55,
                   .rrd_s = 4,
                   .rrd_l = 6,
                   .faw = 26,
                   .ccd_s = 4,
                   .ccd_l = 6,
                   .ccd_l_write = 6,
                   .wr = 18,
                   .wtr_s = 3,
                   .wtr_l = 9,
                   .rtp = 9,
                   .ppd = 1,
                   .rtw_gap = 2,
                   .rank_gap = 2,
                   .refi = 9364,
                   .rfc = 433};
  config.bank_groups = 4;
  config.banks = 4;
  config.rows = 65536;
  config.row_bytes = 8192;
  config.burst_bytes = 64;
  return config;
}

// DDR5_4800BN, DDR5_16Gb_x8, after JEDEC JESD79-5: a channel is half a module, 32 bits wide, with bursts
// of 16. In ns: tRAS 32, tFAW 20 (the standard allows 32 cycles), tWR 30, tRTP 7.5, tWTR_L 10, tCCD_L 5,
// between writes of a bank group 20, tREFI 3900, tRFC 295. Activations, reads and writes have the bus for two
// cycles.
DramConfig ddr5_4800() {
  DramConfig config;
  config.period = 416;
  config.timing = {.bl = 8,
                   .cl = 36,
                   .cwl = 34,
                   .rcd = 36,
                   .rcd_write = 36,
                   .rp = 36,
                   .ras = 77,
                   .rc = 113,
                   .rrd_s = 8,
                   .rrd_l = 12,
                   .faw = 48,
                   .ccd_s = 8,
                   .ccd_l = 12,
                   .ccd_l_write = 48,
                   .wr = 72,
                   .wtr_s = 6,
                   .wtr_l = 24,
                   .rtp = 18,
                   .ppd = 2,
                   .rtw_gap = 4,
                   .rank_gap = 2,
                   .refi = 9375,
                   .rfc = 710};
  config.bank_groups = 8;
  config.banks = 4;
  config.rows = 65536;
  config.row_bytes = 4096;
  config.activate_cycles = 2;
  config.column_cycles = 2;
  config.burst_bytes = 64;
  return config;
}

// HBM2_2000, 8 Gb: JEDEC JESD235D. The ranks are the two pseudo channels of a channel, 64 bits wide with
// bursts of four. Rows are opened and closed over a command bus of their own, on which an activation takes
// two cycles.
DramConfig hbm2_2000() {
  DramConfig config;
  config.period = 1000;
  config.timing = {.bl = 2,
                   .cl = 14,
                   .cwl = 5,
                   .rcd = 14,
                   .rcd_write = 12,
                   .rp = 14,
                   .ras = 34,
                   .rc = 48,
                   .rrd_s = 4,
                   .rrd_l = 4,
                   .faw = 15,
                   .ccd_s = 2,
                   .ccd_l = 4,
                   .ccd_l_write = 4,
                   .wr = 16,
                   .wtr_s = 6,
                   .wtr_l = 8,
                   .rtp = 5,
                   .ppd = 1,
                   .rtw_gap = 2,
                   .rank_gap = 2,
                   .refi = 3900,
                   .rfc = 350};
  config.ranks = 2;
  config.pseudo_channels = true;
  config.bank_groups = 4;
  config.banks = 4;
  config.rows = 65536;
  config.row_bytes = 1024;
  config.burst_bytes = 32;
  config.two_command_buses = true;
  config.activate_cycles = 2;
  return config;
}

// GDDR6_16Gb_x16 with the times of GDDR6_14000_1350mV_double and GDDR6_14000_1250mV_double (those of quad
// data rate are the same), after a vendor's data sheet at two supply voltages: a channel of 16 bits with
// bursts of 16. The time from a read to a write is tCL + 1 there. Their tables have no time from the
// precharge of a single bank to a refresh.
DramConfig gddr6_14000(bool low_voltage) {
  DramConfig config;
  config.period = 570;
  config.timing = {.bl = 2,
                   .cl = 24,
                   .cwl = 6,
                   .rcd = low_voltage ? 30 : 27,
                   .rcd_write = low_voltage ? 20 : 16,
                   .rp = low_voltage ? 30 : 27,
                   .ras = low_voltage ? 60 : 53,
                   .rc = low_voltage ? 90 : 79,
                   .rrd_s = low_voltage ? 11 : 8,
                   .rrd_l = low_voltage ? 11 : 8,
                   .faw = low_voltage ? 43 : 29,
                   .ccd_s = 2,
                   .ccd_l = 4,
                   .ccd_l_write = 4,
                   .wr = low_voltage ? 30 : 27,
                   .wtr_s = 9,
                   .wtr_l = 11,
                   .rtp = 4,
                   .ppd = low_voltage ? 2 : 1,
                   .rtw_gap = 5,
                   .rank_gap = 2,
                   .refi = 3333,
                   .rfc = 211};
  config.bank_groups = 4;
  config.banks = 4;
  config.rows = 16384;
  config.row_bytes = 4096;
  config.burst_bytes = 32;
  config.refresh_after_precharge = false;
  return config;
}

// HBM3_6400Mbps, after JEDEC JESD238: a pseudo channel is 32 bits wide, with bursts of eight. HBM3_16Gb_8hi
// has two stack IDs, between whose reads the data bus has a pause, HBM3_4Gb one.
DramConfig hbm3_6400(bool stacked) {
  DramConfig config;
  config.period = 625;
  config.timing = {.bl = 2,
                   .cl = 20,
                   .cwl = 10,
                   .rcd = 31,
                   .rcd_write = 15,
                   .rp = 26,
                   .ras = 45,
                   .rc = 72,
                   .rrd_s = 4,
                   .rrd_l = 5,
                   .faw = 24,
                   .ccd_s = 2,
                   .ccd_l = 4,
                   .ccd_l_write = 4,
                   .ccd_stack = 3,
                   .wr = 33,
                   .wtr_s = 7,
                   .wtr_l = 10,
                   .rtp = 9,
                   .ppd = 2,
                   .rtw_gap = 8,
                   .rank_gap = 2,
                   .refi = 6240,
                   .rfc = stacked ? 560 : 416};
  config.ranks = 2;
  config.pseudo_channels = true;
  config.stacks = stacked ? 2 : 1;
  config.bank_groups = 4;
  config.banks = 4;
  config.rows = 16384;
  config.row_bytes = 1024;
  config.burst_bytes = 32;
  config.two_command_buses = true;
  config.half_cycles = true;
  return config;
}

// LPDDR5_6400, LPDDR5_8Gb_x16, after JEDEC JESD209-5: a channel of 16 bits with bursts of 16; a cycle is four
// of the data clock's. In ns: tRRD 5, tFAW 20, tRFC 210, tREFI 3906. tWTR_L is 10 from the end of the longest
// burst, four cycles, which is two behind that of this one.
DramConfig lpddr5_6400() {
  DramConfig config;
  config.period = 1250;
  config.timing = {.bl = 2,
                   .cl = 17,
                   .cwl = 9,
                   .rcd = 15,
                   .rcd_write = 15,
                   .rp = 15,
                   .ras = 34,
                   .rc = 49,
                   .rrd_s = 4,
                   .rrd_l = 4,
                   .faw = 16,
                   .ccd_s = 2,
                   .ccd_l = 4,
                   .ccd_l_write = 4,
                   .wr = 28,
                   .wtr_s = 5,
                   .wtr_l = 12,
                   .rtp = 8,
                   .ppd = 2,
                   .rtw_gap = 2,
                   .rank_gap = 2,
                   .refi = 3125,
                   .rfc = 168};
  config.bank_groups = 4;
  config.banks = 4;
  config.rows = 32768;
  config.row_bytes = 2048;
  config.burst_bytes = 32;
  config.second_activation = 8;
  config.data_clock_tail = 1;
  return config;
}

DramConfig figures_of(std::size_t index) {
  switch (index) {
    case 0:
      return ddr4_2400();
    case 1:
      return ddr5_4800();
    case 2:
      return hbm2_2000();
    case 3:
      return gddr6_14000(false);
    case 4:
      return gddr6_14000(true);
    case 5:
      return hbm3_6400(true);
    case 6:
      return hbm3_6400(false);
    case 7:
      return lpddr5_6400();
    default:
      throw sim::InternalError("no such DRAM preset");
  }
}

}  // namespace

DramConfig dram_preset(std::size_t index) {
  DramConfig config = figures_of(index);
  config.preset = index;
  return config;
}

}  // namespace marti::memory
