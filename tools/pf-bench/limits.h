#pragma once

namespace bench {

/// Fused multiply-adds of this core with the widest vectors it has, in flop per microsecond (2 per FMA), in the library's scalar.
double peak_flops_per_us();

/// Bytes per microsecond of reading and writing back a buffer of this size, both counted.
double bandwidth_per_us(int bytes);

/// T >= (n^2 m + 2 n m c + n m^2 + m^3/3) / F + n^2 s / BW for n states, m rows that touch c columns each.
double update_limit_us(int n, int m, int c, double flops_per_us, double bytes_per_us);

}  // namespace bench
